"""Houses and strangers' stages as MJCF, loaded by MuJoCo and let go."""

from __future__ import annotations

import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdPhysics, UsdShade

from chord_usd.base.errors import OutputError, StageError
from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.cli import UNUSABLE, main
from chord_usd.library.database import AssetDatabase, load_database
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.export.export_stage import export_stage

PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
MOST_M, MOST_RAD = 0.01, 0.1
SECONDS = 2.0


def exported(stage: Path, folder: Path) -> Path:
    export_stage(stage, folder / "model", "mujoco")
    return folder / "model"


def loaded(folder: Path, capfd: pytest.CaptureFixture[str] | None = None) -> Any:
    """The model, which loads without a word."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        model = mujoco.MjModel.from_xml_path(str(folder / "model.xml"))
    if capfd is not None:
        assert capfd.readouterr() == ("", "")
    return model


def saved(stage: Usd.Stage, folder: Path) -> Any:
    """The model of a stage in memory."""
    path = folder / "stage.usda"
    stage.GetRootLayer().Export(str(path))
    return loaded(exported(path, folder))


def after(model: Any, seconds: float) -> Any:
    data = mujoco.MjData(model)
    while data.time < seconds:
        mujoco.mj_step(model, data)
    assert not any(warning.number for warning in data.warning)
    return data


def name_at(model: Any, start: int) -> str:
    """Of what the Python module gives no names of."""
    return model.names[start:].split(b"\0", 1)[0].decode()


def named(prim: Usd.Prim) -> str:
    return str(prim.GetPath())[1:].replace("/", ".")


# Houses -------------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def equipped(furnished_house: SceneGraph, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A house with what the database holds: chairs that slide, a shower that is hollow."""
    database = load_database()

    def fitted(item: Item, of: AssetDatabase) -> Item:
        return replace(item, asset=of.nearest(item.category, item.box.size_m))

    items = tuple(fitted(item, database) for item in furnished_house.items)
    path = tmp_path_factory.mktemp("equipped") / "house.usda"
    return author_stage(replace(furnished_house, items=items), path, seed=3).path


