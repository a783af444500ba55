"""Crowded pages: labels, points and vectors agree with what is drawn, and a seed is a page."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from shapely.geometry import Polygon

from chord_usd.base.raster.page_labels import (
    BUILT_NAMES,
    CORNER,
    DOOR,
    FLOOR,
    HINGE,
    JAMB,
    LAID_NAMES,
    OUTSIDE,
    PASSAGE,
    STAIRS,
    SWING,
    WALL,
    WINDOW,
    built_of,
    laid_of,
)
from chord_usd.base.scene.geometry import footprint, room_polygon
from chord_usd.base.scene.types import ByteArray, FloatArray
from chord_usd.workshop.data.drawn.crowded import draw_page, with_open_kitchen
from chord_usd.workshop.data.drawn.page_looks import KINDS, Look, random_look
from chord_usd.workshop.data.drawn.truth import CrowdedPage
from chord_usd.workshop.data.houses import random_plan

BLACK_WALLS = Look(
    "agent", names=0.0, sizes=0.0, chains=0.0, furniture_of_page=0.0, surroundings=0.0,
    pieces="none", masses=0.3, corner_doors=0.9, door_rgb=(200, 0, 0), window_rgb=(0, 0, 200),
    piece_rgb=(0, 160, 0),
)  # fmt: skip
"""Only walls are black."""

CLEAN_SEEDS = (3, 4, 6, 7, 8, 9)


@pytest.fixture(scope="module", params=CLEAN_SEEDS)
def page(request: pytest.FixtureRequest) -> CrowdedPage:
    """A page with nothing on it but a house."""
    return draw_page(request.param, BLACK_WALLS)


def pixels_of(page: CrowdedPage, points_m: FloatArray) -> FloatArray:
    """(N, 2) continuous pixels."""
    seen = np.column_stack([points_m, np.ones(len(points_m))]) @ page.to_picture.T
    return np.asarray(seen[:, :2] / seen[:, 2:])


def drawn_mask(page: CrowdedPage, rings_m: list[FloatArray]) -> ByteArray:
    mask = np.zeros(page.labels.shape, np.uint8)
    for ring in rings_m:
        cv2.fillPoly(mask, [np.rint(pixels_of(page, ring) - 0.5).astype(np.int32)], (1.0,))
    return mask


def overlap(one: ByteArray, other: ByteArray) -> float:
    return float((one & other).sum() / (one | other).sum())


def test_walls_are_where_the_ink_is() -> None:
    """On pages that no camera saw."""
    shares = []
    for seed in CLEAN_SEEDS:
        page = draw_page(seed, BLACK_WALLS)
        dark = (page.rgb.max(axis=2) < 110).astype(np.uint8)
        shares.append(overlap(dark, (built_of(page.labels) == WALL).astype(np.uint8)))
    assert np.median(shares) > 0.85


def test_rooms_are_floor(page: CrowdedPage) -> None:
    built = built_of(page.labels)
    for storey in page.storeys:
        for room in storey.plan.rooms:
            inner = room_polygon(room).buffer(-0.1)
            if not isinstance(inner, Polygon) or inner.is_empty:
                continue
            mask = drawn_mask(page, [np.array(inner.exterior.coords)]) > 0
            if mask.sum() > 50:
                assert np.isin(built[mask], (FLOOR, STAIRS)).mean() > 0.97


def test_openings_are_labelled_where_the_vectors_are(page: CrowdedPage) -> None:
    built = built_of(page.labels)
    wanted = {"door": (DOOR, PASSAGE), "window": (WINDOW,), "passage": (PASSAGE,)}
    for storey in page.storeys:
        for opening in storey.plan.openings:
            middle = pixels_of(page, np.array([opening.box.center_m[:2]]))[0].astype(int)
            if (middle >= 0).all() and (middle < built.shape[::-1]).all():
                assert built[middle[1], middle[0]] in wanted[opening.kind]


def test_leaves_hang_at_their_openings_and_sweep_a_quarter(page: CrowdedPage) -> None:
    laid = laid_of(page.labels)
    for storey in page.storeys:
        boxes = {o.id: footprint(o.box) for o in storey.plan.openings}
        for name, hinge, tip in storey.hinges_m:
            assert Polygon(boxes[name]).distance(Polygon([hinge, tip, tip])) < 0.01
            assert np.hypot(*(tip - hinge)) > 0.3
    if any(storey.hinges_m for storey in page.storeys):
        assert (laid == SWING).any()


def test_points_lie_at_what_they_mark(page: CrowdedPage) -> None:
    built = built_of(page.labels)
    near = cv2.dilate(np.isin(built, (DOOR, WINDOW, PASSAGE)).astype(np.uint8), np.ones((9, 9)))
    for x, y, kind in page.points:
        if kind in (HINGE, JAMB):
            assert near[int(y), int(x)]
    assert {CORNER, JAMB} <= set(page.points[:, 2].astype(int))


def test_wall_bodies_are_the_wall_pixels() -> None:
    shares = []
    for seed in CLEAN_SEEDS:
        page = draw_page(seed, BLACK_WALLS)
        rings = [ring for storey in page.storeys for ring in storey.walls_m]
        bodies = np.zeros(page.labels.shape, np.uint8)
        pixels = [np.rint(pixels_of(page, ring) - 0.5).astype(np.int32) for ring in rings]
        cv2.fillPoly(bodies, pixels, (1,))
        shares.append(overlap(bodies, (built_of(page.labels) == WALL).astype(np.uint8)))
    assert np.median(shares) > 0.9


def test_a_seed_is_a_page() -> None:
    one, again, other = draw_page(11), draw_page(11), draw_page(12)
    assert np.array_equal(one.rgb, again.rgb)
    assert np.array_equal(one.labels, again.labels)
    assert np.array_equal(one.points, again.points)
    assert one.rgb.shape != other.rgb.shape or not np.array_equal(one.rgb, other.rgb)


def test_every_kind_of_page_is_drawn() -> None:
    rng = np.random.default_rng(0)
    looks: dict[str, Look] = {}
    while len(looks) < len(KINDS):
        look = random_look(rng)
        looks.setdefault(look.kind, replace(look, surroundings=0.5, chains=0.5))
    for index, look in enumerate(looks.values()):
        page = draw_page(100 + index, look)
        assert page.rgb.shape[:2] == page.labels.shape
        assert built_of(page.labels).max() < len(BUILT_NAMES)
        assert laid_of(page.labels).max() < len(LAID_NAMES)
        assert {OUTSIDE, FLOOR, WALL} <= set(np.unique(built_of(page.labels)))


def test_a_kitchen_lies_open_to_the_room_beside_it():
    rng = np.random.default_rng(5)
    opened = 0
    for seed in range(20):
        plan = random_plan(np.random.default_rng(seed))
        found = with_open_kitchen(plan, rng)
        grown = [
            (own, room)
            for own, room in zip(plan.rooms, found.rooms, strict=True)
            if not np.array_equal(own.polygon_m, room.polygon_m)
        ]
        opened += len(grown)
        for own, room in grown:
            floor = room_polygon(room)
            assert own.kind == "kitchen"
            assert floor.contains(room_polygon(own).buffer(-1e-3))
            touched = [
                other
                for other in found.rooms
                if other is not room and floor.intersection(room_polygon(other)).length > 1.0
            ]
            assert {other.kind for other in touched} & {"living", "dining"}
            assert all(floor.intersection(room_polygon(o)).area < 1e-4 for o in touched)
            shut = [o for o in plan.openings if o not in found.openings]
            assert all(own.id in one.room_ids for one in shut)
    assert opened > 4
