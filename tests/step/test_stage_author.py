"""The house as a stage, read back with usd-core."""

from __future__ import annotations

import re
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely
from pxr import Gf, Kind, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdUtils, UsdValidation

from chord_usd.errors import AssetError, OutputError, SceneError, StageError
from chord_usd.geometry import footprint, room_polygon
from chord_usd.looks import load_looks
from chord_usd.stage.author import author_stage
from chord_usd.stage.read import StageSummary, summary
from chord_usd.stage.walls import build_walls
from chord_usd.types import Asset, Box, Item, Provenance, SceneGraph

BLOCK_SIZE_M = (0.5, 0.4, 0.25)


@pytest.fixture(scope="session")
def block(tmp_path_factory: pytest.TempPathFactory) -> Asset:
    """A component with its mesh behind a payload: a block that stands on the origin."""
    folder = tmp_path_factory.mktemp("database") / "Block"
    folder.mkdir()
    length, width, height = BLOCK_SIZE_M
    payload = Usd.Stage.CreateNew(str(folder / "payload.usda"))
    UsdGeom.Xform.Define(payload, "/Block")
    UsdGeom.Scope.Define(payload, "/Block/Geometry")
    mesh = UsdGeom.Mesh.Define(payload, "/Block/Geometry/Body")
    corners = [
        Gf.Vec3f(x * length / 2, y * width / 2, z * height)
        for z in (0, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]  # fmt: skip
    mesh.CreatePointsAttr(corners)
    mesh.CreateFaceVertexCountsAttr([4] * 6)
    mesh.CreateFaceVertexIndicesAttr(
        [3, 2, 1, 0, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7]
    )
    extent = [corners[0], corners[6]]
    mesh.CreateExtentAttr(extent)
    payload.SetDefaultPrim(payload.GetPrimAtPath("/Block"))
    _set_units(payload)
    payload.Save()
    interface = Usd.Stage.CreateNew(str(folder / "Block.usda"))
    root = UsdGeom.Xform.Define(interface, "/Block").GetPrim()
    Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
    UsdGeom.ModelAPI(root).SetExtentsHint(extent)
    root.GetPayloads().AddPayload("./payload.usda")
    interface.SetDefaultPrim(root)
    _set_units(interface)
    interface.Save()
    return Asset("Block", "table", BLOCK_SIZE_M, folder / "Block.usda")


def _set_units(stage: Usd.Stage) -> None:
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)


@pytest.fixture(scope="session")
def graph(furnished_house: SceneGraph, block: Asset) -> SceneGraph:
    """A furnished house; its first item that can carries two things, its last has no mesh."""
    items = [replace(item, asset=block) for item in furnished_house.items]
    items[-1] = replace(items[-1], asset=None)
    cup = Item("cup", "coffee_cup", Box((0.1, 0.05, 0.4), (0.1, 0.1, 0.1), 45.0), asset=block)
    book = Item("book", "lying_book", Box((-0.1, 0.0, 0.4), (0.15, 0.2, 0.03), 0.0), asset=block)
    at = next(n for n, item in enumerate(items) if item.category == "bedside_table")
    items[at] = replace(items[at], children=(cup, book))
    made = Provenance(input_hash="cafe", seed=5, configuration={"steps": 20})
    return replace(furnished_house, items=tuple(items), provenance=made)


