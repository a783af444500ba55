"""The pieces of a room as a list, and the room around them as segments.

A room is told in a frame of its own: its middle is the origin, most of its walls run along x and y.
A piece is a category, the way it faces, and the lines that its footprint lies between; so is the
floor that an opening keeps clear. All are told on one grid: what touches has the same number, so
that a network says so by repeating it. Read back, a number that is the own one of a wall or of a
clear floor means exactly that line.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal

import numpy as np
import shapely

from chord_usd.base.metrics.clear_floor import ClearFloor, clearances
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.scene.geometry import footprint, resized, room_polygon
from chord_usd.base.scene.palette import CATEGORIES, Category, Level, Mount, ranked
from chord_usd.base.scene.types import (
    LEARNED_KINDS,
    Box,
    FloatArray,
    Item,
    Opening,
    Room,
    RoomKind,
    SceneGraph,
    learned_kind,
)
from chord_usd.base.scene.units import rotation_2d, wrap_deg
from chord_usd.line.lists.vocabulary import Element, Floats, Ints, Vocabulary

STEP_M = 0.05
PLACES = 168
"""8.4 m, in steps of STEP_M from the room's middle; larger rooms are told smaller."""

YAW_STEP_DEG = 15.0
YAWS = 24
LARGEST_M = 8.0

MOST_PIECES = 24
MOST_SEGMENTS = 64

CATEGORY_ORDER = ranked(Level.HOUSE)
"""Large and needed pieces first, what stands at others after them."""

KITCHEN_RUN = tuple(name for name in CATEGORY_ORDER if name in KITCHEN_UNITS)
"""Told along the walls: each unit begins where the last one ends."""

WARDROBE_DEPTH_M, TALL_M, CHEST_M = 0.475, 2.15, 0.9
"""A cabinet at least so deep gets a mesh about so high, another one that of a chest."""

SEGMENT_KINDS = (
    "wall", "door", "window", "low window", "passage", "open side",
    "clear of way", "clear of window", "clear of low window",
)  # fmt: skip
"""The last three are rectangles: floor that doors and passages keep free, or windows above their
sill, told from its lowest corner to its highest."""
TOUCHING_M = 0.05
"""Rooms whose outlines are no farther apart have no wall between them."""
LOW_SILL_M = 0.7
"""A window below it keeps out most furniture."""

Teacher = Literal["homes", "paper"]
TEACHERS: tuple[Teacher, ...] = ("homes", "paper")
"""Whose houses the network imitates (data.furnish.mix)."""
AREAS = 24
_LEAST_AREA_M2, _AREA_STEP = 1.0, 1.2
_ROOMS_A_FLAG = 3.0
"""Rooms of a kind for which its flag is 1."""

_FIRST_CLEAR = 1 + SEGMENT_KINDS.index("clear of way")
_CLEAR_OF = {
    kind: 1 + SEGMENT_KINDS.index(f"clear of {kind if 'window' in kind else 'way'}")
    for kind in ("door", "window", "low window", "passage")
}

_INDEX = {name: index for index, name in enumerate(CATEGORY_ORDER)}
_IN_RUN = frozenset(_INDEX[name] for name in KITCHEN_RUN)
_KINDS = {kind: index for index, kind in enumerate(LEARNED_KINDS)}

PIECES = Vocabulary(
    categories=CATEGORY_ORDER,
    ranges=(("yaw", YAWS), ("x", PLACES), ("y", PLACES)),
    slots=("yaw", "x", "y", "x", "y"),
    segments=1 + len(SEGMENT_KINDS),
    facts=(len(LEARNED_KINDS), len(TEACHERS), AREAS),
    flags=2 * len(CATEGORY_ORDER) + len(LEARNED_KINDS) + 1,
    most=MOST_PIECES,
    run=KITCHEN_RUN,
)


@dataclass(frozen=True)
class Frame:
    """Where a room's own frame lies."""

    middle_m: tuple[float, float]
    yaw_deg: float
    """Of its x axis, in [-45, 45)."""
    scale: float
    """By which the room is told smaller; 1 for all but the largest."""

    def points(self, points_m: FloatArray) -> FloatArray:
        """(..., 2) world points in the frame, scaled."""
        turned: FloatArray = (points_m - self.middle_m) @ rotation_2d(self.yaw_deg)
        return turned * self.scale

    def world(self, points_m: FloatArray) -> FloatArray:
        """Inverse of points."""
        turned: FloatArray = (points_m / self.scale) @ rotation_2d(self.yaw_deg).T
        return turned + np.array(self.middle_m)


