"""Kitchens are composed as runs: by published numbers, in their room, off openings and pieces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import shapely

from chord_usd.base.metrics.design.kitchen_rules import runs_of
from chord_usd.base.metrics.design.shell import shells
from chord_usd.base.metrics.design.view import view_home
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.metrics.violations import violations
from chord_usd.base.scene.geometry import footprint_polygon, to_own
from chord_usd.base.scene.trim import boards, casings
from chord_usd.base.scene.types import Box, Item, Opening, Plan, Room, SceneGraph, frozen_array
from chord_usd.line.compose.composer import (
    compose,
    composed_kitchens,
    composed_of,
    put_back,
    with_kitchens,
)
from chord_usd.line.compose.prices import SINK_END_M
from chord_usd.line.compose.site import site_of
from chord_usd.line.compose.widths import FITS, WIDTHS, splits
from tests.every import for_every

SIZES_M = ((2.4, 3.0), (1.9, 4.2), (3.0, 3.4), (4.0, 2.6), (5.0, 4.0), (2.0, 2.1))
KIT = "kitchen_1"


def kitchen(size_m: tuple[float, float], sill_m: float = 0.9, door_at: float = 0.5) -> SceneGraph:
    """A room with a door in its south wall and a window in its north wall."""
    wide, deep = size_m
    corners = frozen_array([[0, 0], [wide, 0], [wide, deep], [0, deep]])
    door = Box((wide * door_at, -0.12, 0.0), (0.8, 0.24, 2.1), 0.0)
    window = Box((wide / 2, deep + 0.12, sill_m), (1.2, 0.24, 1.4), 0.0)
    openings = (
        Opening("door1", "door", door, (KIT,)),
        Opening("window1", "window", window, (KIT,)),
    )
    return Plan((Room(KIT, "kitchen", corners, "Kitchen"),), openings).scene()


def composed(house: SceneGraph, seed: int = 0) -> SceneGraph:
    return with_kitchens(house, composed_kitchens(house, house.rooms, seed, {}, {}))


def one(house: SceneGraph, category: str) -> Item:
    return next(item for item in house.items if item.category == category)


@for_every("size_m", SIZES_M)
def test_nothing_is_wrong_with_a_composed_kitchen(size_m: tuple[float, float]) -> None:
    """Nothing overlaps, is out of reach or before an opening; essentials and a refrigerator."""
    for seed in range(4):
        house = composed(kitchen(size_m), seed)
        assert not violations(house)
        assert {"sink_cabinet", "cooker_cabinet", "refrigerator"} <= {
            i.category for i in house.items
        }


@for_every("door_at", (0.16, 0.3, 0.7, 0.84))
def test_units_stand_off_the_casings_of_doors(door_at: float) -> None:
    """Also of a door whose casing lies in the corner beside a run."""
    for size_m in SIZES_M[2:5]:
        bare = kitchen(size_m, door_at=door_at)
        legs = [footprint_polygon(leg) for leg in casings(bare.openings[0], bare.rooms[0])]
        for wall in site_of(bare, bare.rooms[0], (), ()).walls:
            for low, high in wall.spans(0.6, 0.87, 0.1):
                shape = shapely.Polygon(wall.rectangle(low, high, 0.0, 0.6))
                assert all(shape.intersection(leg).area < 1e-6 for leg in legs)


def test_units_stand_off_the_board_of_a_window_beyond_an_open_border() -> None:
    house = kitchen((3.0, 3.4))
    beside = Room("room", "living", frozen_array([[3.0, 0], [6.0, 0], [6.0, 3.4], [3.0, 3.4]]))
    window = Opening("b", "window", Box((3.6, 3.52, 0.8), (1.2, 0.24, 1.4), 0.0), ("room",))
    house = replace(house, rooms=(*house.rooms, beside), openings=(house.openings[0], window))
    (board,) = boards(window, beside)
    for wall in site_of(house, house.rooms[0], (), ()).walls:
        for low, high in wall.spans(0.6, 0.87, 0.1):
            shape = shapely.Polygon(wall.rectangle(low, high, 0.0, 0.6))
            assert shape.intersection(footprint_polygon(board)).area < 1e-6


def test_no_unit_stands_close_before_a_wall() -> None:
    """A pier 75 cm from a wall: what is behind it could not be opened."""
    pier = shapely.box(0.75, 2.6, 1.9, 3.4)
    floor = shapely.orient_polygons(shapely.box(0, 0, 3.6, 3.4).difference(pier))
    bare = kitchen((3.6, 3.4), door_at=0.8)
    room = replace(bare.rooms[0], polygon_m=shapely.get_coordinates(floor.exterior)[:-1])
    house = replace(bare, rooms=(room,), openings=bare.openings[:1])
    for seed in range(6):
        for item in composed(house, seed).items:
            front = replace(item.box, size_m=(item.box.size_m[0], item.box.size_m[1] + 0.6, 1.0))
            assert footprint_polygon(front).intersection(pier).area < 0.02, (seed, item.category)


def test_people_come_in_over_open_borders() -> None:
    """Cookers stand off these as off doors, when kitchens are composed and when they are judged."""
    house = kitchen((3.0, 3.4))
    beside = frozen_array([[3.0, 0], [6.0, 0], [6.0, 3.4], [3.0, 3.4]])
    house = replace(house, rooms=(*house.rooms, Room("room", "living", beside)))
    border = np.array([[3.0, 0.0], [3.0, 3.4]])
    entries = [hole.ends for hole in shells(house.rooms, house.openings)[KIT].entries]
    for ends in (entries, site_of(house, house.rooms[0], (), ()).doors):
        assert len(ends) == 2
        assert min(np.abs(np.sort(one, axis=0) - border).max() for one in ends) < 0.02


@for_every("size_m", SIZES_M[1:5])
def test_the_cooker_stands_between_worktops(size_m: tuple[float, float]) -> None:
    """30 cm on both sides, in its run or round its corner, and never below the window."""
    for seed in range(4):
        house = composed(kitchen(size_m), seed)
        cooker = one(house, "cooker_cabinet")
        ends = footprint_polygon(cooker.box).bounds
        assert cooker.box.yaw_deg != 0.0 or min(ends[2], size_m[0] / 2 + 0.6) - max(
            ends[0], size_m[0] / 2 - 0.6
        ) < 0.05  # fmt: skip
        for side in (-1, 1):
            x_m = side * (cooker.box.size_m[0] / 2 + 0.14)
            assert any(
                np.all(
                    np.abs(to_own(item.box, _world(cooker, x_m)))
                    < np.array(item.box.size_m[:2]) / 2
                )
                for item in house.items
                if item.category.endswith("floor_cabinet") and item.box.size_m[2] < 1.0
            )


def _world(item: Item, x_m: float) -> np.ndarray:
    from chord_usd.base.scene.geometry import to_world

    return to_world(item.box, (x_m, 0.0))


def test_what_is_tall_ends_its_run() -> None:
    for seed in range(6):
        house = composed(kitchen((4.0, 3.2)), seed)
        for tall in (item for item in house.items if item.box.size_m[2] > 1.2):
            low = [item for item in house.items if item.box.size_m[2] < 1.0]
            sides = [
                any(abs(to_own(tall.box, item.box.center_m[:2])[1]) < 0.1
                    and 0 < side * to_own(tall.box, item.box.center_m[:2])[0]
                    - (tall.box.size_m[0] + item.box.size_m[0]) / 2 + 0.05 < 0.1 for item in low)
                for side in (-1, 1)
            ]  # fmt: skip
            assert not all(sides)


def test_worktops_stay_below_low_windows() -> None:
    """All units of a kitchen are as high as the lowest sill allows."""
    house = kitchen((3.0, 3.4), 0.84)
    heights = {unit.box.size_m[2] for unit in compose(house, house.rooms[0], 1)}
    assert len({height for height in heights if height < 1.2}) == 1
    assert min(heights) <= 0.84 - 0.018


def test_seeds_give_other_kitchens_and_the_same_seed_the_same() -> None:
    house = kitchen((3.4, 3.6))
    made = [tuple(compose(house, house.rooms[0], seed)) for seed in range(12)]
    assert made[3] == tuple(compose(house, house.rooms[0], 3))
    assert len(set(made)) >= 8


def test_large_kitchens_have_islands_that_one_walks_round() -> None:
    """A work aisle before the run, a walkway on the other sides, and no fault."""
    houses = [composed(kitchen((5.2, 5.0)), seed) for seed in range(8)]
    found = [[i for i in house.items if i.facts.unit == "island"] for house in houses]
    assert 2 <= sum(map(bool, found)) < len(houses)
    for house, units in zip(houses, found, strict=True):
        assert not violations(house)
        others = [footprint_polygon(i.box) for i in house.items if i not in units]
        for unit in units:
            assert min(map(footprint_polygon(unit.box).distance, others)) > 0.9


def test_no_kitchen_where_none_fits() -> None:
    house = kitchen((1.0, 1.1))
    assert composed(house).items == ()


def test_kept_units_and_excluded_essentials_leave_a_kitchen_alone() -> None:
    house = composed(kitchen((3.0, 3.4)))
    sink = one(house, "sink_cabinet")
    rooms = house.rooms
    assert not composed_kitchens(house, rooms, 0, {}, {KIT: [sink]})
    assert not composed_kitchens(house, rooms, 0, {KIT: ["cooker_cabinet"]}, {})
    without = composed_kitchens(house, rooms, 0, {KIT: ["refrigerator"]}, {})
    assert "refrigerator" not in {item.category for item in without[KIT]}


def test_a_kept_table_stays_clear_of_the_units() -> None:
    house = kitchen((5.0, 4.0))
    table = Item(
        f"{KIT}/dining_table_0", "dining_table", Box((3.9, 2.6, 0), (1.2, 0.8, 0.75), 0), KIT
    )
    house = replace(house, items=(table,))
    made = composed_kitchens(house, house.rooms, 2, {}, {KIT: [table]})
    assert not violations(with_kitchens(house, made))


def test_what_the_painter_tears_is_put_back() -> None:
    """Units come back in their composed sizes and places, and note where they were painted."""
    house = composed(kitchen((3.0, 3.4)))
    kitchens = composed_of(house)
    torn = [
        replace(item, box=replace(item.box, size_m=(0.9 * item.box.size_m[0], 0.55, 0.87)))
        for item in house.items
        if item.category != "sink_cabinet"
    ]
    torn = [item.with_facts(unit=None, source_px=((0.0, 0.0),) * 4) for item in torn]
    back = put_back(replace(house, items=tuple(torn)), kitchens)
    assert [item.box for item in back.items] == [item.box for item in house.items]
    assert all(item.category in KITCHEN_UNITS for item in back.items)
    edited = [item for item in back.items if item.facts.edits]
    assert len(edited) >= len(torn) - 1


@for_every("gap", range(121))
def test_gaps_are_filled_with_widths_that_are_sold(gap: int) -> None:
    ways = splits(gap)
    assert bool(ways) == bool(FITS[gap])
    assert all(sum(way) == gap and set(way) <= set(WIDTHS) for way in ways)
    assert FITS[gap] or gap in (1, 2, 5)


def test_something_can_be_put_down_on_both_sides_of_a_sink() -> None:
    """Also in a narrow kitchen, where the numbers of NKBA cannot be kept."""
    (view,) = view_home(composed(kitchen((1.7, 3.0)), 0)).rooms
    runs = runs_of(view)
    assert runs is not None
    sink = runs.first("sink_cabinet")
    assert sink is not None
    assert runs.sides(sink)[0] >= SINK_END_M
