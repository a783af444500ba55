"""A stage as a model of MuJoCo: MJCF with its meshes and pictures beside it.

Bodies, colliders, joints and masses are read off UsdPhysics, whoever wrote them.
"""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
from pxr import Usd, UsdGeom, UsdLux, UsdPhysics

from chord_usd.base.errors import StageError
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.export.exchange.mjcf_bodies import Body, Mechanism, mechanism_of, name_of
from chord_usd.line.stage.export.exchange.mjcf_frames import (
    Frames,
    dotted,
    numbers,
    placed,
    rigid,
    scale_of,
)
from chord_usd.line.stage.export.exchange.mjcf_geoms import Shape, friction_of, shapes_of, solid_of
from chord_usd.line.stage.export.exchange.mjcf_looks import MESHES, TEXTURES, Assets, seen_of
from chord_usd.line.stage.export.exchange.mjcf_masses import STILL, Masses, PieceOfMass
from chord_usd.line.stage.export.gltf_lights import light_of
from chord_usd.line.stage.read.vertices import Vertices

MODEL_FILE = "model.xml"
_EARTH_M_PER_S2 = 9.81
_STEP_S = 0.002
_FRICTION = "0.5 0.005 0.0001"
"""Of colliders without a material."""

_ASIDE = (UsdGeom.Tokens.guide, UsdGeom.Tokens.render)


def write_mjcf(stage: Usd.Stage, folder: Path) -> None:
    """Write model.xml, meshes/ and textures/ for what the stage has selected.

    Names of bodies, joints, geoms, lights and cameras are paths with dots. Raises StageError for a
    stage with nothing in it.
    """
    root = mjcf_of(stage, folder)
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    (folder / MODEL_FILE).write_text(text + "\n", encoding="utf-8")


def mjcf_of(stage: Usd.Stage, folder: Path) -> ET.Element:
    """The model as XML; its meshes and textures are written into the folder. Raises StageError."""
    return _Writer(stage, folder).model()