@dataclass(frozen=True, eq=False)
class Around:
    """A room as the network sees it, without its pieces."""

    frame: Frame
    lines_m: FloatArray
    """(S, 4) x and y of both ends of each segment, or of opposite corners of clear floor; in the
    frame."""
    kinds: Ints
    """(S,) 1 + index into SEGMENT_KINDS."""
    facts: Ints
    """(3,) kind, teacher, area."""
    flags: Floats
    """What touching rooms hold, what other rooms hold, how many rooms of each kind the house has,
    and whether what others hold is told at all."""

    @property
    def kinds_of_home(self) -> list[RoomKind]:
        """The kind of each room of the house, in the order of LEARNED_KINDS."""
        counts = self.flags[2 * len(CATEGORY_ORDER) : -1] * _ROOMS_A_FLAG
        return [kind for kind, count in zip(LEARNED_KINDS, counts, strict=True)
                for _ in range(round(float(count)))]  # fmt: skip


def frame_of(room: Room) -> Frame:
    """The frame of a room's longest direction, in the middle of its extent along that."""
    sides = np.roll(room.polygon_m, -1, axis=0) - room.polygon_m
    lengths = np.hypot(*sides.T)
    angles = np.degrees(np.arctan2(sides[:, 1], sides[:, 0]))
    folded = (angles + 45.0) % 90.0 - 45.0
    apart = np.abs((folded[:, None] - folded[None] + 45.0) % 90.0 - 45.0)
    yaw_deg = float(folded[np.argmax((lengths * (apart < 2.0)).sum(axis=1))])
    yaw_deg = 0.0 if abs(yaw_deg) < 1e-6 else yaw_deg
    turned = room.polygon_m @ rotation_2d(yaw_deg)
    low, high = turned.min(axis=0), turned.max(axis=0)
    middle = rotation_2d(yaw_deg) @ ((low + high) / 2)
    scale = min(1.0, LARGEST_M / max(float((high - low).max()), 1e-6))
    return Frame((float(middle[0]), float(middle[1])), yaw_deg, scale)


def rooms_around(
    graph: SceneGraph, teacher: Teacher, listed: Iterable[str] | None = None
) -> list[Around]:
    """Every room of the house as the network sees it.

    told: ids of rooms whose pieces the others may know of; None where nothing is known of any.
    """
    known = None if listed is None else frozenset(listed)
    walls = [(room, _sides(room.polygon_m)) for room in graph.rooms]
    near = _near(graph.rooms)
    classes = [learned_kind(room.kind) for room in graph.rooms]
    counts = np.array([classes.count(kind) for kind in LEARNED_KINDS])
    held = {room.id: _held(graph.items_of(room.id)) for room in graph.rooms}
    clear = list(clearances(graph.rooms, graph.openings))
    arounds = []
    for room, sides in walls:
        frame = frame_of(room)
        lines, kinds = [*sides], [1] * len(sides)
        touching = []
        for at in near[room.id]:
            other, others = walls[at]
            shared = _shared(sides, others)
            if shared:
                touching.append(other.id)
                lines += shared
                kinds += [1 + SEGMENT_KINDS.index("open side")] * len(shared)
        for opening in graph.openings:
            side = _in_wall(opening, sides, room)
            if side is not None:
                lines.append(side)
                kinds.append(1 + SEGMENT_KINDS.index(_kind_of(opening)))
        points = frame.points(np.array(lines).reshape(-1, 2, 2))
        for opening, corners in _clear_floors(room, clear, frame):
            points = np.concatenate([points, corners[None]])
            kinds.append(_CLEAR_OF[_kind_of(opening)])
        points = points[:MOST_SEGMENTS]
        flags = _flags(room, graph.rooms, touching, held, counts, known)
        facts = np.array(
            [_KINDS[learned_kind(room.kind)], TEACHERS.index(teacher), _area(room)], np.int64
        )
        kinds_told = np.array(kinds[:MOST_SEGMENTS], np.int64)
        arounds.append(Around(frame, points.reshape(-1, 4), kinds_told, facts, flags))
    return arounds


