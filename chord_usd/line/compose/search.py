"""The places of sink and cooker: every pair on the grid, priced by published numbers.

Shapes and tall units are tried from the cheapest on, by what they cost at least; once that is more
than the best whole kitchen costs, nothing better is left.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import shapely

from chord_usd.base.scene.types import BoolArray, FloatArray
from chord_usd.line.compose import prices
from chord_usd.line.compose.prices import price, short
from chord_usd.line.compose.runs import CELL_M, LEAST_ALONE_M, Run, Shape, seen, shapes
from chord_usd.line.compose.site import Site
from chord_usd.line.compose.talls import Talls, talls
from chord_usd.line.compose.widths import FILLED, FITS, NARROW, cornered, washed

TASTE = 1.5
"""Most that a form of kitchen costs more in the taste of one home than in that of another."""
LIKING = 0.5
"""Most that a place of sink and cooker does."""
_GOOD = 18.0
"""Cost of a kitchen that misses no more than two numbers or so; less deep units gain little."""
EFFORT = 40
"""Shapes looked at, the most promising first."""
COOKER_CELLS = 12
SINK_CELLS = 12, 16
"""The wider one where there is much worktop."""
_COMPACT_SINK_CELLS = 10
_COMPACT_RUN_M = (_COMPACT_SINK_CELLS + COOKER_CELLS) * CELL_M
_WIDE_SINK_FROM_M = 3.4
_WIDE_SINKS = 0.6
"""Share of such kitchens."""
_AT_WINDOW_M = 0.2
_HINTED, _GUESSED = 2.0, 0.2
"""Price of a metre between units that somebody has placed and the runs, on average; between sink or
cooker and its place there."""
_DRAWN = 20.0, 12.0
"""The same where a plan shows them."""
_PULL_OUT = 0.3
"""Price of a unit that is narrower than others, for what it holds."""
_WALL_CELLS = 3
"""Between cooker and side wall."""


Hint = tuple[str, float, float]
"""Category and middle, world metres, of a unit that somebody has placed."""


@dataclass(frozen=True)
class Wanted:
    """What a kitchen is to hold, and where it is known to stand."""

    refrigerator: bool = True
    appliances: bool = True
    """A dishwasher and an oven tower."""
    hints: tuple[Hint, ...] = ()
    height: float = 0.87
    """Of worktops."""
    effort: int = EFFORT
    compact: bool = False
    """Whether a narrow sink will do, and a run that holds sink and cooker alone."""
    is_drawn: bool = False
    """Whether hints are what the plan shows, and no guess."""

    @property
    def metre_cost(self) -> tuple[float, float]:
        """Of a metre between hints and the runs, on average; between a unit and its hint."""
        return _DRAWN if self.is_drawn else (_HINTED, _GUESSED)


@dataclass(frozen=True, eq=False)
class Found:
    """One kitchen: where everything that is not plain stands."""

    cost: float
    shape: Shape
    talls: Talls
    sink: tuple[int, int, int]
    """Run, first cell and cells."""
    cooker: tuple[int, int, int]


@dataclass(frozen=True, eq=False)
class _Row:
    """All places of one unit in one run."""

    run: int
    first: np.ndarray
    cells: int
    low: np.ndarray
    """(N,) cells between it and what is fixed at the run's beginning; high: at its end."""
    high: np.ndarray
    front: FloatArray
    """(N, 2) middle of its front."""
    clear: FloatArray
    cost: FloatArray
    """(N,) what the place costs by itself."""


