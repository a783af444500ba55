"""Normals and texture coordinates of a solid, one per triangle corner."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Iterator
from itertools import pairwise

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.solids import Solid

CREASE_DEG = 38.0
"""Faces that meet at a sharper angle keep their edge; flatter ones shade as one surface."""

MOST_AT_A_POINT = 1000
"""Corners. The pole of a fine sphere has 256."""

_BAR = 3.0
"""Times as long as wide: what is a bar, with its grain along it however it stands."""

_UPRIGHT = math.cos(math.radians(4.0))
"""Cosine of the angle up to which a bar counts as parallel to an axis of the model."""

_SIDES_FIRST = np.array([0.999, 1.0, 1.0])
"""Faces at 45 degrees to the grain are seen with it."""

_LONGEST_TILE_M = 2.0

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


def corner_uvs_m(solid: Solid, name: str = "") -> FloatArray:
    """(3 T, 2) texture coordinates in metres, projected along the axis each face looks most at.

    Each connected solid is a board of its own: u runs along its longest side, and it begins
    elsewhere than others do (name: of the part, by which that is drawn). Seen from outside, v runs
    to the left of u.
    """
    piece = _pieces(solid)
    corners = solid.points_m[solid.faces]
    normals = _face_normals(solid)
    uvs = np.empty((len(solid.faces), 3, 2))
    by_piece = np.split(np.argsort(piece, kind="stable"), np.cumsum(np.bincount(piece))[:-1])
    for number, faces in enumerate(by_piece):
        axes = _axes_of(corners[faces].reshape(-1, 3))
        start = _start_m(name, number)
        uvs[faces] = _projected(corners[faces] @ axes.T, normals[faces] @ axes.T) + start
    return uvs.reshape(-1, 2)


def _projected(corners: FloatArray, normals: FloatArray) -> FloatArray:
    """(T, 3, 2) coordinates of faces in a frame whose first axis is along the grain."""
    axis = np.argmax(np.abs(normals) * _SIDES_FIRST, axis=1)
    positive = np.take_along_axis(normals, axis[:, None], axis=1)[:, 0] >= 0.0
    sign = np.where(positive, 1.0, -1.0)[:, None]
    along, second, third = corners[..., 0], corners[..., 1], corners[..., 2]
    which = axis[:, None]
    u = np.where(which == 0, second, along)
    v = np.where(which == 0, third, np.where(which == 1, -third, second))
    return np.stack([u, v * sign], axis=-1)


def _axes_of(points: FloatArray) -> FloatArray:
    """(3, 3) rows: along the longest side of a solid, then the next. Bars that stand aslant have
    axes of their own; all others have the axes of the model."""
    spans = np.ptp(points, axis=0)
    order = np.argsort(-spans, kind="stable")
    axes = np.eye(3)[order]
    centred = points - points.mean(axis=0)
    _, vectors = np.linalg.eigh(centred.T @ centred)
    principal = vectors.T[::-1]
    slant = np.abs(principal[0]).max()
    own_spans = np.ptp(centred @ principal.T, axis=0)
    if slant < _UPRIGHT and own_spans[0] > _BAR * max(own_spans[1:]):
        longest = np.argmax(np.abs(principal), axis=1)
        axes = principal * np.sign(principal[np.arange(3), longest])[:, None]
    if np.linalg.det(axes) < 0.0:
        axes[2] *= -1.0
    return axes


def separate(solid: Solid) -> list[Solid]:
    """The connected solids that one consists of, in order of appearance."""
    piece = _pieces(solid)
    solids = []
    for number in range(int(piece.max()) + 1):
        used, faces = np.unique(solid.faces[piece == number], return_inverse=True)
        solids.append(Solid(solid.points_m[used], faces.reshape(-1, 3)))
    return solids


def _pieces(solid: Solid) -> np.ndarray:
    """(T,) number of the connected solid that each face belongs to, in order of appearance."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    first, second, third = solid.faces.T
    rows, columns = np.concatenate([first, second]), np.concatenate([second, third])
    count = len(solid.points_m)
    joined = coo_matrix((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(count, count))
    _, label = connected_components(joined, directed=False)
    _, first_seen, number = np.unique(label[first], return_index=True, return_inverse=True)
    rank = np.empty_like(first_seen)
    rank[np.argsort(first_seen)] = np.arange(len(first_seen))
    return rank[number.reshape(-1)]


def _start_m(name: str, number: int) -> FloatArray:
    """Where in its tile the texture of a solid begins."""
    digest = hashlib.sha256(f"{name}/{number}".encode()).digest()
    return np.frombuffer(digest[:4], dtype="<u2") / 65536.0 * _LONGEST_TILE_M


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
