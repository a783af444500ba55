"""Grown surfaces: wood, bark, leaves, cane."""

from __future__ import annotations

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.looks.look_noise import blurred, shifted_samples, spectral_noise
from chord_usd.library.surfaces.surface_pattern import Pattern, centred, grid_m, smoothstep

_LEAVES = ((0.0, 0.19, 0.5, 0.034), (0.19, 0.16, 1.35, 0.012), (0.35, 0.21, 0.42, 0.05),
           (0.56, 0.16, -0.5, 0.02))  # fmt: skip
"""Boards side by side: where one begins and how wide it is, in metres across the grain; where the
heart of its tree lies, in widths from its edge, and how deep below the cut, in metres."""

_ACROSS_M = 0.72
_ALONG_M = 1.3
_RING_M = 0.0058


def wood(rng: np.random.Generator, px: int) -> Pattern:
    """Boards of one tree, cut flat and quartered: flames, straight grain, pores.

    A cut through rings around the heart of a tree: where it comes near the heart, the rings lie
    open as flames, and beside that as lines.
    """
    tile_m = (_ALONG_M, _ACROSS_M)
    shape = (px, px)
    u, v = grid_m(px, tile_m)
    # Features have true lengths: the tile is longer than wide.
    long = tile_m[0] / tile_m[1]
    wander = spectral_noise(rng, shape, slope=2.0, lowest=1, highest=24, stretch=(5.0 * long, 1.0))
    fibre = spectral_noise(rng, shape, slope=0.55, lowest=14, stretch=(26.0 * long, 1.0))
    streak = spectral_noise(rng, shape, slope=1.3, lowest=5, highest=60, stretch=(16.0 * long, 1.0))
    cloud = spectral_noise(rng, shape, slope=1.6, lowest=1, highest=12, stretch=(3.0 * long, 1.0))
    dots = spectral_noise(rng, shape, slope=0.0, lowest=40, highest=260, stretch=(9.0 * long, 1.0))
    rings, tone = _rings(rng, u, v, wander)
    early = 1.0 - smoothstep(0.45, 0.95, rings)
    late = smoothstep(0.35, 0.92, rings) * (1.0 - smoothstep(0.94, 1.0, rings))
    pores = np.clip(dots - 0.9, 0.0, 1.6) * (0.35 + 0.65 * early)
    fade = 0.75 + 0.25 * np.clip(cloud, -2.0, 2.0)
    depth = 0.2 * late * fade + 0.05 * fibre + 0.2 * pores + 0.045 * streak + 0.03 * cloud + tone
    height_m = 2.4e-5 * fibre - 9.0e-5 * blurred(pores, 0.5) + 2.0e-5 * late
    roughness = 1.0 + 0.1 * pores - 0.06 * late + 0.03 * fibre
    warmth = 0.012 * streak + 0.01 * cloud
    return Pattern(tile_m, centred(depth), height_m, roughness, 1.0, warmth)


