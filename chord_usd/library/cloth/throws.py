"""Throws over a bed's foot or a seat's front edge: gathered, in folds, some with a fringe.

Drawn, not simulated: a cloth that is gathered loosely slips off what it is let fall on.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.cloth.cloth_grids import Made, thickened
from chord_usd.library.kit.solids import Solid, joined, loft

_CELL_M = 0.03
_BEND_M = 0.05
"""Radius over the edge of what it lies on."""

_STRAND_APART_M = 0.02


@dataclass(frozen=True)
class Throw:
    """How a throw is made and how it lies."""

    folds: int = 5
    """Across its width."""
    fold_m: float = 0.022
    """Height of the folds where it lies; they are deeper where it hangs."""
    thick_m: float = 0.014
    quilted_m: float = 0.0
    """Width of stitched channels along it; 0 for a plain cloth."""
    fringe_m: float = 0.0
    """Length of the strands at both ends."""
    askew: float = 0.0
    """Tangent of the angle at which it lies."""
    seed: int = 0


@dataclass(frozen=True)
class Place:
    """What a throw hangs over, its middle or its back end at the origin, along x."""

    flat_m: float
    """From the origin to the edge."""
    hang_m: float
    back_m: float = 0.0
    """From the origin to the end that lies; 0 where it hangs at both sides alike."""
    sinks_m: float = 0.018
    """How far its long edges lie lower than its middle: they rest on something soft."""


def laid_over(throw: Throw, place: Place, width_m: float) -> tuple[Made, Solid | None]:
    """Points, faces, cloth coordinates of a throw of this width (along y), and its fringe.

    The cloth's underside is at z = 0 where it lies flat.
    """
    rng = np.random.default_rng(throw.seed)
    reach = place.flat_m + place.hang_m + _BEND_M * (np.pi / 2 - 1.0)
    lies, bends = place.flat_m - _BEND_M, place.flat_m + _BEND_M * (np.pi / 2 - 1.0)
    side = np.concatenate([_steps(lies, bends, 0.016)[:-1], _steps(bends, reach, _CELL_M)])
    if place.back_m:
        line = np.concatenate([_steps(-place.back_m, lies, _CELL_M)[:-1], side])
    else:
        line = np.concatenate([-side[::-1], _steps(-lies, lies, 2 * _CELL_M)[1:-1], side])
    rows = max(round(width_m / _CELL_M), 5 * throw.folds) + 1
    if throw.quilted_m:
        # Five cells a channel, with lines of the grid in the seams.
        rows = 10 * round(width_m / throw.quilted_m / 2) + 1
    along, across = np.meshgrid(line, np.linspace(1.0, -1.0, rows))
    sign = np.sign(along) if not place.back_m else np.ones_like(along)
    out, down, turn = _bent(along * sign, place.flat_m)
    hangs = np.square(np.sin(turn))
    off = _folds(throw, along, across, hangs, down, rng)
    if throw.quilted_m:
        off += 0.01 * np.abs(np.sin(np.pi * across * width_m / 2 / throw.quilted_m)) ** 0.6
    edge = np.abs(across) ** 6
    wander = 0.03 * _wander(along, rng) * np.sign(across) * np.abs(across)
    narrower = 1.0 - 0.1 * np.clip(down / 0.3, 0.0, 1.0)
    grid = np.stack([
        sign * (out + off * np.sin(turn)),
        across * width_m / 2 * narrower + wander + throw.askew * along * (1.0 - hangs),
        -down + off * np.cos(turn) - place.sinks_m * edge * (1.0 - hangs),
    ], axis=-1)  # fmt: skip
    grid[..., 2] += 0.02 * hangs * _wander(across + sign, rng) * down / max(place.hang_m, 1e-6)
    points, faces, owner = thickened(grid, throw.thick_m)
    flat = np.stack([along, across * 0.6 * width_m], axis=-1).reshape(-1, 2)
    fringe = _fringe(grid, throw, rng) if throw.fringe_m else None
    return (points, faces, flat[owner]), fringe


def _steps(first: float, last: float, step: float) -> FloatArray:
    return np.linspace(first, last, max(round((last - first) / step), 1) + 1)


def _bent(along: FloatArray, flat_m: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Way out, way down and slope (radians) of a line that follows the top and hangs down."""
    past = along - (flat_m - _BEND_M)
    turn = np.clip(past / _BEND_M, 0.0, np.pi / 2)
    out = np.minimum(along, flat_m - _BEND_M) + _BEND_M * np.sin(turn)
    down = _BEND_M * (1.0 - np.cos(turn)) + np.maximum(past - _BEND_M * np.pi / 2, 0.0)
    return out, down, turn


def _folds(
    throw: Throw,
    along: FloatArray,
    across: FloatArray,
    hangs: FloatArray,
    down: FloatArray,
    rng: np.random.Generator,
) -> FloatArray:
    """How far the cloth is from what it lies on."""
    uneven = across + 0.22 * np.sin(2.3 * across + rng.uniform(0, 6)) + 0.1 * _wander(along, rng)
    phase = np.pi * throw.folds * uneven + rng.uniform(0, 6)
    ridges = (0.5 + 0.5 * np.sin(phase)) ** 2.5
    # Where it lies, folds come and go; where it hangs, all of them run down to the hem.
    fade = np.clip(0.55 + 0.6 * np.sin(1.7 * across + 3.1 * along + rng.uniform(0, 6)), 0.1, 1.0)
    lying = throw.fold_m * ridges * fade
    deeper = 0.6 + 0.6 * np.clip(down / 0.3, 0.0, 1.0)
    hanging = 1.3 * throw.fold_m * deeper * (0.5 + 0.5 * np.sin(phase + 0.6 * _wander(down, rng)))
    off = (1.0 - hangs) * lying + hangs * hanging
    return off


def _wander(x: FloatArray, rng: np.random.Generator) -> FloatArray:
    """A slow curve between about -1 and 1."""
    a, b, c = rng.uniform(0.0, 2 * np.pi, 3)
    return 0.5 * np.sin(2.1 * x + a) + 0.3 * np.sin(4.7 * x + b) + 0.2 * np.sin(9.1 * x + c)


def _fringe(grid: FloatArray, throw: Throw, rng: np.random.Generator) -> Solid:
    """Knotted strands at both ends."""
    strands = []
    for end, inner in ((0, 1), (-1, -2)):
        hem, out = grid[:, end], grid[:, end] - grid[:, inner]
        out /= np.linalg.norm(out, axis=1, keepdims=True)
        length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(hem, axis=0), axis=1))])
        places = np.arange(0.008, length[-1] - 0.004, _STRAND_APART_M)
        for place in places:
            at, way = (
                np.array([np.interp(place, length, values[:, axis]) for axis in range(3)])
                for values in (hem, out)
            )
            strands.append(_strand(at, way, throw, rng))
    return joined(strands)


def _strand(at: FloatArray, way: FloatArray, throw: Throw, rng: np.random.Generator) -> Solid:
    sway = rng.normal(0.0, 0.18, 3)
    beside = np.cross(way, [0.3, 0.5, 0.8])
    beside /= np.linalg.norm(beside)
    third = np.cross(way, beside)
    rings = []
    for share, radius in ((-0.1, 0.002), (0.12, 0.0042), (0.3, 0.0022), (1.0, 0.003)):
        middle = at + throw.fringe_m * share * (way + sway * max(share, 0.0) ** 1.5)
        around = np.linspace(0.0, 2 * np.pi, 3, endpoint=False)[:, None]
        rings.append(middle + radius * (np.cos(around) * beside + np.sin(around) * third))
    return loft(rings)
