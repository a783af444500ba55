"""What stands on worktops and hobs: pots, kettles, toasters, coffee machines, boards, knives."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

import numpy as np

from chord_usd.assets.dressing.kitchen_finishes import FINISHES
from chord_usd.assets.dressing.vessels import hollow
from chord_usd.assets.model import Design, Draw, Part
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
    loft,
    mirrored_pair,
    ring,
    rounded_profile,
    rounded_slab,
    tube,
)


def _lid(radius: float, z: float, dome: float) -> Solid:
    return lathe([(radius - 0.004, z - 0.003), (radius, z), (radius, z + 0.003), (radius * 0.8, z + dome * 0.55),
                  (radius * 0.4, z + dome * 0.92), (0, z + dome)], 36)  # fmt: skip


def saucepan(size_m: Size) -> tuple[Part, ...]:
    """A pan with a long handle to the right and a lid."""
    length, width, tall = size_m
    radius = width / 2
    x = -length / 2 + radius
    rim = tall - 0.045
    pan = lathe(
        [
            (radius - 0.012, 0),
            (radius - 0.003, 0.004),
            (radius - 0.002, 0.012),
            (radius - 0.002, rim - 0.003),
            (radius, rim),
            (0, rim + 0.001),
        ],
        36,
    )
    handle_l = length - 2 * radius + 0.012
    grip = rounded_slab((handle_l - 0.03, 0.024, 0.014), 0.012, 0.004, 3, 2).moved(
        x + radius + 0.03 + (handle_l - 0.042) / 2, 0, rim - 0.024
    )
    neck = block((0.05, 0.018, 0.01), 0.002).moved(x + radius + 0.012, 0, rim - 0.022)
    knob = lathe(
        [
            (0.006, rim + 0.024),
            (0.006, tall - 0.018),
            (0.016, tall - 0.012),
            (0.014, tall - 0.001),
            (0, tall),
        ],
        18,
    )
    return (
        Part("Pan", pan.moved(x), "metal"),
        Part("Lid", _lid(radius - 0.003, rim + 0.001, 0.026).moved(x), "lid", collider=None),
        Part("Knob", knob.moved(x), "grip", collider=None),
        Part("Neck", neck, "lid", collider=None),
        Part("Grip", grip, "grip", collider=None),
    )


def casserole(size_m: Size) -> tuple[Part, ...]:
    """A cast-iron casserole with two ears and a domed lid."""
    length, width, tall = size_m
    radius = width / 2
    rim = tall - 0.065
    pot = lathe(
        rounded_profile(
            [
                (radius * 0.82, 0),
                (radius * 0.93, 0.004),
                (radius * 0.98, 0.03),
                (radius, rim - 0.004),
                (radius, rim),
                (0, rim + 0.0005),
            ],
            1,
        ),
        40,
    )
    lid = lathe(
        rounded_profile(
            [
                (radius - 0.006, rim),
                (radius + 0.001, rim + 0.002),
                (radius + 0.001, rim + 0.01),
                (radius * 0.9, rim + 0.022),
                (radius * 0.4, rim + 0.036),
                (0, rim + 0.038),
            ],
            1,
        ),
        40,
    )
    reach = length / 2 - 0.008
    ear = tube(
        bent_path(
            [
                [radius - 0.006, -0.045, rim - 0.022],
                [reach, -0.04, rim - 0.02],
                [reach, 0.04, rim - 0.02],
                [radius - 0.006, 0.045, rim - 0.022],
            ],
            0.025,
            4,
        ),
        0.0075,
        8,
    )
    knob = lathe(
        [
            (0.012, rim + 0.03),
            (0.009, tall - 0.02),
            (0.02, tall - 0.013),
            (0.021, tall - 0.004),
            (0.015, tall),
            (0, tall),
        ],
        22,
    )
    return (
        Part("Pot", pot + mirrored_pair(ear), "enamel"),
        Part("Lid", lid, "enamel", collider=None),
        Part("Knob", knob, "grip", collider=None),
    )


def frying_pan(size_m: Size) -> tuple[Part, ...]:
    """A frying pan."""
    length, width, tall = size_m
    radius = width / 2
    x = -length / 2 + radius
    rim = 0.046
    pan = hollow(
        [(radius * 0.76, 0), (radius * 0.8, 0.003), (radius * 0.92, rim * 0.55), (radius, rim)],
        0.004,
        0.006,
        40,
    )
    start, end = x + radius - 0.01, length / 2
    arm = [
        [start, 0, rim - 0.014],
        [start + 0.05, 0, rim + 0.004],
        [end - 0.06, 0, tall - 0.014],
        [end - 0.008, 0, tall - 0.0085],
    ]
    path = bent_path(arm, 0.05, 4)
    handle = tube(path, 0.0085, 10).scaled(1.0, 1.25, 1.0)
    return (Part("Pan", pan.moved(x), "iron"), Part("Handle", handle, "grip", collider=None))


def kettle(size_m: Size) -> tuple[Part, ...]:
    """An electric kettle on its base: spout to the left, grip to the right."""
    length, width, tall = size_m
    radius = width / 2 - 0.002
    x = -length / 2 + 0.03 + radius
    base = lathe(
        [
            (radius, 0),
            (radius + 0.002, 0.003),
            (radius + 0.001, 0.016),
            (radius - 0.004, 0.02),
            (0, 0.02),
        ],
        36,
    )
    top = tall - 0.02
    profile = rounded_profile(
        [
            (radius - 0.006, 0.021),
            (radius - 0.002, 0.026),
            (radius - 0.003, 0.06),
            (radius * 0.86, tall * 0.62),
            (radius * 0.74, top - 0.006),
            (radius * 0.7, top),
        ],
        2,
    )
    body = lathe([*profile, (0, top + 0.0005)], 36)
    lid = lathe(
        [
            (radius * 0.66, top),
            (radius * 0.64, top + 0.006),
            (radius * 0.2, top + 0.01),
            (0, top + 0.01),
        ],
        30,
    )
    knob = cylinder(0.011, tall - top - 0.008, 0.003, 16).moved(z=top + 0.008)
    spout = _spout(radius, top)
    hand = bent_path(
        [
            [radius * 0.7, 0, top - 0.012],
            [length - 0.03 - radius - 0.012, 0, top - 0.006],
            [length - 0.03 - radius - 0.012, 0, tall * 0.32],
            [radius * 0.86, 0, tall * 0.24],
        ],
        0.03,
        4,
    )
    return (
        Part("Base", base.moved(x), "grip"),
        Part("Body", (body + spout).moved(x), "metal", collider="boundingCube"),
        Part("Lid", (lid + knob).moved(x), "grip", collider=None),
        Part("Handle", tube(hand, 0.0105, 10).moved(x), "grip", collider=None),
    )


def _spout(radius: float, top: float) -> Solid:
    """A beak on the upper edge, towards -x."""
    outline = np.array(
        [
            [0.0, 0.026],
            [-0.02, 0.02],
            [-0.042, 0.006],
            [-0.042, -0.006],
            [-0.02, -0.02],
            [0.0, -0.026],
        ]
    )[::1]
    shift = -radius * 0.66
    low = np.column_stack(
        [outline[:, 0] * 0.35 + shift - 0.006, outline[:, 1] * 0.7, np.full(6, top - 0.06)]
    )
    high = np.column_stack([outline[:, 0] + shift, outline[:, 1], np.full(6, top - 0.002)])
    return loft([low, high])


def stove_kettle(size_m: Size) -> tuple[Part, ...]:
    """A whistling kettle: a low body, a bow handle over it, a short spout."""
    length, width, tall = size_m
    radius = width / 2
    x = -length / 2 + (length - 2 * radius) + radius
    high = tall * 0.56
    body = lathe(
        rounded_profile(
            [
                (radius * 0.84, 0),
                (radius * 0.98, 0.004),
                (radius, high * 0.3),
                (radius * 0.92, high * 0.62),
                (radius * 0.5, high * 0.93),
                (radius * 0.42, high),
                (0, high),
            ],
            2,
        ),
        40,
    )
    lid = lathe(
        [
            (radius * 0.42, high - 0.004),
            (radius * 0.42, high + 0.002),
            (radius * 0.2, high + 0.008),
            (0.005, high + 0.01),
            (0.005, high + 0.018),
            (0.013, high + 0.024),
            (0.012, high + 0.034),
            (0, high + 0.036),
        ],
        28,
    )
    spout = tube(
        [
            [-radius * 0.7, 0, high * 0.5],
            [-radius * 1.02, 0, high * 0.82],
            [-length + radius + 0.012, 0, high * 1.02],
        ],
        0.014,
        12,
    )
    bow = bent_path(
        [
            [-radius * 0.74, 0, high * 0.72],
            [-radius * 0.62, 0, tall - 0.01],
            [radius * 0.62, 0, tall - 0.01],
            [radius * 0.74, 0, high * 0.72],
        ],
        0.05,
        5,
    )
    grip = (
        cylinder(0.0125, radius * 0.8, 0.004, 14)
        .turned("y", 90)
        .moved(-radius * 0.4, 0, tall - 0.0125)
    )
    return (
        Part("Body", (body + spout).moved(x), "metal"),
        Part("Lid", lid.moved(x), "metal", collider=None),
        Part("Bow", tube(bow, 0.005, 8).moved(x), "bow", collider=None),
        Part("Grip", grip.moved(x), "grip", collider=None),
    )


def toaster(size_m: Size, *, retro: bool = False) -> tuple[Part, ...]:
    """A toaster for two slices, its lever at the right end."""
    length, width, tall = size_m
    feet, lever = 0.012, 0.016
    body_l = length - lever
    x = -lever / 2
    corner = 0.05 if retro else 0.03
    rings = []
    high = tall - feet
    levels = (
        (
            (0.93, 0.9, 0.0),
            (1.0, 1.0, 0.1),
            (1.0, 1.0, 0.62),
            (0.985, 0.96, 0.82),
            (0.94, 0.88, 0.94),
            (0.86, 0.74, 1.0),
        )
        if retro
        else (
            (0.97, 0.95, 0.0),
            (1.0, 1.0, 0.05),
            (1.0, 1.0, 0.86),
            (0.985, 0.97, 0.95),
            (0.95, 0.9, 1.0),
        )
    )
    for a, b, z in levels:
        rings.append(ring(body_l * a, width * b, corner * a, feet + high * z, 5) + [x, 0.0, 0.0])
    body = loft(rings)
    slots = joined(
        [box((body_l * 0.66, 0.026, 0.003)).moved(x, s * 0.026, tall - 0.0015) for s in (-1, 1)]
    )
    knob = (
        cylinder(0.013, 0.012, 0.003, 18)
        .turned("y", 90)
        .moved(x + body_l / 2 - 0.003, 0.0, feet + 0.045)
    )
    handle = block((lever + 0.006, 0.04, 0.014), 0.004).moved(
        x + body_l / 2 + lever / 2 - 0.004, 0.0, tall * 0.66
    )
    track = box((0.003, 0.008, high * 0.5)).moved(x + body_l / 2, 0.0, feet + high * 0.26)
    base = rounded_slab((body_l * 0.92, width * 0.86, feet + 0.006), 0.03, 0.003, 4).moved(x)
    return (
        Part("Base", base, "trim"),
        Part("Body", body, "metal"),
        Part("Slots", slots + track, "dark", collider=None),
        Part("Lever", handle + knob, "trim", collider=None),
    )


def espresso_machine(size_m: Size) -> tuple[Part, ...]:
    """A machine for espresso: head with group and portafilter, drip tray, cups on top."""
    length, width, tall = size_m
    back = width / 2
    high = tall - 0.06
    tray_h = 0.065
    body_w = width * 0.56
    body = rounded_slab((length, body_w, high), 0.02, 0.006, 4).moved(y=back - body_w / 2)
    tray = rounded_slab((length, width - 0.02, tray_h), 0.02, 0.006, 4).moved(y=-0.01 + 0.0)
    grid = joined(
        [
            box((length * 0.8, 0.006, 0.004)).moved(
                y=-width / 2 + 0.035 + 0.014 * n, z=tray_h - 0.001
            )
            for n in range(8)
        ]
    )
    head = rounded_slab((length, width * 0.84, 0.11), 0.02, 0.006, 4).moved(
        y=back - width * 0.42, z=high - 0.1105
    )
    group_y = back - width * 0.66
    group = cylinder(0.036, 0.03, 0.003, 28).moved(y=group_y, z=high - 0.138)
    filter_ = cylinder(0.033, 0.026, 0.003, 28).moved(y=group_y, z=high - 0.162)
    spouts = joined(
        [
            tube(
                [
                    [s * 0.002, group_y, high - 0.158],
                    [s * 0.012, group_y, high - 0.172],
                    [s * 0.012, group_y, high - 0.188],
                ],
                0.005,
                8,
            )
            for s in (-1, 1)
        ]
    )
    grip = tube([[0, group_y - 0.03, high - 0.15], [0, group_y - 0.13, high - 0.156]], 0.011, 12)
    front = back - width * 0.84
    dials = joined(
        [
            cylinder(0.017, 0.016, 0.003, 20).turned("x", 90).moved(x, front + 0.001, high - 0.055)
            for x in (-0.07, 0.07)
        ]
    )
    gauge = (
        cylinder(0.024, 0.006, 0.002, 24).turned("x", 90).moved(0.0, front + 0.001, high - 0.055)
    )
    wand = tube(
        bent_path(
            [
                [length * 0.38, group_y, high - 0.108],
                [length * 0.38, group_y, high - 0.19],
                [length * 0.42, group_y - 0.02, high - 0.23],
            ],
            0.03,
            3,
        ),
        0.005,
        8,
    )
    cup = hollow([(0.022, 0), (0.03, 0.02), (0.033, 0.06)], 0.003, 0.005, 18)
    cups = joined(
        [
            cup.moved(x, back - 0.06 - 0.06 * (n % 2), high - 0.0005)
            for n, x in enumerate((-0.07, -0.0053, 0.0618))
        ]
    )
    return (
        Part("Body", body, "metal"),
        Part("Tray", tray, "metal"),
        Part("Head", head, "metal", collider=None),
        Part("Grid", grid, "dark", collider=None),
        Part("Group", joined([group, filter_, spouts, wand]), "chrome", collider=None),
        Part("Handle", joined([grip, dials]), "grip", collider=None),
        Part("Gauge", gauge, "face", collider=None),
        Part("Cups", cups, "cup", collider=None),
    )


def filter_machine(size_m: Size) -> tuple[Part, ...]:
    """A filter coffee machine: tank, filter, glass jug on a hot plate."""
    length, width, tall = size_m
    back = width / 2
    plate_h = 0.035
    base = rounded_slab((length, width, plate_h), 0.03, 0.006, 4)
    tower_w = width * 0.38
    tower = rounded_slab((length, tower_w, tall), 0.025, 0.006, 4).moved(y=back - tower_w / 2)
    head = rounded_slab((length * 0.96, width * 0.66, tall * 0.3), 0.03, 0.008, 4).moved(
        y=back - tower_w - width * 0.66 / 2 + 0.08, z=tall * 0.7 - 0.0005
    )
    y = -width / 2 + 0.085
    radius = min(0.065, length * 0.4)
    top = tall * 0.7 - 0.02
    jug_profile = rounded_profile(
        [
            (radius * 0.86, plate_h + 0.004),
            (radius, plate_h + 0.014),
            (radius, plate_h + 0.06),
            (radius * 0.72, top - 0.01),
            (radius * 0.74, top),
        ],
        1,
    )
    jug = hollow(jug_profile, 0.0025, plate_h + 0.007, 28).moved(y=y)
    level = plate_h + 0.066
    brew = lathe(
        [
            (radius * 0.82, plate_h + 0.0075),
            (radius - 0.0035, plate_h + 0.016),
            (radius - 0.0035, level - 0.004),
            (0, level),
        ],
        28,
    ).moved(y=y)
    grip = tube(
        bent_path(
            [
                [radius * 0.72, y, top - 0.004],
                [radius + 0.03, y, top - 0.006],
                [radius + 0.03, y, plate_h + 0.035],
                [radius * 0.96, y, plate_h + 0.03],
            ],
            0.02,
            3,
        ).tolist(),
        0.007,
        8,
    ).turned("z", 0)
    hot = cylinder(radius + 0.004, 0.004, 0.001, 28).moved(y=y, z=plate_h - 0.0005)
    switch = block((0.03, 0.004, 0.014), 0.001).moved(0.0, -width / 2, 0.012)
    return (
        Part("Base", base, "metal"),
        Part("Tower", tower, "metal"),
        Part("Head", head, "metal", collider=None),
        Part("Plate", hot, "dark", collider=None),
        Part("Jug", jug, "clear", collider=None),
        Part("Coffee", brew, "coffee", collider=None),
        Part("Grip", _before(grip, y) + switch, "grip", collider=None),
    )


def _before(solid: Solid, y: float) -> Solid:
    """Turned about the upright axis of the jug, so that the grip shows to the front right."""
    return solid.moved(y=-y).turned("z", -50).moved(y=y)


def cutting_board(size_m: Size, *, kind: str = "handle") -> tuple[Part, ...]:
    """One or two boards that lean against the wall behind."""
    length, depth, tall = size_m
    thick = 0.018
    boards = []
    if kind == "pair":
        back = _leaning(_oblong(length * 0.9, tall, 0.02), 0.016, 0.0, 0.055, x=-length * 0.05)
        front = _leaning(_round_board(length * 0.74), 0.016, -0.0175, 0.055, x=length * 0.13)
        return (Part("Board", back, "wood"), Part("Board_2", front, "second"))
    if kind == "round":
        outline = _round_board(length, stub=tall - length)
    elif kind == "stone":
        outline = _oblong(length, tall, 0.012)
    else:
        outline = _handled(length, tall)
    boards.append(_leaning(outline, thick, depth / 2 - 0.001, depth - thick - 0.003))
    return (Part("Board", joined(boards), "wood"),)


def _oblong(length: float, tall: float, corner: float) -> np.ndarray:
    return ring(length, tall, corner, 0.0, 4)[:, :2] + [0.0, tall / 2]


def _handled(length: float, tall: float) -> np.ndarray:
    """A board whose upper end narrows to a handle."""
    half, neck = length / 2, 0.026
    body = tall - 0.11
    right = [
        [half - 0.015, 0.0],
        [half - 0.004, 0.004],
        [half, 0.015],
        [half, body - 0.05],
        [half - 0.012, body - 0.02],
        [half * 0.55, body],
        [neck, body + 0.02],
        [neck - 0.002, tall - 0.026],
        [neck - 0.01, tall - 0.006],
        [0.0, tall],
    ]
    return np.array(right + [[-x, z] for x, z in reversed(right[:-1])])


def _round_board(across: float, stub: float = 0.0) -> np.ndarray:
    """A disc, with a stub of a handle above it."""
    radius = across / 2
    angles = np.radians(np.linspace(-90.0, 270.0, 41)[:-1])
    points = np.stack([radius * np.cos(angles), radius + radius * np.sin(angles)], axis=-1)
    if stub <= 0.0:
        return points
    wide = 0.026
    keep = ~((np.abs(points[:, 0]) < wide) & (points[:, 1] > radius))
    cut = int(np.argmin(keep))
    shoulder = radius + float(np.sqrt(radius**2 - wide**2))
    handle = [
        [wide, shoulder],
        [wide, across + stub - 0.012],
        [wide - 0.012, across + stub],
        [-wide + 0.012, across + stub],
        [-wide, across + stub - 0.012],
        [-wide, shoulder],
    ]
    kept_before, kept_after = points[:cut][keep[:cut]], points[cut:][keep[cut:]]
    return np.concatenate([kept_before, handle, kept_after])


def _leaning(outline: np.ndarray, thick: float, back: float, foot: float, x: float = 0.0) -> Solid:
    """A board of this outline (x, z) whose upper edge touches y = back, its foot `foot` before it."""
    tall = float(np.ptp(outline[:, 1]))
    lean = np.degrees(np.arcsin(min(foot / tall, 0.5)))
    plate = _soft_plate(outline, thick)
    stood = plate.turned("x", 90).turned("x", -lean)
    low, high = stood.bounds_m()
    return stood.moved(x, back - float(high[1]), -float(low[2]))


def _soft_plate(outline: np.ndarray, thick: float) -> Solid:
    """A plate with chamfered rims over any outline."""
    edge = np.roll(outline, -1, axis=0) - outline
    edge /= np.linalg.norm(edge, axis=1, keepdims=True)
    out = np.stack([edge[:, 1], -edge[:, 0]], axis=-1)
    corner = out + np.roll(out, 1, axis=0)
    corner /= np.linalg.norm(corner, axis=1, keepdims=True)
    soft = 0.0025
    inner = outline - soft * corner
    return _stacked([(inner, 0.0), (outline, soft), (outline, thick - soft), (inner, thick)])


def _stacked(levels: list[tuple[np.ndarray, float]]) -> Solid:
    """Rings of one outline on top of each other; the ends are cut into triangles by ear."""
    from chord_usd.assets.solids import welded

    count = len(levels[0][0])
    caps = extruded(levels[0][0], 1.0)
    low = caps.faces[np.all(caps.points_m[caps.faces][:, :, 2] < 0.5, axis=1)]
    index = {tuple(np.round(p[:2], 9)): n for n, p in enumerate(levels[0][0])}
    mapped = np.array(
        [[index[tuple(np.round(caps.points_m[c][:2], 9))] for c in face] for face in low]
    )
    points = np.concatenate([np.column_stack([flat, np.full(count, z)]) for flat, z in levels])
    here = np.arange(count)
    after = (here + 1) % count
    faces = [mapped, mapped[:, ::-1] + (len(levels) - 1) * count]
    for level in range(len(levels) - 1):
        a, b = level * count, (level + 1) * count
        faces += [
            np.stack([a + here, a + after, b + after], -1),
            np.stack([a + here, b + after, b + here], -1),
        ]
    return welded(points, np.concatenate(faces))


def knife_block(size_m: Size) -> tuple[Part, ...]:
    """A slanted block with the handles of its knives."""
    length, depth, tall = size_m
    front, back = -depth / 2, depth / 2
    profile = [
        [front + 0.05, 0.0],
        [back - 0.01, 0.0],
        [back, 0.012],
        [back - 0.045, tall * 0.66],
        [front, tall * 0.48],
    ]
    lean = np.degrees(np.arctan2(tall * 0.18, depth - 0.045))
    body = extruded(profile, length).turned("x", 90).turned("z", 90).moved(x=-length / 2)
    across = np.array([front, tall * 0.48]), np.array([back - 0.045, tall * 0.66])
    grips, bolsters = [], []
    direction = across[1] - across[0]
    direction /= np.linalg.norm(direction)
    up = np.array([-direction[1], direction[0]])
    for row, share in enumerate((0.28, 0.68)):
        for column in range(3 - row):
            x = (column - (2 - row) / 2) * 0.034
            at = across[0] + (across[1] - across[0]) * share
            long = 0.1 - 0.012 * column - 0.008 * (1 - row)
            handle = (
                block((0.016, 0.026, long), 0.005)
                .turned("x", lean)
                .moved(x, at[0] + up[0] * 0.008, at[1] + up[1] * 0.008)
            )
            grips.append(handle)
            bolsters.append(
                block((0.013, 0.022, 0.014), 0.002)
                .turned("x", lean)
                .moved(x, at[0] - up[0] * 0.004, at[1] - up[1] * 0.004)
            )
    return (
        Part("Block", body, "wood"),
        Part("Bolsters", joined(bolsters), "steel", collider=None),
        Part("Grips", joined(grips), "grip", collider=None),
    )


def utensil_jar(size_m: Size) -> tuple[Part, ...]:
    """A crock of wooden spoons and other tools."""
    length, width, tall = size_m
    radius = 0.055
    high = 0.155
    crock = hollow(
        rounded_profile(
            [
                (radius * 0.9, 0),
                (radius, 0.006),
                (radius, 0.02),
                (radius, high - 0.01),
                (radius * 1.02, high),
            ],
            1,
        ),
        0.005,
        0.01,
        30,
    )
    wooden, steel = [], []
    leans = ((-11, 6, 0), (8, 10, 1), (10, -9, 2), (-5, -10, 0), (2, 2, 1))
    for index, (about_y, about_x, kind) in enumerate(leans):
        stem_top = tall - 0.08 - 0.014 * index
        tool = cylinder(0.0048, stem_top - 0.012, 0.001, 8).moved(z=0.0)
        if kind == 0:
            tool += (
                lathe([(0.004, 0), (0.018, 0.02), (0.023, 0.045), (0.016, 0.07), (0, 0.076)], 16)
                .scaled(1.0, 0.36, 1.0)
                .moved(z=stem_top - 0.018)
            )
        elif kind == 1:
            tool += block((0.05, 0.006, 0.075), 0.002).moved(0.0005, 0.0003, z=stem_top - 0.016)
        else:
            tool += _balloon(stem_top - 0.03, 0.1)
        placed = tool.turned("y", about_y).turned("x", about_x).moved(0.0007 * index, 0.0, 0.016)
        (steel if kind == 2 else wooden).append(placed)
    return (
        Part("Crock", crock, "ware"),
        Part("Spoons", joined(wooden), "wood", collider=None),
        Part("Whisk", joined(steel), "steel", collider=None),
    )


def _balloon(low: float, long: float) -> Solid:
    wires = []
    for turn in (0.0, 61.7, 123.1):
        arc = [
            [0.025 * np.sin(a) * (1 - 0.3 * np.cos(a)), 0.0, low + long * (1 - np.cos(a)) / 2]
            for a in np.linspace(0.06, 2 * np.pi - 0.06, 17)
        ]
        wires.append(tube(arc, 0.0013, 5).turned("z", turn))
    return joined(wires)


def _design(
    name: str, category: str, size: Size, draw: Draw, looks: Mapping[str, Mapping[str, str]],
    styles: tuple[str, ...] = (),
) -> Design:  # fmt: skip
    return Design(name, category, size, draw, looks, FINISHES, styles)


_PANS = {
    "steel": {"metal": "brushed_steel", "lid": "steel", "grip": "black", "iron": "cast_iron"},
    "copper": {"metal": "copper", "lid": "copper", "grip": "brass", "iron": "cast_iron"},
    "black_metal": {"metal": "cast_iron", "lid": "steel", "grip": "walnut", "iron": "black_metal"},
}
_CASSEROLES = {
    "cream": {"enamel": "enamel_cream", "grip": "brass"},
    "red": {"enamel": "enamel_red", "grip": "black"},
    "blue": {"enamel": "enamel_blue", "grip": "steel"},
    "cast_iron": {"enamel": "cast_iron", "grip": "brass"},
}
_KETTLES = {
    "steel": {"metal": "brushed_steel", "grip": "black", "bow": "steel"},
    "cream": {"metal": "enamel_cream", "grip": "oak", "bow": "steel"},
    "black_metal": {"metal": "black_metal", "grip": "walnut", "bow": "black_metal"},
    "white": {"metal": "white", "grip": "birch", "bow": "brass"},
}
_TOASTERS = {
    "steel": {"metal": "brushed_steel", "trim": "black", "dark": "black"},
    "cream": {"metal": "enamel_cream", "trim": "steel", "dark": "black"},
    "black_metal": {"metal": "black_metal", "trim": "brass", "dark": "black"},
    "white": {"metal": "white", "trim": "light_grey", "dark": "black"},
}
_MACHINES = {
    "steel": {"metal": "brushed_steel", "chrome": "chrome", "grip": "black", "dark": "graphite", "face": "white", "cup": "ceramic", "clear": "clear_glass", "coffee": "coffee"},
    "cream": {"metal": "enamel_cream", "chrome": "chrome", "grip": "walnut", "dark": "graphite", "face": "white", "cup": "ceramic", "clear": "clear_glass", "coffee": "coffee"},
    "black_metal": {"metal": "black_metal", "chrome": "chrome", "grip": "black", "dark": "steel", "face": "white", "cup": "stoneware", "clear": "clear_glass", "coffee": "coffee"},
}  # fmt: skip
_BOARDS = {
    "oak": {"wood": "oak", "second": "walnut"}, "walnut": {"wood": "walnut", "second": "birch"},
    "birch": {"wood": "birch", "second": "oak"},
}  # fmt: skip
_STONE_BOARDS = {"marble": {"wood": "marble"}, "dark_stone": {"wood": "dark_stone"}}
_BLOCKS = {
    "oak": {"wood": "oak", "grip": "black", "steel": "steel"},
    "walnut": {"wood": "walnut", "grip": "black", "steel": "steel"},
    "black_stain": {"wood": "black_stain", "grip": "oak", "steel": "steel"},
}
_CROCKS = {
    "white": {"ware": "ceramic", "wood": "oak", "steel": "steel"},
    "stoneware": {"ware": "stoneware", "wood": "birch", "steel": "steel"},
    "dark": {"ware": "stoneware_dark", "wood": "walnut", "steel": "steel"},
}

DESIGNS = (
    _design("Pot_Saucepan", "pot", (0.36, 0.18, 0.16), saucepan, _PANS),
    _design("Pot_Casserole", "pot", (0.32, 0.24, 0.2), casserole, _CASSEROLES),
    _design("Pot_Frying_Pan", "pot", (0.46, 0.28, 0.09), frying_pan, _PANS),
    _design("Kettle_Electric", "kettle", (0.22, 0.16, 0.24), kettle, _KETTLES),
    _design("Kettle_Stove", "kettle", (0.23, 0.19, 0.22), stove_kettle, _KETTLES),
    _design("Toaster", "toaster", (0.29, 0.17, 0.19), toaster, _TOASTERS),
    _design("Toaster_Retro", "toaster", (0.31, 0.19, 0.2), partial(toaster, retro=True), _TOASTERS),
    _design(
        "Coffee_Machine_Espresso", "coffee_machine", (0.26, 0.32, 0.38), espresso_machine, _MACHINES
    ),
    _design(
        "Coffee_Machine_Filter", "coffee_machine", (0.19, 0.27, 0.34), filter_machine, _MACHINES
    ),
    _design("Cutting_Board", "cutting_board", (0.22, 0.1, 0.4), cutting_board, _BOARDS),
    _design(
        "Cutting_Board_Pair",
        "cutting_board",
        (0.36, 0.089, 0.42),
        partial(cutting_board, kind="pair"),
        _BOARDS,
    ),
    _design(
        "Cutting_Board_Round",
        "cutting_board",
        (0.28, 0.1, 0.39),
        partial(cutting_board, kind="round"),
        _BOARDS,
    ),
    _design(
        "Cutting_Board_Stone",
        "cutting_board",
        (0.3, 0.08, 0.38),
        partial(cutting_board, kind="stone"),
        _STONE_BOARDS,
    ),
    _design("Knife_Block", "knife_block", (0.12, 0.18, 0.24), knife_block, _BLOCKS),
    _design("Utensil_Jar", "utensil_jar", (0.147, 0.12, 0.317), utensil_jar, _CROCKS),
)
