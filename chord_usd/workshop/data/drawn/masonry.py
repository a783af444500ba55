"""A house as it is built on paper: walls of several thicknesses, chimney breasts, doors in corners.

Procedural houses have walls of one thickness and doors in the middle of them; real ones do not.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

from chord_usd.base.scene.geometry import footprint_polygon, polygons_of, room_polygon, room_sides
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    Box,
    FloatArray,
    Item,
    Opening,
    OpeningKind,
    Plan,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)
from chord_usd.workshop.data.drawn.labelled_canvas import rectangle
from chord_usd.workshop.data.drawn.page_looks import Look

_DEEPEST_M = 1.0
"""Twice as far as any wall reaches from its middle."""
_OVERLAP_M2 = 1e-4
"""Of a hole with a chimney breast, that comes of rounding."""


@dataclass(frozen=True, eq=False)
class Gap:
    """An opening as it is drawn."""

    opening: Opening
    """With the box as drawn."""
    shape: Polygon
    middle: FloatArray
    along: FloatArray
    """Unit vector along the wall; a leaf hangs at its start."""
    across: FloatArray
    """Unit vector to the side that a leaf opens to."""
    length_m: float
    depth_m: float
    is_outer: bool

    @property
    def kind(self) -> OpeningKind:
        """Door, window or passage."""
        return self.opening.kind


@dataclass(frozen=True, eq=False)
class Masonry:
    """A furnished storey."""

    house: BaseGeometry
    """All within the outer faces of the outer walls."""
    rooms: tuple[tuple[RoomKind, Polygon], ...]
    """Between the faces of the walls."""
    walls: BaseGeometry
    """Without the openings."""
    inner_walls: BaseGeometry
    masses: BaseGeometry
    """Chimney breasts, columns and shafts, parts of the walls."""
    gaps: tuple[Gap, ...]
    items: tuple[Item, ...]

    def plan(self) -> Plan:
        """As vectors; rooms of an open plan touch."""
        rooms = tuple(
            Room(f"room{index + 1}", kind, frozen_array(orient(area).exterior.coords[:-1]))
            for index, (kind, area) in enumerate(self.rooms)
        )
        return Plan(rooms, tuple(gap.opening for gap in self.gaps))


def build(scene: SceneGraph, look: Look, rng: np.random.Generator) -> Masonry:
    """Walls and openings of a furnished house, as a look has them."""
    grown = _grown_rooms(scene.rooms, look, rng)
    floors = shapely.union_all(grown)
    house = _house(scene.rooms, floors, look)
    masses = _masses(scene, look, rng)
    walls = house.difference(floors.difference(masses))
    core = house.buffer(-(look.outer_wall_m + 1e-3), join_style="mitre")
    before_walls = masses.intersection(floors)
    gaps: list[Gap] = []
    for opening in scene.openings:
        shifts = look.corner_doors if opening.kind == "door" else 0.0
        shift = _shift_to_corner(opening.box, scene.rooms, rng) if rng.random() < shifts else 0.0
        # Where another opening is already, a door stays in its place.
        for moved in dict.fromkeys((shift, 0.0)):
            gap = _gap(opening, moved, walls, rng)
            if gap is None or gap.shape.intersection(before_walls).area > _OVERLAP_M2:
                continue
            if not any(gap.shape.intersects(other.shape) for other in gaps):
                gaps.append(gap)
                break
    holes = shapely.union_all([gap.shape.buffer(1e-4, join_style="mitre") for gap in gaps])
    body = walls.difference(holes)
    kept = tuple(item for item in scene.items if not footprint_polygon(item.box).intersects(masses))
    rooms = _rooms_as_drawn(scene.rooms, grown, masses)
    return Masonry(house, rooms, body, body.intersection(core), masses, tuple(gaps), kept)


def _grown_rooms(rooms: tuple[Room, ...], look: Look, rng: np.random.Generator) -> list[Polygon]:
    """Rooms up to the faces of thinner walls; some walls stay thick."""
    full = (WALL_THICKNESS_M - look.inner_wall_m) / 2
    grown = []
    for room in rooms:
        share = 0.2 if rng.random() < look.thick_rooms else 1.0
        grown.append(room_polygon(room).buffer(full * share, join_style="mitre"))
    return grown


def _rooms_as_drawn(
    rooms: tuple[Room, ...], grown: list[Polygon], masses: BaseGeometry
) -> tuple[tuple[RoomKind, Polygon], ...]:
    """Rooms of an open plan do not overlap: each ends where the next was grown before it."""
    drawn_rooms: list[tuple[RoomKind, Polygon]] = []
    taken: BaseGeometry = masses
    for room, area in zip(rooms, grown, strict=True):
        parts = polygons_of(area.difference(taken))
        taken = taken.union(area)
        if parts:
            largest = max(parts, key=lambda part: part.area)
            drawn_rooms.append((room.kind, Polygon(largest.exterior)))
    return tuple(drawn_rooms)


def _house(rooms: tuple[Room, ...], floors: BaseGeometry, look: Look) -> BaseGeometry:
    """Rooms and walls; balconies have a rail in place of an outer wall where the look says so."""
    railed = [room for room in rooms if room.kind == "balcony" and look.has_rails]
    within = [room_polygon(room) for room in rooms if room not in railed]
    near = WALL_THICKNESS_M / 2 + 0.03
    closed = shapely.union_all(within).buffer(near, join_style="mitre")
    closed = closed.buffer(-near, join_style="mitre")
    grow = (WALL_THICKNESS_M - look.inner_wall_m) / 2
    house = closed.buffer(look.outer_wall_m + grow, join_style="mitre").union(floors)
    for room in railed:
        house = house.union(room_polygon(room).buffer(grow + look.rail_m, join_style="mitre"))
    # Gaps between a rail and the house, too narrow to be anything.
    return house.buffer(0.07, join_style="mitre").buffer(-0.07, join_style="mitre")


def _masses(scene: SceneGraph, look: Look, rng: np.random.Generator) -> BaseGeometry:
    """Solid parts that reach from walls into rooms, clear of openings."""
    ways = shapely.union_all([footprint_polygon(o.box).buffer(0.35) for o in scene.openings])
    masses: list[BaseGeometry] = []
    for room in scene.rooms:
        if room.kind == "balcony" or rng.random() >= look.masses:
            continue
        sides = room_sides(room)
        start, stop = sides[int(rng.integers(len(sides)))]
        length = float(np.hypot(*(stop - start)))
        if length < 0.5:
            continue
        along = (stop - start) / length
        inward = np.array([-along[1], along[0]])
        wide, deep = rng.uniform(0.25, 0.5, 2)
        if rng.random() < 0.5:  # a chimney breast
            wide = rng.uniform(0.8, 1.7)
        wide = min(float(wide), 0.9 * length)
        where = (wide / 2) / length if rng.random() < 0.4 else rng.uniform(0.1, 0.9)
        middle = start + along * where * length + inward * (deep / 2 - WALL_THICKNESS_M / 2)
        mass = rectangle(middle, along, wide, deep + WALL_THICKNESS_M * 0.9)
        within = mass.intersection(room_polygon(room).buffer(0.1, join_style="mitre"))
        if not mass.intersects(ways) and within.area > 0.5 * mass.area:
            masses.append(within)
    return shapely.union_all(masses)


# Openings ----------------------------------------------------------------------------------------


def _gap(
    opening: Opening, shift_m: float, walls: BaseGeometry, rng: np.random.Generator
) -> Gap | None:
    """An opening, moved along its wall, cut through it; None where there is no wall."""
    along = _direction(opening.box)
    middle = np.array(opening.box.center_m[:2]) + along * shift_m
    length = opening.box.size_m[0]
    cut = rectangle(middle, along, length, _DEEPEST_M).intersection(walls)
    spot = Point(*middle)
    parts = [part for part in polygons_of(cut) if part.distance(spot) < 0.05]
    if not parts:
        return None
    across = np.array([-along[1], along[0]])
    corners = np.array(max(parts, key=lambda part: part.area).exterior.coords)
    reach = (corners - middle) @ across
    depth = float(np.ptp(reach))
    middle = middle + across * (reach.min() + depth / 2)
    if not 0.01 < depth < 0.8:
        return None
    shape = rectangle(middle, along, length, depth)
    box = Box(
        (float(middle[0]), float(middle[1]), opening.box.center_m[2]),
        (length, depth, opening.box.size_m[2]),
        opening.box.yaw_deg,
    )
    flip_along, flip_across = rng.choice([-1.0, 1.0], 2)
    return Gap(
        replace(opening, box=box), shape, middle, along * flip_along, across * flip_across,
        length, depth, len(opening.room_ids) < 2,
    )  # fmt: skip


def _direction(box: Box) -> FloatArray:
    angle = math.radians(box.yaw_deg)
    return np.array([math.cos(angle), math.sin(angle)])


def _shift_to_corner(box: Box, rooms: tuple[Room, ...], rng: np.random.Generator) -> float:
    """How far a door can go along its wall, to one end or the other, metres."""
    along = _direction(box)
    middle = np.array(box.center_m[:2])
    across = np.array([-along[1], along[0]])
    free = np.array([-4.0, 4.0])
    for side in (-1.0, 1.0):
        place = middle + across * side * (box.size_m[1] / 2 + 0.05)
        line = LineString([place - along * 4.0, place + along * 4.0])
        for room in rooms:
            area = room_polygon(room)
            if not area.covers(Point(*place)):
                continue
            pieces = area.intersection(line)
            for piece in getattr(pieces, "geoms", [pieces]):
                reach = (np.array(piece.coords) - place) @ along
                if reach.min() <= 0.0 <= reach.max():
                    free = np.array([max(free[0], reach.min()), min(free[1], reach.max())])
    half = box.size_m[0] / 2 + rng.choice([0.0, 0.03, 0.1])
    low, high = float(min(0.0, free[0] + half)), float(max(0.0, free[1] - half))
    return low if rng.random() < 0.5 else high
