"""A stage as URDF: the tree of bodies and joints that MJCF has, in the words of ROS.

Links are bodies; joints at 0 are shut, wherever the stage has them. What is free hangs on a joint
of the type `floating`.
"""

from __future__ import annotations

import math
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
from pxr import Usd
from scipy.spatial.transform import Rotation

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.export.exchange.mjcf_frames import numbers
from chord_usd.line.stage.export.exchange.mjcf_looks import MESHES, TEXTURES
from chord_usd.line.stage.export.exchange.mjcf_model import mjcf_of

MODEL_FILE = "model.urdf"
WORLD = "world"
"""The link of what stands still."""

_TYPES = {"hinge": "revolute", "slide": "prismatic"}
_EFFORT, _SPEED = 100.0, 2.0
"""Of motors, which nothing here has and URDF asks for: newtons, metres or radians a second."""


def write_urdf(stage: Usd.Stage, folder: Path) -> None:
    """Write model.urdf and meshes/ for what the stage has selected; colours for pictures.

    Raises StageError for a stage with nothing in it.
    """
    root = urdf_of(stage, folder)
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    (folder / MODEL_FILE).write_text(text + "\n", encoding="utf-8")


def urdf_of(stage: Usd.Stage, folder: Path) -> ET.Element:
    """The model as XML; its meshes are written into the folder, new or empty. Raises StageError."""
    root = _Writer(mjcf_of(stage, folder)).model()
    shutil.rmtree(folder / TEXTURES, ignore_errors=True)
    return root


class _Writer:
    def __init__(self, mjcf: ET.Element) -> None:
        asset = mjcf.find("asset")
        assert asset is not None, "a model has one"
        self._mjcf = mjcf
        self._meshes = {mesh.attrib["name"]: mesh for mesh in asset.iter("mesh")}
        self._colours = {
            look.attrib["name"]: look.get("rgba", "1 1 1 1") for look in asset.iter("material")
        }
        self._root = ET.Element("robot", name=_named(mjcf.get("model", "stage")))

    def model(self) -> ET.Element:
        for name, rgba in self._colours.items():
            look = ET.SubElement(self._root, "material", name=name)
            ET.SubElement(look, "color", rgba=rgba)
        world = self._mjcf.find("worldbody")
        assert world is not None, "a model has one"
        waiting: list[tuple[ET.Element, str, FloatArray]] = [(world, "", np.eye(4))]
        while waiting:
            body, parent, shift = waiting.pop()
            name, local = self._link(body, parent, shift)
            waiting += [(child, name, local) for child in reversed(body.findall("body"))]
        return self._root

    def _link(self, body: ET.Element, parent: str, above: FloatArray) -> tuple[str, FloatArray]:
        """Write a body as a link, and the joint to its parent; returns its name, and (4, 4) its
        frame of MJCF in the frame that it has here: where its joint is, as it stands at 0."""
        name = _named(body.get("name", WORLD)) if parent else WORLD
        joint = next(iter(body.findall("joint")), None)
        local = np.eye(4)
        if joint is not None:
            local[:3, 3] = -_vector(joint, "pos", "0 0 0")
        link = ET.SubElement(self._root, "link", name=name)
        if parent:
            pose = above @ _pose(body) @ np.linalg.inv(local) @ _back(joint)
            self._joint(body, joint, parent, name, pose)
        inertial = body.find("inertial")
        if inertial is not None and (joint is not None or body.find("freejoint") is not None):
            link.append(_inertial(inertial, local))
        for geom in body.findall("geom"):
            self._geom(link, geom, local)
        return name, local

    def _joint(
        self, body: ET.Element, joint: ET.Element | None, parent: str, child: str, pose: FloatArray
    ) -> None:
        kind = "fixed"
        if joint is not None:
            kind = _TYPES.get(joint.get("type", ""), "floating")
        elif body.find("freejoint") is not None:
            kind = "floating"
        name = _named(joint.attrib["name"]) if joint is not None else f"{child}.joint"
        element = ET.SubElement(self._root, "joint", name=name, type=kind)
        ET.SubElement(element, "parent", link=parent)
        ET.SubElement(element, "child", link=child)
        element.append(_origin(pose))
        if joint is None or kind == "floating":
            return
        ET.SubElement(element, "axis", xyz=joint.get("axis", "0 0 1"))
        low, high = _vector(joint, "range", "-180 180")
        unit = math.radians(1.0) if kind == "revolute" else 1.0
        ET.SubElement(
            element, "limit", lower=numbers([low * unit]), upper=numbers([high * unit]),
            effort=numbers([_EFFORT]), velocity=numbers([_SPEED]),
        )  # fmt: skip
        ET.SubElement(element, "dynamics", damping=joint.get("damping", "0"))

    def _geom(self, link: ET.Element, geom: ET.Element, local: FloatArray) -> None:
        shape = self._shape(geom)
        if shape is None:
            return
        is_seen = geom.get("class") != "felt"
        part = ET.SubElement(link, "visual" if is_seen else "collision")
        part.append(_origin(local @ _pose(geom)))
        ET.SubElement(part, "geometry").append(shape)
        if is_seen and geom.get("material"):
            ET.SubElement(part, "material", name=geom.attrib["material"])

    def _shape(self, geom: ET.Element) -> ET.Element | None:
        """None for what URDF has no word for: planes, height fields."""
        kind = geom.get("type", "mesh")
        if kind == "mesh":
            mesh = self._meshes[geom.attrib["mesh"]]
            record = {"filename": f"{MESHES}/{mesh.attrib['file']}"}
            return ET.Element("mesh", record | ({"scale": s} if (s := mesh.get("scale")) else {}))
        size = _vector(geom, "size", "0 0 0")
        if kind == "box":
            return ET.Element("box", size=numbers(2 * size))
        if kind in ("cylinder", "capsule"):
            more = size[0] if kind == "capsule" else 0.0
            length = numbers([2 * (size[1] + more)])
            return ET.Element("cylinder", radius=numbers(size[:1]), length=length)
        if kind in ("sphere", "ellipsoid"):
            return ET.Element("sphere", radius=numbers([size.max()]))
        return None


