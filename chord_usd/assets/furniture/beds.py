"""Beds: frame, headboard, mattress, duvet with a turned sheet, pillows."""

from __future__ import annotations

from functools import partial
from typing import Literal

from chord_usd.assets.furniture.joinery import four_legs
from chord_usd.assets.model import Part, Style, editions
from chord_usd.assets.solids import (
    Size,
    Solid,
    block,
    creased,
    cushion,
    joined,
    pillow,
    piped_cushion,
    rounded_slab,
    soft_block,
)

Headboard = Literal["panel", "slats", "channels", "cushions"]

_RAIL_TOP_M = 0.3
_MATTRESS_TOP_M = 0.5


def bed(size_m: Size, *, headboard: Headboard = "panel", throw: bool = True) -> tuple[Part, ...]:
    """A bed with its head at the back (+y); length runs across the bed, width along it."""
    length, width, height = size_m
    head = {"channels": 0.1, "cushions": 0.13}.get(headboard, 0.06)
    lying = width - head
    y = -head / 2
    rail = rounded_slab((length, lying, _RAIL_TOP_M - 0.12), 0.03, 0.012).moved(y=y, z=0.12)
    mattress = cushion((length - 0.09, lying - 0.05, 0.24), 0.08, 0.05, 0.015)
    return (
        *four_legs(length - 0.08, width - 0.08, 0.13, 0.058, "leg"),
        Part("Rail", rail, "frame"),
        *_headboard(headboard, length, height, head, width / 2),
        Part("Mattress", mattress.moved(y=y, z=_MATTRESS_TOP_M - 0.24), "mattress"),
        *_bedding(length, lying, y, throw=throw),
        *_pillows(length, width / 2 - head),
    )


def _headboard(
    kind: Headboard, length: float, height: float, thick: float, back: float
) -> tuple[Part, ...]:
    y, rise = back - thick / 2, height - 0.1
    if kind == "panel":
        board = rounded_slab((length, rise, thick), 0.04, 0.015, 6, 2)
        return (Part("Headboard", _upright(board).moved(y=back, z=0.1), "frame"),)
    if kind == "channels":
        count = max(round(length / 0.2), 4)
        wide = length / count
        pads = [
            rounded_slab((wide - 0.001, thick, rise), 0.045, 0.015, 3).moved(
                -length / 2 + wide * (i + 0.5), y, 0.1
            )
            for i in range(count)
        ]
        return (Part("Headboard", joined(pads), "frame"),)
    if kind == "cushions":
        return _cushioned(length, height, thick, back)
    posts = [block((0.06, thick, height)).moved(s * (length - 0.06) / 2, y) for s in (-1, 1)]
    rails = [block((length - 0.1, 0.035, 0.08)).moved(y=y, z=z) for z in (0.42, height - 0.1)]
    count = max(round(length / 0.13), 5)
    step = (length - 0.12) / count
    bars = [
        block((0.035, 0.02, height - 0.56)).moved(-(length - 0.12) / 2 + step * (i + 0.5), y, 0.48)
        for i in range(count)
    ]
    return (Part("Headboard", joined([*posts, *rails, *bars]), "frame"),)


def _cushioned(length: float, height: float, thick: float, back: float) -> tuple[Part, ...]:
    """Loose back cushions with piped edges, hung on a board."""
    board_m = 0.03
    board = block((length, board_m, height - 0.08), 0.006).moved(y=back - board_m / 2, z=0.1)
    count = 2 if length >= 1.3 else 1
    wide = length / count
    deep = thick - board_m + 0.012
    pad = piped_cushion((wide - 0.012, height - 0.5, deep), 0.06, 0.03, 0.02).turned("x", 90)
    high = pad.bounds_m()[1]
    pad = pad.moved(0.0, back - board_m + 0.012 - float(high[1]), height - float(high[2]))
    pads = [pad.moved(x=(i - (count - 1) / 2) * wide) for i in range(count)]
    return (
        Part("Headboard", board.moved(z=-0.02), "frame"),
        Part("Back_Cushions", joined(pads), "frame", collider=None),
    )


def _upright(plate: Solid) -> Solid:
    """A plate drawn lying down, stood up with its underside to the back and its width rising."""
    lifted = plate.turned("x", 90)
    return lifted.moved(z=-float(lifted.bounds_m()[0, 2]))


