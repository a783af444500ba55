"""Prims of a component: meshes, materials by slot, colliders with physics materials."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.scene.geometry import shared_rows
from chord_usd.library.kit.model import Design, Part
from chord_usd.library.kit.shading import corner_normals, corner_uvs_m
from chord_usd.library.kit.solids import Solid
from chord_usd.library.surfaces.physical import feel_of, write_feel

if TYPE_CHECKING:
    from pxr import Sdf, Usd

_LEAST_FACE_M2 = 2e-12
"""What is smaller is a line; validators refuse it."""


def new_stage(design: Design) -> Usd.Stage:
    """A stage in memory with the root prim as its default prim."""
    from pxr import Usd, UsdGeom

    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, f"/{design.id}")
    stage.SetDefaultPrim(root.GetPrim())
    return stage


def write_labels(prim: Usd.Prim, labels: Mapping[str, str]) -> None:
    """Semantic labels of a prim, by their taxonomies."""
    from pxr import UsdSemantics

    for taxonomy, name in labels.items():
        UsdSemantics.LabelsAPI.Apply(prim, taxonomy).CreateLabelsAttr([name])


def detached(stage: Usd.Stage) -> Sdf.Layer:
    """The stage's layer without the stage, which would look at once for what it points to."""
    from pxr import Sdf

    layer = Sdf.Layer.CreateAnonymous(".usda")
    layer.TransferContent(stage.GetRootLayer())
    return layer


def define_mesh(stage: Usd.Stage, path: str, part: Part) -> None:
    """The mesh of a part, with normals and texture coordinates of each corner."""
    from pxr import Sdf, UsdGeom, Vt

    part = _without_slivers(part)
    mesh = UsdGeom.Mesh.Define(stage, path)
    points = Vt.Vec3fArray.FromNumpy(part.solid.points_m.astype(np.float32))
    corners = part.solid.faces.reshape(-1).astype(np.int32)
    mesh.CreatePointsAttr(points)
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray([3] * (len(corners) // 3)))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(corners))
    mesh.CreateExtentAttr(UsdGeom.PointBased.ComputeExtent(points))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    if part.two_sided:
        mesh.CreateDoubleSidedAttr(True)
    normals = corner_normals(part.solid).astype(np.float32)
    mesh.CreateNormalsAttr(Vt.Vec3fArray.FromNumpy(normals))
    mesh.SetNormalsInterpolation(UsdGeom.Tokens.faceVarying)
    flat = corner_uvs_m(part.solid, part.name) if part.uvs is None else part.uvs
    uvs, places = shared_rows(flat)
    primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(
        "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying
    )
    primvar.Set(Vt.Vec2fArray.FromNumpy(uvs))
    primvar.SetIndices(Vt.IntArray.FromNumpy(places))


def _without_slivers(part: Part) -> Part:
    """The part without faces that have no area once their corners are in single precision."""
    solid = part.solid
    a, b, c = np.moveaxis(solid.points_m.astype(np.float32)[solid.faces].astype(np.float64), 1, 0)
    is_face = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2 >= _LEAST_FACE_M2
    if is_face.all():
        return part
    uvs = None if part.uvs is None else part.uvs.reshape(-1, 3, 2)[is_face].reshape(-1, 2)
    return replace(part, solid=Solid(solid.points_m, solid.faces[is_face]), uvs=uvs)


def mesh_name(design: Design, part: str, link: str = "") -> str:
    """Prim name of a part's mesh, which no other mesh of a house has: Blender numbers those that
    are alike. link: name of the body that it moves with, where the piece is jointed."""
    return "_".join(filter(None, (part, design.id, link)))


def material_path(root: str, slot: str) -> str:
    """Prim path of a slot's material: `book_red` becomes `BookRed`."""
    return f"/{root}/Materials/{''.join(word.capitalize() for word in slot.split('_'))}"


def bind_feel(design: Design, slot: str, colliders: Iterable[Usd.Prim]) -> None:
    """Binds colliders to the physics material of their part's finish in the first colourway."""
    from pxr import UsdShade

    looks = next(iter(design.colourways.values()))
    for collider in colliders:
        stage = collider.GetStage()
        path = material_path(design.id, slot)
        write_feel(stage.OverridePrim(path), feel_of(design.finishes[looks[slot]]))
        relation = UsdShade.MaterialBindingAPI.Apply(collider).GetDirectBindingRel("physics")
        relation.SetTargets([path])


def define_colliders(stage: Usd.Stage, path: str) -> None:
    """The scope of colliders, which are not seen; readers that leave guides out leave it out,
    too."""
    from pxr import UsdGeom

    UsdGeom.Scope.Define(stage, path).CreatePurposeAttr(UsdGeom.Tokens.guide)


def define_box(stage: Usd.Stage, path: str, bounds_m: np.ndarray) -> Usd.Prim:
    """A collider that is a box between two corners, (2, 3)."""
    from pxr import Gf, UsdGeom, UsdPhysics

    low, high = bounds_m
    cube = UsdGeom.Cube.Define(stage, path)
    cube.CreateSizeAttr(1.0)
    cube.CreateExtentAttr([Gf.Vec3f(-0.5), Gf.Vec3f(0.5)])
    cube.CreatePurposeAttr(UsdGeom.Tokens.guide)
    cube.AddTranslateOp().Set(Gf.Vec3d(*((low + high) / 2).tolist()))
    cube.AddScaleOp().Set(Gf.Vec3f(*(high - low).tolist()))
    UsdPhysics.CollisionAPI.Apply(cube.GetPrim())
    return cube.GetPrim()
