"""What stairs are drawn from: flights, landings, handrails, and the railings around their holes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from chord_usd.base.scene.geometry import to_world
from chord_usd.base.scene.stair_forms import BuiltStair
from chord_usd.base.scene.stair_spirals import POLE_M, RIM_M, SPIRAL_THICK_M, is_round
from chord_usd.base.scene.storeys import Flight, Tread
from chord_usd.base.scene.types import Box, FloatArray
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.shell.mesh import Face, cuboid, moved, prism, standing
from chord_usd.line.stage.shell.railings import railing_faces
from chord_usd.line.stage.shell.winder_parts import (
    newel_faces,
    outer_rail,
    tapered,
    tread_faces,
    tread_hull,
)

GUARD_M = 1.0
"""Height of a railing around a hole over the floor."""

_WAIST_M = 0.16
"""Of a flight, straight down from the inner corner of a step."""

_LANDING_M = 0.2
_RAIL_M = 0.9
"""Height of a handrail over the noses of the steps."""

_GRIP_M = (0.045, 0.05)
"""Width and height of a handrail."""

_FROM_SIDE_M = 0.06
"""From the side of a flight to the middle of its rail."""

_BAR_M = 0.014
_POST_M = 0.05
_GUARD_FOOT_M = 0.07
"""Between the floor and where a railing's frame begins."""

_GUARD_IN_M = 0.04
"""A railing stands this far over its hole, off the floor that one walks on."""

_ON_WALL = 0.02
"""Share of the last step that a wall lies under, at least, where it is cut for it."""

_LEAST_FLIGHT_M = 0.01
"""A shorter flight has no steps: one steps from the floor onto the turn, or off it."""

_EVEN_M = 0.01
_BOX = 0.999
"""Share of its bounds that a rectangle fills."""

_GUARD_OUT_M = 0.03
"""The railing around a round hole stands this far off it on the floor, since treads end at it."""

_BEND_DEG = 30.0
"""Railings go on over smaller bends without a post."""

_COARSE_M = 0.02
"""How far the colliders of a round railing may be off it."""

_LEAST_GUARD_M = 0.12
"""A gap no wider needs no railing."""


@dataclass(frozen=True, eq=False)
class StairPart:
    """One mesh of a stair, in the storey's frame."""

    name: str
    faces: Sequence[Face]
    surface: str
    """Row of surfaces.PLAIN_SURFACES, or "Floor" for the look of the room."""


def stair_parts(built: BuiltStair, walls: BaseGeometry) -> list[StairPart]:
    """Steps and handrails of a stair. walls: where walls stand around it, seen from above."""
    steps: list[Face] = []
    rails: list[Face] = []
    if built.is_spiral:
        rails = pole_faces(built)
        rails += outer_rail(built, walls, _FROM_SIDE_M, _RAIL_M, _GRIP_M, _BAR_M)
        steps = list(spiral_tread_faces(built))
        return [
            StairPart("Steps", _in_storey(built, steps), "Floor"),
            StairPart("Handrail", _in_storey(built, rails), "Metal"),
        ]
    for flight in (straight for straight in built.flights if straight.length_m > _LEAST_FLIGHT_M):
        steps += _in_storey(
            built, _flight_faces(built, flight, lifted=_ends_over_wall(built, flight, walls))
        )
        for side in (-1, 1):
            walled = _is_walled(built, flight, side, walls)
            rails += _in_storey(built, _rail_faces(built, flight, side, walled=walled))
    for tread in tapered(built):
        steps += _in_storey(built, tread_faces(tread, built.rise_m, _WAIST_M))
    for tread in built.treads:
        if tread.is_landing:
            steps += _in_storey(built, prism(tread.area_m, tread.top_m - _LANDING_M, tread.top_m))
    if tapered(built):
        turned = newel_faces(built, _FROM_SIDE_M, _RAIL_M)
        turned += outer_rail(built, walls, _FROM_SIDE_M, _RAIL_M, _GRIP_M, _BAR_M)
        rails += _in_storey(built, turned)
    return [StairPart("Steps", steps, "Floor"), StairPart("Handrail", rails, "Metal")]


