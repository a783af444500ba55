"""Wet rooms: toilet, washbasin, washing machine, and a shower or a bathtub, each with room in front
of it."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from chord_usd.base.metrics.complete import FEWER_BELOW_M2
from chord_usd.workshop.data.furnish import sizes
from chord_usd.workshop.data.furnish.floor import Floor
from chord_usd.workshop.data.furnish.free_spans import Wall
from chord_usd.workshop.data.furnish.hints import hinted_distance
from chord_usd.workshop.data.furnish.joint import Fitting, place_jointly

REACH_M = {"bathtub": 0.5, "shower": 0.45, "toilet": 0.5, "washbasin": 0.55, "washing_machine": 0.6}
"""Free floor in front of each; those that are hardest to place come first."""

TOILET_SLOT_M = 0.7
"""Width that a toilet needs between its neighbours."""

NARROW_ROOM_M = 1.9
"""Between walls nearer than this there is a way past fittings on one side only."""

_HAND_BASIN_M2 = 1.3
"""A WC has a basin from this size on."""

FEW_TRIES, MOST_TRIES = 5, 24
"""Placements tried for one list of fittings: before smaller ones are taken, for the smallest."""

_BATHING = ("shower", "bathtub")
_OTHER_BATHING = {"shower": "bathtub", "bathtub": "shower"}
_BY_NEED = ("toilet", "washbasin", "shower", "bathtub")
_LONGEST_M = {"shower": 1.4, "bathtub": 1.8}


def furnish_bathroom(floor: Floor, *, has_wc: bool = False) -> None:
    """The fullest programme that fits, from generous sizes to the smallest; then the laundry.

    has_wc: whether the home has a WC apart, so that a small bathroom does without a toilet.
    """
    if floor.kind != "bathroom":
        _place_programme(floor, _served(floor))
        return
    _place_programme(floor, _programme(floor, has_wc))
    shown = [name for name, _, _ in floor.hints]
    # Drawings show washing machines as a second basin.
    has_machine = "washing_machine" in shown or shown.count("washbasin") > 1
    share = floor.mix.washing_machine
    if has_machine or (floor.area_m2 > 5.0 and floor.dice.random() < share):
        machine = _fitting(floor, "washing_machine", 0.4)
        place_jointly(floor, [machine], partial(_liking, floor), FEW_TRIES)


def _place_programme(floor: Floor, wanted: list[str]) -> None:
    liking = partial(_liking, floor)
    for generous in (1.0, 0.4, 0.0):
        tries = FEW_TRIES if generous else MOST_TRIES
        fittings = [_fitting(floor, name, generous) for name in wanted]
        if place_jointly(floor, fittings, liking, tries):
            return
    for names in _fewer(wanted):
        fittings = [_fitting(floor, name, 0.0) for name in names]
        if place_jointly(floor, fittings, liking, MOST_TRIES):
            return


def _served(floor: Floor) -> list[str]:
    """What belongs into a WC or a washroom; a room for one piece holds the one it is there for."""
    first = "toilet" if floor.kind == "wc" else "washing_machine"
    least_m2 = _HAND_BASIN_M2 if floor.kind == "wc" else FEWER_BELOW_M2[floor.kind][0][0]
    wanted = {first, "washbasin"} if floor.area_m2 >= least_m2 else {first}
    return [name for name in REACH_M if name in wanted]


def _programme(floor: Floor, has_wc: bool) -> list[str]:
    """What belongs here, the piece that is hardest to place first."""
    dice, mix = floor.dice, floor.mix
    shown = {name for name, _, _ in floor.hints if name in REACH_M}
    if "bathtub" in shown or "shower" in shown:
        bathing = "bathtub" if "bathtub" in shown else "shower"
    else:
        bathing = "bathtub" if floor.area_m2 > 4.0 and dice.random() < mix.bathtub else "shower"
    # Now and then the basin stands outside, in front of the bathroom.
    has_basin = floor.area_m2 > 5.5 or dice.random() < mix.washbasin
    if floor.area_m2 >= 3.0:
        wanted = {bathing, "toilet", "washbasin"} if has_basin else {bathing, "toilet"}
    elif shown:
        wanted = set()
    elif floor.area_m2 >= 1.9:
        wanted = {bathing, "washbasin" if has_wc else "toilet"}
    else:
        wanted = {"toilet", "washbasin"} if floor.area_m2 > 1.1 else {"toilet"}
    wanted |= shown - {"washing_machine"}
    for name in ("washbasin", "toilet") if has_wc else ("toilet", "washbasin"):
        if floor.area_m2 >= 2.0 and len(wanted) < 2:
            wanted.add(name)
    if floor.area_m2 > 7.0 and bathing == "bathtub":
        wanted.add("shower")
    return [name for name in REACH_M if name in wanted]


def _fewer(wanted: list[str]) -> list[list[str]]:
    """Programmes for rooms too small for the one wanted: the least needed piece goes first.

    A bathtub is lower than the sill and may stand at a window, where no shower can.
    """
    swapped = [_OTHER_BATHING.get(name, name) for name in wanted]
    by_need = sorted(wanted, key=_BY_NEED.index)
    return [swapped, *(by_need[:count] for count in range(len(by_need) - 1, 0, -1))]


def _fitting(floor: Floor, category: str, generous: float) -> Fitting:
    """generous: 1 samples the whole range of sizes, 0 gives the smallest."""
    dice, roomy = floor.dice, min(1.0, floor.area_m2 / 6.0) * generous
    slot = 0.0
    if category == "toilet":
        size = (0.4, sizes.between(dice, 0.62, 0.62 + 0.14 * roomy, 0.02), 0.78)
        slot = TOILET_SLOT_M + 0.2 * roomy
    elif category == "washbasin":
        length = sizes.between(dice, 0.45 + 0.15 * roomy, 0.5 + 0.75 * roomy)
        size = (length, sizes.between(dice, 0.4, 0.45 + 0.12 * roomy), 0.85)
    elif category == "shower":
        length = sizes.between(dice, 0.75 + 0.05 * roomy, 0.8 + 0.5 * roomy)
        depth = min(length, sizes.between(dice, 0.75, 0.8 + 0.3 * roomy))
        size = (length, depth, 2.0)
    elif category == "bathtub":
        length = sizes.between(dice, 1.4, 1.5 + 0.3 * roomy)
        size = (length, sizes.between(dice, 0.7, 0.7 + 0.15 * roomy), 0.55)
    else:
        size = (0.6, sizes.between(dice, 0.55, 0.65), 0.85)
    return Fitting(category, size, REACH_M[category], slot, _LONGEST_M.get(category, 0.0))


def _liking(
    floor: Floor, fitting: Fitting, wall: Wall, s: float, corners: int, used: Sequence[Wall]
) -> float:
    """Wet pieces in the far corner, the basin near the door, the toilet between them."""
    category = fitting.category
    x, y = wall.world(s, 0.3)
    together = _together(wall, used)
    if floor.hints:
        return together + 0.3 * corners - 2.0 * hinted_distance(floor, category, x, y)
    away = floor.distance_to_door(x, y)
    if category in _BATHING:
        return together + 1.2 * min(away, 3.0) + 1.4 * corners
    if category == "washbasin":
        return together + 0.3 * corners - 0.3 * abs(away - 1.2) - 0.2 * wall.has_window
    return together + 0.4 * corners + 0.3 * min(away, 2.0)


def _together(wall: Wall, used: Sequence[Wall]) -> float:
    """Fittings share a wall; on both sides of a narrow room they would close the way."""
    liking = 0.0
    for other in used:
        if other is wall:
            liking += 0.4
        elif (
            wall.ux * other.ux + wall.uy * other.uy < -0.99
            and wall.local(other.x, other.y)[1] < NARROW_ROOM_M
        ):
            liking -= 1.0
    return liking
