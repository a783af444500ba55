"""The view of a room: from inside it, at its furniture, past what stands in the way."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from shapely.geometry import LineString, Point, Polygon, box

from chord_usd.data.furnish import furnish
from chord_usd.data.houses import random_plan
from chord_usd.scene.geometry import footprint_polygon, room_polygon
from chord_usd.scene.types import Box, Item
from chord_usd.stage.viewpoints import SENSOR_MM, View, choose_view


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


@pytest.mark.parametrize("seed", range(6))
def test_rooms_are_seen_from_inside_and_not_from_behind_furniture(seed: int) -> None:
    rng = np.random.default_rng(seed)
    house = furnish(random_plan(rng), rng)
    for room in house.rooms:
        floor, items = room_polygon(room), list(house.items_of(room.id))
        view = choose_view(floor, items)
        assert floor.buffer(-0.1).contains(Point(view.position_m)), room.id
        tall = [
            footprint_polygon(one.box)
            for one in items
            if one.box.center_m[2] + one.box.size_m[2] > 1.3
        ]
        assert not any(area.contains(Point(view.position_m)) for area in tall), room.id
        if floor.area > 6.0:
            assert clear_ahead_m(view, floor, tall) > 1.2, room.id


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
    view = choose_view(floor, [bath, basin], [np.array([1.2, 2.1])])
    assert view.position_m[1] > 1.2
    assert looks_at(view, (0.85, 0.4))
