"""Furniture and fixtures that a drawing shows: kept in the plan, and placed in its rooms.

A drawing says a place to within a hand. Placed, a piece is as large as its category, square to the
walls, with its back on the wall behind it, in no wall and before no door; what cannot stand so is
left out, with the reason.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely
from shapely.geometry import Point, Polygon

from chord_usd.base.scene.geometry import footprint_polygon, room_polygon, to_world
from chord_usd.base.scene.oriented_rect import EDGES, Edge, Footprint
from chord_usd.base.scene.palette import CATEGORIES, having
from chord_usd.base.scene.trim import casings
from chord_usd.base.scene.types import Box, FloatArray, Item, Opening, Plan, Room
from chord_usd.base.scene.units import cm_from_m, fold_deg, m_from_cm, rotation_2d

DRAWN = "drawn"
"""Key of Plan.extra: pieces that the drawing shows, boxes as of furniture, with `type` and
`score`."""

KITCHEN = ("sink_cabinet", "cooker_cabinet", "refrigerator")
"""Of a kitchen: the units are composed around where these are drawn."""
_SINGLE = frozenset(("toilet", "cooker_cabinet", "refrigerator"))
"""A room has one: the surest stays."""
_BACK_M, _SIDE_M = 0.3, 0.15
"""A back that is drawn so near to a wall is on it; a side."""
_SQUARE_DEG, _WALLED_DEG = 30.0, 45.0
"""A piece that is askew by less is square to its room; plumbing and cabinets always are."""
_STEP_M = 0.025
"""A piece is moved in such steps to stand clear: by up to a quarter of a metre or, along its back,
of its longer side."""
_REACH_M, _REACH = 0.25, 0.25
_GRID_M = np.stack(np.meshgrid(*[np.arange(-20, 21) * _STEP_M] * 2), axis=-1).reshape(-1, 2)
_OFF_WALL = 4.0
"""A move off the wall behind a piece counts so many times as far as one along it."""
_STEPS_M = _GRID_M[np.argsort(np.hypot(*(_GRID_M * (1.0, _OFF_WALL)).T), kind="stable")]
_TOUCH_M2 = 1e-4
_GAP_M = 0.01
"""Between a piece and a casing."""


@dataclass(frozen=True)
class Placed:
    """A piece that the drawing shows."""

    drawn: Item
    """As it is drawn."""
    item: Item | None = None
    """As it stands in its room; None where it is left out."""
    reason: str = ""
    """Why it is left out."""


def to_entry(items: Sequence[Item]) -> list[dict[str, Any]]:
    """For Plan.extra."""
    return [
        {
            "type": item.category,
            "pos": [round(cm_from_m(v), 1) for v in item.box.center_m],
            **{
                key: round(cm_from_m(v), 1)
                for key, v in zip(("length", "width", "height"), item.box.size_m, strict=True)
            },
            "rotate": round(item.box.yaw_deg, 1),
            "score": round(item.score, 2),
        }
        for item in items
    ]


def drawn_items(extra: Mapping[str, Any]) -> list[Item]:
    """The pieces of a plan's extra, the surest first; what is none is passed over."""
    items = []
    for number, entry in enumerate(extra.get(DRAWN, ())):
        try:
            x, y, z = (m_from_cm(float(v)) for v in entry["pos"])
            length, width, height = (
                m_from_cm(float(entry[key])) for key in ("length", "width", "height")
            )
            name, score = str(entry["type"]), float(entry.get("score", 1.0))
            box = Box((x, y, z), (length, width, height), float(entry["rotate"]))
        except (KeyError, TypeError, ValueError):
            continue
        if name in CATEGORIES and min(length, width, height) > 0 and np.isfinite((x, y)).all():
            items.append(Item(f"drawn_{number}", name, box, score=score))
    return sorted(items, key=lambda item: -item.score)


def seen_item(category: str, box: Box, score: float) -> Item:
    """A piece as it was seen, in no room."""
    return Item("", category, box, score=score)


