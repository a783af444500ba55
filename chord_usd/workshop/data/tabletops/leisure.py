"""Coffee tables, side tables, bedside tables and TV cabinets."""

from __future__ import annotations

from chord_usd.base.raster.table_top import SIDES, Side
from chord_usd.workshop.data.tabletops.board import Place
from chord_usd.workshop.data.tabletops.tabletop_sizes import (
    CLOCK,
    PHONE,
    SHADE_LAMP,
    SMALL_LAMP,
    SPEAKER,
    usual,
    varied,
)
from chord_usd.workshop.data.tabletops.tops import Piece
from chord_usd.workshop.data.tabletops.work import put_magazine


def lay_coffee_table(place: Place, piece: Piece) -> None:
    """place: at the side of the sofa. Cups before the seats, the bowl in the middle."""
    dice = place.board.dice
    half, deep = place.length_m / 2, place.depth_m
    if dice.chance(0.65):
        kind = dice.weighted((("food", 0.5), ("small_plant", 0.25), ("small_ornament", 0.25)))
        aside = half * 0.4
        place.put(kind, usual(dice, kind), (-aside, aside), (deep * 0.4, deep * 0.6), 15.0)
    if dice.chance(0.55):
        put_magazine(place, (-half + 0.15, half - 0.15), (0.17, max(deep - 0.17, 0.18)))
    for side in piece.sides("seat") or (place.side,):
        if dice.chance(0.55):
            seen = Place(place.board, side)
            reach = max(seen.length_m / 2 - 0.15, 0.02)
            size_m = usual(dice, "coffee_cup")
            seen.put("coffee_cup", size_m, (-reach, reach), (0.1, 0.18), 30.0)
    spots = (-half + 0.1, half - 0.1), (0.1, max(deep - 0.1, 0.12))
    for kind, chance, turn in (
        ("lying_book", 0.3, 15.0), ("drinks", 0.22, 0.0), ("laptop", 0.12, 8.0),
        ("small_plant", 0.2, 0.0), ("small_ornament", 0.2, 0.0),
    ):  # fmt: skip
        if dice.chance(chance):
            span = spots[1] if kind != "laptop" else (0.18, 0.25)
            place.put(kind, usual(dice, kind), spots[0], span, turn)
    if dice.chance(0.45):
        place.put("electronic", varied(dice, PHONE), *spots, 25.0)
    _at_least_one(place, "coffee_cup")


def lay_side_table(place: Place, piece: Piece) -> None:
    """One large thing or two small ones, for whoever sits beside it; no lamp outside."""
    dice = place.board.dice
    half, deep = place.length_m / 2, place.depth_m
    if dice.chance(0.05 if piece.room == "balcony" else 0.4):
        size_m = varied(dice, dice.pick((SHADE_LAMP, SMALL_LAMP)))
        place.put("table_lamp", size_m, (-0.06, 0.06), (deep * 0.5, deep * 0.65))
    elif dice.chance(0.3):
        kind = dice.weighted((("small_plant", 0.5), ("big_plant", 0.2), ("small_ornament", 0.3)))
        place.put(kind, usual(dice, kind), (-0.06, 0.06), (deep * 0.45, deep * 0.6))
    for kind, chance in (("coffee_cup", 0.5), ("lying_book", 0.35), ("drinks", 0.12)):
        if dice.chance(chance):
            size_m = usual(dice, kind, longest_m=0.22)
            place.put(kind, size_m, (-half + 0.09, half - 0.09), (0.09, deep - 0.09), 15.0)
    if dice.chance(0.25):
        span = (-half + 0.07, half - 0.07), (0.1, deep - 0.1)
        place.put("electronic", varied(dice, PHONE), *span, 15.0)
    _at_least_one(place, "coffee_cup")


