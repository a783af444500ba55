"""Chairs as they stand at tables: they face them, and the chairs of a table are a set.

Where tables are, the model paints chairs with torn edges and marks. Without a mark a chair says
nothing of its front, being about square and off the walls; and by their edges alone no two chairs
of a table would be of one size, and so of one design.
"""

from __future__ import annotations

import zlib
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import shapely
from pxr import UsdGeom, UsdPhysics
from shapely import Polygon

from chord_usd.base.metrics.clear_floor import border_sides, floor_across, shut_borders
from chord_usd.base.metrics.overlap import natural_partners, overlaps_by_nature
from chord_usd.base.metrics.walk import WALKER_RADIUS_M
from chord_usd.base.places.free_places import FreePlaces, places_near
from chord_usd.base.runtime.asset_stages import open_asset
from chord_usd.base.scene.geometry import (
    footprint_polygon,
    front_direction,
    resized,
    to_own,
    to_world,
)
from chord_usd.base.scene.palette import category, having
from chord_usd.base.scene.types import Asset, Box, FloatArray, Item, SceneGraph
from chord_usd.base.scene.units import rotation_2d, wrap_deg
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.stage.check.check_contact import Body, Solid, collisions
from chord_usd.line.stage.check.check_scene import solids_of
from chord_usd.line.stage.check.triangles import Triangles

_AT_TABLE_M = 0.4
"""A chair this close to a table is one of its."""


def seat_chairs(work: Arrangement) -> SceneGraph:
    """The graph with chairs that face their tables, in sets of one size; meshes are to be matched.

    A chair whose front was seen faces as it did, and so does one at no table.
    """
    faced = tuple(_facing(item, work.graph.items) for item in work.graph.items)
    return _even_sets(work.holding(replace(work.graph, items=faced)))


def _table_of(chair: Item, items: Sequence[Item]) -> Item | None:
    """The nearest table of the chair's room, if it is near."""
    shape = footprint_polygon(chair.box)
    near = [
        (gap_m, item.id, item)
        for item in items
        if item.category in _TABLES
        and item.room_id == chair.room_id
        and (gap_m := shape.distance(footprint_polygon(item.box))) < _AT_TABLE_M
    ]
    return min(near)[2] if near else None


def _facing(item: Item, items: Sequence[Item]) -> Item:
    """A chair without a mark turned by quarters to its table, its footprint where it was."""
    if item.category != SEAT or item.facts.front_from != "wall":
        return item
    table = _table_of(item, items)
    if table is None:
        return item
    way = _inward(table.box, item.box)
    turned = [_turned(item.box, quarters) for quarters in range(4)]
    box = max(turned, key=lambda box: float(front_direction(box.yaw_deg) @ way))
    return replace(item, box=box).with_facts(front_from="table")


def _inward(table: Box, chair: Box) -> FloatArray:
    """(2,) from the side of a table that a chair is at to the other one."""
    local = to_own(table, chair.center_m[:2])
    side = int(np.argmax(np.abs(local) - np.array(table.size_m[:2]) / 2))
    across = np.zeros(2)
    across[side] = -np.sign(local[side])
    return rotation_2d(table.yaw_deg) @ across


def _turned(box: Box, quarters: int) -> Box:
    """The same footprint, its front elsewhere."""
    length, depth, height = box.size_m
    if quarters % 2:
        length, depth = depth, length
    return Box(box.center_m, (length, depth, height), wrap_deg(box.yaw_deg + 90.0 * quarters))


def _even_sets(work: Arrangement) -> SceneGraph:
    """The graph with the chairs of each table in the middle one of their sizes, of usual ones.

    Their fronts stay where they were. A chair that would grow into something, or before a door,
    stays as it is.
    """
    items = {item.id: item for item in work.graph.items}
    for chairs in _sets(work.graph.items):
        length_m, depth_m = _usual_size_m(chairs)
        for chair in chairs:
            box = _sized(chair.box, length_m, depth_m)
            if work.free_places(chair, items.values()).has(box):
                items[chair.id] = replace(chair, box=box)
    return replace(work.graph, items=tuple(items.values()))


def _sets(items: Sequence[Item]) -> list[list[Item]]:
    """The chairs of each table, without undersized chairs."""
    row = category(SEAT)
    sets: defaultdict[str, list[Item]] = defaultdict(list)
    for item in items:
        if item.category == SEAT and not row.is_undersized(item.box.size_m):
            table = _table_of(item, items)
            if table is not None:
                sets[table.id].append(item)
    return list(sets.values())


def _sized(box: Box, length_m: float, depth_m: float) -> Box:
    """The box in another size, the middle of its front where it was."""
    return resized(box, (length_m, depth_m), (0.0, (depth_m - box.size_m[1]) / 2))


def _usual_size_m(chairs: Sequence[Item]) -> tuple[float, float]:
    row = category(SEAT)
    length_m, depth_m = np.median([chair.box.size_m[:2] for chair in chairs], axis=0)
    return float(np.clip(length_m, *row.length_m)), float(np.clip(depth_m, *row.width_m))


# Chairs at their tables: drawn out until nothing of them runs into the table, or left out --------

