"""Ovens, hobs, microwaves and refrigerators, as they are built into a kitchen."""

from __future__ import annotations

from typing import Literal

from chord_usd.library.kit.joinery import FRONT_M, cells, hung
from chord_usd.library.kit.model import Part, hollow_part, moving_part, partly_moving
from chord_usd.library.kit.moves import Leaf, door, flap
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    bent_path,
    block,
    box,
    cylinder,
    joined,
    lathe,
    loft,
    ring,
    tube,
)
from chord_usd.library.kitchen.kitchen_fronts import pull_bar

FridgeKind = Literal["single", "double", "retro"]
_PANEL_M = 0.1
_CAVITY_M = 0.4
"""Depth of an oven inside."""

_OVEN_DEG, _MICROWAVE_DEG, _FRIDGE_DEG = 85.0, 90.0, 105.0


def dial(radius: float = 0.02) -> tuple[Solid, Solid]:
    """A control that is turned, its foot in the plane y = 0, and the mark on it."""
    skirt = lathe(
        [
            (radius, 0),
            (radius, 0.003),
            (radius * 0.82, 0.005),
            (radius * 0.78, 0.022),
            (radius * 0.68, 0.0245),
            (0, 0.0245),
        ],
        22,
    )
    mark = box((0.0018, 0.003, radius * 0.62)).moved(y=-0.0242, z=radius * 0.08)
    return skirt.turned("x", 90), mark


def oven(length: float, height: float, y: float, z: float) -> tuple[Part, ...]:
    """A built-in oven: a door of dark glass in a frame, a rail, a panel with dials and a clock."""
    door_h = height - _PANEL_M - 0.004
    frame = block((length, FRONT_M, door_h), 0.002).moved(y=y - FRONT_M / 2, z=z)
    panel_z = z + door_h + 0.004
    panel = block((length, FRONT_M, _PANEL_M), 0.002).moved(y=y - FRONT_M / 2, z=panel_z)
    face = y - FRONT_M
    glass = block((length - 0.016, 0.005, door_h - 0.105), 0.0015)
    glass = glass.moved(y=face - 0.0015, z=z + 0.022)
    clock = block((length * 0.27, 0.004, 0.042), 0.001).moved(y=face - 0.001, z=panel_z + 0.03)
    skirt, mark = dial()
    knob_z = panel_z + _PANEL_M / 2
    places = [length * share for share in (-0.38, -0.25, 0.25, 0.38)]
    rail = pull_bar(length * 0.84).moved(y=face, z=z + door_h - 0.042)
    figures = [
        box((0.007, 0.001, 0.015)).moved(0.012 * n, face - 0.0033, panel_z + 0.043)
        for n in (-2, -1, 1, 2)
    ]
    leaf = flap(frame, opens_deg=_OVEN_DEG, inside="nothing")
    dials = joined([skirt.moved(x, face + 0.001, knob_z) for x in places])
    return (
        moving_part("Oven_Door", [frame], "appliance", [leaf]),
        Part("Oven_Cavity", _cavity(length, door_h, y, z), "dark_glass", collider=None),
        Part("Oven_Racks", _racks(length, door_h, y, z), "handle", collider=None),
        Part("Oven_Panel", panel, "appliance"),
        partly_moving("Oven_Window", glass, leaf, clock, "dark_glass"),
        partly_moving("Oven_Rail", rail, leaf, dials, "handle"),
        Part(
            "Oven_Marks",
            joined([mark.moved(x, face, knob_z) for x in places] + figures),
            "mark",
            collider=None,
        ),
    )


def _cavity(length: float, height: float, y: float, z: float) -> Solid:
    """The lining behind an oven's door: seen where it opens, else within the closed body."""
    wide, deep, tall = length - 0.07, _CAVITY_M, height - 0.09
    wall, radius = 0.008, 0.012
    tray = loft([
        ring(wide, tall, radius, 0.0, 3),
        ring(wide, tall, radius, deep, 3),
        ring(wide - 2 * wall, tall - 2 * wall, radius, deep, 3),
        ring(wide - 2 * wall, tall - 2 * wall, radius, wall, 3),
    ])  # fmt: skip
    return tray.turned("x", 90).moved(y=y + 0.004 + deep, z=z + 0.04 + tall / 2)


