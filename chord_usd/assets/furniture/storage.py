"""Wardrobes, chests, bookcases, sideboards, shoe cabinets, bedside tables, TV cabinets."""

from __future__ import annotations

from functools import partial
from typing import Literal

from chord_usd.assets.furniture.joinery import (
    FRONT_M,
    HANDLE_M,
    HandleKind,
    cells,
    doors,
    drawers,
    four_legs,
    front,
    knob,
    plinth,
)
from chord_usd.assets.model import Design, Part
from chord_usd.assets.solids import Size, Solid, block, box, joined, mirrored_pair, rounded_slab

_BOARD_M = 0.022


def _face_y(width: float, kind: HandleKind) -> float:
    """Plane of the fronts' back, so that the handles end at the nominal front."""
    stand = HANDLE_M if kind != "none" else 0.0
    return -width / 2 + stand + FRONT_M


def _carcass(length: float, face_y: float, back_y: float, height: float, z: float) -> Solid:
    """The closed body behind the fronts, a little darker than them by the gaps it shows."""
    depth = back_y - face_y
    return block((length, depth, height)).moved(y=face_y + depth / 2, z=z)


def wardrobe(
    size_m: Size, *, leaves: int = 2, handle: HandleKind = "bar", framed: bool = False
) -> tuple[Part, ...]:
    """A wardrobe with hinged doors on a plinth; framed gives shaker doors and a cornice."""
    length, width, height = size_m
    y, base, top = _face_y(width, handle), 0.08, 0.03 if framed else 0.002
    body = _carcass(length, y, width / 2, height - base - top + 0.002, base)
    face = list(cells(length - 0.006, height - base - top - 0.006, leaves, z_m=base + 0.003))
    parts = [
        plinth(size_m, base, inset_m=0.08),
        Part("Body", body, "body"),
        *doors(face, y, handle, framed=framed),
    ]
    if framed:
        cornice = block((length, width - 0.02, top), 0.01)
        parts.append(Part("Cornice", cornice.moved(y=0.01, z=height - top), "body"))
    return tuple(parts)


def sliding_wardrobe(size_m: Size, *, leaves: int = 2) -> tuple[Part, ...]:
    """Sliding doors in two tracks between a frame, every second one glazed dark."""
    length, width, height = size_m
    rail, depth = 0.05, 0.07
    y = -width / 2 + depth
    wide = (length - 0.05) / leaves
    panels: dict[str, list[Solid]] = {"front": [], "glass": []}
    for index in range(leaves):
        x = -(length - 0.05) / 2 + wide * (index + 0.5)
        track = y - (0.012 if index % 2 else 0.038)
        leaf = block((wide + 0.02, 0.02, height - 2 * rail + 0.01)).moved(x, track, rail - 0.005)
        panels["glass" if index % 2 else "front"].append(leaf)
    edges = [
        block((0.018, 0.026, height - 2 * rail)).moved(
            -(length - 0.05) / 2 + wide * (index + 0.5 + side * 0.49), y - 0.03, rail
        )
        for index in range(leaves)
        for side in (-1, 1)
    ]
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
        Part("Body", _carcass(length, y, width / 2, height, 0.0), "body"),
        Part("Rails", joined(frame) + sides, "body", collider=None),
        Part("Doors", joined(panels["front"]), "front"),
        Part("Glass_Doors", joined(panels["glass"]), "glass"),
        Part("Edges", joined(edges), "handle", collider=None),
    )


