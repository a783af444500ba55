"""Faces and meshes of the shell: upright sheets, flat sheets, prisms. Numpy and shapely only."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import mapbox_earcut
import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient

from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.types import BoolArray, FloatArray

IntArray = npt.NDArray[np.int32]

_SAME_POINT_DECIMALS = 6
"""Corners closer than a micrometre are one point of the mesh."""

_ON_SIDE_M = 1e-5
"""A point nearer to the side of a triangle lies on it."""

_SLIVER_M2 = 1e-8
"""Triangles and areas smaller than this are lines or points: they cover nothing."""

_NO_AREA_M2 = 1e-12
"""Faces whose corners coincide, or lie in a line, once their points are shared."""


@dataclass(frozen=True, eq=False)
class Face:
    """A planar convex polygon, counter-clockwise seen from the side it faces."""

    corners_m: FloatArray
    """(K, 3)."""
    uvs_m: FloatArray
    """(K, 2) texture coordinates, in metres on the surface."""


@dataclass(frozen=True, eq=False)
class Mesh:
    """Faces with shared points, ready to be written."""

    points_m: FloatArray
    """(N, 3)."""
    counts: IntArray
    """(F,) corners of each face."""
    indices: IntArray
    """(C,) point of each corner, C being the sum of counts."""
    uvs_m: FloatArray
    """(C, 2), one per corner."""
    normals: FloatArray
    """(C, 3), one per corner: faces are flat."""

    @property
    def is_empty(self) -> bool:
        """Whether there is nothing to write."""
        return len(self.counts) == 0

    def extent_m(self) -> FloatArray:
        """(2, 3) lowest and highest corner of the bounds."""
        return np.array([self.points_m.min(axis=0), self.points_m.max(axis=0)])


def mesh_of(faces: Sequence[Face]) -> Mesh:
    """One mesh of these faces; equal corners become one point, faces without area are left out."""
    counts = np.array([len(face.corners_m) for face in faces], dtype=np.int32)
    corners = np.concatenate([np.empty((0, 3)), *(face.corners_m for face in faces)])
    uvs = np.concatenate([np.empty((0, 2)), *(face.uvs_m for face in faces)])
    kept = np.linalg.norm(_newell(np.round(corners, _SAME_POINT_DECIMALS), counts), axis=1)
    has_area = kept > 2.0 * _NO_AREA_M2
    corners, uvs = (rows[np.repeat(has_area, counts)] for rows in (corners, uvs))
    counts = counts[has_area]
    points, indices = np.unique(
        np.round(corners, _SAME_POINT_DECIMALS), axis=0, return_inverse=True
    )
    return Mesh(
        points_m=points + 0.0,  # turns -0.0 into 0.0, so that files do not differ by a sign
        counts=counts,
        indices=indices.reshape(-1).astype(np.int32),
        uvs_m=np.round(uvs, _SAME_POINT_DECIMALS) + 0.0,
        normals=corner_normals(corners, counts),
    )


def fans(counts: npt.NDArray[np.integer]) -> npt.NDArray[np.int64]:
    """(T, 3) corners of the triangles of convex faces, fanned from the first corner of each.

    counts: (F,) corners of each face; corners are numbered through all faces.
    """
    if (counts == 3).all():
        return np.arange(3 * len(counts)).reshape(-1, 3)
    starts = np.cumsum(counts) - counts
    cuts = np.maximum(counts - 2, 0)
    faces = np.repeat(np.arange(len(counts)), cuts)
    step = np.arange(len(faces)) - (np.cumsum(cuts) - cuts)[faces] + 1
    first = starts[faces]
    return np.stack([first, first + step, first + step + 1], axis=1)


def upright(
    start_m: FloatArray, end_m: FloatArray, low_m: float, high_m: float, *, along_m: float = 0.0
) -> Face:
    """A vertical quad over a ground line; it faces the right-hand side of start to end.

    start_m, end_m: (2,). along_m: texture coordinate u at start_m; v is the height.
    """
    length = float(np.hypot(*(np.asarray(end_m) - start_m)))
    corners = np.array(
        [[*start_m, low_m], [*end_m, low_m], [*end_m, high_m], [*start_m, high_m]], dtype=float
    )
    u = (along_m, along_m + length)
    uvs = np.array([[u[0], low_m], [u[1], low_m], [u[1], high_m], [u[0], high_m]])
    return Face(corners, uvs)


def flat(area: BaseGeometry, height_m: float, *, up: bool, cut: bool = False) -> list[Face]:
    """A horizontal sheet that faces up or down; u, v are world x, y. Holes are cut out.

    Convex parts stay one polygon, unless they must be cut; others become triangles. What has no
    area gives no face.
    """
    pieces = _triangles if cut else _convex_pieces
    return [face for part in _parts(area) for face in _sheet(pieces(part), height_m, up=up)]


def prism(area: BaseGeometry, low_m: float, high_m: float) -> list[Face]:
    """Closed solids: an area of the ground plane raised from low_m to high_m.

    What has no volume gives no face.
    """
    if high_m - low_m <= 10.0**-_SAME_POINT_DECIMALS:
        return []
    return [face for part in _parts(area) for face in _prism(part, low_m, high_m)]


def _parts(area: BaseGeometry) -> Iterator[Polygon]:
    """The polygons of an area that cover something, counter-clockwise."""
    return (orient(part) for part in polygons_of(area) if part.area > _SLIVER_M2)


def _prism(area: Polygon, low_m: float, high_m: float) -> list[Face]:
    pieces = _convex_pieces(area)
    faces = _sheet(pieces, high_m, up=True) + _sheet(pieces, low_m, up=False)
    for ring in (area.exterior, *area.interiors):
        corners = np.asarray(ring.coords)[:, :2]
        along = 0.0
        for start, end in pairwise(corners):
            faces.append(upright(start, end, low_m, high_m, along_m=along))
            along += float(np.hypot(*(end - start)))
    return faces


def cuboid(low_m: Sequence[float], high_m: Sequence[float]) -> list[Face]:
    """A closed axis-aligned box between two corners (x, y, z)."""
    (x0, y0, z0), (x1, y1, z1) = low_m, high_m
    return prism(Polygon([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), z0, z1)


def standing(faces: Iterable[Face]) -> list[Face]:
    """Faces drawn in the ground plane, stood up: y becomes the height, the prism's axis -y.

    A profile drawn with prism(profile, low, high) then reaches from y = -high to y = -low.
    """
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
    return [Face(face.corners_m @ turn.T, face.uvs_m) for face in faces]


def moved(
    faces: Iterable[Face], rotation: FloatArray, offset_m: FloatArray | Sequence[float]
) -> list[Face]:
    """Faces turned about the vertical by a (2, 2) rotation, then shifted by (x, y, z)."""
    turn = np.eye(3)
    turn[:2, :2] = rotation
    return [Face(face.corners_m @ turn.T + np.asarray(offset_m), face.uvs_m) for face in faces]


def corner_normals(corners: FloatArray, counts: IntArray) -> FloatArray:
    """(C, 3) normals by Newell's sum, which does not mind three corners in a line."""
    sums = _newell(corners, counts)
    lengths = np.linalg.norm(sums, axis=1, keepdims=True)
    units = np.round(sums / np.maximum(lengths, 1e-12), _SAME_POINT_DECIMALS) + 0.0
    return np.repeat(units, counts, axis=0)