def _racks(length: float, height: float, y: float, z: float) -> Solid:
    """Two wire racks: rods from front to back on two across."""
    wide, deep, tall = length - 0.09, _CAVITY_M - 0.03, height - 0.09
    across = box((wide, 0.005, 0.005))
    along = box((0.004, deep, 0.004))
    middle_y = y + 0.008 + deep / 2
    rods = [across.moved(y=middle_y + s * (deep / 2 - 0.01)) for s in (-1, 1)]
    count = 11
    rods += [
        along.moved(wide * (n / (count - 1) - 0.5) * 0.96, middle_y, 0.005) for n in range(count)
    ]
    rack = joined(rods)
    return joined([rack.moved(z=z + 0.04 + tall * share) for share in (0.33, 0.66)])


def microwave(length: float, height: float, y: float, z: float) -> tuple[Part, ...]:
    """A built-in microwave: a wide dark window, keys and a display at the right."""
    case = block((length, FRONT_M, height), 0.002).moved(y=y - FRONT_M / 2, z=z)
    face = y - FRONT_M
    wide = length * 0.74
    pane = block((wide, 0.005, height - 0.05), 0.0015)
    pane = pane.moved(-(length - wide) / 2 + 0.022, face - 0.0015, z + 0.025)
    side = (length - wide) - 0.06
    x = length / 2 - 0.02 - side / 2
    display = block((side, 0.004, 0.04), 0.001).moved(x, face - 0.001, z + height - 0.075)
    keys = [
        block((side / 3 - 0.006, 0.004, 0.018), 0.001).moved(
            x + side / 3 * column, face - 0.001, z + 0.115 + 0.026 * row
        )
        for column in (-1, 0, 1)
        for row in range(4)
    ]
    skirt, mark = dial(0.022)
    rail = pull_bar(height * 0.7).turned("y", 90).moved(x - side / 2 - 0.022, face, z + height / 2)
    leaf = door(case, hung="left", opens_deg=_MICROWAVE_DEG, inside="nothing")
    grips = joined([*keys, rail, skirt.moved(x, face + 0.001, z + 0.065)])
    mark = mark.moved(x, face, z + 0.065)
    return (
        moving_part("Microwave", [case], "appliance", [leaf]),
        Part("Microwave_Cavity", _cavity(length, height, y, z), "appliance", collider=None),
        moving_part("Microwave_Window", [pane + display], "dark_glass", [leaf], None),
        moving_part("Microwave_Keys", [grips], "handle", [leaf], None),
        moving_part("Microwave_Mark", [mark], "mark", [leaf], None),
    )


def hob(length: float, width: float, height: float, *, gas: bool) -> tuple[Part, ...]:
    """Four burners or four glowing rings on a plate in the worktop, a hair's breadth above it."""
    long, deep = min(0.58, length - 0.06), min(0.5, width - 0.08)
    plate = block((long, deep, 0.012), 0.002).moved(z=height - 0.0065)
    parts = [Part("Hob", plate, "appliance" if gas else "dark_glass", above=True)]
    top = height + 0.0055
    make = _gas_burners if gas else _glass_marks
    return (*parts, *make(long, deep, top))


def _glass_marks(long: float, deep: float, top: float) -> tuple[Part, ...]:
    marks = []
    for (sx, sy), radius in zip(
        ((-1, 1), (1, 1), (-1, -1), (1, -1)), (0.088, 0.1, 0.1, 0.075), strict=True
    ):
        x, y = sx * long * 0.245, sy * deep * 0.225 + 0.025
        for size in (radius, radius * 0.62):
            line = [(size, 0), (size, 0.0006), (size - 0.0016, 0.0006), (size - 0.0016, 0)]
            marks.append(lathe(line, 36, loop=True).moved(x, y, top - 0.0002))
    for n in range(-4, 5):
        marks.append(
            cylinder(0.004 if n % 2 else 0.0022, 0.0006, 0.0, 12).moved(
                0.028 * n, -deep / 2 + 0.028, top - 0.0002
            )
        )
    return (Part("Hob_Marks", joined(marks), "mark", collider=None, above=True),)