def search(site: Site, wanted: Wanted, depth: float, rng: np.random.Generator) -> Iterator[Found]:
    """Kitchens so deep, the best of each shape, from the cheapest on."""
    taste = {form: rng.uniform(0.0, TASTE) for form in ("one wall", "galley", "L", "U")}
    options: list[tuple[float, int, Shape]] = []
    alone = _COMPACT_RUN_M if wanted.compact else LEAST_ALONE_M
    for shape in shapes(site, depth, wanted.height, alone):
        least = _shape_cost(site, shape, wanted) + taste[shape.form] + rng.uniform(0.0, TASTE)
        options.append((least, len(options), shape))
    options.sort(key=lambda option: option[:2])
    best, layouts = np.inf, []
    for least, _, bare in options[: wanted.effort]:
        if least > best:
            break
        shape = seen(site, bare)
        least += _aisle_cost(site, shape)
        for tall in talls(site, shape, wanted.refrigerator, wanted.appliances):
            # Those that stand apart come last, and cost the most.
            start = least + tall.cost + _worktop_cost(site, shape, tall)
            if least + tall.least > best:
                break
            layout = _best_pair(site, shape, tall, wanted, (start, best), rng)
            if layout is not None:
                layouts.append(layout)
                best = min(best, layout.cost)
    yield from sorted(layouts, key=lambda layout: layout.cost)


def _shape_cost(site: Site, shape: Shape, wanted: Wanted) -> float:
    """What a shape costs wherever its units stand."""
    area = site.area_m2
    runs = [run.footprint for run in shape.runs]
    length = sum(run.cells for run in shape.runs) * CELL_M
    cost = float(short(length, prices.worktop_m(area), price("worktop", area)))
    tall_m = 0.6 if wanted.refrigerator else 0.0
    cost += 0.6 * max(0.0, length - tall_m - max(prices.worktop_m(area) + 0.3, 0.45 * area + 1.0))
    cost += 0.3 * (len(shape.runs) - 1)
    cost += 2.0 * sum(run.cells < 18 and "corner" not in run.ends for run in shape.runs)
    if site.pieces:
        over = sum(run.intersection(piece).area for run in runs for piece in site.pieces)
        cost += price("piece in place", area) * min(1.5, 2.0 * over)
    cost += price("way shut", area) * sum(
        any(line.intersection(run).length > 0.1 for run in runs) for line in site.way_lines
    )
    if wanted.hints:
        walls = shapely.union_all(runs)
        away = [min(walls.distance(shapely.Point(x, y)), 1.5) for _, x, y in wanted.hints]
        cost += wanted.metre_cost[0] * sum(away) / len(away)
    return cost


def _aisle_cost(site: Site, shape: Shape) -> float:
    return (
        price("narrow aisle", site.area_m2)
        * 0.5
        * sum(float(np.median(run.clear)) < prices.NARROW_AISLE_M - 0.01 for run in shape.runs)
    )


def _worktop_cost(site: Site, shape: Shape, tall: Talls) -> float:
    """Beyond what the shape costs as if nothing in it were tall."""
    area = site.area_m2
    cells = sum(run.cells for run in shape.runs)
    need, whole = prices.worktop_m(area), price("worktop", area)
    worktop = (cells - tall.all_cells) * CELL_M
    cost = float(short(worktop, need, whole) - short(cells * CELL_M, need, whole))
    return cost + float(short(worktop - 1.2, prices.PLAIN_M, price("plain", area)))


def _best_pair(
    site: Site, shape: Shape, tall: Talls, wanted: Wanted, bounds: tuple[float, float],
    rng: np.random.Generator,
) -> Found | None:  # fmt: skip
    """The best places of sink and cooker in a shape. bounds: what it costs at least, and at most to
    be worth a look."""
    worktop = sum(run.cells for run in shape.runs) * CELL_M - tall.all_cells * CELL_M
    is_wide = worktop > _WIDE_SINK_FROM_M and rng.random() < _WIDE_SINKS
    sink_cells = _COMPACT_SINK_CELLS if wanted.compact else SINK_CELLS[is_wide]
    best: Found | None = None
    start, most = bounds
    if start > most:
        return None
    cookers = _rows(site, shape, tall, wanted, COOKER_CELLS, False)
    for sink in _rows(site, shape, tall, wanted, sink_cells, True):
        for cooker in cookers:
            if start + sink.cost.min() + cooker.cost.min() > most:
                continue
            cost = start + _pair_costs(site, shape, tall, sink, cooker)
            cost = cost + rng.uniform(0.0, LIKING, cost.shape)
            at = np.unravel_index(int(cost.argmin()), cost.shape)
            if np.isfinite(cost[at]) and (best is None or cost[at] < best.cost):
                best = Found(
                    float(cost[at]), shape, tall,
                    (sink.run, int(sink.first[at[0]]), sink_cells),
                    (cooker.run, int(cooker.first[at[1]]), COOKER_CELLS),
                )  # fmt: skip
    return best


