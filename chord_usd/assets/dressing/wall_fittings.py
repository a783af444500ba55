"""Clocks, radiators, switches, sockets; backs at +y."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Literal

import numpy as np

from chord_usd.assets.dressing.dry_finishes import DRY
from chord_usd.assets.dressing.forms import (
    CLASSIC,
    INDUSTRIAL,
    JAPANESE,
    MODERN,
    SCANDINAVIAN,
    hollow,
    lofted,
    outward,
)
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
    ring,
    rounded_slab,
    tube,
)

Draw = Callable[[Size], tuple[Part, ...]]


def _upright(solid: Solid, back_y_m: float, z_m: float) -> Solid:
    """Drawn lying with its face up: stood up with its underside in the plane back_y_m."""
    return solid.turned("x", 90).moved(y=back_y_m, z=z_m)


def _hand(long_m: float, wide_m: float, hour: float, lift_m: float) -> Solid:
    """A hand of a clock that points to this hour, lying, pivot at the origin."""
    tail = long_m * 0.18
    plate = block((wide_m, long_m + tail, 0.0016), 0.0005).moved(y=(long_m - tail) / 2, z=lift_m)
    return plate.turned("z", -30.0 * hour)


def clock(
    size_m: Size, *, marks: Literal["bars", "dots", "numerals"] = "bars", rim_m: float = 0.016
) -> tuple[Part, ...]:
    """A round clock: rim, dial, marks, hands at ten past ten."""
    radius, width, back = size_m[0] / 2, size_m[1], size_m[1] / 2
    hoop = [(radius - 0.002, 0.0), (radius, 0.004), (radius, width - 0.004), (radius - 0.003, width),
            (radius - rim_m + 0.002, width), (radius - rim_m, width - 0.004), (radius - rim_m, 0.0)]  # fmt: skip
    face_z = width * 0.6
    dial = cylinder(radius - rim_m + 0.003, face_z, 0.0, 56)
    inner = radius - rim_m
    pieces = []
    for hour in range(12):
        long = inner * (0.16 if hour % 3 == 0 else 0.09)
        if marks == "dots":
            one = cylinder(inner * (0.035 if hour % 3 == 0 else 0.02), 0.0012, 0.0, 12)
            one = one.moved(y=inner * 0.86)
        elif marks == "numerals":
            strokes = (3, 1, 2, 3, 2, 1, 2, 3, 4, 2, 1, 2)[hour]
            bars = [block((inner * 0.022, inner * 0.2, 0.0012), 0.0003)
                    .moved(inner * 0.05 * (i - (strokes - 1) / 2), inner * 0.8) for i in range(strokes)]  # fmt: skip
            one = joined(bars)
        else:
            one = block((inner * 0.03, long, 0.0012), 0.0003).moved(y=inner * 0.92 - long / 2)
        pieces.append(one.turned("z", -30.0 * hour).moved(z=face_z - 0.0004))
    hands = [_hand(inner * 0.52, inner * 0.05, 10.17, face_z + 0.002),
             _hand(inner * 0.78, inner * 0.035, 2.0, face_z + 0.0045),
             cylinder(inner * 0.045, 0.008, 0.001, 16).moved(z=face_z - 0.0005)]  # fmt: skip
    z = size_m[2] / 2
    return (
        Part("Rim", _upright(outward(lathe(hoop, 56, loop=True)), back, z), "rim", None),
        Part("Dial", _upright(dial, back, z), "dial", None),
        Part("Marks", _upright(joined(pieces), back, z), "mark", None),
        Part("Hands", _upright(joined(hands), back, z), "hand", None),
    )


def open_clock(size_m: Size) -> tuple[Part, ...]:
    """Two iron rings with bars of numerals between them and the wall seen through."""
    radius, width, back = size_m[0] / 2, size_m[1], size_m[1] / 2
    thick = 0.012
    hoops = [hollow([(r, 0.0), (r, thick)], 0.014, 56) for r in (radius, radius * 0.64)]
    bars = []
    for hour in range(12):
        strokes = (3, 1, 2, 3, 2, 1, 2, 3, 4, 2, 1, 2)[hour]
        for i in range(strokes):
            bar = block((0.012, radius * 0.36, 0.008), 0.001)
            bars.append(bar.moved(0.024 * (i - (strokes - 1) / 2), radius * 0.81, 0.002)
                        .turned("z", -30.0 * hour))  # fmt: skip
    spokes = [block((0.008, radius * 0.63, 0.006), 0.001).moved(y=radius * 0.315, z=0.003).turned("z", a)
              for a in (45, 135, 225, 315)]  # fmt: skip
    hub = cylinder(0.04, width - 0.008, 0.003, 28)
    hands = [_hand(radius * 0.38, 0.016, 10.17, width - 0.011), _hand(radius * 0.56, 0.012, 2.0, width - 0.008),
             cylinder(0.012, 0.01, 0.002, 14).moved(z=width - 0.01)]  # fmt: skip
    z = size_m[2] / 2
    return (
        Part("Rings", _upright(joined([*hoops, *spokes]), back, z), "rim", None),
        Part("Marks", _upright(joined(bars), back, z), "rim", None),
        Part("Hub", _upright(hub, back, z), "rim", None),
        Part("Hands", _upright(joined(hands), back, z), "hand", None),
    )


def square_clock(size_m: Size) -> tuple[Part, ...]:
    """A square wooden plate with four marks."""
    length, width, height = size_m
    plate = rounded_slab((length, height, width * 0.6), 0.012, 0.004, 5)
    marks = [
        block((0.008, 0.03, 0.0014), 0.0004).moved(y=0.39 * height).turned("z", a)
        for a in (0, 90, 180, 270)
    ]
    face = width * 0.6
    hands = [_hand(length * 0.24, 0.012, 10.17, face + 0.003), _hand(length * 0.36, 0.008, 2.0, face + 0.006),
             cylinder(0.009, width - face, 0.001, 16).moved(z=face - 0.0003)]  # fmt: skip
    back, z = width / 2, height / 2
    return (
        Part("Plate", _upright(plate, back, z), "rim", None),
        Part("Marks", _upright(joined(marks).moved(z=face - 0.0005), back, z), "hand", None),
        Part("Hands", _upright(joined(hands), back, z), "hand", None),
    )


def _pipes(x_m: float, back_y_m: float, z_m: float, valve_z_m: float) -> Solid:
    """A feed from the wall with its rose, and a valve's head."""
    path = bent_path(
        [[x_m, back_y_m - 0.001, z_m], [x_m, 0.0, z_m], [x_m, 0.0, valve_z_m]], 0.02, 3
    )
    rose = cylinder(0.018, 0.008, 0.002, 16).turned("x", 90).moved(x_m, back_y_m, z_m)
    return tube(path, 0.0075, 8) + rose


