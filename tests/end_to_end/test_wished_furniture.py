"""Pieces that a user asks for: built, or refused in one line with nothing left behind."""

from __future__ import annotations

import subprocess
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.chord_json import read_scene
from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.pipeline import Settings, require_lists
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.edit.staged_house import read_house
from tests.every import later
from tests.exit_codes import written

RunCli = Callable[..., subprocess.CompletedProcess[str]]

PLAN = Path(__file__).parents[2] / "examples" / "two_bedrooms.png"
WORDS = ("--steps", 2, "--progress", "none", "--json", "--no-tabletop", "--no-dressing")
AROUND_THE_BED = ("--room", "Bedroom_0", "--keep", "Bed_0", *WORDS)


def _without_lists() -> str:
    try:
        require_lists(Settings())
    except ChordError as error:
        return str(error)
    return ""


needs_lists = pytest.mark.skipif(bool(_without_lists()), reason=_without_lists() or "lists")


def refused(done: subprocess.CompletedProcess[str], folder: Path, *words: str) -> None:
    assert done.returncode == 2, done.stderr
    assert done.stdout == ""
    assert done.stderr.startswith("error: ")
    assert done.stderr.count("\n") == 1
    assert all(word in done.stderr for word in words), done.stderr
    assert list(folder.iterdir()) == []


@pytest.mark.parametrize(
    ("wishes", "words"),
    [
        ([""], "is empty"),
        (["Bedroom 1:"], "is empty"),
        (["desk"], "names no room"),
        (["Bedroom 1: dessk"], "expected desk"),
        (["; ".join(["WC: desk"] * 10_000)], "at most 2000"),
        (["Bedroom: 10000 desks"], "at most 24"),
        (["Bedroom: desk", "--no-list"], "--no-list"),
    ],
)
def test_wishes_that_cannot_be_are_refused_before_anything_is_read(
    wishes: list[str], words: str, tmp_path: Path, run_cli: RunCli
) -> None:
    folder = tmp_path / "out"
    folder.mkdir()
    output = folder / "house.usda"
    plan = tmp_path / "plan.png"
    plan.write_bytes(b"no picture: reading it would be the error")
    done = run_cli("generate", plan, "-o", output, *WORDS, "--furniture", *wishes)
    refused(done, folder, words)


def test_a_layout_model_that_sees_no_lists_is_told(
    tmp_path: Path, run_cli: RunCli, furnished_house: SceneGraph
) -> None:
    if not _without_lists():
        pytest.skip("lists are there")
    output = tmp_path / "house.usda"
    done = run_cli("generate", PLAN, "-o", output, *WORDS, "--furniture", "Bedroom: desk")
    refused(done, tmp_path)


@needs_lists
@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("Bedroom 3: desk", ["there is no room 'Bedroom 3'", "Bedroom_0, "]),
        ("Bedroom 1: desk; bedrooms: no desk", ["Bedroom_0: desk", "wanted and excluded"]),
        *later(("Bathroom: four beds", ["Bathroom_0: no place was found for: ", "bed"])),
    ],
)
def test_what_the_plan_has_no_place_for_is_refused(
    text: str, words: list[str], tmp_path: Path, run_cli: RunCli
) -> None:
    output = tmp_path / "house.usda"
    refused(run_cli("generate", PLAN, "-o", output, *WORDS, "--furniture", text), tmp_path, *words)


@needs_lists
def test_what_is_wished_is_built(tmp_path: Path, run_cli: RunCli) -> None:
    wishes = "Bedroom 1: single bed, desk; living: no sofa, two armchairs; Bathroom: bathtub"
    stage, scene = tmp_path / "house.usda", tmp_path / "scene.json"
    done = run_cli(
        "generate", PLAN, "-o", stage, "--graph-out", scene, *WORDS, "--furniture", wishes
    )
    assert not written(done)["certificate"]["errors"]
    graph = read_scene(scene)
    kinds = {room.id: room.kind for room in graph.rooms}
    first = next(room.id for room in graph.rooms if room.kind == "bedroom")
    lengths = {i.category: i.box.size_m[0] for i in graph.items_of(first)}
    assert lengths["bed"] < 1.4
    assert "table" in lengths
    held = Counter((kinds[item.room_id], item.category) for item in graph.items)
    assert held["living", "single_sofa"] >= 2
    assert not held["living", "sofa"]
    assert held["bathroom", "bathtub"]
    kept = read_house(stage).requests
    assert kept["Bedroom_0"] == "single bed, desk"
    assert kept["LivingRoom_0"] == "arm chair, arm chair, no sofa"


@needs_lists
def test_a_room_is_furnished_anew_as_wished_around_what_is_kept(
    furnished_house: SceneGraph, tmp_path: Path, run_cli: RunCli
) -> None:
    stage, scene = tmp_path / "house.usda", tmp_path / "scene.json"
    author_stage(furnished_house, stage)
    before = stage.read_bytes()
    done = run_cli("regenerate", stage, *AROUND_THE_BED, "--without", "bed")
    assert done.returncode == 2
    assert "kept and excluded" in done.stderr
    assert stage.read_bytes() == before
    words = ("--graph-out", scene, "--with", "bed, desk", "--without", "wardrobe")
    done = run_cli("regenerate", stage, *AROUND_THE_BED, *words)
    written(done)
    again = ("--graph-out", tmp_path / "again.json", "--with", "chair")
    written(run_cli("regenerate", stage, *AROUND_THE_BED, *again))
    assert read_house(stage).requests == {"Bedroom_0": "chair, bed, desk, no wardrobe"}
    for file in (scene, tmp_path / "again.json"):
        graph = read_scene(file)
        room = next(room for room in graph.rooms if room.name == "Bedroom_0")
        held = Counter(item.category for item in graph.items_of(room.id))
        assert held["bed"] == 1, "the bed that is kept is the bed that is wished"
        assert held["table"], "wished once, and held when the room is furnished again"
        assert not held["cabinet"]


@needs_lists
@pytest.mark.acceptance
def test_a_room_without_a_place_for_what_is_wished_stays_as_it_is(
    furnished_house: SceneGraph, tmp_path: Path, run_cli: RunCli
) -> None:
    """It is refused once all places were tried."""
    stage = tmp_path / "house.usda"
    author_stage(furnished_house, stage)
    before = stage.read_bytes()
    done = run_cli("regenerate", stage, *AROUND_THE_BED, "--with", "three bathtubs, two sofas")
    assert done.returncode == 2
    assert "Bedroom_0: no place was found for" in done.stderr
    assert stage.read_bytes() == before
