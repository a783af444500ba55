"""Rules a stage keeps, numbered. What UsdValidation covers is left to it; it misses these.

    CHORD001  Z is up, one unit is one metre, the default prim is an assembly
    CHORD002  no component inside a component
    CHORD003  no rigid body inside a rigid body
    CHORD004  every prim above geometry, lights and cameras has a type
    CHORD005  asset paths are relative and stay beside the stage
    CHORD006  meshes have an extent, and it bounds their points
    CHORD007  faces refer to points that exist and have an area
    CHORD008  everything the stage points to is there
    CHORD009  groups hold groups and components: model kinds reach from the root without a gap
    CHORD010  normals and primvars have as many values as their interpolation asks for
    CHORD011  no coordinate is infinite or not a number
    CHORD012  what has a payload has an extentsHint, so that it has bounds before it is loaded
    CHORD013  every mesh is bound to a material
    CHORD014  node ids are unique
    CHORD015  the house has a room with a floor (looked for by check.py)
    CHORD016  what moves collides as boxes and hulls, not as its triangles
    CHORD017  a mesh has the texture coordinates that the pictures of its material are laid by

Each has a broken stage in tests/fixtures/broken that trips it. Paths inside an instance are given
through the first instance that shows them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pxr import Kind, Sdf, Usd, UsdGeom, UsdPhysics, UsdShade, UsdUtils, UsdValidation

from chord_usd.base.runtime.stages import named_in
from chord_usd.line.stage.author.surfaces import bound_material, coordinates_read
from chord_usd.line.stage.check.triangles import cross

NODE_ID = "chord:node_id"
"""Attribute of an item's prim: id of its node in the scene graph."""

EXTENT_TOLERANCE_M = 1e-3
MIN_FACE_AREA_M2 = 1e-12

StageRule = Callable[[Usd.Stage], Iterator[tuple[str, str]]]
"""Paths and messages."""

_PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)

_ABSOLUTE = re.compile(r"^([/\\~]|[A-Za-z]:|[A-Za-z][A-Za-z0-9+.-]+:)")
"""A root, a home folder, a drive letter or a scheme."""


@dataclass(frozen=True)
class Finding:
    """A rule that a prim, or a file, breaks."""

    rule: str
    path: str
    message: str


def broken_rules(stage: Usd.Stage) -> list[Finding]:
    """What UsdValidation and the rules above find, in order of rule and path.

    stage: opened with all payloads loaded.
    """
    return in_order([*broken_by_prims(stage), *broken_by_files(stage, validators_of(stage))])


def in_order(findings: Iterable[Finding]) -> list[Finding]:
    """Each finding once, by rule and path."""
    return sorted({*findings}, key=lambda f: (f.rule, f.path, f.message))


def broken_by_files(
    stage: Usd.Stage, validators: Sequence[UsdValidation.Validator]
) -> list[Finding]:
    """What USD's validators find, and rules about files: calls of USD that let other threads run
    meanwhile."""
    return [*_usd_findings(stage, validators), *_stage_findings(stage, _FILE_RULES)]


def broken_by_prims(stage: Usd.Stage) -> list[Finding]:
    """What the other rules find."""
    return [*_stage_findings(stage, _STAGE_RULES), *_prim_findings(_prims_once(stage))]


def _stage_findings(stage: Usd.Stage, rules: Mapping[str, StageRule]) -> Iterator[Finding]:
    for rule, look in rules.items():
        for path, message in look(stage):
            yield Finding(rule, path, message)


def _prim_findings(prims: Iterable[Usd.Prim]) -> list[Finding]:
    findings = []
    for prim in prims:
        judged = [(rule, judge(prim)) for rule, judge in _PRIM_RULES.items()]
        shape = _shape(prim)
        if shape is not None:
            judged += [(rule, look(prim, shape)) for rule, look in _MESH_RULES.items()]
        findings += [
            Finding(rule, _shown(prim), message)
            for rule, messages in judged
            for message in messages
        ]
    return findings


def validators_of(stage: Usd.Stage) -> list[UsdValidation.Validator]:
    """USD's own validators, loaded. To be called where no other thread runs: both the loader of
    libraries and the interpreter's lock are taken meanwhile, and imports take them the other way
    round."""
    # Each of these walks through all files again: CHORD008 has looked for what is missing, and
    # what is no package breaks no rule of packages.
    needless = {"usdUtilsValidators:MissingReferenceValidator"}
    if not stage.GetRootLayer().GetFileFormat().IsPackage():
        needless.add("usdUtilsValidators:UsdzPackageValidator")
    every = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    return [validator for validator in every if validator.GetMetadata().name not in needless]


