"""A house of storeys: plans on each other, joined by stairs (stacking.py lays them so)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from shapely.geometry import LineString, Polygon

from chord_usd.base.scene.types import ROOM_HEIGHT_M, Box, Item, Opening, Plan, Room, SceneGraph

if TYPE_CHECKING:
    from chord_usd.base.scene.registration import Registration
    from chord_usd.base.scene.stair_cells import Cell
    from chord_usd.base.scene.stair_forms import BuiltStair

# What stairs are made of, and the rules that they keep. Numpy and shapely only -------------------

# A stair is an oriented box seen from above, its front (-y) where it begins. Rules: every rise 16
# to 20 cm, all alike; going 24 to 30 cm; flights 80 cm wide or more; 2 m of headroom.

StairForm = Literal["straight", "L", "U", "winder_L", "winder_U", "spiral"]
"""L and U turn on a landing; a quarter-turn and a half-turn winder stair turn on tapered treads; a
spiral stair winds round a pole."""

IFC_FORMS: dict[StairForm, str] = {
    "straight": "STRAIGHT_RUN_STAIR", "L": "QUARTER_TURN_STAIR", "U": "HALF_TURN_STAIR",
    "winder_L": "QUARTER_WINDING_STAIR", "winder_U": "HALF_WINDING_STAIR", "spiral": "SPIRAL_STAIR",
}  # fmt: skip
"""IFC's words for them."""

Turn = Literal["left", "right"]
Leads = Literal["up", "down"]

HEADROOM_M = 2.0


@dataclass(frozen=True)
class StairRule:
    """What a stair keeps, metres."""

    rise_m: tuple[float, float]
    going_m: tuple[float, float]
    width_m: float
    """Of a flight, from side to side, at least."""


TO_RULE = StairRule((0.16, 0.20), (0.24, 0.30), 0.8)
STEEP = StairRule((0.16, 0.22), (0.22, 0.30), 0.65)
"""What a steep stair of an old house keeps: the steepest that British rules know (Approved Document
K), and narrower."""
RISE_M, GOING_M, LEAST_WIDTH_M = TO_RULE.rise_m, TO_RULE.going_m, TO_RULE.width_m

WELL_M = 0.1
"""Between the two flights of a U."""

CEILING_TO_FLOOR_M = 0.3
"""Thickness of what lies between two storeys."""


@dataclass(frozen=True)
class Stair:
    """A stair on the plan of a storey."""

    id: str
    form: StairForm
    box: Box
    """What it takes up; the front faces where one steps on below. Its height is not looked at."""
    turn: Turn = "right"
    """Which way one turns going up, where one turns."""
    leads: Leads = "up"
    """To the storey above, or to the one below."""
    rule: StairRule = TO_RULE


@dataclass(frozen=True, eq=False)
class Tread:
    """What one steps on: a step or a landing."""

    area_m: Polygon
    """In the stair's own frame, seen from above."""
    top_m: float
    """Over the lower floor."""
    is_landing: bool = False
    edges_m: tuple[LineString, LineString] | None = None
    """Of a tapered tread: over which one steps on it and off it, from newel or pole outwards."""


@dataclass(frozen=True)
class Flight:
    """A straight run of steps, in the stair's own frame."""

    start_m: tuple[float, float]
    """Middle of the edge of its first step."""
    ahead: tuple[int, int]
    """Direction in which it rises: (0, 1), (0, -1), (1, 0) or (-1, 0)."""
    length_m: float
    width_m: float
    low_m: float
    high_m: float
    """Heights of the floors or landings that it joins."""

    @property
    def end_m(self) -> tuple[float, float]:
        """Middle of the edge where it meets what it leads to."""
        (x, y), (ux, uy) = self.start_m, self.ahead
        return x + ux * self.length_m, y + uy * self.length_m


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
    """A house of one storey; stairs that it shows lead nowhere, and stairs of a drawing stay empty.
    Raises PlanError."""
    from chord_usd.base.scene.stair_cells import with_wells
    from chord_usd.base.scene.stair_places import drawn_stairs

    name = given.name or storey_title(0)
    storeys = (Storey(0, name, with_wells(given.plan, drawn_stairs(given.plan)), 0.0),)
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

    def opening(old: Opening) -> Opening:
        return replace(old, id=prefix + old.id, room_ids=tuple(prefix + i for i in old.room_ids))

    def room(old: Room) -> Room:
        return replace(old, id=prefix + old.id)

    return replace(
        plan, rooms=tuple(map(room, plan.rooms)), openings=tuple(map(opening, plan.openings))
    )


def with_own_ids(graph: SceneGraph, prefix: str) -> SceneGraph:
    """A furnished storey whose items, too, have ids that are no other storey's."""
    if not prefix:
        return graph

    def item(old: Item) -> Item:
        rests = old.facts.rests_on
        moved = old.with_facts(rests_on=prefix + rests) if rests else old
        return replace(moved, id=prefix + moved.id, children=tuple(map(item, moved.children)))

    return replace(
        graph, items=tuple(map(item, graph.items)), dressing=tuple(map(item, graph.dressing))
    )
