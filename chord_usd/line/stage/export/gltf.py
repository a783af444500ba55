"""A stage as a GLB: the tree of the house, meshes shared by instances, lights, cameras, Y up."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
from pxr import Usd, UsdGeom, UsdLux, UsdPhysics, UsdShade

from chord_usd.base.runtime.networks import usable_cores
from chord_usd.base.runtime.stages import open_known, open_stage, room_prims
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.author.names import REQUESTS
from chord_usd.line.stage.author.surfaces import bound_material
from chord_usd.line.stage.export.gltf_file import Entry, GltfFile
from chord_usd.line.stage.export.gltf_lights import LUX_PER_UNIT, camera_of, light_of
from chord_usd.line.stage.export.gltf_looks import Looks
from chord_usd.line.stage.read.vertices import Vertices, joined, tangents_of, vertices_of
from chord_usd.line.stage.shell.roof import select_roof

_PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
Y_UP: FloatArray = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
"""glTF is Y up; Z up turns into it about x."""

_ASIDE = (UsdGeom.Tokens.guide, UsdGeom.Tokens.render)
"""Purposes of colliders and of the ground outside."""

_LABELS = "SemanticsLabelsAPI:"
_DIGITS = 6


PICTURE_TEXTURE_PX = 1024
VIEW_TEXTURE_PX = 512
"""Of a house that a browser shows: its graphics memory holds pictures unpacked."""


def write_view(stage: Path, target: Path) -> None:
    """Write a house that this program wrote as a .glb with small pictures, and with the roof that
    it offers, which the page leaves out until it is asked for. Raises StageError."""
    house = open_known(stage)
    select_roof(house)
    write_glb(house, target, VIEW_TEXTURE_PX, tangents=False)


def write_drawn(stage: Path, target: Path) -> None:
    """Write a stage as a .glb for pictures of its rooms. Raises StageError."""
    write_glb(open_stage(stage), target, PICTURE_TEXTURE_PX, tangents=False)


def write_glb(
    stage: Usd.Stage,
    target: Path,
    most_px: int | None = None,
    *,
    photometric: bool = False,
    tangents: bool = True,
    root: Usd.Prim | None = None,
) -> None:
    """Write what is seen of the stage to target, a .glb, in metres; pictures of at most most_px.

    root: what is written of it, in its own frame and units; by default all.

    Prims are nodes, with `extras` that say what they are; within a component only those that have
    a label or move are, and the meshes of one node and one material are one primitive. Lights are
    those that shine in the variants selected, at an exposure for rooms by day; photometric: in
    candela and lux. tangents: 16 bytes a vertex of what has a normal map, which browsers derive
    and other readers may not.
    """
    # Pictures are packed by libraries that let Python go on meanwhile.
    with ThreadPoolExecutor(usable_cores()) as pool:
        lux_per_unit = 1.0 if photometric else LUX_PER_UNIT
        writer = _Writer(stage, pool, most_px, lux_per_unit, tangents=tangents)
        top = writer.alone(root) if root else writer.root(stage.GetDefaultPrim())
        writer.looks.finish()
    target.write_bytes(writer.file.to_bytes(top))


class _Writer:
    """Goes through the prims of a stage."""

    def __init__(
        self,
        stage: Usd.Stage,
        pool: Executor,
        most_px: int | None,
        lux_per_unit: float,
        *,
        tangents: bool,
    ) -> None:
        self._lux_per_unit = lux_per_unit
        self._has_tangents = tangents
        self.file = GltfFile()
        self.looks = Looks(self.file, pool, most_px)
        self._rooms = {room.GetPath() for room in room_prims(stage)}
        self._meshes: dict[tuple[str, ...], int] = {}
        self._frames = UsdGeom.XformCache()
        self._metres = UsdGeom.GetStageMetersPerUnit(stage)
        self._is_z_up = UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z

    def root(self, prim: Usd.Prim) -> int:
        """Write the node of the default prim, which turns and scales all of it."""
        frame = np.diag([self._metres] * 3 + [1.0])
        world = np.array(self._frames.GetLocalToWorldTransform(prim)).T
        frame = (Y_UP if self._is_z_up else np.eye(4)) @ frame @ world
        node = self._node(prim, frame, inside=_is_component(prim), room="")
        return self.file.add("nodes", node or {"name": prim.GetName()})

    def alone(self, prim: Usd.Prim) -> int:
        """Write the node of a component, or of a part of one, where its origin is."""
        node = self._node(prim, Y_UP, inside=True, room="")
        return self.file.add("nodes", node or {"name": prim.GetName()})

    def _node(self, prim: Usd.Prim, frame: FloatArray, *, inside: bool, room: str) -> Entry | None:
        """The entry of a prim, after the entries of its children; None where nothing is in it."""
        if prim.GetPath() in self._rooms:
            room = prim.GetName()
        meshes: list[Usd.Prim] = [prim] if prim.IsA(UsdGeom.Mesh) else []
        children = []
        for child in self._nearest(prim, inside=inside, meshes=meshes):
            local, _ = self._frames.ComputeRelativeTransform(child, prim)
            within = inside or _is_component(child)
            node = self._node(child, np.array(local).T, inside=within, room=room)
            if node:
                children.append(self.file.add("nodes", node))
        entry: Entry = {"name": prim.GetName(), **self._light_or_camera(prim)}
        if meshes:
            entry["mesh"] = self._mesh(prim, meshes)
        if children:
            entry["children"] = children
        if len(entry) == 1:
            return None
        if not np.array_equal(frame, np.eye(4)):
            entry["matrix"] = np.round(frame.T, _DIGITS).reshape(-1).tolist()
        extras = _extras(prim, room)
        return entry | ({"extras": extras} if extras else {})

    def _nearest(
        self, prim: Usd.Prim, *, inside: bool, meshes: list[Usd.Prim]
    ) -> Iterator[Usd.Prim]:
        """The prims below that become nodes; meshes that do not are added to meshes."""
        for child in prim.GetFilteredChildren(_PROXIES):
            shape = UsdGeom.Imageable(child)
            if not shape or child.IsA(UsdShade.Material):
                continue
            if shape.GetVisibilityAttr().Get() == UsdGeom.Tokens.invisible:
                continue
            if shape.GetPurposeAttr().Get() in _ASIDE:
                continue
            if not inside or _stands_out(child):
                yield child
            elif child.IsA(UsdGeom.Mesh):
                meshes.append(child)
            else:
                yield from self._nearest(child, inside=inside, meshes=meshes)

    def _light_or_camera(self, prim: Usd.Prim) -> Entry:
        """The light or the camera of a node."""
        if prim.IsA(UsdGeom.Camera):
            return {"camera": self.file.add("cameras", camera_of(prim, self._metres))}
        light = light_of(prim) if prim.HasAPI(UsdLux.LightAPI) else None
        if light is None:
            return {}
        intensity = round(light["intensity"] / self._lux_per_unit, 4)
        place = {"light": self.file.add_light(light | {"intensity": intensity})}
        return {"extensions": {"KHR_lights_punctual": place}}

    def _mesh(self, node: Usd.Prim, prims: list[Usd.Prim]) -> int:
        """Place of the mesh of a node; instances of one model have the same."""
        sources = [prim.GetPrimInPrototype() if prim.IsInstanceProxy() else prim for prim in prims]
        key = tuple(str(source.GetPath()) for source in sources)
        if key not in self._meshes:
            primitives = self._primitives(node, prims)
            entry = {"name": node.GetName(), "primitives": primitives}
            self._meshes[key] = self.file.add("meshes", entry)
        return self._meshes[key]

    def _primitives(self, node: Usd.Prim, prims: list[Usd.Prim]) -> list[Entry]:
        """One primitive for each material."""
        parts: dict[int | None, list[Vertices]] = {}
        for prim in prims:
            frame, _ = self._frames.ComputeRelativeTransform(prim, node)
            two_sided = bool(UsdGeom.Gprim(prim).GetDoubleSidedAttr().Get())
            look = self.looks.of(bound_material(prim), two_sided=two_sided)
            material, placement = look or (None, None)
            vertices = vertices_of(prim, np.array(frame).T, placement)
            if vertices is not None:
                parts.setdefault(material, []).append(vertices)
        return [self._primitive(material, vertices) for material, vertices in parts.items()]

    def _primitive(self, material: int | None, parts: list[Vertices]) -> Entry:
        whole = joined(parts)
        attributes = {
            "POSITION": self.file.add_vertices(whole.points, bounded=True),
            "NORMAL": self.file.add_vertices(whole.normals),
        }
        if whole.uvs is not None:
            downwards = np.column_stack([whole.uvs[:, 0], 1.0 - whole.uvs[:, 1]])
            attributes["TEXCOORD_0"] = self.file.add_vertices(downwards)
            if self._has_tangents and self.looks.has_relief(material):
                attributes["TANGENT"] = self.file.add_vertices(tangents_of(whole))
        entry = {"attributes": attributes, "indices": self.file.add_indices(whole.triangles)}
        return entry if material is None else entry | {"material": material}


def _is_component(prim: Usd.Prim) -> bool:
    return bool(Usd.ModelAPI(prim).GetKind() == "component")


def _stands_out(prim: Usd.Prim) -> bool:
    """Whether a prim of a component is more than a part of its looks."""
    labelled = any(name.startswith(_LABELS) for name in prim.GetAppliedSchemas())
    lit = prim.HasAPI(UsdLux.LightAPI) or prim.IsA(UsdGeom.Camera)
    return labelled or lit or prim.HasAPI(UsdPhysics.RigidBodyAPI)


def _extras(prim: Usd.Prim, room: str) -> Entry:
    """What a prim is: its labels (`category`, `class`; a room's is its `kind`), its room and id,
    of rooms their names and requests, and of dressing the id of what it rests on."""
    names = [name.removeprefix(_LABELS) for name in prim.GetAppliedSchemas() if _LABELS in name]
    labels = {name: prim.GetAttribute(f"semantics:labels:{name}").Get() for name in names}
    said: Entry = {name: str(values[0]) for name, values in labels.items() if values}
    if not said:
        return {}
    if "room" in said:
        asked = prim.GetAttributeAtPath(f"Furniture.{REQUESTS}")
        said |= {"kind": said.pop("room"), "title": prim.GetDisplayName()}
        said |= {"requests": asked.Get()} if asked else {}
    if "category" in said:
        said.setdefault("class", said["category"])
    if room:
        said["room"] = room
    noted = prim.GetAttribute("chord:node_id").Get()
    rests_on = prim.GetAttribute("chord:rests_on").Get()
    said |= ({"id": noted} if noted else {}) | ({"rests_on": rests_on} if rests_on else {})
    return said | {"path": str(prim.GetPath())}
