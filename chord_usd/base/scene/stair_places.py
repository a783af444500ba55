"""Stairs as they are drawn -> stairs to rule on the plans that they join."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from shapely.geometry import Point, Polygon
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import polygons_of, room_polygon, to_own, to_world
from chord_usd.base.scene.stair_cells import is_cell, with_cell
from chord_usd.base.scene.stair_forms import BuiltStair, build_stair, least_run_m, least_square_m
from chord_usd.base.scene.stair_landings import LEAST_LANDING_M
from chord_usd.base.scene.stair_spirals import RIM_M, is_round
from chord_usd.base.scene.storeys import (
    LEAST_WIDTH_M,
    STEEP,
    TO_RULE,
    WELL_M,
    Stair,
    StairForm,
    StairRule,
    Turn,
)
from chord_usd.base.scene.types import Box, FloatArray, Plan, Room, frozen_array
from chord_usd.base.scene.units import m_from_cm

DRAWN_STAIRS = "drawnStairs"
"""Key of Plan.extra: outlines of the stairs seen on a picture, lists of [x, y] in centimetres."""

_LONG = 2.0
"""A stair that is so many times as long as wide is straight, before it is anything else."""

_FILLED = 0.8
"""Share of the least rectangle around it that a stair fills, unless it is an L."""

_SAME_M = 0.01

_ALONG = 0.5
"""Cosine: a straight stair goes up no more slantwise than this against what its steps say."""


_TURN_M = 1.0
"""Between what two storeys show of the ends of one stair: where it turns."""

_GROWN_M = tuple(0.1 * step for step in range(13))
"""How much longer than drawn a stair may become: many are drawn shorter than they are built."""

_FLIGHTS_WIDE: dict[StairForm, int] = {
    "straight": 1, "L": 2, "U": 2, "winder_L": 1, "winder_U": 2
}  # fmt: skip
_WITH_WELL: tuple[StairForm, ...] = ("U", "winder_U")
_WIDENED_M = 0.3
"""Drawn narrower than that by no more than this, they are made so wide; spiral stairs, as wide as
the least of them."""

_IN_ONE_ROOM = 0.97
"""Share of a stair that grew that must lie in one room of each storey, clear of walls."""

_ASIDE_M, _STRIP_M, _FREE_SHARE, _MOSTLY = 0.3, 0.02, 0.93, 0.6
"""How far beside what was seen floor is looked for, in strips of which this share must be free;
and how much of what was seen must stand on floor that both storeys have."""

_ASKEW_DEG = 3.0
"""Of what is drawn along an axis a picture shows the outline no more askew."""

_SQUARE_M, _SQUARE = (1.5, 2.4), 1.15
"""Sides of what may be a spiral stair whose circle was not seen, and the greater to the lesser."""

_STAIRWELL_M2 = 1.0

_END_SHARE = 0.2
"""Of the height: what is no higher is at the lower end."""

_WINDERS: tuple[StairForm, ...] = ("winder_L", "winder_U")


@dataclass(frozen=True, eq=False)
class StairShape:
    """A stair up from a storey, seen from above."""

    area: Polygon
    up: FloatArray | None = None
    """(2,) unit vector from its lowest steps to its highest; None where the file does not say."""
    ends: tuple[FloatArray, FloatArray] | None = None
    """(2,) middles of its lowest and its highest steps, where the file gives them."""
    forms: tuple[StairForm, ...] = ()
    """Forms that the file names; none where it names none."""
    others: bool = True
    """Whether other forms are tried, too."""
    rule: StairRule = TO_RULE


def drawn_stairs(plan: Plan, shift_m: tuple[float, float] = (0.0, 0.0)) -> list[Polygon]:
    """The stairs seen on a plan's picture, in metres, moved by a shift."""
    outlines = []
    for corners in plan.extra.get(DRAWN_STAIRS, ()):
        points = np.array([[m_from_cm(x), m_from_cm(y)] for x, y in corners]) + shift_m
        outlines.append(Polygon(points).buffer(0))
    return outlines


