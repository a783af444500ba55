"""A drawing of which the reader is unsure: what generate says; and a plan edited by hand."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from PIL import Image
from plan_symbols import draw_storeys

from tests.exit_codes import written

RunCli = Callable[..., "subprocess.CompletedProcess[str]"]
QUICK = ("--steps", 2, "--redraws", 0, "--no-tabletop", "--no-dressing")


@pytest.fixture
def sheet(tmp_path: Path) -> Path:
    Image.fromarray(draw_storeys()).save(tmp_path / "sheet.png")
    return tmp_path / "sheet.png"


def test_generate_takes_a_part_and_says_what_is_uncertain(sheet: Path, run_cli: RunCli) -> None:
    done = run_cli(
        "generate", sheet, "-o", sheet.with_name("house.usda"), "--part", 2, *QUICK, "--json"
    )
    told = written(done)
    assert told["rooms"] == 2
    assert any("2 plans; number 2" in warning for warning in told["warnings"])
    assert any("the scale" in warning and "guess" in warning for warning in told["warnings"])


def test_a_plan_edited_by_hand_is_fed_back(sheet: Path, run_cli: RunCli) -> None:
    plan, raster = sheet.with_name("plan.json"), sheet.with_name("plan.png")
    assert run_cli("plan", "read", sheet, "-o", plan).returncode == 0
    data = json.loads(plan.read_text())
    data["rooms"][0]["roomName"] = "Kitchen"
    plan.write_text(json.dumps(data))
    done = run_cli("plan", "draw", plan, "-o", raster)
    assert done.returncode == 0, done.stderr
    # The raster has the new kind as its shade.
    again = sheet.with_name("again.json")
    assert run_cli("plan", "read", raster, "-o", again).returncode == 0
    names = [room["roomName"] for room in json.loads(again.read_text())["rooms"]]
    assert names.count("kitchen") == 1