def stair_boxes(built: BuiltStair) -> list[Box]:
    """What one steps on and is rectangular, as upright boxes in the storey's frame."""
    boxes = []
    for tread in filter(_is_box, built.treads):
        west, south, east, north = tread.area_m.bounds
        low = 0.0 if tread.top_m < 2 * built.rise_m - 1e-6 else tread.top_m - built.rise_m - 0.02
        x, y = to_world(built.stair.box, ((west + east) / 2, (south + north) / 2))
        size_m = (east - west, north - south, tread.top_m - low)
        boxes.append(Box((float(x), float(y), low), size_m, built.stair.box.yaw_deg))
    return boxes


def stair_hulls(built: BuiltStair) -> list[Sequence[Face]]:
    """What else one steps on, as solids whose hulls bear one, in the storey's frame."""
    return [
        _in_storey(built, tread_hull(built, tread)) for tread in built.treads if not _is_box(tread)
    ]


def _is_box(tread: Tread) -> bool:
    return tread.edges_m is None and tread.area_m.area > _BOX * tread.area_m.envelope.area


def guard_lines(hole: Polygon, walls: BaseGeometry, ways: Sequence[LineString]) -> list[FloatArray]:
    """(N, 2) corners of the railings around a hole in a floor: where neither a wall stands nor one
    of the ways over its edge is. The hole lies to their left; only round holes give more than two
    corners."""
    ring = shapely.geometry.polygon.orient(hole).exterior
    beside_m = RIM_M + 0.03 if is_round(hole.convex_hull) else 0.03
    blocked = shapely.union_all([walls.buffer(beside_m), *(way.buffer(0.03) for way in ways)])
    chains: list[FloatArray] = []
    for start, end in pairwise(np.asarray(ring.coords)):
        free = LineString([start, end]).difference(blocked)
        for piece in shapely.get_parts(free) if not free.is_empty else ():
            corners = np.asarray(piece.coords)
            if chains and _goes_on(chains[-1], corners):
                chains[-1] = np.vstack([chains[-1], corners[1:]])
            else:
                chains.append(corners)
    if len(chains) > 1 and _goes_on(chains[-1], chains[0]):
        chains[0] = np.vstack([chains.pop(), chains[0][1:]])
    return [chain for chain in chains if LineString(chain).length > _LEAST_GUARD_M]


def _goes_on(chain: FloatArray, piece: FloatArray) -> bool:
    """Whether a piece begins where a chain ends, and bends little there."""
    before, after = chain[-1] - chain[-2], piece[1] - piece[0]
    bend = np.arctan2(before[0] * after[1] - before[1] * after[0], before @ after)
    return bool(np.hypot(*(chain[-1] - piece[0])) < 1e-6 and abs(np.degrees(bend)) < _BEND_DEG)


def guard_part(line: FloatArray) -> tuple[StairPart, list[Box]]:
    """A railing along a line (N, 2), with posts at its ends, and its colliders; in the storey's
    frame. One of more than two corners stands off the hole, others over it."""
    is_straight = len(line) == 2
    aside_m = _GUARD_IN_M if is_straight else -_GUARD_OUT_M
    pieces = list(pairwise(line))
    faces: list[Face] = []
    for index, (start, end) in enumerate(pieces):
        place = _beside(start, end, aside_m)
        half = place.size_m[0] / 2
        panel = moved(railing_faces(-half, half, 0.0), np.eye(2), (0.0, 0.0, _GUARD_FOOT_M))
        posts = [-half] * (index == 0) + [half - _POST_M] * (index == len(pieces) - 1)
        for post in posts:
            panel += cuboid((post, -_POST_M / 2, 0.0), (post + _POST_M, _POST_M / 2, GUARD_M))
        faces += moved(panel, rotation_2d(place.yaw_deg), (*place.center_m[:2], 0.0))
    coarse = np.asarray(LineString(line).simplify(_COARSE_M).coords)
    boxes = [_beside(start, end, aside_m) for start, end in pairwise(coarse)]
    return StairPart("Railing", faces, "Metal"), boxes


