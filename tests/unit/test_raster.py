"""Rasters are exact: a pixel is painted if and only if its centre is inside."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.errors import PlanError
from chord_usd.base.raster import canvas
from chord_usd.base.scene import palette
from chord_usd.base.scene.geometry import (
    footprint_polygon,
    front_direction,
    room_polygon,
    wall_area,
)
from chord_usd.base.scene.palette import Level, Mount
from chord_usd.base.scene.types import (
    CANVAS_PX,
    Box,
    Item,
    Opening,
    PixelFrame,
    Plan,
    PlanImage,
    Room,
    frozen_array,
)
from chord_usd.base.scene.units import m_from_px, px_from_m
from chord_usd.workshop.data.houses import random_plan

FRAME = PixelFrame(0.05, (-1.0, -2.0))
HOUSE = ("living", [[0, 0], [5, 0], [5, 4], [2.5, 4], [2.5, 6], [0, 6]])
SQUARE = [[0, 0], [4, 0], [4, 4], [0, 4]]
WALL_RGB, DOOR_RGB, WINDOW_RGB = (palette.category(n).rgb for n in ("wall", "door", "window"))


def room(kind: Any, corners: Any, name: str = "r") -> Room:
    return Room(name, kind, frozen_array(corners))


def centers_m(frame: PixelFrame) -> np.ndarray:
    rows, columns = np.mgrid[0 : frame.height_px, 0 : frame.height_px] + 0.5
    return m_from_px(np.stack([columns, rows], axis=-1), frame)


def inside(shape: shapely.Geometry, frame: PixelFrame) -> np.ndarray:
    """Pixels whose centres lie inside, by shapely."""
    points = centers_m(frame)
    return shapely.contains_xy(shape, points[..., 0], points[..., 1])


def is_rgb(image: np.ndarray, rgb: tuple[int, int, int]) -> np.ndarray:
    return (image == np.array(rgb)).all(axis=-1)


# Plans -------------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", range(4))
def test_walls_and_rooms_are_what_shapely_says(seed: int) -> None:
    plan = random_plan(np.random.default_rng(seed))
    image = canvas.draw_plan(Plan(plan.rooms, ()))
    frame = image.frame
    wall = wall_area(plan.rooms)
    # A centre on an edge, to rounding, may count either way.
    points = shapely.points(centers_m(frame).reshape(-1, 2))
    sure = (shapely.distance(wall.boundary, points) > 1e-9).reshape(CANVAS_PX, CANVAS_PX)
    assert np.array_equal(is_rgb(image.rgb, WALL_RGB)[sure], inside(wall, frame)[sure])
    for each in plan.rooms:
        mine = inside(room_polygon(each), frame) & sure
        assert is_rgb(image.rgb, palette.ROOM_SHADES[each.kind])[mine].all()


@pytest.mark.parametrize("seed", range(4))
def test_openings_are_painted_through_their_wall_and_nowhere_else(seed: int) -> None:
    plan = random_plan(np.random.default_rng(seed))
    frame = canvas.fit_frame(plan)
    bare = canvas.draw_plan(Plan(plan.rooms, ()), frame).rgb
    image = canvas.draw_plan(plan, frame).rgb
    wall = is_rgb(bare, WALL_RGB)
    assert np.array_equal(bare[~wall], image[~wall])
    expected = bare.copy()
    colors = {"door": DOOR_RGB, "window": WINDOW_RGB, "passage": palette.BACKGROUND_RGB}
    for opening in plan.openings:
        # A hair wider than the wall: their common faces may differ in the last bit.
        shape = footprint_polygon(opening.box).buffer(1e-7, join_style="mitre")
        expected[inside(shape, frame) & wall] = colors[opening.kind]
    assert (expected != image).any(axis=-1).sum() <= 2


@pytest.mark.parametrize("shade", [True, False])
def test_a_plan_has_palette_colours_only(shade: bool) -> None:
    image = canvas.draw_plan(random_plan(np.random.default_rng(3)), shade=shade).rgb
    allowed = {WALL_RGB, DOOR_RGB, WINDOW_RGB, palette.BACKGROUND_RGB}
    if shade:
        allowed |= set(palette.ROOM_SHADES.values())
    assert set(map(tuple, np.unique(image.reshape(-1, 3), axis=0).tolist())) <= allowed
    assert image.shape == (CANVAS_PX, CANVAS_PX, 3)
    assert image.dtype == np.uint8
    assert not image.flags.writeable


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10_000), st.integers(64, 300), st.integers(1, 12))
def test_the_house_is_centred_and_fills_the_canvas(seed: int, size: int, margin: int) -> None:
    plan = random_plan(np.random.default_rng(seed), rooms=3)
    frame = canvas.fit_frame(plan, size, margin)
    bounds = np.array(wall_area(plan.rooms).bounds).reshape(2, 2)
    (left, bottom), (right, top) = px_from_m(bounds, frame)
    assert min(left, top) >= margin - 1e-6
    assert max(right, bottom) <= size - margin + 1e-6
    assert min(left, top) == pytest.approx(margin)
    assert left == pytest.approx(size - right)
    assert top == pytest.approx(size - bottom)


@pytest.mark.parametrize("side_m", [2.0, 8.0, 16.0, 25.0, 90.0, 500.0])
def test_a_house_of_any_size_has_a_scale_that_serves(side_m: float) -> None:
    corners = [(0, 0), (side_m, 0), (side_m, side_m / 3), (0, side_m / 3)]
    plan = Plan((room("bedroom", corners),), ())
    frame = canvas.house_frame(plan)
    assert canvas.FINEST_M_PER_PX <= frame.m_per_px <= canvas.COARSEST_M_PER_PX
    assert frame.height_px >= CANVAS_PX
    assert frame.height_px % canvas.CANVAS_STEP_PX == 0
    bounds = px_from_m(np.array(wall_area(plan.rooms).bounds).reshape(2, 2), frame)
    assert bounds.min() >= 5.9
    assert bounds.max() <= frame.height_px - 5.9
    if 8.0 <= side_m <= 16.0:
        assert frame == canvas.fit_frame(plan)


def test_a_plan_in_the_wrong_unit_is_refused() -> None:
    plan = Plan((room("bedroom", [(0, 0), (9e4, 0), (9e4, 9e4), (0, 9e4)]),), ())
    with pytest.raises(PlanError, match=r"m across.*Try: m_per_px"):
        canvas.house_frame(plan)


def test_a_short_opening_box_still_goes_through_the_whole_wall() -> None:
    plan = Plan(
        (room(*HOUSE),), (Opening("w", "window", Box((2, -0.12, 0.9), (1.5, 0.12, 1.4), 0)),)
    )
    image = canvas.draw_plan(plan, FRAME).rgb
    bare = canvas.draw_plan(Plan(plan.rooms, ()), FRAME).rgb
    column = px_from_m((2, 0), FRAME)[0].astype(int)
    wall = is_rgb(bare, WALL_RGB)[:, column]
    window = is_rgb(image, WINDOW_RGB)[:, column]
    below = centers_m(FRAME)[:, column, 1] < 1.0
    assert np.array_equal(window, wall & below)
    assert is_rgb(image, WINDOW_RGB).sum() == 30 * window.sum()


def test_rooms_that_touch_have_no_wall_between_them() -> None:
    rooms = (
        room("living", HOUSE[1]),
        room("dining", [[5, 0], [9, 0], [8, 4], [5, 4]]),
        room("kitchen", [[9, 0], [12, 0], [12, 4], [8, 4]]),
    )
    image = canvas.draw_plan(Plan(rooms, ())).rgb
    frame = canvas.fit_frame(Plan(rooms, ()))
    for x in (5.0, 8.5):
        column, row = np.floor(px_from_m((x, 2.0), frame)).astype(int)
        assert not is_rgb(image[row, column - 3 : column + 4], WALL_RGB).any()


def test_rooms_that_overlap_by_mistake_do_not_turn_into_walls_or_doors() -> None:
    rooms = tuple(
        room(kind, np.add(SQUARE, (0.3 * index, 0)))
        for index, kind in enumerate(palette.ROOM_SHADES)
    )
    plan = Plan(rooms, ())
    image = canvas.draw_plan(plan)
    floor = inside(shapely.union_all([room_polygon(r) for r in rooms]), image.frame)
    for rgb in (WALL_RGB, DOOR_RGB, WINDOW_RGB):
        assert not is_rgb(image.rgb, rgb)[floor].any()


def test_what_lies_beyond_the_canvas_is_cut_off() -> None:
    frame = PixelFrame(0.02, (2.0, 2.0))
    image = canvas.draw_plan(Plan((room(*HOUSE),), ()), frame).rgb
    floor = inside(room_polygon(room(*HOUSE)), frame)
    assert np.array_equal(is_rgb(image, palette.ROOM_SHADES["living"]), floor)


def test_a_plan_without_rooms_has_no_frame() -> None:
    with pytest.raises(PlanError, match="no rooms"):
        canvas.fit_frame(Plan((), ()))
    assert (canvas.draw_plan(Plan((), ()), FRAME).rgb == 255).all()


# Items -------------------------------------------------------------------------------------------

boxes = st.builds(
    Box,
    st.tuples(st.floats(-0.5, 11), st.floats(-1.5, 10), st.just(0.0)),
    st.tuples(st.floats(0.01, 3), st.floats(0.01, 3), st.just(1.0)),
    st.sampled_from([0.0, 90.0, 180.0, -90.0, 270.0, 45.0]) | st.floats(-180, 180),
)


@settings(deadline=None, max_examples=40)
@given(boxes)
def test_an_item_is_painted_where_its_footprint_is(box: Box) -> None:
    labels, front = canvas.draw_items([Item("i", "sofa", box)], FRAME)
    painted = labels > 0
    assert set(np.unique(labels)) <= {0, palette.category("sofa").detector_class + 1}
    assert not (front & ~painted).any()
    shape = footprint_polygon(box)
    if min(box.size_m[:2]) >= FRAME.m_per_px:
        grown, shrunk = shape.buffer(1e-9), shape.buffer(-1e-9)
        assert not (painted & ~inside(grown, FRAME)).any()
        assert not (inside(shrunk, FRAME) & ~painted).any()
    else:
        # Thinner than a pixel: one pixel thick, and never behind its back.
        reach = shape.buffer(FRAME.m_per_px * 1.01, join_style="mitre")
        assert not (painted & ~inside(reach, FRAME)).any()


@settings(deadline=None, max_examples=40)
@given(boxes)
def test_the_front_mark_lies_at_the_front(box: Box) -> None:
    labels, front = canvas.draw_items([Item("i", "sofa", box)], FRAME)
    on_canvas = shapely.box(-0.9, -1.9, 11.7, 10.7).contains(footprint_polygon(box))
    if not on_canvas or min(box.size_m[:2]) < 3 * FRAME.m_per_px:
        return
    points = centers_m(FRAME)
    middle, mark = points[labels > 0].mean(axis=0), points[front].mean(axis=0)
    forward = (mark - middle) @ front_direction(box.yaw_deg)
    assert forward == pytest.approx(
        box.size_m[1] * (1 - palette.FRONT_MARK_WIDTH) / 2, abs=1.2 * FRAME.m_per_px
    )


@settings(deadline=None, max_examples=30)
@given(st.floats(0, 5), st.floats(0, 5), st.floats(0.005, 0.12), st.sampled_from([0, 90, 180, 270]))
def test_the_thinnest_item_at_a_wall_is_seen_whole_and_with_a_mark(
    x: float, y: float, width: float, yaw_deg: float
) -> None:
    box = Box((x, y, 1.1), (2.0, width, 1.0), float(yaw_deg))
    labels, front = canvas.draw_items([Item("i", "bed_background", box)], FRAME)
    assert labels.astype(bool).sum() in range(39, 42 * 4)
    assert front.sum() >= 20
    # Its back is fixed: no pixel behind it.
    behind = (centers_m(FRAME)[labels > 0] - (x, y)) @ -front_direction(yaw_deg)
    assert behind.max() <= width / 2 + 1e-9


def test_items_are_painted_underfoot_first_then_large_then_small_then_wall_hung() -> None:
    center = (4.0, 4.0, 0.0)
    order = ["bed_background", "bedside_table", "bed"]
    sizes = {"bed": (2, 2, 1), "bedside_table": (1, 1, 1), "bed_background": (1.5, 0.5, 1)}
    items = [Item(name, name, Box(center, sizes[name], 0.0)) for name in order]  # type: ignore[arg-type]
    labels, _ = canvas.draw_items(items, FRAME)
    counts = {
        name: (labels == palette.category(name).detector_class + 1).sum() * FRAME.m_per_px**2
        for name in order
    }
    assert counts["bed_background"] == pytest.approx(0.75, abs=0.05)
    assert counts["bedside_table"] == pytest.approx(0.5, abs=0.05)
    assert counts["bed"] == pytest.approx(4 - 0.75 - 0.5, abs=0.05)


def test_a_smaller_item_hides_the_mark_below_it() -> None:
    large = Item("a", "bed", Box((4, 4, 0), (2, 2, 1), 0))
    small = Item("b", "chair", Box((4, 3.2, 0), (0.4, 0.4, 1), 180))
    _, front = canvas.draw_items([large, small], FRAME)
    column, row = px_from_m((4, 3.1), FRAME).astype(int)
    assert not front[row, column]


def test_levels_do_not_mix() -> None:
    box = Box((4, 4, 0), (1, 1, 1), 0)
    items = [Item("a", "laptop", box), Item("b", "bed", box)]
    house, _ = canvas.draw_items(items, FRAME)
    table, _ = canvas.draw_items(items, FRAME, Level.TABLE)
    assert set(np.unique(house)) == {0, palette.category("bed").detector_class + 1}
    assert set(np.unique(table)) == {0, palette.category("laptop").detector_class + 1}
    rug = Item("c", "magazine", box)
    assert palette.category("magazine").mount is Mount.UNDERFOOT
    labels, _ = canvas.draw_items([items[0], rug], FRAME, Level.TABLE)
    assert set(np.unique(labels)) == set(np.unique(table))


# Layouts -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("marked", [False, True])
def test_layout_colours_are_those_of_the_palette(marked: bool) -> None:
    below = [WALL_RGB, *palette.ROOM_SHADES.values()]
    image = PlanImage(np.array([below], np.uint8), FRAME)
    for row in [*palette.HOUSE_CATEGORIES, *palette.TABLE_CATEGORIES]:
        labels = np.full((1, len(below)), row.detector_class + 1, np.uint8)
        painted = canvas.paint_layout(image, labels, np.full(labels.shape, marked), row.level)
        wanted = [palette.painted(rgb, row.rgb) for rgb in below]
        if marked:
            wanted = [palette.painted(rgb, (0, 0, 0), palette.FRONT_MARK_OPACITY) for rgb in wanted]
        assert np.array_equal(painted[0], wanted)


def test_a_layout_differs_from_its_plan_only_under_items() -> None:
    plan = Plan((room(*HOUSE),), ())
    image = canvas.draw_plan(plan)
    items = [Item("a", "bed", Box((1, 1, 0), (2, 2, 1), 30))]
    labels, front = canvas.draw_items(items, image.frame)
    layout = canvas.layout_image(image, items)
    changed = (layout.rgb != image.rgb).any(axis=-1)
    assert np.array_equal(changed, labels > 0)
    assert np.array_equal(layout.rgb, canvas.paint_layout(image, labels, front))
    assert layout.frame == image.frame


def test_drawing_is_fast_enough_to_stream_training_data() -> None:
    plans = [random_plan(np.random.default_rng(seed)) for seed in range(20)]
    start = time.process_time()
    for plan in plans:
        canvas.draw_plan(plan)
    # 0.5 ms on an idle core; the bound only catches a return of shapely or of loops over pixels.
    assert (time.process_time() - start) / len(plans) < 0.01


def test_what_is_taken_is_a_pixel_wider_than_what_is_drawn() -> None:
    frame = PixelFrame(0.1, (0.0, 0.0), 64)
    bed = Item("bed", "bed", Box((3.0, 3.0, 0.0), (1.0, 2.0, 0.5), 0.0), "room")
    drawn = canvas.draw_items([bed], frame)[0] > 0
    taken = canvas.taken_pixels([bed], frame)
    assert not (drawn & ~taken).any()
    rows, columns = np.nonzero(drawn)
    wide_rows, wide_columns = np.nonzero(taken)
    assert (wide_rows.min(), wide_rows.max()) == (rows.min() - 1, rows.max() + 1)
    assert (wide_columns.min(), wide_columns.max()) == (columns.min() - 1, columns.max() + 1)
    assert not canvas.taken_pixels([], frame).any()
