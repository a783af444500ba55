"""Grown surfaces: wood, bark, leaves, cane."""

from __future__ import annotations

import numpy as np

from chord_usd.library.surfaces.surface_pattern import Pattern, centred, even
from chord_usd.library.textures.boards import Boards, years
from chord_usd.library.textures.fields import Ground, blurred, noise, smoothstep

_LEAVES = np.array(
    ((0.0, 0.19, 0.5, 0.034), (0.19, 0.16, 1.35, 0.012), (0.35, 0.21, 0.42, 0.05),
     (0.56, 0.16, -0.5, 0.02))
)  # fmt: skip
"""Boards side by side: where one begins and how wide it is, in metres across the grain; where the
heart of its tree lies, in widths from its edge, and how deep below the cut, in metres."""

_RING_M = 0.0058


def wood(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Boards of one tree, cut flat and quartered: flames, straight grain, pores."""
    wander = noise(rng, ground, 2.0, longest_m=0.72, shortest_m=0.03, stretch=(16.0, 1.0))
    fibre = noise(rng, ground, 0.55, longest_m=0.05, stretch=(85.0, 1.0))
    streak = noise(rng, ground, 1.3, longest_m=0.144, shortest_m=0.012, stretch=(52.0, 1.0))
    cloud = noise(rng, ground, 1.6, longest_m=0.72, shortest_m=0.06, stretch=(10.0, 1.0))
    dots = noise(rng, ground, 0.0, longest_m=0.018, shortest_m=0.0028, stretch=(29.0, 1.0))
    boards = _leaves(ground)
    width, heart, below = _LEAVES.T[1:]
    rings = years(
        rng, boards, ground.x_m[None, :], wander, heart_m=heart * width, deep_m=below,
        ring_m=_RING_M, period_m=ground.tile_m[0], waves=1, uneven=0.55,
    )  # fmt: skip
    tone = boards.each(rng.uniform(-0.045, 0.045, boards.count))
    early = 1.0 - smoothstep(0.45, 0.95, rings)
    late = smoothstep(0.35, 0.92, rings) * (1.0 - smoothstep(0.94, 1.0, rings))
    pores = np.clip(dots - 0.9, 0.0, 1.6) * (0.35 + 0.65 * early)
    fade = 0.75 + 0.25 * np.clip(cloud, -2.0, 2.0)
    depth = 0.2 * late * fade + 0.05 * fibre + 0.2 * pores + 0.045 * streak + 0.03 * cloud + tone
    height_m = 2.4e-5 * fibre - 9.0e-5 * blurred(pores, ground, 0.0009) + 2.0e-5 * late
    roughness = 1.0 + 0.1 * pores - 0.06 * late + 0.03 * fibre
    warmth = 0.012 * streak + 0.01 * cloud
    return Pattern(ground, centred(depth), height_m, roughness, 1.0, warmth)


def _leaves(ground: Ground) -> Boards:
    """The boards of _LEAVES; the edge of the tile falls into the middle of a board."""
    start, width = _LEAVES[:, :2].T.astype(np.float32)
    across = ((ground.y_m + np.float32(0.07)) % np.float32(ground.tile_m[1]))[:, None]
    index = np.searchsorted(start, across, side="right") - 1
    across = across - start[index]
    edge = np.minimum(across, width[index] - across)
    return Boards(ground, index, ground.x_m[None, :], across, edge)


def rattan(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Flat strands of cane woven two over, two under."""
    count = 16
    x, y = (
        place * np.float32(count / ground.tile_m[0])
        for place in (ground.x_m[None, :], ground.y_m[:, None])
    )
    i, j = x.astype(np.int32), y.astype(np.int32)
    upper = ((i + j) % 4) < 2
    across = np.where(upper, x - i, y - j).astype(np.float32) - 0.5
    belly = np.sqrt(np.clip(1.0 - (across / 0.47) ** 2, 0.0, 1.0))
    bend = np.cos(np.where(upper, y - i, x + 1 - j).astype(np.float32) * (np.pi / 2) - np.pi / 4)
    gap = np.abs(across) > 0.46
    fine, other = (
        noise(rng, ground, 0.4, longest_m=0.0048, shortest_m=0.00048, stretch=stretch)
        for stretch in ((8.0, 1.0), (1.0, 8.0))
    )
    grain = np.where(upper, other, fine)
    strands = rng.uniform(-1.0, 1.0, (2, count)).astype(np.float32)
    tone = np.where(upper, strands[0][i], strands[1][j])
    depth = 0.34 * (1.0 - belly) + 0.7 * gap - 0.1 * bend + 0.05 * grain + 0.09 * tone
    knots = np.clip(np.cos(np.where(upper, y, x) * (np.pi / 4)) - 0.985, 0.0, 1.0) * 8.0
    height_m = 0.0011 * belly * ~gap + 0.0005 * bend + 1.5e-5 * grain
    return Pattern(ground, centred(depth + knots, 4.0), height_m, 1.0 + 0.12 * grain, 1.0)


def bark(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Ridges along the stem, also loose soil."""
    ridges = noise(rng, ground, 1.1, longest_m=0.024, shortest_m=0.0017, stretch=(6.7, 1.0))
    crumbs = noise(rng, ground, 0.7, longest_m=0.006, stretch=(1.3, 1.0))
    cracks = np.exp(-np.abs(ridges) * 3.0)
    depth = 0.4 * cracks + 0.06 * crumbs - 0.05 * np.clip(ridges, -2.0, 2.0)
    height_m = 0.0009 * (0.35 * ridges - cracks) + 0.00012 * crumbs
    return Pattern(ground, centred(depth), height_m, even(ground, 1.0), 0.8)


def soil(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Crumbs of earth."""
    lumps = noise(rng, ground, 0.9, longest_m=0.0167, shortest_m=0.00125)
    grit = noise(rng, ground, 0.2, longest_m=0.0033)
    depth = -0.22 * lumps - 0.1 * grit
    height_m = 0.0012 * lumps + 0.0003 * grit
    return Pattern(ground, centred(depth), height_m, even(ground, 1.0), 0.6)


def leaf(rng: np.random.Generator, ground: Ground) -> Pattern:
    """A blade's veins, slanting from its length, and its mottled green."""
    cloud = noise(rng, ground, 1.7, shortest_m=0.0015, stretch=(2.0, 1.0))
    along, up = ground.tile_m
    slant = np.float32(8.0 / along) * ground.x_m + np.float32(2.0 / up) * ground.y_m[:, None]
    slant = slant + 0.09 * cloud
    slant -= np.floor(slant)
    veins = np.exp(-(((slant - 0.5) / 0.055) ** 2))
    fine = noise(rng, ground, 0.5, longest_m=0.002, shortest_m=0.0003, stretch=(2.0, 1.0))
    depth = 0.1 * cloud - 0.17 * veins + 0.03 * fine
    height_m = -0.00022 * blurred(veins, ground, 0.0004) + 1.2e-5 * fine
    return Pattern(ground, centred(depth), height_m, 1.0 + 0.06 * cloud, 0.7, 0.03 * cloud)
