"""stage -> stage, one room of it furnished and dressed again."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.raster import canvas
from chord_usd.base.runtime.progress import Stopwatch
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.settings import Settings
from chord_usd.base.scene.styles import MIXED, style_named
from chord_usd.base.scene.types import Item, LayoutImage, Room, SceneGraph, StageFile
from chord_usd.line.pipeline import (
    draw_plan,
    dress_rooms,
    lay_tables,
    load_models,
    require_lists,
    sampling,
    score_outliers,
    settle,
)
from chord_usd.line.pipeline.resample import TOUCH_M2, Resampler, furnish_again

if TYPE_CHECKING:
    from chord_usd.library.database import AssetDatabase
    from chord_usd.line.lists.wishes import Wishes
    from chord_usd.line.stage.edit.staged_house import StagedHouse


@dataclass(frozen=True, eq=False)
class Regenerated:
    """A house of which one room is to be furnished again."""

    source: Path
    room_name: str
    room: Room
    before: LayoutImage
    """The house as it stands, drawn from its stage."""
    layout: LayoutImage
    """The same with the room sampled again; pixels outside the room stay."""
    graph: SceneGraph
    """The house with the room's new furniture and dressing."""
    kept: tuple[str, ...] = ()
    """Names of the room's prims that stay as they are."""
    kept_ids: frozenset[str] = frozenset()
    """Their ids in the graph."""
    style: str = ""
    """Name of the style it is furnished in."""
    home_seed: int = 0
    """Seed of the house, by which its rooms agree."""
    requests: str = ""
    """Pieces that the room must and must not hold from now on, in words."""

    @property
    def new_items(self) -> tuple[Item, ...]:
        """Furniture that was not there before."""
        pieces = self.graph.items_of(self.room.id)
        return tuple(item for item in pieces if item.id not in self.kept_ids)

    @property
    def new_dressing(self) -> tuple[Item, ...]:
        """Dressing that was not there before."""
        things = self.graph.dressing_of(self.room.id)
        return tuple(item for item in things if item.id not in self.kept_ids)


