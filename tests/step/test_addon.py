"""The extension in Blender: built, installed, enabled, used, disabled. In processes of its own."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from chord_usd.cli import main
from chord_usd.library.catalogue import designs
from chord_usd.library.database import build_assets
from chord_usd.line.stage.check.check_stage import check_stage
from tests.every import later

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "tests" / "fixtures" / "furnished_house.json"
ROOM = "/House/Rooms/Bedroom_0"
BED, CABINET, TABLE = (
    f"{ROOM}/Furniture/{name}" for name in ("Bed_0", "Cabinet_0", "BedsideTable_0")
)

Told = dict[str, Any]
RunInBlender = Callable[..., Told]

PRETENDS = """#!{python}
import sys
sys.path.insert(0, {folder!r})
from pretends import main
main(*{answers!r})
"""
"""A program that answers as chord-usd does, and has everything ready."""


@pytest.fixture(scope="module")
def untouched(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stage that nobody writes to."""
    stage = tmp_path_factory.mktemp("untouched") / "house.usda"
    assert main(["stage", str(SCENE), "-o", str(stage)]) == 0
    return stage


def copied(stage: Path, folder: Path) -> Path:
    """A house of its own."""
    shutil.copytree(stage.parent, folder)
    return folder / stage.name


@pytest.fixture(scope="module")
def house(untouched: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A stage in a folder whose name has a space and letters that are not ASCII."""
    return copied(untouched, tmp_path_factory.mktemp("addon") / "häuser 1")


@pytest.fixture(scope="module")
def programs(untouched: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Good and bad answers to the question for chord-usd."""
    folder = tmp_path_factory.mktemp("programs é")
    models = folder / "models"
    models.mkdir()
    build_assets(models, chosen=[designs()[0], designs()[1], designs()[300]])
    shutil.copytree(ROOT / "docs", models / "pictures")
    for asset in models.glob("*/*.usda"):
        shutil.copyfile(ROOT / "docs" / "layouts.png", models / "pictures" / f"{asset.stem}.png")
    for name, answer, code, options, pause_s in (
        ("good", "chord-usd 9.0.0", 0, "--outline PNG --text TEXT --furniture WISHES", 0.0),
        # What is killed or cancelled must not be finished first, however busy the machine is.
        ("endless", "chord-usd 9.0.0", 0, "", 600.0),
        ("older", "chord-usd 0.1.0", 0, "--outline PNG", 0.0),
        ("old", "chord-usd 0.0.1", 0, "", 0.0),
        ("wrong", "Python 3.11.2", 0, "", 0.0),
        ("broken", "", 3, "", 0.0),
    ):
        answers = (answer, code, options, str(models), str(untouched.parent), pause_s)
        beside = str(ROOT / "tests" / "blender")
        text = PRETENDS.format(python=sys.executable, folder=beside, answers=answers)
        (folder / name).write_text(text, encoding="utf-8")
        (folder / name).chmod(0o755)
    return folder


@pytest.fixture(scope="module")
def edits(run_in_blender: RunInBlender, house: Path) -> Told:
    """What happened to a house that was changed."""
    return run_in_blender("edits.py", house)


@pytest.fixture(scope="module", params=later("artist"))
def artist(
    run_in_blender: RunInBlender, untouched: Path, tmp_path_factory: pytest.TempPathFactory
) -> Told:
    """What an artist did to the collections of a house."""
    own = copied(untouched, tmp_path_factory.mktemp("artist") / "house")
    return run_in_blender("artist.py", own)


@pytest.fixture(scope="module", params=later("undo"))
def undo(run_in_blender: RunInBlender, programs: Path) -> Told:
    """What was taken back."""
    return run_in_blender("undo.py", ROOT / "examples" / "two_bedrooms.png", programs)


@pytest.fixture(scope="module", params=later("together"))
def together(
    run_in_blender: RunInBlender, house: Path, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Told, Told]:
    """What two Blenders tell that wanted one house."""
    meeting = tmp_path_factory.mktemp("meeting")

    def first() -> Told:
        told = run_in_blender("together.py", "first", house, meeting)
        (meeting / "ended").touch()
        return told

    with ThreadPoolExecutor() as both:
        one = both.submit(first)
        other = both.submit(run_in_blender, "together.py", "second", house, meeting)
        return one.result(), other.result()


@pytest.fixture(scope="module")
def failures(
    run_in_blender: RunInBlender, programs: Path, tmp_path_factory: pytest.TempPathFactory
) -> Told:
    """What is said where something is wrong."""
    plan = tmp_path_factory.mktemp("pläne 1") / "plän 1.png"
    shutil.copyfile(ROOT / "examples" / "two_bedrooms.png", plan)
    return run_in_blender("failures.py", plan, programs)


@pytest.fixture(scope="module", params=later("wishes"))
def wishes(run_in_blender: RunInBlender, house: Path, programs: Path) -> Told:
    """What is offered, told and drawn where a house is made of a text or an open plan."""
    return run_in_blender("wishes.py", ROOT / "examples" / "two_bedrooms.png", programs, house)


def operators(drawn: list[list[str]]) -> list[str]:
    return [line[1] for line in drawn if line[0] == "operator"]


def labels(drawn: list[list[str]]) -> str:
    """All that is written in the panel, as if its lines were one."""
    return " ".join(line[1] for line in drawn if line[0] == "label")


def ways(drawn: list[list[str]]) -> list[str]:
    """The ways to say what house is wanted that can be chosen."""
    return [line[-1] for line in drawn if line[0] == "prop_enum"]


def test_the_house_comes_in_as_a_collection_tree(edits: Told) -> None:
    assert edits["open"] == ""
    house = edits["tree"]["House"]
    assert set(edits["rooms"]) < set(house)
    assert "Cameras" in house
    for room in edits["rooms"]:
        assert f"{room} Architecture" in house[room]
    assert edits["camera"]
    assert edits["shown"] == ["House"], "not the heap of what instances show"


def test_a_piece_with_things_on_it_is_a_collection_of_its_own(edits: Told) -> None:
    for room in edits["rooms"]:
        furniture = edits["tree"]["House"][room].get(f"{room} Furniture", {})
        assert sorted(furniture) == [f"{room} {piece}" for piece in edits["laid"].get(room, [])]
    assert edits["laid"]


def test_an_untouched_house_has_no_edits(edits: Told) -> None:
    assert edits["untouched"] == []


def test_edits_are_an_override_layer_that_comes_back(edits: Told, house: Path) -> None:
    """Read by USD itself, and by Blender when it opens the house again."""
    first = Usd.Stage.Open(str(house.with_name("first.usda")))
    place = UsdGeom.Xformable(first.GetPrimAtPath(edits["bed"])).ComputeLocalToWorldTransform(0)
    assert np.allclose(np.array(place).T, edits["moved"], atol=1e-5)
    assert not first.GetPrimAtPath(edits["other"]).IsActive()
    assert Usd.Stage.Open(str(house)).GetPrimAtPath(edits["other"]).IsActive()
    assert edits["reopened"] == ""
    assert np.allclose(edits["again"][edits["bed"]], edits["moved"], atol=1e-5)
    assert edits["other"] not in edits["again"]


def test_what_is_moved_back_is_no_edit_any_more(edits: Told) -> None:
    assert edits["moved_back"] == [edits["other"]]


def test_another_model_stands_in_the_place_of_the_old_one(edits: Told) -> None:
    assert edits["found"] == edits["swapped"] == ""
    assert edits["offered"] > 2
    assert operators(edits["swap_drawn"]).count("chord.swap") == edits["offered"] - 1
    _, size_m = edits["swap"][edits["bed"]]
    assert np.allclose(edits["swap_reach"], size_m, atol=2e-3)
    assert edits["undone"] == []


def test_the_edited_layer_is_a_valid_stage(edits: Told, house: Path) -> None:
    """Models, looks and lamps as other programs see them."""
    layer = house.with_name("all.usda")
    stage = Usd.Stage.Open(str(layer))
    bed = stage.GetPrimAtPath(edits["bed"])
    usd, _ = edits["swap"][edits["bed"]]
    arcs = Usd.PrimCompositionQuery.GetDirectReferences(bed).GetCompositionArcs()
    assert [Path(arc.GetTargetLayer().realPath).name for arc in arcs] == [Path(usd).name]
    for path, looks in edits["chosen"].items():
        sets = stage.GetPrimAtPath(path).GetVariantSets()
        assert {name: sets.GetVariantSelection(name) for name in looks} == looks
    lamps = [p for p in stage.Traverse() if str(p.GetPath()).startswith(f"{ROOM}/Lights/")]
    assert [p.GetAttribute("inputs:exposure").Get() for p in lamps] == [pytest.approx(1.0)]
    assert check_stage(layer).errors == check_stage(house).errors


def test_looks_lamps_and_locks_are_kept(edits: Told) -> None:
    assert edits["looks"] == edits["evening"] == ""
    assert "no such look" in edits["no_look"]
    assert edits["chosen"]["/House"] == {"lighting": "evening"}
    assert set(edits["chosen"][ROOM]) == {"floorMaterial", "wallMaterial"}
    assert edits["light_after"] == pytest.approx(2.0, abs=1e-3)
    assert edits["locked"] == [f"{ROOM}/Furniture/Cabinet_0"]


def test_edits_of_a_room_can_be_discarded(edits: Told) -> None:
    assert edits["discarded"] == ""
    assert edits["left_after"] == [[], ["/House"], []]
    assert edits["back"]


def test_pictures_are_of_the_room_that_is_picked(edits: Told) -> None:
    assert edits["pictures"] == [["Bedroom_0"], [edits["rooms"][0]], []]
    assert edits["rooms"][0] != "Bedroom_0"
    assert "Choose the room to render" in edits["no_room"]


def test_one_room_can_be_shown_alone(edits: Told) -> None:
    assert edits["solo"] == ["Bedroom_0"]


def test_ceilings_are_hidden_and_shown(edits: Told) -> None:
    assert all(edits["ceilings_hidden"])
    assert edits["ceilings_shown"]
    assert not any(edits["ceilings_shown"])


def test_a_finding_selects_the_culprits(edits: Told) -> None:
    assert edits["check"] == ""
    assert edits["findings"] >= 1
    assert edits["culprits"]
    for path in edits["culprits"]:
        assert any(one.startswith(path) for one in edits["selected"])


def test_what_an_artist_added_outlives_the_house(edits: Told) -> None:
    assert edits["reopen"] == ""
    assert edits["lamp"]


@pytest.mark.parametrize(
    ("case", "words"),
    [
        ("no_plan", "Choose a floor plan"),
        ("nowhere", "There is no file"),
        ("old", "too old"),
        ("wrong", "is not chord-usd"),
        ("broken", "is not chord-usd"),
        ("none", "No chord-usd was found"),
        ("killed", "killed"),
        ("plan_gone", "not there"),
        ("plan_gone_meanwhile", "plän 1.png"),
        ("house_gone", "Generate it again"),
        ("assets_gone", "assets folder"),
        ("second_job", "A job is running"),
    ],
)
def test_what_is_wrong_is_said_in_plain_words(failures: Told, case: str, words: str) -> None:
    assert words in failures[case]


def test_a_check_says_what_was_found_and_what_is_missing(failures: Told) -> None:
    state, answer = failures["check_program"]
    assert state == "FINISHED"
    assert answer.startswith("Found chord-usd 9.0.0")
    assert "is not chord-usd" in failures["checked_broken"]
    assert "Install chord-usd" in failures["checked_broken"]


def test_a_job_that_fails_leaves_the_house(failures: Told) -> None:
    assert failures["error"] == failures["cancelled"] == failures["after_failures"] == ""
    assert failures["still"]


def test_a_job_that_fails_leaves_no_folder(failures: Told) -> None:
    assert failures["left_by_failures"] == ["plän 1"]
    assert failures["left_by_gone_plan"] == failures["left_by_file"] == []


def test_a_house_is_not_written_while_another_has_it(failures: Told) -> None:
    assert failures["claimed"]
    assert all("Another Blender" in one for one in failures["two"])
    assert failures["other_folder"] == ""
    assert failures["folders"] == ["plän 1 2", "plän 1 3"]


def test_two_blenders_do_not_work_on_one_house(together: tuple[Told, Told]) -> None:
    first, second = together
    assert first["open"] == first["save"] == ""
    assert "Another Blender" in second["refused"]
    assert second["empty"]
    assert second["open"] == "", "the first has ended"


def test_a_copy_does_not_count_as_its_original(artist: Told) -> None:
    assert artist["open"] == ""
    assert artist["copied"] == []
    assert artist["renamed"] == [BED]
    assert artist["again"][0] == pytest.approx(artist["bed_x"], abs=1e-5)
    assert artist["copy_shows"], "also when the house is brought in again"


def test_edits_are_found_wherever_the_house_is_put(artist: Told) -> None:
    assert artist["elsewhere"] == [BED, CABINET]
    assert artist["solo"] == ["Bedroom_0"]


def test_a_piece_is_where_it_is_seen_whatever_it_hangs_on(artist: Told) -> None:
    assert artist["hung"] == [BED, CABINET]
    assert artist["pulled"] == [BED, TABLE, CABINET]
    assert np.allclose(artist["again"][1], artist["table"], atol=1e-5)


def test_a_house_goes_as_a_whole_and_takes_nothing_along(artist: Told) -> None:
    assert artist["reopen"] == ""
    assert artist["after"] == artist["objects"]
    assert artist["all"] == artist["cabinets"], "a piece in another collection is gone"
    assert len(artist["stays"]) == 3
    assert artist["varnish"]
    assert artist["collections"] == [True, True]


def test_a_layer_of_somebody_else_is_not_replaced(artist: Told) -> None:
    assert "was not written by this panel" in artist["foreign"]
    assert artist["foreign_kept"] == "#usda 1.0"


def test_one_step_takes_a_new_house_back(undo: Told) -> None:
    assert undo["first"] == undo["second"] == ""
    assert undo["none"] == ["", 0, False]
    assert undo["redone"]
    assert undo["first_again"]


def test_a_second_house_of_a_plan_has_its_own_folder(undo: Told) -> None:
    assert undo["folders"] == ["two_bedrooms", "two_bedrooms 2"]
    assert undo["first_edits"] == [BED, TABLE], "also those that were not saved yet"
    assert undo["saved"] == undo["saved_again"] == ""
    assert undo["second_edits"] == []


def test_a_room_that_is_taken_back_is_taken_back_on_disk(undo: Told) -> None:
    assert undo["regenerated"] == undo["saved_back"] == ""
    assert undo["furnished_anew"]
    assert undo["back_in_scene"]
    assert undo["back_on_disk"]
    assert undo["edits_back"] == [BED, CABINET]


def test_undo_while_a_job_runs_takes_no_saved_edits_back(undo: Told) -> None:
    assert undo["saved_before"] == undo["meanwhile"] == ""
    assert undo["shows_another"]
    saved, stands = undo["kept"]
    assert np.allclose(saved, stands, atol=1e-5)


def test_a_house_that_was_changed_outside_is_not_mixed(undo: Told) -> None:
    for said in undo["changed_outside"]:
        assert "changed outside" in said
    assert undo["not_touched"]
    assert undo["brought_in"] == ""


def test_another_file_ends_the_job_of_this_one(failures: Told) -> None:
    assert not failures["left_running"]
    assert failures["fresh"] == ""


@pytest.mark.parametrize(
    ("state", "has", "has_not"),
    [
        ("nowhere_drawn", "chord.generate", "chord.cancel"),
        ("offered", "chord.generate", "chord.regenerate"),
        ("running", "chord.cancel", "never"),
    ],
)
def test_the_panel_draws_every_state(failures: Told, state: str, has: str, has_not: str) -> None:
    assert has in operators(failures[state])
    assert has_not not in operators(failures[state])


def test_the_panel_of_a_house_has_every_button(edits: Told) -> None:
    assert "chord.regenerate" not in operators(edits["empty"])
    assert {
        "chord.regenerate", "chord.frame_room", "chord.save_edits", "chord.check_house",
        "chord.render", "chord.write_farm_job", "chord.choose_look", "chord.shuffle_looks",
        "chord.build_library",
    } <= set(operators(edits["done"]))  # fmt: skip
    assert {"chord.find_models", "chord.lock_piece", "chord.delete_piece"} <= set(
        operators(edits["swap_drawn"])
    )
    assert "neighbours parted: moved 4 cm" in labels(edits["swap_drawn"])


def test_only_what_the_program_can_is_offered(failures: Told, wishes: Told) -> None:
    assert ways(wishes["older_drawn"]) == ["PLAN", "OUTLINE"]
    assert "chord-usd 0.1.0 cannot plan a home" in labels(wishes["older_drawn"])
    assert ways(wishes["good_drawn"]) == ["PLAN", "TEXT", "OUTLINE"]
    assert "cannot" not in labels(wishes["good_drawn"])
    assert ways(failures["old_drawn"]) == []


def test_a_program_too_old_for_a_text_is_told_and_nothing_begun(wishes: Told) -> None:
    assert "chord-usd 0.1.0 cannot plan a home from a text yet" in wishes["older"]
    assert not wishes["older_folder"]


@pytest.mark.parametrize(
    ("way", "has", "has_not"),
    [("PLAN", {"plan"}, {"outline", "text"}), ("TEXT", {"text"}, {"plan", "outline"}),
     ("OUTLINE", {"outline", "text"}, {"plan"})],
)  # fmt: skip
def test_each_way_has_its_own_fields(
    wishes: Told, way: str, has: set[str], has_not: set[str]
) -> None:
    drawn = {line[1] for line in wishes["fields"][way] if line[0] == "prop"}
    assert has <= drawn
    assert not has_not & drawn


def test_what_was_understood_and_missed_is_shown_with_the_house(wishes: Told) -> None:
    assert wishes["text"] == ""
    assert wishes["named"] == "two bedrooms about 70 m²"
    for words in ("Understood: TWO BEDROOMS,", "Planned: 5 rooms, 65 m²", "Asked for 2 bedrooms,"):
        assert words in labels(wishes["text_drawn"])
        assert words not in labels(wishes["good_drawn"])
        assert words not in labels(wishes["running"])
        assert words not in labels(wishes["refused_drawn"])
        assert words not in labels(wishes["opened"]), "another house"


def test_a_text_that_is_not_understood_is_an_error_like_others(wishes: Told) -> None:
    assert wishes["wordless"].endswith("Describe the home in the text field.\n")
    assert wishes["refused"] == "--text: the text names no rooms; expected rooms, in words"
    assert "the text names no rooms" in labels(wishes["refused_drawn"])
    assert wishes["kept"]


def test_pieces_are_asked_for_where_a_room_is_furnished_anew(wishes: Told) -> None:
    assert wishes["strange"] == "--with: 'elephant' is no piece that is known; expected bed"
    assert "'elephant' is no piece" in labels(wishes["strange_drawn"])
    fields = [line[1] for line in wishes["strange_drawn"] if line[0] == "prop"]
    assert {"wanted", "unwanted"} <= set(fields)
    assert wishes["wished"] == ""


def test_an_open_plan_is_divided_with_a_text_or_without(wishes: Told) -> None:
    assert "Choose an open plan" in wishes["shapeless"]
    assert wishes["outline"] == wishes["outline_text"] == ""
    assert "Understood" not in labels(wishes["outline_drawn"])
    assert "Understood: TWO BATHROOMS" in labels(wishes["outline_text_drawn"])


def test_the_furniture_becomes_an_asset_library(failures: Told) -> None:
    assert failures["library"] == failures["again"] == ""
    assert len(failures["assets"]) == 3
    for asset in failures["assets"].values():
        assert asset["catalog"].strip("0-")
        assert asset["licence"] == "CC0-1.0"
        assert min(asset["preview"]) > 0
        assert asset["meshes"] > 0
    assert failures["once"] == 1
    assert failures["mine"], "what lay in the folder that was chosen"


def gone(*scripts: Told) -> bool:
    return all(not (one["left"] or one["handlers_left"] or one["field_left"]) for one in scripts)


def test_nothing_is_left_when_it_is_disabled(edits: Told, failures: Told, wishes: Told) -> None:
    assert gone(edits, failures, wishes)


def test_nothing_is_left_of_an_artists_work(artist: Told, undo: Told) -> None:
    assert gone(artist, undo)
