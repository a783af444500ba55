"""Colliders of a stage as geoms of MJCF: boxes stay boxes, hulls are convex meshes."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import numpy as np
import trimesh
from pxr import Usd, UsdGeom, UsdPhysics, UsdShade
from scipy.spatial import ConvexHull, QhullError
from scipy.spatial.transform import Rotation

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.export.exchange.mjcf_frames import numbers, placed, rigid, scale_of
from chord_usd.line.stage.shell.mesh import fans

_ROUND = 24
"""Corners of the rim of a cone."""

_SHEET_M = 0.004
"""Thickness of the colliders of surfaces; things fall through thinner colliders."""

_THIN_M = 1e-3
"""What is flat gets this thickness, for a hull must have a volume."""

_CONVEX = 0.97
"""Share of its hull that a part must fill to collide as the hull."""


@dataclass(frozen=True, eq=False)
class Shape:
    """One geom; its mesh, if it has one, as (N, 3) corners."""

    attributes: dict[str, str]
    volume_m3: float
    hull: FloatArray | None = None


@dataclass(frozen=True, eq=False)
class Surface:
    """A collider of triangles, in the frame of its body."""

    points: FloatArray
    """(N, 3)"""
    triangles: np.ndarray
    """(T, 3)"""

    def element(self, name: str, friction: str) -> ET.Element:
        """Of a body that stands still: MuJoCo makes hulls of all meshes, and a tub is none."""
        attributes = {
            "name": name, "type": "direct", "dim": "2", "rigid": "true", "mass": "1",
            "radius": numbers([_SHEET_M]), "group": "3", "point": numbers(self.points.ravel()),
            "element": " ".join(map(str, self.triangles.ravel().tolist())),
        }  # fmt: skip
        element = ET.Element("flexcomp", attributes)
        ET.SubElement(element, "contact", selfcollide="none", friction=friction)
        return element


def shapes_of(prim: Usd.Prim, frame: FloatArray, *, moves: bool) -> Iterator[Shape | Surface]:
    """A gprim as geoms of its body. frame: (4, 4) of the prim in that of the body, with scale."""
    if prim.IsA(UsdGeom.Mesh):
        yield from _mesh_shapes(prim, frame, moves=moves)
        return
    shape = solid_of(prim, frame)
    if shape is not None:
        yield shape


def solid_of(prim: Usd.Prim, frame: FloatArray) -> Shape | None:
    """A gprim that is no mesh; None for what has no solid, such as curves."""
    scale = scale_of(frame)
    pose = rigid(frame)
    if prim.IsA(UsdGeom.Plane):
        plane = UsdGeom.Plane(prim)
        return Shape({"type": "plane", "size": "0 0 1", **placed(pose @ _to_z(plane))}, 0.0)
    if prim.IsA(UsdGeom.Cube):
        half = UsdGeom.Cube(prim).GetSizeAttr().Get() / 2
        return _box(frame, np.zeros(3), np.full(3, half))
    if prim.IsA(UsdGeom.Sphere):
        radii = UsdGeom.Sphere(prim).GetRadiusAttr().Get() * np.abs(
            np.linalg.norm(frame[:3, :3], axis=0) if scale is None else scale
        )
        return _ball(pose, radii)
    for schema, kind in (
        (UsdGeom.Capsule, "capsule"), (UsdGeom.Cylinder, "cylinder"), (UsdGeom.Cone, "cone"),
    ):  # fmt: skip
        if prim.IsA(schema):
            return _round(schema(prim), kind, frame)
    return None


def _ball(pose: FloatArray, radii: FloatArray) -> Shape:
    volume = float(4 / 3 * math.pi * np.prod(radii))
    if np.ptp(radii) < 1e-6 * radii.max():
        return Shape({"type": "sphere", "size": numbers(radii[:1]), **placed(pose)}, volume)
    return Shape({"type": "ellipsoid", "size": numbers(radii), **placed(pose)}, volume)


def _box(frame: FloatArray, middle: FloatArray, half: FloatArray) -> Shape:
    scale = scale_of(frame)
    if scale is None:
        signs = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, -1).T
        return _hull((middle + signs * half) @ frame[:3, :3].T + frame[:3, 3])
    pose = rigid(frame)
    pose[:3, 3] = (frame @ [*middle, 1.0])[:3]
    size = np.maximum(np.abs(scale) * half, _THIN_M / 2)
    attributes = {"type": "box", "size": numbers(size), **placed(pose)}
    return Shape(attributes, float(8.0 * np.prod(size)))


def _to_z(prim: UsdGeom.Gprim) -> FloatArray:
    """(4, 4) that turns z to the axis of a prim."""
    turn = np.eye(4)
    way = {"X": (0.0, 90.0, 0.0), "Y": (-90.0, 0.0, 0.0), "Z": (0.0, 0.0, 0.0)}
    angles_deg = way[prim.GetAxisAttr().Get()]
    turn[:3, :3] = Rotation.from_euler("xyz", angles_deg, degrees=True).as_matrix()
    return turn


def _round(prim: UsdGeom.Gprim, kind: str, frame: FloatArray) -> Shape:
    """A capsule, a cylinder or a cone, which MJCF has lying along z; squeezed ones are hulls."""
    frame = frame @ _to_z(prim)
    radius, half = prim.GetRadiusAttr().Get(), prim.GetHeightAttr().Get() / 2
    scale = scale_of(frame)
    angles = np.linspace(0.0, 2 * math.pi, _ROUND, endpoint=False)
    rim = radius * np.column_stack([np.cos(angles), np.sin(angles)])
    if kind == "cone" or scale is None or abs(abs(scale[0]) - abs(scale[1])) > 1e-6 * abs(scale[0]):
        low = np.column_stack([rim, np.full(_ROUND, -half)])
        tip = np.array([[0.0, 0.0, half + (radius if kind == "capsule" else 0.0)]])
        points = np.vstack([low, tip] if kind == "cone" else [low, low * [1, 1, -1], tip, -tip])
        return _hull(points @ frame[:3, :3].T + frame[:3, 3])
    across, long = radius * abs(scale[0]), half * abs(scale[2])
    ends = 4 / 3 * math.pi * across**3 if kind == "capsule" else 0.0
    attributes = {"type": kind, "size": numbers([across, long]), **placed(rigid(frame))}
    return Shape(attributes, float(math.pi * across**2 * 2 * long + ends))


def _hull(points: FloatArray) -> Shape:
    """The convex shape around points; what is flat is made thick enough to have one."""
    try:
        around = ConvexHull(points)
    except QhullError:
        middle = points.mean(axis=0)
        spread, ways = np.linalg.svd(points - middle, full_matrices=False)[1:]
        flat = ways[spread < 1e-6 * max(spread.max(), 1e-9)]
        for way in flat if len(flat) else ways[-1:]:
            points = np.vstack([points - way * _THIN_M / 2, points + way * _THIN_M / 2])
        around = ConvexHull(points, qhull_options="QJ")
    return Shape({"type": "mesh"}, float(around.volume), points[around.vertices])


def _mesh_shapes(prim: Usd.Prim, frame: FloatArray, *, moves: bool) -> Iterator[Shape | Surface]:
    mesh = UsdGeom.Mesh(prim)
    local = np.array(mesh.GetPointsAttr().Get() or np.zeros((0, 3)), dtype=np.float64)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get() or (), dtype=np.int64)
    if not len(local) or not len(corners):
        return
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(), dtype=np.int64)
    points = local @ frame[:3, :3].T + frame[:3, 3]
    how = "none"
    if prim.HasAPI(UsdPhysics.MeshCollisionAPI):
        how = UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get()
    if how == "boundingCube":
        low, high = local.min(axis=0), local.max(axis=0)
        yield _box(frame, (low + high) / 2, (high - low) / 2)
    elif how == "boundingSphere":
        pose = np.eye(4)
        pose[:3, 3] = (points.min(axis=0) + points.max(axis=0)) / 2
        radius = np.linalg.norm(points - pose[:3, 3], axis=1).max()
        yield _ball(pose, np.full(3, radius))
    elif how == "convexHull" or (moves and how != "convexDecomposition"):
        yield _hull(points[np.unique(corners)])
    else:
        yield from _parts(points, corners[fans(counts)], moves=moves)


def _parts(points: FloatArray, triangles: np.ndarray, *, moves: bool) -> Iterator[Shape | Surface]:
    """Each part of a mesh as its hull where it is as good as that, what is hollow as triangles."""
    whole = trimesh.Trimesh(points, triangles, process=False)
    whole.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=6)
    whole.update_faces(whole.nondegenerate_faces())
    hollow = []
    for part in whole.split(only_watertight=False, repair=False):
        shape = _hull(part.vertices)
        solid = part.is_watertight and part.volume >= _CONVEX * shape.volume_m3
        if moves or solid:
            yield shape
        else:
            hollow.append(part)
    if hollow:
        starts = np.cumsum([0, *(len(part.vertices) for part in hollow[:-1])])
        faces = [part.faces + start for part, start in zip(hollow, starts, strict=True)]
        yield Surface(np.vstack([part.vertices for part in hollow]), np.vstack(faces))


def friction_of(prim: Usd.Prim) -> str | None:
    """Friction of a collider; None where its stage says nothing.

    MuJoCo has one number: the friction of sliding. Turning and rolling keep what it has.
    """
    material = _physics_material(prim)
    if material is None:
        return None
    return numbers([max(material.GetDynamicFrictionAttr().Get(), 1e-4), 0.005, 0.0001])


def density_of(prim: Usd.Prim) -> float:
    """Of a collider's material, as the stage counts; 0 where it says nothing."""
    material = _physics_material(prim)
    return float(material.GetDensityAttr().Get()) if material else 0.0


def _physics_material(prim: Usd.Prim) -> UsdPhysics.MaterialAPI | None:
    bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")[0]
    has_physics = bound and bound.GetPrim().HasAPI(UsdPhysics.MaterialAPI)
    return UsdPhysics.MaterialAPI(bound.GetPrim()) if has_physics else None
