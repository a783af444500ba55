"""A house of two storeys as a user makes and changes it."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import chord_usd
from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.scene.chord_json import write_plan
from chord_usd.base.scene.json_stairs import storeys_from_json
from chord_usd.base.scene.storeys import STOREY_M
from chord_usd.line.stage.read.diff import diff_stages
from chord_usd.workshop.data.storey_houses import random_storeys
from tests.exit_codes import written

RunCli = Callable[..., subprocess.CompletedProcess[str]]
QUICK = ("--steps", 2, "--progress", "none", "--json", "--no-tabletop", "--no-dressing")


@pytest.fixture(scope="module")
def plans(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    folder = tmp_path_factory.mktemp("plans")
    files = []
    for index, storey in enumerate(random_storeys(np.random.default_rng(12), 2)):
        files.append(folder / f"{index}.json")
        write_plan(storey.plan, files[-1])
    return files


@pytest.fixture(scope="module")
def told(plans: list[Path], run_cli: RunCli) -> dict[str, object]:
    folder = plans[0].parent
    done = run_cli(
        "generate", *plans, "-o", folder / "house" / "house.usda", *QUICK, "--roof", "hip",
        "--preview", folder / "above.png", "--graph-out", folder / "graph.json",
        "--keep", folder / "kept",
    )  # fmt: skip
    return written(done)


def test_all_storeys_are_drawn_told_and_kept(told: dict[str, object], plans: list[Path]) -> None:
    folder = plans[0].parent
    assert told["certificate"]["holds"], told["certificate"]  # type: ignore[index]
    with Image.open(folder / "above.png") as picture:
        assert picture.width > 1.5 * picture.height
    graph = parse_json((folder / "graph.json").read_bytes(), "graph", ValueError)
    assert [one.name for one in storeys_from_json(graph)] == ["Ground floor", "First floor"]
    for index in (0, 1):
        assert (folder / "kept" / f"storey_{index}" / "sheet.png").is_file()


def test_a_room_upstairs_is_furnished_again_and_nothing_else(
    told: dict[str, object], plans: list[Path], tmp_path: Path, run_cli: RunCli
) -> None:
    house = plans[0].parent / "house" / "house.usda"
    seen = chord_usd.open(house)
    room = next(one for one in seen.rooms if one.kind == "bedroom" and one.storey == "First floor")
    assert all(piece.center_m[2] >= STOREY_M - 0.01 for piece in room.pieces)
    done = run_cli(
        "regenerate", house, "--room", room.id, "-o", tmp_path / "house.usda", "--seed", 9, *QUICK
    )
    report = written(done)["certificate"]
    assert not report["errors"], report["errors"]
    assert not report["unsupported"]
    own = (f"/House/Rooms/Storey_1/{room.id}", f"/House/Cameras/{room.id}")
    changes = diff_stages(house, tmp_path / "house.usda")
    assert changes
    assert all(change.path.startswith((*own, "/House/Looks")) for change in changes)


def test_a_sentence_is_understood_on_its_storey(told: dict[str, object], plans: list[Path]) -> None:
    house = chord_usd.open(plans[0].parent / "house" / "house.usda")
    assert "Kitchen" in " ".join(house.edit("no rug in the kitchen", dry_run=True))
    with pytest.raises(ChordError, match="has no storey 'attic'"):
        house.edit("no rug in the kitchen", storey="attic", dry_run=True)
