"""What can move and how heavy it is; doors on their hinges.

Furniture and dressing bring their colliders. A piece that people move becomes a rigid body; what
is built in or too heavy to push stays a collider without a body. Walls and floors are sheets,
which no solver takes for a collider (MuJoCo makes hulls of meshes, and closes the doors with
them): unseen boxes behind them do that.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from pxr import Gf, Sdf, Vt

from chord_usd.base.scene.articulation import SETTLES_S
from chord_usd.base.scene.feels import Feel
from chord_usd.base.scene.types import Box, Item
from chord_usd.line.stage.author.prims import (
    Types,
    apply_schema,
    attribute,
    define,
    note,
    place,
    relate,
    write_mesh,
)
from chord_usd.line.stage.shell.mesh import Mesh

GRAVITY_M_PER_S2 = 9.81

KG_PER_M3: dict[str, float] = {
    "chair": 30.0,
    "dining_table": 40.0,
    "table": 70.0,
    "coffee_table": 75.0,
    "side_coffee_table": 50.0,
    "bedside_table": 120.0,
    "sofa": 35.0,
    "single_sofa": 40.0,
    "leisure_sofa": 40.0,
    "lying_book": 700.0,
    "standing_book": 550.0,
    "magazine": 900.0,
    "all_in_one_computer": 90.0,
    "laptop": 90.0,
    "big_mouse_pad": 400.0,
    "table_lamp": 50.0,
    "small_ornament": 600.0,
    "pen_holder": 300.0,
    "big_plant": 80.0,
    "small_plant": 150.0,
    "coffee_cup": 200.0,
    "electronic": 400.0,
    "photo_frame": 150.0,
    "food": 250.0,
    "dinner_set": 120.0,
    "drinks": 450.0,
    "floor_plant": 60.0,
    "basket": 40.0,
    "bin": 40.0,
    "umbrella_stand": 60.0,
    "book_row": 450.0,
    "vase": 300.0,
    "sculpture": 500.0,
    "candle": 400.0,
    "storage_box": 120.0,
    "trailing_plant": 150.0,
    "kettle": 200.0,
    "toaster": 250.0,
    "coffee_machine": 250.0,
    "pot": 250.0,
    "knife_block": 450.0,
    "utensil_jar": 300.0,
    "jar": 400.0,
    "bottle": 450.0,
    "bowl": 250.0,
    "plate_stack": 600.0,
    "soap_dispenser": 500.0,
    "toothbrush_cup": 200.0,
    "towel_stack": 120.0,
    "toilet_brush": 150.0,
}
"""Mass over the box a piece fills, air included: a chair weighs about five kilograms. Categories
that are not in the table stay where they are."""

STILL_KG_PER_M3: dict[str, float] = {
    "bed": 60.0,
    "cabinet": 110.0,
    "bed_background": 250.0,
    "tv_cabinet": 110.0,
    "sofa_background": 250.0,
    "dining_cabinet": 110.0,
    "shoe_cabinet": 110.0,
    "single_door_floor_cabinet": 130.0,
    "double_door_floor_cabinet": 120.0,
    "cooker_cabinet": 140.0,
    "sink_cabinet": 120.0,
    "electrical_floor_cabinet": 160.0,
    "refrigerator": 95.0,
    "shower": 45.0,
    "toilet": 180.0,
    "washbasin": 120.0,
    "washing_machine": 220.0,
    "washing_set": 120.0,
    "bathtub": 90.0,
    "curtain": 20.0,
    "curtain_rail": 150.0,
    "blind": 60.0,
    "rug": 150.0,
    "mat": 200.0,
    "ceiling_lamp": 80.0,
    "pendant_lamp": 15.0,
    "floor_lamp": 15.0,
    "wall_lamp": 100.0,
    "picture": 250.0,
    "mirror": 300.0,
    "clock": 150.0,
    "wall_shelf": 150.0,
    "hook_rail": 60.0,
    "radiator": 350.0,
    "light_switch": 600.0,
    "socket": 600.0,
    "wall_cabinet": 150.0,
    "cooker_hood": 120.0,
    "splashback": 2000.0,
    "utensil_rail": 60.0,
    "towel_rail": 60.0,
    "paper_holder": 150.0,
    "shower_screen": 1200.0,
    "cushion": 40.0,
    "throw": 60.0,
    "cutting_board": 300.0,
}
"""The same of all others, for who takes them out of the house: a refrigerator of 0.7 cubic metres
weighs about 67 kilograms."""

DOOR_KG_PER_M2, SASH_KG_PER_M2 = 14.0, 25.0
"""An inner door; glass ones are about as heavy. Two panes in their frame."""

DOOR_OPENS_DEG = 90.0

_ON_TOP_M = 0.01
_LEAST_KG = 0.01


def write_gravity(layer: Sdf.Layer, path: str) -> None:
    """The physics scene: gravity along -z."""
    scene = define(layer, path, "PhysicsScene")
    attribute(scene, "physics:gravityDirection", Types.Vector3f, Gf.Vec3f(0.0, 0.0, -1.0))
    attribute(scene, "physics:gravityMagnitude", Types.Float, GRAVITY_M_PER_S2)


def mass_of(prim: Sdf.PrimSpec, item: Item, carriers: Mapping[str, Item]) -> float | None:
    """Mass in kg of an item that people move, its density noted; None for others.

    carriers: by id. Dressing moves only on floors and on tops: what stands within a piece, on one
    of its boards, would lie in the collider around it.
    """
    carrier_id = item.facts.rests_on
    if carrier_id is not None:
        carrier = carriers.get(carrier_id)
        if carrier is None or item.box.center_m[2] < carrier.box.top_m - _ON_TOP_M:
            return None
    if item.category not in KG_PER_M3:
        return None
    length, width, height = item.box.size_m
    density = KG_PER_M3[item.category]
    note(prim, kg_per_m3=density)  # Blender's import drops masses; a swap needs one
    return density * length * width * height


def usual_mass_kg(name: str, size_m: tuple[float, float, float]) -> float:
    """Mass of a piece of this category, by itself. Raises KeyError for one not in the palette."""
    density = KG_PER_M3[name] if name in KG_PER_M3 else STILL_KG_PER_M3[name]
    return max(density * math.prod(size_m), _LEAST_KG)


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
    `Hinge_n` that nothing drives.

    hinge_m: the leaf's origin in the frame of its opening. box: what it fills, in its own frame.
    opens_deg: the smallest and the largest turn; closed is 0. material: that it feels like.
    """
    width_m, _, height_m = box.size_m
    mass_kg = kg_per_m2 * width_m * height_m
    give_body(leaf, mass_kg)
    write_collider(layer, leaf.path.AppendChild("Collider"), box, material)
    path = leaf.path.GetParentPath().AppendChild(f"Hinge_{leaf.name.rpartition('_')[2]}")
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
    damping = math.radians(mass_kg * width_m**2 / 3 / SETTLES_S)
    attribute(joint, "drive:angular:physics:stiffness", Types.Float, 0.0)
    attribute(joint, "drive:angular:physics:damping", Types.Float, round(damping, 6))


