"""What stands on desks: books, computers, lamps, pens, pictures."""

from __future__ import annotations

import math
from functools import partial
from typing import Literal

import numpy as np

from chord_usd.assets.model import Design, Part
from chord_usd.assets.solids import (
    Size,
    Solid,
    bent_path,
    block,
    box,
    cylinder,
    extruded,
    joined,
    lathe,
    mirrored_pair,
    rounded_profile,
    rounded_slab,
    tube,
)

_COVERS = ("cover_a", "cover_b", "cover_c")


def _book(length: float, width: float, thick: float) -> tuple[Solid, Solid]:
    """(cover, pages) of a book lying flat, its spine to the left."""
    board = min(0.003, thick / 4)
    plate = block((length, width, board), 0.001)
    spine = block((board, width, thick - 2 * board), 0.0005).moved(-(length - board) / 2, z=board)
    pages = box((length - 0.008, width - 0.01, thick - 2 * board + 0.0005))
    cover = joined([plate, plate.moved(z=thick - board), spine])
    return cover, pages.moved(x=-0.002, z=board - 0.0002)


def _hardback(length: float, width: float, thick: float) -> tuple[Solid, Solid]:
    """(cover, pages) of a book to be seen from near: round corners and spine, pages hollowed."""
    board = min(0.003, thick / 4)
    inner = thick - 2 * board
    plate = rounded_slab((length - 0.003, width, board), 0.0025, 0.0008, 5).moved(x=0.0015)
    angles = np.linspace(-math.pi / 2, math.pi / 2, 11)
    bow = np.stack([-0.006 * np.cos(angles), inner / 2 * np.sin(angles)], axis=-1)
    outline = np.concatenate([bow, bow[::-1] * [0.5, 0.9] + [0.0006, 0.0]])
    outline[:, 0] += 0.006
    spine = extruded(outline[::-1], width - 0.001).turned("x", 90)
    spine = spine.moved(-length / 2, (width - 0.001) / 2, board + inner / 2)
    fore = bow * [0.5, 1.0] + [length / 2 - 0.003, 0.0]
    back = [[-length / 2 + 0.006, inner / 2], [-length / 2 + 0.006, -inner / 2]]
    leaves = extruded(np.concatenate([fore, back]), width - 0.008).turned("x", 90)
    pages = leaves.moved(0.0, (width - 0.008) / 2, board + inner / 2)
    return joined([plate, plate.moved(z=thick - board), spine]), pages


def lying_books(size_m: Size, *, count: int = 1) -> tuple[Part, ...]:
    """One book, or a pile of them turned a little against each other."""
    length, width, height = size_m
    parts, pages = [], []
    for index in range(count):
        shrink = 1.0 - 0.1 * index
        turn = (0.0, 6.0, -7.0)[index % 3]
        inset = abs(math.sin(math.radians(turn)))
        size = (
            (length - inset * width) * shrink,
            (width - inset * length) * shrink,
            height / count,
        )
        cover, block_of_pages = _hardback(*size)
        z = height / count * index
        parts.append(
            Part(
                f"Cover_{index + 1}",
                cover.turned("z", turn).moved(z=z),
                _COVERS[index % 3],
                collider="boundingCube",
            )
        )
        pages.append(block_of_pages.turned("z", turn).moved(z=z))
    return (*parts, Part("Pages", joined(pages), "paper", collider=None))  # fmt: skip


def standing_books(size_m: Size) -> tuple[Part, ...]:
    """A row of books between two bookends, spines to the front."""
    length, width, height = size_m
    end_m = 0.006
    covers: dict[str, list[Solid]] = {slot: [] for slot in _COVERS}
    pages, x, count = [], -length / 2 + end_m, 0
    while True:
        thick = (0.03, 0.022, 0.038, 0.026, 0.034)[count % 5]
        rest = length / 2 - end_m - x
        if rest < 0.004:
            break
        thick = rest if rest < thick + 0.018 else thick
        tall = height * (1.0, 0.9, 0.96, 0.84, 0.93)[count % 5]
        deep = width * (0.98, 0.9, 0.95, 0.86, 0.92)[count % 5]
        cover, block_of_pages = _book(deep, tall, thick - 0.001)
        at = {"x": x + thick / 2, "y": -width / 2 + deep / 2, "z": tall / 2}
        covers[_COVERS[count % 3]].append(_stood_up(cover, thick).moved(**at))
        pages.append(_stood_up(block_of_pages, thick).moved(**at))
        x, count = x + thick, count + 1
    end = block((end_m, width, height * 0.62), 0.001).moved((length - end_m) / 2)
    row = [
        Part(f"Books_{slot[-1].upper()}", joined(solids), slot, collider=None)
        for slot, solids in covers.items()
        if solids
    ]
    return (
        *row,
        Part("Pages", joined(pages), "paper", collider=None),
        # The box around both ends is the box around the row, and stands upright.
        Part("Bookends", mirrored_pair(end), "metal"),
    )  # fmt: skip


