"""Items against the rooms they stand in: out of room, and rooms left unfurnished."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence

import shapely

from chord_usd.base.metrics.footprints import GRID_M, footprints_of
from chord_usd.base.scene.geometry import footprint_polygon, room_polygon
from chord_usd.base.scene.palette import CATEGORIES, having
from chord_usd.base.scene.tunnels import as_cut
from chord_usd.base.scene.types import WET_KINDS, Item, Opening, Room, RoomKind, SceneGraph

_BESIDE_STUDIO: tuple[RoomKind, ...] = ("kitchen", *sorted(WET_KINDS), "balcony", "store")

MAX_SHARE_OUTSIDE = 0.01
"""An item is out of its room when more than this share of its footprint is (PhyScene's R_out)."""

DRESSING_SLACK_M = 0.005
"""As much as contact of meshes (stage.check_contact.MIN_DEPTH_M)."""

FURNISHED_KINDS: frozenset[RoomKind] = frozenset(
    ("living", "dining", "bedroom", "kitchen", *WET_KINDS, "study")
)
"""Kinds of room that nobody leaves empty; corridors, stores and balconies often are."""

MIN_UNKNOWN_ROOM_M2 = 6.0
"""A room of unknown kind counts as one to furnish from this size on; smaller may be a corridor."""


def out_of_room(graph: SceneGraph) -> list[str]:
    """Ids of items with more than MAX_SHARE_OUTSIDE of their footprint outside their room.

    An item whose room_id names no room is out. Tabletop items are not looked at: they belong to
    what carries them. Dressing is thin: it may reach DRESSING_SLACK_M into walls, and in windows.
    """
    things = (*graph.items, *graph.dressing)
    if not things:
        return []
    nowhere = shapely.Polygon()
    floors = {room.id: room_polygon(room) for room in graph.rooms}
    wider = _with_windows(floors, as_cut(graph.rooms, graph.openings)) if graph.dressing else {}
    homes = [floors.get(item.room_id, nowhere) for item in graph.items]
    homes += [wider.get(item.room_id, nowhere) for item in graph.dressing]
    prints = footprints_of(things)
    outside_m2 = shapely.area(shapely.difference(prints.polygons, homes, grid_size=GRID_M))
    share = outside_m2 / prints.areas_m2
    return [item.id for item, s in zip(things, share, strict=True) if s > MAX_SHARE_OUTSIDE]


def _with_windows(
    floors: Mapping[str, shapely.Polygon], openings: Iterable[Opening]
) -> dict[str, shapely.Geometry]:
    """The floors by room id, grown into the walls a little and by the windows beside them."""
    windows = [footprint_polygon(opening.box) for opening in openings if opening.kind == "window"]
    return {
        room_id: shapely.union_all(
            [floor, *(window for window in windows if window.distance(floor) < DRESSING_SLACK_M)]
        ).buffer(DRESSING_SLACK_M, join_style="mitre")
        for room_id, floor in floors.items()
    }


def is_to_furnish(room: Room) -> bool:
    """Whether an empty room of this kind counts as a fault."""
    if room.kind == "unknown":
        return room_polygon(room).area >= MIN_UNKNOWN_ROOM_M2
    return room.kind in FURNISHED_KINDS


def is_of_kind(item: Item, kind: RoomKind, mixed: RoomKind | None = None) -> bool:
    """Whether this category usually stands in such a room; anything fits an unknown one."""
    return stands_in(item.category, kind, mixed)


def stands_in(category: str, kind: RoomKind, mixed: RoomKind | None = None) -> bool:
    """The same of a category by its name. mixed: mixed_kind of the home."""
    row = CATEGORIES.get(category)
    if kind == "unknown" or row is None:
        return kind == "unknown"
    lives = "living" in row.rooms if kind == "bedroom" else "studio" in row.traits
    return kind in row.rooms or (kind == mixed and lives)


def plumbing_elsewhere(kinds: Collection[RoomKind]) -> set[str]:
    """Categories that rooms of these kinds, those of a home, are for, and none of unknown kind:
    networks take a closet for a WC, and a bare room for a kitchen."""
    units = having("kitchen_unit")
    wet = having("fixture") - units if {*WET_KINDS}.intersection(kinds) else set()
    return {*wet, *(units if "kitchen" in kinds else ())}


def mixed_kind(kinds: Sequence[RoomKind]) -> RoomKind | None:
    """The kind of room in which a home of rooms of these kinds both lives and sleeps: the living
    room of a studio, the bedrooms of a home that has no room to live in."""
    if is_studio(kinds):
        return "living"
    is_home = {"bedroom", "bathroom", "kitchen"} <= {*kinds}
    return "bedroom" if is_home and not {"living", "dining", "unknown"} & {*kinds} else None


def is_studio(kinds: Sequence[RoomKind]) -> bool:
    """Whether a home of rooms of these kinds has one room to live and sleep in.

    A corridor leads to rooms of other storeys: a home with one is no studio. A living room without
    a bathroom or WC is a room of a home that is not shown.
    """
    is_home = kinds.count("living") == 1 and not {"bathroom", "wc"}.isdisjoint(kinds)
    return is_home and {*kinds} <= {"living", *_BESIDE_STUDIO}


def rooms_to_furnish(rooms: Iterable[Room]) -> list[Room]:
    """The denominator of the furnished share: rooms for which is_to_furnish."""
    return [room for room in rooms if is_to_furnish(room)]


def empty_rooms(graph: SceneGraph) -> list[str]:
    """Ids of rooms to furnish that hold no item of their kind (the paper's empty room rate)."""
    return [
        room.id
        for room in rooms_to_furnish(graph.rooms)
        if not any(is_of_kind(item, room.kind) for item in graph.items_of(room.id))
    ]
