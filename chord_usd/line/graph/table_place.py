"""Items drawn for a top -> children that stand on the mesh of their piece.

An item keeps the place it was drawn at; it is moved a little only to bring it back over the
edge, off what stands out of the wall behind (a panel, a window board), or wholly onto or off a mat
over whose rim it would tip. What cannot stand there is left out. Its height comes
from the meshes: the highest point below its footprint, of the piece or of what lies underfoot.
"""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely
from shapely import Polygon

from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.raster.relief import Relief, Reliefs
from chord_usd.base.scene.geometry import footprint_polygon, in_world, to_own
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.types import Box, FloatArray, Item
from chord_usd.line.graph.match import Database, fitted_box, reading_order

ON_TOP = 0.995
"""Share of its footprint that must lie over the top; the rest is rounding of cells."""

_STEP_M, _STEPS = 0.01, 6
"""How an item is moved back over the edge."""

_FIRM_STEPS = 12
"""How far it may be moved to where it stands firm: half the depth of a laptop."""

_FIRM = 0.4
"""The middle of what stands on a mat is at least this share of its shorter side inside the rim: the
weight of a laptop with its lid up is near its back edge."""

_TOUCH_M = 0.002
"""Boxes that share no more height than this only touch."""


@dataclass(frozen=True, eq=False)
class Laid:
    """What became of the items drawn for a top."""

    children: tuple[Item, ...]
    """In the frame of the piece, standing."""
    seen: tuple[Item, ...]
    """All that was drawn, before anything was moved or left out; z is that of the top."""

    @property
    def left_out(self) -> int:
        """How many items found no place to stand."""
        return len(self.seen) - len(self.children)


def place_on(
    table: Item,
    relief: Relief,
    things: Sequence[Item],
    database: Database,
    reliefs: Reliefs,
    around: Sequence[Box] = (),
) -> Laid:
    """Stand what was drawn for a top on its piece.

    things: in the frame of the piece, without meshes. relief: of the piece's mesh at the size of
    the piece. around: boxes of the room that things on it could run into. Raises AssetError where
    the database has nothing of a category.
    """
    seen = [_matched(table, item, relief.level_m, database) for item in things]
    standing: list[Item] = []
    for item in sorted(seen, key=_order):
        moved = _back_over_edge(item, relief)
        if moved is None:
            continue
        placed = _stood_firm(moved, relief, standing, reliefs)
        if placed is not None and _runs_into(placed.box, table.box, around):
            placed = _stood_clear(moved, table.box, relief, standing, reliefs, around)
        if placed is not None:
            standing.append(placed)
    return Laid(_named(table, standing), tuple(seen))


def _order(item: Item) -> tuple[bool, float, str, tuple[float, float, float]]:
    """What lies underfoot first, then larger before smaller: these are surest."""
    row = category(item.category)
    area = item.box.size_m[0] * item.box.size_m[1]
    return row.mount is not Mount.UNDERFOOT, -round(area, 6), item.category, item.box.center_m


def _matched(table: Item, thing: Item, level_m: float, database: Database) -> Item:
    """The item with its mesh, in the mesh's own proportions, about the place it was drawn at."""
    asset = database.nearest(thing.category, thing.box.size_m)
    size_m = fitted_box(thing.box, asset, category(thing.category), is_guess=True).size_m
    x, y, _ = thing.box.center_m
    box = Box((x, y, level_m), size_m, thing.box.yaw_deg)
    return replace(thing, id="", box=box, room_id=table.room_id, asset=asset)


def _back_over_edge(item: Item, relief: Relief) -> Item | None:
    """The item where all of it lies over the top: there, or a few steps towards the middle."""
    best: tuple[float, Box] | None = None
    for ring in _rings(item.box):
        for box in ring:
            share = _share_over(relief, box)
            if best is None or share > best[0]:
                best = share, box
        if best and best[0] >= ON_TOP:
            return replace(item, box=best[1])
    return None


def _rings(box: Box, steps: int = _STEPS) -> Iterator[list[Box]]:
    """The box itself, then those a step away, two steps: towards the middle first."""
    x, y, z = box.center_m
    inward = -np.array([x, y]) / max(float(np.hypot(x, y)), 1e-9)
    ways: list[FloatArray] = [
        inward,
        *(np.array(way) for way in ((0, 1), (0, -1), (1, 0), (-1, 0))),
    ]
    yield [box]
    for step in range(1, steps + 1):
        moved = [np.array([x, y]) + step * _STEP_M * way for way in ways]
        yield [replace(box, center_m=(float(there[0]), float(there[1]), z)) for there in moved]


