"""Kitchen floor cabinets that line up into a run, and the refrigerator.

All base cabinets share one height, plinth and worktop, so that a row of them reads as one kitchen.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from chord_usd.assets.furniture.joinery import (
    FRONT_M,
    HANDLE_M,
    bar_handle,
    cells,
    doors,
    drawers,
    plinth,
)
from chord_usd.assets.model import Draw, Part, Style, editions, steps
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
    ring,
    tube,
)

PLINTH_M = 0.1
WORKTOP_M = 0.038
HEIGHT_M = 0.87

_WALL_UNIT_M = 0.35
"""Depth of a wall unit, its door included."""

_WALL_UNIT_Z_M = 1.42
_WALL_UNIT_HEIGHT_M = 0.7


def _face_y(width: float) -> float:
    return -width / 2 + HANDLE_M + FRONT_M


def _body(size_m: Size) -> tuple[Part, ...]:
    """Plinth and carcass of a base cabinet."""
    length, width, height = size_m
    y = _face_y(width)
    depth = width / 2 - y
    tall = height - PLINTH_M - WORKTOP_M + 0.001
    case = block((length, depth, tall), 0.002).moved(y=y + depth / 2, z=PLINTH_M)
    return plinth(size_m, PLINTH_M, inset_m=0.09), Part("Body", case, "body")


def _worktop(size_m: Size) -> Part:
    """A plate over the whole footprint, cut straight at both ends so that a run has no joints."""
    length, width, height = size_m
    low, soft, front = height - WORKTOP_M, 0.004, -width / 2
    profile = [
        [-low, front + soft], [-low, width / 2], [-height, width / 2], [-height, front + soft],
        [soft - height, front], [-low - soft, front],
    ]  # fmt: skip
    # Drawn lying with z to the left, then stood up: the plate's axis becomes the length.
    plate = extruded(profile, length).turned("y", 90).moved(x=-length / 2)
    return Part("Worktop", plate, "worktop")


def _wall_unit(size_m: Size) -> tuple[Part, ...]:
    """A cabinet on the wall over a base cabinet, and the splashback below it."""
    length, width, height = size_m
    depth = _WALL_UNIT_M - FRONT_M
    back = width / 2
    y = back - depth
    case = block((length, depth - 0.001, _WALL_UNIT_HEIGHT_M), 0.002)
    columns = max(1, round(length / 0.48))
    face = list(cells(length, _WALL_UNIT_HEIGHT_M - 0.004, columns, z_m=_WALL_UNIT_Z_M + 0.002))
    light = block((length - 0.06, 0.03, 0.012)).moved(y=back - 0.06, z=_WALL_UNIT_Z_M - 0.011)
    body = case.moved(y=back - (depth - 0.001) / 2, z=_WALL_UNIT_Z_M)
    parts = (
        Part("Wall_Unit", body, "body"),
        *(replace(part, name=f"Wall_Unit_{part.name}") for part in doors(face, y, "bar", low=True)),
        Part("Wall_Unit_Light", light, "glow", collider=None),
        _splashback(length, back, height, _WALL_UNIT_Z_M),
    )
    return tuple(replace(part, on_wall=True) for part in parts)


def _splashback(length: float, back: float, low: float, high: float) -> Part:
    panel = box((length, 0.008, high - low)).moved(y=back - 0.0045, z=low)
    return Part("Splashback", panel, "splash", collider=None)


def _hood(size_m: Size) -> tuple[Part, ...]:
    """An extractor over a hob: a sloping canopy and its chimney."""
    length, width, height = size_m
    back, wide = width / 2, min(length, 0.6)
    top = _WALL_UNIT_Z_M + _WALL_UNIT_HEIGHT_M
    low, deep = _WALL_UNIT_Z_M + 0.06, 0.46
    levels = ((wide, deep, 0.0), (wide, deep, 0.045), (0.3, 0.26, 0.21), (0.3, 0.26, 0.24))
    rings = [
        ring(long, far, 0.004, low + rise, 1) + np.array([0.0, back - far / 2 - 0.001, 0.0])
        for long, far, rise in levels
    ]
    chimney = block((0.27, 0.23, top - low - 0.22)).moved(y=back - 0.117, z=low + 0.22)
    keys = box((0.12, 0.004, 0.018)).moved(y=back - deep - 0.0015, z=low + 0.014)
    parts = (
        Part("Hood", loft(rings), "appliance"),
        Part("Hood_Chimney", chimney, "appliance"),
        Part("Hood_Keys", keys, "dark_glass", collider=None),
        _splashback(length, back, height, low),
    )
    return tuple(replace(part, on_wall=True) for part in parts)


def _fronts_height(size_m: Size) -> float:
    return size_m[2] - PLINTH_M - WORKTOP_M - 0.004


def door_cabinet(size_m: Size, *, columns: int = 1, has_drawers: bool = True) -> tuple[Part, ...]:
    """A base cabinet: a drawer over each door, or doors only."""
    length, width, _ = size_m
    y, tall = _face_y(width), _fronts_height(size_m)
    rows = (4.2, 1.0) if has_drawers else (1.0,)
    face = list(cells(length, tall, columns, rows, PLINTH_M + 0.002))
    upper = [cell for cell in face if cell.row == 1]
    return (
        *_body(size_m),
        *doors([cell for cell in face if cell.row == 0], y, "bar"),
        *(drawers(upper, y, "bar") if upper else ()),
        _worktop(size_m),
        *_wall_unit(size_m),
    )


def drawer_cabinet(size_m: Size) -> tuple[Part, ...]:
    """A base cabinet of three deep drawers."""
    length, width, _ = size_m
    face = list(cells(length, _fronts_height(size_m), 1, (2, 2, 1), PLINTH_M + 0.002))
    return (
        *_body(size_m), *drawers(face, _face_y(width), "bar"), _worktop(size_m),
        *_wall_unit(size_m),
    )  # fmt: skip


def cooker_cabinet(size_m: Size, *, gas: bool = True) -> tuple[Part, ...]:
    """A cabinet with a hob in its worktop and, gas or electric, an oven below."""
    length, width, height = size_m
    y, tall = _face_y(width), _fronts_height(size_m)
    oven_length = min(0.6, length) - 0.006
    oven = _oven(oven_length, tall - 0.004, y, PLINTH_M + 0.004)
    side = (length - oven_length) / 2
    parts = [
        *_body(size_m), *oven, _worktop(size_m), *_hob(length, width, height, gas=gas),
        *_hood(size_m),
    ]  # fmt: skip
    if side > 0.1:
        fillers = [
            block((side - 0.006, FRONT_M, tall - 0.004)).moved(
                sign * (length - side) / 2, y - FRONT_M / 2, PLINTH_M + 0.004
            )
            for sign in (-1, 1)
        ]
        parts.append(Part("Side_Fronts", joined(fillers), "front"))
    return tuple(parts)  # fmt: skip


def _oven(length: float, height: float, y: float, z: float) -> tuple[Part, ...]:
    """A built-in oven front: a dark door with a window and rail, a panel with knobs above."""
    panel_h = 0.11
    door_h = height - panel_h - 0.004
    door = block((length, FRONT_M, door_h), 0.003).moved(y=y - FRONT_M / 2, z=z)
    panel = block((length, FRONT_M, panel_h), 0.003)
    panel = panel.moved(y=y - FRONT_M / 2, z=z + door_h + 0.004)
    pane = box((length * 0.74, 0.003, door_h * 0.5))
    pane = pane.moved(y=y - FRONT_M - 0.0005, z=z + door_h * 0.22)
    rail = bar_handle(length * 0.8, upright=False).moved(y=y - FRONT_M, z=z + door_h - 0.06)
    knob_z = z + door_h + 0.004 + panel_h / 2
    dial = cylinder(0.02, 0.022, 0.004, 16).turned("x", 90)
    dials = joined([dial.moved(length * share, y - FRONT_M, knob_z) for share in (-0.36, 0.36)])
    clock = box((length * 0.26, 0.003, 0.04)).moved(y=y - FRONT_M - 0.0005, z=knob_z - 0.02)
    return (
        Part("Oven_Door", door, "appliance"),
        Part("Oven_Panel", panel, "appliance"),
        Part("Oven_Window", pane + clock, "dark_glass", collider=None),
        Part("Oven_Rail", rail + dials, "handle", collider=None),
    )


def _hob(length: float, width: float, height: float, *, gas: bool) -> tuple[Part, ...]:
    """Four burners on a glass plate let into the worktop; kept a hair's breadth above it."""
    long, deep = min(0.58, length - 0.06), min(0.5, width - 0.08)
    plate = block((long, deep, 0.012), 0.003).moved(z=height - 0.006)
    spots = [(sx * long * 0.25, sy * deep * 0.24 + 0.03) for sx in (-1, 1) for sy in (-1, 1)]
    sizes = (0.075, 0.095, 0.09, 0.065)
    parts = [Part("Hob", plate, "dark_glass", collider=None, above=True)]
    if not gas:
        rings = [
            lathe([(r, 0), (r, 0.0015), (r - 0.006, 0.0015), (r - 0.006, 0)], 32, loop=True).moved(
                x, y, height + 0.0055
            )
            for (x, y), r in zip(spots, sizes, strict=True)
        ]
        parts.append(Part("Rings", joined(rings), "glow", collider=None, above=True))
        return tuple(parts)
    burners, grates = [], []
    for (x, y), radius in zip(spots, sizes, strict=True):
        cap = [(radius * 0.55, 0), (radius * 0.55, 0.012), (radius * 0.4, 0.018), (0, 0.018)]
        burners.append(lathe(cap, 20).moved(x, y, height + 0.005))
        for turn in (0, 90):
            bar = block((0.2, 0.01, 0.012)).turned("z", turn)
            grates.append(bar.moved(x, y, height + 0.03 + turn * 1e-5))
        for sx in (-1, 1):
            for sy in (-1, 1):
                foot = block((0.01, 0.01, 0.026)).turned("z", 45)
                at = (0.09 * sx, 0.0) if sx == sy else (0.0, 0.09 * sy)
                grates.append(foot.moved(x + at[0], y + at[1], height + 0.005))
    dials = [
        cylinder(0.017, 0.02, 0.004, 14).moved((i - 1.5) * 0.07, -deep / 2 + 0.035, height + 0.005)
        for i in range(4)
    ]
    return (
        *parts,
        Part("Burners", joined(burners), "burner", collider=None, above=True),
        Part("Grates", joined(grates), "grate", collider=None, above=True),
        Part("Hob_Dials", joined(dials), "handle", collider=None, above=True),
    )