def _stood_up(book: Solid, thick: float) -> Solid:
    """A lying book stood on its lower edge, spine to the front, centred."""
    return book.moved(z=-thick / 2).turned("x", 90).turned("z", 90)


def magazine(size_m: Size) -> tuple[Part, ...]:
    """A thin magazine with a picture, a title, lines of text and a bar code on its cover."""
    length, width, height = size_m
    paper = max(height - 0.0006, height * 0.8)
    picture = box((length * 0.82, width * 0.5, height * 0.1)).moved(y=-width * 0.1, z=paper - 1e-4)
    title = box((length * 0.7, width * 0.12, height - paper + 1e-4)).moved(
        y=width * 0.36, z=paper - 1e-4
    )
    ink = height * 0.1
    lines = [
        box((length * share, width * 0.012, ink)).moved(
            -length * (0.41 - share / 2), -width * (0.37 + 0.015 * row), paper - 1e-4
        )
        for row, share in enumerate((0.5, 0.46, 0.5, 0.3, 0.0, 0.5, 0.44, 0.2))
        if share
    ]
    bars = [
        box((length * (0.004 + 0.004 * (index % 3)), width * 0.06, ink)).moved(
            length * (0.2 + 0.015 * index), -width * 0.42, paper - 1e-4
        )
        for index in range(15)
    ]
    return (
        Part("Sheets", rounded_slab((length, width, paper), 0.002, 0.0005, 6), "paper"),
        Part("Picture", picture, "cover_a", collider=None),
        Part("Title", title, "cover_b", collider=None),
        Part("Text", joined([*lines, *bars]), "metal", collider=None),
    )


def mouse_pad(size_m: Size) -> tuple[Part, ...]:
    """A desk mat with a stitched rim."""
    length, width, height = size_m
    mat = rounded_slab((length - 0.006, width - 0.006, height * 0.94), 0.02, 0.001, 6)
    rim = tube(_rim(length, width, height), height / 2, 8)
    return Part("Mat", mat, "cloth"), Part("Rim", rim, "rim", collider=None)


def _rim(length: float, width: float, height: float) -> np.ndarray:
    """Nearly closed path around the mat at half its thickness."""
    r, z = height / 2, height / 2
    x, y = length / 2 - r, width / 2 - r
    corners = [[0, -y, z], [x, -y, z], [x, y, z], [-x, y, z], [-x, -y, z], [-0.002, -y, z]]
    return bent_path(corners, 0.02, 4)


def pen_holder(size_m: Size) -> tuple[Part, ...]:
    """A cup with pens and a ruler."""
    length, width, height = size_m
    cup_h = height * 0.55
    cup = lathe(
        [(0.5, 0), (0.5, cup_h), (0.46, cup_h), (0.46, 0.008), (0.0, 0.008)], 36
    ).scaled(length, width, 1.0)  # fmt: skip
    pens = []
    spread = min(length, width) * 0.36
    for index in range(4):
        turn = math.radians(90 * index + 30)
        foot = [-0.6 * spread * math.cos(turn), -0.6 * spread * math.sin(turn), 0.01]
        top = [1.15 * spread * math.cos(turn), 1.15 * spread * math.sin(turn),
               height * (1.0, 0.93, 0.97, 0.9)[index] - 0.002]  # fmt: skip
        pens.append(tube([foot, top], 0.004, 14))
    return (
        Part("Cup", cup, "cup"),
        Part("Pens_A", pens[0] + pens[2], "cover_a", collider=None),
        Part("Pens_B", pens[1] + pens[3], "cover_b", collider=None),
    )


