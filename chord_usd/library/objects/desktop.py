"""What stands on desks: books, magazines, mats, pens, pictures."""

from __future__ import annotations

import math

import numpy as np

from chord_usd.library.kit.forms import cup, face_uvs, flat_rail, frame_rails, rng_of
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    block,
    box,
    extruded,
    joined,
    mirrored_pair,
    rounded_slab,
    tube,
)
from chord_usd.library.objects.books import bound
from chord_usd.library.plants.leaves import tapered

_COVERS = ("cover_a", "cover_b", "cover_c")


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
    parts, pages, titles = [], [], []
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
        titles += [title.turned("z", turn).moved(z=z) for title in _titles(*size, index)]
        parts.append(
            Part(
                f"Cover_{index + 1}",
                cover.turned("z", turn).moved(z=z),
                _COVERS[index % 3],
                collider="boundingCube",
            )
        )
        pages.append(block_of_pages.turned("z", turn).moved(z=z))
    return (
        *parts,
        Part("Pages", joined(pages), "paper", collider=None),
        Part("Titles", joined(titles), "print", collider=None),
    )


def _titles(length: float, width: float, thick: float, index: int) -> list[Solid]:
    """Print on a cover, and on the spine to the left of a lying book."""
    lines = (
        ((0.0, 0.22, 0.5, 0.03), (0.0, 0.14, 0.34, 0.012))
        if index % 2 == 0
        else ((0.0, 0.0, 0.4, 0.05),)
    )
    flat = [
        box((length * wide, width * tall, 0.0004)).moved(length * x, width * y, thick - 0.0002)
        for x, y, wide, tall in lines
    ]
    spine = [
        box((0.0016, width * long, thick * 0.34)).moved(
            -length / 2 + 0.0006, width * y, thick * 0.33
        )
        for y, long in ((0.12, 0.3), (-0.32, 0.06))
    ]
    return [*flat, *spine]


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


