"""Where the rooms lie: a few ways architects arrange a house, each with many free measures.

A public block (living, dining, kitchen) lies at x < 0; private rooms line a corridor along +x
(spine), or stand on both sides of the living room (hub), or there is one main room (studio).
"""

from __future__ import annotations

from dataclasses import dataclass, field

from chord_usd.data.floorplans.dice import Dice
from chord_usd.data.floorplans.programme import AREA_M2, Programme
from chord_usd.data.floorplans.sketch import (
    STEP_M,
    WALL,
    Cell,
    Point,
    Sketch,
    rectangle,
    tidy,
)
from chord_usd.types import RoomKind

_STEPS_PER_M2 = 1.0 / (STEP_M * STEP_M)

_LEAST_WIDTH: dict[RoomKind, int] = {
    "bedroom": 285, "study": 240, "bathroom": 165, "store": 125, "kitchen": 195,
}  # fmt: skip
"""Between middle lines, along the corridor."""

_DOOR_LEG = 125
"""Least width, between middle lines, of the part of a room that leads to its door."""


@dataclass(slots=True)
class Slot:
    """A room in a row, with the small rooms that are cut out of it."""

    kind: RoomKind
    width: int
    annexes: list[RoomKind] = field(default_factory=list)


@dataclass(slots=True)
class Row:
    """Slots along one side of a corridor."""

    depth: int
    start: int = 0
    slots: list[Slot] = field(default_factory=list)

    @property
    def end(self) -> int:
        """Where its last room ends."""
        return self.start + sum(slot.width for slot in self.slots)


def _area(dice: Dice, kind: RoomKind) -> float:
    low, high = AREA_M2[kind]
    return dice.about(low, high) * _STEPS_PER_M2


def _slot_width(dice: Dice, kind: RoomKind, depth: int) -> int:
    # Areas are of floors, widths between middle lines.
    width = _area(dice, kind) / max(depth - WALL, 100) + WALL
    return int(max(width, _LEAST_WIDTH[kind]))


def private_slots(dice: Dice, programme: Programme, shared_bathrooms: int) -> list[Slot]:
    """Bedrooms, studies, bathrooms and stores as slots of no width yet, annexes handed out."""
    bedrooms = [Slot("bedroom", 0) for _ in range(programme.bedroom)]
    slots = [Slot("study", 0) for _ in range(programme.study)]
    for index in range(programme.bathroom):
        hosts = [slot for slot in bedrooms if not slot.annexes]
        if index >= shared_bathrooms and hosts and dice.chance(0.8):
            hosts[0].annexes.append("bathroom")
        else:
            slots.append(Slot("bathroom", 0))
    for _ in range(programme.store):
        hosts = [slot for slot in bedrooms if len(slot.annexes) < 2]
        if hosts and dice.chance(0.6):
            hosts[0].annexes.append("store")
        else:
            slots.append(Slot("store", 0))
    return dice.shuffled(bedrooms) + dice.shuffled(slots)


# --- rows along a corridor -------------------------------------------------------------------


def _place_slot(
    dice: Dice, sketch: Sketch, slot: Slot, corner: Point, depth: int, side: int
) -> Cell:
    """Draw a slot whose corner nearest the corridor's start is given; side is +1 up, -1 down."""
    x0, y0 = corner

    def placed(points: list[Point]) -> list[Point]:
        return tidy([(x0 + u, y0 + side * v) for u, v in points])

    if not slot.annexes:
        return sketch.add(slot.kind, placed(rectangle(0, 0, slot.width, depth)))
    room, annexes = _with_annexes(dice, slot, depth)
    host = sketch.add(slot.kind, placed(room))
    for kind, points in annexes:
        sketch.add(kind, placed(points), host)
    return host


