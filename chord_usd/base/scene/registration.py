"""How two storeys lie on each other: by their stairs, else by their outer walls."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import polygons_of, room_polygon
from chord_usd.base.scene.storeys import Stair
from chord_usd.base.scene.types import WALL_THICKNESS_M, Plan
from chord_usd.base.scene.units import wrap_deg

ON_WALL_M = 0.15
"""An outer wall this near to the one below stands on it."""

LEAST_ON_WALLS = 0.5
"""Share of a storey's outer walls that must stand on walls below where no stair aligns both."""

_BETWEEN_M = 0.8
"""As wide is a party wall with a shaft in it."""

LEAST_CARRIED = 0.7
"""Share of a storey's floor that must lie over the one below."""

_SURE = 0.95
"""Another scale or direction at which so much stands on walls is the right one."""

_SAME_SIZE = 0.12
"""Relative: by so much the same stair is drawn larger or smaller on two storeys."""

_SAME_YAW_DEG = 5.0
_STEPS_M = 0.25
"""Along outlines, between the points that are measured."""

_TRIED_SCALES = (0.5, 2.0)
_ALIKE = 0.97
"""Of the same plan drawn twice, so much of each room lies in the other."""


@dataclass(frozen=True)
class Registration:
    """Where a storey lies over the one below."""

    shift_m: tuple[float, float]
    by: str
    """"stairs", "outer walls", or "file"."""
    on_walls: float
    """Share of its outer walls within ON_WALL_M of those below."""
    residual_m: float
    """Mean distance of these from those below; of stairs, if there is none."""
    carried: float
    """Share of its floor over the one below."""


def register(
    lower: Plan,
    upper: Plan,
    climbs: Sequence[tuple[Stair, Stair]],
    known_m: tuple[float, float] | None = None,
    where: str = "plan",
) -> Registration:
    """Where the upper storey lies. Nothing is turned or scaled: plans are in metres, north alike.

    climbs: pairs of stairs that may be the same, up on the lower and down on the upper storey.
    known_m: as the file says. Raises PlanError where the storeys do not fit, with the reason.
    """
    below, above = outline(lower), outline(upper)
    if known_m is not None:
        return _refused_unless_carried(_measured(below, above, known_m, "file"), where)
    _refuse_copy(lower, upper, climbs, where)
    matched = [pair for pair in climbs if _is_same(*pair)]
    tried = [_measured(below, above, _apart(*pair), "stairs") for pair in matched]
    if not tried:
        _refuse_other_stairs(climbs, where)
        tried = [_measured(below, above, shift, "outer walls") for shift in _shifts(below, above)]
    best = max(tried, key=lambda attempt: (round(attempt.on_walls, 2), round(attempt.carried, 2),
                                       -attempt.residual_m))  # fmt: skip
    if best.by == "outer walls" and best.on_walls < _SURE:
        hint, fit = _why(below, above, best.on_walls)
        if best.on_walls < LEAST_ON_WALLS or fit >= _SURE:
            raise PlanError(
                f"only {best.on_walls:.0%} of its outer walls would stand on walls of the storey "
                f"below{hint}",
                where=where,
                expected="storeys of one house, at one scale, north alike",
                try_=("a stair on both plans (docs/plans.md)", "the right <m_per_px>"),
            )
    return _refused_unless_carried(best, where)


def outline(plan: Plan) -> Polygon:
    """What a storey covers, its outer walls included, and what is narrower than _BETWEEN_M between
    two homes of it; balconies are left out."""
    rooms = [room for room in plan.rooms if room.kind != "balcony"] or list(plan.rooms)
    half = WALL_THICKNESS_M / 2 + 1e-3
    grown = [room_polygon(room).buffer(half, join_style="mitre") for room in rooms]
    reach = _BETWEEN_M / 2
    whole = unary_union(grown).buffer(half + reach, join_style="mitre")
    whole = whole.buffer(-reach, join_style="mitre")
    largest: Polygon = max(polygons_of(whole), key=lambda part: part.area)
    return Polygon(largest.exterior)


def _refused_unless_carried(registration: Registration, where: str) -> Registration:
    if registration.carried < LEAST_CARRIED:
        raise PlanError(
            f"only {registration.carried:.0%} of its floor would lie over the storey below",
            where=where,
            expected=f"at least {LEAST_CARRIED:.0%}, at one scale, north alike",
        )
    return registration


def _apart(up: Stair, down: Stair) -> tuple[float, float]:
    (x, y, _), (u, v, _) = up.box.center_m, down.box.center_m
    return x - u, y - v


def _is_same(up: Stair, down: Stair) -> bool:
    turned = abs(wrap_deg(up.box.yaw_deg - down.box.yaw_deg))
    ratios = np.array(up.box.size_m[:2]) / np.array(down.box.size_m[:2])
    return (
        (up.form, up.turn) == (down.form, down.turn)
        and turned <= _SAME_YAW_DEG
        and bool(np.abs(ratios - 1.0).max() <= _SAME_SIZE)
    )