def _area(room: Room) -> int:
    step = math.log(max(room_polygon(room).area, _LEAST_AREA_M2) / _LEAST_AREA_M2)
    return min(int(step / math.log(_AREA_STEP)), AREAS - 1)


def _held(items: Iterable[Item]) -> Floats:
    held = np.zeros(len(CATEGORY_ORDER), np.float32)
    for item in items:
        if item.category in _INDEX:
            held[_INDEX[item.category]] = 1.0
    return held


def _flags(
    room: Room,
    rooms: Sequence[Room],
    touching: Sequence[str],
    held: dict[str, Floats],
    counts: Ints,
    known: frozenset[str] | None,
) -> Floats:
    beside = np.zeros(len(CATEGORY_ORDER), np.float32)
    elsewhere = np.zeros_like(beside)
    for other in rooms:
        if known is not None and other is not room and other.id in known:
            into = beside if other.id in touching else elsewhere
            np.maximum(into, held[other.id], out=into)
    others = counts.astype(np.float32) / _ROOMS_A_FLAG
    return np.concatenate([beside, elsewhere, others, [float(known is not None)]]).astype(
        np.float32
    )


def _sides(polygon_m: FloatArray) -> list[FloatArray]:
    """(2, 2) start and end of every side."""
    return list(np.stack([polygon_m, np.roll(polygon_m, -1, axis=0)], axis=1))


def _near(rooms: Sequence[Room]) -> dict[str, list[int]]:
    """Numbers of the rooms that may touch one, by its id."""
    low = np.array([room.polygon_m.min(axis=0) for room in rooms]) - TOUCHING_M
    high = np.array([room.polygon_m.max(axis=0) for room in rooms]) + TOUCHING_M
    meets = ((low[:, None] <= high) & (high[:, None] >= low)).all(axis=2)
    return {
        room.id: [int(other) for other in np.flatnonzero(meets[at]) if other != at]
        for at, room in enumerate(rooms)
    }


def _shared(sides: Sequence[FloatArray], others: Sequence[FloatArray]) -> list[FloatArray]:
    """Stretches of our sides along which another room touches."""
    elements = []
    theirs = np.array(others)
    for side in sides:
        along = side[1] - side[0]
        length = float(np.hypot(*along))
        if length < 1e-6:
            continue
        along = along / length
        ahead = theirs - side[0]
        s = ahead @ along
        t = ahead @ np.array([-along[1], along[0]])
        low, high = np.maximum(s.min(axis=1), 0.0), np.minimum(s.max(axis=1), length)
        touches = (np.abs(t).max(axis=1) < TOUCHING_M) & (high - low > 0.3)
        elements += [
            np.array([side[0] + along * a, side[0] + along * b])
            for a, b in zip(low[touches], high[touches], strict=True)
        ]
    return elements


def _kind_of(opening: Opening) -> str:
    if opening.kind != "window":
        return opening.kind
    return "low window" if opening.box.center_m[2] < LOW_SILL_M else "window"


def _in_wall(opening: Opening, sides: Sequence[FloatArray], room: Room) -> FloatArray | None:
    """(2, 2) the span of an opening on the nearest side of the room, along that; None where it
    belongs to other rooms.
    """
    if opening.room_ids and room.id not in opening.room_ids:
        return None
    middle = np.array(opening.box.center_m[:2])
    turn = math.radians(opening.box.yaw_deg)
    direction = np.array([math.cos(turn), math.sin(turn)])
    best, nearest = None, opening.box.size_m[1] + 0.2
    for side in sides:
        along = side[1] - side[0]
        length = float(np.hypot(*along))
        if length < 1e-6 or abs(along @ direction) / length < 0.98:
            continue
        along = along / length
        s = float((middle - side[0]) @ along)
        t = abs(float((middle - side[0]) @ np.array([-along[1], along[0]])))
        half = opening.box.size_m[0] / 2
        low, high = max(s - half, 0.0), min(s + half, length)
        if t < nearest and high > low:
            best, nearest = np.array([side[0] + along * low, side[0] + along * high]), t
    return best


def _clear_floors(
    room: Room, clear: Iterable[ClearFloor], frame: Frame
) -> Iterator[tuple[Opening, FloatArray]]:
    """Openings, and (2, 2) the corners, in the frame, of what they keep clear of a room."""
    floor = room_polygon(room)
    shapely.prepare(floor)
    for opening, shape in clear:
        if floor.intersects(shape):
            shared = shape.intersection(floor)
            if shared.area > MIN_OVERLAP_M2:
                corners = frame.points(shapely.get_coordinates(shared))
                yield opening, np.stack([corners.min(axis=0), corners.max(axis=0)])