def standing_books(size_m: Size, *, seed: str = "row") -> tuple[Part, ...]:
    """A row of bound books between two bookends, spines to the front."""
    length, width, height = size_m
    rng = rng_of(f"{seed}/{size_m}")
    end_m = 0.006
    covers: dict[str, list[Solid]] = {slot: [] for slot in _COVERS}
    pages, titles = [], []
    x, count = -length / 2 + end_m, 0
    while length / 2 - end_m - x > 0.004:
        thick = float(rng.choice([0.018, 0.023, 0.029, 0.037]))
        rest = length / 2 - end_m - x
        thick = rest if rest < thick + 0.018 else thick
        tall = height * (1.0 if count == 1 else float(rng.choice([0.8, 0.86, 0.92, 0.97])))
        deep = width * float(rng.choice([0.84, 0.9, 0.96]))
        cover, leaves = bound(thick - 0.001, deep, tall)
        at = {"x": x + thick / 2, "y": -width / 2 + deep / 2}
        covers[_COVERS[(count * 2 + count // 3) % 3]].append(cover.moved(**at))
        pages.append(leaves.moved(**at))
        wide = (thick - 0.001) * 0.55
        for z, part in ((0.74, 0.14), (0.16, 0.02), (0.12, 0.01))[: 1 + count % 3]:
            titles.append(
                box((wide, 0.002, tall * part)).moved(at["x"], -width / 2 + 0.0004, tall * z)
            )
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
        Part("Titles", joined(titles), "print", collider=None),
        # The box around both ends is the box around the row, and stands upright.
        Part("Bookends", mirrored_pair(end), "metal"),
    )


def magazine(size_m: Size) -> tuple[Part, ...]:
    """Magazines, the upper one a little turned; a picture is on its cover."""
    length, width, height = size_m
    turn = 3.0
    inset = math.sin(math.radians(turn))
    size = (length - inset * width, width - inset * length)
    thick = height / 2
    parts = []
    for index, (name, angle) in enumerate((("Lower", 0.0), ("Upper", turn))):
        plate = rounded_slab((*size, thick * 0.86), 0.002, 0.0004, 6).turned("z", angle)
        plate = plate.scaled(length / size[0], width / size[1], 1.0) if angle == 0.0 else plate
        parts.append(Part(f"{name}_Sheets", plate.moved(z=thick * index), "paper"))
    sheet = rounded_slab((*size, thick * 0.14), 0.002, 0.0001, 6)
    corners = sheet.points_m[sheet.faces].reshape(-1, 3)
    uvs = np.clip(corners[:, :2] / size + 0.5, 0.002, 0.998)
    back = rounded_slab((length, width, thick * 0.14), 0.002, 0.0001, 6).moved(z=thick * 0.86)
    parts.append(Part("Lower_Cover", back, "cover_a", collider=None))
    parts.append(
        Part(
            "Cover",
            sheet.turned("z", turn).moved(z=height - thick * 0.14),
            "picture",
            collider=None,
            uvs=uvs,
        )
    )
    return tuple(parts)


def pen_holder(size_m: Size) -> tuple[Part, ...]:
    """A cup with pencils, a pen, a ruler."""
    length, width, height = size_m
    cup_h = height * 0.56
    r = 0.5
    vessel = cup(
        [(0.0, 0.0), (r - 0.03, 0.0), (r, 0.004), (r, cup_h - 0.002), (r - 0.012, cup_h)],
        0.035,
        0.006,
        36,
    )
    pencils, tips, leads = [], [], []
    spread = min(length, width) * 0.3
    for _index, (tall, turn) in enumerate(
        ((1.0, 20.0), (0.92, 100.0), (0.96, 170.0), (0.88, 250.0), (0.94, 310.0))
    ):
        a = math.radians(turn)
        foot = np.array([-0.8 * spread * math.cos(a), -0.8 * spread * math.sin(a), 0.008])
        top = np.array(
            [0.95 * spread * math.cos(a), 0.95 * spread * math.sin(a), height * tall - 0.003]
        )
        along = (top - foot) / np.linalg.norm(top - foot)
        pencils.append(tube([foot, top - 0.018 * along], 0.0038, 6))
        tips.append(
            tapered(np.array([top - 0.0181 * along, top - 0.004 * along]), 0.0036, 0.0012, 6)
        )
        leads.append(tapered(np.array([top - 0.0045 * along, top]), 0.0011, 0.0003, 5))
    ruler = (
        block((0.026, 0.0018, height * 0.93), 0.0005).turned("x", -3).moved(0.0, 0.3 * width, 0.006)
    )
    return (
        Part("Cup", vessel.scaled(length, width, 1.0), "cup"),
        Part("Pencils_A", joined(pencils[::2]), "cover_a", collider=None),
        Part("Pencils_B", joined(pencils[1::2]), "cover_b", collider=None),
        Part("Tips", joined(tips), "wood", collider=None),
        Part("Leads", joined(leads), "ink", collider=None),
        Part("Ruler", ruler, "wood", collider=None),
    )


def photo_frame(size_m: Size, *, mount_m: float = 0.018) -> tuple[Part, ...]:
    """A leaning frame with a photograph behind a mount, on an easel foot."""
    length, width, height = size_m
    lean_deg = min(13.0, math.degrees(math.atan2(width * 0.7, height)))
    deep, rail = 0.014, 0.014
    tall = (height - deep * math.sin(math.radians(lean_deg))) / math.cos(math.radians(lean_deg))
    frame = frame_rails(length, tall, flat_rail(rail, deep, 0.002)).moved(y=deep / 2)
    inner_l, inner_h = length - 2 * rail, tall - 2 * rail
    board = block((inner_l + 0.006, 0.005, inner_h + 0.006), 0.001).moved(y=0.0035, z=rail - 0.003)
    mount = frame_rails(
        inner_l + 0.004, inner_h + 0.004, flat_rail(mount_m + 0.002, 0.0018, 0.0008)
    )
    seen_l, seen_h = inner_l - 2 * mount_m + 0.003, inner_h - 2 * mount_m + 0.003
    low = rail + mount_m - 0.0015
    seen = box((seen_l, 0.0008, seen_h)).moved(y=0.0007, z=low)
    uvs = face_uvs(seen, (-seen_l / 2, low), (seen_l / 2, low + seen_h))
    back = -width / 2 + deep / 2
    slope = math.tan(math.radians(lean_deg))
    rest = [0.0, back + slope * tall * 0.55 + 0.008, tall * 0.55]
    prop = tube([rest, [0.0, width / 2 - 0.004, 0.004]], 0.004, 8)
    at = back + 0.001
    turned_ = {
        name: solid.turned("x", -lean_deg).moved(y=at)
        for name, solid in (
            ("frame", frame),
            ("board", board),
            ("mount", mount.moved(y=0.001, z=rail - 0.002)),
            ("seen", seen),
        )
    }
    return (
        Part("Frame", turned_["frame"], "wood"),
        Part("Board", turned_["board"], "ink", collider=None),
        Part("Mount", turned_["mount"], "mount", collider=None),
        Part("Photograph", turned_["seen"], "photo", collider=None, uvs=uvs),
        Part("Prop", prop, "ink"),
    )
