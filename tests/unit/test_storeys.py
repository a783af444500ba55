"""Houses of storeys: procedural ones are sound, and what does not fit is refused with a reason."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import shapely
from shapely import affinity, box
from shapely.ops import unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.metrics.walk import walk
from chord_usd.base.scene.geometry import polygons_of, room_polygon
from chord_usd.base.scene.json_stairs import storeys_from_json, storeys_to_json
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.stacking import stack
from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.base.scene.stair_landings import LEAST_LANDING_M, landing_depth_m
from chord_usd.base.scene.stair_places import DRAWN_STAIRS, seen_on_both
from chord_usd.base.scene.stair_spirals import is_round
from chord_usd.base.scene.storeys import STAIRS, STEEP, TO_RULE, Building, StoreyPlan
from chord_usd.base.scene.types import Plan, Room, RoomKind
from chord_usd.workshop.data.storey_houses import random_storeys

HOUSES = 24


@cache
def house(seed: int) -> tuple[StoreyPlan, ...]:
    return random_storeys(np.random.default_rng(seed), 3 if seed % 4 == 0 else 2)


@cache
def building(seed: int) -> Building:
    return stack(house(seed))


@pytest.mark.parametrize("seed", range(HOUSES))
def test_every_room_of_a_procedural_house_is_reached_over_its_stairs(seed: int) -> None:
    made = building(seed)
    assert len(made.climbs) == len(made.storeys) - 1
    assert not made.warnings
    reached = {0: True}
    for climb in made.climbs:
        reached[climb.storey + 1] = reached[climb.storey]
        assert {climb.foot.joined, climb.top.joined}.isdisjoint({climb.foot.room, climb.top.room})
    assert set(reached) == set(range(len(made.storeys)))
    for storey in made.storeys:
        assert walk(storey.plan.scene()).reachable_rooms == 1.0
        assert any(map(is_cell, storey.plan.rooms))
    ids = [one.id for storey in made.storeys for one in (*storey.plan.rooms, *storey.plan.openings)]
    assert len(ids) == len(set(ids))


@pytest.mark.parametrize("seed", range(HOUSES))
def test_a_cell_takes_its_floor_from_the_hall_and_nothing_else(seed: int) -> None:
    for given, storey in zip(house(seed), building(seed).storeys, strict=True):
        before = unary_union([room_polygon(room) for room in given.plan.rooms])
        after = unary_union([room_polygon(room) for room in storey.plan.rooms])
        assert before.symmetric_difference(after).area < 0.01


@pytest.mark.parametrize("seed", range(6))
def test_registration_does_not_depend_on_where_a_plan_was_drawn(seed: int) -> None:
    moved = [
        replace(one, plan=moved_plan(one.plan, (3.7 * index, -11.0 * index)))
        for index, one in enumerate(house(seed))
    ]
    for one, other in zip(stack(moved).storeys, building(seed).storeys, strict=True):
        for room, same in zip(one.plan.rooms, other.plan.rooms, strict=True):
            assert room_polygon(room).symmetric_difference(room_polygon(same)).area < 0.01


@pytest.mark.parametrize("seed", range(6))
def test_without_stairs_storeys_are_laid_on_each_other_by_their_outer_walls(seed: int) -> None:
    bare = [replace(one, plan=replace(one.plan, extra={})) for one in house(seed)]
    bare[1] = replace(bare[1], plan=posed(bare[1].plan, Pose(offset_m=(2.0, 5.0))))
    made = stack(bare)
    found = made.storeys[1].registration
    assert found
    assert found.by == "outer walls"
    assert np.allclose(found.shift_m, (-2.0, -5.0), atol=0.05)
    assert found.residual_m < 0.02
    assert "no stair joins" in made.warnings[0]


@pytest.mark.parametrize("share", [1.0, 0.85])
@pytest.mark.parametrize("seed", range(HOUSES))
def test_stairs_seen_on_pictures_join_storeys_as_those_that_are_given(
    seed: int, share: float
) -> None:
    """share: of a stair's length that the lower picture shows; its top is cut off, as drawn."""
    made, drawn = building(seed), [one for one in house(seed) if one.plan.extra.get(STAIRS)]
    pictures = []
    for index, one in enumerate(drawn):
        shown = [c.built for c in made.climbs if c.storey in (index, index - 1)]
        areas = [built.hole_m if built.is_spiral else built.area_m for built in shown]
        shift = made.storeys[index].registration
        dx, dy = shift.shift_m if shift else (0.0, 0.0)
        seen = [affinity.translate(area, -dx, -dy) for area in areas]
        seen = [affinity.scale(area, share, share) for area in seen]
        outlines = [area if is_round(area) else area.minimum_rotated_rectangle for area in seen]
        corners = [np.array(area.exterior.coords)[:-1] for area in outlines]
        noted = [(points * 100).tolist() for points in corners]
        pictures.append(replace(one, plan=replace(one.plan, extra={DRAWN_STAIRS: noted})))
    again = stack(pictures)
    assert len(again.climbs) == len(made.climbs), again.warnings
    for given, found in zip(made.climbs, again.climbs, strict=True):
        assert found.built.area_m.intersection(given.built.area_m).area > 0.5 * (
            given.built.area_m.area
        )
        assert found.built.is_spiral == given.built.is_spiral


