"""Kitchen units end before doors, as far as a usual unit is left."""

from __future__ import annotations

from pathlib import Path

import pytest

from chord_usd.graph.ends import end_before_openings
from chord_usd.metrics.openings import blocked_openings
from chord_usd.types import MOVED, Asset, Box, Item, Opening, Room, SceneGraph, frozen_array

WIDE_M, NARROW_M = 1.44, 1.38
"""Of galleys, before whose door a unit may be 0.55 or 0.49 m deep."""


class Sizes:
    """A database with a mesh of every size asked for."""

    def nearest(self, name: str, size_m: tuple[float, float, float], *_: object) -> Asset:
        return Asset(name, name, size_m, Path(f"{name}.usda"))


def unit(depth_m: float, y_m: float, length_m: float, name: str = "sink_cabinet") -> Item:
    """With its back on the wall opposite to the door."""
    box = Box((depth_m / 2, y_m, 0.0), (length_m, depth_m, 0.87), 90.0)
    return Item("k/0", name, box, "k", asset=Asset("a", name, box.size_m, Path("a.usda")))


def galley(width_m: float, item: Item) -> SceneGraph:
    corners = [(0.0, 0.0), (width_m, 0.0), (width_m, 4.0), (0.0, 4.0)]
    room = Room("k", "kitchen", frozen_array(corners))
    door = Opening("d", "door", Box((width_m + 0.12, 1.0, 0.0), (0.9, 0.24, 2.1), 90.0), ("k",))
    return SceneGraph((room,), (door,), (item,))


def ended(item: Item, width_m: float = NARROW_M) -> Item:
    return end_before_openings(galley(width_m, item), Sizes()).items[0]


def is_blocked(item: Item, width_m: float = NARROW_M) -> bool:
    return bool(blocked_openings(galley(width_m, item)))


def test_a_unit_a_little_too_deep_gets_shallower() -> None:
    item = unit(0.58, 1.2, 1.6)
    assert is_blocked(item, WIDE_M)
    cut = ended(item, WIDE_M)
    assert not is_blocked(cut, WIDE_M)
    assert cut.box.size_m[0] == pytest.approx(item.box.size_m[0])
    assert cut.box.center_m[0] - cut.box.size_m[1] / 2 == pytest.approx(0.0), "its back stays"
    assert cut.extra[MOVED] == pytest.approx(item.box.size_m[1] - cut.box.size_m[1])
    assert cut.asset is not None
    assert cut.asset.size_m == pytest.approx(cut.box.size_m)


def test_a_run_past_the_door_ends_before_it() -> None:
    item = unit(0.65, 2.0, 1.9)
    cut = ended(item)
    assert not is_blocked(cut)
    assert cut.box.size_m[0] == pytest.approx(2.95 - 1.45, abs=0.03)
    assert cut.box.size_m[1] == pytest.approx(item.box.size_m[1])


@pytest.mark.parametrize(
    "item",
    [unit(0.48, 1.0, 1.6), unit(0.8, 1.0, 0.8), unit(0.65, 1.0, 1.6, "refrigerator")],
    ids=["out of the way", "nothing would be left", "comes in its sizes"],
)
def test_others_stay(item: Item) -> None:
    assert ended(item).box == item.box
