"""What is done to the furniture of a layout after it is read: rules, in one table.

Reading puts every piece where it is painted, edges within half a pixel on their walls. Each rule
mends one thing that painting gets wrong. benchmarks/rules.py measures what each is worth.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from chord_usd.graph.colours import LabelArray, read_pixels
from chord_usd.graph.fit import is_built_in
from chord_usd.graph.flush import Standing, part, pull_into
from chord_usd.graph.free_floor import FreeFloor, Painted
from chord_usd.graph.match import FLUSH_PX
from chord_usd.graph.runs import level_fronts
from chord_usd.graph.seating import seat_chairs
from chord_usd.graph.usual import grow_to_usual
from chord_usd.scene.geometry import room_polygon
from chord_usd.scene.palette import category
from chord_usd.scene.types import Box, Item, LayoutImage, PixelFrame, Room, SceneGraph


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


Rule = Callable[[SceneGraph, Seen], SceneGraph]


def arrange(graph: SceneGraph, seen: Seen, without: Collection[str] = ()) -> SceneGraph:
    """The graph after all rules, but for those that are named; meshes are matched after it."""
    for name, rule in RULES.items():
        if name not in without:
            graph = rule(graph, seen)
    return graph


def _room_by_room(boxes_of: Callable[[Room, Sequence[Item], Seen], Sequence[Box]]) -> Rule:
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
    return [pull_into(Standing.of(item.box), floor).on(item.box) for item in items]


def _parted(room: Room, items: Sequence[Item], seen: Seen) -> list[Box]:
    standings = part([Standing.of(item.box) for item in items], seen.reach_m)
    return [standing.on(item.box) for standing, item in zip(standings, items, strict=True)]


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
                Standing.of(item.box), item.box, category(item.category), seen.reach_m, seen.painted
            ),
        )
        for item in graph.items
    )
    return replace(graph, items=items)


def _below_sills(graph: SceneGraph, seen: Seen) -> SceneGraph:
    free = FreeFloor(graph.rooms, graph.openings)
    return replace(graph, items=tuple(free.below_sill(item) for item in graph.items))


RULES: Mapping[str, Rule] = {
    "cut at the room's edge": _room_by_room(_cut_at_walls),
    "neighbours parted": _room_by_room(_parted),
    "one depth of kitchen units": _room_by_room(_levelled),
    "off the floor before openings": _off_free_floor,
    "below window sills": _below_sills,
    "grown to usual sizes": lambda graph, _: grow_to_usual(graph),
    "chairs face tables, in sets": lambda graph, _: seat_chairs(graph),
}
"""In the order in which they are applied."""
