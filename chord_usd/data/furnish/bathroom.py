"""Bathrooms: toilet, washbasin, and a shower or a bathtub, each with room in front of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from chord_usd.data.furnish import sizes
from chord_usd.data.furnish.floor import Floor, Size
from chord_usd.data.furnish.hints import hinted_distance
from chord_usd.data.furnish.paths import path_faults
from chord_usd.data.furnish.walls import REACH, Wall

REACH_M = {"bathtub": 0.5, "shower": 0.45, "toilet": 0.5, "washbasin": 0.55, "washing_machine": 0.6}
"""Free floor in front of each; those that are hardest to place come first."""

TOILET_SLOT_M = 0.7
"""Width that a toilet needs between its neighbours."""

NICHE_M = 0.3
"""A shower or bathtub that leaves less than this beside it fills the whole niche."""

NARROW_ROOM_M = 1.9
"""Between walls nearer than this there is a way past fittings on one side only."""

FEW_TRIES, MOST_TRIES = 7, 24
"""Placements tried for one list of fittings: before smaller ones are taken, for the smallest."""


class Fitting(NamedTuple):
    """One fixture to place: its size, and the width of wall it takes."""

    category: str
    size: Size
    slot_m: float


class Place(NamedTuple):
    """A fitting at a wall."""

    score: float
    wall: Wall
    s: float
    size: Size


def furnish_bathroom(floor: Floor) -> None:
    """The fullest programme that fits, from generous sizes to the smallest."""
    wanted = _programme(floor)
    for generous in (1.0, 0.4, 0.0):
        tries = FEW_TRIES if generous else MOST_TRIES
        if _place_all(floor, [_fitting(floor, name, generous) for name in wanted], tries):
            return
    for names in _fewer(wanted):
        if _place_all(floor, [_fitting(floor, name, 0.0) for name in names], MOST_TRIES):
            return


def _programme(floor: Floor) -> list[str]:
    """What belongs here, the piece that is hardest to place first."""
    dice = floor.dice
    shown = [name for name, _, _ in floor.hints if name in REACH_M]
    if shown:
        # Drawings show washing machines as a second basin.
        twin = ["washing_machine"] if shown.count("washbasin") > 1 else []
        return [name for name in REACH_M if name in (*shown, *twin)]
    if floor.area_m2 < 1.9:
        return ["toilet", "washbasin"] if floor.area_m2 > 1.1 else ["toilet"]
    bathing = "bathtub" if floor.area_m2 > 4.0 and dice.random() < 0.08 else "shower"
    wanted = [bathing, "toilet"]
    # Now and then the basin stands outside, in front of the bathroom.
    if floor.area_m2 > 5.5 or dice.random() < 0.72:
        wanted.append("washbasin")
    if floor.area_m2 > 7.0 and bathing == "bathtub":
        wanted.insert(1, "shower")
    if floor.area_m2 > 5.0 and dice.random() < 0.06:
        wanted.append("washing_machine")
    return wanted


def _fewer(wanted: list[str]) -> list[list[str]]:
    """Programmes for rooms too small for the one wanted, fullest first.

    Where a toilet belongs nothing takes its place: a smaller one may still fit (furnish_least).
    """
    if "toilet" in wanted and wanted[0] not in _BATHING:
        return [["toilet", "washbasin"], ["toilet"]]
    if len(wanted) < 3 or wanted[0] not in _BATHING:
        smaller = ["shower" if name == "bathtub" else name for name in wanted]
        single = sorted(smaller, key=lambda name: name != "toilet")
        return [smaller, *([name] for name in single), ["toilet"], ["washbasin"]]
    usual = [["shower", "toilet", "washbasin"]]
    # A bathtub is lower than the sill and may stand at a window, where no shower can.
    if wanted[0] == "shower":
        usual.append(["bathtub", "toilet", "washbasin"])
    return [*usual, ["toilet", "washbasin"], ["shower", "toilet"], ["toilet"], ["washbasin"]]


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
        length = sizes.between(dice, 1.4, 1.5 + 0.3 * roomy)
        size = (length, sizes.between(dice, 0.7, 0.7 + 0.15 * roomy), 0.55)
    else:
        size = (0.6, sizes.between(dice, 0.55, 0.65), 0.85)
    return Fitting(category, size, size[0])


def _place_all(floor: Floor, fittings: Sequence[Fitting], most: int) -> bool:
    """Place every fitting, going back on earlier ones where later ones or the paths fail."""
    tries = [most]
    used: list[Wall] = []

    def place(rest: Sequence[Fitting]) -> bool:
        if not rest:
            return path_faults(floor) == 0
        for found in _places(floor, rest[0], used)[:6]:
            if tries[0] == 0:
                return False
            tries[0] -= 1
            mark = floor.mark()
            _put(floor, rest[0], found)
            used.append(found.wall)
            if place(rest[1:]):
                return True
            used.pop()
            floor.undo(mark)
        return False

    return place(fittings)


def _put(floor: Floor, fitting: Fitting, place: Place) -> None:
    floor.new_group()
    category, wall, s, depth = fitting.category, place.wall, place.s, place.size[1]
    floor.put(category, wall, s, place.size, core=category in ("toilet", "washbasin"))
    half = max(fitting.slot_m, place.size[0]) / 2
    floor.keep(wall, s - half, s + half, 0.0, depth + REACH_M[category], REACH)


def _places(floor: Floor, fitting: Fitting, used: Sequence[Wall]) -> list[Place]:
    """Both ends of every free span, best first."""
    category, size, slot = fitting
    found = []
    liking = {wall.index: _together(wall, used) for wall in floor.walls} if used else {}
    for spot in floor.spots(size[1], size[2], REACH_M[category], slot):
        fills = category in _BATHING and spot.length - slot < NICHE_M
        length = min(spot.length, _LONGEST_M[category]) if fills else size[0]
        width = max(slot, length)
        for s in dict.fromkeys((spot.s_from + width / 2, spot.s_to - width / 2)):
            corners = (s - width / 2 < 1e-6) + (s + width / 2 > spot.wall.length - 1e-6)
            score = _score(floor, category, spot.wall, s, corners)
            score += liking.get(spot.wall.index, 0.0)
            grown = (length, size[1], size[2])
            found.append(Place(score + floor.dice.random() * 0.5, spot.wall, s, grown))
    found.sort(key=lambda place: place.score, reverse=True)
    return found


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


_BATHING = ("shower", "bathtub")
_LONGEST_M = {"shower": 1.4, "bathtub": 1.8}


def _score(floor: Floor, category: str, wall: Wall, s: float, corners: int) -> float:
    """Wet pieces in the far corner, the basin near the door, the toilet between them."""
    x, y = wall.world(s, 0.3)
    if floor.hints:
        return 0.3 * corners - 2.0 * hinted_distance(floor, category, x, y)
    away = floor.distance_to_door(x, y)
    if category in _BATHING:
        return 1.2 * min(away, 3.0) + 1.4 * corners
    if category == "washbasin":
        return 0.3 * corners - 0.3 * abs(away - 1.2) - 0.2 * wall.has_window
    return 0.4 * corners + 0.3 * min(away, 2.0)