def _rows(
    site: Site, shape: Shape, tall: Talls, wanted: Wanted, cells: int, is_sink: bool
) -> list[_Row]:
    rows = []
    for index, run in enumerate(shape.runs):
        low, high = tall.cells(index, 0), tall.cells(index, 1)
        first = np.arange(low, run.cells - high - cells + 1)
        if not len(first):
            continue
        s = run.low + first * CELL_M
        middle = s + cells * CELL_M / 2
        front = run.wall.start_m + middle[:, None] * run.wall.along + run.depth * run.wall.inward
        clear = np.lib.stride_tricks.sliding_window_view(run.clear[1:-1], cells - 2)[first].min(1)
        gaps = first - low, run.cells - high - cells - first
        cost = _place_cost(site, run, s, cells, is_sink)
        cost = cost + _corner_cost(site, run, gaps, (low, high), is_sink)
        cost = cost + 0.5 * _PULL_OUT * sum(NARROW[gap] for gap in gaps)
        name = "sink_cabinet" if is_sink else "cooker_cabinet"
        for category, x, y in wanted.hints:
            if category == name:
                inward = run.depth / 2 * run.wall.inward if wanted.is_drawn else 0.0
                away = np.hypot(*(front - inward - (x, y)).T)
                cost = cost + wanted.metre_cost[1] * np.minimum(away, 3.0)
        rows.append(_Row(index, first, cells, *gaps, front, clear, cost))
    return rows


def _place_cost(
    site: Site, run: Run, s: FloatArray, cells: int, is_sink: bool
) -> FloatArray:  # fmt: skip
    """Windows and doors."""
    area, end = site.area_m2, s + cells * CELL_M
    reach = _AT_WINDOW_M if is_sink else 0.0
    lit = np.zeros(len(s), bool)
    for low, high in run.wall.windows:
        shared = np.minimum(end + reach, high) - np.maximum(s - reach, low)
        lit |= shared > (0.15 if is_sink else 0.04)
    if is_sink:
        return np.where(lit, 0.0, price("sink at a window", area) * bool(site.sills))
    cost: FloatArray = np.where(lit, price("cooker below a window", area), 0.0)
    for door in site.doors:
        ends = run.wall.local(door)
        along = np.maximum(np.maximum(s - ends[:, 0].max(), ends[:, 0].min() - end), 0.0)
        deep = max(float(ends[:, 1].min()) - run.depth, -float(ends[:, 1].max()), 0.0)
        cost = np.where(
            np.hypot(along, deep) < prices.DOOR_M + 0.1,
            cost + price("cooker at a door", area),
            cost,
        )
    return cost


def _corner_cost(
    site: Site, run: Run, gaps: tuple[np.ndarray, np.ndarray], tall: tuple[int, int], is_sink: bool
) -> FloatArray:
    """Inner corners and side walls."""
    area = site.area_m2
    cost = np.zeros(len(gaps[0]))
    for gap, end, taken in zip(gaps, run.ends, tall, strict=True):
        if taken:
            continue
        away = gap - (run.hidden if end == "corner" else 0)
        if end in ("corner", "beside corner"):
            near = away < round(prices.CORNER_M / CELL_M)
            name = "sink in a corner" if is_sink else "cooker in a corner"
            cost = cost + np.where(near, price(name, area), 0.0)
        elif end == "wall":
            near = away < _WALL_CELLS
            cost = cost + np.where(
                near, price("sink in a corner" if is_sink else "cooker in a corner", area), 0.0
            )
    return cost