@pytest.fixture(scope="module")
def model_folder(equipped: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return exported(equipped, tmp_path_factory.mktemp("mujoco"))


def test_every_body_stays_where_the_stage_has_it(
    equipped: Path, model_folder: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    model, stage = loaded(model_folder, capfd), Usd.Stage.Open(str(equipped))
    data = after(model, SECONDS)
    cache, moving = UsdGeom.XformCache(), 0
    for number in range(1, model.nbody):
        prim = stage.GetPrimAtPath("/" + model.body(number).name.replace(".", "/"))
        assert prim, model.body(number).name
        matrix = cache.GetLocalToWorldTransform(prim).RemoveScaleShear()
        off = np.linalg.norm(data.xpos[number] - matrix.ExtractTranslation())
        turn = matrix.ExtractRotationQuat()
        same = abs(np.dot(data.xquat[number], [turn.GetReal(), *turn.GetImaginary()]))
        assert off < MOST_M, prim.GetPath()
        assert 2 * np.arccos(min(same, 1.0)) < MOST_RAD, prim.GetPath()
        moving += prim.HasAPI(UsdPhysics.RigidBodyAPI)
    bodies = [one for one in stage.Traverse() if one.HasAPI(UsdPhysics.RigidBodyAPI)]
    assert moving == len(bodies) > 10


def test_masses_are_those_of_the_stage(equipped: Path, model_folder: Path) -> None:
    model, stage = loaded(model_folder), Usd.Stage.Open(str(equipped))
    for prim in stage.Traverse():
        if prim.HasAPI(UsdPhysics.RigidBodyAPI):
            body = model.body(named(prim))
            assert body.mass[0] == pytest.approx(
                UsdPhysics.MassAPI(prim).GetMassAttr().Get(), rel=1e-3
            )


def test_joints_have_names_and_limits_of_the_stage(equipped: Path, model_folder: Path) -> None:
    model, stage = loaded(model_folder), Usd.Stage.Open(str(equipped))
    hinges = [one for one in stage.Traverse() if one.IsA(UsdPhysics.RevoluteJoint)]
    found = {
        model.joint(n).name
        for n in range(model.njnt)
        if model.jnt_type[n] == mujoco.mjtJoint.mjJNT_HINGE
    }
    assert found == {named(prim) for prim in hinges}
    assert hinges
    for prim in hinges:
        hinge = UsdPhysics.RevoluteJoint(prim)
        limits = hinge.GetLowerLimitAttr().Get(), hinge.GetUpperLimitAttr().Get()
        joint = model.joint(named(prim))
        assert np.degrees(joint.range) == pytest.approx(limits, abs=1e-3)
        assert joint.qpos0[0] == pytest.approx(0.0, abs=1e-6)


def test_each_collider_is_felt_once_and_as_what_it_is(equipped: Path, model_folder: Path) -> None:
    model, stage = loaded(model_folder), Usd.Stage.Open(str(equipped))
    felt = {model.geom(n).name: n for n in range(model.ngeom) if model.geom_contype[n]}
    hollow = {name_at(model, model.name_flexadr[n]) for n in range(model.nflex)}
    boxes = 0
    for prim in Usd.PrimRange.Stage(stage, PROXIES):
        if not prim.HasAPI(UsdPhysics.CollisionAPI):
            continue
        name = named(prim)
        assert name in felt or name in hollow, name
        if prim.IsA(UsdGeom.Cube):
            assert model.geom_type[felt[name]] == mujoco.mjtGeom.mjGEOM_BOX
            boxes += 1
    assert boxes > 50


def test_a_floor_is_as_slippery_as_its_look_says(equipped: Path, model_folder: Path) -> None:
    model, stage = loaded(model_folder), Usd.Stage.Open(str(equipped))
    compared = set()
    for prim in Usd.PrimRange.Stage(stage, PROXIES):
        if prim.GetName() == "Box_0" and prim.HasAPI(UsdPhysics.CollisionAPI):
            material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")[0]
            told = UsdPhysics.MaterialAPI(material.GetPrim()).GetDynamicFrictionAttr().Get()
            geom = model.geom(named(prim))
            assert geom.friction[0] == pytest.approx(told)
            compared.add(told)
    assert compared


def test_no_collider_of_a_house_is_without_a_physics_material(equipped: Path) -> None:
    stage = Usd.Stage.Open(str(equipped))
    colliders = bare = 0
    for prim in Usd.PrimRange.Stage(stage, PROXIES):
        if prim.HasAPI(UsdPhysics.CollisionAPI):
            bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")[0]
            colliders += 1
            bare += not (bound and bound.GetPrim().HasAPI(UsdPhysics.MaterialAPI))
    assert colliders > 100
    assert bare == 0


def test_what_is_seen_is_as_large_as_on_the_stage(equipped: Path, model_folder: Path) -> None:
    model, stage = loaded(model_folder), Usd.Stage.Open(str(equipped))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    bounds = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"])
    compared = 0
    for prim in stage.Traverse():
        if not prim.GetAttribute("chord:usd_path"):
            continue
        body = model.body(named(prim))
        points = [
            corners_of(model, data, n)
            for n in range(model.ngeom)
            if model.geom_bodyid[n] == body.id and not model.geom_contype[n]
        ]
        box = bounds.ComputeWorldBound(prim).ComputeAlignedRange()
        assert np.vstack(points).min(axis=0) == pytest.approx(list(box.GetMin()), abs=2e-3)
        assert np.vstack(points).max(axis=0) == pytest.approx(list(box.GetMax()), abs=2e-3)
        compared += 1
    assert compared > 20


def corners_of(model: Any, data: Any, geom: int) -> np.ndarray:
    """(N, 3) vertices of a mesh in the world."""
    mesh = model.geom_dataid[geom]
    start, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
    own = model.mesh_vert[start : start + count]
    return own @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]


def test_bodies_say_their_class_and_cameras_look_where_they_did(
    equipped: Path, model_folder: Path
) -> None:
    model, stage = loaded(model_folder), Usd.Stage.Open(str(equipped))
    said = bytes(model.text_data).decode().split("\0")
    classes = {name_at(model, model.name_textadr[n]): said[n] for n in range(model.ntext)}
    assert {"bed", "chair"} <= set(classes.values())
    for name, told in classes.items():
        prim = stage.GetPrimAtPath("/" + name.replace(".", "/"))
        assert list(prim.GetAttribute("semantics:labels:class").Get()) == [told]
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    cameras = [one for one in stage.Traverse() if one.IsA(UsdGeom.Camera)]
    assert len(cameras) == model.ncam > 0
    for prim in cameras:
        number = model.camera(named(prim)).id
        way = UsdGeom.Camera(prim).GetCamera().frustum.ComputeViewDirection()
        assert -data.cam_xmat[number].reshape(3, 3)[:, 2] == pytest.approx(list(way), abs=1e-5)
    assert model.nlight > 0


def test_the_same_house_is_the_same_model(
    equipped: Path, model_folder: Path, tmp_path: Path
) -> None:
    again = exported(equipped, tmp_path)
    names = {
        file.relative_to(again)
        for file in again.rglob("*.*")
        if file.is_file() and file.name[0] != "."
    }
    assert all((again / one).read_bytes() == (model_folder / one).read_bytes() for one in names)
    assert any(one.suffix == ".obj" for one in names)


def test_two_houses_on_one_stage_bring_no_scene(equipped: Path) -> None:
    stage = Usd.Stage.CreateInMemory()
    for name in ("one", "two"):
        stage.DefinePrim(f"/{name}").GetReferences().AddReference(str(equipped))
    assert not [prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.Scene)]
    own = Usd.Stage.Open(str(equipped))
    assert len([prim for prim in own.Traverse() if prim.IsA(UsdPhysics.Scene)]) == 1