def usual_box(category: str, box: Box) -> Box:
    """The box as large as the category is built, its back and middle where they are drawn."""
    row = CATEGORIES[category]
    length, width = (
        float(np.clip(side, *usual))
        for side, usual in zip(box.size_m[:2], (row.length_m, row.width_m), strict=True)
    )
    height = sum(row.height_m) / 2
    against = _against_back(box, (length, width))
    center_m = (*against.center_m[:2], row.mount_height_m)
    return replace(against, center_m=center_m, size_m=(length, width, height))


def _against_back(box: Box, size_m: tuple[float, float]) -> Box:
    """A box of another length and width with its back where it was."""
    x, y = to_world(box, (0.0, (box.size_m[1] - size_m[1]) / 2))
    return replace(
        box, center_m=(float(x), float(y), box.center_m[2]), size_m=(*size_m, box.size_m[2])
    )


def place(
    plan: Plan,
    clear: Sequence[tuple[shapely.Geometry, Opening]],
    named: Callable[[Item, str], tuple[str, str]],
    blocks: Callable[[Item, Opening], bool],
) -> list[Placed]:
    """All drawn pieces of a plan, the surest first.

    clear: floor that openings keep free. named: the category of a piece in a room, by its id, and
    why it does not stand there; "" where it does. blocks: whether a piece on the floor of an
    opening is in its way.
    """
    floors = {room.id: room_polygon(room) for room in plan.rooms}
    trims = {room.id: _trims(room, plan.openings) for room in plan.rooms}
    counts: Counter[tuple[str, str]] = Counter()
    standing: list[Polygon] = []
    placed = []
    for item in drawn_items(plan.extra):
        room_id = next((i for i, f in floors.items() if f.covers(Point(item.box.center_m[:2]))), "")
        if not room_id:
            placed.append(Placed(item, reason="in no room"))
            continue
        category, reason = named(item, room_id)
        if not reason and category in _SINGLE and counts[room_id, category]:
            reason = "a second one in its room"
        as_named = replace(item, category=category)
        box = _on_walls(category, usual_box(category, item.box), plan.room(room_id))
        if not reason and category not in KITCHEN:
            kept_free = [
                area for area, opening in clear if blocks(replace(as_named, box=box), opening)
            ]
            kept_free += trims[room_id]
            floor = _Floor(floors[room_id], kept_free, standing)
            box, reason = _standing(category, box, plan.room(room_id), floor)
        if reason:
            placed.append(Placed(item, reason=reason))
            continue
        number = counts[room_id, category]
        counts[room_id, category] += 1
        if category not in KITCHEN:
            standing.append(footprint_polygon(box))
        new = replace(as_named, id=f"{room_id}/{category}_{number}", box=box, room_id=room_id)
        placed.append(Placed(item, new.with_facts(locked=True)))
    return placed


def _trims(room: Room, openings: Sequence[Opening]) -> list[Polygon]:
    """Floor below the casings of a room's doors: lids and drawers beside them could not open."""
    return [
        footprint_polygon(casing).buffer(_GAP_M)
        for opening in openings
        if room.id in opening.room_ids
        for casing in casings(opening, room)
    ]


@dataclass(frozen=True, eq=False)
class _Floor:
    """Where a piece may stand."""

    room: Polygon
    kept_free: Sequence[shapely.Geometry]
    """Before openings."""
    standing: Sequence[Polygon]

    def refuses(self, box: Box) -> str:
        """Why a box may not stand where it is; "" where it may."""
        shape = footprint_polygon(box)
        if shape.difference(self.room).area > _TOUCH_M2:
            return "in a wall"
        if any(shape.intersection(area).area > _TOUCH_M2 for area in self.kept_free):
            return "before an opening"
        if any(shape.intersection(other).area > _TOUCH_M2 for other in self.standing):
            return "in another piece"
        return ""


