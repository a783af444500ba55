"""CHOrD JSON: round trips, and errors that name file, element and key."""

from __future__ import annotations

import copy
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.errors import ChordError, PlanError, SceneError
from chord_usd.base.scene import palette
from chord_usd.base.scene.chord_json import (
    json_text,
    plan_from_json,
    plan_to_json,
    read_plan,
    read_scene,
    scene_from_json,
    scene_to_json,
    write_plan,
    write_scene,
)
from chord_usd.base.scene.geometry import footprint, rooms_beside
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.types import (
    ROOM_KINDS,
    Asset,
    Box,
    Edit,
    Facts,
    Item,
    Opening,
    Provenance,
    Room,
    SceneGraph,
    frozen_array,
)

LISTING: dict[str, Any] = {
    "rooms": [
        {
            "roomId": "r1",
            "roomName": "living",
            "roomType": 1,
            "wallPoints": [[0, 0], [500, 0], [500, 400], [0, 400]],
        },
        {
            "roomId": "r2",
            "roomName": "masterbedroom",
            "roomType": 1,
            "wallPoints": [[524, 0], [900, 0], [900, 400], [524, 400]],
        },
        {
            "roomId": "out",
            "roomName": "out_room",
            "roomType": 0,
            "wallPoints": [[-24, -24], [924, -24], [924, 424], [-24, 424]],
        },
    ],
    "windowsDoors": [
        {"type": "door", "pos": [512, 200.5, 0], "length": 95, "width": 12, "height": 210,
         "rotate": 90},
        {"type": "window", "pos": [250, -12, 90], "length": 153.75, "width": 12, "height": 110,
         "rotate": 0},
    ],
    "furniture": [
        {"type": "sofa", "pos": [250, 345.45, 0], "length": 185.3, "width": 90.1, "height": 99,
         "rotate": 0},
        {"type": "Coffee Table", "pos": [250, 200, 0], "length": 94, "width": 76, "height": 45,
         "rotate": 180},
    ],
}  # fmt: skip


# Round trips -------------------------------------------------------------------------------------

lengths = st.floats(0.05, 5.0)
places = st.floats(-50.0, 50.0)
texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=12)
values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False)
    | texts,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
    max_leaves=5,
)  # fmt: skip
extras = st.dictionaries(st.sampled_from(["note", "[1, 2]", "Größe"]), values, max_size=2)
boxes = st.builds(
    Box,
    st.tuples(places, places, st.floats(0, 3)),
    st.tuples(lengths, lengths, lengths),
    st.floats(-360, 360),
)
corners_px = st.tuples(*[st.tuples(places, places)] * 4)
facts = st.builds(
    Facts,
    source_px=st.just(()) | corners_px,
    front_from=st.none() | st.sampled_from(["mark", "wall", "table", "guess"]),
    detected=st.none() | st.booleans(),
    below_sill_m=st.none() | lengths,
    ood=st.none() | lengths,
    edits=st.lists(st.builds(Edit, st.just("neighbours parted"), boxes), max_size=2).map(tuple),
)


@st.composite
def rooms(draw: st.DrawFn, index: int) -> Room:
    radii = np.array(draw(st.lists(st.floats(1.0, 4.0), min_size=3, max_size=9)))
    angles = np.linspace(0, 2 * np.pi, len(radii), endpoint=False)
    polygon = radii[:, None] * np.stack([np.cos(angles), np.sin(angles)], axis=1) + [10 * index, 0]
    name = draw(texts | st.sampled_from(["bedroom 2", "WC", ""]))
    kind = draw(st.sampled_from(ROOM_KINDS))
    # A name that only repeats the kind is not kept: it says nothing.
    return Room(
        f"r{index}", kind, frozen_array(polygon), "" if name == kind else name, draw(extras)
    )


@st.composite
def items(draw: st.DrawFn, index: str, depth: int = 0) -> Item:
    level = palette.HOUSE_CATEGORIES if depth == 0 else palette.TABLE_CATEGORIES
    category = draw(st.sampled_from(level)).name
    children = draw(st.integers(0, 2)) if depth < 2 else 0
    asset = Asset("a", category, (0.5, 0.25, 1.0), Path("assets/a/a.usd"), "CC0-1.0", "né")
    return Item(
        f"item {index}",
        category,
        draw(boxes),
        "r0" if depth == 0 and draw(st.booleans()) else "",
        draw(st.none() | st.just(asset)),
        tuple(draw(items(f"{index}.{n}", depth + 1)) for n in range(children)),
        draw(st.floats(0, 1)),
        draw(facts),
        draw(extras),
    )


