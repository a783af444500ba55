"""Real flats: what a traced drawing says is what the plan holds."""

import gzip
import json
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from shapely.geometry import box as rectangle

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import footprint_polygon, room_polygon, wall_area
from chord_usd.base.scene.types import WALL_THICKNESS_M, Box, Opening, Plan
from chord_usd.workshop.data.flats import (
    flat_from_lines,
    furnishable,
    read_flats,
    read_flats_or_why,
)
from chord_usd.workshop.data.floorplans.traced import closed_cells
from chord_usd.workshop.data.splits import part_of
from tests.foreign_records import flat_lines, line


@pytest.fixture(scope="module")
def plan() -> Plan:
    return flat_from_lines("ab/cd/0001", flat_lines())


def _kinds(plan: Plan) -> list[str]:
    return sorted(room.kind for room in plan.rooms)


def test_kinds_come_from_labels_and_the_kitchen_is_opened_up(plan):
    assert _kinds(plan) == ["balcony", "bathroom", "bedroom", "corridor", "kitchen", "living"]
    kitchen, living = (
        room_polygon(next(room for room in plan.rooms if room.kind == kind))
        for kind in ("kitchen", "living")
    )
    assert kitchen.intersection(living).length > 2.0
    assert kitchen.intersection(living).area < 1e-9


def test_doors_give_the_scale(plan):
    bedroom = next(room for room in plan.rooms if room.kind == "bedroom")
    inner_m2 = (4.0 - WALL_THICKNESS_M) * (4.5 - WALL_THICKNESS_M)
    assert room_polygon(bedroom).area == pytest.approx(inner_m2, rel=0.1)


def test_walls_are_one_thickness_everywhere(plan):
    for one, other in combinations(plan.rooms, 2):
        gap_m = room_polygon(one).distance(room_polygon(other))
        assert gap_m > WALL_THICKNESS_M - 1e-6 or {one.kind, other.kind} == {"kitchen", "living"}
    walls = wall_area(plan.rooms).buffer(1e-6)
    for opening in plan.openings:
        assert walls.covers(footprint_polygon(opening.box))
    assert wall_area(plan.rooms).area > 8.0


@pytest.mark.parametrize("off_m", [-0.125, -0.05, 0.05, 0.125])
def test_openings_lie_in_walls_also_where_they_are_drawn_beside_them(off_m):
    window, door = line(1, 6.5, 3, 6.5, "door"), line(7.6, 2, 8.4, 2, "door")
    moved = [
        line(1, 6.5 + off_m, 3, 6.5 + off_m, "door"),
        line(7.6, 2 + off_m, 8.4, 2 + off_m, "door"),
    ]
    rest = [one for one in flat_lines() if one not in (window, door)]
    plan = flat_from_lines("x", rest + moved)
    walls = wall_area(plan.rooms).buffer(1e-6)
    assert len(plan.openings) == 7
    assert all(walls.covers(footprint_polygon(opening.box)) for opening in plan.openings)


def test_windows_and_doors_are_told_apart(plan):
    kind_of = {room.id: room.kind for room in plan.rooms}
    found = sorted(
        (opening.kind, *sorted(kind_of[room] for room in opening.room_ids))
        for opening in plan.openings
    )
    assert found == [
        ("door", "balcony", "bedroom"),
        ("door", "bathroom", "bedroom"),
        ("door", "bathroom", "corridor"),
        ("door", "bedroom", "living"),
        ("door", "corridor"),
        ("door", "corridor", "kitchen"),
        ("window", "living"),
    ]
    assert not any(opening.extra for opening in plan.openings)


def test_y_points_up(plan):
    balcony, bedroom = (
        room_polygon(next(room for room in plan.rooms if room.kind == kind)).centroid.y
        for kind in ("balcony", "bedroom")
    )
    # Below the bedroom in the drawing, whose y runs down.
    assert balcony < bedroom


def test_fixtures_are_kept_as_hints(plan):
    (counter,) = plan.extra["fixtures"]
    kitchen = next(room for room in plan.rooms if room.kind == "kitchen")
    assert counter["category"] == "cooking_counter"
    x, y, w, h = (counter[key] for key in "xywh")
    assert rectangle(x - w / 2, y - h / 2, x + w / 2, y + h / 2).within(
        room_polygon(kitchen).buffer(0.2)
    )
    assert plan.extra["source"] == "ab/cd/0001"


