"""A house of storeys: plans on each other, joined by stairs (stacking.py lays them so)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from chord_usd.base.scene.stair_elements import CEILING_TO_FLOOR_M
from chord_usd.base.scene.types import ROOM_HEIGHT_M, Item, Opening, Plan, Room, SceneGraph

if TYPE_CHECKING:
    from chord_usd.base.scene.registration import Registration
    from chord_usd.base.scene.stair_cells import Cell
    from chord_usd.base.scene.stair_forms import BuiltStair

STAIRS = "stairs"
"""Key of Plan.extra."""

STOREY_M = ROOM_HEIGHT_M + CEILING_TO_FLOOR_M
"""From floor to floor."""

_ORDINALS = ("Ground floor", "First floor", "Second floor", "Third floor")


@dataclass(frozen=True, eq=False)
class StoreyPlan:
    """A storey as a file gives it."""

    plan: Plan
    name: str = ""
    shift_m: tuple[float, float] | None = None
    """Where its origin lies in the lowest storey's plan; None where that is to be found out."""


@dataclass(frozen=True, eq=False)
class Storey:
    """One level of a house, in the frame of the whole house; its own floor lies at z = 0."""

    index: int
    """From 0, the lowest."""
    name: str
    plan: Plan
    elevation_m: float
    registration: Registration | None = None
    """How it was laid over the storey below; None for the lowest."""

    @property
    def prefix(self) -> str:
        """Of its ids, so that they are unique in the house."""
        return prefix_of(self.index)


@dataclass(frozen=True, eq=False)
class Climb:
    """A stair between two storeys."""

    storey: int
    """Index of the lower one."""
    built: BuiltStair
    foot: Cell
    top: Cell


@dataclass(frozen=True, eq=False)
class Building:
    """A house of one storey or more."""

    storeys: tuple[Storey, ...]
    climbs: tuple[Climb, ...]
    warnings: tuple[str, ...] = ()


def prefix_of(index: int) -> str:
    """What ids of this storey begin with; nothing on the lowest."""
    return f"storey{index}_" if index else ""


def storey_title(index: int) -> str:
    """What a storey is called where nobody has named it."""
    return _ORDINALS[index] if index < len(_ORDINALS) else f"Storey {index}"


def one_storey(given: StoreyPlan) -> Building:
    """A house of one storey; stairs that it shows lead nowhere. Raises PlanError."""
    name = given.name or storey_title(0)
    storeys = (Storey(0, name, given.plan, 0.0),)
    if STAIRS not in given.plan.extra:
        return Building(storeys, ())
    from chord_usd.base.scene.json_stairs import stairs_of

    up = [stair.id for stair in stairs_of(given.plan, name) if stair.leads == "up"]
    return Building(storeys, (), unused_warnings(up))


def unused_warnings(stairs: Sequence[str]) -> tuple[str, ...]:
    """A warning for stairs, by id, above the highest storey."""
    return (f"above stair {', '.join(stairs)} is no storey: it is left out",) if stairs else ()


def with_own_room_ids(plan: Plan, index: int) -> Plan:
    """The plan with ids of rooms and openings that no other storey has."""
    prefix = prefix_of(index)
    if not prefix:
        return plan

    def opening(one: Opening) -> Opening:
        return replace(one, id=prefix + one.id, room_ids=tuple(prefix + i for i in one.room_ids))

    def room(one: Room) -> Room:
        return replace(one, id=prefix + one.id)

    return replace(
        plan, rooms=tuple(map(room, plan.rooms)), openings=tuple(map(opening, plan.openings))
    )


def with_own_ids(graph: SceneGraph, prefix: str) -> SceneGraph:
    """A furnished storey whose items, too, have ids that are no other storey's."""
    if not prefix:
        return graph

    def item(one: Item) -> Item:
        rests = one.facts.rests_on
        own = one.found(rests_on=prefix + rests) if rests else one
        return replace(own, id=prefix + own.id, children=tuple(map(item, own.children)))

    return replace(
        graph, items=tuple(map(item, graph.items)), dressing=tuple(map(item, graph.dressing))
    )