def _valve(x_m: float, z_m: float, y_m: float = 0.0) -> Solid:
    head = lathe([(0.014, 0.0), (0.017, 0.004), (0.019, 0.03), (0.017, 0.05), (0.012, 0.054)], 18)
    return head.turned("y", 90 if x_m > 0 else -90).moved(x_m, y_m, z_m)


def panel_radiator(size_m: Size) -> tuple[Part, ...]:
    """A panel with pressed channels, a grille on top, sides and a thermostatic valve."""
    length, width, height = size_m
    wide = length - 0.06
    x0 = -0.03
    depth = width - 0.022
    front_y = -width / 2
    panel = rounded_slab((wide - 0.012, height - 0.02, 0.012), 0.01, 0.004, 3).turned("x", 90)
    panel = panel.moved(x0, front_y + 0.0175, (height - 0.02) / 2 + 0.004)
    count = max(6, round((wide - 0.08) / 0.05))
    step = (wide - 0.06) / count
    rib = block((step * 0.62, 0.007, height - 0.1), 0.003)
    ribs = [
        rib.moved(x0 - (wide - 0.06) / 2 + step * (i + 0.5), front_y + 0.0035, 0.05)
        for i in range(count)
    ]
    back = box((wide - 0.03, depth - 0.026, height - 0.05)).moved(
        x0, front_y + 0.016 + (depth - 0.026) / 2, 0.02
    )
    sides = [block((0.006, depth, height - 0.012), 0.002).moved(x0 + s * (wide - 0.006) / 2, front_y + 0.004 + depth / 2, 0.004)
             for s in (-1, 1)]  # fmt: skip
    fins = max(10, round(wide / 0.03))
    top = [
        block((wide - 0.008, depth - 0.004, 0.004), 0.001).moved(
            x0, front_y + 0.004 + depth / 2, height - 0.0125
        )
    ]
    slot = [box((0.005, depth - 0.03, 0.0025)).moved(x0 - wide / 2 + 0.02 + (wide - 0.04) * (i + 0.5) / fins,
            front_y + 0.004 + depth / 2, height - 0.0085) for i in range(fins)]  # fmt: skip
    frame = [block((wide - 0.014, 0.008, 0.011), 0.002).moved(x0, front_y + 0.0045 + s, height - 0.0115)
             for s in (0.004, depth - 0.004)]  # fmt: skip
    brackets = [box((0.04, 0.024, 0.05)).moved(x0 + s * wide * 0.3, width / 2 - 0.012, z)
                for s in (-1, 1) for z in (0.08, height - 0.14)]  # fmt: skip
    at = length / 2 - 0.058
    valve = _valve(at + 0.004, 0.06)
    return (
        Part("Panel", panel, "paint", None),
        Part("Channels", joined(ribs), "paint", None),
        Part("Body", back, "shadow", None),
        Part("Sides", joined([*sides, *top, *frame]), "paint", None),
        Part("Grille", joined(slot), "shadow", None),
        Part("Brackets", joined(brackets), "paint", None),
        Part("Valve", valve, "valve", None),
        Part("Pipe", tube([[at - 0.02, 0.0, 0.06], [at + 0.01, 0.0, 0.06]], 0.009, 8)
             + _pipes(at, width / 2, 0.019, 0.06), "metal", None),
    )  # fmt: skip


