"""Kitchen units in line: one depth to a run, and nothing grows into anything."""

from __future__ import annotations

import pytest
import shapely
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.base.scene.geometry import footprint, footprint_polygon
from chord_usd.base.scene.types import Box
from chord_usd.line.arrange.unit_runs import level_fronts

PX_M = 0.044


def unit(x_m: float, depth_m: float, length_m: float = 0.6, yaw_deg: float = 0.0) -> Box:
    """A unit with its back on y = 3."""
    return Box((x_m, 3.0 - depth_m / 2, 0.0), (length_m, depth_m, 0.9), yaw_deg)


def test_fronts_of_a_run_come_into_line_and_backs_stay() -> None:
    units = [unit(0.6 * i, depth) for i, depth in enumerate((0.57, 0.53, 0.57, 0.61, 0.57))]
    levelled = level_fronts(units, (), PX_M)
    assert [box.size_m[1] for box in levelled] == pytest.approx([0.57] * 5)
    for before, after in zip(units, levelled, strict=True):
        assert footprint(after)[0] == pytest.approx(footprint(before)[0])
        assert after.size_m[0] == before.size_m[0]


def test_what_is_meant_to_be_deeper_or_stands_apart_stays() -> None:
    units = [unit(0.0, 0.57), unit(0.6, 0.8), unit(2.4, 0.53)]
    assert level_fronts(units, (), PX_M) == units


def test_no_unit_grows_into_its_neighbours() -> None:
    """The shorter leg of an L stands against the front of the longer one."""
    long_leg = [unit(0.6 * i, depth) for i, depth in enumerate((0.53, 0.61, 0.61))]
    corner = Box((0.0, 3.0 - 0.53 - 0.3, 0.0), (0.6, 0.6, 0.9), 90.0)
    levelled = level_fronts([*long_leg, corner], (), PX_M)
    assert [box.size_m[1] for box in levelled[:3]] == pytest.approx([0.53] * 3)
    table = Box((0.0, 2.0, 0.0), (0.6, 0.94, 0.75), 0.0)
    assert [box.size_m[1] for box in level_fronts(long_leg, [table], PX_M)] == [0.53] * 3


@given(depths=st.lists(st.floats(0.4, 0.8), min_size=1, max_size=6))
def test_no_front_moves_further_than_the_steps_of_its_run(depths: list[float]) -> None:
    units = [unit(0.6 * i, depth) for i, depth in enumerate(depths)]
    levelled = level_fronts(units, (), PX_M)
    for box in levelled:
        assert min(depths) - 1e-9 <= box.size_m[1] <= max(depths) + 1e-9
    area_m2 = shapely.union_all([footprint_polygon(box) for box in levelled]).area
    assert area_m2 == pytest.approx(sum(box.size_m[0] * box.size_m[1] for box in levelled))
