"""Taps of kitchens and bathrooms. All stand at the origin, their spouts towards -y."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.solids import (
    Solid,
    bent_path,
    block,
    cylinder,
    joined,
    lathe,
    mirrored_pair,
    rounded_profile,
    rounded_slab,
    tube,
)

SinkTap = Literal["swan", "square", "bridge", "slim"]
BasinTap = Literal["lever", "block", "cross"]


def _bow(reach: float, rise: float, drop: float, start: float, steps: int = 10) -> FloatArray:
    """A path up from z = start, over in half a circle of this reach, and down again by drop."""
    angles = np.linspace(math.pi, 0.0, steps + 1)
    radius = reach / 2
    over = np.stack(
        [np.zeros(steps + 1), -radius - radius * np.cos(angles), rise + radius * np.sin(angles)], -1
    )
    return np.concatenate([[[0.0, 0.0, start]], over, [[0.0, -reach, rise - drop]]])


def _side_lever(z: float, *, blade: bool) -> Solid:
    """A cartridge to the right of the body with its lever."""
    hub = cylinder(0.0165, 0.042, 0.003, 20).turned("y", 90).moved(0.004, 0.0, z)
    if blade:
        arm = block((0.006, 0.012, 0.085), 0.002).turned("x", 8).moved(0.04, 0.0, z + 0.004)
    else:
        arm = tube(
            [[0.038, 0.0, z], [0.05, -0.004, z + 0.03], [0.068, -0.012, z + 0.085]], 0.005, 8
        )
    return hub + arm


def sink_tap(kind: SinkTap = "swan") -> Solid:
    """A kitchen mixer, about 0.37 m high, reaching 0.19 m to the front."""
    if kind == "bridge":
        return _bridge_tap()
    foot = [(0.026, 0), (0.026, 0.004), (0.0215, 0.008), (0.0205, 0.014)]
    if kind == "square":
        path = bent_path([[0, 0, 0.1], [0, 0, 0.34], [0, -0.2, 0.34], [0, -0.2, 0.26]], 0.02, 4)
        body = lathe([*foot, (0.0205, 0.112), (0.019, 0.114), (0, 0.114)], 24)
        end = cylinder(0.0125, 0.03, 0.002, 18).moved(0.0, -0.2, 0.236)
        return joined([body, tube(path, 0.0115, 14), end, _side_lever(0.07, blade=True)])
    reach = 0.19 if kind == "swan" else 0.17
    path = _bow(reach, 0.27, 0.05, 0.1)
    thick = 0.0115 if kind == "swan" else 0.0085
    body = lathe(
        rounded_profile(
            [*foot, (0.0205, 0.1), (0.018, 0.118), (thick + 0.001, 0.128), (0, 0.129)], 1
        ),
        24,
    )
    end = cylinder(thick + 0.0025, 0.034, 0.003, 18).moved(0.0, -reach, 0.27 - 0.05 - 0.03)
    return joined([body, tube(path, thick, 14), end, _side_lever(0.066, blade=kind == "slim")])


def _cross_handle() -> Solid:
    """Four arms on a hub, its foot at the origin, 0.07 m high."""
    stem = lathe(
        [
            (0.019, 0),
            (0.019, 0.004),
            (0.012, 0.01),
            (0.011, 0.045),
            (0.014, 0.05),
            (0.012, 0.066),
            (0.006, 0.071),
            (0, 0.071),
        ],
        20,
    )
    arm = lathe([(0.0045, 0), (0.0042, 0.022), (0.007, 0.029), (0.005, 0.034), (0, 0.035)], 10)
    arms = [
        arm.moved(z=0.003).turned("y", 90).turned("z", turn).moved(z=0.057)
        for turn in (45.0, 135.0, 225.0, 315.0)
    ]
    return joined([stem, *arms])


def _bridge_tap() -> Solid:
    """Two pillars with cross handles, a bridge between them, a high bow on it."""
    pillar = lathe(
        [
            (0.024, 0),
            (0.024, 0.004),
            (0.013, 0.012),
            (0.013, 0.05),
            (0.019, 0.056),
            (0.019, 0.07),
            (0, 0.071),
        ],
        20,
    )
    bridge = cylinder(0.011, 0.18, 0.0, 14).turned("y", 90).moved(-0.09, 0.0, 0.062)
    ball = lathe(
        rounded_profile(
            [(0, 0.04), (0.017, 0.044), (0.021, 0.062), (0.017, 0.08), (0.013, 0.09), (0, 0.092)], 1
        ),
        20,
    )
    neck = tube(_bow(0.18, 0.25, 0.05, 0.08), 0.0105, 14)
    end = cylinder(0.014, 0.024, 0.004, 18).moved(0.0, -0.18, 0.18)
    handles = mirrored_pair((pillar + _cross_handle().moved(z=0.0667)).moved(0.09))
    return joined([handles, bridge, ball, neck, end])


def basin_tap(kind: BasinTap = "lever", rise: float = 0.13) -> Solid:
    """A mixer for a basin; rise is the height of its body, the spout's mouth a little lower."""
    if kind == "cross":
        return _three_hole_tap(rise)
    if kind == "block":
        body = block((0.04, 0.042, rise), 0.003)
        spout = block((0.036, 0.135, 0.018), 0.003).moved(0.0, -0.064, rise - 0.032)
        plate = block((0.038, 0.09, 0.009), 0.0025).turned("x", -9).moved(0.0, -0.012, rise + 0.012)
        stem = cylinder(0.014, 0.014, 0.001, 16).moved(z=rise - 0.002)
        mouth = cylinder(0.0115, 0.008, 0.001, 16).moved(0.0, -0.114, rise - 0.038)
        return joined([body, spout, plate, stem, mouth])
    profile = [
        (0.027, 0),
        (0.027, 0.003),
        (0.0235, 0.007),
        (0.0225, rise * 0.5),
        (0.0235, rise - 0.004),
        (0.022, rise),
        (0, rise),
    ]
    body = lathe(profile, 28)
    path = bent_path(
        [
            [0, -0.008, rise * 0.55],
            [0, -0.075, rise * 0.82],
            [0, -0.128, rise * 0.7],
            [0, -0.13, rise * 0.6],
        ],
        0.045,
        5,
    )
    spout = tube(path, 0.0115, 14)
    mouth = cylinder(0.0125, 0.012, 0.002, 18).moved(0.0, -0.13, rise * 0.6 - 0.008)
    cap = lathe(
        [(0.022, rise + 0.002), (0.0225, rise + 0.012), (0.014, rise + 0.022), (0, rise + 0.024)],
        24,
    )
    lever = rounded_slab((0.016, 0.1, 0.008), 0.007, 0.002, 3).moved(y=-0.048).turned("x", -16)
    return joined([body, spout, mouth, cap, lever.moved(z=rise + 0.011)])


