"""What the turn of a winder stair is drawn from: tapered treads, newels, the handrail outside,
which a spiral stair has, too.

Everything is in the stair's own frame. The underside of the treads goes on as that of the flights
does: along the edge between two treads it is as far below as a step's inner corner.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry import LineString, Point
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

from chord_usd.base.scene.geometry import to_world
from chord_usd.base.scene.stair_forms import BuiltStair
from chord_usd.base.scene.storeys import Tread
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.shell.mesh import Face, cuboid, flat, prism

NEWEL_M = 0.08
"""Side of a newel."""

_OVER_RAIL_M = 0.08
"""How much higher it is than the handrails that meet it."""

_BARS_M = 0.14
"""Between the bars below a handrail along the outer side, at most."""

_BENDS = 4
"""Straight pieces of a spiral stair's handrail over each tread."""

_EDGE_M = 1e-6


def tapered(built: BuiltStair) -> list[Tread]:
    """The treads of the turn, from below."""
    return [tread for tread in built.treads if tread.edges_m is not None]


def tread_faces(tread: Tread, rise_m: float, waist_m: float) -> list[Face]:
    """A tapered tread as a closed solid, from its top to the underside of the stair.

    waist_m: thickness below a step's inner corner.
    """
    area = orient(tread.area_m)
    faces = flat(area, tread.top_m, up=True)
    for face in flat(area, 0.0, up=False, cut=True):
        corners = face.corners_m.copy()
        corners[:, 2] = _undersides_m(tread, corners[:, :2], rise_m, waist_m)
        faces.append(Face(corners, face.uvs_m))
    for start, end in pairwise(np.asarray(area.exterior.coords)[:, :2]):
        low = _undersides_m(tread, np.array([start, end]), rise_m, waist_m)
        length = float(np.hypot(*(end - start)))
        corners = np.array([[*start, low[0]], [*end, low[1]], [*end, tread.top_m],
                            [*start, tread.top_m]])  # fmt: skip
        faces.append(Face(corners, np.column_stack([[0.0, length, length, 0.0], corners[:, 2]])))
    return faces


def tread_hull(built: BuiltStair, tread: Tread) -> list[Face]:
    """A tapered tread as a prism that a solver can take the hull of."""
    low_m = 0.0 if tread.top_m < 2 * built.rise_m - 1e-6 else tread.top_m - built.rise_m - 0.02
    return prism(tread.area_m, low_m, tread.top_m)


