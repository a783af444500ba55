"""Carpets and mats, as thick as their weave or pile, with a picture of their own size."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, partial
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import Size, Solid, loft, welded
from chord_usd.library.surfaces.drawn import DrawnFinishes
from chord_usd.library.surfaces.finishes import Finish
from chord_usd.library.surfaces.textiles import TEXTILES
from chord_usd.library.textiles import rug_patterns
from chord_usd.library.textiles.rug_patterns import Pattern, Rgb, woven

Shape = Literal["rectangle", "round"]

_FRINGE_M = 0.045
_TASSEL_EACH_M = 0.014
_TASSEL_HIGH_M = 0.004
_ROUND_M = 0.008
"""Radius, at most, with which pile turns down at the edge."""

_BINDING_M = 0.0045
"""Half the width of the tape around a bound edge."""

_BINDING_HIGH = 0.8
"""Height of that tape over the carpet's: pile stands above it."""


@dataclass(frozen=True)
class _Weave:
    """A pattern with its colours: one family of carpets."""

    name: str
    pattern: Pattern
    palettes: Mapping[str, tuple[Rgb, ...]]
    yarn: float = 0.07
    pile: float = 0.05
    bound: int | None = None
    """Which of its colours the tape around its edge has; None for an edge without."""


def _finish_name(weave: _Weave, colour: str) -> str:
    return f"{colour}_wool_{weave.name.lower()}"


def _woven(weave: _Weave, colour: str, length_m: float, width_m: float) -> Finish:
    palette = weave.palettes[colour]
    picture = woven(weave.pattern, palette, length_m, width_m, 7, weave.yarn, weave.pile)
    return Finish(palette[0], 0.97, texture=picture)


def rug(
    size_m: Size, *, shape: Shape = "rectangle", fringed: bool = False, shaggy_m: float = 0.0,
    bound: bool = False,
) -> tuple[Part, ...]:  # fmt: skip
    """A carpet, its picture's u along the length; fringes lie at both ends of the length.

    bound: a tape goes around its edge.
    """
    length, width, height = size_m
    body = length - 2 * (_FRINGE_M - 0.003) if fringed else length
    outline = _circle(length, width) if shape == "round" else _rectangle(body, width)
    if shaggy_m:
        outline = _frayed(outline, shaggy_m, body, width)
    plate = _pile(outline, height, _BINDING_M if bound else 0.0)
    share = plate.points_m[:, :2] / [body, width] + 0.5
    parts = [Part("Rug", plate, "rug", None, uvs=share[plate.faces.reshape(-1)])]
    if fringed:
        tall = min(height / 2, _TASSEL_HIGH_M)
        parts.append(Part("Fringe", _tassels(length, width, tall), "fringe", None))
    if bound:
        parts.append(Part("Binding", _binding(outline, _BINDING_HIGH * height), "binding", None))
    return tuple(parts)


def _inset(outline: FloatArray, by_m: float, z_m: float) -> FloatArray:
    """(N, 3) the outline drawn in from all sides, at a height."""
    middle = (outline.min(axis=0) + outline.max(axis=0)) / 2
    flat = middle + (outline - middle) * (1.0 - 2 * by_m / np.ptp(outline, axis=0))
    return np.column_stack([flat, np.full(len(flat), z_m)])


def _pile(outline: FloatArray, height: float, within_m: float) -> Solid:
    """What one walks on: round at its upper edge, drawn in a little at the floor."""
    radius = min(0.7 * height, _ROUND_M)
    turn = np.radians([0.0, 30.0, 60.0, 90.0])
    insets = [0.25 * radius, *radius * (1.0 - np.cos(turn)), 3 * radius]
    heights = [0.0, *(height - radius + radius * np.sin(turn)), height]
    return loft([_inset(outline, within_m + b, z) for b, z in zip(insets, heights, strict=True)])


def _binding(outline: FloatArray, height: float) -> Solid:
    """A tape sewn around the edge."""
    turn = np.radians(np.arange(-90.0, 270.0, 45.0))
    sections = zip(_BINDING_M * (1.0 - np.cos(turn)), height / 2 * (1.0 + np.sin(turn)),
                   strict=True)  # fmt: skip
    return loft([_inset(outline, by, z) for by, z in sections], loop=True)


def _rectangle(length: float, width: float) -> FloatArray:
    """Points every 4 cm along the edge, its corners a little round."""
    x, y = length / 2, width / 2
    cut = 0.008
    corners = [(x, -y + cut), (x, y - cut), (x - cut, y), (-x + cut, y), (-x, y - cut),
               (-x, -y + cut), (-x + cut, -y), (x - cut, -y)]  # fmt: skip
    points: list[tuple[float, float]] = []
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        count = max(round(math.hypot(bx - ax, by - ay) / 0.04), 1)
        points += [(ax + (bx - ax) * n / count, ay + (by - ay) * n / count) for n in range(count)]
    return np.array(points)


