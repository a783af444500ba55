"""Wardrobes, chests, bookcases, shoe cabinets."""

from __future__ import annotations

from functools import partial
from typing import Literal

from chord_usd.library.kit.forms import cup, rng_of
from chord_usd.library.kit.joinery import (
    FRONT_M,
    HANDLE_M,
    Cell,
    HandleKind,
    cells,
    doors,
    drawers,
    four_legs,
    plinth,
    shifted,
)
from chord_usd.library.kit.model import (
    Part,
    hollow_part,
    moving_part,
)
from chord_usd.library.kit.moves import Leaf, Slide, flap, leaves_of
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    joined,
    mirrored_pair,
    rounded_profile,
    rounded_slab,
)
from chord_usd.library.objects.books import bound

BOARD_M = 0.022

_TILT_DEG = 35.0
"""How far the flaps of a shoe cabinet tilt."""

_LEAF_M = 0.46
"""Usual length of a wardrobe door."""
_DRAWER_M = 0.44
"""Height of the two rows of drawers below."""


def fronts_y(width: float, kind: HandleKind) -> float:
    """Plane of the fronts' back, so that the handles end at the nominal front."""
    stand = HANDLE_M if kind != "none" else 0.0
    return -width / 2 + stand + FRONT_M


def carcass(length: float, face_y: float, back_y: float, height: float, z: float) -> Solid:
    """The closed body behind the fronts, a little darker than them by the gaps it shows."""
    depth = back_y - face_y
    return block((length, depth, height)).moved(y=face_y + depth / 2, z=z)


def wardrobe(size_m: Size, *, handle: HandleKind = "bar", framed: bool = False) -> tuple[Part, ...]:
    """A wardrobe on a plinth: doors over drawers, or, framed, tall shaker doors and a cornice."""
    length, width, height = size_m
    leaves = max(1, round(length / _LEAF_M))
    y, base, top = fronts_y(width, handle), 0.08, 0.03 if framed else 0.002
    body = carcass(length, y, width / 2, height - base - top + 0.002, base)
    wide, tall, low = length - 0.006, height - base - top - 0.006, base + 0.003
    drawer = 0.0 if framed else _DRAWER_M
    face = list(cells(wide, tall - drawer, leaves, z_m=low + drawer))
    parts = [
        plinth(size_m, base, inset_m=0.08),
        hollow_part("Body", body),
        *doors(face, y, handle, framed=framed),
    ]
    if framed:
        cornice = block((length, width - 0.02, top), 0.01)
        parts.append(Part("Cornice", cornice.moved(y=0.01, z=height - top), "body"))
    else:
        parts += drawers(list(cells(wide, drawer, leaves, (1.0, 1.0), low)), y, handle)
    return tuple(parts)


def sliding_wardrobe(size_m: Size) -> tuple[Part, ...]:
    """Sliding doors in two tracks between a frame, every second one glazed dark."""
    length, width, height = size_m
    leaves = max(2, round(length / 0.9))
    rail, depth = 0.05, 0.07
    y = -width / 2 + depth
    wide = (length - 0.05) / leaves
    panels, edges, slides = [], [], []
    for index in range(leaves):
        x = -(length - 0.05) / 2 + wide * (index + 0.5)
        track = y - (0.012 if index % 2 else 0.038)
        panel = block((wide + 0.02, 0.02, height - 2 * rail + 0.01)).moved(x, track, rail - 0.005)
        edge = block((0.018, 0.022, height - 2 * rail)).moved(x, track, rail)
        panels.append(panel)
        edges.append(edge.moved(x=-wide * 0.4885) + edge.moved(x=wide * 0.4885))
        # Every second one runs behind its neighbours.
        way = -1.0 if index % 2 or index == leaves - 1 else 1.0
        slides.append(Leaf("Door", Slide((x, track, rail), "x", way * (wide - 0.06))))
    frame = [
        block((length, depth, rail)).moved(y=y - depth / 2),
        block((length, depth, rail)).moved(y=y - depth / 2, z=height - rail),
    ]
    sides = mirrored_pair(
        block((0.025, depth, height - 2 * rail + 0.004)).moved(
            (length - 0.025) / 2, y - depth / 2, rail - 0.002
        )
    )
    return (
        hollow_part("Body", carcass(length, y, width / 2, height, 0.0)),
        Part("Rails", joined(frame) + sides, "body", collider=None),
        moving_part("Doors", panels[::2], "front", slides[::2]),
        moving_part("Glass_Doors", panels[1::2], "glass", slides[1::2]),
        moving_part("Edges", edges, "handle", slides, None),
    )