class _Writer:
    """A model being written."""

    def __init__(self, stage: Usd.Stage, folder: Path) -> None:
        self._stage = stage
        self._frames = Frames(stage)
        self._assets = Assets(folder)
        self._masses = Masses(stage)
        self._elements: dict[Body, ET.Element] = {}
        self._geoms = 0

    def model(self) -> ET.Element:
        mechanism = mechanism_of(self._stage, self._frames)
        root = ET.Element("mujoco", model=_title(self._stage))
        if mechanism.left_out:
            said = ", ".join(mechanism.left_out).replace("--", "- -")
            root.append(ET.Comment(f" joints that MJCF lacks: {said} "))
        _settings(root, _gravity(self._stage, self._frames))
        root.append(self._assets.element)
        self._bodies(ET.SubElement(root, "worldbody"), mechanism)
        if not self._geoms:
            raise StageError(
                "holds no visible mesh and no collider",
                where=self._stage.GetRootLayer().realPath,
                expected="meshes or colliders",
            )
        self._ties(root, mechanism)
        self._labels(root, mechanism)
        return root

    def _bodies(self, world: ET.Element, mechanism: Mechanism) -> None:
        below: dict[Body, list[Body]] = {}
        first = mechanism.bodies[0]
        for body in mechanism.bodies[1:]:
            below.setdefault(body.parent or first, []).append(body)
        self._elements[first] = world
        waiting = [first]
        while waiting:
            body = waiting.pop()
            if body is not first:
                self._open(body)
            self._fill(body)
            waiting += reversed(below.get(body, []))
        lights = [
            part for body in mechanism.bodies for part in body.parts if part.HasAPI(UsdLux.LightAPI)
        ]
        for light in sorted(lights, key=strength):
            attributes = light_attributes(light, rigid(self._frames.of(light)))
            if attributes and _is_seen(light):
                ET.SubElement(world, "light", {"name": name_of(light), **attributes})

    def _open(self, body: Body) -> None:
        """The element of a body, with its joints."""
        above = body.parent.pose if body.parent else np.eye(4)
        owner = self._elements[body.parent] if body.parent else next(iter(self._elements.values()))
        attributes = {"name": body.name, **placed(np.linalg.inv(above) @ body.pose)}
        if body.is_led:
            attributes["mocap"] = "true"
        element = self._elements[body] = ET.SubElement(owner, "body", attributes)
        if body.moves and body.parent is None:
            ET.SubElement(element, "freejoint", name=body.name)
        for link in body.links:
            ET.SubElement(element, "joint", link.attributes())

    def _fill(self, body: Body) -> None:
        """Write the colliders and the visible geoms of a body."""
        element = self._elements[body]
        inverse = np.linalg.inv(body.pose)
        colliders: list[PieceOfMass] = []
        for prim in body.parts:
            frame = inverse @ self._frames.of(prim)
            if prim.HasAPI(UsdPhysics.CollisionAPI) and prim.IsA(UsdGeom.Gprim):
                colliders += self._collider(element, prim, frame, moves=body.moves)
            if prim.IsA(UsdGeom.Camera):
                attributes = camera_attributes(prim, rigid(frame), self._frames.metres)
                ET.SubElement(element, "camera", {"name": name_of(prim), **attributes})
        if body.moves:
            self._masses.share(body.prim, element, colliders, self._frames)
        elif element.tag == "body":
            element.insert(0, ET.Element("inertial", STILL))
        self._looks(body, element)

    def _collider(
        self, element: ET.Element, prim: Usd.Prim, frame: FloatArray, *, moves: bool
    ) -> list[PieceOfMass]:
        if not UsdPhysics.CollisionAPI(prim).GetCollisionEnabledAttr().Get():
            return []
        friction = friction_of(prim)
        pieces = []
        for number, shape in enumerate(shapes_of(prim, frame, moves=moves)):
            name = name_of(prim) + (f".{number}" if number else "")
            self._geoms += 1
            if not isinstance(shape, Shape):
                element.append(shape.element(name, friction or _FRICTION))
                continue
            attributes = {"name": name, "class": "felt", **shape.attributes}
            if friction:
                attributes["friction"] = friction
            if shape.hull is not None:
                attributes["mesh"] = self._assets.hull(shape.hull)
            ET.SubElement(element, "geom", attributes)
            pieces.append(PieceOfMass(prim, shape))
        return pieces

    def _looks(self, body: Body, element: ET.Element) -> None:
        """One geom for each material of a body's meshes; other solids are geoms themselves."""
        matrix = self._frames.of(body.prim) if body.prim.GetParent() else self._frames.world
        scale, skew = scale_of(matrix), np.eye(4)
        if scale is None:
            scale, skew = np.ones(3), np.linalg.inv(body.pose) @ matrix
        parts: dict[str, list[Vertices]] = {}
        for prim in body.parts:
            if not prim.IsA(UsdGeom.Gprim) or not _is_seen(prim):
                continue
            material, placement = self._assets.look_of(prim)
            if not prim.IsA(UsdGeom.Mesh):
                self._solid(body, element, prim, material)
                continue
            local = self._frames.within(prim, body.prim)
            vertices = seen_of(prim, skew @ local, placement)
            if vertices is not None:
                parts.setdefault(material, []).append(vertices)
        for material, solids in parts.items():
            name = f"{body.prim.GetName()}_{material}" if body.prim.GetParent() else material
            mesh = self._assets.mesh(name, solids, scale)
            if mesh is not None:
                attributes = {"class": "seen", "mesh": mesh, "material": material}
                ET.SubElement(element, "geom", attributes)
                self._geoms += 1

    def _solid(self, body: Body, element: ET.Element, prim: Usd.Prim, material: str) -> None:
        shape = solid_of(prim, np.linalg.inv(body.pose) @ self._frames.of(prim))
        if shape is None:
            return
        attributes = {"class": "seen", "material": material, **shape.attributes}
        if shape.hull is not None:
            attributes["mesh"] = self._assets.hull(shape.hull)
        ET.SubElement(element, "geom", attributes)
        self._geoms += 1

    def _ties(self, root: ET.Element, mechanism: Mechanism) -> None:
        """What does not touch, and joints that close a loop."""
        world = mechanism.bodies[0]
        pairs = [pair for pair in mechanism.apart if world not in pair]
        if pairs:
            contact = ET.SubElement(root, "contact")
            for first, second in dict.fromkeys(pairs):
                ET.SubElement(contact, "exclude", body1=first.name, body2=second.name)
        if mechanism.loops:
            equality = ET.SubElement(root, "equality")
            for loop in mechanism.loops:
                attributes = {"name": dotted(loop.path)}
                names = {"body1": _known(loop.first, world), "body2": _known(loop.second, world)}
                if loop.kind != "fixed":
                    attributes["anchor"] = numbers(loop.anchor)
                kind = "weld" if loop.kind == "fixed" else "connect"
                ET.SubElement(equality, kind, attributes | names)

    def _labels(self, root: ET.Element, mechanism: Mechanism) -> None:
        """Texts with the names of bodies: their class."""
        custom = ET.Element("custom")
        for body in mechanism.bodies[1:]:
            values = body.prim.GetAttribute("semantics:labels:class").Get()
            if values:
                ET.SubElement(custom, "text", name=body.name, data=str(values[0]))
        if len(custom):
            root.append(custom)


def _known(body: Body, world: Body) -> str:
    return "world" if body is world else body.name


def _title(stage: Usd.Stage) -> str:
    prim = stage.GetDefaultPrim()
    return prim.GetName() if prim else "stage"


