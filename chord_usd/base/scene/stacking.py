"""Plans laid over each other as the storeys of one house, and joined by stairs."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.json_stairs import stairs_of
from chord_usd.base.scene.limits import MOST_STOREYS
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.registration import Registration, register
from chord_usd.base.scene.stair_cells import Cell, with_cell
from chord_usd.base.scene.stair_forms import build_stair
from chord_usd.base.scene.stair_landings import LEAST_LANDING_M, landing_depth_m
from chord_usd.base.scene.stair_places import drawn_stairs, grown_stair, seen_on_both
from chord_usd.base.scene.storeys import (
    STEEP,
    STOREY_M,
    Building,
    Climb,
    Stair,
    Storey,
    StoreyPlan,
    prefix_of,
    storey_title,
    unused_warnings,
    with_own_room_ids,
)
from chord_usd.base.scene.types import Plan

_SAME_PLACE_M = 0.4
"""Between the middles of a stair as two storeys show it."""

_SLACK_M = 0.005


def stack(given: Sequence[StoreyPlan]) -> Building:
    """The plans as one house, the lowest first. Raises PlanError for what does not fit."""
    if len(given) > MOST_STOREYS:
        raise PlanError(f"the house has {len(given)} storeys", expected=f"at most {MOST_STOREYS}")
    placed, stairs, registered = _placed(given)
    plans, climbs, warnings = list(placed), [], []
    for low in range(len(plans) - 1):
        stairs_up = list(_climbs(stairs[low], stairs[low + 1]))
        if not stairs_up:
            stairs_up, why = _from_drawings(given, registered, low, (plans[low], plans[low + 1]))
            warnings += why
        if not stairs_up:
            warnings.append(f"no stair joins {_title(given, low)} and {_title(given, low + 1)}")
        for stair in stairs_up:
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
    warnings += unused_warnings([stair.id for stair in stairs[-1] if stair.leads == "up"])
    storeys = tuple(
        Storey(index, _title(given, index), with_own_room_ids(plan, index), index * STOREY_M, fit)
        for index, (plan, fit) in enumerate(zip(plans, registered, strict=True))
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
    for index, storey in enumerate(given[1:], start=1):
        title = _title(given, index)
        shown = stairs_of(storey.plan, title)
        pairs = [
            (up, down)
            for up in stairs[-1] if up.leads == "up"
            for down in shown if down.leads == "down"
        ]  # fmt: skip
        fit = register(plans[-1], storey.plan, pairs, storey.shift_m, title)
        pose = Pose(offset_m=fit.shift_m)
        registered.append(fit)
        plans.append(posed(storey.plan, pose))
        stairs.append([replace(stair, box=pose.box(stair.box)) for stair in shown])
    return plans, stairs, registered


def _climbs(below: Sequence[Stair], above: Sequence[Stair]) -> list[Stair]:
    """The stairs up from a storey. What both storeys show must be at one place."""
    downs = [stair for stair in above if stair.leads == "down"]
    ups = []
    for up in (stair for stair in below if stair.leads == "up"):
        near = [stair for stair in downs if _apart_m(up, stair) <= _SAME_PLACE_M]
        if downs and not near:
            raise PlanError(
                f"stair {up.id} leads nowhere: the storey above shows stairs "
                f"{min(_apart_m(up, stair) for stair in downs):.1f} m away",
                expected="the same stair on both storeys",
            )
        ups.append(up)
    return ups


def _apart_m(stair: Stair, other: Stair) -> float:
    (x, y, _), (u, v, _) = stair.box.center_m, other.box.center_m
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
        fit = registered[index]
        shown.append(drawn_stairs(given[index].plan, fit.shift_m if fit else (0.0, 0.0)))
    areas = sorted(seen_on_both(*shown), key=lambda area: -area.area)
    if not areas and all(shown):
        pair = f"{_title(given, low)} and {_title(given, low + 1)}"
        return [], [f"the stairs drawn on {pair} do not lie over each other"]
    for number, area in enumerate(areas, start=1):
        stair = grown_stair(area, f"stair{number}", *plans, STOREY_M)
        if stair is not None:
            return [stair], list(_steepness(stair))
    return [], [
        f"the stair drawn on {_title(given, low)} ({_sides(area)} m) leaves no room for one to rule"
        for area in areas[:1]
    ]


def _steepness(stair: Stair) -> Iterator[str]:
    """What to say of a stair that keeps the rule of steep ones."""
    if stair.rule == STEEP:
        built = build_stair(stair, STOREY_M)
        width_m = min(flight.width_m for flight in built.flights)
        yield (
            f"stair {stair.id} is steep, as it is drawn: rises of {built.rise_m * 100:.0f} cm, "
            f"goings of {built.going_m * 100:.0f} cm, {width_m:.2f} m wide"
        )


def _sides(area: Polygon) -> str:
    corners = np.asarray(area.minimum_rotated_rectangle.exterior.coords)[:3]
    short, long = sorted(np.hypot(*np.diff(corners, axis=0).T).tolist())
    return f"{short:.1f} by {long:.1f}"


def _prefixed_cell(cell: Cell, index: int) -> Cell:
    prefix = prefix_of(index)
    return replace(cell, room=prefix + cell.room, joined=prefix + cell.joined)
