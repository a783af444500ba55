"""Whether a reading is probably right: one verdict from all that is unsure of it, and the places of
its doubts.

Weights and bounds are set on 58 readings of real plans that were judged by eye (docs/plans.md).
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass, replace
from typing import Any, Literal

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import hanging_together, room_polygon, seams
from chord_usd.base.scene.types import OPEN, Opening, Plan, Room
from chord_usd.line.plan.openings import CONFIDENCE, is_guessed
from chord_usd.line.plan.placement import CHECK_SCALE, WARNINGS

Verdict = Literal["right", "look", "wrong"]
VERDICT = "verdict"
"""Key of Plan.extra and of --json."""
JOINED = "joinedFloors"
"""Key of Plan.extra: how many floors became parts of others, since no wall parts them."""

SAID: dict[str, str] = {
    "right": "probably right", "look": "look at the overlay", "wrong": "probably wrong",
}  # fmt: skip

OF_SEVERAL = "what is printed there is of several rooms"
NO_ROOM = "no room was found where"
CUT_OFF = "the drawing seems to be cut off"
OPEN_OUT = "open to the outside"
UNSURE_RIMS = "the outlines of"
UNSURE_WHAT = "it is uncertain what"
NO_DOOR = "no door leads from the other rooms to"
"""Parts of doubts by which a verdict, and the places of doubts, know them."""
COUNTED = "(red on the overlay)"
"""Part of a doubt that counts rooms or openings, which are too many to name."""

_UNCERTAIN = 0.5
_UNCERTAIN_ROOM = 0.6
"""Least chance of an opening, and of a room's floor and rim, that goes without a word."""

_TOUCH_M = 0.01
"""Rooms so near have no wall between: one walks from one to the other."""

_LOOK, _WRONG = 0.35, 2.3
"""Sums of symptoms, each with its weight, from which on a reading is doubtful, and wrong."""
_NOTHING, _MANY = 4.1, 20
"""Sum of symptoms from which on nothing is sure, and so many openings of which none is."""
_MOST_UNKNOWN = 0.34
"""Share of rooms without a kind in a reading that is right."""
_WORD = re.compile(r"\w+")
_NOT_DOUBTFUL = (
    UNSURE_WHAT, "the sheet shows", "the plan shows", "the file has", "the file holds",
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
    warnings = _warnings_in(plan)
    rooms = max(len(plan.rooms), 1)
    seen = [opening for opening in plan.openings if not is_guessed(opening)]
    vague = (sum(map(is_vague, seen)) + joined) / max(len(seen) + joined, 1)
    apart = sum(map(len, reached_together(plan)[1:])) / rooms
    return Symptoms(
        vague,
        (sum(map(is_shaky, plan.rooms)) + joined) / (rooms + joined),
        apart,
        any(CHECK_SCALE in line for line in warnings),
        any(OF_SEVERAL in line for line in warnings),
        any(NO_ROOM in line for line in warnings),
        any(CUT_OFF in line for line in warnings),
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
    is_doubted = any(
        not line.startswith(_NOT_DOUBTFUL) and not any(part in line for part in _SURE_PARTS)
        for line in _warnings_in(plan)
    )
    is_partly = symptoms.apart > 0 or symptoms.unknown > _MOST_UNKNOWN
    return "look" if symptoms.total >= _LOOK or is_partly or is_doubted else "right"


def doubts_placed(plan: Plan) -> list[dict[str, Any]]:
    """The plan's warnings, each with the ids of the rooms and openings that it is about, and where
    these lie, metres."""
    at: dict[str, Sequence[float]] = {o.id: o.box.center_m[:2] for o in plan.openings}
    for room in plan.rooms:
        inside = room_polygon(room).representative_point()
        at[room.id] = (inside.x, inside.y)
    about = [(text, doubted_by(plan, text)) for text in _warnings_in(plan)]
    return [
        {"text": text, "ids": ids, "at": [_rounded(at[doubted]) for doubted in ids]}
        for text, ids in about
    ]


def doubted_by(plan: Plan, text: str) -> list[str]:
    """Ids of the rooms and openings that a doubt is about, whether it names or counts them."""
    known = {*(room.id for room in plan.rooms), *(opening.id for opening in plan.openings)}
    named = [word for word in _WORD.findall(text) if word in known]
    if COUNTED not in text:
        return named
    for part, meant in _MEANT.items():
        if part in text:
            return meant(plan)
    return named


def _rounded(spot: Sequence[float]) -> list[float]:
    return [round(float(value), 3) for value in spot]


def _warnings_in(plan: Plan) -> list[str]:
    return [str(line) for line in plan.extra.get(WARNINGS, ())]


def is_shaky(room: Room) -> bool:
    """Whether a room's floor or rim is unsure."""
    return bool(room.extra.get(CONFIDENCE, 1.0) < _UNCERTAIN_ROOM)


def is_vague(opening: Opening) -> bool:
    """Whether it is unsure what an opening is that was seen."""
    return not is_guessed(opening) and bool(opening.extra.get(CONFIDENCE, 1.0) < _UNCERTAIN)


def reached_together(plan: Plan) -> list[list[str]]:
    """Ids of rooms that doors and passages join which were seen, or that touch, the largest group
    first."""
    ids = [room.id for room in plan.rooms]
    index_of = {room_id: index for index, room_id in enumerate(ids)}
    touching = seams([room_polygon(room) for room in plan.rooms], _TOUCH_M)
    pairs = [(first, other) for first, other, _ in touching]
    for opening in plan.openings:
        is_way = opening.kind != "window" and not is_guessed(opening)
        if is_way and len(opening.room_ids) == 2:
            first, other = (index_of[room_id] for room_id in opening.room_ids)
            pairs.append((first, other))
    groups = [[ids[index] for index in group] for group in hanging_together(len(ids), pairs)]
    return sorted(groups, key=lambda group: (-len(group), group))


_MEANT: dict[str, Callable[[Plan], list[str]]] = {
    OPEN_OUT: lambda plan: [room.id for room in plan.rooms if OPEN in room.extra],
    UNSURE_RIMS: lambda plan: [room.id for room in plan.rooms if is_shaky(room)],
    UNSURE_WHAT: lambda plan: [opening.id for opening in plan.openings if is_vague(opening)],
    NO_DOOR: lambda plan: [room_id for group in reached_together(plan)[1:] for room_id in group],
}
"""Which rooms and openings doubts count, by a part of their words."""
