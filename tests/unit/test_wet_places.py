"""Fixtures placed together along the walls of bathrooms, washrooms and WCs."""

from __future__ import annotations

import pytest

from chord_usd.base.metrics.design import judged_room
from chord_usd.base.metrics.design.price import tight
from chord_usd.base.metrics.design.shell import shells
from chord_usd.base.metrics.design.view import View
from chord_usd.base.scene.types import (
    Box,
    Item,
    Opening,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)
from chord_usd.line.lists.improve import improved
from chord_usd.line.lists.put_back import put_back
from chord_usd.line.lists.wet_places import composed

SIZES = {
    "toilet": (0.38, 0.6, 0.78), "washbasin": (0.37, 0.27, 0.85), "shower": (0.78, 0.78, 2.0),
    "bathtub": (1.5, 0.7, 0.55), "washing_machine": (0.6, 0.6, 0.85),
}  # fmt: skip


def view_of(kind: RoomKind, size: tuple[float, float], *names: str, window: bool = False) -> View:
    """A room with a door in the middle of its south wall, pieces in a heap in a corner."""
    east, north = size
    corners = frozen_array([(0.0, 0.0), (east, 0.0), (east, north), (0.0, north)])
    door = Opening("d", "door", Box((east / 2, -0.12, 0.0), (0.7, 0.24, 2.1), 0.0), ("r",))
    pane = Opening("w", "window", Box((east / 2, north + 0.12, 0.9), (0.8, 0.24, 1.2), 0.0), ("r",))
    room = Room("r", kind, corners)
    holes = (door, pane) if window else (door,)
    items = []
    for name in names:
        long, deep, high = SIZES[name]
        box = Box((long / 2, north - deep / 2, 0.0), (long, deep, high), 0.0)
        items.append(Item(name, name, box, "r"))
    return View(shells((room,), holes)["r"], tuple(items))


def planned(view: View) -> View:
    return improved(view, lambda _: 0.0, [composed])


def broken(view: View) -> set[str]:
    return {found.rule for one in judged_room(view) for found in one.findings}


@pytest.mark.parametrize(
    ("kind", "size", "names", "may_miss"),
    [
        ("wc", (0.84, 2.0), ("toilet",), {"comfortably"}),
        ("wc", (1.4, 1.8), ("toilet", "washbasin"), {"comfortably"}),
        ("bathroom", (1.9, 2.3), ("toilet", "washbasin", "shower"), {"comfortably"}),
        ("bathroom", (2.2, 2.8), ("toilet", "washbasin", "bathtub"), set()),
        ("bathroom", (2.6, 3.2), ("toilet", "washbasin", "bathtub", "shower"), {"comfortably"}),
        ("washroom", (1.5, 2.2), ("washbasin", "washing_machine"), {"comfortably"}),
        ("bathroom", (2.2, 2.6), ("toilet",), {"comfortably"}),  # what it lacks comes, too
    ],
)
@pytest.mark.parametrize("window", [False, True])
def test_fixtures_keep_the_published_clearances(
    kind: RoomKind, size: tuple[float, float], names: tuple[str, ...], may_miss: set[str],
    window: bool,
) -> None:  # fmt: skip
    crowded = view_of(kind, size, *names, window=window)
    made = planned(crowded)
    missed = {rule for rule in broken(made) if not any(word in rule for word in may_miss)}
    assert not missed
    assert tight(made) == 0
    assert {*names} <= {*made.categories}
    ids = {item.id for item in crowded.items}
    assert ids <= {item.id for item in made.items}


def test_a_narrow_wc_has_its_toilet_in_the_middle_and_no_basin() -> None:
    made = planned(view_of("wc", (0.84, 2.0), "toilet", "washbasin"))
    assert made.categories == ["toilet"]
    assert made.items[0].box.center_m[0] == pytest.approx(0.42, abs=0.03)


@pytest.mark.parametrize("bath", ["bathtub", "shower"])
def test_a_small_bathroom_has_a_basin_beside_its_toilet(bath: str) -> None:
    """A shower takes the place of a bath that leaves no floor for a basin of a usual size."""
    made = planned(view_of("bathroom", (1.5, 1.9), "toilet", bath))
    assert sorted(made.categories) == ["shower", "toilet", "washbasin"]
    assert tight(made) == 0
    sizes = {item.category: item.box.size_m for item in made.items}
    assert min(sizes["shower"][:2]) >= 0.75
    assert sizes["washbasin"][0] >= 0.45
    assert sizes["toilet"][0] >= 0.35


def test_a_bath_replaces_a_shower_that_can_stand_only_before_a_window() -> None:
    made = planned(view_of("bathroom", (1.7, 1.9), "toilet", "washbasin", "shower", window=True))
    assert sorted(made.categories) == ["bathtub", "toilet", "washbasin"]
    assert tight(made) == 0


def test_a_room_that_holds_nothing_that_fits_stays_as_it_is() -> None:
    view = view_of("bathroom", (0.7, 0.9), "toilet")
    assert planned(view) is view
    assert not list(composed(view_of("bathroom", (0.7, 0.9))))


def test_a_shower_comes_rather_than_a_washing_machine() -> None:
    made = planned(view_of("bathroom", (1.3, 2.2), "toilet", "washbasin", "washing_machine"))
    assert "shower" in made.categories
    assert "washing_machine" not in made.categories


def test_a_piece_that_somebody_placed_stays() -> None:
    crowded = view_of("bathroom", (2.2, 2.8), "toilet", "washbasin", "bathtub")
    tub = crowded.items[2].with_facts(locked=True)
    made = planned(View(crowded.shell, (*crowded.items[:2], tub)))
    assert tub in made.items
    assert not {rule for rule in broken(made) if "comfortably" not in rule}


def test_the_same_room_is_composed_alike() -> None:
    view = view_of("bathroom", (1.9, 2.3), "toilet", "washbasin", "shower")
    first, second = ([item.box for one in composed(view) for item in one] for _ in range(2))
    assert first == second


def test_basins_have_a_margin_for_the_painter_where_there_is_place() -> None:
    room = planned(view_of("bathroom", (2.6, 3.2), "toilet", "washbasin", "shower"))
    assert [room.length[at] >= 0.55 for at in room.of("washbasin")] == [True]
    small = planned(view_of("wc", (1.4, 1.8), "toilet", "washbasin"))
    assert {"toilet", "washbasin"} <= {*small.categories}


def test_a_room_that_loses_all_its_pieces_gets_a_smaller_one() -> None:
    room = Room("w", "washroom", frozen_array([(0, 0), (1.6, 0), (1.6, 2.2), (0, 2.2)]))
    door = Opening("d", "door", Box((0.6, 2.32, 0.0), (0.8, 0.24, 2.1), 0.0), ("w",))
    wide = Item("set", "washing_set", Box((0.8, 0.35, 0.0), (1.6, 0.7, 0.9), 180.0), "w")
    home = SceneGraph((room,), (door,), (wide,))
    after = put_back(home, home, ["w"], (), lambda house: house.without(["set"]))
    assert len(after.items) == 1
    assert after.items[0].id != "set"