def _standing(category: str, box: Box, room: Room, floor: _Floor) -> tuple[Box, str]:
    """The box moved as little as is needed, else made as small as the category is built, or why it
    may stand nowhere near."""
    reason = floor.refuses(box)
    if not reason:
        return box, ""
    row = CATEGORIES[category]
    least = (min(row.length_m[0], box.size_m[0]), min(row.width_m[0], box.size_m[1]))
    # What is drawn over a wall is smaller than it was seen.
    tried = (*_steps(box), *_steps(_on_walls(category, _against_back(box, least), room)))
    return next(((option, "") for option in tried if not floor.refuses(option)), (box, reason))


def _on_walls(category: str, box: Box, room: Room) -> Box:
    """The box square to the room, with its back and sides on walls near them."""
    within_deg = _WALLED_DEG if category in having("walled") else _SQUARE_DEG
    footprint = _square(Footprint.of(box), room.polygon_m, within_deg)
    back: Edge = ("v1", "u0", "v0", "u1")[footprint.quarter_turns % 4]
    for axis in (0, 1):
        places = {
            edge: _wall_near(footprint, edge, room.polygon_m, _BACK_M if edge == back else _SIDE_M)
            for edge in EDGES[axis]
        }
        moves = [(edge, place) for edge, place in places.items() if place is not None]
        moves.sort(
            key=lambda move: (move[0] != back, abs(move[1] - getattr(footprint.rect, move[0])))
        )
        if moves:
            edge, place = moves[0]
            by = place - getattr(footprint.rect, edge)
            low, high = EDGES[axis]
            rect = footprint.rect
            rect = rect.moved_edge(low, getattr(rect, low) + by)
            footprint = replace(footprint, rect=rect.moved_edge(high, getattr(rect, high) + by))
    return footprint.on(box)


def _square(footprint: Footprint, polygon_m: FloatArray, within_deg: float) -> Footprint:
    """Turned to the longest side of a room that it is parallel to but for so much."""
    sides = np.roll(polygon_m, -1, axis=0) - polygon_m
    for side in np.argsort(-np.hypot(*sides.T)):
        along_deg = float(np.degrees(np.arctan2(*sides[side][::-1])))
        turn = fold_deg(footprint.rect.angle_deg - along_deg)
        if abs(turn) <= within_deg:
            return footprint.turned(-turn)
    return footprint


def _wall_near(
    footprint: Footprint, edge: Edge, polygon_m: FloatArray, reach_m: float
) -> float | None:
    """Where the nearest wall beyond an edge lies along its axis; None where none is near."""
    rect = footprint.rect
    axis = 0 if edge in EDGES[0] else 1
    local = rect.local(polygon_m)
    at = getattr(rect, edge)
    low, high = rect.span(1 - axis)
    best: float | None = None
    for start, end in zip(local, np.roll(local, -1, axis=0), strict=True):
        if abs(end[axis] - start[axis]) > 0.1 * abs(end[1 - axis] - start[1 - axis]) + 1e-9:
            continue
        first, last = sorted((start[1 - axis], end[1 - axis]))
        if min(high, last) - max(low, first) < 0.3 * (high - low):
            continue
        place = float((start[axis] + end[axis]) / 2)
        # Walls run counter-clockwise about the floor: this one has to face the edge.
        faces = (end[1 - axis] - start[1 - axis]) * (1 if axis == 0 else -1)
        if (faces > 0) != (edge in ("u1", "v1")):
            continue
        if abs(place - at) <= reach_m and (best is None or abs(place - at) < abs(best - at)):
            best = place
    return best


def _steps(box: Box) -> Iterator[Box]:
    """The box moved along each of its axes, the nearest first."""
    turn = rotation_2d(box.yaw_deg)
    x, y, z = box.center_m
    along_m = max(_REACH_M, _REACH * max(box.size_m[:2]))
    is_near = np.abs(_STEPS_M) <= np.array([along_m, _REACH_M]) + _STEP_M / 2
    for by in _STEPS_M[is_near.all(axis=1)]:
        u, v = (turn @ by).tolist()
        yield replace(box, center_m=(x + u, y + v, z))
