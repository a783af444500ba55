"""Walls of a house, one by one: together they are the walls, and each hole is in one of them."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely.ops import unary_union

from chord_usd.line.stage.export.exchange.wall_pieces import wall_pieces
from chord_usd.line.stage.shell.walls import build_walls
from chord_usd.workshop.data.houses import random_plan

SEEDS = range(8)


@pytest.mark.parametrize("seed", SEEDS)
def test_walls_cover_the_solid_exactly_once(seed: int) -> None:
    walls = build_walls(random_plan(np.random.default_rng(seed)))
    areas = [piece.area_m for piece in wall_pieces(walls)]
    assert len(areas) >= 4
    assert sum(area.area for area in areas) == pytest.approx(walls.solid_m.area, abs=1e-3)
    assert unary_union(areas).symmetric_difference(walls.solid_m).area < 1e-3


@pytest.mark.parametrize("seed", SEEDS)
def test_every_hole_is_in_one_wall(seed: int) -> None:
    walls = build_walls(random_plan(np.random.default_rng(seed)))
    pieces = wall_pieces(walls)
    held = [(tunnel, piece) for piece in pieces for tunnel in piece.tunnels]
    assert sorted(tunnel.opening.id for tunnel, _ in held) == sorted(walls.tunnels)
    for tunnel, piece in held:
        outside = shapely.difference(tunnel.area_m, piece.area_m.buffer(1e-4))
        assert outside.area < 1e-3
    assert sum(len(piece.gaps) for piece in pieces) == len(walls.railings)
