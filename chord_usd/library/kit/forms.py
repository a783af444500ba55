"""Shapes that things on walls, ceilings and floors share: sheets, shades, frames, seeds."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.types import FloatArray, frozen_array
from chord_usd.library.kit.solids import Solid, joined, lathe, loft, ring, welded

_MITRE_M = 4e-5
"""Between two rails of a frame."""


def rng_of(name: str) -> np.random.Generator:
    """A generator that is always the same for a name."""
    digest = hashlib.sha256(name.encode()).digest()
    return np.random.default_rng(int.from_bytes(digest[:8], "big"))


def outward(solid: Solid) -> Solid:
    """A closed mesh whose faces look outwards, whichever way they looked before."""
    a, b, c = (solid.points_m[solid.faces[:, corner]] for corner in range(3))
    if float(np.sum(a * np.cross(b, c))) >= 0.0:
        return solid
    return Solid(solid.points_m, frozen_array(solid.faces[:, ::-1], np.int64))


def lofted(rings: Sequence[FloatArray], *, loop: bool = False) -> Solid:
    """A loft over rings that run either way."""
    return outward(loft(rings, loop=loop))


def sheet(grid_m: FloatArray) -> Solid:
    """An open surface over a grid of points (rows, columns, 3), both sides to be seen."""
    rows, columns = grid_m.shape[:2]
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b = index[:-1, :-1].ravel(), index[1:, :-1].ravel()
    c, d = index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    faces = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
    return welded(grid_m.reshape(-1, 3), faces)


def hollow(profile_m: Sequence[tuple[float, float]], thick_m: float, sides: int = 32) -> Solid:
    """A turned skin of an even thickness, open at both ends: a lamp shade, a sleeve.

    profile_m: (radius, z) pairs of its outside, from the lower rim to the upper one.
    """
    inside = [(radius - thick_m, z) for radius, z in reversed(profile_m)]
    return outward(lathe([*profile_m, *inside], sides, loop=True))


def cup(
    profile_m: Sequence[tuple[float, float]], thick_m: float, floor_m: float, sides: int = 32, *,
    lip: bool = False,
) -> Solid:  # fmt: skip
    """A turned vessel: its outside (radius, z) from the underside to the rim, and an inside.

    lip: whether its rim is rounded.
    """
    radius, top = profile_m[-1]
    rim = [(radius - 0.4 * thick_m, top + 0.3 * thick_m)] if lip else []
    inside = [(max(r - thick_m, 0.002), z) for r, z in reversed(profile_m) if z > floor_m]
    return outward(lathe([*profile_m, *rim, *inside, (0.0, floor_m)], sides))


def arc(
    first: tuple[float, float],
    middle: tuple[float, float],
    last: tuple[float, float],
    steps: int = 8,
) -> list[tuple[float, float]]:
    """Points of a smooth curve (quadratic Bezier) from first to last, drawn towards middle."""
    at = np.linspace(0.0, 1.0, steps + 1)[:, None]
    ends = (1 - at) ** 2 * np.array(first) + at**2 * np.array(last)
    return [(float(x), float(y)) for x, y in ends + 2 * at * (1 - at) * np.array(middle)]


def sphere_profile(
    radius_m: float, low: float = -1.0, high: float = 1.0, steps: int = 14, z_m: float = 0.0
) -> list[tuple[float, float]]:
    """(radius, z) of a ball around z_m between two shares of its radius, lowest first."""
    angles = np.linspace(math.asin(max(low, -1.0)), math.asin(min(high, 1.0)), steps + 1)
    return [
        (max(float(radius_m * math.cos(a)), 0.0), z_m + float(radius_m * math.sin(a)))
        for a in angles
    ]


def ball(radius_m: float, steps: int = 12, sides: int = 24) -> Solid:
    """A ball around the origin."""
    return lathe(sphere_profile(radius_m, steps=steps), sides)


def frame_rails(length_m: float, height_m: float, section_m: npt.ArrayLike) -> Solid:
    """Four mitred rails around an upright rectangle that stands on z = 0 in the plane y = 0.

    section_m: (K, 2) outline of a rail, (inwards from the outer edge, y), in order.
    Each rail is closed by itself, so that the grain runs along it; the mitres are hairlines, so
    that no point of one rail lies on the next.
    """
    section = np.asarray(section_m, dtype=np.float64)
    inward, deep = section[:, 0], section[:, 1]
    half = length_m / 2
    corners = []
    for sx, low in ((-1, True), (1, True), (1, False), (-1, False)):
        z = inward if low else height_m - inward
        corners.append(np.stack([sx * (half - inward), deep, z], axis=-1))
    rails = []
    for start, end in zip(corners, corners[1:] + corners[:1], strict=True):
        along = (end - start) / np.linalg.norm(end - start, axis=1, keepdims=True)
        rails.append(lofted([start + _MITRE_M / 2 * along, end - _MITRE_M / 2 * along]))
    return joined(rails)


def flat_rail(rail_m: float, deep_m: float, bevel_m: float = 0.0015) -> FloatArray:
    """Section of a plain rail whose back lies at y = 0, front to -y."""
    b = bevel_m
    return np.array(
        [
            [0.0, 0.0],
            [0.0, -deep_m + b],
            [b, -deep_m],
            [rail_m - b, -deep_m],
            [rail_m, -deep_m + b],
            [rail_m, 0.0],
        ]
    )


def moulded_rail(rail_m: float, deep_m: float) -> FloatArray:
    """Section of a classic rail: a raised outer bead, a hollow, an inner step."""
    shape = [
        (0.0, 0.0),
        (0.0, 0.62),
        (0.06, 0.86),
        (0.16, 1.0),
        (0.27, 0.95),
        (0.34, 0.78),
        (0.5, 0.58),
        (0.68, 0.52),
        (0.76, 0.6),
        (0.86, 0.6),
        (0.92, 0.42),
        (1.0, 0.36),
        (1.0, 0.0),
    ]
    return np.array([[rail_m * along, -deep_m * out] for along, out in shape])


def face_uvs(solid: Solid, low_m: Sequence[float], high_m: Sequence[float]) -> FloatArray:
    """(3 T, 2) coordinates 0 to 1 over an upright rectangle (x, z), seen from the front."""
    corners = solid.points_m[solid.faces].reshape(-1, 3)
    u = (corners[:, 0] - low_m[0]) / (high_m[0] - low_m[0])
    v = (corners[:, 2] - low_m[1]) / (high_m[1] - low_m[1])
    return np.clip(np.stack([u, v], axis=-1), 0.002, 0.998)


def rectangles(
    length: float, width: float, levels: list[tuple[float, float]], corner: float, steps: int = 4
) -> list:
    """Rounded rectangles, (inset, z) each."""
    return [
        ring(length - 2 * inset, width - 2 * inset, max(corner - inset, 0.004), z, steps)
        for inset, z in levels
    ]


def open_tub(
    length: float, width: float, height: float, thick: float, corner: float, taper: float = 0.0
) -> Solid:
    """A hollow box with round corners, open above."""
    levels = [
        (taper + 0.003, 0.0),
        (taper, 0.004),
        (0.0, height - 0.002),
        (0.001, height),
        (thick, height),
        (taper + thick, 0.012),
    ]
    return lofted(rectangles(length, width, levels, corner))


def stood_up(solid: Solid, back_y_m: float, z_m: float) -> Solid:
    """Drawn lying with its face up: stood up with its underside in the plane back_y_m."""
    return solid.turned("x", 90).moved(y=back_y_m, z=z_m)
