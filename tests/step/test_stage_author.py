"""What is on a stage: structure, placement and openings, read back with usd-core."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path

import numpy as np
import pytest
import shapely
from pxr import Gf, Usd, UsdGeom, UsdLux, UsdPhysics, UsdSemantics, UsdShade

from chord_usd.base.errors import StageError
from chord_usd.base.scene.geometry import footprint, room_polygon
from chord_usd.base.scene.types import Plan, Room, SceneGraph
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_scene import read_scene
from chord_usd.line.stage.read.describe import StageSummary, summary
from chord_usd.line.stage.shell.walls import build_walls

SCOPES = {"Architecture", "Furniture", "Dressing", "Items", "Lights", "Joints", "Geometry",
          "Materials", "Colliders"}  # fmt: skip
"""Names that prims have because of where they are."""


def prims_with_id(stage: Usd.Stage) -> dict[str, Usd.Prim]:
    """Prims of rooms, items and openings by their node in the scene staged_graph."""
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


def test_hierarchy_is_house_room_furniture_items(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    root = stage.GetDefaultPrim()
    assert kind_of(root) == "assembly"
    rooms = root.GetChild("Rooms").GetChildren()
    assert [room.GetAttribute("chord:node_id").Get() for room in rooms] == [
        room.id for room in staged_graph.rooms
    ]
    nodes = prims_with_id(stage)
    for room, prim in zip(staged_graph.rooms, rooms, strict=True):
        assert kind_of(prim) == "group"
        assert [child.GetName() for child in prim.GetChildren()] == [
            "Architecture", "Furniture", "Lights",
        ]  # fmt: skip
        assert kind_of(prim.GetChild("Architecture")) == "component"
        assert prim.GetAttribute("semantics:labels:room").Get() == [room.kind]
        furniture = prim.GetChild("Furniture").GetPath()
        for item in staged_graph.items_of(room.id):
            assert nodes[item.id].GetPath().HasPrefix(furniture)
            assert nodes[item.id].GetAttribute("chord:category").Get() == item.category
            for taxonomy in ("category", "class"):
                labels = UsdSemantics.LabelsAPI(nodes[item.id], taxonomy).GetLabelsAttr().Get()
                assert labels == [item.category]


def test_a_piece_that_carries_others_is_a_group_around_two_instances(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    nodes = prims_with_id(stage)
    carrier = next(item for item in staged_graph.items if item.children)
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
    for prim in prims_with_id(stage).values():
        assert re.fullmatch(r"[A-Z][A-Za-z]+(_\d+)?", prim.GetName())


def test_no_two_things_of_a_house_have_one_name(stage: Usd.Stage) -> None:
    """But for the scopes of a room and of a component, which are called what they are."""
    below = Usd.PrimRange(stage.GetPrimAtPath("/House/Rooms"))
    seen = [one for one in below if not one.IsA(UsdShade.Material) and not one.IsA(UsdShade.Shader)]
    names = Counter(one.GetName() for one in seen if one.GetName() not in SCOPES)
    colliders = re.compile(r"(Collider|Box|Hull)(_\d+)?")
    assert {n: c for n, c in names.items() if c > 1 and not colliders.fullmatch(n)} == {}
    assert sum(one.IsA(UsdPhysics.Joint) for one in seen) > 20


def test_without_payloads_bounds_are_right_and_meshes_are_absent(staged_house: Path) -> None:
    loaded = Usd.Stage.Open(str(staged_house))
    light = Usd.Stage.Open(str(staged_house), Usd.Stage.LoadNone)
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
        points = points[points[:, 2] >= 0.0]  # the ground outside is a picture's business
        assert np.allclose(found.GetMin(), points.min(axis=0), atol=2e-3), path
        assert np.allclose(found.GetMax(), points.max(axis=0), atol=2e-3), path


def test_summary_counts_what_the_graph_holds(staged_house: Path, staged_graph: SceneGraph) -> None:
    children = sum(len(item.children) for item in staged_graph.items)
    assert summary(staged_house) == StageSummary(
        rooms=len(staged_graph.rooms),
        furniture=len(staged_graph.items),
        items=len(staged_graph.items) + children,
        dressing=0,
        openings=len(staged_graph.openings),
        lights=len(staged_graph.rooms),
        cameras=len(staged_graph.rooms) + 2,
    )
    with pytest.raises(StageError):
        summary(staged_house.with_name("other.usda"))


# --- placement ----------------------------------------------------------------------------------


def test_every_mesh_fills_the_box_of_its_item(stage: Usd.Stage, staged_graph: SceneGraph) -> None:
    nodes = prims_with_id(stage)
    for item in staged_graph.items:
        points = mesh_points(nodes[item.id])
        corners = footprint(item.box)
        for corner in corners:
            assert np.hypot(*(points[:, :2] - corner).T).min() < 1e-4
        assert points[:, 2].min() == pytest.approx(item.box.center_m[2], abs=1e-5)
        assert np.ptp(points[:, 2]) == pytest.approx(item.box.size_m[2], abs=1e-4)


def test_what_stands_on_a_piece_is_posed_in_its_frame(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    nodes = prims_with_id(stage)
    carrier = next(item for item in staged_graph.items if item.children)
    yaw = np.deg2rad(carrier.box.yaw_deg)
    turn = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    for child in carrier.children:
        points = mesh_points(nodes[child.id])
        middle = turn @ np.array(child.box.center_m[:2]) + carrier.box.center_m[:2]
        assert np.allclose((points.min(axis=0) + points.max(axis=0))[:2] / 2, middle, atol=1e-4)
        base = carrier.box.center_m[2] + child.box.center_m[2]
        assert points[:, 2].min() == pytest.approx(base, abs=1e-5)


def test_each_room_has_one_light_at_its_centre_sized_to_it(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    powers = []
    for room, prim in zip(
        staged_graph.rooms, stage.GetPrimAtPath("/House/Rooms").GetChildren(), strict=True
    ):
        (light,) = prim.GetChild("Lights").GetChildren()
        assert light.GetName() == f"AreaLight_{prim.GetName()}"
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
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    cameras = stage.GetPrimAtPath("/House/Cameras")
    for room, prim in zip(
        staged_graph.rooms, stage.GetPrimAtPath("/House/Rooms").GetChildren(), strict=True
    ):
        camera = UsdGeom.Camera(cameras.GetChild(prim.GetName())).GetCamera()
        place = camera.transform.ExtractTranslation()
        assert place[2] == pytest.approx(1.5)
        # A view through a wall begins at its clipping plane.
        ahead = camera.transform.TransformDir(Gf.Vec3d(0, 0, -1)) * camera.clippingRange.min
        place = place + ahead
        assert room_polygon(room).buffer(-0.1).contains(shapely.Point(place[:2]))
        for item in staged_graph.items_of(room.id):
            over = place[2] > item.box.center_m[2] + item.box.size_m[2]
            assert over or not shapely.Polygon(footprint(item.box)).contains(
                shapely.Point(place[:2])
            )
        up = camera.transform.TransformDir(Gf.Vec3d(0, 1, 0))
        assert np.allclose(up, (0, 0, 1), atol=1e-6)  # verticals stay straight
        assert 0.199 <= camera.focalLength <= 0.281  # tenths of a metre: 20 to 28 mm


def test_the_top_camera_sees_the_whole_house_as_a_plan(stage: Usd.Stage) -> None:
    prim = stage.GetPrimAtPath("/House/Cameras/Top")
    camera = UsdGeom.Camera(prim).GetCamera()
    assert camera.projection == Gf.Camera.Orthographic
    assert prim.GetAttribute("chord:cut_m").Get() == pytest.approx(1.2)
    assert np.allclose(camera.transform.ExtractRotationMatrix(), np.eye(3))
    low, high = UsdGeom.ModelAPI(stage.GetDefaultPrim()).GetExtentsHint()
    for x in (low[0], high[0]):
        for y in (low[1], high[1]):
            assert camera.frustum.Intersects(Gf.Vec3d(x, y, high[2]))
    seen_m = camera.frustum.window.GetSize()
    filled = max((high[0] - low[0]) / seen_m[0], (high[1] - low[1]) / seen_m[1])
    assert filled > 0.9


# --- openings -----------------------------------------------------------------------------------


def test_every_opening_is_a_labelled_prim_of_a_room_it_joins(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    nodes = prims_with_id(stage)
    walls = build_walls(staged_graph.plan)
    for opening in staged_graph.openings:
        prim = nodes[opening.id]
        room = prim.GetParent().GetParent().GetParent()
        assert room.GetAttribute("chord:node_id").Get() in opening.room_ids
        assert prim.GetAttribute("semantics:labels:category").Get() == [opening.kind]
        parts = {child.GetName() for child in prim.GetChildren()}
        parts = {name.removesuffix(f"_{prim.GetName()}") for name in parts}
        if opening.id in walls.tunnels:
            expected = {
                "door": {"Frame", "Leaf_0"},
                "window": {"Frame", "Sash_0"},
                "passage": set(),
            }
            assert parts >= {"Lining", *expected[opening.kind]}


def test_rooms_that_touch_are_joined_on_the_stage(tmp_path: Path) -> None:
    """As passages for whoever reads a stage; the program's reader sees that the rooms touch."""
    east = shapely.union(shapely.box(4, 0, 7, 4), shapely.box(3, 0, 4, 1))
    rooms = tuple(
        Room(name, kind, shapely.get_coordinates(shapely.orient_polygons(floor).exterior)[:-1])
        for name, kind, floor in (
            ("a", "living", shapely.box(0, 0, 4, 4).difference(east)),
            ("b", "kitchen", east),
        )
    )
    path = author_stage(Plan(rooms, ()).scene(), tmp_path / "house.usda").path
    stage = Usd.Stage.Open(str(path))
    ways = [p for p in stage.Traverse() if p.GetAttribute("chord:category").Get() == "passage"]
    assert len(prims_with_id(stage)) >= len(ways) == 3  # ids differ
    assert all(set(way.GetAttribute("chord:rooms").Get()) == {"a", "b"} for way in ways)
    lengths = [way.GetAttribute("chord:size_m").Get()[0] for way in ways]
    assert sorted(lengths) == pytest.approx([1.0, 1.0, 3.0], abs=1e-3)
    assert summary(path).openings == 0
    assert not read_scene(stage).graph.openings


def test_walls_of_the_stage_have_the_holes_of_its_doors(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    """No wall mesh has a point of a face inside the way through any door."""
    for opening in staged_graph.openings:
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