def _refuse_other_stairs(climbs: Sequence[tuple[Stair, Stair]], where: str) -> None:
    """Stairs on both storeys, none of which is the same: say how the nearest pair differs."""
    for up, down in climbs:
        ratios = np.array(up.box.size_m[:2]) / np.array(down.box.size_m[:2])
        turned = round(wrap_deg(up.box.yaw_deg - down.box.yaw_deg))
        even = abs(ratios[0] / ratios[1] - 1.0) < _SAME_SIZE
        difference = (
            f"is turned by {turned} degrees" if abs(turned) > _SAME_YAW_DEG
            else f"is drawn at {1 / float(ratios.mean()):.2f} times the scale" if even
            else "has another shape"
        )  # fmt: skip
        raise PlanError(
            f"its stair {down.id} {difference} against stair {up.id} of the storey below",
            where=where,
            expected="the same stair on both storeys",
        )


def _measured(below: Polygon, above: Polygon, shift: tuple[float, float], by: str) -> Registration:
    moved = affinity.translate(above, *shift)
    count = max(8, int(moved.exterior.length / _STEPS_M))
    points = shapely.line_interpolate_point(
        moved.exterior, np.arange(count) / count, normalized=True
    )
    distances = shapely.distance(below.exterior, points)
    near = distances <= ON_WALL_M
    return Registration(
        shift_m=(float(shift[0]), float(shift[1])),
        by=by,
        on_walls=float(near.mean()),
        residual_m=float(distances[near].mean()) if near.any() else 0.0,
        carried=float(moved.intersection(below).area / moved.area),
    )


def _shifts(below: BaseGeometry, above: BaseGeometry) -> Iterator[tuple[float, float]]:
    """Offsets that bring walls of both outlines onto each other, sides in pairs."""
    offsets: list[list[float]] = []
    for axis in (0, 1):
        sides = [_side_lines(shape, axis) for shape in (below, above)]
        pairs = sorted(
            ((min(a[1], b[1]), round(a[0] - b[0], 3)) for a, b in itertools.product(*sides)),
            reverse=True,
        )
        offsets.append(list(dict.fromkeys(offset for _, offset in pairs))[:12] or [0.0])
    yield from itertools.product(*offsets)


def _side_lines(shape: BaseGeometry, axis: int) -> list[tuple[float, float]]:
    """(coordinate, length) of the sides of an outline that run across an axis, and its bounds."""
    corners = np.asarray(shape.simplify(0.02).exterior.coords)
    ends = itertools.pairwise(corners)
    lines = [
        (float(a[axis] + b[axis]) / 2, float(abs(a[1 - axis] - b[1 - axis])))
        for a, b in ends
        if abs(a[axis] - b[axis]) < 0.1 * abs(a[1 - axis] - b[1 - axis])
    ]
    bounds = shape.bounds
    return [*lines, (bounds[axis], 0.5), (bounds[axis + 2], 0.5)]


def _why(below: Polygon, above: Polygon, on_walls: float) -> tuple[str, float]:
    """What would make it fit better, for the message, and how well."""
    best, hint = max(on_walls + 0.2, 0.75), ""
    for turn in (0.0, 90.0, 180.0, 270.0):
        turned = affinity.rotate(above, turn, origin=(0.0, 0.0))
        sizes = [np.subtract(shape.bounds[2:], shape.bounds[:2]) for shape in (below, turned)]
        for scale in {1.0, *np.round(sizes[0] / sizes[1], 3).tolist()}:
            if not _TRIED_SCALES[0] <= scale <= _TRIED_SCALES[1]:
                continue
            other = affinity.scale(turned, scale, scale, origin=(0.0, 0.0))
            fit = max(
                _measured(below, other, shift, "").on_walls for shift in _shifts(below, other)
            )
            if fit > best:
                parts = ([f"turned by {turn:.0f} degrees"] if turn else []) + (
                    [f"drawn {scale:.2f} times as large"] if abs(scale - 1.0) > 0.02 else []
                )
                if parts:
                    best, hint = fit, f"; {' and '.join(parts)}, {fit:.0%} would"
    return hint, best if hint else on_walls


def _refuse_copy(
    lower: Plan, upper: Plan, climbs: Sequence[tuple[Stair, Stair]], where: str
) -> None:
    """The same plan twice is most likely the same file twice, unless its stairs say otherwise."""
    if climbs or len(lower.rooms) != len(upper.rooms):
        return
    alike = [
        room.kind == other.kind and _iou(room_polygon(room), room_polygon(other)) > _ALIKE
        for room, other in zip(lower.rooms, upper.rooms, strict=True)
    ]
    if all(alike) and len(lower.openings) == len(upper.openings):
        raise PlanError(
            "is the plan of the storey below once more",
            where=where,
            expected="one plan a storey; storeys that are alike need a stair up and down",
        )


def _iou(first: BaseGeometry, other: BaseGeometry) -> float:
    return float(first.intersection(other).area / max(first.union(other).area, 1e-9))
