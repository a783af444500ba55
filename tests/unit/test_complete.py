"""Complete and right rooms: what is missing and what stands wrongly, named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.metrics import score_scene
from chord_usd.base.metrics.complete import ESSENTIALS, TWO_CHAIRS, homely_rooms, lacking
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.types import Box, Item, Room, RoomKind, SceneGraph, frozen_array
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan


def room(kind: RoomKind, length: float, width: float) -> Room:
    return Room("r", kind, frozen_array([(0, 0), (length, 0), (length, width), (0, width)]))


def piece(category: str, x: float, y: float, size=(0.6, 0.6, 0.8), yaw: float = 0.0) -> Item:
    return Item(f"{category} {x} {y}", category, Box((x, y, 0.0), size, yaw), "r")


def judged(kind: RoomKind, *pieces: Item, sides: tuple[float, float] = (4.0, 3.0)):
    return homely_rooms(SceneGraph((room(kind, *sides),), (), pieces))[0]


SINK, COOKER = piece("sink_cabinet", 1, 2.7), piece("cooker_cabinet", 1.6, 2.7)
TABLE = piece("dining_table", 2, 1.5, (1.2, 0.8, 0.75))
CHAIRS = piece("chair", 2, 2.1), piece("chair", 2, 0.9, yaw=180.0)
SOFA, LOW_TABLE = piece("sofa", 2, 2.6, (2, 0.8, 0.8)), piece("coffee_table", 2, 1.4)
TELEVISION = piece("tv_cabinet", 2, 0.2, (1.6, 0.4, 0.5), 180.0)

CORNER_UNIT = piece("double_door_floor_cabinet", 0.3, 2.0, (0.8, 0.6, 0.8), 90.0)
WIDE_SINK = piece("sink_cabinet", 0.8, 2.7, (1.6, 0.6, 0.8))

IN_A_CORNER = (
    piece("toilet", 1, 2.7), piece("washbasin", 3.7, 2.7), piece("shower", 2, 2.7),
)  # fmt: skip

FURNISHED = {
    "bedroom": (piece("bed", 2, 2.0, (1.6, 2.0, 1.0)),),
    "living": (SOFA, LOW_TABLE, TELEVISION),
    "dining": (TABLE, *CHAIRS),
    "kitchen": (SINK, COOKER),
    "bathroom": (piece("toilet", 1, 2.7), piece("washbasin", 2, 2.7), piece("shower", 3, 2.7)),
    "washroom": (piece("washing_machine", 1, 2.7), piece("washbasin", 2, 2.7)),
    "wc": (piece("toilet", 1, 2.7), piece("washbasin", 2, 2.7)),
}


@pytest.mark.parametrize("kind", ESSENTIALS)
def test_a_room_with_all_it_needs_is_right_and_without_any_piece_it_is_not(kind: RoomKind) -> None:
    assert judged(kind, *FURNISHED[kind]).right
    assert not judged(kind).complete


@pytest.mark.parametrize(
    ("area_m2", "standing", "missing"),
    [
        (6.0, (), ("toilet", "washbasin", "shower or bathtub")),
        (6.0, ("toilet", "bathtub"), ("washbasin",)),
        (2.9, ("toilet", "shower"), ()),
        (2.9, ("shower",), ("toilet",)),
        (1.9, ("washing_set",), ()),
        (1.9, (), ("toilet",)),
    ],
)
def test_small_bathrooms_need_less(area_m2: float, standing, missing) -> None:
    assert lacking("bathroom", area_m2, standing) == missing


@pytest.mark.parametrize(
    ("kind", "pieces", "missing"),
    [
        ("kitchen", (SINK,), ("cooker",)),
        ("living", (SOFA,), ("coffee table or television",)),
        ("dining", (TABLE, CHAIRS[0]), (TWO_CHAIRS,)),
        ("dining", (), ("dining table",)),
        ("corridor", (), ()),
    ],
)
def test_what_is_missing_is_named(kind: RoomKind, pieces, missing) -> None:
    assert judged(kind, *pieces).missing == missing


def at(item: Item, x: float, y: float, yaw: float) -> Item:
    return replace(item, box=Box((x, y, 0.0), item.box.size_m, yaw))


@pytest.mark.parametrize(
    ("kind", "pieces", "fault"),
    [
        ("kitchen", (at(SINK, 1, 2.5, 0), COOKER), "off its wall"),
        ("kitchen", (at(SINK, 1, 2.7, 20), COOKER), "off its wall"),
        ("kitchen", (at(SINK, 2.6, 2.7, 90), COOKER), "off its wall"),
        ("kitchen", (SINK, at(COOKER, 2.0, 2.7, 0)), "apart from its run"),
        (
            "kitchen",
            (SINK, at(COOKER, 2.0, 2.7, 0), piece("washing_machine", 1.5, 2.7)),
            None,
        ),
        ("kitchen", (SINK, at(COOKER, 2.3, 2.7, 0)), None),  # as wide as a dishwasher
        ("kitchen", (SINK, at(COOKER, 1.9, 0.3, 180)), None),
        ("dining", (TABLE, *CHAIRS, piece("chair", 0.4, 0.4)), "without a table"),
        ("dining", (TABLE, *CHAIRS, piece("chair", 1.1, 1.5, yaw=180)), "turned from its table"),
        ("living", (SOFA, piece("single_sofa", 1, 1), TELEVISION), None),
        ("living", (at(SOFA, 2, 1.9, 180), LOW_TABLE), "turned away"),
        (
            "living",
            (at(SOFA, 1, 2.6, 0), at(LOW_TABLE, 1, 1.4, 0), at(TELEVISION, 3.2, 2.8, 0)),
            "facing no seat",
        ),
        ("bedroom", (piece("bed", 3.4, 2, (1, 2, 1)), SOFA), "facing nothing"),
        # a blind corner, half of one, a basin behind a machine, a seat against a sofa's side
        ("kitchen", (at(SINK, 0.3, 2.7, 0), CORNER_UNIT, COOKER), "out of reach"),
        ("kitchen", (WIDE_SINK, CORNER_UNIT, at(COOKER, 1.9, 2.7, 0)), None),
        ("bathroom", (*IN_A_CORNER, piece("washing_machine", 3.7, 2.1, yaw=-90.0)), "out of reach"),
        ("bathroom", (*IN_A_CORNER, piece("washing_machine", 3.7, 1.0, yaw=-90.0)), None),
        (
            "living",
            (SOFA, LOW_TABLE, piece("single_sofa", 0.6, 2.4, (0.8,) * 3, 90)),
            "out of reach",
        ),
        ("living", (SOFA, LOW_TABLE, piece("single_sofa", 0.5, 1.3, (0.8,) * 3, 90)), None),
    ],
)
def test_what_stands_wrongly_is_named(kind: RoomKind, pieces, fault: str | None) -> None:
    found = judged(kind, *pieces)
    assert found.complete
    assert [one.fault for one in found.misplaced] == ([fault] if fault else [])


def test_a_washing_machine_may_stand_behind_the_short_step_of_a_wall() -> None:
    """Steps shorter than a pilaster are no wall to stand at."""
    corners = frozen_array([(0, 0), (4, 0), (4, 3), (2, 3), (2, 2.9), (0, 2.9)])
    machine = piece("washing_machine", 1, 2.6)
    graph = SceneGraph((Room("r", "bathroom", corners),), (), (machine,))
    assert not homely_rooms(graph)[0].misplaced
    aside = at(machine, 1.7, 2.95, -90.0)  # its back at the step only
    graph = replace(graph, items=(aside,))
    assert "off its wall" in [one.fault for one in homely_rooms(graph)[0].misplaced]


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.floats(-180, 180), st.booleans())
def test_homes_are_judged_alike_from_every_side(seed: int, yaw_deg: float, mirrored: bool) -> None:
    rng = np.random.default_rng(seed)
    graph = furnish(random_plan(rng), rng)
    other = posed(graph, Pose(mirrored, yaw_deg=yaw_deg, offset_m=(3.0, -2.0)))
    assert homely_rooms(other) == homely_rooms(graph)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000), st.data())
def test_taking_a_piece_away_completes_no_room(seed: int, data) -> None:
    rng = np.random.default_rng(seed)
    graph = furnish(random_plan(rng, rooms=6), rng)
    gone = data.draw(st.sampled_from(graph.items))
    before = {found.room: found for found in score_scene(graph).homely}
    for after in score_scene(graph.without([gone.id])).homely:
        assert bool(after.missing) >= bool(before[after.room].missing)
        assert before[after.room].complete or not after.complete