def test_a_forgotten_door_is_put_in_and_says_so():
    lines = [one for one in flat_lines() if one != line(7, 0.6, 7, 1.4, "door")]
    lines = [one for one in lines if one != line(7.6, 2, 8.4, 2, "door")]
    plan = flat_from_lines("x", lines)
    (inferred,) = (opening for opening in plan.openings if opening.extra.get("inferred"))
    kinds = {plan.room(room).kind for room in inferred.room_ids}
    assert kinds == {"bathroom", "corridor"}


@pytest.mark.parametrize(
    ("without", "reason"),
    [
        ("wall", "no closed room"),
        ("bathroom", "no bathroom, or nowhere to live"),
    ],
)
def test_unsound_drawings_are_refused_with_a_reason(without, reason):
    lines = [line for line in flat_lines() if line[4] != without]
    with pytest.raises(PlanError) as error:
        flat_from_lines("x", lines)
    assert error.value.what == reason


@pytest.mark.parametrize("slip", [-6, -3, -1, 1, 2, 3])
def test_loose_and_crooked_ends_are_closed(slip):
    square = [(0.0, 0.0, 100.0 + slip, 0.0), (100.0, 0.0, 100.0, 100.0), (100.0, 100.0, 0.0, 98.0)]
    (cell,) = closed_cells([*square, (0.0, 100.0, 1.0, 0.0)])
    assert cell.symmetric_difference(rectangle(0, 0, 100, 100)).area < 350
    xs, ys = np.array(cell.simplify(0.01).exterior.coords).T
    assert len(set(xs)) == 2
    assert len(set(ys)) == 2


def test_files_are_read_and_split(tmp_path, plan):
    path = tmp_path / "flats.jsonl.gz"
    records = [{"id": f"flat/{n}", "lines": flat_lines()} for n in range(12)]
    records.append({"id": "broken", "lines": flat_lines()[:3]})
    path.write_bytes(gzip.compress("\n".join(map(json.dumps, records)).encode()))
    assert read_flats_or_why(path)["broken"] == "no closed room"
    flats = read_flats(path)
    assert [flat.extra["source"] for flat in flats] == [f"flat/{n}" for n in range(12)]
    parts = [read_flats(path, part) for part in ("train", "test")]
    assert [len(part) for part in parts] == [
        sum(part_of(f"flat/{n}") == name for n in range(12)) for name in ("train", "test")
    ]


def test_a_plan_with_a_room_of_nothing_but_doors_is_not_furnishable(plan):
    bedroom = next(room for room in plan.rooms if room.kind == "bedroom")
    low, high = bedroom.polygon_m.min(axis=0), bedroom.polygon_m.max(axis=0)
    (x0, y0), (x1, y1) = low, high
    walls = [((x0 + x1) / 2, y, x1 - x0, 0.0) for y in (y0 - 0.12, y1 + 0.12)]
    walls += [(x, (y0 + y1) / 2, y1 - y0, 90.0) for x in (x0 - 0.12, x1 + 0.12)]
    doors = tuple(
        Opening(f"all{i}", "door", Box((x, y, 0.0), (length, 0.24, 2.1), yaw), (bedroom.id,))
        for i, (x, y, length, yaw) in enumerate(walls)
    )
    all_doors = replace(plan, openings=(*plan.openings, *doors))
    assert furnishable([all_doors, plan]) == [plan]


@pytest.mark.parametrize(
    "content",
    [b"", b"not gzip", gzip.compress(b"{]"), gzip.compress(b"[1]")],
    ids=["empty", "not gzip", "not JSON", "not a flat"],
)
def test_what_is_no_file_of_flats_is_refused(tmp_path, content):
    path = tmp_path / "flats.jsonl.gz"
    path.write_bytes(content)
    if not content:
        assert read_flats(path) == []
        return
    with pytest.raises(PlanError, match=r"flats\.jsonl\.gz"):
        read_flats(path)
