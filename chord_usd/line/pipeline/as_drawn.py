"""What a plan shows of furniture and fixtures, on its way into the house."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import Any

from chord_usd.base.scene.drawn_pieces import KITCHEN, Placed, place
from chord_usd.base.scene.dwellings import is_common
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.palette import category, having
from chord_usd.base.scene.stair_cells import is_cell
from chord_usd.base.scene.types import Item, Opening, Plan, SceneGraph

_ALIKE = {
    "sink_cabinet": "washbasin", "washbasin": "sink_cabinet", "table": "dining_table",
    "dining_table": "table", "single_sofa": "leisure_sofa", "cabinet": "dining_cabinet",
}  # fmt: skip
"""What a drawing shows alike; the room tells which of the two it is."""
_DOUBLE = 0.3
"""Two pieces of a category that share so much of the smaller one are one."""
BUILT_M = 0.25
"""A piece is built where it is drawn if one of its category stands so near."""


def placed_pieces(plan: Plan) -> list[Placed]:
    """The pieces that a plan's drawing shows, each as it stands in its room, or why it does not."""
    from chord_usd.base.metrics.clear_floor import ClearFloors, clearances, is_high_enough
    from chord_usd.base.metrics.rooms import mixed_kind, stands_in

    clear = list(clearances(plan.rooms, plan.openings))
    mixed = mixed_kind([room.kind for room in plan.rooms])

    def named(item: Item, room_id: str) -> tuple[str, str]:
        room = plan.room(room_id)
        if is_cell(room) or is_common(room):
            return item.category, "in a part that stays empty"
        if item.category in having("kitchen_unit") and item.category not in KITCHEN:
            return item.category, "a part of the composed kitchen"
        for name in (item.category, _ALIKE.get(item.category, "")):
            if stands_in(name, room.kind, mixed):
                return name, ""
        return item.category, f"in a {room.kind}"

    def blocks(item: Item, opening: Opening) -> bool:
        length, width, _ = item.box.size_m
        lowest = replace(item.box, size_m=(length, width, category(item.category).height_m[0]))
        return is_high_enough(replace(item, box=lowest), opening)

    placed = place(plan, [(area, opening) for opening, area in clear], named, blocks)
    floors = ClearFloors(clear)
    return [
        piece if piece.item is None else replace(piece, item=floors.below_sill(piece.item))
        for piece in placed
    ]


def parted(placed: Iterable[Placed]) -> tuple[tuple[Item, ...], tuple[Item, ...]]:
    """What stays where it is drawn, and the units that kitchens are composed around."""
    items = [piece.item for piece in placed if piece.item is not None]
    return (
        tuple(item for item in items if item.category not in KITCHEN),
        tuple(item for item in items if item.category in KITCHEN),
    )


def hindering_left_out(placed: Iterable[Placed], locked: Iterable[Item]) -> list[Placed]:
    """Placed pieces with the reason for those that were to be locked, and are no longer."""
    kept = {item.id for item in locked}
    return [
        replace(piece, item=None, reason="the room cannot be furnished round it")
        if piece.item is not None
        and piece.item.category not in KITCHEN
        and piece.item.id not in kept
        else piece
        for piece in placed
    ]


def with_locked(house: SceneGraph, locked: Iterable[Item], *, aside: bool) -> SceneGraph:
    """The house with locked pieces of its rooms, in place of what stands for them.

    aside: whether other pieces of these rooms are moved out of them, or else left out.
    """
    rooms = {room.id for room in house.rooms}
    locked = [item for item in locked if item.room_id in rooms]
    rest = _without_doubles(house.items, locked)
    full = replace(house, items=(*locked, *rest))
    if not aside or not locked:
        return full
    from chord_usd.line.arrange.arrangement import Arrangement
    from chord_usd.line.arrange.rules import arrange

    crowded = {item.room_id for item in locked}
    loose = {item.id for item in rest if item.room_id in crowded}
    return arrange(Arrangement.of(full, movable=loose), "given")


def _without_doubles(items: Iterable[Item], locked: Sequence[Item]) -> list[Item]:
    """Items but those that stand for a locked piece: of its category, and mostly where it is."""
    ids = {item.id for item in locked}
    shapes = [(item.category, footprint_polygon(item.box)) for item in locked]

    def is_double(item: Item) -> bool:
        outline = footprint_polygon(item.box)
        return any(
            item.category == name
            and outline.intersection(shape).area > _DOUBLE * min(outline.area, shape.area)
            for name, shape in shapes
        )

    return [item for item in items if item.id not in ids and not is_double(item)]


def drawn_told(placed: Sequence[Placed], graph: SceneGraph | None = None) -> list[dict[str, Any]]:
    """For reports, each piece that is drawn: its category and box, whether it is built there, and
    else the reason. graph: the house; without it, whether it can be built there."""
    return [_told(piece, graph) for piece in placed]


def _told(piece: Placed, graph: SceneGraph | None) -> dict[str, Any]:
    is_built = piece.item is not None and (graph is None or _is_built(piece.item, graph))
    reason = piece.reason or ("" if is_built else "elsewhere")
    box = piece.drawn.box
    return {
        "category": (piece.item or piece.drawn).category,
        "box": [round(v, 3) for v in (*box.center_m[:2], *box.size_m[:2], box.yaw_deg)],
        "confidence": round(piece.drawn.score, 2),
        "kept": is_built,
        **({"reason": reason} if reason else {}),
    }


def _is_built(item: Item, graph: SceneGraph) -> bool:
    """Whether one of its category stands where it was placed; a mesh may be smaller."""
    return any(
        other.category == item.category
        and math.dist(other.box.center_m[:2], item.box.center_m[:2]) <= BUILT_M
        for other in graph.items
    )
