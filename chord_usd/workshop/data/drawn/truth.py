"""A crowded page and its truth, per pixel and as vectors."""

from __future__ import annotations

from dataclasses import dataclass

import shapely
from shapely.geometry import Polygon
from shapely.geometry.polygon import orient

from chord_usd.base.scene.geometry import polygons_of, room_polygon, rooms_beside
from chord_usd.base.scene.types import (
    ByteArray,
    FloatArray,
    Item,
    Opening,
    Plan,
    Room,
    RoomKind,
    frozen_array,
)

_LEADING: tuple[RoomKind, ...] = (
    "living", "bedroom", "kitchen", "bathroom", "dining", "study", "balcony", "store", "corridor",
)  # fmt: skip


@dataclass(frozen=True, eq=False)
class DrawnStorey:
    """One storey of a page, as vectors."""

    plan: Plan
    """As drawn: rooms between the faces of their walls, those of an open plan touch; openings where
    and as deep as they are drawn. Metres on the sheet."""
    walls_m: tuple[FloatArray, ...]
    """(N, 2) rings of the walls' bodies, openings left out; holes run clockwise."""
    hinges_m: tuple[tuple[str, FloatArray, FloatArray], ...]
    """Of each leaf: its opening's id, (2,) where it hangs and (2,) where its tip is when open."""
    pieces: tuple[Item, ...] = ()
    """Furniture and fixtures that are drawn. Metres on the sheet."""


@dataclass(frozen=True, eq=False)
class CrowdedPage:
    """A page as it arrives, and its truth."""

    rgb: ByteArray
    """(H, W, 3)."""
    labels: ByteArray
    """(H, W); page_labels.built_of and laid_of tell what they say."""
    points: FloatArray
    """(P, 3) continuous pixel x, y and which of page_labels.POINT_NAMES."""
    storeys: tuple[DrawnStorey, ...]
    to_picture: FloatArray
    """(3, 3) from metres on the sheet to continuous pixels of rgb, in homogeneous coordinates."""


def without_seams(plan: Plan) -> Plan:
    """The plan as one who sees no colours would read it: touching rooms are one."""
    floors = polygons_of(shapely.union_all([room_polygon(r).buffer(1e-4) for r in plan.rooms]))
    rooms = []
    for index, floor in enumerate(floors):
        parts = [r for r in plan.rooms if floor.contains(room_polygon(r).representative_point())]
        kinds = {room.kind for room in parts}
        kind: RoomKind = next((one for one in _LEADING if one in kinds), "unknown")
        outline = floor if len(parts) > 1 else room_polygon(parts[0])
        outline = orient(Polygon(outline.exterior).simplify(1e-3))
        corners = frozen_array(outline.exterior.coords[:-1])
        rooms.append(Room(f"room{index + 1}", kind, corners))
    openings = tuple(
        Opening(o.id, o.kind, o.box, rooms_beside(o.box, rooms)) for o in plan.openings
    )
    return Plan(tuple(rooms), openings)
