"""Where a piece may stand that somebody asked for: free places of a room, and how well they are
what was said. Metres.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import cast

import numpy as np
import shapely

from chord_usd.base.metrics.clear_floor import BEFORE_WINDOWS, clearances, sides_of
from chord_usd.base.metrics.complete import TABLES, WALLED
from chord_usd.base.metrics.footprints import is_underfoot
from chord_usd.base.metrics.fronts import FRONT, SWINGS_M, floor_before
from chord_usd.base.places.room_space import take_clearances, take_walls
from chord_usd.base.places.taken_space import Reason, TakenSpace
from chord_usd.base.places.tries import beside, over_floor, placed
from chord_usd.base.places.wall_frames import WallFace, faces_of, wall_frames
from chord_usd.base.scene.geometry import (
    Floors,
    footprint_polygon,
    room_polygon,
)
from chord_usd.base.scene.intents import (
    COMPASS_DEG,
    CORNER,
    DOOR,
    MIDDLE,
    SEEN_DEG,
    WALL,
    WINDOW,
    Relation,
    Way,
)
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.types import Box, FloatArray, Item, Opening, Room, SceneGraph

ALONG_M, GRID_M = 0.1, 0.3
"""Between places along a wall or a piece, and on the open floor."""

BESIDE_M = 0.04
"""Left between a piece and what it stands next to; its mesh may be a little larger than its box."""

OFF_WALL_M = 0.005
NEAR_M = {"by": 1.0, "before": 1.2, "between": 2.0, "above": 0.5, "under": 0.01,
          "behind": 1.2, "left of": 1.2, "right of": 1.2}  # fmt: skip
"""Farther from what a relation is to is not where it was asked for."""

_AT_WALL = 5.0
"""What goes to a wall that is named stands so many times nearer to it than by a piece."""
_HUNG_M = 0.001
_LEAST_SIDE_M = 0.3
_CHAIR_M = 0.02
_TOUCH_M2 = 1e-4


@dataclass(frozen=True, eq=False)
class Floor:
    """A room with what stands in it, to find places in."""

    graph: SceneGraph
    room: Room
    gone: frozenset[str] = frozenset()
    """Ids of things that do not count as obstacles."""

    @cached_property
    def things(self) -> list[Item]:
        """Possible obstacles: of all rooms, since open plans have no walls."""
        items = (*self.graph.items, *self.graph.dressing)
        return [item for item in items if item.id not in self.gone and not is_underfoot(item)]

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
    def _faces(self) -> tuple[WallFace, ...]:
        return faces_of(self.room, self.openings, Floors(self.graph.rooms))

    @cached_property
    def _taken(self) -> TakenSpace:
        taken = TakenSpace()
        for item in self.things:
            taken.add(item.box, "piece", item.id)
        clear = clearances(self.graph.rooms, self.graph.openings)
        seen = [opening for opening, ground in clear if ground.intersects(self.polygon)]
        take_clearances(taken, dict.fromkeys(seen))
        take_walls(taken, self._faces)
        return taken

    def obstacle_at(self, item: Item) -> str:
        """Name of the obstacle of a thing at its place; "" without one."""
        if not self._covering.covers(footprint_polygon(item.box)):
            return "the wall"
        if is_underfoot(item):
            return ""
        mount = category(item.category).mount
        ignoring = {*(() if mount is Mount.WALL else ("open",)),
                    *(("pane",) if mount in BEFORE_WINDOWS else ())}  # fmt: skip
        hit = self._taken.hit(item.box, ignoring)
        return self._named(*hit) if hit else ""

    def is_taken(self, item: Item) -> bool:
        """Whether a piece overlaps another."""
        hit = self._taken.hit(item.box, {"open", "pane", "clear"})
        return hit is not None and hit[0] == "piece"

    @cached_property
    def _swings(self) -> shapely.Geometry:
        """Floor over which doors, drawers and flaps of furniture swing."""
        floors = [footprint_polygon(floor_before(item.box, FRONT, 0.0, SWINGS_M[item.category]))
                  for item in self.things if item.category in SWINGS_M]  # fmt: skip
        return shapely.union_all(floors)

    def stops_leaves(self, item: Item) -> bool:
        """Whether a thing on the floor stands where furniture opens."""
        shape = footprint_polygon(item.box)
        return not is_underfoot(item) and shape.intersection(self._swings).area > _TOUCH_M2

    def _named(self, reason: Reason, owner: str) -> str:
        if reason == "open":
            return "the open side of the room"
        kinds = {opening.id: opening.kind for opening in self.graph.openings}
        if owner in kinds:
            return f"the way to a {kinds[owner]}" if reason == "clear" else f"a {kinds[owner]}"
        thing = next(thing for thing in self.things if thing.id == owner)
        return category(thing.category).label.lower()

    # Anchors --------------------------------------------------------------------------------------

    def shapes(self, anchors: Sequence[str]) -> list[shapely.Geometry]:
        """Of what a relation is to, seen from above; of windows, doors and walls all."""
        outlines: list[shapely.Geometry] = []
        by_id = {item.id: item for item in (*self.graph.items, *self.graph.dressing)}
        for anchor in anchors:
            if anchor == WALL:
                outlines.append(self.polygon.exterior)
            elif anchor.endswith(f" {WALL}"):
                sides = self._sides(cast(Way, anchor.removesuffix(f" {WALL}")))
                outlines += [shapely.MultiLineString(sides)] if sides else []
            elif anchor == CORNER:
                outlines.append(shapely.MultiPoint(self.room.polygon_m))
            elif anchor == MIDDLE:
                outlines.append(self.polygon.centroid)
            elif anchor in (WINDOW, DOOR):
                holes = [opening.box for opening in self.openings if (opening.kind == WINDOW)
                         == (anchor == WINDOW)]  # fmt: skip
                if holes:
                    outlines.append(shapely.union_all([footprint_polygon(box) for box in holes]))
            else:
                outlines.append(footprint_polygon(by_id[anchor].box))
        return outlines

    def _sides(self, way: Way) -> list[FloatArray]:
        """The walls of the room that somebody sees who looks this way."""
        corners = self.room.polygon_m
        turn = math.radians(COMPASS_DEG[way])
        ahead = np.array([math.cos(turn), math.sin(turn)])
        sides = np.roll(corners, -1, axis=0) - corners
        outwards = np.stack([sides[:, 1], -sides[:, 0]], axis=1)
        faced = outwards @ ahead > 0.9 * np.linalg.norm(sides, axis=1)
        return [np.stack([corners[at], corners[(at + 1) % len(corners)]])
                for at in np.flatnonzero(faced)]  # fmt: skip

    def misses_m(self, item: Item, relation: Relation, anchors: Sequence[str]) -> float:
        """How far a thing is from where a relation wants it."""
        shape, shapes = footprint_polygon(item.box), self.shapes(anchors)
        if not relation or not shapes:
            return 0.0
        away = [float(shape.distance(anchor)) for anchor in shapes]
        if relation == "between":
            return float(max(away))
        if relation == "under":
            return float(shape.centroid.distance(shapes[0].centroid))
        if relation == "above":
            return float(shape.centroid.distance(shapes[0].centroid)) if (
                item.box.center_m[2] > self._top_m(anchors[0]) - 0.01) else 9.0  # fmt: skip
        if relation == "by" and anchors[0].endswith(f" {WALL}"):
            return _AT_WALL * float(min(away))
        if relation in SEEN_DEG:
            return self._beside_m(item, anchors[0], away[0], SEEN_DEG[relation])
        return min(away)

    def _top_m(self, anchor: str) -> float:
        return next((item.box.top_m for item in self.things if item.id == anchor), 0.0)

    def _beside_m(self, item: Item, anchor: str, away_m: float, side_deg: float) -> float:
        """From the middle of a side of a piece, or from an opening. side_deg: as SEEN_DEG."""
        target = next((item for item in self.things if item.id == anchor), None)
        if target is None:
            return away_m
        ahead = np.array(item.box.center_m[:2]) - target.box.center_m[:2]
        turn = math.radians(side_deg + target.box.yaw_deg)
        way = np.array([math.cos(turn), math.sin(turn)])
        beside = float(np.hypot(*(ahead - (ahead @ way) * way)))
        return away_m + beside if ahead @ way > 0 else 9.0

    # Places ---------------------------------------------------------------------------------------

    def places(self, item: Item) -> Iterator[Box]:
        """Where a thing may be tried, in a fixed order."""
        mount, box = category(item.category).mount, item.box
        gap_m = _HUNG_M if mount is Mount.WALL else OFF_WALL_M
        for wall in wall_frames(self.room, _LEAST_SIDE_M):
            yield from wall.boxes(box.size_m, ALONG_M, box.center_m[2], gap_m)
        if mount is Mount.WALL:
            return
        is_chair, is_flat = item.category == "chair", is_underfoot(item)
        for other in self.things:
            if other.room_id != self.room.id or category(other.category).mount is not Mount.FLOOR:
                continue
            if is_flat:
                yield placed(box, other.box.center_m[:2], other.box.yaw_deg)
            elif is_chair and other.category in TABLES:
                yield from beside(box, other.box, _CHAIR_M, ALONG_M, looks_at_it=True)
            elif not is_chair:
                yield from beside(box, other.box, BESIDE_M, ALONG_M)
        if item.category not in WALLED and not is_chair:
            yield from over_floor(box, self.room, GRID_M)

    def free(self, item: Item, boxes: Collection[Box] | Iterator[Box]) -> Iterator[Item]:
        """The item at each of the places without an obstacle."""
        for box in boxes:
            placed = replace(item, box=box)
            if not self.obstacle_at(placed):
                yield placed
