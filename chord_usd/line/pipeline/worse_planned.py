"""Two states of a house -> what the second is planned worse in."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

from chord_usd.base.scene.types import SceneGraph

if TYPE_CHECKING:
    from chord_usd.base.metrics.design import Design
    from chord_usd.line.stage.edit.staged_house import StagedHouse


def lines_worse_planned(house: StagedHouse, before: SceneGraph, after: SceneGraph) -> list[str]:
    """Rooms that are noticeably worse planned after an edit, and clauses less that the home keeps
    of the standard that it is planned to, a line each."""
    from chord_usd.base.metrics.design import worse_planned
    from chord_usd.base.metrics.design.standard import keeping, standards_in

    names = {room_id: name for name, room_id in house.room_ids.items()}
    worse = worse_planned(_design(before), _design(after))
    lost = [
        f"{names.get(place, place)} is worse planned: {rules}" for place, rules in worse.items()
    ]
    for standard in standards_in(house.standard):
        known = {(clause.name, place) for clause, place, _ in
                 keeping(standard, [before]).findings}  # fmt: skip
        now = keeping(standard, [after])
        lost += [now.line(clause, names.get(place, place), finding)
                 for clause, place, finding in now.findings
                 if (clause.name, place) not in known]  # fmt: skip
    return lost


@lru_cache(maxsize=2)  # each candidate of an edit is compared with one house
def _design(graph: SceneGraph) -> Design:
    from chord_usd.base.metrics.design import design_of

    return design_of([graph])
