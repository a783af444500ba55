"""A house as URDF and SDF: one tree, as large as the stage, its joints where the stage has them."""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import trimesh
from pxr import Usd, UsdGeom
from scipy.spatial.transform import Rotation

from chord_usd.base.scene.articulation import ARTICULATION, JOINTED
from chord_usd.line.pipeline.house_states import set_states
from chord_usd.line.stage.export.exchange.mjcf_frames import dotted
from chord_usd.line.stage.export.export_stage import export_stage


class Robot:
    """A model with its joints at 0, read as ROS does."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.root = ET.parse(folder / "model.urdf").getroot()
        self.links = {link.attrib["name"]: link for link in self.root.iter("link")}
        self.joints = {
            joint.find("child").attrib["link"]: joint for joint in self.root.iter("joint")
        }

    def pose(self, link: str) -> np.ndarray:
        joint = self.joints.get(link)
        if joint is None:
            return np.eye(4)
        return self.pose(joint.find("parent").attrib["link"]) @ origin(joint)

    def bounds_m(self) -> np.ndarray:
        """Of all that is seen."""
        corners = []
        for name, link in self.links.items():
            for visual in link.iter("visual"):
                mesh = visual.find("geometry/mesh")
                scale = np.fromstring(mesh.get("scale", "1 1 1"), sep=" ")
                loaded = trimesh.load_mesh(self.folder / mesh.attrib["filename"], process=False)
                points = np.c_[loaded.vertices * scale, np.ones(len(loaded.vertices))]
                corners.append((points @ (self.pose(name) @ origin(visual)).T)[:, :3])
        every = np.concatenate(corners)
        return np.array([every.min(axis=0), every.max(axis=0)])


def origin(element: ET.Element) -> np.ndarray:
    record = element.find("origin")
    pose = np.eye(4)
    pose[:3, 3] = np.fromstring(record.get("xyz", "0 0 0"), sep=" ")
    angles = np.fromstring(record.get("rpy", "0 0 0"), sep=" ")
    pose[:3, :3] = Rotation.from_euler("xyz", angles).as_matrix()
    return pose


@pytest.fixture(scope="module")
def robot(opening_house: Path, tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """Of a copy with its doors ajar and its furniture open, which counts for nothing at 0."""
    house = opening_house.with_name("stated.usda")
    set_states(opening_house, house, "doors: ajar; furniture: open")
    folder = tmp_path_factory.mktemp("urdf") / "house"
    export_stage(house, folder, "urdf")
    return Robot(folder)


def test_a_model_is_one_tree(robot: Robot) -> None:
    assert set(robot.links) - set(robot.joints) == {"world"}
    names = [joint.attrib["name"] for joint in robot.root.iter("joint")]
    assert len(names) == len(set(names))
    assert len(list(robot.root.iter("link"))) == len(robot.links)
    kinds = {joint.attrib["type"] for joint in robot.joints.values()}
    assert kinds >= {"fixed", "floating", "revolute"}
    for link in robot.links.values():
        for look in link.iter("material"):
            assert robot.root.find(f"material[@name='{look.attrib['name']}']") is not None
    for name, joint in robot.joints.items():
        if joint.attrib["type"] == "revolute":
            assert float(robot.links[name].find("inertial/mass").attrib["value"]) > 0.0


def test_joints_at_zero_are_shut_and_all_is_where_the_stage_has_it(
    robot: Robot, opening_house: Path
) -> None:
    stage = Usd.Stage.Open(str(opening_house))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    box = cache.ComputeWorldBound(stage.GetPseudoRoot()).ComputeAlignedRange()
    assert np.allclose(robot.bounds_m(), [box.GetMin(), box.GetMax()], atol=1e-3)
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for prim in list(stage.Traverse()):
            if prim.GetVariantSets().HasVariantSet(ARTICULATION):
                prim.GetVariantSet(ARTICULATION).SetVariantSelection(JOINTED)
    transforms, leaves = UsdGeom.XformCache(), 0
    for prim in stage.Traverse():
        joint = robot.joints.get(dotted(prim.GetPath()))
        if joint is not None and joint.attrib["type"] in ("revolute", "prismatic"):
            leaves += 1
            at = np.array(transforms.GetLocalToWorldTransform(prim).ExtractTranslation())
            pose = robot.pose(dotted(prim.GetPath()))
            assert np.allclose(pose[:3, 3], at, atol=1e-4), prim.GetPath()
    assert leaves == sum(j.attrib["type"] in ("revolute", "prismatic")
                         for j in robot.joints.values())  # fmt: skip


def test_an_sdf_has_the_links_joints_and_poses_of_the_urdf(
    robot: Robot, opening_house: Path, tmp_path: Path
) -> None:
    export_stage(opening_house, tmp_path / "sdf", "sdf")
    model = ET.parse(tmp_path / "sdf" / "model.sdf").getroot().find("model")
    links = {link.attrib["name"]: link for link in model.findall("link")}
    joints = {joint.attrib["name"]: joint for joint in model.findall("joint")}
    ends = [joint.find(end).text for joint in joints.values() for end in ("parent", "child")]
    assert set(ends) <= {*links, "world"}
    assert len(joints) == len(model.findall("joint"))
    assert not any(link.attrib["name"] == "world" for link in links.values())
    for mesh in model.iter("uri"):
        assert (tmp_path / "sdf" / mesh.text).is_file()
    turning = {name for name, joint in joints.items() if joint.attrib["type"] == "revolute"}
    doors = {joint.attrib["name"]: name for name, joint in robot.joints.items()
             if joint.attrib["type"] == "revolute" and "Architecture" in name}  # fmt: skip
    assert doors
    assert set(doors) <= turning  # the furniture of this one is not jointed
    for joint, link in doors.items():
        limit = joints[joint].find("axis/limit")
        record = next(entry for entry in robot.root.iter("joint") if entry.attrib["name"] == joint)
        assert limit.find("upper").text == record.find("limit").attrib["upper"]
        pose, parent = links[link].find("pose"), links[link].find("pose").attrib["relative_to"]
        assert parent == record.find("parent").attrib["link"]
        at = np.array(pose.text.split(), dtype=float)[:3]
        assert np.allclose(at, origin(record)[:3, 3], atol=1e-6)
