"""Panels on the wall behind a bed or a sofa, and pictures. Their back is against the wall (+y)."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    joined,
    lathe,
    loft,
    mirrored_pair,
    ring,
    rounded_slab,
)
from chord_usd.library.pictures.wall_pictures import (
    ART_SLOTS,
    art_finishes,
    framed_art,
)
from chord_usd.library.surfaces.drawn import DrawnFinishes


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


def boiserie(size_m: Size) -> tuple[Part, ...]:
    """Painted panelling: a moulded frame around each field, a cornice above, a base below."""
    length, width, height = size_m
    back_m = width - 0.03
    board = box((length, back_m, height - 0.03)).moved(y=(width - back_m) / 2, z=0.0)
    count = max(2, round(length / 0.7))
    wide = length / count
    field_l, field_h = wide - 0.16, height - 0.3
    rail = [block((field_l, 0.02, 0.026), 0.008), block((0.024, 0.018, field_h - 0.01), 0.007)]
    half = (field_l - 0.026) / 2
    frame = joined([
        rail[0], rail[0].moved(z=field_h - 0.026),
        rail[1].moved(-half, z=0.005), rail[1].moved(half, z=0.005),
    ])  # fmt: skip
    y = width / 2 - back_m - 0.008
    frames = [frame.moved(-length / 2 + wide * (i + 0.5), y, 0.15) for i in range(count)]
    # Their backs stand free of the board's, so that no two faces lie in one plane.
    cornice = block((length, width - 0.002, 0.03), 0.012).moved(y=-0.001, z=height - 0.03)
    base = block((length - 0.002, width - 0.012, 0.07), 0.006).moved(y=0.004, z=0.001)
    return (
        Part("Board", board, "wood"),
        Part("Mouldings", joined([*frames, cornice, base]), "wood", collider=None),
    )


def plank_wall(size_m: Size) -> tuple[Part, ...]:
    """Old boards lying on each other, of many lengths and not quite of one thickness."""
    length, width, height = size_m
    rows = max(4, round(height / 0.16))
    tall = height / rows
    boards = []
    for row in range(rows):
        cuts = [0.0, *sorted(((row * 0.37 + 0.21) % 1.0, (row * 0.61 + 0.55) % 1.0)), 1.0]
        for number, (low, high) in enumerate(pairwise(cuts)):
            if (high - low) * length < 0.05:
                continue
            thick = width - 0.001 - 0.006 * ((row + 2 * number) % 3)
            board = block(((high - low) * length - 0.002, thick, tall - 0.002), 0.003)
            at = (
                ((low + high) / 2 - 0.5) * length,
                (width - thick) / 2 - 0.001,
                row * tall + 0.001,
            )
            boards.append(board.moved(*at))
    backing = box((length, 0.006, height)).moved(y=width / 2 - 0.003)
    return (Part("Backing", backing, "board"), Part("Boards", joined(boards), "wood", None))


def flush_wall(size_m: Size) -> tuple[Part, ...]:
    """Upright boards with dark shadow gaps: broader ones look like cupboards."""
    length, width, height = size_m
    count = max(2, round(length / 0.24))
    wide = length / count
    backing = box((length, 0.012, height)).moved(y=width / 2 - 0.006)
    panel = rounded_slab((wide - 0.01, height - 0.002, width - 0.01), 0.004, 0.003, 2, 2)
    panel = panel.turned("x", 90).moved(y=width / 2 - 0.01, z=height / 2)
    panels = [panel.moved(-length / 2 + wide * (i + 0.5)) for i in range(count)]
    return (Part("Backing", backing, "board"), Part("Panels", joined(panels), "wood", None))


def pictures(
    size_m: Size, *, pitch_m: float, rail_m: float, mount_m: float = 0.0, moulded: bool = False
) -> tuple[Part, ...]:
    """Framed pictures in a row, all of one size; pitch_m: about from one to the next."""
    length, width, height = size_m
    count = _count(length, pitch_m)
    wide = _wide(length, count)
    named: dict[str, list[Part]] = {}
    for index in range(count):
        x = -length / 2 + wide / 2 + (wide + _GAP_M) * index
        slot = ART_SLOTS[index % len(ART_SLOTS)]
        for part in framed_art(wide, width, height, rail_m, mount_m, moulded, f"_{index}", slot, x):
            named.setdefault(part.name if part.uvs is not None else part.slot, []).append(part)
    return tuple(
        replace(
            group[0],
            name=name.capitalize(),
            solid=joined([part.solid for part in group]),
            collider="boundingCube" if name == "frame" else None,
        )
        for name, group in named.items()
    )


_GAP_M = 0.07


def _count(length: float, pitch_m: float) -> int:
    return max(1, round(length / pitch_m))


def _wide(length: float, count: int) -> float:
    return (length - _GAP_M * (count - 1)) / count


def prints(
    name: str, size_m: Size, *, pitch_m: float, edge_m: float, drawings: Sequence[str]
) -> DrawnFinishes:
    """Finishes of pictures in a row; edge_m: width of rail and mount around each."""
    wide = _wide(size_m[0], _count(size_m[0], pitch_m))
    aspect = round((wide - 2 * edge_m) / (size_m[2] - 2 * edge_m), 3)
    return art_finishes(name, drawings, aspect)
