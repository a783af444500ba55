"""The planes of a roof over an outline whose walls meet at right angles.

A roof of equal slopes rises over each eave by the distance from it, as far as no other eave is
nearer. Distance is the larger of those along the two directions that walls run in: so the borders
between planes are hips, valleys and ridges, as over a straight skeleton, courtyards included.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
import shapely
from shapely.affinity import rotate
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.roof_forms import NO_ROOF, RoofForm
from chord_usd.base.scene.types import FloatArray
from chord_usd.base.scene.units import rotation_2d

OVERHANG_M = 0.4
_FLAT_OVERHANG_M = 0.25

_SLOPE = float(np.tan(np.radians(30.0)))

_OFFSET_M = 0.3
"""Eaves that lie so near to one line become one."""

_CLOSED_M = 0.05
"""Gaps of the outline up to twice this are none."""

_SLANT_M = 0.05
"""A wall that leans by less over its length is straight."""

_SAME_M = 1e-6
_GRID_M = 1e-4
"""Of eaves."""

_FINE_M = 1e-6
"""Of the corners between planes."""

_LEAST_M2 = 1e-4


@dataclass(frozen=True, eq=False)
class RoofPlane:
    """One plane of a roof, seen from above."""

    area_m: Polygon
    inward: FloatArray
    """(2,) unit vector, level, in which it rises."""
    eave_m: float
    """Where it begins: dot product of a point of the eave with inward."""
    slope: float
    """Metres up for each metre inwards; 0 is flat."""
    foot_m: float
    """Height of its underside at the eave, over the top of the walls."""

    def heights_m(self, points_m: FloatArray) -> FloatArray:
        """(N,) heights of its underside at points (N, 2), over the top of the walls."""
        ahead: FloatArray = np.asarray(points_m)[:, :2] @ self.inward - self.eave_m
        return self.foot_m + self.slope * ahead


def roof_planes(outline: BaseGeometry, form: RoofForm) -> list[RoofPlane]:
    """The planes over what the walls enclose, eaves beyond it included; none for no roof.

    outline: of the outer walls from outside. Raises PlanError for a gable or hip roof over walls
    that do not meet at right angles.
    """
    if form == NO_ROOF:
        return []
    closed = outline.buffer(_CLOSED_M, join_style="mitre").buffer(-_CLOSED_M, join_style="mitre")
    reach_m = _FLAT_OVERHANG_M if form == "flat" else OVERHANG_M
    grown = shapely.simplify(closed.buffer(reach_m, join_style="mitre"), 1e-3)
    if form == "flat":
        level = np.array([1.0, 0.0])
        return [RoofPlane(part, level, 0.0, 0.0, 0.0) for part in polygons_of(grown)]
    turn_deg = _walls_deg(polygons_of(grown))
    upright = rotate(grown, -turn_deg, origin=(0.0, 0.0))
    planes = []
    for part in polygons_of(_straightened(polygons_of(upright), form)):
        eaves = [*_eaves(part)]
        areas = _areas(part, eaves)
        if form == "gable":
            _end_in_gables(eaves, areas)
        planes += [
            _turned(RoofPlane(piece, eave.inward, eave.line_m, _SLOPE, -_SLOPE * reach_m), turn_deg)
            for eave, area in zip(eaves, areas, strict=True)
            for piece in polygons_of(area)
            if piece.area > _LEAST_M2
        ]
    return planes


def _turned(plane: RoofPlane, turn_deg: float) -> RoofPlane:
    area = rotate(plane.area_m, turn_deg, origin=(0.0, 0.0))
    return replace(plane, area_m=area, inward=rotation_2d(turn_deg) @ plane.inward)


def _walls_deg(parts: Sequence[Polygon]) -> float:
    """The direction most of the outline runs in, -45 to 45."""
    steps = [np.diff(np.asarray(part.exterior.coords), axis=0) for part in parts]
    longest = max(np.vstack(steps), key=lambda step: float(np.hypot(*step)))
    return float((np.degrees(np.arctan2(longest[1], longest[0])) + 45.0) % 90.0 - 45.0)


def _straightened(parts: Sequence[Polygon], form: RoofForm) -> BaseGeometry:
    """Upright outlines with eaves on few lines, moved outwards where they move at all."""
    rings = [
        np.asarray(ring.coords)[:-1, :2]
        for part in map(orient, parts)
        for ring in (part.exterior, *part.interiors)
    ]
    slanted = sum(int((_lean_m(ring) > _SLANT_M).sum()) for ring in rings)
    if slanted:
        raise PlanError(
            f"{slanted} outer walls slant, which no {form} roof here can follow",
            expected="outer walls at right angles, or a flat roof",
        )
    solid: BaseGeometry = Polygon()
    for ring in rings:
        area = Polygon(_upright(ring)).buffer(0)
        # Rings of courtyards run the other way round, and come after the ring around them.
        solid = solid.union(area) if _is_left(ring) else solid.difference(area)
    for _ in range(sum(map(len, rings))):
        steps = [*_steps(polygons_of(solid))]
        if not steps:
            break
        solid = _clean(solid.union(steps[0]))
    return solid


def _lean_m(ring: FloatArray) -> FloatArray:
    return np.asarray(np.abs(np.roll(ring, -1, axis=0) - ring).min(axis=1))


def _is_left(ring: FloatArray) -> bool:
    return bool(shapely.LinearRing(ring).is_ccw)


def _upright(ring: FloatArray) -> FloatArray:
    """(N, 2) the ring with its sides along the axes, on a grid."""
    step = np.roll(ring, -1, axis=0) - ring
    axis = np.where(np.abs(step[:, 0]) > np.abs(step[:, 1]), 1, 0)
    middle = ring + step / 2
    corners = []
    for index, direction in enumerate(axis):
        corner, before = ring[index].copy(), index - 1
        corner[axis[before]] = middle[before, axis[before]]
        if axis[before] == direction:  # two in a row: a step between them
            corners.append(corner.copy())
        corner[direction] = middle[index, direction]
        corners.append(corner)
    return np.round(np.array(corners) / _GRID_M) * _GRID_M


def _clean(area: BaseGeometry) -> BaseGeometry:
    """The area on the grid, without corners in a line."""
    cleaned: BaseGeometry = shapely.set_precision(area, _GRID_M).simplify(_GRID_M / 2)
    return cleaned


def _steps(parts: Sequence[Polygon]) -> Iterator[Polygon]:
    """What fills the outline in beside sides too short to be seen, between two of one direction."""
    for part in map(orient, parts):
        for ring in (part.exterior, *part.interiors):
            corners = np.asarray(ring.coords)[:-1, :2]
            step = np.roll(corners, -1, axis=0) - corners
            for index, side in enumerate(step):
                before, after = step[index - 1], step[(index + 1) % len(step)]
                if (
                    np.hypot(*side) > _OFFSET_M
                    or before @ after <= 0.0
                    or abs(side @ before) > 1e-6
                ):
                    continue
                if before[0] * side[1] - before[1] * side[0] > 0.0:  # the next one lies farther in
                    start, along, away = corners[index], after, side
                else:
                    start, along, away = corners[index] + side, -before, -side
                yield Polygon([start, start + along, start + along + away, start + away])


@dataclass(frozen=True, eq=False)
class _Eave:
    start_m: FloatArray
    end_m: FloatArray
    inward: FloatArray

    @property
    def line_m(self) -> float:
        return float(self.start_m @ self.inward)


def _eaves(part: Polygon) -> Iterator[_Eave]:
    part = orient(part)
    for ring in (part.exterior, *part.interiors):
        for start, end in pairwise(np.asarray(ring.coords)[:, :2]):
            along = (end - start) / np.hypot(*(end - start))
            yield _Eave(start, end, np.array([-along[1], along[0]]).round())


def _areas(part: Polygon, eaves: Sequence[_Eave]) -> list[BaseGeometry]:
    """What of a roof each eave is nearest to."""
    areas = []
    for index, eave in enumerate(eaves):
        area: BaseGeometry = _part_within(part, [_far(eave, end, eave) for end in _ENDS])
        for other in range(len(eaves)):
            if other != index and not area.is_empty:
                nearer = _nearer(part, eaves[other], eave, first=other < index)
                if nearer is not None:
                    area = _solid(shapely.difference(area, nearer, grid_size=_FINE_M))
        kept = [piece for piece in polygons_of(area) if piece.area > _LEAST_M2]
        areas.append(shapely.union_all(kept, grid_size=_FINE_M))
    return areas


_ENDS = ("behind", "ahead", "start", "end")

_Linear = tuple[FloatArray, float]
"""A function of places: their dot product with a vector, and what is added."""


def _distance(eave: _Eave, end: str) -> _Linear:
    """One of the four functions whose maximum is the distance to an eave."""
    along = np.array([eave.inward[1], -eave.inward[0]])
    if end == "ahead":
        return eave.inward, -eave.line_m
    if end == "behind":
        return -eave.inward, eave.line_m
    if end == "start":
        return -along, float(along @ eave.start_m)
    return along, -float(along @ eave.end_m)


def _far(eave: _Eave, end: str, reference: _Eave) -> _Linear:
    """How much farther an eave is, by one of its functions, than another's line."""
    vector, added = _distance(eave, end)
    return vector - reference.inward, added + reference.line_m


