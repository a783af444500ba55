"""Plans of storeys -> one furnished stage: each furnished as generate does, joined by stairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.runtime.progress import Stopwatch
from chord_usd.base.scene.json_stairs import StoreyPlan, is_storeys, storeys_from_json
from chord_usd.base.scene.limits import MOST_JSON_BYTES, SEEDS
from chord_usd.base.scene.settings import Settings
from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.base.scene.storeys import Building, Storey, stack
from chord_usd.base.scene.styles import MIXED, style_named
from chord_usd.base.scene.types import PlanImage, StageFile
from chord_usd.line.pipeline import (
    Furnished,
    draw_plan,
    furnish,
    load_usd,
    read_plan,
    refuse_roof,
    refuse_shut,
    sampling,
)
from chord_usd.line.pipeline.loading import Models, load_models

if TYPE_CHECKING:
    from chord_usd.line.lists.wishes import Asked

_SEEDS_APART = 7919
"""Between the seeds of storeys."""


@dataclass(frozen=True, eq=False)
class StoreyHouse:
    """Every artefact of a house of storeys."""

    building: Building
    plan_images: tuple[PlanImage, ...]
    furnished: tuple[Furnished, ...]
    """Storey by storey, the lowest first."""
    stage: StageFile


def read_storeys(
    files: Sequence[Path], settings: Settings, *, every: bool = False
) -> tuple[StoreyPlan, ...]:
    """The storeys in these files, the lowest first: a plan each, or a JSON that holds several.

    every: whether of each file all storeys are taken that it shows. Of the settings, rooms name
    their storey, too (corrections.on_storeys).

    Raises PlanError.
    """
    found: list[StoreyPlan] = []
    said, settings = settings.rooms, replace(settings, rooms="")
    for file in files:
        held = storeys_in(file)
        if every and not held:
            from chord_usd.line.plan.read import read_storey_plans

            found += read_storey_plans(file, settings.m_per_px)
            continue
        found += held or [StoreyPlan(read_plan(file, settings))]
    return _corrected(found, said) if said else tuple(found)


def _corrected(storeys: Sequence[StoreyPlan], said: str) -> tuple[StoreyPlan, ...]:
    from chord_usd.base.scene.storeys import storey_title
    from chord_usd.line.plan.corrections import on_storeys, read_rooms, with_rooms

    names = [one.name or storey_title(index) for index, one in enumerate(storeys)]
    return tuple(
        replace(storey, plan=with_rooms(storey.plan, own)) if own else storey
        for storey, own in zip(storeys, on_storeys(read_rooms(said), names), strict=True)
    )


def storeys_in(file: Path) -> tuple[StoreyPlan, ...]:
    """The storeys in a JSON file that holds several; none for any other file. Raises PlanError."""
    if file.suffix.lower() != ".json":
        return ()
    refuse_odd_file(file, PlanError, MOST_JSON_BYTES)
    data = parse_json(file.read_bytes(), str(file), PlanError)
    return storeys_from_json(data, str(file)) if is_storeys(data) else ()


def generate_storeys(
    given: Sequence[StoreyPlan],
    files: Sequence[Path],
    stage_path: Path,
    settings: Settings | None = None,
    stopwatch: Stopwatch | None = None,
    models: Models | None = None,
) -> StoreyHouse:
    """Furnish storeys and write them as one stage, the lowest first.

    files: what they were read from, one for all or one each. Everything else is as generate has
    it. Raises ChordError.
    """
    settings, watch = settings or Settings(), stopwatch or Stopwatch()
    with watch.step("plan"):
        building = stack(given)
        own_files = [files[min(one.index, len(files) - 1)] for one in building.storeys]
        for storey, file in zip(building.storeys, own_files, strict=True):
            refuse_shut(storey.plan, file)
        refuse_roof(building.storeys[-1].plan, settings)
        images = [draw_plan(storey.plan) for storey in building.storeys]
        asked = _asked(building, settings)
    style = style_named(settings.style or MIXED, settings.seed)
    with watch.step("load"):
        models = (models or load_models(settings)).in_style(style.name)
        load_usd()
    made = []
    for storey, image, file in zip(building.storeys, images, own_files, strict=True):
        own = replace(settings, seed=_seed(settings.seed, storey.index))
        ids = {room.id for room in storey.plan.rooms}
        wishes = {room_id: one for room_id, one in asked.items() if room_id in ids}
        draw = replace(sampling(own, models.lists, wishes), shut=_cells(storey))
        made.append(furnish(storey.plan, image, file, models, own, draw, style, watch))
    with watch.step("stage"):
        stage = _write(building, made, stage_path, settings, style.name)
    return StoreyHouse(building, tuple(images), tuple(made), stage)


def _seed(seed: int, index: int) -> int:
    return (seed + _SEEDS_APART * index) % (SEEDS[1] + 1)


def _cells(storey: Storey) -> frozenset[str]:
    return frozenset(room.id for room in storey.plan.rooms if is_cell(room))


def _asked(building: Building, settings: Settings) -> dict[str, Asked]:
    """What rooms of all storeys shall hold, by their ids. Raises ChordError."""
    if not settings.furniture:
        return {}
    from chord_usd.line.lists.wishes import furniture_asked, read_furniture
    from chord_usd.line.stage.author.stage_levels import levels_of

    graphs = [storey.plan.scene() for storey in building.storeys]
    rooms = {named.name: named.room for one in levels_of(building, graphs) for named in one.rooms}
    return furniture_asked(read_furniture(settings.furniture), rooms)


def _write(
    building: Building,
    made: Sequence[Furnished],
    stage_path: Path,
    settings: Settings,
    style: str,
) -> StageFile:
    from chord_usd.library.looks.look_library import style_looks
    from chord_usd.line.stage.author.author_stage import author_levels
    from chord_usd.line.stage.author.stage_levels import levels_of

    levels = levels_of(building, [one.graph for one in made])
    looks = style_looks(style_named(style, settings.seed), settings.seed, settings.texture_px)
    return author_levels(
        levels, stage_path, seed=settings.seed, looks=looks, style=style, sky=settings.sky,
        articulation=settings.articulation, roof=settings.roof,
    )  # fmt: skip
