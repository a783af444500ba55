"""The floor above a stair is open where headroom needs it, and nowhere else."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.geometry import Point, Polygon

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import room_polygon, to_world
from chord_usd.base.scene.stacking import stack
from chord_usd.base.scene.stair_cells import is_cell, with_wells
from chord_usd.base.scene.storeys import HEADROOM_M, STAIRS, StairForm
from chord_usd.base.scene.tunnels import as_cut
from chord_usd.base.scene.types import (
    ROOM_HEIGHT_M,
    Box,
    Opening,
    Plan,
    Room,
    RoomKind,
    frozen_array,
)
from chord_usd.workshop.data.storey_houses import random_storeys
from tests.stair_houses import cornered, terraced

SIZES: list[tuple[StairForm, tuple[float, float]]] = [
    ("straight", (0.95, 4.0)), ("U", (2.0, 3.0)), ("L", (2.8, 3.0)), ("winder_L", (1.7, 3.0)),
    ("winder_U", (1.75, 2.3)),
]  # fmt: skip


@pytest.mark.parametrize(("form", "size"), SIZES)
def test_the_hole_leaves_the_floor_over_the_lower_steps(
    form: StairForm, size: tuple[float, float]
) -> None:
    made = cornered(form, size)
    built, top = made.climbs[0].built, made.climbs[0].top
    assert top.hole_m is not None
    hole, area = built.hole_m, built.area_m
    assert area.buffer(1e-3).covers(hole)
    assert top.hole_m.symmetric_difference(hole).area < 0.01
    for tread in built.treads:
        place = to_world(built.stair.box, tread.area_m.representative_point().coords[0])
        if tread.top_m + HEADROOM_M > ROOM_HEIGHT_M:
            assert hole.covers(Point(place))
    first = to_world(built.stair.box, built.treads[0].area_m.representative_point().coords[0])
    halls = [room_polygon(room) for room in made.storeys[1].plan.rooms if not is_cell(room)]
    assert any(hall.covers(Point(first)) for hall in halls)


def test_over_a_spiral_stair_the_floor_is_open_in_a_circle() -> None:
    made = cornered("spiral", (2.0, 2.0), "left")
    built, top = made.climbs[0].built, made.climbs[0].top
    assert top.hole_m is not None
    assert top.hole_m.symmetric_difference(built.hole_m).area < 1e-3
    assert top.hole_m.area == pytest.approx(np.pi * 0.94**2, rel=0.01)
    cell = made.storeys[1].plan.room(top.room)
    assert room_polygon(cell).area == pytest.approx(4.0, abs=0.01)


def test_a_spiral_stair_goes_on_where_the_one_below_ends_and_nowhere_else() -> None:
    given = random_storeys(np.random.default_rng(0), 3, ("spiral",))
    made = stack(given)
    low, high = (climb.built for climb in made.climbs)
    assert low.landing_m is not None
    assert high.approach_m is not None
    assert low.landing_m.covers(high.approach_m.buffer(-0.02))
    turned = []
    for storey in given:
        stairs = [dict(one) for one in storey.plan.extra[STAIRS]]
        for one in stairs:
            one["rotate"] += 90.0 if one["id"] in ("stair1", "stair2_down") else 0.0
        turned.append(replace(storey, plan=replace(storey.plan, extra={STAIRS: stairs})))
    with pytest.raises(PlanError, match=r"begins over the hole|leads nowhere"):
        stack(turned)


def test_flights_drawn_too_short_get_a_stair_under_the_floor_above_and_over_a_wall() -> None:
    made = stack(terraced())
    assert not made.warnings
    built = made.climbs[0].built
    assert built.stair.form == "straight"
    assert built.hole_m.bounds[1] >= 1.68 - 1e-6
    assert built.area_m.bounds[1] < 1.68
    assert built.area_m.bounds[3] > 4.34 > built.under_m.bounds[3]
    kinds = {room.id: room.kind for room in made.storeys[1].plan.rooms}
    assert kinds["storey1_landing"] == "corridor"


def test_where_one_steps_off_no_wall_is_cut() -> None:
    for storey in stack(terraced()).storeys:
        openings = [one for one in storey.plan.openings if one.kind == "passage"]
        cut = as_cut(storey.plan.rooms, storey.plan.openings)
        assert openings
        assert [one for one in cut if one.kind == "passage"] == openings


def hall(kind: RoomKind = "corridor", door_m: float = 0.6) -> Plan:
    """A hall of 2 x 4 m with a door in its lower wall."""
    room = Room("hall", kind, frozen_array([(0.0, 0.0), (2.0, 0.0), (2.0, 4.0), (0.0, 4.0)]))
    door = Opening("door", "door", Box((door_m, -0.12, 0.0), (0.8, 0.24, 2.1), 0.0), ("hall",))
    return Plan((room,), (door,))


def test_nothing_stands_on_the_steps_that_a_storey_alone_shows() -> None:
    """Shoe cabinets stood there."""
    stair = shapely.box(1.1, 0.5, 2.05, 4.0)
    made = with_wells(hall(), [stair])
    assert [is_cell(room) for room in made.rooms] == [False, True]
    assert sum(room_polygon(room).area for room in made.rooms) == pytest.approx(8.0, abs=0.01)
    full = with_wells(hall(), [shapely.box(0.0, 0.2, 2.0, 4.0)])
    assert [is_cell(room) for room in full.rooms] == [True]


@pytest.mark.parametrize(
    ("plan", "stair"),
    [
        (hall(door_m=1.5), shapely.box(1.1, 0.0, 2.0, 3.0)),
        (hall("bathroom"), shapely.box(1.1, 0.5, 2.0, 4.0)),
        (hall(), shapely.box(1.4, 2.0, 2.0, 3.5)),
    ],
    ids=["before a door", "in a bathroom", "small"],
)
def test_what_only_looks_like_a_stair_stays_floor(plan: Plan, stair: Polygon) -> None:
    assert with_wells(plan, [stair]) == plan
