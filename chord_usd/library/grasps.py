"""Where a parallel gripper takes hold of a thing: pairs of surface points that face each other.

A grasp is a frame: the gripper closes along x, y is across its pads, z is where its fingers point.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import trimesh

from chord_usd.base.scene.palette import CATEGORIES, Level, usual_mass_kg
from chord_usd.base.scene.types import Asset, FloatArray

OPEN_M = 0.085
"""How far the gripper opens."""

LIFTED_KG = 3.0

PAD_M = (0.01, 0.022, 0.03)
"""Of a finger: thickness, width, and length of what may touch."""

TIP_M = 0.008
"""Fingers reach so far beyond the points that they hold."""

PALM_M = 0.05
"""From the points held back to the palm."""

_POINTS, _TURNS, _PAIRS = 700, 8, 60
_ALIGNED = np.cos(np.radians(15.0))
"""Pads slip where the faces are farther from square to the line between them."""

_CLEAR_M = 0.004
_LEAST_M = 0.003


@dataclass(frozen=True, eq=False)
class Grasp:
    """A frame of the gripper in that of the thing, and how far its pads are apart."""

    middle_m: FloatArray
    """(3,) between the pads."""
    axes: FloatArray
    """(3, 3) whose columns are x, y, z of the gripper."""
    width_m: float

    def in_gripper(self, points: FloatArray) -> FloatArray:
        """(N, 3) points of the thing in the frame of the gripper."""
        turned: FloatArray = (points - self.middle_m) @ self.axes
        return turned

    def clears_floor(self, floor_m: float) -> bool:
        """Whether the open fingers stay above the plane that the thing stands on."""
        reach = OPEN_M / 2 + PAD_M[0]
        sides = [(x, y, TIP_M) for x in (-reach, reach) for y in (-PAD_M[1] / 2, PAD_M[1] / 2)]
        corners = np.array(sides) @ self.axes.T + self.middle_m
        return bool(corners[:, 2].min() >= floor_m)


def is_graspable(asset: Asset) -> bool:
    """Whether a gripper may lift it: small, light, and loose."""
    row = CATEGORIES.get(asset.category)
    if row is None or row.level is Level.HOUSE or "moved" not in row.traits:
        return False
    light = usual_mass_kg(asset.category, asset.size_m) <= LIFTED_KG
    return light and min(asset.size_m) <= OPEN_M


def candidates(mesh: trimesh.Trimesh, seed: int = 0) -> Iterator[Grasp]:
    """Antipodal grasps whose open fingers and palm meet nothing, the nearest to the middle first,
    from above before from the side."""
    rng = np.random.default_rng(seed)
    points, normals = _sampled(mesh, rng)
    first, second, width = _facing(points, normals)
    if not len(first):
        return
    middle = (points[first] + points[second]) / 2
    away = np.linalg.norm(middle - mesh.bounds.mean(axis=0), axis=1)
    ranked: list[tuple[float, Grasp]] = []
    nearest = np.argsort(away)[:_PAIRS]
    for index in {*nearest.tolist(), *rng.permutation(len(away))[: 2 * _PAIRS].tolist()}:
        axis = (points[second[index]] - points[first[index]]) / width[index]
        for approach in _across(axis):
            frame = np.column_stack([axis, np.cross(approach, axis), approach])
            grasp = Grasp(middle[index], frame, float(width[index]))
            if _is_clear(grasp.in_gripper(points), grasp.width_m):
                low = 0.0 if grasp.clears_floor(mesh.bounds[0, 2]) else 1.0
                ranked.append((low + away[index] + 0.05 * (1.0 + approach[2]), grasp))
    yield from (grasp for _, grasp in sorted(ranked, key=lambda pair: pair[0]))


def _sampled(mesh: trimesh.Trimesh, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
    """Points spread over the faces by area, and the normals there."""
    areas = mesh.area_faces
    faces = rng.choice(len(areas), size=_POINTS, p=areas / areas.sum())
    weights = rng.dirichlet(np.ones(3), size=_POINTS)
    return np.einsum("nk,nkd->nd", weights, mesh.triangles[faces]), mesh.face_normals[faces]


def _facing(
    points: FloatArray, normals: FloatArray
) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp], FloatArray]:
    """Indices of the pairs that a gripper holds from outside, and how wide each is."""
    line = points[None] - points[:, None]
    width = np.linalg.norm(line, axis=2)
    line /= np.maximum(width, 1e-9)[:, :, None]
    # Normals point outwards: away from the other point.
    near = -np.einsum("ijd,id->ij", line, normals) > _ALIGNED
    far = np.einsum("ijd,jd->ij", line, normals) > _ALIGNED
    fits = (width > _LEAST_M) & (width < OPEN_M - 2 * _CLEAR_M)
    first, second = np.nonzero(np.triu(near & far & fits, k=1))
    return first, second, width[first, second]


def _across(axis: FloatArray) -> Iterator[FloatArray]:
    """Directions square to an axis, the first as far down as can be."""
    down = np.array([0.0, 0.0, -1.0]) - axis * -axis[2]
    if np.linalg.norm(down) < 1e-3:
        down = np.array([1.0, 0.0, 0.0])
    down = down / np.linalg.norm(down)
    side = np.cross(axis, down)
    for turn in np.linspace(0.0, 2 * np.pi, _TURNS, endpoint=False):
        yield np.cos(turn) * down + np.sin(turn) * side


def _is_clear(points: FloatArray, width_m: float) -> bool:
    """Whether no point lies where the open fingers or the palm are."""
    x, y, z = np.abs(points[:, 0]), np.abs(points[:, 1]), points[:, 2]
    beside = (x > width_m / 2 + _CLEAR_M) & (x < OPEN_M / 2 + PAD_M[0]) & (y < PAD_M[1] / 2)
    in_fingers = beside & (z > -PALM_M) & (z < TIP_M)
    in_palm = (z < -PALM_M + 0.005) & (z > -PALM_M - 0.03) & (x < OPEN_M / 2) & (y < 0.02)
    return not bool((in_fingers | in_palm).any())