def _rings(
    rng: np.random.Generator, u: FloatArray, v: FloatArray, wander: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Where in its year's ring each point lies, 0 to 1, and the tone of each board."""
    rings, tone = np.zeros_like(u), np.zeros_like(u)
    # The edge of the tile falls into the middle of a board.
    across = (v + 0.07) % _ACROSS_M
    for start, width, heart, below in _LEAVES:
        here = (across >= start) & (across < start + width)
        turn = 2 * np.pi * u / _ALONG_M
        one, two, three = rng.uniform(0.0, 2 * np.pi, 3)
        sway = 0.011 * np.sin(turn + one) + 0.004 * np.sin(2 * turn + two)
        rise = below * (1.0 + 0.75 * np.sin(turn + two) + 0.35 * np.sin(2 * turn + three))
        aside = across - start - heart * width + sway
        radius = np.hypot(aside, rise) + 0.0042 * wander
        # Years differ: some rings are wide, some narrow.
        years = radius / _RING_M + 0.55 * np.sin(radius * 71.0 + one) + rng.uniform(0.0, 1.0)
        rings = np.where(here, years % 1.0, rings)
        tone = np.where(here, rng.uniform(-0.045, 0.045), tone)
    return rings, tone


def rattan(rng: np.random.Generator, px: int) -> Pattern:
    """Flat strands of cane woven two over, two under."""
    tile_m, count = (0.096, 0.096), 16
    u, v = grid_m(px, tile_m)
    x, y = u / tile_m[0] * count, v / tile_m[1] * count
    i, j = np.floor(x).astype(int), np.floor(y).astype(int)
    upper = ((i + j) % 4) < 2
    across = np.where(upper, x - i, y - j) - 0.5
    along = np.where(upper, y, x)
    belly = np.sqrt(np.clip(1.0 - (across / 0.47) ** 2, 0.0, 1.0))
    bend = np.cos(2 * np.pi * (np.where(upper, y - i, x + 1 - j) - 0.5) / 4.0)
    gap = np.abs(across) > 0.46
    fine = spectral_noise(rng, (px, px), slope=0.4, lowest=20, highest=200, stretch=(8.0, 1.0))
    other = spectral_noise(rng, (px, px), slope=0.4, lowest=20, highest=200, stretch=(1.0, 8.0))
    grain = np.where(upper, other, fine)
    strands = rng.uniform(-1.0, 1.0, (2, count))
    tone = np.where(upper, strands[0][i % count], strands[1][j % count])
    depth = 0.34 * (1.0 - belly) + 0.7 * gap - 0.1 * bend + 0.05 * grain + 0.09 * tone
    knots = np.clip(np.cos(2 * np.pi * along / 8.0) - 0.985, 0.0, 1.0) * 8.0
    height_m = 0.0011 * belly * ~gap + 0.0005 * bend + 1.5e-5 * grain
    return Pattern(tile_m, centred(depth + knots, 4.0), height_m, 1.0 + 0.12 * grain, 1.0)


def bark(rng: np.random.Generator, px: int) -> Pattern:
    """Ridges along the stem, also loose soil."""
    tile_m, shape = (0.16, 0.12), (px, px)
    ridges = spectral_noise(rng, shape, slope=1.1, lowest=5, highest=70, stretch=(5.0, 1.0))
    crumbs = spectral_noise(rng, shape, slope=0.7, lowest=20)
    cracks = np.exp(-np.abs(ridges) * 3.0)
    depth = 0.4 * cracks + 0.06 * crumbs - 0.05 * np.clip(ridges, -2.0, 2.0)
    height_m = 0.0009 * (0.35 * ridges - cracks) + 0.00012 * crumbs
    return Pattern(tile_m, centred(depth), height_m, np.ones(shape), 0.8)


def soil(rng: np.random.Generator, px: int) -> Pattern:
    """Crumbs of earth."""
    tile_m, shape = (0.2, 0.2), (px, px)
    lumps = spectral_noise(rng, shape, slope=0.9, lowest=12, highest=160)
    grit = spectral_noise(rng, shape, slope=0.2, lowest=60)
    depth = -0.22 * lumps - 0.1 * grit
    return Pattern(tile_m, centred(depth), 0.0012 * lumps + 0.0003 * grit, np.ones(shape), 0.6)


def leaf(rng: np.random.Generator, px: int) -> Pattern:
    """A blade's veins, slanting from its length, and its mottled green."""
    tile_m, shape = (0.12, 0.06), (px, px)
    u, v = grid_m(px, tile_m)
    cloud = spectral_noise(rng, shape, slope=1.7, lowest=1, highest=40)
    rows, columns = np.indices(shape, dtype=np.float64)
    slant = 8.0 * u / tile_m[0] + 2.0 * v / tile_m[1]
    slant = slant + 0.09 * shifted_samples(cloud, rows, columns)
    veins = np.exp(-((np.abs(slant % 1.0 - 0.5) / 0.055) ** 2))
    fine = spectral_noise(rng, shape, slope=0.5, lowest=30, highest=200)
    depth = 0.1 * cloud - 0.17 * veins + 0.03 * fine
    height_m = -0.00022 * blurred(veins, px / 256) + 1.2e-5 * fine
    return Pattern(tile_m, centred(depth), height_m, 1.0 + 0.06 * cloud, 0.7, 0.03 * cloud)
