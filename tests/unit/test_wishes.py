"""What somebody wants in a room: read, matched to rooms and categories, and looked for."""

from __future__ import annotations

import math
from contextlib import suppress

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Box, Item, Plan, Room, RoomKind, frozen_array
from chord_usd.line.lists.house import Drafts, furnish_by_lists
from chord_usd.line.lists.list_sampler import ListDrawer
from chord_usd.line.lists.pieces import (
    CATEGORY_ORDER,
    PIECES,
    Around,
    frame_of,
    of_length,
    pieces_of,
)
from chord_usd.line.lists.vocabulary import WORDS, named
from chord_usd.line.lists.wishes import (
    SLACK_M,
    Asked,
    Piece,
    Wishes,
    asked_in,
    furniture_asked,
    read_furniture,
    read_pieces,
    rooms_meant,
)
from tests.every import for_every
from tests.unit.test_lists import Chance

DESK = WORDS["desk"]


def room(id_: str, kind: RoomKind, side_m: float = 4.0, name: str = "") -> Room:
    corners = [(0, 0), (side_m, 0), (side_m, side_m), (0, side_m)]
    return Room(id_, kind, frozen_array(corners), name)


HOUSE = {
    "Bedroom_0": room("a", "bedroom", 3.0, "Kinder"),
    "Bedroom_1": room("b", "bedroom", 5.0),
    "Bedroom_2": room("c", "bedroom", 4.0, "Schlafen 2 (Gast)"),
    "Kitchen_0": room("k", "kitchen"),
    "Bathroom_0": room("w", "bathroom"),
    "Room_0": room("u", "unknown"),
}


def told(wishes: Wishes) -> tuple[list[str], list[str]]:
    return [one.word for one in wishes.wanted], [one.word for one in wishes.excluded]


def test_every_category_has_a_word_and_its_own_name_is_one() -> None:
    worded = {row.name for row in CATEGORIES.values() if row.words}
    assert {one.category for one in WORDS.values()} == worded >= set(CATEGORY_ORDER)
    for name in worded:
        found = named(CATEGORIES[name].label.lower().split())
        assert found
        assert found.category == name


@pytest.mark.parametrize(
    ("text", "wanted", "excluded"),
    [
        ("double bed, desk", ["double bed", "desk"], []),
        ("two chairs and a pair of bedside tables", ["chair"] * 2 + ["bedside table"] * 2, []),
        ("2x chairs & desk.", ["chair", "chair", "desk"], []),
        ("no sofa or tv cabinet, 2 chairs", ["chair", "chair"], ["sofa", "tv cabinet"]),
        ("a bed without bedside tables", ["bed"], ["bedside table"]),
        ("without a sofa and two chairs", ["chair", "chair"], ["sofa"]),
        ("0 chairs", [], ["chair"]),
        ("chests of drawers; ".rstrip("; "), ["chest of drawers"], []),
        ("King-Size bed, two-seater sofa", ["king size bed", "two seater sofa"], []),
        ("zwei Stühle, kein Sofa", ["stuhl", "stuhl"], ["sofa"]),
        ("un lit double et deux tables de chevet", ["lit double"] + ["table de chevet"] * 2, []),
        ("dos sillas y un escritorio, sin sofá", ["silla", "silla", "escritorio"], ["sofa"]),
        ("uma cama de casal e duas cadeiras", ["cama de casal", "cadeira", "cadeira"], []),
        ("två stolar och ett skrivbord", ["stol", "stol", "skrivbord"], []),
        ("kaksi tuolia, ilman sohvaa", ["tuoli", "tuoli"], ["sohva"]),
        ("双人床、两把椅子，不要沙发", ["双人床", "椅子", "椅子"], ["沙发"]),
        ("2つの椅子、ソファなし", ["椅子", "椅子"], ["ソファ"]),
    ],
)
def test_pieces_are_heard(text: str, wanted: list[str], excluded: list[str]) -> None:
    assert told(read_pieces(text)) == (wanted, excluded)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is empty"),
        (" , ", "names no piece"),
        ("deskk", "'deskk' is no piece that is known; expected desk"),
        ("red sofa", "expected sofa"),
        ("double desk", "is no piece"),
        ("an elephant", "such as bed"),
        ("plant", "stands on tables"),
        ("-2 chairs", "is no piece"),
        ("2.5 chairs", "is no piece"),
        ("desk, no", "followed by nothing"),
        ("10000 chairs", "at most 24"),
        ("desk, " * 10_000, "at most 2000"),
        ("\x1b[31mdesk\udc80", "is no piece"),
    ],
)
def test_what_is_not_understood_is_told(text: str, words: str) -> None:
    with pytest.raises(ChordError) as caught:
        read_pieces(text)
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


