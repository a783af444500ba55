"""Furnish a plan several times, and keep of each room the draft that the planning table prefers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from chord_usd.base.metrics.design.price import house_price
from chord_usd.base.metrics.violations import room_faults
from chord_usd.base.scene.types import Plan, SceneGraph
from chord_usd.line.lists.put_back import put_back
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


def price_of(house: SceneGraph) -> float:
    """What a house costs by planning rules and faults (metrics.design.price); 0 is the best."""
    faults = room_faults(house, house.rooms)
    by_id = {room.id: fault for room, fault in zip(house.rooms, faults, strict=True)}
    return house_price(house, by_id)


def repaired(house: SceneGraph, finish: Callable[[SceneGraph], SceneGraph]) -> SceneGraph:
    """The house with what its rooms and the home lack by planning rules, as generate adds it to
    lists (line.lists.put_back); the house as it is where that costs less.

    finish: leaves out what must not stand.
    """
    rooms = {room.id for room in house.rooms}
    return min(house, put_back(house, house, rooms, (), finish), key=price_of)
