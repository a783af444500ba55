"""Kitchen units of a run have one depth, so that their worktop goes through.

A raster tells the front of each unit to a pixel or two. Steps of a few centimetres in a worktop are
those pixels: units are made in one depth.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely

from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2
from chord_usd.base.scene.geometry import footprint_polygon, resized, to_own
from chord_usd.base.scene.types import Box
from chord_usd.base.scene.units import wrap_deg

_BESIDE_PX = 1.5
"""Neighbours of a run are this close, and so are their backs to one line."""

_STEP_PX = 2.5
"""Fronts that differ by more are meant."""

_PARALLEL_DEG = 1.0


def level_fronts(units: Sequence[Box], others: Sequence[Box], m_per_px: float) -> list[Box]:
    """The units, those of a run as deep as most of it; backs stay where they are.

    others: what else stands in the room. Where a unit would grow into it, or into a unit of
    another run, the whole run stays as shallow as that unit.
    """
    levelled = list(units)
    for run in _runs(units, m_per_px):
        depth_m = float(np.median([units[index].size_m[1] for index in run]))
        around = [*others, *(box for index, box in enumerate(levelled) if index not in run)]
        for index in run:
            if _overlap_m2(_deep(units[index], depth_m), around) > (
                _overlap_m2(units[index], around) + MIN_OVERLAP_M2
            ):
                depth_m = min(depth_m, units[index].size_m[1])
        for index in run:
            levelled[index] = _deep(units[index], depth_m)
    return levelled


def _runs(units: Sequence[Box], m_per_px: float) -> list[list[int]]:
    """Indices of units side by side, two at least."""
    waiting, runs = set(range(len(units))), []
    while waiting:
        run = [waiting.pop()]
        for one in run:
            run += (near := [i for i in waiting if _is_next(units[one], units[i], m_per_px)])
            waiting.difference_update(near)
        if len(run) > 1:
            runs.append(sorted(run))
    return runs


def _is_next(one: Box, other: Box, m_per_px: float) -> bool:
    x, y = to_own(one, other.center_m[:2])
    (length, depth, _), (other_length, other_depth, _) = one.size_m, other.size_m
    return bool(
        abs(wrap_deg(other.yaw_deg - one.yaw_deg)) < _PARALLEL_DEG
        and abs(x) - (length + other_length) / 2 < _BESIDE_PX * m_per_px
        and abs(y + (other_depth - depth) / 2) < _BESIDE_PX * m_per_px
        and abs(other_depth - depth) < _STEP_PX * m_per_px
    )


def _deep(box: Box, depth_m: float) -> Box:
    """The box with another depth, its back where it was."""
    return resized(box, (box.size_m[0], depth_m), (0.0, (box.size_m[1] - depth_m) / 2))


def _overlap_m2(box: Box, around: Sequence[Box]) -> float:
    shapes = [footprint_polygon(other) for other in around]
    return float(shapely.area(shapely.intersection(footprint_polygon(box), shapes)).sum())
