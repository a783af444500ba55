"""A house of storeys: plans on each other, joined by stairs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.json_stairs import StoreyPlan, stairs_of
from chord_usd.base.scene.limits import MOST_STOREYS
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.registration import Registration, register
from chord_usd.base.scene.stair_cells import Cell, with_cell
from chord_usd.base.scene.stair_elements import CEILING_TO_FLOOR_M, Stair
from chord_usd.base.scene.stair_forms import BuiltStair, build_stair
from chord_usd.base.scene.stair_landings import LEAST_LANDING_M, landing_depth_m
from chord_usd.base.scene.stair_places import drawn_stairs, grown_stair, seen_on_both
from chord_usd.base.scene.types import ROOM_HEIGHT_M, Item, Opening, Plan, Room, SceneGraph

STOREY_M = ROOM_HEIGHT_M + CEILING_TO_FLOOR_M
"""From floor to floor."""

_SAME_PLACE_M = 0.4
"""Between the middles of a stair as two storeys show it."""

_SLACK_M = 0.005

_ORDINALS = ("Ground floor", "First floor", "Second floor", "Third floor")


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


def stack(given: Sequence[StoreyPlan]) -> Building:
    """The plans as one house, the lowest first. Raises PlanError for what does not fit."""
    if len(given) > MOST_STOREYS:
        raise PlanError(f"the house has {len(given)} storeys", expected=f"at most {MOST_STOREYS}")
    placed, stairs, registered = _placed(given)
    plans, climbs, warnings = list(placed), [], []
    for low in range(len(plans) - 1):
        found = list(_climbs(stairs[low], stairs[low + 1]))
        if not found:
            found, why = _from_drawings(given, registered, low, (plans[low], plans[low + 1]))
            warnings += why
        if not found:
            warnings.append(f"no stair joins {_title(given, low)} and {_title(given, low + 1)}")
        for stair in found:
            try:
                built = build_stair(stair, STOREY_M)
                plans[low], foot = with_cell(plans[low], built, above=False)
                plans[low + 1], top = with_cell(plans[low + 1], built, above=True)
            except PlanError as error:
                raise _at(error, _title(given, low)) from error
            foot, top = _prefixed_cell(foot, low), _prefixed_cell(top, low + 1)
            climbs.append(Climb(low, built, foot, top))
            depth_m = landing_depth_m(plans[low + 1], built)
            if depth_m < LEAST_LANDING_M - _SLACK_M:
                warnings.append(
                    f"the landing above stair {stair.id} on {_title(given, low + 1)} is "
                    f"{depth_m:.2f} m deep, less than {LEAST_LANDING_M:.2f} m"
                )
    unused = [one.id for one in stairs[-1] if one.leads == "up"]
    if unused:
        warnings.append(f"above stair {', '.join(unused)} is no storey: it is left out")
    storeys = tuple(
        Storey(index, _title(given, index), _prefixed(plan, index), index * STOREY_M, found)
        for index, (plan, found) in enumerate(zip(plans, registered, strict=True))
    )
    return Building(storeys, tuple(climbs), tuple(warnings))


def _title(given: Sequence[StoreyPlan], index: int) -> str:
    return given[index].name or storey_title(index)


def _at(error: PlanError, where: str) -> PlanError:
    return PlanError(error.what, where=error.where or where, expected=error.expected)


def _placed(
    given: Sequence[StoreyPlan],
) -> tuple[list[Plan], list[list[Stair]], list[Registration | None]]:
    """Plans and stairs in the frame of the lowest, each registered to the one below."""
    plans, stairs = [given[0].plan], [list(stairs_of(given[0].plan, _title(given, 0)))]
    registered: list[Registration | None] = [None]
    for index, own in enumerate(given[1:], start=1):
        title = _title(given, index)
        shown = stairs_of(own.plan, title)
        pairs = [
            (up, down)
            for up in stairs[-1] if up.leads == "up"
            for down in shown if down.leads == "down"
        ]  # fmt: skip
        found = register(plans[-1], own.plan, pairs, own.shift_m, title)
        pose = Pose(offset_m=found.shift_m)
        registered.append(found)
        plans.append(posed(own.plan, pose))
        stairs.append([replace(one, box=pose.box(one.box)) for one in shown])
    return plans, stairs, registered


def _climbs(below: Sequence[Stair], above: Sequence[Stair]) -> list[Stair]:
    """The stairs up from a storey. What both storeys show must be at one place."""
    downs = [one for one in above if one.leads == "down"]
    found = []
    for up in (one for one in below if one.leads == "up"):
        near = [one for one in downs if _apart_m(up, one) <= _SAME_PLACE_M]
        if downs and not near:
            raise PlanError(
                f"stair {up.id} leads nowhere: the storey above shows stairs "
                f"{min(_apart_m(up, one) for one in downs):.1f} m away",
                expected="the same stair on both storeys",
            )
        found.append(up)
    return found


def _apart_m(one: Stair, other: Stair) -> float:
    (x, y, _), (u, v, _) = one.box.center_m, other.box.center_m
    return float(((x - u) ** 2 + (y - v) ** 2) ** 0.5)


def _from_drawings(
    given: Sequence[StoreyPlan],
    registered: Sequence[Registration | None],
    low: int,
    plans: tuple[Plan, Plan],
) -> tuple[list[Stair], list[str]]:
    """The first stair to rule where the pictures of two storeys show one, and what is in its way
    where there is none."""
    shown = []
    for index in (low, low + 1):
        found = registered[index]
        shown.append(drawn_stairs(given[index].plan, found.shift_m if found else (0.0, 0.0)))
    areas = sorted(seen_on_both(*shown), key=lambda area: -area.area)
    for number, area in enumerate(areas, start=1):
        stair = grown_stair(area, f"stair{number}", *plans, STOREY_M)
        if stair is not None:
            return [stair], []
    return [], [
        f"the stair drawn on {_title(given, low)} ({_sides(area)} m) leaves no room for one to rule"
        for area in areas[:1]
    ]


def _sides(area: Polygon) -> str:
    corners = np.asarray(area.minimum_rotated_rectangle.exterior.coords)[:3]
    short, long = sorted(np.hypot(*np.diff(corners, axis=0).T).tolist())
    return f"{short:.1f} by {long:.1f}"


def _prefixed_cell(cell: Cell, index: int) -> Cell:
    prefix = prefix_of(index)
    return replace(cell, room=prefix + cell.room, joined=prefix + cell.joined)


def _prefixed(plan: Plan, index: int) -> Plan:
    """The plan with ids that are no other storey's."""
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
