"""edit on a stage: what a sentence says is done in the rooms that it means, and nowhere else."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import pytest
from pxr import Gf, Sdf, Usd

import chord_usd
from chord_usd.base.errors import ChordError, OutputError, StageError
from chord_usd.base.runtime.alone import alone_with
from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.base.scene.units import wrap_deg
from chord_usd.cli import DONE, NOT_HELD, main
from chord_usd.line.arrange.asked_places import Floor
from chord_usd.line.pipeline.edit_house import edit, read_sentence
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_stage import check_stage, worse
from chord_usd.line.stage.edit.staged_house import read_house
from tests.bare_stage import write_bare_stage


@pytest.fixture
def house(staged_house: Path, tmp_path: Path) -> Path:
    """A copy of the shared house, to change."""
    return Path(shutil.copytree(staged_house.parent, tmp_path / "house")) / "house.usda"


def prims(path: Path) -> dict[str, str]:
    """The text of each room, by name, and of the rest of the layer."""
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    rooms = layer.GetPrimAtPath("/House/Rooms").nameChildren
    return {room.name: room.GetAsText() for room in rooms}


def files(path: Path) -> dict[str, bytes]:
    """What lies beside a stage."""
    beside = [one for one in path.parent.rglob("*") if one.is_file() and one != path]
    return {str(one): one.read_bytes() for one in beside if not one.name.startswith(".")}


def only(path: Path, category: str, room: str) -> Item:
    house = read_house(path)
    own = house.graph.items_of(house.room_ids[room])
    (found,) = (item for item in own if item.category == category)
    return found


@pytest.mark.parametrize(
    ("sentence", "rooms"),
    [
        ("put a desk in bedroom 2", {"Bedroom_1"}),
        ("carry the armchair from the balcony into the living room", {"Balcony_0", "LivingRoom_0"}),
        ("remove the coffee table and swap the toilet and the washbasin",
         {"LivingRoom_0", "Bathroom_0"}),
    ],
)  # fmt: skip
def test_rooms_that_are_not_meant_stay_byte_for_byte(
    sentence: str, rooms: set[str], house: Path
) -> None:
    before, beside, report = prims(house), files(house), check_stage(house)
    reading, _, done = edit(house, sentence, house)
    after = prims(house)
    assert set(reading.rooms) == {name for name in before if after[name] != before[name]} == rooms
    assert files(house).items() >= beside.items()
    assert done == check_stage(house)
    assert not worse(report, done)


def test_what_is_added_is_asked_for_when_its_room_is_furnished_again(house: Path) -> None:
    edit(house, "put a desk in bedroom 2", house)
    assert read_house(house).requests == {"Bedroom_1": "desk"}
    chord_usd.open(house).undo()
    assert not any(read_house(house).requests.values())


def test_a_piece_is_turned_where_it_stands_with_all_that_it_wears(house: Path) -> None:
    before = only(house, "leisure_sofa", "Balcony_0")
    chord_usd.open(house).edit("rotate the armchair on the balcony by 90 degrees clockwise")
    after = only(house, "leisure_sofa", "Balcony_0")
    assert (after.id, after.room_id) == (before.id, before.room_id)
    assert after.box.center_m == pytest.approx(before.box.center_m, abs=1e-6)
    turned_deg = wrap_deg(after.box.yaw_deg - before.box.yaw_deg)
    assert turned_deg == pytest.approx(-90, abs=1e-6)


def test_colours_are_worn_by_what_was_said_alone_and_undone_in_words(house: Path) -> None:
    text, before = house.read_bytes(), read_house(house)
    edit(house, "make the sofa blue, and the living room walls sage green", house)
    after = read_house(house)
    sofa = only(house, "sofa", "LivingRoom_0").id
    assert {own for own in after.colours if after.colours[own] != before.colours.get(own)} == {sofa}
    assert "blue" in after.colours[sofa] or "navy" in after.colours[sofa]
    stage = Usd.Stage.Open(str(house))
    walls = stage.GetPrimAtPath("/House/Rooms/LivingRoom_0")
    worn = walls.GetVariantSet("wallMaterial").GetVariantSelection()
    assert worn.startswith("Plaster_")
    look = json.loads((house.parent / "materials" / worn / "look.json").read_text())
    assert look["family"] == "plaster"
    reading, *_ = edit(house, "Undo that, please.", house)
    assert reading.understood.told[0].startswith("taken back: edit make the sofa blue")
    assert house.read_bytes() == text


def test_a_question_is_answered_and_writes_nothing(
    house: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = house.read_bytes()
    main(["edit", str(house), "what is in the living room?", "--json", "--progress", "none"])
    told = json.loads(capsys.readouterr().out)
    assert "1 × sofa" in told["answer"]
    assert (told["understood"], told["written"], told["rooms"]) == ([], False, [])
    assert house.read_bytes() == text


def test_a_piece_that_is_not_known_is_named_with_the_nearest_by_meaning(house: Path) -> None:
    with pytest.raises(ChordError, match=r"no 'chesterfield' in the catalogue.*sofa"):
        edit(house, "add a chesterfield to the living room", house)


def test_what_would_break_the_certificate_changes_nothing(
    house: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Floor, "obstacle_at", lambda *_: "")
    text, beside = house.read_bytes(), files(house)
    with pytest.raises(StageError, match=r"worse: .*Sofa_0 runs into .*CoffeeTable_0"):
        edit(house, "move the coffee table 0.5 m towards the sofa", house)
    assert (house.read_bytes(), files(house)) == (text, beside)


def test_a_lock_binds_until_it_is_taken_off(house: Path) -> None:
    text = house.read_bytes()
    edit(house, "lock the sofa", house)
    assert read_house(house).locked_in("LivingRoom_0") == ["Sofa_0"]
    with pytest.raises(ChordError, match="locked"):
        edit(house, "remove the sofa", house)
    edit(house, "unlock the sofa", house)
    assert house.read_bytes() == text


def test_rooms_are_written_as_a_layer_of_edits_shows_them(house: Path, tmp_path: Path) -> None:
    edits = tmp_path / "edits.usda"
    stage = Usd.Stage.CreateNew(str(edits))
    stage.GetRootLayer().subLayerPaths.append(str(house))
    stage.SetDefaultPrim(stage.GetPrimAtPath("/House"))
    path_of = {item_id: path for path, item_id in read_house(house).item_ids.items()}
    sofa, chair = (
        stage.GetPrimAtPath(path_of[only(house, category, room).id])
        for category, room in (("sofa", "LivingRoom_0"), ("leisure_sofa", "Balcony_0"))
    )
    for prim in (sofa, chair):
        at = prim.GetAttribute("xformOp:translate")
        at.Set(at.Get() + Gf.Vec3d(0.01, 0, 0))
    stage.GetRootLayer().Save()
    path, shown_m = sofa.GetPath(), sofa.GetAttribute("xformOp:translate").Get()
    before = prims(house)
    _, done, _ = edit(house, "remove the coffee table", house, edits=edits)
    written = Sdf.Layer.FindOrOpen(str(house)).GetPrimAtPath(path)
    assert written.attributes["xformOp:translate"].default == pytest.approx(shown_m)
    assert str(path) in done.taken_over
    assert prims(house)["Balcony_0"] == before["Balcony_0"]


def test_of_two_edits_at_once_the_second_is_refused(house: Path) -> None:
    text = house.read_bytes()
    with alone_with(house), pytest.raises(OutputError, match="somebody else"):
        edit(house, "remove the sofa", house)
    assert house.read_bytes() == text


def test_a_dry_run_says_what_is_understood_and_writes_nothing(
    house: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = house.read_bytes()
    words = ["edit", str(house), "remvoe the coffee table", "--dry-run", "--json"]
    held = check_stage(house).holds
    assert main([*words, "--progress", "none"]) == (DONE if held else NOT_HELD)
    told = json.loads(capsys.readouterr().out)
    assert [one["told"] for one in told["understood"]] == [
        "remove 1 × coffee table from Living Room 1"
    ]
    assert told["rooms"] == ["LivingRoom_0"]
    assert told["read_as"] == ["'remvoe' as 'remove'"]
    assert (told["written"], told["certificate"]["holds"]) == (False, held)
    assert house.read_bytes() == text


@pytest.mark.parametrize(
    ("sentence", "why"),
    [
        ("replace the toilet by a washing machine", "Bathroom_0 lacks toilet"),
        ("turn the sofa to the window", "Sofa_0 is turned away"),
        ("move the coffee table 20 m west", "blocks it"),
    ],
)
def test_what_makes_a_house_worse_is_refused_with_its_place_unless_forced(
    sentence: str, why: str, house: Path
) -> None:
    text, beside = house.read_bytes(), files(house)
    with pytest.raises(ChordError, match=why) as refused:
        edit(house, sentence, house)
    with pytest.raises(ChordError) as tried:
        edit(house, sentence, house, dry_run=True)
    assert str(tried.value) == str(refused.value)
    assert (house.read_bytes(), files(house)) == (text, beside)
    if "worse" in str(refused.value):
        *_, report = edit(house, sentence, house, force=True)
        assert any(why in flaw for flaw in report.flaws)
        assert house.read_bytes() != text


def test_what_breaks_a_clause_of_a_standard_alone_is_refused_unless_forced(
    staged_graph: SceneGraph, tmp_path: Path
) -> None:
    """The certificate and the planning table ask for less floor before furniture."""
    made = replace(staged_graph.provenance, configuration={"standard": "DIN 18040-2"})
    path = author_stage(replace(staged_graph, provenance=made), tmp_path / "h.usda", seed=3).path
    text, before, words = path.read_bytes(), check_stage(path), "put a desk in bedroom 2"
    with pytest.raises(StageError, match=r"Bedroom_1: .*DIN 18040-2, rooms, furniture"):
        edit(path, words, path)
    assert path.read_bytes() == text
    *_, report = edit(path, words, path, force=True)
    assert not worse(before, report)
    assert path.read_bytes() != text


def test_a_refusal_is_one_line_and_an_exit_code(
    house: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = house.read_bytes()
    words = ["edit", str(house), "varnish the sofa", "--progress", "none"]
    assert main(words) == 2
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.startswith("error: ")
    assert "'varnish'" in told.err
    assert len(told.err.splitlines()) == 1
    assert house.read_bytes() == text


def test_a_house_by_another_program_is_refused(furnished_house: SceneGraph, tmp_path: Path) -> None:
    path = write_bare_stage(furnished_house.plan, tmp_path / "other.usda")
    assert read_sentence(path, "put a desk in bedroom 2").rooms == ("Bedroom_1",)
    with pytest.raises(StageError, match="not in this layer"):
        edit(path, "put a desk in bedroom 2", path)


def test_what_is_new_in_a_house_that_opens_opens(staged_graph: SceneGraph, tmp_path: Path) -> None:
    path = author_stage(staged_graph, tmp_path / "house.usda", seed=3, articulation="jointed").path
    _, done, report = edit(path, "put a chest of drawers in the corridor", path)
    (new,) = done.added
    house = read_house(path)
    (at,) = (one for one, item_id in house.item_ids.items() if item_id == new)
    stage = Usd.Stage.Open(str(path))
    prim = stage.GetPrimAtPath(at)
    assert prim.GetVariantSet("articulation").GetVariantSelection() == "jointed"
    assert prim.GetChild("Joints").GetChildren()
    assert not [one for one in (*report.faults, *report.flaws) if at in one]