def segments_of(around: Around, turned: FloatArray | None = None) -> Ints:
    """(S, SEGMENT_FIELDS) the segments as numbers. turned: (S, 4) instead of the own lines."""
    lines = around.lines_m if turned is None else turned
    corners = lines.reshape(-1, 2, 2)
    sorted_corners = np.sort(corners, axis=1)
    is_clear = around.kinds >= _FIRST_CLEAR
    lines = np.where(is_clear[:, None, None], sorted_corners, corners).reshape(-1, 4)
    return np.concatenate([around.kinds[:, None], place(lines)], axis=1)


def place(position_m: FloatArray) -> Ints:
    """The line of the grid nearest to a coordinate of the frame."""
    # Neighbours share an edge: it has one number, however each of them rounds.
    index = np.rint(np.round(position_m / STEP_M, 6)).astype(np.int64) + PLACES // 2
    return np.clip(index, 0, PLACES - 1)


def place_m(index: Ints) -> FloatArray:
    """Metres, in the frame."""
    return (np.asarray(index) - PLACES // 2) * STEP_M


def pieces_of(
    items: Iterable[Item], frame: Frame, quarter_turns: int = 0, mirrored: bool = False
) -> list[Element]:
    """The pieces of a room, by the ranks of the vocabulary, then from left to right; those of the
    run counterclockwise about the room's middle, from its widest gap on.

    quarter_turns, mirrored: the room is mirrored in x, then turned so often.
    """
    elements = [
        _element(item, frame, quarter_turns, mirrored) for item in items if item.category in _INDEX
    ]
    elements.sort(key=lambda element: (element.category, element.values[1], element.values[2]))
    along = iter(_along_walls([element for element in elements if element.category in _IN_RUN]))
    return [next(along) if element.category in _IN_RUN else element for element in elements]


def _along_walls(units: Sequence[Element]) -> list[Element]:
    """Counterclockwise about the room's middle, from the widest gap on."""
    ends = np.array([unit.values[1:] for unit in units]).reshape(-1, 2, 2)
    turns = [rotation_2d(_slant_deg(unit.values[0])) for unit in units]
    x, y = np.array([
        turn @ place_m(bounds).mean(axis=0) for turn, bounds in zip(turns, ends, strict=True)
    ]).reshape(-1, 2).T  # fmt: skip
    angle = np.arctan2(y, x)
    order = np.argsort(angle, kind="stable")
    gaps = np.diff(angle[order], prepend=angle[order][-1:] - 2 * np.pi)
    return [units[at] for at in np.roll(order, -int(np.argmax(gaps)) if len(gaps) else 0)]


def _element(item: Item, frame: Frame, quarter_turns: int, mirrored: bool) -> Element:
    yaw_deg = item.box.yaw_deg - frame.yaw_deg
    corners = frame.points(footprint(item.box))
    if mirrored:
        corners, yaw_deg = corners * (-1.0, 1.0), -yaw_deg
    corners = corners @ rotation_2d(90.0 * quarter_turns).T
    yaw = round((yaw_deg + 90.0 * quarter_turns) / YAW_STEP_DEG) % YAWS
    turned = corners @ rotation_2d(_slant_deg(yaw))
    low, high = place(turned.min(axis=0)), place(turned.max(axis=0))
    flat = low == high  # a panel as thin as the grid
    is_above = ((turned.mean(axis=0) > place_m(low)) & (low < PLACES - 1)) | (low == 0)
    low, high = low - (flat & ~is_above), high + (flat & is_above)
    return Element(_INDEX[item.category], (yaw, int(low[0]), int(low[1]), int(high[0]),
                                           int(high[1])))  # fmt: skip


def _slant_deg(yaw: int) -> float:
    """How far a piece of this yaw is turned from the frame's axes, in [0, 90)."""
    return yaw * YAW_STEP_DEG % 90.0


def items_from(elements: Iterable[Element], around: Around, room_id: str) -> list[Item]:
    """The pieces of a room that a list tells, in the world; those without any extent are left out.

    A line that is a wall's lies exactly on it. Heights are usual ones.
    """
    counts: dict[str, int] = {}
    items = []
    for element in elements:
        box = _box(element, around)
        if box is None:
            continue
        category = CATEGORY_ORDER[element.category]
        if around.frame.scale < 1.0:
            box = _as_made(box, CATEGORIES[category])
        number = counts.get(category, 0)
        counts[category] = number + 1
        items.append(Item(f"{room_id}/{category}_{number}", category, box, room_id))
    return items


def _as_made(box: Box, row: Category) -> Box:
    """No larger than such pieces are made, its back in place: networks see large rooms smaller, and
    fill them."""
    length, depth = (min(box.size_m[0], row.length_m[1]), min(box.size_m[1], row.width_m[1]))
    return resized(box, (length, depth), (0.0, (box.size_m[1] - depth) / 2))


def of_length(
    element: Element, around: Around, length_m: tuple[float, float], fixed: float
) -> Element:
    """The element with a length between these; fixed: the share of it that stays in place."""
    yaw, *corners = element.values
    ends = np.array(corners).reshape(2, 2)
    axis = round((yaw * YAW_STEP_DEG - _slant_deg(yaw)) / 90.0) % 2
    steps = np.array(length_m) * around.frame.scale / STEP_M
    long = int(ends[1, axis] - ends[0, axis])
    wanted = int(np.clip(long, np.ceil(steps[0]), np.floor(min(steps[1], PLACES - 1))))
    low = int(np.clip(ends[0, axis] + round((long - wanted) * fixed), 0, PLACES - 1 - wanted))
    ends[:, axis] = low, low + wanted
    return Element(element.category, (yaw, *map(int, ends.ravel())))


def _box(element: Element, around: Around) -> Box | None:
    yaw, x0, y0, x1, y1 = element.values
    slant_deg = _slant_deg(yaw)
    if x1 <= x0 or y1 <= y0:
        return None
    bounds = np.array([[x0, y0], [x1, y1]])
    low, high = _on_lines(bounds, around) if slant_deg == 0.0 else place_m(bounds)
    middle = rotation_2d(slant_deg) @ ((low + high) / 2)
    long, deep = (high - low) / around.frame.scale
    if round((yaw * YAW_STEP_DEG - slant_deg) / 90.0) % 2:
        long, deep = deep, long
    row = CATEGORIES[CATEGORY_ORDER[element.category]]
    x_m, y_m = around.frame.world(middle)
    base_m = row.mount_height_m if row.mount is Mount.WALL else 0.0
    height_m = _height_m(row, float(deep))
    yaw_deg = wrap_deg(yaw * YAW_STEP_DEG + around.frame.yaw_deg)
    return Box((float(x_m), float(y_m), base_m), (float(long), float(deep), height_m), yaw_deg)


def _height_m(row: Category, deep_m: float) -> float:
    """The usual height. Of a cabinet its depth tells it: wardrobes are deep, chests are not."""
    if row.name == "cabinet":
        return TALL_M if deep_m >= WARDROBE_DEPTH_M else CHEST_M
    return round(sum(row.height_m) / 2, 2)


def _on_lines(bounds: Ints, around: Around) -> FloatArray:
    """(2, 2) metres of low and high; on walls where their number is that of one, else at the edge
    of clear floors.
    """
    corners = np.array(place_m(bounds), np.float64)
    for axis, (flat, numbers) in enumerate(_lines(around)):
        for row in (0, 1):
            same = flat[numbers == bounds[row, axis]]
            if len(same):
                corners[row, axis] = same[np.argmin(np.abs(same - corners[row, axis]))]
    return corners


@lru_cache(maxsize=64)  # all drafts of a room ask for its lines
def _lines(around: Around) -> tuple[tuple[FloatArray, Ints], ...]:
    """By axis, (L,) where walls and the edges of clear floors lie, and their numbers."""
    walls, clear = around.lines_m[around.kinds == 1], around.lines_m[around.kinds >= _FIRST_CLEAR]
    places = []
    for axis in (0, 1):
        ends = walls[:, axis], walls[:, axis + 2]
        flat = ends[0][np.abs(ends[0] - ends[1]) < STEP_M / 2]
        edges = clear[:, [axis, axis + 2]].ravel()
        flat = np.concatenate([flat, edges[~np.isin(place(edges), place(flat))]])
        places.append((flat, place(flat)))
    return tuple(places)
