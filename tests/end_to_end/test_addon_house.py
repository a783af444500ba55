"""The extension with the real program: from an example plan to a house, a room, pictures, a job."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

Told = dict[str, Any]

pytestmark = pytest.mark.acceptance


@pytest.fixture(scope="module")
def plan(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An example under a name with a space and letters that are not ASCII."""
    path = tmp_path_factory.mktemp("pläne 1") / "plän 1.png"
    example = Path(__file__).parents[2] / "examples" / "two_bedrooms.png"
    return Path(shutil.copyfile(example, path))


@pytest.fixture(scope="module")
def told(run_in_blender: Callable[..., Told], plan: Path) -> Told:
    """What happened in Blender."""
    return run_in_blender("generate.py", plan)


def test_a_plan_becomes_a_collection_tree(told: Told) -> None:
    assert told["generated"] == ""
    house = told["tree"]["House"]
    assert {"LivingRoom_0", "Bedroom_0", "Kitchen_0"} <= set(told["rooms"]) < set(house)
    for room in told["rooms"]:
        parts = {f"{room} {part}" for part in ("Architecture", "Furniture", "Lights")}
        assert parts <= set(house[room])
    assert told["camera"]
    assert told["world"]
    assert told["units"] == 1.0


def test_a_house_of_an_unsaved_file_moves_with_it(told: Told) -> None:
    assert told["temporary"], "the panel says that the house is not safe yet"
    assert "Save the Blender file first" in told["nowhere"]
    assert told["second"] != told["first"]
    assert Path(told["second"]).is_file()
    assert Path(told["second"]).parent.name == "plän 1"


def test_a_locked_piece_and_other_rooms_stay(told: Told) -> None:
    assert told["regenerated"] == ""
    assert np.allclose(told["locked_after"], told["locked_at"], atol=1e-5)
    assert told["locked"] in told["still_locked"]  # with what it stands on
    inside = f"/Rooms/{told['room']}/"
    before, after = told["before"], told["after"]
    for path, matrix in before.items():
        if inside not in path and path not in (told["other"], told["meanwhile"]):
            assert np.allclose(after[path], matrix, atol=1e-5), path
    assert {p: m for p, m in after.items() if inside in p} != {
        p: m for p, m in before.items() if inside in p
    }


def test_an_edit_of_another_room_outlives_it(told: Told) -> None:
    assert np.allclose(told["other_at"], told["moved"], atol=1e-5)


def test_an_edit_made_while_the_program_works_is_not_lost(told: Told) -> None:
    assert np.allclose(told["after"][told["meanwhile"]], told["meanwhile_at"], atol=1e-5)


def test_a_sentence_is_told_as_understood_then_done(told: Told) -> None:
    assert told["read"] == told["said"] == ""
    assert ["operator", "chord.edit_by_words"] in [line[:2] for line in told["read_drawn"]]
    assert any(line[0] == "label" and "Remove" in line[1] for line in told["read_drawn"])
    assert not told["still_there"]
    assert np.allclose(told["beside_after"], told["beside_at"], atol=1e-5)
    assert not told["by_hand"], "the stage itself has it there now"


def test_a_room_is_taken_back_and_done_again(told: Told) -> None:
    assert told["saved_undone"] == told["saved_redone"] == ""
    assert told["undone_on_disk"]
    assert told["redone_on_disk"]
    for state, wanted in (("undone", "before"), ("redone", "after")):
        inside = {p: m for p, m in told[wanted].items() if f"/Rooms/{told['room']}/" in p}
        assert {p: m for p, m in told[state].items() if p in inside} == inside


def test_pictures_are_made_here_and_on_a_farm(told: Told) -> None:
    assert told["farm"] == told["rendered"] == ""
    assert f"{told['room']}.png" in told["pictures"]
    template = Path(told["farm_note"].split(" in ", 1)[1])
    assert json.loads(template.read_text(encoding="utf-8"))["specificationVersion"]


def test_an_opened_file_goes_on_where_it_was(told: Told) -> None:
    assert told["reopened"] == ""
    assert "walkable" in told["certificate"]


def test_nothing_is_left(told: Told) -> None:
    assert told["left"] == told["handlers_left"] == []
    assert not told["field_left"]