@st.composite
def scenes(draw: st.DrawFn) -> SceneGraph:
    count = draw(st.integers(1, 3))
    openings = [
        Opening(f"o{n}", kind, draw(boxes), draw(st.sampled_from([(), ("r0",)])), draw(extras))
        for n, kind in enumerate(("door", "window", "passage"))
    ]
    provenance = st.builds(Provenance, texts, texts, st.integers(0, 9), texts, extras)
    return SceneGraph(
        tuple(draw(rooms(n)) for n in range(count)),
        tuple(openings),
        tuple(draw(items(str(n))) for n in range(draw(st.integers(0, 3)))),
        draw(provenance),
        draw(extras),
    )


def assert_same(first: Any, second: Any) -> None:
    """Equal in everything but rounding to 1e-8 m."""
    if isinstance(first, np.ndarray):
        np.testing.assert_allclose(first, second, rtol=0, atol=1e-8)
    elif isinstance(first, tuple):
        assert len(first) == len(second)
        for one, other in zip(first, second, strict=True):
            assert_same(one, other)
    elif isinstance(first, Room | Opening | Item | SceneGraph | Box | Facts | Edit):
        for key in type(first).__dataclass_fields__:
            assert_same(getattr(first, key), getattr(second, key))
    elif isinstance(first, float):
        assert second == pytest.approx(first, abs=1e-6)
    else:
        assert first == second


@settings(deadline=None, max_examples=40)
@given(scenes())
def test_a_scene_comes_back_as_it_was_written(scene: SceneGraph) -> None:
    text = json_text(scene_to_json(scene))
    again = scene_from_json(json.loads(text))
    assert_same(again, scene)
    assert json_text(scene_to_json(again)) == text


@settings(deadline=None, max_examples=20)
@given(scenes())
def test_a_plan_comes_back_as_it_was_written(scene: SceneGraph) -> None:
    text = json_text(plan_to_json(scene.plan))
    again = plan_from_json(json.loads(text))
    assert_same(again.rooms, scene.rooms)
    assert_same(again.openings, scene.openings)
    assert json_text(plan_to_json(again)) == text


def test_files_round_trip_byte_for_byte(tmp_path: Path) -> None:
    scene = scene_from_json(LISTING)
    write_scene(scene, tmp_path / "a.json")
    write_scene(read_scene(tmp_path / "a.json"), tmp_path / "b.json")
    assert (tmp_path / "a.json").read_bytes() == (tmp_path / "b.json").read_bytes()
    write_plan(scene.plan, tmp_path / "p.json")
    assert_same(read_plan(tmp_path / "p.json").rooms, scene.rooms)


# The listing -------------------------------------------------------------------------------------


def test_the_listing_is_read_in_metres_with_rooms_and_ids_filled_in() -> None:
    scene = scene_from_json(LISTING)
    assert [(room.id, room.kind, room.name) for room in scene.rooms] == [
        ("r1", "living", ""),
        ("r2", "bedroom", "masterbedroom"),
    ]
    assert scene.openings[0].box == Box((5.12, 2.005, 0.0), (0.95, 0.12, 2.1), 90.0)
    assert set(scene.openings[0].room_ids) == {"r1", "r2"}
    assert scene.openings[1].room_ids == ("r1",)
    assert [item.category for item in scene.items] == ["sofa", "coffee_table"]
    assert [item.room_id for item in scene.items] == ["r1", "r1"]
    assert len({item.id for item in scene.items}) == 2


def test_rotate_turns_the_front_from_south_counter_clockwise() -> None:
    data = copy.deepcopy(LISTING)
    data["furniture"][0]["rotate"] = 90
    box = scene_from_json(data).items[0].box
    front = footprint(box)[1:3].mean(axis=0) - np.array(box.center_m[:2])
    np.testing.assert_allclose(front, [box.size_m[1] / 2, 0], atol=1e-12)


def test_the_house_outline_is_no_room_and_is_written_again() -> None:
    plan = plan_from_json(LISTING)
    assert {room.id for room in plan.rooms} == {"r1", "r2"}
    assert plan_to_json(plan)["rooms"][-1] == LISTING["rooms"][2]


def test_unknown_keys_survive() -> None:
    data = copy.deepcopy(LISTING)
    for element in (data, data["rooms"][0], data["windowsDoors"][1], data["furniture"][0]):
        element["fancy"] = {"kept": [1, {"two": "zwei"}]}
    data["rooms"][0]["roomType"] = 7
    out = scene_to_json(scene_from_json(data))
    for element in (out, out["rooms"][0], out["windowsDoors"][1], out["furniture"][0]):
        assert element["fancy"] == {"kept": [1, {"two": "zwei"}]}
    assert out["rooms"][0]["roomType"] == 7