def chest(
    size_m: Size, *, columns: int = 1, rows: tuple[float, ...] = (1.2, 1.0, 1.0, 0.8),
    handle: HandleKind = "bar",
) -> tuple[Part, ...]:  # fmt: skip
    """A chest of drawers on short legs with a projecting top."""
    length, width, height = size_m
    y, base, top = _face_y(width, handle), 0.12, 0.024
    body = _carcass(length - 0.012, y, width / 2 - 0.002, height - base - top + 0.002, base)
    face = list(cells(length - 0.02, height - base - top - 0.008, columns, rows, base + 0.004))
    plate = rounded_slab((length, width - HANDLE_M + 0.004, top), 0.006, 0.004, 3)
    return (
        *four_legs(length - 0.05, width - 0.1, base + 0.01, 0.04, is_round=True),
        Part("Body", body, "body"),
        *drawers(face, y, handle),
        Part("Top", plate.moved(y=HANDLE_M / 2 - 0.002, z=height - top), "top"),
    )


def bookcase(size_m: Size, *, bays: int = 1, shelves: int = 5) -> tuple[Part, ...]:
    """Open shelves above a pair of doors, with books on the shelves."""
    length, width, height = size_m
    base, low = 0.06, 0.5
    y = _face_y(width, "knob")
    inner = length - 2 * _BOARD_M
    depth = width / 2 - y
    middle = (y + width / 2) / 2
    uprights = [
        block((_BOARD_M, depth, height - base)).moved(
            -length / 2 + _BOARD_M / 2 + (length - _BOARD_M) * i / bays, middle, base
        )
        for i in range(bays + 1)
    ]
    step = (height - base - low - _BOARD_M) / shelves
    levels = [base + low + step * i for i in range(shelves + 1)]
    boards = [block((inner, depth - 0.004, _BOARD_M)).moved(y=middle, z=z) for z in levels]
    cupboard = box((inner, depth - 0.01, low)).moved(y=middle, z=base)
    back = box((inner, 0.01, height - base - low)).moved(y=width / 2 - 0.008, z=base + low)
    face = list(cells(length - 0.006, low - 0.01, 2 * bays, z_m=base + 0.005))
    return (
        plinth(size_m, base),
        Part("Uprights", joined(uprights), "body", collider="none"),
        Part("Shelves", joined(boards), "body", collider="none"),
        Part("Back", back, "back"),
        Part("Cupboard", cupboard, "body"),
        *doors(face, y, "knob"),
        *_books(inner / bays, bays, levels[:-1], step - _BOARD_M, middle),
    )


_BOOK_SLOTS = ("book_red", "book_blue", "book_pale")


def _books(bay: float, bays: int, levels: list[float], clear: float, y: float) -> tuple[Part, ...]:
    """Rows of books of unlike height that fill half of each shelf, left and right in turn."""
    rows: dict[str, list[Solid]] = {slot: [] for slot in _BOOK_SLOTS}
    for shelf, z in enumerate(levels):
        for column in range(bays):
            rightwards = 1.0 if (shelf + column) % 2 == 0 else -1.0
            edge = bay / 2 - 0.03
            x, count = -edge, 0
            while x < edge * (0.1 if shelf % 3 else 0.75):
                spell = (7 * shelf + 5 * column + 3 * count) % 11
                thick, tall = 0.022 + 0.0025 * spell, clear * (0.62 + 0.026 * ((spell * 4) % 11))
                centre = rightwards * (x + thick / 2) + bay * (column - (bays - 1) / 2)
                book = box((thick - 0.002, 0.17, tall)).moved(centre, y - 0.02, z + _BOARD_M)
                rows[_BOOK_SLOTS[(spell + count) % 3]].append(book)
                x, count = x + thick, count + 1
    names = ("Books_Red", "Books_Blue", "Books_Pale")
    return tuple(
        Part(name, joined(rows[slot]), slot, collider=None)
        for name, slot in zip(names, _BOOK_SLOTS, strict=True)
        if rows[slot]
    )