# Stages of others ---------------------------------------------------------------------------------


def cube(stage: Usd.Stage, path: str, at: tuple[float, float, float], side: float) -> Usd.Prim:
    """A cube that is felt and seen."""
    shape = UsdGeom.Cube.Define(stage, path)
    shape.CreateSizeAttr(side)
    shape.AddTranslateOp().Set(Gf.Vec3d(*at))
    UsdPhysics.CollisionAPI.Apply(shape.GetPrim())
    return shape.GetPrim()


def new_stage(metres: float = 1.0, up: str = UsdGeom.Tokens.z) -> Usd.Stage:
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageMetersPerUnit(stage, metres)
    UsdGeom.SetStageUpAxis(stage, up)
    return stage


def test_a_stage_without_physics_is_seen_and_stands_still(tmp_path: Path) -> None:
    stage = new_stage()
    mesh = UsdGeom.Mesh.Define(stage, "/Triangle")
    mesh.CreatePointsAttr([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    mesh.CreateFaceVertexCountsAttr([3])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2])
    UsdGeom.Sphere.Define(stage, "/Ball")
    model = saved(stage, tmp_path)
    assert (model.ngeom, model.njnt, model.nbody) == (2, 0, 1)
    assert not model.geom_contype.any()


def test_an_empty_stage_is_refused(tmp_path: Path) -> None:
    stage = new_stage()
    stage.GetRootLayer().Export(str(tmp_path / "stage.usda"))
    with pytest.raises(StageError, match="no visible mesh"):
        exported(tmp_path / "stage.usda", tmp_path)
    assert not (tmp_path / "model").exists()


def test_names_that_clash_or_are_forbidden_are_told_apart(tmp_path: Path) -> None:
    stage = new_stage()
    for path in ("/world", "/a", "/b"):
        UsdPhysics.RigidBodyAPI.Apply(UsdGeom.Xform.Define(stage, path).GetPrim())
        for name in ("Same", "Küche", "same"):
            cube(stage, f"{path}/{name}", (0, 0, 0), 1.0)
    model = saved(stage, tmp_path)
    assert {model.body(n).name for n in range(model.nbody)} == {"world", "world_", "a", "b"}
    names = [model.geom(n).name for n in range(model.ngeom) if model.geom_contype[n]]
    assert {"a.Same", "b.Same", "b.Küche"} <= set(names)
    assert len(set(names)) == len(names) == 9


@pytest.mark.parametrize(("up", "metres"), [("Y", 0.01), ("Z", 1.0)])
def test_units_and_axes_become_metres_and_z_up(up: str, metres: float, tmp_path: Path) -> None:
    stage = new_stage(metres, up)
    high = (0, 2 / metres, 0) if up == "Y" else (0, 0, 2 / metres)
    box = cube(stage, "/Box", high, 0.5 / metres)
    UsdPhysics.RigidBodyAPI.Apply(box)
    UsdPhysics.MassAPI.Apply(box).CreateDensityAttr(500.0 * metres**3)
    model = saved(stage, tmp_path)
    assert model.body("Box").pos == pytest.approx([0, 0, 2])
    assert model.body("Box").mass[0] == pytest.approx(62.5, rel=1e-3)
    assert model.geom("Box").size == pytest.approx([0.25] * 3)
    data = after(model, 0.5)
    assert data.body("Box").xpos[2] == pytest.approx(2 - 9.81 / 8, abs=0.01)