def _usd_findings(
    stage: Usd.Stage, validators: Sequence[UsdValidation.Validator]
) -> Iterator[Finding]:
    """Errors of USD's own validators in a stage; their warnings are advice."""
    for error in UsdValidation.ValidationContext(validators).Validate(stage):
        if error.GetType() != UsdValidation.ValidationErrorType.Error:
            continue
        sites = [site.GetPrim() or site.GetProperty() for site in error.GetSites()]
        path = next((str(site.GetPath()) for site in sites if site), "/")
        yield Finding(str(error.GetName()), path, error.GetMessage().strip())


# --- prims --------------------------------------------------------------------------------------


def _prims_once(stage: Usd.Stage) -> Iterator[Usd.Prim]:
    """Every defined prim: first in the stage, then in each prototype."""
    yield from stage.Traverse()
    for prototype in stage.GetPrototypes():
        yield from Usd.PrimRange(prototype)


def _shown(prim: Usd.Prim) -> str:
    """The prim's path; through an instance that shows it, where it is inside a prototype."""
    path = prim.GetPath()
    while True:
        prototype = prim.GetStage().GetPrimAtPath(path)
        while prototype and not prototype.IsPrototype():
            prototype = prototype.GetParent()
        if not prototype:
            return str(path)
        instance = min(prototype.GetInstances(), key=lambda instance: str(instance.GetPath()))
        path = path.ReplacePrefix(prototype.GetPath(), instance.GetPath())


def _kind(prim: Usd.Prim) -> str:
    return str(Usd.ModelAPI(prim).GetKind())


# --- rules about the stage ----------------------------------------------------------------------


def _metrics(stage: Usd.Stage) -> Iterator[tuple[str, str]]:
    if UsdGeom.GetStageUpAxis(stage) != UsdGeom.Tokens.z:
        yield "/", f"upAxis is {UsdGeom.GetStageUpAxis(stage)}, expected Z"
    m_per_unit = UsdGeom.GetStageMetersPerUnit(stage)
    if m_per_unit != 1.0:
        yield "/", f"metersPerUnit is {m_per_unit:g}, expected 1"
    house = stage.GetDefaultPrim()
    if house and _kind(house) != Kind.Tokens.assembly:
        yield str(house.GetPath()), f"kind is '{_kind(house)}', expected 'assembly'"


def _asset_paths(stage: Usd.Stage) -> Iterator[tuple[str, str]]:
    folder = Path(stage.GetRootLayer().realPath).parent
    for layer in stage.GetUsedLayers():
        if layer == stage.GetSessionLayer():
            continue
        name = Path(layer.realPath).name
        for path in sorted({*named_in(layer.identifier)}):
            if _ABSOLUTE.match(path):
                yield "/", f"{name} points to '{path}', expected a relative path"
        if not Path(layer.realPath).is_relative_to(folder) and not layer.anonymous:
            yield "/", f"{layer.realPath} lies outside the stage's folder"


def _missing_files(stage: Usd.Stage) -> Iterator[tuple[str, str]]:
    _, _, missing = UsdUtils.ComputeAllDependencies(stage.GetRootLayer().identifier)
    for path in sorted(missing):
        yield "/", f"'{path}' is not there"


def _node_ids(stage: Usd.Stage) -> Iterator[tuple[str, str]]:
    owners: dict[str, str] = {}
    for prim in stage.Traverse():
        node_id = prim.GetAttribute(NODE_ID).Get() if prim.HasAttribute(NODE_ID) else None
        if node_id is None:
            continue
        path = str(prim.GetPath())
        if node_id in owners:
            yield path, f"node id '{node_id}' is also that of {owners[node_id]}"
        owners.setdefault(node_id, path)


def _missing_coordinates(stage: Usd.Stage) -> Iterator[tuple[str, str]]:
    read: dict[Sdf.Path, list[str]] = {}  # by the material's path: many meshes share each
    for prim in _prims_once(stage):
        material = bound_material(prim) if prim.IsA(UsdGeom.Mesh) else None
        if not material:
            continue
        path = material.GetPath()
        if path not in read:
            surface = material.ComputeSurfaceSource()[0]
            read[path] = coordinates_read(surface) if surface else []
        primvars = UsdGeom.PrimvarsAPI(prim)
        for name in read[path]:
            if not primvars.FindPrimvarWithInheritance(name).HasValue():
                yield _shown(prim), f"has no '{name}', by which a picture of {path.name} is laid"