def sideboard(
    size_m: Size, *, handle: HandleKind = "bar", framed: bool = False
) -> tuple[Part, ...]:
    """A long low cabinet on legs: doors at both ends, drawers in the middle."""
    length, width, height = size_m
    y, base, top = _face_y(width, handle), 0.14, 0.024
    body = _carcass(length - 0.012, y, width / 2 - 0.002, height - base - top + 0.002, base)
    wide, tall = (length - 0.02) / 3, height - base - top - 0.008
    three = list(cells(length - 0.02, tall, 3, z_m=base + 0.004))
    middle = list(cells(wide, tall, 1, (1.2, 1.0, 0.8), base + 0.004))
    plate = rounded_slab((length, width - HANDLE_M + 0.004, top), 0.006, 0.004, 3)
    return (
        *four_legs(length - 0.1, width - 0.1, base + 0.01, 0.045, is_round=True, splay_m=0.015),
        Part("Body", body, "body"),
        *doors([three[0], three[2]], y, handle, framed=framed),
        *drawers(middle, y, handle),
        Part("Top", plate.moved(y=HANDLE_M / 2 - 0.002, z=height - top), "top"),
    )


def hutch(size_m: Size) -> tuple[Part, ...]:
    """A dresser: doors below, a shelf for serving, glazed doors with plates above."""
    length, width, height = size_m
    y, base, low = _face_y(width, "knob"), 0.07, 0.82
    upper_z, top = low + 0.38, 0.03
    depth = width * 0.72
    y_up = width / 2 - depth
    body = _carcass(length - 0.006, y, width / 2 - 0.002, low - base, base)
    counter = rounded_slab((length, width - HANDLE_M + 0.01, 0.03), 0.006, 0.005, 3)
    tall = height - upper_z - top
    shell = [
        block((length - 0.01, 0.012, height - low - top)).moved(y=width / 2 - 0.008, z=low),
        *(
            block((_BOARD_M, depth - 0.01, height - low - top)).moved(
                s * (length - 0.03) / 2, width / 2 - depth / 2, low
            )
            for s in (-1, 1)
        ),
        *(
            block((length - 0.05, depth - 0.02, _BOARD_M)).moved(y=width / 2 - depth / 2, z=z)
            for z in (upper_z, upper_z + tall * 0.5, height - top - _BOARD_M)
        ),
    ]
    columns = max(2, round(length / 0.45))
    glass = list(cells(length - 0.02, tall - 0.004, columns, z_m=upper_z))
    panes = [
        box((c.length_m - 0.09, 0.006, c.height_m - 0.09)).moved(
            c.x_m, y_up - FRONT_M / 2, c.z_m + 0.045
        )
        for c in glass
    ]
    plates = [
        block((0.2, 0.012, 0.2), 0.004).turned("x", -12).moved(x, width / 2 - 0.06, z)
        for x in (-length / 4, length / 4)
        for z in (upper_z + _BOARD_M, upper_z + tall * 0.5 + _BOARD_M)
    ]
    cornice = block((length, depth + 0.03, top), 0.01)
    return (
        plinth(size_m, base),
        Part("Body", body, "body"),
        *doors(list(cells(length - 0.014, low - base - 0.008, columns, z_m=base + 0.004)), y,
               "knob", framed=True),
        Part("Counter", counter.moved(y=HANDLE_M / 2 - 0.005, z=low), "top"),
        Part("Upper_Cabinet", joined(shell), "body", collider="none"),
        Part("Plates", joined(plates), "plate", collider=None),
        Part("Glazing", joined(panes), "glass", collider=None),
        Part("Glazed_Doors", joined([_sash(c.x_m, y_up, c.z_m, c.length_m, c.height_m)
                                     for c in glass]), "front", collider=None),
        Part("Cornice", cornice.moved(y=width / 2 - (depth + 0.03) / 2, z=height - top), "body"),
    )  # fmt: skip


def _sash(x: float, y: float, z: float, length: float, height: float) -> Solid:
    """The wooden frame of a glazed door."""
    rail = 0.05
    stile = block((rail, FRONT_M, height), 0.002)
    bar = block((length - 2 * rail + 0.002, FRONT_M - 0.002, rail), 0.002)
    pieces = [
        stile.moved(x=-(length - rail) / 2),
        stile.moved(x=(length - rail) / 2),
        bar,
        bar.moved(z=height - rail),
    ]
    return joined(pieces).moved(x, y - FRONT_M / 2, z)


