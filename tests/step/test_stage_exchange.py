"""Houses as IFC, DXF and maps, read again with what reads such files."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
import yaml
from pxr import Usd, UsdGeom
from shapely.geometry import Point

from chord_usd.base.errors import MissingExtraError, OutputError, StageError
from chord_usd.base.metrics.walk import WALKER_RADIUS_M
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Box, Item, Opening, Plan, Room, SceneGraph, frozen_array
from chord_usd.cli import UNUSABLE, main
from chord_usd.line.plan.read import read_plan_file
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.export.exchange.built_house import House, house_of
from chord_usd.line.stage.export.exchange.occupancy import FREE, OCCUPIED, RESOLUTION_M
from chord_usd.line.stage.export.export_stage import export_stage
from chord_usd.workshop.data.houses import random_plan
from tests.bare_stage import write_bare_stage
from tests.plan_alike import likeness

FORMATS = ("ifc", "dxf")


def square(room_id: str, kind: Any, west: float, name: str = "") -> Room:
    """4 by 4 m."""
    corners = [(west, 0.0), (west + 4.0, 0.0), (west + 4.0, 4.0), (west, 4.0)]
    return Room(room_id, kind, frozen_array(corners), name)


def hole(opening_id: str, kind: Any, x: float, y: float, length: float, yaw: float) -> Opening:
    base, height = (0.9, 1.3) if kind == "window" else (0.0, 2.0)
    return Opening(opening_id, kind, Box((x, y, base), (length, 0.24, height), yaw))


ODD_NAMES = ("Ann's \\P{den} 100%% ^I ✓🛋", "Küche; /\\ \"'#1=", "L" * 300)
TWO_ROOMS = Plan(
    (
        square("a", "living", 0.0, ODD_NAMES[0]),
        square("b", "kitchen", 4.24, ODD_NAMES[1]),
        square("c", "store", 8.48, ODD_NAMES[2]),
    ),
    (
        hole("in", "door", 2.0, -0.12, 0.9, 0.0),
        # Opens beside a wall, where an open leaf looks like a closed one.
        hole("between", "door", 4.12, 3.5, 1.0, 90.0),
        hole("double", "door", 6.0, 4.12, 1.8, 180.0),
        hole("w1", "window", 1.0, 4.12, 1.2, 0.0),
        hole("w2", "window", 2.26, 4.12, 1.2, 0.0),
    ),
)
"""Odd names, windows 6 cm apart, and a room without a door."""


def staged(plan: Plan | SceneGraph, folder: Path) -> Path:
    graph = plan.scene() if isinstance(plan, Plan) else plan
    return author_stage(graph, folder / "house.usda").path


@pytest.fixture(scope="module")
def plain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return staged(TWO_ROOMS, tmp_path_factory.mktemp("plain"))


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> tuple[Plan, Path]:
    """Sixty rooms in ten rows, a door from each to the next in its row, a window in each row."""
    rooms, openings = [], []
    for row in range(10):
        for column in range(6):
            corners = np.array([(0, 0), (3, 0), (3, 3), (0, 3)]) + np.array([column, row]) * 3.24
            rooms.append(Room(f"{row}_{column}", "bedroom", frozen_array(corners)))
            x, y = corners[0]
            openings.append(hole(f"door{row}_{column}", "door", x - 0.12, y + 1.5, 0.9, 90.0))
        openings.append(hole(f"window{row}", "window", x + 3.12, y + 1.5, 1.2, 90.0))
    plan = Plan(tuple(rooms), tuple(openings))
    return plan, write_bare_stage(plan, tmp_path_factory.mktemp("large") / "house.usda")


def exported(stage: Path, folder: Path, package: str) -> Path:
    path = folder / (f"house.{package}" if package != "ros" else "map")
    export_stage(stage, path, package)
    return path


# Plans --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("package", FORMATS)
@pytest.mark.parametrize("seed", [4, 11])
def test_a_plan_comes_back_to_a_centimetre(package: str, seed: int, tmp_path: Path) -> None:
    plan = random_plan(np.random.default_rng(seed))
    found = read_plan_file(exported(staged(plan, tmp_path), tmp_path, package))
    assert likeness(found, plan).holds(0.01), likeness(found, plan)


@pytest.mark.parametrize("package", FORMATS)
def test_odd_names_and_near_openings_come_back(package: str, plain: Path, tmp_path: Path) -> None:
    found = read_plan_file(exported(plain, tmp_path, package))
    assert likeness(found, TWO_ROOMS).holds(0.01), likeness(found, TWO_ROOMS)


@pytest.mark.parametrize("package", FORMATS)
def test_a_window_half_behind_a_wall_keeps_its_length(package: str, tmp_path: Path) -> None:
    """A bay's side wall stands behind its end, so that less is cut through than the plan says."""
    corners = [(3.12, 0), (6.5, 0), (6.5, 4), (3.12, 4), (3.12, 2.8), (2.6, 2.8), (2.6, 1.2)]
    room = Room("bay", "living", frozen_array([*corners, (3.12, 1.2)]))
    plan = Plan((room,), (hole("window", "window", 3.0, 3.45, 1.1, 90.0),))
    found = read_plan_file(exported(write_bare_stage(plan, tmp_path / "b.usda"), tmp_path, package))
    assert likeness(found, plan).holds(0.01), likeness(found, plan)


