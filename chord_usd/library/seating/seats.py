"""Sofas, armchairs, lounge chairs and chairs."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray, frozen_array
from chord_usd.library.kit.joinery import four_legs
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    bevelled_plate,
    block,
    box,
    creased,
    cushion,
    cylinder,
    joined,
    lathe,
    loft,
    mirrored_pair,
    pair,
    ring,
    rounded_slab,
    soft_block,
    tube,
)

ArmKind = Literal["track", "soft", "slim", "rolled", "leather", "frame"]

_ARM_M = {"track": 0.15, "soft": 0.21, "slim": 0.09, "rolled": 0.22, "leather": 0.17, "frame": 0.09}
_LEG_M = {"track": 0.09, "soft": 0.09, "slim": 0.15, "rolled": 0.11, "leather": 0.1, "frame": 0.12}
_SEAT_TOP_M = 0.43
_BASE_TOP_M = 0.27
_SEAT_LENGTH_M = 0.66


def sofa(size_m: Size, *, seats: int = 0, arm: ArmKind = "track") -> tuple[Part, ...]:
    """A sofa or armchair: base on legs, two arms, a back, loose seat and back cushions.

    seats: how many; 0 takes as many as fit.
    """
    length, width, height = size_m
    arm_m, leg_m = _ARM_M[arm], _LEG_M[arm]
    inner = length - 2 * arm_m
    seats = seats or max(2, round(inner / _SEAT_LENGTH_M))
    back_m = 0.16 if arm != "frame" else 0.06
    if arm == "frame":
        return (*_timber_frame(length, width, height),
                *_seats(inner, width, height, back_m, seats, corded=False))  # fmt: skip
    y_back = width / 2 - back_m / 2
    base = rounded_slab((length - arm_m, width - 0.03, _BASE_TOP_M - leg_m), 0.03, 0.015, 4, 2)
    back = soft_block((inner + 0.06, back_m, height - 0.06 - leg_m), 0.05, (4, 1, 3))
    return (
        *_legs(arm, length, width, leg_m),
        Part("Base", base.moved(z=leg_m), "cloth"),
        Part("Back", back.moved(y=y_back, z=leg_m + 0.02), "cloth"),
        *_arms(arm, length, width, height, leg_m),
        *_seats(inner, width, height, back_m, seats, corded=arm != "slim"),
    )


def _legs(arm: ArmKind, length: float, width: float, leg_m: float) -> tuple[Part, ...]:
    """Splayed wood, turned feet, or blocks and skids of metal."""
    wide, deep = length - _ARM_M[arm] + 0.05, width - 0.1
    if arm == "slim":
        return four_legs(wide, deep, leg_m + 0.04, 0.042, is_round=True, splay_m=0.03)
    if arm == "rolled":
        foot = lathe(
            [(0.016, 0.0), (0.02, 0.012), (0.017, 0.03), (0.034, 0.055), (0.034, 0.075),
             (0.024, 0.09), (0.026, leg_m + 0.02)], 16,
        )  # fmt: skip
        places = [(sx, sy) for sx, sy in ((-1, 1), (-1, -1), (1, -1), (1, 1))]
        return tuple(
            Part(f"Leg_{n}", foot.moved(sx * (wide / 2 - 0.05), sy * (deep / 2 - 0.03)), "leg")
            for n, (sx, sy) in enumerate(places, start=1)
        )
    if arm == "leather":
        skid = bent_path(
            [[0, -deep / 2, leg_m + 0.02], [0, -deep / 2, 0.009], [0, deep / 2, 0.009],
             [0, deep / 2, leg_m + 0.02]], 0.02,
        )  # fmt: skip
        bar = tube(skid, 0.009, 8)
        return tuple(
            Part(f"Leg_{n}", bar.moved(sx * (wide / 2 - 0.09)), "leg")
            for n, sx in enumerate((-1, 1), start=1)
        )
    return four_legs(wide, deep, leg_m + 0.04, 0.045)


def _arms(
    kind: ArmKind, length: float, width: float, height: float, leg: float
) -> tuple[Part, ...]:
    wide = _ARM_M[kind]
    top = min({"slim": 0.58, "leather": 0.6}.get(kind, 0.62), height - 0.1)
    at = (length - wide) / 2
    if kind == "rolled":
        right = rolled_arm(wide, width - 0.03, top - leg + 0.006).moved(y=-0.012, z=-0.006)
    else:
        radius = {"track": 0.03, "soft": 0.095, "slim": 0.038, "leather": 0.05}[kind]
        right = soft_block((wide, width, top - leg + 0.01), radius, (2, 6, 3))
        right = creased(right, 0.0025, 0.4).moved(z=-0.01)
    return (
        Part("Arm_Left", right.scaled(x=-1.0).moved(x=-at, z=leg), "cloth"),
        Part("Arm_Right", right.moved(x=at, z=leg), "cloth"),
    )


def _timber_frame(length: float, width: float, height: float) -> tuple[Part, ...]:
    """A low frame of boards: legs that carry flat arms, slats behind the cushions."""
    side, arm_z = length / 2 - 0.025, 0.54
    legs = []
    for number, (sx, sy) in enumerate(((-1, 1), (-1, -1), (1, -1), (1, 1)), start=1):
        tall = arm_z if sy < 0 else height - 0.1
        post = block((0.05, 0.05, tall - 0.002), 0.004)
        post = post.moved(sx * side, sy * (width / 2 - 0.035))
        legs.append(Part(f"Leg_{number}", post, "leg"))
    rest = rounded_slab((0.09, width - 0.09, 0.026), 0.012, 0.006).moved(z=arm_z - 0.004)
    rests = pair(rest.moved(y=-0.03), x=length / 2 - 0.045)
    deck = block((length - 0.09, width - 0.08, 0.05), 0.004).moved(z=_BASE_TOP_M - 0.06)
    rails = [block((length - 0.06, 0.024, 0.06), 0.004).moved(y=width / 2 - 0.035, z=z)
             for z in (height - 0.17, _BASE_TOP_M + 0.08)]  # fmt: skip
    count = max(round((length - 0.2) / 0.09), 4)
    slats = [block((0.03, 0.014, height - 0.45), 0.002).moved(
                 (i - (count - 1) / 2) * (length - 0.16) / (count - 1), width / 2 - 0.036,
                 _BASE_TOP_M + 0.11)
             for i in range(count)]  # fmt: skip
    return (
        *legs,
        Part("Arm_Rests", joined(rests), "leg"),
        Part("Base", deck, "leg"),
        Part("Back", joined([*rails, *slats]), "leg"),
    )


def _seats(
    inner: float, width: float, height: float, back: float, seats: int, *, corded: bool
) -> tuple[Part, ...]:
    """Seat and back cushions; a hand's breadth of seat shows in front of the arms' line."""
    wide = inner / seats - 0.008
    deep = width - back - 0.015
    rest_height = height - _SEAT_TOP_M + 0.05
    places = [(i - (seats - 1) / 2) * inner / seats for i in range(seats)]
    y = -width / 2 + 0.005 + deep / 2
    lying, standing = [], []
    for number, x in enumerate(places):
        seat = boxed_cushion(
            (wide, deep, _SEAT_TOP_M - _BASE_TOP_M + 0.03), crown_m=0.03, dent_m=0.008,
            seed=number, cords=2 if corded else 0, corner_m=0.04 if corded else 0.06,
        )  # fmt: skip
        lying.append(seat.moved(x, y, _BASE_TOP_M - 0.015))
        rest = boxed_cushion(
            (wide - 0.01, rest_height, 0.2), crown_m=0.06, belly_m=0.016, seed=10 + number,
            cords=int(corded), corner_m=0.06,
        )  # fmt: skip
        lean = 77.0 + (0.0, 1.6, -1.2)[number % 3]
        standing.append(stood_up(rest, lean, width / 2 - back + 0.03, height).moved(x))
    return (
        Part("Seat", joined(lying), "cushion"),
        Part("Back_Cushions", joined(standing), "cushion", collider=None),
    )


def wing_chair(size_m: Size) -> tuple[Part, ...]:
    """A high-backed armchair with wings."""
    length, width, height = size_m
    plain = sofa(size_m, seats=1, arm="soft")
    thick, low, reach = 0.075, 0.5, 0.36
    # Side view, front to the left: up the front edge, over the round top, down the back.
    curve = np.radians(np.linspace(0.0, 90.0, 6))
    top = height - 0.005
    outline = [
        [0.005, low], [reach, low], [reach, top - 0.03], [reach - 0.03, top],
        *([reach - 0.1 - 0.2 * math.sin(a), top - 0.2 + 0.2 * math.cos(a)] for a in curve),
        [0.03, low + 0.16],
    ]  # fmt: skip
    plate = bevelled_plate(outline, thick, 0.016).turned("x", 90).turned("z", 90)
    at_x = (length - 2 * _ARM_M["soft"]) / 2 + 0.06
    low_x = float(plate.bounds_m()[0, 0])
    wing = plate.moved(x=at_x - thick / 2 - low_x, y=width / 2 - reach)
    return (*plain, Part("Wings", mirrored_pair(wing), "cloth"))


def barrel_chair(size_m: Size) -> tuple[Part, ...]:
    """A tub chair: one curved shell that is back and arms, on a turned foot."""
    length, width, height = size_m
    shell = _curved_shell(length, width, 0.09, height - 0.1, 0.58 - 0.1)
    seat = cushion((length - 0.2, width - 0.15, 0.2), 0.3, 0.06, 0.03)
    foot = lathe([(0.2, 0.0), (0.22, 0.015), (0.2, 0.03), (0.06, 0.05), (0.06, 0.13)], 28)
    base = rounded_slab((length - 0.14, width - 0.14, 0.16), 0.35, 0.02, 6, 2)
    # Boxes within the round of the shell: beyond it they would touch what the chair does not.
    back = box((length * 0.6, 0.1, height - 0.1)).moved(y=width / 2 - 0.05, z=0.1)
    arm = box((0.1, width * 0.55, 0.48)).moved(length / 2 - 0.05, 0.0, 0.1)
    return (
        Part("Foot", foot, "leg"),
        Part("Base", base.moved(y=-0.02, z=0.12), "cloth"),
        Part("Shell", shell.moved(z=0.1), "cloth", colliders=(back, arm, arm.scaled(x=-1.0))),
        Part("Seat", seat.moved(y=-0.06, z=0.25), "cushion"),
    )


def _curved_shell(
    length: float, width: float, thick: float, back_height: float, arm_height: float
) -> Solid:
    """A wall in a horseshoe, open to the front, highest at the back."""
    rings = []
    angles = np.radians(np.linspace(-38.0, 218.0, 33))
    for angle in angles:
        along = math.sin(angle)
        share = min(max((along + 0.2) / 1.1, 0.0), 1.0)
        tall = arm_height + (back_height - arm_height) * (share**2 * (3 - 2 * share))
        section = ring(thick, tall, thick * 0.48, 0.0, 4)
        across, up = section[:, 0], section[:, 1] + tall / 2
        x = math.cos(angle) * (length / 2 - thick / 2 + across)
        y = math.sin(angle) * (width / 2 - thick / 2 + across)
        rings.append(np.stack([x, y, up], axis=-1))
    return loft(rings[::-1])


def lounge_chair(size_m: Size) -> tuple[Part, ...]:
    """A wooden frame with sloping seat and back cushions."""
    length, width, height = size_m
    half, front_y, back_y = length / 2 - 0.02, -width / 2 + 0.03, width / 2 - 0.05
    arm_z = 0.56
    side = joined(
        [
            tube([[half, front_y + 0.06, 0.0], [half, front_y + 0.02, arm_z - 0.02]], 0.02, 10),
            tube([[half, back_y - 0.2, 0.0], [half, back_y - 0.16, arm_z - 0.02]], 0.02, 10),
            tube([[half, front_y + 0.04, 0.3], [half, back_y - 0.17, 0.24]], 0.016, 10),
            rounded_slab((0.07, width - 0.2, 0.03), 0.03, 0.008).moved(
                half - 0.015, -0.1, arm_z - 0.03
            ),
        ]
    )
    inner = length - 0.13
    seat = boxed_cushion((inner, width - 0.24, 0.13), crown_m=0.02, dent_m=0.006).turned("x", -7)
    back = boxed_cushion((inner, height - 0.28, 0.13), crown_m=0.03, seed=2).turned("x", 66)
    high = back.bounds_m()[1]
    back = back.moved(0.0, width / 2 - float(high[1]), height - float(high[2]))
    bars = [
        tube([[-half, y, z], [half, y, z]], 0.016, 10)
        for y, z in ((front_y + 0.07, 0.3), (back_y - 0.19, 0.25))
    ]
    return (
        Part("Frame", mirrored_pair(side) + joined(bars), "frame"),
        Part("Seat", seat.moved(y=-0.1, z=0.31), "cushion"),
        Part("Back", back, "cushion"),
    )


def slipper_chair(size_m: Size) -> tuple[Part, ...]:
    """A low armless chair: a thick seat and a rolled back on turned legs."""
    length, width, height = size_m
    leg_m, seat_z = 0.18, 0.42
    back_m = 0.16
    base = rounded_slab((length - 0.02, width - 0.04, 0.12), 0.05, 0.02, 4, 2)
    seat = boxed_cushion((length - 0.006, width - back_m + 0.02, 0.15), crown_m=0.025, dent_m=0.005)
    back = soft_block((length, back_m, height - leg_m - 0.06), 0.06, (2, 1, 2))
    return (
        *four_legs(length - 0.08, width - 0.1, leg_m + 0.02, 0.045, is_round=True, splay_m=0.012),
        Part("Base", base.moved(y=0.0, z=leg_m), "cloth"),
        Part("Seat", seat.moved(y=-back_m / 2 + 0.01, z=seat_z - 0.14), "cushion"),
        Part("Back", back.moved(y=(width - back_m) / 2, z=leg_m + 0.06), "cloth"),
    )


def office_chair(size_m: Size) -> tuple[Part, ...]:
    """A swivel chair: five-star foot on castors, gas lift, padded seat and back, arm rests."""
    length, width, height = size_m
    reach = min(length, width) / 2 - 0.03
    spokes, castors = [], []
    for index in range(5):
        turn = -90.0 + 72.0 * index
        spoke = tube([[0.02, 0, 0.11], [reach - 0.005, 0, 0.075]], 0.018, 8)
        spokes.append(spoke.turned("z", turn))
        wheel = cylinder(0.028, 0.035, 0.006, 14).moved(z=-0.0175).turned("x", 90)
        castors.append(wheel.moved(reach, 0, 0.028).turned("z", turn))
    stem = cylinder(0.03, 0.12, 0, 14).moved(z=0.09) + cylinder(0.018, 0.2, 0, 12).moved(z=0.2)
    seat = cushion((length - 0.1, width - 0.12, 0.09), 0.11, 0.04, 0.02)
    back = cushion((length - 0.14, height - 0.52, 0.09), 0.09, 0.035, 0.03).turned("x", 80)
    high = back.bounds_m()[1]
    back = back.moved(0.0, width / 2 - 0.01 - float(high[1]), height - float(high[2]))
    spine = bent_path(
        [[0, 0.06, 0.39], [0, width / 2 - 0.03, 0.39], [0, width / 2 - 0.01, 0.7]], 0.08
    )
    arm = [[0.02, 0.1, 0.41], [length / 2 - 0.025, 0.1, 0.41], [length / 2 - 0.025, 0.1, 0.63]]
    rest = rounded_slab((0.05, 0.24, 0.025), 0.025, 0.008).moved(length / 2 - 0.025, 0.02, 0.63)
    return (
        Part("Foot", joined(spokes), "metal"),
        Part("Castors", joined(castors), "rubber"),
        Part("Lift", stem, "metal"),
        Part("Seat", seat.moved(y=-0.04, z=0.395), "seat"),
        Part("Back", back, "seat"),
        Part("Spine", tube(spine, 0.018, 8), "rubber", collider=None),
        Part("Arm_Rests", mirrored_pair(tube(bent_path(arm, 0.05), 0.013, 8) + rest), "rubber",
             collider=None),
    )  # fmt: skip


# What an upholsterer makes: boxed cushions with cords, stuffed arms and backs, rolled ------------

_CORD_M = 0.0055


def boxed_cushion(
    size_m: Size, *, crown_m: float = 0.03, belly_m: float = 0.012, dent_m: float = 0.0,
    seed: int = 0, cords: int = 2, corner_m: float = 0.045,
) -> Solid:  # fmt: skip
    """A cushion of two covers and a border, lying; it fills its size at the crown.

    crown_m: how much higher its middle is than its edges; belly_m: how far its sides swell;
    dent_m: how deep it is sat in. cords: none, one around the upper cover, or two.
    """
    length, width, height = size_m
    edge = height - crown_m
    inset = belly_m + (_CORD_M if cords else 0.0)
    core = (length - 2 * inset, width - 2 * inset, edge)
    cells = (max(round(length / 0.14), 3), max(round(width / 0.14), 3), 1)
    body = soft_block(core, min(corner_m, 0.4 * edge), cells)
    points = _swollen(body.points_m.copy(), core, crown_m, belly_m, dent_m, seed)
    made = Solid(frozen_array(points), body.faces)
    if not cords:
        return made
    round_m = min(corner_m, 0.4 * edge)
    lines = []
    for z in (edge - 0.3 * round_m, 0.3 * round_m)[:cords]:
        path = _around(core, round_m, z)
        path = _swollen(path, core, crown_m, belly_m, dent_m, seed)
        lines.append(cord(path, _CORD_M))
    return joined([made, *lines])


def _around(core: Size, round_m: float, z: float) -> FloatArray:
    """Where the cover meets the border: just inside the block's outermost line."""
    inset = 0.3 * round_m
    outline = ring(core[0] - 2 * inset, core[1] - 2 * inset, max(round_m - inset, 0.012), z, 2)
    points = []
    for here, after in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        count = max(round(float(np.linalg.norm(after - here)) / 0.17), 1)
        points += [here + (after - here) * n / count for n in range(count)]
    return np.array(points)


