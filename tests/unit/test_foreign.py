"""Readers of other people's houses: what stands where in theirs stands there in ours."""

from __future__ import annotations

import gzip
import io
import json
import math
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from chord_usd.base.errors import ChordError, SceneError
from chord_usd.base.metrics.rooms import out_of_room
from chord_usd.base.scene.chord_json import scene_from_json, scene_to_json
from chord_usd.base.scene.geometry import footprint_polygon, front_direction, room_polygon
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import WALL_THICKNESS_M
from chord_usd.workshop.data.box_scenes import LEFT_OUT
from chord_usd.workshop.data.foreign import (
    Models,
    foreign_houses,
    house_from_record,
    read_models_file,
)
from chord_usd.workshop.data.threed_front import category_of, kind_of, labels_by_name
from tests.foreign_records import flat_lines, front_house, procthor_house

MODELS = Models(categories={"m1": "King-size Bed", "m2": "Floor Lamp"})


def test_a_house_of_3d_front_keeps_its_rooms_and_known_pieces() -> None:
    house = house_from_record(front_house(), MODELS)
    (room,) = house.rooms
    assert room.kind == "bedroom"
    assert room_polygon(room).area == pytest.approx(12.0, abs=0.01)
    (bed,) = house.items
    assert bed.category == "bed"
    assert bed.box.size_m == (1.8, 2.1, 1.0)
    assert out_of_room(house) == []
    # Its front looks away from the wall at z = 0, into the room, which lies at negative y.
    assert np.allclose(front_direction(bed.box.yaw_deg), (0.0, -1.0))


FAR = (1e308, -1e308, 1e30, math.inf, math.nan)


@pytest.mark.parametrize("far", FAR)
def test_coordinates_beyond_reach_never_meet_geometry(far: float) -> None:
    """GEOS has no end with some of them."""
    front, procthor = front_house(), procthor_house()
    front["mesh"][0]["xyz"][5] = far
    procthor["rooms"][0]["floorPolygon"][1]["z"] = far
    lines = flat_lines()
    lines[0][2] = far
    room = {"room_type": "bedroom", "floor": [[0, 0], [0, 4], [3, far], [3, 0]], "objects": []}
    for record in (front, procthor, room, {"id": "flat", "lines": lines}):
        with pytest.raises(ChordError, match="coordinate"):
            house_from_record(record, MODELS)
    # Also pieces: their places meet rooms.
    front = front_house()
    front["scene"]["room"][0]["children"][1]["pos"][0] = far
    with pytest.raises(SceneError, match="coordinate"):
        house_from_record(front, MODELS)


@pytest.mark.parametrize("angle_deg", [0.0, 90.0, 180.0, -90.0, 30.0])
def test_a_turn_in_3d_front_is_our_yaw(angle_deg: float) -> None:
    (bed,) = house_from_record(front_house(angle_deg), MODELS).items
    # A model that is turned by a about y looks along (sin a, cos a) in x and z.
    angle = math.radians(angle_deg)
    expected = (math.sin(angle), -math.cos(angle))
    assert np.allclose(front_direction(bed.box.yaw_deg), expected, atol=1e-6)


def test_remap_table_names_categories_of_the_palette() -> None:
    assert set(labels_by_name().values()) <= {"", *CATEGORIES}
    assert category_of(" nightstand ") == "bedside_table"
    assert category_of("Pendant Lamp") is category_of("pendant_lamp") is None
    # ATISS spells 3D-FRONT's categories without blanks, and has short names for them.
    long = category_of("Bookcase / jewelry Armoire")
    assert category_of("bookcase/jewelry armoire") == category_of("bookshelf") == long == "cabinet"
    assert kind_of("LivingDiningRoom") == "living"
    assert kind_of("SomethingElse") == "unknown"


SIZES = Models(sizes={"Bed_1": (1.6, 2.0, 0.9), "Toilet_1": (0.4, 0.7, 0.8)})


def test_a_house_of_procthor_gets_walls_and_keeps_its_pieces_in_their_rooms() -> None:
    house = house_from_record(procthor_house(), SIZES)
    assert [room.kind for room in house.rooms] == ["bedroom", "bathroom"]
    faces = [room_polygon(room) for room in house.rooms]
    assert faces[0].distance(faces[1]) == pytest.approx(WALL_THICKNESS_M)
    assert [item.category for item in house.items] == ["bed", "bedside_table", "toilet"]
    assert out_of_room(house) == []
    for item in house.items:
        assert room_polygon(house.plan.room(item.room_id)).intersects(footprint_polygon(item.box))


def endless_floor(house: dict[str, Any]) -> None:
    house["mesh"][0]["faces"] *= 3000