@pytest.mark.parametrize("flipped", [False, True])
def test_a_drawer_and_a_door_move_as_the_stage_says(flipped: bool, tmp_path: Path) -> None:
    stage = new_stage()
    base = cube(stage, "/Base", (0, 0, 0), 1.0)
    for name, at in (("Door", (1.2, 0, 0)), ("Drawer", (0, 1.5, 0))):
        body = cube(stage, f"/{name}", at, 1.0)
        UsdPhysics.RigidBodyAPI.Apply(body)
    door = UsdPhysics.RevoluteJoint.Define(stage, "/Hinge")
    drawer = UsdPhysics.PrismaticJoint.Define(stage, "/Slide")
    ends = [
        (door, "/Door", (0.6, 0, 0), (-0.6, 0, 0), "Z"),
        (drawer, "/Drawer", (0, 0, 0), (0, 0, 0), "Y"),
    ]
    for joint, path, on_base, on_body, axis in ends:
        sides = [(str(base.GetPath()), on_base), (path, on_body)]
        (first, at0), (second, at1) = sides[::-1] if flipped else sides
        joint.CreateBody0Rel().SetTargets([first])
        joint.CreateBody1Rel().SetTargets([second])
        joint.CreateLocalPos0Attr(at0)
        joint.CreateLocalPos1Attr(at1)
        joint.CreateAxisAttr(axis)
        joint.CreateLowerLimitAttr(-2.0)
        joint.CreateUpperLimitAttr(80.0)
    UsdPhysics.DriveAPI.Apply(door.GetPrim(), "angular").CreateDampingAttr(0.1)
    model = saved(stage, tmp_path)
    assert np.degrees(model.joint("Hinge").range) == pytest.approx([-2, 80])
    assert model.joint("Slide").range == pytest.approx([-2, 80])
    assert model.joint("Hinge").damping[0] == pytest.approx(0.1 * 180 / np.pi)
    sign = -1.0 if flipped else 1.0
    assert model.joint("Slide").qpos0[0] == pytest.approx(1.5 * sign)
    data = mujoco.MjData(model)
    data.joint("Hinge").qpos = np.radians(30.0)
    data.joint("Slide").qpos = 2.0 * sign
    mujoco.mj_forward(model, data)
    assert data.body("Drawer").xpos == pytest.approx([0, 2.0, 0])
    turn = np.radians(30.0 * sign)
    assert data.body("Door").xpos == pytest.approx(
        [0.6 + 0.6 * np.cos(turn), 0.6 * np.sin(turn), 0]
    )
    assert model.nexclude == 2