@given(st.integers(0, 3), st.booleans())
def test_clockwise_and_closed_wall_points_are_accepted(start: int, closed: bool) -> None:
    corners = np.roll([[0, 0], [0, 400], [500, 400], [500, 0]], start, axis=0).tolist()
    data = copy.deepcopy(LISTING)
    data["rooms"][0]["wallPoints"] = corners + corners[:1] * closed
    polygon = plan_from_json(data).rooms[0].polygon_m
    assert len(polygon) == 4
    x, y = polygon.T
    assert np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y) / 2 == pytest.approx(20.0)
    np.testing.assert_allclose(polygon[0] * 100, corners[0])


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("living", "living"), ("Living Room", "living"), ("livingroom_2", "living"),
        ("masterbedroom", "bedroom"), ("Bedroom 12", "bedroom"), ("kids' bedroom", "bedroom"),
        ("kitchen", "kitchen"), ("toilet", "wc"), ("laundry", "washroom"),
        ("balcony", "balcony"), ("Entrance hall", "corridor"), ("hall", "corridor"),
        ("walk-in closet", "store"), ("storage", "store"), ("study", "study"),
        ("dining room", "dining"), ("out of ideas", "unknown"), ("", "unknown"),
        ("部屋", "unknown"),
    ],
)  # fmt: skip
def test_room_names_are_understood(name: str, kind: str) -> None:
    assert room_kind(name) == kind


def test_an_unknown_room_name_is_kept() -> None:
    data = copy.deepcopy(LISTING)
    data["rooms"][0]["roomName"] = "Zen garden"
    room = plan_from_json(data).rooms[0]
    assert (room.kind, room.name) == ("unknown", "Zen garden")


def test_rooms_beside_an_opening_are_found_on_both_sides() -> None:
    plan = plan_from_json(LISTING)
    assert rooms_beside(Box((5.12, 2, 0), (0.9, 0.24, 2), 90), plan.rooms) == ("r1", "r2")
    assert rooms_beside(Box((5.12, 2, 0), (0.9, 0.24, 2), -90), plan.rooms) == ("r2", "r1")
    assert rooms_beside(Box((-5, 2, 0), (0.9, 0.24, 2), 90), plan.rooms) == ()


# Errors ------------------------------------------------------------------------------------------

Damage = Callable[[dict[str, Any]], Any]


def at(*path: Any, value: Any) -> Damage:
    def damage(data: dict[str, Any]) -> None:
        inner: Any = data
        for step in path[:-1]:
            inner = inner[step]
        inner[path[-1]] = value

    return damage


def bow_tie(data: dict[str, Any]) -> None:
    data["rooms"][0]["wallPoints"] = [[0, 0], [500, 0], [0, 400], [500, 400]]


def twin_room(data: dict[str, Any]) -> None:
    data["rooms"][1]["roomId"] = "r1"


def twin_items(data: dict[str, Any]) -> None:
    for item in data["furniture"]:
        item["id"] = "same"


def overlap(data: dict[str, Any]) -> None:
    data["rooms"][1]["wallPoints"] = [[300, 0], [900, 0], [900, 400], [300, 400]]


