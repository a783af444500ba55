"""What can move and how heavy it is; doors on their hinges.

Furniture and dressing bring their colliders. A piece that people move becomes a rigid body; what
is built in or too heavy to push stays a collider without a body. Walls and floors are sheets,
which no solver takes for a collider (MuJoCo makes hulls of meshes, and closes the doors with
them): unseen boxes behind them do that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import numpy.typing as npt
from pxr import Gf, Sdf, Vt

from chord_usd.base.scene.articulation import hinge_damping
from chord_usd.base.scene.feels import Feel
from chord_usd.base.scene.palette import CATEGORIES, having
from chord_usd.base.scene.types import Box, Item
from chord_usd.line.stage.author.prims import (
    Types,
    apply_schema,
    attribute,
    define,
    place,
    relate,
    write_mesh,
)
from chord_usd.line.stage.shell.mesh import Mesh

GRAVITY_M_PER_S2 = 9.81


DOOR_KG_PER_M2, SASH_KG_PER_M2 = 14.0, 25.0
"""An inner door; glass ones are about as heavy. Two panes in their frame."""

DOOR_OPENS_DEG = 90.0

_ON_TOP_M = 0.01


def write_gravity(layer: Sdf.Layer, path: str) -> None:
    """The physics scene: gravity along -z."""
    scene = define(layer, path, "PhysicsScene")
    attribute(scene, "physics:gravityDirection", Types.Vector3f, Gf.Vec3f(0.0, 0.0, -1.0))
    attribute(scene, "physics:gravityMagnitude", Types.Float, GRAVITY_M_PER_S2)


def mass_of(item: Item, carriers: Mapping[str, Item]) -> float | None:
    """Mass in kg of an item that people move; None for others.

    carriers: by id. Dressing moves only on floors and on tops: what stands within a piece, on one
    of its boards, would lie in the collider around it.
    """
    carrier_id = item.facts.rests_on
    if carrier_id is not None:
        carrier = carriers.get(carrier_id)
        if carrier is None or item.box.center_m[2] < carrier.box.top_m - _ON_TOP_M:
            return None
    if item.category not in having("moved"):
        return None
    return CATEGORIES[item.category].kg_per_m3 * math.prod(item.box.size_m)


def hang_leaf(
    layer: Sdf.Layer,
    leaf: Sdf.PrimSpec,
    hinge_m: tuple[float, float, float],
    box: Box,
    opens_deg: tuple[float, float],
    material: Sdf.Path,
    kg_per_m2: float = DOOR_KG_PER_M2,
) -> None:
    """Make the leaf of a door or window a body that turns about its own z axis, beside it a joint
    `Hinge_n_Door_m` that nothing drives.

    hinge_m: the leaf's origin in the frame of its opening. box: what it fills, in its own frame.
    opens_deg: the smallest and the largest turn; closed is 0. material: that it feels like.
    """
    width_m, _, height_m = box.size_m
    mass_kg = kg_per_m2 * width_m * height_m
    give_body(leaf, mass_kg)
    write_collider(layer, leaf.path.AppendChild("Collider"), box, material)
    path = leaf.path.GetParentPath().AppendChild(f"Hinge_{leaf.name.partition('_')[2]}")
    joint = define(layer, path, "PhysicsRevoluteJoint")
    relate(joint, "physics:body0", [leaf.path.GetParentPath()])
    relate(joint, "physics:body1", [leaf.path])
    attribute(joint, "physics:axis", Types.Token, "Z", uniform=True)
    attribute(joint, "physics:localPos0", Types.Point3f, Gf.Vec3f(*hinge_m))
    attribute(joint, "physics:localPos1", Types.Point3f, Gf.Vec3f(0.0))
    attribute(joint, "physics:localRot0", Types.Quatf, Gf.Quatf(1.0))
    attribute(joint, "physics:localRot1", Types.Quatf, Gf.Quatf(1.0))
    attribute(joint, "physics:lowerLimit", Types.Float, opens_deg[0])
    attribute(joint, "physics:upperLimit", Types.Float, opens_deg[1])
    apply_schema(joint, "PhysicsDriveAPI:angular")
    attribute(joint, "drive:angular:physics:stiffness", Types.Float, 0.0)
    attribute(
        joint, "drive:angular:physics:damping", Types.Float, hinge_damping(mass_kg * width_m**2 / 3)
    )


def hold(
    layer: Sdf.Layer,
    path: Sdf.Path,
    carrier: str,
    carried: Sdf.Path,
    at: npt.ArrayLike,
    yaw_deg: float,
) -> None:
    """A fixed joint at path between two bodies that may touch each other.

    at: (3,) origin of the carried body in the frame of the carrier, unscaled. yaw_deg: its turn.
    """
    joint = define(layer, path, "PhysicsFixedJoint")
    half = math.radians(yaw_deg) / 2
    relate(joint, "physics:body0", [carrier])
    relate(joint, "physics:body1", [carried])
    attribute(joint, "physics:localPos0", Types.Point3f, Gf.Vec3f(*map(float, np.asarray(at))))
    turn = Gf.Quatf(math.cos(half), 0.0, 0.0, math.sin(half))
    attribute(joint, "physics:localRot0", Types.Quatf, turn)
    attribute(joint, "physics:localPos1", Types.Point3f, Gf.Vec3f(0.0))
    attribute(joint, "physics:localRot1", Types.Quatf, Gf.Quatf(1.0))


def write_feel(material: Sdf.PrimSpec, feel: Feel) -> None:
    """Make a material a physics material, too."""
    apply_schema(material, "PhysicsMaterialAPI")
    for name, value in feel.attributes().items():
        attribute(material, name, Types.Float, value)


def define_colliders(layer: Sdf.Layer, path: Sdf.Path) -> Sdf.PrimSpec:
    """The scope of colliders, which are not seen; readers that leave guides out leave it out,
    too."""
    scope = define(layer, path, "Scope")
    attribute(scope, "purpose", Types.Token, "guide", uniform=True)
    return scope


def write_collider(layer: Sdf.Layer, path: Sdf.Path, box: Box, material: Sdf.Path) -> None:
    """An unseen box that collides, bound to a physics material; its size is also its scale."""
    cube = define(layer, path, "Cube")
    apply_schema(cube, "PhysicsCollisionAPI", "MaterialBindingAPI")
    relate(cube, "material:binding:physics", [material])
    attribute(cube, "purpose", Types.Token, "guide", uniform=True)
    attribute(cube, "size", Types.Double, 1.0)
    extent = Vt.Vec3fArray([Gf.Vec3f(-0.5), Gf.Vec3f(0.5)])
    attribute(cube, "extent", Types.Float3Array, extent)
    x, y, z = box.center_m
    place(cube, at_m=(x, y, z + box.size_m[2] / 2), yaw_deg=box.yaw_deg, scale=box.size_m)


def write_hull(layer: Sdf.Layer, path: Sdf.Path, mesh: Mesh, material: Sdf.Path) -> None:
    """A mesh whose unseen hull collides, bound to a physics material."""
    prim = write_mesh(layer, path, mesh)
    apply_schema(prim, "PhysicsCollisionAPI", "PhysicsMeshCollisionAPI", "MaterialBindingAPI")
    attribute(prim, "physics:approximation", Types.Token, "convexHull", uniform=True)
    relate(prim, "material:binding:physics", [material])
    attribute(prim, "purpose", Types.Token, "guide", uniform=True)


def give_body(prim: Sdf.PrimSpec, mass_kg: float) -> None:
    """Make a prim a rigid body."""
    apply_schema(prim, "PhysicsRigidBodyAPI", "PhysicsMassAPI")
    attribute(prim, "physics:mass", Types.Float, round(mass_kg, 4))


def give_inertia(
    prim: Sdf.PrimSpec,
    mass_kg: float,
    size_m: tuple[float, float, float],
    own_m: tuple[float, float, float],
) -> None:
    """Centre and moments of an even box for a body that has no collider to take them from.

    size_m: of the box, which stands on the prim's origin; own_m: its size before the prim's scale.
    """
    squares = np.square(size_m)
    moments = mass_kg * (squares.sum() - squares) / 12
    attribute(prim, "physics:centerOfMass", Types.Point3f, Gf.Vec3f(0.0, 0.0, own_m[2] / 2))
    attribute(prim, "physics:diagonalInertia", Types.Float3, Gf.Vec3f(*moments.tolist()))
    attribute(prim, "physics:principalAxes", Types.Quatf, Gf.Quatf(1.0))
