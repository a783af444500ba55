"""A folder of houses as a data set: what stands beside them is right, and nobody's file is lost."""

from __future__ import annotations

import hashlib
import json
from pathlib import Path

import pytest
from batch_makers import FIGURES

from chord_usd.base.errors import OutputError
from chord_usd.base.scene.chord_json import write_scene
from chord_usd.base.scene.types import SceneGraph
from chord_usd.faces.batch.make import SCENE_FILE
from chord_usd.faces.batch.records import (
    HOUSE_RECORD,
    Record,
    files_in,
    hashes_of,
    write_costs,
    write_record,
)
from chord_usd.faces.batch.release import require_own, write_release
from chord_usd.workshop.data.foreign import Models, foreign_houses

NAMES = [f"house_{number:06d}" for number in range(12)]
COLLIDES = NAMES[3]


@pytest.fixture
def houses(tmp_path: Path, furnished_house: SceneGraph) -> Path:
    """Houses as a batch leaves them; one does not hold its certificate, the last was not made."""
    for name in NAMES[:-1]:
        house = tmp_path / name
        house.mkdir()
        write_scene(furnished_house, house / SCENE_FILE)
        told = {
            **FIGURES,
            "dressing": 9,
            "holds": name != COLLIDES,
        }
        recipe = {"seed": 1, "procedural_plan": 1, "checkpoints": {"lists": "ab" * 32}}
        record = Record(recipe, hashes_of(files_in(house), house), told)
        write_record(record, house / HOUSE_RECORD)
        write_costs(house, "house", {"stage": 9.0}, 6.0)
    return tmp_path


def test_splits_hold_the_houses_that_hold(houses: Path) -> None:
    release = write_release(houses, NAMES)
    splits = json.loads((houses / "splits.json").read_text())
    assert sorted(splits["train"] + splits["test"]) == sorted({*NAMES[:-1]} - {COLLIDES})
    assert release.as_json()["houses"] == len(NAMES) - 1
    # One core takes 6 s a house.
    assert "7 days of one core" in release.summary
    assert f"# {len(NAMES) - 1} furnished houses" in (houses / "README.md").read_text()


def test_a_house_keeps_its_part_as_others_come(houses: Path) -> None:
    write_release(houses, NAMES[:6])
    few = json.loads((houses / "splits.json").read_text())
    write_release(houses, NAMES)
    many = json.loads((houses / "splits.json").read_text())
    assert {*few["train"]} <= {*many["train"]}
    assert {*few["test"]} <= {*many["test"]}


def test_a_release_is_read_as_a_folder_of_houses(houses: Path) -> None:
    write_release(houses, NAMES)
    found = list(foreign_houses(houses, Models()))
    assert [(one.name, one.why) for one in found] == [(name, "") for name in sorted(NAMES[:-1])]


def test_checksums_are_of_every_file(houses: Path) -> None:
    write_release(houses, NAMES)
    lines = (houses / "checksums.sha256").read_text().splitlines()
    listed = {name: digest for digest, name in (line.split("  ", 1) for line in lines)}
    assert {*listed} == {
        file.relative_to(houses).as_posix()
        for file in files_in(houses)
        if file.name != "checksums.sha256"
    }
    for name, digest in listed.items():
        assert hashlib.sha256((houses / name).read_bytes()).hexdigest() == digest


def test_what_houses_cost_changes_no_byte_of_a_release(houses: Path) -> None:
    write_release(houses, NAMES)
    before = (houses / "checksums.sha256").read_bytes()
    for name in NAMES[:-1]:
        write_costs(houses / name, "house", {"stage": 90.0}, 60.0)
    release = write_release(houses, NAMES)
    assert release.cpu_s == 60.0
    assert (houses / "checksums.sha256").read_bytes() == before


def test_a_card_of_somebody_else_is_refused_before_any_house_is_made(houses: Path) -> None:
    (houses / "README.md").write_text("my notes")
    with pytest.raises(OutputError, match=r"README\.md"):
        require_own(houses)
    with pytest.raises(OutputError):
        write_release(houses, NAMES)
    assert (houses / "README.md").read_text() == "my notes"


def test_what_was_changed_of_ours_is_set_aside(houses: Path) -> None:
    write_release(houses, NAMES)
    card = houses / "README.md"
    card.write_text("better words")
    require_own(houses)
    write_release(houses, NAMES)
    assert "furnished houses" in card.read_text()
    assert (houses / "README.md.changed").read_text() == "better words"