def _with_annexes(
    dice: Dice, slot: Slot, depth: int
) -> tuple[list[Point], list[tuple[RoomKind, list[Point]]]]:
    """The room left over and its annexes, in the slot's own frame (corridor at v = 0)."""
    width = slot.width
    if len(slot.annexes) == 2:
        # A suite: bathroom and store share a strip along one side.
        strip, cut = dice.steps(170, 215), dice.steps(0.5 * depth, 0.62 * depth)
        room = rectangle(strip, 0, width, depth)
        boxes = [rectangle(0, 0, strip, cut), rectangle(0, cut, strip, depth)]
        if dice.chance(0.5):
            boxes.reverse()
        annexes = list(zip(slot.annexes, boxes, strict=True))
    else:
        kind = slot.annexes[0]
        across, along = _annex_size(dice, kind, width, depth)
        room = [(across, 0), (width, 0), (width, depth), (0, depth), (0, along), (across, along)]
        annexes = [(kind, rectangle(0, 0, across, along))]
        if kind == "bathroom" and dice.chance(0.4):
            # On the outer wall instead, where it gets a window.
            room = [(u, depth - v) for u, v in room]
            annexes = [(kind, [(u, depth - v) for u, v in points]) for kind, points in annexes]
    if dice.chance(0.5):
        room = [(width - u, v) for u, v in room]
        annexes = [(kind, [(width - u, v) for u, v in points]) for kind, points in annexes]
    return room, annexes


def _annex_size(dice: Dice, kind: RoomKind, width: int, depth: int) -> tuple[int, int]:
    if kind == "store":
        across = min(dice.steps(130, 200), width - _DOOR_LEG)
        return across, dice.steps(150, 220)
    across = min(dice.steps(175, 235), width - _DOOR_LEG)
    return across, min(dice.steps(190, 270), depth - 210)


def _fill_rows(dice: Dice, slots: list[Slot], rows: tuple[Row, Row]) -> None:
    """Hand out slots to the shorter row in turn and give them widths."""
    for slot in slots:
        row = min(rows, key=lambda row: row.end)
        slot.width = _slot_width(dice, slot.kind, row.depth)
        if slot.annexes:
            extra = 195 if len(slot.annexes) == 2 else 60
            slot.width = max(slot.width + extra, 330)
        row.slots.append(slot)
    for row in rows:
        row.slots = dice.shuffled(row.slots)


def _even_out(dice: Dice, rows: tuple[Row, Row]) -> None:
    """Stretch the shorter row to the end of the longer one where that is not far."""
    short, long = sorted(rows, key=lambda row: row.end)
    if not short.slots or dice.chance(0.1):
        return
    lack = long.end - short.end
    if lack <= 0.3 * (short.end - short.start):
        share = lack // len(short.slots)
        for slot in short.slots:
            slot.width += share
        short.slots[-1].width += lack - share * len(short.slots)


def draw_leg(
    dice: Dice,
    slots: list[Slot],
    breadth: int,
    upper: Row,
    lower: Row,
    reach: int = 0,
    may_wrap: bool = True,
) -> tuple[Sketch, int]:
    """Rooms on both sides of a corridor along +x at y in [0, breadth], and how long that is.

    reach: the corridor is at least this long. may_wrap: the last room may take its end.
    """
    rows = (upper, lower)
    _fill_rows(dice, slots, rows)
    _even_out(dice, rows)
    needed = max([reach, *(row.end - row.slots[-1].width + _DOOR_LEG for row in rows if row.slots)])
    total = max(upper.end, lower.end, needed)
    short, long = sorted(rows, key=lambda row: row.end)
    last = long.slots[-1] if long.slots else None
    wraps = may_wrap and last is not None and last.kind in ("bedroom", "study") and not last.annexes
    length = total
    if wraps and total - needed > 60 and (short.end < total or dice.chance(0.5)):
        # The last room of the longer row takes the corridor's end.
        room_for = max(needed, short.end if short.end < total else 0)
        length = room_for if short.end < total else dice.steps(needed, total - 60)
    sketch = Sketch()
    for row, side in ((upper, 1), (lower, -1)):
        x, y = row.start, breadth if side > 0 else 0
        for slot in row.slots:
            depth = row.depth
            if slot.kind in ("bedroom", "study") and not slot.annexes and dice.chance(0.25):
                depth += dice.steps(-50, 90)
            cell = _place_slot(dice, sketch, slot, (x, y), depth, side)
            x += slot.width
            if slot is row.slots[-1] and row is long and length < total:
                _take_corridor_end(cell, length, total, breadth, side)
    return sketch, length


def _take_corridor_end(cell: Cell, start: int, end: int, breadth: int, side: int) -> None:
    """Let the last room of a row reach across the corridor beyond its end."""
    inner = breadth if side > 0 else 0
    outer = breadth - inner
    index = cell.corners.index((end, inner))
    piece: list[Point] = [(start, inner), (start, outer), (end, outer)]
    if side < 0:
        piece.reverse()
    cell.corners[index : index + 1] = piece
    cell.corners = tidy(cell.corners)


