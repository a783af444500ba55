"""Houses spoilt on purpose: furniture moved into other furniture, and as a control, moved clear."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.metrics.footprints import is_underfoot
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2, overlaps_by_nature
from chord_usd.base.scene.geometry import footprint_polygon, room_polygon
from chord_usd.base.scene.types import Item, Room, SceneGraph

LEAST_SHARE = 0.25
"""A collision covers at least this much of the smaller of two footprints."""

_TRIES = 60

_Find = Callable[[Item, Sequence[Item], Room, np.random.Generator], tuple[Item, str] | None]
"""A piece, the others of its room: the piece where it goes, and which one stays put for that."""


@dataclass(frozen=True, eq=False)
class Spoilt:
    """A house of which some pieces were moved."""

    scene: SceneGraph
    moved: tuple[str, ...]
    """Ids of the pieces moved."""


def collide(scene: SceneGraph, rng: np.random.Generator, per_room: int = 1) -> Spoilt:
    """In every room that can, moves up to per_room pieces into another one that should be clear.

    A moved piece stays inside its room, keeps its yaw and covers at least LEAST_SHARE of the
    smaller footprint. Each piece moves at most once, and what it was moved into stays.
    """
    return _spoil(scene, rng, per_room, _into_another)


def displace(scene: SceneGraph, rng: np.random.Generator, per_room: int = 1) -> Spoilt:
    """The control: as collide, but to where the piece touches nothing."""
    return _spoil(scene, rng, per_room, _clear_of_all)


def jostle(scene: SceneGraph, rng: np.random.Generator, spread_m: float) -> SceneGraph:
    """Every piece moved by normal noise of this spread along x and y, where that leaves it in its
    room."""
    floors = {room.id: room_polygon(room) for room in scene.rooms}

    def jostled(item: Item) -> Item:
        moved = _moved_to(item, np.array(item.box.center_m[:2]) + rng.normal(0.0, spread_m, 2))
        floor = floors.get(item.room_id)
        return moved if floor and floor.covers(footprint_polygon(moved.box)) else item

    return replace(scene, items=tuple(map(jostled, scene.items)))


def _spoil(scene: SceneGraph, rng: np.random.Generator, per_room: int, find: _Find) -> Spoilt:
    items = {item.id: item for item in scene.items}
    moved: list[str] = []
    for room in scene.rooms:
        standing = [item for item in scene.items_of(room.id) if not is_underfoot(item)]
        fixed: set[str] = set()
        for index in rng.permutation(len(standing))[: 4 * per_room]:
            if sum(item.id in moved for item in standing) == per_room:
                break
            piece = standing[int(index)]
            others = [items[item.id] for item in standing if item.id != piece.id]
            spoilt = None if piece.id in fixed else find(piece, others, room, rng)
            if spoilt is not None:
                items[piece.id], anchor = spoilt
                fixed.update((anchor, piece.id))
                moved.append(piece.id)
    return Spoilt(replace(scene, items=tuple(items.values())), tuple(moved))


def _into_another(
    item: Item, others: Sequence[Item], room: Room, rng: np.random.Generator
) -> tuple[Item, str] | None:
    """The piece moved into one of the others, and which."""
    floor = room_polygon(room)
    for index in rng.permutation(len(others)):
        other = others[int(index)]
        if overlaps_by_nature(item, other):
            continue
        shape = footprint_polygon(other.box)
        reach_m = (np.hypot(*item.box.size_m[:2]) + np.hypot(*other.box.size_m[:2])) / 2
        for _ in range(_TRIES // len(others) + 1):
            offset_m = rng.uniform(-reach_m, reach_m, size=2)
            moved = _moved_to(item, np.array(other.box.center_m[:2]) + offset_m)
            outline = footprint_polygon(moved.box)
            shared_m2 = outline.intersection(shape).area
            if shared_m2 >= LEAST_SHARE * min(outline.area, shape.area) and floor.covers(outline):
                return moved, other.id
    return None


def _clear_of_all(
    item: Item, others: Sequence[Item], room: Room, rng: np.random.Generator
) -> tuple[Item, str] | None:
    """The piece moved to a free place of its room, at least half its own size away."""
    floor = room_polygon(room)
    west, south, east, north = floor.bounds
    shapes = [footprint_polygon(other.box) for other in others]
    least_m = max(item.box.size_m[:2]) / 2
    for _ in range(_TRIES):
        moved = _moved_to(item, rng.uniform((west, south), (east, north)))
        outline = footprint_polygon(moved.box)
        step_m = np.hypot(*(np.array(moved.box.center_m) - item.box.center_m)[:2])
        if step_m >= least_m and floor.covers(outline) and _is_clear(outline, shapes):
            return moved, item.id
    return None


def _is_clear(outline: Polygon, shapes: Sequence[Polygon]) -> bool:
    return all(outline.intersection(shape).area <= MIN_OVERLAP_M2 for shape in shapes)


def _moved_to(item: Item, center_m: np.ndarray) -> Item:
    x_m, y_m = (float(value) for value in center_m)
    return replace(item, box=replace(item.box, center_m=(x_m, y_m, item.box.center_m[2])))