ShoeKind = Literal["flaps", "louvres", "bench"]


def shoe_cabinet(size_m: Size, *, kind: ShoeKind = "flaps") -> tuple[Part, ...]:
    """A shallow hall cabinet: tilting flaps, louvred doors, or a bench with doors above."""
    length, width, height = size_m
    if kind == "bench":
        return _shoe_tower(size_m)
    handle: HandleKind = "knob"
    y, base, top = _face_y(width, handle), 0.08, 0.022
    body = _carcass(length - 0.01, y, width / 2 - 0.002, height - base - top + 0.002, base)
    tall = height - base - top - 0.008
    columns = max(1, round(length / 0.6))
    plate = rounded_slab((length, width - HANDLE_M + 0.006, top), 0.006, 0.004, 3)
    if kind == "flaps":
        rows = (1.0,) * max(2, round(tall / 0.38))
        face = list(cells(length - 0.018, tall, columns, rows, base + 0.004))
        fronts = drawers(face, y, handle)
    else:
        face = list(cells(length - 0.018, tall, 2 * columns, z_m=base + 0.004))
        fronts = (
            *doors(face, y, handle),
            Part("Louvres", joined([_louvres(c, y) for c in face]), "front", collider=None),
        )
    return (
        plinth(size_m, base),
        Part("Body", body, "body"),
        *fronts,
        Part("Top", plate.moved(y=HANDLE_M / 2 - 0.003, z=height - top), "top"),
    )


def _louvres(cell, y: float) -> Solid:  # noqa: ANN001
    """Slanting slats on the upper part of a door."""
    count = max(4, int(cell.height_m / 0.055))
    step = (cell.height_m - 0.12) / count
    slat = block((cell.length_m - 0.11, 0.008, step * 0.95), 0.002).turned("x", -16)
    low = cell.z_m + 0.06
    return joined([slat.moved(cell.x_m, y - FRONT_M - 0.002, low + step * i) for i in range(count)])


def _shoe_tower(size_m: Size) -> tuple[Part, ...]:
    """Full height: doors on one side, a seat with coat hooks and upper doors on the other."""
    length, width, height = size_m
    y, base = _face_y(width, "knob"), 0.08
    tower, bench = length * 0.42, length * 0.58
    x_tower, x_bench = (tower - length) / 2, (length - bench) / 2
    upper = height - 0.45
    parts = [plinth(size_m, base)]
    column = _carcass(tower, y, width / 2, height - base, base).moved(x=x_tower)
    low = _carcass(bench + 0.002, y, width / 2, 0.32, base).moved(x=x_bench)
    high = _carcass(bench + 0.002, y, width / 2, 0.45, upper).moved(x=x_bench)
    back = block((bench, 0.018, upper - 0.4 + 0.004)).moved(x_bench, width / 2 - 0.012, 0.398)
    seat = rounded_slab((bench - 0.01, width - HANDLE_M, 0.06), 0.02, 0.02, 4, 2)
    hooks = [
        block((0.02, 0.05, 0.02)).moved(x_bench + (i - 1) * bench / 4, width / 2 - 0.045, 1.5)
        for i in range(3)
    ]
    face = [
        *_shifted(
            cells(tower - 0.006, height - base - 0.006, 1, (1.3, 1.0), base + 0.003), x_tower
        ),
        *_shifted(cells(bench - 0.006, 0.31, 2, z_m=base + 0.004), x_bench),
        *_shifted(cells(bench - 0.006, 0.44, 2, z_m=upper + 0.004), x_bench),
    ]
    rail = block((bench - 0.1, 0.02, 0.08)).moved(x_bench, width / 2 - 0.03, 1.47)
    return (
        *parts,
        Part("Tower", column, "body"),
        Part("Bench", low, "body"),
        Part("Upper_Cabinet", high, "body"),
        Part("Back", back, "top"),
        *doors(face, y, "knob", low=False),
        Part("Seat", seat.moved(x_bench, HANDLE_M / 2, base + 0.318), "cushion"),
        Part("Hook_Rail", rail, "body", collider=None),
        Part("Hooks", joined(hooks), "handle", collider=None),
    )


