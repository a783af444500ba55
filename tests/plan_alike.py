"""How far a plan that was written and read again is from what it was."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.scene.geometry import footprint, room_polygon
from chord_usd.base.scene.types import Opening, Plan

_COLLINEAR_M = 1e-3
"""A corner nearer to the line through its neighbours than this is none."""


@dataclass(frozen=True)
class Likeness:
    """Of two plans that lie in one place."""

    rooms: bool
    """Whether rooms are equal in number and kind."""
    openings: bool
    """Whether doors, windows and passages are equal in number."""
    corner_m: float
    """The farthest that a corner of a room strayed; infinite where a room is missing."""
    opening_m: float
    """The farthest that a corner of an opening, its sill or its head strayed."""

    def holds(self, tolerance_m: float = 0.01) -> bool:
        """Whether it is the same plan."""
        return self.rooms and self.openings and max(self.corner_m, self.opening_m) <= tolerance_m


def likeness(found: Plan, wanted: Plan) -> Likeness:
    """Compare two plans in metres."""
    return Likeness(
        rooms=_kinds(found.rooms) == _kinds(wanted.rooms) and _same_kinds(found, wanted),
        openings=_kinds(found.openings) == _kinds(wanted.openings),
        corner_m=max((_nearest_room(room, found) for room in map(_shape, wanted.rooms)), default=0),
        opening_m=max((_nearest_opening(one, found) for one in wanted.openings), default=0.0),
    )


def _kinds(things) -> Counter[str]:  # type: ignore[no-untyped-def]
    return Counter(thing.kind for thing in things)


def _same_kinds(found: Plan, wanted: Plan) -> bool:
    """Whether the room in each place is of the kind that was there."""
    for room in wanted.rooms:
        shape = _shape(room)
        best = max(found.rooms, key=lambda one: _shape(one).intersection(shape).area, default=None)
        if best is None or best.kind != room.kind:
            return False
    return True


def _shape(room) -> Polygon:  # type: ignore[no-untyped-def]
    return room_polygon(room).simplify(_COLLINEAR_M)


def _nearest_room(wanted: Polygon, found: Plan) -> float:
    return min((_apart(wanted, _shape(room)) for room in found.rooms), default=np.inf)


def _apart(one: Polygon, other: Polygon) -> float:
    """The farthest from a corner of one to the nearest of the other, and the other way round."""
    a, b = (np.array(shape.exterior.coords)[:-1] for shape in (one, other))
    distances = np.linalg.norm(a[:, None] - b[None], axis=2)
    return float(max(distances.min(axis=0).max(), distances.min(axis=1).max()))


def _nearest_opening(wanted: Opening, found: Plan) -> float:
    same = [one for one in found.openings if one.kind == wanted.kind]
    return min((_strayed(wanted, one) for one in same), default=np.inf)


def _strayed(one: Opening, other: Opening) -> float:
    corners = footprint(one.box), footprint(other.box)
    flat = np.linalg.norm(corners[0][:, None] - corners[1][None], axis=2)
    low = abs(one.box.center_m[2] - other.box.center_m[2])
    heads = [box.center_m[2] + box.size_m[2] for box in (one.box, other.box)]
    return float(max(flat.min(axis=1).max(), low, abs(heads[0] - heads[1])))
