"""What benchmarks/fuzz.py found, each as the smallest input that shows it."""

from __future__ import annotations

import gzip
import json
import os
import re
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from chord_usd.base.errors import AssetError, ChordError, SceneError
from chord_usd.base.runtime import json_lines
from chord_usd.base.runtime.json_lines import read_lines
from chord_usd.base.runtime.json_text import MOST_VALUES, parse_json
from chord_usd.cli import UNUSABLE, main
from chord_usd.library.database import load_database
from chord_usd.library.kit.shading import corner_normals
from chord_usd.library.kit.solids import Solid
from chord_usd.workshop.data.flats import read_flats_or_why
from chord_usd.workshop.data.foreign import Models, foreign_houses
from tests import plan_files
from tests.foreign_records import flat_lines, front_house, procthor_house

Capture = pytest.CaptureFixture[str]


def refused(capsys: Capture, *words: object) -> str:
    """Run it; it must end with one error line, which is returned."""
    capsys.readouterr()
    assert main([*map(str, words), "--progress", "none"]) == UNUSABLE
    told = capsys.readouterr().err
    assert re.fullmatch(r"error: .+\n", told), told
    assert "unexpected" not in told
    return told


@pytest.mark.parametrize("points", [[], [[0, 0]], [[0, 0], [0, 0], [0, 0]]])
def test_a_room_without_corners(points: list[Any], tmp_path: Path, capsys: Capture) -> None:
    room = {"roomId": "a", "roomName": "a", "roomType": 1, "wallPoints": points}
    plan = tmp_path / "plan.json"
    plan.write_text(json.dumps({"rooms": [room], "windowsDoors": [], "furniture": []}))
    assert "corners" in refused(capsys, "plan", "draw", plan, "-o", tmp_path / "plan.png")


def test_a_mesh_of_flat_points(tmp_path: Path, capsys: Capture) -> None:
    """Two numbers a corner are points to trimesh, and none in space."""
    with zipfile.ZipFile(tmp_path / "flat.sh3f", "w") as archive:
        archive.writestr(
            "PluginFurnitureCatalog.properties",
            "id#1=a\nname#1=Chair\nmodel#1=/a.obj\nwidth#1=48\ndepth#1=52\nheight#1=90\n",
        )
        archive.writestr("a.obj", "v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n")
    refused(capsys, "assets", "add", tmp_path / "flat.sh3f", "-o", tmp_path / "database")


@pytest.mark.parametrize("turn", ["nan 0 0 0 1 0 0 0 1", "-1 0 0 0 5 0 0 0 1", "0 0 0 0 0 0 0 0 0"])
def test_a_rotation_that_turns_nothing(turn: str, tmp_path: Path, capsys: Capture) -> None:
    """Numbers that are none, or a matrix that bends, came into the database."""
    with zipfile.ZipFile(tmp_path / "bent.sh3f", "w") as archive:
        archive.writestr(
            "PluginFurnitureCatalog.properties",
            "id#1=a\nname#1=Chair\nmodel#1=/a.obj\nwidth#1=48\ndepth#1=52\nheight#1=90\n"
            f"modelRotation#1={turn}\n",
        )
        archive.writestr("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 3\n")
    told = refused(capsys, "assets", "add", tmp_path / "bent.sh3f", "-o", tmp_path / "database")
    assert "no rotation" in told


def test_a_mesh_with_thousands_of_faces_at_one_point() -> None:
    """Pairs of faces at a point took 60 s and 10 GB."""
    angles = np.linspace(0.0, 2.0 * np.pi, 20_000, endpoint=False)
    rim = np.stack([np.cos(angles), np.sin(angles), np.zeros_like(angles)], axis=1)
    at = np.arange(20_000)
    faces = np.stack([np.full_like(at, 20_000), at, np.roll(at, -1)], axis=1)
    cone = Solid(np.vstack([rim, [0.0, 0.0, 1.0]]), faces)
    normals = corner_normals(cone)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0)
    assert np.all(normals[:, 2] > 0.5)


@pytest.mark.parametrize("value", ["..", None, [], {}, "x"])
def test_a_flat_whose_lines_are_none(value: object, tmp_path: Path) -> None:
    for at in range(5):
        lines = [list(line) for line in flat_lines()]
        lines[0][at] = value
        lines[-1][at] = value
        path = tmp_path / f"{at}.jsonl"
        path.write_text(json.dumps({"id": "a", "lines": lines}) + "\n")
        (found,) = read_flats_or_why(path).values()
        assert at == 4 or isinstance(found, str)


