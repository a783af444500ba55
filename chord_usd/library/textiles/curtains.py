"""Curtains, open at a window's side or drawn before it."""

from __future__ import annotations

import itertools
from dataclasses import replace
from typing import Literal

from chord_usd.library.cloth.hangings import HEIGHT_M, TIE
from chord_usd.library.cloth.stored import Cloth, stored
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import Size, circle, joined, loft

Heading = Literal["wave", "pinch", "gather", "eyelet"]

_TAPE_M = 0.09
"""How much of the upper end never changes where curtains are of other lengths."""


def curtain(size_m: Size, *, heading: Heading, state: str) -> tuple[Part, ...]:
    """A curtain of its own width, depth and height; state: open, tied or drawn."""
    length, width, height = size_m
    cloth = _cut(stored(_name(heading, state, length)), height, keep_hem=state == "tied")
    low, high = cloth.solid.bounds_m()
    span = high - low
    cloth = cloth.moved(-float(low[0] + high[0]) / 2, -float(low[1] + high[1]) / 2, -float(low[2]))
    cloth = cloth.scaled(length / span[0], width / span[1], height / span[2])
    sheet = Part("Curtain", cloth.solid, "cloth", None, uvs=cloth.corner_uvs_m(), two_sided=True)
    if state == "tied":
        band = _band(cloth, height * (1.0 - TIE))
        return (sheet, Part("Band", band, "band", None))
    if heading == "eyelet":
        return (sheet, Part("Eyelets", _eyelets(cloth, height), "metal", None))
    return (sheet,)


def _name(heading: Heading, state: str, length: float) -> str:
    kind = "wave" if heading == "eyelet" else heading
    if state != "drawn":
        return f"curtain_{kind}_{state}"
    return f"curtain_{kind}_{'narrow' if length < 0.85 else 'wide'}"


def _cut(cloth: Cloth, height: float, *, keep_hem: bool) -> Cloth:
    """Made shorter below its heading, whose folds stay as they are."""
    if keep_hem or height > 0.8 * HEIGHT_M:
        return cloth
    points = cloth.solid.points_m
    share = height / HEIGHT_M
    below = HEIGHT_M - points[:, 2]
    uvs = cloth.uvs_m.copy()
    moved = points.copy()
    drop = below.clip(_TAPE_M) - _TAPE_M
    full = HEIGHT_M - _TAPE_M
    moved[:, 2] = HEIGHT_M - (below.clip(max=_TAPE_M) + drop * (height - _TAPE_M) / full)
    uvs[:, 1] *= share
    return Cloth(replace(cloth.solid, points_m=moved), uvs)


def _band(cloth: Cloth, z_m: float):
    """A band around the narrowest place."""
    near = cloth.solid.points_m[abs(cloth.solid.points_m[:, 2] - z_m) < 0.05]
    low, high = near.min(axis=0), near.max(axis=0)
    middle, half = (low + high) / 2, (high - low) / 2 + 0.006
    flat = circle(1.0, 0.0, 32) * [half[0], half[1], 0.0]
    rings = [
        flat * [grow, grow, 1.0] + [middle[0], middle[1], z_m + dz]
        for dz, grow in ((-0.03, 0.94), (-0.026, 1.02), (0.026, 1.02), (0.03, 0.94))
    ]
    return loft(rings, loop=True)


def _eyelets(cloth: Cloth, height: float):
    """Metal rings through which the rod passes: one at every fold."""
    points = cloth.solid.points_m
    top = points[points[:, 2] > height - 0.004]
    crossings = [(a + b) / 2 for a, b in itertools.pairwise(top) if (a[1] > 0.0) != (b[1] > 0.0)]
    ring = [
        circle(r, y, 12)
        for r, y in ((0.021, -0.004), (0.03, -0.004), (0.03, 0.004), (0.021, 0.004))
    ]
    hoop = loft(ring, loop=True).turned("y", 90)
    return joined([hoop.moved(p[0], p[1], height - 0.04) for p in crossings])
