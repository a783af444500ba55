"""Chairs under tables: on the real meshes, nothing is left that runs into anything."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.metrics.clear_floor import blocked_openings
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph
from chord_usd.library.database import load_database
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.rules import arrange
from chord_usd.line.arrange.seating import FARTHEST_M, draw_out_chairs
from chord_usd.line.arrange.seating import RULE as ASKEW
from chord_usd.line.graph.match import match_assets
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_stage import check_stage

ROOM = Room("r", "dining", np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]))
TABLE = Item("table", "dining_table", Box((2.0, 2.0, 0.0), (1.4, 0.85, 0.75), 0.0), "r")


def chair_at(x_m: float, y_m: float, yaw_deg: float = 0.0, name: str = "chair") -> Item:
    """A chair that faces -y at yaw 0."""
    return Item(name, "chair", Box((x_m, y_m, 0.0), (0.45, 0.5, 0.9), yaw_deg), "r")


def house(*items: Item, openings: tuple[Opening, ...] = ()) -> SceneGraph:
    return match_assets(SceneGraph((ROOM,), openings, items), load_database())


def moved_m(before: SceneGraph, after: SceneGraph, name: str = "chair") -> float:
    first, second = (
        next(item.box.center_m for item in graph.items if item.id == name)
        for graph in (before, after)
    )
    return float(np.hypot(*np.subtract(first, second)[:2]))


def cleared(graph: SceneGraph) -> SceneGraph:
    return draw_out_chairs(Arrangement.of(graph))


@pytest.mark.parametrize("x_m", [1.4, 1.55, 2.0, 2.6])
@pytest.mark.parametrize("y_m", [2.1, 2.35, 2.55])
def test_a_chair_ends_up_clear_of_its_table(x_m: float, y_m: float) -> None:
    before = house(TABLE, chair_at(x_m, y_m))
    after = arrange(Arrangement.of(before), "meshed", without=(ASKEW,))
    again = cleared(after)
    assert moved_m(after, again) == 0.0, "what is clear stays where it is"
    assert moved_m(before, after, "table") == 0.0
    far_m = moved_m(before, after)
    assert far_m <= FARTHEST_M + 1e-6
    chair = after.items[1]
    assert np.isclose(chair.moved_m, far_m, atol=1e-5)
    assert [edit.rule for edit in chair.facts.edits] == ["chairs clear of tables"] * (far_m > 0)


def test_the_certificate_sees_no_collision_any_more(tmp_path: Path) -> None:
    before = house(TABLE, chair_at(1.5, 2.4), chair_at(2.55, 1.6, 180.0, "other"))
    bad, good = (
        check_stage(author_stage(graph, tmp_path / f"{name}.usda").path)
        for name, graph in (("bad", before), ("good", cleared(before)))
    )
    assert len(bad.collisions) == 2
    assert good.collisions == ()


def test_a_chair_well_under_its_table_stays_there() -> None:
    before = house(TABLE, chair_at(2.0, 2.5))
    overlap = footprint_polygon(before.items[0].box) & footprint_polygon(before.items[1].box)
    assert overlap.area > 0.01
    assert cleared(before).items == before.items


def test_a_chair_with_its_back_to_its_table_comes_out_forward() -> None:
    """Its mark may have been misread; backwards it would have to cross all of the table."""
    before = house(TABLE, chair_at(2.0, 2.3, 180.0))
    after = cleared(before)
    assert 0.0 < moved_m(before, after) <= FARTHEST_M + 1e-6
    assert after.items[1].box.center_m[1] > 2.3
    assert moved_m(after, cleared(after)) == 0.0


def test_a_chair_shut_in_is_left_out() -> None:
    walls = [
        Item(f"cabinet_{n}", "cabinet", Box((x, y, 0.0), (0.8, 0.4, 2.0), yaw), "r")
        for n, (x, y, yaw) in enumerate([(2.0, 2.58, 0.0), (1.55, 2.1, 90.0), (2.45, 2.1, 90.0)])
    ]
    before = house(TABLE, chair_at(2.0, 2.1), *walls)
    assert [item.id for item in cleared(before).items] == ["table", *(one.id for one in walls)]


def test_a_chair_does_not_move_before_a_door() -> None:
    door = Opening("door", "door", Box((2.0, 4.12, 0.0), (1.2, 0.24, 2.1), 0.0), ("r",))
    table = replace(TABLE, box=replace(TABLE.box, center_m=(2.0, 2.45, 0.0)))
    before = house(table, chair_at(2.0, 2.62), openings=(door,))
    assert not blocked_openings(before)
    after = cleared(before)
    assert not blocked_openings(after)


@pytest.mark.parametrize(("sill_m", "may_move"), [(1.0, True), (0.3, False)])
def test_a_chair_may_move_below_a_sill(sill_m: float, may_move: bool) -> None:
    window = Opening("w", "window", Box((2.0, 4.12, sill_m), (3.8, 0.24, 1.0), 0.0), ("r",))
    table = replace(TABLE, box=replace(TABLE.box, center_m=(2.5, 2.9, 0.0)))
    before = house(table, chair_at(2.0, 3.3), openings=(window,))
    assert (len(cleared(before).items) == 2) == may_move


def test_only_chairs_that_may_move_do() -> None:
    before = house(TABLE, chair_at(2.0, 2.1), chair_at(2.0, 1.9, 180.0, "other"))
    after = draw_out_chairs(Arrangement.of(before, movable=("other",)))
    assert moved_m(before, after) == 0.0
    assert moved_m(before, after, "other") > 0.0
    assert draw_out_chairs(Arrangement.of(before, movable=())).items == before.items