def floor_named_often(house: dict[str, Any]) -> None:
    """15 MB of JSON took 21 GiB."""
    house["scene"]["room"][0]["children"] *= 3000


def floor_of_many_rooms(house: dict[str, Any]) -> None:
    house["mesh"][0]["faces"] *= 100
    house["scene"]["room"] *= 100


@pytest.mark.parametrize("change", [endless_floor, floor_named_often, floor_of_many_rooms])
def test_floors_of_endless_triangles_are_refused(change: Callable[[dict[str, Any]], None]) -> None:
    """300,000 of them took minutes to join."""
    house = front_house()
    change(house)
    with pytest.raises(SceneError, match="triangles"):
        house_from_record(house, MODELS)


def one_room_twice(house: dict[str, Any]) -> None:
    house["scene"]["room"] *= 2


def two_rooms_in_one_place(house: dict[str, Any]) -> None:
    (room,) = house["scene"]["room"]
    house["scene"]["room"].append({**room, "instanceid": "another"})


def piece_of_no_size(house: dict[str, Any]) -> None:
    house["scene"]["room"][0]["children"][1]["scale"] = [0.0, 1.0, 1.0]


def mirrored_piece(house: dict[str, Any]) -> None:
    house["scene"]["room"][0]["children"][1]["scale"] = [-1.0, 1.0, 1.0]


@pytest.mark.parametrize(
    "change", [one_room_twice, two_rooms_in_one_place, piece_of_no_size, mirrored_piece]
)
def test_what_is_imported_can_be_read(change: Callable[[dict[str, Any]], None]) -> None:
    """One such house in a folder made every other verb refuse the folder."""
    record = front_house()
    assert scene_from_json(scene_to_json(house_from_record(record, MODELS))).items
    change(record)
    try:
        house = house_from_record(record, MODELS)
    except SceneError:
        return
    scene_from_json(scene_to_json(house))


def test_fronts_of_procthor_look_where_unity_turns_them() -> None:
    bed, _, toilet = house_from_record(procthor_house(), SIZES).items
    assert np.allclose(front_direction(bed.box.yaw_deg), (0.0, -1.0), atol=1e-9)
    assert np.allclose(front_direction(toilet.box.yaw_deg), (1.0, 0.0), atol=1e-9)


def test_openings_of_procthor_lie_where_their_hole_is() -> None:
    door, window = house_from_record(procthor_house(), SIZES).openings
    assert (door.kind, window.kind) == ("door", "window")
    assert np.allclose(door.box.center_m, (4.0, 1.45, 0.0))
    assert door.box.size_m == pytest.approx((0.9, WALL_THICKNESS_M, 2.1))
    assert door.box.yaw_deg == pytest.approx(90.0)
    assert set(door.room_ids) == {"room|1", "room|2"}
    assert np.allclose(window.box.center_m, (2.0, 0.0, 0.9))
    assert window.room_ids == ("room|1",)


OBJECT_TYPES = ("double_bed", "nightstand", "pendant_lamp")


def test_boxes_stand_where_3d_front_has_them(tmp_path: Path) -> None:
    """The same bedroom as front_house, as ATISS keeps it: around its middle, sizes halved."""
    (folder := tmp_path / "rooms" / "MasterBedroom-1").mkdir(parents=True)
    angle = math.radians(30.0)
    (bed,) = house_from_record(front_house(30.0), MODELS).items
    np.savez_compressed(
        folder / "boxes.npz",
        # Columns after the names are start and end.
        class_labels=np.eye(5, dtype=np.float32)[[0, 2, 4]],
        translations=np.array([[0.0, 0.5, -0.45], [1.5, 2.2, 1.0], [0, 0, 0]], np.float32),
        sizes=np.array([[0.9, 0.5, 1.05], [0.2, 0.2, 0.2], [1, 1, 1]], np.float32),
        angles=np.array([[angle], [0.0], [0.0]], np.float32),
        floor_plan_vertices=np.array([[0, 0, 0], [4, 0, 0], [4, 0, 3], [0, 0, 3]], float),
        floor_plan_faces=np.array([[0, 1, 2], [0, 2, 3]]),
        floor_plan_centroid=np.array([2.0, 0.0, 1.5]),
        scene_type="masterbedroom",
    )
    stats = tmp_path / "dataset_stats.txt"
    stats.write_text(json.dumps({"object_types": OBJECT_TYPES}))
    (found,) = foreign_houses(tmp_path / "rooms", read_models_file(stats))
    assert found.house, found.why
    assert found.name == "MasterBedroom-1"
    (room,), (own,) = found.house.rooms, found.house.items
    assert room.kind == "bedroom"
    assert room_polygon(room).bounds == pytest.approx((-2.0, -1.5, 2.0, 1.5), abs=1e-3)
    assert own.category == "bed"
    assert own.box.size_m == pytest.approx(bed.box.size_m)
    assert own.box.yaw_deg == pytest.approx(bed.box.yaw_deg)
    x_m, y_m, z_m = own.box.center_m
    assert (x_m + 2.0, y_m - 1.5, z_m) == pytest.approx(bed.box.center_m)
    assert found.house.extra[LEFT_OUT] == {"pendant_lamp": 1}