def _share_over(relief: Relief, box: Box) -> float:
    """Share of a box that lies over the top; none where something rises below it."""
    return relief.free_share(box) if relief.is_level(box) else 0.0


def _stood_firm(
    item: Item, relief: Relief, standing: Sequence[Item], reliefs: Reliefs
) -> Item | None:
    """The item on what is below it, a few steps away if it tips there; None if it cannot stand."""
    mats = [
        footprint_polygon(other.box)
        for other in standing
        if category(other.category).mount is Mount.UNDERFOOT
    ]
    if not _tips(item.box, mats):
        return _stood(item, relief, standing, reliefs)
    for box in itertools.chain.from_iterable(_rings(item.box, _FIRM_STEPS)):
        if not _tips(box, mats) and _share_over(relief, box) >= ON_TOP:
            placed = _stood(replace(item, box=box), relief, standing, reliefs)
            if placed is not None:
                return placed
    return None


def _stood_clear(
    item: Item,
    table: Box,
    relief: Relief,
    standing: Sequence[Item],
    reliefs: Reliefs,
    around: Sequence[Box],
) -> Item | None:
    """The item a few steps away, where it runs into nothing around the piece."""
    for box in itertools.chain.from_iterable(_rings(item.box)):
        if _runs_into(box, table, around) or _share_over(relief, box) < ON_TOP:
            continue
        placed = _stood_firm(replace(item, box=box), relief, standing, reliefs)
        if placed is not None and not _runs_into(placed.box, table, around):
            return placed
    return None


def _tips(box: Box, mats: Sequence[Polygon]) -> bool:
    """Whether a box stands on the rim of a mat, with its middle beside the mat or nearly so."""
    shape = footprint_polygon(box)
    middle = shape.centroid.buffer(_FIRM * min(box.size_m[:2]))
    return any(
        shapely.intersection(shape, mat).area > MIN_OVERLAP_M2 and not mat.contains(middle)
        for mat in mats
    )


def _stood(item: Item, relief: Relief, standing: Sequence[Item], reliefs: Reliefs) -> Item | None:
    """The item on what is below it; None where that is something nothing stands on."""
    shape = footprint_polygon(item.box)
    base_m = relief.highest_m(item.box)
    lies_under = category(item.category).mount is Mount.UNDERFOOT
    for other in standing:
        if shapely.intersection(shape, footprint_polygon(other.box)).area <= MIN_OVERLAP_M2:
            continue
        if lies_under or category(other.category).mount is not Mount.UNDERFOOT:
            return None
        base_m = max(base_m, _top_of(other, item.box, reliefs))
    x, y, _ = item.box.center_m
    return replace(item, box=replace(item.box, center_m=(x, y, base_m)))


def _top_of(carrier: Item, box: Box, reliefs: Reliefs) -> float:
    """The highest point of a carrier's mesh below a box; both in the frame of the piece."""
    if carrier.asset is None:
        return carrier.box.top_m
    relief = reliefs(carrier.asset).scaled(carrier.box.size_m)
    x, y = to_own(carrier.box, box.center_m[:2])
    local = Box((float(x), float(y), 0.0), box.size_m, box.yaw_deg - carrier.box.yaw_deg)
    return carrier.box.center_m[2] + relief.highest_m(local)


def _runs_into(box: Box, table: Box, around: Sequence[Box]) -> bool:
    """Whether a box in the frame of the piece shares space with a box of the room."""
    if not around:
        return False
    world = in_world(box, table)
    low, high = world.center_m[2], world.top_m
    shape = footprint_polygon(world)
    for other in around:
        overlaps = other.center_m[2] < high - _TOUCH_M and other.top_m > low + _TOUCH_M
        if overlaps and shape.intersects(footprint_polygon(other)):
            return True
    return False


def _named(table: Item, items: Sequence[Item]) -> tuple[Item, ...]:
    """Ids table/category_n, counted by category and position, as in rooms."""
    counts: dict[str, int] = defaultdict(int)
    named = []
    for item in sorted(items, key=lambda item: reading_order(item.category, item.box)):
        named.append(replace(item, id=f"{table.id}/{item.category}_{counts[item.category]}"))
        counts[item.category] += 1
    return tuple(named)
