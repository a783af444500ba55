"""Large houses: what the network sees of them, and how its answers are put together."""

import numpy as np
import pytest

from chord_usd.base.raster import canvas
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import CANVAS_PX, Box, Opening, Plan, PlanImage, Room
from chord_usd.line.layout.condition import FLOOR_PLANE, floor_regions, plan_condition
from chord_usd.line.layout.denoiser import Estimate, Plans
from chord_usd.line.layout.mosaic import OVERLAP_M, cut_views, mosaic_of
from chord_usd.workshop.data.houses import random_plan

STEP_PX = 32


def _room(name: str, x: float, y: float, length: float, width: float) -> Room:
    corners = [(x, y), (x + length, y), (x + length, y + width), (x, y + width)]
    return Room(name, "bedroom", np.array(corners))


def _terrace(rooms: int) -> PlanImage:
    """Rooms of 6 × 4 m in a row, with doors between them."""
    row = tuple(_room(f"r{index}", 6.24 * index, 0.0, 6.0, 4.0) for index in range(rooms))
    doors = tuple(
        Opening(f"d{index}", "door", Box((6.24 * index - 0.12, 2.0, 0.0), (0.9, 0.24, 2.1), 90.0))
        for index in range(rooms)
    )
    return _drawn(Plan(row, doors))


def _drawn(plan: Plan) -> PlanImage:
    return canvas.draw_plan(plan, canvas.house_frame(plan))


def _views(image: PlanImage):
    return cut_views(image.rgb, image.frame.m_per_px, STEP_PX)


@pytest.mark.parametrize("seed", range(6))
def test_views_share_the_floor_out_and_show_it_as_it_is(seed: int) -> None:
    plan = random_plan(np.random.default_rng(seed), rooms=24)
    image = canvas.draw_plan(plan, canvas.fit_frame(plan, 512))
    regions, _ = floor_regions(image.rgb, image.frame.m_per_px)
    times = np.zeros(regions.shape, int)
    for view in cut_views(image.rgb, image.frame.m_per_px, STEP_PX):
        assert all(side <= CANVAS_PX and side % STEP_PX == 0 for side in view.decided.shape)
        times[view.window] += view.decided
        floor = plan_condition(view.rgb, image.frame.m_per_px, 4).pixels[FLOOR_PLANE]
        assert floor[view.decided].all()
        assert np.array_equal(view.rgb[view.decided], image.rgb[view.window][view.decided])
    assert np.array_equal(times, regions > 0)


@pytest.mark.parametrize("rooms", [6, 12, 24, 48])
def test_what_is_looked_at_grows_with_the_floor(rooms: int) -> None:
    views = _views(_terrace(rooms))
    looked_at = sum(view.decided.size for view in views)
    assert looked_at < 8 * sum(view.decided.sum() for view in views)


def test_neighbours_are_in_sight() -> None:
    image = _terrace(12)
    for view in _views(image):
        seen = floor_regions(view.rgb, image.frame.m_per_px)[0] > 0
        assert (seen & ~view.decided).any()


def test_a_hall_larger_than_a_view_is_cut_well_within_what_is_seen() -> None:
    image = _drawn(Plan((_room("hall", 0.0, 0.0, 60.0, 8.0),), ()))
    reach_px = OVERLAP_M / image.frame.m_per_px
    views = _views(image)
    assert len(views) > 2
    last_px = max(view.window[1].start + np.flatnonzero(view.decided.any(0))[-1] for view in views)
    for view in views:
        seen = np.flatnonzero((floor_regions(view.rgb, image.frame.m_per_px)[0] > 0).any(axis=0))
        own = np.flatnonzero(view.decided.any(axis=0))
        left_px = view.window[1].start
        if left_px + own[-1] < last_px:
            assert seen[-1] - own[-1] >= reach_px - 12, "the wall that closes the view is near"
        assert (view.rgb[:, seen[-1] + 1] == 0).all(axis=1).any(), "no wall closes the view"


def test_a_passage_that_leads_out_of_sight_keeps_its_floor_free() -> None:
    rooms = (_room("a", 0.0, 0.0, 16.0, 5.0), _room("b", 16.24, 0.0, 16.0, 5.0))
    gap = Opening("p", "passage", Box((16.12, 2.5, 0.0), (1.2, 0.24, 2.3), 90.0))
    image = _drawn(Plan(rooms, (gap,)))
    door = np.array(category("door").rgb)
    assert not (image.rgb == door).all(axis=2).any()
    views = _views(image)
    assert len(views) == 2
    for view in views:
        assert (view.rgb == door).all(axis=2).any()
        kept_free = plan_condition(view.rgb, image.frame.m_per_px, 4).pixels[FLOOR_PLANE + 1]
        assert (kept_free & view.decided).any()


def test_a_mosaic_puts_every_answer_in_its_place() -> None:
    image = _terrace(12)
    looked: list[tuple[int, ...]] = []

    def describe(pictures, scales, drafts=None):
        floor = np.zeros((len(pictures), 1, *pictures[0].shape[:2]), bool)
        return Plans(np.zeros(floor.shape, np.float32), None, floor)

    def look(state, times, plans):
        looked.append(state.shape)
        return Estimate(2.0 * state, 3.0 * state)

    bare = np.full((1, 2, 1, 1), -1.0, np.float32), np.full((1, 2, 1, 1), -2.0, np.float32)
    mosaic = mosaic_of([image.rgb], [image.frame.m_per_px], STEP_PX, describe)
    state = np.random.default_rng(0).standard_normal((1, 2, *image.rgb.shape[:2]), np.float32)
    said = mosaic.estimate(state, [5], look, bare)
    floor = floor_regions(image.rgb, image.frame.m_per_px)[0] > 0
    assert np.array_equal(mosaic.inside[0, 0], floor)
    assert np.array_equal(said.output, np.where(floor, 2.0 * state, -1.0))
    assert np.array_equal(said.clean, np.where(floor, 3.0 * state, -2.0))


def test_only_views_on_what_matters_are_looked_through() -> None:
    image = _terrace(12)
    region = canvas.room_pixels(_room("r0", 0.0, 0.0, 6.0, 4.0), image.frame)
    described = []

    def describe(pictures, scales, drafts=None):
        described.extend(pictures)
        return Plans(
            np.zeros((len(pictures), 1, 4, 4), np.float32), None, np.zeros((1, 1, 4, 4)) > 0
        )

    mosaic_of([image.rgb], [image.frame.m_per_px], STEP_PX, describe, region)
    assert len(described) == 1 < len(_views(image))
