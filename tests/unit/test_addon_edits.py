"""What an artist changes in a house: told against the house, kept as a layer, carried over."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from blender_addon.core import edits, layer, swaps


def moved(x: float) -> edits.Matrix:
    return ((1.0, 0.0, 0.0, x), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


BED, DESK = (f"/House/Rooms/Bedroom_{n}/Furniture/Bed_0" for n in (0, 1))


CHAIR = "/House/Rooms/Bedroom_0/Furniture/Chair_0"
ITEM = f"{BED}/Items/Book_0"


def test_only_what_was_touched_is_an_edit() -> None:
    was = {BED: moved(0.0), ITEM: moved(0.0), DESK: moved(1.0), CHAIR: moved(2.0)}
    assert edits.moves(was, was, {}) == {}
    now = {BED: moved(0.5), ITEM: moved(0.0), DESK: moved(1.0)}
    found = edits.moves(was, now, {})
    assert found == {
        BED: edits.Edit(moved(0.0), moved(0.5)),
        CHAIR: edits.Edit(moved(2.0), None),
    }
    assert list(edits.moves(was, {DESK: moved(1.0), CHAIR: moved(2.0)}, {})) == [BED], (
        "what stood on a removed piece is gone with it"
    )


def test_an_edit_that_is_undone_is_none_after_the_house_was_opened_again() -> None:
    changes = edits.Changes(pieces={BED: edits.Edit(moved(0.0), moved(0.5))})
    was = edits.placements_of_house({BED: moved(0.5), DESK: moved(1.0)}, changes)
    assert was == {BED: moved(0.0), DESK: moved(1.0)}
    assert edits.moves(was, {BED: moved(0.0), DESK: moved(1.0)}, {}) == {}


def test_an_edit_of_a_piece_that_the_house_has_no_more_is_passed_over() -> None:
    changes = edits.Changes(pieces={BED: edits.Edit(moved(0.0), moved(0.5))})
    assert edits.placements_of_house({DESK: moved(1.0)}, changes) == {DESK: moved(1.0)}


SWAP = edits.Swap(
    "assets/B/B.usda", (1.6, 2.0, 0.9), (0.0, 0.1), (1.6, 1.8, 1.0), {"colour": "oak"}
)
ROOM = "/House/Rooms/Bedroom_0"
ALL = edits.Changes(
    pieces={
        BED: edits.Edit(moved(0.0), moved(0.25), SWAP),
        CHAIR: edits.Edit(moved(2.0), moved(2.5)),
        DESK: edits.Edit(moved(1.0), None),
    },
    looks={ROOM: {"floorMaterial": "Oak"}, "/House": {"lighting": "evening"}},
    lights={f"{ROOM}/Lights/AreaLight": 2.0},
    locked=(BED,),
)


def test_a_room_furnished_anew_keeps_the_edits_of_what_is_locked() -> None:
    left = edits.without_room(ALL, "Bedroom_0")
    assert set(left.pieces) == {BED, DESK}
    assert left.looks == ALL.looks
    assert set(edits.without_room(ALL, "Bedroom_1").pieces) == {BED, CHAIR}


def test_the_edits_of_a_room_can_be_dropped() -> None:
    left = edits.as_it_was(ALL, "Bedroom_0")
    assert set(left.pieces) == {DESK}
    assert left.looks == {"/House": {"lighting": "evening"}}
    assert left.lights == {}


def test_what_is_done_while_the_program_works_is_carried_over() -> None:
    before = edits.Changes(
        pieces={CHAIR: edits.Edit(moved(2.0), moved(2.5)), DESK: ALL.pieces[DESK]}
    )
    wanted = edits.Changes(pieces={**before.pieces, BED: ALL.pieces[BED]})
    now = edits.Changes(
        pieces={BED: edits.Edit(moved(0.0), moved(9.0)), CHAIR: edits.Edit(moved(2.0), moved(3.0))},
        lights={"lamp": 2.0},
        locked=(DESK,),
    )
    merged = edits.carried_over(wanted, before, now)
    assert merged.pieces == {BED: ALL.pieces[BED], CHAIR: now.pieces[CHAIR]}
    assert merged.lights == {"lamp": 2.0}
    assert merged.locked == (DESK,)
    assert edits.carried_over(wanted, before, before) == wanted


def test_a_look_is_chosen_where_it_belongs() -> None:
    room = edits.with_look(ALL, ROOM, "wallMaterial", "Plaster")
    assert room.looks[ROOM] == {"floorMaterial": "Oak", "wallMaterial": "Plaster"}
    bed = edits.with_look(ALL, BED, "colour", "white")
    assert bed.swaps[BED].looks == {"colour": "white"}
    assert BED not in bed.looks
    assert edits.with_look(ALL, CHAIR, "colour", "white").looks[CHAIR] == {"colour": "white"}


def test_changes_come_back_from_their_layer(tmp_path: Path) -> None:
    house = tmp_path / "hôuse.usda"
    file = layer.write_changes(house, ALL)
    assert file is not None
    assert layer.opened_file(house) == file
    assert layer.house_of(file) == house == layer.house_of(house)
    assert layer.read_changes(house) == ALL
    assert layer.write_changes(house, edits.Changes()) is None
    assert layer.opened_file(house) == house
    assert layer.read_changes(house).is_nothing


@pytest.mark.parametrize("path", ["", "/", "House", "/House//Rooms", "/House/a b", "/House/"])
def test_changes_of_what_no_house_has_are_dropped_when_it_opens(tmp_path: Path, path: str) -> None:
    """Such a layer held `over ""`, which USD does not open, nor the house below it."""
    house = tmp_path / "house.usda"
    looks, lights = {**ALL.looks, path: {"a": "b"}}, {**ALL.lights, path: 2.0}
    file = layer.edits_file(house)
    file.write_text(layer.layer_text("house.usda", replace(ALL, looks=looks, lights=lights)))
    layer.mend_layer(house)
    assert layer.read_changes(house) == ALL
    assert file.read_text() == layer.layer_text("house.usda", ALL)
    kept = file.stat().st_mtime_ns
    layer.mend_layer(house)
    assert file.stat().st_mtime_ns == kept


@pytest.mark.parametrize("text", ["#usda 1.0", "", "string chord_edits = '''{}'''"])
def test_a_foreign_layer_is_left_alone(tmp_path: Path, text: str) -> None:
    house = tmp_path / "house.usda"
    layer.edits_file(house).write_text(text, encoding="utf-8")
    assert layer.read_changes(house).is_nothing


def test_a_swapped_model_stands_as_the_piece_did() -> None:
    """Quarter turn, scaled by two: the offset turns with it, the scale is the model's own."""
    turned: edits.Matrix = (
        (0.0, -2.0, 0.0, 5.0), (2.0, 0.0, 0.0, 3.0), (0.0, 0.0, 2.0, 0.0), (0.0, 0.0, 0.0, 1.0)
    )  # fmt: skip
    placed = swaps.placed(turned, None, SWAP, (1.6, 1.8, 0.5))
    assert placed[0] == pytest.approx((0.0, -1.0, 0.0, 4.9))
    assert placed[1] == pytest.approx((1.0, 0.0, 0.0, 3.0))
    assert placed[2] == pytest.approx((0.0, 0.0, 2.0, 0.0))
    again = swaps.placed(placed, SWAP, SWAP, (1.6, 1.8, 0.5))
    assert edits.same(placed, again), "swapping does not drift"
    assert swaps.raised(placed, 0.2)[2][3] == pytest.approx(0.2)


