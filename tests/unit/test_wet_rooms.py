"""WCs, washrooms and bathrooms: which room is which, and that everything knows all three."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from chord_usd.base.metrics.complete import homely_rooms, is_complete
from chord_usd.base.metrics.rooms import stands_in
from chord_usd.base.scene.chord_json import plan_from_json, plan_to_json
from chord_usd.base.scene.drawn_pieces import DRAWN, to_entry
from chord_usd.base.scene.style_looks import GROUP_OF
from chord_usd.base.scene.types import (
    LEARNED_KINDS,
    ROOM_KINDS,
    Box,
    Item,
    Opening,
    Plan,
    Room,
    RoomKind,
    frozen_array,
    learned_kind,
)
from chord_usd.base.scene.wet_rooms import with_wet_kinds
from chord_usd.base.scene.wish import NAMES, with_wished_wet
from chord_usd.line.image.preview import ROOM_TINTS
from chord_usd.line.lists.home_programme import programme_of, toilets_elsewhere
from chord_usd.line.plan.corrections import read_rooms
from chord_usd.line.planning.wording import read_wish
from chord_usd.line.stage.author.names import ROOM_LABELS
from chord_usd.workshop.data.furnish import furnish


def home(*rooms: tuple[RoomKind, float, str], doors: Sequence[tuple[int, int]] = ()) -> Plan:
    """Rooms of so many square metres, 2 m deep, side by side along a hall that all open into, but
    for those of doors: pairs of neighbours, the second of which opens into the first alone."""
    made = [
        Room("hall", "corridor", frozen_array([(0, -1.24), (30, -1.24), (30, -0.24), (0, -0.24)]))
    ]
    ways = []
    west = 0.0
    inner = {second for _, second in doors}
    for number, (kind, area_m2, name) in enumerate(rooms):
        east = west + area_m2 / 2
        corners = frozen_array([(west, 0.0), (east, 0.0), (east, 2.0), (west, 2.0)])
        made.append(Room(f"r{number}", kind, corners, name))
        if number in inner:
            box = Box((west - 0.12, 0.6, 0.0), (0.7, 0.24, 2.1), 90.0)
            ways.append(Opening(f"d{number}", "door", box, (f"r{number - 1}", f"r{number}")))
        else:
            box = Box(((west + east) / 2, -0.12, 0.0), (0.7, 0.24, 2.1), 0.0)
            ways.append(Opening(f"d{number}", "door", box, ("hall", f"r{number}")))
        west = east + 0.24
    return Plan(tuple(made), tuple(ways))


def wet(area_m2: float, name: str = "", kind: RoomKind = "bathroom") -> tuple[RoomKind, float, str]:
    return kind, area_m2, name


BED: tuple[RoomKind, float, str] = ("bedroom", 12.0, "")


@pytest.mark.parametrize(
    ("plan", "kinds"),
    [
        (home(BED, wet(5.0)), ["bathroom"]),
        (home(BED, wet(1.8)), ["bathroom"]),  # the only one: somebody has to wash there
        (home(BED, wet(5.0), wet(1.4)), ["bathroom", "wc"]),
        (home(BED, BED, BED, wet(5.0), wet(4.0)), ["bathroom", "bathroom"]),
        (home(BED, wet(1.2), wet(3.0), wet(2.6), doors=[(2, 3)]), ["wc", "washroom", "bathroom"]),
        (home(BED, wet(5.0), wet(2.4, "Gäste-WC", "wc")), ["bathroom", "wc"]),
        (home(BED, wet(5.0, "WC", "wc")), ["bathroom"]),  # a bathroom that people call WC
        (home(BED, wet(4.5), wet(3.0, "Laundry", "washroom")), ["bathroom", "washroom"]),
        (home(BED, BED, *[wet(4.0)] * 8), ["bathroom"] * 8),
    ],
)
def test_size_names_doors_and_the_needs_of_the_home_decide(plan: Plan, kinds: list[str]) -> None:
    found = with_wet_kinds(plan)
    assert [room.kind for room in found.rooms if learned_kind(room.kind) == "bathroom"] == kinds


def test_a_name_that_says_no_more_than_the_class_follows_the_kind() -> None:
    plan = home(BED, wet(5.0, "Bathroom 1"), wet(1.3, "Bathroom 2"), wet(1.4, "Bad der Kinder"))
    names = [room.name for room in with_wet_kinds(plan).rooms[2:]]
    assert names == ["Bathroom 1", "WC 1", "Bad der Kinder"]


def test_what_is_drawn_decides() -> None:
    plan = home(BED, wet(3.0), wet(3.0), wet(3.0))
    drawn = {"r1": "washing_basin", "r2": "bathtub", "r3": "toilet"}
    marks = [{"category": name, "x": float(plan.room(room).polygon_m[:, 0].mean()), "y": 1.0}
             for room, name in drawn.items()]  # fmt: skip
    seen = [
        Item("", "washbasin" if "basin" in name else name, Box((x, 1.0, 0.0), (0.6, 0.6, 0.6), 0.0))
        for name, x in ((mark["category"], mark["x"]) for mark in marks)
    ]
    for extra in ({"fixtures": marks}, {DRAWN: to_entry(seen)}):
        found = with_wet_kinds(Plan(plan.rooms, plan.openings, extra))
        assert [room.kind for room in found.rooms[2:]] == ["washroom", "bathroom", "wc"]


@pytest.mark.parametrize("noted", [7, [3], [{"x": "a"}], [{"category": [], "x": 1, "y": None}]])
def test_unknown_notes_of_a_file_are_passed_over(noted: object) -> None:
    assert with_wet_kinds(Plan(home(BED, wet(5.0)).rooms, (), {"fixtures": noted})).rooms


def test_json_keeps_what_is_said_and_old_files_are_read() -> None:
    plan = home(BED, wet(5.0), wet(1.2), wet(1.3))
    old = plan_to_json(plan)
    for room in old["rooms"]:
        room.pop("roomKind", None)
    assert [room.kind for room in plan_from_json(old).rooms[2:]] == ["bathroom", "wc", "wc"]
    said = plan_from_json(plan_to_json(plan))  # names its bathrooms' kind
    assert [room.kind for room in said.rooms] == [room.kind for room in plan.rooms]


def test_every_table_knows_every_kind_and_networks_know_theirs() -> None:
    for table in (ROOM_LABELS, ROOM_TINTS, GROUP_OF):
        assert set(table) == set(ROOM_KINDS)
    assert {*NAMES, "unknown"} == set(ROOM_KINDS)
    assert {learned_kind(kind) for kind in ROOM_KINDS} == set(LEARNED_KINDS)
    assert (ROOM_LABELS["wc"], ROOM_LABELS["washroom"]) == ("WC", "Washroom")
    assert not any(stands_in(name, "wc") for name in ("bathtub", "shower", "washing_machine"))
    assert not any(stands_in(name, "washroom") for name in ("bathtub", "shower", "toilet"))


def test_the_programme_has_one_place_for_each_use() -> None:
    plan = home(BED, wet(2.6), wet(1.5, kind="wc"), wet(3.0, kind="washroom"))
    needed = programme_of(plan.rooms, plan.openings)
    assert needed["r2"] == ("toilet", "washbasin")
    assert set(needed["r3"]) == {"washing_machine", "washbasin"}
    assert toilets_elsewhere(plan.rooms) == {"r1"}


def test_the_teacher_furnishes_all_three() -> None:
    plan = home(("bedroom", 14.0, ""), wet(6.0), wet(3.2, kind="wc"), wet(6.0, kind="washroom"))
    for seed in range(6):
        made = furnish(plan, np.random.default_rng(seed))
        held = {room.id: {item.category for item in made.items_of(room.id)} for room in plan.rooms}
        assert is_complete([one for one in homely_rooms(made) if one.room in ("r1", "r2", "r3")])
        assert held["r2"] == {"toilet", "washbasin"}
        assert held["r3"] == {"washing_machine", "washbasin"}


def test_words_ask_for_all_three() -> None:
    wish = read_wish("a flat with 2 bedrooms, a bathroom, a WC and a laundry room").wish
    assert (wish.counts["bathroom"], wish.wet) == (3, {"wc": 1, "washroom": 1})
    found = with_wished_wet(home(wet(5.0), wet(2.0), wet(3.0)), wish)
    assert [room.kind for room in found.rooms[1:]] == ["bathroom", "wc", "washroom"]
    assert [one.kind for one in read_rooms("3: WC, 4: laundry, 5: toilet / bath")] == [
        "wc", "washroom", "bathroom",
    ]  # fmt: skip
    # Of the only wet room a text may speak as of a toilet.
    assert read_wish("one bedroom and a toilet").wish.wet == {}
