"""What of an asset opens, and the boxes that it is felt as: read from its layers, not composed."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from pxr import Sdf

from chord_usd.base.places.swept import Boxes, Leaf
from chord_usd.base.runtime.stages import layer_beside
from chord_usd.base.scene.articulation import JOINTED_LAYER, JOINTS, PAYLOAD_LAYER
from chord_usd.base.scene.types import FloatArray, Item

_JOINTS = ("PhysicsRevoluteJoint", "PhysicsPrismaticJoint")


@dataclass(frozen=True, eq=False)
class Openable:
    """An asset in its frame, at its size."""

    leaves: tuple[Leaf, ...]
    felt_m: FloatArray
    """(N, 2, 3) boxes that it is felt as while all is shut."""


@lru_cache(maxsize=512)
def openable(interface: str) -> Openable | None:
    """What opens of an asset, by the identifier of its interface layer; None for assets of other
    makers, whose layers are not known."""
    payload, jointed = (layer_beside(interface, name) for name in (PAYLOAD_LAYER, JOINTED_LAYER))
    if payload is None:
        return None
    felt = [bounds for root in payload.rootPrims for bounds in _felt(payload, root)]
    leaves = () if jointed is None else tuple(
        leaf for root in jointed.rootPrims for leaf in _leaves(jointed, root)
    )  # fmt: skip
    return Openable(leaves, np.array(felt).reshape(-1, 2, 3))


def leaves_of(item: Item) -> list[Leaf]:
    """What opens of a piece, at its size; nothing without a mesh."""
    asset = item.asset
    if asset is None or not asset.usd_path.with_name(JOINTED_LAYER).is_file():
        return []
    known = openable(str(asset.usd_path))
    if known is None:
        return []
    factor = np.array(item.box.size_m) / np.array(asset.size_m)
    return [leaf.scaled(factor) for leaf in known.leaves]


def felt_boxes(item: Item) -> Boxes:
    """What a piece is felt as, in the world; its box without a mesh of this library."""
    asset = item.asset
    if asset is None or not asset.usd_path.with_name(PAYLOAD_LAYER).is_file():
        return Boxes.filling(item.box)
    known = openable(str(asset.usd_path))
    if known is None:
        return Boxes.filling(item.box)
    factor = np.array(item.box.size_m) / np.array(asset.size_m)
    return Boxes.of(known.felt_m * factor).placed(item.box)


def _leaves(layer: Sdf.Layer, root: Sdf.PrimSpec) -> Iterator[Leaf]:
    joints = layer.GetPrimAtPath(root.path.AppendChild(JOINTS))
    for joint in joints.nameChildren if joints else ():
        if joint.typeName not in _JOINTS:
            continue
        body = layer.GetPrimAtPath(root.path.AppendChild(joint.name))
        at = np.array(_value(joint, "physics:localPos0"), dtype=float)
        limits = _value(joint, "physics:lowerLimit"), _value(joint, "physics:upperLimit")
        boxes = np.array(list(_felt(layer, body))).reshape(-1, 2, 3) + at
        if len(boxes):
            yield Leaf(
                joint.name, joint.typeName == _JOINTS[0],
                "XYZ".index(_value(joint, "physics:axis")), at, float(max(limits, key=abs)), boxes,
            )  # fmt: skip


def _felt(layer: Sdf.Layer, root: Sdf.PrimSpec) -> Iterator[FloatArray]:
    """(2, 3) bounds of each collider below a prim, which is at the origin."""
    colliders = layer.GetPrimAtPath(root.path.AppendChild("Colliders"))
    for cube in colliders.nameChildren if colliders else ():
        half = np.array(_value(cube, "xformOp:scale")) * _value(cube, "size") / 2
        at = np.array(_value(cube, "xformOp:translate"), dtype=float)
        yield np.array([at - half, at + half])
    geometry = layer.GetPrimAtPath(root.path.AppendChild("Geometry"))
    for mesh in geometry.nameChildren if geometry else ():
        if "PhysicsCollisionAPI" in mesh.GetInfo("apiSchemas").GetAppliedItems():
            extent = _value(mesh, "extent")
            if extent is None:
                shape = layer.GetPrimAtPath(f"/Shapes/{mesh.name}")
                extent = _value(shape, "extent") if shape else None
            if extent is not None:
                yield np.array(extent, dtype=float)


def _value(prim: Sdf.PrimSpec, name: str) -> Any:
    attribute = prim.attributes.get(name)
    return attribute.default if attribute else None
