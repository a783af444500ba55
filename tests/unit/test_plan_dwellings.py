"""Dwellings on one plan: common stairs, homes by themselves, and what is no home."""

from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.errors import PlanError
from chord_usd.base.raster.page_labels import KIND_NAMES
from chord_usd.base.scene.dwellings import DWELLING, NO_HOME, is_common, only_dwelling
from chord_usd.base.scene.types import Box, Opening, Plan, Room, frozen_array
from chord_usd.line.pipeline.steps import refuse_no_home
from chord_usd.line.plan.home_graph import dwellings_of, of_dwellings, work_names
from chord_usd.line.plan.home_uses import Floor

FLAT = ["living", "bathroom", "bedroom"]


def test_flats_on_a_stair_are_dwellings_and_the_stair_is_common():
    kinds = ["corridor", *FLAT, *FLAT, "store"]
    pairs = [(0, 1), (1, 2), (1, 3), (0, 4), (4, 5), (4, 6), (0, 7)]
    assert dwellings_of(kinds, pairs) == [0, 1, 1, 1, 2, 2, 2, 0]


@pytest.mark.parametrize(
    ("kinds", "pairs"),
    [
        # Two suites and a kitchen on a hall.
        (["corridor", "bedroom", "bathroom", "bedroom", "bathroom", "kitchen"],
         [(0, 1), (1, 2), (0, 3), (3, 4), (0, 5)]),
        # A hall within a flat, with a door to the landing.
        (["corridor", *FLAT, "corridor"], [(0, 1), (0, 2), (0, 3), (0, 4)]),
        ([*FLAT], [(0, 1), (0, 2)]),
        # A hall, and a kitchen with a bath that no door joins to it.
        (["corridor", *FLAT, "kitchen", "bathroom"], [(0, 1), (1, 2), (1, 3), (4, 5)]),
        # A wing of bedroom, bath and breakfast nook.
        (["corridor", *FLAT, "kitchen", "bedroom", "bathroom", "dining"],
         [(0, 1), (1, 2), (1, 3), (1, 4), (0, 5), (5, 6), (5, 7)]),
        (["corridor", "unknown"], []),
    ],
)  # fmt: skip
def test_a_home_is_one_dwelling(kinds, pairs):
    assert set(dwellings_of(kinds, pairs)) == {1}


def floor(told="unknown", stairs=0.0):
    return Floor(np.full(len(KIND_NAMES), 0.1), told, stairs=stairs)


HOME = [floor("living"), floor("bathroom"), floor("kitchen")]
INSIDE = [[0, 1], [0, 2]]
LANDING, STAIR = floor(), floor("corridor", 0.4)


@pytest.mark.parametrize(
    ("floors", "ways", "common"),
    [
        # A landing with a door to a neighbour, and the stair behind it with the building's door.
        ([*HOME, LANDING, STAIR], [*INSIDE, [0, 3], [3, 4], [3], [4]], {3, 4}),
        # The stair of a house: one door out.
        ([*HOME, LANDING, STAIR], [*INSIDE, [0, 3], [3, 4], [3]], set()),
        # A hall with a stair, on which two rooms of the home hang.
        ([*HOME, floor("corridor", 0.4)], [*INSIDE, [0, 3], [1, 3], [3], [3]], set()),
        # A hall with two doors out and no stair.
        ([*HOME, LANDING], [*INSIDE, [0, 3], [3], [3]], set()),
        # A bedroom behind the hall.
        ([*HOME, STAIR, floor("bedroom")], [*INSIDE, [0, 3], [3, 4], [3], [3]], set()),
    ],
    ids=["landing", "house", "hall", "no stair", "bedroom"],
)
def test_a_landing_with_other_doors_is_common(floors, ways, common):
    """It was furnished, or a room of unknown kind."""
    found, whose = of_dwellings(floors, ways)
    assert {at for at, number in enumerate(whose) if number == 0} == common
    assert found[0].is_outer == bool(common)


def room(name, number, west):
    corners = np.array([(west, 0.0), (west + 3, 0.0), (west + 3, 3.0), (west, 3.0)])
    return Room(name, "living", frozen_array(corners), extra={DWELLING: number})


def door(name, x, *rooms):
    return Opening(name, "door", Box((x, 1.5, 0.0), (0.8, 0.24, 2.1), 90.0), rooms)


BLOCK = Plan(
    (room("a", 1, 0.0), room("stair", 0, 3.24), room("b", 2, 6.48)),
    (door("door1", 3.12, "a", "stair"), door("door2", 6.36, "stair", "b")),
)


def test_a_dwelling_alone_keeps_its_front_door():
    alone = only_dwelling(BLOCK, 2)
    assert [one.id for one in alone.rooms] == ["b"]
    assert [(one.id, one.room_ids) for one in alone.openings] == [("door2", ("b",))]
    assert [is_common(one) for one in BLOCK.rooms] == [False, True, False]
    with pytest.raises(PlanError, match="the plan shows 2"):
        only_dwelling(BLOCK, 3)


@pytest.mark.parametrize(
    ("names", "is_work"),
    [
        (["Office 1", "Open space", "Reception"], True),
        (["Besprechung", "Empfang", "Büro"], True),
        (["Classroom 1", "Classroom 2", "Staff WC"], True),
        # A British flat; a house with an office; one word alone.
        (["Reception Room", "Bedroom 1", "Kitchen"], False),
        (["Office", "Living", "Bath", "Bedroom"], False),
        (["Reception", "WC"], False),
        (["Shop", "Office", "Study"], False),
        ([], False),
    ],
)
def test_offices_are_no_homes(names, is_work):
    assert bool(work_names(names)) == is_work


def test_what_is_no_home_is_refused_with_the_way_out():
    plan = Plan(BLOCK.rooms, BLOCK.openings, {"warnings": [f"{NO_HOME}: rooms are named 'Office'"]})
    with pytest.raises(PlanError, match="no home") as refused:
        refuse_no_home(plan, Path("office.png"))
    assert refused.value.suggestions("command") == ("--anyway",)
    refuse_no_home(BLOCK, Path("home.png"))
