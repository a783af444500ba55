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


def all_in_one(size_m: Size) -> tuple[Part, ...]:
    """A screen on a foot with keyboard and mouse before it."""
    length, width, height = size_m
    screen_y, low = width / 2 - 0.09, height * 0.22
    tall = height - low
    case = block((length, 0.02, tall), 0.005).moved(y=screen_y, z=low)
    glass = box((length - 0.02, 0.002, tall - 0.05)).moved(y=screen_y - 0.0105, z=low + 0.04)
    foot = rounded_slab((length * 0.36, 0.18, 0.008), 0.02, 0.002).moved(y=screen_y)
    neck = block((0.06, 0.014, height * 0.5), 0.003).turned("x", -8).moved(y=screen_y + 0.03)
    keys_l = length * 0.6
    keyboard = rounded_slab((keys_l, 0.11, 0.014), 0.01, 0.003)
    keyboard = keyboard.moved(-length * 0.08, -width / 2 + 0.055)
    caps = [
        block((keys_l / 13.5, 0.015, 0.004), 0.001).moved(
            -length * 0.08 + keys_l / 12.6 * (column - 5.5),
            -width / 2 + 0.022 + 0.0215 * row,
            0.0135,
        )
        for column in range(12)
        for row in range(4)
    ]
    mouse = rounded_slab((0.055, 0.095, 0.028), 0.027, 0.012, 5, 3)
    return (
        Part("Case", case, "body"),
        Part("Screen", glass, "screen", collider=None),
        Part("Foot", foot + neck, "metal"),
        Part("Keyboard", keyboard, "body"),
        Part("Keys", joined(caps), "keys", collider=None),
        Part("Mouse", mouse.moved(length / 2 - 0.06, -width / 2 + 0.055), "body"),
    )


def laptop(size_m: Size) -> tuple[Part, ...]:
    """An open laptop; the screen leans back over the rear edge."""
    length, width, height = size_m
    thick, lean_deg = 0.014, 15.0
    lean = math.tan(math.radians(lean_deg)) * (height - thick)
    base_w = width - lean
    base = rounded_slab((length, base_w, thick), 0.012, 0.004, 4, 2).moved(y=-lean / 2)
    lid_h = (height - thick) / math.cos(math.radians(lean_deg))
    lid = rounded_slab((length, lid_h, 0.008), 0.012, 0.003, 4, 2)
    glass = box((length - 0.016, lid_h - 0.02, 0.001)).moved(z=0.0078)
    hinge = {"y": base_w / 2 - lean / 2 - 0.004, "z": thick - 0.002}
    raise_lid = partial(_hinged, height=lid_h, lean_deg=lean_deg, at=hinge)
    deck_y = -lean / 2
    caps = [
        block((length / 15.5, 0.013, 0.002), 0.0005).moved(
            length / 14.5 * (column - 6), deck_y + base_w * 0.32 - 0.0165 * row, thick - 0.0006
        )
        for column in range(13)
        for row in range(5)
    ]
    pad = box((length * 0.3, base_w * 0.26, 0.0008)).moved(
        y=deck_y - base_w * 0.3, z=thick - 0.0002
    )
    return (
        Part("Base", base, "body"),
        Part("Lid", raise_lid(lid), "body"),
        Part("Screen", raise_lid(glass), "screen", collider=None),
        Part("Keys", joined(caps), "keys", collider=None),
        Part("Trackpad", pad, "metal", collider=None),
    )


def _hinged(solid: Solid, height: float, lean_deg: float, at: dict[str, float]) -> Solid:
    """A lid drawn lying, stood up on its lower edge and leaned back."""
    return solid.moved(y=height / 2).turned("x", 90 - lean_deg).moved(**at)


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


