"""Pictures of woven carpets, as wide and long as the carpet, drawn from their size and a seed."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from PIL import Image

from chord_usd.base.scene.types import FloatArray

PX_PER_M = 260
"""Threads of about 4 mm."""

Rgb = tuple[int, int, int]
Pattern = Callable[[FloatArray, FloatArray, float, float, np.random.Generator], FloatArray]
"""(x, y, length, width, rng) in metres from the middle to indices of the palette, as floats."""


@lru_cache(maxsize=8)
def woven(
    pattern: Pattern, palette: tuple[Rgb, ...], length_m: float, width_m: float, seed: int,
    yarn: float = 0.07, pile: float = 0.05,
) -> Image.Image:  # fmt: skip
    """The carpet's picture, u along its length.

    yarn: how much threads differ in tone; pile: how much patches of the pile do.
    """
    rng = np.random.default_rng(seed)
    columns, rows = (max(round(side * PX_PER_M), 16) for side in (length_m, width_m))
    x = ((np.arange(columns) + 0.5) / columns - 0.5) * length_m
    y = (0.5 - (np.arange(rows) + 0.5) / rows) * width_m
    xx, yy = np.meshgrid(x, y)
    # Hands do not weave straight: the pattern wavers by a few millimetres.
    waver = 0.004 * _blurred_noise(rng, rows, columns, 60)
    index = pattern(xx + waver, yy - waver[::-1], length_m, width_m, rng)
    colours = np.array(palette, dtype=np.float64)
    low = np.clip(np.floor(index).astype(int), 0, len(palette) - 1)
    high = np.clip(low + 1, 0, len(palette) - 1)
    share = np.clip(index - low, 0.0, 1.0)[..., None]
    rgb = colours[low] * (1 - share) + colours[high] * share
    rows_tone = rng.normal(0.0, yarn * 0.5, (rows, 1)) + rng.normal(0.0, yarn * 0.35, (1, columns))
    tone = 1.0 + rows_tone + rng.normal(0.0, yarn, (rows, columns))
    tone += pile * _blurred_noise(rng, rows, columns, 40)
    rgb = np.clip(rgb * tone[..., None], 0, 255)
    return Image.fromarray(np.round(rgb).astype(np.uint8))


def _blurred_noise(rng: np.random.Generator, rows: int, columns: int, cell_px: int) -> FloatArray:
    """Smooth noise of about unit size, a knot every cell_px."""
    shape = (max(rows // cell_px, 2) + 1, max(columns // cell_px, 2) + 1)
    coarse = Image.fromarray(rng.normal(0.0, 1.0, shape).astype(np.float32))
    return np.asarray(coarse.resize((columns, rows), Image.Resampling.BICUBIC), dtype=np.float64)


def edge_distance(x: FloatArray, y: FloatArray, length: float, width: float) -> FloatArray:
    """Metres to the nearest edge."""
    return np.minimum(length / 2 - np.abs(x), width / 2 - np.abs(y))


def bordered(x, y, length, width, rng):
    """A plain field with two bands along the edge."""
    edge = edge_distance(x, y, length, width) / min(1.0, 0.5 + 0.4 * width)
    return np.where(edge < 0.055, 1.0, np.where((edge > 0.09) & (edge < 0.102), 1.0, 0.0))


def plain(x, y, length, width, rng):
    """A field of one colour with a little of the second in it."""
    return 0.35 * _blurred_noise(rng, len(x), x.shape[1], 5).clip(0.0, 1.0)


def stripes(x, y, length, width, rng):
    """Bands across the length, broad and fine, mirrored about the middle."""
    at = np.abs(x) / max(length / 2, 1e-6)
    codes = np.zeros_like(x)
    for middle, half, colour in ((0.93, 0.03, 1), (0.85, 0.012, 2), (0.8, 0.012, 1),
                                 (0.55, 0.02, 2), (0.5, 0.008, 1), (0.16, 0.03, 1),
                                 (0.08, 0.01, 2)):  # fmt: skip
        codes[np.abs(at - middle) < half] = colour
    return codes


def ribs(x, y, length, width, rng):
    """Ribs along the length."""
    return 0.5 + 0.5 * np.sin(2 * np.pi * y / 0.024)


def berber(x, y, length, width, rng):
    """Thin dark lozenges on pale wool, none quite like the next."""
    pitch = 0.42
    u, v = x / pitch, y / (pitch * 1.3)
    skew = 0.05 * _blurred_noise(rng, len(x), x.shape[1], 90)
    a = np.abs(((u + v + skew) % 1.0) - 0.5)
    b = np.abs(((u - v - skew) % 1.0) - 0.5)
    line = np.minimum(a, b)
    codes = np.clip(1.6 - line / 0.022, 0.0, 1.0)
    inner = np.clip(1.4 - np.abs(np.maximum(a, b) - 0.34) / 0.014, 0.0, 1.0)
    return np.maximum(codes, np.where(np.floor(u + v) % 3 == 0, inner, 0.0))


def checks(x, y, length, width, rng):
    """Large checks of two tones."""
    return ((np.floor(x / 0.3 + 0.5) + np.floor(y / 0.3 + 0.5)) % 2).astype(np.float64)


def arcs(x, y, length, width, rng):
    """Calm large shapes: an arch, a disc and a field, as on modern tufted carpets."""
    codes = np.zeros_like(x)
    codes[x + 0.35 * np.sin(2.2 * y + 0.6) > 0.12 * length] = 1
    disc = np.hypot(x + 0.18 * length, y - 0.12 * width)
    codes[disc < 0.27 * width] = 2
    ring = np.hypot(x - 0.3 * length, y + 0.5 * width)
    codes[np.abs(ring - 0.42 * width) < 0.012] = 3
    codes[np.abs(ring - 0.34 * width) < 0.012] = 3
    return codes


def rings(x, y, length, width, rng):
    """Braided rings around the middle, of two tones."""
    around = np.hypot(x, y)
    braid = 0.004 * np.sin(160 * np.arctan2(y, x) * np.maximum(around, 0.05))
    ring = (around + braid) / 0.026
    codes = 0.25 * (np.floor(ring) % 2)
    return np.where((around > 0.36 * length) & (around < 0.42 * length), 1.0, codes)


def tatami(x, y, length, width, rng):
    """Rush in fine ribs, bound with cloth along the long edges."""
    rib = 0.5 + 0.5 * np.sin(2 * np.pi * x / 0.012)
    return np.where(np.abs(y) > width / 2 - 0.028, 2.0, 0.6 * rib)


def persian(x, y, length, width, rng):
    """A medallion in a field of flowers, guard stripes and a broad border of rosettes."""
    edge = edge_distance(x, y, length, width)
    border = min(0.13 * width, 0.26)
    codes = np.zeros_like(x)
    field_l, field_w = length / 2 - border, width / 2 - border
    u, v = np.abs(x), np.abs(y)
    # Field: a lattice of small flowers on curling stems.
    pitch = 0.17
    row = np.floor(v / pitch)
    a, b = (u + (row % 2) * pitch / 2) % pitch - pitch / 2, v % pitch - pitch / 2
    codes[_flower(a, b, 0.045, 5)] = 3
    codes[np.hypot(a, b) < 0.012] = 2
    vine = np.abs(b - 0.03 * np.sin(2 * np.pi * u / pitch)) < 0.004
    codes[vine & (codes == 0)] = 4
    # Medallion: lobed rings, and pendants along the length.
    radius = np.hypot(u / 1.25, v)
    lobes = 1.0 + 0.08 * np.cos(16 * np.arctan2(v * 1.25, u))
    size = 0.62 * field_w
    for share, colour in ((1.0, 2), (0.94, 1), (0.72, 2), (0.68, 0), (0.45, 3), (0.4, 1),
                          (0.2, 2), (0.12, 3)):  # fmt: skip
        codes[radius < share * size * lobes] = colour
    inner = (radius > 0.74 * size * lobes) & (radius < 0.92 * size * lobes)
    petal = np.cos(24 * np.arctan2(v * 1.25, u)) > 0.6
    codes[inner & petal] = 3
    pendant = np.abs(u - 1.25 * size - 0.09) / 1.4 + v < 0.075
    codes[pendant] = 1
    # Spandrels: quarter medallions in the corners of the field.
    corner = np.hypot((field_l - u) / 1.2, field_w - v)
    wave = 1.0 + 0.07 * np.cos(14 * np.arctan2(field_w - v, field_l - u))
    for share, colour in ((1.0, 2), (0.93, 1), (0.6, 2), (0.55, 3), (0.3, 1)):
        codes[corner < share * 0.55 * field_w * wave] = colour
    return _persian_border(codes, x, y, length, width, edge, border)


def _persian_border(codes, x, y, length, width, edge, border):
    along = np.where(length / 2 - np.abs(x) < width / 2 - np.abs(y), np.abs(y), np.abs(x))
    inside = edge < border
    codes = np.where(inside, 1.0, codes)
    guard = (edge > border * 0.86) | (edge < border * 0.2)
    codes = np.where(inside & guard, 4.0, codes)
    dots = (np.floor(along / 0.02) % 2 == 0) & guard & (np.abs((edge / border) % 0.8 - 0.1) < 0.05)
    codes = np.where(inside & dots, 2.0, codes)
    middle = edge - border * 0.53
    pitch = 0.15
    a = along % pitch - pitch / 2
    rosette = _flower(a, middle, border * 0.22, 8) & inside
    codes = np.where(rosette, 3.0, codes)
    codes = np.where(inside & (np.hypot(a, middle) < border * 0.07), 2.0, codes)
    bud = (np.hypot(along % pitch - 0.0, middle * 0.8) < border * 0.09) & inside
    codes = np.where(bud, 2.0, codes)
    for at in (0.2, 0.86, 0.995):
        codes = np.where(np.abs(edge - border * at) < 0.005, 2.0, codes)
    return np.where(edge < 0.016, 1.0, codes)


def _flower(a, b, size, petals):
    """Where a flower of this radius around (0, 0) is."""
    return np.hypot(a, b) < size * (0.72 + 0.28 * np.cos(petals * np.arctan2(b, a)))