def _newell(corners: FloatArray, counts: IntArray) -> FloatArray:
    """(F, 3) normals of faces, as long as twice their areas."""
    starts = np.cumsum(counts) - counts
    following = np.arange(1, len(corners) + 1)
    following[starts + counts - 1] = starts
    sums: FloatArray = np.add.reduceat(np.cross(corners, corners[following]), starts)
    return sums


def _convex_pieces(area: Polygon) -> list[FloatArray]:
    """Rings (N, 2) of an oriented area, counter-clockwise, that cover it."""
    ring = np.asarray(area.exterior.coords)[:-1, :2]
    return [ring] if not area.interiors and _is_convex(ring) else list(_triangles(area))


def _sheet(pieces: Iterable[FloatArray], height_m: float, *, up: bool) -> list[Face]:
    return [_flat_face(piece if up else piece[::-1], height_m) for piece in pieces]


def _flat_face(ring: FloatArray, height_m: float) -> Face:
    return Face(np.column_stack([ring, np.full(len(ring), height_m)]), ring)


def _is_convex(ring: FloatArray) -> bool:
    to_next = np.roll(ring, -1, axis=0) - ring
    following = np.roll(to_next, -1, axis=0)
    turns = to_next[:, 0] * following[:, 1] - to_next[:, 1] * following[:, 0]
    return bool(np.all(turns >= 0.0))


def _triangles(area: Polygon) -> Iterable[FloatArray]:
    rings = [np.asarray(ring.coords)[:-1, :2] for ring in (area.exterior, *area.interiors)]
    points = np.concatenate(rings)
    ends = np.cumsum([len(ring) for ring in rings]).astype(np.uint32)
    cut = mapbox_earcut.triangulate_float64(points, ends).reshape(-1, 3)
    for triangle in _meeting_at_corners(points, cut):
        yield points[list(triangle)]


def _meeting_at_corners(
    points: FloatArray, triangles: npt.NDArray[np.integer]
) -> Iterator[tuple[int, ...]]:
    """Triangles, counter-clockwise, cut in two where a point lies in the middle of a side.

    Earcut passes over corners in a line with others; the mesh would come apart there. Triangles
    that are no more than such a line are left out.
    """
    waiting = [(tuple(map(int, triangle)), frozenset[int]()) for triangle in triangles]
    while waiting:
        (a, b, c), cut_off = waiting.pop()
        turn = _cross(points[b] - points[a], points[c] - points[a])
        if abs(turn) / 2 <= _SLIVER_M2:
            continue
        triangle = (a, b, c) if turn > 0.0 else (a, c, b)
        for a, b, c in (triangle, triangle[1:] + triangle[:1], triangle[2:] + triangle[:2]):
            inner = _on_side(points, a, b)
            # Lines are lines to a tolerance only: without end a triangle could lose one corner,
            # come by another, and get the first one back.
            inner[list(cut_off)] = False
            if inner.any():
                if not inner[c]:
                    middle = int(inner.argmax())
                    waiting.append(((a, middle, c), cut_off | {b}))
                    waiting.append(((middle, b, c), cut_off | {a}))
                break
        else:
            yield triangle


def _on_side(points: FloatArray, a: int, b: int) -> BoolArray:
    """(N,) which of the points lie between two of them, on the line from one to the other."""
    side, offset = points[b] - points[a], points - points[a]
    length = max(float(np.hypot(*side)), _ON_SIDE_M)
    along = offset @ side / length
    beside = np.abs(_cross(side, offset)) / length
    inner: BoolArray = beside < _ON_SIDE_M
    return inner & (along > _ON_SIDE_M) & (along < length - _ON_SIDE_M)


def _cross(first: FloatArray, second: FloatArray) -> FloatArray:
    """z of the cross product of vectors (..., 2)."""
    product: FloatArray = first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
    return product
