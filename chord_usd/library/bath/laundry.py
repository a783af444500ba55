"""Washing machines and laundry units."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from chord_usd.library.bath.taps import sink_tap
from chord_usd.library.kit.joinery import (
    FRONT_M,
    HANDLE_M,
    cells,
    colliders_around,
    plinth,
    shifted,
)
from chord_usd.library.kit.model import (
    Part,
    hollow_part,
    moving_part,
    placed,
)
from chord_usd.library.kit.moves import Moving, door
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    at_corners,
    block,
    box,
    circle,
    cylinder,
    extruded,
    joined,
    lathe,
    pair,
    ring,
)
from chord_usd.library.kitchen.kitchen_fronts import FrontForm, kitchen_fronts
from chord_usd.library.kitchen.sinks import sink_bowl

_DOOR_OUT_M = 0.035


def washing_machine(size_m: Size) -> tuple[Part, ...]:
    """A front loader: casing with a round opening, bulging glass door, drawer, dial, display."""
    length, width, height = size_m
    machine = _machine(length, width - _DOOR_OUT_M, height, drum=min(0.175, length * 0.3))
    return placed(machine, (0.0, _DOOR_OUT_M / 2, 0.0))


def _machine(
    length: float, width: float, height: float, drum: float, prefix: str = ""
) -> tuple[Part, ...]:
    """One machine, its own front at y = -width / 2. Its door opens, and the drum is behind it."""
    y = -width / 2
    front_m, feet = 0.03, 0.02
    centre_z = height * 0.47
    sheet = ring(length, height - feet, 0.012, 0.0, 2)[:, :2] + [0.0, feet + (height - feet) / 2]
    hole = circle(drum, 0.0, 36)[:, :2] + [0.0, centre_z]
    # Drawn lying, raised about x: the plate's underside becomes the front.
    face = extruded(sheet, front_m, [hole]).turned("x", 90).moved(y=y + front_m)
    body = block((length, width - front_m + 0.002, height - feet), 0.006)
    body = body.moved(y=front_m / 2, z=feet)
    foot_x, foot_y = length / 2 - 0.06, width / 2 - 0.07
    foot = at_corners(cylinder(0.022, feet + 0.002, 0, 12), foot_x, foot_y)
    door_at = {"y": y, "z": centre_z}
    hoop = lathe(
        [
            (drum - 0.014, -0.006),
            (drum + 0.03, -0.002),
            (drum + 0.034, 0.006),
            (drum + 0.028, 0.02),
            (drum + 0.012, 0.027),
            (drum - 0.008, 0.028),
            (drum - 0.02, 0.016),
        ],
        44,
        loop=True,
    )
    lip = lathe(
        [
            (drum + 0.032, -0.001),
            (drum + 0.04, -0.001),
            (drum + 0.04, 0.004),
            (drum + 0.032, 0.004),
        ],
        44,
        loop=True,
    )
    lens = lathe(
        [
            (drum - 0.012, 0.0),
            (drum - 0.016, 0.014),
            (drum * 0.72, 0.022),
            (drum * 0.5, 0.012),
            (drum * 0.25, 0.004),
            (0, 0.003),
        ],
        40,
    )
    grip = block((0.018, 0.012, 0.1), 0.005).moved(drum + 0.014, y - 0.03, centre_z - 0.05)
    panel_z = height - 0.115
    drawer = block((length * 0.29, 0.014, 0.086), 0.005).moved(-length * 0.315, y, panel_z + 0.004)
    pull = block((length * 0.2, 0.006, 0.014), 0.002)
    pull = pull.moved(-length * 0.315, y - 0.0075, panel_z + 0.012)
    flap = block((0.12, 0.006, 0.07), 0.002).moved(length * 0.32, y - 0.001, feet + 0.02)
    seam = [
        box((length - 0.012, 0.003, 0.0035)).moved(y=y - 0.0005, z=z)
        for z in (panel_z - 0.012, feet + 0.105)
    ]
    dial = lathe(
        [(0.036, 0), (0.036, 0.004), (0.029, 0.007), (0.028, 0.024), (0.026, 0.026), (0, 0.026)], 30
    )
    dial = dial.turned("x", 90).moved(0.005, y + 0.001, panel_z + 0.047)
    display = block((length * 0.27, 0.006, 0.062), 0.002)
    display = display.moved(length * 0.29, y - 0.0015, panel_z + 0.016)
    keys = [
        cylinder(0.0055, 0.003, 0.001, 12)
        .turned("x", 90)
        .moved(length * 0.29 + 0.022 * n, y - 0.0035, panel_z + 0.032)
        for n in (-2, -1, 0, 1, 2)
    ]
    figures = [
        box((0.006, 0.001, 0.014)).moved(length * 0.29 + 0.0105 * n, y - 0.0047, panel_z + 0.05)
        for n in (-2, -1, 1, 2)
    ]
    hoop = joined([hoop.turned("x", 90).moved(**door_at), grip])
    hatch = door(hoop, hung="left", inside="nothing")
    collider = _up_to(hoop, y)
    lip = lip.turned("x", 90).moved(**door_at)
    tub, tub_colliders = _tub(drum + 0.03, width - front_m - 0.06, y + front_m, centre_z)
    parts = (
        Part("Casing", body + face, "machine", hollow=(body,), still=face,
             still_colliders=colliders_around_upright(face, drum, centre_z)),
        Part("Feet", joined(foot), "rubber", None),
        Part("Drawer", drawer + flap, "trim", None),
        Part("Seams", joined([*seam, pull]), "seam", None),
        Part("Hoop", hoop, "hoop", None, moves=(Moving(hatch, hoop, (collider,)),)),
        Part("Lip", lip, "hoop", None, still=lip + tub, still_colliders=tub_colliders),
        moving_part("Door_Glass", [lens.turned("x", 90).moved(**door_at)], "dark_glass", [hatch],
                    None),
        Part("Dial", dial, "hoop", None),
        Part("Display", display, "dark_glass", None),
        Part("Keys", joined([*keys, *figures]), "mark", None),
    )  # fmt: skip
    return tuple(replace(part, name=prefix + part.name) for part in parts)


def _up_to(solid: Solid, y: float) -> Solid:
    """The box around what of a solid is before a plane."""
    low, high = solid.bounds_m()
    size = (float(high[0] - low[0]), float(y - low[1]), float(high[2] - low[2]))
    return box(size).moved(float(low[0] + high[0]) / 2, float(low[1] + y) / 2, float(low[2]))


def _tub(radius: float, deep: float, y: float, z: float) -> tuple[Solid, tuple[Solid, ...]]:
    """A drum that is open towards -y, and its colliders: a square of boards around it."""
    wall = 0.004
    profile = [(0.0, 0.0), (radius, 0.0), (radius, deep), (radius - wall, deep),
               (radius - wall, wall), (0.0, wall)]  # fmt: skip
    tub = lathe(profile, 36).turned("x", 90).moved(y=y + deep, z=z)
    plate = box((2 * radius, deep, 0.01))
    side = box((0.01, deep, 2 * radius))
    middle = y + deep / 2
    colliders = [plate.moved(y=middle, z=z - radius - 0.01), plate.moved(y=middle, z=z + radius)]
    colliders += pair(side.moved(y=middle, z=z - radius), x=radius + 0.005)
    return tub, tuple(colliders)


def colliders_around_upright(face: Solid, radius: float, z: float) -> tuple[Solid, ...]:
    """Boards around a round hole in an upright sheet, which collide in its place."""
    low, high = face.bounds_m()
    deep, y = float(high[1] - low[1]), float(low[1] + high[1]) / 2
    length, x = float(high[0] - low[0]), float(low[0] + high[0]) / 2
    side = length / 2 - radius
    return (
        box((length, deep, z - radius - float(low[2]))).moved(x, y, float(low[2])),
        box((length, deep, float(high[2]) - z - radius)).moved(x, y, z + radius),
        *(box((side, deep, 2 * radius)).moved(x + s * (radius + side / 2), y, z - radius)
          for s in (-1, 1)),
    )  # fmt: skip


def laundry_counter(
    size_m: Size, *, form: FrontForm = "bar", has_dryer: bool = False
) -> tuple[Part, ...]:
    """A worktop over a washing machine and, beside it, a sink cabinet or a second machine."""
    length, width, height = size_m
    top = 0.036
    tall = height - top - 0.012
    machine_l = min(0.6, length * 0.52) if not has_dryer else min(0.6, length / 2 - 0.02)
    machine_w = width - _DOOR_OUT_M
    machine = partial(_machine, machine_l, machine_w, tall, min(0.175, machine_l * 0.3))
    x = -(length - machine_l) / 2 + 0.012
    parts = [*placed(machine("Washer_"), (x, _DOOR_OUT_M / 2, 0.0))]
    if has_dryer:
        parts += placed(machine("Dryer_"), (-x, _DOOR_OUT_M / 2, 0.0))
        parts.append(Part("Worktop", _plate(length, width, top, height), "worktop"))
        return tuple(parts)
    case_l = length - machine_l - 0.024
    parts += _sink_side(case_l, (length - case_l) / 2, size_m, top, form)
    return tuple(parts)


def _plate(length: float, width: float, top: float, height: float) -> Solid:
    return block((length, width - 0.01, top), 0.003).moved(y=0.005, z=height - top)


def _sink_side(case_l: float, x: float, size_m: Size, top: float, form: FrontForm) -> list[Part]:
    """The cabinet with a laundry sink, and the worktop with its hole."""
    length, width, height = size_m
    y, base = -width / 2 + HANDLE_M + FRONT_M, 0.08
    depth = width / 2 - y
    low = height - top - base - 0.24
    case = block((case_l, depth, low)).moved(x, y + depth / 2, base)
    rims = [
        box((0.018, depth - 0.002, 0.242)).moved(
            x + s * (case_l - 0.022) / 2, y + depth / 2, base + low
        )
        for s in (-1, 1)
    ]
    back = box((case_l - 0.024, 0.014, 0.24)).moved(x, y + 0.009, base + low + 0.001)
    columns = 2 if case_l > 0.6 else 1
    face = shifted(cells(case_l, height - top - base - 0.004, columns, z_m=base + 0.002), x)
    bowl_l, bowl_w = min(0.46, case_l - 0.09), width - 0.24
    hole = ring(bowl_l, bowl_w, 0.06, 0.0, 5)[:, :2] + [x, -0.02]
    outline = ring(length, width - 0.01, 0.0, 0.0, 0)[:, :2] + [0.0, 0.005]
    plate = extruded(outline, top, [hole]).moved(z=height - top)
    base_part = plinth((case_l, width, height), base, inset_m=0.09)
    bowl = sink_bowl(bowl_l, bowl_w, 0.2).moved(x, -0.02, height)
    tap = sink_tap().scaled(0.9, 0.9, 0.9).moved(x, -0.02 + bowl_w / 2 + 0.05, height - 0.002)
    return [
        Part("Plinth", base_part.solid.moved(x=x), "plinth"),
        hollow_part("Sink_Body", case),
        Part("Sink_Upper_Body", joined([*rims, back]), "body", collider=None),
        *kitchen_fronts(face, y, form),
        Part("Worktop", plate, "worktop", colliders=colliders_around(plate, [hole])),
        Part("Bowl", bowl, "ceramic", collider=None, above=True),
        Part("Tap", tap, "tap", collider=None, above=True),
    ]


def laundry_tower(size_m: Size, *, form: FrontForm = "bar") -> tuple[Part, ...]:
    """A washer with a dryer on top, between a tall cabinet and a frame."""
    length, width, height = size_m
    machine_l = 0.6
    machine_h = 0.84
    machine = partial(_machine, machine_l, width - _DOOR_OUT_M, machine_h, 0.175)
    x = -(length - machine_l) / 2 + 0.025
    case_l = length - machine_l - 0.05
    case_x = (length - case_l) / 2
    y, base = -width / 2 + HANDLE_M + FRONT_M, 0.08
    depth = width / 2 - y
    case = block((case_l, depth, height - base)).moved(case_x, y + depth / 2, base)
    upper_z = 2 * machine_h + 0.05
    upper = block((machine_l + 0.028, depth, height - upper_z - 0.001))
    upper = upper.moved(x + 0.011, y + depth / 2, upper_z)
    cheek = block((0.02, width - 0.06, height)).moved(-(length - 0.02) / 2, 0.03)
    columns = 2 if case_l > 0.55 else 1
    face = [
        *shifted(cells(case_l, height - base - 0.004, columns, (1.2, 1.0), base + 0.002), case_x),
        *shifted(cells(machine_l + 0.03, height - upper_z - 0.004, 2, z_m=upper_z + 0.002), x),
    ]
    base_part = plinth((case_l, width, height), base, inset_m=0.09)
    return (
        *placed(machine("Washer_"), (x, _DOOR_OUT_M / 2, 0.0)),
        *placed(machine("Dryer_"), (x, _DOOR_OUT_M / 2, machine_h + 0.012)),
        Part("Plinth", base_part.solid.moved(x=case_x), "plinth"),
        hollow_part("Tall_Body", case),
        hollow_part("Upper_Body", upper),
        Part("Cheek", cheek, "body"),
        *kitchen_fronts(face, y, form),
    )
