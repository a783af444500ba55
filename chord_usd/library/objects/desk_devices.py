"""Computers, laptops, telephones, loudspeakers, clocks for desks."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import partial

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.forms import face_uvs, outward
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    block,
    box,
    cylinder,
    joined,
    lathe,
    pair,
    rounded_slab,
    tube,
)


def _top_uvs(
    solid: Solid, length_m: float, width_m: float, at: Sequence[float] = (0.0, 0.0)
) -> FloatArray:
    """Coordinates 0 to 1 over a lying rectangle, its foot to the front."""
    corners = solid.points_m[solid.faces].reshape(-1, 3)
    u = (corners[:, 0] - at[0]) / length_m + 0.5
    v = (corners[:, 1] - at[1]) / width_m + 0.5
    return np.clip(np.stack([u, v], -1), 0.002, 0.998)


def _keys(length_m: float, width_m: float, rows: int, columns: int, tall_m: float) -> Solid:
    """Rows of keys around the origin, a long bar in the nearest row."""
    step_x, step_y = length_m / columns, width_m / rows
    caps = []
    for row in range(rows):
        y = (row - (rows - 1) / 2) * step_y
        column = 0
        while column < columns:
            wide = (
                5
                if row == 0 and column == 4
                else 2
                if row and column in (0, columns - 2) and row % 2
                else 1
            )
            wide = min(wide, columns - column)
            x = (column + wide / 2) * step_x - length_m / 2
            cap = box((wide * step_x - 0.0022, step_y - 0.0022, tall_m))
            caps.append(cap.moved(x, y))
            column += wide
    return joined(caps)


def all_in_one(size_m: Size) -> tuple[Part, ...]:
    """A slim screen on an angled foot, keyboard and mouse before it."""
    length, width, height = size_m
    screen_y, tall = width / 2 - 0.085, length * 9 / 16 + 0.016
    low = height - tall
    thin = rounded_slab((length, tall, 0.011), 0.008, 0.003, 5, 2).turned("x", 90)
    thin = thin.moved(y=screen_y, z=low + tall / 2)
    hump = rounded_slab((length * 0.42, tall * 0.5, 0.022), 0.03, 0.012, 5, 2).turned("x", 90)
    hump = hump.moved(y=screen_y + 0.02, z=low + tall * 0.45)
    glass = box((length - 0.007, 0.0016, tall - 0.007)).moved(y=screen_y - 0.0112, z=low + 0.0035)
    seen_l, seen_h = length - 0.022, tall - 0.022
    seen = box((seen_l, 0.0014, seen_h)).moved(y=screen_y - 0.0118, z=low + 0.011)
    uvs = face_uvs(seen, (-seen_l / 2, low + 0.011), (seen_l / 2, low + 0.011 + seen_h))
    foot = rounded_slab((length * 0.34, 0.17, 0.007), 0.018, 0.0025, 6).moved(y=screen_y)
    rest = bent_path(
        [
            [0, screen_y + 0.05, 0.005],
            [0, screen_y + 0.068, low + 0.02],
            [0, screen_y + 0.02, low + tall * 0.45],
        ],
        0.03,
        4,
    )
    neck = tube(rest, 0.011, 10).scaled(x=3.4)
    keys_l, deep = min(length * 0.62, 0.36), 0.118
    y = -width / 2 + deep / 2
    board = rounded_slab((keys_l + 0.014, deep, 0.009), 0.008, 0.003, 4).moved(-length * 0.08, y)
    caps = _keys(keys_l, deep - 0.012, 5, 14, 0.0035).moved(-length * 0.08, y, 0.0082)
    mouse = rounded_slab((0.058, 0.105, 0.03), 0.028, 0.014, 6, 3).moved(
        length / 2 - 0.06, -width / 2 + 0.0525
    )
    wheel = (
        cylinder(0.005, 0.006, 0.0, 12)
        .turned("y", 90)
        .moved(length / 2 - 0.063, -width / 2 + 0.082, 0.0278)
    )
    return (
        Part("Case", thin + hump, "body"),
        Part("Glass", glass, "bezel", collider=None),
        Part("Screen", seen, "screen", collider=None, uvs=uvs),
        Part("Foot", foot + neck, "metal"),
        Part("Keyboard", board, "body"),
        Part("Keys", caps, "keys", collider=None),
        Part("Mouse", mouse, "keys"),
        Part("Wheel", wheel, "metal", collider=None),
    )


def laptop(size_m: Size) -> tuple[Part, ...]:
    """An open laptop; the screen leans back over the rear edge."""
    length, width, height = size_m
    thick, lean_deg = 0.013, 15.0
    lean = math.tan(math.radians(lean_deg)) * (height - thick)
    base_w = width - lean
    deck_y = -lean / 2
    base = rounded_slab((length, base_w, thick), 0.012, 0.004, 5, 2).moved(y=deck_y)
    lid_h = (height - thick) / math.cos(math.radians(lean_deg))
    lid = rounded_slab((length, lid_h, 0.006), 0.01, 0.0022, 5, 2)
    bezel = rounded_slab((length - 0.005, lid_h - 0.005, 0.0012), 0.008, 0.0004, 4).moved(z=0.0055)
    seen_l, seen_h = length - 0.02, lid_h - 0.028
    seen = box((seen_l, seen_h, 0.0008)).moved(y=0.003, z=0.0063)
    uvs = _top_uvs(seen, seen_l, seen_h, (0.0, 0.003))
    hinge = {"y": base_w / 2 - lean / 2 - 0.004, "z": thick - 0.002}
    raise_lid = partial(_hinged, height=lid_h, lean_deg=lean_deg, at=hinge)
    well_l, well_w = length * 0.84, base_w * 0.44
    well = rounded_slab((well_l + 0.006, well_w + 0.006, 0.0012), 0.004, 0.0004, 3).moved(
        y=deck_y + base_w * 0.16, z=thick - 0.0008
    )
    caps = _keys(well_l, well_w, 5, 14, 0.0016).moved(y=deck_y + base_w * 0.16, z=thick + 0.0002)
    pad = rounded_slab((length * 0.36, base_w * 0.3, 0.0008), 0.004, 0.0003, 4).moved(
        y=deck_y - base_w * 0.29, z=thick - 0.0003
    )
    barrel = (
        cylinder(0.0045, length * 0.78, 0.001, 12)
        .turned("y", 90)
        .moved(-length * 0.39, hinge["y"] + 0.001, thick - 0.001)
    )
    return (
        Part("Base", base, "body"),
        Part("Lid", raise_lid(lid), "body"),
        Part("Bezel", raise_lid(bezel), "bezel", collider=None),
        Part("Screen", raise_lid(seen), "screen", collider=None, uvs=uvs),
        Part("Well", well, "bezel", collider=None),
        Part("Keys", caps, "keys", collider=None),
        Part("Trackpad", pad, "metal", collider=None),
        Part("Hinge", barrel, "bezel", collider=None),
    )


def _hinged(solid: Solid, height: float, lean_deg: float, at: dict[str, float]) -> Solid:
    """A lid drawn lying, stood up on its lower edge and leaned back."""
    return solid.moved(y=height / 2).turned("x", 90 - lean_deg).moved(**at)


def slate(size_m: Size) -> tuple[Part, ...]:
    """A telephone or a tablet, its screen up."""
    length, width, height = size_m
    corner = length * 0.13
    case = rounded_slab((length, width, height * 0.92), corner, 0.0024, 7, 2)
    glass = rounded_slab(
        (length - 0.003, width - 0.003, height * 0.12), corner - 0.0015, 0.0004, 7
    ).moved(z=height * 0.86)
    edge = 0.006 if length < 0.1 else 0.012
    seen = rounded_slab(
        (length - edge, width - edge, height * 0.06), max(corner - edge / 2, 0.002), 0.0002, 7
    ).moved(z=height * 0.94)
    buttons = [
        block((0.0012, long, height * 0.3), 0.0004).moved(length / 2 + 0.0003, y, height * 0.34)
        for y, long in ((width * 0.2, width * 0.08), (width * 0.32, width * 0.05))
    ]
    return (
        Part("Case", case, "metal"),
        Part("Glass", glass, "bezel", collider=None),
        Part(
            "Screen", seen, "page", collider=None, uvs=_top_uvs(seen, length - edge, width - edge)
        ),
        Part("Buttons", joined(buttons), "metal", collider=None),
    )


def speaker(size_m: Size) -> tuple[Part, ...]:
    """A loudspeaker: cloth around, a dished top with a ring."""
    length, width, height = size_m
    cloth = outward(
        lathe(
            [(0.44, 0.05), (0.485, 0.08), (0.5, 0.16), (0.5, 0.9), (0.485, 0.955), (0.46, 0.97)], 40
        )
    )
    top = outward(
        lathe(
            [(0.462, 0.94), (0.466, 0.985), (0.45, 1.0), (0.4, 0.995), (0.34, 0.975), (0.0, 0.965)],
            40,
        )
    )
    ring_ = outward(
        lathe([(0.3, 0.974), (0.3, 0.984), (0.27, 0.984), (0.27, 0.974)], 32, loop=True)
    )
    base = outward(lathe([(0.42, 0.0), (0.45, 0.015), (0.45, 0.06), (0.43, 0.07)], 40))
    seam = outward(
        lathe(
            [(0.5, 0.52), (0.505, 0.525), (0.505, 0.535), (0.5, 0.54), (0.49, 0.53)], 40, loop=True
        )
    )
    fit = (length * 0.985, width * 0.985, height)
    return (
        Part("Speaker", cloth.scaled(*fit), "cloth", colliders=(box(size_m),)),
        Part("Top", top.scaled(*fit), "keys", collider=None),
        Part("Ring", ring_.scaled(*fit), "metal", collider=None),
        Part("Base", base.scaled(*fit), "metal", collider=None),
        Part("Seam", seam.scaled(*fit), "cloth", collider=None),
    )


_SEGMENTS = {"0": "abcdef", "4": "bcfg", "5": "acdfg", "7": "abc"}


def alarm_clock(size_m: Size) -> tuple[Part, ...]:
    """A cloth-wrapped clock whose lit digits say 7:45."""
    length, width, height = size_m
    body = rounded_slab((length, height - 0.004, width - 0.008), 0.02, 0.008, 6, 3).turned("x", 90)
    body = body.moved(y=width / 2, z=(height - 0.004) / 2)
    _low, high = body.bounds_m()
    body = body.moved(y=width / 2 - float(high[1]))
    face = rounded_slab((length * 0.9, height * 0.76, 0.008), 0.014, 0.002, 5).turned("x", 90)
    front = -width / 2
    face = face.moved(y=front + 0.0085, z=height * 0.48)
    digits = [
        _digit("745"[index], length * 0.12, height * 0.42).moved(
            length * at, front + 0.0004, height * 0.27
        )
        for index, at in enumerate((-0.22, 0.08, 0.25))
    ]
    dots = [
        cylinder(0.003, 0.001, 0.0, 10)
        .turned("x", 90)
        .moved(-0.075 * length, front + 0.0012, height * z)
        for z in (0.4, 0.56)
    ]
    snooze = rounded_slab((length * 0.34, width * 0.36, 0.006), 0.01, 0.002, 5).moved(
        y=0.004, z=height - 0.006
    )
    feet = pair(cylinder(0.008, 0.004, 0.001, 12), x=length * 0.36)
    return (
        Part("Case", body.moved(z=0.002), "cloth", colliders=(box((length, width, height)),)),
        Part("Face", face, "bezel", collider=None),
        Part("Digits", joined([*digits, *dots]), "digits", collider=None),
        Part("Snooze_Bar", snooze, "metal", collider=None),
        Part("Feet", joined(feet), "metal", collider=None),
    )


def _digit(sign: str, length: float, height: float) -> Solid:
    """A digit of seven bars."""
    bar = 0.17 * length
    across = box((length - 2.2 * bar, 0.001, bar))
    upright = box((bar, 0.001, height / 2 - 1.2 * bar))
    side, half = (length - bar) / 2, height / 2
    spots = {
        "a": across.moved(z=height - bar),
        "g": across.moved(z=half - bar / 2),
        "d": across,
        "b": upright.moved(side, z=half + 0.1 * bar),
        "c": upright.moved(side, z=bar),
        "f": upright.moved(-side, z=half + 0.1 * bar),
        "e": upright.moved(-side, z=bar),
    }
    return joined([spots[name] for name in _SEGMENTS[sign]])