# A layout shows how far a chair is pushed under a table, seen from above; only the meshes show
# whether its back passes over the top and its legs stand between the table's. So a chair that
# runs into its table moves, by the least that sets it free, mostly away from where it faces. It
# never moves into something else, out of its room or before a door. Colliders count as meshes do: a
# simulator would throw apart what they hold in each other.

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
        """Its meshes, and its colliders."""
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
    return [Table(item) for item in items if item.category in _TABLES and has_mesh(item)]


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
    """Meshes and colliders of an item, in the world, without the things on it."""
    assert item.asset is not None
    seen, colliders = _solids(item.asset.usd_path)
    return _body(item, item.asset, seen), _body(item, item.asset, colliders)


def _body(item: Item, asset: Asset, local: Sequence[Solid]) -> Body:
    """Solids in the frame of an item's asset, brought to where the item stands."""
    scale = np.diag(np.array(item.box.size_m) / np.array(asset.size_m))
    turn = np.eye(3)
    turn[:2, :2] = rotation_2d(item.box.yaw_deg)
    solids = tuple(solid.placed(scale @ turn.T, np.array(item.box.center_m)) for solid in local)
    return Body(item.id, solids)


@lru_cache(maxsize=64)
def _solids(path: Path) -> tuple[tuple[Solid, ...], tuple[Solid, ...]]:
    """The meshes of an asset, and the boxes of its colliders, in its own frame."""
    stage, transforms = open_asset(path), UsdGeom.XformCache()
    colliders = tuple(
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
    return solids_of(stage.GetDefaultPrim(), transforms), colliders


# Chairs and armchairs as people leave them: a few degrees askew, a few centimetres drawn ---------

# Rows at exact angles give a picture away as computer-made. A piece turns only where that costs
# nothing: it stays in its room, clear of all others and of openings, and narrows no passage.

RULE = "left a little askew"
_TURN_DEG = (2.0, 6.0)
_MOST_BACK_M = 0.05
_TRIES = 6

_PASSAGE_M = 2 * WALKER_RADIUS_M
_SPARE_M = 0.1
"""A passage that is this much wider than a walker is passable however the floor is sampled."""


def leave_askew(work: Arrangement) -> SceneGraph:
    """The house with chairs and armchairs turned a little where there is room, each once.

    The same house gives the same turns. Raises StageError for a mesh that cannot be opened.
    """
    items = {item.id: item for item in work.graph.items}
    tables = tables_of(work.graph.items)
    across = [floor_across(side) for sides in border_sides(work.graph) for side in sides]
    borders = shapely.union_all(across)

    def shuts_border(box: Box, item: Item) -> bool:
        if not borders.intersects(footprint_polygon(box)):
            return False
        turned = {**items, item.id: replace(item, box=box)}
        return any(shut_borders(replace(work.graph, items=tuple(turned.values()))))

    for item in work.graph.items:
        if item.category not in (SEAT, *having("easy_chair")) or not work.may_move(item):
            continue
        if not has_mesh(item) or any(edit.rule == RULE for edit in item.facts.edits):
            continue
        near = [table for table in tables if item.category == SEAT and table.is_near(item)]
        free = work.free_places(item, items.values())
        around = _around(work, item, list(items.values()))
        for box in _askew(item):
            if (
                free.has(box)
                and _leaves_passages(item.box, box, around)
                and not runs_into(box, item, near)
                and not shuts_border(box, item)
            ):
                items[item.id] = replace(item, box=box)
                break
    return replace(work.graph, items=tuple(items.values()))


def _askew(item: Item) -> Iterator[Box]:
    """What to try, from the item's own random numbers."""
    x, y, _ = item.box.center_m
    rng = np.random.default_rng(zlib.crc32(f"{item.id} {x:.3f} {y:.3f}".encode()))
    for _ in range(_TRIES):
        turn = rng.uniform(*_TURN_DEG) * rng.choice([-1.0, 1.0])
        back = rng.uniform(0.0, _MOST_BACK_M) if item.category == SEAT else 0.0
        x_m, y_m = to_world(item.box, (0.0, back))
        center = (round(float(x_m), 6), round(float(y_m), 6), item.box.center_m[2])
        yaw_deg = wrap_deg(round(item.box.yaw_deg + float(turn), 3))
        yield replace(item.box, center_m=center, yaw_deg=yaw_deg)


def _around(work: Arrangement, item: Item, items: Sequence[Item]) -> list[shapely.Geometry]:
    """What bounds the passages beside a piece."""
    floor = work.floors.get(item.room_id)
    corners = floor.exterior.coords if floor is not None else ()
    # A wall each: the distance to all of them is that to the nearest alone.
    walls = [shapely.LineString(ends) for ends in pairwise(corners)]
    others = [
        footprint_polygon(other.box)
        for other in items
        if other.room_id == item.room_id
        and other.id != item.id
        and not overlaps_by_nature(item, other)
    ]
    return [*walls, *others]


def _leaves_passages(before: Box, after: Box, around: Sequence[shapely.Geometry]) -> bool:
    old, new = footprint_polygon(before), footprint_polygon(after)
    for other in around:
        old_m, new_m = old.distance(other), new.distance(other)
        if new_m < old_m and old_m >= _PASSAGE_M and new_m < _PASSAGE_M + _SPARE_M:
            return False
    return True