BROKEN: list[tuple[Damage, str]] = [
    (bow_tie, r"room 'r1': wallPoints cross at corner 2; expected a simple polygon. Try: "),
    (twin_room, r"room 'r1': the id 'r1' is taken"),
    (twin_items, r"furniture 'same': the id 'same' is taken"),
    (overlap, r"room 'r2' crosses room 'r1'"),
    (at("rooms", value=[]), r"rooms holds no room"),
    (at("rooms", value={}), r"rooms is an object; expected a list"),
    (at("rooms", 0, value=3), r"room 1: is a number; expected a JSON object"),
    (at("rooms", 0, "wallPoints", value=[[0, 0], [1, 1]]), r"'r1': wallPoints has fewer"),
    (at("rooms", 0, "wallPoints", value=[[0, 0], [9, 0], [5, 0]]), r"'r1': .* area of 0 m2"),
    (at("rooms", 0, "wallPoints", value=[[0, 0], [5, 0], [5, 4], [0, 4]]), r"centimetres"),
    (at("rooms", 0, "wallPoints", value=[[1, 1]] * 4), r"fewer than three corners"),
    (at("rooms", 0, "wallPoints", 1, value=[500]), r"wallPoints\[1\] is not a list of 2"),
    (at("rooms", 0, "wallPoints", 1, 0, value="x"), r"wallPoints\[1\] holds a text"),
    (at("rooms", 0, "wallPoints", 1, 0, value=float("nan")), r"wallPoints\[1\] is nan; .*finite"),
    (at("rooms", 0, "wallPoints", 1, 0, value=1e300), r"wallPoints\[1\] is 1e\+300"),
    (at("rooms", 0, "wallPoints", 1, 0, value=10**400), r"wallPoints\[1\] is inf"),
    (at("rooms", 0, "roomType", value=True), r"roomType is true or false; expected a whole"),
    (at("rooms", 0, "roomKind", value="castle"), r"unknown roomKind 'castle'"),
    (at("rooms", 0, "note", value=[float("inf")]), r"room 'r1': note holds NaN or Infinity"),
    (at("windowsDoors", 0, "type", value="portal"), r"opening 1: unknown type 'portal'.*door"),
    (at("windowsDoors", 1, "length", value=0), r"opening 2: length is 0"),
    (at("windowsDoors", 1, "width", value=-12), r"opening 2: width is -12; expected a positive"),
    (at("windowsDoors", 1, "pos", value=[1, 2]), r"opening 2: pos is not a list of 3"),
    (at("windowsDoors", 1, "roomIds", value=["r9"]), r"room 'r9' does not exist"),
    (at("windowsDoors", 1, "roomIds", value=[9]), r"roomIds holds something else"),
    (at("furniture", 0, "type", value="sofaa"), r"furniture 1: unknown category 'sofaa'.*'sofa'"),
    (at("furniture", 0, "type", value="door"), r"'door' is no furniture"),
    (at("furniture", 0, "type", value="laptop"), r"'laptop' is a tabletop category"),
    (at("furniture", 0, "rotate", value=None), r"furniture 1: rotate is null"),
    (at("furniture", 0, "height", value=float("inf")), r"furniture 1: height is inf"),
    (at("furniture", 0, "roomId", value="out"), r"room 'out' does not exist"),
    (at("furniture", 0, "children", value=[{}]), r"furniture 1: child 1: type is missing"),
    (at("furniture", 0, "asset", value={"id": "a"}), r"furniture 1: asset: size is missing"),
    (at("provenance", value={"seeds": 1}), r"provenance: unknown key 'seeds'"),
]


@pytest.mark.parametrize(("damage", "message"), BROKEN)
def test_broken_files_are_refused_by_name(damage: Damage, message: str, tmp_path: Path) -> None:
    data = copy.deepcopy(LISTING)
    damage(data)
    path = tmp_path / "bad.json"
    path.write_text(json.dumps(data))
    with pytest.raises(SceneError, match=message) as caught:
        read_scene(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("element", ["rooms", "windowsDoors", "furniture"])
def test_every_missing_key_is_named(element: str) -> None:
    for key in LISTING[element][0]:
        data = copy.deepcopy(LISTING)
        del data[element][0][key]
        with pytest.raises(SceneError, match=rf"(r1'|1): {key} is missing"):
            scene_from_json(data)


@pytest.mark.parametrize("key", ["rooms", "windowsDoors", "furniture"])
def test_a_misspelt_key_is_pointed_out(key: str) -> None:
    data = copy.deepcopy(LISTING)
    data[key.swapcase()[:1] + key[1:]] = data.pop(key)
    with pytest.raises(SceneError, match=rf"{key} is missing.*rename '.*' to '{key}'"):
        scene_from_json(data)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "is not JSON"),
        (b"{'a': 1}", "is not JSON .*line 1"),
        (b'{"rooms": [ # inner\n', "without comments"),
        (b"\xff\xfe\x00", "is not text"),
        (b"[" * 100_000, "nested too deeply"),
        (b"[]", "is a list; expected a JSON object"),
        (b"NaN", "is a number"),
    ],
)
@pytest.mark.parametrize(("reader", "error"), [(read_plan, PlanError), (read_scene, SceneError)])
def test_files_that_are_no_chord_json(
    content: bytes, message: str, reader: Callable[[Path], Any], error: type[ChordError],
    tmp_path: Path,
) -> None:  # fmt: skip
    path = tmp_path / "bad.json"
    path.write_bytes(content)
    with pytest.raises(error, match=message):
        reader(path)


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(PlanError, match=r"none\.json: cannot be read \(no such file"):
        read_plan(tmp_path / "none.json")


def test_plan_errors_are_plan_errors() -> None:
    data = copy.deepcopy(LISTING)
    bow_tie(data)
    with pytest.raises(PlanError, match="room 'r1'"):
        plan_from_json(data, "plan.json")


def test_a_scan_of_a_phone_is_refused_as_what_it_is() -> None:
    scan = {key: [] for key in ("walls", "doors", "windows", "openings", "objects", "floors")}
    with pytest.raises(PlanError, match=r"is a RoomPlan scan .* Try: export its floor plan"):
        plan_from_json({"version": 2, **scan})
