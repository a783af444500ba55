"""Whether a reading is probably right: one verdict from all that is unsure of it, and the places of
its doubts.

Weights and bounds are set on 58 readings of real plans that were judged by eye (docs/plans.md).
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import astuple, dataclass, replace
from typing import Any, Literal

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Plan
from chord_usd.line.plan.doubts import (
    CUT_OFF,
    NO_ROOM,
    OF_SEVERAL,
    is_shaky,
    is_vague,
    reached_together,
)
from chord_usd.line.plan.placement import WARNINGS
from chord_usd.line.plan.scale_choice import CHECK_SCALE

Verdict = Literal["right", "look", "wrong"]
VERDICT = "verdict"
"""Key of Plan.extra and of --json."""
JOINED = "joinedFloors"
"""Key of Plan.extra: how many floors became parts of others, since no wall parts them."""

SAID: dict[str, str] = {
    "right": "probably right", "look": "look at the overlay", "wrong": "probably wrong",
}  # fmt: skip

_LOOK, _WRONG = 0.35, 2.3
"""Sums of symptoms, each with its weight, from which on a reading is doubtful, and wrong."""
_NOTHING, _MANY = 4.1, 20
"""Sum of symptoms from which on nothing is sure, and so many openings of which none is."""
_MOST_UNKNOWN = 0.34
"""Share of rooms without a kind in a reading that is right."""
_WORD = re.compile(r"\w+")
_NOT_DOUBTFUL = (
    "it is uncertain what", "the sheet shows", "the plan shows", "the file has", "the file holds",
)  # fmt: skip
"""Begin warnings that the sums count, or that say what was read..."""
_SURE_PARTS = ("is drawn", "is named a")
"""...as do these of parts of floors."""


@dataclass(frozen=True)
class Symptoms:
    """What is unsure of a reading, each from 0 to 1."""

    vague: float
    """Share of openings that are unsure."""
    shaky: float
    """Share of rooms with unsure outlines."""
    apart: float
    """Share of rooms that no door joins to the others."""
    scale: bool
    """Whether a warning says to check the scale."""
    crowded: bool
    """Whether names of several rooms stand in one."""
    homeless: bool
    """Whether a name stands in no room."""
    cut: bool
    """Whether the drawing is cut off."""
    unknown: float
    """Share of rooms without a kind."""

    @property
    def total(self) -> float:
        """Their weighted sum."""
        return sum(w * float(s) for w, s in zip(_WEIGHTS, astuple(self), strict=True))


_WEIGHTS = (2.2, 2.0, 1.2, 0.5, 0.5, 0.3, 0.3, 0.6)
"""In the order of the fields of Symptoms."""


def symptoms_of(plan: Plan, joined: int = 0) -> Symptoms:
    """What is unsure of a plan that was read, with its warnings. joined: floors that became parts
    of others, each with an unsure outline and opening."""
    told = _told(plan)
    rooms = max(len(plan.rooms), 1)
    openings = max(len(plan.openings) + joined, 1)
    vague = (sum(map(is_vague, plan.openings)) + joined) / openings
    apart = sum(map(len, reached_together(plan)[1:])) / rooms
    return Symptoms(
        vague,
        (sum(map(is_shaky, plan.rooms)) + joined) / (rooms + joined),
        apart,
        any(CHECK_SCALE in one for one in told),
        any(OF_SEVERAL in one for one in told),
        any(NO_ROOM in one for one in told),
        any(CUT_OFF in one for one in told),
        sum(room.kind == "unknown" for room in plan.rooms) / rooms,
    )


def refuse_unsure(plan: Plan) -> None:
    """Raises PlanError for a reading of which hardly anything is sure: diagrams, views in
    perspective, several drawings in one."""
    vague, count = sum(map(is_vague, plan.openings)), len(plan.openings)
    joined = int(plan.extra.get(JOINED, 0))
    if symptoms_of(plan, joined).total >= _NOTHING or (count >= _MANY and vague == count):
        shaky = sum(map(is_shaky, plan.rooms))
        raise PlanError(
            f"hardly anything on it is sure: {vague} of {count} openings and {shaky} of"
            f" {len(plan.rooms)} outlines are not",
            expected="the plan of one floor, seen straight from above",
            try_="a clearer picture, cut to one floor",
        )


def judged(plan: Plan) -> Plan:
    """The plan with its verdict."""
    return replace(plan, extra={**plan.extra, VERDICT: verdict_of(plan)})


def verdict_of(plan: Plan) -> Verdict:
    """Whether a reading is probably right, from its symptoms and warnings."""
    symptoms = symptoms_of(plan)
    if symptoms.total >= _WRONG:
        return "wrong"
    is_told = any(
        not one.startswith(_NOT_DOUBTFUL) and not any(part in one for part in _SURE_PARTS)
        for one in _told(plan)
    )
    is_partly = symptoms.apart > 0 or symptoms.unknown > _MOST_UNKNOWN
    return "look" if symptoms.total >= _LOOK or is_partly or is_told else "right"


def doubts_placed(plan: Plan) -> list[dict[str, Any]]:
    """The plan's warnings, each with where the rooms and openings lie that it names, metres."""
    at: dict[str, Sequence[float]] = {o.id: o.box.center_m[:2] for o in plan.openings}
    for room in plan.rooms:
        inside = room_polygon(room).representative_point()
        at[room.id] = (inside.x, inside.y)
    return [{"text": text, "at": [_rounded(at[word]) for word in _WORD.findall(text) if word in at]}
            for text in _told(plan)]  # fmt: skip


def _rounded(spot: Sequence[float]) -> list[float]:
    return [round(float(value), 3) for value in spot]


def _told(plan: Plan) -> list[str]:
    return [str(one) for one in plan.extra.get(WARNINGS, ())]
