"""What was read can be seen, and put right by hand."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image, ImageDraw

from chord_usd.base.errors import ChordError
from chord_usd.base.raster import lettering
from chord_usd.base.raster.lettering import text_size, write_text
from chord_usd.base.raster.raster_files import write_raster
from chord_usd.base.scene.chord_json import write_plan
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Plan
from chord_usd.cli import main
from chord_usd.line.pipeline import draw_plan
from chord_usd.line.plan.corrections import read_rooms, with_rooms
from chord_usd.line.plan.overlay import overlay, with_doubts
from chord_usd.line.plan.placement import WARNINGS
from chord_usd.line.plan.read import read_plan_file
from chord_usd.workshop.data.houses import random_plan

PLAN = random_plan(np.random.default_rng(3), rooms=5)


@pytest.fixture
def drawn(tmp_path: Path) -> Path:
    write_raster(draw_plan(PLAN), tmp_path / "plan.png")
    return tmp_path / "plan.png"


# Corrections -------------------------------------------------------------------------------------


def test_rooms_take_the_kinds_that_are_said_and_nothing_else_changes() -> None:
    last = PLAN.rooms[-1].id
    plan = with_rooms(PLAN, read_rooms(f"1: bathroom; {last}：主卧, 2 = unknown"))
    assert [plan.rooms[i].kind for i in (0, 1, -1)] == ["bathroom", "unknown", "bedroom"]
    assert plan.rooms[-1].name == "主卧"
    assert plan.rooms[2:-1] == PLAN.rooms[2:-1]
    assert [room.id for room in plan.rooms] == [room.id for room in PLAN.rooms]
    assert plan.openings == PLAN.openings


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ("99: bedroom", "there is no room 99; expected 1 to 5, or an id such as"),
        ("0: bedroom", "there is no room 0"),
        ("attic: bedroom", "there is no room attic"),
        ("1: xqzvw", "'xqzvw' is no kind of room; expected one of living"),
        ("1: bedroom, 1: study", "room 1 is named twice"),
        ("1 bedroom", "'1 bedroom' is not ROOM: KIND"),
        ("1:", "is not ROOM: KIND"),
        (" , ", "is empty"),
        ("1" * 5000 + ": bedroom", "characters"),
    ],
)
def test_what_names_no_room_or_kind_is_told(
    said: str, told: str, drawn: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = drawn.parent / "plan.json"
    assert main(["plan", "read", str(drawn), "-o", str(output), "--rooms", said]) == 2
    error = capsys.readouterr().err.strip()
    assert told in error
    assert "\n" not in error
    assert not output.exists()


def test_one_room_cannot_be_said_by_number_and_by_id() -> None:
    with pytest.raises(ChordError, match="are the same room"):
        with_rooms(PLAN, read_rooms(f"1: bedroom, {PLAN.rooms[0].id}: study"))


def test_a_plan_put_right_goes_on_from_its_json(drawn: Path, tmp_path: Path) -> None:
    first, second = tmp_path / "first.json", tmp_path / "second.json"
    assert main(["plan", "read", str(drawn), "-o", str(first), "--rooms", "1: study"]) == 0
    plan = read_plan_file(first)
    assert plan.rooms[0].kind == "study"
    # By hand, in the file.
    moved = replace(plan.rooms[1], kind="store", name="")
    write_plan(replace(plan, rooms=(plan.rooms[0], moved, *plan.rooms[2:])), first)
    assert main(["plan", "read", str(first), "-o", str(second), "--rooms", "3: balcony"]) == 0
    assert [room.kind for room in read_plan_file(second).rooms[:3]] == ["study", "store", "balcony"]


# The overlay -------------------------------------------------------------------------------------


def test_the_overlay_marks_and_tells_what_is_doubted(drawn: Path) -> None:
    plan = read_plan_file(drawn)
    sure = Plan(plan.rooms, plan.openings, {k: v for k, v in plan.extra.items() if k != WARNINGS})
    doubt = f"the outlines of {plan.rooms[0].id} are uncertain: " + "look at them well, " * 20
    unsure = replace(sure, extra={**sure.extra, WARNINGS: [doubt]})
    rgb = np.full((*cv2.imread(str(drawn)).shape[:2], 3), 255, np.uint8)

    assert red(overlay(unsure, rgb)) > 5 * red(overlay(sure, rgb)) + 20
    told = with_doubts(overlay(unsure, rgb), [doubt])
    assert told.shape[0] > rgb.shape[0]
    assert told.shape[1] == rgb.shape[1]
    assert red(told[rgb.shape[0] :]) > 100
    # The doubt is broken into lines that fit.
    assert red(told[rgb.shape[0] :, -3:]) == 0


def red(picture: np.ndarray) -> int:  # type: ignore[type-arg]
    levels = picture.astype(int)
    return int(((levels[..., 0] - levels[..., 1] > 120) & (levels[..., 2] < 120)).sum())


# Letters -----------------------------------------------------------------------------------------


def written(text: str) -> np.ndarray:  # type: ignore[type-arg]
    picture = Image.new("RGB", (400, 60), (255, 255, 255))
    write_text(ImageDraw.Draw(picture), (10, 30), text, 24, anchor="lm")
    return np.asarray(picture)


def test_every_script_is_written_and_no_two_letters_alike() -> None:
    letters = "EÉOÖUÜŁØßя居リ한卧חжק¹²½"
    pictures = [written(letter).tobytes() for letter in letters]
    assert len(set(pictures)) == len(letters)
    assert all(text_size(letter, 24)[0] > 3 for letter in letters)


def test_what_no_font_has_is_left_out_and_never_a_box() -> None:
    assert np.array_equal(written("a\ue123b\U0001f9ff"), written("ab"))


def test_hebrew_runs_from_the_right_and_its_numbers_do_not() -> None:
    assert lettering._from_left("חדר 12 (3.5)") == "(3.5) 12 רדח"
    assert lettering._from_left("Room חדר 2") == "Room רדח 2"
    assert lettering._from_left("Küche 2 (12 m²)") == "Küche 2 (12 m²)"


def test_a_floor_is_parted_by_what_it_is_said_to_be():
    largest = max(PLAN.rooms, key=lambda room: room_polygon(room).area)
    plan = with_rooms(PLAN, read_rooms(f"{largest.id}: living / kitchen"))
    assert len(plan.rooms) == len(PLAN.rooms) + 1
    kinds = {one.kind for one in plan.rooms if one.id not in {r.id for r in PLAN.rooms}}
    assert kinds <= {"living", "kitchen"}
    smallest = min(PLAN.rooms, key=lambda room: room_polygon(room).area)
    with pytest.raises(ChordError, match="has no room for"):
        with_rooms(PLAN, read_rooms(f"{smallest.id}: living + kitchen + dining + study + bedroom"))


def test_a_kitchen_that_only_a_name_tells_is_a_warning_or_a_part(tmp_path: Path) -> None:
    """JSON stays as it is, and says how to part it; walls with labels are parted."""
    box = [[0, 0], [700, 0], [700, 500], [0, 500]]
    room = {"roomId": "a", "roomName": "Living Room / Kitchen", "roomType": 1, "wallPoints": box}
    door = {"type": "Door", "pos": [350, -12, 0], "length": 90, "width": 24, "height": 210,
            "rotate": 0}  # fmt: skip
    file = tmp_path / "plan.json"
    file.write_text(json.dumps({"rooms": [room], "windowsDoors": [door], "furniture": []}))
    (told,) = [one for one in read_plan_file(file).extra["warnings"] if "kitchen" in one]
    rooms = told.split('"')[1]
    kinds = {one.kind for one in with_rooms(read_plan_file(file), read_rooms(rooms)).rooms}
    assert kinds == {"living", "kitchen"}
    drawing = tmp_path / "plan.svg"
    drawing.write_text(
        '<svg width="7m" viewBox="0 0 700 500"><rect id="room-1" width="700" height="500" '
        'data-name="Living Room / Kitchen"/><rect id="door-1" x="300" y="490" width="90" '
        'height="20"/></svg>'
    )
    assert {one.kind for one in read_plan_file(drawing).rooms} == {"living", "kitchen"}
