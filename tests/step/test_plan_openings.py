"""Openings from corner to corner, charts of coloured bars, and several plans on one sheet."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image
from plan_symbols import draw_storeys

from chord_usd.cli import main
from chord_usd.data.drawn.draw import draw_in_style
from chord_usd.data.drawn.styles import random_style
from chord_usd.data.houses import random_plan
from chord_usd.errors import PlanError
from chord_usd.plan import drawing as drawings
from chord_usd.plan.drawing import read_drawing
from chord_usd.plan.placement import WARNINGS
from chord_usd.types import ByteArray, Plan

THICK_PX = 14
YELLOW, PINK, GREEN, DARK = (250, 215, 40), (230, 140, 195), (166, 216, 84), (50, 50, 50)

pytestmark = pytest.mark.usefixtures("unlettered")


@pytest.fixture
def unlettered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reading without OCR, which other tests are about, and which takes a second."""
    monkeypatch.setattr(drawings, "read_texts", lambda _: ())


def box(page: ByteArray, left: int, top: int, right: int, bottom: int, *rgb: int) -> None:
    """A filled bar with a dark outline, as charts of flats have them."""
    cv2.rectangle(page, (left, top), (right - 1, bottom - 1), rgb, -1)
    cv2.rectangle(page, (left, top), (right - 1, bottom - 1), DARK, 1)


def chart(
    door: tuple[int, ...] | None = PINK, bedroom: tuple[int, ...] = (225, 235, 245)
) -> ByteArray:
    """A corridor whose end, from wall to wall, is the door of a bedroom; a bath beside it."""
    page = np.full((560, 900, 3), 255, np.uint8)
    box(page, 60, 60, 840, 500, *YELLOW)
    box(page, 60 + THICK_PX, 74, 500, 200, 240, 240, 225)
    box(page, 514, 74, 826, 486, *bedroom)
    box(page, 74, 214, 500, 486, 205, 235, 240)
    if door:
        box(page, 500, 74, 514, 200, *door)
    box(page, 200, 200, 280, 214, *PINK)
    box(page, 60, 100, 74, 170, *PINK)
    for top in (200, 340):
        box(page, 826, top, 840, top + 90, *GREEN)
    box(page, 200, 486, 300, 500, *GREEN)
    return page


def kinds(plan: Plan) -> list[str]:
    return sorted(opening.kind for opening in plan.openings)


def test_a_door_from_corner_to_corner_parts_two_rooms() -> None:
    plan = read_drawing(chart())
    assert len(plan.rooms) == 3
    joined = [opening for opening in plan.openings if len(opening.room_ids) == 2]
    assert [opening.kind for opening in joined] == ["door", "door"]
    assert max(opening.box.size_m[0] for opening in joined) > 1.2 * joined[0].box.size_m[1]


def test_an_entrance_in_the_colour_of_doors_is_no_window() -> None:
    assert kinds(read_drawing(chart())) == ["door"] * 3 + ["window"] * 3


def test_the_one_bar_of_its_colour_is_an_entrance_and_said_to_be_uncertain() -> None:
    page = chart()
    box(page, 700, 60, 770, 60 + THICK_PX, 165, 55, 10)
    plan = read_drawing(page)
    assert kinds(plan) == ["door"] * 4 + ["window"] * 3
    assert any("uncertain what door" in warning for warning in plan.extra[WARNINGS])


def test_paper_that_shows_in_openings_is_no_colour_of_theirs() -> None:
    """Doors and windows in white on blue are both filled with blue."""
    rng = np.random.default_rng(6)
    style = replace(random_style(rng, "blueprint"), has_names=False, sizes="none")
    drawing = draw_in_style(random_plan(rng, rooms=4), style, rng)
    assert kinds(read_drawing(drawing.rgb, drawing.frame.m_per_px)) == kinds(drawing.truth)


def test_tiles_in_line_with_a_wall_are_no_door() -> None:
    page = chart(door=None)
    page[75:199, 500:514] = page[100, 300]
    for column in range(88, 826, 14):
        page[74:200, column] = DARK
    plan = read_drawing(page)
    assert len(plan.rooms) <= 2
    assert not any(o.kind == "door" and len(o.room_ids) == 2 and o.box.size_m[0] > 1.6
                   for o in plan.openings)  # fmt: skip


def test_rooms_of_two_colours_are_told() -> None:
    """The door is missing: corridor and bedroom are read as one room."""
    page = chart(door=None, bedroom=(140, 190, 160))
    page[75:199, 499:508] = (240, 240, 225)
    page[75:199, 508:516] = (140, 190, 160)
    warnings = read_drawing(page).extra[WARNINGS]
    assert any("several colours" in warning for warning in warnings)
    assert not any("several colours" in w for w in read_drawing(chart()).extra.get(WARNINGS, ()))


def test_walls_along_the_edge_of_the_picture_are_not_cut_off() -> None:
    close = chart()[52:508, 52:848]
    assert not any("cut off" in warning for warning in read_drawing(close).extra.get(WARNINGS, ()))


# Several plans on one sheet ----------------------------------------------------------------------


@pytest.mark.parametrize(("part", "rooms", "told"), [(1, 3, "the largest"), (2, 2, "number 2")])
def test_a_part_of_a_sheet_is_read_and_told(
    part: int, rooms: int, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Image.fromarray(draw_storeys()).save(tmp_path / "sheet.png")
    out = tmp_path / "plan.json"
    words = ["plan", "read", str(tmp_path / "sheet.png"), "-o", str(out), "--part", str(part)]
    assert main([*words, "--json"]) == 0
    report = json.loads(capsys.readouterr().out)
    assert any("2 plans" in w and told in w and "--part" in w for w in report["warnings"])
    assert report["rooms"] == rooms
    assert len(json.loads(out.read_text())["rooms"]) == rooms


def test_a_part_that_is_not_there_is_refused() -> None:
    with pytest.raises(PlanError, match="part 3 was asked for, but the sheet shows 2") as caught:
        read_drawing(draw_storeys(), part=3)
    assert "1 to 2" in str(caught.value)
