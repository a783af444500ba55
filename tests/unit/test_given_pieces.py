"""Rooms that are furnished about pieces which the plan shows, and these stay."""

from __future__ import annotations

from dataclasses import replace

import pytest

from chord_usd.base.metrics.complete import homely_rooms
from chord_usd.base.metrics.design.view import view_home
from chord_usd.base.scene.types import (
    Box,
    Item,
    Opening,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)
from chord_usd.line.lists.changes import Propose
from chord_usd.line.lists.dining_changes import more_chairs, seats_at
from chord_usd.line.lists.house import _foreign
from chord_usd.line.lists.improve import improved
from chord_usd.line.lists.other_places import bed_instead, sofa_groups
from chord_usd.line.lists.pieces import rooms_around
from chord_usd.line.lists.put_back import put_back, without_strays


def _home(kind: RoomKind, size: tuple[float, float], *pieces: Item) -> SceneGraph:
    """One room with a door in a corner of its south wall."""
    east, north = size
    corners = frozen_array([(0.0, 0.0), (east, 0.0), (east, north), (0.0, north)])
    door = Opening("d", "door", Box((0.6, -0.12, 0.0), (0.8, 0.24, 2.1), 0.0), ("r",))
    return SceneGraph((Room("r", kind, corners),), (door,), pieces)


def _piece(name: str, box: Box, *, given: bool = False) -> Item:
    return Item(f"r/{name}_0", name, box, "r").with_facts(locked=given)


SOFA = _piece("sofa", Box((2.5, 3.5, 0.0), (2.0, 0.9, 0.8), 0.0), given=True)
TABLE = _piece("dining_table", Box((3.0, 2.6, 0.0), (1.4, 0.8, 0.75), 0.0), given=True)
ARMCHAIR = _piece("single_sofa", Box((1.0, 1.5, 0.0), (0.8, 0.8, 0.8), 45.0))


@pytest.mark.parametrize(
    ("kind", "pieces", "change", "comes"),
    [
        ("living", (SOFA, ARMCHAIR), sofa_groups, "coffee_table"),
        ("dining", (TABLE,), lambda view: more_chairs(view, 4), "chair"),
    ],
)
def test_what_a_drawing_lacks_comes_to_what_it_shows(
    kind: RoomKind, pieces: tuple[Item, ...], change: Propose, comes: str
) -> None:
    (before,) = view_home(_home(kind, (5.0, 4.0), *pieces)).rooms
    after = improved(before, lambda _: 0.0, [change])
    given = [item for item in pieces if item.facts.locked]
    assert given == [item for item in after.items if item.facts.locked]
    assert comes in after.categories
    assert not after.of("dining_table") or seats_at(after) == 4


def test_a_bed_replaces_what_leaves_it_no_place() -> None:
    """But what the plan shows stays."""
    wide = Box((1.5, 2.7, 0.0), (2.9, 0.6, 2.0), 0.0)
    rest = [
        _piece("cabinet", wide), _piece("table", Box((2.6, 1.0, 0.0), (1.4, 0.7, 0.75), 90.0))
    ]  # fmt: skip
    home = _home("bedroom", (3.0, 3.0), *rest)
    (view,) = view_home(home).rooms
    assert improved(view, lambda _: 0.0, [bed_instead]).of("bed")
    given = [item.with_facts(locked=True) for item in rest]
    (view,) = view_home(_home("bedroom", (3.0, 3.0), *given)).rooms
    assert {*given} <= {*improved(view, lambda _: 0.0, [bed_instead]).items}


def test_a_studio_sleeps_in_its_living_room() -> None:
    """All that the home lacks is a bed."""
    living = _home("living", (5.0, 4.0), SOFA)
    east = {"b": ("bathroom", 0.0), "k": ("kitchen", 2.24)}
    others = [
        Room(name, kind, frozen_array([(5.24, y), (8.0, y), (8.0, y + 1.8), (5.24, y + 1.8)]))
        for name, (kind, y) in east.items()
    ]
    ways = [
        Opening(name, "door", Box((5.12, y + 0.9, 0.0), (0.8, 0.24, 2.1), 90.0), ("r", name))
        for name, (_, y) in east.items()
    ]
    fixtures = [
        Item(name, name, Box((x, y, 0.0), (0.5, 0.6, 0.85), 0.0), room)
        for name, x, y, room in (
            ("toilet", 7.7, 1.5, "b"), ("sink_cabinet", 7.7, 3.74, "k"),
            ("cooker_cabinet", 7.2, 3.74, "k"),
        )
    ]  # fmt: skip
    home = SceneGraph(
        (*living.rooms, *others), (*living.openings, *ways), (*living.items, *fixtures)
    )
    furnished = put_back(home, home, ["r"], [], lambda house: house)
    assert "bed" in {item.category for item in furnished.items_of("r")}


def test_a_chair_at_no_table_goes_and_others_stay() -> None:
    stray = _piece("chair", Box((1.0, 3.0, 0.0), (0.45, 0.5, 0.9), 20.0))
    seat = replace(stray, id="r/chair_1", box=Box((3.0, 1.95, 0.0), (0.45, 0.5, 0.9), 180.0))
    given = replace(stray, id="r/chair_2").with_facts(locked=True)
    (view,) = view_home(_home("living", (5.0, 4.0), TABLE, stray, seat, given)).rooms
    assert {*without_strays(view)} == {(TABLE, seat, given)}


def test_an_open_border_is_no_wall() -> None:
    """A television with its back to the next part of an open plan stands in the middle of it."""
    parts = [
        Room(name, kind, frozen_array([(x, 0.0), (x + 4.0, 0.0), (x + 4.0, 4.0), (x, 4.0)]))
        for name, kind, x in (("r", "living", 0.0), ("k", "kitchen", 4.0))
    ]
    pieces = [
        _piece("sofa", Box((0.5, 2.0, 0.0), (2.0, 0.9, 0.8), 90.0)),
        _piece("tv_cabinet", Box((3.8, 2.0, 0.0), (1.6, 0.4, 0.5), -90.0)),
    ]
    room, _ = homely_rooms(SceneGraph(tuple(parts), (), tuple(pieces)))
    assert [(one.category, one.fault) for one in room.misplaced] == [("tv_cabinet", "off its wall")]
    (alone,) = homely_rooms(SceneGraph((parts[0],), (), tuple(pieces)))
    assert not alone.misplaced


def test_rooms_of_unknown_kind_have_no_plumbing_that_their_home_has_rooms_for() -> None:
    def foreign(*kinds: RoomKind) -> set[str]:
        square = frozen_array([(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)])
        rooms = [Room(str(at), kind, square + 4.0 * at) for at, kind in enumerate(kinds)]
        (around, *_) = rooms_around(SceneGraph(tuple(rooms), (), ()), "homes", None)
        return _foreign(rooms[0], around)

    assert not foreign("unknown", "unknown")
    assert {"toilet", "shower"} <= foreign("unknown", "bathroom")
    assert "sink_cabinet" in foreign("unknown", "kitchen", "wc")
    assert "bed" not in foreign("unknown", "kitchen", "wc")
