"""Label maps, the plans that are read from them, and what is found wrong with plans."""

from dataclasses import replace

import numpy as np
import pytest

from chord_usd.base.errors import PlanError
from chord_usd.base.raster import plan_labels
from chord_usd.base.scene.geometry import is_axis_aligned, room_polygon
from chord_usd.base.scene.types import Box, Opening, Plan, Room, frozen_array
from chord_usd.base.scene.wish import Wish, floor_area_m2, has_open_kitchen, room_counts
from chord_usd.line.layout.floor_condition import GRID_PLANES, PIXEL_PLANES, floor_condition
from chord_usd.line.planning.choose import best, judged
from chord_usd.line.planning.faults import faults
from chord_usd.line.planning.floor_sheet import blank_sheet
from chord_usd.line.planning.outline import open_shell, shell_labels, shell_of
from chord_usd.line.planning.partition import plan_from_labels
from chord_usd.workshop.data.houses import random_plan


def fitting_plans(count: int, aligned: bool = True) -> list[tuple[Plan, float]]:
    """Plans that fit their sheets, with the scale."""
    found, seed = [], 0
    while len(found) < count:
        plan = random_plan(np.random.default_rng(seed))
        scale = plan_labels.fitting_scale(plan)
        if scale and (is_axis_aligned(plan) or not aligned):
            found.append((plan, scale))
        seed += 1
    return found


PLANS = fitting_plans(40)


def square(x: float, y: float, width: float, depth: float) -> np.ndarray:
    return frozen_array([(x, y), (x + width, y), (x + width, y + depth), (x, y + depth)])