def _shifted(face, x: float):  # noqa: ANN001, ANN202
    from dataclasses import replace

    return [replace(cell, x_m=cell.x_m + x) for cell in face]


def bedside_table(
    size_m: Size, *, kind: Literal["drawers", "open", "round"] = "drawers"
) -> tuple[Part, ...]:
    """A night stand: two drawers on legs, one drawer over an open shelf, or a round one."""
    length, width, height = size_m
    if kind == "round":
        return _drum_stand(size_m)
    if kind == "drawers":
        return chest(size_m, rows=(1.2, 1.0), handle="knob")
    y, board = _face_y(width, "knob"), 0.02
    depth = width / 2 - y
    middle = (y + width / 2) / 2
    drawer_z = height - 0.2
    side = block((board, depth, height - 0.13)).moved((length - board) / 2, middle, 0.11)
    shelf = block((length - 2 * board + 0.002, depth - 0.01, board)).moved(y=middle, z=0.13)
    case = box((length - 2 * board, depth - 0.006, 0.18)).moved(y=middle, z=drawer_z)
    back = box((length - 2 * board, 0.01, drawer_z - 0.13)).moved(y=width / 2 - 0.01, z=0.13)
    plate = rounded_slab((length, width - HANDLE_M + 0.004, board), 0.006, 0.004, 3)
    return (
        *four_legs(length - 0.04, width - 0.08, 0.115, 0.035),
        Part("Sides", mirrored_pair(side), "body", collider="none"),
        Part("Shelf", shelf, "body"),
        Part("Drawer_Box", case, "body"),
        Part("Back", back, "body"),
        *drawers(list(cells(length - 0.01, 0.172, 1, z_m=drawer_z + 0.004)), y, "knob"),
        Part("Top", plate.moved(y=HANDLE_M / 2 - 0.002, z=height - board), "top"),
    )


def _drum_stand(size_m: Size) -> tuple[Part, ...]:
    """A round stand: an open-looking drum below, a drawer drum with a knob above."""
    length, width, height = size_m
    out = HANDLE_M - 0.012
    deep = width - out
    low = rounded_slab((length - 0.02, deep - 0.02, height - 0.33), length, 0.008, 10, 2)
    high = rounded_slab((length - 0.02, deep - 0.02, 0.165), length, 0.008, 10, 2)
    waist = rounded_slab((length - 0.05, deep - 0.05, 0.03), length, 0.002, 10)
    top = rounded_slab((length, deep, 0.022), length, 0.008, 10, 2)
    y = out / 2
    grip = knob().moved(y=y - deep / 2 + 0.022, z=height - 0.105)
    return (
        *four_legs(length * 0.7, width * 0.7, 0.135, 0.03, is_round=True),
        Part("Drum", low.moved(y=y, z=0.13), "body"),
        Part("Waist", waist.moved(y=y, z=height - 0.208), "plinth", collider=None),
        Part("Drawer", high.moved(y=y, z=height - 0.186), "front"),
        Part("Knob", grip, "handle", collider=None),
        Part("Top", top.moved(y=y, z=height - 0.022), "top"),
    )