def _pair_costs(site: Site, shape: Shape, tall: Talls, sink: _Row, cooker: _Row) -> FloatArray:
    """(S, C) what each pair of places costs; infinite for what cannot be built."""
    area = site.area_m2
    run = shape.runs[sink.run]
    same_run = sink.run == cooker.run
    sides = [_beside(shape, tall, row) for row in (sink, cooker)]
    (sink_low, sink_high), (cook_low, cook_high) = (
        (low[:, None] if row is sink else low[None], high[:, None] if row is sink else high[None])
        for row, (low, high) in zip((sink, cooker), sides, strict=True)
    )
    fits_sink, fits_cooker = _fits(shape, tall, sink), _fits(shape, tall, cooker)
    cost = sink.cost[:, None] + cooker.cost[None]
    s_low, s_high = sink.low[:, None], sink.high[:, None]
    if same_run:
        before = sink.first[:, None] + sink.cells <= cooker.first[None]
        after = cooker.first[None] + cooker.cells <= sink.first[:, None]
        between = np.where(before, cooker.first[None] - sink.first[:, None] - sink.cells,
                           sink.first[:, None] - cooker.first[None] - cooker.cells)  # fmt: skip
        open_m = np.maximum(between, 0) * CELL_M
        sink_low, sink_high = np.where(after, open_m, sink_low), np.where(before, open_m, sink_high)
        cook_low, cook_high = np.where(before, open_m, cook_low), np.where(after, open_m, cook_high)
        s_low, s_high = np.where(after, between, s_low), np.where(before, between, s_high)
        fits = (before | after) & FITS[np.clip(between, 0, len(FITS) - 1)]
        fits &= np.where(before, fits_sink[0][:, None] & fits_cooker[1][None],
                         fits_cooker[0][None] & fits_sink[1][:, None])  # fmt: skip
        cost = cost + _PULL_OUT * NARROW[np.clip(between, 0, len(FITS) - 1)]
        cost = cost + np.where(between == 0, price("cooker touches", area), 0.0)
        cost = cost + 2.0 * np.clip(prices.PREPARATION_M - open_m, 0.0, 0.9)
    else:
        fits = (fits_sink[0] & fits_sink[1])[:, None] & (fits_cooker[0] & fits_cooker[1])[None]
        cost = cost + (0.3 if shape.is_linked else _across(site, shape, sink, cooker))
    fits = fits & _others_fit(shape, tall, {sink.run, cooker.run})
    cost = cost + _worktop_beside(area, (sink_low, sink_high), (cook_low, cook_high), sink.cells)
    cost = cost + _tall_beside(
        site, shape, tall, (sink, s_low, s_high), (cooker, cook_low, cook_high)
    )
    cost = cost + _legs(site, tall, sink, cooker)
    clear = np.minimum(sink.clear[:, None], cooker.clear[None])
    cost = cost + short(clear, prices.AISLE_M - 0.05, price("aisle", area))
    cost = cost + short(clear, prices.NARROW_AISLE_M, price("narrow aisle", area))
    cost = cost + price("dishwasher", area) * ~_washes(run, sink, s_low, s_high)
    if not shape.is_linked:
        cost = cost + price("idle run", area) * _idle(shape, tall, {sink.run, cooker.run})
    return np.where(fits, cost, np.inf)


def _beside(shape: Shape, tall: Talls, row: _Row) -> tuple[FloatArray, FloatArray]:
    """Metres of worktop from a unit to each end of its run, and round the corner there."""
    run = shape.runs[row.run]
    sides = []
    for gap, end, at in zip((row.low, row.high), run.ends, (0, 1), strict=True):
        metres = np.where(True, gap, 0) * CELL_M
        if not tall.cells(row.run, at):
            if end == "beside corner":
                metres = metres + run.depth
            elif end in ("free", "wall"):
                metres = FILLED[gap] * CELL_M
        sides.append(metres)
    return sides[0], sides[1]