def two_rooms() -> Plan:
    """A living room and a bedroom, a wall apart; a front door and one between them."""
    rooms = (
        Room("living1", "living", square(0, 0, 4, 4)),
        Room("bedroom1", "bedroom", square(4.24, 0, 3, 4)),
    )
    front = Opening("door1", "door", Box((2.0, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("living1",))
    inner = Opening(
        "door2", "door", Box((4.12, 2.0, 0.0), (0.8, 0.24, 2.1), 90.0), ("living1", "bedroom1")
    )
    return Plan(rooms, (front, inner))


def test_nobody_comes_home_to_a_bathroom() -> None:
    plan = two_rooms()
    assert faults(plan) == []
    bathroom = replace(plan.rooms[0], kind="bathroom")
    assert "the front door leads into living1" in faults(
        replace(plan, rooms=(bathroom, plan.rooms[1]))
    )


def test_what_was_drawn_is_read_back() -> None:
    """Rooms and floor areas of nearly all; the rest lose a nook narrower than a line's gap."""
    same, sound = 0, 0
    for plan, scale in PLANS:
        frame = plan_labels.label_frame(plan, scale)
        read = plan_from_labels(plan_labels.label_plan(plan, frame), frame)
        same += room_counts(read) == room_counts(plan)
        sound += not faults(read)
        assert floor_area_m2(read) == pytest.approx(floor_area_m2(plan), rel=0.12)
    assert same >= 0.9 * len(PLANS)
    assert sound >= 0.9 * len(PLANS)


def test_frayed_and_speckled_maps_give_straight_walls() -> None:
    plan, scale = PLANS[0]
    frame = plan_labels.label_frame(plan, scale)
    labels = plan_labels.label_plan(plan, frame)
    rng = np.random.default_rng(0)
    rows, columns = np.indices(labels.shape)
    shift = rng.integers(-1, 2, labels.shape)
    frayed = labels[rows, np.clip(columns + shift, 0, labels.shape[1] - 1)]
    frayed[rng.random(labels.shape) < 0.02] = plan_labels.WALL
    read = plan_from_labels(frayed, frame)
    assert room_counts(read) == room_counts(plan)
    assert is_axis_aligned(read)
    assert floor_area_m2(read) == pytest.approx(floor_area_m2(plan), rel=0.12)


def test_an_empty_map_has_no_rooms() -> None:
    frame = plan_labels.sheet_frame(0.12)
    read = plan_from_labels(np.zeros((plan_labels.CANVAS_PX,) * 2, np.uint8), frame)
    assert not read.rooms
    assert faults(read) == ["there are no rooms"]


@pytest.mark.parametrize("index", range(10))
def test_shells_are_kept_to_the_millimetre(index: int) -> None:
    """Slanted walls, too: rooms fill the shell up to their own inner walls."""
    plan, _ = fitting_plans(10, aligned=False)[index]
    shell = open_shell(plan)
    labels, frame = shell_labels(shell)
    truth = plan_labels.label_plan(plan, frame)
    inside = labels == plan_labels.label_of("unknown")
    read = plan_from_labels(np.where(inside, truth, labels), frame, shell)
    outside = room_polygon(shell.rooms[0]).buffer(0.001)
    for room in read.rooms:
        assert outside.covers(room_polygon(room)), room.id
    kept = {opening.box for opening in shell.openings} & {opening.box for opening in read.openings}
    assert len(kept) == len({opening.box for opening in shell.openings})


def test_only_open_plans_are_shells() -> None:
    with pytest.raises(PlanError, match="2 closed rooms"):
        shell_of(two_rooms(), "open.png")
    tiny = Plan((Room("a", "unknown", square(0, 0, 2, 2)),), ())
    with pytest.raises(PlanError, match="at least 14"):
        shell_of(tiny, "open.png")
    huge = Plan((Room("a", "unknown", square(0, 0, 40, 10)),), ())
    with pytest.raises(PlanError, match="at most 24 m"):
        shell_of(huge, "open.png")


def test_conditions_of_blank_and_open_sheets() -> None:
    frame = plan_labels.sheet_frame(0.12)
    blank = floor_condition(blank_sheet(frame).rgb, 0.12, 4)
    assert blank.pixels.shape == (PIXEL_PLANES, 160, 160)
    assert blank.grid.shape == (GRID_PLANES, 40, 40)
    assert blank.pixels[0].all()
    assert not blank.grid[0].any()
    labels, frame = shell_labels(open_shell(PLANS[0][0]))
    given = floor_condition(plan_labels.paint_labels(labels), frame.m_per_px, 4)
    assert given.grid[0].all()
    assert np.array_equal(given.pixels[0] > 0, labels != plan_labels.OUTSIDE)


def test_a_sound_plan_has_no_faults() -> None:
    assert faults(two_rooms()) == []


def test_every_fault_is_found() -> None:
    plan = two_rooms()
    front, inner = plan.openings
    assert "there is no front door" in faults(replace(plan, openings=(inner,)))
    assert "bedroom1 cannot be reached" in faults(replace(plan, openings=(front,)))
    living, bedroom = plan.rooms
    close = replace(bedroom, polygon_m=square(4.1, 0, 3, 4))
    assert any("less than a wall apart" in f for f in faults(replace(plan, rooms=(living, close))))
    slit = replace(bedroom, polygon_m=square(4.24, 0, 0.5, 10))
    assert any("narrower" in f for f in faults(replace(plan, rooms=(living, slit))))
    small = replace(bedroom, polygon_m=square(4.24, 0, 2, 2))
    assert any("less than 4.5" in f for f in faults(replace(plan, rooms=(living, small))))
    crossed = replace(bedroom, polygon_m=frozen_array([(5, 0), (8, 4), (8, 0), (5, 4)]))
    assert any("not closed" in f for f in faults(replace(plan, rooms=(living, crossed))))
    astray = replace(inner, box=replace(inner.box, center_m=(20.0, 2.0, 0.0)))
    assert any("does not lie in a wall" in f for f in faults(replace(plan, openings=(astray,))))


def test_the_floor_that_holds_is_taken() -> None:
    plan = two_rooms()
    wish = Wish({"bedroom": 1, "living": 1}, floor_area_m2(plan))
    good = judged(plan, wish)
    shut = judged(replace(plan, openings=plan.openings[:1]), wish)
    other = judged(plan, Wish({"bedroom": 2}, 90.0))
    assert good.holds
    assert good.cost == 0.0
    assert other.missed == {"bedroom": (2, 1)}
    assert other.area_missed
    assert best([shut, other, good]) is good


def test_open_kitchens_are_seen() -> None:
    plan = two_rooms()
    kitchen = replace(plan.rooms[1], kind="kitchen")
    through = replace(plan.openings[1], kind="passage")
    assert has_open_kitchen(Plan((plan.rooms[0], kitchen), (plan.openings[0], through)))
    assert not has_open_kitchen(Plan((plan.rooms[0], kitchen), plan.openings))