def tv_cabinet(
    size_m: Size, *, kind: Literal["drawers", "slats"] = "drawers", tv_m: float = 1.1
) -> tuple[Part, ...]:
    """A low cabinet with a television on it.

    size_m is the cabinet's own: the television stands above the nominal height, near the wall,
    and is tv_m long (16:9).
    """
    length, width, height = size_m
    y, base, top = -width / 2 + FRONT_M, 0.1, 0.022
    body = _carcass(length - 0.01, y, width / 2 - 0.002, height - base - top + 0.002, base)
    columns = max(2, round(length / 0.6))
    face = list(cells(length - 0.016, height - base - top - 0.006, columns, z_m=base + 0.003))
    if kind == "slats":
        panels = Part("Doors", joined([_slatted(c, y) for c in face]), "front")
    else:
        panels = Part("Drawers", joined([front(c, y) for c in face]), "front")
    plate = rounded_slab((length, width, top), 0.006, 0.004, 3)
    return (
        *four_legs(length - 0.12, width - 0.06, base + 0.01, 0.045, is_round=True, splay_m=0.012),
        Part("Body", body, "body"),
        panels,
        Part("Top", plate.moved(z=height - top), "top"),
        *television(min(tv_m, length * 0.86), width / 2 - 0.1, height),
    )


def _slatted(cell, y: float) -> Solid:  # noqa: ANN001
    """A door of upright slats on a back board."""
    count = max(6, int(cell.length_m / 0.035))
    step = cell.length_m / count
    board = box((cell.length_m, 0.008, cell.height_m)).moved(cell.x_m, y - 0.004, cell.z_m)
    slat = block((step * 0.62, 0.012, cell.height_m), 0.002).moved(y=y - 0.012, z=cell.z_m)
    left = cell.x_m - cell.length_m / 2
    return joined([board, *(slat.moved(x=left + step * (i + 0.5)) for i in range(count))])


def television(length: float, y: float, z: float) -> tuple[Part, ...]:
    """A flat screen on two feet, its back at about y; stands on height z."""
    tall = length * 9 / 16 + 0.02
    case = block((length, 0.032, tall), 0.006).moved(y=y, z=z + 0.07)
    bulge = block((length * 0.7, 0.05, tall * 0.6), 0.012).moved(y=y + 0.03, z=z + 0.09)
    glass = box((length - 0.016, 0.002, tall - 0.022)).moved(y=y - 0.0165, z=z + 0.083)
    foot = [
        block((0.03, 0.16, 0.012)).moved(length * 0.34, y),
        block((0.022, 0.022, 0.08)).moved(length * 0.34, y, 0.008),
    ]
    feet = mirrored_pair(joined(foot)).moved(z=z - 0.001)
    return (
        Part("Television", case + bulge, "tv", above=True),
        Part("Screen", glass, "screen", collider=None, above=True),
        Part("Television_Feet", feet, "tv", collider=None, above=True),
    )


def _look(body: str, fronts: str, handle: str, **more: str) -> dict[str, str]:
    base = {
        "body": body, "front": fronts, "top": body, "plinth": "graphite", "leg": body,
        "handle": handle, "glass": "smoked_glass", "back": body, "plate": "ceramic",
        "cushion": "beige_cloth", "tv": "plastic_black", "screen": "screen",
        "book_red": "red_cover", "book_blue": "blue_cover", "book_pale": "paper",
    }  # fmt: skip
    return {**base, **more}


_WARDROBE = {
    "white_oak": _look("pale_oak", "white", "steel"),
    "oak": _look("oak", "oak", "black_metal"),
    "graphite": _look("walnut", "graphite", "brass"),
}
_FRAMED = {
    "sage": _look("sage", "sage", "brass"),
    "white": _look("warm_white", "warm_white", "black_metal"),
    "navy": _look("navy", "navy", "brass"),
}
_LIVING = {
    "oak": _look("oak", "oak", "black_metal", leg="black_metal"),
    "walnut": _look("walnut", "walnut", "brass", leg="brass"),
    "white": _look("oak", "white", "steel"),
}
_HALL = {
    "white": _look("white", "white", "black_metal", top="oak"),
    "oak": _look("oak", "oak", "black_metal"),
    "green": _look("forest", "forest", "brass", top="walnut"),
}


