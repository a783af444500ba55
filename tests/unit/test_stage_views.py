"""The view of a room: at its furniture and floor, past what stands in the way."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Point, Polygon, box

from chord_usd.base.scene.geometry import footprint_polygon, room_polygon
from chord_usd.base.scene.types import Box, FloatArray, Item, Opening
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.views.viewpoints import NEAR_M, SENSOR_MM, View, choose_view
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan


def item(category: str, at_m: tuple[float, float], size_m: tuple[float, float, float]) -> Item:
    return Item(category, category, Box((*at_m, 0.0), size_m, 0.0))


def looks_at(view: View, point: tuple[float, float]) -> bool:
    """Whether a point lies between the left and the right edge of the picture."""
    bearing = math.degrees(math.atan2(point[1] - view.position_m[1], point[0] - view.position_m[0]))
    half_deg = math.degrees(math.atan(SENSOR_MM[0] / 2 / view.lens_mm))
    return abs((bearing - view.yaw_deg + 180.0) % 360.0 - 180.0) < half_deg


def clear_ahead_m(view: View, floor: Polygon, tall: list[Polygon]) -> float:
    """How far one sees along the middle of the picture."""
    yaw = math.radians(view.yaw_deg)
    ahead = np.array(view.position_m) + 50.0 * np.array([math.cos(yaw), math.sin(yaw)])
    line = LineString([view.position_m, ahead])
    free = line.intersection(floor).difference(shapely.union_all(tall) if tall else Polygon())
    first = min(shapely.get_parts(free), key=lambda part: part.distance(Point(view.position_m)))
    return float(first.length)


def in_sight_m(view: View) -> FloatArray:
    """(2, 2) ends of the near clipping plane in the picture, seen from above."""
    turn = rotation_2d(view.yaw_deg)
    half = view.near_m * SENSOR_MM[0] / 2 / view.lens_mm
    middle = np.array(view.position_m) + view.near_m * turn[:, 0]
    return np.array([middle - half * turn[:, 1], middle + half * turn[:, 1]])


@pytest.mark.parametrize("seed", range(6))
def test_nothing_is_cut_open_and_no_piece_stands_close(seed: int) -> None:
    rng = np.random.default_rng(seed)
    house = furnish(random_plan(rng), rng)
    for room in house.rooms:
        floor, items = room_polygon(room), list(house.items_of(room.id))
        view = choose_view(floor, items)
        pieces = [footprint_polygon(one.box) for one in items]
        assert floor.buffer(0.01).covers(LineString(in_sight_m(view))), room.id
        inside = view.near_m == NEAR_M
        assert inside or not any(LineString(in_sight_m(view)).intersects(p) for p in pieces)
        gap_m = min((p.distance(Point(view.position_m)) for p in pieces), default=1.0)
        if floor.area > 9.0:
            assert gap_m >= 0.39, room.id


def test_two_thirds_of_living_rooms_are_seen_through_lenses_that_do_not_stretch() -> None:
    shares, lenses_mm = [], []
    for seed in range(6):
        rng = np.random.default_rng(seed)
        house = furnish(random_plan(rng), rng)
        for room in house.rooms:
            view = choose_view(room_polygon(room), list(house.items_of(room.id)))
            lenses_mm.append(view.lens_mm)
            if room.kind == "living":
                shares.append(view.floor_share)
    assert np.median(shares) >= 0.66
    assert np.mean(np.array(lenses_mm) >= 24.0) > 0.85


def test_furniture_is_what_one_looks_at() -> None:
    bed = item("bed", (4.9, 0.9), (2.0, 1.6, 1.0))
    view = choose_view(box(0, 0, 6, 4), [bed])
    assert looks_at(view, (4.9, 0.9))


def test_one_does_not_stand_behind_a_wardrobe_that_hides_the_bed() -> None:
    bed = item("bed", (1.0, 1.0), (2.0, 2.0, 1.0))
    screen = item("cabinet", (3.0, 1.4), (0.4, 2.8, 2.4))
    view = choose_view(box(0, 0, 6, 4), [bed, screen])
    sight = LineString([view.position_m, (1.0, 1.0)])
    assert not sight.intersects(footprint_polygon(screen.box))
    assert looks_at(view, (1.0, 1.0))


def test_a_closet_is_seen_along_its_diagonal() -> None:
    view = choose_view(box(0, 0, 1.2, 1.2), [])
    assert clear_ahead_m(view, box(0, 0, 1.2, 1.2), []) > 1.0


def test_a_doorway_is_a_place_to_stand() -> None:
    """A narrow room full of furniture but for its door."""
    bath = item("bathtub", (0.85, 0.4), (1.7, 0.8, 0.6))
    basin = item("washbasin", (0.3, 1.2), (0.6, 0.6, 0.9))
    floor = box(0, 0, 1.7, 2.0)
    door = Opening("door", "door", Box((1.2, 2.1, 0.0), (0.8, 0.2, 2.1), 0.0))
    view = choose_view(floor, [bath, basin], [door])
    assert view.position_m[1] > 1.2
    assert looks_at(view, (0.85, 0.4))
