"""What is done to the furniture of a house after it is read: one table of rules.

Reading puts every piece where it is painted, edges within half a pixel on their walls. Each rule
mends one thing that painting gets wrong, and what it does to a piece is kept with the piece, as an
Edit. docs/rules.md says what each is worth (benchmarks/rules.py).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from chord_usd.base.scene.oriented_rect import Footprint
from chord_usd.base.scene.types import Box, Edit, Item, SceneGraph
from chord_usd.line.arrange.arrangement import Arrangement, kept_off
from chord_usd.line.arrange.leaves_free import free_leaves
from chord_usd.line.arrange.moved_aside import leave_out, move_aside
from chord_usd.line.arrange.off_trim import clear_trim, cut_at_walls, hang_on_walls
from chord_usd.line.arrange.seating import RULE as ASKEW
from chord_usd.line.arrange.seating import draw_out_chairs, leave_askew, seat_chairs
from chord_usd.line.arrange.ways_open import free_fronts, open_ways
from chord_usd.line.graph.flush import parted

When = Literal["read", "given", "drawn", "meshed"]
"""A layout was read; boxes came from elsewhere; no more is drawn; meshes are at hand."""

_SAME = 1e-6
"""Metres and degrees."""


@dataclass(frozen=True)
class Rule:
    """One thing that is mended."""

    name: str
    when: When
    act: Callable[[Arrangement], SceneGraph]


def arrange(work: Arrangement, when: When, without: Collection[str] = ()) -> SceneGraph:
    """The house after the rules of this moment, in the order of the table.

    without: names of rules that are left out. Raises StageError for a mesh that cannot be opened.
    """
    for rule in RULES:
        if rule.when == when and rule.name not in without:
            work = work.holding(noted(rule.name, work.graph, rule.act(work)))
    return work.graph


def noted(name: str, before: SceneGraph, after: SceneGraph) -> SceneGraph:
    """The graph after a rule, with an Edit in each piece whose box it changed."""
    boxes = {item.id: item.box for item in before.items}

    def with_edit(item: Item) -> Item:
        box = boxes.get(item.id, item.box)
        if _is_same(box, item.box):
            return item
        return item.with_facts(edits=(*item.facts.edits, Edit(name, box)))

    return replace(after, items=tuple(with_edit(item) for item in after.items))


def _is_same(a: Box, b: Box) -> bool:
    """But for rounding."""
    first, second = ((*box.center_m, *box.size_m, box.yaw_deg) for box in (a, b))
    return a == b or bool(np.allclose(first, second, rtol=0.0, atol=_SAME))


def edits_told(graph: SceneGraph) -> list[dict[str, str | float]]:
    """Every edit of a house's pieces, for reports: which piece, which rule, and how far the piece
    was moved in all."""
    return [
        {"item": item.id, "rule": edit.rule, "moved_m": item.moved_m}
        for item in graph.items
        for edit in item.facts.edits
    ]


def _room_by_room(
    boxes_of: Callable[[Arrangement, str, Sequence[Item]], Sequence[Box]],
) -> Callable[[Arrangement], SceneGraph]:
    """A rule that looks at each room alone, by its id."""

    def rule(work: Arrangement) -> SceneGraph:
        items = {item.id: item for item in work.graph.items}
        for room in work.graph.rooms:
            pieces = list(work.graph.items_of(room.id))
            for item, box in zip(pieces, boxes_of(work, room.id, pieces), strict=True):
                items[item.id] = replace(item, box=box)
        return replace(work.graph, items=tuple(items.values()))

    return rule


def _cut_at_walls(work: Arrangement, room_id: str, items: Sequence[Item]) -> list[Box]:
    floor = work.floors[room_id]
    return [cut_at_walls(Footprint.of(item.box), floor).on(item.box) for item in items]


def _parted(work: Arrangement, _: str, items: Sequence[Item]) -> list[Box]:
    apart = parted([Footprint.of(item.box) for item in items], work.reach_m)
    return [footprint.on(item.box) for footprint, item in zip(apart, items, strict=True)]


def _off_free_floor(work: Arrangement) -> SceneGraph:
    items = tuple(
        replace(item, box=kept_off(work.clear_floors, item, work.reach_m, work.painted))
        for item in work.graph.items
    )
    return replace(work.graph, items=items)


def _below_sills(work: Arrangement) -> SceneGraph:
    items = tuple(work.clear_floors.below_sill(item) for item in work.graph.items)
    return replace(work.graph, items=items)


RULES: tuple[Rule, ...] = (
    Rule("cut at the room's edge", "read", _room_by_room(_cut_at_walls)),
    Rule("neighbours parted", "read", _room_by_room(_parted)),
    Rule("off the floor before openings", "read", _off_free_floor),
    Rule("below window sills", "read", _below_sills),
    Rule("chairs face tables, in sets", "read", seat_chairs),
    Rule("moved aside", "given", move_aside),
    Rule("fronts freed", "drawn", free_fronts),
    Rule("what stands in the way left out", "drawn", leave_out),
    Rule("ways kept open", "drawn", open_ways),
    Rule("panels on their walls", "meshed", hang_on_walls),
    Rule("off casings and sills", "meshed", clear_trim),
    Rule("chairs clear of tables", "meshed", draw_out_chairs),
    Rule(ASKEW, "meshed", leave_askew),
    Rule("leaves free", "meshed", free_leaves),
)
"""In the order in which they are applied."""
