"""evaluate plans --real: one bad file ends nothing, a truth beside a picture is scored."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from PIL import Image
from plan_files import write_sweethome

from chord_usd.base.raster.raster_files import write_raster
from chord_usd.base.scene.chord_json import write_plan
from chord_usd.cli import main
from chord_usd.line.pipeline import draw_plan
from chord_usd.line.plan.read import read_plan_file
from chord_usd.workshop.data.houses import random_plan


def test_a_folder_of_files_becomes_a_table_and_a_sheet(tmp_path: Path) -> None:
    folder = tmp_path / "real"
    folder.mkdir()
    write_raster(draw_plan(random_plan(np.random.default_rng(3), rooms=4)), folder / "good.png")
    write_plan(read_plan_file(folder / "good.png"), folder / "good.json")
    write_sweethome(folder / "home.sh3d")
    (folder / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\n broken")
    Image.new("RGB", (300, 200), (255, 255, 255)).save(folder / "küche 空.png")
    (folder / "notes.txt").write_text("no plan")

    report = tmp_path / "out" / "real.md"
    report.parent.mkdir()
    assert main(["evaluate", "plans", "--real", str(folder), "-o", str(report)]) == 0
    rows = {
        row["file"]: row for row in json.loads(report.with_suffix(".json").read_text())["files"]
    }
    assert set(rows) == {"good.png", "home.sh3d", "broken.png", "küche 空.png"}
    score = rows["good.png"]["score"]
    assert min(score["walls"], score["openings"], score["room_iou"]) > 0.99
    assert rows["home.sh3d"]["rooms"] == 2
    assert rows["broken.png"]["refusal"]
    assert rows["küche 空.png"]["refusal"]
    assert "![overlays](real.png)" in report.read_text()
    with Image.open(report.with_suffix(".png")) as sheet:
        assert sheet.width > 1800


def test_an_empty_or_missing_folder_is_told(tmp_path: Path, capsys) -> None:  # type: ignore[no-untyped-def]
    for place, said in ((tmp_path, "holds no file to read"), (tmp_path / "no", "no such file")):
        assert main(["evaluate", "plans", "--real", str(place)]) == 2
        assert said in capsys.readouterr().err
