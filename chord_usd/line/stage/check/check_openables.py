"""What opens must open: leaves of furniture whose swept volume something stands in."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely
from pxr import Sdf, Usd, UsdGeom

from chord_usd.base.metrics.clear_floor import sides_of
from chord_usd.base.places.swept import OPENS, WALL, Boxes, Leaf, way_of
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.trim import boards, casings
from chord_usd.base.scene.types import Box, FloatArray, Item
from chord_usd.library.asset_shapes import Openable, openable
from chord_usd.line.stage.check.check_scene import StageScene

_HALF = 0.5
"""Share of its range from which a leaf is of use."""

_TRIM = -2
"""In place of the number of a piece."""

_WALL_M = 1e-3
"""A leaf flush with a wall passes it."""


@dataclass(frozen=True)
class Opens:
    """How far a leaf of a piece opens."""

    path: str
    """Of its body in the variant `jointed`."""
    free_share: float
    """Of its range, [0, 1]."""
    free: str
    """The same in words: centimetres or degrees of how many."""
    stopped_by: str = ""
    """Path of what stops it, "a wall", or "" where it opens wide."""

    @property
    def is_free(self) -> bool:
        """Whether it opens as far as a leaf has to."""
        return self.free_share >= OPENS

    @property
    def is_stuck(self) -> bool:
        """Whether it opens less than half: nothing is taken out or put in, the certificate does
        not hold."""
        return self.free_share < _HALF


@dataclass(frozen=True, eq=False)
class _Placed:
    """A piece on its stage."""

    item: Item
    box: Box
    """Where its origin is, and its direction."""
    factor: FloatArray
    asset: Openable | None

    @property
    def collider(self) -> Boxes:
        """Boxes of its colliders, in the world."""
        if self.asset is None:
            return Boxes.filling(self.item.box)
        return Boxes.of(self.asset.colliders_m * self.factor).placed(self.box)


def openables(stage: Usd.Stage, scene: StageScene) -> list[Opens]:
    """Every leaf of a storey's furniture, and how far it opens."""
    transforms = UsdGeom.XformCache()
    items = [item for whole in (*scene.graph.items, *scene.graph.dressing) for item in
             (whole, *whole.children)]  # fmt: skip
    placed = [_placed(stage, transforms, scene.elevation_m, item) for item in items]
    colliders = [each.collider for each in placed]
    owners = np.repeat(np.arange(len(colliders)), [len(each.middle) for each in colliders])
    trim = [
        Boxes.filling(box)
        for opening, room in sides_of(scene.graph.openings, scene.graph.rooms)
        for box in (*casings(opening, room), *boards(opening, room))
    ]
    solid = Boxes.joined([*colliders, *trim])
    owners = np.concatenate([owners, np.full(len(solid.middle) - len(owners), _TRIM)])
    floor = shapely.union_all([room_polygon(room) for room in scene.graph.rooms]).buffer(_WALL_M)
    shapely.prepare(floor)
    names = [each.item.id for each in placed]
    return [
        _opens(each, leaf, solid.kept(owners != number), owners[owners != number], names, floor)
        for number, each in enumerate(placed)
        if each.asset
        for leaf in each.asset.leaves
    ]


def _opens(
    each: _Placed, leaf: Leaf, solid: Boxes, owners: npt.NDArray[np.intp], names: Sequence[str],
    floor: shapely.Geometry,
) -> Opens:  # fmt: skip
    way = way_of(leaf.scaled(each.factor), each.box, solid, floor)
    stopped_by = ""
    if way.stopped_by is not None:
        owner = WALL if way.stopped_by == WALL else int(owners[way.stopped_by])
        stopped_by = "a wall" if owner == WALL else "a casing" if owner == _TRIM else names[owner]
    unit, scale = ("degrees", 1.0) if leaf.turns else ("cm", 100.0)
    whole = abs(leaf.opens) * scale
    words = f"{whole * way.share:.0f} of {whole:.0f} {unit}"
    return Opens(f"{each.item.id}/{leaf.name}", round(way.share, 3), words, stopped_by)


def _placed(
    stage: Usd.Stage, transforms: UsdGeom.XformCache, elevation_m: float, item: Item
) -> _Placed:
    prim = stage.GetPrimAtPath(item.id)
    matrix = np.array(transforms.GetLocalToWorldTransform(prim)).T
    factor = np.linalg.norm(matrix[:3, :3], axis=0)
    x, y, z = matrix[:3, 3].tolist()
    yaw_deg = float(np.degrees(np.arctan2(matrix[1, 0], matrix[0, 0])))
    box = Box((x, y, z - elevation_m), item.box.size_m, yaw_deg)
    return _Placed(item, box, factor, _asset_of(prim))


def _asset_of(prim: Usd.Prim) -> Openable | None:
    layers: Iterator[Sdf.Layer] = (spec.layer for spec in prim.GetPrimStack())
    names: Sequence[str] = list(dict.fromkeys(layer.identifier for layer in layers))
    return next((asset for name in names if (asset := openable(name)) is not None), None)