def sink_cabinet(size_m: Size, *, has_drainer: bool = False) -> tuple[Part, ...]:
    """A two-door cabinet with a hollow bowl in its worktop and a swan-neck tap behind it."""
    length, width, height = size_m
    y, tall = _face_y(width), _fronts_height(size_m)
    bowl_l = min(0.52, length - 0.12) if not has_drainer else length * 0.46
    bowl_w = min(0.4, width - 0.17)
    x = 0.0 if not has_drainer else -length / 2 + bowl_l / 2 + 0.07
    at_y = -0.03
    hole = ring(bowl_l, bowl_w, 0.06, 0.0, 5)[:, :2] + [x, at_y]
    outline = ring(length, width, 0.0, 0.0, 0)[:, :2]
    plate = extruded(outline, WORKTOP_M, [hole]).moved(z=height - WORKTOP_M)
    columns = 2 if length >= 0.55 else 1
    face = list(cells(length, tall, columns, z_m=PLINTH_M + 0.002))
    parts = [
        *_sink_body(size_m),
        *doors(face, y, "bar"),
        Part("Worktop", plate, "worktop", collider="none"),
        *_wall_unit(size_m),
        Part("Bowl", sink_bowl(bowl_l, bowl_w, 0.17).moved(x, at_y, height), "steel", collider=None,
             above=True),
        Part("Tap", swan_neck().moved(x, at_y + bowl_w / 2 + 0.045, height - 0.002), "tap",
             collider=None, above=True),
    ]  # fmt: skip
    if has_drainer:
        ribs = [
            block((length - bowl_l - 0.2, 0.008, 0.004), 0.001).moved(
                length / 2 - (length - bowl_l - 0.2) / 2 - 0.06, at_y + 0.05 * i, height - 0.001
            )
            for i in range(-3, 4)
        ]
        parts.append(Part("Drainer", joined(ribs), "steel", collider=None, above=True))
    return tuple(parts)


