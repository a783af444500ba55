"""Limits of a house hold: bounded time and memory for what is as large, and an error beyond."""

from __future__ import annotations

import tracemalloc
from dataclasses import replace

import numpy as np
import pytest
from shapely.geometry import Polygon, box

from chord_usd.base.errors import ChordError, SceneError
from chord_usd.base.scene import estimates
from chord_usd.base.scene.chord_json import scene_from_json, scene_to_json
from chord_usd.base.scene.estimates import of_furnishing, of_stage
from chord_usd.base.scene.piles import is_piled
from chord_usd.base.scene.types import Box, Item, PixelFrame, PlanImage, Room, SceneGraph
from chord_usd.line.stage.views.view_places import QUICK, THOROUGH, Stand, stands
from chord_usd.line.stage.views.viewpoints import _Room

TABLE = Item("t", "dining_table", Box((1.0, 1.0, 0.0), (0.8, 0.6, 0.7), 0.0), "r")


def store(side: int) -> list[Item]:
    """side x side tables that stand beside one another."""
    spots = [(1.0 + x, 1.0 + y, 0.0) for x in range(side) for y in range(side)]
    return [
        replace(TABLE, id=f"t{at}", box=replace(TABLE.box, center_m=spot))
        for at, spot in enumerate(spots)
    ]


def hall(side_m: float) -> Polygon:
    return box(0.0, 0.0, side_m, side_m)


def house(items: list[Item], side_m: float = 70.0) -> SceneGraph:
    corners = np.array([(0, 0), (side_m, 0), (side_m, side_m), (0, side_m)], float)
    return SceneGraph((Room("r", "living", corners),), (), tuple(items))


def test_a_view_of_thousands_of_pieces_takes_bounded_memory() -> None:
    """Each place compared all points of all pieces with all pieces: gigabytes for 4,000."""
    room = _Room(hall(52.0), store(50), (), ())
    tracemalloc.start()
    room.sight(Stand(np.array([0.5, 0.5])))
    peak_bytes = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak_bytes < 100 * 2**20


def test_places_of_a_room_are_bounded() -> None:
    """However many corners its free floor and its outline have."""
    turn = np.radians(np.arange(0.0, 360.0, 0.5))
    round_hall = Polygon(np.column_stack([np.cos(turn), np.sin(turn)]) * 120.0)
    for floor, items in ((hall(32.0), store(30)), (round_hall, [])):
        for effort in (THOROUGH, QUICK):
            behind = effort.walls * len(effort.shares) * len(effort.behind_m)
            found = list(stands(floor, items, (), effort))
            assert 0 < len(found) <= effort.inside + behind


def test_pieces_in_one_another_are_counted() -> None:
    assert not is_piled(store(60))
    assert not is_piled([TABLE] * 60)
    assert is_piled([TABLE] * 4000)
    assert is_piled([replace(TABLE, children=tuple([TABLE] * 200))])
    above = [
        replace(TABLE, box=replace(TABLE.box, center_m=(1.0, 1.0, float(z)))) for z in range(500)
    ]
    assert not is_piled(above)


@pytest.mark.parametrize("key", ["furniture", "dressing"])
def test_a_pile_is_refused_when_it_is_read(key: str) -> None:
    data = scene_to_json(house([TABLE]))
    rug = {**data["furniture"][0], "type": "rug"}
    first = data["furniture"][0] if key == "furniture" else rug
    data[key] = [{**first, "id": f"p{at}"} for at in range(4000)]
    with pytest.raises(SceneError, match="stand in one another"):
        scene_from_json(data)


def test_estimates_grow_and_are_refused_beyond_the_machine(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    small, large = house([TABLE]), house(store(70), 80.0)
    assert of_stage(small).said() == ""
    assert of_stage(large).seconds > of_stage(small).seconds
    assert "min of processor time" in of_stage(large).said()
    raster = PlanImage(np.zeros((4096, 4096, 3), np.uint8), PixelFrame(0.07, (0.0, 0.0), 4096))
    of_all = of_furnishing(large.plan, raster) + of_stage(large)
    assert of_all.seconds > of_stage(large).seconds
    of_all.require_memory("x")
    monkeypatch.setattr(estimates, "_memory_bytes", lambda: 1e9)
    with pytest.raises(ChordError, match=r"GB of memory; expected at most the 1\.0 GB"):
        of_all.require_memory("x")
