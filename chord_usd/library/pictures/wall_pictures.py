"""Pictures: framed, on canvas, in pairs, as scrolls; the art is drawn when it is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache, partial

from PIL import Image

from chord_usd.library.kit.forms import (
    face_uvs,
    flat_rail,
    frame_rails,
    moulded_rail,
    rng_of,
)
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import Size, block, box, cylinder, joined
from chord_usd.library.pictures import art, art_nature
from chord_usd.library.surfaces.drawn import DrawnFinishes
from chord_usd.library.surfaces.finishes import Finish, finish_table

LONGEST_PX = 512

_DRAWINGS: dict[str, art.Draw] = {
    "field": art.colour_field,
    "field_pale": partial(art.colour_field, palette=art.PALE),
    "field_deep": partial(art.colour_field, palette=art.DEEP),
    "arches": art.arches,
    "arches_pale": partial(art.arches, palette=art.PALE),
    "bauhaus": art.bauhaus,
    "bauhaus_earth": partial(art.bauhaus, palette=art.EARTH),
    "cut_outs": art.cut_outs,
    "face": art.line_face,
    "stripes": art.stripes,
    "strokes": art.strokes,
    "strokes_deep": partial(art.strokes, palette=art.DEEP),
    "contours": art.hatched,
    "gears": art.gears,
    "city": art.city,
    "moons": art.moons,
    "mountains": art_nature.mountains,
    "ink_hills": art_nature.ink_hills,
    "enso": art_nature.enso,
    "botanical": art_nature.botanical,
    "botanical_blue": partial(art_nature.botanical, tone=(72, 92, 112)),
    "fronds": art_nature.fronds,
    "bamboo": art_nature.bamboo,
    "sea": art_nature.sea,
    "old_landscape": art_nature.old_landscape,
    "still_life": art_nature.still_life,
    "still_life_pale": partial(art_nature.still_life, palette=art.PALE),
    "branch": art_nature.branch,
}
"""Drawing by name."""

ART_SLOTS = ("art", "art_b", "art_c")


@cache
def drawn(name: str, drawing: str, aspect: float) -> Image.Image:
    """The picture of this design; aspect is width over height. The same name, the same picture."""
    longest = LONGEST_PX
    size = (longest, round(longest / aspect)) if aspect > 1 else (round(longest * aspect), longest)
    return _DRAWINGS[drawing](rng_of(name), size)


def art_finishes(name: str, drawings: Sequence[str], aspect: float) -> DrawnFinishes:
    """Finishes with a picture for each of the drawings, in the order of ART_SLOTS."""
    pictures = {
        slot: cache(partial(_printed, f"{name}/{slot}", drawing, aspect))
        for slot, drawing in zip(ART_SLOTS, drawings, strict=False)
    }
    return DrawnFinishes(finish_table("dry"), pictures)


def _printed(name: str, drawing: str, aspect: float) -> Finish:
    image = drawn(name, drawing, aspect)
    mean = image.resize((1, 1), Image.Resampling.BOX).getpixel((0, 0))
    assert isinstance(mean, tuple)
    return Finish((int(mean[0]), int(mean[1]), int(mean[2])), 0.8, texture=image)


def _art(
    name: str,
    slot: str,
    length: float,
    height: float,
    y: float,
    z: float,
    thick: float,
    x: float = 0.0,
) -> Part:
    """A picture whose front lies in the plane y, standing on z."""
    sheet = box((length, thick, height)).moved(x, y + thick / 2, z)
    uvs = face_uvs(sheet, (x - length / 2, z), (x + length / 2, z + height))
    return Part(name, sheet, slot, None, uvs=uvs)


def framed(
    size_m: Size, *, rail_m: float = 0.015, mount_m: float = 0.0, moulded: bool = False
) -> tuple[Part, ...]:
    """A picture in mitred rails; mount_m is the width of the passe-partout around it."""
    length, width, height = size_m
    return framed_art(length, width, height, rail_m, mount_m, moulded, "", "art", 0.0)


def framed_art(
    length: float,
    width: float,
    height: float,
    rail: float,
    mount: float,
    moulded: bool,
    end: str,
    slot: str,
    x: float,
) -> tuple[Part, ...]:
    """The parts of one framed picture whose middle is at x; end: of their names."""
    section = moulded_rail(rail, width) if moulded else flat_rail(rail, width)
    frame = frame_rails(length, height, section).moved(x, width / 2)
    inner_l, inner_h = length - 2 * rail, height - 2 * rail
    front = -width / 2 + min(0.008, width * 0.4)
    back = box((inner_l + 0.008, width / 2 - front - 0.003, inner_h + 0.008))
    back = back.moved(x, front / 2 + width / 4 + 0.001, rail - 0.004)
    parts = [Part(f"Frame{end}", frame, "frame", None), Part(f"Back{end}", back, "back", None)]
    if mount > 0.0:
        board = frame_rails(
            inner_l + 0.006, inner_h + 0.006, flat_rail(mount + 0.003, 0.0022, 0.001)
        )
        parts.append(
            Part(f"Mount{end}", board.moved(x, front + 0.0006, rail - 0.003), "mount", None)
        )
    seen_l, seen_h = inner_l - 2 * mount + 0.004, inner_h - 2 * mount + 0.004
    y = front + 0.0002 if mount > 0.0 else front - 0.0012
    parts.append(_art(f"Art{end}", slot, seen_l, seen_h, y, rail + mount - 0.002, 0.0015, x))
    return tuple(parts)


def pair(size_m: Size, *, rail_m: float = 0.015, mount_m: float = 0.05) -> tuple[Part, ...]:
    """Two frames of one size side by side, a hand apart."""
    length, width, height = size_m
    frame_m = (length - 0.07) / 2
    at = (length - frame_m) / 2
    return (
        *framed_art(frame_m, width, height, rail_m, mount_m, False, "_Left", "art", -at),
        *framed_art(frame_m, width, height, rail_m, mount_m, False, "_Right", "art_b", at),
    )


def on_canvas(size_m: Size) -> tuple[Part, ...]:
    """A stretched canvas without frame; the picture runs around its edges."""
    length, width, height = size_m
    return (_art("Art", "art", length, height, -width / 2, 0.0, width),)


def floating(size_m: Size) -> tuple[Part, ...]:
    """A canvas in a tray frame, a shadow gap around it."""
    length, width, height = size_m
    rail, gap = 0.008, 0.006
    frame = frame_rails(length, height, flat_rail(rail, width, 0.001)).moved(y=width / 2)
    tray = box((length - 0.008, 0.008, height - 0.008)).moved(y=width / 2 - 0.006, z=0.004)
    inset = rail + gap
    canvas = _art(
        "Art",
        "art",
        length - 2 * inset,
        height - 2 * inset,
        -width / 2 + 0.004,
        inset,
        width - 0.013,
    )
    return Part("Frame", frame, "frame", None), Part("Tray", tray, "back", None), canvas


def scroll(size_m: Size) -> tuple[Part, ...]:
    """A hanging scroll: a picture on silk between two rods."""
    length, width, height = size_m
    rod = 0.014
    wide = length - 0.05
    silk = box((wide, 0.0015, height - 0.045)).moved(y=width / 2 - 0.003, z=0.015)
    band = [
        box((wide - 0.0, 0.0009, 0.05)).moved(y=width / 2 - 0.0042, z=z)
        for z in (0.075, height - 0.17)
    ]
    bar = cylinder(rod, length - 0.03, 0.0, 16).turned("y", 90).moved(-(length - 0.03) / 2)
    knobs = [
        cylinder(rod * 0.8, 0.02, 0.003, 14).turned("y", 90).moved(x)
        for x in (-length / 2, length / 2 - 0.02)
    ]
    foot = {"y": width / 2 - rod - 0.001, "z": rod}
    top = block((wide + 0.006, 0.012, 0.016), 0.003).moved(y=width / 2 - 0.007, z=height - 0.046)
    strings = [
        block((0.002, 0.002, 0.19 * length), 0.0004)
        .turned("y", s * 76)
        .moved(s * length * 0.185, width / 2 - 0.006)
        for s in (-1, 1)
    ]
    cord = joined(strings)
    cord = cord.moved(z=height - float(cord.bounds_m()[1, 2]))
    art_l, art_z = wide - 0.08, 0.15
    return (
        Part("Silk", silk, "silk", None),
        Part("Bands", joined(band), "band", None),
        Part("Rod", bar.moved(**foot), "frame", None),
        Part("Knobs", joined(knobs).moved(**foot), "frame", None),
        Part("Top", top, "frame", None),
        Part("Cord", cord, "band", None),
        _art("Art", "art", art_l, height - 0.35, width / 2 - 0.0052, art_z, 0.002),
    )


_INSET_M = {
    "Plain": 0.014,
    "Mount": 0.066,
    "Wide_Mount": 0.105,
    "Gilt": 0.06,
    "Moulded": 0.075,
    "Canvas": 0.0,
    "Float": 0.014,
    "Steel": 0.014,
    "Pair": 0.065,
}
"""What lies between the edge and the picture, by how it is framed."""


def shown(name: str, size_m: Size, *, kind: str, drawings: Sequence[str]) -> DrawnFinishes:
    """Finishes of a picture of this id and size; kind: how it is framed, a key of _INSET_M or
    Scroll."""
    length, _, height = size_m
    if kind == "Scroll":
        seen_l, seen_h = length - 0.13, height - 0.35
    else:
        wide = (length - 0.07) / 2 if kind == "Pair" else length
        seen_l, seen_h = wide - 2 * _INSET_M[kind], height - 2 * _INSET_M[kind]
    return art_finishes(name, drawings, round(seen_l / seen_h, 3))
