"""Procedural houses of several storeys: the same outer walls and stairs, other rooms on each.

A hall runs through the house between two rows of rooms; the stair stands in it, or in a bay of it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import get_args

import numpy as np

from chord_usd.base.scene.json_stairs import stair_to_json
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.storeys import STAIRS, Stair, StairForm, StoreyPlan, Turn, storey_title
from chord_usd.base.scene.types import Box, Plan, RoomKind
from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.floorplans.placed_openings import (
    MARGIN,
    NoPlaceError,
    Stretch,
    Walls,
    find_walls,
    make_openings,
)
from chord_usd.workshop.data.floorplans.sketch import (
    HALF_WALL,
    STEP_M,
    Bounds,
    Sketch,
    faces,
    rectangle,
)
from chord_usd.workshop.data.houses import plan_of

_MOST_DRAWS = 200

_BEHIND = 110
"""Floor behind a spiral stair and beside what turns off, in steps."""

_WIDTHS: dict[RoomKind, tuple[int, int]] = {
    "living": (420, 640), "kitchen": (250, 380), "dining": (300, 400), "study": (250, 340),
    "bedroom": (290, 430), "bathroom": (190, 270), "store": (150, 210),
}  # fmt: skip
"""Least and usual most along the hall, between the middle lines of walls, in steps."""

_SMALL: tuple[RoomKind, ...] = ("store", "bathroom")
"""Kinds that take no floor that is left over."""

_GROUND: tuple[RoomKind, ...] = ("living", "kitchen", "bathroom")
_GROUND_MORE: tuple[RoomKind, ...] = ("dining", "study", "store", "bedroom")
_UPPER: tuple[RoomKind, ...] = ("bedroom", "bathroom", "bedroom")
_UPPER_MORE: tuple[RoomKind, ...] = ("bedroom", "study", "bathroom", "store", "bedroom")


@dataclass(frozen=True)
class _Frame:
    """What all storeys of a house share; steps, x along the hall."""

    width: int
    south: int
    """Depth of the southern row, to the middle of the hall's wall."""
    hall: int
    depth: int
    """Of the whole house."""
    bay: tuple[int, int] | None
    """The part of the northern row that belongs to the hall, along x."""
    stair: Stair
    """Up from the ground floor."""

    def stair_at(self, level: int) -> Stair:
        """Up from a storey: a spiral stair begins where the one below ends, others where it did."""
        if self.stair.form != "spiral":
            return self.stair
        quarter = 90.0 if self.stair.turn == "left" else -90.0
        yaw_deg = self.stair.box.yaw_deg + quarter * level
        return replace(self.stair, box=replace(self.stair.box, yaw_deg=yaw_deg))

    @property
    def slots(self) -> list[Bounds]:
        """Where rooms can be."""
        north, top = self.south + self.hall, self.depth
        low, high = self.bay or (self.width, self.width)
        spans = [(0, low), (high, self.width)]
        slots: list[Bounds] = [(0, 0, self.width, self.south)]
        return slots + [(a, north, b, top) for a, b in spans if b > a]


def random_storeys(
    rng: np.random.Generator, storeys: int = 2, forms: Sequence[StairForm] = get_args(StairForm)
) -> tuple[StoreyPlan, ...]:
    """A house of two or three storeys, the lowest first, registered by its stairs.

    forms: of stairs, which are drawn among.

    The same state of rng gives the same house. Raises ValueError for another number of storeys.
    """
    if storeys not in (2, 3):
        raise ValueError(f"storeys must be 2 or 3, not {storeys}")
    dice = Dice(rng)
    for _ in range(_MOST_DRAWS):
        try:
            frame = _draw_frame(dice, forms)
            plans = [_draw_storey(dice, frame, level, storeys) for level in range(storeys)]
        except NoPlaceError:
            continue
        pose = Pose(dice.chance(0.5), yaw_deg=90.0 * dice.steps(0, 3))
        return tuple(
            StoreyPlan(_posed(plan, frame, level, storeys, pose), storey_title(level))
            for level, plan in enumerate(plans)
        )
    raise RuntimeError(f"no sound house of {storeys} storeys in {_MOST_DRAWS} draws")