def _named(name: str) -> str:
    """Names of frames in ROS hold no other characters."""
    return re.sub(r"[^A-Za-z0-9_.]", "_", name)


def _vector(element: ET.Element, name: str, otherwise: str) -> FloatArray:
    return np.array(element.get(name, otherwise).split(), dtype=np.float64)


def _pose(element: ET.Element) -> FloatArray:
    """(4, 4) of pos and quat."""
    pose = np.eye(4)
    pose[:3, 3] = _vector(element, "pos", "0 0 0")
    w, x, y, z = _vector(element, "quat", "1 0 0 0")
    pose[:3, :3] = Rotation.from_quat([x, y, z, w]).as_matrix()
    return pose


def _back(joint: ET.Element | None) -> FloatArray:
    """(4, 4) that takes a body from where it stands to where its joint is at 0."""
    back = np.eye(4)
    if joint is None or not joint.get("ref"):
        return back
    axis, now = _vector(joint, "axis", "0 0 1"), float(joint.attrib["ref"])
    if joint.get("type") == "slide":
        back[:3, 3] = -axis * now
    else:
        back[:3, :3] = Rotation.from_rotvec(-axis * math.radians(now)).as_matrix()
    return back


def _origin(pose: FloatArray) -> ET.Element:
    rpy = Rotation.from_matrix(pose[:3, :3]).as_euler("xyz")
    return ET.Element("origin", xyz=numbers(pose[:3, 3]), rpy=numbers(rpy))


def _inertial(record: ET.Element, local: FloatArray) -> ET.Element:
    pose = local @ _pose(record)
    element = ET.Element("inertial")
    element.append(_origin(pose))
    ET.SubElement(element, "mass", value=record.attrib["mass"])
    moments = dict(zip(("ixx", "iyy", "izz", "ixy", "ixz", "iyz"), _moments(record), strict=True))
    ET.SubElement(element, "inertia", {name: f"{value:.9g}" for name, value in moments.items()})
    return element


def _moments(record: ET.Element) -> Iterator[float]:
    full = record.get("fullinertia")
    values = full.split() if full else [*record.attrib["diaginertia"].split(), "0", "0", "0"]
    yield from map(float, values)