def _gas_burners(long: float, deep: float, top: float) -> tuple[Part, ...]:
    burners, grates = [], []
    y_mid = 0.02
    for sx in (-1, 1):
        for sy, radius in ((1, 0.045 if sx > 0 else 0.036), (-1, 0.036 if sx > 0 else 0.052)):
            x, y = sx * long * 0.25, y_mid + sy * deep * 0.215
            base = lathe(
                [
                    (radius * 1.25, 0),
                    (radius * 1.2, 0.005),
                    (radius * 0.95, 0.009),
                    (radius * 0.95, 0.016),
                    (0, 0.016),
                ],
                24,
            )
            cap = lathe(
                [(radius, 0.0165), (radius * 1.02, 0.019), (radius * 0.9, 0.024), (0, 0.0255)], 24
            )
            burners.append((base + cap).moved(x, y, top - 0.0005))
            grates += _fingers(x, y, radius, top + 0.032, long * 0.235, deep * 0.2)
        grates += _grate_frame(sx * long * 0.25, y_mid, long * 0.47, deep * 0.84, top)
    knobs = [
        cylinder(0.017, 0.022, 0.004, 18).moved((n - 1.5) * 0.062, -deep / 2 + 0.03, top - 0.0005)
        for n in range(4)
    ]
    return (
        Part("Burners", joined(burners), "burner", collider=None, above=True),
        Part("Grates", joined(grates), "grate", above=True),
        Part("Hob_Dials", joined(knobs), "handle", collider=None, above=True),
    )


def _fingers(
    x: float, y: float, radius: float, z: float, half_x: float, half_y: float
) -> list[Solid]:
    """Four bars towards a burner, from the frame of its grate."""
    inner = radius * 0.45
    bars = []
    for sign in (-1, 1):
        for half, turn in ((half_x, 0.0), (half_y, 90.0)):
            bar = (
                block((half - inner, 0.009, 0.012), 0.002)
                .moved(sign * (half + inner) / 2)
                .turned("z", turn)
            )
            bars.append(bar.moved(x, y, z + 1e-4 * (turn > 0)))
    return bars


