"""What of a written house stands open or shines, as opinions of its own layer.

A leaf turns or slides along its joint, so that simulators begin where it stands; a piece of
furniture that opens is one whose joints are selected. A lamp keeps its brightness at all times of
day.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from pxr import Gf, Sdf, Usd, UsdPhysics

from chord_usd.base.runtime.house_history import Deed
from chord_usd.base.runtime.stages import open_layer, room_prims
from chord_usd.base.scene.articulation import ARTICULATION, JOINTED
from chord_usd.base.scene.states import OPENED, USUAL
from chord_usd.base.scene.types import FloatArray, Provenance
from chord_usd.line.stage.author.lighting import LIGHT_ROOTS, light_name, variants_of
from chord_usd.line.stage.author.prims import Types, attribute, note, set_op_order
from chord_usd.line.stage.check.check_openables import openables
from chord_usd.line.stage.check.check_rules import NODE_ID
from chord_usd.line.stage.check.check_scene import CATEGORY, read_storeys
from chord_usd.line.stage.edit.refurnish import give_light, rewrite
from chord_usd.line.stage.read.leaf_states import STATE

_INTENSITY, _AT = "inputs:intensity", "xformOp:translate"
_ROOMS = "chord:rooms"


@dataclass(frozen=True, eq=False)
class ThingThere:
    """What has a state on a stage."""

    path: Sdf.Path
    names: frozenset[str]
    """Of prims, in small letters: of what it is a part of."""
    category: str
    """door, window, that of the piece or of the lamp; "" for the area light of a room."""
    rooms: tuple[str, ...]
    """Names of the prims of the rooms that it is in or between."""


@dataclass(frozen=True, eq=False)
class LeafThere(ThingThere):
    """A leaf of a door, window or piece of furniture."""

    piece: Sdf.Path | None
    """Of the piece of furniture."""
    turns: bool
    axis: int
    opens: float
    """Signed range, degrees or metres; 0 is shut."""
    shut_m: FloatArray
    """(3,) its origin while it is shut."""


@dataclass(frozen=True, eq=False)
class LightThere(ThingThere):
    """A light of a room."""


def things_there(stage: Usd.Stage) -> list[ThingThere]:
    """All leaves and lights of a house. Pieces that open are jointed in the session layer."""
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for room in room_prims(stage):
            for prim in list(_openable(room)):
                prim.GetVariantSet(ARTICULATION).SetVariantSelection(JOINTED)
    called = {str(room.GetAttribute(NODE_ID).Get()): room.GetName() for room in room_prims(stage)}
    result: list[ThingThere] = []
    for room in room_prims(stage):
        for prim in Usd.PrimRange(room):
            if prim.IsA(UsdPhysics.RevoluteJoint) or prim.IsA(UsdPhysics.PrismaticJoint):
                result.append(_leaf(prim, room, called))
        result += _lights(room)
    return result


def give_states(
    source: Path,
    target: Path,
    stage: Usd.Stage,
    states: Sequence[tuple[ThingThere, str]],
    said: str,
) -> None:
    """Write a house to target, which may be source, with leaves and lights in these states, in
    this order. stage: the house at source, as things_there left it. said: the words for these
    states. Raises as rewrite does."""
    furniture = any(isinstance(entry, LeafThere) and entry.piece for entry, _ in states)
    free = free_shares(stage) if furniture else {}

    def edit(path: Path, _: Sequence[Path]) -> Sdf.Layer:
        layer = open_layer(path)
        for entry, state in states:
            if isinstance(entry, LeafThere):
                _set_leaf(layer, entry, state, free.get(entry.path, 1.0))
            elif isinstance(entry, LightThere):
                _set_light(layer, entry, state)
        layer.Save()
        return layer

    rewrite(source, target, edit, Provenance(), Deed("state", said))


def free_shares(stage: Usd.Stage) -> dict[Sdf.Path, float]:
    """How far each leaf of furniture opens before something stops it, as a share of its range."""
    every = (each for scene in read_storeys(stage) for each in openables(stage, scene))
    return {Sdf.Path(each.path): each.free_share for each in every}


def _set_leaf(layer: Sdf.Layer, leaf: LeafThere, state: str, free_share: float = 1.0) -> None:
    """Say in a layer how far a leaf stands open; it stops at free_share of its range."""
    if state == USUAL and not layer.GetPrimAtPath(leaf.path):
        return
    spec = Sdf.CreatePrimInLayer(layer, leaf.path)
    share = min(OPENED.get(state, 0.0), free_share)
    turn_op = f"xformOp:rotate{'XYZ'[leaf.axis]}"
    for name in (STATE, turn_op, _AT, "xformOpOrder"):
        if name in spec.attributes:
            del spec.properties[spec.attributes[name].name]
    if leaf.piece is not None:
        selected = layer.GetPrimAtPath(leaf.piece).variantSelections
        if share or selected.get(ARTICULATION) == JOINTED:
            selected[ARTICULATION] = JOINTED
    if state == USUAL:
        return
    note(spec, state=state)
    if leaf.turns:
        attribute(spec, turn_op, Types.Double, round(leaf.opens * share, 4))
        if leaf.piece is not None:  # which has no turn while it is shut
            set_op_order(spec, [_AT, turn_op])
    else:
        at_m = leaf.shut_m.copy()
        at_m[leaf.axis] += leaf.opens * share
        attribute(spec, _AT, Types.Double3, Gf.Vec3d(*at_m.round(6).tolist()))


def _set_light(layer: Sdf.Layer, light: LightThere, state: str) -> None:
    """Say in a layer whether a light is on, whatever time of day is selected."""
    spec = Sdf.CreatePrimInLayer(layer, light.path)
    for name in (STATE, _INTENSITY):
        if name in spec.attributes:
            del spec.properties[spec.attributes[name].name]
    if state == USUAL:
        return
    brightest = max(_intensities(layer, light.path), default=1.0)
    give_light(spec, state, brightest)


def _openable(room: Usd.Prim) -> Iterator[Usd.Prim]:
    for prim in Usd.PrimRange(room):
        if prim.HasAttribute(NODE_ID) and prim.GetVariantSets().HasVariantSet(ARTICULATION):
            yield prim


def _leaf(joint: Usd.Prim, room: Usd.Prim, called: Mapping[str, str]) -> LeafThere:
    target = UsdPhysics.Joint(joint).GetBody1Rel().GetTargets()[0]
    owner = joint.GetParent()
    piece = None
    rooms: Iterable[str] = (room.GetName(),)
    if not owner.HasAttribute(_ROOMS):  # furniture: joints lie in a scope
        owner = owner.GetParent()
        piece = owner.GetPath()
    else:
        rooms = (called.get(entry, entry) for entry in owner.GetAttribute(_ROOMS).Get())
    turns = joint.IsA(UsdPhysics.RevoluteJoint)
    read = UsdPhysics.RevoluteJoint(joint) if turns else UsdPhysics.PrismaticJoint(joint)
    limits = (read.GetLowerLimitAttr().Get(), read.GetUpperLimitAttr().Get())
    shut_m = np.array(read.GetLocalPos0Attr().Get(), dtype=np.float64)
    return LeafThere(
        target, _names(owner.GetPath(), room), str(owner.GetAttribute(CATEGORY).Get()),
        tuple(rooms), piece, turns, "XYZ".index(str(read.GetAxisAttr().Get())),
        float(max(limits, key=abs)), shut_m,
    )  # fmt: skip


def _lights(room: Usd.Prim) -> Iterator[LightThere]:
    lamps = {}
    for group in LIGHT_ROOTS:
        below = room.GetChild(group)
        for prim in Usd.PrimRange(below) if below else ():
            if prim.HasAttribute(NODE_ID):
                steps = str(prim.GetPath().MakeRelativePath(below.GetPath())).split("/")
                lamps["_".join(step for step in steps if step != "Items")] = prim
    scope = room.GetChild("Lights")
    for light in scope.GetChildren() if scope else ():
        name = light.GetName().removesuffix(light_name("", room.GetName()))
        lamp = lamps.get(name)
        names = {name.lower(), light.GetName().lower()} | (
            _names(lamp.GetPath(), room) if lamp else set()
        )
        category = str(lamp.GetAttribute(CATEGORY).Get()) if lamp else ""
        yield LightThere(light.GetPath(), frozenset(names), category, (room.GetName(),))


def _names(path: Sdf.Path, room: Usd.Prim) -> frozenset[str]:
    steps = str(path.MakeRelativePath(room.GetPath())).lower().split("/")
    return frozenset(steps[1:])


def _intensities(layer: Sdf.Layer, path: Sdf.Path) -> Iterator[float]:
    """How bright a light is at each time of day."""
    house = layer.GetPrimAtPath(path.GetPrefixes()[0])
    for variant in variants_of(house).values():
        spec = layer.GetAttributeAtPath(
            path.ReplacePrefix(house.path, variant.path).AppendProperty(_INTENSITY)
        )
        if spec is not None:
            yield float(spec.default)
