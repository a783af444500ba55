"""The layer that lets a piece of furniture open: bodies, joints, hollow insides.

    X/Geometry, X/Colliders   off: the piece in one
    X/Base                    a rigid body: what stands still, hollow bodies as boards
    X/Door_1, X/Drawer_1, …   rigid bodies, their origin on the hinge
    X/Joints/Anchor           holds Base where the piece is
    X/Joints/Door_1, …        with limits and damping; drives have no stiffness

It is a payload of the variant `jointed` of the variant set `articulation`, so that one opinion
about that variant opens a piece.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.scene.articulation import JOINTS, PAYLOAD_LAYER, SETTLES_S, hinge_damping
from chord_usd.library.component_prims import (
    bind_feel,
    define_box,
    define_colliders,
    define_mesh,
    detached,
    material_path,
    mesh_name,
    new_stage,
)
from chord_usd.library.kit.links import BASE, Link, Piece, links_of
from chord_usd.library.kit.model import Design, Part
from chord_usd.library.kit.moves import Hinge
from chord_usd.library.kit.shading import corner_uvs_m
from chord_usd.library.surfaces.physical import feel_of

if TYPE_CHECKING:
    from pxr import Usd

SHAPES = "/Shapes"
"""A class in the payload of a piece that opens: its meshes, which its base shares."""

ANCHOR = "Anchor"

_SOLID_SHARE, _MOST_KG_PER_M3 = 0.7, 700.0
"""Boards weigh so much of what solid stuff of their finish would; metal and glass are sheets."""

_LEAST_KG, _LEAST_KG_M2 = 0.05, 1e-3


def write_jointed(design: Design, parts: Sequence[Part], path: Path) -> None:
    """Write the layer of a piece of which something moves; payload.usdc lies beside it."""
    from pxr import Sdf, UsdGeom, UsdPhysics

    stage = new_stage(design)
    root = stage.GetDefaultPrim()
    root.SetSpecifier(Sdf.SpecifierOver)
    UsdPhysics.ArticulationRootAPI.Apply(root)
    for name in ("Geometry", "Colliders"):
        stage.OverridePrim(f"/{design.id}/{name}").SetActive(False)
    links = links_of(parts)
    masses = [_write_link(stage, design, link, parts) for link in links]
    UsdGeom.Scope.Define(stage, f"/{design.id}/{JOINTS}")
    anchor = UsdPhysics.FixedJoint.Define(stage, f"/{design.id}/{JOINTS}/{ANCHOR}")
    anchor.CreateBody0Rel().SetTargets([root.GetPath()])
    anchor.CreateBody1Rel().SetTargets([root.GetPath().AppendChild(BASE)])
    for link, mass_kg in zip(links, masses, strict=True):
        if link.motion is not None:
            _write_joint(stage, design, link, mass_kg)
    layer = detached(stage)
    # Said last: while it is written, the layer is nowhere that a path could start from.
    spec = layer.GetPrimAtPath(f"/{design.id}/{BASE}/Geometry")
    if links[0].reused:
        shared = Sdf.Reference(f"./{PAYLOAD_LAYER}", SHAPES)
        spec.referenceList.prependedItems = [shared]
    layer.Export(str(path))


def _write_link(stage: Usd.Stage, design: Design, link: Link, parts: Sequence[Part]) -> float:
    """A rigid body with its meshes and colliders; returns its mass in kg."""
    from pxr import Gf, UsdGeom, UsdPhysics

    path = f"/{design.id}/{link.name}"
    body = UsdGeom.Xform.Define(stage, path)
    at_m = np.zeros(3) if link.motion is None else np.array(link.motion.at_m)
    body.AddTranslateOp().Set(Gf.Vec3d(*at_m.tolist()))
    UsdGeom.Scope.Define(stage, f"{path}/Geometry")
    define_colliders(stage, f"{path}/Colliders")
    if link.reused:
        for part in parts:
            if part.name not in link.reused:
                stage.OverridePrim(f"{path}/Geometry/{mesh_name(design, part.name)}").SetActive(
                    False
                )
    for piece in link.pieces:
        _write_piece(stage, design, path, piece, at_m, is_new=piece.part.name not in link.reused)
    mass_kg = max(sum(_mass_kg(design, piece) for piece in link.pieces), _LEAST_KG)
    UsdPhysics.RigidBodyAPI.Apply(body.GetPrim())
    UsdPhysics.MassAPI.Apply(body.GetPrim()).CreateMassAttr(round(mass_kg, 3))
    return mass_kg


def _write_piece(
    stage: Usd.Stage, design: Design, body: str, piece: Piece, origin_m: np.ndarray, *, is_new: bool
) -> None:
    from pxr import UsdPhysics, UsdShade

    part = piece.part
    link = body.rpartition("/")[2] if is_new else ""
    path = f"{body}/Geometry/{mesh_name(design, part.name, link)}"
    if is_new:
        # Texture coordinates belong to its place when shut.
        uvs = corner_uvs_m(part.solid, part.name) if part.uvs is None else part.uvs
        define_mesh(stage, path, replace(part, solid=part.solid.moved(*-origin_m), uvs=uvs))
    mesh = stage.OverridePrim(path)
    worn = UsdShade.MaterialBindingAPI.Apply(mesh).GetDirectBindingRel()
    worn.SetTargets([material_path(design.id, part.slot)])
    colliders = [
        define_box(stage, f"{body}/Colliders/{part.name}_{number}", bounds_m - origin_m)
        for number, bounds_m in enumerate(piece.colliders_m, start=1)
    ]
    if piece.collides_itself and part.collider is not None:
        UsdPhysics.CollisionAPI.Apply(mesh)
        UsdPhysics.MeshCollisionAPI.Apply(mesh).CreateApproximationAttr(part.collider)
        colliders.append(mesh)
    bind_feel(design, part.slot, colliders)


def _mass_kg(design: Design, piece: Piece) -> float:
    """Mass of what collides: trim weighs nothing."""
    looks = next(iter(design.colourways.values()))
    density = feel_of(design.finishes[looks[piece.part.slot]]).density_kg_per_m3
    boxes = (
        [*piece.colliders_m, piece.part.solid.bounds_m()]
        if piece.collides_itself
        else piece.colliders_m
    )
    volume_m3 = sum(float(np.prod(bounds[1] - bounds[0])) for bounds in boxes)
    return volume_m3 * min(density, _MOST_KG_PER_M3) * _SOLID_SHARE


def _write_joint(stage: Usd.Stage, design: Design, link: Link, mass_kg: float) -> None:
    """A joint between base and leaf, at the leaf's origin; 0 is shut."""
    from pxr import Gf, UsdPhysics

    motion = link.motion
    if motion is None:
        return
    path = f"/{design.id}/{JOINTS}/{link.name}"
    turns = isinstance(motion, Hinge)
    joint = (
        UsdPhysics.RevoluteJoint.Define(stage, path)
        if turns
        else UsdPhysics.PrismaticJoint.Define(stage, path)
    )
    joint.CreateBody0Rel().SetTargets([f"/{design.id}/{BASE}"])
    joint.CreateBody1Rel().SetTargets([f"/{design.id}/{link.name}"])
    joint.CreateAxisAttr(motion.axis.upper())
    joint.CreateLocalPos0Attr(Gf.Vec3f(*motion.at_m))
    joint.CreateLocalPos1Attr(Gf.Vec3f(0.0))
    joint.CreateLocalRot0Attr(Gf.Quatf(1.0))
    joint.CreateLocalRot1Attr(Gf.Quatf(1.0))
    wide_open = motion.opens_deg if isinstance(motion, Hinge) else motion.opens_m
    joint.CreateLowerLimitAttr(round(min(wide_open, 0.0), 4))
    joint.CreateUpperLimitAttr(round(max(wide_open, 0.0), 4))
    drive = UsdPhysics.DriveAPI.Apply(joint.GetPrim(), "angular" if turns else "linear")
    drive.CreateStiffnessAttr(0.0)
    drive.CreateDampingAttr(_damping(link, mass_kg))


def _damping(link: Link, mass_kg: float) -> float:
    """Newton seconds per metre, or newton metre seconds per degree."""
    if not isinstance(link.motion, Hinge):
        return float(round(mass_kg / SETTLES_S, 4))
    boxes = np.concatenate(
        [np.array(piece.colliders_m) for piece in link.pieces if piece.colliders_m]
    )
    away = np.abs(boxes - np.array(link.motion.at_m)).max(axis=(0, 1))
    away["xyz".index(link.motion.axis)] = 0.0
    inertia = max(mass_kg * float(away @ away) / 3, _LEAST_KG_M2)
    return hinge_damping(inertia)
