"""What an unlabelled room is, from its size and shape, its doors and windows, and where they lead.

Rules of thumb over floor plans in general: a corridor is narrow and has many doors, a balcony is
narrow and glazed, a bathroom has one narrow door and a small window or none, the living room is
large and well connected, the kitchen lies beside it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from chord_usd.base.scene.types import RoomKind
from chord_usd.workshop.data.furnish.floor import Floor

NARROW_DOOR_M = 0.83
"""Doors of bathrooms and stores are no wider."""

SMALL_WINDOW_M = 0.85


def guess_kinds(floors: Sequence[Floor]) -> None:
    """Give every floor of unknown kind a likely one, in place; known ones stay as they are."""
    for is_kind, kind in _UNMISTAKABLE:
        _name(floors, kind, is_kind)
    if not any(floor.kind == "living" for floor in floors):
        _name_best(floors, "living", lambda floor: floor.area_m2 > 9.0, _is_living)
    living = next((floor for floor in floors if floor.kind == "living"), None)
    _name(floors, "bathroom", _is_bathroom)
    if living and not any(floor.kind == "kitchen" for floor in floors):
        _name_best(floors, "kitchen", lambda floor: floor.area_m2 < 12.5 and len(floors) > 2,
                   lambda floor: 12.0 * _leads_to_living(floor) - floor.area_m2)  # fmt: skip
    if living:
        _name(floors, "dining", lambda floor: living in floor.touching)
    _without_bathroom(floors)
    _name(floors, "bedroom", lambda floor: floor.area_m2 >= 5.0)
    _name(floors, "store", lambda floor: True)


def _name(floors: Sequence[Floor], kind: RoomKind, fits: Callable[[Floor], bool]) -> None:
    for floor in floors:
        if floor.kind == "unknown" and fits(floor):
            floor.kind = kind


def _name_best(
    floors: Sequence[Floor],
    kind: RoomKind,
    fits: Callable[[Floor], bool],
    score: Callable[[Floor], float],
) -> None:
    fitting = [floor for floor in floors if floor.kind == "unknown" and fits(floor)]
    if fitting:
        max(fitting, key=score).kind = kind


def _without_bathroom(floors: Sequence[Floor]) -> None:
    """A house has a bathroom: the smallest room if none looked like one."""
    if len(floors) > 2 and not any(floor.kind == "bathroom" for floor in floors):
        _name_best(floors, "bathroom", lambda floor: floor.area_m2 < 9.0, lambda f: -f.area_m2)


def _narrow_m(floor: Floor) -> float:
    """Width of the rectangle that is as long and as large."""
    return floor.area_m2 / max(wall.length for wall in floor.walls)


def _widest_window_m(floor: Floor) -> float:
    return max((s_to - s_from for _, s_from, s_to, _ in floor.windows), default=0.0)


def _widest_door_m(floor: Floor) -> float:
    return max((door.s_to - door.s_from for door in floor.doors), default=0.0)


def _is_corridor(floor: Floor) -> bool:
    doors = len(floor.doors)
    many = doors >= 3 and _narrow_m(floor) < 2.0
    return many or (doors >= 2 and _narrow_m(floor) < 1.4 and _widest_window_m(floor) < 1.0)


def _is_balcony(floor: Floor) -> bool:
    glazed = _widest_window_m(floor) > max(1.2, 0.3 * max(wall.length for wall in floor.walls))
    return _narrow_m(floor) < 2.0 and floor.area_m2 < 12.0 and len(floor.doors) <= 2 and glazed


def _is_store(floor: Floor) -> bool:
    return floor.area_m2 < 1.0 or (_narrow_m(floor) < 0.95 and not floor.windows)


def _is_living(floor: Floor) -> float:
    entrance = any(door.is_entrance for door in floor.doors)
    return floor.area_m2 + 2.5 * len(floor.doors) + 5.0 * entrance + 5.0 * bool(floor.touching)


def _is_bathroom(floor: Floor) -> bool:
    return (
        len(floor.doors) == 1
        and floor.area_m2 < 9.0
        and _widest_door_m(floor) <= NARROW_DOOR_M
        and _widest_window_m(floor) <= SMALL_WINDOW_M
    )


def _leads_to_living(floor: Floor) -> bool:
    return any(door.beyond and door.beyond.kind in ("living", "dining") for door in floor.doors)


_UNMISTAKABLE: tuple[tuple[Callable[[Floor], bool], RoomKind], ...] = (
    (_is_corridor, "corridor"),
    (_is_balcony, "balcony"),
    (_is_store, "store"),
)