@pytest.mark.parametrize("package", FORMATS)
def test_sixty_rooms_come_back(package: str, large: tuple[Plan, Path], tmp_path: Path) -> None:
    found = read_plan_file(exported(large[1], tmp_path, package))
    assert likeness(found, large[0]).holds(0.01), likeness(found, large[0])


@pytest.mark.parametrize("package", [*FORMATS, "ros"])
def test_the_same_house_is_the_same_bytes(package: str, staged_house: Path, tmp_path: Path) -> None:
    found = []
    for name in ("one", "two"):
        path = exported(staged_house, tmp_path / name, package)
        files = sorted(path.iterdir()) if path.is_dir() else [path]
        found.append([file.read_bytes() for file in files])
    assert found[0] == found[1]


@pytest.mark.parametrize(("package", "module"), [("ifc", "ifcopenshell"), ("dxf", "ezdxf")])
def test_an_extra_that_is_not_there_is_named(
    package: str, module: str, plain: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(MissingExtraError, match=rf"pip install '\.\[{package}\]'"):
        exported(plain, tmp_path, package)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("package", [*FORMATS, "ros"])
@pytest.mark.parametrize("wide_m", [0.0, 5000.0])
def test_what_is_no_house_is_refused(package: str, wide_m: float, tmp_path: Path) -> None:
    """No room at all, or one as wide as a town."""
    stage = Usd.Stage.CreateNew(str(tmp_path / "odd.usda"))
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/House").GetPrim())
    if wide_m:
        floor = UsdGeom.Mesh.Define(stage, "/House/Rooms/R/Architecture/Geometry/Floor")
        floor.CreatePointsAttr([(0, 0, 0), (wide_m, 0, 0), (wide_m, 4, 0), (0, 4, 0)])
        floor.CreateFaceVertexCountsAttr([4])
        floor.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    stage.Save()
    with pytest.raises(StageError, match=r"holds no rooms|more than 500 m"):
        exported(tmp_path / "odd.usda", tmp_path / "out", package)
    assert not (tmp_path / "out").exists()


# IFC ----------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def building(staged_house: Path, tmp_path_factory: pytest.TempPathFactory) -> Any:
    import ifcopenshell

    return ifcopenshell.open(str(exported(staged_house, tmp_path_factory.mktemp("ifc"), "ifc")))


def test_a_building_keeps_to_the_schema(building: Any, plain: Path, tmp_path: Path) -> None:
    import ifcopenshell
    import ifcopenshell.validate

    log = ifcopenshell.validate.json_logger()
    ifcopenshell.validate.validate(building, log)
    odd = ifcopenshell.open(str(exported(plain, tmp_path, "ifc")))
    ifcopenshell.validate.validate(odd, log)
    assert log.statements == []
    identifiers = [one.GlobalId for one in building.by_type("IfcRoot")]
    assert len(set(identifiers)) == len(identifiers)
    assert {one.GlobalId for one in odd.by_type("IfcRoot")}.isdisjoint(identifiers)


def test_a_building_says_what_architects_look_for(building: Any) -> None:
    from ifcopenshell.util.element import get_material, get_psets

    for kind in ("Space", "Wall", "Slab", "Door", "Window"):
        for element in building.by_type(f"Ifc{kind}"):
            sets = get_psets(element)
            assert "IsExternal" in sets[f"Pset_{kind}Common"]
            told = [v for k, v in sets[f"Qto_{kind}BaseQuantities"].items() if k != "id"]
            assert told
            assert min(told) > 0.0
            if kind in ("Wall", "Slab"):
                assert get_material(element).Name
    walls = building.by_type("IfcWall")
    facades = [get_psets(one)["Pset_WallCommon"]["IsExternal"] for one in walls]
    assert any(facades)
    assert not all(facades)


def test_names_survive_in_a_building(plain: Path, tmp_path: Path) -> None:
    import ifcopenshell

    odd = ifcopenshell.open(str(exported(plain, tmp_path, "ifc")))
    said = {space.Description for space in odd.by_type("IfcSpace")}
    assert said == {name[:255] for name in ODD_NAMES}
    assert {space.LongName for space in odd.by_type("IfcSpace")} >= {"Living Room", "Storeroom"}


def test_furniture_of_one_model_shares_its_type_and_mesh(
    building: Any, staged_graph: SceneGraph
) -> None:
    things = [one for one in building.by_type("IfcElement") if one.ContainedInStructure]
    spaced = [o for o in things if o.ContainedInStructure[0].RelatingStructure.is_a("IfcSpace")]
    assert len(spaced) == len(staged_graph.items)
    types = {one.IsTypedBy[0].RelatingType for one in spaced}
    categories = {item.category for item in staged_graph.items}
    # The block of the database, as many categories wear it, and the plain box.
    assert len(types) <= len(categories) + 1
    assert len(building.by_type("IfcRepresentationMap")) == len(types)
    kinds = {one.is_a() for one in spaced}
    assert {"IfcFurniture", "IfcSanitaryTerminal"} <= kinds


def test_furniture_stands_in_a_building_where_it_stood(building: Any, staged_house: Path) -> None:
    import ifcopenshell.geom

    settings = ifcopenshell.geom.settings()
    settings.set("use-world-coords", True)
    stage = Usd.Stage.Open(str(staged_house))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"])
    compared = 0
    for element in building.by_type("IfcElement"):
        told = {
            value.Name: value.NominalValue.wrappedValue
            for relation in element.IsDefinedBy
            if relation.is_a("IfcRelDefinesByProperties")
            and relation.RelatingPropertyDefinition.is_a("IfcPropertySet")
            for value in relation.RelatingPropertyDefinition.HasProperties
        }
        if "Prim" not in told:
            continue
        shape: Any = ifcopenshell.geom.create_shape(settings, element)
        points = np.array(shape.geometry.verts).reshape(-1, 3)
        box = cache.ComputeWorldBound(stage.GetPrimAtPath(told["Prim"])).ComputeAlignedRange()
        assert np.allclose(points.min(axis=0), box.GetMin(), atol=1e-3)
        assert np.allclose(points.max(axis=0), box.GetMax(), atol=1e-3)
        compared += 1
    assert compared > 5


# DXF ----------------------------------------------------------------------------------------------


def test_a_drawing_has_layers_by_kind_and_blocks_by_model(
    staged_house: Path, staged_graph: SceneGraph, tmp_path: Path
) -> None:
    import ezdxf

    document = ezdxf.readfile(exported(staged_house, tmp_path, "dxf"))
    assert document.header["$INSUNITS"] == 6
    assert document.audit().errors == []
    found: dict[str, set[str]] = {}
    for entity in document.modelspace():
        found.setdefault(entity.dxf.layer, set()).add(entity.dxftype())
    assert "ARC" in found["DOORS"]
    assert "MTEXT" in found["ROOMS"]
    assert found["DIMENSIONS"] == {"DIMENSION"}
    inserts = document.modelspace().query("INSERT")
    assert len(inserts) == len(staged_graph.items)
    assert len({insert.dxf.name for insert in inserts}) <= 2
    low, high = (np.array(document.header[name]) for name in ("$EXTMIN", "$EXTMAX"))
    corners = np.concatenate([room.polygon_m for room in staged_graph.rooms])
    assert (low[:2] <= corners.min(axis=0)).all()
    assert (high[:2] >= corners.max(axis=0)).all()
    assert np.ptp([low[:2], high[:2]], axis=0).max() < 3 * np.ptp(corners, axis=0).max()


# Maps ---------------------------------------------------------------------------------------------


class Map:
    """A folder as map_server reads it."""

    def __init__(self, folder: Path) -> None:
        told = yaml.safe_load((folder / "map.yaml").read_text())
        grey = cv2.imread(str(folder / told["image"]), cv2.IMREAD_UNCHANGED)
        taken = (255 - grey.astype(float)) / 255 if not told["negate"] else grey / 255
        self.occupied = taken > told["occupied_thresh"]
        self.free = taken < told["free_thresh"]
        self.resolution, (self.west, self.south, _) = told["resolution"], told["origin"]
        self.rooms = json.loads((folder / "rooms.json").read_text(encoding="utf-8"))
        self.spawns = json.loads((folder / "spawns.json").read_text(encoding="utf-8"))

    def cell(self, x: float, y: float) -> tuple[int, int]:
        column = int(np.floor((x - self.west) / self.resolution))
        return self.free.shape[0] - 1 - int(np.floor((y - self.south) / self.resolution)), column

    def room(self, room_id: str) -> dict[str, Any]:
        return next(room for room in self.rooms["rooms"] if room["id"] == room_id)


def house_at(path: Path) -> House:
    return house_of(Usd.Stage.Open(str(path)))


def test_walls_and_furniture_are_occupied_and_doorways_free(
    staged_house: Path, tmp_path: Path
) -> None:
    seen = Map(exported(staged_house, tmp_path, "ros"))
    house = house_at(staged_house)
    for item in house.graph.items:
        if item.box.center_m[2] < 1.0:
            assert seen.occupied[seen.cell(*item.box.center_m[:2])], item.category
    for opening in house.plan.openings:
        cell = seen.cell(*opening.box.center_m[:2])
        assert (seen.occupied if opening.kind == "window" else seen.free)[cell]
    assert not (seen.free | seen.occupied)[0, 0]  # outside nobody knows
    assert {OCCUPIED, FREE} <= set(np.unique(cv2.imread(str(tmp_path / "map/map.pgm"), -1)))


def test_rugs_are_no_obstacle(tmp_path: Path) -> None:
    rug = Item("rug", "rug", Box((2.0, 2.0, 0.0), (1.5, 1.5, 0.004), 0.0), "a")
    chair = Item("chair", "chair", Box((1.0, 1.0, 0.0), (0.5, 0.5, 0.9), 0.0), "a")
    graph = replace(TWO_ROOMS.scene(), items=(chair,), dressing=(rug,))
    seen = Map(exported(staged(graph, tmp_path), tmp_path, "ros"))
    assert seen.free[seen.cell(2.0, 2.0)]
    assert seen.occupied[seen.cell(1.0, 1.0)]


def test_a_robot_fits_where_it_is_said_to(staged_house: Path, tmp_path: Path) -> None:
    seen = Map(exported(staged_house, tmp_path, "ros"))
    house = house_at(staged_house)
    rows, columns = np.nonzero(~seen.free)
    south = seen.south + (seen.free.shape[0] - 1 - rows) * RESOLUTION_M
    west = seen.west + columns * RESOLUTION_M
    poses = 0
    for room in house.plan.rooms:
        for pose in seen.spawns["rooms"][room.id]:
            off_x = np.maximum(0, np.maximum(west - pose["x"], pose["x"] - west - RESOLUTION_M))
            off_y = np.maximum(0, np.maximum(south - pose["y"], pose["y"] - south - RESOLUTION_M))
            assert np.hypot(off_x, off_y).min() >= WALKER_RADIUS_M - 1e-6
            assert room_polygon(room).contains(Point(pose["x"], pose["y"]))
            assert -np.pi <= pose["yaw"] <= np.pi
            poses += 1
    assert poses >= len(house.plan.rooms)


def test_rooms_and_doors_are_a_graph(plain: Path, tmp_path: Path) -> None:
    seen = Map(exported(plain, tmp_path, "ros"))
    doors = {door["id"]: door for door in seen.rooms["doors"]}
    assert [room["class"] for room in seen.rooms["rooms"]] == ["living", "kitchen", "store"]
    assert [room["name"] for room in seen.rooms["rooms"]] == [
        " ".join(name.split()) for name in ODD_NAMES
    ]
    pairs = sorted(tuple(sorted(door["rooms"])) for door in doors.values())
    assert pairs == [("Kitchen_0",), ("Kitchen_0", "LivingRoom_0"), ("LivingRoom_0",)]
    assert doors[seen.rooms["entrance"]]["rooms"] == ["LivingRoom_0"]
    for room in seen.rooms["rooms"]:
        assert set(room["doors"]) == {d["id"] for d in doors.values() if room["id"] in d["rooms"]}


def test_a_room_without_a_door_is_on_the_map_and_out_of_reach(plain: Path, tmp_path: Path) -> None:
    seen = Map(exported(plain, tmp_path, "ros"))
    store = seen.room("Storeroom_0")
    assert (store["doors"], store["reachable"]) == ([], False)
    assert seen.spawns["rooms"]["Storeroom_0"]
    assert seen.room("Kitchen_0")["reachable"]


def test_rooms_that_touch_are_open_to_each_other(tmp_path: Path) -> None:
    plan = Plan(
        (square("a", "living", 0.0), square("b", "kitchen", 4.0)),
        (hole("in", "door", 2.0, -0.12, 0.9, 0.0),),
    )
    seen = Map(exported(staged(plan, tmp_path), tmp_path, "ros"))
    (seam,) = (door for door in seen.rooms["doors"] if door["kind"] == "open")
    assert sorted(seam["rooms"]) == ["Kitchen_0", "LivingRoom_0"]
    assert (seam["x"], seam["width"]) == pytest.approx((4.0, 4.0), abs=0.05)
    assert seen.room("Kitchen_0")["reachable"]
    assert seen.free[seen.cell(4.0, 2.0)]


def test_sixty_rooms_are_on_the_map(large: tuple[Plan, Path], tmp_path: Path) -> None:
    seen = Map(exported(large[1], tmp_path, "ros"))
    assert len(seen.rooms["rooms"]) == len(seen.spawns["rooms"]) == 60
    assert all(seen.spawns["rooms"].values())


# Targets ------------------------------------------------------------------------------------------


def test_a_folder_of_somebody_else_is_no_map(plain: Path, tmp_path: Path) -> None:
    target = tmp_path / "map"
    target.mkdir()
    (target / "thesis.txt").write_text("years of work")
    for mode in ("new", "replace"):
        with pytest.raises(OutputError, match="holds"):
            export_stage(plain, target, "ros", mode)
    assert [file.name for file in target.iterdir()] == ["thesis.txt"]


def test_a_map_is_written_anew_when_asked(plain: Path, tmp_path: Path) -> None:
    target = exported(plain, tmp_path, "ros")
    with pytest.raises(OutputError, match="overwrite=True"):
        exported(plain, tmp_path, "ros")
    assert main(["export", str(plain), "--for", "ros", "-o", str(target), "--overwrite"]) == 0
    names = {file.name for file in target.iterdir() if not file.name.startswith(".")}
    assert names == {"map.yaml", "map.pgm", "rooms.json", "spawns.json"}


@pytest.mark.parametrize(
    ("package", "target"),
    [
        ("ros", "."), ("ros", "house.usda"), ("ros", "old.ifc"), ("ros", "map.yaml"),
        ("ifc", "house.usda"), ("ifc", "house.ifcx"), ("dxf", "house.dwg"), ("ifc", "link.ifc"),
    ],
)  # fmt: skip
def test_targets_that_cannot_be(
    package: str, target: str, plain: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    home = plain.parent
    monkeypatch.chdir(home)
    before = {file: file.stat().st_mtime_ns for file in home.rglob("*")}
    (tmp_path / "old.ifc").write_text("somebody's")
    (tmp_path / "link.ifc").symlink_to(tmp_path / "old.ifc")
    path = tmp_path / target if target in ("old.ifc", "link.ifc", "map.yaml") else Path(target)
    code = main(["export", "house.usda", "--for", package, "-o", str(path), "--progress", "none"])
    assert code == UNUSABLE
    assert capsys.readouterr().err.startswith("error: ")
    assert {file: file.stat().st_mtime_ns for file in home.rglob("*")} == before
    assert (tmp_path / "old.ifc").read_text() == "somebody's"


def test_an_old_file_is_replaced(plain: Path, tmp_path: Path) -> None:
    (tmp_path / "house.ifc").write_text("of last week")
    assert b"IFC4" in exported(plain, tmp_path, "ifc").read_bytes()
