"""What tabletop items measure: a few usual pieces per category, within the palette's ranges."""

from __future__ import annotations

from chord_usd.workshop.data.floorplans.dice import Dice

Size = tuple[float, float, float]
"""Length, width (depth) and height in metres."""

USUAL_M: dict[str, tuple[Size, ...]] = {
    "lying_book": ((0.15, 0.21, 0.025), (0.2, 0.27, 0.06), (0.13, 0.2, 0.03)),
    "standing_book": ((0.18, 0.18, 0.24), (0.36, 0.2, 0.26), (0.26, 0.18, 0.24)),
    "magazine": ((0.21, 0.28, 0.008),),
    "all_in_one_computer": ((0.5, 0.36, 0.42), (0.62, 0.42, 0.48)),
    "laptop": ((0.3, 0.27, 0.21), (0.36, 0.31, 0.24)),
    "big_mouse_pad": ((0.8, 0.35, 0.004), (0.7, 0.32, 0.004)),
    "table_lamp": ((0.26, 0.26, 0.45), (0.36, 0.18, 0.46), (0.22, 0.22, 0.4)),
    "small_ornament": ((0.12, 0.12, 0.22), (0.15, 0.06, 0.2)),
    "pen_holder": ((0.09, 0.09, 0.18),),
    "big_plant": ((0.3, 0.3, 0.45), (0.4, 0.4, 0.6)),
    "small_plant": ((0.18, 0.18, 0.24), (0.12, 0.12, 0.13)),
    "coffee_cup": ((0.14, 0.14, 0.08),),
    "electronic": ((0.075, 0.15, 0.01), (0.11, 0.11, 0.16), (0.18, 0.07, 0.08)),
    "photo_frame": ((0.17, 0.09, 0.22), (0.27, 0.09, 0.2)),
    "food": ((0.27, 0.27, 0.16), (0.33, 0.18, 0.11)),
    "dinner_set": ((0.44, 0.33, 0.12), (0.38, 0.28, 0.02)),
    "drinks": ((0.08, 0.08, 0.3), (0.25, 0.2, 0.3)),
}

SPREAD = 0.08
"""Pieces of one kind differ by up to this share, in all three sizes alike."""

PHONE, SPEAKER, CLOCK = USUAL_M["electronic"]
SHADE_LAMP, ARM_LAMP, SMALL_LAMP = USUAL_M["table_lamp"]


def varied(dice: Dice, size_m: Size) -> Size:
    """A piece of about this size."""
    scale = 1.0 + SPREAD * (2.0 * dice.unit() - 1.0)
    length, width, height = size_m
    return length * scale, width * scale, height * scale


def usual(dice: Dice, category: str, longest_m: float = 9.0) -> Size:
    """One of the usual pieces of a category; the smallest where all are longer than longest_m."""
    pieces = USUAL_M[category]
    short = [piece for piece in pieces if max(piece[:2]) <= longest_m]
    return varied(dice, dice.pick(short or (min(pieces),)))
