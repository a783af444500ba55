"""Where the refrigerator stands, and an oven tower beside it: what is tall ends a run."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
import shapely

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.compose.prices import LANDING_M, NARROW_AISLE_M, price, short, worktop_m
from chord_usd.line.compose.runs import CELL_M, Run, Shape
from chord_usd.line.compose.site import TOUCH_M, Site, Wall

TALL_DEPTH_M = 0.6
TALL_HEIGHT_M = 2.1
TALL_CELLS = 12
_TOWER_FROM_M2 = 7.5
_TOWER_SPARES_M = 0.2
"""A tower stands where there is so much more worktop than is needed."""
_BESIDE_M2 = 0.02
"""Of the floor before a run, what may stand on it at most."""
_ALONE = 10
"""Places apart from the runs that are looked at."""


@dataclass(frozen=True, eq=False)
class Talls:
    """What is tall in a kitchen."""

    run: int | None = None
    """Which run the refrigerator ends; None where it stands apart, or nowhere."""
    end: int = 0
    """0 where that begins, else 1."""
    tower: bool = False
    wall: Wall | None = None
    """Where it stands apart."""
    low: float = 0.0
    front: FloatArray | None = None
    """(2,) middle of its front; None without a refrigerator."""
    cost: float = 0.0
    least: float = 0.0
    """What this place and all after it cost at least."""

    def cells(self, run: int, end: int) -> int:
        """What of an end of a run is tall."""
        return TALL_CELLS * (1 + self.tower) if (run, end) == (self.run, self.end) else 0

    @property
    def all_cells(self) -> int:
        """Of the runs."""
        return 0 if self.run is None else self.cells(self.run, self.end)


def talls(site: Site, shape: Shape, wanted: bool, towers: bool) -> Iterator[Talls]:
    """Every place of the refrigerator, if one is wanted. towers: whether one may stand beside."""
    if not wanted:
        yield Talls()
        return
    for index, run in enumerate(shape.runs):
        for end in (0, 1):
            if run.ends[end] in ("free", "wall"):
                yield from _at_end(site, shape, (index, end), towers)
    nowhere = price("no refrigerator", site.area_m2)
    apart = price("refrigerator apart", site.area_m2)
    yield Talls(cost=nowhere, least=apart)
    yield from _apart(site, shape)


def _at_end(
    site: Site, shape: Shape, place: tuple[int, int], towers: bool
) -> Iterator[Talls]:  # fmt: skip
    index, end = place
    run = shape.runs[index]
    worktop = sum(run.cells for run in shape.runs) * CELL_M - worktop_m(site.area_m2)
    for tower in (False, True)[: 1 + towers]:
        cells = TALL_CELLS * (1 + tower)
        spare = worktop - cells * CELL_M
        if run.cells - cells < TALL_CELLS or (tower and spare < _TOWER_SPARES_M):
            continue
        if tower and site.area_m2 < _TOWER_FROM_M2:
            continue
        low = run.low if end == 0 else run.high - cells * CELL_M
        if not stands(run.wall, low, low + cells * CELL_M):
            continue
        inner = low + (cells - TALL_CELLS) * CELL_M if end == 0 else low
        seen = _clear(run, inner)
        cost = short(seen, NARROW_AISLE_M + 0.05, price("aisle", site.area_m2))
        cost -= 0.8 if tower else 0.0
        front = run.wall.at(inner + TALL_CELLS * CELL_M / 2, TALL_DEPTH_M)
        yield Talls(index, end, tower, None, inner, front, float(cost))


def _clear(run: Run, inner: float) -> float:
    """Free floor before a refrigerator in a run."""
    first = max(round((inner - run.low) / CELL_M), 0)
    before = run.clear[first : first + TALL_CELLS]
    return float(before.min(initial=9.0)) - (TALL_DEPTH_M - run.depth)


def stands(wall: Wall, low: float, high: float) -> bool:
    """Whether what is tall may stand between two places along a wall."""
    spans = wall.spans(TALL_DEPTH_M, TALL_HEIGHT_M, high - low)
    return any(a < low + 1e-3 and b > high - 1e-3 for a, b in spans)


def _apart(site: Site, shape: Shape) -> Iterator[Talls]:
    """Along walls where no run stands, nor the floor before one."""
    kept = shapely.union_all([
        shapely.Polygon(run.wall.rectangle(run.low, run.high, 0.0, run.depth + NARROW_AISLE_M))
        for run in shape.runs
    ])  # fmt: skip
    stood_on = shapely.union_all([run.footprint for run in shape.runs])
    length = TALL_CELLS * CELL_M
    options = []
    for wall in site.walls:
        for a, b in wall.spans(TALL_DEPTH_M, TALL_HEIGHT_M, length):
            for low in dict.fromkeys((round(a, 4), round(b - length, 4))):
                box = shapely.Polygon(wall.rectangle(low, low + length, 0.0, TALL_DEPTH_M))
                is_clear = box.intersection(stood_on).area < TOUCH_M
                if is_clear and box.intersection(kept).area < _BESIDE_M2:
                    options.append(_one_apart(site, shape, wall, low))
    options.sort(key=lambda option: option.cost)
    yield from options[:_ALONE]


def _one_apart(site: Site, shape: Shape, wall: Wall, low: float) -> Talls:
    length = TALL_CELLS * CELL_M
    points = np.array([wall.at(low + s, TALL_DEPTH_M) for s in (0.05, 0.3, 0.55)])
    sides = [np.stack([run.corners, np.roll(run.corners, -1, axis=0)], axis=1)
             for run in shape.runs]  # fmt: skip
    clear = site.clear_m(points, wall.inward, np.concatenate(sides)).min()
    across = shapely.Polygon(wall.rectangle(low, low + length, TALL_DEPTH_M, TALL_DEPTH_M + 1.22))
    lands = any(across.intersection(run.footprint).area > 0.5 * LANDING_M * 0.3
                for run in shape.runs)  # fmt: skip
    cost = price("refrigerator apart", site.area_m2)
    cost += 0.0 if lands else price("landing", site.area_m2)
    cost += float(short(clear, NARROW_AISLE_M, price("aisle", site.area_m2)))
    beside = min(run.footprint.distance(shapely.Point(points[1]))
                 for run in shape.runs)  # fmt: skip
    return Talls(None, 0, False, wall, low, points[1], cost + 0.3 * beside, cost)
