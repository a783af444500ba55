"""Stone, fired clay, concrete and brushed metal."""

from __future__ import annotations

import numpy as np

from chord_usd.library.looks.look_noise import blurred, shifted_samples, spectral_noise
from chord_usd.library.surfaces.surface_pattern import Pattern, centred, grains, smoothstep


def brushed(rng: np.random.Generator, px: int) -> Pattern:
    """Fine scratches along the sheet, seen in the highlights more than in the colour."""
    tile_m, shape = (0.5, 0.25), (px, px)
    lines = spectral_noise(rng, shape, slope=0.35, lowest=20, stretch=(60.0, 1.0))
    cloud = spectral_noise(rng, shape, slope=1.8, lowest=1, highest=16)
    depth = 0.03 * lines + 0.012 * cloud
    roughness = 1.0 + 0.12 * np.clip(lines, -2.0, 2.0) + 0.06 * cloud
    return Pattern(tile_m, centred(depth), 0.000006 * lines, roughness, 0.0)


def stone(rng: np.random.Generator, px: int) -> Pattern:
    """Dense dark stone: clouds, crystals, a few pale threads."""
    tile_m, shape = (0.9, 0.9), (px, px)
    rows, columns = np.indices(shape, dtype=np.float64)
    cloud = spectral_noise(rng, shape, slope=1.7, lowest=2, highest=60)
    speck = spectral_noise(rng, shape, slope=0.3, lowest=px / 8)
    field = spectral_noise(rng, shape, slope=2.0, lowest=2, highest=16)
    reach = px / 40
    field = shifted_samples(field, rows + reach * cloud, columns - reach * cloud)
    threads = np.exp(-np.abs(field) * 55) * smoothstep(0.0, 1.2, cloud)
    depth = 0.1 * cloud + 0.07 * speck - 0.5 * threads
    roughness = 1.0 + 0.1 * speck + 0.08 * cloud
    return Pattern(tile_m, centred(depth, 5.0), 0.000012 * speck, roughness, 0.3, 0.006 * cloud)


def marble(rng: np.random.Generator, px: int) -> Pattern:
    """White marble: grey veins that branch, over faint clouds."""
    tile_m, shape = (1.3, 1.3), (px, px)
    rows, columns = np.indices(shape, dtype=np.float64)
    bend = [spectral_noise(rng, shape, slope=1.8, lowest=2, highest=80) for _ in range(2)]
    reach = px / 42
    rows, columns = rows + reach * bend[0], columns + reach * bend[1]
    share = np.zeros(shape)
    for strength, sharp, lowest, highest in ((0.3, 26, 1, 5), (0.2, 40, 2, 9), (0.1, 34, 4, 22)):
        field = spectral_noise(
            rng, shape, slope=1.7, lowest=lowest, highest=highest, stretch=(1.0, 1.6)
        )
        field = shifted_samples(field, rows, columns)
        thick = smoothstep(-0.9, 1.3, spectral_noise(rng, shape, slope=1.8, lowest=1, highest=8))
        vein = np.exp(-np.abs(field) * sharp) + 0.28 * np.exp(-np.abs(field) * sharp / 5)
        share = np.maximum(share, strength * vein * thick)
    cloud = spectral_noise(rng, shape, slope=1.8, lowest=1, highest=30)
    depth = share + 0.022 * cloud
    return Pattern(tile_m, centred(depth, 9.0), np.zeros(shape), 1.0 + 0.1 * share, 0.1)


def quartz(rng: np.random.Generator, px: int) -> Pattern:
    """Engineered stone: grains of quartz of a few millimetres, pale and dark."""
    tile_m, shape = (0.4, 0.4), (px, px)
    number, inside = grains(rng, px, 150)
    tone = np.clip(rng.standard_normal(150 * 150), -2.0, 2.0)
    dark = rng.random(150 * 150) < 0.05
    pale = tone[number] * smoothstep(0.0, 0.3, inside)
    flecks = dark[number] * smoothstep(0.1, 0.25, inside)
    depth = 0.028 * blurred(pale, px / 900) + 0.2 * blurred(flecks, px / 900)
    return Pattern(tile_m, centred(depth, 6.0), np.zeros(shape), 1.0 + 0.05 * pale, 0.1)


def ceramic(rng: np.random.Generator, px: int) -> Pattern:
    """Stoneware under glaze: it pools a little, and specks of iron show."""
    tile_m, shape = (0.25, 0.25), (px, px)
    pooled = spectral_noise(rng, shape, slope=1.7, lowest=2, highest=40)
    _, inside = grains(rng, px, 40)
    size = spectral_noise(rng, shape, slope=1.0, lowest=8)
    specks = smoothstep(0.0, 0.1, inside - 0.5 + 0.05 * size)
    depth = 0.035 * pooled + 0.22 * specks
    height_m = 0.00007 * spectral_noise(rng, shape, slope=2.0, lowest=3, highest=24)
    return Pattern(tile_m, centred(depth, 5.0), height_m, 1.0 + 0.1 * pooled, 0.7)


def concrete(rng: np.random.Generator, px: int) -> Pattern:
    """Cast concrete: clouds, sand, small blow holes."""
    tile_m, shape = (1.0, 1.0), (px, px)
    cloud = spectral_noise(rng, shape, slope=1.7, lowest=1, highest=60)
    sand = spectral_noise(rng, shape, slope=0.3, lowest=px / 10)
    _, inside = grains(rng, px, 40)
    size = spectral_noise(rng, shape, slope=0.8, lowest=8)
    holes = smoothstep(0.0, 0.08, inside - 0.54 + 0.045 * size)
    depth = 0.055 * cloud + 0.03 * sand + 0.28 * holes
    height_m = 0.00012 * sand + 0.0002 * cloud - 0.0015 * blurred(holes, 0.6)
    return Pattern(tile_m, centred(depth, 5.0), height_m, 1.0 + 0.05 * cloud, 0.4, 0.008 * cloud)


def terracotta(rng: np.random.Generator, px: int) -> Pattern:
    """Fired clay: sand, lime bloom, faint rings of the wheel along u."""
    tile_m, shape = (0.3, 0.3), (px, px)
    sand = spectral_noise(rng, shape, slope=0.3, lowest=px / 10)
    bloom = spectral_noise(rng, shape, slope=1.7, lowest=1, highest=40)
    rings = spectral_noise(rng, shape, slope=0.8, lowest=8, highest=80, stretch=(24.0, 1.0))
    depth = 0.045 * sand - 0.06 * bloom + 0.03 * rings
    height_m = 0.00009 * sand + 0.00016 * rings
    return Pattern(tile_m, centred(depth), height_m, 1.0 + 0.04 * sand, 0.9, -0.015 * bloom)
