"""A stage as SDF: the links and joints of its URDF in the words of Gazebo and Drake.

What is free has no joint; what stands still is held to the world by a joint of the type `fixed`.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

from pxr import Usd

from chord_usd.line.stage.export.exchange.urdf_model import WORLD, urdf_of

MODEL_FILE = "model.sdf"
_VERSION = "1.9"
_HOUSE = "house"
"""The link of what stands still: SDF keeps the name `world`."""


def write_sdf(stage: Usd.Stage, folder: Path) -> None:
    """Write model.sdf and meshes/ for what the stage has selected. Raises StageError for a stage
    with nothing in it."""
    urdf = urdf_of(stage, folder)
    root = ET.Element("sdf", version=_VERSION)
    model = ET.SubElement(root, "model", name=urdf.attrib["name"])
    colours = {look.attrib["name"]: look for look in urdf.findall("material")}
    poses = {_child(joint): joint for joint in urdf.iter("joint")}
    for link in urdf.iter("link"):
        model.append(_link(link, poses.get(link.attrib["name"]), colours))
    model.append(_joint("held", "fixed", WORLD, _HOUSE))
    for joint in urdf.iter("joint"):
        if joint.attrib["type"] != "floating":
            model.append(_moving(joint))
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    (folder / MODEL_FILE).write_text(text + "\n", encoding="utf-8")


def _link(
    link: ET.Element, joint: ET.Element | None, colours: dict[str, ET.Element]
) -> ET.Element:  # fmt: skip
    element = ET.Element("link", name=_called(link.attrib["name"]))
    if joint is not None:
        above = _called(_parent(joint))
        element.append(_pose(joint, relative_to=above))
    inertial = link.find("inertial")
    if inertial is not None:
        element.append(_inertial(inertial))
    for number, part in enumerate(entry for entry in link if entry.tag in ("visual", "collision")):
        record = ET.SubElement(element, part.tag, name=f"{part.tag}_{number}")
        record.append(_pose(part))
        record.append(_geometry(part))
        look = part.find("material")
        if look is not None:
            colour = colours[look.attrib["name"]].find("color")
            shown = ET.SubElement(record, "material")
            ET.SubElement(shown, "diffuse").text = (
                colour.attrib["rgba"] if colour is not None else ""
            )
    return element


def _geometry(part: ET.Element) -> ET.Element:
    """The same shape, its attributes as elements."""
    element = ET.Element("geometry")
    for shape in part.findall("geometry/*"):
        record = ET.SubElement(element, shape.tag)
        for name, value in shape.attrib.items():
            ET.SubElement(record, "uri" if name == "filename" else name).text = value
    return element


def _inertial(inertial: ET.Element) -> ET.Element:
    element = ET.Element("inertial")
    element.append(_pose(inertial))
    for name in ("mass", "inertia"):
        record = inertial.find(name)
        assert record is not None, "an inertial has both"
        if name == "mass":
            ET.SubElement(element, name).text = record.attrib["value"]
            continue
        moments = ET.SubElement(element, name)
        for moment, value in record.attrib.items():
            ET.SubElement(moments, moment).text = value
    return element


def _moving(joint: ET.Element) -> ET.Element:
    kind = joint.attrib["type"]
    name, above, child = joint.attrib["name"], _called(_parent(joint)), _called(_child(joint))
    element = _joint(name, kind, above, child)
    axis, limit, dynamics = (joint.find(tag) for tag in ("axis", "limit", "dynamics"))
    if axis is None or limit is None:
        return element
    record = ET.SubElement(element, "axis")
    ET.SubElement(record, "xyz").text = axis.attrib["xyz"]
    limits = ET.SubElement(record, "limit")
    for bound in ("lower", "upper", "effort", "velocity"):
        ET.SubElement(limits, bound).text = limit.attrib[bound]
    if dynamics is not None:
        damped = ET.SubElement(record, "dynamics")
        ET.SubElement(damped, "damping").text = dynamics.attrib["damping"]
    return element


def _joint(name: str, kind: str, parent: str, child: str) -> ET.Element:
    element = ET.Element("joint", name=name, type=kind)
    ET.SubElement(element, "parent").text = parent
    ET.SubElement(element, "child").text = child
    return element


def _pose(element: ET.Element, **record: str) -> ET.Element:
    origin = element.find("origin")
    pose = ET.Element("pose", record)
    pose.text = f"{origin.attrib['xyz']} {origin.attrib['rpy']}" if origin is not None else ""
    return pose


def _called(link: str) -> str:
    return _HOUSE if link == WORLD else link


def _parent(joint: ET.Element) -> str:
    return next(entry.attrib["link"] for entry in joint.findall("parent"))


def _child(joint: ET.Element) -> str:
    return next(entry.attrib["link"] for entry in joint.findall("child"))
