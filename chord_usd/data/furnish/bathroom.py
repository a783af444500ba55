"""Bathrooms: toilet, washbasin, and a shower or a bathtub, each with room in front of it."""

from __future__ import annotations

from typing import NamedTuple

from chord_usd.data.furnish import sizes
from chord_usd.data.furnish.floor import Floor, Size, Spot
from chord_usd.data.furnish.storage import anchored

REACH_M = {"toilet": 0.5, "washbasin": 0.55, "shower": 0.45, "bathtub": 0.5, "washing_machine": 0.6}
"""Free floor in front of each."""

TOILET_SLOT_M = 0.7
"""Width that a toilet needs between its neighbours."""


class Fitting(NamedTuple):
    """One fixture to place: its size, and the width of wall it takes."""

    category: str
    size: Size
    slot_m: float


def furnish_bathroom(floor: Floor) -> None:
    """The fullest of a few tries, from generous sizes to the smallest."""
    wanted = _programme(floor)
    for generous in (1.0, 0.6, 0.3, 0.0, 0.0):
        mark = floor.mark()
        missing = [name for name in wanted if not _put(floor, _fitting(floor, name, generous))]
        if not missing:
            return
        floor.undo(mark)
    _put_most_important(floor, wanted)


def _programme(floor: Floor) -> list[str]:
    """What belongs here, the piece that is hardest to place first."""
    dice = floor.dice
    if floor.area_m2 < 1.9:
        return ["toilet", "washbasin"] if floor.area_m2 > 1.1 else ["toilet"]
    bathing = "bathtub" if floor.area_m2 > 4.2 and dice.random() < 0.25 else "shower"
    wanted = [bathing, "toilet", "washbasin"] if dice.random() < 0.5 else [
        bathing, "washbasin", "toilet"
    ]  # fmt: skip
    if floor.area_m2 > 8.0 and bathing == "bathtub":
        wanted.append("shower")
    if floor.area_m2 > 5.0 and dice.random() < 0.1:
        wanted.append("washing_machine")
    return wanted


def _put_most_important(floor: Floor, wanted: list[str]) -> None:
    """Too small for the whole programme: toilet first, then what else fits."""
    order = ["toilet", "washbasin", *(name for name in wanted if name not in _DRY)]
    best: tuple[int, list[str]] = (-1, order)
    for names in (order, [order[-1], *order[:-1]], ["washbasin", "toilet"]):
        mark = floor.mark()
        count = sum(_put(floor, _fitting(floor, name, 0.0)) for name in names)
        if count > best[0]:
            best = (count, names)
        floor.undo(mark)
    for name in best[1]:
        _put(floor, _fitting(floor, name, 0.0))


_DRY = ("toilet", "washbasin")


def _fitting(floor: Floor, category: str, generous: float) -> Fitting:
    """generous: 1 samples the whole range of sizes, 0 gives the smallest."""
    dice, roomy = floor.dice, min(1.0, floor.area_m2 / 6.0) * generous
    if category == "toilet":
        size = (0.4, sizes.between(dice, 0.62, 0.62 + 0.14 * roomy, 0.02), 0.78)
        return Fitting(category, size, TOILET_SLOT_M + 0.2 * roomy)
    if category == "washbasin":
        length = sizes.between(dice, 0.45 + 0.15 * roomy, 0.5 + 0.75 * roomy)
        size = (length, sizes.between(dice, 0.4, 0.45 + 0.12 * roomy), 0.85)
    elif category == "shower":
        length = sizes.between(dice, 0.75 + 0.05 * roomy, 0.8 + 0.5 * roomy)
        depth = min(length, sizes.between(dice, 0.75, 0.8 + 0.3 * roomy))
        size = (length, depth, 2.0)
    elif category == "bathtub":
        length = sizes.between(dice, 1.4, 1.4 + 0.4 * roomy)
        size = (length, sizes.between(dice, 0.7, 0.7 + 0.15 * roomy), 0.55)
    else:
        size = (0.6, sizes.between(dice, 0.55, 0.65), 0.85)
    return Fitting(category, size, size[0])


def _put(floor: Floor, fitting: Fitting) -> bool:
    category, size, slot = fitting
    best: tuple[float, Spot, float] | None = None
    for spot in floor.spots(size[1], size[2], REACH_M[category], slot):
        width = slot
        if category in ("shower", "bathtub") and spot.length - slot < 0.25:
            width = min(spot.length, _longest(category))
        s = anchored(floor, spot, width)
        score = _score(floor, category, spot, s, size) + floor.dice.uniform(0.0, 0.5)
        if best is None or score > best[0]:
            best = (score, spot, s)
            grown = (width if category != "toilet" else size[0], size[1], size[2])
            chosen = grown
    if best is None:
        return False
    floor.new_group()
    floor.put(
        category, best[1].wall, best[2], chosen, reach=REACH_M[category],
        core=category == "toilet",
    )  # fmt: skip
    return True


def _longest(category: str) -> float:
    return 1.4 if category == "shower" else 1.8


def _score(floor: Floor, category: str, spot: Spot, s: float, size: Size) -> float:
    """Wet pieces in the far corner, the basin near the door, the toilet not facing the door."""
    away = floor.distance_to_door(*spot.wall.world(s, size[1] / 2))
    corner = spot.s_from < 1e-6 or spot.s_to > spot.wall.length - 1e-6
    if category in ("shower", "bathtub"):
        ends = (spot.s_from < 1e-6) + (spot.s_to > spot.wall.length - 1e-6)
        filled = spot.length - size[0] < 0.25
        return 1.2 * min(away, 3.0) + 0.6 * ends + 0.8 * filled - 0.4 * spot.wall.has_window
    if category == "washbasin":
        return 0.5 * corner - 0.3 * abs(away - 1.2)
    return 0.5 * corner + 0.3 * min(away, 2.0)
