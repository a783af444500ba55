"""The history of a house in Blender, the same as the program's; every button without arguments."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from chord_usd.cli import main

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "tests" / "fixtures" / "furnished_house.json"

Told = dict[str, Any]

PRETENDS = """#!{python}
import sys
sys.path.insert(0, {folder!r})
from pretends import main
main(*{answers!r})
"""
"""A program that has everything ready: the real one would render, and build a library."""


@pytest.fixture(scope="module")
def past(run_in_blender: Callable[..., Told], tmp_path_factory: pytest.TempPathFactory) -> Told:
    """What happened to a house that went along its history."""
    folder = tmp_path_factory.mktemp("past")
    house = folder / "house" / "house.usda"
    assert main(["stage", str(SCENE), "-o", str(house)]) == 0
    (folder / "models" / "pictures").mkdir(parents=True)
    answers = (
        "chord-usd 9.0.0",
        0,
        "--outline PNG",
        str(folder / "models"),
        str(house.parent),
        0.0,
    )
    text = PRETENDS.format(
        python=sys.executable, folder=str(ROOT / "tests" / "blender"), answers=answers
    )
    (folder / "good").write_text(text, encoding="utf-8")
    (folder / "good").chmod(0o755)
    return run_in_blender("past.py", house, folder)


def test_the_history_of_a_house_is_that_of_the_program(past: Told) -> None:
    steps = ("opened", "saved", "listed", "edited", "undo", "again", "redo", "go_to")
    assert {name: past[name] for name in steps} == dict.fromkeys(steps, "")
    assert "no earlier state" in past["nothing_to_undo"]
    assert [line.partition(":")[0] for line in past["after"][0]] == ["3", "2", "1"]
    assert "remove the cabinet" in past["after"][0][0]
    assert "remove the cabinet" in past["program"]
    assert ">   3" in past["program"], "the panel went there"
    assert "Choose a change" in past["no_choice"]
    assert {"chord.undo", "chord.redo", "chord.go_to"} <= {
        line[1] for line in past["drawn"] if line[0] == "operator"
    }


def test_undo_shows_the_house_as_it_was_and_makes_no_change_of_its_own(past: Told) -> None:
    (_, _, cabinet, bed_m), end = past["none_yet"], past["after"][2:]
    assert cabinet
    assert end == [False, pytest.approx(bed_m + 0.25)]
    assert past["undone"][2:] == [True, pytest.approx(bed_m + 0.25)]
    assert past["undone_again"][2:] == [True, pytest.approx(bed_m)]
    assert past["redone"][2:] == past["undone"][2:]
    assert past["gone_to"][2:] == end
    for state, at in (("undone", 1), ("undone_again", 2), ("redone", 1), ("gone_to", 0)):
        assert past[state][1] == at
        assert len(past[state][0]) == 3, state
    assert past["saved_undone"] == ""


def test_missed_planning_numbers_are_findings_to_click(past: Told) -> None:
    assert past["planning"] == ""
    assert any(
        is_planning and " cm, not " in text and paths
        for is_planning, text, paths in past["findings"]
    )


def test_every_button_does_without_arguments(past: Told) -> None:
    said = [*past["nothing_there"].values(), *past["house_there"].values()]
    assert len(past["every"]) == 26
    assert [text for text in said if "Traceback" in text or "could not be used" in text] == []
    assert past["came_of_nothing"] == ["", 0], "nothing comes of nothing"
    assert past["opens"] == "", "and nothing breaks the house"
    assert past["whole"] > 100
