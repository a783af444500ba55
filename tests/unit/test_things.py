"""Lists of things on tops: told and read back, and the tops that a network is told of."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.metrics.overlap import items_overlap
from chord_usd.base.raster.table_top import SIDES, Border, TableTop
from chord_usd.base.scene.palette import SUPPORTS, TABLE_CATEGORIES
from chord_usd.base.scene.types import Box, Item
from chord_usd.line.lists import things
from chord_usd.line.lists.things import THINGS, top_faults
from chord_usd.workshop.data.tabletops import random_tabletop

SEEDS = st.integers(0, 100_000)


def top_of(size_m: tuple[float, float], *borders: Border) -> TableTop:
    return TableTop("table", size_m, np.ones((40, 80), np.bool_), borders)


def test_lists_can_tell_every_category_of_the_palette() -> None:
    assert sorted(THINGS.categories) == sorted(row.name for row in TABLE_CATEGORIES)


@settings(max_examples=60, deadline=None)
@given(SEEDS)
def test_what_is_told_and_read_back_is_the_same_table(seed: int) -> None:
    tabletop = random_tabletop(np.random.default_rng(seed))
    elements = things.things_of(tabletop.items, tabletop.top)
    found = things.items_from(elements, tabletop.top)
    assert things.things_of(found, tabletop.top) == elements
    assert items_overlap(found).por == 0.0
    assert top_faults(found, tabletop.top) == 0.0
    left = list(tabletop.items)
    for item in found:
        near = min(left, key=lambda other: (other.category != item.category, _apart(item, other)))
        left.remove(near)
        assert near.category == item.category
        assert _apart(item, near) <= 2 * things.STEP_M
        assert abs((near.box.yaw_deg - item.box.yaw_deg + 180.0) % 360.0 - 180.0) <= 2.51


def _apart(one: Item, other: Item) -> float:
    """Most that middles or sizes differ, metres."""
    gaps = np.subtract(one.box.center_m[:2], other.box.center_m[:2])
    return float(np.abs([*gaps, *np.subtract(one.box.size_m[:2], other.box.size_m[:2])]).max())


@settings(max_examples=60, deadline=None)
@given(SEEDS)
def test_rims_are_those_of_the_top(seed: int) -> None:
    """The sides that are told close to polygons about as large as the top, holes left out."""
    top = random_tabletop(np.random.default_rng(seed)).top
    segments = things.segments_of(top)
    assert len(segments) <= things.MOST_SEGMENTS
    rim = segments[segments[:, 0] == 1]
    lines = shapely.linestrings(things.place_m(rim[:, 1:]).reshape(-1, 2, 2))
    areas = sorted((one.area for one in shapely.polygonize([*lines]).geoms), reverse=True)
    free_m2 = top.free.mean() * top.size_m[0] * top.size_m[1]
    if areas and not (~top.free).all():
        assert areas[0] == pytest.approx(free_m2, rel=0.12, abs=0.02)


@pytest.mark.parametrize("side", SIDES)
def test_what_is_beside_a_top_is_told_where_it_is(side) -> None:
    (told, *_) = things.segments_of(top_of((1.2, 0.6), Border(side, "seat", -0.2, 0.1)))
    assert told[0] == 1 + things.SEGMENT_KINDS.index("seat")
    x0, y0, x1, y1 = things.place_m(told[1:])
    at = {"back": (0, 0.3), "front": (0, -0.3), "left": (-0.6, 0), "right": (0.6, 0)}[side]
    if side in ("back", "front"):
        assert (x0, x1, y0, y1) == pytest.approx((-0.2, 0.1, at[1], at[1]))
    else:
        assert (y0, y1, x0, x1) == pytest.approx((-0.2, 0.1, at[0], at[0]))
    flags = things.flags_of(top_of((1.2, 0.6), Border(side, "seat", -0.2, 0.1)))
    assert flags.sum() == 1.0


def test_a_long_top_is_told_smaller_and_read_at_its_size() -> None:
    top = top_of((5.0, 0.5))
    item = Item("a", "laptop", Box((2.1, 0.0, 0.0), (0.34, 0.28, 0.2), 90.0))
    (back,) = things.items_from(things.things_of([item], top), top)
    assert back.box.center_m[:2] == pytest.approx((2.1, 0.0), abs=0.02)
    assert back.box.size_m[:2] == pytest.approx((0.34, 0.28), abs=0.021)
    assert things.segments_of(top)[:, 1:].max() < things.PLACES


def test_facts_stay_within_the_vocabulary() -> None:
    for name in SUPPORTS:
        for size_m in ((0.05, 0.05), (1.0, 0.5), (8.0, 8.0)):
            top = TableTop(name, size_m, np.ones((4, 4), np.bool_))
            assert (things.facts_of(top) < THINGS.facts).all()


def test_faults_are_overlap_and_what_is_beside_the_top() -> None:
    top = top_of((1.0, 0.6))

    def cup(x: float, name: str = "coffee_cup") -> Item:
        return Item(f"{name} {x}", name, Box((x, 0.0, 0.0), (0.1, 0.1, 0.08), 0.0))

    assert top_faults([cup(0.0), cup(0.2)], top) == 0.0
    assert top_faults([cup(0.0), cup(0.05)], top) == pytest.approx(0.0025)
    assert top_faults([cup(0.5)], top) == pytest.approx(0.005, rel=0.3)
    assert top_faults([cup(0.0), cup(0.05, "magazine")], top) == 0.0, "cups stand on magazines"
    assert top_faults([], top) == 1.0
