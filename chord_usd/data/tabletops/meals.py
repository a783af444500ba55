"""Dining tables and worktops: settings by seat, dishes in the middle, supplies at the wall."""

from __future__ import annotations

from chord_usd.data.tabletops.board import Place
from chord_usd.data.tabletops.sizes import SPEAKER, USUAL_M, usual, varied
from chord_usd.data.tabletops.tops import Piece

LAID_CHANCE = 0.72
"""Share of dining tables that are laid; on the others stands what is not cleared away."""


def lay_dining_table(place: Place, piece: Piece) -> None:
    """place: at the front; each seat is laid from its own side."""
    dice = place.board.dice
    if dice.chance(LAID_CHANCE) and piece.seats():
        size_m = varied(dice, dice.pick(USUAL_M["dinner_set"]))
        for seat in piece.seats():
            if dice.chance(0.94):
                _lay_setting(Place(place.board, seat.side), (seat.from_m + seat.to_m) / 2, size_m)
        _put_dishes(place, dice.steps(1, 2))
    else:
        _put_dishes(place, dice.steps(2, 4))
        if dice.chance(0.4):
            _put_leftovers(place)


def _lay_setting(place: Place, seat: float, size_m: tuple[float, float, float]) -> None:
    """A set that faces its seat and, by chance, a cup beside it."""
    dice = place.board.dice
    along = place.along(seat)
    near = size_m[1] / 2 + 0.025
    placed = None
    for farther in (0.0, 0.04, 0.08, 0.13):
        # Where the edge is round a setting lies a little farther in.
        span = (near + farther, near + farther + 0.03)
        inwards = along * (1.0 - farther)
        placed = placed or place.put("dinner_set", size_m, (inwards - 0.02, inwards + 0.02), span)
    if placed and dice.chance(0.18):
        cup_m = usual(dice, "coffee_cup")
        at = along + dice.pick((-1.0, 1.0)) * (size_m[0] / 2 + 0.1)
        place.put("coffee_cup", cup_m, (at - 0.01, at + 0.02), (0.14, 0.28), 20.0)


def _put_dishes(place: Place, count: int) -> None:
    """What everybody shares, along the middle line."""
    dice = place.board.dice
    reach = place.length_m * 0.3 if place.length_m > 1.0 else 0.1
    middle = (place.depth_m / 2 - 0.05, place.depth_m / 2 + 0.05)
    kinds = (("food", 0.36), ("drinks", 0.28), ("small_plant", 0.18), ("small_ornament", 0.14),
             ("big_plant", 0.04))  # fmt: skip
    for index in range(count):
        kind = dice.weighted(kinds)
        span = (-0.05, 0.05) if index == 0 and dice.chance(0.6) else (-reach, reach)
        place.put(kind, usual(dice, kind), span, middle, 20.0 if kind == "food" else 0.0)


def _put_leftovers(place: Place) -> None:
    dice = place.board.dice
    half, deep = place.length_m / 2 - 0.15, place.depth_m
    kind = dice.pick(("coffee_cup", "laptop", "lying_book", "magazine"))
    place.put(kind, usual(dice, kind), (-half, half), (0.2, deep - 0.2), 10.0)


def lay_worktop(place: Place) -> None:
    """A worktop: the back for what stays, the front kept free to work on."""
    dice = place.board.dice
    half, deep = place.length_m / 2, place.depth_m
    kinds = [("drinks", 0.24), ("food", 0.3), ("small_plant", 0.16), ("coffee_cup", 0.14),
             ("electronic", 0.08), ("dinner_set", 0.06), ("small_ornament", 0.02)]  # fmt: skip
    most = 1 if place.length_m < 0.42 else 2 if place.length_m < 0.75 else 3
    left = dice.steps(1, most)
    for _ in range(6):
        if left == 0:
            return
        kind = dice.weighted(kinds)
        size_m = varied(dice, SPEAKER) if kind == "electronic" else usual(dice, kind)
        reach = half - size_m[0] / 2 - 0.02
        if reach <= 0.0:
            continue
        far = deep - size_m[1] / 2 - 0.03
        turn = 10.0 if kind in ("food", "coffee_cup") else 0.0
        depth = (deep * 0.35, far) if kind == "coffee_cup" else (far - 0.08, far)
        left -= bool(place.put(kind, size_m, (-reach, reach), depth, turn))
