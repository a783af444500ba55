"""A desk with its chair, in bedrooms and studies."""

from __future__ import annotations

from chord_usd.workshop.data.furnish import sizes
from chord_usd.workshop.data.furnish.floor import Floor, Spot
from chord_usd.workshop.data.furnish.free_spans import REACH
from chord_usd.workshop.data.furnish.storage import anchored, best_spot

SEAT_M = 0.75
"""From the desk's edge to the back of somebody who sits or gets up."""


def put_desk(floor: Floor, *, core: bool = False) -> bool:
    """A desk along a wall, at a window where possible, and a chair that faces it."""
    dice = floor.dice
    usual = sizes.sampled(dice, "table", shortest=1.0, longest=1.6, deepest=0.6)
    chair = sizes.sampled(dice, "chair", shortest=0.45, longest=0.58, shallowest=0.5)
    for length, depth in ((usual[0], max(usual[1], 0.5)), (0.8, 0.5)):
        best = best_spot(
            floor,
            (length, depth + chair[1], usual[2]),
            SEAT_M - chair[1],
            length,
            _desk_score,
        )
        if not best:
            continue
        s = _desk_middle(floor, best, length)
        low, high, seat = s - chair[0] / 2, s + chair[0] / 2, depth
        if best.wall.fits(low, high, seat, seat + chair[1], chair[2]):
            floor.new_group()
            floor.put("table", best.wall, s, (length, depth, usual[2]), core=core)
            floor.put_turned("chair", best.wall, s, seat + chair[1] / 2, chair, 2)
            floor.keep(best.wall, s - length / 2, s + length / 2, depth, depth + SEAT_M, REACH)
            return True
    return False


def _desk_middle(floor: Floor, spot: Spot, length: float) -> float:
    """Under the window if the span has one, else in the corner."""
    low, high = spot.s_from + length / 2, spot.s_to - length / 2
    for wall, s_from, s_to, _ in floor.windows:
        middle = (s_from + s_to) / 2
        if wall is spot.wall and low - 0.3 < middle < high + 0.3:
            return min(max(middle, low), high)
    return anchored(floor, spot, length)


def _desk_score(floor: Floor, spot: Spot, wanted: float) -> float:
    del wanted
    corner = spot.s_from < 1e-6 or spot.s_to > spot.wall.length - 1e-6
    return 0.8 * spot.wall.has_window + 0.4 * corner + 0.1 * min(spot.length, 3.0)
