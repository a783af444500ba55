"""What stands on worktops and hobs: pots, kettles, toasters, coffee machines, boards, knives."""

from __future__ import annotations

import numpy as np

from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    block,
    extruded,
    joined,
    lathe,
    mirrored_pair,
    ring,
    rounded_profile,
    rounded_slab,
    tube,
)
from chord_usd.library.kitchen.vessels import vessel


def _lid(radius: float, z: float, dome: float) -> Solid:
    return lathe(
        [
            (radius - 0.004, z - 0.003),
            (radius, z),
            (radius, z + 0.003),
            (radius * 0.8, z + dome * 0.55),
            (radius * 0.4, z + dome * 0.92),
            (0, z + dome),
        ],
        36,
    )


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
    pan = vessel(
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
    """A board of this outline (x, z) that leans on y = back, its foot so far before it."""
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
    from chord_usd.library.kit.solids import welded

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