def _circle(length: float, width: float) -> FloatArray:
    angles = np.linspace(0.0, 2 * math.pi, 120, endpoint=False)
    return np.stack([np.cos(angles) * length / 2, np.sin(angles) * width / 2], axis=-1)


def _frayed(outline: FloatArray, by_m: float, length: float, width: float) -> FloatArray:
    rng = np.random.default_rng(round(1000 * length) * 10_007 + round(1000 * width))
    return outline * (1.0 - by_m * rng.random((len(outline), 1)) * 2 / [length, width])


def _tassels(length: float, width: float, height: float) -> Solid:
    """Flat pointed tassels at both ends, no two quite straight."""
    rng = np.random.default_rng(round(1000 * width))
    count = round(width / _TASSEL_EACH_M)
    y = (np.arange(count) + 0.5) / count * width - width / 2
    points: list[tuple[float, float, float]] = []
    faces: list[tuple[int, ...]] = []
    for side in (-1.0, 1.0):
        root, tip = side * (length / 2 - _FRINGE_M), side * length / 2
        aside = rng.uniform(-0.004, 0.004, count)
        for at, slant in zip(y, aside, strict=True):
            low, high = at - 0.0035, at + 0.0035
            base = len(points)
            points += [
                (root, low, 0.0), (root, high, 0.0), (root, high, height), (root, low, height),
                (tip - side * abs(slant), at + slant, 0.0),
            ]  # fmt: skip
            quad = [(0, 2, 1), (0, 3, 2), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)]
            quad = quad if side > 0 else [face[::-1] for face in quad]
            faces += [tuple(base + n for n in face) for face in quad]
    return welded(np.array(points), np.array(faces))


_CREAM, _OAT, _SAND = (232, 224, 208), (208, 194, 170), (190, 170, 140)
_CHARCOAL, _BLACK, _GREY = (74, 72, 72), (44, 42, 42), (160, 158, 154)
_SAGE, _MOSS = (150, 160, 138), (98, 106, 80)
_RUST, _TERRA, _BLUSH = (164, 92, 64), (182, 114, 88), (212, 178, 166)
_MUSTARD, _TAN = (196, 152, 72), (170, 130, 92)
_TEAL, _NAVY, _INDIGO, _BLUE = (64, 106, 110), (48, 60, 86), (54, 64, 94), (112, 134, 156)

_BORDERED = {
    "grey": ((196, 192, 184), _CHARCOAL), "oat": (_OAT, _CREAM), "sage": (_CREAM, _SAGE),
    "rust": (_OAT, _RUST), "navy": (_CREAM, _NAVY), "mustard": (_CREAM, _MUSTARD),
}  # fmt: skip
_STRIPED = {
    "sage": (_CREAM, _SAGE, _CHARCOAL), "blush": (_CREAM, _BLUSH, _RUST),
    "blue": (_CREAM, _BLUE, _NAVY), "mustard": (_CREAM, _MUSTARD, _CHARCOAL),
    "grey": (_CREAM, _GREY, _CHARCOAL), "indigo": (_OAT, _INDIGO, _CREAM),
}  # fmt: skip
_BERBER = {
    "cream": ((234, 228, 214), _CHARCOAL), "oat": ((216, 204, 184), (124, 92, 66)),
    "grey": ((188, 186, 182), (92, 92, 94)),
}  # fmt: skip
_ARCS = {
    "teal": (_CREAM, _OAT, _TEAL, _CHARCOAL), "mustard": (_CREAM, _OAT, _MUSTARD, _CHARCOAL),
    "rust": (_CREAM, _OAT, _RUST, _CHARCOAL), "navy": (_OAT, _CREAM, _NAVY, _TAN),
}  # fmt: skip
_PERSIAN = {
    "burgundy": ((122, 44, 46), (42, 48, 74), (204, 178, 132), (222, 206, 176), (74, 36, 40)),
    "navy": ((44, 54, 84), (124, 52, 50), (200, 176, 134), (220, 206, 180), (36, 42, 64)),
    "forest": ((62, 84, 70), (116, 56, 48), (204, 182, 140), (224, 210, 184), (48, 62, 54)),
    "gold": ((196, 168, 118), (122, 52, 48), (232, 218, 188), (84, 70, 62), (168, 138, 92)),
}  # fmt: skip
_FADED = {
    "rust": ((166, 120, 102), (104, 92, 96), (196, 176, 154), (210, 194, 176), (142, 104, 92)),
    "teal": ((112, 130, 132), (146, 112, 100), (188, 178, 162), (206, 196, 182), (96, 112, 114)),
    "charcoal": ((112, 110, 110), (152, 140, 128), (178, 170, 160), (196, 188, 178), (92, 90, 92)),
    "mustard": ((180, 152, 108), (118, 102, 96), (202, 186, 160), (216, 202, 182), (158, 132, 96)),
}  # fmt: skip
_PLAIN = {
    "grey": (_GREY, (190, 188, 184)), "oat": (_OAT, (226, 216, 198)),
    "charcoal": (_CHARCOAL, (110, 108, 108)), "moss": (_MOSS, (130, 136, 108)),
    "indigo": (_INDIGO, (90, 100, 126)), "rust": (_RUST, (190, 124, 96)),
    "tan": (_TAN, (194, 160, 124)), "terracotta": (_TERRA, (200, 142, 118)),
}  # fmt: skip
_CHECKED = {
    "grey": ((176, 174, 170), (116, 116, 116)), "oat": (_CREAM, _SAND),
    "charcoal": (_GREY, _CHARCOAL), "tan": (_OAT, _TAN),
}  # fmt: skip
_JUTE = {
    "jute": ((196, 166, 120), (150, 116, 78)), "white": ((214, 196, 164), (238, 232, 220)),
    "black": ((192, 164, 120), _BLACK),
}  # fmt: skip
_RUSH = {
    "green": ((186, 178, 122), (164, 158, 104), (72, 82, 60)),
    "black": ((196, 178, 128), (174, 156, 108), _BLACK),
    "indigo": ((194, 178, 130), (172, 156, 110), _INDIGO),
}  # fmt: skip

