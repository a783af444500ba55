"""Furniture that opens: one opinion about its variant makes it so.

A jointed piece has rigid bodies, which USD does not allow inside instances, nor inside a body. So
whether it is an instance and whether it is one body goes with the variant, in a class that all
such pieces of a house inherit; there pieces of one kind still share a prototype.
"""

from __future__ import annotations

from pxr import Sdf

from chord_usd.base.scene.articulation import ARTICULATION, FIXED, JOINTED
from chord_usd.line.stage.author.prims import (
    Types,
    add_variants,
    apply_schema,
    attribute,
    define_class,
    inherit,
    over,
)

OPENABLE, MOVABLE = "Openable", "OpenableMovable"
"""Names of the classes."""


def let_open(layer: Sdf.Layer, prim: Sdf.PrimSpec, mass_kg: float | None) -> None:
    """Let a piece whose component has the variant set open. mass_kg: None where nobody moves it."""
    inherit(prim, _class(layer, MOVABLE if mass_kg is not None else OPENABLE))
    if mass_kg is not None:
        attribute(prim, "physics:mass", Types.Float, round(mass_kg, 4))


def _class(layer: Sdf.Layer, name: str) -> Sdf.Path:
    path = define_class(layer, name)
    prim = layer.GetPrimAtPath(path)
    if ARTICULATION in prim.variantSets:
        return path
    fixed, jointed = add_variants(prim, ARTICULATION, (FIXED, JOINTED))
    fixed.instanceable = True
    jointed.instanceable = False
    if name == MOVABLE:
        apply_schema(fixed, "PhysicsRigidBodyAPI", "PhysicsMassAPI")
        # Nothing holds its base but the floor.
        anchor = over(jointed, "Joints", "Anchor")
        attribute(anchor, "physics:jointEnabled", Types.Bool, False)
    return path
