"""The programme of a home: which pieces its rooms hold so that those who sleep there can also eat,
sit, wash, and hang up their coats. Follows from the plan alone, before any room is furnished."""

from __future__ import annotations

from collections.abc import Sequence

from chord_usd.base.metrics.design.home_rules import MOST_DINERS
from chord_usd.base.metrics.design.shell import Shell, shells
from chord_usd.base.metrics.rooms import is_studio, stands_in
from chord_usd.base.metrics.walk import entrance, rooms_beside
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Opening, Room, RoomKind, SceneGraph

DOUBLE_M2 = 9.0
"""A bedroom at least so large is for two."""
WASHED_IN: tuple[RoomKind, ...] = ("washroom", "balcony", "bathroom", "kitchen")
TABLE_M2 = 9.0
"""A room of another kind takes a dining table from this size on."""
LAUNDRY_M2 = 3.5
"""A bathroom takes a washing machine from this size on."""
TOILET_M2 = 3.0
"""A smaller bathroom has no toilet in a home with a WC apart."""

HAND_BASIN_M2 = 1.3
"""A WC has a basin from this size on, where that leaves the floor that people need."""

_SMALL = 4

Programme = dict[str, tuple[str, ...]]
"""By room id, categories of pieces, as often as they are needed."""


def toilets_elsewhere(rooms: Sequence[Room]) -> frozenset[str]:
    """Ids of the bathrooms of a home whose toilet is in a WC of the home."""
    has_wc = any(room.kind == "wc" for room in rooms)
    return frozenset(room.id for room in rooms if has_wc and room.kind == "bathroom"
                     and room_polygon(room).area < TOILET_M2)  # fmt: skip


def suits_dining(shell: Shell) -> tuple[int, float]:
    """How well a dining table suits a room, the best first; from _SMALL on lists name none.

    A living room that no way joins to a kitchen comes after a kitchen with room for a table.
    """
    large = shell.area_m2 >= TABLE_M2
    order = {
        "dining": 0,
        "living": (1 if shell.joins_kitchen else 3) if large else _SMALL,
        "kitchen": 2 if large else _SMALL,
        "bedroom": _SMALL + 1,
    }
    return order.get(shell.kind, _SMALL + 2), -shell.area_m2


def programme_of(rooms: Sequence[Room], openings: Sequence[Opening]) -> Programme:
    """What each room of a home holds at least."""
    areas = {room.id: float(room_polygon(room).area) for room in rooms}
    pieces: dict[str, list[str]] = {room.id: [] for room in rooms}
    largest: dict[RoomKind, Room] = {}
    for room in sorted(rooms, key=lambda candidate: -areas[candidate.id]):
        largest.setdefault(room.kind, room)
    sleepers = 0
    in_studio = is_studio([room.kind for room in rooms])
    for room in rooms:
        if room.kind == "bedroom":
            double = areas[room.id] >= DOUBLE_M2
            sleepers += 2 if double else 1
            pieces[room.id] += ["bed", "cabinet", *["bedside_table"] * (2 if double else 1)]
        if room.kind == "store":
            pieces[room.id].append("cabinet")
        if room.kind == "wc":
            pieces[room.id] += ["toilet", *["washbasin"] * (areas[room.id] >= HAND_BASIN_M2)]
        if room.kind == "washroom":
            pieces[room.id].append("washbasin")
        if room.kind == "kitchen":
            pieces[room.id] += ["sink_cabinet", "cooker_cabinet", "refrigerator"]
    if "living" in largest:
        # Networks have seen no such room: of long programmes they make rows of small pieces.
        rest = ["bed"] if in_studio else ["tv_cabinet", "single_sofa"]
        pieces[largest["living"].id] += ["sofa", "coffee_table", *rest]
    eaten = min(shells(tuple(rooms), tuple(openings)).values(), key=suits_dining, default=None)
    if eaten is not None and suits_dining(eaten)[0] < _SMALL:
        diners = min(max(2, sleepers), MOST_DINERS)
        pieces[eaten.room.id] += ["dining_table", *["chair"] * diners]
    washed = next((largest[kind] for kind in WASHED_IN if kind in largest
                   and (kind != "bathroom" or areas[largest[kind].id] >= LAUNDRY_M2)
                   and stands_in("washing_machine", kind)), None)  # fmt: skip
    if washed is not None:
        pieces[washed.id].append("washing_machine")
    front = entrance(SceneGraph(tuple(rooms), tuple(openings), ()))
    if front is not None:
        hall = next(room for room in rooms_beside([front], rooms)[0] if room is not None)
        if stands_in("shoe_cabinet", hall.kind):
            pieces[hall.id].append("shoe_cabinet")
    return {room_id: tuple(wanted) for room_id, wanted in pieces.items() if wanted}
