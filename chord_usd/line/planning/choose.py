"""Which of several planned floors to take: the one that is sound and closest to the wish."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from chord_usd.base.scene.types import Plan, RoomKind
from chord_usd.base.scene.wish import Wish, floor_area_m2, has_open_kitchen, room_counts
from chord_usd.line.planning.faults import faults

AREA_TOLERANCE = 0.1
"""The floor area is met when it is this close, as a share of what was asked for."""

_FAULT_COST = 4.0
_ROOM_COST = 2.0
_KITCHEN_COST = 0.5


@dataclass(frozen=True, eq=False)
class Candidate:
    """A planned floor and what speaks against it."""

    plan: Plan
    faults: tuple[str, ...]
    """As faults.faults; none for a sound plan."""
    missed: dict[RoomKind, tuple[int, int]]
    """Kinds of room whose number is not the one asked for: asked for, planned."""
    area_m2: float
    area_missed: bool
    cost: float
    """The lower the better; 0 for all that was asked for."""
    off_programme: int
    """Rooms too many and too few for the programme that it was planned to."""

    @property
    def holds(self) -> bool:
        """Whether the plan is sound and all that was asked for."""
        return not (self.faults or self.missed or self.area_missed)


def judged(plan: Plan, wish: Wish, programme: Wish | None = None) -> Candidate:
    """A plan measured by a wish, and by what was made of it before planning; None: nothing was."""
    misses = faults(plan)
    counts = room_counts(plan)
    missed = _missed(counts, wish)
    area_m2 = floor_area_m2(plan) if plan.rooms else 0.0
    off = abs(area_m2 / wish.area_m2 - 1.0) if wish.area_m2 else 0.0
    cost = _FAULT_COST * len(misses) + off / AREA_TOLERANCE * (off > AREA_TOLERANCE / 2)
    cost += _ROOM_COST * _rooms_off(missed)
    if wish.open_kitchen and not has_open_kitchen(plan):
        cost += _KITCHEN_COST
    off_programme = _rooms_off(_missed(counts, programme or wish))
    return Candidate(
        plan, tuple(misses), missed, area_m2, off > AREA_TOLERANCE, cost, off_programme
    )


def best(candidates: Sequence[Candidate]) -> Candidate:
    """The cheapest, of equals that closest to its programme; the first of such."""
    return min(candidates, key=lambda candidate: (candidate.cost, candidate.off_programme))


def _missed(counts: Mapping[RoomKind, int], wish: Wish) -> dict[RoomKind, tuple[int, int]]:
    return {
        kind: (asked, counts[kind]) for kind, asked in wish.counts.items() if counts[kind] != asked
    }


def _rooms_off(missed: Mapping[RoomKind, tuple[int, int]]) -> int:
    return sum(abs(asked - planned) for asked, planned in missed.values())
