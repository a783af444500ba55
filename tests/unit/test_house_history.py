"""The history of a house: every state comes back byte for byte, and no change is lost."""

from __future__ import annotations

import json
import random
from pathlib import Path

import pytest

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime import house_history
from chord_usd.base.runtime.alone import alone_with
from chord_usd.base.runtime.house_history import (
    Deed,
    amend,
    go_to,
    read_history,
    recorded,
    redo,
    undo,
)


@pytest.fixture
def house(tmp_path: Path) -> Path:
    """A house with a shell."""
    (tmp_path / "house_architecture").mkdir()
    (tmp_path / "house_architecture" / "Walls.usdc").write_bytes(b"walls")
    (tmp_path / "house.usda").write_text("as made")
    return tmp_path / "house.usda"


def change(house: Path, text: str) -> None:
    with recorded(house, Deed("edit", text)):
        house.write_text(text)


def bytes_of(house: Path) -> dict[str, bytes]:
    files = (one for one in house.parent.rglob("*") if ".chord-usd.history" not in one.parts)
    return {str(one): one.read_bytes() for one in files if one.is_file()}


def test_every_state_comes_back_byte_for_byte(house: Path) -> None:
    rng, states = random.Random(7), {}
    edits = house.with_name("house.edits.usda")
    for number in range(2, 12):
        with recorded(house, Deed("edit", str(number))):
            house.write_bytes(rng.randbytes(rng.randrange(2000)))
            if rng.random() < 0.5:
                (house.parent / "house_architecture" / f"{number}.usdc").write_bytes(b"more")
            edits.write_text(str(number)) if number % 3 else edits.unlink(missing_ok=True)
        states[number] = bytes_of(house)
        if rng.random() < 0.4:
            undo(house)
    for number in rng.sample(sorted(states), len(states)):
        go_to(house, number)
        assert bytes_of(house) == states[number]


def test_redo_takes_the_branch_that_was_left_last(house: Path) -> None:
    change(house, "a")
    undo(house)
    change(house, "b")
    undo(house)
    assert (house.read_text(), redo(house).words, house.read_text()) == ("as made", "b", "b")
    go_to(house, 2)
    undo(house)
    assert redo(house).words == house.read_text() == "a"
    with pytest.raises(ChordError, match="nothing that was undone"):
        redo(house)


def test_what_follows_a_change_can_be_made_part_of_it(house: Path) -> None:
    edits = house.with_name("house.edits.usda")
    assert amend(house).changes == ()
    change(house, "a")
    edits.write_text("carried")
    after = bytes_of(house)
    assert [one.verb for one in amend(house).changes] == ["begin", "edit"]
    undo(house)
    assert not edits.exists()
    redo(house)
    assert bytes_of(house) == after


def test_what_is_recorded_within_a_change_is_part_of_it(house: Path) -> None:
    with recorded(house, Deed("by hand")):
        change(house, "a")
        house.with_name("house.edits.usda").write_text("carried")
    assert [one.verb for one in read_history(house).changes] == ["begin", "edit"]
    undo(house)
    redo(house)
    assert house.with_name("house.edits.usda").read_text() == "carried"


def test_what_another_program_changed_is_a_change_and_not_lost(house: Path) -> None:
    change(house, "a")
    house.write_text("by hand")
    assert (undo(house).verb, house.read_text()) == (house_history.OUTSIDE, "a")
    redo(house)
    assert house.read_text() == "by hand"


def test_a_change_that_fails_leaves_no_trace(house: Path) -> None:
    before = sorted(house.parent.rglob("*"))
    with pytest.raises(ZeroDivisionError), recorded(house, Deed("edit")):
        raise ZeroDivisionError
    with recorded(house, Deed("edit", "nothing")):
        pass
    assert sorted(house.parent.rglob("*")) == before
    with pytest.raises(ChordError, match="no earlier state"):
        undo(house)


def test_a_damaged_state_is_refused_and_the_house_stays(house: Path) -> None:
    change(house, "a")
    for kept in (house.parent / ".chord-usd.history" / "house.usda" / "objects").iterdir():
        kept.write_bytes(b"")
    with pytest.raises(ChordError, match="not whole"):
        undo(house)
    assert (house.read_text(), read_history(house).number) == ("a", 2)


def test_a_history_of_another_version_says_so(house: Path) -> None:
    change(house, "a")
    index = house.parent / ".chord-usd.history" / "house.usda" / "changes.json"
    index.write_text(json.dumps({**json.loads(index.read_text()), "format": 0}))
    with pytest.raises(ChordError, match="another version"):
        undo(house)


@pytest.mark.parametrize("name", ["../evil", "/etc/evil", "house_architecture/../../evil", "other"])
def test_a_strangers_history_writes_no_other_file(house: Path, name: str) -> None:
    change(house, "a")
    index = house.parent / ".chord-usd.history" / "house.usda" / "changes.json"
    told = json.loads(index.read_text())
    told["changes"][0]["files"][name] = told["changes"][0]["files"]["house.usda"]
    index.write_text(json.dumps(told))
    with pytest.raises(ChordError, match="is damaged"):
        undo(house)


def test_nobody_undoes_while_the_house_is_changed(house: Path) -> None:
    change(house, "a")
    with alone_with(house), pytest.raises(ChordError, match="being changed by somebody else"):
        undo(house)


def test_a_long_history_forgets_the_earliest(house: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(house_history, "MOST_CHANGES", 5)
    for number in range(9):
        change(house, f"change {number}")
    kept = read_history(house).changes
    assert [one.words for one in kept] == [f"change {number}" for number in range(4, 9)]
    objects = house.parent / ".chord-usd.history" / "house.usda" / "objects"
    assert len(list(objects.iterdir())) == 6  # the shell is one
    for _ in range(4):
        undo(house)
    assert house.read_text() == "change 4"


def test_a_new_house_has_no_history_and_costs_nothing(tmp_path: Path) -> None:
    house = tmp_path / "house.usda"
    change(house, "made")
    assert [one.name for one in tmp_path.iterdir()] == ["house.usda"]


def test_a_layer_of_edits_means_its_house(house: Path) -> None:
    edits = house.with_name("house.edits.usda")
    with recorded(edits, Deed("by hand")):
        edits.write_text("moved")
    undo(edits)
    assert not edits.exists()
    assert house.read_text() == "as made"
