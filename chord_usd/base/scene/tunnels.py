"""The solid of a house's walls and the holes that openings cut through it. Shapely only.

A hole goes straight through its wall, seen from above; its open ends lie on the wall's two faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import numpy.typing as npt
import shapely
from shapely.geometry import LineString, MultiPolygon, Polygon, box
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import polygons_of, resized, room_polygon, to_own, wall_area
from chord_usd.base.scene.types import ROOM_HEIGHT_M, WALL_THICKNESS_M, FloatArray, Opening, Room
from chord_usd.base.scene.units import rotation_2d

LINTEL_M = 0.1
"""Least height of wall left over an opening, so that the solid stays one."""

ObjectArray = npt.NDArray[np.object_]

GRID_M = 1e-4
"""Corners are rounded to this, which makes the boolean operations exact and repeatable."""

ON_LINE_M = 2e-3
"""Points nearer to a line than this lie on it."""

SLIT_M = 0.02
"""Walls thinner than this are gaps between rooms that should touch, not walls."""

_SHAFT_M2 = 0.5
"""Voids between walls smaller than this are filled."""

_HOLLOW_M = 0.6
"""So are those narrower than this: the wall between two rooms is as thick as they are apart."""

_SLIVER_M2 = 0.01
"""What is smaller is no void, but a corner that was rounded off."""

_REACH_M = 0.15
"""How far beyond its own depth an opening looks for the two faces of its wall."""

_FEW_STRIPS = 8
"""So many openings may go through the same part of the walls, one after the other."""


@dataclass(frozen=True, eq=False)
class Tunnel:
    """The hole that one opening cuts through the walls."""

    opening: Opening
    area_m: Polygon
    """Seen from above; counter-clockwise. Its open ends lie on the boundary of the walls."""
    low_m: float
    high_m: float
    is_end: tuple[bool, ...]
    """Of each edge of area_m: whether one passes through it (True) or it is a jamb (False)."""

    def edges_m(self) -> list[tuple[FloatArray, FloatArray]]:
        """(start, end) of each edge of area_m, in order."""
        ring = np.asarray(self.area_m.exterior.coords)
        return list(pairwise(ring))

    def ends_m(self) -> list[tuple[FloatArray, FloatArray]]:
        """The edges that one passes through."""
        return [edge for edge, end in zip(self.edges_m(), self.is_end, strict=True) if end]


def wall_solid(rooms: Sequence[Room]) -> MultiPolygon:
    """The walls between and around rooms, seen from above."""
    if not rooms:
        return MultiPolygon()
    area = wall_area(rooms)
    half = SLIT_M / 2
    area = area.buffer(-half, join_style="mitre").buffer(half, join_style="mitre")
    floors = unary_union([room_polygon(room) for room in rooms])
    whole = unary_union([area, floors])
    shafts = [
        Polygon(ring)
        for part in polygons_of(whole)
        for ring in part.interiors
        if SLIT_M**2 < Polygon(ring).area < _SHAFT_M2
    ]
    closed = whole.buffer(_HOLLOW_M / 2, join_style="mitre")
    closed = closed.buffer(-_HOLLOW_M / 2, join_style="mitre")
    hollows = [part for part in polygons_of(closed.difference(whole)) if part.area > _SLIVER_M2]
    filled = unary_union([area, *shafts, *hollows]).difference(floors)
    solid = shapely.set_precision(filled, GRID_M)
    return MultiPolygon([orient(part) for part in polygons_of(solid) if part.area > GRID_M])


def as_cut(rooms: Sequence[Room], openings: Sequence[Opening]) -> list[Opening]:
    """The openings as the holes that they cut: as wide, less where a wall ends before them, and as
    deep as the wall there is, whatever was read."""
    dug = dig_tunnels(openings, wall_solid(rooms))
    return [
        opening if tunnel is None else _as_hole(opening, tunnel)
        for opening, tunnel in zip(openings, dug, strict=True)
    ]


def _as_hole(opening: Opening, tunnel: Tunnel) -> Opening:
    ends = [to_own(opening.box, edge) for edge in tunnel.ends_m()]
    # A file may put its openings in the middle of a wall that is thicker than here.
    across = [float(end[:, 1].mean()) for end in ends]
    middle_y = (min(across) + max(across)) / 2 if len(ends) > 1 else 0.0
    fronts = [float(e[:, 1].max()) for e, y in zip(ends, across, strict=True) if y < middle_y]
    backs = [float(e[:, 1].min()) for e, y in zip(ends, across, strict=True) if y >= middle_y]
    along = to_own(opening.box, shapely.get_coordinates(tunnel.area_m))[:, 0]
    left, right = float(along.min()), float(along.max())
    half = opening.box.size_m[1] / 2
    front, back = max(fronts, default=-half), min(backs, default=half)
    if back <= front:
        front, back = -half, half
    sides, middle = (right - left, back - front), ((left + right) / 2, (front + back) / 2)
    size_m = opening.box.size_m
    if np.allclose((*sides, *middle), (*size_m[:2], 0.0, 0.0), rtol=0.0, atol=ON_LINE_M):
        return opening
    return replace(opening, box=resized(opening.box, sides, middle))


def dig_tunnels(openings: Sequence[Opening], solid: MultiPolygon) -> list[Tunnel | None]:
    """What each opening takes out of the walls; None for those that meet no wall."""
    strips = np.array([_strip(opening, reach_m(opening)) for opening in openings], object)
    around = _walls_around(strips, solid)
    return [_tunnel(*each) for each in zip(openings, strips, around, strict=True)]


def _walls_around(strips: ObjectArray, solid: MultiPolygon) -> ObjectArray:
    """For each strip a part of the walls that goes on around it.

    The house is halved until few strips are left, so that not every one goes through all of it.
    """
    around = np.full(len(strips), solid, object)
    if len(strips) <= _FEW_STRIPS:
        return around
    middles = shapely.get_coordinates(shapely.centroid(strips))
    order = np.argsort(middles[:, np.ptp(middles, axis=0).argmax()])
    for half in np.array_split(order, 2):
        west, south, east, north = shapely.total_bounds(strips[half])
        region = box(west - _REACH_M, south - _REACH_M, east + _REACH_M, north + _REACH_M)
        part = MultiPolygon(polygons_of(solid.intersection(region)))
        around[half] = _walls_around(strips[half], part)
    return around


def reach_m(opening: Opening) -> float:
    """How far from its middle line an opening looks for the faces of its wall."""
    return max(opening.box.size_m[1], WALL_THICKNESS_M) / 2 + _REACH_M


def _strip(opening: Opening, reach: float) -> BaseGeometry:
    half = opening.box.size_m[0] / 2
    return _in_world(box(-half, -reach, half, reach), opening)


def _tunnel(opening: Opening, strip: BaseGeometry, solid: BaseGeometry) -> Tunnel | None:
    """What the opening takes out of its wall, straight through along its own y."""
    length, _, height = opening.box.size_m
    reach = reach_m(opening)
    parts = polygons_of(shapely.set_precision(strip.intersection(solid), GRID_M))
    if not parts:
        return None
    clear = [strip.difference(_blocked(opening, solid, reach, side)) for side in (-1.0, 1.0)]
    through = shapely.intersection_all([*clear, solid])
    parts = [p for p in polygons_of(through) if p.area > 0.2 * length * SLIT_M] or parts
    centre = shapely.Point(opening.box.center_m[:2])
    best = min(parts, key=lambda part: (round(part.distance(centre), 3), -part.area))
    area = orient(shapely.set_precision(best, GRID_M))
    low = _on_grid(max(0.0, opening.box.center_m[2]))
    high = _on_grid(min(low + height, ROOM_HEIGHT_M - LINTEL_M))
    if not isinstance(area, Polygon) or area.is_empty or high <= low:
        return None
    boundary = solid.boundary
    ring = np.asarray(area.exterior.coords)
    middles = shapely.points((ring[:-1] + ring[1:]) / 2)
    is_end = tuple(bool(near) for near in shapely.distance(middles, boundary) < ON_LINE_M)
    return Tunnel(opening, area, low, high, is_end)


def _on_grid(height_m: float) -> float:
    return round(height_m / GRID_M) * GRID_M


def _blocked(opening: Opening, solid: BaseGeometry, reach: float, side: float) -> BaseGeometry:
    """The part of the opening's strip whose far side (own y = side * reach) is still wall.

    There a wall runs crosswise; digging on would only scratch it.
    """
    half = opening.box.size_m[0] / 2
    far = _in_world(LineString([(-half, side * reach), (half, side * reach)]), opening)
    turn = rotation_2d(opening.box.yaw_deg)
    centre = np.array(opening.box.center_m[:2])
    blocked = []
    for piece in shapely.get_parts(far.intersection(solid)):
        if piece.is_empty:
            continue
        along = (np.asarray(piece.coords) - centre) @ turn[:, 0]
        blocked.append(_in_world(box(along.min(), -reach, along.max(), reach), opening))
    return unary_union(blocked)


def _in_world(shape: BaseGeometry, opening: Opening) -> BaseGeometry:
    turn = rotation_2d(opening.box.yaw_deg)
    centre = np.array(opening.box.center_m[:2])
    return shapely.transform(shape, lambda points: points @ turn.T + centre)