def test_a_bowl_is_hollow_and_a_hull_is_not(tmp_path: Path) -> None:
    """A ball dropped into an open box of sheets meets its floor; into its hull, its rim."""
    heights = {}
    for how in ("none", "convexHull"):
        stage = new_stage()
        mesh = UsdGeom.Mesh.Define(stage, "/Tub")
        mesh.CreatePointsAttr(
            [(x, y, z) for z in (0, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        )
        mesh.CreateFaceVertexCountsAttr([4] * 5)
        mesh.CreateFaceVertexIndicesAttr(
            [0, 1, 2, 3, 0, 4, 5, 1, 1, 5, 6, 2, 2, 6, 7, 3, 3, 7, 4, 0]
        )
        UsdPhysics.CollisionAPI.Apply(mesh.GetPrim())
        UsdPhysics.MeshCollisionAPI.Apply(mesh.GetPrim()).CreateApproximationAttr(how)
        ball = UsdGeom.Sphere.Define(stage, "/Ball")
        ball.CreateRadiusAttr(0.1)
        ball.AddTranslateOp().Set(Gf.Vec3d(0.2, 0.1, 1.3))
        UsdPhysics.CollisionAPI.Apply(ball.GetPrim())
        UsdPhysics.RigidBodyAPI.Apply(ball.GetPrim())
        folder = tmp_path / how
        folder.mkdir()
        heights[how] = after(saved(stage, folder), SECONDS).body("Ball").xpos[2]
    assert heights["none"] == pytest.approx(0.1, abs=0.02)
    assert heights["convexHull"] == pytest.approx(1.1, abs=0.02)


@pytest.mark.parametrize(
    ("kind", "geom"),
    [("Capsule", "CAPSULE"), ("Cylinder", "CYLINDER"), ("Cone", "MESH"), ("Sphere", "SPHERE")],
)
@pytest.mark.parametrize("axis", ["X", "Y", "Z"])
def test_round_colliders_lie_along_their_axis(
    kind: str, geom: str, axis: str, tmp_path: Path
) -> None:
    stage = new_stage()
    shape = getattr(UsdGeom, kind).Define(stage, "/Shape")
    shape.CreateRadiusAttr(0.5)
    if kind != "Sphere":
        shape.CreateHeightAttr(3.0)
        shape.CreateAxisAttr(axis)
    UsdPhysics.CollisionAPI.Apply(shape.GetPrim())
    UsdPhysics.RigidBodyAPI.Apply(shape.GetPrim())
    model = saved(stage, tmp_path)
    felt = next(n for n in range(model.ngeom) if model.geom_contype[n])
    assert model.geom_type[felt] == getattr(mujoco.mjtGeom, f"mjGEOM_{geom}")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    inertia = (
        data.ximat[1].reshape(3, 3) @ np.diag(model.body_inertia[1]) @ data.ximat[1].reshape(3, 3).T
    )
    if kind != "Sphere":
        assert int(np.argmin(np.diag(inertia))) == "XYZ".index(axis)


def test_joints_that_close_a_loop_or_are_unknown_do_not_stop_a_model(tmp_path: Path) -> None:
    stage = new_stage()
    for number, name in enumerate("ABC"):
        UsdPhysics.RigidBodyAPI.Apply(cube(stage, f"/{name}", (3.0 * number, 0, 0), 1.0))
    for name, first, second in (("AB", "A", "B"), ("BC", "B", "C"), ("CA", "C", "A")):
        joint = UsdPhysics.RevoluteJoint.Define(stage, f"/{name}")
        joint.CreateBody0Rel().SetTargets([f"/{first}"])
        joint.CreateBody1Rel().SetTargets([f"/{second}"])
    far = UsdPhysics.DistanceJoint.Define(stage, "/Rope")
    far.CreateBody1Rel().SetTargets(["/A"])
    lost = UsdPhysics.FixedJoint.Define(stage, "/Lost")
    lost.CreateBody0Rel().SetTargets(["/Nowhere"])
    model = saved(stage, tmp_path)
    assert (model.njnt, model.neq) == (3, 1)
    text = (tmp_path / "model/model.xml").read_text()
    assert "/Rope" in text
    assert "/Lost" in text


def test_sixty_rooms_are_one_model(tmp_path: Path) -> None:
    """Each a component with walls of its own and a chair that moves."""
    stage = new_stage()
    for room in range(60):
        root = UsdGeom.Xform.Define(stage, f"/House/Room_{room}")
        root.AddTranslateOp().Set(Gf.Vec3d(4.0 * (room % 10), 4.0 * (room // 10), 0.0))
        Usd.ModelAPI(root.GetPrim()).SetKind("group")
        cube(stage, f"{root.GetPath()}/Floor", (0, 0, -2), 4.0)
        for chair in range(3):
            UsdPhysics.RigidBodyAPI.Apply(
                cube(stage, f"{root.GetPath()}/Chair_{chair}", (chair - 1, 0, 0.2), 0.4)
            )
    model = saved(stage, tmp_path)
    assert model.njnt == 180
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    start = data.xpos.copy()
    assert np.linalg.norm(after(model, 0.2).xpos - start, axis=1).max() < MOST_M


# Targets ------------------------------------------------------------------------------------------


def test_a_model_is_written_anew_only_when_asked(tmp_path: Path) -> None:
    stage = new_stage()
    cube(stage, "/Box", (0, 0, 0), 1.0)
    path = tmp_path / "stage.usda"
    stage.GetRootLayer().Export(str(path))
    target = exported(path, tmp_path)
    with pytest.raises(OutputError, match="overwrite=True"):
        export_stage(path, target, "mujoco")
    assert main(["export", str(path), "--for", "mujoco", "-o", str(target), "--overwrite"]) == 0
    for wrong in (path, tmp_path, tmp_path / "house.xml"):
        assert main(["export", str(path), "--for", "mujoco", "-o", str(wrong)]) == UNUSABLE
    assert path.read_text().startswith("#usda")


def test_a_robot_that_is_added_keeps_its_weight(tmp_path: Path) -> None:
    """Its geoms are of no group in particular."""
    stage = new_stage()
    UsdPhysics.RigidBodyAPI.Apply(cube(stage, "/Crate", (0, 0, 0.5), 1.0))
    saved(stage, tmp_path)
    spec = mujoco.MjSpec.from_file(str(tmp_path / "model/model.xml"))
    robot = spec.worldbody.add_body(name="robot", pos=[3, 0, 1])
    robot.add_freejoint()
    robot.add_geom(type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.1, 0.1, 0.1], mass=8.0)
    model = spec.compile()
    assert model.body("robot").mass[0] == pytest.approx(8.0)
    assert model.body("Crate").mass[0] == pytest.approx(1000.0, rel=1e-6)
    assert model.body("Crate").inertia == pytest.approx([1000 / 6] * 3, rel=1e-6)
