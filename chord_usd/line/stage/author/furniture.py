"""Furniture, what stands on it, and dressing: placed references to components.

A component may not contain a component, so a piece that carries others becomes a group: the group
holds the placement, beside the piece itself stand its Items. Everything else is one reference.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from pxr import Sdf

from chord_usd.base.scene.articulation import ARTICULATION, FIXED, JOINTED
from chord_usd.base.scene.geometry import footprint, to_own
from chord_usd.base.scene.palette import Level, category, usual_mass_kg
from chord_usd.base.scene.types import Asset, Box, FloatArray, Item
from chord_usd.library.prop import GRASPS
from chord_usd.line.stage.author.names import NamedItem, NamedRoom
from chord_usd.line.stage.author.physics import (
    define_colliders,
    give_body,
    give_inertia,
    hold,
    mass_of,
    write_collider,
)
from chord_usd.line.stage.author.prims import (
    Types,
    add_variants,
    apply_schema,
    attribute,
    bind,
    define,
    define_class,
    hint_extent,
    identify,
    inherit,
    label,
    new_layer,
    note,
    note_size,
    over,
    place,
    write_mesh,
)
from chord_usd.line.stage.author.surfaces import PLAIN_SURFACES, write_surface
from chord_usd.line.stage.author.variants import Wardrobe
from chord_usd.line.stage.export.packages import Packages
from chord_usd.line.stage.shell.mesh import cuboid, mesh_of

PLACEHOLDER = "Placeholder"
"""Name of the plain box that stands in for an item without a mesh."""


FURNITURE, DRESSING, ITEMS, JOINTS = "Furniture", "Dressing", "Items", "Joints"
"""Names of the groups of a room that hold its things, and what ties these to each other."""


def place_furniture(
    layer: Sdf.Layer, room: NamedRoom, assets: Packages, scratch: Path, wardrobe: Wardrobe
) -> None:
    """Write the Furniture group of a room.

    scratch: a folder that is thrown away later, where a placeholder can be drawn. wardrobe: selects
    the variants of its components.
    """
    _place_all(layer, FURNITURE, room.items, _Shop(room, assets, scratch, wardrobe))


def place_dressing(
    layer: Sdf.Layer, room: NamedRoom, assets: Packages, scratch: Path, wardrobe: Wardrobe
) -> None:
    """Write the Dressing group of a room; arguments as place_furniture takes.

    What rests on a piece that people move is a body, too: its own, or tied to the piece.
    """
    shop = _Shop(room, assets, scratch, wardrobe)
    _place_all(layer, DRESSING, room.dressing, shop)
    for named in room.dressing:
        carrier = shop.carrier_of(named.item)
        if carrier is not None and _is_tied(named.item, carrier.item, shop):
            _tie(layer, room.path, named, carrier)


def _place_all(layer: Sdf.Layer, name: str, items: Iterable[NamedItem], shop: _Shop) -> None:
    group = define(layer, f"{shop.named.path}/{name}", "Xform", kind="group")
    for named in items:
        _place(layer, group.path, named, shop)


@dataclass(frozen=True)
class _Shop:
    """Where the components of a room come from."""

    named: NamedRoom
    assets: Packages
    scratch: Path
    wardrobe: Wardrobe

    @cached_property
    def carriers(self) -> dict[str, Item]:
        """Furniture and dressing of the room, by id."""
        return {named.item.id: named.item for named in (*self.named.items, *self.named.dressing)}

    def carrier_of(self, item: Item) -> NamedItem | None:
        """The furniture of the room on which a thing rests."""
        rests_on = item.facts.rests_on
        return next((named for named in self.named.items if named.item.id == rests_on), None)


def extent_of(items: Iterable[Item]) -> FloatArray:
    """(2, 3) bounds of items of a room, in the world; what stands on them is left out."""
    corners = [
        [*corner, z]
        for item in items
        for corner in footprint(item.box)
        for z in (item.box.center_m[2], item.box.top_m)
    ]
    return np.array([np.min(corners, axis=0), np.max(corners, axis=0)])


def _place(layer: Sdf.Layer, parent: Sdf.Path, named: NamedItem, shop: _Shop) -> None:
    path = parent.AppendChild(named.name)
    if not named.children:
        _refer(layer, path, named, shop, placed=True)
        return
    group = define(layer, path, "Xform", kind="group")
    place(group, at_m=named.item.box.center_m, yaw_deg=named.item.box.yaw_deg)
    _refer(layer, path.AppendChild(named.label), named, shop, placed=False)
    items = define(layer, path.AppendChild(ITEMS), "Xform", kind="group")
    for child in named.children:
        _place(layer, items.path, child, shop)


def _is_tied(item: Item, carrier: Item, shop: _Shop) -> bool:
    """Whether a thing that is no body itself rests on a piece that is one."""
    bodies = (mass_of(item, shop.carriers), mass_of(carrier, shop.carriers))
    return bodies[0] is None and bodies[1] is not None


def _tie(layer: Sdf.Layer, room: str, named: NamedItem, carrier: NamedItem) -> None:
    """Make a thing a body that a fixed joint holds to its carrier."""
    groups = f"{room}/{DRESSING}", f"{room}/{FURNITURE}"
    within = f"{carrier.name}/{carrier.label}" if carrier.children else carrier.name
    prim = layer.GetPrimAtPath(f"{groups[0]}/{named.name}")
    box, below = named.item.box, carrier.item.box
    mass_kg = usual_mass_kg(named.item.category, box.size_m)
    give_body(prim, mass_kg)
    give_inertia(prim, mass_kg, box.size_m, _size_m(named.item))
    joints = layer.GetPrimAtPath(f"{room}/{JOINTS}") or define(layer, f"{room}/{JOINTS}", "Scope")
    at_m = (*to_own(below, box.center_m[:2]), box.center_m[2] - below.center_m[2])
    scale = _scale(carrier.item)
    path = joints.path.AppendChild(joint_name(named.name))
    turn_deg = box.yaw_deg - below.yaw_deg
    below_path = f"{groups[1]}/{within}"
    hold(layer, path, below_path, prim.path, at_m / scale, turn_deg)
    # Newton refuses joints of bodies that belong to no articulation.
    apply_schema(layer.GetPrimAtPath(below_path), "PhysicsArticulationRootAPI")


def joint_name(thing: str) -> str:
    """Name of the joint that holds a thing of this name to its carrier."""
    return f"Joint_{thing}"


def _size_m(item: Item) -> tuple[float, float, float]:
    """Size of the component that an item refers to."""
    return item.asset.size_m if item.asset else (1.0, 1.0, 1.0)


def _scale(item: Item) -> FloatArray:
    """(3,) by which the component of an item fills its box."""
    scale: FloatArray = np.divide(item.box.size_m, _size_m(item))
    return scale


def _refer(
    layer: Sdf.Layer, path: Sdf.Path, named: NamedItem, shop: _Shop, *, placed: bool
) -> None:
    """An instance of the item's asset, scaled so that it fills the item's box exactly."""
    item = named.item
    asset = item.asset or _placeholder(shop.scratch)
    prim = define(layer, path, "Xform", kind="component", name=category(item.category).label)
    package = shop.assets.add(asset.usd_path, (GRASPS,))
    prim.referenceList.prependedItems.append(Sdf.Reference(package))
    chosen = shop.wardrobe.selections(item, shop.named.room)
    for variant_set, variant in chosen.items():
        prim.variantSelections[variant_set] = variant
    box: Box = item.box
    scale = _scale(item)
    if placed:
        place(prim, at_m=box.center_m, yaw_deg=box.yaw_deg, scale=scale.tolist())
    else:
        place(prim, scale=scale.tolist())
    label(prim, "category", item.category)
    note(prim, node_id=item.id, category=item.category, score=item.score, usd_path=str(path))
    if item.facts.ood is not None:
        note(prim, ood=item.facts.ood)
    if category(item.category).level is Level.DRESSING:
        note(prim, level=Level.DRESSING.value)
    if item.facts.rests_on is not None:
        note(prim, rests_on=item.facts.rests_on)
    _note_origin(prim, item)
    note_size(prim, box.size_m)
    mass_kg = mass_of(item, shop.carriers)
    if mass_kg is not None:
        # Blender's import drops masses; a swap needs one.
        note(prim, kg_per_m3=category(item.category).kg_per_m3)
    if ARTICULATION in chosen:
        let_open(layer, prim, mass_kg)
        return
    prim.instanceable = True
    if mass_kg is not None:
        give_body(prim, mass_kg)


def _note_origin(prim: Sdf.PrimSpec, item: Item) -> None:
    """Where in the layout raster it was seen, and how far mesh and place are from that."""
    facts = item.facts
    if facts.source_px:
        note(prim, source_px=np.array(facts.source_px, dtype=np.float64))
    if item.asset is not None:
        missed_m = np.subtract(item.asset.size_m[:2], item.box.size_m[:2])
        distance_m = facts.asset_distance_m
        if distance_m is None:
            distance_m = round(float(np.hypot(*missed_m)), 6)
        note(prim, asset_distance_m=distance_m)
    if facts.edits:
        # A text, since Blender's import passes over lists of them.
        rules = "; ".join(dict.fromkeys(edit.rule for edit in facts.edits))
        note(prim, moved_m=item.moved_m, edited_by=rules)


def _placeholder(scratch: Path) -> Asset:
    """A component that is a box of one metre; drawn on first use."""
    interface = scratch / PLACEHOLDER / f"{PLACEHOLDER}.usda"
    if not interface.exists():
        interface.parent.mkdir(parents=True)
        _draw_placeholder(interface)
    return Asset(PLACEHOLDER, "", (1.0, 1.0, 1.0), interface)


def _draw_placeholder(interface: Path) -> None:
    root = Sdf.Path.absoluteRootPath.AppendChild(PLACEHOLDER)
    mesh = mesh_of(cuboid((-0.5, -0.5, 0.0), (0.5, 0.5, 1.0)))
    payload = new_layer(interface.with_name("payload.usdc"), PLACEHOLDER)
    define(payload, root, "Xform")
    define(payload, root.AppendChild("Geometry"), "Scope")
    define(payload, root.AppendChild("Materials"), "Scope")
    material = root.AppendPath(f"Materials/{PLACEHOLDER}")
    write_surface(payload, material, PLACEHOLDER, PLAIN_SURFACES[PLACEHOLDER])
    prim = write_mesh(payload, root.AppendPath("Geometry/Box"), mesh)
    bind(prim, material)
    define_colliders(payload, root.AppendChild("Colliders"))
    whole = Box((0.0, 0.0, 0.0), (1, 1, 1), 0.0)
    write_collider(payload, root.AppendPath("Colliders/Box"), whole, material)
    payload.Save()
    layer = new_layer(interface, PLACEHOLDER)
    component = define(layer, root, "Xform", kind="component")
    identify(component, PLACEHOLDER, f"./{interface.name}")
    inherit(component, define_class(layer, PLACEHOLDER))
    hint_extent(component, mesh.extent_m())
    component.payloadList.prependedItems.append(Sdf.Payload("./payload.usdc"))
    layer.Save()


# Furniture that opens: one opinion about its variant makes it so ---------------------------------

# A jointed piece has rigid bodies, which USD does not allow inside instances, nor inside a body. So
# whether it is an instance and whether it is one body goes with the variant, in a class that all
# such pieces of a house inherit; there pieces of one kind still share a prototype.

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
