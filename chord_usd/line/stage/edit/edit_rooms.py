"""Pieces of a written stage moved, removed, locked, brought into other rooms, and new ones beside
them; the prims of everything else stay as they are, byte for byte.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from pxr import Gf, Sdf

from chord_usd.base.errors import StageError
from chord_usd.base.runtime.house_history import Deed
from chord_usd.base.runtime.stages import open_layer
from chord_usd.base.scene.geometry import to_own, to_world
from chord_usd.base.scene.looks import Look
from chord_usd.base.scene.style_rooms import Part
from chord_usd.base.scene.types import Box, Provenance, Room, StageFile
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.stage.author.design_notes import forget_design
from chord_usd.line.stage.author.furniture import DRESSING, JOINTS, joint_name
from chord_usd.line.stage.author.look_variants import wear_look
from chord_usd.line.stage.author.names import NamedRoom
from chord_usd.line.stage.author.prims import Types, apply_schema, attribute, define, relate
from chord_usd.line.stage.author.stage_levels import STOREY, room_spec, room_specs
from chord_usd.line.stage.author.variants import COLOUR
from chord_usd.line.stage.check.check_rules import NODE_ID
from chord_usd.line.stage.edit.refurnish import (
    NewFurniture,
    furnish_layer,
    require_furniture,
    rewrite,
)
from chord_usd.line.stage.edit.staged_house import LOCKED
from chord_usd.line.stage.export.packages import Packages

_AT, _TURNED = "xformOp:translate", "xformOp:rotateZ"


@dataclass(frozen=True, eq=False)
class PieceChange:
    """The change of a piece that is there. Paths name the prim that holds its placement: the piece,
    or the group around it."""

    path: str
    was: Box
    now: Box | None
    """None where it is removed."""
    room_name: str = ""
    """Name of the prim of another room that it is brought into."""
    locked: bool | None = None
    """None leaves its lock as it is."""


@dataclass(frozen=True, eq=False)
class RoomsChange:
    """What becomes of some rooms of a house."""

    pieces: Sequence[PieceChange] = ()
    rooms: Mapping[str, NewFurniture] = field(default_factory=dict)
    """New things, by the name of the room's prim, of every room that is changed; what is there and
    not removed is kept."""
    colours: Mapping[str, str] = field(default_factory=dict)
    """Colourways that things get, new ones too, by their ids."""
    looks: Mapping[tuple[str, Part], Look] = field(default_factory=dict)
    """Looks of walls and floors, by the name of the room's prim."""
    shells: Mapping[str, Room] = field(default_factory=dict)
    """The rooms that get looks, by the names of their prims."""
    seed: int = 0
    """Of the house."""


def edit_rooms(
    source: Path, target: Path, change: RoomsChange, deed: Deed,
    accept: Callable[[Path], None] | None = None,
) -> StageFile:  # fmt: skip
    """Write source to target with some rooms changed; arguments and errors as rewrite has them."""
    for name in change.rooms:
        require_furniture(source, name)
    made = next((new.made for new in change.rooms.values()), Provenance())

    def edit(path: Path, finals: Sequence[Path]) -> Sdf.Layer:
        layer = open_layer(path)
        for piece in change.pieces:
            _change(layer, piece, source)
        layer.Save()
        for name, new in change.rooms.items():
            groups = _room(layer, name).nameChildren
            there = [spec for group in ("Furniture", DRESSING) if group in groups
                     for spec in groups[group].nameChildren]  # fmt: skip
            names = [spec.name for spec in there]
            layer = furnish_layer(path, finals, replace(new, kept=names))
        _collect_dressing(layer)
        _colour(layer, change.colours)
        materials = Packages(path.parent, finals, "materials")
        for (name, part), look in change.looks.items():
            group = _room(layer, name).nameParent.name
            within = group if group.startswith(STOREY) else ""
            named = NamedRoom(0, name, change.shells[name], (), (), (), within)
            wear_look(layer, named, part, look, materials, change.seed)
        moved = [piece for piece in change.pieces if piece.now != piece.was]
        if moved:
            forget_design(layer, {path.name for piece in moved for path in _rooms_of(piece)})
        layer.Save()
        return layer

    return rewrite(source, target, edit, made, deed, accept)


def _colour(layer: Sdf.Layer, colours: Mapping[str, str]) -> None:
    """Bind colourways to things, also colourways that the house did not offer."""
    due = [group for room in room_specs(layer) for group in room.nameChildren] if colours else []
    while due:
        prim = due.pop()
        due += prim.nameChildren
        noted = prim.attributes.get(NODE_ID)
        if noted and noted.default in colours:
            prim.variantSelections[COLOUR] = colours[noted.default]


def _rooms_of(piece: PieceChange) -> Iterator[Sdf.Path]:
    """Paths above a piece's, its room's among them."""
    yield from Sdf.Path(piece.path).GetAncestorsRange()
    if piece.room_name:
        yield Sdf.Path(f"/House/Rooms/{piece.room_name}")