def _settings(root: ET.Element, gravity: FloatArray) -> None:
    ET.SubElement(
        root, "compiler", angle="degree", autolimits="true", meshdir=MESHES, texturedir=TEXTURES,
        boundmass="1e-6", boundinertia="1e-9",
    )  # fmt: skip
    ET.SubElement(
        root, "option", timestep=numbers([_STEP_S]), gravity=numbers(gravity),
        integrator="implicitfast", cone="elliptic",
    )  # fmt: skip
    visual = ET.SubElement(root, "visual")
    ET.SubElement(visual, "global", offwidth="1920", offheight="1080")
    ET.SubElement(visual, "headlight", ambient="0.55 0.55 0.55", diffuse="0.3 0.3 0.3")
    default = ET.SubElement(root, "default")
    seen = ET.SubElement(default, "default", {"class": "seen"})
    ET.SubElement(
        seen, "geom", type="mesh", contype="0", conaffinity="0", group="2", mass="0"
    )  # fmt: skip
    colliders = ET.SubElement(default, "default", {"class": "felt"})
    ET.SubElement(colliders, "geom", group="3", friction=_FRICTION)


def _gravity(stage: Usd.Stage, frames: Frames) -> FloatArray:
    """Of the first physics scene; that of the earth where there is none, or it leaves it open."""
    scene = next((prim for prim in stage.Traverse() if prim.IsA(UsdPhysics.Scene)), None)
    down, strong = np.array([0.0, 0.0, -1.0]), _EARTH_M_PER_S2
    if scene is not None:
        physics = UsdPhysics.Scene(scene)
        way = np.array(physics.GetGravityDirectionAttr().Get(), dtype=np.float64)
        if np.linalg.norm(way) > 0.0:
            turn = rigid(frames.world)[:3, :3]
            down = turn @ way / np.linalg.norm(way)
        size = physics.GetGravityMagnitudeAttr().Get()
        strong = size * frames.metres if 0.0 <= size < float("inf") else strong
    return down * strong


def _is_seen(prim: Usd.Prim) -> bool:
    shape = UsdGeom.Imageable(prim)
    hidden = shape.ComputeVisibility() == UsdGeom.Tokens.invisible
    return not hidden and shape.ComputePurpose() not in _ASIDE


# Lights and cameras of a stage as MJCF has them --------------------------------------------------

_SUN, _LAMP = 0.6, 0.9
"""How bright they are on MuJoCo's screen, where full is 1: its renderer knows no exposure."""

_FADES = "1 0 0.3"
"""A lamp lights its room and little of the next: its light goes through walls."""

_WIDEST_DEG = 80.0
_MM_PER_TENTH = 0.1
_NEAR_M = 0.3
_SUBJECT_M = 3.0
"""So far from a camera's near plane its picture is as wide as on the stage."""

_WIDTH_PX = 1280


def light_attributes(prim: Usd.Prim, pose: FloatArray) -> dict[str, str] | None:
    """Of a `<light>` in the world; None for what is dark, and for skies."""
    light = light_of(prim)
    if light is None:
        return None
    kind = str(light["type"])
    level = _SUN if kind == "directional" else _LAMP
    attributes = {
        "type": "directional" if kind == "directional" else kind,
        "pos": numbers(pose[:3, 3]),
        "dir": numbers(-pose[:3, 2]),
        "diffuse": numbers(np.array(light["color"]) * level),
        "specular": "0.1 0.1 0.1",
        "castshadow": "true" if kind == "directional" else "false",
    }
    if kind != "directional":
        attributes |= {"attenuation": _FADES, "intensity": numbers([light["intensity"]])}
    if kind == "spot":
        attributes |= {"cutoff": numbers([_WIDEST_DEG]), "exponent": "1"}
    return attributes


def camera_attributes(prim: Usd.Prim, pose: FloatArray, metres: float) -> dict[str, str]:
    """Of a `<camera>` in the frame of its body, which is moved to where its picture begins.

    MuJoCo has one near plane for all: a camera that looks into a room from behind a wall would see
    the wall. It stands at its own near plane, with a lens as much wider.
    """
    lens = UsdGeom.Camera(prim).GetCamera()
    across, up = lens.horizontalAperture, lens.verticalAperture
    if lens.projection == lens.Orthographic:
        height = numbers([up * _MM_PER_TENTH * metres])
        return {"projection": "orthographic", "fovy": height, **placed(pose)}
    behind_m = lens.clippingRange.min * metres
    wider = 1.0
    if behind_m > _NEAR_M:
        pose = pose.copy()
        pose[:3, 3] -= behind_m * pose[:3, 2]
        wider = 1.0 + behind_m / _SUBJECT_M
    # In metres; any unit would do.
    sensor, focal = np.array([across, up]) * wider * 1e-3, lens.focalLength * 1e-3
    # MuJoCo counts the vertical shift downwards.
    shift = np.array([lens.horizontalApertureOffset, -lens.verticalApertureOffset]) * wider * 1e-3
    attributes = {
        "sensorsize": numbers(sensor), "focal": numbers([focal, focal]),
        "resolution": f"{_WIDTH_PX} {round(_WIDTH_PX * up / across)}",
    }  # fmt: skip
    if np.abs(shift).max() > 0.0:
        attributes["principal"] = numbers(shift)
    return attributes | placed(pose)


def strength(prim: Usd.Prim) -> tuple[bool, float]:
    """By which lights are put in order, the first of which a renderer may take alone."""
    light = light_of(prim) or {"intensity": 0.0}
    return not prim.IsA(UsdLux.DistantLight), -float(light["intensity"])