def lay_bedside_table(place: Place, piece: Piece) -> None:
    """place: at the front. The lamp at the back near the bed, the rest in reach of it."""
    dice = place.board.dice
    half, deep = place.length_m / 2, place.depth_m
    beds = piece.sides("bed")
    bed = 0.0 if not beds else 1.0 if beds[0] == "right" else -1.0
    towards_deg = 25.0 * bed * dice.unit()
    turned = Place(place.board, place.side)
    turned.yaw_deg = place.yaw_deg + towards_deg
    if dice.chance(0.85):
        size_m = varied(dice, dice.pick((SHADE_LAMP, SMALL_LAMP, SMALL_LAMP)))
        at = bed * max(half - size_m[0] / 2 - 0.03, 0.0)
        far = deep - size_m[1] / 2 - 0.025
        along = (min(at, 0.6 * at) - 0.02, max(at, 0.6 * at) + 0.02)
        place.put("table_lamp", size_m, along, (far - 0.08, far), tries=10)
    kind = dice.weighted((("clock", 0.3), ("photo_frame", 0.25), ("small_plant", 0.15),
                          ("small_ornament", 0.1), ("", 0.2)))  # fmt: skip
    if kind:
        size_m = varied(dice, CLOCK) if kind == "clock" else usual(dice, kind, longest_m=0.2)
        name = "electronic" if kind == "clock" else kind
        turned.put(name, size_m, (-half + 0.08, half - 0.08), (deep * 0.3, deep - 0.08), 5.0)
    for kind, chance in (("phone", 0.4), ("lying_book", 0.45), ("coffee_cup", 0.25)):
        if dice.chance(chance):
            size_m = varied(dice, PHONE) if kind == "phone" else usual(dice, kind, longest_m=0.22)
            name = "electronic" if kind == "phone" else kind
            span = (-half + 0.08, half - 0.08), (0.09, deep * 0.55)
            place.put(name, size_m, *span, 12.0, 6)
    _at_least_one(place, "table_lamp")


def lay_tv_cabinet(place: Place, piece: Piece) -> None:
    """place: at the front. Both ends, for the set is in the middle; before it only what is low."""
    dice = place.board.dice
    half, deep = place.length_m / 2, place.depth_m
    if dice.chance(0.1 if piece.room == "bedroom" else 0.3):
        size_m = varied(dice, SPEAKER)
        at = half * (0.75 + 0.15 * dice.unit())
        for side in (-at, at):
            place.put("electronic", size_m, (side - 0.02, side + 0.02), (deep * 0.4, deep * 0.6))
    for end in dice.shuffled((-1.0, 1.0)):
        kind = dice.weighted((
            ("big_plant", 0.16), ("small_plant", 0.22), ("photo_frame", 0.2),
            ("small_ornament", 0.22), ("standing_book", 0.14), ("table_lamp", 0.06), ("", 0.2),
        ))  # fmt: skip
        if kind:
            size_m = usual(dice, kind, longest_m=min(0.4, deep - 0.03))
            outer = max(half - size_m[0] / 2 - 0.03, 0.0)
            inner = max(outer - 0.25, 0.0)
            span = (end * inner, end * outer)
            turn = 20.0 if kind == "photo_frame" else 0.0
            place.put(kind, size_m, span, (deep * 0.45, max(deep * 0.55, deep - 0.15)), turn)
    if dice.chance(0.35):
        size_m = varied(dice, PHONE)
        place.put("electronic", size_m, (-half * 0.6, half * 0.6), (0.08, 0.12), 40.0)
    if dice.chance(0.2):
        size_m = usual(dice, "lying_book", longest_m=deep - 0.05)
        place.put("lying_book", size_m, (-half * 0.8, half * 0.8), (0.13, 0.17), 10.0)
    _at_least_one(place, "small_ornament")


def main_side(piece: Piece) -> Side:
    """The side most people sit at; the front where nobody does."""
    lengths = dict.fromkeys(SIDES, 0.0)
    for border in piece.seats():
        lengths[border.side] += border.to_m - border.from_m
    best = max(SIDES, key=lambda side: lengths[side])
    return best if lengths[best] > 0.0 else "front"


def _at_least_one(place: Place, kind: str) -> None:
    """Something small where chance left the top bare."""
    if not place.board.placed:
        size_m = min(usual(place.board.dice, kind, longest_m=0.25) for _ in range(2))
        half, deep = place.length_m / 2, place.depth_m
        middle = (-half / 2, half / 2), (deep * 0.4, deep * 0.6)
        anywhere = (-half + 0.06, half - 0.06), (0.05, deep * 0.8)
        for spans, tries in ((middle, 6), (anywhere, 20)):
            if place.put(kind, size_m, *spans, tries=tries):
                return
