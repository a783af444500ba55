"""What floors and walls look like: variant sets on each room."""

from __future__ import annotations

from pxr import Sdf

from chord_usd.stage.names import NamedRoom
from chord_usd.stage.prims import add_variants, over
from chord_usd.stage.shell import floor_material, wall_material
from chord_usd.stage.surfaces import PLAIN_SURFACES, shade


def wear_looks(layer: Sdf.Layer, room: NamedRoom) -> None:
    """Write the variant sets floorMaterial and wallMaterial of a room."""
    prim = layer.GetPrimAtPath(f"/House/Rooms/{room.name}")
    for name, material, plain in (
        ("floorMaterial", floor_material(room), "PlainFloor"),
        ("wallMaterial", wall_material(room), "PlainWall"),
    ):
        for choice in add_variants(prim, name, ["Plain"]):
            spec = over(choice, "Architecture", "Materials", material)
            shade(layer, spec, PLAIN_SURFACES[plain])
