"""A stage as one flat .usdz for web viewers, and for Apple's AR Quick Look.

Web viewers (three.js, tinyusdz) load no payloads, know no instances, and each has its own idea of
faces with four corners and of UsdTransform2d. So the stage is written out plainly: triangles,
pictures that lie where the coordinates say, and nothing that is not seen. Quick Look wants Y up,
lights a scene itself, and takes for bodies what has their schemas.

Crate files hold vectors of small whole numbers in a short form, which three.js misreads: a scale of
(1, 1, 1) becomes 65793. So such vectors are written a float's smallest step away from whole.
"""

from __future__ import annotations

import itertools
import os
import tempfile
from pathlib import Path

import numpy as np
from pxr import Ar, Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdUtils, Vt

from chord_usd.line.stage.author.author_stage import ARCHIVE_TIME_S
from chord_usd.line.stage.author.surfaces import (
    bound_material,
    place_of,
    placed,
    placement_of,
    source_of,
    st_of,
)
from chord_usd.line.stage.shell.mesh import fans

_UNSEEN = ("PhysicsScene", "PhysicsRevoluteJoint", "DomeLight", "RenderSettings", "RenderProduct")


_PICTURES = "textures"

_SINGLE = (Gf.Vec2f, Gf.Vec3f, Gf.Vec4f)
_DOUBLE = (Gf.Vec2d, Gf.Vec3d, Gf.Vec4d)


def write_web(stage: Usd.Stage, target: Path) -> None:
    """Write what is seen of the stage to target, a .usdz. The stage's session layer is changed."""
    _write(stage, target, for_ar=False)


def write_ar(stage: Usd.Stage, target: Path) -> None:
    """As write_web, by the ARKit profile."""
    _write(stage, target, for_ar=True)


def _write(stage: Usd.Stage, target: Path, *, for_ar: bool) -> None:
    stage.SetEditTarget(stage.GetSessionLayer())
    for prim in list(stage.Traverse()):
        if prim.IsInstanceable():
            prim.SetInstanceable(False)
    for prim in list(stage.Traverse()):
        if prim.IsValid() and (_is_unseen(prim) or (for_ar and prim.HasAPI(UsdLux.LightAPI))):
            prim.SetActive(False)
    with tempfile.TemporaryDirectory(dir=target.parent) as folder:
        layer = stage.Flatten(addSourceFileComment=False)
        _drop_inactive(layer)
        _plain_meshes(Usd.Stage.Open(layer))
        _bring_pictures(layer, Path(folder))
        if for_ar:
            _drop_physics(layer)
            _stand_up(layer)
        _drop_whole_vectors(layer)
        flat = Path(folder) / f"{target.stem}.usdc"
        layer.Export(str(flat))
        for file in Path(folder).rglob("*"):  # the archive notes their times
            os.utime(file, (ARCHIVE_TIME_S, ARCHIVE_TIME_S))
        UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(flat)), str(target))


def _bring_pictures(layer: Sdf.Layer, folder: Path) -> None:
    """Copy the pictures beside the layer, no two of one name, each of them once.

    USD would number folders for them, and Blender unpacks all pictures into one.
    """
    names: dict[bytes, str] = {}

    def beside(path: str) -> str:
        asset = Ar.GetResolver().OpenAsset(Ar.ResolvedPath(path))
        if not asset:
            return path
        data = bytes(asset.GetBuffer())
        if data not in names:
            name = Path(path.replace("[", "/").rstrip("]"))
            taken = (f"{name.stem}_{number}{name.suffix}" for number in itertools.count(2))
            free = itertools.chain([name.name], taken)
            names[data] = next(candidate for candidate in free if candidate not in names.values())
            place = folder / _PICTURES / names[data]
            place.parent.mkdir(exist_ok=True)
            place.write_bytes(data)
        return f"./{_PICTURES}/{names[data]}"

    UsdUtils.ModifyAssetPaths(layer, beside)


def _stand_up(layer: Sdf.Layer) -> None:
    """Y up: the root is turned, what is in it stays as it is. One matrix says so, since three.js
    passes over operations that have a suffix."""
    layer.pseudoRoot.SetInfo("upAxis", "Y")
    stage = Usd.Stage.Open(layer)
    root = UsdGeom.Xformable(stage.GetDefaultPrim())
    upright = Gf.Matrix4d(Gf.Rotation(Gf.Vec3d.XAxis(), -90.0), Gf.Vec3d(0.0))
    frame = root.GetLocalTransformation() * upright
    root.MakeMatrixXform().Set(frame)


def _drop_whole_vectors(layer: Sdf.Layer) -> None:
    """Remove scales that change nothing, and give vectors of small whole numbers the long form."""
    scales = []

    def visit(path: Sdf.Path) -> None:
        spec = layer.GetAttributeAtPath(path) if path.IsPropertyPath() else None
        if spec is None or not _is_whole(spec.default):
            return
        if spec.name.startswith("xformOp:scale") and set(spec.default) == {1.0}:
            scales.append(spec)
            return
        kind = np.float32 if isinstance(spec.default, _SINGLE) else np.float64
        first = np.nextafter(kind(spec.default[0]), kind(2 * abs(spec.default[0]) + 1))
        spec.default = type(spec.default)(*[float(first), *list(spec.default)[1:]])

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    for scale in scales:
        order = scale.owner.attributes.get("xformOpOrder")
        if order is not None:
            order.default = Vt.TokenArray([op for op in order.default if op != scale.name])
        scale.owner.RemoveProperty(scale)


