"""Pieces that stand alone along a wall: cabinets, shoe cabinets, armchairs."""

from __future__ import annotations

import math
from collections.abc import Callable

from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.workshop.data.furnish import sizes
from chord_usd.workshop.data.furnish.floor import Floor, Size, Spot
from chord_usd.workshop.data.furnish.free_spans import MARGIN_M

Score = Callable[[Floor, Spot, float], float]
"""How well a piece of the wanted length would stand in a span."""

OPEN_DOORS_M = 0.6
"""In front of a cabinet, for its doors and for whoever stands there."""


def anchored(floor: Floor, spot: Spot, length: float) -> float:
    """Middle of a piece pushed into the corner end of a span; the farther end from the door."""
    low, high = spot.s_from + length / 2, spot.s_to - length / 2
    at_start, at_end = spot.s_from < 1e-6, spot.s_to > spot.wall.length - 1e-6
    if at_start != at_end:
        return low if at_start else high
    if not at_start and floor.dice.random() < 0.5:
        return (low + high) / 2
    near_low = floor.distance_to_door(*spot.wall.world(low, 0.3))
    near_high = floor.distance_to_door(*spot.wall.world(high, 0.3))
    return low if near_low > near_high else high


def put_dining_cabinet(floor: Floor, longest: float) -> bool:
    """A low cabinet as near to the dining table as can be. Returns whether one was put."""
    tables = [piece for piece in floor.placed if piece.category == "dining_table"]

    def score(floor: Floor, spot: Spot, wanted: float) -> float:
        liked = _cabinet_score(floor, spot, wanted)
        x, y = spot.wall.world((spot.s_from + spot.s_to) / 2, 0.3)
        return liked - sum(math.hypot(table.x - x, table.y - y) for table in tables)

    return put_cabinet(floor, tall=False, longest=longest, category="dining_cabinet", score=score)


def put_cabinet(
    floor: Floor,
    *,
    tall: bool,
    longest: float,
    category: str = "cabinet",
    score: Score | None = None,
) -> bool:
    """A cabinet as long as fits, in a corner where possible. Returns whether one was put."""
    dice = floor.dice
    row = CATEGORIES[category]
    if tall:
        depth, height = sizes.wardrobe(dice)
        depth = min(depth, row.width_m[1])
    else:
        depth, height = sizes.between(dice, row.width_m[0], 0.45), sizes.between(dice, 0.8, 1.1)
    least = row.length_m[0]
    best = best_spot(floor, (least, depth, height), OPEN_DOORS_M, longest, score or _cabinet_score)
    if not best:
        return False
    length = min(longest, row.length_m[1], best.length)
    # A niche little longer than the cabinet is filled from end to end.
    if best.length - length < 0.35:
        length = min(best.length, row.length_m[1])
    else:
        length = max(least, int(length * 20 + 1e-6) / 20)
    floor.new_group()
    s = anchored(floor, best, length)
    floor.put(category, best.wall, s, (length, depth, height), reach=OPEN_DOORS_M)
    return True


def best_spot(
    floor: Floor,
    least: Size,
    reach: float,
    wanted: float,
    score: Score,
) -> Spot | None:
    """The best span for a piece of at least this size, wanted metres long if possible."""
    noise = floor.dice.uniform
    spots = [
        (score(floor, spot, wanted) + noise(0.0, 0.5), i, spot)
        for i, spot in enumerate(floor.spots(least[1], least[2], reach, least[0]))
    ]
    return max(spots)[2] if spots else None


def _cabinet_score(floor: Floor, spot: Spot, wanted: float) -> float:
    """Long enough, in a corner, not on the window wall."""
    score = 2.0 * min(spot.length, wanted) / wanted
    score += 0.5 * (spot.s_from < 1e-6 or spot.s_to > spot.wall.length - 1e-6)
    score -= 0.5 * spot.wall.has_window
    # A niche just filled looks built in.
    return score + 0.6 * (0.0 <= spot.length - wanted < 0.35)


def put_armchair(floor: Floor, beside_table: float = 0.4) -> bool:
    """A leisure sofa, at a window where possible, sometimes with a small table beside it."""
    dice = floor.dice
    size = sizes.sampled(dice, "leisure_sofa")
    size = (size[0], min(size[1], size[0] + 0.1), size[2])
    best = best_spot(floor, size, 0.5, size[0], _armchair_score)
    if not best:
        return False
    floor.new_group()
    s = anchored(floor, best, size[0])
    floor.put("leisure_sofa", best.wall, s, size, reach=0.4)
    if dice.random() < beside_table:
        table = sizes.square(dice, "side_coffee_table")
        for side in (-1, 1):
            middle = s + side * (size[0] / 2 + MARGIN_M + table[0] / 2)
            low, high = middle - table[0] / 2, middle + table[0] / 2
            if best.wall.fits(low, high, 0.0, table[1], table[2]):
                floor.put("side_coffee_table", best.wall, middle, table)
                break
    return True


def _armchair_score(floor: Floor, spot: Spot, wanted: float) -> float:
    del wanted
    corner = spot.s_from < 1e-6 or spot.s_to > spot.wall.length - 1e-6
    away = floor.distance_to_door(*spot.wall.world((spot.s_from + spot.s_to) / 2, 0.0))
    return 0.8 * corner + 0.6 * spot.wall.has_window + 0.2 * min(away, 4.0)


def put_shoe_cabinet(floor: Floor) -> bool:
    """A shallow cabinet beside the entrance, no farther than 2.5 m from it."""
    dice = floor.dice
    entrances = [door for door in floor.doors if door.is_entrance]
    if not entrances:
        return False
    door = entrances[0]
    x, y = door.wall.world((door.s_from + door.s_to) / 2, 0.0)
    depth, height = sizes.between(dice, 0.25, 0.4), dice.choice((0.9, 1.0, 1.1, 2.0, 2.2))
    best = None
    for spot in floor.spots(depth, height, 0.6, 0.6):
        end = min(2.5, max(0.0, spot.length))
        near_s, _ = spot.wall.local(x, y)
        length = min(end, sizes.between(dice, 0.8, 1.6), 1.6)
        low, high = spot.s_from + length / 2, spot.s_to - length / 2
        s = min(max(near_s, low), high)
        own_x, own_y = spot.wall.world(s, depth / 2)
        away = abs(own_x - x) + abs(own_y - y)
        if away < 3.0 and (best is None or away < best[0]):
            best = (away, spot.wall, s, length)
    if best is None:
        return False
    floor.new_group()
    floor.put("shoe_cabinet", best[1], best[2], (best[3], depth, height), reach=0.6)
    return True
