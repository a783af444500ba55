"""Desks, dining tables, coffee tables, side tables."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

from chord_usd.library.kit.joinery import HANDLE_M, cells, drawers, four_legs, round_colliders
from chord_usd.library.kit.model import Part, hollow_part, placed
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    cylinder,
    joined,
    lathe,
    mirrored_pair,
    rounded_slab,
)

_TOP_M = 0.03


def legged_table(
    size_m: Size, *, leg_m: float = 0.05, top_m: float = _TOP_M, is_round: bool = False
) -> tuple[Part, ...]:
    """A top on four legs with an apron; is_round gives turned, splayed legs."""
    length, width, height = size_m
    corner = 0.03 if not is_round else 0.12
    top = rounded_slab((length, width, top_m), corner, 0.006, 6, 2)
    apron_m = min(0.08, height * 0.16)
    reach = 0.02 if not is_round else 0.06
    rails = joined(
        [
            mirrored_pair(
                block((0.022, width - 0.16, apron_m - 0.002)).moved(
                    length / 2 - reach - leg_m / 2, z=0.001
                )
            ),
            block((length - 0.16, 0.022, apron_m)).moved(y=-width / 2 + reach + leg_m / 2),
            block((length - 0.16, 0.022, apron_m)).moved(y=width / 2 - reach - leg_m / 2),
        ]
    )
    return (
        Part("Top", top.moved(z=height - top_m), "top"),
        Part("Apron", rails.moved(z=height - top_m - apron_m), "leg", collider=None),
        *four_legs(
            length - reach, width - reach, height - top_m + 0.002, leg_m,
            is_round=is_round, splay_m=0.05 if is_round else 0.0,
        ),
    )  # fmt: skip


def trestle_table(size_m: Size) -> tuple[Part, ...]:
    """A thick top on two metal portal frames."""
    length, width, height = size_m
    bar, top_m = 0.045, 0.038
    tall = height - top_m
    upright = block((bar, bar, tall + 0.001)).moved(y=width / 2 - 0.07)
    cross = block((bar - 0.002, width - 0.14, bar))
    portal = [upright, upright.scaled(y=-1.0), cross, cross.moved(z=tall - bar)]
    at = length / 2 - min(0.16, length * 0.12)
    top = rounded_slab((length, width, top_m), 0.012, 0.005, 3, 1)
    beam = block((2 * at, 0.04, 0.03)).moved(z=tall - 0.032)
    return (
        Part("Top", top.moved(z=tall), "top"),
        _portal("Frame_Left", portal, -at),
        _portal("Frame_Right", portal, at),
        Part("Beam", beam, "leg", collider=None),
    )


def _portal(name: str, bars: Sequence[Solid], x_m: float) -> Part:
    """Bars that collide one by one: feet go between them."""
    moved = tuple(bar.moved(x=x_m) for bar in bars)
    return Part(name, joined(moved), "leg", colliders=moved)


def pedestal_table(size_m: Size, *, foot_m: float = 0.28) -> tuple[Part, ...]:
    """A round or oval top on one turned column."""
    length, width, height = size_m
    top = rounded_slab((length, width, 0.03), max(length, width), 0.01, 12, 3)
    foot = min(foot_m, min(length, width) * 0.38)
    column = [
        (foot, 0.0), (foot, 0.012), (foot * 0.9, 0.022), (0.06, 0.06), (0.04, 0.14),
        (0.04, height - 0.12), (0.09, height - 0.03), (0.09, height - 0.028),
    ]  # fmt: skip
    top = top.moved(z=height - 0.03)
    colliders = (
        *round_colliders(cylinder(foot, 0.022)),
        cylinder(0.06, height - 0.05).moved(z=0.02),
    )
    return (
        Part("Top", top, "top", colliders=round_colliders(top)),
        Part("Column", lathe(column, 28), "leg", colliders=colliders),
    )


def drawer_desk(size_m: Size, *, side: Literal["left", "right"] = "right") -> tuple[Part, ...]:
    """A desk with a pedestal of three drawers on one side and a leg panel on the other."""
    length, width, height = size_m
    sign = 1.0 if side == "right" else -1.0
    wide, top_m = 0.4, 0.03
    tall = height - top_m
    top = block((length, width, top_m), 0.004).moved(z=tall)
    box_depth = width - HANDLE_M - 0.018 - 0.02
    x = sign * (length / 2 - wide / 2 - 0.005)
    y_face = -width / 2 + HANDLE_M + 0.018
    pedestal = block((wide, box_depth, tall - 0.05)).moved(x, y_face + box_depth / 2, 0.05)
    fronts = drawers(list(cells(wide, tall - 0.055, 1, (2, 1, 1), 0.052)), y_face, "bar")
    panel = block((0.03, width - 0.06, tall + 0.001)).moved(-sign * (length / 2 - 0.035))
    modesty = block((length - wide - 0.06, 0.018, 0.35))
    feet = block((wide - 0.04, box_depth - 0.06, 0.052)).moved(x, y_face + box_depth / 2)
    return (
        Part("Top", top, "top"),
        hollow_part("Pedestal", pedestal),
        Part("Pedestal_Feet", feet, "leg"),
        *placed(fronts, (x, 0.0, 0.0)),
        Part("Side_Panel", panel, "body"),
        Part("Modesty_Panel", modesty.moved(-sign * wide / 2, width / 2 - 0.08, tall - 0.35),
             "body"),
    )  # fmt: skip


def waterfall_table(size_m: Size) -> tuple[Part, ...]:
    """A low table whose top bends down into its sides, with a drawer between them."""
    length, width, height = size_m
    board = 0.035
    top = rounded_slab((length, width, board), 0.006, 0.006, 4, 2).moved(z=height - board)
    side = block((board, width - 0.002, height - board + 0.002), 0.004)
    tall, depth = min(0.14, height * 0.35), width - HANDLE_M - 0.022
    y_face = -width / 2 + HANDLE_M + 0.02
    z = height - board - tall
    case = block((length - 2 * board, depth, tall)).moved(y=y_face + depth / 2, z=z)
    columns = 1 if length < 1.0 else 2
    right = side.moved(x=(length - board) / 2 - 0.002)
    fronts = drawers(list(cells(length - 2 * board, tall - 0.004, columns, (1.0,), z + 0.002)),
                     y_face, "knob")  # fmt: skip
    return (
        Part("Top", top, "top"),
        Part("Sides", mirrored_pair(right), "top", colliders=(right, right.scaled(x=-1.0))),
        hollow_part("Drawer_Box", case),
        *fronts,
    )  # fmt: skip


def nest_of_drums(size_m: Size) -> tuple[Part, ...]:
    """A large low drum with a smaller, higher one at its side."""
    length, width, height = size_m
    big, small = width / 2, min(length - width, width) / 2 + 0.04
    profile = [(big - 0.03, 0), (big, 0.03), (big, height - 0.1), (big - 0.015, height - 0.09)]
    low = lathe(profile, 40).moved(x=-length / 2 + big)
    tall = cylinder(small, height - 0.001, 0.012, 32).moved(length / 2 - small, -(big - small))
    return (
        Part("Low_Table", low, "top", colliders=round_colliders(low)),
        Part("High_Table", tall, "leg", colliders=round_colliders(tall)),
    )


def tray_table(size_m: Size) -> tuple[Part, ...]:
    """A round tray with a raised rim on three splayed legs."""
    length, width, height = size_m
    radius = 0.5
    tray = lathe(
        [(radius - 0.02, 0), (radius, 0.008), (radius, 0.04), (radius - 0.015, 0.04),
         (radius - 0.02, 0.014), (0.0, 0.014)], 36,
    ).scaled(x=length, y=width)  # fmt: skip
    # What stands on it stands within the rim, which nothing needs to feel.
    plate = cylinder(radius - 0.02, 0.014, 0, 36).scaled(x=length, y=width).moved(z=height - 0.04)
    reach = min(length, width) / 2
    legs = []
    for index in range(3):
        leg = cylinder(0.011, height - 0.03, 0.002, 10, top_m=0.016)
        points = leg.points_m.copy()
        points[:, 0] += reach * (0.85 - 0.35 * points[:, 2] / height)
        legs.append(type(leg)(points, leg.faces).turned("z", 90 + 120 * index))
    return (
        Part("Tray", tray.moved(z=height - 0.04), "top", colliders=round_colliders(plate)),
        *(Part(f"Leg_{i}", leg, "leg") for i, leg in enumerate(legs, start=1)),
    )


def cube_table(size_m: Size) -> tuple[Part, ...]:
    """An open wooden cube with a shelf: top, bottom, two sides, back."""
    length, width, height = size_m
    board = 0.022
    side = block((board, width - 0.004, height - 2 * board + 0.002))
    right = side.moved((length - board) / 2 - 0.002, 0, board - 0.001)
    return (
        Part("Top", rounded_slab((length, width, board), 0.01, 0.004).moved(z=height - board),
             "top"),
        Part("Bottom", block((length - 0.002, width - 0.002, board)), "leg"),
        Part("Sides", mirrored_pair(right), "leg", colliders=(right, right.scaled(x=-1.0))),
        Part("Shelf", block((length - 2 * board, width - 0.03, 0.018)).moved(z=height * 0.45),
             "leg"),
        Part("Back", block((length - 2 * board, 0.012, height - 2 * board)).moved(
            y=width / 2 - 0.02, z=board), "leg"),
    )  # fmt: skip
