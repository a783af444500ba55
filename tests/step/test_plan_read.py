"""Plans from any file: JSON, our rasters, drawings of others; or one clear sentence."""

from __future__ import annotations

import json
import struct
import zlib
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from chord_usd.base.errors import PlanError
from chord_usd.base.raster.canvas import draw_plan, layout_image
from chord_usd.base.raster.raster_files import write_raster
from chord_usd.base.scene.chord_json import write_plan
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Box, Item, Plan
from chord_usd.line.plan.overlay import overlay
from chord_usd.line.plan.picture import LARGEST_SIDE_PX
from chord_usd.line.plan.placement import frame_of
from chord_usd.line.plan.read import is_plan_raster, read_plan_file
from chord_usd.workshop.data.houses import random_plan

PLAN = random_plan(np.random.default_rng(5), rooms=5)


def area_m2(plan: Plan) -> float:
    return sum(room_polygon(room).area for room in plan.rooms)


# Our own files -----------------------------------------------------------------------------------


def test_json_is_told_by_its_name_or_its_first_character(tmp_path: Path) -> None:
    for name in ("plan.json", "plan.JSON", "plan.txt"):
        write_plan(PLAN, tmp_path / name)
        plan = read_plan_file(tmp_path / name)
        assert [room.id for room in plan.rooms] == [room.id for room in PLAN.rooms]


def test_a_raster_of_ours_lies_where_it_was_drawn(tmp_path: Path) -> None:
    image = draw_plan(PLAN)
    write_raster(image, tmp_path / "plan.png")
    plan = read_plan_file(tmp_path / "plan.png")
    assert frame_of(plan) == image.frame
    assert area_m2(plan) == pytest.approx(area_m2(PLAN), rel=0.02)
    bounds = np.concatenate([room.polygon_m for room in plan.rooms]).min(axis=0)
    wanted = np.concatenate([room.polygon_m for room in PLAN.rooms]).min(axis=0)
    np.testing.assert_allclose(bounds, wanted, atol=image.frame.m_per_px)


def test_a_raster_without_its_text_takes_its_scale_from_the_walls(tmp_path: Path) -> None:
    Image.fromarray(draw_plan(PLAN).rgb).save(tmp_path / "plan.png")
    plan = read_plan_file(tmp_path / "plan.png")
    assert area_m2(plan) == pytest.approx(area_m2(PLAN), rel=0.25)
    assert {room.kind for room in plan.rooms} == {room.kind for room in PLAN.rooms}
    image = draw_plan(PLAN)
    scaled = read_plan_file(tmp_path / "plan.png", scale=image.frame.m_per_px)
    assert area_m2(scaled) == pytest.approx(area_m2(PLAN), rel=0.02)


def test_a_scale_at_which_doors_are_gates_is_refused(tmp_path: Path) -> None:
    image = draw_plan(random_plan(np.random.default_rng(3)))
    Image.fromarray(np.asarray(image.rgb)).save(tmp_path / "plan.png")
    with pytest.raises(PlanError, match="doors"):
        read_plan_file(tmp_path / "plan.png", scale=8 * image.frame.m_per_px)


def test_a_larger_raster_in_our_colours_is_one_of_ours(tmp_path: Path) -> None:
    rgb = cv2.resize(draw_plan(PLAN).rgb, None, fx=3, fy=3, interpolation=cv2.INTER_NEAREST)
    assert is_plan_raster(rgb)
    Image.fromarray(rgb).save(tmp_path / "plan.png")
    plan = read_plan_file(tmp_path / "plan.png")
    assert len(plan.openings) == len(PLAN.openings)


def test_what_was_read_survives_json(tmp_path: Path) -> None:
    write_raster(draw_plan(PLAN), tmp_path / "plan.png")
    plan = read_plan_file(tmp_path / "plan.png")
    write_plan(plan, tmp_path / "plan.json")
    again = read_plan_file(tmp_path / "plan.json")
    assert frame_of(again) == frame_of(plan)
    assert Counter(o.kind for o in again.openings) == Counter(o.kind for o in plan.openings)