def chest(
    size_m: Size, *, rows: tuple[float, ...] = (1.2, 1.0, 1.0, 0.8), handle: HandleKind = "bar"
) -> tuple[Part, ...]:  # fmt: skip
    """A chest of drawers on short legs with a projecting top."""
    length, width, height = size_m
    columns = max(1, round(length / 0.75))
    y, base, top = fronts_y(width, handle), 0.12, 0.024
    body = carcass(length - 0.012, y, width / 2 - 0.002, height - base - top + 0.002, base)
    face = list(cells(length - 0.02, height - base - top - 0.008, columns, rows, base + 0.004))
    plate = rounded_slab((length, width - HANDLE_M + 0.004, top), 0.006, 0.004, 3)
    return (
        *four_legs(length - 0.05, width - 0.1, base + 0.01, 0.04, is_round=True),
        hollow_part("Body", body),
        *drawers(face, y, handle),
        Part("Top", plate.moved(y=HANDLE_M / 2 - 0.002, z=height - top), "top"),
    )


def low_cabinet(size_m: Size) -> tuple[Part, ...]:
    """A low cabinet on a plinth: panelled doors with knobs under a wooden top."""
    length, width, height = size_m
    y, base, top = fronts_y(width, "knob"), 0.08, 0.026
    body = carcass(length - 0.012, y, width / 2 - 0.002, height - base - top + 0.002, base)
    columns = max(1, round(length / 0.45))
    face = list(cells(length - 0.02, height - base - top - 0.008, columns, z_m=base + 0.004))
    plate = rounded_slab((length, width - HANDLE_M + 0.006, top), 0.006, 0.005, 3)
    return (
        plinth(size_m, base),
        hollow_part("Body", body),
        *doors(face, y, "knob", framed=True),
        Part("Top", plate.moved(y=HANDLE_M / 2 - 0.003, z=height - top), "top"),
    )


def bookcase(size_m: Size, *, low: float = 0.5) -> tuple[Part, ...]:
    """Open shelves above pairs of doors of height low, with books on the shelves."""
    length, width, height = size_m
    base = 0.06
    bays = max(1, round(length / 0.85))
    shelves = max(1, round((height - base - low) / 0.31))
    y = fronts_y(width, "knob")
    inner = length - 2 * BOARD_M
    depth = width / 2 - y
    middle = (y + width / 2) / 2
    uprights = [
        block((BOARD_M, depth, height - base - 0.001)).moved(
            -length / 2 + BOARD_M / 2 + (length - BOARD_M) * i / bays, middle, base
        )
        for i in range(bays + 1)
    ]
    step = (height - base - low - BOARD_M) / shelves
    levels = [base + low + step * i for i in range(shelves + 1)]
    boards = [block((inner, depth - 0.004, BOARD_M)).moved(y=middle, z=z) for z in levels]
    cupboard = box((inner, depth - 0.01, low - 0.001)).moved(y=middle, z=base + 0.001)
    back = box((inner - 0.004, 0.01, height - base - low - 0.008))
    back = back.moved(y=width / 2 - 0.008, z=base + low + 0.004)
    face = list(cells(length - 0.006, low - 0.01, 2 * bays, z_m=base + 0.005))
    return (
        plinth(size_m, base),
        Part("Uprights", joined(uprights), "body", colliders=tuple(uprights)),
        Part("Shelves", joined(boards), "body", colliders=tuple(boards)),
        Part("Back", back, "back"),
        hollow_part("Cupboard", cupboard),
        *doors(face, y, "knob"),
        *_books(inner / bays, bays, levels[:-1], step - BOARD_M, middle),
    )


