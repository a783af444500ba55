"""Sideboards, dressers, bedside tables, TV cabinets with their television."""

from __future__ import annotations

from typing import Literal

from chord_usd.library.kit.forms import cup
from chord_usd.library.kit.joinery import (
    FRONT_M,
    HANDLE_M,
    Cell,
    HandleKind,
    cells,
    doors,
    drawers,
    four_legs,
    hung,
    knob,
    plinth,
)
from chord_usd.library.kit.model import Part, hollow_part, moving_part
from chord_usd.library.kit.moves import door
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    joined,
    mirrored_pair,
    pair,
    rounded_slab,
)
from chord_usd.library.storage.cabinets import (
    BOARD_M,
    carcass,
    chest,
    fronts_y,
)


def sideboard(
    size_m: Size, *, handle: HandleKind = "bar", framed: bool = False
) -> tuple[Part, ...]:
    """A long low cabinet on legs: doors at both ends, drawers in the middle."""
    length, width, height = size_m
    y, base, top = fronts_y(width, handle), 0.14, 0.024
    body = carcass(length - 0.012, y, width / 2 - 0.002, height - base - top + 0.002, base)
    wide, tall = (length - 0.02) / 3, height - base - top - 0.008
    three = list(cells(length - 0.02, tall, 3, z_m=base + 0.004))
    middle = list(cells(wide, tall, 1, (1.2, 1.0, 0.8), base + 0.004))
    plate = rounded_slab((length, width - HANDLE_M + 0.004, top), 0.006, 0.004, 3)
    return (
        *four_legs(length - 0.1, width - 0.1, base + 0.01, 0.045, is_round=True, splay_m=0.015),
        hollow_part("Body", body),
        *doors([three[0], three[2]], y, handle, framed=framed),
        *drawers(middle, y, handle),
        Part("Top", plate.moved(y=HANDLE_M / 2 - 0.002, z=height - top), "top"),
    )


