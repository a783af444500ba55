"""Pieces that nobody could build as they stand are left out: the least needed of each clash."""

from __future__ import annotations

from collections.abc import Iterable

from chord_usd.base.metrics.violations import Violation, violations
from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.arrange.arrangement import Arrangement

_NEVER_BUILT = ("overlap", "before an opening", "undersized")


def clashes(graph: SceneGraph) -> list[Violation]:
    """Pieces in each other, before openings, and those too small to be pieces."""
    return [one for one in violations(graph) if one.kind in _NEVER_BUILT]


def leave_out(work: Arrangement) -> SceneGraph:
    """The house without undersized pieces, and without those that stand in others or before
    openings and can best be done without.

    Of those in each other's way the one goes without which least is wrong, of equal ones the
    smaller. What a room cannot do without stays before a window, not before a door or in another
    piece.
    """
    faults, graph = work.faults, work.graph
    assert faults is not None, "nothing tells how much is wrong"
    floor_m2 = {item.id: item.box.size_m[0] * item.box.size_m[1] for item in graph.items}
    while found := clashes(graph):
        before = faults(graph)
        clashing = {item_id for one in found for item_id in one.items}
        may_go = (item.id for item in graph.items if item.id in clashing and work.may_move(item))
        tries = sorted((faults(graph.without([one])), floor_m2[one], one) for one in may_go)
        shut = _shut_in(graph, found)
        worst = next((one for left, _, one in tries if left < before or one in shut), None)
        if worst is None:
            break
        graph = graph.without([worst])
    return graph


def _shut_in(graph: SceneGraph, found: Iterable[Violation]) -> set[str]:
    """Ids of pieces that are undersized or in others, or before doors and passages: nobody gets
    by."""
    windows = {opening.id for opening in graph.openings if opening.kind == "window"}
    return {item_id for one in found if one.other not in windows for item_id in one.items}
