"""What users do by mistake: exit 2, one line that says what to do, nothing left behind."""

from __future__ import annotations

import copy
import io
import json
import os
import re
import shutil
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from PIL import Image

from chord_usd.base.raster.canvas import draw_plan
from chord_usd.base.raster.raster_files import write_raster
from chord_usd.base.scene.chord_json import plan_to_json, write_plan

RunCli = Callable[..., subprocess.CompletedProcess[str]]

UNUSABLE = 2
ONE_ERROR = re.compile(r"error: .+\n")
FULL_DISK_KIB = 96


@pytest.fixture(scope="module")
def house_json(furnished_house) -> dict[str, Any]:
    return plan_to_json(furnished_house.plan)


def png(array: np.ndarray) -> bytes:
    buffer = io.BytesIO()
    Image.fromarray(array).save(buffer, "PNG")
    return buffer.getvalue()


def huge_png() -> bytes:
    """20,000 × 20,000 pixels in a file of 50 kB."""
    buffer = io.BytesIO()
    Image.new("1", (20_000, 20_000), 1).save(buffer, "PNG")
    return buffer.getvalue()


def cat_photo() -> bytes:
    """Soft fur, two ears, two eyes: closed shapes, but no floor plan."""
    rng = np.random.default_rng(0)
    photo = cv2.GaussianBlur(rng.normal(150, 90, (480, 640, 3)), (0, 0), 9) + 0.0
    photo = np.clip((photo - photo.mean()) * 5 + (120, 140, 160), 0, 255).astype(np.uint8)
    cv2.ellipse(photo, (320, 270), (150, 130), 0, 0, 360, (90, 110, 150), -1, cv2.LINE_AA)
    for x in (220, 420):
        ear = np.array([[x - 50, 190], [x, 70], [x + 50, 190]])
        cv2.fillPoly(photo, [ear], (80, 100, 140), cv2.LINE_AA)
        cv2.circle(photo, ((x + 320) // 2, 250), 22, (40, 200, 120), -1, cv2.LINE_AA)
        cv2.circle(photo, ((x + 320) // 2, 250), 9, (0, 0, 0), -1, cv2.LINE_AA)
    grain = rng.normal(0, 8, photo.shape)
    photo = np.clip(cv2.GaussianBlur(photo, (0, 0), 1.5) + grain, 0, 255).astype(np.uint8)
    return cv2.imencode(".jpg", photo)[1].tobytes()


PICTURES: dict[str, Callable[[], bytes]] = {
    "text.png": lambda: b"this is no picture\n",
    "empty.png": lambda: b"",
    "pixel.png": lambda: png(np.zeros((1, 1, 3), np.uint8)),
    "huge.png": huge_png,
    "white.png": lambda: png(np.full((256, 256, 3), 255, np.uint8)),
    "black.png": lambda: png(np.zeros((256, 256, 3), np.uint8)),
    "noise.png": lambda: png(np.random.default_rng(1).integers(0, 256, (300, 400, 3), np.uint8)),
    "cat.jpg": cat_photo,
    "cut.png": lambda: png(np.zeros((256, 256, 3), np.uint8))[:60],
}


def crossed(house: dict[str, Any]) -> None:
    points = house["rooms"][0]["wallPoints"]
    points[1], points[2] = points[2], points[1]


def not_a_number(house: dict[str, Any]) -> None:
    house["rooms"][0]["wallPoints"][0][0] = float("nan")


def same_ids(house: dict[str, Any]) -> None:
    house["rooms"][1]["roomId"] = house["rooms"][0]["roomId"]


def flat_room(house: dict[str, Any]) -> None:
    for point in house["rooms"][0]["wallPoints"]:
        point[1] = 0.0


def no_rooms(house: dict[str, Any]) -> None:
    house["rooms"] = []


def no_doors(house: dict[str, Any]) -> None:
    house["windowsDoors"] = [o for o in house["windowsDoors"] if o["type"] == "window"]


def missing_key(house: dict[str, Any]) -> None:
    del house["rooms"][0]["wallPoints"]


def unknown_category(house: dict[str, Any]) -> None:
    house["furniture"] = [
        {"type": "hoverboard", "pos": [0, 0, 0], "length": 60, "width": 60, "height": 60,
         "rotate": 0}
    ]  # fmt: skip


JSON_FAULTS: list[Callable[[dict[str, Any]], None]] = [
    crossed, not_a_number, same_ids, flat_room, no_rooms, no_doors, missing_key,
]  # fmt: skip


def assert_refused(done: subprocess.CompletedProcess[str], *left: Path) -> None:
    """Exit code 2, nothing on stdout, exactly one line on stderr, and no trace."""
    assert done.returncode == UNUSABLE, done.stderr
    assert done.stdout == ""
    assert ONE_ERROR.fullmatch(done.stderr), done.stderr
    assert "unexpected" not in done.stderr
    assert not [path for path in left if path.exists()]


@pytest.mark.parametrize("name", PICTURES)
def test_pictures_that_are_no_plan(name: str, tmp_path: Path, run_cli: RunCli) -> None:
    (tmp_path / name).write_bytes(PICTURES[name]())
    output = tmp_path / "out" / "house.usda"
    done = run_cli("generate", tmp_path / name, "-o", output, "--progress", "none")
    assert_refused(done, output.parent)
    assert name in done.stderr


@pytest.mark.parametrize("fault", JSON_FAULTS, ids=lambda fault: fault.__name__)
def test_json_that_is_no_plan(
    fault: Callable[[dict[str, Any]], None],
    tmp_path: Path,
    house_json: dict[str, Any],
    run_cli: RunCli,
) -> None:
    house = copy.deepcopy(house_json)
    fault(house)
    (tmp_path / "plan.json").write_text(json.dumps(house))
    output = tmp_path / "out" / "house.usda"
    done = run_cli("generate", tmp_path / "plan.json", "-o", output, "--progress", "none")
    assert_refused(done, output.parent)
    assert "plan.json" in done.stderr


def test_a_scene_with_an_unknown_category(
    tmp_path: Path, house_json: dict[str, Any], run_cli: RunCli
) -> None:
    house = copy.deepcopy(house_json)
    unknown_category(house)
    (tmp_path / "scene.json").write_text(json.dumps(house))
    output = tmp_path / "out" / "house.usda"
    done = run_cli("stage", tmp_path / "scene.json", "-o", output, "--progress", "none")
    assert_refused(done, output.parent)
    assert "hoverboard" in done.stderr


@pytest.mark.parametrize("mode", ["RGBA", "L"])
def test_a_plan_without_its_colours_or_with_transparency_is_read(
    mode: str, tmp_path: Path, furnished_house, run_cli: RunCli
) -> None:
    """Other depths: test_every_pixel_format_is_read_alike."""
    plan = furnished_house.plan
    picture = Image.fromarray(draw_plan(plan, shade=False).rgb).resize((1024, 1024), 0)
    picture.convert(mode).save(tmp_path / "plan.png")
    done = run_cli("plan", "read", tmp_path / "plan.png", "-o", tmp_path / "plan.json", "--json")
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["rooms"] == len(_separate_rooms(plan))


def _separate_rooms(plan: Any) -> list[Any]:
    """Rooms of an open plan touch; without shading nothing in a picture parts them."""
    import shapely

    from chord_usd.base.scene.geometry import polygons_of, room_polygon

    floors = shapely.unary_union([room_polygon(room).buffer(1e-4) for room in plan.rooms])
    return polygons_of(floors)


def test_a_missing_checkpoint(tmp_path: Path, furnished_house, run_cli: RunCli) -> None:
    write_plan(furnished_house.plan, tmp_path / "plan.json")
    (tmp_path / "checkpoints" / "plan2layout").mkdir(parents=True)
    (tmp_path / "checkpoints" / "plan2layout" / "config.json").write_text("{}")
    output = tmp_path / "out" / "house.usda"
    done = run_cli(
        "generate", tmp_path / "plan.json", "-o", output, "--progress", "none",
        env={"CHORD_USD_CHECKPOINTS": str(tmp_path / "checkpoints")},
    )  # fmt: skip
    assert_refused(done, output.parent)
    assert "plan2layout" in done.stderr


@pytest.mark.parametrize("target", ["file/house.usda", "folder", "house.txt"])
def test_a_target_that_cannot_be_written(
    target: str, tmp_path: Path, furnished_house, run_cli: RunCli
) -> None:
    from chord_usd.base.scene.chord_json import write_scene

    write_scene(furnished_house, tmp_path / "scene.json")
    (tmp_path / "file").write_text("in the way")
    (tmp_path / "folder").mkdir()
    before = sorted(tmp_path.rglob("*"))
    done = run_cli("stage", tmp_path / "scene.json", "-o", tmp_path / target, "--progress", "none")
    assert_refused(done)
    assert sorted(tmp_path.rglob("*")) == before


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A file system with room for very little."""
    if os.geteuid() != 0 or not shutil.which("mount"):
        pytest.skip("mounting a small disk needs root")
    disk = tmp_path / "disk"
    disk.mkdir()
    words = ["mount", "-t", "tmpfs", "-o", f"size={FULL_DISK_KIB}k", "tmpfs", str(disk)]
    if subprocess.run(words, capture_output=True, check=False).returncode:
        pytest.skip("this machine does not let tests mount")
    yield disk
    subprocess.run(["umount", str(disk)], check=True)


def test_a_full_disk(small_disk: Path, tmp_path: Path, furnished_house, run_cli: RunCli) -> None:
    from chord_usd.base.scene.chord_json import write_scene

    write_scene(furnished_house, tmp_path / "scene.json")
    for output in ("house.usda", "house.usdz"):
        done = run_cli(
            "stage", tmp_path / "scene.json", "-o", small_disk / output, "--progress", "none"
        )
        assert_refused(done)
        assert "disk is full" in done.stderr
        assert list(small_disk.iterdir()) == []


def test_a_full_disk_for_a_picture(small_disk: Path, furnished_house, run_cli: RunCli) -> None:
    plan = small_disk.parent / "plan.json"
    write_plan(furnished_house.plan, plan)
    (small_disk / "filler").write_bytes(b"x" * (FULL_DISK_KIB - 4) * 1024)
    write_raster(draw_plan(furnished_house.plan), plan.with_suffix(".png"))
    done = run_cli("plan", "draw", plan, "-o", small_disk / "plan.png", "--progress", "none")
    if done.returncode == 0:
        # The picture was small enough for what was left.
        assert (small_disk / "plan.png").read_bytes() == plan.with_suffix(".png").read_bytes()
    else:
        assert_refused(done, small_disk / "plan.png")