def _sink_body(size_m: Size) -> tuple[Part, ...]:
    """A carcass that leaves room for the bowl: low box, two cheeks and a back."""
    length, width, height = size_m
    y = _face_y(width)
    depth = width / 2 - y
    tall = height - PLINTH_M - WORKTOP_M + 0.001
    low = block((length, depth, tall - 0.2), 0.002).moved(y=y + depth / 2, z=PLINTH_M)
    z = PLINTH_M + tall - 0.201
    cheeks = [
        box((0.02, depth - 0.002, 0.201)).moved(s * (length - 0.022) / 2, y + depth / 2, z)
        for s in (-1, 1)
    ]
    walls = [
        box((length - 0.03, 0.016, 0.199)).moved(y=at, z=z + 0.001)
        for at in (y + 0.01, width / 2 - 0.01)
    ]
    shell = joined([*cheeks, *walls])
    return (
        plinth(size_m, PLINTH_M, inset_m=0.09),
        Part("Body", low, "body"),
        Part("Upper_Body", shell, "body", collider=None),
    )


def sink_bowl(length: float, width: float, deep: float) -> Solid:
    """A pressed steel bowl hanging from z = 0, with a rim that laps over the worktop."""
    rim, wall = 0.012, 0.002
    outline = [
        (wall, 0.055, 0.0), (wall, 0.055, -deep), (0.0, 0.055, -deep), (0.0, 0.055, 0.0),
        (-rim, 0.065, 0.001), (-rim, 0.065, 0.003), (0.003, 0.055, 0.003),
        (0.012, 0.05, -deep + 0.025), (0.03, 0.045, -deep + 0.008), (0.1, 0.03, -deep + 0.004),
    ]  # fmt: skip
    del outline[1:3]
    outline.insert(0, (0.03, 0.045, -deep))
    outline.insert(1, (0.006, 0.05, -deep + 0.02))
    rings = [ring(length - 2 * i, width - 2 * i, corner, z, 5) for i, corner, z in outline]
    drain = lathe([(0.03, 0), (0.03, 0.004), (0.022, 0.004), (0.018, 0.001), (0, 0.001)], 20)
    return loft(rings) + drain.moved(z=-deep + 0.0036)


