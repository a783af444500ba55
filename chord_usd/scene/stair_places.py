"""Stairs as they are drawn -> stairs to rule on the plans that they join."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Point, Polygon

from chord_usd.errors import PlanError
from chord_usd.scene.geometry import room_polygon
from chord_usd.scene.stair_cells import with_cell
from chord_usd.scene.stair_elements import LEAST_WIDTH_M, WELL_M, Stair, StairForm, Turn
from chord_usd.scene.stair_forms import BuiltStair, build_stair
from chord_usd.scene.types import Box, FloatArray, Plan
from chord_usd.scene.units import m_from_cm

DRAWN_STAIRS = "drawnStairs"
"""Key of Plan.extra: outlines of the stairs seen on a picture, lists of [x, y] in centimetres."""

_LONG = 2.0
"""A stair that is so many times as long as wide is straight, before it is anything else."""

_SAME_M = 0.01

_ALONG = 0.5
"""Cosine: a straight stair goes up no more slantwise than this against what its steps say."""


_GROWN_M = (0.0, 0.3, 0.6, 0.9, 1.2)
"""How much longer than drawn a stair may become: many are drawn shorter than they are built."""

_LEAST_M: dict[StairForm, float] = {
    "straight": LEAST_WIDTH_M, "L": 2 * LEAST_WIDTH_M, "U": 2 * LEAST_WIDTH_M + WELL_M,
    "winder_L": LEAST_WIDTH_M, "winder_U": 2 * LEAST_WIDTH_M + WELL_M,
}  # fmt: skip
"""Widths of stairs."""
_WIDENED_M = 0.3
"""Drawn narrower than that by no more than this, they are made so wide."""

_IN_ONE_ROOM = 0.97
"""Share of a stair that grew that must lie in one room of each storey, clear of walls."""


@dataclass(frozen=True, eq=False)
class StairShape:
    """A stair up from a storey, seen from above."""

    area: Polygon
    up: FloatArray | None = None
    """(2,) unit vector from its lowest steps to its highest; None where the file does not say."""
    ends: tuple[FloatArray, FloatArray] | None = None
    """(2,) middles of its lowest and its highest steps, where the file tells them."""
    forms: tuple[StairForm, ...] = ()
    """Those that the file speaks of; none where it does not say."""


def drawn_stairs(plan: Plan, shift_m: tuple[float, float] = (0.0, 0.0)) -> list[Polygon]:
    """The stairs seen on a plan's picture, in metres, moved by a shift."""
    found = []
    for corners in plan.extra.get(DRAWN_STAIRS, ()):
        points = np.array([[m_from_cm(x), m_from_cm(y)] for x, y in corners]) + shift_m
        found.append(Polygon(points).buffer(0))
    return found


def seen_on_both(below: Sequence[Polygon], above: Sequence[Polygon]) -> list[Polygon]:
    """Stairs between two storeys: what both show at one place, as far as either shows it; where
    only one shows stairs, those."""
    if not below or not above:
        return [*below, *above]
    pairs = [(low, high) for low in below for high in above if low.intersects(high)]
    return [low.union(high).convex_hull for low, high in pairs]


def grown_stair(
    area: Polygon, name: str, lower: Plan, upper: Plan, height_m: float
) -> Stair | None:
    """As placed_stair, for one seen on a picture: as much longer as it has to be, and can be."""
    for more_m in _GROWN_M:
        stair = placed_stair(StairShape(area), name, lower, upper, height_m, more_m)
        if stair is not None:
            return stair
    return None


def placed_stair(
    shape: StairShape,
    name: str,
    lower: Plan,
    upper: Plan,
    height_m: float,
    more_m: float | None = None,
) -> Stair | None:
    """The stair to rule that takes a drawn one's place and joins rooms of both storeys; None where
    none does. All in metres. Of several of the likeliest form, the one that begins and ends nearest
    to where the drawn one does. more_m: how much longer it becomes than it is drawn, within the
    rooms that it stands in; None takes it as it is."""
    best: tuple[float, Stair] | None = None
    for stair in (_grown(one, more_m) for one in _candidates(shape, name)):
        if best is not None and (shape.ends is None or stair.form != best[1].form):
            break
        try:
            built = build_stair(stair, height_m)
            if more_m is not None:
                _refuse_walls(built, lower, upper)
            with_cell(lower, built, above=False)
            with_cell(upper, built, above=True)
        except PlanError:
            continue
        off_m = _off_m(built, shape)
        if best is None or off_m < best[0] - _SAME_M:
            best = off_m, stair
    return best[1] if best else None


def _grown(stair: Stair, more_m: float | None) -> Stair:
    """Longer at its foot, and wide enough."""
    if more_m is None:
        return stair
    (width_m, depth_m, high_m), (x, y, z) = stair.box.size_m, stair.box.center_m
    ahead = np.radians(stair.box.yaw_deg + 90.0)
    back = more_m / 2
    center = (x - back * float(np.cos(ahead)), y - back * float(np.sin(ahead)), z)
    least_m = _LEAST_M[stair.form]
    wide_m = max(width_m, least_m) if least_m - width_m < _WIDENED_M else width_m
    size = (wide_m, depth_m + more_m, high_m)
    return replace(stair, box=replace(stair.box, center_m=center, size_m=size))


def _refuse_walls(built: BuiltStair, lower: Plan, upper: Plan) -> None:
    area = built.area_m
    for plan in (lower, upper):
        shares = [room_polygon(room).intersection(area).area / area.area for room in plan.rooms]
        if max(shares) < _IN_ONE_ROOM:
            raise PlanError("a stair there would stand in a wall")


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
    winders: tuple[StairForm, ...] = ("winder_L", "winder_U")
    forms = shape.forms + tuple(one for one in (*forms, *winders) if one not in shape.forms)
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
