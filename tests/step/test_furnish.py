"""The furnisher on many random houses: what every layout it makes must hold to."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
import shapely

from chord_usd.base.metrics.clear_floor import blocked_openings
from chord_usd.base.metrics.complete import homely_rooms, is_complete
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS, unit_gaps
from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    front_direction,
    room_polygon,
)
from chord_usd.base.scene.palette import CATEGORIES, Mount
from chord_usd.base.scene.types import Box, Item, Opening, Plan, Room, SceneGraph, frozen_array
from chord_usd.base.scene.units import rotation_2d
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from tests.every import later

AT_A_WALL = frozenset(
    ("cabinet", "bed_background", "bedside_table", "tv_cabinet", "sofa_background",
     "dining_cabinet", "shoe_cabinet", "sink_cabinet", "cooker_cabinet", "refrigerator",
     "single_door_floor_cabinet", "double_door_floor_cabinet", "electrical_floor_cabinet",
     "shower", "toilet", "washbasin", "bathtub", "washing_machine", "washing_set", "leisure_sofa",
     "table")
)  # fmt: skip


def _is_sound(plan: Plan) -> bool:
    return all(room_polygon(room).is_valid for room in plan.rooms)


@pytest.fixture(scope="module", params=[125, *later(500)])
def houses(request: pytest.FixtureRequest) -> list[SceneGraph]:
    rng = np.random.default_rng(20)
    plans = (random_plan(rng) for _ in range(request.param))
    return [furnish(plan, rng) for plan in plans if _is_sound(plan)]


def _by_room(graph: SceneGraph) -> dict[str, list[Item]]:
    found: dict[str, list[Item]] = {room.id: [] for room in graph.rooms}
    for item in graph.items:
        found[item.room_id].append(item)
    return found


def test_no_two_footprints_overlap(houses: list[SceneGraph]) -> None:
    for graph in houses:
        prints = np.array([footprint_polygon(item.box) for item in graph.items])
        if len(prints) < 2:
            continue
        a, b = shapely.STRtree(prints).query(prints, predicate="intersects")
        shared_m2 = shapely.area(shapely.intersection(prints[a], prints[b]))
        assert shared_m2[a != b].max(initial=0.0) < 1e-4


def test_everything_is_inside_its_room(houses: list[SceneGraph]) -> None:
    for graph in houses:
        for room_id, items in _by_room(graph).items():
            floor = room_polygon(graph.plan.room(room_id)).buffer(0.001)
            assert all(floor.covers(footprint_polygon(item.box)) for item in items), room_id


def test_doors_and_windows_are_clear(houses: list[SceneGraph]) -> None:
    assert [blocked for graph in houses for blocked in blocked_openings(graph)] == []


def test_rooms_to_live_in_are_furnished(houses: list[SceneGraph]) -> None:
    needed = {"living": {"sofa", "leisure_sofa"}, "bedroom": {"bed"}, "bathroom": {"toilet"},
              "kitchen": {"sink_cabinet"}, "dining": {"dining_table"},
              "study": {"table"}}  # fmt: skip
    rooms: Counter[str] = Counter()
    furnished: Counter[str] = Counter()
    for graph in houses:
        standing = _by_room(graph)
        for room in graph.rooms:
            rooms[room.kind] += 1
            names = {item.category for item in standing[room.id]}
            furnished[room.kind] += bool(names & needed.get(room.kind, set()))
    for kind in ("living", "bedroom", "bathroom", "kitchen"):
        assert furnished[kind] / rooms[kind] >= 0.99, kind
    for kind in ("dining", "study"):
        assert furnished[kind] / rooms[kind] >= 0.9, kind


def test_sizes_and_heights_are_those_of_the_palette(houses: list[SceneGraph]) -> None:
    for item in (item for graph in houses for item in graph.items):
        row = CATEGORIES[item.category]
        spans = (row.length_m, row.width_m, row.height_m)
        for value, (low, high) in zip(item.box.size_m, spans, strict=True):
            assert low - 1e-6 <= value <= high + 1e-6, item
        assert item.box.center_m[2] == (row.mount_height_m if row.mount is Mount.WALL else 0.0)


def test_backs_are_flush_with_a_wall(houses: list[SceneGraph]) -> None:
    for graph in houses:
        outlines = {room.id: room_polygon(room).exterior for room in graph.rooms}
        for item in graph.items:
            if item.category in AT_A_WALL:
                corners = footprint(item.box)
                ends = shapely.points([corners[0], corners[3]])
                assert shapely.distance(ends, outlines[item.room_id]).max() < 0.02, item


def test_beds_and_sofas_stand_before_their_panel_or_the_wall(houses: list[SceneGraph]) -> None:
    for graph in houses:
        for items in _by_room(graph).values():
            for piece, panel in (("bed", "bed_background"), ("sofa", "sofa_background")):
                panels = [item for item in items if item.category == panel]
                for item in (item for item in items if item.category == piece):
                    back = -front_direction(item.box.yaw_deg) * item.box.size_m[1] / 2
                    x, y = np.array(item.box.center_m[:2]) + back
                    outline = room_polygon(graph.plan.room(item.room_id)).exterior
                    behind = [footprint_polygon(p.box) for p in panels]
                    gaps = [shape.distance(shapely.Point(x, y)) for shape in (outline, *behind)]
                    assert min(gaps) < 0.02, item


def test_chairs_face_the_table_they_touch(houses: list[SceneGraph]) -> None:
    for graph in houses:
        for items in _by_room(graph).values():
            tables = [item for item in items if item.category in ("table", "dining_table")]
            for chair in (item for item in items if item.category == "chair"):
                ahead = front_direction(chair.box.yaw_deg) * (chair.box.size_m[1] / 2 + 0.03)
                seat_edge = shapely.Point(np.array(chair.box.center_m[:2]) + ahead)
                near = min(footprint_polygon(table.box).distance(seat_edge) for table in tables)
                assert near < 0.03, chair


def test_kitchen_runs_have_no_gaps(houses: list[SceneGraph]) -> None:
    """Units along one wall touch, and no run is without sink, cooker and refrigerator."""
    runs = whole = 0
    for graph in houses:
        for room in graph.rooms:
            units = [item for item in graph.items_of(room.id) if item.category in KITCHEN_UNITS]
            if room.kind != "kitchen" or not units:
                continue
            assert not list(unit_gaps(units, room_polygon(room)))
            shapes = [footprint_polygon(i.box).buffer(1e-4, join_style="mitre") for i in units]
            centres = [
                shape for shape, item in zip(shapes, units, strict=True)
                if item.category in ("sink_cabinet", "cooker_cabinet", "refrigerator")
            ]  # fmt: skip
            for block in shapely.get_parts(shapely.unary_union(shapes)):
                runs += 1
                whole += any(block.intersects(shape) for shape in centres)
    assert runs > len(houses) / 3
    assert whole >= 0.98 * runs


def test_ids_are_unique_and_name_room_and_category(houses: list[SceneGraph]) -> None:
    for graph in houses:
        assert len({item.id for item in graph.items}) == len(graph.items)
        for item in graph.items:
            room_id, _, name = item.id.rpartition("/")
            assert room_id == item.room_id
            assert name.rpartition("_")[0] == item.category


def test_same_state_gives_the_same_house_and_another_another() -> None:
    plan = random_plan(np.random.default_rng(4), rooms=9)
    first, again, other = (furnish(plan, np.random.default_rng(seed)) for seed in (5, 5, 6))
    assert [(i.id, i.box) for i in first.items] == [(i.id, i.box) for i in again.items]
    assert [i.box for i in first.items] != [i.box for i in other.items]


def test_unlabelled_plans_are_furnished_as_what_they_look_like() -> None:
    rng = np.random.default_rng(8)
    counts: Counter[str] = Counter()
    houses = 60
    for _ in range(houses):
        plan = random_plan(rng, rooms=9)
        rooms = tuple(replace(room, kind="unknown") for room in plan.rooms)
        openings = tuple(replace(opening, room_ids=()) for opening in plan.openings)
        graph = furnish(Plan(rooms, openings), rng)
        assert all(room.kind == "unknown" for room in graph.rooms)
        counts.update({item.category for item in graph.items})
    for category in ("bed", "toilet", "sofa", "sink_cabinet"):
        assert counts[category] > 0.9 * houses, category


def _room(kind: str, corners: list[tuple[float, float]]) -> Room:
    return Room("r", kind, frozen_array(corners))  # type: ignore[arg-type]


def _opening(kind: str, x: float, y: float, length: float, sill: float = 0.0) -> Opening:
    return Opening("o", kind, Box((x, y, sill), (length, 0.24, 1.4), 0.0), ("r",))  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", ["living", "bedroom", "kitchen", "bathroom", "study", "dining"])
@pytest.mark.parametrize("yaw_deg", [0.0, 17.0, 45.0])
def test_slanted_rooms_are_furnished_along_their_walls(kind: str, yaw_deg: float) -> None:
    corners = np.array([(0, 0), (4.2, 0), (4.2, 3.6), (0, 3.6)]) @ rotation_2d(yaw_deg).T
    graph = furnish(Plan((_room(kind, corners.tolist()),), ()), np.random.default_rng(2))
    assert graph.items
    for item in graph.items:
        off_deg = (item.box.yaw_deg - yaw_deg) % 90.0
        assert min(off_deg, 90.0 - off_deg) < 1e-6


@pytest.mark.parametrize("kind", ["living", "bedroom", "kitchen", "bathroom", "balcony", "store"])
def test_tiny_rooms_are_left_empty_rather_than_broken(kind: str) -> None:
    room = _room(kind, [(0, 0), (0.5, 0), (0.5, 0.5), (0, 0.5)])
    door = _opening("door", 0.25, -0.12, 0.4)
    graph = furnish(Plan((room,), (door,)), np.random.default_rng(0))
    assert graph.items == ()


def test_nothing_tall_stands_before_a_low_window() -> None:
    """A wall that is all window down to the floor takes no furniture within half a metre."""
    room = _room("bedroom", [(0, 0), (4, 0), (4, 3.5), (0, 3.5)])
    window = _opening("window", 2.0, -0.12, 4.0, sill=0.0)
    for seed in range(20):
        graph = furnish(Plan((room,), (window,)), np.random.default_rng(seed))
        assert graph.items
        assert min(footprint(item.box)[:, 1].min() for item in graph.items) > 0.49


def test_homes_are_complete_and_everything_stands_rightly(houses: list[SceneGraph]) -> None:
    judged = [[room for room in homely_rooms(graph) if room.is_judged] for graph in houses]
    rooms = [room for house in judged for room in house]
    assert sum(room.complete for room in rooms) >= 0.99 * len(rooms)
    assert sum(room.right for room in rooms) >= 0.99 * len(rooms)
    assert sum(map(is_complete, judged)) >= 0.95 * len(judged)


def test_homes_hold_what_households_have(houses: list[SceneGraph]) -> None:
    """Shares are those of mix.HOMES, less what does not fit."""
    with_kitchen = [graph for graph in houses if any(r.kind == "kitchen" for r in graph.rooms)]
    assert _share_with(with_kitchen, {"refrigerator"}) >= 0.9
    assert _share_with(houses, {"washing_machine", "washing_set"}) >= 0.85
    bedrooms = [
        {item.category for item in graph.items_of(room.id)}
        for graph in houses
        for room in graph.rooms
        if room.kind == "bedroom" and room_polygon(room).area >= 8.0
    ]
    for category, share in (("bedside_table", 0.75), ("cabinet", 0.85), ("table", 0.3)):
        assert sum(category in names for names in bedrooms) >= share * len(bedrooms), category


def _share_with(houses: list[SceneGraph], any_of: set[str]) -> float:
    held = [any(item.category in any_of for item in graph.items) for graph in houses]
    return sum(held) / len(held)


def test_the_papers_mix_is_sparser_and_needs_no_less() -> None:
    counts = {}
    for statistics in ("homes", "paper"):
        graphs = []
        for seed in range(40):
            rng = np.random.default_rng(seed)
            graphs.append(furnish(random_plan(rng), rng, statistics))
        counts[statistics] = sum(len(graph.items) for graph in graphs)
        lacking = [room for graph in graphs for room in homely_rooms(graph) if room.missing]
        assert len(lacking) <= 2
    assert counts["paper"] < 0.9 * counts["homes"]


@pytest.mark.parametrize("kind", ["living", "bedroom", "kitchen", "bathroom", "dining", "study"])
def test_rooms_no_larger_than_they_must_be_hold_what_they_need(kind: str) -> None:
    """And what does not fit goes by priority."""
    sides = {"living": (2.6, 3.2), "bedroom": (2.1, 3.0), "kitchen": (1.9, 2.3),
             "bathroom": (1.6, 1.9), "dining": (2.2, 2.8), "study": (1.9, 2.0)}[kind]  # fmt: skip
    x, y = sides
    room = _room(kind, [(0, 0), (x, 0), (x, y), (0, y)])
    door = _opening("door", 0.5, -0.12, 0.7)
    for seed in range(8):
        graph = furnish(Plan((room,), (door,)), np.random.default_rng(seed))
        assert homely_rooms(graph)[0].right, seed
        assert blocked_openings(graph) == []


def test_fixtures_of_a_drawing_are_kept_and_what_is_missing_is_added() -> None:
    room = _room("bathroom", [(0, 0), (2.4, 0), (2.4, 2.2), (0, 2.2)])
    door = _opening("door", 0.6, -0.12, 0.7)
    tub = {"category": "bathtub", "x": 2.0, "y": 1.7, "w": 0.7, "h": 1.4}
    plan = Plan((room,), (door,), extra={"fixtures": [tub]})
    graph = furnish(plan, np.random.default_rng(1))
    names = {item.category for item in graph.items}
    assert {"bathtub", "toilet", "washbasin"} <= names