def _grate_frame(x: float, y: float, long: float, deep: float, top: float) -> list[Solid]:
    """A rectangle of cast bars on four feet, with a bar across its middle."""
    z, thick = top + 0.0315, 0.0095
    lying = block((long, thick, 0.0125), 0.002)
    upright = block((thick, deep - thick, 0.0122), 0.002)
    pieces = [lying.moved(x, y + at, z) for at in (-deep / 2, 0.0, deep / 2)]
    pieces += [
        upright.moved(x + at, y, z + 0.0001) for at in (-long / 2 + thick / 2, long / 2 - thick / 2)
    ]
    foot = block((thick, thick, 0.034), 0.001)
    pieces += [
        foot.moved(x + sx * (long / 2 - 0.02), y + sy * (deep / 2 - 0.0002), top - 0.001)
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    return pieces


def refrigerator(size_m: Size, *, kind: FridgeKind = "single") -> tuple[Part, ...]:
    """A fridge: freezer below, two tall doors with a dispenser, or a rounded one of the fifties."""
    if kind == "retro":
        return _retro_fridge(size_m)
    length, width, height = size_m
    out, thick, base, seal = 0.045, 0.06, 0.045, 0.008
    y = -width / 2 + out
    depth = width - out - thick - seal
    case = block((length, depth, height - base), 0.008).moved(y=width / 2 - depth / 2, z=base)
    feet = block((length - 0.04, depth - 0.04, base + 0.002)).moved(y=width / 2 - depth / 2)
    rows = (0.62, 1.0) if kind == "single" else (0.5, 1.0)
    face = list(cells(length + 0.002, height - base, 1 if kind == "single" else 2, rows, base))
    leaves = [
        block((c.length_m, thick, c.height_m), 0.008).moved(c.x_m, y + thick / 2, c.z_m)
        for c in face
    ]
    seals = [
        box((c.length_m - 0.03, seal + 0.004, c.height_m - 0.03)).moved(
            c.x_m, y + thick + seal / 2, c.z_m + 0.015
        )
        for c in face
    ]
    swings = [
        door(leaf, hung=hung(c), opens_deg=_FRIDGE_DEG)
        for c, leaf in zip(face, leaves, strict=True)
    ]
    grips = [
        _fridge_grip(c.x_m, c.z_m, c.length_m, c.height_m, c.row, c.column, y, out) for c in face
    ]
    parts = [
        Part("Feet", feet, "plinth"),
        hollow_part("Body", case),
        moving_part("Doors", leaves, "front", swings),
        moving_part("Seals", seals, "seal", swings, None),
        moving_part("Door_Handles", grips, "handle", swings, None),
    ]
    if kind == "double":
        at = next(i for i, c in enumerate(face) if c.row == 1 and c.column == 0)
        parts += _dispenser(face[at].x_m - 0.03, y, face[at].z_m + 0.12, swings[at])
    else:
        top = face[-1]
        plate = block((0.09, 0.004, 0.026), 0.001).moved(
            top.x_m, y - 0.0012, top.z_m + top.height_m - 0.09
        )
        parts.append(moving_part("Display", [plate], "dark_glass", swings[-1:], None))
    return tuple(parts)


def _fridge_grip(
    x: float, z: float, long: float, tall: float, row: int, column: int, y: float, out: float
) -> Solid:
    """A straight bar on two feet, near the edge that opens."""
    sign = 1.0 if column == 0 else -1.0
    reach = min(0.62, tall * 0.62)
    middle = z + tall - reach / 2 - 0.05 if row == 0 else z + reach / 2 + 0.05
    bar = cylinder(0.0095, reach, 0.003, 14).moved(y=-out + 0.0095, z=-reach / 2)
    feet = [
        block((0.012, out - 0.008, 0.022), 0.002).moved(y=-(out - 0.008) / 2 + 0.002, z=at - 0.011)
        for at in (-reach / 2 + 0.05, reach / 2 - 0.05)
    ]
    return joined([bar, *feet]).moved(x + sign * (long / 2 - 0.04), y, middle)


def _dispenser(x: float, y: float, z: float, leaf: Leaf) -> list[Part]:
    """A niche for a glass with its controls over it."""
    wide, tall = 0.19, 0.34
    frame = block((wide, 0.006, tall), 0.002).moved(x, y - 0.002, z)
    lip = block((wide - 0.03, 0.022, 0.008), 0.002).moved(x, y - 0.014, z + 0.012)
    spout = cylinder(0.012, 0.03, 0.002, 14).moved(x, y - 0.014, z + tall - 0.12)
    marks = [
        cylinder(0.006, 0.001, 0.0, 12)
        .turned("x", 90)
        .moved(x + 0.04 * n, y - 0.0048, z + tall - 0.045)
        for n in (-1, 0, 1)
    ]
    return [
        moving_part("Dispenser", [frame], "dark_glass", [leaf], None),
        moving_part("Dispenser_Lip", [lip + spout], "handle", [leaf], None),
        moving_part("Display", [joined(marks)], "mark", [leaf], None),
    ]


def _retro_fridge(size_m: Size) -> tuple[Part, ...]:
    """One door with round edges, a chrome latch and a badge."""
    from chord_usd.library.kit.solids import loft, ring

    length, width, height = size_m
    out, base = 0.03, 0.05
    y = -width / 2 + out
    thick, seal = 0.075, 0.006
    tall = height - base

    def shell(front: float, deep: float, low: float, high: float, bulge: float) -> Solid:
        """An upright rounded plate, drawn lying and stood up."""
        rings = []
        for inset, at in (
            (0.004, 0.0),
            (0.0, 0.006),
            (0.0, deep - bulge),
            (0.012, deep - bulge * 0.35),
            (0.035, deep),
        ):
            rings.append(
                ring(length - 2 * inset, high - low - 2 * inset, 0.075 - inset * 0.5, at, 6)
            )
        return loft(rings).turned("x", 90).moved(0.0, front + deep, (low + high) / 2)

    depth = width - out - thick - seal
    body = shell(width / 2 - depth, depth, base, height, 0.02)
    split = base + tall * 0.3
    lower = shell(y, thick, base + 0.004, split - 0.004, 0.05)
    upper = shell(y, thick, split + 0.004, height - 0.003, 0.05)
    seals = [
        box((length - 0.12, seal + 0.02, high - low - 0.12)).moved(
            y=y + thick + seal / 2, z=low + 0.06
        )
        for low, high in ((base + 0.004, split - 0.004), (split + 0.004, height - 0.003))
    ]
    feet = [
        cylinder(0.022, base + 0.02, 0.002, 14).moved(
            sx * (length / 2 - 0.1), sy * (width / 2 - 0.14) + 0.03
        )
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    grips = []
    for z in (split - 0.11, split + 0.13):
        bow = bent_path(
            [
                [0, 0.004, -0.07],
                [0, -out + 0.008, -0.055],
                [0, -out + 0.008, 0.055],
                [0, 0.004, 0.07],
            ],
            0.02,
            4,
        )
        grips.append(tube(bow, 0.0078, 10).moved(length / 2 - 0.075, y, z))
    badge = block((0.13, 0.004, 0.022), 0.0015).moved(-length * 0.18, y - 0.001, height - 0.2)
    swings = [door(leaf, hung="left", opens_deg=_FRIDGE_DEG) for leaf in (lower, upper)]
    return (
        Part("Feet", joined(feet), "handle", collider=None),
        hollow_part("Body", body),
        moving_part("Doors", [lower, upper], "front", swings),
        moving_part("Seals", seals, "seal", swings, None),
        moving_part("Door_Handles", grips, "handle", swings, None),
        moving_part("Badge", [badge], "handle", swings[1:], None),
    )