def newel_faces(built: BuiltStair, from_side_m: float, rail_m: float) -> list[Face]:
    """A post at each inner corner of the turn, from the floor to over the handrails.

    from_side_m: from the inner side to the post's middle. rail_m: height of handrails over noses.
    """
    turn = tapered(built)
    if not turn:
        return []
    corners = _inner_corners(built)
    side = 1.0 if built.stair.turn == "right" else -1.0
    tops = [turn[len(turn) // 2].top_m, turn[-1].top_m][-len(corners) :]
    faces: list[Face] = []
    for (x, y), out, top in zip(corners, (-side, side), tops, strict=False):
        at, half = np.array([x + out * from_side_m, y + from_side_m]), NEWEL_M / 2
        faces += cuboid((*(at - half), 0.0), (*(at + half), top + rail_m + _OVER_RAIL_M))
    return faces


def outer_rail(
    built: BuiltStair, walls: BaseGeometry, from_side_m: float, rail_m: float,
    grip_m: tuple[float, float], bar_m: float,
) -> list[Face]:  # fmt: skip
    """The handrail along the outer side of the turn; with bars where no wall holds it."""
    faces: list[Face] = []
    wide, high = grip_m
    rail = _outer_line(built, from_side_m, rail_m)
    around = shapely.union_all([tread.area_m.buffer(_EDGE_M) for tread in tapered(built)])
    for start, end in pairwise(rail):
        along = (end - start)[:2]
        length = float(np.hypot(*along))
        if length < _EDGE_M:
            continue
        across = np.array([-along[1], along[0]]) / length * wide / 2
        faces += _bar(start - [0.0, 0.0, high], end - [0.0, 0.0, high], across, high)
        if _is_walled(built, (start + end)[:2] / 2, around, walls):
            continue
        for share in np.linspace(0.0, 1.0, max(1, int(np.ceil(length / _BARS_M))) + 1)[:-1]:
            x, y, top = start + share * (end - start)
            foot = _tread_at(built, (x, y), top - rail_m) - 0.005
            half = bar_m / 2
            faces += cuboid((x - half, y - half, foot), (x + half, y + half, top - high + 0.005))
    return faces


def _undersides_m(tread: Tread, at: FloatArray, rise_m: float, waist_m: float) -> FloatArray:
    """(N,) heights of the underside; nowhere below the floor."""
    assert tread.edges_m is not None
    on, off = (shapely.distance(edge, shapely.points(at)) for edge in tread.edges_m)
    share = on / np.maximum(on + off, _EDGE_M)
    heights: FloatArray = np.maximum(tread.top_m - rise_m * (1.0 - share) - waist_m, 0.0)
    return heights


def _inner_corners(built: BuiltStair) -> list[tuple[float, float]]:
    """Where the inner side of the turn bends."""
    ends = [edge.coords[0] for tread in tapered(built) for edge in tread.edges_m or ()]
    first, last = np.array(ends[0]), np.array(ends[-1])
    y = built.stair.box.size_m[1] / 2 - built.flights[0].width_m
    if built.stair.form == "winder_L":
        return [(float(first[0]), y)]
    return [(float(first[0]), y), (float(last[0]), y)]


def _outer_line(built: BuiltStair, from_side_m: float, rail_m: float) -> FloatArray:
    """(N, 3) the top of the handrail, from the end of one flight to the start of the next."""
    turn = tapered(built)
    edges = [tread.edges_m[0] for tread in turn if tread.edges_m]
    edges += [tread.edges_m[1] for tread in turn[-1:] if tread.edges_m]
    tops = [tread.top_m + rail_m for tread in turn]
    tops += [tops[-1] + built.rise_m]
    if built.is_spiral:
        return _helix([edge.coords[-1] for edge in edges], tops, from_side_m)
    back = built.stair.box.size_m[1] / 2
    first, last = (edges[at].coords[-1] for at in (0, -1))
    outer = [first, (first[0], back), (last[0], back), last]
    side = from_side_m if built.stair.turn == "left" else -from_side_m
    rail = LineString(_distinct(outer)).offset_curve(side, join_style="mitre")
    along = [rail.project(rail.intersection(edge).centroid) for edge in edges]
    bends = [rail.project(Point(corner)) for corner in rail.coords[1:-1]]
    stops = sorted({*along, *bends})
    places = [rail.interpolate(stop).coords[0] for stop in stops]
    return np.column_stack([places, np.interp(stops, along, tops)])


def _helix(
    corners: Sequence[tuple[float, ...]], tops: Sequence[float], from_side_m: float
) -> FloatArray:
    """(N, 3) a line that winds within corners of treads around the origin."""
    x, y = np.array(corners).T
    shares = np.arange(0.0, len(corners) - 1 + 1e-9, 1 / _BENDS)
    angles = np.interp(shares, np.arange(len(corners)), np.unwrap(np.arctan2(y, x)))
    radius = np.hypot(x, y).max() - from_side_m
    heights = np.interp(shares, np.arange(len(corners)), tops)
    return np.column_stack([radius * np.cos(angles), radius * np.sin(angles), heights])


def _distinct(points: Sequence[tuple[float, ...]]) -> list[tuple[float, ...]]:
    kept = list(points[:1])
    for point in points[1:]:
        if np.hypot(*np.subtract(point, kept[-1])) > _EDGE_M:
            kept.append(point)
    return kept


def _bar(start: FloatArray, end: FloatArray, across: FloatArray, high: float) -> list[Face]:
    """A bar with upright sides between two places (x, y, z of its underside)."""
    beside = np.array([*across, 0.0])
    low = np.array([start - beside, start + beside, end + beside, end - beside])
    up = low + np.array([0.0, 0.0, high])
    rings = [up[[0, 3, 2, 1]], low]
    rings += [np.array([low[b], low[a], up[a], up[b]]) for a, b in ((0, 1), (1, 2), (2, 3), (3, 0))]
    uvs = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]) * high
    return [Face(ring, uvs) for ring in rings]


def _tread_at(built: BuiltStair, place: Sequence[float], about_m: float) -> float:
    """Height of the tread at a place; of two a turn apart, of the one about so high."""
    point = Point(place)
    nearest = min(
        tapered(built),
        key=lambda tread: (
            round(tread.area_m.distance(point), 3), abs(tread.top_m - about_m)
        ),
    )  # fmt: skip
    return nearest.top_m


def _is_walled(built: BuiltStair, at: FloatArray, turn: BaseGeometry, walls: BaseGeometry) -> bool:
    """Whether a wall stands beside a place near the outer side of the turn."""
    out = np.array(turn.exterior.interpolate(turn.exterior.project(Point(at))).coords[0])
    beyond = out + (out - at) / max(float(np.hypot(*(out - at))), _EDGE_M) * 0.1
    return bool(shapely.contains_xy(walls, to_world(built.stair.box, [beyond]))[0])
