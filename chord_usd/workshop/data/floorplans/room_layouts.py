"""Where the rooms lie: a few ways architects arrange a house, each with many free measures.

A public block (living, dining, kitchen) lies at x < 0; private rooms line a corridor along +x
(spine), or stand on both sides of the living room (hub), or there is one main room (studio).
"""

from __future__ import annotations

from dataclasses import dataclass, field

from chord_usd.base.scene.types import RoomKind
from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.floorplans.programme import Programme, floor_area
from chord_usd.workshop.data.floorplans.sketch import (
    STEP_M,
    WALL,
    Cell,
    Point,
    Sketch,
    rectangle,
    tidy,
)

_STEPS_PER_M2 = 1.0 / (STEP_M * STEP_M)

_LEAST_WIDTH: dict[RoomKind, int] = {
    "bedroom": 285, "study": 240, "bathroom": 165, "store": 125, "kitchen": 195,
}  # fmt: skip
"""Between middle lines, along the corridor."""

_DOOR_LEG = 125
"""Least width, between middle lines, of the part of a room that leads to its door."""


_LEAST_NIB = 110
"""Least width of the part of a room that reaches round a corridor's end."""


_DEEPER = 90
"""How much deeper than its row a single room may be."""


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


def _slot_width(dice: Dice, kind: RoomKind, depth: int) -> int:
    # Areas are of floors, widths between middle lines.
    width = floor_area(dice, kind) / max(depth - WALL, 100) + WALL
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
    width, strip = slot.width, _strip_width(dice, slot, depth)
    kind = slot.annexes[0]
    if len(slot.annexes) == 2:
        # A suite: bathroom and store share a strip along one side.
        cut = dice.steps(0.5 * depth, depth - 140)
        cut = cut if kind == "bathroom" else depth - cut
        room = rectangle(strip, 0, width, depth)
        boxes = [rectangle(0, 0, strip, cut), rectangle(0, cut, strip, depth)]
        annexes = list(zip(slot.annexes, boxes, strict=True))
    elif depth - _least_depth(kind) < 210 or dice.chance(0.15):
        room, annexes = rectangle(strip, 0, width, depth), [(kind, rectangle(0, 0, strip, depth))]
    else:
        along = dice.steps(_least_depth(kind), min(depth - 210, _least_depth(kind) + 80))
        room = [(strip, 0), (width, 0), (width, depth), (0, depth), (0, along), (strip, along)]
        annexes = [(kind, rectangle(0, 0, strip, along))]
    if dice.chance(0.4):
        # The annex on the outer wall, where it gets a window, not beside the corridor.
        room = [(u, depth - v) for u, v in room]
        annexes = [(kind, [(u, depth - v) for u, v in points]) for kind, points in annexes]
    if dice.chance(0.5):
        room = [(width - u, v) for u, v in room]
        annexes = [(kind, [(width - u, v) for u, v in points]) for kind, points in annexes]
    return room, annexes


def _least_depth(kind: RoomKind) -> int:
    return 195 if kind == "bathroom" else 150


def _strip_width(dice: Dice, slot: Slot, depth: int) -> int:
    """Width of what annexes take from the side of their slot."""
    if "bathroom" in slot.annexes:
        return dice.steps(170, 225) if depth < 420 else dice.steps(165, 200)
    return dice.steps(130, 190)


def _fill_rows(dice: Dice, slots: list[Slot], rows: tuple[Row, Row]) -> None:
    """Hand out slots to the shorter row in turn and give them widths."""
    for slot in slots:
        row = min(rows, key=lambda row: row.end)
        slot.width = _slot_width(dice, slot.kind, row.depth)
        if slot.annexes:
            small_m2 = sum(4.5 if kind == "bathroom" else 2.5 for kind in slot.annexes)
            slot.width += int(small_m2 * _STEPS_PER_M2 / row.depth)
            slot.width = max(slot.width, 225 + _LEAST_WIDTH[slot.kind])
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
    if wraps and (short.end < total or dice.chance(0.5)):
        # The last room of the longer row takes the corridor's end.
        length = short.end if short.end < total else dice.steps(needed, total - _LEAST_NIB)
        length = length if needed <= length <= total - _LEAST_NIB else total
    sketch = Sketch()
    for row, side in ((upper, 1), (lower, -1)):
        x, y = row.start, breadth if side > 0 else 0
        for slot in row.slots:
            depth = row.depth
            if slot.kind in ("bedroom", "study") and not slot.annexes and dice.chance(0.25):
                depth += dice.pick([dice.steps(-60, -30), dice.steps(30, _DEEPER)])
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
    two_sided = programme.corridor == 2 and not bent
    bottom = -lower - dice.pick([0, 0, dice.steps(40, 140)])
    top = breadth + upper + dice.pick([0, 0, dice.steps(-60, -30), dice.steps(30, 100)])
    block = Block(width, bottom, top, breadth, two_sided)
    _join(sketch, draw_public_block(dice, programme, block))
    if bent:
        _bend(dice, sketch, legs[1], length, breadth, lower)
    elif two_sided:
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
    # Single rooms are up to _DEEPER deeper than their row; past that, no gap too narrow to walk.
    reach = left.depth + _DEEPER + 60
    under = [cell.bounds for cell in sketch.cells if cell.bounds[2] > end - reach]
    left.start = int(max(top for _, _, _, top in under))
    flush = sum(
        max(min(x1, end) - max(x0, end - left.depth), 0)
        for x0, _, x1, y1 in under
        if y1 == left.start
    )
    if flush < left.depth:
        raise UnsoundError("a gap between the two rows of a bend")
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