def _three_hole_tap(rise: float) -> Solid:
    """A spout between two cross handles."""
    foot = lathe([(0.026, 0), (0.026, 0.004), (0.014, 0.014), (0.0125, 0.03), (0, 0.031)], 22)
    neck = tube(_bow(0.12, rise * 0.8, 0.03, 0.02), 0.0105, 14)
    end = cylinder(0.0125, 0.014, 0.002, 16).moved(0.0, -0.12, rise * 0.8 - 0.04)
    return joined([foot, neck, end, mirrored_pair(_cross_handle().moved(0.105))])


def tall_basin_tap(rise: float, *, bowed: bool = True) -> Solid:
    """A tall mixer beside a bowl that stands on a counter; rise: from the counter to the spout."""
    if not bowed:
        return basin_tap("block", rise + 0.03)
    foot = lathe(
        [(0.026, 0), (0.026, 0.004), (0.021, 0.008), (0.021, 0.11), (0.0125, 0.122), (0, 0.123)], 24
    )
    neck = tube(_bow(0.14, rise, 0.035, 0.1), 0.0115, 14)
    end = cylinder(0.0135, 0.02, 0.002, 18).moved(0.0, -0.14, rise - 0.05)
    return joined([foot, neck, end, _side_lever(0.066, blade=False)])


def plate_tap(rise: float, tall: float) -> Solid:
    """A spout and a lever out of an upright plate at the wall: its back at y = 0."""
    plate = rounded_slab((0.17, tall, 0.012), 0.006, 0.002, 3).turned("x", 90).moved(z=tall / 2)
    spout = tube(
        bent_path(
            [[0.04, -0.006, rise], [0.04, -0.17, rise], [0.04, -0.175, rise - 0.02]], 0.02, 4
        ),
        0.0115,
        14,
    )
    hub = cylinder(0.021, 0.045, 0.003, 22).turned("x", 90).moved(-0.042, -0.008, rise)
    lever = tube(
        [[-0.042, -0.046, rise], [-0.042, -0.06, rise + 0.03], [-0.042, -0.075, rise + 0.075]],
        0.0052,
        8,
    )
    rose = cylinder(0.02, 0.008, 0.002, 22).turned("x", 90).moved(0.04, -0.008, rise)
    return joined([plate, spout, hub, lever, rose])


def tub_tap(*, cross: bool = False) -> Solid:
    """A spout on the rim of a tub, a control at either side of it."""
    neck = (
        _bow(0.15, 0.1, 0.02, 0.002)
        if cross
        else bent_path([[0, 0, 0.002], [0, 0, 0.12], [0, -0.16, 0.12], [0, -0.16, 0.095]], 0.03, 4)
    )
    spout = tube(neck, 0.0135, 14)
    foot = lathe([(0.03, 0), (0.03, 0.004), (0.018, 0.01), (0, 0.011)], 22)
    if cross:
        return joined([spout, foot, mirrored_pair(_cross_handle().moved(0.11))])
    knob = lathe(
        [(0.027, 0), (0.027, 0.004), (0.022, 0.007), (0.021, 0.045), (0.019, 0.048), (0, 0.048)], 24
    )
    pin = tube([[0.0, 0.0, 0.036], [0.012, -0.022, 0.042], [0.018, -0.04, 0.048]], 0.004, 8)
    return joined([spout, foot, mirrored_pair((knob + pin).moved(0.12))])