@given(st.text(max_size=60))
def test_any_text_is_heard_or_refused(text: str) -> None:
    for read in (read_pieces, read_furniture, lambda said: rooms_meant(said, HOUSE)):
        with suppress(ChordError):
            assert read(text)


def test_what_is_to_be_left_out_needs_no_no() -> None:
    assert told(read_pieces("desk", "sofa, no tv")) == (["desk"], ["sofa", "tv"])
    assert told(read_pieces(None, "two chairs")) == ([], ["chair"])


@pytest.mark.parametrize(
    ("name", "ids"),
    [
        ("Bedroom_2", "c"), ("bedroom_0", "a"), ("Bedroom 1", "a"), ("bedroom two", "b"),
        ("second bedroom", "b"), ("Bedroom", "b"), ("master bedroom", "b"), ("Schlafzimmer 3", "c"),
        ("kinder", "a"), ("schlafen 2 gast", "c"), ("every bedroom", "abc"), ("bedrooms", "abc"),
        ("Küche", "k"), ("卧室", "b"), ("卧室 3", "c"), ("Room 1", "u"), ("every room", "abckwu"),
    ],
)  # fmt: skip
def test_rooms_are_found_as_people_call_them(name: str, ids: str) -> None:
    assert "".join(one.id for one in rooms_meant(name, HOUSE)) == ids


@pytest.mark.parametrize("name", ["Bedroom 4", "Bedroom 0", "Sauna 2", "Spaceship", "3 bedrooms"])
def test_a_room_that_is_not_there_is_told_with_those_that_are(name: str) -> None:
    with pytest.raises(ChordError, match=r"expected one of Bedroom_0, Bedroom_1, .*Room_0"):
        furniture_asked(read_furniture(f"{name}: desk"), HOUSE)


def test_wishes_of_a_room_come_together() -> None:
    text = "every bedroom: no sofa; Bedroom 1: double bed, desk; Kinder: chair\nkitchen: table"
    asked = furniture_asked(read_furniture(text), HOUSE)
    first = asked["a"]
    assert [piece.category for piece in first.wanted] == ["bed", "table", "chair"]
    assert first.wanted[0].length_m == (1.3, math.inf)
    assert first.excluded == {"sofa", "sofa_background"}
    assert first.room == "Bedroom_0"
    assert [piece.category for piece in asked["k"].wanted] == ["dining_table"]
    assert not asked["b"].wanted


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("bedroom 1: desk, no desk", "Bedroom_0: desk: wanted and excluded at once"),
        ("bedrooms: desk; bedroom 2: no tables", "Bedroom_1: desk and table: wanted and excl"),
        ("bedrooms: 20 chairs; bedroom 2: 20 chairs", "Bedroom_1: 40 pieces .* at most 24"),
        ("desk", "names no room"),
        ("Bedroom 1:", "is empty"),
        (" ; ", "is empty"),
    ],
)
def test_furniture_that_cannot_be_is_told(text: str, words: str) -> None:
    with pytest.raises(ChordError, match=words):
        furniture_asked(read_furniture(text), HOUSE)


def item(category: str, length_m: float = 1.0) -> Item:
    return Item(f"{category}/{length_m}", category, Box((0, 0, 0), (length_m, 1, 1), 0), "a")