def _draw_frame(dice: Dice, forms: Sequence[StairForm]) -> _Frame:
    form = dice.pick(list(forms))
    south, north = dice.steps(360, 470), dice.steps(350, 430)
    width = dice.steps(860, 1240)
    if form == "straight":
        hall = 24 + 95 + dice.steps(110, 140)
        length = dice.steps(390, 440)
        start = dice.steps(130, width - length - 150)
        middle = ((start + length / 2) * STEP_M, (south + hall - HALF_WALL - 95 / 2) * STEP_M)
        box = Box((*middle, 0.0), (0.95, length * STEP_M, 1.0), -90.0)
        return _Frame(width, south, hall, south + hall + north, None, Stair("stair", form, box))
    hall = 24 + dice.steps(110, 150)
    inner = north - 24
    turns_off = form in ("L", "winder_L", "spiral")
    turn: Turn = "right" if turns_off else dice.pick(["left", "right"])
    beyond = 0
    if form == "U":
        across, depth = dice.steps(190, 215), inner
    elif form == "winder_U":
        across, depth = dice.steps(178, 212), dice.steps(235, 280)
    elif form == "winder_L":
        across, depth = dice.steps(165, 210), min(inner, dice.steps(295, 330))
    elif form == "spiral":  # on the third storey one steps off behind it
        across = depth = dice.steps(196, 230)
        turn, beyond = "left", min(_BEHIND, inner - depth)
    else:
        across, depth = dice.steps(275, 300), min(inner, dice.steps(300, 330))
    bay_width = across + 24 + (_BEHIND if turns_off else 0)
    start = dice.pick([0, width - bay_width, dice.steps(300, max(300, width - bay_width - 300))])
    if start < 0 or start + bay_width > width:
        raise NoPlaceError("stair")
    x = (start + HALF_WALL + across / 2) * STEP_M
    top = south + hall + north - HALF_WALL - beyond
    y = (top - depth / 2) * STEP_M
    box = Box((x, y, 0.0), (across * STEP_M, depth * STEP_M, 1.0), 0.0)
    bay = (start, start + bay_width)
    stair = Stair("stair", form, box, turn)
    return _Frame(width, south, hall, south + hall + north, bay, stair)


def _draw_storey(dice: Dice, frame: _Frame, level: int, storeys: int) -> Plan:
    sketch = Sketch()
    south, north = frame.south, frame.south + frame.hall
    hall = rectangle(0, south, frame.width, north)
    if frame.bay:
        low, high = frame.bay
        hall = [(0, south), (frame.width, south)]
        hall += [(frame.width, north)] if high < frame.width else []
        hall += [(high, north)] if high < frame.width else []
        hall += [(high, frame.depth), (low, frame.depth)]
        hall += [(low, north), (0, north)] if low > 0 else []
    sketch.add("corridor", list(hall))
    _fill(dice, frame, sketch, level)
    inner = faces(sketch)
    walls = find_walls(inner)
    _keep_clear(walls, frame.stair)
    return plan_of(sketch, inner, make_openings(dice, sketch, walls, entrance=level == 0))


