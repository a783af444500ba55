"""Sentences, and what has to be true of a house after each; and those that mean nothing."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.base.errors import ChordError
from chord_usd.base.metrics.violations import violations
from chord_usd.base.scene.geometry import to_own
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import Asset, Box, Item, Room, SceneGraph
from chord_usd.line.arrange.asked_edits import carry_out
from chord_usd.line.arrange.asked_leeway import worse
from chord_usd.line.arrange.asked_work import Work
from chord_usd.line.lists.kept_requests import kept_requests
from chord_usd.line.lists.sentences import Understood, understand
from chord_usd.line.stage.author.names import name_rooms
from tests.house_facts import Facts

_FILE = Path(__file__).parents[1] / "fixtures" / "sentences.json"
SENTENCES = json.loads(_FILE.read_text())


class UsualSizes:
    """A database of one piece for each size that is asked for."""

    def in_style(self, name: str) -> UsualSizes:
        return self

    def of_category(self, name: str) -> tuple[Asset, ...]:
        return ()

    def named(self, asset_id: str) -> Asset:
        raise KeyError(asset_id)

    def nearest(
        self,
        name: str,
        size_m: tuple[float, float, float],
        most_height_m: float | None = None,
        **_: object,
    ) -> Asset:
        return Asset(f"{name}_{size_m}", category(name).name, size_m, Path("piece.usda"))


@pytest.fixture(scope="module")
def house(furnished_house: SceneGraph) -> SceneGraph:
    """A house with a little dressing."""
    middle = {room.id: room.polygon_m.mean(axis=0) for room in furnished_house.rooms}

    def thing(name: str, room: str, x: float, y: float, size_m: tuple[float, float, float]) -> Item:
        at = middle[room]
        box = Box((at[0] + x, at[1] + y, category(name).mount_height_m), size_m, 0.0)
        return Item(f"{room}/{name}_0", name, box, room)

    dressing = (
        thing("rug", "room4", 0.0, 0.0, (1.0, 1.5, 0.01)),
        thing("floor_plant", "room5", -1.0, 0.0, (0.4, 0.4, 1.0)),
        thing("picture", "room5", 0.0, -2.28, (0.4, 0.03, 0.5)),
    )
    return replace(furnished_house, dressing=dressing)


@pytest.fixture(scope="module")
def rooms(house: SceneGraph) -> dict[str, Room]:
    return {named.name: named.room for named in name_rooms(house)}


def done(graph: SceneGraph, understood: Understood) -> Work:
    return carry_out(Work(graph, UsualSizes), understood.intents)


def faults(graph: SceneGraph) -> set[tuple[str, str, str]]:
    hard = ("overlap", "out of room", "before an opening")
    return {(one.kind, one.item, one.other) for one in violations(graph) if one.kind in hard}


@pytest.mark.parametrize(
    "said",
    [one for one in SENTENCES if "true" in one],
    ids=lambda one: one["say"][:40],
)
def test_what_is_asked_is_true_afterwards_and_nothing_else_changes(
    said: dict[str, Any], house: SceneGraph, rooms: dict[str, Room]
) -> None:
    work = done(house, understand(said["say"], house, rooms))
    ids = {room.name: room.id for room in house.rooms}
    looks = {place: look.family for place, look in work.looks.items()}
    facts = Facts(house, work.graph, ids, work.styles, sorted(work.locked), looks)
    assert all(facts.is_true(fact) for fact in said["true"])
    assert facts.others_are_still(said)
    assert faults(work.graph) <= faults(house)
    before = Facts(house, house, ids, {}, ())
    assert not all(before.is_true(fact) for fact in said["true"]), "true without doing anything"


@pytest.mark.parametrize(
    "said", [one for one in SENTENCES if "refused" in one], ids=lambda one: one["say"][:40]
)
def test_what_cannot_be_is_refused_and_named(
    said: dict[str, Any], house: SceneGraph, rooms: dict[str, Room]
) -> None:
    with pytest.raises(ChordError) as error:
        done(house, understand(said["say"], house, rooms))
    assert all(word.lower() in str(error.value).lower() for word in said["refused"])


@pytest.mark.parametrize(
    ("sentence", "why"),
    [
        ("", "is empty"),
        ("x" * 10_000, "10000 characters"),
        ("put a desk in bedroom 7", "no room"),
        ("move it to the window", "'it'"),
        ("don't remove the sofa", "'dont'"),
        ("put a desk in bedroom 2 and rotate it 90 degrees", "'it'"),
        ("remove the bed", "Bedroom 1, Bedroom 2"),
        ("put a lamp on the desk in bedroom 1", "in or on"),
        ("turn the desk into a bed", "into something else"),
        ("make the kitchen modern, make the kitchen classic", "contradict"),
        ("put a desk in bedroom 2 and no desk in bedroom 2", "contradict"),
        ("lock the sofa and move the sofa 1 m north", "contradict"),
        ("two beds in bedroom 1", "or in all"),
        ("add 0 chairs to the kitchen", "0 ×"),
        ("add 99 chairs to the living room", "99 ×"),
        ("move the sofa", "whereto"),
        ("move the sofa 1 m", "whereto"),
        ("move the sofa 9 m north", "blocks it"),
        ("remove all the chairs except two", "'except'"),
        ("move the red sofa to the window", "not known here"),
        ("paint the sofa", "into what"),
        ("make the sofa green red", "two colours"),
        ("please hate the sofa", "orders nothing"),
        ("a modern sofa, restyle the sofa", ""),
        ("remove the rug on the stairs", "stairs"),
        ("paint it green", "'it'"),
        ("paint the walls green and the walls of the kitchen red", "contradict"),
        ("make the desk taller", "taller"),
        ("remove a chair next to the window", "there already"),
        ("I hate the sofa", "states something"),
        ("turn the sofa down", "'down' after 'turn'"),
        ("pull the sofa out", "'out' after 'pull'"),
        ("mettez le canapé à la fenêtre", "mettez"),
        ("\x1b[31m移动沙发\u202e", "no meaning"),
    ],
)
def test_no_sentence_is_half_understood(
    sentence: str, why: str, house: SceneGraph, rooms: dict[str, Room]
) -> None:
    with pytest.raises(ChordError) as error:
        done(house, understand(sentence, house, rooms))
    assert why in str(error.value)


WORDS = (
    "put", "remove", "move", "turn", "make", "the", "a", "no", "two", "sofa", "desk", "rug", "bed",
    "chair", "window", "bedroom", "kitchen", "living", "2", "1", "to", "in", "and", ",", "next",
    "by", "from", "with", "90", "degrees", "m", "north", "modern", "it", "there", "swap", "lock",
    "between", "bigger", "smaller", "blue", "oak", "walls", "floor", "left", "replace", "change",
    "different", "one", "paint", "corner", "round", "%", "make", "it",
)  # fmt: skip


@given(words=st.lists(st.sampled_from(WORDS), min_size=1, max_size=9))
def test_any_words_are_understood_as_something_or_refused(
    words: list[str], furnished_house: SceneGraph
) -> None:
    named = {one.name: one.room for one in name_rooms(furnished_house)}
    try:
        understood = understand(" ".join(words), furnished_house, named)
    except ChordError:
        return
    assert understood.intents
    assert all(intent.wording and intent.room for intent in understood.intents)


def test_a_locked_piece_stays(house: SceneGraph, rooms: dict[str, Room]) -> None:
    sofa = next(item for item in house.items if item.category == "sofa")
    understood = understand("remove the sofa", house, rooms)
    with pytest.raises(ChordError, match="locked"):
        carry_out(Work(house, UsualSizes, {sofa.id}), understood.intents)


@pytest.mark.parametrize(
    "sentence",
    [
        "take the sofa away", "take the sofa out", "put the sofa away", "the sofa must go",
        "get the sofa out of the living room", "take the sofa down",
        "I don't like the sofa, take it away", "throw the sofa out",
        "I'm tired of the sofa, remove it",
    ],
)  # fmt: skip
def test_verbs_that_are_parted_by_their_object(
    sentence: str, house: SceneGraph, rooms: dict[str, Room]
) -> None:
    (intent,) = understand(sentence, house, rooms).intents
    (sofa,) = (item.id for item in house.items if item.category == "sofa")
    assert (intent.action, intent.items) == ("remove", (sofa,))


def test_a_slip_of_the_pen_is_read_and_told(house: SceneGraph, rooms: dict[str, Room]) -> None:
    understood = understand("remvoe the sofa", house, rooms)
    assert understood.told == ["remove 1 × sofa from Living Room 1"]
    assert understood.read_as == ("'remvoe' as 'remove'",)


def test_a_dining_chair_stands_at_a_dining_table(house: SceneGraph, rooms: dict[str, Room]) -> None:
    """A desk with a chair in the same room: each word means the chairs at its kind of table."""
    desk = Item("room6/table_0", "table", Box((2.4, 5.6, 0.0), (1.2, 0.6, 0.75), 180.0), "room6")
    seat = Item("room6/chair_9", "chair", Box((2.4, 6.05, 0.0), (0.4, 0.4, 0.9), 0.0), "room6")
    both = replace(house, items=(*house.items, desk, seat))

    def meant(sentence: str) -> set[str]:
        return {one for intent in understand(sentence, both, rooms).intents for one in intent.items}

    assert seat.id not in meant("two dining chairs less")
    assert len(meant("remove all dining chairs")) == 6
    assert meant("remove the desk chair") == {seat.id}


def test_a_bed_and_a_wardrobe_change_places_with_what_belongs_to_the_bed(
    house: SceneGraph, rooms: dict[str, Room]
) -> None:
    work = done(house, understand("swap the bed and the wardrobe in bedroom 1", house, rooms))
    before = {one.id: one.box for one in house.items}
    after = {one.id: one.box for one in work.graph.items}
    bed, wardrobe = (f"room1/{name}_0" for name in ("bed", "cabinet"))
    assert after[bed].yaw_deg == before[wardrobe].yaw_deg
    assert after[wardrobe].yaw_deg == before[bed].yaw_deg
    for one in ("bed_background_0", "bedside_table_0", "bedside_table_1"):
        own = f"room1/{one}"
        assert to_own(after[bed], after[own].center_m[:2]) == pytest.approx(
            to_own(before[bed], before[own].center_m[:2]), abs=1e-6
        )
    assert faults(work.graph) <= faults(house)


def test_a_new_piece_goes_to_the_one_room_of_its_kind(
    house: SceneGraph, rooms: dict[str, Room]
) -> None:
    (intent,) = understand("add a coffee table", house, rooms).intents
    assert intent.room == rooms["LivingRoom_0"].id
    bare = {name: room for name, room in rooms.items() if name != "LivingRoom_0"}
    for said, known in (
        ("add a coffee table", bare),
        ("add a bed", rooms),
        ("add curtains", rooms),
    ):
        with pytest.raises(ChordError, match="in which room"):
            understand(said, house, known)


@pytest.mark.parametrize(
    ("sentence", "told"),
    [
        ("change the sofa color from grey to navy", ["give sofa in Living Room 1 navy"]),
        ("replace the carpet in bedroom 1 with pale oak floors",
         ["give Bedroom 1 floors of pale oak"]),
        ("add a vase of flowers to the lounge", ["add 1 × vase to Living Room 1"]),
        ("replace the sofa", ["replace sofa in Living Room 1 by 1 × other sofa"]),
        ("add a dining table with two chairs",
         ["add 1 × dining table to Dining Room 1", "add 2 × chair to Dining Room 1"]),
        ("add a coffee table and a fridge",
         ["add 1 × coffee table to Living Room 1", "add 1 × fridge to Kitchen 1"]),
        ("turn the sofa to face the window", ["turn sofa in Living Room 1 to the window"]),
        ("rotate the sofa", ["turn sofa in Living Room 1 by 90° counter-clockwise"]),
        ("make the sofa bigger. Dark leather.",
         ["replace sofa in Living Room 1 by 1 × sofa of a larger size, dark leather"]),
    ],
)  # fmt: skip
def test_a_sentence_means_one_thing(
    sentence: str, told: list[str], house: SceneGraph, rooms: dict[str, Room]
) -> None:
    assert understand(sentence, house, rooms).told == told


@pytest.mark.parametrize(
    ("sentence", "note"),
    [
        ("move the bed in bedroom 1 20 cm to the left", "with its bed background, bedside table"),
        ("move the dining table in the dining room 50 cm to the left", "35 cm instead of 50 cm"),
    ],
)
def test_what_comes_nearest_to_what_was_asked_is_done_and_said(
    house: SceneGraph, rooms: dict[str, Room], sentence: str, note: str
) -> None:
    intents = understand(sentence, house, rooms).intents
    work = done(house, understand(sentence, house, rooms))
    assert any(note in line for line in work.notes), work.notes
    assert not worse(house, work.graph)
    assert faults(work.graph) <= faults(house)
    assert set(intents[0].items) <= set(work.moved)


def test_what_makes_the_house_worse_is_done_only_where_nothing_else_is_left(
    house: SceneGraph, rooms: dict[str, Room]
) -> None:
    understood = understand("move the dining table in the dining room to the left", house, rooms)
    first = carry_out(Work(house, UsualSizes, judge=lambda *_: ()), understood.intents)
    seen = []

    def boxes(graph: SceneGraph) -> dict[str, Box]:
        return {item.id: item.box for item in graph.items}

    def judge(before: SceneGraph, after: SceneGraph) -> list[str]:
        seen.append(after)
        return ["worse"] if boxes(after) == boxes(first.graph) else []

    second = carry_out(Work(house, UsualSizes, judge=judge), understood.intents)
    assert boxes(second.graph) != boxes(first.graph)
    always = Work(house, UsualSizes, judge=lambda *_: ["worse"])
    assert boxes(carry_out(always, understood.intents).graph) == boxes(first.graph)
    assert len(seen) > 1


@pytest.mark.parametrize(
    ("before", "sentence", "after"),
    [
        ("", "add a desk to bedroom 1", "desk"),
        ("no desk, single bed", "add a desk to bedroom 1", "single bed, desk"),
        ("desk", "no desk in bedroom 1", "no desk"),
        ("", "add a mirror to bedroom 1", ""),
        ("", "add a bedside table to bedroom 1", "bedside table, bedside table, bedside table"),
    ],
)
def test_what_an_edit_adds_is_asked_for_from_then_on(
    house: SceneGraph, rooms: dict[str, Room], before: str, sentence: str, after: str
) -> None:
    intents = understand(sentence, house, rooms).intents
    then = [item.category for item in house.items_of(rooms["Bedroom_0"].id)]
    now = [*then, *(one.new.category for one in intents if one.action == "add" and one.new)]
    assert kept_requests(before, intents, then, now) == after


def test_a_piece_without_a_room_is_that_of_the_room_where_it_belongs(
    house: SceneGraph, rooms: dict[str, Room]
) -> None:
    (rug,) = (item for item in house.dressing if item.category == "rug")
    living = next(room.id for room in house.rooms if room.kind == "living")
    twice = replace(rug, id=f"{living}/rug_0", room_id=living)
    two = replace(house, dressing=(*house.dressing, twice))
    (intent,) = understand("remove the rug", two, rooms).intents
    assert intent.items == (twice.id,)
    for said in ("remove the bed", "remove the rugs"):  # of two bedrooms; of which of two rooms
        with pytest.raises(ChordError, match="may be that of"):
            understand(said, two, rooms)


@pytest.mark.parametrize("name", ["kitchen", "living room", "balcony"])
def test_a_question_about_a_room_is_answered_with_what_it_has(
    house: SceneGraph, rooms: dict[str, Room], name: str
) -> None:
    room = rooms[f"{name.title().replace(' ', '')}_0"]
    own = [item.category.replace("_", " ") for item in house.items_of(room.id)]
    understood = understand(f"what is in the {name}?", house, rooms)
    assert not understood.intents
    assert all(f"× {one}" in understood.answer for one in own)
    assert own or "no furniture" in understood.answer


def test_a_share_of_a_growth_is_a_growth(house: SceneGraph, rooms: dict[str, Room]) -> None:
    understood = understand("make the wardrobe in bedroom 1 bigger", house, rooms)
    old = next(item for item in house.items if item.id == understood.intents[0].items[0])

    def lengths(graph: SceneGraph) -> list[float]:
        here = (item for item in graph.items_of(old.room_id) if item.category == old.category)
        return [item.box.size_m[0] for item in here if item.box != old.box]

    def judge(_before: SceneGraph, after: SceneGraph) -> list[str]:
        return ["too long" for length_m in lengths(after) if length_m > usual_m - 0.05]

    usual_m = max(lengths(carry_out(Work(house, UsualSizes, judge=lambda *_: ()),
                                    understood.intents).graph))  # fmt: skip
    less = carry_out(Work(house, UsualSizes, judge=judge), understood.intents)
    assert old.box.size_m[0] < max(lengths(less.graph)) < usual_m - 0.05