def swan_neck() -> Solid:
    """A mixer tap: foot, bent neck reaching 0.17 m to the front, lever."""
    neck = bent_path([[0, 0, 0.03], [0, 0, 0.28], [0, -0.17, 0.28], [0, -0.17, 0.2]], 0.085, 6)
    foot = lathe([(0.026, 0), (0.026, 0.006), (0.02, 0.012), (0.018, 0.05), (0, 0.05)], 20)
    lever = tube([[0.015, 0, 0.05], [0.075, 0, 0.085]], 0.006, 8)
    return foot + tube(neck, 0.011, 12) + lever


def electrical_cabinet(size_m: Size) -> tuple[Part, ...]:
    """A cabinet for built-in appliances: an oven low down; tall ones add a microwave above."""
    length, width, height = size_m
    y = _face_y(width)
    if height < 1.2:
        tall = _fronts_height(size_m)
        oven = _oven(length - 0.008, 0.58, y, PLINTH_M + 0.004 + tall - 0.586)
        low = list(cells(length, tall - 0.586, 1, z_m=PLINTH_M + 0.002))
        return (*_body(size_m), *drawers(low, y, "bar"), *oven, _worktop(size_m),
                *_wall_unit(size_m))  # fmt: skip
    depth = width / 2 - y
    case = block((length, depth, height - PLINTH_M), 0.003).moved(y=y + depth / 2, z=PLINTH_M)
    oven_z = 0.62
    micro_z = oven_z + 0.6
    top_z = micro_z + 0.4
    face_low = list(cells(length, oven_z - PLINTH_M - 0.004, 1, (1, 1), PLINTH_M + 0.002))
    face_high = list(cells(length, height - top_z - 0.004, 1, z_m=top_z))
    return (
        plinth(size_m, PLINTH_M, inset_m=0.09),
        Part("Body", case, "body"),
        *drawers(face_low, y, "bar"),
        *_oven(length - 0.008, 0.592, y, oven_z),
        *_microwave(length - 0.008, 0.385, y, micro_z + 0.002),
        *doors(face_high, y, "bar", low=True),
    )