def column_radiator(size_m: Size) -> tuple[Part, ...]:
    """Cast columns side by side, three tubes deep, on a feed with a wheel valve."""
    length, width, height = size_m
    wide = length - 0.05
    count = max(5, round(wide / 0.06))
    step = wide / count
    deep = width - 0.03
    columns = []
    r = 0.0135
    for index in range(count):
        x = -length / 2 + step * (index + 0.5)
        outline = ring(deep, height, deep * 0.42, 0.0, 3)[:, :2]
        loop = np.column_stack([np.zeros(len(outline)), outline[:, 0], outline[:, 1] + height / 2])
        hoop_in = 1.0 - 2 * r / np.ptp(loop[:, 1:], axis=0)
        middle = loop.mean(axis=0)[1:]
        rings = []
        for share, side in ((1.0, -0.5), (1.0, 0.5), (0.0, 0.5), (0.0, -0.5)):
            scaled = loop.copy()
            factor = hoop_in + (1.0 - hoop_in) * share
            scaled[:, 1:] = middle + (loop[:, 1:] - middle) * factor
            scaled[:, 0] = x + side * step * 0.72
            scaled[:, 1] -= 0.015
            rings.append(scaled)
        columns.append(lofted(rings, loop=True))
        columns.append(box((step * 0.66, 2 * r * 0.9, height - 2 * r)).moved(x, -0.015, r))
    hubs = [
        tube([[-length / 2 + 0.004, 0.0, z], [length / 2 - 0.052, 0.0, z]], 0.016, 12)
        for z in (0.05, height - 0.05)
    ]
    brackets = [cylinder(0.008, width / 2, 0.0, 10).turned("x", -90).moved(s * wide * 0.3, 0.0, height - 0.09)
                for s in (-1, 1)]  # fmt: skip
    at = length / 2 - 0.04
    wheel = lathe(
        [(0.005, 0.0), (0.006, 0.016), (0.022, 0.018), (0.022, 0.028), (0.008, 0.032)], 18
    )
    return (
        Part("Columns", joined(columns), "paint", None),
        Part("Hubs", joined([*hubs, *brackets]), "paint", None),
        Part("Pipe", tube([[at - 0.02, 0.0, 0.05], [at + 0.01, 0.0, 0.05]], 0.012, 10)
             + _pipes(at, width / 2, 0.019, 0.05), "metal", None),
        Part("Valve", wheel.turned("y", 90).moved(at + 0.008, 0.0, 0.05), "valve", None),
    )  # fmt: skip


def tubular_radiator(size_m: Size) -> tuple[Part, ...]:
    """Flat horizontal tubes between two uprights."""
    length, width, height = size_m
    count = round(height / 0.07)
    step = height / count
    bars = [rounded_slab((length, 0.016, step * 0.8), 0.004, 0.006, 3).moved(y=-width / 2 + 0.008, z=step * (i + 0.1))
            for i in range(count)]  # fmt: skip
    posts = [
        block((0.035, 0.03, height - 0.02), 0.006).moved(
            s * (length / 2 - 0.08), -width / 2 + 0.03, 0.01
        )
        for s in (-1, 1)
    ]
    stays = [box((0.03, width - 0.04, 0.03)).moved(s * (length / 2 - 0.08), 0.02, z)
             for s in (-1, 1) for z in (0.05, height - 0.09)]  # fmt: skip
    valve = _valve(length / 2 - 0.056, 0.03, -width / 2 + 0.035)
    return (
        Part("Tubes", joined(bars), "paint", None),
        Part("Posts", joined([*posts, *stays]), "paint", None),
        Part("Valve", valve, "valve", None),
    )


