"""Cloth, leather and paper. Threads have their true width, in metres."""

from __future__ import annotations

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.looks.look_noise import blurred, shifted_samples, spectral_noise
from chord_usd.library.surfaces.surface_pattern import Pattern, centred, grains, grid_m, smoothstep


def weave(rng: np.random.Generator, px: int) -> Pattern:
    """Upholstery: plain weave of 2.6 mm yarn, no two of one colour."""
    return _plain_weave(
        rng, px, side_m=0.208, threads=80, melange=0.085, slub=0.1, relief_m=0.00065
    )


def linen(rng: np.random.Generator, px: int) -> Pattern:
    """Sheets, curtains, book cloth: plain weave of 1.25 mm thread, thick and thin."""
    return _plain_weave(
        rng, px, side_m=0.2, threads=160, melange=0.055, slub=0.28, relief_m=0.00022
    )


def _plain_weave(
    rng: np.random.Generator, px: int, *, side_m: float, threads: int, melange: float,
    slub: float, relief_m: float,
) -> Pattern:  # fmt: skip
    """threads: how many cross the tile, an even number. melange: how much yarns differ in tone.
    slub: how much a thread's thickness varies."""
    tile_m, shape = (side_m, side_m), (px, px)
    u, v = grid_m(px, tile_m)
    waver = [spectral_noise(rng, shape, slope=1.6, lowest=2, highest=40) for _ in range(2)]
    x = u / side_m * threads + 0.13 * waver[0]
    y = v / side_m * threads + 0.13 * waver[1]
    warp, warp_tone = _threads(rng, px, threads, x, y, slub, upright=True)
    weft, weft_tone = _threads(rng, px, threads, y, x, slub, upright=False)
    upper = warp >= weft
    top = np.where(upper, warp, weft)
    tone = np.where(upper, warp_tone, weft_tone)
    # Fibres are spun: fine lines run slantwise over each thread.
    spun = np.sin(2 * np.pi * (x * 2.0 + y * 3.0)) * np.where(upper, 1.0, -1.0)
    fuzz = spectral_noise(rng, shape, slope=0.2, lowest=px / 10)
    depth = 0.34 * (1.0 - smoothstep(-0.5, 1.5, top)) + melange * tone + 0.02 * spun + 0.025 * fuzz
    height_m = relief_m * 0.5 * blurred(top, 0.45) + 0.03 * relief_m * fuzz
    return Pattern(tile_m, centred(depth), height_m, 1.0 + 0.02 * fuzz, 0.35)


def _threads(
    rng: np.random.Generator, px: int, threads: int, across: FloatArray, along: FloatArray,
    slub: float, *, upright: bool,
) -> tuple[FloatArray, FloatArray]:  # fmt: skip
    """Height, about -1.5 to 1.5, and tone of the threads that run one way."""
    index = np.floor(across).astype(np.int64)
    offset = across - index - 0.5
    stretch = (1.0, 14.0) if upright else (14.0, 1.0)
    thick = spectral_noise(rng, (px, px), slope=0.6, lowest=6, highest=threads, stretch=stretch)
    radius = 0.5 * np.clip(1.0 + slub * 0.5 * thick, 0.55, 1.35)
    belly = np.sqrt(np.clip(1.0 - (offset / radius) ** 2, 0.0, 1.0))
    sign = np.where((index % 2 == 0) == upright, 1.0, -1.0)
    over = sign * np.sin(np.pi * along)
    own = np.clip(rng.standard_normal(threads), -1.6, 1.6)[index % threads]
    drift = spectral_noise(rng, (px, px), slope=0.9, lowest=4, highest=threads, stretch=stretch)
    return belly + 0.6 * over - 0.6, 0.55 * own + 0.6 * drift


def crumpled(rng: np.random.Generator, px: int) -> Pattern:
    """Bed linen that was washed, slept in and not ironed: creases of 2 to 20 cm.

    Its threads are finer than a pixel of so wide a tile.
    """
    tile_m, shape = (0.9, 0.9), (px, px)
    bend = [spectral_noise(rng, shape, slope=1.2, lowest=2, highest=12) for _ in range(2)]
    rows, columns = np.indices(shape, dtype=np.float64)
    rows, columns = (one + px / 80 * way for one, way in zip((rows, columns), bend, strict=True))
    height_m = np.zeros(shape)
    # Cloth bends along lines and is even between them: noise folded at its zeros has such lines.
    for lowest, highest, high_m in ((3, 9, 0.004), (8, 18, 0.0016), (16, 32, 0.0004)):
        for sign in (1.0, -1.0):
            folded = np.abs(spectral_noise(rng, shape, slope=0.8, lowest=lowest, highest=highest))
            there = smoothstep(
                -1.6, 1.4, spectral_noise(rng, shape, slope=0.8, lowest=2, highest=7)
            )
            height_m += sign * high_m * there * folded
    height_m = blurred(shifted_samples(height_m, rows, columns), px / 320)
    hollow = height_m - blurred(height_m, px / 24)
    fuzz = spectral_noise(rng, shape, slope=0.2, lowest=px / 8)
    depth = -9.0 * hollow + 0.02 * fuzz
    return Pattern(tile_m, centred(depth), height_m, 1.0 + 0.02 * fuzz, 0.35)


