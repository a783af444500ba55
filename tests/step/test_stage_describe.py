"""What a stage is told to hold: the paths that are there, and choices that can be made."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from pxr import Usd

from chord_usd.base.errors import StageError
from chord_usd.base.scene.types import SceneGraph
from chord_usd.cli import main
from chord_usd.line.stage.read.describe import describe_stage


def test_every_piece_is_told_where_it_is(staged_house: Path, staged_graph: SceneGraph) -> None:
    contents = describe_stage(staged_house)
    stage = Usd.Stage.Open(str(staged_house))
    pieces = [piece for room in contents.rooms for piece in room.furniture]
    assert len(pieces) == len(staged_graph.items)
    for piece in pieces:
        assert stage.GetPrimAtPath(piece.path)
        assert stage.GetPrimAtPath(piece.component).GetAttribute("chord:category").Get() == (
            piece.category
        )
        assert (staged_house.parent / "assets" / piece.asset).is_dir()
        assert all(stage.GetPrimAtPath(path) for path in piece.carries)


def test_choices_can_be_made(staged_house: Path) -> None:
    contents = describe_stage(staged_house)
    assert contents.looks["lighting"].offered == ("day", "evening", "night")
    stage = Usd.Stage.Open(str(staged_house))
    for room in contents.rooms:
        for name, choice in room.looks.items():
            sets = stage.GetPrimAtPath(room.path).GetVariantSets()
            assert choice.chosen in choice.offered
            assert sets.GetVariantSet(name).SetVariantSelection(choice.offered[-1])


def test_a_stage_of_something_else_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "other.usda"
    path.write_text('#usda 1.0\n(\n    defaultPrim = "Thing"\n)\ndef Xform "Thing"\n{\n}\n')
    with pytest.raises(StageError, match="holds no rooms"):
        describe_stage(path)


def test_the_nearest_meshes_fit_the_size_and_are_drawn(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["assets", "nearest", "bed", "--size", "1.5x2.0x0.9", "--count", "2", "--json"]
    assert main([*words, "--pictures", str(tmp_path), "--progress", "none"]) == 0
    told = json.loads(capsys.readouterr().out)["assets"]
    assert len(told) == 2
    for asset in told:
        assert Path(asset["picture"]).is_file()
        assert all(a <= b + 1e-6 for a, b in zip(asset["fits"]["size_m"], (1.5, 2.0), strict=False))
    missed = [sum((a["size_m"][i] - (1.5, 2.0)[i]) ** 2 for i in (0, 1)) for a in told]
    assert missed == sorted(missed)