def test_a_device_that_is_none(tmp_path: Path, capsys: Capture) -> None:
    told = refused(capsys, "train", "table", "--device", "aaaa", "-o", tmp_path / "run")
    assert "unknown device" in told
    assert not (tmp_path / "run").exists()


def test_lists_of_fonts_stay_out_of_the_home_folder(tmp_path: Path, furnished_house) -> None:
    plan_files.write_dxf(furnished_house.plan, tmp_path / "plan.dxf")
    (tmp_path / "home").mkdir()
    env = {**os.environ, "HOME": str(tmp_path / "home"), "CHORD_USD_CACHE": str(tmp_path / "cache")}
    env.pop("XDG_CACHE_HOME", None)
    words = ["plan", "read", str(tmp_path / "plan.dxf"), "-o", str(tmp_path / "plan.json")]
    subprocess.run([sys.executable, "-m", "chord_usd.cli", *words], env=env, check=True)
    assert list((tmp_path / "home").iterdir()) == []


# Records from elsewhere ---------------------------------------------------------------------------


def houses_of(tmp_path: Path, record: object) -> list[Any]:
    path = tmp_path / "houses.jsonl"
    path.write_text(json.dumps(record) + "\n")
    return list(foreign_houses(path, Models()))


ODD: list[tuple[Callable[[], dict[str, Any]], Callable[[Any], None]]] = [
    (procthor_house, lambda r: r["rooms"][0]["floorPolygon"][0].update(x=float("nan"))),
    (procthor_house, lambda r: r["rooms"][0]["floorPolygon"][0].update(x=1e300)),
    (procthor_house, lambda r: r["rooms"][0].update(roomType=[])),
    (procthor_house, lambda r: r["objects"][0]["position"].update(x=float("inf"))),
    (procthor_house, lambda r: r["doors"][0].update(holePolygon=[])),
    (front_house, lambda r: r["mesh"][0].update(faces=[10**400])),
    (front_house, lambda r: r["mesh"][0].update(xyz=[1e200] * 12)),
    (front_house, lambda r: r["mesh"][0].update(type=[])),
    (front_house, lambda r: r["scene"]["room"][0].update(type=None)),
    (front_house, lambda r: r["scene"].update(room=[1])),
]


@pytest.mark.parametrize(("record", "change"), ODD)
def test_records_of_others_with_odd_values_are_passed_over(
    record: Callable[[], dict[str, Any]], change: Callable[[Any], None], tmp_path: Path
) -> None:
    odd = json.loads(json.dumps(record()))
    change(odd)
    (found,) = houses_of(tmp_path, odd)
    assert found.house is None
    assert found.why


@pytest.mark.parametrize("source", ["..", "a\x00b", "x" * 400, "a/../../b", "new\nline", "c.json"])
def test_what_a_house_calls_itself_is_a_plain_name(source: str, tmp_path: Path) -> None:
    (found,) = houses_of(tmp_path, {"id": source, "lines": flat_lines()})
    assert re.fullmatch(r"[\w-]{1,100}", found.name)


# Bombs --------------------------------------------------------------------------------------------


def test_lines_that_unpack_to_gigabytes_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "bomb.jsonl.gz"
    path.write_bytes(gzip.compress(b"\n" * (30 * 2**20)))
    with pytest.raises(SceneError, match="times its size"):
        list(read_lines(path, SceneError))


def test_a_line_without_end_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(json_lines, "MOST_LINE_BYTES", 1000)
    path = tmp_path / "long.jsonl"
    path.write_bytes(b"{}\n" + b"0" * 2000)
    with pytest.raises(SceneError, match="line 2"):
        list(read_lines(path, SceneError))


def test_json_of_millions_of_values_is_refused_before_it_is_read() -> None:
    with pytest.raises(ChordError, match="too many values"):
        parse_json("[" + "[]," * MOST_VALUES + "[]]", "file.json")


def test_a_model_of_astronomical_size_is_refused(tmp_path: Path) -> None:
    entry = {"id": "far", "category": "chair", "size_m": [5e299, 0.5, 0.9], "path": "far.usda"}
    (tmp_path / "index.json").write_text(json.dumps({"schema": 1, "assets": [entry]}))
    with pytest.raises(AssetError, match="not three lengths"):
        load_database([tmp_path])