def _swollen(
    points: FloatArray, core: Size, crown: float, belly: float, dent: float, seed: int
) -> FloatArray:
    length, width, edge = core
    u = np.clip(2 * points[:, 0] / length, -1, 1)
    v = np.clip(2 * points[:, 1] / width, -1, 1)
    up = np.clip(points[:, 2] / edge, 0, 1)
    dome = (1 - u**2) * (1 - v**2)
    dome = dome**0.6
    rng = np.random.default_rng(seed)
    phase = rng.uniform(0, 2 * math.pi, 4)
    ripple = 0.0016 * (
        np.sin(points[:, 0] * 31 + 14 * points[:, 1] + phase[0])
        + np.sin(points[:, 1] * 27 - 11 * points[:, 0] + phase[1])
    )
    sat = dent * np.exp(-((u - 0.06 * np.sin(phase[2])) ** 2 / 0.3 + (v + 0.05) ** 2 / 0.35))
    rise = crown * dome + ripple * dome - sat
    mid = 1 - (2 * up - 1) ** 2
    across = 0.15 * np.sin(9 * v + phase[3]) * mid
    out_x = belly * mid * (1 - v**2) ** 0.5 * (1 + across)
    out_y = belly * mid * (1 - u**2) ** 0.5 * (1 + across)
    swollen = points.copy()
    swollen[:, 2] += rise * np.where(up > 0.5, 2 * up - 1, 0.0)
    swollen[:, 0] += np.sign(u) * np.abs(u) ** 6 * out_x
    swollen[:, 1] += np.sign(v) * np.abs(v) ** 6 * out_y
    return swollen


