"""Pieces that a drawing shows: kept in the plan, and placed in its rooms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chord_usd.base.scene.chord_json import plan_from_json, plan_to_json
from chord_usd.base.scene.drawn_pieces import DRAWN, drawn_items, to_entry
from chord_usd.base.scene.geometry import footprint_polygon, room_polygon
from chord_usd.base.scene.piece_names import piece_named
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.trim import CASING_M
from chord_usd.base.scene.types import Box, Item, Opening, Plan, Room, frozen_array
from chord_usd.line.pipeline.as_drawn import placed_pieces

SQUARE = frozen_array(np.array([(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]))
DOOR = Opening("door1", "door", Box((3.4, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("room1",))


def plan(kind: str, *items: Item) -> Plan:
    room = Room("room1", kind, SQUARE)  # type: ignore[arg-type]
    return Plan((room,), (DOOR,), {DRAWN: to_entry(items)})


def piece(
    name: str, x: float, y: float, size: tuple[float, float], yaw: float, score: float = 0.9
) -> Item:
    return Item("", name, Box((x, y, 0.0), (*size, 0.5), yaw), score=score)


def test_a_piece_stands_square_with_its_back_on_the_wall() -> None:
    """Drawn 12 cm off the wall and 5 degrees askew, as a network sees it."""
    (one,) = placed_pieces(plan("bathroom", piece("bathtub", 2.0, 2.5, (1.7, 0.75), 5.0)))
    assert one.item is not None
    assert one.item.facts.locked
    assert one.item.box.yaw_deg == pytest.approx(0.0)
    assert one.item.box.center_m[1] + one.item.box.size_m[1] / 2 == pytest.approx(3.0)


def test_a_back_is_put_on_the_wall_that_it_faces() -> None:
    """Not on the wall before its front, which may be nearer."""
    for yaw, axis, wall in ((0.0, 1, 3.0), (90.0, 0, 0.0), (180.0, 1, 0.0), (-90.0, 0, 4.0)):
        turn = np.radians(yaw)
        back = np.array([-np.sin(turn), np.cos(turn)])
        middle = np.array([2.0, 1.5]) + back * ((2.0, 1.5)[axis] - 0.65 / 2 - 0.1)
        (one,) = placed_pieces(plan("bathroom", piece("toilet", *middle, (0.4, 0.65), yaw)))
        assert one.item is not None
        far = np.array(one.item.box.center_m[:2]) + back * one.item.box.size_m[1] / 2
        assert far[axis] == pytest.approx(wall)


@pytest.mark.parametrize(("name", "turn"), [("toilet", 0.0), ("single_sofa", 38.0)])
def test_plumbing_is_never_oblique_and_armchairs_may_be(name: str, turn: float) -> None:
    (one,) = placed_pieces(
        plan("bathroom" if turn == 0 else "living", piece(name, 2.0, 1.5, (0.4, 0.65), 38.0))
    )
    assert one.item is not None
    assert one.item.box.yaw_deg % 90.0 == pytest.approx(turn)


def test_a_piece_beside_a_door_keeps_off_its_casing() -> None:
    """Its lid would not open."""
    drawn = piece("toilet", 2.72, 0.33, (0.4, 0.65), 180.0)
    (one,) = placed_pieces(plan("bathroom", drawn))
    assert one.item is not None
    right = one.item.box.center_m[0] + one.item.box.size_m[0] / 2
    assert 2.6 < right <= DOOR.box.center_m[0] - DOOR.box.size_m[0] / 2 - CASING_M[0] + 1e-6


def test_sizes_are_those_of_the_category() -> None:
    (one,) = placed_pieces(plan("bathroom", piece("toilet", 2.0, 2.7, (0.2, 1.1), 0.0)))
    assert one.item is not None
    assert one.item.box.size_m[0] == pytest.approx(0.36)
    assert one.item.box.size_m[1] == pytest.approx(0.78)


@pytest.mark.parametrize(
    ("kind", "drawn", "reason"),
    [
        ("bathroom", piece("toilet", 9.0, 1.0, (0.4, 0.65), 0.0), "in no room"),
        ("bedroom", piece("bathtub", 2.0, 2.6, (1.7, 0.75), 0.0), "in a bedroom"),
        ("bathroom", piece("bathtub", 3.2, 0.4, (1.7, 0.75), 180.0), "before an opening"),
    ],
)
def test_what_cannot_stand_is_left_out_with_the_reason(kind: str, drawn: Item, reason: str) -> None:
    (one,) = placed_pieces(plan(kind, drawn))
    assert one.item is None
    assert one.reason == reason


@pytest.mark.parametrize(("name", "size", "stands"), [
    ("bed", (1.4, 2.0), True), ("single_sofa", (0.8, 0.8), False),
])  # fmt: skip
def test_a_piece_is_moved_by_a_quarter_of_its_size(name: str, size: tuple, stands: bool) -> None:
    """A studio's bed was drawn near the door of its balcony, and left out."""
    left = DOOR.box.center_m[0] - DOOR.box.size_m[0] / 2 + 0.33 - size[0] / 2
    room = replace(plan("bedroom" if stands else "living").rooms[0])
    drawn = piece(name, left, 0.1 + size[1] / 2, size, 180.0)
    (one,) = placed_pieces(Plan((room,), (DOOR,), {DRAWN: to_entry([drawn])}))
    assert (one.item is not None) is stands