def _fits(shape: Shape, tall: Talls, row: _Row) -> tuple[BoolArray, BoolArray]:
    """Whether units fill the run on both sides of a unit."""
    run = shape.runs[row.run]
    sides = []
    for gap, end, at in zip((row.low, row.high), run.ends, (0, 1), strict=True):
        if tall.cells(row.run, at) or end == "beside corner":
            sides.append(FITS[gap])
        elif end == "corner":
            sides.append(np.array(cornered(run.hidden))[gap])
        else:
            sides.append(np.ones(len(gap), bool))
    return sides[0], sides[1]


def _others_fit(shape: Shape, tall: Talls, used: set[int]) -> bool:
    """Whether units fill the runs with neither sink nor cooker."""
    for index, run in enumerate(shape.runs):
        if index in used:
            continue
        gap = run.cells - tall.cells(index, 0) - tall.cells(index, 1)
        corners = [end == "corner" for end in run.ends]
        if gap < 0 or (any(corners) and gap < sum(corners) * (run.hidden + 6)):
            return False
    return True


def _worktop_beside(
    area: float, sink: tuple[FloatArray, FloatArray], cooker: tuple[FloatArray, FloatArray],
    sink_cells: int,
) -> FloatArray:  # fmt: skip
    """Worktop on both sides of the cooker and of the sink."""
    least, most = np.minimum(*cooker), np.maximum(*cooker)
    cost = short(least, prices.COOKER_SIDES_M[0], price("cooker between worktops", area))
    cost = cost + short(most, prices.COOKER_SIDES_M[1], price("cooker beside 40", area))
    half_m = (sink_cells * CELL_M - 0.6) / 2
    least, most = np.minimum(*sink) + half_m, np.maximum(*sink) + half_m
    cost = cost + short(least, prices.SINK_END_M, price("sink at an end", area))
    cost = cost + short(least, prices.SINK_SIDES_M[0], price("sink beside 45", area))
    cost = cost + short(most, prices.SINK_SIDES_M[1], price("sink beside 60", area))
    return cost + short(most, prices.PREPARATION_M, price("preparation", area))


def _tall_beside(
    site: Site, shape: Shape, tall: Talls,
    sink: tuple[_Row, FloatArray, FloatArray], cooker: tuple[_Row, FloatArray, FloatArray],
) -> FloatArray:  # fmt: skip
    """Worktop beside the refrigerator, and what stands apart from it."""
    if tall.run is None:
        return np.zeros((1, 1))
    area = site.area_m2
    run = shape.runs[tall.run]
    most = run.cells - tall.cells(tall.run, tall.end)
    (sink_row, s_low, s_high), (cook_row, c_low, c_high) = sink, cooker
    to_sink = (s_low, s_high)[tall.end] * CELL_M if sink_row.run == tall.run else most * CELL_M
    to_cooker = (c_low, c_high)[tall.end] if cook_row.run == tall.run else most * CELL_M
    landing = np.minimum(to_sink, to_cooker)
    cost = short(landing, prices.LANDING_M, price("landing", area))
    touches = np.asarray(to_cooker) < CELL_M / 2
    cost = cost + np.where(touches, price("cooker touches", area), 0.0)
    if not shape.is_linked and tall.run not in (sink_row.run, cook_row.run):
        cost = cost + 0.7 * price("apart", area)
    return cost


