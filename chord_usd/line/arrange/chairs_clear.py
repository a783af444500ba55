"""Chairs at their tables: drawn out until nothing of them runs into the table, or left out.

A layout tells how far a chair is pushed under a table, seen from above; whether its back passes
over the top and its legs stand between the table's is told by the meshes alone. So a chair that
runs into its table moves, by the least that sets it free, mostly away from where it faces. It never
moves into something else, out of its room or before a door. Colliders count as meshes do: a
simulator would throw apart what they hold in each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from pxr import UsdGeom, UsdPhysics
from shapely import Polygon

from chord_usd.base.metrics.overlap import natural_partners
from chord_usd.base.places.free_places import FreePlaces, places_near
from chord_usd.base.runtime.asset_stages import open_asset
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.types import Asset, Box, Item, SceneGraph
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.stage.check.check_contact import Body, Solid, collisions
from chord_usd.line.stage.check.check_scene import solids_of
from chord_usd.line.stage.check.triangles import Triangles

SEAT = "chair"
FARTHEST_M = 0.5
"""A chair is about as deep; drawn out this far it stands before its table."""

_STEP_M = 0.02

_TABLES = natural_partners(SEAT)
_WAYS = np.array([(0.0, 1.0), (-1.0, 0.0), (1.0, 0.0), (0.0, -1.0)])
"""In the chair's own frame: back, left, right, and forward for one that has its back to its table.
Ties go to the first."""


@dataclass(frozen=True, eq=False)
class Table:
    """A table, for as long as chairs are tried at it."""

    item: Item

    @cached_property
    def shape(self) -> Polygon:
        """Its footprint."""
        return footprint_polygon(self.item.box)

    @cached_property
    def bodies(self) -> tuple[Body, Body]:
        """As it is seen, and as it is felt."""
        return _bodies(self.item)

    def is_near(self, chair: Item) -> bool:
        """Whether a chair could come to stand under it."""
        return bool(self.shape.distance(footprint_polygon(chair.box)) < FARTHEST_M)


def draw_out_chairs(work: Arrangement) -> SceneGraph:
    """The house with every chair clear of its table, and without those that have no room for that.

    Items whose mesh is not there stay. Raises StageError for one that cannot be opened.
    """
    graph = work.graph
    caught = []
    tables = tables_of(graph.items)
    for chair in graph.items:
        if chair.category == SEAT and work.may_move(chair) and has_mesh(chair):
            near = [table for table in tables if table.is_near(chair)]
            if runs_into(chair.box, chair, near):
                caught.append((chair, near))
    items = {item.id: item for item in graph.items}
    for chair, near in caught:
        free = work.free_places(chair, items.values())
        clear = _drawn_out(chair, near, free)
        if clear is None:
            del items[chair.id]
        else:
            items[chair.id] = clear
    return replace(graph, items=tuple(items.values()))


def tables_of(items: Sequence[Item]) -> list[Table]:
    """The tables among them that have a mesh."""
    return [Table(one) for one in items if one.category in _TABLES and has_mesh(one)]


def has_mesh(item: Item) -> bool:
    """Whether the item's mesh is there."""
    return item.asset is not None and item.asset.usd_path.is_file()


def _drawn_out(chair: Item, tables: Sequence[Table], free: FreePlaces) -> Item | None:
    """The chair at the nearest free place, if there is one."""
    for box in places_near(chair.box, _WAYS, _STEP_M, FARTHEST_M):
        if free.has(box) and not runs_into(box, chair, tables):
            return replace(chair, box=box)
    return None


def runs_into(box: Box, chair: Item, tables: Sequence[Table]) -> bool:
    """Whether a chair in this box collides with one of the tables: mesh with mesh, or collider with
    collider."""
    shape = footprint_polygon(box)
    over = [table for table in tables if table.shape.intersects(shape)]
    if not over:
        return False
    seats = _bodies(replace(chair, box=box))
    return any(
        collisions([seat], [body])
        for table in over
        for seat, body in zip(seats, table.bodies, strict=True)
    )


def _bodies(item: Item) -> tuple[Body, Body]:
    """An item as it is seen and as it is felt, in the world, without what stands on it."""
    assert item.asset is not None
    seen, felt = _solids(item.asset.usd_path)
    return _body(item, item.asset, seen), _body(item, item.asset, felt)


def _body(item: Item, asset: Asset, own: Sequence[Solid]) -> Body:
    """Solids in the frame of an item's asset, brought to where the item stands."""
    scale = np.diag(np.array(item.box.size_m) / np.array(asset.size_m))
    turn = np.eye(3)
    turn[:2, :2] = rotation_2d(item.box.yaw_deg)
    solids = tuple(solid.placed(scale @ turn.T, np.array(item.box.center_m)) for solid in own)
    return Body(item.id, solids)


@lru_cache(maxsize=64)
def _solids(path: Path) -> tuple[tuple[Solid, ...], tuple[Solid, ...]]:
    """The meshes of an asset, and the boxes that it is felt as, in its own frame."""
    stage, transforms = open_asset(path), UsdGeom.XformCache()
    felt = tuple(
        Solid(
            str(prim.GetPath()),
            Triangles.box(
                UsdGeom.Cube(prim).GetSizeAttr().Get(),
                np.array(transforms.GetLocalToWorldTransform(prim)).T,
            ),
        )
        for prim in stage.Traverse()
        if prim.IsA(UsdGeom.Cube) and prim.HasAPI(UsdPhysics.CollisionAPI)
    )
    return solids_of(stage.GetDefaultPrim(), transforms), felt
