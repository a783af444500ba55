"""Desks: somebody works at the seat, everything else keeps to the back and the sides."""

from __future__ import annotations

from chord_usd.base.raster.table_top import Side
from chord_usd.base.scene.types import RoomKind
from chord_usd.workshop.data.tabletops.board import Place
from chord_usd.workshop.data.tabletops.tabletop_sizes import (
    ARM_LAMP,
    CLOCK,
    PHONE,
    SHADE_LAMP,
    SPEAKER,
    USUAL_M,
    usual,
    varied,
)
from chord_usd.workshop.data.tabletops.tops import Piece


def lay_desk(place: Place, seat_m: float, room: RoomKind) -> None:
    """Computer on its pad before the seat, the rest around it; in a bedroom it may be a dressing
    table. seat_m: along the side."""
    dice = place.board.dice
    if room == "bedroom" and dice.chance(0.3):
        _put_dressing(place, seat_m)
        return
    device = dice.weighted((("all_in_one_computer", 0.45), ("laptop", 0.4), ("", 0.15)))
    if device == "laptop":
        _put_laptop(place, seat_m)
    elif device:
        _put_computer(place, seat_m)
    else:
        _put_reading(place, seat_m)
    _put_behind(place)
    _put_beside(place, seat_m)


def sitter_of(piece: Piece) -> tuple[Side, float]:
    """Side at which one works, and where along own x the seat is; the front where none is."""
    seats = piece.seats()
    if not seats:
        return "front", 0.0
    return seats[0].side, (seats[0].from_m + seats[0].to_m) / 2


def _put_pad(place: Place, seat_m: float, chance: float) -> None:
    dice = place.board.dice
    if dice.chance(chance):
        size_m = usual(dice, "big_mouse_pad")
        reach = max(place.length_m / 2 - size_m[0] / 2 - 0.02, 0.0)
        middle = min(max(seat_m, -reach), reach)
        near = size_m[1] / 2 + 0.02
        place.put("big_mouse_pad", size_m, (middle - 0.03, middle + 0.03), (near, near + 0.06))


def _put_laptop(place: Place, seat_m: float) -> None:
    dice = place.board.dice
    _put_pad(place, seat_m, 0.5)
    size_m = usual(dice, "laptop")
    near = size_m[1] / 2 + 0.06
    place.put("laptop", size_m, (seat_m - 0.05, seat_m + 0.05), (near, near + 0.1), 6.0)


def _put_computer(place: Place, seat_m: float) -> None:
    """The screen's foot may stand behind the pad, its keyboard on it."""
    dice = place.board.dice
    _put_pad(place, seat_m, 0.55)
    size_m = usual(dice, "all_in_one_computer", longest_m=place.length_m - 0.1)
    reach = max(place.length_m / 2 - size_m[0] / 2 - 0.02, 0.0)
    middle = min(max(seat_m, -reach), reach)
    deepest = max(place.depth_m - size_m[1] / 2 - 0.02, size_m[1] / 2 + 0.02)
    nearest = min(size_m[1] / 2 + 0.05, deepest)
    span = (nearest, min(nearest + 0.1, deepest))
    placed = place.put("all_in_one_computer", size_m, (middle - 0.02, middle + 0.02), span)
    if placed and dice.chance(0.2):
        size_m = varied(dice, SPEAKER)
        aside = placed.box.size_m[0] / 2 + 0.09
        for side in (-aside, aside):
            spot = (middle + side - 0.01, middle + side + 0.01)
            place.put("electronic", size_m, spot, (span[1] + 0.05, span[1] + 0.1))


def _put_reading(place: Place, seat_m: float) -> None:
    dice = place.board.dice
    _put_pad(place, seat_m, 0.3)
    size_m = usual(dice, dice.pick(("lying_book", "magazine")))
    kind = "magazine" if size_m[2] < 0.012 else "lying_book"
    near = size_m[1] / 2 + 0.05
    place.put(kind, size_m, (seat_m - 0.1, seat_m + 0.1), (near, near + 0.06), 8.0)