def _legs(site: Site, tall: Talls, sink: _Row, cooker: _Row) -> FloatArray:
    """The triangle of fronts."""
    area = site.area_m2
    legs = [np.hypot(*(sink.front[:, None] - cooker.front[None]).transpose(2, 0, 1))]
    if tall.front is not None:
        legs.append(np.hypot(*(sink.front - tall.front).T)[:, None] + 0.0 * legs[0])
        legs.append(np.hypot(*(cooker.front - tall.front).T)[None] + 0.0 * legs[0])
    least, most = prices.LEGS_M
    each = [
        price("legs", area) * np.where(
            leg < least, 0.8 + 0.6 * (least - leg) / least,
            np.where(leg > most, 0.8 + 0.6 * np.minimum(leg - most, 1.0), 0.0),
        )
        for leg in legs
    ]  # fmt: skip
    cost = np.sum(each, axis=0)
    if area < prices.THREE_LEGS_M2 and len(legs) == 3:
        cost = cost - 0.8 * np.max(each, axis=0)
    cost = cost + short(np.min(legs, axis=0), prices.LEAST_LEG_M, price("least leg", area))
    return cost + price("way between", area) * _crossed(site.ways, sink.front, cooker.front)


def _crossed(ways: FloatArray, sinks: FloatArray, cookers: FloatArray) -> BoolArray:
    """(S, C) whether one of the ways through goes between sink and cooker."""
    crossed = np.zeros((len(sinks), len(cookers)), bool)
    for start, end in ways:
        side_s, side_c = (_side(start, end, points) for points in (sinks, cookers))
        parted = side_s[:, None] * side_c[None] < 0.0
        along = cookers[None] - sinks[:, None]
        from_s, from_e = start - sinks[:, None], end - sinks[:, None]
        turns = [
            along[..., 0] * leg[..., 1] - along[..., 1] * leg[..., 0] for leg in (from_s, from_e)
        ]
        crossed |= parted & (turns[0] * turns[1] < 0.0)
    return crossed


def _side(start: FloatArray, end: FloatArray, points: FloatArray) -> FloatArray:
    way, away = end - start, points - start
    turn: FloatArray = way[0] * away[:, 1] - way[1] * away[:, 0]
    return turn


def _across(site: Site, shape: Shape, sink: _Row, cooker: _Row) -> FloatArray:
    """What it costs that sink and cooker face each other over an aisle."""
    run = shape.runs[sink.run]
    gap = abs(float(run.wall.local(cooker.front[0])[1]) - run.depth)
    beside = np.abs((cooker.front[None] - sink.front[:, None]) @ run.wall.along)
    is_near = (gap <= 1.5) & (beside < 1.9)
    return np.where(is_near, 0.6, price("apart", site.area_m2))


def _idle(shape: Shape, tall: Talls, used: set[int]) -> bool:
    """Whether a run of a galley holds no work centre."""
    return any(index not in used and tall.run != index for index in range(len(shape.runs)))


def _washes(run: Run, sink: _Row, low: np.ndarray, high: np.ndarray) -> BoolArray:
    """Whether a dishwasher fits in beside the sink."""
    allowed = np.zeros(np.broadcast_shapes(np.shape(low), np.shape(high)), bool)
    for gap, end in zip((low, high), run.ends, strict=True):
        hidden = run.hidden if end == "corner" else 0
        table = np.array(washed(hidden))
        allowed = allowed | table[np.clip(gap, 0, len(table) - 1)]
    return allowed


def cheapest(
    site: Site,
    wanted: Wanted,
    rng: np.random.Generator,
    depths: Sequence[float],
    *,
    compact: bool = False,
) -> list[Found]:
    """The best kitchens of all depths, from the cheapest on; less deep ones, and compact ones, only
    where no other fits."""
    layouts: list[Found] = []
    for nth, depth in enumerate(depths):
        if layouts and layouts[0].cost < _GOOD:
            break
        extra = nth * price("shallow", site.area_m2)
        layouts += [
            replace(layout, cost=layout.cost + extra) for layout in search(site, wanted, depth, rng)
        ]
        layouts.sort(key=lambda layout: layout.cost)
    if not layouts and compact:
        return cheapest(site, replace(wanted, compact=True), rng, depths)
    return layouts