def regenerate(
    source: Path,
    room_name: str,
    settings: Settings | None = None,
    stopwatch: Stopwatch | None = None,
    seed: int | None = None,
    *,
    keep: Sequence[str] = (),
    edits: Path | None = None,
    wishes: Wishes | None = None,
) -> Regenerated:
    """Furnish one room of a stage again, by masked diffusion; write_regenerated writes it.

    room_name: as named_room takes it. seed: in place of that of settings; None takes the one
    after the room's last. keep: names of prims of the room's furniture and dressing that stay, as
    what is locked does, and with them what they rest on; the rest is sampled around them. edits: a
    layer over source in which things stand elsewhere; the house is seen with it. wishes: what the
    room must hold (lists.wishes.read_pieces), besides what was asked for before. The stopwatch
    times read, load, layout, graph, outliers, tabletop and dress. A house without dressing stays
    without. Raises ChordError.
    """
    settings = settings or Settings()
    watch = stopwatch or Stopwatch()
    if wishes and any(wishes):
        require_lists(settings)
    with watch.step("read"):
        from chord_usd.line.graph.match import match_assets
        from chord_usd.line.lists.wishes import Wishes, asked_in, read_pieces
        from chord_usd.line.pipeline.named_room import named_room
        from chord_usd.line.stage.edit.refurnish import require_furniture
        from chord_usd.line.stage.edit.staged_house import read_edited_house, read_house

        room_name = named_room(source, room_name)
        house = (
            read_edited_house(edits, source, room_name) if edits else read_house(source, room_name)
        )
        room = house.room(room_name, source)
        require_furniture(source, room_name)
        kept = house.kept(room_name, [*keep, *house.locked_in(room_name)], source)
        kept_ids, bare = frozenset(kept), replace(house.graph, dressing=())
        seed = house.seeds[room_name] + 1 if seed is None else seed
        kept_items = [item for item in house.graph.items_of(room.id) if item.id in kept_ids]
        wishes = wishes or Wishes()
        if settings.lists and (before := house.requests.get(room_name)):
            wishes = wishes.after(read_pieces(before), {item.category for item in kept_items})
        asked = {}
        if any(wishes):
            asked[room.id] = asked_in(room_name, room, wishes, kept_items)
    style = style_named(settings.style or house.graph.style or MIXED, house.seed)
    with watch.step("load"):
        models = load_models(settings).in_style(style.name)
    seeded = replace(settings, seed=seed)
    plan_image = draw_plan(house.graph.plan)
    draw = sampling(seeded, models.lists, asked)
    sampler = Resampler(
        plan_image, models.layout, models.reader.read, draw, kept_ids, step=watch.step
    )
    made = furnish_again(bare, room, sampler)
    graph = _beside_dressing(made.graph, room, house.graph.dressing, kept_ids)
    others = {item.id for item in house.graph.items if item.room_id != room.id}
    graph = match_assets(graph, models.reader.database, but=others | kept_ids)
    with watch.step("outliers"):
        graph = score_outliers(graph, plan_image, models.layout)
    if models.table:
        with watch.step("tabletop") as progress:
            database, rooms = models.reader.database, (room.id,)
            graph = lay_tables(
                graph, models.table, database, seeded, progress, rooms, kept_ids
            ).graph
    graph = settle(graph, seeded, (room.id,), kept_ids, models.reader.database)
    with watch.step("dress"):
        graph = replace(graph, style=style.name)
        graph = _dressed(graph, house, room, models.reader.database, seeded, kept_ids)
    return Regenerated(
        source, room_name, room, canvas.layout_image(plan_image, bare.items), made.layout, graph,
        tuple(kept.values()), kept_ids, style.name, house.seed,
        wishes.in_words() if settings.lists else house.requests.get(room_name, ""),
    )  # fmt: skip


def _beside_dressing(
    graph: SceneGraph, room: Room, dressing: Sequence[Item], kept_ids: Collection[str]
) -> SceneGraph:
    """The house without new furniture that stands in dressing that stays."""
    floor = [
        footprint_polygon(thing.box)
        for thing in dressing
        if thing.id in kept_ids and category(thing.category).mount is Mount.FLOOR
    ]
    return graph.without(
        item.id
        for item in graph.items_of(room.id)
        if item.id not in kept_ids
        and any(
            footprint_polygon(item.box).intersection(outline).area > TOUCH_M2 for outline in floor
        )
    )


def _dressed(
    graph: SceneGraph,
    house: StagedHouse,
    room: Room,
    database: AssetDatabase,
    settings: Settings,
    kept_ids: Collection[str],
) -> SceneGraph:
    """The house with the dressing of other rooms, and of this one what is kept and what is new."""
    stays = tuple(
        thing for thing in house.graph.dressing if thing.room_id != room.id or thing.id in kept_ids
    )
    graph = replace(graph, dressing=stays)
    if not (settings.dressing and house.is_dressed):
        return graph
    # What is kept was read from a stage, where nothing has an asset.
    items = tuple(replace(i, asset=i.asset or house.assets.get(i.id)) for i in graph.items)
    keep = frozenset(thing.id for thing in stays)
    dressed = dress_rooms(replace(graph, items=items), database, settings, (room.id,), keep)
    return replace(dressed, items=graph.items)


def write_regenerated(made: Regenerated, target: Path) -> StageFile:
    """Write the stage with its one room changed; target may be the stage it came from."""
    from chord_usd.line.stage.edit.refurnish import NewFurniture, refurnish

    new = NewFurniture(
        room_name=made.room_name,
        room=made.room,
        items=made.new_items,
        dressing=made.new_dressing,
        made=made.graph.provenance,
        kept=made.kept,
        style=made.style,
        home_seed=made.home_seed,
        requests=made.requests,
    )
    return refurnish(made.source, target, new)
