"""Triangle meshes as contact looks at them: whether they are closed, and whether convex.

The words of trimesh, which finds the same, and whose import takes longer than a room's check.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.types import FloatArray

_FLAT = 1e-5
"""Share of a mesh's size that a corner may rise over the faces around it."""

_LEAST_AREA_M2 = 1e-14

_BOX = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)], dtype=np.float64) - 0.5
_BOX_FACES = np.array(
    [
        [1, 3, 0], [4, 1, 0], [0, 3, 2], [2, 4, 0], [1, 7, 3], [5, 1, 4],
        [5, 7, 1], [3, 7, 2], [6, 4, 2], [2, 7, 6], [6, 5, 4], [7, 5, 6],
    ]
)  # fmt: skip


@dataclass(eq=False)
class _Known:
    """What placing a mesh does not change, once it is asked for."""

    is_watertight: bool | None = None
    is_convex: bool | None = None
    used: npt.NDArray[np.int64] | None = None


@dataclass(frozen=True, eq=False)
class Triangles:
    """A mesh of triangles."""

    vertices: FloatArray
    """(N, 3) metres."""
    faces: npt.NDArray[np.int64]
    """(M, 3) corners, counter-clockwise from outside."""
    _known: _Known = field(default_factory=_Known, repr=False)

    @classmethod
    def box(cls, size_m: float, to_world: FloatArray) -> Triangles:
        """A cube about the origin, brought to where to_world, (4, 4), puts it."""
        return cls(_BOX * size_m, _BOX_FACES).placed(to_world[:3, :3].T, to_world[:3, 3])

    def placed(self, linear: FloatArray, offset_m: FloatArray) -> Triangles:
        """Each vertex v, as a row, at v @ linear (3, 3) + offset_m (3,)."""
        return Triangles(self.vertices @ linear + offset_m, self.faces, self._known)

    @property
    def corners(self) -> FloatArray:
        """(K, 3) the vertices that triangles use; all of them where there is no triangle."""
        known = self._known
        if known.used is None:
            known.used = np.unique(self.faces)
        whole = len(known.used) in (0, len(self.vertices))
        return self.vertices if whole else self.vertices[known.used]

    @property
    def is_watertight(self) -> bool:
        """Whether each edge is one of exactly two triangles."""
        known = self._known
        if known.is_watertight is None:
            known.is_watertight = bool(len(self.faces)) and self._sides() is not None
        return known.is_watertight

    @property
    def is_convex(self) -> bool:
        """Whether it is one closed body without a dent."""
        known = self._known
        if known.is_convex is None:
            known.is_convex = self._is_convex()
        return known.is_convex

    def _sides(self) -> npt.NDArray[np.int64] | None:
        """(E, 2) sides in pairs, numbered as corners of faces are; None where some have no
        partner, or two."""
        ends = np.stack([self.faces, np.roll(self.faces, -1, axis=1)], axis=-1).reshape(-1, 2)
        keys = ends.min(axis=1) * (len(self.vertices) + 1) + ends.max(axis=1)
        order = np.argsort(keys, kind="stable")
        ranked = keys[order]
        if len(ranked) % 2 or (ranked[::2] != ranked[1::2]).any():
            return None
        if (ranked[1:-1:2] == ranked[2::2]).any():
            return None
        return order.reshape(-1, 2)

    def _is_convex(self) -> bool:
        sides = self._sides()
        if sides is None or not len(sides):
            return False
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        normals = cross(b - a, c - a)
        lengths = np.linalg.norm(normals, axis=1)
        normals /= np.maximum(lengths, np.finfo(float).tiny)[:, None]
        beside = sides // 3
        has_area = (lengths[beside] / 2 > _LEAST_AREA_M2).all(axis=1)
        if not has_area.any():
            return False
        # The corner of the second face that is not on the side, over the plane of the first.
        first, second = beside[has_area].T
        on_side = self.faces.reshape(-1)[sides[has_area, 0]]
        opposite = self.faces[second, (sides[has_area, 1] % 3 + 2) % 3]
        away = self.vertices[opposite] - self.vertices[on_side]
        rises_m = np.einsum("ij,ij->i", away, normals[first])
        size_m = float(np.linalg.norm(np.ptp(self.vertices[np.unique(self.faces)], axis=0)))
        return bool(rises_m.max() < _FLAT * size_m) and _is_one(beside, len(self.faces))


def _is_one(beside: npt.NDArray[np.int64], count: int) -> bool:
    """Whether one can walk from any face to any other over pairs, (E, 2), of those beside."""
    label = np.arange(count)
    while True:
        least = label[beside].min(axis=1)
        lower = label.copy()
        for column in (0, 1):
            np.minimum.at(lower, beside[:, column], least)
        lower = lower[lower]
        if (lower == label).all():
            return not label.any()
        label = lower


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """(N, 3) of (N, 3) and (N, 3); np.cross takes several times as long over small arrays."""
    out = np.empty((len(a), 3))
    out[:, 0] = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    out[:, 1] = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    out[:, 2] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return out