def draw_hub(dice: Dice, programme: Programme) -> Sketch:
    """Rooms on both sides of a living room that serves as the hall."""
    slots = private_slots(dice, programme, 1)
    if programme.kitchen:
        slots.append(Slot("kitchen", 0))
    breadth = dice.steps(340, 460)
    left, right = Row(dice.steps(300, 400)), Row(dice.steps(290, 400))
    least = int(floor_area(dice, "living") * 0.9 / (breadth - WALL))
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


# The public block of a house: living room, dining room and kitchen beside a corridor -------------

_LEAST_KITCHEN = 195
_LEAST_DINING = 290
_WIDE_DINING = 300
"""What a dining room would like to be wide: a table, chairs on both sides, and a way past."""

_NECK = 150
"""Least width of the part of a living room that runs past the kitchen."""


@dataclass(frozen=True)
class Block:
    """Measures of a public block at x in [-width, 0]; the corridor is at y in [0, breadth]."""

    width: int
    bottom: int
    top: int
    breadth: int
    two_sided: bool
    """Whether a second corridor leaves it to the west."""


def draw_public_block(dice: Dice, programme: Programme, block: Block) -> Sketch:
    """Living room to the south, kitchen to the north, dining room (if any) between them."""
    kitchen_area = floor_area(dice, "kitchen")
    if not programme.dining:
        return _living_and_kitchen(dice, block, kitchen_area)
    if not block.two_sided and dice.chance(0.2):
        return _side_by_side(dice, block, kitchen_area)
    return _in_a_row(dice, block, kitchen_area)


def _living_and_kitchen(dice: Dice, block: Block, kitchen_area: float) -> Sketch:
    sketch = Sketch()
    deep = int(kitchen_area / (block.width - WALL)) + WALL
    if deep < _LEAST_KITCHEN or dice.chance(0.4):
        # In a corner that the living room runs past.
        edge = max(block.top - 270, block.breadth)
        wanted = kitchen_area / (block.top - edge - WALL) + WALL
        right = int(min(max(wanted, _LEAST_KITCHEN), block.width - _NECK)) - block.width
        corners: list[Point] = [
            (-block.width, block.bottom), (0, block.bottom), (0, block.top), (right, block.top),
            (right, edge), (-block.width, edge),
        ]  # fmt: skip
    else:
        edge, right = max(block.top - deep, block.breadth), 0
        corners = rectangle(-block.width, block.bottom, 0, edge)
    living = sketch.add("living", tidy(corners))
    kitchen = sketch.add("kitchen", rectangle(-block.width, edge, right, block.top))
    if dice.chance(0.2):
        sketch.open_pairs.append((living, kitchen))
    return sketch


def _in_a_row(dice: Dice, block: Block, kitchen_area: float) -> Sketch:
    """Living, dining, kitchen one after the other, or the kitchen west of the dining room."""
    sketch = Sketch()
    # A west corridor would end in a kitchen west of the dining room: it ends in the living room.
    low = block.breadth if block.two_sided else dice.pick([0, dice.steps(-80, -30), block.breadth])
    living = sketch.add("living", rectangle(-block.width, block.bottom, 0, low))
    deep = max(int(kitchen_area / (block.width - WALL)) + WALL, _LEAST_KITCHEN)
    edge = block.top - deep
    if edge - low < _LEAST_DINING or dice.chance(0.4):
        wanted = kitchen_area / (block.top - low - WALL) + WALL
        widest = max(block.width - _WIDE_DINING, min(_LEAST_KITCHEN, block.width - 240))
        right = int(min(max(wanted, _LEAST_KITCHEN), widest)) - block.width
        dining = sketch.add("dining", rectangle(right, low, 0, block.top))
        kitchen = sketch.add("kitchen", rectangle(-block.width, low, right, block.top))
    else:
        dining = sketch.add("dining", rectangle(-block.width, low, 0, edge))
        kitchen = sketch.add("kitchen", rectangle(-block.width, edge, 0, block.top))
    if dice.chance(0.7):
        sketch.open_pairs.append((living, dining))
    if dice.chance(0.2):
        sketch.open_pairs.append((dining, kitchen))
    return sketch


def _side_by_side(dice: Dice, block: Block, kitchen_area: float) -> Sketch:
    """The dining room between the living room and the corridor, the kitchen north of it."""
    sketch = Sketch()
    eat = dice.steps(270, 340)
    left = -eat - dice.steps(370, 480)
    bottom = dice.pick([block.bottom, dice.steps(-120, -40)])
    edge = block.top - max(int(kitchen_area / (eat - WALL)) + WALL, _LEAST_KITCHEN)
    edge = max(edge, block.breadth, bottom + _LEAST_DINING)
    dining = sketch.add("dining", rectangle(-eat, bottom, 0, edge))
    kitchen = sketch.add("kitchen", rectangle(-eat, edge, 0, max(block.top, edge + 200)))
    top = dice.pick([edge, kitchen.bounds[3], edge - dice.steps(40, 90)])
    living = sketch.add("living", rectangle(left, block.bottom, -eat, top))
    if dice.chance(0.8):
        sketch.open_pairs.append((living, dining))
    if top != edge and dice.chance(0.25):
        # Where all three meet in a corner of the outline, it would have no wall to stand in.
        sketch.open_pairs.append((dining, kitchen))
    return sketch