def table_lamp(size_m: Size, *, kind: Literal["shade", "arm"] = "shade") -> tuple[Part, ...]:
    """A lamp with a fabric shade on a turned foot, or a jointed desk lamp."""
    length, width, height = size_m
    reach = min(length, width) / 2
    if kind == "arm":
        return _desk_lamp(length, width, height)
    shade_h = height * 0.42
    neck = reach * 0.72
    profile = [(reach, 0), (neck, shade_h), (neck - 0.003, shade_h), (reach - 0.003, 0)]
    shade = lathe(profile, 32, loop=True).moved(z=height - shade_h)
    spider = box((2 * neck, 0.006, 0.002)).moved(z=height - 0.012)
    foot_r = reach * 0.55
    belly = rounded_profile(
        [(foot_r * 0.4, 0.022), (foot_r * 0.75, height * 0.18), (foot_r * 0.9, height * 0.32),
         (foot_r * 0.2, height * 0.44), (0.008, height * 0.52)]
    )  # fmt: skip
    body = lathe(
        [(foot_r, 0), (foot_r, 0.01), *belly, (0.008, height * 0.7), (0, height * 0.7)], 28
    )
    bulb = lathe([(0.012, 0), (0.028, 0.035), (0.026, 0.055), (0.0, 0.075)], 16)
    bulb = bulb.scaled(*(min(1.0, shade_h / 0.12),) * 3)
    return (
        Part("Foot", body, "ceramic"),
        Part("Shade", shade, "shade", collider="convexHull"),
        Part("Spider", spider, "metal", collider=None),
        Part("Bulb", bulb.moved(z=height * 0.68), "shade", collider=None),
    )  # fmt: skip


def _desk_lamp(length: float, width: float, height: float) -> tuple[Part, ...]:
    foot_r = min(length * 0.3, width * 0.5, 0.09)
    foot_x = length / 2 - foot_r
    head_l = min(0.1, length * 0.35)
    elbow = [length / 2 - 0.02, 0.0, height * 0.58]
    arm = [[foot_x, 0, 0.015], elbow, [-length / 2 + head_l, 0, height - 0.02]]
    inside = [(0.0, 0.062), (0.018, 0.06), (width / 2 - 0.003, 0.0)]
    head = lathe([*inside, (width / 2, 0.0), (0.026, 0.066), (0.02, 0.07), (0.0, 0.07)], 24)
    tilt = head.turned("y", 24)
    low, high = tilt.bounds_m()
    at = (-length / 2 - float(low[0]), 0.0, height - float(high[2]))
    return (
        Part("Foot", cylinder(foot_r, 0.016, 0.004, 28).moved(x=foot_x), "metal"),
        Part("Arm", tube(np.array(arm), 0.006, 8), "metal", collider=None),
        Part("Head", tilt.moved(*at), "metal", collider="convexHull"),
    )


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


def electronic(
    size_m: Size, *, kind: Literal["phone", "speaker", "clock"] = "phone"
) -> tuple[Part, ...]:
    """A phone, a round loudspeaker or an alarm clock."""
    length, width, height = size_m
    if kind == "phone":
        case = rounded_slab((length, width, height * 0.94), 0.012, 0.002, 6, 2)
        face = rounded_slab((length - 0.005, width - 0.005, height * 0.2), 0.01, 0.0004, 6)
        return (
            Part("Case", case, "body"),
            Part("Screen", face.moved(z=height * 0.8), "screen", collider=None),
        )
    if kind == "speaker":
        body = lathe([(0.46, 0), (0.5, 0.03), (0.5, 0.9), (0.44, 1.0), (0, 1.0)], 36)
        base = lathe([(0.47, 0), (0.505, 0.02), (0.505, 0.1), (0.47, 0.11)], 36)
        return (
            Part("Speaker", body.scaled(length * 0.98, width * 0.98, height), "cloth"),
            Part("Base", base.scaled(length * 0.99, width * 0.99, height), "metal", None),
        )  # fmt: skip
    case = block((length, width - 0.003, height - 0.003), 0.006).moved(y=0.0015)
    snooze = rounded_slab((length * 0.4, width * 0.3, 0.006), 0.008, 0.002, 5)
    y = -width / 2 + 0.003
    face = box((length * 0.86, 0.004, height * 0.72)).moved(y=y, z=height * 0.14)
    digits = [
        _digit(length * 0.11, height * 0.42).moved(length * at, y - 0.0025, height * 0.29)
        for at in (-0.29, -0.12, 0.12, 0.29)
    ]
    return (
        Part("Case", case, "body"),
        Part("Snooze_Bar", snooze.moved(z=height - 0.006), "metal"),
        Part("Face", face, "face", collider=None),
        Part("Digits", joined(digits), "digits", collider=None),
    )


