"""Desks, dining tables, coffee tables, side tables."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from typing import Literal

from chord_usd.library.kit.joinery import HANDLE_M, cells, drawers, felt_round, four_legs
from chord_usd.library.kit.model import Design, Part, Style, editions, hollow_part, placed, steps
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
from chord_usd.library.tables.period_tables import (
    low_slab_table,
    panel_table,
    steel_table,
    turned_pedestal,
    turned_table,
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
    """Bars that are felt one by one: feet go between them."""
    moved = tuple(bar.moved(x=x_m) for bar in bars)
    return Part(name, joined(moved), "leg", felt=moved)


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
    felt = (*felt_round(cylinder(foot, 0.022)), cylinder(0.06, height - 0.05).moved(z=0.02))
    return (
        Part("Top", top, "top", felt=felt_round(top)),
        Part("Column", lathe(column, 28), "leg", felt=felt),
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
        Part("Sides", mirrored_pair(right), "top", felt=(right, right.scaled(x=-1.0))),
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
        Part("Low_Table", low, "top", felt=felt_round(low)),
        Part("High_Table", tall, "leg", felt=felt_round(tall)),
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
        Part("Tray", tray.moved(z=height - 0.04), "top", felt=felt_round(plate)),
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
        Part("Sides", mirrored_pair(right), "leg", felt=(right, right.scaled(x=-1.0))),
        Part("Shelf", block((length - 2 * board, width - 0.03, 0.018)).moved(z=height * 0.45),
             "leg"),
        Part("Back", block((length - 2 * board, 0.012, height - 2 * board)).moved(
            y=width / 2 - 0.02, z=board), "leg"),
    )  # fmt: skip


def _pair(top: str, leg: str, handle: str = "black_metal") -> dict[str, str]:
    return {"top": top, "leg": leg, "body": top, "front": top, "handle": handle}


_WOOD = {
    **{wood: _pair(wood, wood) for wood in ("oak", "pale_oak", "birch", "black_stain")},
    "walnut": _pair("walnut", "walnut", "brass"),
    "dark_walnut": _pair("dark_walnut", "dark_walnut", "brass"),
    "cherry": _pair("cherry", "cherry", "brass"),
    "white": _pair("pale_oak", "white", "steel"),
}
_METAL = {
    "oak_black": _pair("oak", "black_metal"),
    "walnut_black": _pair("walnut", "black_metal"),
    "dark_walnut_black": _pair("dark_walnut", "black_metal"),
    "pale_oak_black": _pair("pale_oak", "black_metal"),
    "walnut_brass": _pair("walnut", "brass", "brass"),
    "dark_walnut_steel": _pair("dark_walnut", "steel", "steel"),
    "white_steel": _pair("white", "steel", "steel"),
}
_STONE = {
    "marble": _pair("marble", "brass"),
    "marble_black": _pair("marble", "black_metal"),
    "dark_stone": _pair("dark_stone", "black_metal"),
    "quartz": _pair("quartz", "oak"),
    "concrete": _pair("concrete", "oak"),
}
_DESK = {
    "oak_white": {**_pair("oak", "black_metal"), "body": "white", "front": "white"},
    "walnut": _pair("walnut", "black_metal", "brass"),
    "sage": {**_pair("pale_oak", "black_metal"), "body": "sage", "front": "sage"},
    "birch": {**_pair("birch", "birch"), "body": "white", "front": "white"},
}

_M, _S, _C, _I, _J = (
    (name,) for name in ("modern", "scandinavian", "classic", "industrial", "japanese")
)

_DESKS = (
    Style("Desk_Panel", panel_table, _WOOD, 0.74, _M),
    Style("Desk_Plain", partial(legged_table, leg_m=0.045), _WOOD, 0.74, _J),
    Style("Desk_Splayed", partial(legged_table, leg_m=0.05, is_round=True), _WOOD, 0.74, _S),
    Style("Desk_Turned", partial(turned_table, leg_m=0.06), _WOOD, 0.76, _C),
    Style("Desk_Portal", trestle_table, _METAL, 0.75, _I),
)
_DRAWER_DESKS = (
    Style("Desk_Drawers", drawer_desk, _DESK, 0.75, (*_M, *_S)),
    Style("Desk_Drawers_Left", partial(drawer_desk, side="left"), _DESK, 0.75, (*_M, *_S)),
)
_DINING = (
    Style("Dining_Table_Panel", panel_table, _WOOD, 0.75, _M),
    Style(
        "Dining_Table_Splayed", partial(legged_table, leg_m=0.07, top_m=0.035, is_round=True),
        _WOOD, 0.75, _S,
    ),
    Style("Dining_Table_Turned", partial(turned_table, leg_m=0.085), _WOOD, 0.76, _C),
    Style("Dining_Table_Trestle", trestle_table, _METAL, 0.76, _I),
    Style("Dining_Table_Square_Legs", partial(legged_table, leg_m=0.075, top_m=0.045), _WOOD,
          0.72, _J),
)  # fmt: skip
_DINING_ROUND = (
    Style("Dining_Table_Round", partial(pedestal_table, foot_m=0.3), _STONE, 0.75, _M),
    Style("Dining_Table_Pedestal", turned_pedestal, _WOOD, 0.76, _C),
)
_COFFEE = (
    Style("Coffee_Table_Waterfall", waterfall_table, _WOOD, 0.4, _M),
    Style("Coffee_Table_Splayed", partial(legged_table, leg_m=0.05, is_round=True), _WOOD, 0.42,
          _S),
    Style("Coffee_Table_Turned", partial(turned_table, leg_m=0.06, has_shelf=True), _WOOD, 0.46,
          _C),
    Style("Coffee_Table_Cart", steel_table, _METAL, 0.42, _I),
    Style("Coffee_Table_Low", low_slab_table, _WOOD, 0.35, _J),
)  # fmt: skip
_COFFEE_ROUND = Style("Coffee_Table_Round", pedestal_table, _STONE, 0.4, (*_M, *_C))
_COFFEE_DRUMS = Style("Coffee_Table_Drums", nest_of_drums, _STONE, 0.44, _M)
_SIDE = (
    Style("Side_Table_Tray", tray_table, _METAL, 0.52, (*_S, *_M)),
    Style("Side_Table_Cube", cube_table, _WOOD, 0.5, _J),
    Style("Side_Table_Pedestal", turned_pedestal, _WOOD, 0.58, _C),
    Style("Side_Table_Frame", partial(steel_table, has_wheels=False), _METAL, 0.5, _I),
)
_SIDES_M = (0.36, 0.41, 0.46, 0.51, 0.56, 0.62)


def _each(
    category: str, forms: Sequence[Style], lengths: Sequence[float], widths: Sequence[float]
) -> Iterator[Design]:
    """Each form in every other length, so that all styles have nearly all sizes."""
    for number, form in enumerate(forms):
        yield from editions(category, (form,), lengths[number % 2 :: 2], widths)


DESIGNS = (
    *_each("table", _DESKS, steps(0.8, 1.7), (0.51, 0.6)),
    *_each("table", _DRAWER_DESKS, steps(1.05, 1.65), (0.51, 0.6)),
    *_each("table", (*_DESKS, *_DRAWER_DESKS), (1.4, 1.55, 1.7), (0.71,)),
    *_each("dining_table", _DINING, steps(0.83, 1.23), (0.77,)),
    *_each("dining_table", _DINING, steps(1.2, 2.1), (0.79, 0.89, 0.99)),
    *(design for form in _DINING_ROUND for side in (0.85, 0.95, 1.05)
      for design in editions("dining_table", (form,), (side,), (side,))),
    *_each("coffee_table", _COFFEE, steps(0.65, 1.35), (0.65, 0.75, 0.85)),
    *(design for side in (0.6, 0.7, 0.8, 0.9)
      for design in editions("coffee_table", (_COFFEE_ROUND,), (side,), (side,))),
    *editions("coffee_table", (_COFFEE_DRUMS,), (0.85, 0.95), (0.55,)),
    *(design for form in _SIDE for side in _SIDES_M
      for design in editions("side_coffee_table", (form,), (side,), (side,))),
)  # fmt: skip