def hutch(size_m: Size) -> tuple[Part, ...]:
    """A dresser: doors below, a shelf for serving, glazed doors with plates above."""
    length, width, height = size_m
    y, base, low = fronts_y(width, "knob"), 0.07, 0.82
    upper_z, top = low + 0.38, 0.03
    depth = width * 0.72
    y_up = width / 2 - depth
    body = carcass(length - 0.006, y, width / 2 - 0.002, low - base, base)
    counter = rounded_slab((length, width - HANDLE_M + 0.01, 0.03), 0.006, 0.005, 3)
    tall = height - upper_z - top
    upper_h = height - low - top - 0.011
    shell = [
        block((length - 0.01, 0.012, upper_h)).moved(y=width / 2 - 0.008, z=low + 0.01),
        *pair(
            block((BOARD_M, depth - 0.01, upper_h)).moved(y=width / 2 - depth / 2, z=low + 0.01),
            x=(length - 0.03) / 2,
        ),
        *(
            block((length - 0.05, depth - 0.02, BOARD_M)).moved(y=width / 2 - depth / 2, z=z)
            for z in (upper_z, upper_z + tall * 0.5, height - top - BOARD_M)
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
    sashes = [_sash(c.x_m, y_up, c.z_m, c.length_m, c.height_m) for c in glass]
    leaves = [door(sash, hung=hung(c)) for c, sash in zip(glass, sashes, strict=True)]
    plates = [
        _dishes(index).moved(x, width / 2 - depth / 2 + 0.02, z)
        for index, (x, z) in enumerate(
            (x, z)
            for x in (-length / 4, length / 4)
            for z in (upper_z + BOARD_M, upper_z + tall * 0.5 + BOARD_M)
        )
    ]
    cornice = block((length, depth + 0.03, top), 0.01)
    return (
        plinth(size_m, base),
        hollow_part("Body", body),
        *doors(list(cells(length - 0.014, low - base - 0.008, columns, z_m=base + 0.004)), y,
               "knob", framed=True),
        Part("Counter", counter.moved(y=HANDLE_M / 2 - 0.005, z=low), "top"),
        Part("Upper_Cabinet", joined(shell), "body", colliders=tuple(shell)),
        Part("Plates", joined(plates), "plate", collider=None),
        moving_part("Glazed_Doors", sashes, "front", leaves, None),
        moving_part("Glazing", panes, "pane", leaves, None),
        Part("Cornice", cornice.moved(y=width / 2 - (depth + 0.03) / 2, z=height - top), "body"),
    )  # fmt: skip


def _dishes(number: int) -> Solid:
    """A pile of plates, or of bowls with a cup beside it."""
    if number % 2 == 0:
        plate = cup([(0.0, 0.0), (0.05, 0.0), (0.055, 0.004), (0.1, 0.014)], 0.003, 0.004, 24)
        return joined([plate.moved(z=0.009 * index) for index in range(6)])
    bowl = cup([(0.0, 0.0), (0.028, 0.0), (0.05, 0.02), (0.062, 0.045)], 0.003, 0.006, 20)
    mug = cup([(0.0, 0.0), (0.036, 0.0), (0.038, 0.004), (0.038, 0.085)], 0.003, 0.006, 20)
    pile = [bowl.moved(-0.05, z=0.022 * index) for index in range(4)]
    return joined([*pile, mug.moved(0.07), mug.moved(0.04, 0.07)])


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


def bedside_table(
    size_m: Size, *, kind: Literal["drawers", "open", "round"] = "drawers"
) -> tuple[Part, ...]:
    """A night stand: two drawers on legs, one drawer over an open shelf, or a round one."""
    length, width, height = size_m
    if kind == "round":
        return _drum_stand(size_m)
    if kind == "drawers":
        return chest(size_m, rows=(1.2, 1.0), handle="knob")
    y, board = fronts_y(width, "knob"), 0.02
    depth = width / 2 - y
    middle = (y + width / 2) / 2
    drawer_z = height - 0.2
    right = block((board, depth, height - 0.13)).moved((length - board) / 2, middle, 0.11)
    shelf = block((length - 2 * board + 0.002, depth - 0.01, board)).moved(y=middle, z=0.13)
    case = box((length - 2 * board, depth - 0.006, 0.18)).moved(y=middle, z=drawer_z)
    back = box((length - 2 * board, 0.01, drawer_z - 0.131)).moved(y=width / 2 - 0.012, z=0.131)
    plate = rounded_slab((length, width - HANDLE_M + 0.004, board), 0.006, 0.004, 3)
    return (
        *four_legs(length - 0.04, width - 0.08, 0.115, 0.035),
        Part("Sides", mirrored_pair(right), "body", colliders=(right, right.scaled(x=-1.0))),
        Part("Shelf", shelf, "body"),
        hollow_part("Drawer_Box", case),
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


TvKind = Literal["drawers", "slats", "niche", "framed", "steel"]


def tv_cabinet(
    size_m: Size, *, kind: TvKind = "drawers", has_screen: bool = True
) -> tuple[Part, ...]:
    """A low cabinet with a television on it, or none: before a window one sees nothing on it.

    size_m is the cabinet's own: the television (16:9) stands above the nominal height, near the
    wall.
    """
    length, width, height = size_m
    draw = {"niche": _open_middle, "framed": _panelled, "steel": steel_rack}.get(kind)
    cabinet = draw(size_m) if draw else _flat_front(size_m, has_slats=kind == "slats")
    if not has_screen:
        return cabinet
    screen_m = min(0.45 + 0.45 * length, length * 0.86)
    return (*cabinet, *television(screen_m, width / 2 - 0.1, height))


def _flat_front(size_m: Size, *, has_slats: bool) -> tuple[Part, ...]:
    """Drawers without handles, or doors of slats."""
    length, width, height = size_m
    y, base, top = -width / 2 + FRONT_M, 0.1, 0.022
    body = carcass(length - 0.01, y, width / 2 - 0.002, height - base - top + 0.002, base)
    columns = max(2, round(length / 0.6))
    face = list(cells(length - 0.016, height - base - top - 0.006, columns, z_m=base + 0.003))
    if has_slats:
        slatted = [_slatted(c, y) for c in face]
        leaves = [door(panel, hung=hung(c)) for c, panel in zip(face, slatted, strict=True)]
        panels = moving_part("Doors", slatted, "front", leaves)
    else:
        (panels,) = drawers(face, y, "none")
    plate = rounded_slab((length, width, top), 0.006, 0.004, 3)
    return (
        *four_legs(length - 0.12, width - 0.06, base + 0.01, 0.045, is_round=True, splay_m=0.012),
        hollow_part("Body", body),
        panels,
        Part("Top", plate.moved(z=height - top), "top"),
    )


def _open_middle(size_m: Size) -> tuple[Part, ...]:
    """On high splayed legs: a door at each end, an open niche with a board between them."""
    length, width, height = size_m
    base, board = 0.19, 0.02
    tall, y = height - base, -width / 2 + FRONT_M
    depth = width - FRONT_M - 0.002
    wide = 0.29 * length
    middle = y + depth / 2
    plate = rounded_slab((length, width, board), 0.006, 0.004, 3)
    case = box((wide, depth, tall - 2 * board + 0.002))
    x = (length - wide) / 2 - 0.002
    z = base + board - 0.001
    inner = length - 2 * wide
    back = box((inner + 0.01, 0.01, tall - 2 * board)).moved(y=width / 2 - 0.008, z=z)
    shelf = box((inner + 0.006, depth - 0.03, 0.016)).moved(y=middle + 0.01, z=base + 0.52 * tall)
    face = [
        Cell(side * x, z + 0.003, wide - 0.006, tall - 2 * board - 0.006, column, 0)
        for column, side in enumerate((-1, 1))
    ]
    right = case.moved(x, middle, z)
    ends = (right, right.scaled(x=-1.0))
    return (
        *four_legs(length - 0.1, width - 0.04, base + 0.01, 0.05, is_round=True, splay_m=0.05),
        Part("Bottom", plate.scaled(0.998, 0.998, 1.0).moved(z=base), "body"),
        Part("Ends", joined(ends), "body", colliders=ends, hollow=ends),
        Part("Back", back, "body", collider=None),
        Part("Shelf", shelf, "body", collider=None),
        *doors(face, y, "none"),
        Part("Top", plate.moved(z=height - board), "top"),
    )


def _panelled(size_m: Size) -> tuple[Part, ...]:
    """Panelled doors with knobs on a plinth, under a projecting top."""
    length, width, height = size_m
    y, base, top = fronts_y(width, "knob"), 0.07, 0.03
    body = carcass(length - 0.03, y, width / 2 - 0.002, height - base - top + 0.002, base)
    columns = max(2, round(length / 0.5))
    face = list(cells(length - 0.04, height - base - top - 0.008, columns, z_m=base + 0.004))
    plate = rounded_slab((length, width, top), 0.008, 0.01, 3, 3)
    return (
        plinth((length - 0.01, width, height), base, 0.03),
        hollow_part("Body", body),
        *doors(face, y, "knob", framed=True),
        Part("Top", plate.moved(z=height - top), "top"),
    )


def steel_rack(size_m: Size) -> tuple[Part, ...]:
    """Three thick boards in a frame of square tube, a drawer box in the middle."""
    length, width, height = size_m
    bar, board = 0.028, 0.035
    x, y = (length - bar) / 2, (width - bar) / 2
    post = block((bar, bar, height - board + 0.001), 0.002)
    places = ((-x, y), (-x, -y), (x, -y), (x, y))
    tie = block((bar - 0.002, width - 2 * bar + 0.002, bar), 0.002)
    hoops = [mirrored_pair(tie.moved(x, z=z)) for z in (0.05, height - board - bar)]
    plank = block((length - 2 * bar + 0.002, width - 0.004, board), 0.004)
    tall = height - 2 * board - 0.09
    case = box((0.36 * length, width - 0.05, tall)).moved(y=0.01, z=0.089)
    face = Cell(0.0, 0.093, 0.36 * length - 0.006, tall - 0.008, 0, 0)
    top = block((length, width, board), 0.005).moved(z=height - board)
    return (
        *(Part(f"Post_{i}", post.moved(*at), "leg") for i, at in enumerate(places, start=1)),
        Part("Frame", joined(hoops), "leg", collider=None),
        Part("Shelf", plank.moved(z=0.055), "top"),
        hollow_part("Drawer_Box", case),
        *drawers([face], -width / 2 + 0.035, "none"),
        Part("Top", top, "top"),
    )


def _slatted(cell: Cell, y: float) -> Solid:
    """A door of upright slats on a back board."""
    count = max(6, int(cell.length_m / 0.035))
    step = cell.length_m / count
    board = box((cell.length_m, 0.008, cell.height_m)).moved(cell.x_m, y - 0.004, cell.z_m)
    slat = block((step * 0.62, 0.012, cell.height_m), 0.002).moved(y=y - 0.012, z=cell.z_m)
    left = cell.x_m - cell.length_m / 2
    return joined([board, *(slat.moved(x=left + step * (i + 0.5)) for i in range(count))])


def wall_television(size_m: Size) -> tuple[Part, ...]:
    """A flat screen on a plate at the wall."""
    length, depth, height = size_m
    face = -depth / 2
    case = block((length, 0.02, height), 0.004).moved(y=face + 0.012)
    plate = block((0.4, depth - 0.022, 0.24), 0.002).moved(y=0.011, z=height / 2 - 0.12)
    glass = box((length - 0.012, 0.002, height - 0.018)).moved(y=face + 0.001, z=0.009)
    return Part("Television", case + plate, "tv"), Part("Screen", glass, "screen", collider=None)


def television(length: float, y: float, z: float) -> tuple[Part, ...]:
    """A flat screen on two feet, its back at about y; stands on height z."""
    tall = length * 9 / 16 + 0.02
    case = block((length, 0.018, tall), 0.004).moved(y=y - 0.007, z=z + 0.055)
    bulge = block((length * 0.62, 0.045, tall * 0.5), 0.016).moved(y=y + 0.02, z=z + 0.07)
    glass = box((length - 0.01, 0.002, tall - 0.018)).moved(y=y - 0.0165, z=z + 0.068)
    foot = [
        block((0.026, 0.2, 0.009), 0.003).moved(length * 0.34, y),
        block((0.03, 0.014, 0.07), 0.003).moved(length * 0.34, y, 0.008),
    ]
    feet = mirrored_pair(joined(foot)).moved(z=z - 0.001)
    return (
        Part("Television", case + bulge, "tv", above=True),
        Part("Screen", glass, "screen", collider=None, above=True),
        Part("Television_Feet", feet, "tv", collider=None, above=True),
    )
