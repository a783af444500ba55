"""Dining tables and worktops: settings by seat, dishes in the middle, supplies at the wall."""

from __future__ import annotations

from chord_usd.base.raster.table_top import Side
from chord_usd.workshop.data.tabletops.board import Place, Placed
from chord_usd.workshop.data.tabletops.tabletop_sizes import SPEAKER, USUAL_M, Size, usual, varied
from chord_usd.workshop.data.tabletops.tops import Piece

_USUAL_SEATS: tuple[Side, ...] = ("front", "back", "left", "right")
"""Where a table is laid that has no chairs yet: at its long sides, else where no wall is."""


def lay_dining_table(place: Place, piece: Piece) -> None:
    """place: at the front; each seat is laid from its own side, all with one kind of setting."""
    dice, board = place.board.dice, place.board
    seats = [(seat.side, (seat.from_m + seat.to_m) / 2) for seat in piece.seats()]
    seats = seats or [(side, 0.0) for side in _USUAL_SEATS if side not in piece.sides("wall")][:2]
    sets = USUAL_M["dinner_set"]
    for size_m in (varied(dice, dice.pick(sets)), varied(dice, min(sets)), min(sets)):
        board.placed.clear()
        settings = [_setting(Place(board, side), at, size_m) for side, at in seats]
        if all(settings):
            break
    for (side, at), setting in zip(seats, settings, strict=True):
        if setting and dice.chance(0.18):
            _put_cup(Place(board, side), at, setting.box.size_m[0])
    _put_dishes(place, dice.steps(1, 2))


def _setting(place: Place, seat: float, size_m: Size) -> Placed | None:
    """A set that faces its seat."""
    along = place.along(seat)
    near = size_m[1] / 2 + 0.025
    for farther in (0.0, 0.04, 0.08, 0.13):
        # Where the edge is round, or somebody sits round the corner, it lies farther in.
        span = (near + farther, near + farther + 0.03)
        inwards = along * (1.0 - farther)
        aside = 0.02 + farther / 2
        placed = place.put("dinner_set", size_m, (inwards - aside, inwards + aside), span)
        if placed:
            return placed
    return None


def _put_cup(place: Place, seat: float, setting_m: float) -> None:
    dice = place.board.dice
    at = place.along(seat) + dice.pick((-1.0, 1.0)) * (setting_m / 2 + 0.1)
    place.put("coffee_cup", usual(dice, "coffee_cup"), (at - 0.01, at + 0.02), (0.14, 0.28), 20.0)


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
        turn = 20.0 if kind == "food" else 0.0
        place.put(kind, usual(dice, kind), span, middle, turn, tries=8)


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
