"""Stone, fired clay, concrete and brushed metal."""

from __future__ import annotations

import numpy as np

from chord_usd.library.surfaces.surface_pattern import Pattern, centred, even
from chord_usd.library.textures.fields import (
    Ground,
    Raster,
    blurred,
    grains,
    looked_up,
    noise,
    smoothstep,
)


def brushed(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Fine scratches along the sheet, seen in the highlights more than in the colour."""
    lines = noise(rng, ground, 0.35, longest_m=0.0125, stretch=(120.0, 1.0))
    cloud = noise(rng, ground, 1.8, shortest_m=0.0156, stretch=(2.0, 1.0))
    depth = 0.03 * lines + 0.012 * cloud
    roughness = 1.0 + 0.12 * np.clip(lines, -2.0, 2.0) + 0.06 * cloud
    return Pattern(ground, centred(depth), 0.000006 * lines, roughness, 0.0)


def stone(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Dense dark stone: clouds, crystals, a few pale threads."""
    cloud = noise(rng, ground, 1.7, longest_m=0.45, shortest_m=0.015)
    speck = noise(rng, ground, 0.3, longest_m=0.014)
    field = noise(rng, ground, 2.0, longest_m=0.45, shortest_m=0.056)
    aside_m = 0.0225 * cloud
    field = looked_up(field, ground, ground.x_m - aside_m, ground.y_m[:, None] - aside_m)
    threads = np.exp(-np.abs(field) * 55) * smoothstep(0.0, 1.2, cloud)
    depth = 0.1 * cloud + 0.07 * speck - 0.5 * threads
    roughness = 1.0 + 0.1 * speck + 0.08 * cloud
    return Pattern(ground, centred(depth, 5.0), 0.000012 * speck, roughness, 0.3, 0.006 * cloud)


def marble(rng: np.random.Generator, ground: Ground) -> Pattern:
    """White marble: grey veins that branch, over faint clouds."""
    x_m, y_m = (
        place + 0.031 * noise(rng, ground, 1.8, longest_m=0.65, shortest_m=0.016)
        for place in (ground.x_m[None, :], ground.y_m[:, None])
    )
    share = even(ground, 0.0)
    for strength, sharp, longest_m, shortest_m in (
        (0.3, 26, 1.3, 0.26),
        (0.2, 40, 0.65, 0.144),
        (0.1, 34, 0.325, 0.059),
    ):
        field = noise(
            rng, ground, 1.7, longest_m=longest_m, shortest_m=shortest_m, stretch=(1.0, 1.6)
        )
        away = np.abs(looked_up(field, ground, x_m, y_m)) * -sharp
        thick = smoothstep(-0.9, 1.3, noise(rng, ground, 1.8, shortest_m=0.16))
        share = np.maximum(share, strength * (np.exp(away) + 0.28 * np.exp(away / 5)) * thick)
    depth = share + 0.022 * noise(rng, ground, 1.8, shortest_m=0.043)
    return Pattern(ground, centred(depth, 9.0), even(ground, 0.0), 1.0 + 0.1 * share, 0.1)


def quartz(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Engineered stone: grains of quartz of a few millimetres, pale and dark."""
    number, inside = grains(rng, ground, 150)
    tone = np.clip(rng.standard_normal(150 * 150), -2.0, 2.0).astype(np.float32)
    dark = (rng.random(150 * 150) < 0.05).astype(np.float32)
    pale = tone[number] * smoothstep(0.0, 0.3, inside)
    flecks = dark[number] * smoothstep(0.1, 0.25, inside)
    depth = blurred(0.028 * pale + 0.2 * flecks, ground, 0.00045)
    return Pattern(ground, centred(depth, 6.0), even(ground, 0.0), 1.0 + 0.05 * pale, 0.1)


def _spots(
    rng: np.random.Generator, ground: Ground, slope: float, low: float, vary: float, soft: float
) -> Raster:
    """Round spots of varied size in the middles of 40 grains across; low: without variation they
    begin this far from a grain's border."""
    _, inside = grains(rng, ground, 40)
    size = noise(rng, ground, slope, longest_m=ground.tile_m[0] / 8)
    return smoothstep(0.0, soft, inside - low + vary * size)


def ceramic(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Stoneware under glaze: it pools a little, and specks of iron show."""
    pooled = noise(rng, ground, 1.7, longest_m=0.125, shortest_m=0.00625)
    specks = _spots(rng, ground, 1.0, 0.5, 0.05, 0.1)
    depth = 0.035 * pooled + 0.22 * specks
    height_m = 0.00007 * noise(rng, ground, 2.0, longest_m=0.083, shortest_m=0.0104)
    return Pattern(ground, centred(depth, 5.0), height_m, 1.0 + 0.1 * pooled, 0.7)


def concrete(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Cast concrete: clouds, sand, small blow holes."""
    cloud = noise(rng, ground, 1.7, shortest_m=0.0167)
    sand = noise(rng, ground, 0.3, longest_m=0.0195)
    holes = _spots(rng, ground, 0.8, 0.54, 0.045, 0.08)
    depth = 0.055 * cloud + 0.03 * sand + 0.28 * holes
    height_m = 0.00012 * sand + 0.0002 * cloud - 0.0015 * blurred(holes, ground, 0.0012)
    return Pattern(ground, centred(depth, 5.0), height_m, 1.0 + 0.05 * cloud, 0.4, 0.008 * cloud)


def terracotta(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Fired clay: sand, lime bloom, faint rings of the wheel along u."""
    sand = noise(rng, ground, 0.3, longest_m=0.0059)
    bloom = noise(rng, ground, 1.7, shortest_m=0.0075)
    rings = noise(rng, ground, 0.8, longest_m=0.0375, shortest_m=0.00375, stretch=(24.0, 1.0))
    depth = 0.045 * sand - 0.06 * bloom + 0.03 * rings
    height_m = 0.00009 * sand + 0.00016 * rings
    return Pattern(ground, centred(depth), height_m, 1.0 + 0.04 * sand, 0.9, -0.015 * bloom)