def seen_on_both(below: Sequence[Polygon], above: Sequence[Polygon]) -> list[Polygon]:
    """Stairs between two storeys: what both show at one place, as far as either shows it; where
    only one shows stairs, those. A long one is no wider than both show it: walls are beside it.
    Where each shows one end of a stair that turns, its ends are near each other; of a spiral stair
    the storey shows all that shows a circle, or a square."""
    if not below or not above:
        return [*below, *above]
    pairs = [(low, high) for low in below for high in above]
    at_once = [pair for pair in pairs if pair[0].intersects(pair[1])]
    ends = [pair for pair in pairs if pair[0].distance(pair[1]) < _TURN_M]
    return [_together(low, high) for low, high in at_once or ends]


def _together(low: Polygon, high: Polygon) -> Polygon:
    turning = [outline for outline in (low, high) if is_round(outline) or _is_square(outline)]
    if turning:
        return min(turning, key=lambda outline: outline.area)
    around = low.union(high).minimum_rotated_rectangle
    frame = _frame_of(around)
    (length, width, _), shown = frame.size_m, []
    if length < _LONG * width:
        return low.union(high).convex_hull
    for outline in (low, high):
        across = to_own(frame, np.asarray(outline.exterior.coords))[:, 1]
        shown.append((float(across.min()), float(across.max())))
    near, far = max(span[0] for span in shown), min(span[1] for span in shown)
    corners = [(-length / 2, near), (length / 2, near), (length / 2, far), (-length / 2, far)]
    return Polygon(to_world(frame, corners))


def _is_square(area: Polygon) -> bool:
    """Whether a spiral stair may be what is seen so."""
    length, width, _ = _frame_of(area.minimum_rotated_rectangle).size_m
    return length <= _SQUARE_M[1] and width >= _SQUARE_M[0] and length <= _SQUARE * width


def _frame_of(rectangle: Polygon) -> Box:
    """A rectangle as a box whose length is its longer side."""
    corners = np.asarray(rectangle.exterior.coords)[:4]
    sides = np.roll(corners, -1, axis=0) - corners
    lengths = np.hypot(*sides[:2].T)
    first = int(lengths.argmax())
    yaw_deg = float(np.degrees(np.arctan2(sides[first][1], sides[first][0])))
    x, y = corners.mean(axis=0).tolist()
    return Box((x, y, 0.0), (float(lengths.max()), float(lengths.min()), 1.0), yaw_deg)


def grown_stair(
    area: Polygon, name: str, lower: Plan, upper: Plan, height_m: float
) -> Stair | None:
    """As placed_stair, for one seen on a picture: as much longer as it has to be, and can be;
    what is drawn round as a spiral stair, with winders where no other fits; steeper and narrower
    than the rule where none to rule fits."""
    clear = _clear_of_walls(area, lower, upper)
    likely = _likely(StairShape(area))
    kinds = [
        tuple(form for form in likely if form == "spiral"),
        tuple(form for form in likely if form not in (*_WINDERS, "spiral")),
        _WINDERS,
    ]
    places = [area, *(_with_landing(clear) if clear is not area else [])]
    ways = itertools.product((TO_RULE, STEEP), places, filter(None, kinds), _GROWN_M)
    for rule, seen, forms, more_m in ways:
        shape = StairShape(seen, forms=forms, others=False, rule=rule)
        stair = placed_stair(shape, name, lower, upper, height_m, more_m)
        if stair is not None:
            return stair
    return None