# The overlay -------------------------------------------------------------------------------------


def test_a_plan_from_nowhere_has_no_overlay() -> None:
    with pytest.raises(PlanError, match="not read from a picture"):
        overlay(PLAN, np.zeros((64, 64, 3), np.uint8))


# Bad input ---------------------------------------------------------------------------------------


def png_header(width: int, height: int) -> bytes:
    """A PNG that says it is this large and holds nothing."""
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunk = b"IHDR" + header
    return (
        b"\x89PNG\r\n\x1a\n" + struct.pack(">I", 13) + chunk
        + struct.pack(">I", zlib.crc32(chunk)) + struct.pack(">I", 0) + b"IDAT"
    )  # fmt: skip


def photo_of_something_else() -> np.ndarray:
    """Soft blobs and fur: no straight wall in it."""
    rng = np.random.default_rng(1)
    noise = cv2.resize(rng.random((12, 16, 3)), (640, 480), interpolation=cv2.INTER_CUBIC)
    fur = cv2.GaussianBlur(rng.random((480, 640, 1)), (0, 0), 1.5)[:, :, None]
    return np.clip((0.7 * noise + 0.6 * fur) * 255, 0, 255).astype(np.uint8)


BAD: dict[str, tuple[Callable[[Path], object], str]] = {
    "empty": (lambda p: p.write_bytes(b""), "is empty"),
    "text": (lambda p: p.write_text("a floor plan"), "is not a picture"),
    "cut short": (lambda p: cut_short(p), "is a damaged picture"),
    "1x1": (lambda p: Image.new("RGB", (1, 1)).save(p), "is 1×1 pixels"),
    "huge": (lambda p: p.write_bytes(png_header(20_000, 20_000)), "too large|20000×20000"),
    "200 megapixels": (
        lambda p: p.write_bytes(png_header(16_000, 12_500)),
        "too large|16000×12500",
    ),
    "long": (lambda p: p.write_bytes(png_header(LARGEST_SIDE_PX + 1, 64)), "is 12001×64 pixels"),
    "white": (lambda p: Image.new("RGB", (300, 300), "white").save(p), "no closed room"),
    "black": (lambda p: Image.new("RGB", (300, 300)).save(p), "no closed room"),
    "photo": (
        lambda p: Image.fromarray(photo_of_something_else()).save(p),
        "no closed room|has a floor of|could be read as rooms",
    ),
    "layout": (lambda p: write_layout(p), "is a layout, not a plan"),
    "broken json": (lambda p: p.write_text('{"rooms": ['), "is not JSON"),
    "folder": (lambda p: p.mkdir(), "is a folder"),
    "missing": (lambda p: None, "no such file"),
}


def cut_short(path: Path) -> None:
    Image.fromarray(draw_plan(PLAN).rgb).save(path)
    path.write_bytes(path.read_bytes()[:800])


def write_layout(path: Path) -> None:
    items = [Item("a", "bed", Box((1, 1, 0), (2, 2, 1), 0))]
    write_raster(layout_image(draw_plan(PLAN), items), path)


@pytest.mark.parametrize("name", BAD)
def test_bad_input_gets_one_clear_sentence(name: str, tmp_path: Path) -> None:
    make, message = BAD[name]
    path = tmp_path / "plan.png"
    make(path)
    with pytest.raises(PlanError, match=message) as caught:
        read_plan_file(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_a_damaged_frame_is_not_trusted(tmp_path: Path) -> None:
    from PIL.PngImagePlugin import PngInfo

    for text in ("{", json.dumps({"frame": {"m_per_px": "x"}}), json.dumps([1])):
        info = PngInfo()
        info.add_text("chord", text)
        Image.fromarray(draw_plan(PLAN).rgb).save(tmp_path / "plan.png", pnginfo=info)
        assert len(read_plan_file(tmp_path / "plan.png").openings) == len(PLAN.openings)
