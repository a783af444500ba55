"""Supporting pieces as they stand in rooms: size, outline, and what is at which side."""

from __future__ import annotations

from dataclasses import dataclass

from chord_usd.base.raster.table_top import SIDES, Border, Side, TableTop
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Box, RoomKind
from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.tabletops.board import Outline

SHARES: tuple[tuple[str, float], ...] = (
    ("table", 0.2),
    ("dining_table", 0.2),
    ("coffee_table", 0.16),
    ("bedside_table", 0.12),
    ("tv_cabinet", 0.12),
    ("side_coffee_table", 0.08),
    ("double_door_floor_cabinet", 0.07),
    ("single_door_floor_cabinet", 0.05),
)
"""How often each category is drawn; those with more on them more often."""

STRETCH_M = 0.08
"""Pieces may be this much smaller or larger than the palette's usual ones."""

CHAIR_M, SEAT_GAP_M = 0.46, 0.08
"""Width of a seat at a table, and room between two."""

_ROUND_CHANCE = {
    "dining_table": 0.35, "coffee_table": 0.45, "side_coffee_table": 0.7, "bedside_table": 0.2
}  # fmt: skip
_SOFT_CORNERS_M = (0.0, 0.0, 0.03, 0.12)


@dataclass(frozen=True)
class Piece:
    """A supporting piece before anything is on it."""

    category: str
    outline: Outline
    borders: tuple[Border, ...]
    room: RoomKind = "unknown"
    """Where it stands."""

    @property
    def top(self) -> TableTop:
        """The piece as the condition shows it."""
        size_m = (self.outline.length_m, self.outline.width_m)
        return TableTop(self.category, size_m, self.outline.mask(), self.borders, self.room)

    def sides(self, kind: str) -> tuple[Side, ...]:
        """Sides at which there is something of this kind."""
        return tuple(dict.fromkeys(b.side for b in self.borders if b.kind == kind))

    def seats(self) -> tuple[Border, ...]:
        """Where somebody sits."""
        return tuple(border for border in self.borders if border.kind == "seat")


def random_piece(dice: Dice) -> Piece:
    """One supporting piece of a random category."""
    name = dice.weighted(SHARES)
    row = category(name)
    length = dice.about(row.length_m[0] - STRETCH_M, row.length_m[1] + STRETCH_M)
    width = dice.about(row.width_m[0] - STRETCH_M / 2, row.width_m[1] + STRETCH_M / 2)
    if name == "table" and dice.chance(0.1):
        length, width = width + 0.2, width
    outline = _outline(dice, name, length, width)
    return Piece(name, outline, _borders(dice, name, outline), dice.pick(row.rooms))


def _outline(dice: Dice, name: str, length: float, width: float) -> Outline:
    if dice.chance(_ROUND_CHANCE.get(name, 0.0)):
        if dice.chance(0.5):
            length = width = (length + width) / 2 if name != "dining_table" else width + 0.1
        return Outline(length, width, min(length, width) / 2)
    corner = 0.0 if "cabinet" in name else dice.pick(_SOFT_CORNERS_M)
    holes = _television(dice, length, width) if name == "tv_cabinet" else ()
    return Outline(length, width, min(corner, length / 2, width / 2), holes)


def _television(dice: Dice, length: float, width: float) -> tuple[Box, ...]:
    """A set that stands on the cabinet near the wall, most often; else it hangs."""
    if dice.chance(0.25):
        return ()
    long = length * (0.5 + 0.36 * dice.unit())
    y = width / 2 - 0.06 - 0.06 * dice.unit()
    case = Box((0.0, y, 0.0), (long, 0.05 + 0.03 * dice.unit(), 0.6), 0.0)
    deep = 0.12 + 0.1 * dice.unit()
    at = long * (0.2 + 0.15 * dice.unit())
    feet = [Box((side * at, y, 0.0), (0.03 + 0.04 * dice.unit(), deep, 0.05), 0.0)
            for side in (-1, 1)]  # fmt: skip
    return case, *feet


def _borders(dice: Dice, name: str, outline: Outline) -> tuple[Border, ...]:
    if name == "table":
        return _desk(dice, outline)
    if name == "dining_table":
        return _dining(dice, outline)
    if name in ("coffee_table", "side_coffee_table"):
        return _lounge(dice, outline)
    back = () if dice.chance(0.03) else (_whole(outline, "back", "wall"),)
    if name == "bedside_table":
        bed: Side = dice.pick(("left", "right"))
        other: Side = "left" if bed == "right" else "right"
        corner = (_whole(outline, other, "wall"),) if dice.chance(0.3) else ()
        beside = () if dice.chance(0.05) else (_whole(outline, bed, "bed"),)
        return (*back, *beside, *corner)
    chance = 0.15 if name == "tv_cabinet" else 0.2
    ends = [_whole(outline, side, "wall") for side in ("left", "right") if dice.chance(chance)]  # type: ignore[arg-type]
    return (*back, *ends)


def _desk(dice: Dice, outline: Outline) -> tuple[Border, ...]:
    at_front = dice.chance(0.85)
    behind: Side = "back" if at_front else "front"
    borders = [_whole(outline, behind, "wall")] if dice.chance(0.85) else []
    borders += [
        _whole(outline, side, "wall")
        for side in ("left", "right")
        if dice.chance(0.2)  # type: ignore[arg-type]
    ]
    if dice.chance(0.9):
        reach = max(outline.length_m / 2 - CHAIR_M / 2 - 0.02, 0.0)
        at = 0.0 if dice.chance(0.6) else dice.about(-reach, reach)
        borders.append(_seat("front" if at_front else "back", at))
    return tuple(borders)


def _dining(dice: Dice, outline: Outline) -> tuple[Border, ...]:
    walled: list[Side] = [side for side in SIDES if dice.chance(0.08)]
    borders = [_whole(outline, side, "wall") for side in walled]
    ends = dice.chance(0.3)
    for side in SIDES:
        if side in walled or dice.chance(0.08) or (side in ("left", "right") and not ends):
            continue
        length = max(_length(outline, side) - 1.2 * outline.corner_m, CHAIR_M)
        most = max(int((length - 0.1) / (CHAIR_M + SEAT_GAP_M)), 1)
        count = 1 if side in ("left", "right") else dice.steps(max(most - 1, 1), most)
        if side in ("left", "right") and dice.chance(0.3):
            continue
        step = length / count if dice.chance(0.7) else CHAIR_M + SEAT_GAP_M
        borders += [_seat(side, (k - (count - 1) / 2) * step) for k in range(count)]
    return tuple(borders)


def _lounge(dice: Dice, outline: Outline) -> tuple[Border, ...]:
    borders = []
    main = dice.pick(SIDES)
    for side in SIDES:
        if side == main or dice.chance(0.18):
            length = _length(outline, side)
            if side == main and dice.chance(0.7):
                borders.append(_whole(outline, side, "seat"))
            else:
                reach = max(length / 2 - 0.3, 0.0)
                borders.append(_seat(side, dice.about(-reach, reach)))
        elif dice.chance(0.08):
            borders.append(_whole(outline, side, "wall"))
    return tuple(borders) if dice.chance(0.93) else ()


def _length(outline: Outline, side: Side) -> float:
    return outline.length_m if side in ("front", "back") else outline.width_m


def _whole(outline: Outline, side: Side, kind: str) -> Border:
    half = _length(outline, side) / 2
    return Border(side, kind, -half, half)  # type: ignore[arg-type]


def _seat(side: Side, at: float) -> Border:
    return Border(side, "seat", at - CHAIR_M / 2, at + CHAIR_M / 2)
