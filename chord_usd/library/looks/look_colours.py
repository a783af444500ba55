"""Colours of wall and floor looks: woods and stones by name, and arithmetic of colours."""

from __future__ import annotations

import numpy as np

from chord_usd.library.textures.fields import Raster, Rgb

WOODS: dict[str, tuple[Rgb, Rgb]] = {
    "white_oak": ((196, 180, 158), (226, 214, 196)),
    "pale_oak": ((188, 160, 124), (222, 200, 168)),
    "birch": ((204, 174, 134), (230, 208, 174)),
    "hinoki": ((206, 168, 122), (232, 202, 160)),
    "oak": ((152, 112, 72), (200, 162, 116)),
    "grey_oak": ((128, 118, 106), (178, 168, 154)),
    "cherry": ((116, 70, 46), (160, 106, 74)),
    "walnut": ((76, 55, 41), (122, 93, 70)),
    "smoked_oak": ((74, 58, 45), (116, 94, 74)),
    "dark_walnut": ((50, 35, 26), (88, 64, 47)),
    "larch": ((126, 90, 62), (172, 130, 94)),
    "black_stain": ((32, 29, 27), (60, 56, 52)),
}
"""Colour of the late and of the early wood."""

MARBLES: dict[str, tuple[Rgb, Rgb, Rgb]] = {
    "carrara": ((238, 237, 234), (150, 152, 156), (206, 208, 210)),
    "calacatta": ((244, 241, 234), (158, 138, 112), (214, 208, 200)),
    "crema": ((232, 222, 204), (178, 152, 120), (216, 202, 178)),
    "grey": ((134, 134, 134), (214, 212, 208), (112, 112, 114)),
    "nero": ((30, 30, 32), (196, 192, 186), (48, 48, 50)),
    "verde": ((38, 62, 50), (164, 188, 172), (58, 86, 70)),
}
"""Ground, veins, clouds."""

CHIPS: dict[str, tuple[Rgb, ...]] = {
    "mixed": ((178, 172, 164), (120, 116, 112), (196, 150, 122), (150, 160, 152), (244, 241, 236)),
    "grey": ((186, 186, 184), (140, 140, 140), (96, 97, 98), (232, 231, 228)),
    "warm": ((206, 176, 144), (176, 136, 104), (226, 208, 184), (150, 118, 92)),
    "rose": ((206, 156, 142), (178, 118, 104), (232, 204, 194), (150, 142, 138)),
    "dark": ((210, 206, 198), (132, 128, 122), (168, 140, 112), (92, 92, 92)),
}
"""Chips of terrazzo."""


def rgb_of(colour: str) -> Rgb:
    """A colour written as #rrggbb."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def mixed(low: Rgb | Raster, high: Rgb | Raster, amount: Raster) -> Raster:
    """(H, W, 3) colours between low (0) and high (1); each a colour or (H, W, 3)."""
    start, end = np.asarray(low, dtype=np.float32), np.asarray(high, dtype=np.float32)
    share = np.clip(amount, 0.0, 1.0).astype(np.float32, copy=False)
    mix = np.empty(
        (*np.broadcast_shapes(share.shape, start.shape[:-1], end.shape[:-1]), 3), np.float32
    )
    # A channel at a time: innermost loops of three are slow.
    for channel in range(3):
        first = start[..., channel]
        mix[..., channel] = first + (end[..., channel] - first) * share
    return mix


def lit(rgb: Raster, gain: Raster) -> Raster:
    """Colours made lighter or darker by a factor per pixel."""
    factor = gain.astype(np.float32, copy=False)
    light = np.empty((*np.broadcast_shapes(rgb.shape[:-1], factor.shape), 3), dtype=np.float32)
    for channel in range(3):
        np.multiply(rgb[..., channel], factor, out=light[..., channel])
    return light


def toned(rgb: Rgb, tone: float) -> Rgb:
    """A colour made lighter (tone up to 1) or darker (down to -1)."""
    end = 255.0 if tone > 0.0 else 0.0
    red, green, blue = (round(value + (end - value) * 0.3 * abs(tone)) for value in rgb)
    return red, green, blue


def plain(shape: tuple[int, int], rgb: Rgb) -> Raster:
    """(H, W, 3) of one colour."""
    return np.broadcast_to(np.array(rgb, dtype=np.float32), (*shape, 3))