def _room(layer: Sdf.Layer, name: str) -> Sdf.PrimSpec:
    spec = room_spec(layer, name)
    if spec is None:
        raise StageError(f"{name} is not in this layer", expected="the stage as it was written")
    return spec


def _change(layer: Sdf.Layer, piece: PieceChange, source: Path) -> None:
    prim = layer.GetPrimAtPath(piece.path)
    if not prim:
        raise StageError(
            f"{piece.path} is not in this layer", where=str(source),
            expected="the stage as chord-usd wrote it, not one that refers to it",
        )  # fmt: skip
    if piece.now is None:
        del prim.nameParent.nameChildren[prim.name]
        return
    if piece.room_name:
        prim = _brought(layer, prim, piece.room_name)
    if piece.now != piece.was:
        _place_anew(prim, piece.was, piece.now, source)
    if piece.locked is not None:
        if LOCKED in prim.attributes:
            del prim.properties[prim.attributes[LOCKED].name]
        if piece.locked:
            attribute(prim, LOCKED, Types.Bool, True, custom=True)


def _place_anew(prim: Sdf.PrimSpec, was: Box, now: Box, source: Path) -> None:
    """Move a prim as its box was moved: its origin need not be the middle of its meshes."""
    if _AT not in prim.attributes or _TURNED not in prim.attributes:
        raise StageError(
            f"{prim.path} is not placed as chord-usd places things", where=str(source),
            expected=f"{_AT} and {_TURNED}",
        )  # fmt: skip
    at_m = prim.attributes[_AT].default
    x, y = to_world(now, to_own(was, [at_m[0], at_m[1]]))
    rise_m = now.center_m[2] - was.center_m[2]
    prim.attributes[_AT].default = Gf.Vec3d(float(x), float(y), at_m[2] + rise_m)
    turned = prim.attributes[_TURNED].default + wrap_deg(now.yaw_deg - was.yaw_deg)
    prim.attributes[_TURNED].default = wrap_deg(float(turned))


def _brought(layer: Sdf.Layer, prim: Sdf.PrimSpec, room_name: str) -> Sdf.PrimSpec:
    """The prim in the same group of another room, under a name that is free there."""
    group = _room(layer, room_name).nameChildren.get(prim.nameParent.name)
    if not group:
        raise StageError(f"{room_name} has no {prim.nameParent.name} to bring {prim.name} to")
    name, number = prim.name, 0
    while name in group.nameChildren:  # houses of earlier versions number by room
        name, number = f"{prim.name.rsplit('_', 1)[0]}_{number}", number + 1
    path, old = group.path.AppendChild(name), prim.path
    Sdf.CopySpec(layer, old, layer, path)
    del prim.nameParent.nameChildren[prim.name]
    _rename_notes(layer, path, str(old), str(path))
    _follow(layer, room_name, old, path)
    return layer.GetPrimAtPath(path)


def _rename_notes(layer: Sdf.Layer, path: Sdf.Path, old: str, new: str) -> None:
    """Let what prims note of their own place say the new one."""

    def visit(at: Sdf.Path) -> None:
        spec = layer.GetObjectAtPath(at)
        value = spec.default if isinstance(spec, Sdf.AttributeSpec) else None
        if isinstance(value, str) and value.startswith(old):
            spec.default = new + value[len(old) :]

    layer.Traverse(path, visit)


def _follow(layer: Sdf.Layer, room_name: str, old: Sdf.Path, new: Sdf.Path) -> None:
    """Let joints hold a thing that was brought to another room; they go where the thing goes that
    they tie, under its name."""
    ends = "physics:body0", "physics:body1"
    for room in room_specs(layer):
        joints = room.nameChildren.get(JOINTS)
        for joint in list(joints.nameChildren) if joints else ():
            targets = [joint.relationships[end].targetPathList for end in ends]
            is_tied = old in targets[1].prependedItems
            for target in targets:
                held = [path.ReplacePrefix(old, new) for path in target.prependedItems]
                target.prependedItems = held
            if is_tied:
                there = _room(layer, room_name).path.AppendChild(JOINTS)
                if not layer.GetPrimAtPath(there):
                    define(layer, there, "Scope")
                Sdf.CopySpec(layer, joint.path, layer, there.AppendChild(joint_name(new.name)))
                del joints.nameChildren[joint.name]


def _collect_dressing(layer: Sdf.Layer) -> None:
    """The collection of dressing, where a house has its first."""
    house = layer.GetPrimAtPath("/House")
    rooms = room_specs(layer)
    groups = [room.path.AppendChild(DRESSING) for room in rooms if DRESSING in room.nameChildren]
    if groups and "collection:dressing:includes" not in house.relationships:
        apply_schema(house, "CollectionAPI:dressing")
        relate(house, "collection:dressing:includes", groups)