def _case(name: str, category: str, size_m: Size, draw, looks) -> Design:  # noqa: ANN001
    return Design(name, category, size_m, draw, looks)


DESIGNS = (
    Design(
        "Chest_Narrow", "cabinet", (0.6, 0.42, 1.0),
        partial(chest, rows=(1.2, 1, 1, 1, 0.8)), _LIVING,
    ),
    Design("Bookcase_Single", "cabinet", (0.85, 0.4, 2.0), bookcase, _LIVING),
    Design(
        "Wardrobe_Two_Doors", "cabinet", (0.95, 0.58, 2.1), partial(wardrobe, framed=True,
        handle="knob"), _FRAMED,
    ),
    Design(
        "Chest_Double", "cabinet", (1.25, 0.46, 0.85),
        partial(chest, columns=2, rows=(1.2, 1, 0.8)), _LIVING,
    ),
    Design("Wardrobe_Three_Doors", "cabinet", (1.4, 0.6, 2.2), partial(wardrobe, leaves=3),
           _WARDROBE),
    Design("Bookcase_Double", "cabinet", (1.7, 0.42, 2.1), partial(bookcase, bays=2), _LIVING),
    Design("Wardrobe_Four_Doors", "cabinet", (1.85, 0.6, 2.3), partial(wardrobe, leaves=4),
           _WARDROBE),
    Design("Wardrobe_Sliding", "cabinet", (2.2, 0.64, 2.35), sliding_wardrobe, _WARDROBE),
    Design("Wardrobe_Sliding_Wide", "cabinet", (2.65, 0.64, 2.4),
           partial(sliding_wardrobe, leaves=3), _WARDROBE),
    Design("Bedside_Drawers", "bedside_table", (0.48, 0.42, 0.52), bedside_table, _LIVING),
    Design("Bedside_Open", "bedside_table", (0.42, 0.38, 0.5), partial(bedside_table, kind="open"),
           _LIVING),
    Design("Bedside_Round", "bedside_table", (0.44, 0.44, 0.5),
           partial(bedside_table, kind="round"), _LIVING),
    Design("Bedside_Wide", "bedside_table", (0.58, 0.45, 0.5), bedside_table, _LIVING),
    Design("TV_Cabinet_Short", "tv_cabinet", (1.15, 0.35, 0.48), tv_cabinet, _LIVING),
    Design("TV_Cabinet_Slats", "tv_cabinet", (1.6, 0.4, 0.46),
           partial(tv_cabinet, kind="slats", tv_m=1.23), _LIVING),
    Design("TV_Cabinet_Long", "tv_cabinet", (2.0, 0.42, 0.45), partial(tv_cabinet, tv_m=1.45),
           _LIVING),
    Design("TV_Cabinet_Extra_Long", "tv_cabinet", (2.45, 0.45, 0.45),
           partial(tv_cabinet, kind="slats", tv_m=1.67), _LIVING),
    Design("Dresser_Narrow", "dining_cabinet", (0.95, 0.42, 2.05), hutch, _FRAMED),
    Design("Sideboard", "dining_cabinet", (1.45, 0.42, 0.85), sideboard, _LIVING),
    Design("Dresser_Wide", "dining_cabinet", (1.3, 0.46, 2.1), hutch, _FRAMED),
    Design("Sideboard_Long", "dining_cabinet", (1.85, 0.45, 0.85),
           partial(sideboard, framed=True, handle="knob"), _FRAMED),
    Design("Shoe_Cabinet_Flaps", "shoe_cabinet", (0.7, 0.28, 1.1), shoe_cabinet, _HALL),
    Design("Shoe_Cabinet_Louvres", "shoe_cabinet", (1.0, 0.36, 1.0),
           partial(shoe_cabinet, kind="louvres"), _HALL),
    Design("Shoe_Cabinet_Bench", "shoe_cabinet", (1.4, 0.4, 2.15),
           partial(shoe_cabinet, kind="bench"), _HALL),
)  # fmt: skip