def switch(size_m: Size, *, rockers: int = 1) -> tuple[Part, ...]:
    """A plate with rockers, a little tilted as they are."""
    length, width, height = size_m
    back = width / 2
    plate = _upright(
        rounded_slab((length, height, width * 0.62), 0.006, 0.002, 4), back, height / 2
    )
    wide = (length - 0.022) / rockers
    keys = []
    for index in range(rockers):
        x = -(length - 0.022) / 2 + wide * (index + 0.5)
        key = rounded_slab((wide - 0.0015, height - 0.022, width * 0.62), 0.003, 0.0015, 3)
        keys.append(key.turned("x", 90).turned("x", 2.2).moved(x, back - width * 0.34, height / 2))
    groove = box((length - 0.02, width * 0.2, height - 0.02)).moved(y=back - width * 0.56, z=0.01)
    return (
        Part("Plate", plate, "plate", None),
        Part("Groove", groove, "shadow", None),
        Part("Rocker", joined(keys), "key", None),
    )


def toggle(size_m: Size) -> tuple[Part, ...]:
    """A metal plate with two screws and a little lever."""
    length, width, height = size_m
    back = width / 2
    plate = _upright(
        rounded_slab((length, height, width * 0.4), 0.004, 0.0015, 3), back, height / 2
    )
    collar = lathe([(0.011, 0.0), (0.012, 0.001), (0.009, 0.003)], 20)
    screws = [cylinder(0.0035, 0.0016, 0.0005, 12).moved(y=s * height * 0.36) for s in (-1, 1)]
    lift = back - width * 0.4 + 0.0004
    lever = lathe([(0.0028, 0.0), (0.0042, 0.006), (0.0046, 0.0075), (0.0028, 0.009)], 12)
    long = width * 0.6
    return (
        Part("Plate", plate, "plate", None),
        Part("Collar", _upright(joined([collar, *screws]), lift, height / 2), "key", None),
        Part("Lever", lever.scaled(z=long / 0.009).turned("x", 90).turned("x", 14).moved(y=lift, z=height / 2),
             "key", None),
    )  # fmt: skip


def socket(size_m: Size, *, count: int = 1) -> tuple[Part, ...]:
    """Earthed sockets: round wells with two holes and clips at the sides."""
    length, width, height = size_m
    wide = length / count
    well, deep = 0.0195, width * 0.72
    plates, wells, holes, clips = [], [], [], []
    for index in range(count):
        x = -length / 2 + wide * (index + 0.5)
        turn = np.linspace(0, 2 * math.pi, 20, endpoint=False)
        rim = np.stack([well * np.cos(turn), well * np.sin(turn)], -1)
        outer = ring(wide - 0.0006, height, 0.006, 0.0, 3)[:, :2]
        collar = ring(0.052, 0.052, 0.008, 0.0, 4)[:, :2]
        plates += [
            extruded(outer, width * 0.78, [rim]).moved(x),
            extruded(collar, width * 0.22 + 0.0004, [rim]).moved(x, z=width * 0.78 - 0.0004),
        ]
        cup_ = [(well + 0.001, 0.0), (well + 0.001, width * 0.7), (well - 0.0006, width * 0.7),
                (well - 0.001, width - deep), (0.0, width - deep)]  # fmt: skip
        wells.append(outward(lathe(cup_, 20)).moved(x))
        for s in (-1, 1):
            holes.append(
                cylinder(0.0026, 0.0006, 0.0, 10).moved(x + s * 0.0095, 0.0, width - deep - 0.0002)
            )
            clips.append(
                block((0.005, 0.0022, width * 0.4), 0.0004).moved(
                    x, s * (well - 0.0016), width - deep
                )
            )
    back = width / 2
    parts = (
        (("Plate", plates, "plate")),
        ("Wells", wells, "plate"),
        ("Holes", holes, "shadow"),
        ("Clips", clips, "metal"),
    )
    return tuple(
        Part(name, _upright(joined(solids), back, height / 2), slot, None)
        for name, solids, slot in parts
    )