def _microwave(length: float, height: float, y: float, z: float) -> tuple[Part, ...]:
    case = block((length, FRONT_M, height), 0.003).moved(y=y - FRONT_M / 2, z=z)
    wide = length * 0.7
    pane = box((wide, 0.003, height * 0.66))
    pane = pane.moved(-(length - wide) / 2 + 0.03, y - FRONT_M - 0.0005, z + height * 0.17)
    keys = [
        cylinder(0.014, 0.01, 0.002, 12).turned("x", 90).moved(
            length / 2 - 0.07, y - FRONT_M, z + height * share
        )
        for share in (0.25, 0.45, 0.65)
    ]  # fmt: skip
    rail = bar_handle(height * 0.6, upright=True)
    rail = rail.moved(length / 2 - 0.13, y - FRONT_M, z + height / 2)
    return (
        Part("Microwave", case, "appliance"),
        Part("Microwave_Window", pane, "dark_glass", collider=None),
        Part("Microwave_Keys", joined(keys) + rail, "handle", collider=None),
    )


def refrigerator(size_m: Size, *, doors_across: int = 1) -> tuple[Part, ...]:
    """A fridge: freezer drawer below, or two tall doors with a water dispenser."""
    length, width, height = size_m
    out = 0.045
    y, door = -width / 2 + out, 0.055
    base = 0.04
    depth = width - out - door
    case = block((length - 0.008, depth, height - base - 0.006), 0.006)
    case = case.moved(y=width / 2 - depth / 2, z=base)
    feet = block((length - 0.06, depth - 0.06, base + 0.002)).moved(y=width / 2 - depth / 2)
    rows = (0.62, 1.0) if doors_across == 1 else (1.0,)
    face = list(cells(length + 0.002, height - base, doors_across, rows, base))
    leaves = [
        block((c.length_m, door, c.height_m), 0.012).moved(c.x_m, y + door / 2, c.z_m) for c in face
    ]
    grips = []
    for cell in face:
        sign = 1.0 if cell.column == 0 else -1.0
        reach = min(0.5, cell.height_m * 0.5)
        z = cell.z_m + (cell.height_m - reach / 2 - 0.06 if cell.row == 0 else reach / 2 + 0.06)
        z = z if doors_across == 1 else cell.z_m + cell.height_m * 0.52
        x = cell.x_m + sign * (cell.length_m / 2 - 0.045)
        stand = bent_path(
            [[0, 0.004, -reach / 2], [0, -out + 0.009, -reach / 2],
             [0, -out + 0.009, reach / 2], [0, 0.004, reach / 2]], 0.02, 2)  # fmt: skip
        grips.append(tube(stand, 0.009, 8).moved(x, y, z))
    parts = [
        Part("Feet", feet, "plinth"),
        Part("Body", case, "body"),
        Part("Doors", joined(leaves), "front"),
        Part("Door_Handles", joined(grips), "handle", collider=None),
    ]
    if doors_across == 2:
        panel = block((0.2, 0.006, 0.34), 0.004).moved(face[0].x_m - 0.02, y - 0.001, 1.0)
        parts.append(Part("Dispenser", panel, "dark_glass", collider=None))
    else:
        badge = block((0.07, 0.006, 0.035)).moved(face[-1].x_m, y - 0.001, height - 0.12)
        parts.append(Part("Display", badge, "dark_glass", collider=None))
    return tuple(parts)