# --- whole houses ----------------------------------------------------------------------------


def draw_spine(dice: Dice, programme: Programme) -> Sketch:
    """A public block, and a corridor with private rooms on one or two sides of it."""
    slots = private_slots(dice, programme, 1 + dice.chance(0.25))
    breadth = dice.steps(125, 165)
    upper, lower = dice.steps(290, 400), dice.steps(360, 480)
    legs = [slots[0::2], slots[1::2]] if programme.corridor == 2 else [slots]
    bent = programme.corridor == 2 and dice.chance(0.5)
    sketch, length = _leg_with_corridor(dice, legs[0], breadth, upper, lower, may_wrap=not bent)
    width = dice.steps(370, 520)
    block = _public_block(dice, programme, width, breadth, upper, lower)
    _join(sketch, block)
    if programme.corridor == 2 and bent:
        _bend(dice, sketch, legs[1], length, breadth, lower)
    elif programme.corridor == 2:
        west, _ = _leg_with_corridor(dice, legs[1], breadth, upper, lower)
        for cell in west.cells:
            cell.corners = tidy([(-width - x, y) for x, y in cell.corners])
        _join(sketch, west)
    return sketch


def _join(sketch: Sketch, other: Sketch) -> None:
    sketch.cells += other.cells
    sketch.open_pairs += other.open_pairs


def _leg_with_corridor(
    dice: Dice, slots: list[Slot], breadth: int, upper: int, lower: int, may_wrap: bool = True
) -> tuple[Sketch, int]:
    rows = Row(upper), Row(lower)
    sketch, length = draw_leg(dice, slots, breadth, *rows, may_wrap=may_wrap)
    sketch.add("corridor", rectangle(0, 0, length, breadth))
    return sketch, length


def _bend(
    dice: Dice, sketch: Sketch, slots: list[Slot], end: int, breadth: int, lower: int
) -> None:
    """A second corridor from the end of the first one, to the north, with rooms on both sides."""
    left = Row(dice.steps(290, 380))
    left.start = int(max(c.bounds[3] for c in sketch.cells if c.bounds[2] > end - left.depth - 5))
    right = Row(dice.steps(320, 420), start=-dice.pick([0, lower]))
    first = next(cell for cell in sketch.cells if cell.kind == "corridor")
    across = dice.steps(130, 160)
    leg, length = draw_leg(dice, slots, across, left, right, reach=breadth, may_wrap=False)
    for cell in leg.cells:
        cell.corners = tidy([(end + across - y, x) for x, y in cell.corners])
    _join(sketch, leg)
    second = sketch.add("corridor", rectangle(end, 0, end + across, length))
    sketch.open_pairs.append((first, second))


class UnsoundError(Exception):
    """A draw that cannot become a house; draw again."""


def _public_block(
    dice: Dice, programme: Programme, width: int, breadth: int, upper: int, lower: int
) -> Sketch:
    """Living, dining and kitchen at x in [-width, 0], beside a corridor at y in [0, breadth]."""
    sketch = Sketch()
    bottom = -lower - dice.pick([0, 0, dice.steps(40, 140)])
    top = breadth + upper + dice.pick([0, 0, dice.steps(-60, 100)])
    kitchen = _area(dice, "kitchen")
    deep = int(kitchen / (width - WALL)) + WALL
    beside = deep < 190 or dice.chance(0.4)
    if programme.dining:
        middle = dice.pick([0, dice.steps(-80, 0), breadth])
        kitchen_at = top if beside else max(min(top - deep, top - 190), middle + 260)
        living = sketch.add("living", rectangle(-width, bottom, 0, middle))
        _dine_and_cook(dice, sketch, living, width, middle, kitchen_at, top, kitchen)
    else:
        edge = max(top - deep, breadth) if not beside else max(top - 270, breadth)
        if beside:
            across = _kitchen_across(kitchen, width, top - edge)
            living_corners: list[Point] = [
                (-width, bottom), (0, bottom), (0, top), (across - width, top),
                (across - width, edge), (-width, edge),
            ]  # fmt: skip
            living = sketch.add("living", tidy(living_corners))
            cook = sketch.add("kitchen", rectangle(-width, edge, across - width, top))
        else:
            living = sketch.add("living", rectangle(-width, bottom, 0, edge))
            cook = sketch.add("kitchen", rectangle(-width, edge, 0, top))
        if dice.chance(0.15):
            sketch.open_pairs.append((living, cook))
    return sketch