def test_what_is_kept_cannot_be_excluded() -> None:
    with pytest.raises(ChordError, match="kept and excluded"):
        asked_in("Bedroom_0", HOUSE["Bedroom_0"], read_pieces(None, "sofa"), [item("sofa")])


def test_what_is_missing_is_found_by_category_number_and_length() -> None:
    single, any_bed, king = (
        Piece("bed", (0, 1.3)), Piece("bed"), Piece("bed", (1.75, math.inf)),
    )  # fmt: skip
    asked = Asked((any_bed, single, king))
    assert not asked.missing([item("bed", 1.9), item("bed", 1.0), item("bed", 1.2)])
    assert asked.missing([item("bed", 1.9), item("bed", 1.8), item("bed", 1.5)]) == (single,)
    assert asked.missing([item("bed", 1.0), item("bed", 1.2)]) == (king,)
    assert not Asked((king,)).missing([item("bed", 1.75 - SLACK_M / 2)])
    assert asked.missing([item("sofa")]) == (single, any_bed, king)


@pytest.mark.parametrize("fixed", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("yaw_deg", [0.0, 90.0, 180.0, 45.0])
def test_a_piece_becomes_as_long_as_it_shall_be(fixed: float, yaw_deg: float) -> None:
    own = HOUSE["Bedroom_1"]
    frame = frame_of(own)
    bed = Item("bed", "bed", Box((2.5, 2.5, 0), (1.8, 2.1, 0.9), yaw_deg), "b")
    (element,) = pieces_of([bed], frame)
    around = Around(frame, np.zeros((0, 4)), np.zeros(0, int), np.zeros(3, int), np.zeros(1))
    for length_m in ((0.0, 1.3), (2.0, math.inf), (1.45, 1.6)):
        found = of_length(element, around, length_m, fixed)
        x0, y0, x1, y1 = found.values[1:]
        long, deep = (x1 - x0, y1 - y0) if yaw_deg % 180 != 90 else (y1 - y0, x1 - x0)
        assert length_m[0] - 1e-9 <= long * 0.05 <= length_m[1] + 1e-9
        assert deep == pytest.approx(2.1 / 0.05, abs=1)


def test_lists_hold_pieces_as_long_as_they_are_wanted() -> None:
    own = HOUSE["Bedroom_1"]
    drawer = ListDrawer(Chance(), PIECES, "")  # type: ignore[arg-type]
    asked = Asked((Piece("bed", (0.9, 1.0)), Piece("table")))
    found = furnish_by_lists(Plan((own,), ()), drawer, Drafts(3, 4), {own.id: asked})
    assert not asked.missing(found.items)


@for_every("word", sorted(WORDS))
def test_kept_words_are_read_as_they_were_meant(word: str) -> None:
    piece = WORDS[word]
    if CATEGORIES[piece.category].rank is not None:
        for wishes in (Wishes((piece, piece)), Wishes((), (piece,)), Wishes((piece,), (DESK,))):
            read = read_pieces(wishes.in_words())
            meant = [[p.category for p in said] for said in wishes]
            assert [[p.category for p in said] for said in read] == meant
            assert [p.length_m for p in read.wanted] == [p.length_m for p in wishes.wanted]


def test_the_last_wish_of_a_category_holds() -> None:
    kept = read_pieces("bed, two chairs, no sofa, no wardrobe")
    new = read_pieces("sofa, one chair", "bed")
    assert new.after(kept, {"cabinet"}).in_words() == "sofa, chair, no bed"
    assert Wishes().after(kept) == kept


def test_an_edit_takes_back_the_wishes_that_it_goes_against() -> None:
    kept = read_pieces("two chairs, desk, no sofa, no wardrobe")
    before, after = ["chair", "chair", "desk"], ["chair", "desk", "double_sofa"]
    sofa = kept.excluded[0].category
    lost = kept.without_lost(before, [*after[:2], sofa])
    assert lost.in_words() == "chair, desk, no wardrobe"
    assert kept.without_lost(["desk"], ["desk"]) == kept, "never held, so never taken away"