def cord(path: FloatArray, radius_m: float, sides: int = 4) -> Solid:
    """A round cord along a closed path (N, 3), counter-clockwise seen from above."""
    along = np.roll(path, -1, axis=0) - np.roll(path, 1, axis=0)
    along /= np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-9)
    out = np.stack([along[:, 1], -along[:, 0], np.zeros(len(along))], axis=-1)
    out /= np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-9)
    up = np.cross(out, along)
    angles = np.linspace(0.0, 2 * math.pi, sides, endpoint=False)
    rings = [path + radius_m * (math.cos(a) * out - math.sin(a) * up) for a in angles]
    sections = np.stack(rings, axis=1)
    made = loft(list(sections), loop=True)
    a, b, c = (made.points_m[made.faces[:, corner]] for corner in range(3))
    if float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) < 0.0:
        made = Solid(made.points_m, frozen_array(made.faces[:, ::-1], np.int64))
    return made


def stood_up(lying: Solid, lean_deg: float, back_y: float, top_z: float) -> Solid:
    """A cushion that was drawn lying, its upper side now to the front, leaning on its back.

    Its hindmost point comes to y = back_y, its highest to z = top_z.
    """
    upright = lying.turned("x", lean_deg)
    high = upright.bounds_m()[1]
    return upright.moved(0.0, back_y - float(high[1]), top_z - float(high[2]))