_BOOK_SLOTS = ("book_red", "book_blue", "book_pale", "book_dark")


def _books(bay: float, bays: int, levels: list[float], clear: float, y: float) -> tuple[Part, ...]:
    """What stands in shelves: rows of unlike books, a vase, a bowl, a box, room to breathe."""
    rows: dict[str, list[Solid]] = {slot: [] for slot in _BOOK_SLOTS}
    pages: list[Solid] = []
    things: list[Solid] = []
    # Large shelves hold relatively less: their triangles are limited.
    spare = 0.45 if bays * len(levels) > 8 else 0.0
    for shelf, z in enumerate(levels):
        for column in range(bays):
            rng = rng_of(f"bookcase/{shelf}/{column}/{bay:.3f}")
            middle = bay * (column - (bays - 1) / 2)
            rightwards = 1.0 if (shelf + column) % 2 == 0 else -1.0
            edge = bay / 2 - 0.03
            x, count = -edge, 0
            until = edge * ((-0.3, 0.4, 0.05)[(shelf + 2 * column) % 3] - spare)
            while x < until:
                thick = float(rng.choice([0.022, 0.028, 0.035, 0.044]))
                tall = min(clear * 0.9, float(rng.choice([0.17, 0.19, 0.21, 0.23, 0.25])))
                deep = min(0.75 * tall, 0.19)
                cover, leaves = bound(thick - 0.001, deep, tall, 2)
                at = (
                    middle + rightwards * (x + thick / 2),
                    y - 0.02 - (0.17 - deep) / 2,
                    z + BOARD_M,
                )
                slot = _BOOK_SLOTS[int(rng.integers(4))]
                rows[slot].append(cover.moved(*at))
                pages.append(leaves.moved(*at))
                x, count = x + thick, count + 1
            spot = middle + rightwards * (x + edge) / 2
            if edge - x > 0.22:
                things.append(_thing(shelf + column, clear).moved(spot, y - 0.03, z + BOARD_M))
    names = ("Books_Red", "Books_Blue", "Books_Pale", "Books_Dark")
    parts = [
        Part(name, joined(rows[slot]), slot, collider=None)
        for name, slot in zip(names, _BOOK_SLOTS, strict=True)
        if rows[slot]
    ]
    parts.append(Part("Pages", joined(pages), "page", collider=None))
    if things:
        parts.append(Part("Things", joined(things), "thing", collider=None))
    return tuple(parts)


def _thing(number: int, clear: float) -> Solid:
    """A vase, a bowl or a covered box, between books."""
    if number % 3 == 0:
        profile = [
            (0.0, 0.0),
            (0.035, 0.0),
            (0.06, 0.05),
            (0.062, 0.09),
            (0.024, 0.15),
            (0.02, 0.18),
            (0.026, 0.19),
        ]
        vase = cup([profile[0], *rounded_profile(profile[1:], 1)], 0.004, 0.12, 14)
        return vase.scaled(*(min(1.0, clear / 0.26),) * 3)
    if number % 3 == 1:
        return cup(
            [(0.0, 0.0), (0.03, 0.0), (0.034, 0.006), (0.07, 0.03), (0.09, 0.065)], 0.004, 0.01, 16
        )
    lid = block((0.17, 0.15, 0.03), 0.003).moved(z=0.07)
    return block((0.164, 0.144, 0.075), 0.003) + lid


ShoeKind = Literal["flaps", "louvres", "bench"]


