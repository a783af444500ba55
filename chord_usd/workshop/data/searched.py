"""Furnish a plan several times, and keep of each room the draft that the planning table prefers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from chord_usd.base.scene.types import Plan, SceneGraph
from chord_usd.line.lists.ranking import Ranking
from chord_usd.line.lists.wishes import Asked
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.furnish.mix import Statistics


def furnish_best(
    plan: Plan, rng: np.random.Generator, drafts: int, statistics: Statistics = "homes"
) -> SceneGraph:
    """The plan with the furniture that breaks the fewest planning rules, of several draws.

    drafts: how often the house is furnished, 1 or more. Rooms are ranked and mended as the drafts
    of lists are (line.lists.ranking). The same plan and state of rng give the same house.
    """
    if drafts < 1:
        raise ValueError(f"drafts must be 1 or more, not {drafts}")
    houses = [furnish(plan, rng, statistics) for _ in range(drafts)]
    if drafts == 1:
        return houses[0]
    bare = replace(houses[0], items=())
    ranking = Ranking(bare, plan.rooms, [Asked()] * len(plan.rooms))
    ranking.weigh(
        {
            at: [list(house.items_of(room.id)) for house in houses]
            for at, room in enumerate(plan.rooms)
        }
    )
    return replace(bare, items=tuple(ranking.chosen()))
