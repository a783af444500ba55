"""Ways through the house are kept open: pieces that shut a room off are left out."""

from __future__ import annotations

from chord_usd.base.metrics.walk import walk
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.arrange.arrangement import Arrangement

_BESIDE_M = 0.5
"""From a shut room: a piece that shuts it stands in it or in a room beside it."""


def open_ways(work: Arrangement) -> SceneGraph:
    """The house without the pieces that shut rooms off, the least wrong first (faults)."""
    faults, graph = work.faults, work.graph
    assert faults is not None, "nothing measures how much is wrong"
    while shut := walk(graph).shut:
        floors = [work.floors[room_id] for room_id in shut]
        near = {
            room.id for room in graph.rooms
            if any(room_polygon(room).dwithin(floor, _BESIDE_M) for floor in floors)
        }  # fmt: skip
        tries = [
            (len(walk(option).shut), faults(option), item.id, option)
            for item in graph.items
            if item.room_id in near and work.may_move(item)
            for option in [graph.without([item.id])]
        ]
        left = min(tries, default=None, key=lambda each: each[:3])
        if left is None or left[0] >= len(shut):
            break
        graph = left[3]
    return graph