def _beside(start: FloatArray, end: FloatArray, aside_m: float) -> Box:
    """What a railing from one place to another takes up, moved to its left."""
    along = (end - start) / np.hypot(*(end - start))
    x, y = (start + end) / 2 + np.array([-along[1], along[0]]) * aside_m
    yaw_deg = float(np.degrees(np.arctan2(along[1], along[0])))
    size_m = (float(np.hypot(*(end - start))), _POST_M, GUARD_M)
    return Box((float(x), float(y), 0.0), size_m, yaw_deg)


def floor_boxes(floor: Box, holes: Sequence[Polygon], yaw_deg: float) -> Iterator[Box]:
    """A slab around holes, as boxes. yaw_deg: the direction in which the holes' sides run; of a
    round one its square is left out."""
    turn = rotation_2d(-yaw_deg)
    cut_out = [Polygon(np.asarray(hole.exterior.coords) @ turn.T) for hole in holes]
    cut_out = [hole.envelope if is_round(hole) else hole for hole in cut_out]
    rings = [np.asarray(hole.exterior.coords) for hole in cut_out]
    length, width, height = floor.size_m
    corners = to_world(floor, [[-length / 2, -width / 2], [length / 2, -width / 2],
                               [length / 2, width / 2], [-length / 2, width / 2]])  # fmt: skip
    area = Polygon(corners @ turn.T)
    cuts = np.vstack([*rings, np.asarray(area.exterior.coords)])
    xs, ys = (_distinct(cuts[:, axis]) for axis in (0, 1))
    for low, high in pairwise(ys):
        run: list[float] = []
        for left, right in [*pairwise(xs), (xs[-1], xs[-1])]:
            middle = shapely.Point((left + right) / 2, (low + high) / 2)
            solid = (
                right > left and area.covers(middle) and not any(o.covers(middle) for o in cut_out)
            )
            if solid:
                run = [run[0] if run else left, right]
            elif run:
                x, y = np.array([(run[0] + run[1]) / 2, (low + high) / 2]) @ turn
                size_m = (run[1] - run[0], high - low, height)
                yield Box((float(x), float(y), floor.center_m[2]), size_m, yaw_deg)
                run = []


def _distinct(values: FloatArray) -> list[float]:
    kept: list[float] = []
    for value in np.sort(values):
        if not kept or value - kept[-1] > 1e-3:
            kept.append(float(value))
    return kept


def _in_storey(built: BuiltStair, faces: Sequence[Face]) -> list[Face]:
    x, y, _ = built.stair.box.center_m
    return moved(faces, rotation_2d(built.stair.box.yaw_deg), (x, y, 0.0))


def _in_flight(flight: Flight, faces: Sequence[Face]) -> list[Face]:
    """Faces drawn with x along a flight, y to its left."""
    ux, uy = flight.ahead
    return moved(faces, np.array([[ux, -uy], [uy, ux]], float), (*flight.start_m, 0.0))


def _ends_over_wall(built: BuiltStair, flight: Flight, walls: BaseGeometry) -> bool:
    """Whether the last step of a stair lies on a wall of the lower storey."""
    last = built.treads[-1]
    if flight is not built.flights[-1] or last.top_m <= built.ceiling_m:
        return False
    area = _world_area(built, last)
    return bool(walls.intersection(area).area > _ON_WALL * area.area)


def _flight_faces(built: BuiltStair, flight: Flight, *, lifted: bool) -> list[Face]:
    """Steps and what carries them, in the stair's frame. lifted: whether the last step has nothing
    below the ceiling."""
    count = round((flight.high_m - flight.low_m) / built.rise_m) - 1
    going, rise, low = flight.length_m / count, built.rise_m, flight.low_m
    profile = [(0.0, low)]
    for index in range(count):
        top = low + (index + 1) * rise
        profile += [(index * going, top), ((index + 1) * going, top)]
    thick = _WAIST_M if tapered(built) else _LANDING_M
    foot = low - (0.0 if low == 0.0 else thick)
    bend = float(np.clip((foot - low + _WAIST_M) * going / rise, 0.0, flight.length_m))
    if lifted:
        before = flight.length_m - going
        profile += [(flight.length_m, built.ceiling_m), (before, built.ceiling_m)]
        profile += [(before, low + (count - 1) * rise - _WAIST_M), (bend, foot)]
    else:
        profile += [(flight.length_m, low + count * rise - _WAIST_M), (bend, foot)]
    profile += [(0.0, foot)] if bend > 1e-6 and foot < low else []
    half = flight.width_m / 2
    return _in_flight(flight, standing(prism(Polygon(profile), -half, half)))


