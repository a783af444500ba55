"""Cloth, leather and paper. Threads have their true width, in metres."""

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


def weave(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Upholstery: plain weave of 2.6 mm yarn, no two of one colour."""
    return _plain_weave(rng, ground, threads=80, melange=0.085, slub=0.1, relief_m=0.00065)


def linen(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Sheets, curtains, book cloth: plain weave of 1.25 mm thread, thick and thin."""
    return _plain_weave(rng, ground, threads=160, melange=0.055, slub=0.28, relief_m=0.00022)


def _plain_weave(
    rng: np.random.Generator, ground: Ground, *, threads: int, melange: float, slub: float,
    relief_m: float,
) -> Pattern:  # fmt: skip
    """threads: how many cross the tile, an even number. melange: how much yarns differ in tone.
    slub: how much a thread's thickness varies."""
    per_m = threads / ground.tile_m[0]
    x, y = (
        place * np.float32(per_m) + 0.13 * noise(rng, ground, 1.6, longest_m=0.1, shortest_m=0.005)
        for place in (ground.x_m[None, :], ground.y_m[:, None])
    )
    warp, warp_tone = _threads(rng, ground, threads, x, y, slub, upright=True)
    weft, weft_tone = _threads(rng, ground, threads, y, x, slub, upright=False)
    upper = warp >= weft
    top = np.where(upper, warp, weft)
    tone = np.where(upper, warp_tone, weft_tone)
    # Fibres are spun: fine lines run slantwise over each thread.
    spun = np.sin(np.float32(2 * np.pi) * (x * 2.0 + y * 3.0))
    spun = np.where(upper, spun, -spun)
    fuzz = noise(rng, ground, 0.2, longest_m=0.004)
    depth = 0.34 * (1.0 - smoothstep(-0.5, 1.5, top)) + melange * tone + 0.02 * spun + 0.025 * fuzz
    height_m = relief_m * 0.5 * blurred(top, ground, 0.00018) + 0.03 * relief_m * fuzz
    return Pattern(ground, centred(depth), height_m, 1.0 + 0.02 * fuzz, 0.35)


def _threads(
    rng: np.random.Generator, ground: Ground, threads: int, across: Raster, along: Raster,
    slub: float, *, upright: bool,
) -> tuple[Raster, Raster]:  # fmt: skip
    """Height, about -1.5 to 1.5, and tone of the threads that run one way."""
    index = np.floor(across).astype(np.int32)
    offset = across - index.astype(np.float32) - 0.5
    thread_m = ground.tile_m[0] / threads
    stretch = (1.0, 14.0) if upright else (14.0, 1.0)
    thick = noise(rng, ground, 0.6, longest_m=0.034, shortest_m=thread_m, stretch=stretch)
    radius = 0.5 * np.clip(1.0 + slub * 0.5 * thick, 0.55, 1.35)
    belly = np.sqrt(np.clip(1.0 - (offset / radius) ** 2, 0.0, 1.0))
    rise = np.sin(np.float32(np.pi) * along)
    over = np.where((index % 2 == 0) == upright, rise, -rise)
    dye = np.clip(rng.standard_normal(threads), -1.6, 1.6).astype(np.float32)[index % threads]
    drift = noise(rng, ground, 0.9, longest_m=0.05, shortest_m=thread_m, stretch=stretch)
    return belly + 0.6 * over - 0.6, 0.55 * dye + 0.6 * drift


def crumpled(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Bed linen that was washed, slept in and not ironed: creases of 2 to 20 cm.

    Its threads are finer than a pixel of so wide a tile.
    """
    x_m, y_m = (
        place + 0.011 * noise(rng, ground, 1.2, longest_m=0.45, shortest_m=0.075)
        for place in (ground.x_m[None, :], ground.y_m[:, None])
    )
    height_m = even(ground, 0.0)
    # Cloth bends along lines and is even between them: noise folded at its zeros has such lines.
    for longest_m, shortest_m, high_m in (
        (0.3, 0.1, 0.004),
        (0.11, 0.05, 0.0016),
        (0.056, 0.028, 0.0004),
    ):
        for sign in (1.0, -1.0):
            folded = np.abs(noise(rng, ground, 0.8, longest_m=longest_m, shortest_m=shortest_m))
            there = smoothstep(-1.6, 1.4, noise(rng, ground, 0.8, longest_m=0.45, shortest_m=0.13))
            height_m += sign * high_m * there * folded
    height_m = blurred(looked_up(height_m, ground, x_m, y_m), ground, 0.0028)
    hollow = height_m - blurred(height_m, ground, 0.0375)
    fuzz = noise(rng, ground, 0.2, longest_m=0.014)
    depth = -9.0 * hollow + 0.02 * fuzz
    return Pattern(ground, centred(depth), height_m, 1.0 + 0.02 * fuzz, 0.35)


def knit(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Stocking stitch of thick wool: columns of V, 8 mm apart."""
    waver = 0.09 * noise(rng, ground, 1.8, longest_m=0.096, shortest_m=0.008)
    x = ground.x_m[None, :] / np.float32(0.008) + waver
    y = ground.y_m[:, None] / np.float32(0.006) + waver
    # Both legs of a V lean outwards as they rise.
    leg = np.abs(x - np.floor(x) - 0.5)
    lean = y - 1.5 * leg
    lean -= np.floor(lean)
    strand = np.sqrt(np.clip(1.0 - ((lean - 0.5) / 0.5) ** 2, 0.0, 1.0))
    column = np.sqrt(np.clip(1.0 - ((leg - 0.25) / 0.27) ** 2, 0.0, 1.0))
    top = strand * column
    fuzz = noise(rng, ground, 0.25, longest_m=0.006)
    ply = np.sin(np.float32(2 * np.pi) * (3.0 * lean + 5.0 * leg))
    drift = noise(rng, ground, 1.0, longest_m=0.048, shortest_m=0.0032)
    depth = 0.52 * (1.0 - top) + 0.035 * ply + 0.05 * fuzz + 0.04 * drift
    height_m = 0.0021 * blurred(top, ground, 0.00038) + 0.00012 * fuzz + 0.0001 * ply
    return Pattern(ground, centred(depth), height_m, even(ground, 1.0), 0.3)


def boucle(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Loops of curled yarn, 5 to 8 mm, in all directions."""
    top = even(ground, -1.0)
    for _ in range(3):
        x_m, y_m = (
            place + 0.0022 * noise(rng, ground, 0.6, longest_m=0.017, shortest_m=0.006)
            for place in (ground.x_m[None, :], ground.y_m[:, None])
        )
        loops = noise(rng, ground, 0.0, longest_m=0.012, shortest_m=0.00706)
        # A yarn is where a field passes zero: a line that closes on itself. Others lie over it.
        line = looked_up(loops, ground, x_m, y_m) / 0.62
        yarn = np.sqrt(np.clip(1.0 - line * line, 0.0, 1.0))
        level = noise(rng, ground, 0.2, longest_m=0.015, shortest_m=0.008)
        top = np.maximum(top, yarn - 0.35 - 0.14 * level)
    top = blurred(np.clip(top, -0.6, 1.0), ground, 0.0003)
    fuzz = noise(rng, ground, 0.2, longest_m=0.0056)
    depth = 0.27 * (1.0 - top) + 0.03 * fuzz
    return Pattern(ground, centred(depth), 0.0017 * top + 0.0001 * fuzz, even(ground, 1.0), 0.3)


def velvet(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Short pile that hands have brushed this way and that."""
    brushed = np.tanh(noise(rng, ground, 2.0, shortest_m=0.025, stretch=(1.0, 1.8)))
    crushed = noise(rng, ground, 1.2, longest_m=0.0625, shortest_m=0.0071)
    pile = noise(rng, ground, 0.1, longest_m=0.0078)
    depth = 0.075 * brushed + 0.035 * crushed + 0.035 * pile
    height_m = 0.00032 * crushed + 0.00007 * pile
    return Pattern(ground, centred(depth), height_m, 1.0 - 0.06 * brushed, 0.7)


def leather(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Pebbled hide: grains of 1.5 to 3 mm, creases, a little wear."""
    grain = smoothstep(0.0, 0.22, grains(rng, ground, 130)[1])
    folds = smoothstep(0.0, 0.12, grains(rng, ground, 46)[1])
    presence = noise(rng, ground, 1.6, longest_m=0.15, shortest_m=0.0125)
    worn = noise(rng, ground, 1.7, shortest_m=0.015)
    fine = noise(rng, ground, 0.4, longest_m=0.0059)
    relief = 0.62 * grain + 0.38 * (1.0 - smoothstep(-0.6, 1.0, presence) * (1.0 - folds))
    depth = 0.3 * (1.0 - relief) + 0.055 * worn + 0.02 * fine
    height_m = 0.00021 * blurred(relief, ground, 0.00041) + 0.000008 * fine
    roughness = 1.0 + 0.28 * (0.75 - relief) - 0.07 * np.clip(worn, -2.0, 2.0)
    return Pattern(ground, centred(depth), height_m, roughness, 0.9, 0.012 * worn)


def paper(rng: np.random.Generator, ground: Ground) -> Pattern:
    """Laid fibres, hardly seen."""
    fibres = noise(rng, ground, 0.6, longest_m=0.01, shortest_m=0.001, stretch=(2.0, 1.0))
    cloud = noise(rng, ground, 1.8, shortest_m=0.01)
    depth = 0.016 * fibres + 0.012 * cloud
    return Pattern(ground, centred(depth), 0.00003 * fibres, even(ground, 1.0), 0.4)
