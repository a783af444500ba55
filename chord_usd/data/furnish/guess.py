"""What an unlabelled room is, from its size, shape, doors and windows."""

from __future__ import annotations

from collections.abc import Sequence

from chord_usd.data.furnish.floor import Floor
from chord_usd.types import RoomKind


def guess_kinds(floors: Sequence[Floor]) -> None:
    """Give every floor of unknown kind a likely one, in place.

    Small rooms become balcony, store, bathroom or corridor one by one; of the rest the largest
    becomes the living room and the smallest suitable one the kitchen, where the house has none.
    """
    kinds = {floor.kind for floor in floors}
    unknown = [floor for floor in floors if floor.kind == "unknown"]
    if not unknown:
        return
    large = []
    for floor in unknown:
        kind = _small_kind(floor)
        if kind is None:
            large.append(floor)
        else:
            floor.kind = kind
    large.sort(key=lambda floor: floor.area_m2 * (1.0 + 0.15 * len(floor.doors)), reverse=True)
    if large and "living" not in kinds and large[0].area_m2 >= 10.0:
        large.pop(0).kind = "living"
    kitchens = [floor for floor in large if floor.area_m2 < 11.0]
    if kitchens and "kitchen" not in kinds and len(floors) > 2:
        kitchens[-1].kind = "kitchen"
        large.remove(kitchens[-1])
    for floor in large:
        floor.kind = "bedroom"


def _small_kind(floor: Floor) -> RoomKind | None:
    """Kind of a room too small or too narrow to live in; None for the others."""
    longest = max(wall.length for wall in floor.walls)
    narrow_m = floor.area_m2 / longest
    doors = len(floor.doors)
    if narrow_m < 1.8 and longest > 1.8 * narrow_m and floor.windows and doors <= 2:
        window_m = sum(s_to - s_from for _, s_from, s_to, _ in floor.windows)
        return "balcony" if window_m > 0.5 * longest else "bathroom"
    if doors >= 3 and (narrow_m < 2.0 or floor.area_m2 < 7.0):
        return "corridor"
    if narrow_m < 1.5 and longest > 2.2 * narrow_m:
        return "corridor" if doors >= 2 else "store"
    if floor.area_m2 < 1.3:
        return "store"
    return "bathroom" if floor.area_m2 < 5.2 else None