def _kitchen(
    body: str, front: str, worktop: str, handle: str, appliance: str, splash: str
) -> dict[str, str]:
    return {
        "body": body, "front": front, "worktop": worktop, "handle": handle,
        "appliance": appliance, "plinth": "graphite", "steel": "steel", "tap": "chrome",
        "dark_glass": "black_glass", "burner": "graphite", "grate": "black_metal",
        "glow": "light_grey", "splash": splash,
    }  # fmt: skip


# The same three names on every cabinet, so that one choice dresses a whole kitchen.
LOOKS = {
    "white": _kitchen("white", "white", "oak", "steel", "steel", "ceramic"),
    "graphite": _kitchen("graphite", "graphite", "quartz", "black_metal", "black", "quartz"),
    "sage": _kitchen("sage", "sage", "marble", "brass", "black", "marble"),
}
_FRIDGE = {
    "white": {"body": "white", "front": "white", "handle": "steel", "plinth": "graphite",
              "dark_glass": "black_glass"},
    "graphite": {"body": "graphite", "front": "graphite", "handle": "black_metal",
                 "plinth": "black", "dark_glass": "black_glass"},
    "steel": {"body": "grey", "front": "steel", "handle": "chrome", "plinth": "graphite",
              "dark_glass": "black_glass"},
}  # fmt: skip


def _base(name: str, draw: Draw) -> Style:
    return Style(f"Kitchen_{name}", draw, LOOKS, HEIGHT_M)


_DOOR, _DOOR_PLAIN = (
    _base("Door", door_cabinet),
    _base("Door_Plain", partial(door_cabinet, has_drawers=False)),
)
_DOUBLE = (
    _base("Doors", partial(door_cabinet, columns=2)),
    _base("Drawers", drawer_cabinet),
    _base("Doors_Plain", partial(door_cabinet, columns=2, has_drawers=False)),
)
_COOKERS = (
    _base("Cooker_Gas", cooker_cabinet),
    _base("Cooker_Glass", partial(cooker_cabinet, gas=False)),
)
_SINK = _base("Sink", sink_cabinet)
_SINK_DRAINER = _base("Sink_Drainer", partial(sink_cabinet, has_drainer=True))
_OVEN_LOW = _base("Oven_Low", electrical_cabinet)
_OVEN_TALL = Style("Kitchen_Oven_Tall", electrical_cabinet, LOOKS, 2.1)
_FRIDGE_ONE = Style("Refrigerator", refrigerator, _FRIDGE, 1.85)
_FRIDGE_TWO = Style("Refrigerator_Double", partial(refrigerator, doors_across=2), _FRIDGE, 1.8)

_DEPTHS_M = (0.51, 0.555, 0.6)
DESIGNS = (
    *editions("single_door_floor_cabinet", (_DOOR, _DOOR_PLAIN), steps(0.3, 0.55, 0.05), _DEPTHS_M),
    *editions("double_door_floor_cabinet", _DOUBLE, steps(0.6, 1.1, 0.05), _DEPTHS_M),
    *editions("cooker_cabinet", _COOKERS, steps(0.61, 0.94, 0.055), _DEPTHS_M),
    *editions("sink_cabinet", (_SINK,), steps(0.6, 0.85, 0.05), _DEPTHS_M),
    *editions("sink_cabinet", (_SINK_DRAINER, _SINK), steps(0.9, 1.1, 0.05), _DEPTHS_M),
    *editions("electrical_floor_cabinet", (_OVEN_LOW, _OVEN_TALL), (0.6, 0.66), _DEPTHS_M),
    *editions("refrigerator", (_FRIDGE_ONE,), (0.58, 0.64, 0.7), (0.6, 0.66, 0.72)),
    *editions("refrigerator", (_FRIDGE_TWO,), (0.91,), (0.66, 0.74)),
)
