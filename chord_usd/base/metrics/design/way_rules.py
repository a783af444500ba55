"""Rules of ways through a room: from each door, passage and open border to the others and to the
dining places, past what stands there, chairs as they are drawn out."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import cv2
import numpy as np

from chord_usd.base.metrics.design.floor_ways import WIDEST, Floor, Goal
from chord_usd.base.metrics.design.rule import Measured, Rule
from chord_usd.base.metrics.design.shell import CELL_M
from chord_usd.base.metrics.design.view import View, distances
from chord_usd.base.scene.types import ByteArray

LEAST_M, MAIN_M, SQUEEZED_M = 0.60, 0.91, 0.45
_SEATED_M = 0.5
"""From a table to the backs of its chairs."""
_BESIDE_M = 0.15
"""Pieces no farther beyond the edges of the narrowest place make it narrow."""


def _free(view: View) -> ByteArray:
    """(H, W) the floor between pieces, without the cells at the walls."""
    ground = view.shell.ground
    return ground.between(ground.within, view.corners[view.stands])


def _floor(view: View) -> Floor | None:
    """The free floor with its places to go to; None in a room with fewer than two."""
    ground, tables = view.shell.ground, view.of("dining_table")
    if len(ground.ways) + bool(tables) < 2:
        return None
    floor = view.once(_free)
    around = (_about(view, [at], floor, _SEATED_M) for at in tables)
    return Floor(floor, [*ground.goals, *around])


def _measured(view: View) -> Measured | None:
    """Width of the widest way that joins the entries of a room and its dining places, and the
    pieces at its narrowest place."""
    floor = _floor(view)
    if floor is None:
        return None
    width, strait = floor.widest()
    width_m = width * CELL_M
    if strait is None:
        return Measured(width_m, view.middle)
    at = view.shell.ground.low + CELL_M * np.array(strait[::-1])
    away = distances(at[None], view.edges.reshape(-1, 2, 2)).reshape(-1, 4).min(axis=1)
    near = np.flatnonzero((away < width_m / 2 + _BESIDE_M) & view.stands).tolist()
    return Measured(
        width_m, (float(at[0]), float(at[1])), tuple(view.items[piece].id for piece in near)
    )


def _about(view: View, pieces: Sequence[int], floor: ByteArray, from_m: float = 0.0) -> Goal:
    """The free floor about some pieces, so far from them or farther."""
    ground = view.shell.ground
    mask = np.ones_like(floor)
    for at in pieces:
        cv2.fillPoly(mask, [ground.cells(view.corners[at])], (0,))
    away = cv2.distanceTransform(mask, cv2.DIST_L2, 3) - from_m / CELL_M
    rows, columns = np.nonzero((away < WIDEST) & (floor > 0))
    return (rows, columns), away[rows, columns].astype(np.float64)


def unreached(view: View, sides: Sequence[Sequence[int]]) -> list[int]:
    """Numbers of the sides of tables, each with its chairs, that nobody who comes in gets to."""
    ground = view.shell.ground
    if not ground.ways or not sides:
        return []
    floor = view.once(_free)
    goals = [*ground.goals, *(_about(view, chairs, floor) for chairs in sides)]
    apart = Floor(floor, goals).apart(round(SQUEEZED_M / CELL_M))
    return [at - len(ground.goals) for at in apart if at >= len(ground.goals)]


def leaves_ways(view: View) -> bool:
    """Whether one comes from each entry of a room to the others and to its dining places."""
    floor = _floor(view)
    return floor is None or not floor.apart(round(LEAST_M / CELL_M))


def _at_least(need_m: float) -> Callable[[View], Iterator[Measured]]:
    """Of a room that has such a way without its pieces."""

    def measure(view: View) -> Iterator[Measured]:
        if view.shell.ground.way_m >= need_m - CELL_M / 2:
            measured = view.once(_measured)
            if measured is not None:
                yield measured

    return measure


RULES: tuple[Rule[View], ...] = (
    Rule("way between doors and to the dining place", LEAST_M, "m", "HUD 1973",
         _at_least(LEAST_M), weight=1.5),
    Rule("main way between doors and to the dining place", MAIN_M, "m", "HUD 1973",
         _at_least(MAIN_M), weight=0.3),
)  # fmt: skip
