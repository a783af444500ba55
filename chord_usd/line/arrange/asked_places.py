"""Where a piece may stand that somebody asked for: free places of a room, and how well they are
what was said. Metres.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely

from chord_usd.base.metrics.clear_floor import ClearFloor, clearances, is_high_enough, sides_of
from chord_usd.base.metrics.complete import TABLES, WALLED
from chord_usd.base.metrics.footprints import is_underfoot
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.scene.geometry import (
    footprint_polygon,
    front_direction,
    room_polygon,
    room_sides,
)
from chord_usd.base.scene.intents import DOOR, WALL, WINDOW, Relation
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.trim import boards, casings
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph
from chord_usd.base.scene.units import wrap_deg

ALONG_M, GRID_M = 0.1, 0.3
"""Between places along a wall or a piece, and on the open floor."""

BESIDE_M = 0.04
"""Left between a piece and what it stands next to; its mesh may be a little larger than its box."""

OFF_WALL_M = 0.005
NEAR_M = {"by": 1.0, "before": 1.2, "between": 2.0, "above": 0.5, "under": 0.01}
"""Farther from what a relation is to is not where it was asked for."""

_HUNG_M = 0.001
_LEAST_SIDE_M = 0.3
_CHAIR_M = 0.02
_HOLES_M = 0.12
"""What hangs on walls keeps so far from openings."""


@dataclass(frozen=True, eq=False)
class Floor:
    """A room with what stands in it, to find places in."""

    graph: SceneGraph
    room: Room
    gone: frozenset[str] = frozenset()
    """Ids of things that are not in the way."""

    @cached_property
    def things(self) -> list[Item]:
        """What may be in the way: of all rooms, since open plans have no walls."""
        own = (*self.graph.items, *self.graph.dressing)
        return [one for one in own if one.id not in self.gone and not is_underfoot(one)]

    @cached_property
    def polygon(self) -> shapely.Polygon:
        return room_polygon(self.room)

    @cached_property
    def _covering(self) -> shapely.Polygon:
        grown = self.polygon.buffer(1e-3)
        shapely.prepare(grown)
        return grown

    @cached_property
    def openings(self) -> list[Opening]:
        """In the walls of the room."""
        beside = sides_of(self.graph.openings, self.graph.rooms)
        return [opening for opening, room in beside if room.id == self.room.id]

    @cached_property
    def _clear(self) -> list[ClearFloor]:
        near = clearances(self.graph.rooms, self.graph.openings)
        return [one for one in near if one[1].intersects(self.polygon)]

    @cached_property
    def _trim(self) -> list[Box]:
        return [
            one
            for opening in self.openings
            for one in (*casings(opening, self.room), *boards(opening, self.room))
        ]

    @cached_property
    def _solid(self) -> tuple[list[Box], shapely.STRtree]:
        boxes = [*(one.box for one in self.things), *self._trim]
        return boxes, shapely.STRtree([footprint_polygon(box) for box in boxes])

    def in_the_way(self, item: Item) -> str:
        """Why a thing cannot be there: what is in its way, in words; "" where nothing is."""
        shape, box = footprint_polygon(item.box), item.box
        if not self._covering.covers(shape):
            return "the wall"
        if is_underfoot(item):
            return ""
        boxes, tree = self._solid
        for index in tree.query(shape, predicate="intersects"):
            other = boxes[index]
            is_level = other.center_m[2] < box.top_m and other.top_m > box.center_m[2]
            if is_level and footprint_polygon(other).intersection(shape).area > MIN_OVERLAP_M2:
                named = index < len(self.things)
                return category(self.things[index].category).label.lower() if named else "a casing"
        for opening, ground in self._clear:
            if is_high_enough(item, opening) and (ground.intersection(shape).area > MIN_OVERLAP_M2):
                return f"the way to a {opening.kind}"
        if category(item.category).mount is Mount.WALL:
            for opening in self.openings:
                hole = footprint_polygon(opening.box).buffer(_HOLES_M)
                top = opening.box.top_m + _HOLES_M
                if box.center_m[2] < top and hole.intersects(shape):
                    return f"a {opening.kind}"
        return ""

    # Anchors --------------------------------------------------------------------------------------

    def shapes(self, anchors: Sequence[str]) -> list[shapely.Geometry]:
        """Of what a relation is to, seen from above; of windows, doors and walls all."""
        found: list[shapely.Geometry] = []
        by_id = {one.id: one for one in (*self.graph.items, *self.graph.dressing)}
        for anchor in anchors:
            if anchor == WALL:
                found.append(self.polygon.exterior)
            elif anchor in (WINDOW, DOOR):
                holes = [one.box for one in self.openings if (one.kind == WINDOW)
                         == (anchor == WINDOW)]  # fmt: skip
                if holes:
                    found.append(shapely.union_all([footprint_polygon(box) for box in holes]))
            else:
                found.append(footprint_polygon(by_id[anchor].box))
        return found

    def misses_m(self, item: Item, relation: Relation, anchors: Sequence[str]) -> float:
        """How far a thing is from where a relation wants it."""
        shape, shapes = footprint_polygon(item.box), self.shapes(anchors)
        if not relation or not shapes:
            return 0.0
        away = [float(shape.distance(one)) for one in shapes]
        if relation == "between":
            return float(max(away))
        if relation == "under":
            return float(shape.centroid.distance(shapes[0].centroid))
        if relation == "above":
            return float(shape.centroid.distance(shapes[0].centroid)) if (
                item.box.center_m[2] > self._top_m(anchors[0]) - 0.01) else 9.0  # fmt: skip
        if relation == "before":
            return self._before_m(item, anchors[0], away[0])
        return min(away)

    def _top_m(self, anchor: str) -> float:
        return next((one.box.top_m for one in self.things if one.id == anchor), 0.0)

    def _before_m(self, item: Item, anchor: str, away_m: float) -> float:
        """From the middle of what stands before the front of a piece, or from an opening."""
        own = next((one for one in self.things if one.id == anchor), None)
        if own is None:
            return away_m
        ahead = np.array(item.box.center_m[:2]) - own.box.center_m[:2]
        front = front_direction(own.box.yaw_deg)
        beside = float(np.hypot(*(ahead - (ahead @ front) * front)))
        return away_m + beside if ahead @ front > 0 else 9.0

    # Places ---------------------------------------------------------------------------------------

    @cached_property
    def yaws(self) -> tuple[float, ...]:
        """The four directions of the room's longest side."""
        start, end = max(
            room_sides(self.room), key=lambda side: float(np.hypot(*np.subtract(*side)))
        )
        along = float(np.degrees(np.arctan2(*(end - start)[::-1])))
        return tuple(wrap_deg(round(along + turn, 6)) for turn in (0.0, 90.0, 180.0, 270.0))

    def places(self, item: Item) -> Iterator[Box]:
        """Where a thing may be tried, in a fixed order."""
        mount = category(item.category).mount
        yield from self._at_walls(item)
        if mount is Mount.WALL:
            return
        is_chair, is_flat = item.category == "chair", is_underfoot(item)
        for own in self.things:
            if own.room_id != self.room.id or category(own.category).mount is not Mount.FLOOR:
                continue
            if is_flat:
                yield self._at(item, own.box.center_m[:2], own.box.yaw_deg)
            elif own.category in TABLES or not is_chair:
                yield from self._beside(item, own)
        if item.category not in WALLED and not is_chair:
            yield from self._on_floor(item)

    def _at(self, item: Item, at_m: Sequence[float], yaw_deg: float) -> Box:
        center_m = (round(float(at_m[0]), 4), round(float(at_m[1]), 4), item.box.center_m[2])
        return replace(item.box, center_m=center_m, yaw_deg=wrap_deg(round(yaw_deg, 4)))

    def _at_walls(self, item: Item) -> Iterator[Box]:
        length_m, depth_m, _ = item.box.size_m
        gap_m = _HUNG_M if category(item.category).mount is Mount.WALL else OFF_WALL_M
        for start, end in room_sides(self.room):
            side = end - start
            side_m = float(np.hypot(*side))
            if side_m < max(_LEAST_SIDE_M, length_m):
                continue
            along = side / side_m
            inward = np.array([-along[1], along[0]])
            yaw_deg = float(np.degrees(np.arctan2(inward[0], -inward[1])))
            free_m = side_m - length_m - 2 * OFF_WALL_M
            for step in range(int(max(free_m, 0.0) / ALONG_M) + 2):
                from_m = min(step * ALONG_M, max(free_m, 0.0)) + OFF_WALL_M + length_m / 2
                yield self._at(
                    item, start + along * from_m + inward * (depth_m / 2 + gap_m), yaw_deg
                )

    def _beside(self, item: Item, anchor: Item) -> Iterator[Box]:
        """Along the four sides of a piece; chairs look at it, others as it does or away from it."""
        is_chair = item.category == "chair" and anchor.category in TABLES
        length_m, depth_m, _ = item.box.size_m
        front = front_direction(anchor.box.yaw_deg)
        right = np.array([-front[1], front[0]])
        middle = np.array(anchor.box.center_m[:2])
        for out, half_m, width_m in (
            (right, anchor.box.size_m[0] / 2, anchor.box.size_m[1]),
            (-right, anchor.box.size_m[0] / 2, anchor.box.size_m[1]),
            (front, anchor.box.size_m[1] / 2, anchor.box.size_m[0]),
            (-front, anchor.box.size_m[1] / 2, anchor.box.size_m[0]),
        ):
            outward_deg = float(np.degrees(np.arctan2(out[0], -out[1])))
            yaws = (
                [outward_deg + 180.0]
                if is_chair
                else [
                    anchor.box.yaw_deg,
                    outward_deg,
                    anchor.box.yaw_deg + 90,
                    anchor.box.yaw_deg - 90,
                ]
            )
            sideways = np.array([-out[1], out[0]])
            for yaw_deg in dict.fromkeys(round(wrap_deg(one), 4) for one in yaws):
                ahead = abs(float(front_direction(yaw_deg) @ out))
                reach_m = (depth_m if ahead > 0.7 else length_m) / 2
                gap_m = _CHAIR_M if is_chair else BESIDE_M
                steps = int(width_m / 2 / ALONG_M)
                for step in sorted(range(-steps, steps + 1), key=abs):
                    at_m = middle + out * (half_m + gap_m + reach_m) + sideways * (step * ALONG_M)
                    yield self._at(item, at_m, yaw_deg)

    def _on_floor(self, item: Item) -> Iterator[Box]:
        west, south, east, north = self.polygon.bounds
        for x_m in np.arange(west + GRID_M / 2, east, GRID_M):
            for y_m in np.arange(south + GRID_M / 2, north, GRID_M):
                for yaw_deg in self.yaws:
                    yield self._at(item, (x_m, y_m), yaw_deg)

    def free(self, item: Item, boxes: Collection[Box] | Iterator[Box]) -> Iterator[Item]:
        """The item at those of the places where nothing is in its way."""
        for box in boxes:
            placed = replace(item, box=box)
            if not self.in_the_way(placed):
                yield placed