def knit(rng: np.random.Generator, px: int) -> Pattern:
    """Stocking stitch of thick wool: columns of V, 8 mm apart."""
    columns, rows = 24, 32
    tile_m, shape = (0.192, 0.192), (px, px)
    u, v = grid_m(px, tile_m)
    waver = spectral_noise(rng, shape, slope=1.8, lowest=2, highest=24)
    x, y = u / tile_m[0] * columns + 0.09 * waver, v / tile_m[1] * rows + 0.09 * waver
    side = x % 1.0 - 0.5
    # Both legs of a V lean outwards as they rise.
    leg = np.abs(side)
    lean = (y - 1.5 * leg) % 1.0
    strand = np.sqrt(np.clip(1.0 - ((lean - 0.5) / 0.5) ** 2, 0.0, 1.0))
    column = np.sqrt(np.clip(1.0 - ((leg - 0.25) / 0.27) ** 2, 0.0, 1.0))
    top = strand * column
    fuzz = spectral_noise(rng, shape, slope=0.25, lowest=px / 16)
    ply = np.sin(2 * np.pi * (3.0 * lean + 5.0 * leg))
    drift = spectral_noise(rng, shape, slope=1.0, lowest=4, highest=60)
    depth = 0.52 * (1.0 - top) + 0.035 * ply + 0.05 * fuzz + 0.04 * drift
    height_m = 0.0021 * blurred(top, px / 512) + 0.00012 * fuzz + 0.0001 * ply
    return Pattern(tile_m, centred(depth), height_m, np.ones(shape), 0.3)


def boucle(rng: np.random.Generator, px: int) -> Pattern:
    """Loops of curled yarn, 5 to 8 mm, in all directions."""
    tile_m, shape = (0.24, 0.24), (px, px)
    rows, columns = np.indices(shape, dtype=np.float64)
    reach = px / 110
    top = np.full(shape, -1.0)
    for _ in range(3):
        bend = [spectral_noise(rng, shape, slope=0.6, lowest=14, highest=40) for _ in range(2)]
        field = spectral_noise(rng, shape, slope=0.0, lowest=20, highest=34)
        field = shifted_samples(field, rows + reach * bend[0], columns + reach * bend[1])
        # A yarn is where a field passes zero: a line that closes on itself. Others lie over it.
        yarn = np.sqrt(np.clip(1.0 - (field / 0.62) ** 2, 0.0, 1.0))
        level = 0.4 * spectral_noise(rng, shape, slope=0.2, lowest=16, highest=30)
        top = np.maximum(top, yarn - 0.35 * (1.0 + level))
    top = blurred(np.clip(top, -0.6, 1.0), px / 800)
    fuzz = spectral_noise(rng, shape, slope=0.2, lowest=px / 12)
    depth = 0.27 * (1.0 - top) + 0.03 * fuzz
    return Pattern(tile_m, centred(depth), 0.0017 * top + 0.0001 * fuzz, np.ones(shape), 0.3)


def velvet(rng: np.random.Generator, px: int) -> Pattern:
    """Short pile that hands have brushed this way and that."""
    tile_m, shape = (0.5, 0.5), (px, px)
    brushed = spectral_noise(rng, shape, slope=2.0, lowest=1, highest=20, stretch=(1.0, 1.8))
    crushed = spectral_noise(rng, shape, slope=1.2, lowest=8, highest=70)
    pile = spectral_noise(rng, shape, slope=0.1, lowest=px / 8)
    depth = 0.075 * np.tanh(brushed) + 0.035 * crushed + 0.035 * pile
    height_m = 0.00032 * crushed + 0.00007 * pile
    return Pattern(tile_m, centred(depth), height_m, 1.0 - 0.06 * np.tanh(brushed), 0.7)


def leather(rng: np.random.Generator, px: int) -> Pattern:
    """Pebbled hide: grains of 1.5 to 3 mm, creases, a little wear."""
    tile_m, shape = (0.3, 0.3), (px, px)
    _, inside = grains(rng, px, 130)
    grain = smoothstep(0.0, 0.22, inside)
    _, wide = grains(rng, px, 46)
    folds = smoothstep(0.0, 0.12, wide)
    presence = smoothstep(-0.6, 1.0, spectral_noise(rng, shape, slope=1.6, lowest=2, highest=24))
    worn = spectral_noise(rng, shape, slope=1.7, lowest=1, highest=20)
    fine = spectral_noise(rng, shape, slope=0.4, lowest=px / 10)
    relief = 0.62 * grain + 0.38 * (1.0 - presence * (1.0 - folds))
    depth = 0.3 * (1.0 - relief) + 0.055 * worn + 0.02 * fine
    height_m = 0.00021 * blurred(relief, 0.7) + 0.000008 * fine
    roughness = 1.0 + 0.28 * (0.75 - relief) - 0.07 * np.clip(worn, -2.0, 2.0)
    return Pattern(tile_m, centred(depth), height_m, roughness, 0.9, 0.012 * worn)


def paper(rng: np.random.Generator, px: int) -> Pattern:
    """Laid fibres, hardly seen."""
    tile_m, shape = (0.2, 0.2), (px, px)
    fibres = spectral_noise(rng, shape, slope=0.6, lowest=20, highest=200, stretch=(2.0, 1.0))
    cloud = spectral_noise(rng, shape, slope=1.8, lowest=1, highest=20)
    depth = 0.016 * fibres + 0.012 * cloud
    return Pattern(tile_m, centred(depth), 0.00003 * fibres, np.ones(shape), 0.4)
