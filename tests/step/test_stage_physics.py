"""What moves and what does not: bodies, masses, colliders, doors on hinges."""

from __future__ import annotations

from types import ModuleType

import numpy as np
import shapely
from pxr import Gf, Usd, UsdGeom, UsdPhysics

from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.palette import CATEGORIES, having
from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.stage.author.physics import DOOR_OPENS_DEG
from chord_usd.line.stage.shell.walls import build_walls

PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)


def bounds_m(stage: Usd.Stage, prim: Usd.Prim) -> np.ndarray:
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default", "guide"])
    box = cache.ComputeWorldBound(prim).ComputeAlignedRange()
    return np.array([box.GetMin(), box.GetMax()])


def test_people_move_chairs_and_cups_but_not_beds(stage: Usd.Stage) -> None:
    seen = set()
    for prim in stage.Traverse():
        category = prim.GetAttribute("chord:category").Get()
        if category is None or "Architecture" in str(prim.GetPath()):
            continue
        seen.add(category)
        moves = prim.HasAPI(UsdPhysics.RigidBodyAPI)
        assert moves == (category in having("moved")), prim.GetPath()
        if moves:
            assert 0.01 < UsdPhysics.MassAPI(prim).GetMassAttr().Get() < 150.0
    assert {"bed", "coffee_cup"} <= seen


def test_mass_grows_with_size(stage: Usd.Stage, staged_graph: SceneGraph) -> None:
    masses = {
        prim.GetAttribute("chord:node_id").Get(): UsdPhysics.MassAPI(prim).GetMassAttr().Get()
        for prim in stage.Traverse()
        if prim.HasAPI(UsdPhysics.MassAPI) and prim.HasAttribute("chord:node_id")
    }
    for item in staged_graph.items:
        if item.id in masses:
            expected = CATEGORIES[item.category].kg_per_m3 * np.prod(item.box.size_m)
            assert np.isclose(masses[item.id], expected, rtol=1e-3)


def test_a_ball_dropped_anywhere_in_a_room_or_doorway_meets_a_floor(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    slabs = shapely.union_all(
        [
            shapely.box(*bounds[0, :2], *bounds[1, :2])
            for bounds in (
                bounds_m(stage, prim)
                for prim in stage.Traverse()
                if prim.GetName() == "Box_0" and prim.HasAPI(UsdPhysics.CollisionAPI)
            )
            if np.isclose(bounds[1, 2], 0.0)
        ]
    )
    slabs = slabs.buffer(1e-3)
    for room in staged_graph.rooms:
        assert slabs.covers(room_polygon(room)), room.id
    for tunnel in build_walls(staged_graph.plan).tunnels.values():
        assert slabs.covers(tunnel.area_m)


def test_walls_stop_what_windows_and_doors_let_through(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    blocks = [
        bounds_m(stage, prim)
        for prim in stage.Traverse()
        if prim.GetTypeName() == "Cube" and prim.GetParent().GetName() == "Colliders"
    ]
    walls = build_walls(staged_graph.plan)
    for tunnel in walls.tunnels.values():
        if tunnel.opening.box.yaw_deg % 90.0:
            continue
        x, y = tunnel.area_m.centroid.coords[0]
        for height, free in (((tunnel.low_m + tunnel.high_m) / 2, True), (2.69, False)):
            point = np.array([x, y, height])
            reach = 0.12 * np.array([1.0, 1.0, 0.0])
            hits = [
                b for b in blocks if (b[0] < point + reach).all() and (point - reach < b[1]).all()
            ]
            inside = [b for b in blocks if (b[0] < point).all() and (point < b[1]).all()]
            assert not inside if free else hits


def test_window_boards_carry_what_stands_on_them(stage: Usd.Stage) -> None:
    boards = [prim for prim in stage.Traverse() if prim.GetName().startswith("Board_")]
    boards = [prim for prim in boards if "Window" in prim.GetParent().GetName()]
    assert boards
    for board in boards:
        collider = board.GetParent().GetChild("Collider")
        assert collider.HasAPI(UsdPhysics.CollisionAPI)
        assert np.allclose(bounds_m(stage, collider), bounds_m(stage, board), atol=1e-4)


def test_doors_hang_on_hinges_and_open_into_a_room(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    joints = [prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.RevoluteJoint)]
    doors = [opening for opening in staged_graph.openings if opening.kind == "door"]
    assert len(joints) >= len(doors) > 0
    floors = shapely.union_all([room_polygon(room) for room in staged_graph.rooms])
    for prim in joints:
        joint = UsdPhysics.RevoluteJoint(prim)
        (door,), (leaf,) = joint.GetBody0Rel().GetTargets(), joint.GetBody1Rel().GetTargets()
        body = stage.GetPrimAtPath(leaf)
        assert body.HasAPI(UsdPhysics.RigidBodyAPI)
        assert UsdPhysics.MassAPI(body).GetMassAttr().Get() > 5.0
        assert joint.GetAxisAttr().Get() == "Z"
        limits = joint.GetLowerLimitAttr().Get(), joint.GetUpperLimitAttr().Get()
        assert sorted(map(abs, limits)) == [0.0, DOOR_OPENS_DEG]
        matrices = [
            UsdGeom.Xformable(stage.GetPrimAtPath(path)).ComputeLocalToWorldTransform(0)
            for path in (door, leaf)
        ]
        anchors = [
            matrix.Transform(Gf.Vec3d(point.Get()))
            for matrix, point in zip(
                matrices, (joint.GetLocalPos0Attr(), joint.GetLocalPos1Attr()), strict=True
            )
        ]
        assert np.allclose(anchors[0], anchors[1], atol=1e-5)
        assert _free_end(matrices[1], body, sum(limits)).within(floors.buffer(0.01)), leaf


def _free_end(matrix: Gf.Matrix4d, leaf: Usd.Prim, turn_deg: float) -> shapely.Point:
    """Where the edge with the handle is once the leaf is turned by an angle."""
    collider = UsdGeom.Xformable(leaf.GetChild("Collider")).GetLocalTransformation()
    middle = collider.ExtractTranslation()
    turn = Gf.Rotation(Gf.Vec3d(0, 0, 1), turn_deg)
    return shapely.Point(*list(matrix.Transform(turn.TransformDir(2.0 * middle)))[:2])


def test_doors_and_windows_open_and_shut_and_touch_no_wall(
    stage: Usd.Stage, puller: ModuleType
) -> None:
    shell = [prim for prim in stage.Traverse() if "Architecture" in str(prim.GetPath())]
    hinges = [prim for prim in shell if prim.IsA(UsdPhysics.RevoluteJoint)]
    sashes = [prim for prim in hinges if "Window" in str(prim.GetPath())]
    assert 0 < len(sashes) < len(hinges)
    model = puller.spec_of(shell).compile()
    assert model.njnt == len(hinges)
    assert list(puller.faults_of(model)) == []