def write_feel(material: Sdf.PrimSpec, feel: Feel) -> None:
    """Make a material one that is felt, too."""
    apply_schema(material, "PhysicsMaterialAPI")
    for name, value in feel.attributes().items():
        attribute(material, name, Types.Float, value)


def define_colliders(layer: Sdf.Layer, path: Sdf.Path) -> Sdf.PrimSpec:
    """The scope of what is felt, not seen; readers that leave that out leave the scope out, too."""
    scope = define(layer, path, "Scope")
    attribute(scope, "purpose", Types.Token, "guide", uniform=True)
    return scope


def write_collider(layer: Sdf.Layer, path: Sdf.Path, box: Box, material: Sdf.Path) -> None:
    """A box that is not seen but felt like a material; its size is also its scale."""
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
    """A mesh whose hull is not seen but felt like a material."""
    prim = write_mesh(layer, path, mesh)
    apply_schema(prim, "PhysicsCollisionAPI", "PhysicsMeshCollisionAPI", "MaterialBindingAPI")
    attribute(prim, "physics:approximation", Types.Token, "convexHull", uniform=True)
    relate(prim, "material:binding:physics", [material])
    attribute(prim, "purpose", Types.Token, "guide", uniform=True)


def give_body(prim: Sdf.PrimSpec, mass_kg: float) -> None:
    """Make a prim a rigid body."""
    apply_schema(prim, "PhysicsRigidBodyAPI", "PhysicsMassAPI")
    attribute(prim, "physics:mass", Types.Float, round(mass_kg, 4))
