"""edit on a house of storeys: the sentence is done on the storey where it means something."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf

from chord_usd.base.scene.stacking import stack
from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.cli import DONE, NOT_HELD, UNUSABLE, main
from chord_usd.line.pipeline.edit_house import edit, read_sentence
from chord_usd.line.stage.author.author_stage import author_levels
from chord_usd.line.stage.author.stage_levels import levels_of
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.storey_houses import random_storeys


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = stack(random_storeys(np.random.default_rng(1), 2))
    graphs = []
    for storey in made.storeys:
        graph = furnish(storey.plan, np.random.default_rng(2))
        cells = {room.id for room in storey.plan.rooms if is_cell(room)}
        graphs.append(graph.without(item.id for item in graph.items if item.room_id in cells))
    path = tmp_path_factory.mktemp("storeys") / "house.usda"
    author_levels(levels_of(made, graphs), path)
    return path


@pytest.fixture
def house(written: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(written.parent, tmp_path / "house")) / "house.usda"


def rooms_text(path: Path) -> dict[str, str]:
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    storeys = layer.GetPrimAtPath("/House/Rooms").nameChildren
    return {room.name: room.GetAsText() for storey in storeys for room in storey.nameChildren}


@pytest.mark.parametrize(("piece", "on"), [("coffee table", "Storey_0"), ("bed", "Storey_1")])
def test_only_the_room_that_is_meant_changes(house: Path, piece: str, on: str) -> None:
    before = rooms_text(house)
    room = "bedroom 2" if piece == "bed" else "living room"
    _, done, _ = edit(house, f"remove the {piece} in the {room}", house, force=True)
    after = rooms_text(house)
    assert done.removed
    changed = {name for name in before if before[name] != after[name]}
    layer = Sdf.Layer.OpenAsAnonymous(str(house))
    (name,) = changed
    assert name in layer.GetPrimAtPath(f"/House/Rooms/{on}").nameChildren
    assert not check_stage(house).errors


def test_what_every_storey_has_needs_its_storey(
    house: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = ["edit", str(house), "lock the toilet in bathroom 1", "--dry-run"]
    assert main(line) == UNUSABLE
    told = capsys.readouterr().err.splitlines()[-1]
    assert "several storeys" in told or "the room, too" in told
    assert main([*line, "--storey", "first floor"]) in (DONE, NOT_HELD)
    assert main([*line, "--storey", "0"]) in (DONE, NOT_HELD)
    assert main([*line, "--storey", "attic"]) == UNUSABLE
    assert "Ground floor" in capsys.readouterr().err
    rooms = read_sentence(house, "lock the toilet in bathroom 1", storey="1").rooms
    assert len(rooms) == 1
