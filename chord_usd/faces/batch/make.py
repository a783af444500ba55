"""Makes one house after the other, with models that are loaded once. Runs in the workers."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.runtime.files import hash_file, output_folder
from chord_usd.base.runtime.progress import Stopwatch
from chord_usd.faces.batch.records import (
    HOUSE_RECORD,
    PICTURES_FOLDER,
    PICTURES_RECORD,
    Digests,
    Record,
    files_in,
    finished,
    hashes_of,
    write_costs,
    write_record,
)
from chord_usd.faces.batch.shared import keep_pictures, share_files
from chord_usd.faces.batch.work_units import Order, Unit

if TYPE_CHECKING:
    from chord_usd.base.scene.types import Item, SceneGraph
    from chord_usd.line.image.options import RenderOptions
    from chord_usd.line.pipeline import House, Models
    from chord_usd.line.stage.check.check_stage import Report

Make = Callable[[Unit], None]
"""Makes what is not there yet of a unit. Raises ChordError; then it has left no half of it."""

STAGE_FILE = "house.usda"
PLAN_FILE = "plan.png"
LAYOUT_FILE = "layout.png"
SCENE_FILE = "scene.json"
PROCEDURAL_FILE = "plan.json"


class Maker:
    """Makes the units of an order."""

    def __init__(self, order: Order) -> None:
        self._order = order
        self._digests = Digests()

    def __call__(self, unit: Unit) -> None:
        """As Make."""
        house = self._order.folder / unit.name
        record = finished(house / HOUSE_RECORD, unit.recipe, self._digests)
        record = record or self._furnish(unit, house)
        if self._order.renders:
            _render(house, record, self._order.renders, self._digests)

    @cached_property
    def _models(self) -> Models:
        from chord_usd.line.pipeline import load_models

        return load_models(self._order.settings)

    def _furnish(self, unit: Unit, target: Path) -> Record:
        """Write the house, whole or not at all."""
        from chord_usd.line.pipeline import generate
        from chord_usd.line.stage.check.check_stage import check_stage

        watch, before_s = Stopwatch(), cpu_seconds()
        settings = replace(self._order.settings, seed=unit.seed)
        with output_folder(target, "renew") as folder:
            plan_file = _plan_file(unit, folder)
            stage = folder / STAGE_FILE
            house = generate(plan_file, stage, settings, watch, self._models)
            _write_rasters(house, folder)
            with watch.step("check"):
                report = check_stage(stage, trusted=True)
            share_files(folder, target.parent)
            files = hashes_of(files_in(folder), folder)
            record = Record(unit.recipe, files, _told(unit, house, report))
            write_record(record, folder / HOUSE_RECORD)
            write_costs(folder, "house", watch.seconds, cpu_seconds() - before_s)
            # What was rendered of the very same stage needs not be rendered again.
            old = target / STAGE_FILE
            if old.is_file() and hash_file(old) == files[STAGE_FILE]:
                keep_pictures(target, folder, PICTURES_FOLDER)
        return record


def cpu_seconds() -> float:
    """Of this process and of those that it started and that have ended."""
    times = os.times()
    return times.user + times.system + times.children_user + times.children_system


def pictures_recipe(record: Record, options: RenderOptions) -> Mapping[str, Any]:
    """All that decides the pictures of a finished house, by its record."""
    from chord_usd.line.image.made import settings_record

    house = json.dumps(sorted(record.files.items()))
    return {
        "house_sha256": hashlib.sha256(house.encode()).hexdigest(),
        **settings_record(options),
        "cameras": options.cameras,
        "walkthrough": options.walkthrough,
        "label_set": options.label_set,
    }


def _render(house: Path, made: Record, options: RenderOptions, digests: Digests) -> None:
    """Take the missing pictures; all pictures of a camera appear together."""
    from chord_usd.line.image.render import render_stage

    recipe = pictures_recipe(made, options)
    record = house / PICTURES_RECORD
    if finished(record, recipe, digests):
        return
    watch, before_s = Stopwatch(), cpu_seconds()
    with watch.step("render"):
        rendered = render_stage(house / STAGE_FILE, house / PICTURES_FOLDER, options)
    sidecars = {file.with_name(f"{camera_of(file)}.json") for file in rendered.files}
    files = hashes_of(sorted({*rendered.files, *sidecars}), house)
    write_record(Record(recipe, files, {"device": rendered.device}), record)
    write_costs(house, "pictures", watch.seconds, cpu_seconds() - before_s)


def camera_of(picture: Path) -> str:
    """The camera a file of a render belongs to; names of prims have no dots."""
    return picture.name.split(".")[0]


def _plan_file(unit: Unit, folder: Path) -> Path:
    """The unit's plan; a procedural one is drawn into the house's folder."""
    if isinstance(unit.plan, Path):
        return unit.plan
    import numpy as np

    from chord_usd.base.scene.chord_json import write_plan
    from chord_usd.workshop.data.floorplans.programme import spread_room_count
    from chord_usd.workshop.data.houses import random_plan

    plan = random_plan(np.random.default_rng(unit.plan), spread_room_count(unit.plan))
    write_plan(plan, folder / PROCEDURAL_FILE)
    return folder / PROCEDURAL_FILE


def _write_rasters(house: House, folder: Path) -> None:
    from chord_usd.base.raster.raster_files import write_raster
    from chord_usd.base.scene.json_stairs import write_storeys

    for made in house.storeys:
        for image, name in ((made.plan_image, PLAN_FILE), (made.layout, LAYOUT_FILE)):
            write_raster(image, folder / storey_file(name, made.storey.index))
    graphs = [_with_own_assets(graph) for graph in house.graphs]
    write_storeys(graphs, [made.storey.name for made in house.storeys], folder / SCENE_FILE)


def storey_file(name: str, index: int) -> str:
    """The file of a storey: above the lowest, with the storey's number behind the name."""
    return f"{Path(name).stem}_{index}{Path(name).suffix}" if index else name


def _with_own_assets(graph: SceneGraph) -> SceneGraph:
    """The graph pointing to the meshes beside its stage, not to the machine's."""
    items, dressing = (tuple(map(_with_own_asset, all_)) for all_ in (graph.items, graph.dressing))
    return replace(graph, items=items, dressing=dressing)


def _with_own_asset(item: Item) -> Item:
    children = tuple(_with_own_asset(child) for child in item.children)
    if item.asset is None:
        return replace(item, children=children)
    path = item.asset.usd_path
    asset = replace(item.asset, usd_path=Path("assets", path.parent.name, path.name))
    return replace(item, children=children, asset=asset)


_SHARES = ("walkable", "reachable_rooms", "por", "piou", "complete", "right")


def _told(unit: Unit, house: House, report: Report) -> dict[str, Any]:
    """Figures for the index."""
    graphs = house.graphs
    items = [item for graph in graphs for item in graph.items]
    return {
        "plan": unit.source,
        "seed": unit.seed,
        "rooms": sum(len(graph.rooms) for graph in graphs),
        "furniture": len(items),
        "items": len(items) + sum(len(item.children) for item in items),
        "dressing": sum(len(graph.dressing) for graph in graphs),
        "openings": sum(len(graph.openings) for graph in graphs),
        "m_per_px": house.ground.plan_image.frame.m_per_px,
        "holds": report.holds,
        "errors": len(report.errors),
        "collisions": len(report.collisions),
        "out_of_room": len(report.out_of_room),
        "blocked_openings": len(report.blocked_openings),
        "unsupported": len(report.unsupported),
        "empty_rooms": len(report.empty_rooms),
        **{key: getattr(report, key) for key in _SHARES},
        "warnings": list(house.warnings),
    }
