"""Drawings of others: every pixel format, doors with arcs, windows with panes, photographs."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image
from plan_symbols import SYMBOLS_M_PER_PX, draw_symbols

from chord_usd.base.scene.chord_json import write_plan
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Plan
from chord_usd.base.scene.units import px_from_m
from chord_usd.line.plan.overlay import overlay_on
from chord_usd.line.plan.placement import frame_of
from chord_usd.line.plan.read import read_plan_file
from chord_usd.workshop.data.houses import random_plan

PLAN = random_plan(np.random.default_rng(5), rooms=5)


def areas_m2(plan: Plan) -> list[float]:
    return sorted(room_polygon(room).area for room in plan.rooms)


# Pixel formats -----------------------------------------------------------------------------------


def as_alpha(rgb: np.ndarray) -> Image.Image:
    """White becomes transparent, over a misleading black."""
    white = (rgb == 255).all(axis=2)
    rgba = np.dstack([np.where(white[:, :, None], 0, rgb), np.where(white, 0, 255)])
    return Image.fromarray(rgba.astype(np.uint8), "RGBA")


def as_16_bit(rgb: np.ndarray) -> Image.Image:
    return Image.fromarray(rgb.mean(axis=2).astype(np.uint16) * 257)


def as_12_bit(rgb: np.ndarray) -> Image.Image:
    return Image.fromarray(rgb.mean(axis=2).astype(np.uint16) * 16)


FORMATS: dict[str, Callable[[np.ndarray], Image.Image]] = {
    "alpha": as_alpha,
    "16 bit": as_16_bit,
    "12 bit": as_12_bit,
    "grey": lambda rgb: Image.fromarray(rgb).convert("L"),
    "grey with alpha": lambda rgb: as_alpha(rgb).convert("LA"),
    "palette": lambda rgb: Image.fromarray(rgb).convert("P", palette=Image.Palette.ADAPTIVE),
    "black and white": lambda rgb: Image.fromarray(rgb).convert("1", dither=Image.Dither.NONE),
}


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Plan:
    """What is read of the drawing as it is."""
    path = tmp_path_factory.mktemp("plain") / "plan.png"
    Image.fromarray(draw_symbols(PLAN)).save(path)
    return read_plan_file(path, scale=SYMBOLS_M_PER_PX)


@pytest.mark.parametrize("name", FORMATS)
def test_every_pixel_format_is_read_alike(name: str, plain: Plan, tmp_path: Path) -> None:
    FORMATS[name](draw_symbols(PLAN)).save(tmp_path / "plan.png")
    plan = read_plan_file(tmp_path / "plan.png", scale=SYMBOLS_M_PER_PX)
    assert len(plan.rooms) == len(plain.rooms)
    assert areas_m2(plan) == pytest.approx(areas_m2(plain), rel=0.05)


# Drawings ----------------------------------------------------------------------------------------


def test_rooms_of_a_drawing_are_those_drawn(plain: Plan) -> None:
    assert len(plain.rooms) == len(PLAN.rooms)
    assert sum(areas_m2(plain)) == pytest.approx(sum(areas_m2(PLAN)), rel=0.1)


def test_a_photographed_drawing_is_read(plain: Plan, tmp_path: Path) -> None:
    drawing = draw_symbols(PLAN).astype(np.float64)
    rows, columns = np.mgrid[0 : drawing.shape[0], 0 : drawing.shape[1]]
    light = 0.55 + 0.35 * (rows + columns) / (rows + columns).max()
    noise = np.random.default_rng(0).normal(0, 4, drawing.shape)
    photo = np.clip((drawing * 0.8 + 40) * light[:, :, None] + noise, 0, 255).astype(np.uint8)
    Image.fromarray(cv2.GaussianBlur(photo, (3, 3), 0)).save(tmp_path / "photo.jpg", quality=80)
    plan = read_plan_file(tmp_path / "photo.jpg", scale=SYMBOLS_M_PER_PX)
    assert abs(len(plan.rooms) - len(plain.rooms)) <= 1
    assert sum(areas_m2(plan)) == pytest.approx(sum(areas_m2(plain)), rel=0.15)


def test_a_plan_without_doors_is_read_with_a_warning(tmp_path: Path) -> None:
    Image.fromarray(draw_symbols(Plan(PLAN.rooms, ()))).save(tmp_path / "bare.png")
    plan = read_plan_file(tmp_path / "bare.png", scale=SYMBOLS_M_PER_PX)
    added = [warning for warning in plan.extra["warnings"] if "became" in warning]
    assert len(plan.rooms) - len(added) == len(PLAN.rooms)
    assert any("door" in warning for warning in plan.extra["warnings"])
    write_plan(PLAN, tmp_path / "with_doors.json")
    assert "warnings" not in read_plan_file(tmp_path / "with_doors.json").extra


# The overlay -------------------------------------------------------------------------------------


def test_the_overlay_lies_on_what_was_read(plain: Plan, tmp_path: Path) -> None:
    """Every room is outlined in a colour where it was read."""
    drawing = draw_symbols(PLAN)
    Image.fromarray(drawing).save(tmp_path / "drawing.png")
    picture = overlay_on(plain, tmp_path / "drawing.png").astype(int)
    assert picture.shape == drawing.shape
    frame = frame_of(plain)
    assert frame is not None
    colored = np.ptp(picture, axis=2) > 90
    near = np.zeros(drawing.shape[:2], np.uint8)
    for room in plain.rooms:
        corners = np.rint(px_from_m(room.polygon_m, frame)).astype(np.int32)
        cv2.polylines(near, [corners], True, (1,), 9)
        assert (colored & (near > 0)).any()
