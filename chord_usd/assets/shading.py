"""Normals and texture coordinates of a solid, one per triangle corner."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from chord_usd.assets.solids import Solid
from chord_usd.scene.types import FloatArray

CREASE_DEG = 38.0
"""Faces that meet at a sharper angle keep their edge; flatter ones shade as one surface."""

MOST_AT_A_POINT = 1000
"""Corners. The pole of a fine sphere has 256."""

_PAIRS_AT_ONCE = 1_000_000


def corner_normals(solid: Solid, crease_deg: float = CREASE_DEG) -> FloatArray:
    """(3 T, 3) unit normals in face order: faces around a corner, weighted by area and angle.

    Area keeps large flat faces flat beside small bevels; the angle makes the result independent
    of how a quad was split.
    """
    scaled = _face_normals(solid)
    unit = scaled / np.maximum(np.linalg.norm(scaled, axis=1, keepdims=True), 1e-18)
    weighted = np.repeat(scaled, 3, axis=0) * _corner_angles(solid)[:, None]
    point_of_corner = solid.faces.reshape(-1)
    face_of_corner = np.repeat(np.arange(len(solid.faces)), 3)
    normals = np.zeros((len(point_of_corner), 3))
    for first, second in _pairs_at_a_point(point_of_corner):
        near = np.sum(unit[face_of_corner[first]] * unit[face_of_corner[second]], axis=1)
        together = near >= math.cos(math.radians(crease_deg))
        np.add.at(normals, first[together], weighted[second[together]])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    return normals / np.maximum(length, 1e-18)


def corner_uvs_m(solid: Solid) -> FloatArray:
    """(3 T, 2) texture coordinates in metres, projected along the axis each face looks most at.

    Seen from outside, u runs to the right and v up (on tops and undersides: to the back).
    """
    normals = _face_normals(solid)
    axis = np.argmax(np.abs(normals), axis=1)
    positive = normals[np.arange(len(normals)), axis] >= 0.0
    corners = solid.points_m[solid.faces]
    x, y, z = corners[..., 0], corners[..., 1], corners[..., 2]
    sign = np.where(positive, 1.0, -1.0)[:, None]
    along = axis[:, None]
    u = np.where(along == 0, sign * y, np.where(along == 1, -sign * x, sign * x))
    v = np.where(along == 2, y, z)
    return np.stack([u, v], axis=-1).reshape(-1, 2)


def _face_normals(solid: Solid) -> FloatArray:
    """(T, 3) normals whose length is twice the face's area."""
    a, b, c = (solid.points_m[solid.faces[:, corner]] for corner in range(3))
    return np.cross(b - a, c - a)


def _corner_angles(solid: Solid) -> FloatArray:
    """(3 T,) inner angle of each triangle corner, radians."""
    corners = solid.points_m[solid.faces]
    ahead = np.roll(corners, -1, axis=1) - corners
    back = np.roll(corners, 1, axis=1) - corners
    sine = np.linalg.norm(np.cross(ahead, back), axis=-1)
    return np.arctan2(sine, np.sum(ahead * back, axis=-1)).reshape(-1)


def _pairs_at_a_point(point_of_corner: np.ndarray) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """All ordered pairs of corners (each with itself too) that share a point, in handy portions.

    Where more than MOST_AT_A_POINT meet, each goes with itself alone: pairs grow with the square.
    """
    order = np.argsort(point_of_corner, kind="stable")
    counts = np.bincount(point_of_corner)
    starts = (np.cumsum(counts) - counts)[point_of_corner[order]]
    fan = counts[point_of_corner[order]]
    is_crowd = fan > MOST_AT_A_POINT
    starts = np.where(is_crowd, np.arange(len(order)), starts)
    fan = np.where(is_crowd, 1, fan)
    ends = np.cumsum(fan)
    cuts = np.searchsorted(ends, np.arange(0, ends[-1] if len(ends) else 0, _PAIRS_AT_ONCE))
    for low, high in pairwise([*cuts, len(order)]):
        some = fan[low:high]
        offsets = np.arange(some.sum()) - np.repeat(np.cumsum(some) - some, some)
        yield np.repeat(order[low:high], some), order[np.repeat(starts[low:high], some) + offsets]