_CLOCK = {
    name: {"rim": rim, "dial": dial, "mark": mark, "hand": mark}
    for name, rim, dial, mark in (
        ("black_metal", "black_metal", "white", "ink"), ("oak", "oak", "warm_white", "ink"),
        ("brass", "brass", "warm_white", "ink"), ("walnut", "walnut", "chalk", "ink"),
    )
}  # fmt: skip
_DARK_CLOCK = {
    name: {"rim": rim, "dial": "black", "mark": mark, "hand": mark}
    for name, rim, mark in (
        ("black_metal", "black_metal", "antique_brass"),
        ("rust", "copper", "cream"),
    )
}
_PAINT = {
    name: {"paint": paint, "shadow": "light_grey" if paint == "white" else "graphite",
           "valve": valve, "metal": "chrome"}
    for name, paint, valve in (("white", "white", "plastic_white"), ("graphite", "graphite", "black"))
}  # fmt: skip
_CAST = {
    name: {"paint": paint, "shadow": "graphite", "valve": valve, "metal": metal}
    for name, paint, valve, metal in (
        ("white", "warm_white", "antique_brass", "antique_brass"), ("black_metal", "black_metal", "copper", "copper"),
        ("gunmetal", "gunmetal", "antique_brass", "antique_brass"),
    )
}  # fmt: skip
_PLATE = {
    name: {"plate": plate, "key": key, "shadow": "graphite", "metal": "steel"}
    for name, plate, key in (
        ("white", "plastic_white", "plastic_white"), ("black", "plastic_black", "plastic_black"),
        ("steel", "steel", "plastic_black"), ("brass", "antique_brass", "antique_brass"),
    )
}  # fmt: skip

_MOST = (MODERN, SCANDINAVIAN, JAPANESE)


def _design(
    name: str, category: str, size_m: Size, draw: Draw, looks: dict, styles: tuple[str, ...] = ()
) -> Design:
    return Design(name, category, size_m, draw, looks, DRY, styles)


DESIGNS = (
    _design("Clock_Bars", "clock", (0.3, 0.04, 0.3), clock, _CLOCK, (MODERN, SCANDINAVIAN, INDUSTRIAL)),
    _design("Clock_Dots", "clock", (0.25, 0.035, 0.25), partial(clock, marks="dots", rim_m=0.012), _CLOCK, _MOST),
    _design("Clock_Numerals", "clock", (0.36, 0.045, 0.36), partial(clock, marks="numerals", rim_m=0.026), _CLOCK, (CLASSIC,)),
    _design("Clock_Dark", "clock", (0.4, 0.045, 0.4), partial(clock, rim_m=0.012), _DARK_CLOCK, (INDUSTRIAL, MODERN)),
    _design("Clock_Open", "clock", (0.5, 0.03, 0.5), open_clock, {k: v for k, v in _CLOCK.items() if k in ("black_metal", "brass")}, (INDUSTRIAL, CLASSIC)),
    _design("Clock_Square", "clock", (0.24, 0.032, 0.24), square_clock, {k: v for k, v in _CLOCK.items() if k in ("oak", "walnut")}, (JAPANESE, SCANDINAVIAN)),
    *(_design(f"Radiator_Panel_{100 * x:.0f}", "radiator", (x, 0.1, 0.6), panel_radiator, _PAINT, _MOST)
      for x in (0.6, 0.8, 1.0, 1.2, 1.4, 1.6)),
    *(_design(f"Radiator_Low_{100 * x:.0f}", "radiator", (x, 0.1, 0.4), panel_radiator, _PAINT, _MOST)
      for x in (0.8, 1.2, 1.6)),
    *(_design(f"Radiator_Columns_{100 * x:.0f}", "radiator", (x, 0.14, 0.6), column_radiator, _CAST, (CLASSIC, INDUSTRIAL))
      for x in (0.6, 0.8, 1.0, 1.2, 1.4)),
    _design("Radiator_Tubes_50", "radiator", (0.5, 0.08, 0.88), tubular_radiator, _PAINT, (MODERN, INDUSTRIAL)),
    _design("Light_Switch", "light_switch", (0.081, 0.011, 0.081), switch, _PLATE),
    _design("Light_Switch_Two_Rockers", "light_switch", (0.082, 0.011, 0.082), partial(switch, rockers=2), _PLATE),
    _design("Light_Switch_Toggle", "light_switch", (0.08, 0.015, 0.12), toggle,
            {k: v for k, v in _PLATE.items() if k in ("brass", "black", "steel")}, (CLASSIC, INDUSTRIAL)),
    _design("Socket_Single", "socket", (0.081, 0.011, 0.081), socket, _PLATE),
    _design("Socket_Double", "socket", (0.152, 0.011, 0.081), partial(socket, count=2), _PLATE),
    _design("Socket_Triple", "socket", (0.223, 0.011, 0.081), partial(socket, count=3), _PLATE),
)  # fmt: skip