def test_json_gives_the_same_storeys_back() -> None:
    data = storeys_to_json(house(0))
    assert storeys_to_json(storeys_from_json(data)) == data


def moved_plan(plan: Plan, by_m: tuple[float, float], scale: float = 1.0, yaw: float = 0.0) -> Plan:
    pose = Pose(scale=scale, yaw_deg=yaw, offset_m=by_m)
    stairs = [
        {**one, "pos": [*(pose.points(np.array([one["pos"][:2]]) / 100)[0] * 100), 0.0],
         "length": one["length"] * scale, "width": one["width"] * scale,
         "rotate": pose.yaw(one["rotate"])}
        for one in plan.extra.get(STAIRS, [])
    ]  # fmt: skip
    return replace(posed(plan, pose), extra={STAIRS: stairs})


def with_stairs(plan: Plan, change: Callable[[dict[str, object]], dict[str, object]]) -> Plan:
    return replace(plan, extra={STAIRS: [change(dict(one)) for one in plan.extra[STAIRS]]})


def spoilt(kind: str) -> list[StoreyPlan]:
    ground, first = house(1)[0], house(1)[1]
    bare = [replace(one, plan=replace(one.plan, extra={})) for one in (ground, first)]
    away = [0.0, 0.0, 0.0]
    changed: dict[str, Callable[[], list[StoreyPlan]]] = {
        "scale": lambda: [ground, StoreyPlan(moved_plan(first.plan, (0, 0), 1.3))],
        "turned": lambda: [ground, StoreyPlan(moved_plan(first.plan, (0, 0), 1.0, 90.0))],
        "scale without stairs": lambda: [
            bare[0], StoreyPlan(posed(bare[1].plan, Pose(scale=0.7)))
        ],
        "three copies": lambda: [ground, ground, ground],
        "too small": lambda: [
            replace(one, plan=with_stairs(one.plan, lambda s: {**s, "width": 200.0}))
            for one in (ground, first)
        ],
        "nowhere": lambda: [
            replace(ground, plan=with_stairs(ground.plan, lambda s: {**s, "pos": away})),
            replace(bare[1], shift_m=(0.0, 0.0)),
        ],
        "13 storeys": lambda: [ground, *[first] * 12],
    }  # fmt: skip
    return changed[kind]()


REASONS = {
    "scale": "1.30 times the scale", "turned": "is turned by",
    "scale without stairs": "drawn 1.4", "three copies": "once more",
    "too small": "cannot rise", "nowhere": "stands in no room", "13 storeys": "13 storeys",
}  # fmt: skip


@pytest.mark.parametrize("kind", REASONS)
def test_what_does_not_fit_is_refused_with_the_reason(kind: str) -> None:
    with pytest.raises(PlanError, match=REASONS[kind]):
        stack(spoilt(kind))