def _is_whole(value: object) -> bool:
    """Whether a value is a vector of whole numbers, which may be held as bytes."""
    if not isinstance(value, (*_SINGLE, *_DOUBLE)):
        return False
    return all(float(number).is_integer() for number in value)


def _drop_physics(layer: Sdf.Layer) -> None:
    """Take bodies, masses and colliders out; Quick Look would let things fall."""
    stage = Usd.Stage.Open(layer)
    for prim in stage.TraverseAll():
        for name in prim.GetAppliedSchemas():
            if name.startswith("Physics"):
                prim.RemoveAppliedSchema(name)
        for name in prim.GetPropertyNames():
            if name.startswith("physics:"):
                prim.RemoveProperty(name)


def _plain_meshes(stage: Usd.Stage) -> None:
    """Triangles only; and what UsdTransform2d does becomes part of the coordinates."""
    places = set()
    for prim in stage.Traverse():
        if not prim.IsA(UsdGeom.Mesh):
            continue
        _cut_faces(UsdGeom.Mesh(prim))
        material, st = bound_material(prim), st_of(prim)
        shader = material.ComputeSurfaceSource()[0] if material and st else None
        texture = source_of(shader, "diffuseColor") if shader else None
        place = place_of(texture) if texture else None
        if st and texture and place:
            laid = placed(np.array(st.Get(), dtype=np.float64), placement_of(texture))
            st.Set(Vt.Vec2fArray.FromNumpy(laid.astype(np.float32)))
            places.add(place.GetPath())
    for path in places:
        _take_out(stage, path)


def _cut_faces(mesh: UsdGeom.Mesh) -> None:
    """Cut faces into triangles, with all that is given for faces and for their corners."""
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get(), dtype=np.int64)
    if (counts == 3).all():
        return
    corners = fans(counts).reshape(-1)
    faces = np.repeat(np.arange(len(counts)), counts - 2)
    chosen = {UsdGeom.Tokens.faceVarying: corners, UsdGeom.Tokens.uniform: faces}
    primvars = UsdGeom.PrimvarsAPI(mesh).GetPrimvarsWithAuthoredValues()
    for attribute, interpolation in (
        (mesh.GetNormalsAttr(), mesh.GetNormalsInterpolation()),
        *(
            (
                primvar.GetIndicesAttr() if primvar.IsIndexed() else primvar.GetAttr(),
                primvar.GetInterpolation(),
            )
            for primvar in primvars
        ),
    ):
        values = attribute.Get()
        if values is not None and interpolation in chosen:
            rows = np.array(values)[chosen[interpolation]]
            attribute.Set(type(values).FromNumpy(np.ascontiguousarray(rows)))
    indices = np.array(mesh.GetFaceVertexIndicesAttr().Get(), dtype=np.int32)[corners]
    mesh.GetFaceVertexIndicesAttr().Set(Vt.IntArray.FromNumpy(indices))
    mesh.GetFaceVertexCountsAttr().Set(Vt.IntArray([3] * len(faces)))


def _take_out(stage: Usd.Stage, path: Sdf.Path) -> None:
    """Remove a UsdTransform2d; what came after it comes after what was before it."""
    place = UsdShade.Shader.Get(stage, path)
    before = place.GetInput("in").GetAttr().GetConnections()
    for shader in place.GetPrim().GetParent().GetChildren():
        st = UsdShade.Shader(shader).GetInput("st")
        if st and any(source.GetPrimPath() == path for source in st.GetAttr().GetConnections()):
            st.GetAttr().SetConnections(before)
    stage.RemovePrim(path)


def _is_unseen(prim: Usd.Prim) -> bool:
    """Colliders, hinges, skies, ground and render settings, and the scopes of colliders."""
    purpose = UsdGeom.Imageable(prim).GetPurposeAttr().Get()
    aside = purpose in (UsdGeom.Tokens.guide, UsdGeom.Tokens.render)
    return prim.GetTypeName() in _UNSEEN or prim.GetName() == "Colliders" or aside


def _drop_inactive(layer: Sdf.Layer) -> None:
    """Remove what is switched off, and the classes that nothing inherits any more."""
    paths: list[Sdf.Path] = []

    def note(path: Sdf.Path) -> None:
        prim = layer.GetPrimAtPath(path) if path.IsPrimPath() else None
        if prim and (not prim.active or path == "/__class__"):
            paths.append(path)

    layer.Traverse(Sdf.Path.absoluteRootPath, note)
    edit = Sdf.BatchNamespaceEdit()
    for path in paths:
        if not any(path != other and path.HasPrefix(other) for other in paths):
            edit.Add(path, Sdf.Path.emptyPath)
    layer.Apply(edit)
