"""What the Blender panel does with houses on disk: none is overwritten, none is left half made."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from blender_addon.core import layer, library, revisions, swaps
from blender_addon.core.claim import LOCK, Claims
from blender_addon.core.edits import Changes
from blender_addon.core.errors import InputError


@pytest.fixture
def house(tmp_path: Path) -> Path:
    """A file that is as good as a house here."""
    file = tmp_path / "häuser [1]" / "house.usda"
    file.parent.mkdir()
    file.write_text("first", encoding="utf-8")
    return file


def test_a_new_house_never_takes_the_place_of_one(house: Path) -> None:
    claims = Claims()
    made = claims.take_new(house.parent)
    assert made == house.parent.with_name("häuser [1] 2")
    (made / "house.usda").touch()
    claims.release()
    assert Claims().take_new(house.parent).name == "häuser [1] 3"


def test_a_file_in_the_way_is_passed(tmp_path: Path) -> None:
    (tmp_path / "flat").touch()
    claims = Claims()
    assert claims.take_new(tmp_path / "flat") == tmp_path / "flat 2"
    assert claims.take_new(tmp_path / "flat" / "below") == tmp_path / "flat" / "below"
    claims.release()


def test_folders_that_stay_empty_go_and_no_others(tmp_path: Path) -> None:
    mine, full, empty = tmp_path / "mine", tmp_path / "a" / "full", tmp_path / "b" / "empty"
    mine.mkdir()
    claims = Claims()
    for folder in (mine, full, empty):
        assert claims.take(folder)
    (full / "house.usda").touch()
    claims.drop_empty()
    assert not empty.parent.exists()
    assert not list(mine.iterdir()), "was there before"
    assert not Claims().take(full), "still claimed"
    claims.release()
    assert (full / "house.usda").is_file()
    assert not (mine / LOCK).exists()


def test_an_earlier_state_comes_back_and_the_later_one_too(house: Path) -> None:
    first = revisions.revision(house)
    revisions.keep(house)
    house.write_text("second", encoding="utf-8")
    second = revisions.revision(house)
    revisions.keep(house)
    for state, text in ((first, "first"), (second, "second"), (second, "second")):
        revisions.put_back(house, state)
        assert house.read_text(encoding="utf-8") == text
    assert {one.name for one in house.parent.iterdir()} == {house.name, revisions.FOLDER}


def test_what_somebody_else_wrote_stays(house: Path) -> None:
    first = revisions.revision(house)
    revisions.keep(house)
    house.write_text("by hand", encoding="utf-8")
    with pytest.raises(InputError, match="changed outside"):
        revisions.put_back(house, first)
    assert house.read_text(encoding="utf-8") == "by hand"
    revisions.put_back(house, revisions.revision(house))


def test_so_many_states_are_kept_as_can_be_undone(house: Path) -> None:
    for number in range(revisions.KEPT + 3):
        house.write_text(str(number), encoding="utf-8")
        revisions.keep(house)
    assert len(list((house.parent / revisions.FOLDER).iterdir())) == revisions.KEPT


def test_changes_of_others_are_not_replaced_nor_taken_away(house: Path) -> None:
    file = layer.edits_file(house)
    for text in (
        "#usda 1.0",
        layer.layer_text("h", Changes()).replace('"schema": 2', '"schema": 3'),
    ):
        file.write_text(text, encoding="utf-8")
        for changes in (Changes(), Changes(locked=("/House/Rooms/A_0/Furniture/Bed_0",))):
            with pytest.raises(InputError, match="left alone"):
                layer.write_changes(house, changes)
        assert file.read_text(encoding="utf-8") == text


def test_a_folder_of_a_model_is_completed_and_not_replaced(tmp_path: Path, house: Path) -> None:
    usd = tmp_path / "lib" / "Bed_A" / "Bed_A.usda"
    usd.parent.mkdir(parents=True)
    usd.touch()
    note = house.parent / "assets" / "Bed_A" / "note.txt"
    note.parent.mkdir(parents=True)
    note.touch()
    swaps.bring_model(usd, house)
    assert note.is_file()
    assert (note.parent / "Bed_A.usda").is_file()
    assert [one.name for one in note.parent.parent.iterdir()] == ["Bed_A"]


def test_a_library_takes_nobodys_place(tmp_path: Path) -> None:
    """`assets build` replaces the folder of the models."""
    assert library.library_folder(tmp_path / "new") == tmp_path / "new"
    (tmp_path / "models").mkdir()
    own = library.library_folder(tmp_path)
    assert own == tmp_path / library.NAME
    (own / library.MODELS).mkdir(parents=True)
    entries = {"assets": [{"id": "a", "category": "bed", "path": "a.usda"}]}
    (own / library.MODELS / library.INDEX).write_text(json.dumps(entries))
    for name in ("bed.blend", "bed.blend1", library.CATALOGS):
        (own / name).touch()
    assert library.library_folder(tmp_path) == own, "built before"
    assert library.library_folder(own) == own
    (own / "my kitchen.blend").touch()
    with pytest.raises(InputError, match="holds other files"):
        library.library_folder(tmp_path)


def test_a_model_brings_no_other_files_and_leaves_those_that_are_there(tmp_path: Path) -> None:
    source, home = tmp_path / "models" / "Bed", tmp_path / "home"
    for folder in (source / "textures", home / "assets" / "Bed"):
        folder.mkdir(parents=True)
    (source / "Bed.usda").write_text("a bed")
    (source / "textures" / "oak.png").write_bytes(b"oak")
    (source / "id_rsa").write_text("secret")
    (source / "key.png").symlink_to(source / "id_rsa")
    (home / "assets" / "Bed" / "payload.usdc").write_text("drawn by hand")
    (source / "payload.usdc").write_text("drawn by us")
    brought = swaps.bring_model(source / "Bed.usda", home / "house.usda")
    assert brought == "assets/Bed_2/Bed.usda"
    assert swaps.bring_model(source / "Bed.usda", home / "house.usda") == brought
    files = {str(one.relative_to(home)) for one in home.rglob("*") if one.is_file()}
    assert files == {
        "assets/Bed/payload.usdc", "assets/Bed_2/Bed.usda", "assets/Bed_2/payload.usdc",
        "assets/Bed_2/textures/oak.png",
    }  # fmt: skip
    assert (home / "assets" / "Bed" / "payload.usdc").read_text() == "drawn by hand"


def test_only_revisions_are_cleared_away(tmp_path: Path) -> None:
    house = tmp_path / "house.usda"
    (tmp_path / revisions.FOLDER).mkdir()
    note = tmp_path / revisions.FOLDER / "house-notes.txt"
    note.write_text("a remark")
    for number in range(revisions.KEPT + 3):
        house.write_text(str(number))
        revisions.keep(house)
    assert note.read_text() == "a remark"
    assert len(list((tmp_path / revisions.FOLDER).iterdir())) == revisions.KEPT + 1
