"""A component of the shell while it is written: meshes and materials in a payload layer."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pxr import Sdf

from chord_usd.base.scene.feels import FEEL_OF_SURFACE
from chord_usd.base.scene.types import Box, FloatArray
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.stage.author.physics import (
    DOOR_KG_PER_M2,
    DOOR_OPENS_DEG,
    SASH_KG_PER_M2,
    define_colliders,
    hang_leaf,
    write_collider,
    write_feel,
    write_hull,
)
from chord_usd.line.stage.author.prims import (
    bind,
    define,
    define_class,
    hint_extent,
    identify,
    inherit,
    label,
    new_layer,
    write_mesh,
)
from chord_usd.line.stage.author.surfaces import FLOOR, Fitout, write_surface
from chord_usd.line.stage.shell.mesh import Face, mesh_of
from chord_usd.line.stage.shell.opening_parts import PointM, leaf_box
from chord_usd.line.stage.shell.opening_shapes import Leaf
from chord_usd.line.stage.shell.window_parts import Sash


class ShellComponent:
    """A payload layer being written: meshes under Geometry, materials under Materials.

    No others of the house have their names, which end in that of the group or room that they are
    part of: Blender numbers those that are alike.
    """

    def __init__(self, path: Path, name: str, fitout: Fitout, owner: str = "") -> None:
        """owner: name of the room or storey whose component this is, where there are others."""
        self.fitout = fitout
        self._owner = owner
        self.file = f"./{path.parent.name}/{path.name}"
        """The layer's path as the house writes it."""
        self.extents_m: list[FloatArray] = []
        """(2, 3) world bounds of each mesh."""
        self._layer = new_layer(path, name)
        self._root = Sdf.Path.absoluteRootPath.AppendChild(name)
        define(self._layer, self._root, "Xform", kind="component")
        define(self._layer, self._root.AppendChild("Geometry"), "Scope")
        define(self._layer, self._root.AppendChild("Materials"), "Scope")

    def group(self, name: str) -> Sdf.PrimSpec:
        """An Xform under Geometry."""
        return define(self._layer, self._root.AppendPath(f"Geometry/{name}"), "Xform")

    def mesh(
        self,
        name: str,
        faces: Sequence[Face],
        material: str,
        frame: Frame | None = None,
        *,
        category: str = "",
    ) -> None:
        """A mesh under Geometry, bound to a material of this component; none without faces.

        frame: where the groups above it stand, if it is not drawn in the world.
        """
        mesh = mesh_of(faces)
        if mesh.is_empty:
            return
        *groups, part = name.split("/")
        prim_name = "_".join(filter(None, (part, groups[-1] if groups else self._owner)))
        path = self._root.AppendPath("/".join(("Geometry", *groups, prim_name)))
        prim = write_mesh(self._layer, path, mesh)
        bind(prim, self._material(material))
        points = frame.in_world(mesh.points_m) if frame else mesh.points_m
        self.extents_m.append(np.array([points.min(axis=0), points.max(axis=0)]))
        if category:
            label(prim, "category", category)

    def block(
        self, boxes: Sequence[tuple[Box, str]], hulls: Sequence[tuple[Sequence[Face], str]] = ()
    ) -> None:
        """Colliders of parts that are drawn as sheets, each with its physics material; hulls for
        parts that are no box."""
        scope = define_colliders(self._layer, self._root.AppendChild("Colliders"))
        for index, (box, material) in enumerate(boxes):
            path = scope.path.AppendChild(f"Box_{index}")
            write_collider(self._layer, path, box, self._material(material))
        for index, (faces, material) in enumerate(hulls):
            path = scope.path.AppendChild(f"Hull_{index}")
            if not (mesh := mesh_of(faces)).is_empty:
                write_hull(self._layer, path, mesh, self._material(material))

    def guard(self, parent: Sdf.PrimSpec, boxes: Sequence[Box], material: str) -> None:
        """The colliders of a part that is drawn in bars."""
        for index, box in enumerate(boxes):
            path = parent.path.AppendChild(f"Collider_{index}" if index else "Collider")
            write_collider(self._layer, path, box, self._material(material))

    def hang(
        self, leaf: Sdf.PrimSpec, hinge_m: PointM, drawn: Leaf | Sash, side: int, material: str
    ) -> None:
        """Let a leaf swing towards +y of its opening where side is 1, towards -y where it is -1."""
        turn_deg = DOOR_OPENS_DEG * (-side if drawn.hung_right else side)
        limits_deg = (min(turn_deg, 0.0), max(turn_deg, 0.0))
        path = self._material(material)
        if isinstance(drawn, Sash):
            box, kg_per_m2 = drawn.box, SASH_KG_PER_M2
        else:
            box, kg_per_m2 = leaf_box(drawn), DOOR_KG_PER_M2
        hang_leaf(self._layer, leaf, hinge_m, box, limits_deg, path, kg_per_m2)

    def _material(self, name: str) -> Sdf.Path:
        is_room = name not in self.fitout.surfaces
        slot = name if is_room or not self._owner else f"{name}_{self._owner}"
        path = self._root.AppendPath(f"Materials/{slot}")
        if not self._layer.GetPrimAtPath(path):
            if not is_room:
                write_surface(self._layer, path, name, self.fitout.surfaces[name])
            else:  # the room's variant sets say what it looks like
                plain = "PlainFloor" if name.endswith(FLOOR) else "PlainWall"
                write_feel(define(self._layer, path, "Material"), FEEL_OF_SURFACE[plain])
        return path

    def reserve(self, material: str) -> None:
        """A material that the room's variants write, though no mesh here is bound to it."""
        self._material(material)

    def save(self) -> None:
        """Write the layer's file."""
        self._layer.Save()


@dataclass(frozen=True, eq=False)
class Frame:
    """Where an opening, or a leaf in it, stands in the world."""

    yaw_deg: float
    origin_m: tuple[float, float, float]

    def in_world(self, points_m: FloatArray) -> FloatArray:
        """(N, 3) points of this frame in the world."""
        turned = points_m.copy()
        turned[:, :2] = points_m[:, :2] @ rotation_2d(self.yaw_deg).T
        return turned + np.array(self.origin_m)

    def inner(self, origin_m: tuple[float, float, float]) -> Frame:
        """A frame of the same yaw with its origin at this point of the frame."""
        x, y, z = self.in_world(np.array([origin_m]))[0]
        return Frame(self.yaw_deg, (float(x), float(y), float(z)))


def refer(layer: Sdf.Layer, path: str, component: ShellComponent) -> FloatArray:
    """The component's interface in the house: kind, bounds, payload. Returns the bounds."""
    prim = define(layer, path, "Xform", kind="component")
    identify(prim, prim.name, component.file)
    inherit(prim, define_class(layer, prim.name))
    prim.payloadList.prependedItems.append(Sdf.Payload(component.file))
    extents = np.array(component.extents_m)
    extent = np.array([extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)])
    hint_extent(prim, extent)
    return extent