NEAREST = {
    "id": "Bed_A", "usd": "lib/Bed_A/Bed_A.usda", "size_m": [1.6, 1.8, 0.5],
    "fits": {"center_m": [0.0, 0.1, 0.0], "size_m": [1.6, 1.8, 0.5]},
    "looks": {"colour": ["oak", "white"]}, "picture": "",
}  # fmt: skip


def test_a_swapped_piece_weighs_what_its_size_says(tmp_path: Path) -> None:
    (model,) = swaps.candidates({"assets": [NEAREST]})
    swap = swaps.swap_for(model, (1.6, 2.0, 0.9), "x", "white", 40.0)
    length, width, height = swap.size_m
    changes = edits.Changes(pieces={CHAIR: edits.Edit(moved(0.0), moved(0.0), swap)})
    text = layer.layer_text("house.usda", changes)
    assert f"float physics:mass = {40.0 * length * width * height:.6g}\n" in text
    house = tmp_path / "house.usda"
    layer.write_changes(house, changes)
    assert layer.read_changes(house) == changes
    built_in = edits.Changes(pieces={BED: edits.Edit(moved(0.0), moved(0.0), SWAP)})
    assert "physics:mass" not in layer.layer_text("house.usda", built_in)


def test_a_swap_keeps_the_colour_where_the_model_has_it() -> None:
    (model,) = swaps.candidates({"assets": [NEAREST]})
    assert model.label == "Bed A, 1.60 × 1.80 m"
    assert model.picture is None
    assert swaps.swap_for(model, (1.6, 2.0, 0.9), "x", "white").looks == {"colour": "white"}
    assert swaps.swap_for(model, (1.6, 2.0, 0.9), "x", "blue").looks == {"colour": "oak"}


def test_a_model_is_copied_beside_the_house_once(tmp_path: Path) -> None:
    usd = tmp_path / "lib" / "Bed_A" / "Bed_A.usda"
    usd.parent.mkdir(parents=True)
    usd.write_text("#usda 1.0", encoding="utf-8")
    house = tmp_path / "höuse" / "house.usda"
    for _ in range(2):
        assert swaps.bring_model(usd, house) == "assets/Bed_A/Bed_A.usda"
    assert [file.name for file in (house.parent / "assets").iterdir()] == ["Bed_A"]
    assert (house.parent / "assets" / "Bed_A" / "Bed_A.usda").is_file()