def _fill(dice: Dice, frame: _Frame, sketch: Sketch, level: int) -> None:
    """Divide the slots among the rooms of a storey, what it cannot do without first."""
    needed, more = (_GROUND, _GROUND_MORE) if level == 0 else (_UPPER, _UPPER_MORE)
    wanted = [*needed, *dice.shuffled(more)]
    slots = sorted(frame.slots, key=lambda slot: slot[0] - slot[2])
    held: list[list[RoomKind]] = [[] for _ in slots]
    for number, kind in enumerate(wanted):
        free = [
            (slot[2] - slot[0] - sum(_WIDTHS[room][0] for room in rooms), index)
            for index, (slot, rooms) in enumerate(zip(slots, held, strict=True))
        ]
        fitting = [pair for pair in free if pair[0] >= _WIDTHS[kind][0]]
        if fitting:
            empty = [pair for pair in fitting if not held[pair[1]]]
            held[max(empty or fitting)[1]].append(kind)
        elif number < len(needed):
            raise NoPlaceError(kind)
    for slot, rooms in zip(slots, held, strict=True):
        if not rooms:
            raise NoPlaceError("an empty row")
        _divide(dice, sketch, slot, dice.shuffled(rooms))


def _divide(dice: Dice, sketch: Sketch, slot: Bounds, rooms: list[RoomKind]) -> None:
    x0, y0, x1, y1 = slot
    spare = x1 - x0 - sum(_WIDTHS[kind][0] for kind in rooms)
    most = {kind: _WIDTHS[kind][1] * (1.2 if kind in _SMALL else 2.0) for kind in rooms}
    if spare > sum(most[kind] - _WIDTHS[kind][0] for kind in rooms):
        raise NoPlaceError("too much floor")
    shares = [
        (_WIDTHS[kind][1] - _WIDTHS[kind][0]) * (0.5 + dice.unit())
        * (0.2 if kind in _SMALL else 1.0) for kind in rooms
    ]  # fmt: skip
    left = x0
    for index, (kind, share) in enumerate(zip(rooms, shares, strict=True)):
        wide = _WIDTHS[kind][0] + int(spare * share / sum(shares))
        right = x1 if index == len(rooms) - 1 else left + wide
        sketch.add(kind, rectangle(left, y0, right, y1))
        left = right


def _keep_clear(walls: Walls, stair: Stair) -> None:
    """No door or window in walls beside the stair."""
    length, depth = stair.box.size_m[:2]
    across, along = (depth, length) if abs(stair.box.yaw_deg) == 90.0 else (length, depth)
    x, y = stair.box.center_m[0] / STEP_M, stair.box.center_m[1] / STEP_M
    half_x, half_y = across / STEP_M / 2 + HALF_WALL + 2, along / STEP_M / 2 + HALF_WALL + 2
    area = (x - half_x, y - half_y, x + half_x, y + half_y)
    for stretches in (*walls.shared.values(), *walls.outer.values()):
        stretches[:] = [part for stretch in stretches for part in _outside(stretch, area)]


def _outside(stretch: Stretch, area: Bounds) -> list[Stretch]:
    axis = 0 if stretch.direction[0] else 1
    low, line = stretch.start[axis], stretch.start[1 - axis]
    high = low + stretch.length
    if not area[1 - axis] < line < area[3 - axis]:
        return [stretch]
    spans = [(low, min(high, area[axis])), (max(low, area[axis + 2]), high)]
    pieces = []
    for start, end in spans:
        if end - start > 2 * MARGIN:
            at = (start, line) if axis == 0 else (line, start)
            pieces.append(replace(stretch, start=at, length=end - start))
    return pieces


def _posed(plan: Plan, frame: _Frame, level: int, storeys: int, pose: Pose) -> Plan:
    """The plan turned and mirrored, with its stairs up and down."""

    def in_pose(stair: Stair) -> Stair:
        turn = stair.turn
        if pose.mirrored:
            turn = "left" if turn == "right" else "right"
        return replace(stair, box=pose.box(stair.box), turn=turn)

    up, down = in_pose(frame.stair_at(level)), in_pose(frame.stair_at(level - 1))
    shown = [replace(up, id=f"stair{level}", leads="up")] if level < storeys - 1 else []
    shown += [replace(down, id=f"stair{level}_down", leads="down")] if level else []
    return replace(posed(plan, pose), extra={STAIRS: [stair_to_json(stair) for stair in shown]})
