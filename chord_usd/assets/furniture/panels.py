"""Panels on the wall behind a bed or a sofa, and pictures. Their back is against the wall (+y)."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from chord_usd.assets.dressing.textiles import TEXTILES
from chord_usd.assets.model import Design, Part, Style, editions, steps
from chord_usd.assets.solids import (
    Size,
    Solid,
    block,
    box,
    joined,
    lathe,
    loft,
    mirrored_pair,
    ring,
)


def padded_panel(size_m: Size, *, rows: int = 1, pitch_m: float = 0.2) -> tuple[Part, ...]:
    """Upholstered pads on a board: upright channels (one row) or tiles."""
    length, width, height = size_m
    board_m = 0.015
    board = block((length, board_m, height), 0.003).moved(y=width / 2 - board_m / 2)
    columns = max(2, round(length / pitch_m))
    wide, tall = length / columns, height / rows
    deep = width - 0.004
    pad = _stuffed(wide - 0.001, tall - 0.001, deep).turned("x", 90).moved(y=width / 2 - 0.004)
    pads = [
        pad.moved(x=-length / 2 + wide * (c + 0.5), z=tall * (r + 0.5))
        for c in range(columns)
        for r in range(rows)
    ]
    return (Part("Board", board, "board"), Part("Pads", joined(pads), "cloth", collider=None))


def _stuffed(length: float, width: float, height: float) -> Solid:
    """A pad that swells from its seams: round along its short side, flat along its long one."""
    seam = min(0.016, 0.4 * height)
    flat = ring(length, width, 0.008, 0.0, 2)
    rings = [flat, ring(length, width, 0.008, height - 2 * seam, 2)]
    short = min(length, width)
    for turn in np.radians((30.0, 55.0, 75.0, 90.0)):
        inset = (1 - math.cos(turn)) * 0.42 * short
        rise = height - 2 * seam + 2 * seam * math.sin(turn)
        rings.append(ring(length - inset, width - inset, 0.008 + 0.2 * inset, rise, 2))
    return loft(rings)


def slatted_panel(size_m: Size, *, has_shelf: bool = False) -> tuple[Part, ...]:
    """Upright wooden slats on a dark backing; perhaps a ledge with a vase and books."""
    length, width, height = size_m
    back_m = 0.014
    backing = box((length - 0.004, back_m, height - 0.004)).moved(y=width / 2 - back_m / 2, z=0.002)
    count = round(length / 0.05)
    step = length / count
    deep = min(0.03, width - back_m) if has_shelf else width - back_m - 0.001
    slat = block((step * 0.6, deep, height - 0.002), 0.003).moved(z=0.001)
    y = width / 2 - back_m - deep / 2 + 0.002
    slats = [slat.moved(-length / 2 + step * (i + 0.5), y) for i in range(count)]
    # Its back stands free of the backing's, so that no two faces lie in one plane.
    edge_m = back_m + deep if has_shelf else width - 0.001
    edge = block((0.02, edge_m, height)).moved((length - 0.02) / 2, (width - edge_m) / 2 - 0.001)
    parts = [
        Part("Backing", backing, "board"),
        Part("Slats", joined(slats) + mirrored_pair(edge), "wood", collider=None),
    ]
    return (*parts, *_ledge(length, width, height)) if has_shelf else tuple(parts)


def _ledge(length: float, width: float, height: float) -> tuple[Part, ...]:
    ledge_l, z = length * 0.7, height * 0.42
    ledge = block((ledge_l, width - 0.004, 0.025), 0.003).moved(y=-0.002, z=z)
    r = min(0.042, width / 2 - 0.008)
    vase = lathe(
        [(r * 0.6, 0), (r, 0.06), (r * 0.9, 0.12), (r * 0.35, 0.17), (r * 0.5, 0.2), (0, 0.2)], 24
    ).moved(-ledge_l * 0.35, -0.002, z + 0.024)
    books = [
        box((0.024, width * 0.74, 0.15 + 0.012 * (i % 3))).moved(
            ledge_l * 0.3 + 0.027 * i, 0.0, z + 0.024
        )
        for i in range(5)
    ]
    return (
        Part("Ledge", ledge, "wood"),
        Part("Vase", vase, "vase", collider=None),
        Part("Books", joined(books), "books", collider=None),
    )


def pictures(size_m: Size) -> tuple[Part, ...]:
    """Framed abstract prints in a row, all of one height."""
    length, width, height = size_m
    count = max(2, round(length / 0.72))
    gap = 0.06
    wide = (length - gap * (count - 1)) / count
    frames, mats = [], []
    fields: dict[str, list[Solid]] = {"art_a": [], "art_b": [], "art_c": []}
    for index in range(count):
        x = -length / 2 + wide / 2 + (wide + gap) * index
        frames.append(_frame(wide, width, height).moved(x))
        mats.append(box((wide - 0.03, 0.01, height - 0.03)).moved(x, width / 2 - 0.012, 0.015))
        for slot, piece in _abstract(wide - 0.2, height - 0.2, index):
            fields[slot].append(piece.moved(x, width / 2 - 0.02, 0.1))
    art = [Part(f"Print_{s[-1].upper()}", joined(p), s, collider=None) for s, p in fields.items()]
    return (
        Part("Frames", joined(frames), "wood"),
        Part("Mats", joined(mats), "paper", collider=None),
        *art,
    )


def _frame(length: float, width: float, height: float) -> Solid:
    rail = 0.028
    deep = width
    stile = block((rail, deep, height), 0.003)
    bar = block((length - 2 * rail + 0.004, deep - 0.002, rail), 0.003)
    side = (length - rail) / 2
    return joined([stile.moved(-side), stile.moved(side), bar, bar.moved(z=height - rail)])


def _abstract(length: float, height: float, index: int) -> list[tuple[str, Solid]]:
    """A few flat fields on the mat: bands of land, a disc for a sun; each print arranged anew."""
    low, disc = (0.3, 0.38, 0.24)[index % 3], (0.25, -0.2, 0.1)[index % 3]
    ground = box((length, 0.004, height * low))
    hill = box((length * 0.62, 0.007, height * 0.2))
    shift = (0.19, -0.19, 0.1)[index % 3] * length
    radius = min(length, height) * 0.17
    sun = lathe([(radius, 0), (radius, 0.004), (0, 0.004)], 28).turned("x", 90)
    return [
        ("art_a", ground),
        ("art_b", hill.moved(shift, 0.0, height * low - 0.01)),
        ("art_c", sun.moved(disc * length, 0.002, height * 0.74)),
    ]


def _padding(cloth: str) -> dict[str, str]:
    return {"cloth": cloth, "board": "graphite"}


def _slats(wood: str, vase: str = "terracotta") -> dict[str, str]:
    return {"wood": wood, "board": "black", "vase": vase, "books": "paper"}


def _prints(frame: str, ground: str, hill: str, sun: str) -> dict[str, str]:
    return {"wood": frame, "paper": "paper", "art_a": ground, "art_b": hill, "art_c": sun}


def _padded(cloths: tuple[str, ...]) -> dict[str, dict[str, str]]:
    return {cloth.rsplit("_", 1)[0]: _padding(cloth) for cloth in cloths}


_PADS = _padded(("grey_cloth", "charcoal_cloth", "cream_boucle", "teal_velvet", "beige_cloth"))
_RICH_PADS = _padded(("cream_cloth", "beige_cloth", "navy_velvet", "forest_velvet",
                      "burgundy_velvet"))  # fmt: skip
_SOFT_PADS = _padded(("linen", "grey_cloth", "beige_cloth", "sage_linen", "blush_linen"))
_LEATHER_PADS = _padded(("tan_leather", "brown_leather", "charcoal_cloth", "black_leather"))
_SLATS = {
    "oak": _slats("oak"),
    "pale_oak": _slats("pale_oak"),
    "birch": _slats("birch"),
    "walnut": _slats("walnut", "ceramic"),
    "dark_walnut": _slats("dark_walnut", "ceramic"),
    "black_stain": _slats("black_stain"),
    "white": _slats("warm_white"),
}
_PRINTS = {
    "desert": _prints("oak", "terracotta", "sand", "yellow_cover"),
    "sea": _prints("black_stain", "navy", "teal_cloth", "blush"),
    "forest": _prints("walnut", "forest", "sage", "mustard_cloth"),
}

_Form = tuple[Style, tuple[str, ...]]
_TILES = partial(padded_panel, rows=3, pitch_m=0.38)
_HEADS: tuple[_Form, ...] = (
    (Style("Bed_Panel_Channels", padded_panel, _PADS, 1.0), ("modern",)),
    (Style("Bed_Panel_Slats", slatted_panel, _SLATS, 1.2), ("japanese", "scandinavian")),
    (Style("Bed_Panel_Soft", partial(padded_panel, pitch_m=0.5), _SOFT_PADS, 1.0),
     ("scandinavian",)),
    (Style("Bed_Panel_Tiles", _TILES, _RICH_PADS, 1.05), ("classic",)),
    (Style("Bed_Panel_Leather", partial(padded_panel, rows=4, pitch_m=0.9), _LEATHER_PADS, 1.1),
     ("industrial",)),
)  # fmt: skip
_PICTURES = Style("Sofa_Prints", pictures, _PRINTS, 0.85)
_SLAT_WALL = Style("Sofa_Slats", slatted_panel, _SLATS, 1.2)
_SLAT_LEDGE = Style("Sofa_Slats_Ledge", partial(slatted_panel, has_shelf=True), _SLATS, 1.1)


def _heads() -> Iterator[Design]:
    for style, styles in _HEADS:
        for design in editions(
            "bed_background", (style,), (1.2, 1.35, 1.5, 1.8, 2.0, 2.4, 3.0), (0.06, 0.09)
        ):
            yield replace(design, finishes=TEXTILES, styles=styles)


DESIGNS = (
    *_heads(),
    *editions("sofa_background", (_PICTURES, _SLAT_WALL), steps(1.25, 3.55), (0.06,)),
    *editions("sofa_background", (_SLAT_LEDGE, _PICTURES), steps(1.25, 3.55, 0.2), (0.1,)),
)