def photo_frame(size_m: Size) -> tuple[Part, ...]:
    """A leaning frame with a landscape behind a mat, on an easel foot."""
    length, width, height = size_m
    lean_deg = min(14.0, math.degrees(math.atan2(width * 0.7, height)))
    tall = (height - 0.016 * math.sin(math.radians(lean_deg))) / math.cos(math.radians(lean_deg))
    rail, deep = 0.018, 0.016
    stile = block((rail, deep, tall), 0.002)
    bar = block((length - 2 * rail + 0.002, deep - 0.002, rail), 0.002)
    at = (length - rail) / 2
    frame = joined([mirrored_pair(stile.moved(at)), bar, bar.moved(z=tall - rail)])
    slip = _slip(length - 2 * rail, tall - 2 * rail).moved(y=-0.003, z=rail)
    mat = box((length - rail, 0.004, tall - rail)).moved(y=0.002, z=rail / 2)
    inner_l, inner_h = length - 2 * rail - 0.03, tall - 2 * rail - 0.03
    sky = box((inner_l, 0.002, inner_h)).moved(y=-0.001, z=rail + 0.015)
    hill = box((inner_l - 0.001, 0.003, inner_h * 0.42)).moved(y=-0.002, z=rail + 0.015)
    back = -width / 2 + deep / 2
    slope = math.tan(math.radians(lean_deg))
    rest = [0.0, back + slope * tall * 0.55 + 0.008, tall * 0.55]
    prop = tube([rest, [0.0, width / 2 - 0.004, 0.004]], 0.004, 8)
    tilted = [
        solid.turned("x", -lean_deg).moved(y=back + 0.001)
        for solid in (frame, mat, sky, hill, slip)
    ]
    return (
        Part("Frame", tilted[0], "wood"),
        Part("Mat", tilted[1], "paper", collider=None),
        Part("Sky", tilted[2], "sky", collider=None),
        Part("Hill", tilted[3], "land", collider=None),
        Part("Slip", tilted[4], "paper", collider=None),
        Part("Prop", prop, "wood"),
    )  # fmt: skip


def _slip(length: float, height: float) -> Solid:
    """The thin inner frame that holds a picture under its glass."""
    thin = 0.005
    stile = block((thin, 0.006, height), 0.001).moved((length - thin) / 2)
    bar = block((length - 2 * thin + 0.001, 0.005, thin), 0.001)
    return joined([mirrored_pair(stile), bar, bar.moved(z=height - thin)])


_PRINT = {
    "red": {"cover_a": "red_cover", "cover_b": "blue_cover", "cover_c": "yellow_cover",
            "paper": "paper", "metal": "black_metal"},
    "green": {"cover_a": "green_cover", "cover_b": "sand", "cover_c": "navy", "paper": "paper",
              "metal": "brass"},
}  # fmt: skip
_MAT = {
    "charcoal": {"cloth": "charcoal_cloth", "rim": "black"},
    "tan": {"cloth": "tan_leather", "rim": "brown_leather"},
}
_CUP = {
    "white": {"cup": "ceramic", "cover_a": "blue_cover", "cover_b": "red_cover"},
    "black": {"cup": "black_metal", "cover_a": "yellow_cover", "cover_b": "green_cover"},
}
_PICTURE = {
    "oak": {"wood": "oak", "paper": "paper", "sky": "light_blue", "land": "leaf"},
    "black": {"wood": "black_stain", "paper": "paper", "sky": "blush", "land": "navy"},
}

DESIGNS = (
    Design("Book_Lying", "lying_book", (0.15, 0.21, 0.025), lying_books, _PRINT),
    Design("Book_Lying_Small", "lying_book", (0.13, 0.2, 0.03), lying_books, _PRINT),
    Design("Books_Pair", "lying_book", (0.17, 0.24, 0.04), partial(lying_books, count=2), _PRINT),
    Design("Books_Pile", "lying_book", (0.2, 0.27, 0.06), partial(lying_books, count=3), _PRINT),
    Design("Books_Row_Short", "standing_book", (0.18, 0.18, 0.24), standing_books, _PRINT),
    Design("Books_Row_Medium", "standing_book", (0.26, 0.18, 0.24), standing_books, _PRINT),
    Design("Books_Row_Long", "standing_book", (0.36, 0.2, 0.26), standing_books, _PRINT),
    Design("Magazine", "magazine", (0.21, 0.28, 0.008), magazine, _PRINT),
    Design("Desk_Mat", "big_mouse_pad", (0.8, 0.35, 0.004), mouse_pad, _MAT),
    Design("Desk_Mat_Small", "big_mouse_pad", (0.7, 0.32, 0.004), mouse_pad, _MAT),
    Design("Desk_Mat_Large", "big_mouse_pad", (0.9, 0.4, 0.004), mouse_pad, _MAT),
    Design("Pen_Cup", "pen_holder", (0.09, 0.09, 0.18), pen_holder, _CUP),
    Design("Photo_Portrait", "photo_frame", (0.17, 0.09, 0.22), photo_frame, _PICTURE),
    Design("Photo_Square", "photo_frame", (0.2, 0.08, 0.2), photo_frame, _PICTURE),
    Design("Photo_Landscape", "photo_frame", (0.27, 0.09, 0.2), photo_frame, _PICTURE),
)  # fmt: skip