def _digit(length: float, height: float) -> Solid:
    """An eight of seven bars, one left dark."""
    bar = 0.16 * length
    across = box((length - 2.1 * bar, 0.001, bar))
    upright = box((bar, 0.001, height / 2 - bar))
    side = (length - bar) / 2
    lit = [across.moved(z=z) for z in (0.0, (height - bar) / 2, height - bar)]
    lit += [
        upright.moved(x, 0.0, z)
        for x, z in ((side, bar / 2), (side, height / 2 + bar / 4), (-side, height / 2 + bar / 4))
    ]
    return joined(lit)  # fmt: skip


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
_DEVICE = {
    "silver": {"body": "light_grey", "metal": "steel", "keys": "white", "screen": "screen_lit",
               "face": "black_glass", "digits": "red_glow", "cloth": "grey_cloth"},
    "dark": {"body": "graphite", "metal": "black_metal", "keys": "black", "screen": "screen_lit",
             "face": "black_glass", "digits": "red_glow", "cloth": "charcoal_cloth"},
}  # fmt: skip
_LAMP = {
    "brass": {"ceramic": "sage", "metal": "brass", "shade": "lamp_shade"},
    "black": {"ceramic": "black", "metal": "black_metal", "shade": "lamp_shade"},
}
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
    Design("Computer_Compact", "all_in_one_computer", (0.5, 0.36, 0.42), all_in_one, _DEVICE),
    Design("Computer_Wide", "all_in_one_computer", (0.62, 0.42, 0.48), all_in_one, _DEVICE),
    Design("Laptop_Small", "laptop", (0.3, 0.27, 0.21), laptop, _DEVICE),
    Design("Laptop_Large", "laptop", (0.36, 0.31, 0.24), laptop, _DEVICE),
    Design("Desk_Mat", "big_mouse_pad", (0.8, 0.35, 0.004), mouse_pad, _MAT),
    Design("Desk_Mat_Small", "big_mouse_pad", (0.7, 0.32, 0.004), mouse_pad, _MAT),
    Design("Desk_Mat_Large", "big_mouse_pad", (0.9, 0.4, 0.004), mouse_pad, _MAT),
    Design("Lamp_Shade_Small", "table_lamp", (0.22, 0.22, 0.4), table_lamp, _LAMP),
    Design("Lamp_Shade_Large", "table_lamp", (0.32, 0.32, 0.55), table_lamp, _LAMP),
    Design("Lamp_Shade", "table_lamp", (0.26, 0.26, 0.45), table_lamp, _LAMP),
    Design("Lamp_Arm", "table_lamp", (0.36, 0.18, 0.46), partial(table_lamp, kind="arm"), _LAMP),
    Design("Pen_Cup", "pen_holder", (0.09, 0.09, 0.18), pen_holder, _CUP),
    Design("Phone", "electronic", (0.075, 0.15, 0.01), electronic, _DEVICE),
    Design("Tablet", "electronic", (0.17, 0.24, 0.01), electronic, _DEVICE),
    Design("Speaker", "electronic", (0.11, 0.11, 0.16), partial(electronic, kind="speaker"),
           _DEVICE),
    Design("Alarm_Clock", "electronic", (0.18, 0.07, 0.08), partial(electronic, kind="clock"),
           _DEVICE),
    Design("Photo_Portrait", "photo_frame", (0.17, 0.09, 0.22), photo_frame, _PICTURE),
    Design("Photo_Square", "photo_frame", (0.2, 0.08, 0.2), photo_frame, _PICTURE),
    Design("Photo_Landscape", "photo_frame", (0.27, 0.09, 0.2), photo_frame, _PICTURE),
)  # fmt: skip