def _bedding(length: float, lying: float, y: float, *, throw: bool) -> tuple[Part, ...]:
    """Duvet over the lower two thirds, its upper edge turned back, perhaps a throw at the foot."""
    reach = lying * 0.64
    foot = y - lying / 2
    duvet = soft_block((length - 0.045, reach, 0.23), 0.075, (8, 7, 1))
    duvet = _folded(duvet.moved(y=foot + 0.015 + reach / 2, z=_RAIL_TOP_M + 0.012))
    turned = soft_block((length - 0.03, 0.26, 0.225), 0.06, (8, 1, 1))
    turned = _folded(turned.moved(y=foot + reach - 0.08, z=_RAIL_TOP_M + 0.032))
    parts = [Part("Duvet", duvet, "duvet"), Part("Turned_Sheet", turned, "sheet", collider=None)]
    if throw:
        blanket = soft_block((length - 0.028, 0.48, 0.222), 0.07, (8, 2, 1))
        blanket = _folded(blanket.moved(y=foot + 0.42, z=_RAIL_TOP_M + 0.034))
        parts.append(Part("Throw", blanket, "throw", collider=None))
    return tuple(parts)


def _folded(cloth: Solid) -> Solid:
    """The same folds at the same place on the bed, so that layers of cloth follow each other."""
    return creased(cloth, 0.009, 0.55)


def _pillows(length: float, head_y: float) -> tuple[Part, ...]:
    """One or two pillows leaning on the headboard, each with a small cushion before it."""
    count = 2 if length >= 1.3 else 1
    wide = min(0.7, (length - 0.12) / count - 0.03)
    main = pillow((wide, 0.46, 0.17)).turned("x", 38)
    small = pillow((wide * 0.66, 0.36, 0.14)).turned("x", 46)
    sleepers, accents = [], []
    for index in range(count):
        x = (index - (count - 1) / 2) * (length - 0.12) / count
        sleepers.append(_resting(main, x, head_y - 0.01))
        accents.append(_resting(small, x, head_y - 0.19))
    return (
        Part("Pillows", joined(sleepers), "sheet", collider=None),
        Part("Cushions", joined(accents), "accent", collider=None),
    )


def _resting(piece: Solid, x: float, back: float) -> Solid:
    low, high = piece.bounds_m()
    return piece.moved(x, back - float(high[1]), _MATTRESS_TOP_M - 0.025 - float(low[2]))


_BARE = {"mattress": "mattress", "sheet": "white_cloth"}
_WOODEN = {
    "oak_linen": {
        **_BARE, "frame": "oak", "leg": "oak", "duvet": "linen", "throw": "rust_cloth",
        "accent": "rust_cloth",
    },
    "walnut_blue": {
        **_BARE, "frame": "walnut", "leg": "walnut", "duvet": "white_cloth", "throw": "blue_cloth",
        "accent": "blue_cloth",
    },
    "white_green": {
        **_BARE, "frame": "white", "leg": "white", "duvet": "white_cloth", "throw": "green_cloth",
        "accent": "green_cloth",
    },
}  # fmt: skip
_UPHOLSTERED = {
    "grey_white": {
        **_BARE, "frame": "grey_cloth", "leg": "black_stain", "duvet": "white_cloth",
        "throw": "charcoal_cloth", "accent": "mustard_cloth",
    },
    "beige_linen": {
        **_BARE, "frame": "beige_cloth", "leg": "oak", "duvet": "cream_cloth",
        "throw": "green_cloth", "accent": "green_cloth",
    },
    "teal_grey": {
        **_BARE, "frame": "teal_cloth", "leg": "walnut", "duvet": "linen", "throw": "teal_cloth",
        "accent": "pink_cloth",
    },
}  # fmt: skip

_SLATS = Style("Bed_Slats", partial(bed, headboard="slats"), _WOODEN, 0.9)
_PANEL = Style("Bed_Panel", bed, _WOODEN, 0.95)
_PLAIN = Style("Bed_Plain", partial(bed, throw=False), _WOODEN, 1.0)
_CHANNELS = Style("Bed_Channels", partial(bed, headboard="channels"), _UPHOLSTERED, 1.1)
_CUSHIONS = Style("Bed_Cushions", partial(bed, headboard="cushions"), _UPHOLSTERED, 1.0)

DESIGNS = (
    *editions("bed", (_SLATS, _PANEL), (0.9, 1.0, 1.2), (1.97, 2.07)),
    *editions("bed", (_CHANNELS, _PANEL, _CUSHIONS, _PLAIN), (1.35, 1.5, 1.8, 2.0), (2.07, 2.17)),
)