def test_of_two_in_one_place_the_surer_one_stays_and_the_other_moves_or_goes() -> None:
    near = piece("toilet", 1.0, 2.65, (0.4, 0.65), 0.0, 0.5)
    tub = piece("bathtub", 1.95, 2.6, (1.7, 0.75), 0.0, 0.9)
    same = piece("shower", 1.95, 2.6, (0.9, 0.9), 0.0, 0.4)
    first, second, third = placed_pieces(plan("bathroom", near, same, tub))
    assert first.item is not None
    assert first.item.category == "bathtub"
    assert second.item is not None
    shapes = [footprint_polygon(one.item.box) for one in (first, second) if one.item]
    assert shapes[0].intersection(shapes[1]).area < 1e-3
    assert room_polygon(Room("", "bathroom", SQUARE)).buffer(1e-6).covers(shapes[1])
    assert third.item is None
    assert third.reason == "in another piece"


def test_a_bathroom_has_one_toilet_the_surest() -> None:
    """A bidet or a basin that was taken for a second toilet was built as one."""
    toilets = [piece("toilet", x, 2.65, (0.4, 0.65), 0.0, x / 3) for x in (0.6, 2.6)]
    first, second = placed_pieces(plan("bathroom", *toilets))
    assert first.item is not None
    assert first.drawn.box.center_m[0] == pytest.approx(2.6)
    assert (second.item, second.reason) == (None, "a second one in its room")


def test_a_plan_keeps_them_in_its_file_and_when_it_is_moved() -> None:
    before = plan("bathroom", piece("toilet", 2.0, 2.6, (0.4, 0.65), 30.0))
    again = plan_from_json(plan_to_json(before))
    assert again.extra[DRAWN] == before.extra[DRAWN]
    (moved,) = drawn_items(posed(before, Pose(yaw_deg=90.0, offset_m=(1.0, 0.0))).extra)
    assert moved.box.center_m[:2] == pytest.approx((-1.6, 2.0))
    assert moved.box.yaw_deg == pytest.approx(120.0)


def test_what_is_no_piece_is_passed_over() -> None:
    good = to_entry([piece("bed", 1.0, 1.0, (1.6, 2.0), 0.0)])
    broken = [{}, {**good[0], "type": "throne"}, {**good[0], "length": -5}, {**good[0], "pos": "x"}]
    found = drawn_items(replace(plan("bedroom"), extra={DRAWN: [*broken, *good]}).extra)
    assert [item.category for item in found] == ["bed"]


def test_a_bed_below_a_sill_stands_before_the_window() -> None:
    before = plan("bedroom", piece("bed", 1.0, 1.9, (1.6, 2.0), 0.0))
    window = Opening("w", "window", Box((1.0, 3.12, 0.9), (1.2, 0.24, 1.2), 0.0), ("room1",))
    (one,) = placed_pieces(replace(before, openings=(*before.openings, window)))
    assert one.item is not None
    assert one.item.box.size_m[2] <= 0.9
    low = replace(window, box=replace(window.box, center_m=(1.0, 3.12, 0.3)))
    (other,) = placed_pieces(replace(before, openings=(low,)))
    assert other.reason == "before an opening"


def test_a_room_tells_what_a_drawing_shows_alike() -> None:
    """A basin in a kitchen is its sink, around which units are composed."""
    (one,) = placed_pieces(plan("kitchen", piece("washbasin", 1.0, 2.8, (0.6, 0.45), 0.0)))
    assert one.item is not None
    assert one.item.category == "sink_cabinet"
    (other,) = placed_pieces(
        plan("kitchen", piece("electrical_floor_cabinet", 1, 2.7, (0.6, 0.6), 0))
    )
    assert other.reason == "a part of the composed kitchen"


@pytest.mark.parametrize(
    ("name", "category"),
    [
        ("eTeks#bed140x190", "bed"),
        ("eTeks#toiletUnit", "toilet"),
        ("Badewanne 2", "bathtub"),
        ("Duschkabine", "shower"),
        ("Kitchen table", "dining_table"),
        ("chests of drawers", "cabinet"),
        ("Lampe", None),
        ("", None),
    ],
)
def test_names_of_pieces_in_other_files(name: str, category: str | None) -> None:
    assert piece_named(name) == category