@pytest.fixture(scope="session")
def house(graph: SceneGraph, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("stage") / "house.usda"
    return author_stage(graph, path, seed=3).path


@pytest.fixture
def stage(house: Path) -> Usd.Stage:
    return Usd.Stage.Open(str(house))


def prims_with_id(stage: Usd.Stage) -> dict[str, Usd.Prim]:
    """Prims of rooms, items and openings by their node in the scene graph."""
    return {
        prim.GetAttribute("chord:node_id").Get(): prim
        for prim in stage.Traverse()
        if prim.HasAttribute("chord:node_id")
    }


def kind_of(prim: Usd.Prim) -> str:
    return str(Usd.ModelAPI(prim).GetKind())


def mesh_points(prim: Usd.Prim) -> np.ndarray:
    """(N, 3) points of all meshes below a prim in the world, instances included."""
    cache = UsdGeom.XformCache()
    points = []
    for below in Usd.PrimRange(prim, Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
        if below.IsA(UsdGeom.Mesh):
            matrix = np.array(cache.GetLocalToWorldTransform(below))
            own = np.array(UsdGeom.Mesh(below).GetPointsAttr().Get(), float)
            points.append(own @ matrix[:3, :3] + matrix[3, :3])
    return np.concatenate(points)


def files_below(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file()
    }


# --- structure ----------------------------------------------------------------------------------


def test_layer_metadata(stage: Usd.Stage) -> None:
    layer = stage.GetRootLayer()
    assert layer.defaultPrim == "House"
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert stage.GetMetadata("kilogramsPerUnit") == 1.0
    settings = stage.GetPrimAtPath(stage.GetMetadata("renderSettingsPrimPath"))
    assert settings.GetTypeName() == "RenderSettings"
    assert stage.GetPrimAtPath(settings.GetRelationship("camera").GetTargets()[0]).IsA(
        UsdGeom.Camera
    )
    made = layer.customLayerData["chord"]
    assert made["seed"] == 3
    assert made["provenance"]["inputHash"] == "cafe"
    assert made["provenance"]["configuration"] == '{"steps": 20}'


def test_hierarchy_is_house_room_furniture_items(stage: Usd.Stage, graph: SceneGraph) -> None:
    root = stage.GetDefaultPrim()
    assert kind_of(root) == "assembly"
    rooms = root.GetChild("Rooms").GetChildren()
    assert [room.GetAttribute("chord:node_id").Get() for room in rooms] == [
        room.id for room in graph.rooms
    ]
    nodes = prims_with_id(stage)
    for room, prim in zip(graph.rooms, rooms, strict=True):
        assert kind_of(prim) == "group"
        assert [child.GetName() for child in prim.GetChildren()] == [
            "Architecture", "Furniture", "Lights",
        ]  # fmt: skip
        assert kind_of(prim.GetChild("Architecture")) == "component"
        assert prim.GetAttribute("semantics:labels:room").Get() == [room.kind]
        furniture = prim.GetChild("Furniture").GetPath()
        for item in graph.items_of(room.id):
            assert nodes[item.id].GetPath().HasPrefix(furniture)
            assert nodes[item.id].GetAttribute("chord:category").Get() == item.category
            assert nodes[item.id].GetAttribute("semantics:labels:category").Get() == [item.category]


def test_a_piece_that_carries_others_is_a_group_around_two_instances(
    stage: Usd.Stage, graph: SceneGraph
) -> None:
    nodes = prims_with_id(stage)
    carrier = next(item for item in graph.items if item.children)
    piece = nodes[carrier.id]
    group = piece.GetParent()
    assert kind_of(group) == "group"
    assert [child.GetName() for child in group.GetChildren()] == ["BedsideTable", "Items"]
    assert {child.GetName() for child in group.GetChild("Items").GetChildren()} == {
        "CoffeeCup_0", "LyingBook_0",
    }  # fmt: skip
    for node in (piece, nodes["cup"], nodes["book"]):
        assert node.IsInstance()
        assert kind_of(node) == "component"


def test_no_component_holds_another_and_every_ancestor_is_typed(stage: Usd.Stage) -> None:
    for prim in stage.Traverse(Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)):
        assert prim.GetTypeName(), prim.GetPath()
        if kind_of(prim) == "component":
            above = prim.GetParent()
            while above:
                assert kind_of(above) != "component", prim.GetPath()
                above = above.GetParent()


def test_names_are_numbered_labels(stage: Usd.Stage) -> None:
    rooms = [room.GetName() for room in stage.GetDefaultPrim().GetChild("Rooms").GetChildren()]
    assert len(set(rooms)) == len(rooms)
    for prim in prims_with_id(stage).values():
        assert re.fullmatch(r"[A-Z][A-Za-z]+(_\d+)?", prim.GetName())


def test_without_payloads_bounds_are_right_and_meshes_are_absent(house: Path) -> None:
    loaded = Usd.Stage.Open(str(house))
    light = Usd.Stage.Open(str(house), Usd.Stage.LoadNone)
    everything = Usd.TraverseInstanceProxies(Usd.PrimAllPrimsPredicate)
    assert not [prim for prim in light.Traverse(everything) if prim.IsA(UsdGeom.Mesh)]
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"], useExtentsHint=True)
    for path in [
        "/House",
        "/House/Exterior",
        *(room.GetPath() for room in light.GetPrimAtPath("/House/Rooms").GetChildren()),
    ]:
        found = cache.ComputeWorldBound(light.GetPrimAtPath(path)).ComputeAlignedRange()
        points = mesh_points(loaded.GetPrimAtPath(path))
        assert np.allclose(found.GetMin(), points.min(axis=0), atol=2e-3), path
        assert np.allclose(found.GetMax(), points.max(axis=0), atol=2e-3), path


def test_summary_counts_what_the_graph_holds(house: Path, graph: SceneGraph) -> None:
    children = sum(len(item.children) for item in graph.items)
    assert summary(house) == StageSummary(
        rooms=len(graph.rooms),
        furniture=len(graph.items),
        items=len(graph.items) + children,
        openings=len(graph.openings),
        lights=len(graph.rooms),
        cameras=len(graph.rooms) + 1,
    )
    with pytest.raises(StageError):
        summary(house.with_name("other.usda"))


# --- placement ----------------------------------------------------------------------------------


def test_every_mesh_fills_the_box_of_its_item(stage: Usd.Stage, graph: SceneGraph) -> None:
    nodes = prims_with_id(stage)
    for item in graph.items:
        points = mesh_points(nodes[item.id])
        corners = footprint(item.box)
        for corner in corners:
            assert np.hypot(*(points[:, :2] - corner).T).min() < 1e-4
        assert points[:, 2].min() == pytest.approx(item.box.center_m[2], abs=1e-5)
        assert np.ptp(points[:, 2]) == pytest.approx(item.box.size_m[2], abs=1e-4)


def test_what_stands_on_a_piece_is_posed_in_its_frame(stage: Usd.Stage, graph: SceneGraph) -> None:
    nodes = prims_with_id(stage)
    carrier = next(item for item in graph.items if item.children)
    yaw = np.deg2rad(carrier.box.yaw_deg)
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    for child in carrier.children:
        points = mesh_points(nodes[child.id])
        middle = turn @ np.array(child.box.center_m[:2]) + carrier.box.center_m[:2]
        assert np.allclose((points.min(axis=0) + points.max(axis=0))[:2] / 2, middle, atol=1e-4)
        base = carrier.box.center_m[2] + child.box.center_m[2]
        assert points[:, 2].min() == pytest.approx(base, abs=1e-5)


def test_each_room_has_one_light_at_its_centre_sized_to_it(
    stage: Usd.Stage, graph: SceneGraph
) -> None:
    powers = []
    for room, prim in zip(
        graph.rooms, stage.GetPrimAtPath("/House/Rooms").GetChildren(), strict=True
    ):
        (light,) = prim.GetChild("Lights").GetChildren()
        assert light.GetName() == "AreaLight"
        panel = UsdLux.RectLight(light)
        matrix = UsdGeom.XformCache().GetLocalToWorldTransform(light)
        assert np.allclose(matrix.TransformDir(Gf.Vec3d(0, 0, -1)), (0, 0, -1))
        half = panel.GetWidthAttr().Get() / 2, panel.GetHeightAttr().Get() / 2
        corners = [matrix.Transform(Gf.Vec3d(x * half[0], y * half[1], 0))
                   for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]  # fmt: skip
        floor = room_polygon(room)
        lit = shapely.Polygon([corner[:2] for corner in corners])
        assert floor.covers(lit)
        assert all(2.5 < corner[2] < 2.7 for corner in corners)
        if floor.area > 0.98 * floor.minimum_rotated_rectangle.area:
            assert lit.centroid.distance(floor.centroid) < 0.05
            assert lit.area == pytest.approx(0.16 * floor.area, rel=0.05)
        powers.append(np.pi * panel.GetIntensityAttr().Get() * lit.area / floor.area)
    assert np.allclose(powers, powers[0], rtol=0.01)


def test_cameras_stand_in_their_rooms_clear_of_furniture(
    stage: Usd.Stage, graph: SceneGraph
) -> None:
    cameras = stage.GetPrimAtPath("/House/Cameras")
    for room, prim in zip(
        graph.rooms, stage.GetPrimAtPath("/House/Rooms").GetChildren(), strict=True
    ):
        camera = UsdGeom.Camera(cameras.GetChild(prim.GetName())).GetCamera()
        place = camera.transform.ExtractTranslation()
        assert place[2] == pytest.approx(1.5)
        assert room_polygon(room).buffer(-0.1).contains(shapely.Point(place[:2]))
        for item in graph.items_of(room.id):
            over = place[2] > item.box.center_m[2] + item.box.size_m[2]
            assert over or not shapely.Polygon(footprint(item.box)).contains(
                shapely.Point(place[:2])
            )
        up = camera.transform.TransformDir(Gf.Vec3d(0, 1, 0))
        assert np.allclose(up, (0, 0, 1), atol=1e-6)  # verticals stay straight
        assert 0.18 <= camera.focalLength <= 0.24  # tenths of a metre: 18 to 24 mm


def test_the_top_camera_sees_the_whole_house(stage: Usd.Stage) -> None:
    camera = UsdGeom.Camera(stage.GetPrimAtPath("/House/Cameras/Top")).GetCamera()
    assert camera.projection == Gf.Camera.Perspective
    hint = UsdGeom.ModelAPI(stage.GetDefaultPrim()).GetExtentsHint()
    frustum = camera.frustum
    for x in (hint[0][0], hint[1][0]):
        for y in (hint[0][1], hint[1][1]):
            assert frustum.Intersects(Gf.Vec3d(x, y, hint[1][2]))


# --- openings -----------------------------------------------------------------------------------


def test_every_opening_is_a_labelled_prim_of_a_room_it_joins(
    stage: Usd.Stage, graph: SceneGraph
) -> None:
    nodes = prims_with_id(stage)
    walls = build_walls(graph.plan)
    for opening in graph.openings:
        prim = nodes[opening.id]
        room = prim.GetParent().GetParent().GetParent()
        assert room.GetAttribute("chord:node_id").Get() in opening.room_ids
        assert prim.GetAttribute("semantics:labels:category").Get() == [opening.kind]
        parts = {child.GetName() for child in prim.GetChildren()}
        if opening.id in walls.tunnels:
            expected = {"door": {"Frame", "Leaf_0"}, "window": {"Frame", "Glass"}, "passage": set()}
            assert parts >= {"Lining", *expected[opening.kind]}


def test_walls_of_the_stage_have_the_holes_of_its_doors(
    stage: Usd.Stage, graph: SceneGraph
) -> None:
    """No wall mesh has a point of a face inside the way through any door."""
    for opening in graph.openings:
        if opening.kind != "door":
            continue
        clear = shapely.Polygon(footprint(opening.box)).buffer(-0.02)
        for prim in stage.Traverse():
            if not prim.GetName().startswith(("Wall_", "Facade")) or not prim.IsA(UsdGeom.Mesh):
                continue
            mesh = UsdGeom.Mesh(prim)
            points = np.array(mesh.GetPointsAttr().Get())
            faces = np.array(mesh.GetFaceVertexIndicesAttr().Get()).reshape(-1, 4)
            for face in points[faces]:
                if face[:, 2].min() < 1.0:
                    line = shapely.LineString(face[:2, :2])
                    assert not line.intersects(clear), (prim.GetPath(), opening.id)


# --- files --------------------------------------------------------------------------------------


def problems(path: Path) -> list[str]:
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    return [error.GetMessage() for error in context.Validate(Usd.Stage.Open(str(path)))]


def test_usd_finds_nothing_wrong_with_it(house: Path) -> None:
    assert problems(house) == []


def test_the_folder_can_be_moved(house: Path, tmp_path: Path) -> None:
    moved = tmp_path / "elsewhere"
    shutil.copytree(house.parent, moved)
    layers, files, missing = UsdUtils.ComputeAllDependencies(str(moved / house.name))
    assert missing == []
    assert files, "looks have maps"
    used = [Path(layer.realPath) for layer in layers] + [Path(str(file)) for file in files]
    assert all(file.is_relative_to(moved.resolve()) for file in used)


def test_same_graph_and_seed_give_the_same_bytes(
    graph: SceneGraph, house: Path, tmp_path: Path
) -> None:
    again = author_stage(graph, tmp_path / "a folder" / "house.usda", seed=3)
    assert files_below(again.path.parent) == files_below(house.parent)
    other = author_stage(graph, tmp_path / "other" / "house.usda", seed=4)
    assert other.content_hash != again.content_hash
    assert {
        name for name, data in files_below(other.path.parent).items() if "architecture" in name
        and data != files_below(again.path.parent)[name]
    } == set()  # fmt: skip


def test_an_open_stage_sees_the_house_that_replaces_it(graph: SceneGraph, tmp_path: Path) -> None:
    path = author_stage(graph, tmp_path / "house.usda", looks=()).path
    opened = Usd.Stage.Open(str(path))
    author_stage(replace(graph, rooms=graph.rooms[:1], items=(), openings=()), path, looks=())
    assert len(opened.GetPrimAtPath("/House/Rooms").GetChildren()) == 1


def test_a_different_house_gives_different_bytes(graph: SceneGraph, tmp_path: Path) -> None:
    first = author_stage(graph, tmp_path / "first.usda", looks=())
    fewer = replace(graph, items=graph.items[1:])
    assert author_stage(fewer, tmp_path / "second.usda", looks=()).content_hash != (
        first.content_hash
    )


def test_houses_of_a_folder_share_their_packages(graph: SceneGraph, tmp_path: Path) -> None:
    author_stage(graph, tmp_path / "one.usda", looks=())
    asset = tmp_path / "assets" / "Block" / "Block.usda"
    written_ns = asset.stat().st_mtime_ns
    author_stage(graph, tmp_path / "two.usda", looks=())
    assert asset.stat().st_mtime_ns == written_ns
    assert {path.name for path in (tmp_path / "assets").iterdir()} == {"Block", "Placeholder"}
    assert (tmp_path / "two_architecture").is_dir()


def test_two_packages_of_one_name_stay_apart(
    graph: SceneGraph, block: Asset, tmp_path: Path
) -> None:
    shutil.copytree(block.usd_path.parent, tmp_path / "library" / "Block")
    twin = replace(block, usd_path=tmp_path / "library" / "Block" / "Block.usda")
    items = (replace(graph.items[0], asset=block), replace(graph.items[1], asset=twin))
    path = author_stage(replace(graph, items=items), tmp_path / "house.usda", looks=()).path
    assert (tmp_path / "assets" / "Block_2" / "Block.usda").is_file()
    assert UsdUtils.ComputeAllDependencies(str(path))[2] == []


def test_usdz_is_the_same_house_in_one_file(graph: SceneGraph, house: Path, tmp_path: Path) -> None:
    packed = author_stage(graph, tmp_path / "house.usdz", seed=3)
    assert [file.name for file in tmp_path.iterdir()] == ["house.usdz"]
    assert summary(packed.path) == summary(house)
    assert problems(packed.path) == []


@pytest.mark.parametrize("suffix", [".usd", ".usdc"])
def test_binary_layers_hold_the_same_house(
    graph: SceneGraph, suffix: str, tmp_path: Path, house: Path
) -> None:
    path = author_stage(graph, tmp_path / f"house{suffix}", looks=()).path
    assert summary(path) == summary(house)


# --- looks --------------------------------------------------------------------------------------


def worn_shaders(stage: Usd.Stage) -> Iterator[tuple[str, str]]:
    for prim in stage.Traverse():
        if prim.GetName() == "Floor" or prim.GetName().startswith("Wall_"):
            material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
            shader = material.ComputeSurfaceSource()[0]
            yield str(prim.GetPath()), str(shader.GetPath()) if shader else ""


def test_every_floor_and_wall_wears_a_look_in_every_variant(house: Path) -> None:
    stage = Usd.Stage.Open(str(house))
    stage.SetEditTarget(stage.GetSessionLayer())
    for room in stage.GetPrimAtPath("/House/Rooms").GetChildren():
        names = room.GetVariantSets().GetNames()
        assert sorted(names) == ["floorMaterial", "wallMaterial"]
        for name in names:
            variants = room.GetVariantSet(name)
            assert len(variants.GetVariantNames()) >= 2
            for choice in variants.GetVariantNames():
                variants.SetVariantSelection(choice)
                assert all(shader for _, shader in worn_shaders(stage))


def test_looks_suit_the_kind_of_their_room(stage: Usd.Stage, graph: SceneGraph) -> None:
    library = {look.name: look for look in load_looks()}
    for room, prim in zip(
        graph.rooms, stage.GetPrimAtPath("/House/Rooms").GetChildren(), strict=True
    ):
        for part in ("floor", "wall"):
            worn = library[prim.GetVariantSet(f"{part}Material").GetVariantSelection()]
            assert worn.surface in (part, "both")
            assert room.kind in worn.kinds or "unknown" in worn.kinds


def test_material_names_are_unique_in_the_house(stage: Usd.Stage) -> None:
    """Blender merges materials by name, and with them how a pattern is laid."""
    names = [
        prim.GetName()
        for prim in stage.Traverse()
        if prim.IsA(UsdShade.Material) and prim.GetName().endswith(("_Floor", "_Wall"))
    ]
    assert names
    assert len(set(names)) == len(names)


# --- bad input ----------------------------------------------------------------------------------


def test_a_target_that_cannot_be_written_leaves_nothing(graph: SceneGraph, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputError):
        author_stage(graph, tmp_path / "file" / "house.usda", looks=())
    (tmp_path / "house.usda").mkdir()
    with pytest.raises(OutputError):
        author_stage(graph, tmp_path / "house.usda", looks=())
    with pytest.raises(OutputError, match="blend"):
        author_stage(graph, tmp_path / "house.blend", looks=())
    assert sorted(files_below(tmp_path)) == ["file"]


def test_a_failure_half_way_leaves_the_older_house_alone(
    graph: SceneGraph, block: Asset, tmp_path: Path
) -> None:
    author_stage(replace(graph, items=()), tmp_path / "house.usda", looks=())
    before = files_below(tmp_path)
    lost = replace(block, usd_path=tmp_path / "nowhere" / "Lost.usda")
    broken = replace(graph, items=(*graph.items[1:], replace(graph.items[0], asset=lost)))
    with pytest.raises(AssetError, match="Lost"):
        author_stage(broken, tmp_path / "house.usda", looks=())
    assert files_below(tmp_path) == before


def test_a_house_without_rooms_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="room"):
        author_stage(SceneGraph((), (), ()), tmp_path / "house.usda", looks=())
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_category_is_an_error(graph: SceneGraph, tmp_path: Path) -> None:
    strange = replace(graph.items[0], category="spaceship")
    with pytest.raises(SceneError, match="spaceship"):
        author_stage(replace(graph, items=(strange,)), tmp_path / "house.usda", looks=())


def test_references_are_relative(house: Path) -> None:
    for path in [house, *house.parent.glob("*_architecture/*")]:
        text = Sdf.Layer.FindOrOpen(str(path)).ExportToString()
        assert all(target.startswith("./") for target in re.findall(r"@([^@]+)@", text))