def _nearer(part: Polygon, other: _Eave, eave: _Eave, *, first: bool) -> BaseGeometry | None:
    """Where another eave is nearer than one's own; of two on one line, which is first."""
    limits = []
    for end in _ENDS:
        vector, added = _far(other, end, eave)
        if np.abs(vector).max() < _SAME_M and abs(added) < _SAME_M:
            if end != "ahead" or not first:
                return None
        else:
            limits.append((vector, added))
    return _part_within(part, limits)


def _part_within(part: Polygon, limits: Sequence[_Linear]) -> BaseGeometry:
    """Where none of the functions is above 0, in the bounds of a part of the roof."""
    west, south, east, north = part.bounds
    ring = np.array([[west, south], [east, south], [east, north], [west, north]])
    for vector, added in limits:
        values = ring @ vector + added
        kept = []
        for index, value in enumerate(values):
            before, previous = values[index - 1], ring[index - 1]
            if (value > 0.0) != (before > 0.0):
                share = before / (before - value)
                kept.append(previous + share * (ring[index] - previous))
            if value <= 0.0:
                kept.append(ring[index])
        if len(kept) < 3:
            return Polygon()
        ring = np.array(kept)
    # Its hull, since limits through one corner leave some corners twice.
    area = shapely.MultiPoint(ring).convex_hull
    if area.area < _LEAST_M2:
        return Polygon()
    return _solid(shapely.intersection(area, part, grid_size=_FINE_M))