def test_a_landing_that_is_too_shallow_is_measured() -> None:
    made = stack(random_storeys(np.random.default_rng(3), 2))
    climb, plan = made.climbs[0], made.storeys[1].plan
    assert landing_depth_m(plan, climb.built) == LEAST_LANDING_M
    edge = climb.built.arrival_m
    ahead = climb.built.walk_m[-1, :2] - climb.built.walk_m[-2, :2]
    line = affinity.translate(edge, *(0.62 * ahead / np.hypot(*ahead)))
    wall = affinity.scale(line, 50.0, 50.0).buffer(0.12, cap_style="flat")

    def cut(room: Room) -> Room:
        parts = polygons_of(room_polygon(room).difference(wall)) or [room_polygon(room)]
        part = min(parts, key=edge.distance)
        return replace(room, polygon_m=np.asarray(part.exterior.coords)[:-1])

    rooms = tuple(room if is_cell(room) else cut(room) for room in plan.rooms)
    shallow = replace(plan, rooms=rooms, openings=())
    assert landing_depth_m(shallow, climb.built) == pytest.approx(0.5, abs=0.01)


def rectangle(name: str, kind: RoomKind, bounds: tuple[float, float, float, float]) -> Room:
    west, south, east, north = bounds
    corners = [(west, south), (east, south), (east, north), (west, north)]
    return Room(name, kind, np.array(corners, float))


def hall_house(
    flight: tuple[float, float, float, float], turned_deg: float, landing_m: tuple[float, float]
) -> list[StoreyPlan]:
    """A hall with a landing over a part of it, and a flight that both show, metres."""
    south, north = landing_m
    hall = rectangle("hall", "corridor", (0.0, 0.0, 1.9, 5.6))
    landing = rectangle("landing", "corridor", (0.0, south, 1.9, north))
    bath = rectangle("bath", "bathroom", (0.0, north + 0.24, 1.9, 5.6))
    seen = affinity.rotate(box(*flight), turned_deg)
    noted = [(np.array(seen.exterior.coords)[:-1] * 100).tolist()]
    plans = [
        Plan((hall,), (), {DRAWN_STAIRS: noted}),
        Plan((landing, bath), (), {DRAWN_STAIRS: noted}),
    ]
    return [StoreyPlan(plans[0]), StoreyPlan(plans[1], shift_m=(0.0, 0.0))]


@pytest.mark.parametrize(
    ("flight", "landing_m", "is_steep"),
    [
        ((-0.05, 0.1, 0.85, 3.8), (0.0, 3.75), False),  # British, and 5 cm in its wall
        ((-0.05, 1.05, 0.75, 3.5), (1.0, 4.4), True),  # narrow, and too short under a wall
    ],
)
def test_a_flight_as_pictures_show_it_is_built(
    flight: tuple[float, float, float, float], landing_m: tuple[float, float], is_steep: bool
) -> None:
    """uk_kathleenpro: "0.9 by 3.7 m leaves no room for one to rule"; uk_123: 0.8 by 2.6 m."""
    made = stack(hall_house(flight, 1.0, landing_m))
    (climb,) = made.climbs
    assert climb.built.rise_m <= (STEEP if is_steep else TO_RULE).rise_m[1] + 1e-6
    assert any("is steep" in one for one in made.warnings) == is_steep
    for storey, area in zip(made.storeys, (climb.built.under_m, climb.built.above_m), strict=True):
        floors = unary_union([room_polygon(room).buffer(1e-3) for room in storey.plan.rooms])
        assert area.difference(floors).area < 0.03 * area.area


def test_stairs_that_do_not_meet_are_a_warning() -> None:
    below, above = hall_house((0.0, 0.1, 0.9, 3.7), 0.0, (0.0, 3.75))
    far = {DRAWN_STAIRS: [[[0, 520], [90, 520], [90, 560], [0, 560]]]}
    made = stack([replace(below, plan=replace(below.plan, extra=far)), above])
    assert "do not lie over each other" in made.warnings[0]


@pytest.mark.parametrize(("side_m", "is_alone"), [(1.9, True), (3.2, False)])
def test_a_square_on_one_storey_is_all_of_a_stair_that_winds(side_m: float, is_alone: bool) -> None:
    """A spiral stair of 1.9 m with its way out above "left no room for one to rule"."""
    square = shapely.box(0.0, 0.0, side_m, side_m)
    above = shapely.box(0.0, 0.0, side_m, side_m + 1.0)
    (seen,) = seen_on_both([square], [above])
    assert seen.equals(square) is is_alone
