"""Pieces that are there moved, turned and swapped as somebody asked."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import islice

import numpy as np
import shapely

from chord_usd.base.metrics.complete import TABLES, WALLED, table_of
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.places.tries import around
from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    front_direction,
    to_own,
    to_world,
)
from chord_usd.base.scene.intents import COMPASS_DEG, DOOR, WINDOW, Intent, way_deg
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Box, FloatArray, Item
from chord_usd.base.scene.units import rotation_2d, wrap_deg
from chord_usd.line.arrange.asked_leeway import belongings
from chord_usd.line.arrange.asked_places import NEAR_M, Floor
from chord_usd.line.arrange.asked_work import (
    TRIED,
    Score,
    Work,
    best_place,
    called,
    refused,
    score_of,
    shuts_in,
    with_resting,
)

_SOME_M, _LEAST_M = 0.5, 0.2
"""How far "nearer" moves a piece where nothing says it, and how much nearer another place is."""

_ASIDE_DEG = (0.0, 15.0, -15.0, 30.0, -30.0, 45.0, -45.0)
"""Ways to go nearer where something is in the straight one."""

_SEEN_M, _FARTHEST_M = 9.0, 4.0
"""How far a piece looks, and how far it may go to look there."""

_SIDEWAYS = 15
"""Steps of 0.1 m that a piece may stand beside the place of the one that it is swapped with."""

_GRID_M = 0.1
"""Between places that a turned piece is tried at."""

_SHIFT_M = 0.8
"""A piece that is turned by an angle goes no farther than this to have place."""


def _group(work: Work, item: Item) -> list[Item]:
    """A piece, and what goes where it goes: chairs that stand at a table."""
    if item.category not in TABLES:
        return [item]
    chairs = [piece for piece in work.graph.items
              if piece.category == "chair" and piece.id not in work.locked]  # fmt: skip
    return [item, *(chair for chair in chairs if table_of(chair, work.graph.items) == item)]


def _with_belongings(work: Work, item: Item) -> list[Item]:
    near = belongings(work.graph, item)
    return [*_group(work, item), *(piece for piece in near if piece.id not in work.locked)]


def _going(work: Work, intent: Intent, item: Item) -> list[Item]:
    """What moves, by this candidate."""
    group = _group(work, item)
    if not work.leeway.is_together:
        return group
    all_of_it = _with_belongings(work, item)
    if len(all_of_it) == len(group):
        raise refused(intent, "nothing belongs to it")
    names = dict.fromkeys(category(piece.category).label.lower() for piece in all_of_it[1:])
    work.notes.append(f"with its {', '.join(names)}")
    return all_of_it


def _shifted(item: Item, by_m: FloatArray) -> Item:
    x, y, z = item.box.center_m
    return replace(item, box=replace(item.box, center_m=(x + by_m[0], y + by_m[1], z)))


def _blocked(work: Work, group: Sequence[Item], room_id: str, by_m: FloatArray) -> str:
    """Name of the obstacle of pieces that are moved together; "" without one."""
    gone = with_resting(work, group)
    floor = work.floor(room_id, gone)
    blockers = (floor.obstacle_at(_shifted(piece, by_m)) for piece in group)
    return next((blocker for blocker in blockers if blocker), "")


def _shift(work: Work, group: Sequence[Item], by_m: FloatArray) -> None:
    for piece in group:
        work.move(piece, _shifted(piece, by_m).box)


def move(work: Work, intent: Intent) -> None:
    item = work.item(intent.items[0])
    if intent.to_room:
        _move_to_room(work, intent, item)
    elif intent.distance_m is not None:
        _move_by(work, intent, item)
    elif intent.way or intent.relation in ("nearer to", "away from"):
        _move_some(work, intent, item)
    else:
        _move_beside(work, intent, item)


def _direction(work: Work, intent: Intent, item: Item) -> FloatArray:
    """(2,) of length 1, the way that a move goes."""
    if intent.way:
        way = math.radians(way_deg(intent.way, item.box.yaw_deg))
        return np.array([math.cos(way), math.sin(way)])
    floor = work.floor(item.room_id)
    at = shapely.Point(item.box.center_m[:2])
    shapes = floor.shapes(intent.anchors)
    if not shapes:
        raise refused(intent, f"there is no {intent.anchors[0]} in {called(work, item.room_id)}")
    nearest = shapely.shortest_line(at, min(shapes, key=at.distance))
    start, end = (np.array(point) for point in nearest.coords)
    length_m = float(np.hypot(*(end - start)))
    if length_m < 1e-6:
        raise refused(intent, "it stands there already")
    return (end - start) / length_m * (-1.0 if intent.relation == "away from" else 1.0)


def _move_by(work: Work, intent: Intent, item: Item) -> None:
    assert intent.distance_m is not None
    group = _going(work, intent, item)
    by_m = _direction(work, intent, item) * intent.distance_m * work.leeway.share
    blocked = _blocked(work, group, item.room_id, by_m)
    if blocked:
        raise refused(intent, f"{blocked} blocks it", "a free place")
    _shift(work, group, by_m)
    if work.leeway.share < 1:
        done_cm, asked_cm = 100 * intent.distance_m * work.leeway.share, 100 * intent.distance_m
        work.notes.append(f"{done_cm:.0f} cm instead of {asked_cm:.0f} cm")


def _move_some(work: Work, intent: Intent, item: Item) -> None:
    """Move nearer or farther, or to a side: straight or a little aside past an obstacle."""
    if work.leeway.is_anywhere:
        _move_there(work, intent, item)
        return
    group = _going(work, intent, item)
    way = _direction(work, intent, item)
    blocked, gain_m = "", _SOME_M * work.leeway.share
    for aside_deg in _ASIDE_DEG:
        by_m = rotation_2d(aside_deg) @ way * gain_m / math.cos(math.radians(aside_deg))
        if _leaves_wall(item, by_m):
            continue
        obstacle = _blocked(work, group, item.room_id, by_m)
        if not obstacle:
            _shift(work, group, by_m)
            work.notes.append(f"{100 * gain_m:.0f} cm")
            return
        blocked = blocked or obstacle
    raise refused(intent, f"{blocked or 'the wall behind it'} blocks it", "another way")


def _move_there(work: Work, intent: Intent, item: Item) -> None:
    """Move to the nearest place that is nearer, or farther."""
    floor = work.floor(item.room_id, with_resting(work, [item]))
    shape = footprint_polygon(item.box)
    sign = 1.0 if intent.relation == "away from" else -1.0
    before_m = min(float(shape.distance(anchor)) for anchor in floor.shapes(intent.anchors))

    def score(placed: Item) -> tuple[float, ...] | None:
        outline = footprint_polygon(placed.box)
        now_m = min(float(outline.distance(anchor)) for anchor in floor.shapes(intent.anchors))
        if sign * (now_m - before_m) < _LEAST_M:
            return None
        return (math.dist(placed.box.center_m[:2], item.box.center_m[:2]),)

    place = _best_of_old(work, floor, item, score) if len(_group(work, item)) == 1 else None
    if place is None:
        raise refused(intent, "no place was found there")
    work.move(item, place.box)


def _leaves_wall(item: Item, by_m: FloatArray) -> bool:
    """Whether a piece that stands with its back to a wall would stand free."""
    if item.category not in WALLED:
        return False
    return abs(float(by_m @ front_direction(item.box.yaw_deg))) > 0.01


def _best_of_old(work: Work, floor: Floor, item: Item, score: Score) -> Item | None:
    rest = replace(work.graph, items=tuple(i for i in work.graph.items if i.id != item.id))
    beside = replace(work, graph=rest)
    return best_place(beside, floor, item, score)


def _move_beside(work: Work, intent: Intent, item: Item) -> None:
    floor = work.floor(item.room_id, with_resting(work, [item]))
    place = _best_of_old(work, floor, item, _score_near(floor, intent, item))
    if place is None:
        raise refused(intent, "no place was found there", "what the room has place for")
    work.move(item, place.box)


def _score_near(floor: Floor, intent: Intent, item: Item) -> Score:
    def score(placed: Item) -> tuple[float, ...] | None:
        missed_m = floor.misses_m(placed, intent.relation, intent.anchors)
        if missed_m > NEAR_M.get(intent.relation, 1.0):
            return None
        turned = abs(wrap_deg(placed.box.yaw_deg - item.box.yaw_deg))
        away_m = math.dist(placed.box.center_m[:2], item.box.center_m[:2])
        return (round(missed_m, 1), round(turned, 0), away_m)

    return score


def _move_to_room(work: Work, intent: Intent, item: Item) -> None:
    floor = work.floor(intent.to_room, with_resting(work, [item]))
    place = _best_of_old(work, floor, item, score_of(work, floor, intent))
    if place is None:
        raise refused(intent, f"no place was found in {called(work, intent.to_room)}")
    work.move(item, place.box, intent.to_room)


def turn(work: Work, intent: Intent) -> None:
    item = work.item(intent.items[0])
    _turn_to(work, intent, item, item.box.yaw_deg + intent.turn_deg, _SHIFT_M)


def face(work: Work, intent: Intent) -> None:
    """Turn a piece to face its anchor: square to an opening that is straight ahead then."""
    item = work.item(intent.items[0])
    if intent.way:
        _turn_to(work, intent, item, COMPASS_DEG[intent.way] + 90.0, _FARTHEST_M)
        return
    floor = work.floor(item.room_id)
    shapes = floor.shapes(intent.anchors[:1])
    at = shapely.Point(item.box.center_m[:2])
    holes = [
        opening.box for opening in floor.openings
        if intent.anchors[0] in (WINDOW, DOOR) and (opening.kind == WINDOW)
        == (intent.anchors[0] == WINDOW)
    ]  # fmt: skip
    if not shapes:
        raise refused(intent, f"there is no {intent.anchors[0]} in {called(work, item.room_id)}")
    hole = min(holes, key=lambda box: footprint_polygon(box).distance(at), default=None)
    target = footprint_polygon(hole) if hole else shapes[0]
    ahead = np.array(target.centroid.coords[0]) - item.box.center_m[:2]
    yaw_deg = _towards_deg(ahead)
    if hole:
        square_deg = hole.yaw_deg + (0.0 if front_direction(hole.yaw_deg) @ ahead > 0 else 180.0)
        if _sees(_turned(item, square_deg), target):
            yaw_deg = square_deg
    _turn_to(work, intent, item, yaw_deg, _FARTHEST_M, target)


def _towards_deg(ahead: FloatArray) -> float:
    """The yaw at which a front points this way."""
    return float(np.degrees(np.arctan2(ahead[0], -ahead[1])))


def _turned(item: Item, yaw_deg: float) -> Item:
    return replace(item, box=replace(item.box, yaw_deg=wrap_deg(yaw_deg)))


def _sees(item: Item, target: shapely.Geometry) -> bool:
    """Whether a piece has this straight ahead."""
    middle = np.array(item.box.center_m[:2])
    ahead = middle + front_direction(item.box.yaw_deg) * _SEEN_M
    return bool(target.intersects(shapely.LineString([middle, ahead])))


def _turn_to(
    work: Work, intent: Intent, item: Item, yaw_deg: float, most_m: float,
    target: shapely.Geometry | None = None,
) -> None:  # fmt: skip
    """Turn a piece where it stands or, past an obstacle, in the nearest free place that shuts
    nobody in. target: to be in sight from there."""
    turned = _turned(item, yaw_deg)
    group = _group(work, item)
    floor = work.floor(item.room_id, with_resting(work, group))
    blocked = floor.obstacle_at(turned)
    if len(group) > 1:
        raise refused(intent, "its chairs would block it", "a table without chairs")
    boxes = around(turned.box, _GRID_M, most_m) if blocked else [turned.box]
    free = (
        placed for placed in floor.free(turned, boxes) if target is None or _sees(placed, target)
    )
    place = next((placed for placed in islice(free, TRIED) if not shuts_in(work, placed)), None)
    if place is None:
        raise refused(
            intent, f"{blocked} would block it" if blocked else "it would block the passage"
        )
    work.move(item, place.box)


def swap(work: Work, intent: Intent) -> None:
    """Let two pieces change places, each with what belongs to it; else the two alone."""
    item, other = (work.item(item_id) for item_id in intent.items)
    with_all = [_with_belongings(work, item), _with_belongings(work, other)]
    for groups in (with_all, [[item], [other]]):
        gone = with_resting(work, [piece for group in groups for piece in group])
        floor = work.floor(intent.room, gone)
        places = [list(islice(_places_of(floor, groups[at], groups[1 - at][0]), TRIED))
                  for at in (0, 1)]  # fmt: skip
        pairs = ((first, second) for first in places[0] for second in places[1])
        chosen = next((pair for pair in pairs if _are_apart(*pair)), None)
        if chosen:
            for group, placed in zip(groups, chosen, strict=True):
                for old, new in zip(group, placed, strict=True):
                    work.move(old, new.box)
            return
    raise refused(intent, "one of them has no place where the other stands", "pieces of like size")


def _places_of(floor: Floor, group: Sequence[Item], other: Item) -> Iterator[list[Item]]:
    """Free places of a group whose first piece stands where another one does."""
    leader = group[0].box
    corners = np.concatenate([to_own(leader, footprint(piece.box)) for piece in group])
    for box in _in_place_of(leader, float(corners[:, 1].max()), other):
        placed = []
        for piece in group:
            x, y = to_world(box, to_own(leader, piece.box.center_m[:2]))
            center_m = (float(x), float(y), piece.box.center_m[2])
            yaw_deg = wrap_deg(piece.box.yaw_deg + box.yaw_deg - leader.yaw_deg)
            placed.append(
                replace(piece, box=replace(piece.box, center_m=center_m, yaw_deg=yaw_deg))
            )
        if not any(floor.obstacle_at(piece) for piece in placed):
            yield placed


def _are_apart(group: Sequence[Item], other: Sequence[Item]) -> bool:
    shapes = [footprint_polygon(piece.box) for piece in other]
    return not any(
        footprint_polygon(piece.box).intersection(shape).area > MIN_OVERLAP_M2
        for piece in group for shape in shapes
    )  # fmt: skip


def _in_place_of(leader: Box, back_m: float, other: Item) -> Iterator[Box]:
    """Where another piece stands: the back of a group, so far behind its leader's middle, where
    that piece has its back, then to both sides."""
    front = front_direction(other.box.yaw_deg)
    along = np.array([-front[1], front[0]])
    back = np.array(other.box.center_m[:2]) - front * other.box.size_m[1] / 2
    for step in sorted(range(-_SIDEWAYS, _SIDEWAYS + 1), key=abs):
        at = back + front * back_m + along * (step * 0.1)
        center_m = (float(at[0]), float(at[1]), leader.center_m[2])
        yield replace(leader, center_m=center_m, yaw_deg=other.box.yaw_deg)