def shoe_cabinet(size_m: Size, *, kind: ShoeKind = "flaps") -> tuple[Part, ...]:
    """A shallow hall cabinet: tilting flaps, louvred doors, or a bench with doors above."""
    length, width, height = size_m
    if kind == "bench":
        return _shoe_tower(size_m)
    handle: HandleKind = "knob"
    y, base, top = fronts_y(width, handle), 0.08, 0.022
    body = carcass(length - 0.01, y, width / 2 - 0.002, height - base - top + 0.002, base)
    tall = height - base - top - 0.008
    columns = max(1, round(length / 0.6))
    plate = rounded_slab((length, width - HANDLE_M + 0.006, top), 0.006, 0.004, 3)
    if kind == "flaps":
        rows = (1.0,) * max(2, round(tall / 0.38))
        face = list(cells(length - 0.018, tall, columns, rows, base + 0.004))
        fronts = drawers(face, y, handle, leaf=partial(flap, opens_deg=_TILT_DEG, holds=True))
    else:
        face = list(cells(length - 0.018, tall, 2 * columns, z_m=base + 0.004))
        panels = doors(face, y, handle)
        leaves = leaves_of(panels[0].moves)
        louvres = [_louvres(c, y) for c in face]
        fronts = (*panels, moving_part("Louvres", louvres, "front", leaves, None))
    return (
        plinth(size_m, base),
        hollow_part("Body", body),
        *fronts,
        Part("Top", plate.moved(y=HANDLE_M / 2 - 0.003, z=height - top), "top"),
    )


def _louvres(cell: Cell, y: float) -> Solid:
    """Slanting slats on the upper part of a door."""
    count = max(4, int(cell.height_m / 0.055))
    step = (cell.height_m - 0.12) / count
    slat = block((cell.length_m - 0.11, 0.008, step * 0.95), 0.002).turned("x", -16)
    low = cell.z_m + 0.06
    return joined([slat.moved(cell.x_m, y - FRONT_M - 0.002, low + step * i) for i in range(count)])


def _shoe_tower(size_m: Size) -> tuple[Part, ...]:
    """Full height: doors on one side, a seat with coat hooks and upper doors on the other."""
    length, width, height = size_m
    y, base = fronts_y(width, "knob"), 0.08
    tower, bench = length * 0.42, length * 0.58
    x_tower, x_bench = (tower - length) / 2, (length - bench) / 2
    upper = height - 0.45
    parts = [plinth(size_m, base)]
    column = carcass(tower, y, width / 2, height - base, base).moved(x=x_tower)
    low = carcass(bench + 0.002, y, width / 2, 0.32, base).moved(x=x_bench)
    high = carcass(bench + 0.002, y, width / 2, 0.45, upper).moved(x=x_bench)
    back = block((bench, 0.018, upper - 0.4 + 0.004)).moved(x_bench, width / 2 - 0.012, 0.398)
    seat = rounded_slab((bench - 0.01, width - HANDLE_M, 0.06), 0.02, 0.02, 4, 2)
    hooks = [
        block((0.02, 0.05, 0.02)).moved(x_bench + (i - 1) * bench / 4, width / 2 - 0.046, 1.5)
        for i in range(3)
    ]
    tall = height - base - 0.006
    face = [
        *shifted(cells(tower - 0.006, tall, 1, (1.3, 1.0), base + 0.003), x_tower),
        *shifted(cells(bench - 0.006, 0.31, 2, z_m=base + 0.004), x_bench),
        *shifted(cells(bench - 0.006, 0.44, 2, z_m=upper + 0.004), x_bench),
    ]
    rail = block((bench - 0.1, 0.02, 0.08)).moved(x_bench, width / 2 - 0.03, 1.47)
    return (
        *parts,
        hollow_part("Tower", column),
        hollow_part("Bench", low),
        hollow_part("Upper_Cabinet", high),
        Part("Back", back, "top"),
        *doors(face, y, "knob", low=False),
        Part("Seat", seat.moved(x_bench, HANDLE_M / 2, base + 0.318), "cushion"),
        Part("Hook_Rail", rail, "body", collider=None),
        Part("Hooks", joined(hooks), "handle", collider=None),
    )