def _rail_faces(built: BuiltStair, flight: Flight, side: int, *, walled: bool) -> list[Face]:
    """A handrail; where no wall holds it, with a bar on each step. side: 1 is to the left."""
    count = round((flight.high_m - flight.low_m) / built.rise_m) - 1
    going, rise = flight.length_m / count, built.rise_m
    wide, high = _GRIP_M
    at = side * (flight.width_m / 2 - _FROM_SIDE_M)

    def under(along: float) -> float:
        return flight.low_m + rise + along / going * rise + _RAIL_M - high

    ends = (0.0, flight.length_m)
    bar = Polygon([(x, under(x)) for x in ends] + [(x, under(x) + high) for x in ends[::-1]])
    faces = standing(prism(bar, -at - wide / 2, -at + wide / 2))
    if not walled:
        for index in range(count):
            x = (index + 0.5) * going
            top = flight.low_m + (index + 1) * rise - 0.005
            low = (x - _BAR_M / 2, at - _BAR_M / 2, top)
            faces += cuboid(low, (x + _BAR_M / 2, at + _BAR_M / 2, under(x) + 0.005))
    return _in_flight(flight, faces)


def _is_walled(built: BuiltStair, flight: Flight, side: int, walls: BaseGeometry) -> bool:
    (x, y), (ux, uy) = flight.start_m, flight.ahead
    out = side * (flight.width_m / 2 + 0.1)
    points = [
        (x + ux * along - uy * out, y + uy * along + ux * out)
        for along in np.linspace(0.1, 0.9, 5) * flight.length_m
    ]
    inside = shapely.contains_xy(walls, to_world(built.stair.box, points))
    return bool(inside.mean() > 0.5)


def open_landing_sides(
    built: BuiltStair, walls: BaseGeometry
) -> Iterator[tuple[FloatArray, float]]:
    """(2, 2) ends of the sides of landings over which one could fall, and the landings' heights."""
    for tread in built.treads:
        if tread.is_landing and tread.top_m < built.height_m - _EVEN_M:
            others = [_world_area(built, other) for other in built.treads if other is not tread]
            around = shapely.union_all([walls, *others])
            for line in guard_lines(_world_area(built, tread), around, ()):
                if np.hypot(*(line[1] - line[0])) > 2 * _LEAST_GUARD_M:
                    yield line, tread.top_m


def _world_area(built: BuiltStair, tread: Tread) -> Polygon:
    return Polygon(to_world(built.stair.box, np.asarray(tread.area_m.exterior.coords)))


# What a spiral stair is drawn from: treads with risers, the landing, the pole --------------------

# Everything is in the stair's own frame. Its handrail is that of a winder's turn, along the rim.

_RISER_M = 0.02
_SAME_M = 1e-3
_OVER_LANDING_M = 1.0
"""How much higher the pole is than the landing: as high as the railing around the hole."""


def spiral_tread_faces(built: BuiltStair) -> Iterator[Face]:
    """Treads, each on a riser that stands on the one below, and the landing."""
    for tread in built.treads:
        low_m = tread.top_m - SPIRAL_THICK_M
        yield from prism(tread.area_m, low_m, tread.top_m)
        if tread.edges_m is not None:
            edge = tread.edges_m[0].buffer(_RISER_M, cap_style="flat")
            riser = shapely.remove_repeated_points(edge.intersection(tread.area_m), _SAME_M)
            closed = prism(riser, tread.top_m - built.rise_m, low_m)
            # Its ends lie on treads; drawings would take the upper one for a step.
            yield from (face for face in closed if np.ptp(face.corners_m[:, 2]) > 0.0)


def pole_faces(built: BuiltStair) -> list[Face]:
    """The pole, from the floor to over the landing."""
    pole = Point(0.0, 0.0).buffer(POLE_M, quad_segs=8)
    return prism(pole, 0.0, built.height_m + _OVER_LANDING_M)
