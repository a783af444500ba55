"""One fault each: what was moved in a sound house, where, and why that is wrong.

Half of the kinds break a rule that this package names; for the others no rule is asked, so that a
judge cannot pass by having been written beside the faults.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely import Point, Polygon

from chord_usd.base.metrics.fronts import SWINGS_M
from chord_usd.base.scene.geometry import footprint_polygon, front_direction, room_polygon
from chord_usd.base.scene.types import Box, Item, SceneGraph

Edit = tuple[Item, Box, str]
"""A piece, its box after the edit, and the other thing that the fault is about."""
Search = Callable[[SceneGraph, np.random.Generator], Iterator[Edit]]

_TALL_M = 1.6
_BACK_M = 0.01
"""A picture hangs so far from its wall."""
_FREE_M = 0.05
_CORD_M = 1.5
_STRAY_M = 0.6
_PANE_M = 0.6
"""A curtain so far from every window hangs before a wall."""


@dataclass(frozen=True)
class FaultKind:
    """A kind of fault."""

    name: str
    is_named: bool
    """Whether a rule of this package names it."""
    why: str
    source: str
    search: Search


def moved(
    box: Box, x: float, y: float, yaw_deg: float | None = None, z: float | None = None
) -> Box:
    """The box at another place."""
    turn = box.yaw_deg if yaw_deg is None else (yaw_deg + 180.0) % 360.0 - 180.0
    return replace(box, center_m=(x, y, box.center_m[2] if z is None else z), yaw_deg=turn)


def _of(graph: SceneGraph, rng: np.random.Generator, *names: str) -> list[Item]:
    """Pieces and dressing of these categories, in an order of chance."""
    held = [item for item in (*graph.items, *graph.dressing) if item.category in names]
    return [held[at] for at in rng.permutation(len(held))]


def _others(graph: SceneGraph, item: Item) -> list[Polygon]:
    return [footprint_polygon(other.box) for other in graph.items if other.id != item.id]


def _spots(
    graph: SceneGraph, item: Item, rng: np.random.Generator, wall_m: float
) -> Iterator[tuple[float, float]]:
    """Places in its room where a piece is so far from walls and touches no other."""
    floor = room_polygon(graph.plan.room(item.room_id))
    if not isinstance(floor, Polygon) or (inner := floor.buffer(-wall_m)).is_empty:
        return
    low_x, low_y, high_x, high_y = inner.bounds
    others = _others(graph, item)
    for _ in range(60):
        x, y = float(rng.uniform(low_x, high_x)), float(rng.uniform(low_y, high_y))
        shape = footprint_polygon(moved(item.box, x, y))
        apart = all(shape.distance(other) > _FREE_M for other in others)
        if apart and inner.contains(Point(x, y)) and floor.contains(shape):
            yield x, y


# --- kinds that rules name -------------------------------------------------------------------


def _into_a_piece(graph: SceneGraph, rng: np.random.Generator) -> Iterator[Edit]:
    for item in _of(graph, rng, "bedside_table", "single_sofa", "shoe_cabinet", "tv_cabinet"):
        for other in graph.items:
            if other.id != item.id and other.room_id == item.room_id:
                x, y, _ = other.box.center_m
                yield item, moved(item.box, x, y), other.id


def _before_a_door(graph: SceneGraph, rng: np.random.Generator) -> Iterator[Edit]:
    for item in _of(graph, rng, "cabinet", "single_sofa", "coffee_table", "dining_table"):
        floor = room_polygon(graph.plan.room(item.room_id))
        for hole in graph.openings:
            if hole.kind != "window" and item.room_id in hole.room_ids:
                x, y, _ = hole.box.center_m
                inward = front_direction(hole.box.yaw_deg)
                for side in (1.0, -1.0):
                    step = 0.15 + hole.box.size_m[1] / 2 + item.box.size_m[1] / 2
                    to = (x + side * inward[0] * step, y + side * inward[1] * step)
                    if floor.contains(Point(to)):
                        yield item, moved(item.box, *to, yaw_deg=hole.box.yaw_deg), hole.id


def _turned(*names: str) -> Search:
    def search(graph: SceneGraph, rng: np.random.Generator) -> Iterator[Edit]:
        for item in _of(graph, rng, *names):
            x, y, _ = item.box.center_m
            yield item, moved(item.box, x, y, item.box.yaw_deg + 180.0), ""

    return search


def _far_table(graph: SceneGraph, rng: np.random.Generator) -> Iterator[Edit]:
    for item in _of(graph, rng, "coffee_table"):
        sofas = [o for o in graph.items if o.category == "sofa" and o.room_id == item.room_id]
        for x, y in _spots(graph, item, rng, 0.3):
            shape = footprint_polygon(moved(item.box, x, y))
            if sofas and all(shape.distance(footprint_polygon(s.box)) > 1.0 for s in sofas):
                yield item, moved(item.box, x, y), sofas[0].id


def _through_a_wall(graph: SceneGraph, rng: np.random.Generator) -> Iterator[Edit]:
    for item in _of(graph, rng, "bed", "sofa", "cabinet", "dining_table", "toilet"):
        back = -front_direction(item.box.yaw_deg)
        x, y, _ = item.box.center_m
        reach = item.box.size_m[1] / 3
        yield item, moved(item.box, x + back[0] * reach, y + back[1] * reach), item.room_id


# --- kinds that no rule names ----------------------------------------------------------------


def _hidden_picture(graph: SceneGraph, rng: np.random.Generator) -> Iterator[Edit]:
    for item in _of(graph, rng, "picture", "mirror", "clock"):
        for tall in graph.items:
            if tall.room_id != item.room_id or tall.box.size_m[2] < _TALL_M:
                continue
            if tall.box.size_m[0] < item.box.size_m[0] or tall.category not in SWINGS_M:
                continue
            back = -front_direction(tall.box.yaw_deg)
            x, y, _ = tall.box.center_m
            reach = tall.box.size_m[1] / 2 - item.box.size_m[1] / 2 - _BACK_M
            to = (x + back[0] * reach, y + back[1] * reach)
            yield item, moved(item.box, *to, yaw_deg=tall.box.yaw_deg), tall.id


def _knee_high(graph: SceneGraph, rng: np.random.Generator) -> Iterator[Edit]:
    shapes = [footprint_polygon(item.box).buffer(0.1) for item in graph.items]
    for item in _of(graph, rng, "picture", "clock"):
        x, y, _ = item.box.center_m
        if not any(shape.intersects(footprint_polygon(item.box)) for shape in shapes):
            low = max(0.1, 0.45 - item.box.size_m[2] / 2)
            yield item, moved(item.box, x, y, z=low), ""


def _cord_across(graph: SceneGraph, rng: np.random.Generator) -> Iterator[Edit]:
    for item in _of(graph, rng, "floor_lamp"):
        for x, y in _spots(graph, item, rng, _CORD_M):
            yield item, moved(item.box, x, y), item.room_id


def _stray_rug(graph: SceneGraph, rng: np.random.Generator) -> Iterator[Edit]:
    for item in _of(graph, rng, "rug"):
        floor = room_polygon(graph.plan.room(item.room_id))
        low_x, low_y, high_x, high_y = floor.bounds
        others = _others(graph, item)
        for _ in range(60):
            x, y = float(rng.uniform(low_x, high_x)), float(rng.uniform(low_y, high_y))
            shape = footprint_polygon(moved(item.box, x, y))
            if floor.contains(shape) and all(shape.distance(other) > 0.0 for other in others):
                yield item, moved(item.box, x, y), item.room_id


def _bare_curtain(graph: SceneGraph, rng: np.random.Generator) -> Iterator[Edit]:
    panes = [footprint_polygon(o.box) for o in graph.openings]
    for item in _of(graph, rng, "curtain"):
        floor = room_polygon(graph.plan.room(item.room_id))
        along = front_direction(item.box.yaw_deg + 90.0)
        x, y, _ = item.box.center_m
        for step in (-2.5, -2.0, 2.0, 2.5):
            to = (x + along[0] * step, y + along[1] * step)
            shape = footprint_polygon(moved(item.box, *to))
            if floor.contains(shape) and all(shape.distance(pane) > _PANE_M for pane in panes):
                yield item, moved(item.box, *to), item.room_id


KINDS: Sequence[FaultKind] = (
    FaultKind("a piece in another", True, "two pieces take one place", "SceneEval", _into_a_piece),
    FaultKind("a piece before a door", True, "the door cannot be used", "SceneEval",
              _before_a_door),
    FaultKind("a chair turned away", True, "one sits with the back to the table",
              "planning guides", _turned("chair")),
    FaultKind("a front at the wall", True, "doors open against the wall", "planning guides",
              _turned("cabinet", "toilet", "refrigerator")),
    FaultKind("a coffee table out of reach", True, "farther than an arm from the sofa",
              "planning guides", _far_table),
    FaultKind("a piece in a wall", True, "it reaches beyond its room", "PhyScene", _through_a_wall),
    FaultKind("a picture behind a wardrobe", False, "nobody sees it behind a tall piece",
              "museums hang for a clear view, middle at 145 to 155 cm", _hidden_picture),
    FaultKind("a picture at the knee", False, "its middle is 45 cm above the floor",
              "museums hang the middle at 145 to 155 cm", _knee_high),
    FaultKind("a cord across the floor", False, "a floor lamp 1.5 m from every wall: people trip "
              "over its cord", "NEC 210.52 has sockets in walls, none in floors", _cord_across),
    FaultKind("a rug under nothing", False, "it lies under no piece: it slips and groups nothing",
              "planning guides: front legs stand on it", _stray_rug),
    FaultKind("a curtain without a window", False, "it hangs before a wall", "common sense",
              _bare_curtain),
    FaultKind("drawers towards the wall", False, "drawers of a low piece cannot be pulled",
              "common sense", _turned("bedside_table", "dining_cabinet")),
)  # fmt: skip
