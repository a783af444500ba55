"""Complete homes on the command line: what is drawn, what is said to lack room, what is checked."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from chord_usd.base.scene.chord_json import read_scene, write_plan
from chord_usd.base.scene.types import Box, Opening, Plan, Room, frozen_array
from chord_usd.cli import main


def run(capsys: pytest.CaptureFixture[str], *command: str) -> dict:
    assert main([*command, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def pieces(folder: Path) -> int:
    return sum(len(read_scene(file).items) for file in folder.glob("*.json"))


def test_homes_are_the_default_and_the_papers_mix_is_there(tmp_path, capsys) -> None:
    for statistics in ("homes", "paper"):
        run(capsys, "dataset", "synth", "-o", str(tmp_path / statistics), "--count", "6",
            "--statistics", statistics)  # fmt: skip
    run(capsys, "dataset", "synth", "-o", str(tmp_path / "default"), "--count", "6")
    assert pieces(tmp_path / "default") == pieces(tmp_path / "homes")
    assert pieces(tmp_path / "paper") < pieces(tmp_path / "homes")


def test_rooms_too_small_for_their_kind_are_said(tmp_path, capsys) -> None:
    small = Room("r", "bedroom", frozen_array([(0, 0), (1.5, 0), (1.5, 1.5), (0, 1.5)]), "Box room")
    door = Opening("d", "door", Box((0.6, -0.12, 0.0), (0.7, 0.24, 2.1), 0.0), ("r",))
    (tmp_path / "plans").mkdir()
    write_plan(Plan((small,), (door,)), tmp_path / "plans" / "small.json")
    found = run(capsys, "dataset", "import", str(tmp_path / "plans"), "--furnish",
                "-o", str(tmp_path / "out"))  # fmt: skip
    assert found["lacking"] == [{"house": "small", "room": "Box room", "missing": ["bed"]}]


def test_an_unknown_mix_is_refused(tmp_path, capsys) -> None:
    command = ["dataset", "synth", "-o", str(tmp_path / "x"), "--statistics", "palace"]
    assert main(command) == 2
    assert "homes" in capsys.readouterr().err
    assert not (tmp_path / "x").exists()