SAMPLED = {
    "class_labels": ["double_bed", "nightstand", "end"],
    "translations": [[[0, 0.5, 0], [1.2, 0.3, 0], [9, 9, 9]]],
    "sizes": [[[1, 0.5, 1], [0.2, 0.3, 0.2], [1, 1, 1]]],
    "angles": [[[0.0], [0.0], [0.0]]],
}


def test_a_sample_without_a_floor_gets_the_one_around_its_boxes() -> None:
    house = house_from_record(SAMPLED, Models())
    assert [item.category for item in house.items] == ["bed", "bedside_table"]
    assert room_polygon(house.rooms[0]).bounds == pytest.approx((-1.0, -1.0, 1.4, 1.0))


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("sizes", [[1, 1, 1]]),
        ("angles", [[0.0, 1.0]] * 3),
        ("class_labels", [[1.0, 0.0]] * 3),
        ("class_labels", ["end"] * 3),
        ("translations", [["x"] * 3] * 3),
        ("sizes", [[math.inf] * 3] * 3),
    ],
)
def test_boxes_that_do_not_fit_each_other_are_refused(key: str, value: object) -> None:
    with pytest.raises(SceneError):
        house_from_record({**SAMPLED, key: value}, Models(object_types=OBJECT_TYPES))


@pytest.mark.parametrize(
    "array",
    [np.array([{}], object), b"\x93NUMPY\x01\x00", b"no array", np.lib.format.magic(9, 9)],
)
def test_arrays_of_strangers_are_not_unpickled(tmp_path: Path, array: object) -> None:
    path = tmp_path / "boxes.npz"
    data = io.BytesIO()
    if isinstance(array, bytes):
        data.write(array)
    else:
        np.save(data, array, allow_pickle=True)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("sizes.npy", data.getvalue())
    (found,) = foreign_houses(path, Models())
    assert "no array" in found.why


def test_an_array_is_as_long_as_its_bytes(tmp_path: Path) -> None:
    path = tmp_path / "boxes.npz"
    data = io.BytesIO()
    header = {"descr": "<f8", "fortran_order": False, "shape": (2**40,)}
    np.lib.format.write_array_header_1_0(data, header)
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("sizes.npy", data.getvalue() + bytes(16))
    (found,) = foreign_houses(path, Models())
    assert "no array" in found.why


def test_every_format_is_known_by_its_keys(tmp_path: Path) -> None:
    room = {
        "id": "r-1", "room_type": "bedroom", "floor": [[0, 0], [4, 0], [4, 3], [0, 3]],
        "objects": [{"pos": [2, 0, 1.05], "rot": [0, 0, 0, 1], "size": [1.8, 1, 2.1],
                     "category": "Double Bed"}],
    }  # fmt: skip
    records: list[object] = [room, front_house(), procthor_house(), room, {"rooms": 3}, [1]]
    path = tmp_path / "mixed.jsonl.gz"
    path.write_bytes(gzip.compress("\n".join([*map(json.dumps, records), "{"]).encode()))
    found = list(foreign_houses(path, MODELS))
    assert [bool(own.house) for own in found] == [True, True, True, True, False, False, False]
    assert all(own.why for own in found if own.house is None)
    assert len({own.name for own in found}) == len(found)
    assert found[0].name == "r-1"
    assert found[1].name == "house-1"


@pytest.mark.parametrize("key", ["rooms", "walls", "objects", "doors", "windows"])
def test_a_house_of_procthor_without_a_key_says_which(key: str) -> None:
    record = procthor_house()
    del record[key]
    with pytest.raises(SceneError):
        house_from_record(record, SIZES)


def test_files_of_models_are_told_apart(tmp_path: Path) -> None:
    front, procthor = tmp_path / "model_info.json", tmp_path / "asset-database.json"
    front.write_text(json.dumps([{"model_id": "m1", "category": "Desk"}]))
    assets = {"Bed": [{"assetId": "Bed_1", "boundingBox": {"x": 1.6, "y": 0.9, "z": 2.0}}]}
    procthor.write_text(json.dumps(assets))
    assert read_models_file(front).categories == {"m1": "Desk"}
    assert read_models_file(procthor).sizes == {"Bed_1": (1.6, 2.0, 0.9)}
    procthor.write_text('{"Bed": 3}')
    with pytest.raises(SceneError, match=r"asset-database\.json"):
        read_models_file(procthor)