def _kitchen_across(area: float, width: int, depth: float) -> int:
    wanted = area / max(depth - WALL, 100) + WALL
    return int(min(max(wanted, 195), width - 150))


def _dine_and_cook(
    dice: Dice, sketch: Sketch, living: Cell, width: int, middle: int, kitchen_at: int,
    top: int, kitchen: float,
) -> None:  # fmt: skip
    """Dining north of the living room, the kitchen beyond it or beside it."""
    if kitchen_at < top:
        dining = sketch.add("dining", rectangle(-width, middle, 0, kitchen_at))
        cook = sketch.add("kitchen", rectangle(-width, kitchen_at, 0, top))
    else:
        across = _kitchen_across(kitchen, width - 90, top - middle)
        dining = sketch.add("dining", rectangle(across - width, middle, 0, top))
        cook = sketch.add("kitchen", rectangle(-width, middle, across - width, top))
    if dice.chance(0.7):
        sketch.open_pairs.append((living, dining))
    if dice.chance(0.2):
        sketch.open_pairs.append((dining, cook))


def draw_hub(dice: Dice, programme: Programme) -> Sketch:
    """Rooms on both sides of a living room that serves as the hall."""
    slots = private_slots(dice, programme, 1)
    if programme.kitchen:
        slots.append(Slot("kitchen", 0))
    breadth = dice.steps(340, 460)
    left, right = Row(dice.steps(300, 400)), Row(dice.steps(290, 400))
    least = int(_area(dice, "living") * 0.9 / (breadth - WALL))
    if programme.dining:
        least += dice.steps(270, 360)
    sketch, length = draw_leg(dice, slots, breadth, left, right, reach=max(least, 330))
    if programme.dining and length > 560:
        cut = dice.steps(260, min(0.45 * length, 380))
        cut = cut if dice.chance(0.5) else length - cut
        near, far = rectangle(0, 0, cut, breadth), rectangle(cut, 0, length, breadth)
        living, dining = (far, near) if cut < length / 2 else (near, far)
        hall = sketch.add("living", living)
        sketch.open_pairs.append((hall, sketch.add("dining", dining)))
    elif programme.dining:
        raise UnsoundError("no space for dining")
    else:
        sketch.add("living", rectangle(0, 0, length, breadth))
    return sketch


def draw_studio(dice: Dice, programme: Programme) -> Sketch:
    """One main room with bathroom and kitchen in the corners beside the door."""
    width, depth = dice.steps(360, 560), dice.steps(480, 760)
    sketch = Sketch()
    small = dice.steps(190, 280)
    corners = rectangle(0, 0, width, depth)
    bath = (dice.steps(165, 210), dice.steps(200, 280)) if programme.bathroom else (0, 0)
    if programme.bathroom:
        across, along = bath
        corners = [(across, 0), (width, 0), (width, depth), (0, depth), (0, along), (across, along)]
    if programme.kitchen:
        across = min(dice.steps(195, 260), width - bath[0] - _DOOR_LEG)
        if across < 170:
            raise UnsoundError("no space for the kitchen")
        tall = bath[1] if dice.chance(0.4) else small
        sketch.add("kitchen", rectangle(width - across, 0, width, tall))
        right = [(width - across, 0), (width - across, tall), (width, tall)]
        corners = [corners[0], *right, *corners[2:]]
    if programme.bathroom:
        sketch.add("bathroom", rectangle(0, 0, *bath))
    sketch.add("living" if dice.chance(0.7) else "bedroom", tidy(corners))
    return sketch


def draw_house(dice: Dice, programme: Programme) -> Sketch:
    """The cells of a house with this programme, balconies not yet among them.

    Raises UnsoundError where this draw of measures does not fit together.
    """
    if programme.corridor:
        return draw_spine(dice, programme)
    if programme.bedroom == 0:
        return draw_studio(dice, programme)
    return draw_hub(dice, programme)