def _solid(shape: BaseGeometry) -> BaseGeometry:
    """Without the lines and points where areas touch: overlays take none that are mixed."""
    return MultiPolygon(polygons_of(shape))


def _end_in_gables(eaves: Sequence[_Eave], areas: list[BaseGeometry]) -> None:
    """Let the planes beside each triangular one go on to its eave, in place of it."""
    for index, eave in enumerate(eaves):
        apex = _apex(areas[index], eave)
        beside = [
            next(
                (other for other, candidate in enumerate(eaves) if _is_same(candidate, eave, end)),
                None,
            )
            for end in ("start", "end")
        ]
        if apex is None or beside[0] is None or beside[1] is None:
            continue
        foot = apex - eave.inward * (apex @ eave.inward - eave.line_m)
        for other, corner in zip(beside, (eave.start_m, eave.end_m), strict=True):
            assert other is not None
            areas[other] = shapely.union_all(
                [areas[other], Polygon([corner, foot, apex])], grid_size=_FINE_M
            )
        areas[index] = Polygon()


def _is_same(candidate: _Eave, eave: _Eave, end: str) -> bool:
    """Whether an eave is the next before or after one's own."""
    ends = (candidate.end_m, eave.start_m) if end == "start" else (candidate.start_m, eave.end_m)
    return bool(np.abs(ends[0] - ends[1]).max() < _SAME_M)


def _apex(area: BaseGeometry, eave: _Eave) -> FloatArray | None:
    """(2,) top corner of a plane that is a triangle over the whole of its eave."""
    if not isinstance(area, Polygon) or area.is_empty or area.interiors:
        return None
    corners = np.asarray(area.simplify(1e-4).exterior.coords)[:-1]
    ahead = corners @ eave.inward - eave.line_m
    length = float(np.hypot(*(eave.end_m - eave.start_m)))
    if len(corners) != 3 or abs(area.area - length * length / 4) > 1e-3 * area.area:
        return None
    return np.asarray(corners[int(ahead.argmax())])