# --- rules about one prim -----------------------------------------------------------------------


def _component_in_component(prim: Usd.Prim) -> Iterator[str]:
    if _kind(prim) != Kind.Tokens.component:
        return
    above = prim.GetParent()
    while above and not above.IsPseudoRoot():
        if _kind(above) == Kind.Tokens.component:
            yield f"this component lies inside the component {above.GetPath()}"
            return
        above = above.GetParent()


def _body_in_body(prim: Usd.Prim) -> Iterator[str]:
    if not prim.HasAPI(UsdPhysics.RigidBodyAPI):
        return
    above = prim.GetParent()
    while above and not above.IsPseudoRoot():
        if above.HasAPI(UsdPhysics.RigidBodyAPI):
            yield f"this rigid body lies inside the rigid body {above.GetPath()}"
            return
        above = above.GetParent()


def _hollow_body(prim: Usd.Prim) -> Iterator[str]:
    """Triangles have no inside: solvers refuse them for what moves, or close them to a hull."""
    if not prim.HasAPI(UsdPhysics.RigidBodyAPI):
        return
    for below in Usd.PrimRange(prim, _PROXIES):
        if below.IsA(UsdGeom.Mesh) and below.HasAPI(UsdPhysics.CollisionAPI):
            shape = UsdPhysics.MeshCollisionAPI(below).GetApproximationAttr().Get() or "none"
            if shape == UsdPhysics.Tokens.none:
                yield f"this rigid body collides with the triangles of {below.GetName()}"


def _untyped_ancestor(prim: Usd.Prim) -> Iterator[str]:
    """Blender breaks the chain of transforms at an untyped prim."""
    if prim.GetTypeName() or prim.IsPrototype() or prim.IsPseudoRoot():
        return
    for below in Usd.PrimRange(prim, _PROXIES):
        if below.IsA(UsdGeom.Xformable):
            yield f"has no type and {below.GetPath()} below it; expected Xform or Scope"
            return


def _model_gap(prim: Usd.Prim) -> Iterator[str]:
    kind, parent = _kind(prim), prim.GetParent()
    if not kind or kind == Kind.Tokens.subcomponent or not parent or parent.IsPrototype():
        return
    if parent.IsPseudoRoot() or _kind(parent) == Kind.Tokens.component:
        return  # a component in a component is CHORD002
    if not Kind.Registry.IsA(_kind(parent) or "", Kind.Tokens.group):
        yield f"a {kind} in a prim of kind '{_kind(parent)}', expected a group or an assembly"


def _finite(prim: Usd.Prim) -> Iterator[str]:
    if prim.IsA(UsdGeom.Xformable):
        matrix = UsdGeom.Xformable(prim).GetLocalTransformation()
        if not np.isfinite(np.array(matrix)).all():
            yield "the transform is infinite or not a number"


def _extents_hint(prim: Usd.Prim) -> Iterator[str]:
    if prim.HasAuthoredPayloads() and not UsdGeom.ModelAPI(prim).GetExtentsHintAttr().Get():
        yield "has a payload and no extentsHint"


def _bare_mesh(prim: Usd.Prim) -> Iterator[str]:
    if not prim.IsA(UsdGeom.Mesh) or UsdGeom.Imageable(prim).ComputePurpose() == "guide":
        return
    if UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]:
        return
    parts = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()
    if not parts or not all(
        UsdShade.MaterialBindingAPI(part.GetPrim()).ComputeBoundMaterial()[0] for part in parts
    ):
        yield "has no material"


# --- meshes -------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Shape:
    """What a mesh is made of."""

    points: np.ndarray
    """(N, 3)."""
    counts: np.ndarray
    """(F,) corners of each face."""
    corners: np.ndarray
    """(C,) the point of each corner."""


