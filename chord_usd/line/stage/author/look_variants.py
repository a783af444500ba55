"""What floors and walls look like: variant sets on each room, sampled by kind (CHOrD, section 4).

A look is a reference to a material package plus a few inputs that say how it is laid, so it is
copied once and not per room.
"""

from __future__ import annotations

import hashlib
from typing import Literal

import numpy as np
from pxr import Gf, Sdf
from shapely.geometry import Polygon

from chord_usd.base.scene.feels import FEEL_OF_LOOK, FEEL_OF_SURFACE
from chord_usd.base.scene.geometry import hanging_together, room_polygon, seams
from chord_usd.base.scene.looks import LOOK_FILE, Look, LookSource
from chord_usd.base.scene.tunnels import GRID_M
from chord_usd.base.scene.types import RoomKind
from chord_usd.line.stage.author.names import NamedRoom
from chord_usd.line.stage.author.physics import write_feel
from chord_usd.line.stage.author.prims import Types, add_variants, attribute, label, over
from chord_usd.line.stage.author.stage_levels import Level
from chord_usd.line.stage.author.surfaces import (
    PLAIN_SURFACES,
    floor_material,
    shade,
    wall_material,
)
from chord_usd.line.stage.export.packages import Packages

CHOICES = 3
"""Looks offered for each surface; the first one is worn."""

Part = Literal["floor", "wall"]

_ONE_FLOOR: tuple[RoomKind, ...] = ("living", "bedroom", "kitchen", "dining", "study", "corridor")
"""Kinds of rooms that are done alike where nothing parts them, the leading one first."""

_LEAST_BORDER_M = 0.5


def assign_looks(
    layer: Sdf.Layer, level: Level, looks: LookSource | None, materials: Packages, seed: int
) -> None:
    """Write the variant sets floorMaterial and wallMaterial of a storey's rooms.

    Rooms of an open plan take the looks of the leading room: floor and walls run on.
    """
    leading = _leading_rooms(level)
    for room in level.rooms:
        as_in = leading.get(room.room.id, room)
        _assign_looks(layer, room, as_in, level.walls.floors_m[as_in.index], looks, materials, seed)


def _leading_rooms(level: Level) -> dict[str, NamedRoom]:
    """By id of each room, the leading one of those that it touches with no wall between, over
    others, too: itself where it touches none."""
    rooms = [room for room in level.rooms if room.room.kind in _ONE_FLOOR]
    floors = [level.walls.floors_m[room.index] for room in rooms]
    borders = seams(floors, GRID_M)
    touching = [(first, second) for first, second, line in borders if line.length > _LEAST_BORDER_M]
    leading = {}
    for group in hanging_together(len(rooms), touching):
        members = [rooms[index] for index in group]
        first = min(members, key=lambda room: (_ONE_FLOOR.index(room.room.kind), room.index))
        leading.update(dict.fromkeys((room.room.id for room in members), first))
    return leading


def _assign_looks(
    layer: Sdf.Layer,
    room: NamedRoom,
    as_in: NamedRoom,
    floor: Polygon,
    looks: LookSource | None,
    materials: Packages,
    seed: int,
) -> None:
    """Write the variant sets floorMaterial and wallMaterial of a room.

    How they are laid depends on seed and one room's id and floor alone: its own, or of the room
    as_in which it is done. Without looks, surfaces are plain.
    """
    prim = layer.GetPrimAtPath(room.path)
    parts: tuple[tuple[Part, str], ...] = (
        ("floor", floor_material(room)),
        ("wall", wall_material(room)),
    )
    for part, material in parts:
        plain = f"Plain{part.capitalize()}"
        rng = _generator(seed, as_in.room.id, part)
        choices = looks.choices(part, as_in.room, CHOICES) if looks else ()
        variants = add_variants(
            prim, f"{part}Material", [look.name for look in choices] or ["Plain"]
        )
        specs = [over(variant, "Architecture", "Materials", material) for variant in variants]
        if not choices:
            shade(layer, specs[0], PLAIN_SURFACES[plain])
        for spec, look in zip(specs, choices, strict=False):
            _write_look(spec, look, part, floor, materials, rng)


def wear_look(
    layer: Sdf.Layer, room: NamedRoom, part: Part, look: Look, materials: Packages, seed: int
) -> None:
    """Bind a look to the floor or walls of a written room; the room offers it from then on."""
    prim, name = layer.GetPrimAtPath(room.path), f"{part}Material"
    variants = prim.variantSets.get(name)
    if variants is None:
        variants = Sdf.VariantSetSpec(prim, name)
        prim.variantSetNameList.prependedItems.append(name)
    if look.name not in variants.variants:
        variant = Sdf.VariantSpec(variants, look.name).primSpec
        material = floor_material(room) if part == "floor" else wall_material(room)
        spec = over(variant, "Architecture", "Materials", material)
        rng = _generator(seed, room.room.id, part)
        _write_look(spec, look, part, room_polygon(room.room), materials, rng)
    prim.variantSelections[name] = look.name


def _write_look(
    spec: Sdf.PrimSpec, look: Look, part: Part, floor: Polygon, materials: Packages,
    rng: np.random.Generator,
) -> None:  # fmt: skip
    package = materials.add(look.usd_path, [LOOK_FILE])
    spec.referenceList.prependedItems.append(Sdf.Reference(package))
    label(spec, "material", look.name)
    usual = FEEL_OF_SURFACE[f"Plain{part.capitalize()}"]
    write_feel(spec, FEEL_OF_LOOK.get(look.family, usual))
    _lay(spec, look, part == "floor" and _runs_north(floor), rng)


def _generator(seed: int, room_id: str, part: Part) -> np.random.Generator:
    digest = hashlib.sha256(f"{seed}/{room_id}/{part}".encode()).digest()
    return np.random.default_rng(int.from_bytes(digest[:8], "little"))


def _lay(material: Sdf.PrimSpec, look: Look, turned: bool, rng: np.random.Generator) -> None:
    """How the pattern lies, in its true size: where it starts and which way it runs."""
    across, along = (1.0 / side for side in look.tile_m)
    # Coordinates are scaled before they are turned.
    scale = (along, across) if turned else (across, along)
    offset = rng.uniform(0.0, 1.0, size=2)
    if look.standing:
        offset[1] = 0.0
    attribute(material, "inputs:uvScale", Types.Float2, Gf.Vec2f(*np.round(scale, 4).tolist()))
    attribute(material, "inputs:uvRotation", Types.Float, 90.0 if turned else 0.0)
    attribute(material, "inputs:uvOffset", Types.Float2, Gf.Vec2f(*np.round(offset, 4).tolist()))


def _runs_north(floor: Polygon) -> bool:
    """Whether a room is longer from south to north than across: boards follow the longer side."""
    west, south, east, north = floor.bounds
    return bool(north - south > east - west)