def rolled_arm(wide: float, deep: float, tall: float) -> Solid:
    """An arm whose top rolls outwards (+x) in a scroll; stands on z = 0, runs along y."""
    radius = 0.088
    inner = -wide / 2
    stem = wide - 0.075
    turns = np.radians(np.linspace(-60.0, 172.0, 18))
    cx, cz = wide / 2 - radius, tall - radius
    scroll = [(cx + radius * math.cos(a), cz + radius * math.sin(a)) for a in turns]
    outline = np.array([
        (inner, 0.0), (inner + stem, 0.0), (inner + stem, tall - 2 * radius - 0.06),
        (inner + stem + 0.012, tall - 2 * radius), *scroll, (inner, cz - 0.02), (inner, 0.5 * cz),
    ])  # fmt: skip
    middle = np.array([0.5 * (inner + inner + stem), 0.55 * tall])
    rings = []
    for y, share in ((-deep / 2, 0.93), (-deep / 2 + 0.006, 0.985), (-deep / 2 + 0.02, 1.0),
                     (0.0, 1.0), (deep / 2 - 0.02, 1.0), (deep / 2, 0.96)):  # fmt: skip
        flat = middle + (outline - middle) * share
        flat[:, 1] = np.maximum(flat[:, 1], 0.0)
        rings.append(np.column_stack([flat[:, 0], np.full(len(flat), y), flat[:, 1]]))
    made = loft(rings)
    a, b, c = (made.points_m[made.faces[:, corner]] for corner in range(3))
    if float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum()) < 0.0:
        made = Solid(made.points_m, frozen_array(made.faces[:, ::-1], np.int64))
    return made
