"""Drawings of others: every pixel format, doors with arcs, windows with panes, photographs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
import shapely
from PIL import Image
from plan_symbols import SYMBOLS_M_PER_PX, draw_symbols, frame_of_symbols

from chord_usd.chord_json import write_plan
from chord_usd.data.houses import random_plan
from chord_usd.geometry import footprint, polygons_of, room_polygon
from chord_usd.plan.overlay import draw_overlay
from chord_usd.plan.placement import frame_of
from chord_usd.plan.read import read_plan_file
from chord_usd.types import Plan
from chord_usd.units import px_from_m

PLAN = random_plan(np.random.default_rng(5), rooms=5)


def area_m2(plan: Plan) -> float:
    return sum(room_polygon(room).area for room in plan.rooms)


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


@pytest.mark.parametrize("name", FORMATS)
def test_every_pixel_format_is_read(name: str, tmp_path: Path) -> None:
    drawing = draw_symbols(PLAN)
    FORMATS[name](drawing).save(tmp_path / "plan.png")
    plan = read_plan_file(tmp_path / "plan.png", scale=SYMBOLS_M_PER_PX)
    reference = np.sort([room_polygon(room).area for room in PLAN.rooms])
    assert len(plan.rooms) == len(reference)
    np.testing.assert_allclose(
        np.sort([room_polygon(room).area for room in plan.rooms]), reference, rtol=0.1
    )


# Drawings ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("seed", [1, 3, 11, 15, 19, 21])
def test_a_drawing_with_door_arcs_and_window_panes_is_read(seed: int, tmp_path: Path) -> None:
    drawn = random_plan(np.random.default_rng(seed))
    Image.fromarray(draw_symbols(drawn)).save(tmp_path / "drawing.png")
    plan = read_plan_file(tmp_path / "drawing.png", scale=SYMBOLS_M_PER_PX)
    # Rooms that touch are one to whoever sees no shades.
    floor = shapely.union_all([room_polygon(room).buffer(1e-6) for room in drawn.rooms])
    assert len(plan.rooms) == len(polygons_of(floor))
    wanted = Counter(opening.kind for opening in drawn.openings)
    assert Counter(opening.kind for opening in plan.openings) == wanted
    assert area_m2(plan) == pytest.approx(area_m2(drawn), rel=0.03)
    joints = [opening for opening in plan.openings if len(opening.room_ids) == 2]
    assert len(joints) == sum(len(opening.room_ids) == 2 for opening in drawn.openings)


def test_doors_give_a_drawing_its_scale(tmp_path: Path) -> None:
    Image.fromarray(draw_symbols(PLAN)).save(tmp_path / "drawing.png")
    plan = read_plan_file(tmp_path / "drawing.png")
    frame = frame_of(plan)
    assert frame is not None
    assert frame.m_per_px == pytest.approx(SYMBOLS_M_PER_PX, rel=0.2)


def test_a_photographed_drawing_is_read(tmp_path: Path) -> None:
    drawing = draw_symbols(PLAN).astype(np.float64)
    rows, columns = np.mgrid[0 : drawing.shape[0], 0 : drawing.shape[1]]
    light = 0.55 + 0.35 * (rows + columns) / (rows + columns).max()
    noise = np.random.default_rng(0).normal(0, 4, drawing.shape)
    photo = np.clip((drawing * 0.8 + 40) * light[:, :, None] + noise, 0, 255).astype(np.uint8)
    Image.fromarray(cv2.GaussianBlur(photo, (3, 3), 0)).save(tmp_path / "photo.jpg", quality=80)
    plan = read_plan_file(tmp_path / "photo.jpg", scale=SYMBOLS_M_PER_PX)
    assert len(plan.rooms) == len(PLAN.rooms)
    assert area_m2(plan) == pytest.approx(area_m2(PLAN), rel=0.1)


def test_a_plan_without_doors_is_read_with_a_warning(tmp_path: Path) -> None:
    bare = Plan(PLAN.rooms, ())
    Image.fromarray(draw_symbols(bare)).save(tmp_path / "bare.png")
    plan = read_plan_file(tmp_path / "bare.png", scale=SYMBOLS_M_PER_PX)
    assert len(plan.rooms) == len(PLAN.rooms)
    assert plan.openings == ()
    assert "no doors" in plan.extra["warnings"][0]
    assert "warnings" not in read_with_doors(tmp_path).extra


def read_with_doors(folder: Path) -> Plan:
    write_plan(PLAN, folder / "with_doors.json")
    return read_plan_file(folder / "with_doors.json")


# The overlay -------------------------------------------------------------------------------------


def test_the_overlay_lies_on_what_was_read(tmp_path: Path) -> None:
    drawing = draw_symbols(PLAN)
    Image.fromarray(drawing).save(tmp_path / "drawing.png")
    plan = read_plan_file(tmp_path / "drawing.png")
    draw_overlay(plan, tmp_path / "drawing.png", tmp_path / "overlay.png")
    with Image.open(tmp_path / "overlay.png") as written:
        picture = np.asarray(written).astype(int)
    assert picture.shape == drawing.shape
    green = (picture[..., 1] - picture[..., 0] > 60) & (picture[..., 1] > picture[..., 2])
    doors = np.zeros(drawing.shape[:2], np.uint8)
    for opening in PLAN.openings:
        if opening.kind == "door":
            corners = px_from_m(footprint(opening.box), frame_of_symbols(PLAN))
            cv2.fillConvexPoly(doors, np.rint(corners).astype(np.int32), 1)
    near = cv2.dilate(doors, np.ones((15, 15))) > 0
    assert green.sum() > 200
    assert (green & near).sum() == green.sum()