_P = rug_patterns
_RECTANGLES = (
    _Weave("Bordered", _P.bordered, _BORDERED, bound=1),
    _Weave("Striped", _P.stripes, _STRIPED),
    _Weave("Berber", _P.berber, _BERBER, yarn=0.11, pile=0.09),
    _Weave("Arcs", _P.arcs, _ARCS, bound=0),
    _Weave("Persian", _P.persian, _PERSIAN, pile=0.04),
    _Weave("Faded", _P.persian, _FADED, yarn=0.1, pile=0.12),
    _Weave("Plain", _P.plain, _PLAIN, yarn=0.1, pile=0.06),
    _Weave("Checked", _P.checks, _CHECKED, bound=1),
    _Weave("Rush", _P.tatami, _RUSH, pile=0.03, bound=2),
)
_ROUNDS = (
    _Weave("Jute", _P.rings, _JUTE, yarn=0.09),
    _Weave("Disc", _P.plain, _PLAIN, yarn=0.1, pile=0.06),
)

_BATH = {
    "white": ((236, 234, 228), (248, 247, 244)), "grey": ((150, 150, 148), (178, 178, 176)),
    "sage": (_SAGE, (174, 182, 164)), "charcoal": (_CHARCOAL, (104, 102, 102)),
    "sand": (_SAND, (210, 192, 166)), "navy": (_NAVY, (78, 90, 114)),
    "blush": (_BLUSH, (226, 200, 190)), "terracotta": (_TERRA, (200, 142, 118)),
}  # fmt: skip
_COIR = {
    "coir": ((146, 110, 74), (118, 86, 56)), "black": ((84, 66, 50), (48, 42, 38)),
    "grey": ((120, 112, 100), (88, 82, 74)),
}  # fmt: skip
_MATS = (
    _Weave("Bath", _P.bordered, _BATH, yarn=0.1),
    _Weave("Ribbed", _P.ribs, _BATH, yarn=0.06, bound=0),
    _Weave("Door", _P.bordered, _COIR, yarn=0.22),
)
_BY_NAME = {weave.name: weave for weave in (*_RECTANGLES, *_ROUNDS, *_MATS)}


def wool(_: str, size_m: Size, *, weave: str) -> DrawnFinishes:
    """Finishes of a carpet of this size: a picture for each palette of a weave, and its tape."""
    kind = _BY_NAME[weave]
    tapes = {}
    if kind.bound is not None:
        tapes = {
            f"{_finish_name(kind, colour)}_tape": Finish(palette[kind.bound], 0.95, surface="weave")
            for colour, palette in kind.palettes.items()
        }
    pictures = {
        _finish_name(kind, colour): cache(partial(_woven, kind, colour, *size_m[:2]))
        for colour in kind.palettes
    }
    return DrawnFinishes({**TEXTILES, **tapes}, pictures)
