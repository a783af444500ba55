"""What makes a component a prop that simulators take by itself, after NVIDIA's SimReady.

    Desk_A/simready_usd/Desk_A.usda                        the interface, with a body and provenance
    Desk_A/simready_usd/.thumbs/256x256/Desk_A.usda.png    what browsers of assets show

Profile Robotics-Prop 4.0.0: folders by NP.005, thumbnail SR.002, provenance SR.004, body RB.001.
Houses refer to the interface beside this folder: there the house decides what is a body.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.scene.articulation import ARTICULATION, FIXED, PROP
from chord_usd.base.scene.feels import CLOTH
from chord_usd.base.scene.label_sets import wikidata_item
from chord_usd.base.scene.palette import usual_mass_kg
from chord_usd.base.scene.types import FloatArray
from chord_usd.library.component_prims import define_box, define_colliders, write_labels
from chord_usd.library.kit.model import Design, Part
from chord_usd.library.surfaces.physical import feel_of, write_feel

if TYPE_CHECKING:
    from pxr import Sdf, Usd

GRASPS = "grasps.json"
"""Beside the interface, once a command has tried where a gripper holds the piece."""

THUMBNAIL_PX = 256
"""Side of the picture."""

_COLOURS = 96
"""Of the picture's palette: a third of the bytes."""

_EVEN = 1e-6
"""Products of inertia below this share of the moments are rounding."""


@dataclass(frozen=True, eq=False)
class Body:
    """How a piece moves as one."""

    mass_kg: float
    centre_m: FloatArray
    """(3,) in its frame."""
    moments_kg_m2: FloatArray
    """(3,) about the principal axes through the centre."""
    axes: FloatArray
    """(3, 3) whose columns are these axes, right-handed."""


def body_of(design: Design, parts: Sequence[Part]) -> Body:
    """Mass by the category; its distribution by the volumes and finishes of the colliders.

    Boxes count as solid, so that what is hollow turns as if its mass were spread over it.
    """
    boxes, density = colliders_by_density(design, parts)
    sides, middles = boxes[:, 1] - boxes[:, 0], boxes.mean(axis=1)
    mass_kg = usual_mass_kg(design.category, design.size_m)
    shares = np.maximum(sides.prod(axis=1), 1e-12) * density
    masses = mass_kg * shares / shares.sum()
    centre = masses @ middles / mass_kg
    inertia = np.zeros((3, 3))
    for mass, side, away in zip(masses, sides, middles - centre, strict=True):
        inertia += mass * np.diag((side @ side - side**2) / 12)
        inertia += mass * (away @ away * np.eye(3) - np.outer(away, away))
    products = np.abs(inertia[~np.eye(3, dtype=bool)]).max()
    if products < _EVEN * np.trace(inertia):
        return Body(mass_kg, centre, np.diag(inertia), np.eye(3))
    moments, axes = np.linalg.eigh(inertia)
    axes[:, 2] *= np.linalg.det(axes)
    return Body(mass_kg, centre, moments, axes)


def colliders_by_density(design: Design, parts: Sequence[Part]) -> tuple[FloatArray, FloatArray]:
    """(N, 2, 3) bounds of a piece's colliders, and (N,) kilograms a cubic metre of each.

    Of what is soft or thin, which nothing collides with in a house, the bounds of its parts.
    """
    looks = next(iter(design.colourways.values()))
    colliders = [part for part in parts if part.collider is not None] or list(parts)
    boxes, densities = [], []
    for part in colliders:
        bounds = [*part.collider_boxes_m().values()] or [part.solid.bounds_m()]
        boxes += bounds
        densities += [feel_of(design.finishes[looks[part.slot]]).density_kg_per_m3] * len(bounds)
    return np.array(boxes), np.array(densities)


def feel_soft(stage: Usd.Stage, bounds_m: FloatArray) -> None:
    """Lets a soft or thin piece collide as the box around it, (2, 3); in a house it has no
    collider, which would only be a hindrance."""
    from pxr import UsdGeom, UsdShade

    scope = stage.GetDefaultPrim().GetPath().AppendChild("Felt")
    UsdGeom.Scope.Define(stage, scope)
    cloth = UsdShade.Material.Define(stage, scope.AppendChild("Cloth"))
    write_labels(cloth.GetPrim(), {"material": "textile"})
    write_feel(cloth.GetPrim(), CLOTH)
    define_colliders(stage, f"{scope}/Colliders")
    box = define_box(stage, f"{scope}/Colliders/Box", bounds_m)
    UsdShade.MaterialBindingAPI.Apply(box).GetDirectBindingRel("physics").SetTargets(
        [cloth.GetPath()]
    )


def give_body(root: Sdf.PrimSpec, body: Body) -> None:
    """Make a component one rigid body; one that opens is that in its variant `fixed`."""
    from pxr import Gf, Sdf

    if ARTICULATION in root.variantSets:
        root = root.variantSets[ARTICULATION].variants[FIXED].primSpec
    known = root.GetInfo("apiSchemas").prependedItems if root.HasInfo("apiSchemas") else []
    names = [*known, "PhysicsRigidBodyAPI", "PhysicsMassAPI"]
    root.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=names))
    turn = Gf.Matrix3d(*body.axes.T.flatten().tolist()).ExtractRotation().GetQuat()
    types = Sdf.ValueTypeNames
    for name, kind, value in (
        ("mass", types.Float, round(body.mass_kg, 4)),
        ("centerOfMass", types.Point3f, Gf.Vec3f(*np.round(body.centre_m, 5).tolist())),
        ("diagonalInertia", types.Float3, Gf.Vec3f(*body.moments_kg_m2.tolist())),
        ("principalAxes", types.Quatf, Gf.Quatf(turn)),
    ):
        Sdf.AttributeSpec(root, f"physics:{name}", kind).default = value


def provenance(
    design: Design, author: str, licence: str, made: str, bounds_m: FloatArray
) -> dict[str, object]:
    """The fields that SR.004 asks for."""
    from pxr import Gf

    mass_kg = usual_mass_kg(design.category, design.size_m)
    return {
        "asset_name": design.id,
        "asset_type": "prop",
        "author": author,
        "asset_license": licence,
        "category": design.category,
        "qcode": wikidata_item(design.category),
        "source_file": f"{design.id}.usda",
        "usd_date_generated": made,
        "rigid_body_count": 1,
        "asset_extents": Gf.Vec3f(*(bounds_m[1] - bounds_m[0]).tolist()),
        "mass": round(mass_kg, 4),
    }


def write_thumbnail(design: Design, parts: Sequence[Part], package: Path) -> None:
    """Draw the picture of a prop into its package, in its first colours."""
    from PIL import Image

    from chord_usd.library.contact_sheet import picture_of

    pixels = picture_of(design, parts, THUMBNAIL_PX)
    size = f"{THUMBNAIL_PX}x{THUMBNAIL_PX}"
    file = package / PROP / ".thumbs" / size / f"{design.id}.usda.png"
    file.parent.mkdir(parents=True)
    few = Image.fromarray(pixels).quantize(_COLOURS, Image.Quantize.FASTOCTREE)
    few.save(file, "PNG", optimize=True)


def prop_files(name: str) -> tuple[str, ...]:
    """What a package holds for the prop beside what its interface points to."""
    thumbnail = f"{PROP}/.thumbs/{THUMBNAIL_PX}x{THUMBNAIL_PX}/{name}.usda.png"
    return f"{PROP}/{name}.usda", thumbnail, GRASPS