def _put_dressing(place: Place, seat_m: float) -> None:
    """Lamp and picture at the back, small things in reach, the middle free."""
    dice = place.board.dice
    _put_behind(place)
    half, deep = place.length_m / 2 - 0.1, place.depth_m
    for kind in ("small_ornament", "small_ornament", "small_plant", "lying_book"):
        if dice.chance(0.55):
            aside = seat_m + dice.pick((-1.0, 1.0)) * (0.25 + 0.3 * dice.unit())
            at = min(max(aside, -half), half)
            place.put(kind, usual(dice, kind), (at - 0.03, at + 0.03), (0.15, deep - 0.1), 10.0)


def _put_behind(place: Place) -> None:
    """A row along the far edge: lamp in a corner, books, plant, picture."""
    dice = place.board.dice
    half, deep = place.length_m / 2, place.depth_m
    corner = dice.pick((-1.0, 1.0))
    if dice.chance(0.6):
        size_m = varied(dice, dice.pick((SHADE_LAMP, ARM_LAMP)))
        at = corner * (half - size_m[0] / 2 - 0.03)
        far = deep - size_m[1] / 2 - 0.03
        place.put("table_lamp", size_m, (at, at - corner * 0.06), (far - 0.04, far), 8.0)
    for kind, chance in (
        ("standing_book", 0.4), ("small_plant", 0.35), ("photo_frame", 0.3),
        ("small_ornament", 0.15),
    ):  # fmt: skip
        if dice.chance(chance):
            size_m = usual(dice, kind)
            far = deep - size_m[1] / 2 - 0.025
            turn = 15.0 if kind == "photo_frame" else 0.0
            reach = half - size_m[0] / 2 - 0.02
            place.put(kind, size_m, (-reach, reach), (far - 0.02, far), turn)


def _put_beside(place: Place, seat_m: float) -> None:
    """What the hand reaches for: pens, cup, telephone, books."""
    dice = place.board.dice
    half, deep = place.length_m / 2 - 0.08, place.depth_m
    if dice.chance(0.6):
        size_m = usual(dice, "pen_holder")
        place.put("pen_holder", size_m, (-half, half), (deep * 0.5, deep - 0.08))
    if dice.chance(0.5):
        size_m = usual(dice, "coffee_cup")
        hand = seat_m + dice.pick((-1.0, 1.0, 1.0)) * (0.3 + 0.15 * dice.unit())
        place.put("coffee_cup", size_m, (hand - 0.05, hand + 0.05), (0.12, 0.35), 30.0)
    if dice.chance(0.45):
        hand = seat_m + dice.pick((-1.0, 1.0)) * (0.25 + 0.2 * dice.unit())
        place.put("electronic", varied(dice, PHONE), (hand - 0.05, hand + 0.05), (0.1, 0.3), 12.0)
    if dice.chance(0.45):
        size_m = usual(dice, "lying_book")
        place.put("lying_book", size_m, (-half, half), (0.16, deep - 0.14), 12.0)
    if dice.chance(0.2):
        place.put("electronic", varied(dice, CLOCK), (-half, half), (deep * 0.6, deep - 0.07), 10.0)
    if dice.chance(0.15):
        put_magazine(place, (-half, half), (0.18, deep - 0.16))


def put_magazine(
    place: Place, along: tuple[float, float], depth: tuple[float, float], chance: float = 0.6
) -> None:
    """A magazine and, by chance, a book or a cup on it."""
    dice = place.board.dice
    under = place.put("magazine", varied(dice, USUAL_M["magazine"][0]), along, depth, 15.0)
    if under and dice.chance(chance):
        kind = dice.weighted((("lying_book", 0.6), ("coffee_cup", 0.25), ("electronic", 0.15)))
        size_m = varied(dice, PHONE) if kind == "electronic" else usual(dice, kind)
        x, y, _ = under.box.center_m
        shift = 0.05
        place.board.put(
            kind, size_m, x + shift * (2 * dice.unit() - 1), y + shift * (2 * dice.unit() - 1),
            under.box.yaw_deg + 15.0 * (2.0 * dice.unit() - 1.0),
        )  # fmt: skip
