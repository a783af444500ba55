"""Leaves of doors, windows and furniture that somebody gave a state (edit.leaves_and_lamps)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pxr import Usd, UsdGeom, UsdPhysics
from shapely.geometry import MultiPoint
from shapely.geometry.base import BaseGeometry

from chord_usd.base.runtime.stages import room_prims
from chord_usd.base.scene.states import OPENED, PASSABLE

STATE = "chord:state"
"""Attribute of leaves and lights: the state that somebody gave them."""


def shut_leaves(stage: Usd.Stage) -> None:
    """Shut, in the session layer, what stands open by a state: boxes are measured so."""
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for leaf in stated_leaves(stage):
            for op in UsdGeom.Xformable(leaf).GetOrderedXformOps():
                if op.GetOpType() == UsdGeom.XformOp.TypeTranslate:
                    op.Set(op.GetAttr().GetPropertyStack()[-1].default)
                else:
                    op.Set(0.0)


def stated_leaves(stage: Usd.Stage) -> Iterator[Usd.Prim]:
    """The leaves that somebody gave a state."""
    for room in room_prims(stage):
        for prim in Usd.PrimRange(room):
            if prim.HasAttribute(STATE) and prim.HasAPI(UsdPhysics.RigidBodyAPI):
                yield prim


@dataclass(frozen=True, eq=False)
class StatedDoor:
    """A door or window that somebody gave a state."""

    state: str
    """Of the leaf that stands open widest."""
    shadows_m: tuple[BaseGeometry, ...]
    """Its leaves where they stand, seen from above."""

    @property
    def is_shut(self) -> bool:
        """Whether nobody passes."""
        return OPENED[self.state] < PASSABLE


def stated_doors(stage: Usd.Stage) -> dict[str, StatedDoor]:
    """Doors and windows that somebody gave a state, by their paths."""
    leaves: dict[str, list[Usd.Prim]] = {}
    for leaf in stated_leaves(stage):
        if "/Architecture/" in str(leaf.GetPath()):
            leaves.setdefault(str(leaf.GetPath().GetParentPath()), []).append(leaf)
    return {
        path: StatedDoor(
            max((str(leaf.GetAttribute(STATE).Get()) for leaf in hung), key=OPENED.__getitem__),
            tuple(map(_shadow, hung)),
        )
        for path, hung in leaves.items()
    }


def _shadow(leaf: Usd.Prim) -> BaseGeometry:
    cube = UsdGeom.Xformable(leaf.GetChild("Collider"))
    matrix = np.array(cube.ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
    corners = np.array([(x, y, z, 2.0) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    return MultiPoint((corners @ matrix)[:, :2]).convex_hull
