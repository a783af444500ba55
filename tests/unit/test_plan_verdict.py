"""Verdicts on readings: right only where nothing speaks against it, worse with each symptom."""

from dataclasses import replace

import pytest

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.types import Box, Opening, Plan, Room, frozen_array
from chord_usd.line.plan.openings import CONFIDENCE
from chord_usd.line.plan.placement import CHECK_SCALE, WARNINGS
from chord_usd.line.plan.verdict import (
    CUT_OFF,
    NO_ROOM,
    OF_SEVERAL,
    doubts_placed,
    refuse_unsure,
    symptoms_of,
    verdict_of,
)


def room(name, kind, west, confidence=0.9):
    corners = [(west, 0.0), (west + 3.0, 0.0), (west + 3.0, 3.0), (west, 3.0)]
    return Room(name, kind, frozen_array(corners), extra={CONFIDENCE: confidence})


def door(number, confidence=0.9):
    x = 3.24 * number + 3.12
    rooms = (f"room{number}", f"room{number + 1}")
    box = Box((x, 1.5, 0.0), (0.8, 0.24, 2.1), 90.0)
    return Opening(f"door{number}", "door", box, rooms, extra={CONFIDENCE: confidence})


KINDS = ["living", "kitchen", "bedroom", "bathroom", "corridor", "bedroom"]
SURE = Plan(
    tuple(room(f"room{i}", kind, 3.24 * i) for i, kind in enumerate(KINDS)),
    tuple(door(i) for i in range(len(KINDS) - 1)),
)


def told(*warnings):
    return replace(SURE, extra={WARNINGS: list(warnings)})


def test_a_sure_reading_is_right_and_a_torn_one_wrong():
    assert verdict_of(SURE) == "right"
    torn = Plan(
        tuple(replace(one, kind="unknown", extra={CONFIDENCE: 0.3}) for one in SURE.rooms),
        tuple(replace(one, extra={CONFIDENCE: 0.2}) for one in SURE.openings),
    )
    assert verdict_of(torn) == "wrong"


@pytest.mark.parametrize(
    "warning",
    [
        f"room1: {OF_SEVERAL}; an opening may be missing",
        f"{NO_ROOM} 'TERRACE' is printed",
        f"{CUT_OFF} at its left edge",
        f"doors say 2 times that: {CHECK_SCALE}",
        "no kitchen was recognised: a part of living1 became kitchen1",
        "no way leads into room2: a door may be missing",
    ],
)
def test_no_reading_with_a_doubt_is_right(warning):
    assert verdict_of(told(warning)) == "look"


def test_what_was_read_is_no_doubt():
    sure = told("the sheet shows 2 plans; the largest was taken", "kitchen1 is the part of living1"
                " where a kitchen is drawn")  # fmt: skip
    assert verdict_of(sure) == "right"


def test_rooms_that_no_door_joins_are_a_symptom():
    shut = replace(SURE, openings=SURE.openings[:-1])
    assert symptoms_of(shut).apart == pytest.approx(1 / 6)
    assert verdict_of(shut) == "look"


def test_more_symptoms_are_never_better():
    totals = [
        symptoms_of(
            replace(SURE, openings=tuple(door(i, 0.2 if i < bad else 0.9) for i in range(5)))
        )
        for bad in range(6)
    ]
    sums = [one.total for one in totals]
    assert sums == sorted(sums)
    assert sums[0] < sums[-1]


def test_doubts_say_where_their_rooms_lie():
    plan = told("room0, door1: something is unsure", "the page has two columns")
    first, second = doubts_placed(plan)
    assert first["at"][0] == pytest.approx([1.5, 1.5], abs=1.5)
    assert first["at"][1] == [6.36, 1.5]
    assert first["ids"] == ["room0", "door1"]
    assert second["at"] == []


def test_doubts_that_count_openings_say_where_they_lie():
    """The overlay called them red, and drew them as sure."""
    plan = told("it is uncertain what 7 openings (red on the overlay) are")
    vague = replace(plan, openings=tuple(door(i, 0.2) for i in range(5)))
    assert doubts_placed(vague)[0]["ids"] == [one.id for one in vague.openings]


def unsure(rooms, openings):
    return Plan(
        tuple(replace(one, kind="unknown", extra={CONFIDENCE: rooms}) for one in SURE.rooms * 5),
        tuple(replace(one, extra={CONFIDENCE: openings}) for one in SURE.openings * 5),
    )


def test_what_shows_nothing_sure_is_refused_with_counts():
    """A circuit diagram became a home of eight kitchens; so did views in perspective."""
    with pytest.raises(PlanError, match="25 of 25 openings and 0 of 30 outlines"):
        refuse_unsure(unsure(0.9, 0.2))
    refuse_unsure(unsure(0.4, 0.6))
    refuse_unsure(SURE)