def _shape(prim: Usd.Prim) -> _Shape | None:
    """Of a mesh; None for anything else and for an empty mesh."""
    if not prim.IsA(UsdGeom.Mesh):
        return None
    mesh = UsdGeom.Mesh(prim)
    points = mesh.GetPointsAttr().Get()
    if not points:
        return None
    counts = np.array(mesh.GetFaceVertexCountsAttr().Get() or [], dtype=np.int64)
    corners = np.array(mesh.GetFaceVertexIndicesAttr().Get() or [], dtype=np.int64)
    return _Shape(np.array(points, dtype=np.float64).reshape(-1, 3), counts, corners)


def _extent(prim: Usd.Prim, shape: _Shape) -> Iterator[str]:
    extent = UsdGeom.Boundable(prim).GetExtentAttr()
    if not extent.HasAuthoredValue():
        yield "has no extent"
        return
    low, high = np.array(extent.Get(), dtype=np.float64)
    points = shape.points
    outside = np.maximum(low - points.min(axis=0), points.max(axis=0) - high).max()
    if outside > EXTENT_TOLERANCE_M:
        yield f"points lie up to {outside:.3f} m outside the extent"


def _topology(_: Usd.Prim, shape: _Shape) -> Iterator[str]:
    points, counts, corners = shape.points, shape.counts, shape.corners
    if counts.sum() != len(corners) or (counts < 3).any():
        yield f"{counts.sum()} face corners are counted and {len(corners)} given"
        return
    if len(corners) and not 0 <= corners.min() <= corners.max() < len(points):
        yield f"a face refers to a point outside 0 to {len(points) - 1}"
        return
    flat = int(np.count_nonzero(_face_areas_m2(points, counts, corners) < MIN_FACE_AREA_M2))
    if flat:
        yield f"{flat} of {len(counts)} faces have no area"


def _value_counts(prim: Usd.Prim, shape: _Shape) -> Iterator[str]:
    wanted = {
        "constant": 1,
        "uniform": len(shape.counts),
        "vertex": len(shape.points),
        "varying": len(shape.points),
        "faceVarying": len(shape.corners),
    }
    mesh = UsdGeom.Mesh(prim)
    normals = mesh.GetNormalsAttr().Get()
    if normals is not None and len(normals) != wanted[mesh.GetNormalsInterpolation()]:
        yield f"{len(normals)} normals, expected {wanted[mesh.GetNormalsInterpolation()]}"
    for primvar in UsdGeom.PrimvarsAPI(prim).GetPrimvarsWithAuthoredValues():
        values = primvar.ComputeFlattened()
        if not hasattr(values, "__len__") or isinstance(values, str):
            continue
        expected = wanted[primvar.GetInterpolation()] * primvar.GetElementSize()
        if len(values) != expected:
            yield f"{primvar.GetName()} has {len(values)} values, expected {expected}"


def _finite_points(_: Usd.Prim, shape: _Shape) -> Iterator[str]:
    if not np.isfinite(shape.points).all():
        yield "a point is infinite or not a number"


def _face_areas_m2(points: np.ndarray, counts: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """(F,) area of each face, by Newell's method."""
    if not len(counts):
        return np.zeros(0)
    starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
    following = np.arange(1, len(corners) + 1)
    following[starts + counts - 1] = starts
    turns = cross(points[corners], points[corners[following]])
    doubled: np.ndarray = np.linalg.norm(np.add.reduceat(turns, starts), axis=1)
    return doubled / 2.0


_STAGE_RULES: dict[str, StageRule] = {
    "CHORD001": _metrics,
    "CHORD014": _node_ids,
    "CHORD017": _missing_coordinates,
}

_FILE_RULES: dict[str, StageRule] = {
    "CHORD005": _asset_paths,
    "CHORD008": _missing_files,
}

_PRIM_RULES: dict[str, Callable[[Usd.Prim], Iterator[str]]] = {
    "CHORD002": _component_in_component,
    "CHORD003": _body_in_body,
    "CHORD004": _untyped_ancestor,
    "CHORD009": _model_gap,
    "CHORD011": _finite,
    "CHORD012": _extents_hint,
    "CHORD013": _bare_mesh,
    "CHORD016": _hollow_body,
}

_MESH_RULES: dict[str, Callable[[Usd.Prim, _Shape], Iterator[str]]] = {
    "CHORD006": _extent,
    "CHORD007": _topology,
    "CHORD010": _value_counts,
    "CHORD011": _finite_points,
}

RULES = tuple(sorted({*_STAGE_RULES, *_FILE_RULES, *_PRIM_RULES, *_MESH_RULES}))
"""Numbers of our own rules."""
