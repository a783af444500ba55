"""What is done to the furniture of a house after it is read: one table of rules.

Reading puts every piece where it is painted, edges within half a pixel on their walls. Each rule
mends one thing that painting gets wrong, and what it does to a piece is kept with the piece, as an
Edit. docs/rules.md says what each is worth (benchmarks/rules.py).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from chord_usd.arrange.chairs_clear import draw_out_chairs
from chord_usd.arrange.free_floor import FreeFloor, Painted
from chord_usd.arrange.left_out import Faults, leave_out
from chord_usd.arrange.on_walls import hang_on_walls
from chord_usd.arrange.seating import seat_chairs
from chord_usd.arrange.unit_runs import level_fronts
from chord_usd.arrange.usual_sizes import grow_to_usual
from chord_usd.arrange.walls_kept import cut_at_walls
from chord_usd.graph.colours import LabelArray, read_pixels
from chord_usd.graph.fit import is_built_in
from chord_usd.graph.flush import parted
from chord_usd.graph.match import FLUSH_PX
from chord_usd.scene.geometry import room_polygon
from chord_usd.scene.oriented_rect import Footprint
from chord_usd.scene.palette import category
from chord_usd.scene.types import Box, Edit, Item, LayoutImage, PixelFrame, Room, SceneGraph

_SAME = 1e-6
"""Metres and degrees."""


@dataclass(frozen=True, eq=False)
class Seen:
    """What a graph was read from."""

    labels: LabelArray
    """(H, W) as LayoutPixels.item."""
    frame: PixelFrame

    @classmethod
    def on(cls, layout: LayoutImage) -> Seen:
        """What a layout raster shows."""
        return cls(read_pixels(layout.rgb).item, layout.frame)

    @property
    def painted(self) -> Painted:
        return Painted(self.labels, self.frame)

    @property
    def reach_m(self) -> float:
        """Edges no farther apart than this are one."""
        return FLUSH_PX * self.frame.m_per_px


OnLayout = Callable[[SceneGraph, Seen], SceneGraph]
OnHouse = Callable[[SceneGraph, Faults, Collection[str]], SceneGraph]
OnMeshes = Callable[[SceneGraph, Collection[str], Collection[str]], SceneGraph]


@dataclass(frozen=True)
class Rule:
    """One thing that is mended: by a layout raster, when no more is drawn, or by meshes."""

    name: str
    on_layout: OnLayout | None = None
    on_house: OnHouse | None = None
    """Called with what tells how much is wrong, and ids of the items that may go, none for all."""
    on_meshes: OnMeshes | None = None
    """Called with ids of rooms, none for all, and of items that stay."""


def arrange(graph: SceneGraph, seen: Seen, without: Collection[str] = ()) -> SceneGraph:
    """The graph after the rules that look at its layout; meshes are matched after it.

    without: names of rules that are left out.
    """
    for rule in RULES:
        if rule.on_layout and rule.name not in without:
            graph = noted(rule.name, graph, rule.on_layout(graph, seen))
    return graph


def arrange_house(
    graph: SceneGraph, faults: Faults, among: Collection[str] = (), without: Collection[str] = ()
) -> SceneGraph:
    """The graph after the rules for what the last draw leaves.

    faults: how much is wrong with a house. among: ids of the items that may go, by default all.
    without: names of rules that are left out.
    """
    for rule in RULES:
        if rule.on_house and rule.name not in without:
            graph = rule.on_house(graph, faults, among)
    return graph


def arrange_meshes(
    graph: SceneGraph, rooms: Collection[str] = (), but: Collection[str] = ()
) -> SceneGraph:
    """The graph after the rules that look at meshes, before its stage is written.

    rooms: ids of the rooms whose pieces may move, by default all. but: ids of items that stay.
    Raises StageError for a mesh that cannot be opened.
    """
    for rule in RULES:
        if rule.on_meshes:
            graph = noted(rule.name, graph, rule.on_meshes(graph, rooms, but))
    return graph


def noted(name: str, before: SceneGraph, after: SceneGraph) -> SceneGraph:
    """The graph after a rule, with an Edit in each piece whose box it changed."""
    boxes = {item.id: item.box for item in before.items}

    def with_edit(item: Item) -> Item:
        box = boxes.get(item.id, item.box)
        if _is_same(box, item.box):
            return item
        return item.found(edits=(*item.facts.edits, Edit(name, box)))

    return replace(after, items=tuple(with_edit(item) for item in after.items))


def _is_same(one: Box, other: Box) -> bool:
    """But for rounding."""
    first, second = ((*box.center_m, *box.size_m, box.yaw_deg) for box in (one, other))
    return one == other or bool(np.allclose(first, second, rtol=0.0, atol=_SAME))


def edits_told(graph: SceneGraph) -> list[dict[str, str | float]]:
    """Every edit of a house's pieces, for reports: which piece, which rule, and how far the piece
    was moved in all."""
    return [
        {"item": item.id, "rule": edit.rule, "moved_m": item.moved_m}
        for item in graph.items
        for edit in item.facts.edits
    ]


def _room_by_room(boxes_of: Callable[[Room, Sequence[Item], Seen], Sequence[Box]]) -> OnLayout:
    """A rule that looks at each room alone."""

    def rule(graph: SceneGraph, seen: Seen) -> SceneGraph:
        items = {item.id: item for item in graph.items}
        for room in graph.rooms:
            own = list(graph.items_of(room.id))
            for item, box in zip(own, boxes_of(room, own, seen), strict=True):
                items[item.id] = replace(item, box=box)
        return replace(graph, items=tuple(items.values()))

    return rule


def _cut_at_walls(room: Room, items: Sequence[Item], seen: Seen) -> list[Box]:
    floor = room_polygon(room)
    return [cut_at_walls(Footprint.of(item.box), floor).on(item.box) for item in items]


def _parted(room: Room, items: Sequence[Item], seen: Seen) -> list[Box]:
    apart = parted([Footprint.of(item.box) for item in items], seen.reach_m)
    return [footprint.on(item.box) for footprint, item in zip(apart, items, strict=True)]


def _levelled(room: Room, items: Sequence[Item], seen: Seen) -> list[Box]:
    built_in = [is_built_in(category(item.category)) for item in items]
    units = [item.box for item, is_unit in zip(items, built_in, strict=True) if is_unit]
    others = [item.box for item, is_unit in zip(items, built_in, strict=True) if not is_unit]
    level = iter(level_fronts(units, others, seen.frame.m_per_px))
    return [
        next(level) if is_unit else item.box for item, is_unit in zip(items, built_in, strict=True)
    ]


def _off_free_floor(graph: SceneGraph, seen: Seen) -> SceneGraph:
    free = FreeFloor(graph.rooms, graph.openings)
    items = tuple(
        replace(
            item,
            box=free.kept(
                Footprint.of(item.box),
                item.box,
                category(item.category),
                seen.reach_m,
                seen.painted,
            ),
        )
        for item in graph.items
    )
    return replace(graph, items=items)


def _below_sills(graph: SceneGraph, seen: Seen) -> SceneGraph:
    free = FreeFloor(graph.rooms, graph.openings)
    return replace(graph, items=tuple(free.below_sill(item) for item in graph.items))


RULES: tuple[Rule, ...] = (
    Rule("cut at the room's edge", _room_by_room(_cut_at_walls)),
    Rule("neighbours parted", _room_by_room(_parted)),
    Rule("one depth of kitchen units", _room_by_room(_levelled)),
    Rule("off the floor before openings", _off_free_floor),
    Rule("below window sills", _below_sills),
    Rule("grown to usual sizes", lambda graph, _: grow_to_usual(graph)),
    Rule("chairs face tables, in sets", lambda graph, _: seat_chairs(graph)),
    Rule("what stands in the way left out", on_house=leave_out),
    Rule("panels on their walls", on_meshes=hang_on_walls),
    Rule("chairs clear of tables", on_meshes=draw_out_chairs),
)
"""In the order in which they are applied."""
