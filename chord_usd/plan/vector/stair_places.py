"""Stairs of vector files -> stairs to rule on the plans that they join."""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np
from shapely.geometry import Point

from chord_usd.errors import PlanError
from chord_usd.plan.vector.shapes import StairShape
from chord_usd.scene.stair_cells import with_cell
from chord_usd.scene.stair_forms import BuiltStair, Stair, StairForm, Turn, build_stair
from chord_usd.scene.storeys import STOREY_M
from chord_usd.scene.types import Box, Plan

_LONG = 2.0
"""A stair that is so many times as long as wide is straight, before it is anything else."""

_SAME_M = 0.01

_ALONG = 0.5
"""Cosine: a straight stair goes up no more slantwise than this against what its steps say."""


def placed_stair(shape: StairShape, name: str, lower: Plan, upper: Plan) -> Stair | None:
    """The stair to rule that takes a drawn one's place and joins rooms of both storeys; None where
    none does. All in metres. Of several of the likeliest form, the one that begins and ends nearest
    to where the drawn one does."""
    best: tuple[float, Stair] | None = None
    for stair in _candidates(shape, name):
        if best is not None and (shape.ends is None or stair.form != best[1].form):
            break
        try:
            built = build_stair(stair, STOREY_M)
            with_cell(lower, built, above=False)
            with_cell(upper, built, above=True)
        except PlanError:
            continue
        off_m = _off_m(built, shape)
        if best is None or off_m < best[0] - _SAME_M:
            best = off_m, stair
    return best[1] if best else None


def _off_m(built: BuiltStair, shape: StairShape) -> float:
    """How far a stair begins and ends from where the drawn one does."""
    if shape.ends is None:
        return 0.0
    edges = (built.departure_m, built.arrival_m)
    return sum(edge.distance(Point(end)) for edge, end in zip(edges, shape.ends, strict=True))


def _candidates(shape: StairShape, name: str) -> Iterator[Stair]:
    """The likeliest first."""
    around = shape.area.minimum_rotated_rectangle
    corners = np.asarray(around.exterior.coords)[:4]
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(*sides[:2].T)
    yaw = float(np.degrees(np.arctan2(sides[0][1], sides[0][0])))
    x, y = corners.mean(axis=0).tolist()
    is_long = float(lengths.max() / max(lengths.min(), 1e-6)) >= _LONG
    fills = shape.area.area / max(around.area, 1e-6)
    forms: tuple[StairForm, ...] = ("straight", "U", "L") if is_long else ("U", "L", "straight")
    if fills < 0.8 and not is_long:
        forms = ("L", "U", "straight")
    for form, quarter in itertools.product(forms, range(4)):
        width, depth = (lengths if quarter % 2 == 0 else lengths[::-1]).tolist()
        box = Box((x, y, 0.0), (width, depth, 1.0), yaw + 90.0 * quarter)
        ahead = np.radians(box.yaw_deg + 90.0)
        along = 1.0 if shape.up is None else float(shape.up @ [np.cos(ahead), np.sin(ahead)])
        if form == "straight" and along < _ALONG:
            continue
        turns: tuple[Turn, ...] = ("right",) if form == "straight" else ("right", "left")
        for turn in turns:
            yield Stair(name, form, box, turn)
