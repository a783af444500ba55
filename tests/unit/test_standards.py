"""Standards: each clause has a source and a known measure; what keeps them, and what does not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chord_usd.base.errors import ChordError
from chord_usd.base.metrics.design.price import broken_share
from chord_usd.base.metrics.design.standard import (
    HOME,
    NAMES,
    OF_HOME,
    OF_ROOM,
    keeping,
    planning_to,
    standards_in,
    standards_named,
)
from chord_usd.base.metrics.design.view import view_home
from chord_usd.base.scene.types import Box, Item, Opening, Room, RoomKind, SceneGraph

DIN, WHEELCHAIR = "DIN 18040-2", "DIN 18040-2 R"


def house(
    kind: RoomKind, size_m: tuple[float, float], items: tuple[Item, ...] = (), door_m: float = 0.9
) -> SceneGraph:
    """A room with a door in the middle of its southern wall."""
    width, depth = size_m
    polygon = np.array([[0.0, 0.0], [width, 0.0], [width, depth], [0.0, depth]])
    door = Opening("door", "door", Box((width / 2, -0.12, 0.0), (door_m, 0.24, 2.1), 0.0), ("a",))
    return SceneGraph((Room("a", kind, polygon),), (door,), items)


@pytest.mark.parametrize("name", NAMES)
def test_a_standard_has_twelve_clauses_each_with_a_source(name: str):
    (standard,) = standards_named([name])
    assert len(standard.clauses) >= 12
    assert len({clause.name for clause in standard.clauses}) == len(standard.clauses)
    for clause in standard.clauses:
        assert clause.source
        assert clause.text
        assert clause.kinds
        known = OF_HOME if HOME in clause.kinds else OF_ROOM
        assert not clause.measure or (clause.measure in known and clause.need >= 0.0)


def test_an_unknown_standard_is_one_line_with_the_known_ones():
    with pytest.raises(ChordError, match="M4"):
        standards_named(["BS 8300"])
    assert standards_in("din 18040-2,")[0].name == DIN


def test_two_standards_that_contradict_each_other_are_refused():
    with pytest.raises(ChordError, match="contradict each other: height of the basin"):
        standards_in("NKBA, DIN 18040-2")
    assert len(standards_in("DIN 18040-2, M4(3)")) == 2


@pytest.mark.parametrize(("side_m", "keeps"), [(1.4, False), (1.6, True)])
def test_a_plan_s_limits_are_found_before_it_is_furnished(side_m: float, keeps: bool):
    (standard,) = standards_named([WHEELCHAIR])
    kept = keeping(standard, [house("bathroom", (side_m, 2.0))], of_plan=True)
    assert ("bathroom, to turn" in kept.kept) == keeps
    broken = {clause.name: found for clause, place, found in kept.findings if place == "a"}
    if not keeps:
        found = broken["bathroom, to turn"]
        assert found.have == pytest.approx(side_m, abs=0.05)
        assert 0.0 <= found.at[0] <= side_m
        assert 0.0 <= found.at[1] <= 2.0


def test_narrow_doors_and_corridors_are_found_with_their_place():
    (standard,) = standards_named([DIN])
    kept = keeping(standard, [house("corridor", (1.0, 4.0), door_m=0.7)], of_plan=True)
    broken = {clause.name: found for clause, _, found in kept.findings}
    assert broken["doors, inner"].have == pytest.approx(0.7)
    assert broken["doors, inner"].at == pytest.approx((0.5, -0.12))
    assert broken["corridors"].have == pytest.approx(1.0, abs=0.06)


def test_furniture_takes_the_place_to_turn():
    (standard,) = standards_named([WHEELCHAIR])
    bed = Item("bed", "bed", Box((1.0, 2.0, 0.0), (1.8, 2.0, 0.5), 0.0), "a")
    empty = house("bedroom", (3.0, 3.0))
    assert "rooms, to turn" in keeping(standard, [empty]).kept
    kept = keeping(standard, [replace(empty, items=(bed,))])
    assert "rooms, to turn" not in kept.kept
    assert "bed, one side" in {clause.name for clause, _, _ in kept.findings}


def test_a_clause_without_a_number_is_not_checked_and_breaks_nothing():
    (standard,) = standards_named(["M4(3)"])
    kept = keeping(standard, [house("corridor", (0.8, 3.0), door_m=0.6)])
    assert {clause.name for clause in kept.unchecked} >= {"doors, inner", "hall, width"}
    assert kept.holds
    assert "planned to M4(3)" in kept.summary
    assert "certified" not in str(kept.as_json()).lower()


def test_drafts_cost_more_that_break_the_standard_a_home_is_planned_to():
    near = Item("bed", "bed", Box((1.0, 2.0, 0.0), (1.4, 2.0, 0.5), 0.0), "a")
    graph = house("bedroom", (4.5, 3.2), (near,))
    (room,) = view_home(graph).rooms
    before = broken_share(room)
    with planning_to(standards_named([WHEELCHAIR])):
        assert broken_share(room) > before
    assert broken_share(room) == before


@pytest.mark.parametrize("corners", [4, 40])
@pytest.mark.parametrize("side_m", [0.6, 1.0, 20.0])
@pytest.mark.parametrize("kind", ["bathroom", "kitchen", "living", "corridor", "bedroom"])
def test_any_room_is_judged_without_an_error(kind: RoomKind, side_m: float, corners: int):
    angles = np.linspace(0.0, 2 * np.pi, corners, endpoint=False)
    polygon = np.stack([np.cos(angles), np.sin(angles)], axis=1) * side_m / 2 + side_m
    graph = SceneGraph((Room("a", kind, polygon),), (), ())
    for name in NAMES:
        (standard,) = standards_named([name])
        for of_plan in (True, False):
            keeping(standard, [graph], of_plan=of_plan)