def _clear_of_walls(area: Polygon, lower: Plan, upper: Plan) -> Polygon:
    """A long stair that was seen, as wide as the floor that both storeys have there: outlines of
    pictures lie some centimetres off, and its walls are beside it."""
    frame = _frame_of(area.minimum_rotated_rectangle)
    length, width, _ = frame.size_m
    free = _main_floor(lower, area).intersection(_main_floor(upper, area))
    if length < _LONG * width or free.intersection(area).area < _MOSTLY * area.area:
        return area
    yaw_deg = 90.0 * round(frame.yaw_deg / 90.0)
    if abs(frame.yaw_deg - yaw_deg) < _ASKEW_DEG:
        frame = replace(frame, yaw_deg=yaw_deg)
    along, across = (-length / 2, length / 2), (-width / 2, width / 2)
    across = _free_run(frame, free, across, along, 1, _MOSTLY)
    along = _free_run(frame, free, along, across, 0, _FREE_SHARE)
    across = _free_run(frame, free, across, along, 1, _FREE_SHARE, LEAST_WIDTH_M)
    corners = [(along[i], across[j]) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return Polygon(to_world(frame, corners))


def _main_floor(plan: Plan, area: Polygon) -> Polygon:
    """Of the room in which most of an area lies."""
    floors = map(room_polygon, plan.rooms)
    return max(floors, key=lambda floor: floor.intersection(area).area)


def _free_run(
    frame: Box,
    free: Polygon,
    span: tuple[float, float],
    aside: tuple[float, float],
    axis: int,
    share: float,
    least_m: float = 0.0,
) -> tuple[float, float]:
    """What of a span along an axis of a frame is floor, by strips as long as aside is wide, or a
    little more where that is less than the least. As given where little of it is floor."""
    places = np.arange(span[0] - _ASIDE_M, span[1] + _ASIDE_M, _STRIP_M)
    shares = []
    for at in places:
        ends = [
            (at, aside[0]),
            (at + _STRIP_M, aside[0]),
            (at + _STRIP_M, aside[1]),
            (at, aside[1]),
        ]
        strip = Polygon(to_world(frame, ends if axis == 0 else [(y, x) for x, y in ends]))
        shares.append(strip.intersection(free).area / strip.area)
    is_free = np.concatenate([[False], np.array(shares) >= share, [False]])
    starts = np.flatnonzero(is_free[1:] & ~is_free[:-1])
    stops = np.flatnonzero(is_free[:-1] & ~is_free[1:])
    pairs = zip(starts, stops, strict=True)
    runs = [(float(places[a]), float(places[b - 1]) + _STRIP_M) for a, b in pairs]
    half = (span[1] - span[0]) / 2
    runs = [run for run in runs if min(run[1], span[1]) - max(run[0], span[0]) > half]
    if not runs:
        return span
    low, high = max(runs[0][0], span[0]), min(runs[0][1], span[1])
    low = max(runs[0][0], low - max(least_m - (high - low), 0.0))
    return low, min(runs[0][1], max(high, low + least_m))


def _with_landing(area: Polygon) -> list[Polygon]:
    """A long stair as it was seen, and shorter at either end by a landing."""
    frame = _frame_of(area.minimum_rotated_rectangle)
    length, width, _ = frame.size_m
    if length < _LONG * width or length < 2 * LEAST_LANDING_M:
        return [area]
    half, short, aside = length / 2, length / 2 - LEAST_LANDING_M, width / 2
    ends = [(-half, short), (-short, half)]
    return [area, *(Polygon(to_world(frame, [(a, -aside), (b, -aside), (b, aside), (a, aside)]))
                    for a, b in ends)]  # fmt: skip


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
    for stair in (
        grown
        for candidate in _candidates(shape, name)
        for grown in _grown(candidate, more_m, height_m)
    ):
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


def with_stairwell(plan: Plan, area: Polygon, room_id: str) -> Plan:
    """The plan with a hall where a stair stands, as far as no room is there."""
    floors = unary_union([room_polygon(room) for room in plan.rooms])
    free = max(polygons_of(area.difference(floors)), key=lambda part: part.area, default=None)
    if free is None or free.area < _STAIRWELL_M2:
        return plan
    corners = frozen_array(orient(free).exterior.coords[:-1])
    return replace(plan, rooms=(*plan.rooms, Room(room_id, "corridor", corners, "Stairs")))


def _grown(stair: Stair, more_m: float | None, height_m: float) -> Iterator[Stair]:
    """Longer at its foot, and wide enough."""
    if more_m is None:
        yield stair
        return
    if stair.form == "spiral":
        yield from _resized(stair, more_m, least_square_m(height_m))
        return
    if stair.form == "straight":
        spare_m = stair.box.size_m[1] + more_m - least_run_m(height_m, stair.rule)
        more_m -= min(max(spare_m, 0.0), more_m, _GROWN_M[1])
    (width_m, depth_m, high_m), (x, y, z) = stair.box.size_m, stair.box.center_m
    ahead = np.radians(stair.box.yaw_deg + 90.0)
    back = more_m / 2
    center = (x - back * float(np.cos(ahead)), y - back * float(np.sin(ahead)), z)
    least_m = _FLIGHTS_WIDE[stair.form] * stair.rule.width_m + WELL_M * (stair.form in _WITH_WELL)
    wide_m = max(width_m, least_m) if least_m - width_m < _WIDENED_M else width_m
    size = (wide_m, depth_m + more_m, high_m)
    yield replace(stair, box=replace(stair.box, center_m=center, size_m=size))


def _resized(stair: Stair, less_m: float, least_m: float) -> Iterator[Stair]:
    """A spiral stair in a square smaller by so much, if that is no less than the least, or made as
    large as that; about its middle, and to two sides."""
    drawn_m, _, high_m = stair.box.size_m
    side_m = drawn_m - less_m if less_m else max(drawn_m, least_m)
    if side_m < least_m or side_m - drawn_m > _WIDENED_M:
        return
    aside = abs(side_m - drawn_m) / 2
    for to in ((0.0, 0.0), *itertools.product((-aside, aside), repeat=2)):
        (x, y), z = to_world(stair.box, [to])[0], stair.box.center_m[2]
        box = Box((float(x), float(y), z), (side_m, side_m, high_m), stair.box.yaw_deg)
        yield replace(stair, box=box)


def _refuse_walls(built: BuiltStair, lower: Plan, upper: Plan) -> None:
    for plan, area in ((lower, built.under_m), (upper, built.above_m)):
        cells = unary_union([room_polygon(room) for room in plan.rooms if is_cell(room)])
        floors = [room_polygon(room).union(cells) for room in plan.rooms]
        shares = [floor.intersection(area).area / area.area for floor in floors]
        if max(shares) < _IN_ONE_ROOM:
            raise PlanError("a stair there would stand in a wall")


def _off_m(built: BuiltStair, shape: StairShape) -> float:
    """How far a stair begins and ends from where the drawn one does."""
    if shape.ends is None:
        return 0.0
    places = [built.departure_m, built.arrival_m]
    if built.is_spiral:  # its edges say less than where its lowest and its highest treads lie
        share = _END_SHARE * built.height_m
        lowest = [tread.area_m for tread in built.treads if tread.top_m <= share]
        highest = [tread.area_m for tread in built.treads if tread.top_m >= built.height_m - share]
        middles = [unary_union(areas).centroid.coords[0] for areas in (lowest, highest)]
        places = [Point(at) for at in to_world(built.stair.box, middles)]
    return sum(place.distance(Point(end)) for place, end in zip(places, shape.ends, strict=True))


def _likely(shape: StairShape) -> tuple[StairForm, ...]:
    """Forms, the likeliest first."""
    length, width, _ = _frame_of(shape.area.minimum_rotated_rectangle).size_m
    is_long = length >= _LONG * max(width, 1e-6)
    fills = shape.area.area / max(length * width, 1e-6)
    forms: tuple[StairForm, ...] = ("straight", "U", "L") if is_long else ("U", "L", "straight")
    if fills < _FILLED and not is_long:
        forms = ("L", "U", "straight")
    if is_round(shape.area):
        forms = ("spiral", "U", "L", "straight")
    elif _is_square(shape.area):
        return (*forms, *_WINDERS, "spiral")
    return (*forms, *_WINDERS)


def _candidates(shape: StairShape, name: str) -> Iterator[Stair]:
    """The likeliest first."""
    frame = _frame_of(shape.area.minimum_rotated_rectangle)
    if is_round(shape.area):  # nothing says how its square lies: as most walls do
        side_m = round(float(np.sqrt(frame.size_m[0] * frame.size_m[1])), 3)
        frame = Box(frame.center_m, (side_m, side_m, 1.0), 0.0)
    others = [form for form in _likely(shape) if form not in shape.forms] if shape.others else []
    for form, quarter in itertools.product((*shape.forms, *others), range(4)):
        width, depth = frame.size_m[:2] if quarter % 2 == 0 else frame.size_m[1::-1]
        if form == "spiral":
            width = depth = round((width + depth) / 2 + 2 * RIM_M, 2)
        box = Box(frame.center_m, (width, depth, 1.0), frame.yaw_deg + 90.0 * quarter)
        ahead = np.radians(box.yaw_deg + 90.0)
        along = 1.0 if shape.up is None else float(shape.up @ [np.cos(ahead), np.sin(ahead)])
        if form == "straight" and along < _ALONG:
            continue
        turns: tuple[Turn, ...] = ("right",) if form == "straight" else ("right", "left")
        for turn in turns:
            yield Stair(name, form, box, turn, rule=shape.rule)
