"""Cushions that stand on sofas and beds, leaning back a little; throws over a bed's foot
or a seat's edge.

They are soft: what they sink into would be pushed away by their colliders, so they have none.
"""

from __future__ import annotations

import math

import numpy as np

from chord_usd.base.scene.types import frozen_array
from chord_usd.library.cloth.cloth_grids import Made
from chord_usd.library.cloth.stored import Cloth
from chord_usd.library.cloth.stuffed import Filling, stuffed
from chord_usd.library.cloth.throws import Place, Throw, laid_over
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import Size, Solid, lathe, loft

_LEAN_DEG = 72.0
_CORD_M = 0.0045
_STANDS_OUT_M = 0.025
"""How far the folds of a throw stand out from what it lies on."""


def cushion(size_m: Size, *, filling: Filling, piped: bool = False) -> tuple[Part, ...]:
    """A stuffed cushion standing on its edge, leaning back."""
    length, _, height = size_m
    case = stuffed(length, height / 0.94, filling)
    solids = [case.solid, _cord(case)] if piped else [case.solid]
    # Its underside becomes its back; then it is brought to its size as a whole.
    upright = [solid.turned("x", _LEAN_DEG) for solid in solids]
    bounds = np.array([solid.bounds_m() for solid in upright])
    low, high = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
    middle = (low + high) / 2
    scale = np.array(size_m) / (high - low)
    placed = [
        solid.moved(-float(middle[0]), -float(middle[1]), -float(low[2])).scaled(*scale)
        for solid in upright
    ]
    parts = [Part("Cushion", placed[0], "cloth", None, uvs=case.corner_uvs_m())]
    if piped:
        parts.append(Part("Piping", placed[1], "cord", None))
    return tuple(parts)


def _cord(bag: Cloth) -> Solid:
    """A cord along the seam: where the two sides of the bag meet."""
    uvs = bag.uvs_m
    half = np.abs(uvs).max(axis=0)
    on_edge = np.flatnonzero((np.abs(uvs) > half - 1e-4).any(axis=1))
    around = np.arctan2(uvs[on_edge, 1] / half[1], uvs[on_edge, 0] / half[0])
    path = bag.solid.points_m[on_edge[np.argsort(around)]]
    ahead, behind = np.roll(path, -1, axis=0), np.roll(path, 1, axis=0)
    along = ahead - behind
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    out = np.cross(along, [0.0, 0.0, 1.0])
    out /= np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-9)
    up = np.cross(out, along)
    rings = [
        path + _CORD_M * (math.cos(a) * out + math.sin(a) * up)
        for a in np.linspace(0.0, 2 * math.pi, 6, endpoint=False)
    ]
    sections = np.stack(rings, axis=1)
    return loft(list(sections[::-1]), loop=True)


def bolster(size_m: Size) -> tuple[Part, ...]:
    """A roll with gathered ends and a button in each."""
    length, width, height = size_m
    radius, half = min(width, height) / 2, length / 2
    profile = [(0.012, -half + 0.012)]
    for share in (0.3, 0.6, 0.85):
        profile.append((radius * share, -half + 0.006 * (1 - share)))
    profile += [(radius * 0.96, -half + 0.012), (radius, -half + 0.03), (radius * 0.985, 0.0),
                (radius, half - 0.03), (radius * 0.96, half - 0.012)]  # fmt: skip
    for share in (0.85, 0.6, 0.3):
        profile.append((radius * share, half - 0.006 * (1 - share)))
    profile.append((0.012, half - 0.012))
    roll = lathe(profile, 36)
    roll = _gathered(roll, radius, half).turned("y", 90)
    stud = lathe([(0.012, -0.004), (0.018, 0.004), (0.012, 0.009), (0.0, 0.01)], 14)
    studs = [stud.turned("y", s * 90).moved(s * (half - 0.011), 0.0, radius) for s in (-1, 1)]
    return (
        Part("Cushion", roll.moved(z=radius), "cloth", None),
        Part("Buttons", studs[0] + studs[1], "cord", None),
    )


def _gathered(roll: Solid, radius: float, half: float) -> Solid:
    """Small pleats in the ends."""
    points = roll.points_m.copy()
    around = np.arctan2(points[:, 1], points[:, 0])
    near = np.clip((np.abs(points[:, 2]) - half + 0.025) / 0.02, 0.0, 1.0)
    points[:, 2] -= np.sign(points[:, 2]) * 0.005 * near * (1 + np.sin(18 * around))
    points[:, :2] *= (1.0 + 0.008 * np.sin(3 * around + 40 * points[:, 2]))[:, None]
    points[:, :2] *= radius / np.abs(points[:, :2]).max()
    return Solid(frozen_array(points), roll.faces)


def bed_throw(size_m: Size, *, throw: Throw) -> tuple[Part, ...]:
    """A throw across a bed's foot; it hangs down at both sides, the lowest at z = 0."""
    length, width, height = size_m
    place = Place(length / 2 - _STANDS_OUT_M, height - _STANDS_OUT_M - throw.fringe_m)
    return _fitted(size_m, *laid_over(throw, place, width))


def seat_throw(size_m: Size, *, throw: Throw) -> tuple[Part, ...]:
    """A throw on a seat that hangs over its front edge, the lower end at z = 0."""
    length, depth, height = size_m
    lies = depth - _STANDS_OUT_M - throw.fringe_m
    place = Place(0.0, height - _STANDS_OUT_M - throw.fringe_m, back_m=lies, sinks_m=0.004)
    made, fringe = laid_over(throw, place, length)
    points, faces, uvs = made
    turned = [Solid(frozen_array(points), frozen_array(faces, np.int64)), fringe]
    cloth, fringe = (solid and solid.turned("z", -90) for solid in turned)
    assert cloth is not None
    return _fitted(size_m, (cloth.points_m, faces, uvs), fringe)


def _fitted(size_m: Size, made: Made, fringe: Solid | None) -> tuple[Part, ...]:
    points, faces, uvs = made
    solid = Solid(frozen_array(points), frozen_array(faces, np.int64))
    whole = solid if fringe is None else solid + fringe
    low, high = whole.bounds_m()
    scale = np.array(size_m) / (high - low)
    shift = -(low + high) / 2 * [1, 1, 0] - low * [0, 0, 1]
    placed = solid.moved(*shift).scaled(*scale)
    parts = [Part("Throw", placed, "cloth", None, uvs=uvs[placed.faces.reshape(-1)])]
    if fringe is not None:
        parts.append(Part("Fringe", fringe.moved(*shift).scaled(*scale), "cloth", None))
    return tuple(parts)
