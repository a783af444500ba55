"""Bubble diagrams: of plans, on sheets, and as the sequences that are learned from."""

import numpy as np
import pytest
from shapely.geometry import Point

from chord_usd.base.raster import plan_labels
from chord_usd.base.raster.bubbles import (
    LEAST_RADIUS_M,
    Bubble,
    bubbles_of,
    touching_pairs,
    with_bubbles,
)
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Plan, Room, frozen_array
from chord_usd.base.scene.wish import WISHED_KINDS, room_counts
from chord_usd.line.layout.floor_condition import PIXEL_PLANES, floor_condition
from chord_usd.line.planning import sketch_tokens as tokens
from chord_usd.line.planning.floor_sheet import blank_sheet, on_sheet, shell_sheet, slips
from chord_usd.line.planning.outline import open_shell, shell_labels
from chord_usd.workshop.data.houses import random_plan

PLANS = [random_plan(np.random.default_rng(seed)) for seed in range(20)]
FRAME = plan_labels.sheet_frame(0.12)


@pytest.mark.parametrize("plan", PLANS)
def test_every_room_has_a_bubble_of_its_own(plan: Plan) -> None:
    bubbles = bubbles_of(plan)
    assert [one.kind for one in bubbles] == [room.kind for room in plan.rooms]
    assert touching_pairs(bubbles) == 0
    for room, one in zip(plan.rooms, bubbles, strict=True):
        disc = Point(one.x_m, one.y_m).buffer(min(one.radius_m, LEAST_RADIUS_M))
        assert room_polygon(room).buffer(0.01).covers(disc) or one.radius_m == LEAST_RADIUS_M


def test_a_bubble_lies_in_the_room_where_its_middle_is_not() -> None:
    """The centroid of an L lies outside it."""
    corners = frozen_array([(0, 0), (6, 0), (6, 1.5), (1.5, 1.5), (1.5, 6), (0, 6)])
    room = Room("a", "corridor", corners)
    (bubble,) = bubbles_of(Plan((room,), ()))
    assert room_polygon(room).contains(Point(bubble.x_m, bubble.y_m).buffer(bubble.radius_m * 0.99))


def test_rooms_of_unknown_kind_have_none() -> None:
    corners = frozen_array([(0, 0), (4, 0), (4, 4), (0, 4)])
    assert bubbles_of(Plan((Room("a", "unknown", corners),), ())) == ()


def test_bubbles_are_drawn_where_they_are_and_seen_by_kind() -> None:
    bubble = Bubble("bedroom", 2.04, -1.08, 1.0)
    sheet = with_bubbles(blank_sheet(FRAME), [bubble])
    seen = floor_condition(sheet.rgb, 0.12, 4)
    plane = seen.pixels[PIXEL_PLANES - len(WISHED_KINDS) + WISHED_KINDS.index("bedroom")]
    assert np.pi < plane.sum() * 0.12**2 < np.pi * 1.07**2, "half a pixel more, as discs are drawn"
    rows, columns = np.nonzero(plane)
    assert (columns.mean() + 0.5 - 80) * 0.12 == pytest.approx(2.04, abs=0.03)
    assert (80 - rows.mean() - 0.5) * 0.12 == pytest.approx(-1.08, abs=0.03)
    assert seen.pixels[PIXEL_PLANES - len(WISHED_KINDS) :].sum() == plane.sum()


def test_bubbles_leave_walls_as_they_are() -> None:
    sheet, _ = shell_sheet(open_shell(PLANS[0]))
    drawn = with_bubbles(sheet, [Bubble("living", *PLANS[0].rooms[0].polygon_m[0], 3.0)])
    walls = (sheet.rgb != 255).any(axis=2)
    assert np.array_equal(drawn.rgb[walls], sheet.rgb[walls])
    assert not np.array_equal(drawn.rgb, sheet.rgb)


def test_slips_are_counted() -> None:
    sheet, _ = shell_sheet(open_shell(PLANS[0]))
    assert slips(sheet, bubbles_of(PLANS[0])) == 0
    outside = Bubble("store", 500.0, 0.0, 0.3)
    assert slips(sheet, [*bubbles_of(PLANS[0]), outside]) == 1
    twice = [Bubble("store", 0.0, 0.0, 0.5), Bubble("bedroom", 0.6, 0.0, 0.5)]
    assert slips(blank_sheet(FRAME), twice) == 1


@pytest.mark.parametrize("plan", PLANS[:10])
def test_sequences_tell_a_house_within_half_a_step(plan: Plan) -> None:
    bubbles = [one for one in bubbles_of(plan) if max(abs(one.x_m), abs(one.y_m)) < 12.8]
    told = tokens.sequence_of(bubbles, 100.0)
    assert tokens.area_of(told.values[0, 0]) == pytest.approx(100.0, rel=0.04)
    counted = tokens.counts_of(told.values[: tokens.HEADING])
    assert sum(counted.values()) == len(bubbles)
    assert len(bubbles) < len(plan.rooms) or counted == room_counts(plan)
    read = tokens.bubbles_from(told.roles[tokens.HEADING :], told.values[tokens.HEADING :])
    for one in read:
        near = [o for o in bubbles if o.kind == one.kind
                and max(abs(o.x_m - one.x_m), abs(o.y_m - one.y_m)) <= 0.1 + 1e-9]  # fmt: skip
        assert any(abs(o.radius_m - one.radius_m) <= 0.051 or one.radius_m > 3.3 for o in near)


def test_every_value_can_stand_where_it_stands() -> None:
    allowed = tokens.allowed_values()
    for plan in PLANS[:10]:
        told = tokens.sequence_of(bubbles_of(plan), 80.0)
        slots = np.arange(tokens.SLOTS)
        assert allowed[told.roles[:, None], slots[None], told.values].all()


def test_shells_are_seen_in_place() -> None:
    """One window on the left of a house is in the left half of its cells."""
    labels = np.zeros((160, 160), np.uint8)
    labels[40:120, 40:120] = plan_labels.WALL
    labels[50:110, 50:110] = plan_labels.label_of("unknown")
    labels[70:80, 40:50] = plan_labels.WINDOW
    cells = tokens.shell_cells(labels, 0.16)
    assert cells.shape == (tokens.SHELL_MARKS, tokens.SHELL_CELLS, tokens.SHELL_CELLS)
    assert cells[0].sum() * tokens.CELL_M**2 == pytest.approx(12.8**2, rel=0.01)
    assert cells[2, :, :16].sum() > 0 == cells[2, :, 16:].sum()
    patches = tokens.shell_patches(cells)
    assert patches.shape == (tokens.SHELL_PATCHES, tokens.SHELL_CHANNELS)
    assert patches.sum() == pytest.approx(cells.sum(), rel=1e-5)


def test_bubbles_from_the_middle_of_a_sheet_come_to_lie_in_the_world() -> None:
    shell = open_shell(PLANS[1])
    sheet, _ = shell_sheet(shell)
    corners = shell.rooms[0].polygon_m
    middle = (corners.min(axis=0) + corners.max(axis=0)) / 2
    (placed,) = on_sheet(sheet, [Bubble("living", 0.0, 0.0, 1.0)])
    assert (placed.x_m, placed.y_m) == pytest.approx(tuple(middle), abs=0.2)
    assert shell_labels(shell)[1] == sheet.frame
