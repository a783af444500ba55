"""The shapes that a kitchen can have in a room: one wall, galley, L, U, and an island."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product
from typing import Literal

import numpy as np
import shapely

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.compose.site import Site, Span, Wall

CELL_M = 0.05
"""Widths of units are multiples of it."""
LEAST_M = 0.6
"""No run is shorter."""
LEAST_ALONE_M = 1.2
MOST_CELLS = 120
"""No run is longer."""
LEAST_DOOR_M = 0.3
"""Of the part of a corner unit that opens."""

End = Literal["free", "wall", "corner", "beside corner"]
"""What a run ends at: nothing; a wall beside it; the wall of another run, with a unit in the corner
of which one depth is hidden; the front of that unit."""
Form = Literal["one wall", "galley", "L", "U"]

_LENGTHS_M = 1.8, 2.4, 3.0, 3.6, 4.2, 4.8
"""Of runs that could be longer."""
_SQUARE = 0.03
_AT_CORNER_M = 0.02
_BETWEEN_FRONTS_M = 0.85
_WIDEST_AISLE_M = 2.4
"""Runs that are farther apart are no galley."""


@dataclass(frozen=True, eq=False)
class Run:
    """A stretch of units along a wall, in cells of CELL_M."""

    wall: Wall
    low: float
    """Where it begins along the wall, metres."""
    cells: int
    depth: float
    ends: tuple[End, End]
    slack: float = 0.0
    """What is left between two fixed ends; one of its units takes it."""
    clear: FloatArray = field(default_factory=lambda: np.zeros(0))
    """(cells,) free floor before each cell, metres."""

    @property
    def high(self) -> float:
        """Where it ends along the wall."""
        return self.low + self.cells * CELL_M + self.slack

    @cached_property
    def corners(self) -> FloatArray:
        """(4, 2) of its footprint."""
        return self.wall.rectangle(self.low, self.high, 0.0, self.depth)

    @cached_property
    def footprint(self) -> shapely.Polygon:
        """The floor that it stands on."""
        return shapely.Polygon(self.corners)

    @property
    def hidden(self) -> int:
        """Cells of a corner unit that the other run stands before."""
        return round(self.depth / CELL_M)


@dataclass(frozen=True, eq=False)
class Shape:
    """One or more runs."""

    form: Form
    runs: tuple[Run, ...]

    @property
    def is_linked(self) -> bool:
        """Whether one worktop goes through."""
        return self.form != "galley"


def shapes(
    site: Site, depth: float, height: float, least_alone: float = LEAST_ALONE_M
) -> Iterator[Shape]:
    """Every shape that the free walls of a room allow, at full length and shorter.

    least_alone: metres of a run without another.
    """
    spans = {
        wall.index: [_Stretch(wall, *span) for span in wall.spans(depth, height, LEAST_M)]
        for wall in site.walls
    }
    every = [stretch for wall_spans in spans.values() for stretch in wall_spans]
    for stretch in every:
        if stretch.length >= least_alone:
            yield from (Shape("one wall", (run,)) for run in _cut(stretch.run(depth)))
    for index, stretch in enumerate(every):
        for other in every[index + 1 :]:
            if _faces(stretch, other, depth):
                both = product(_cut(stretch.run(depth)), _cut(other.run(depth)))
                yield from (Shape("galley", runs) for runs in both)
    pairs = [(first, other) for first in every for other in every if _meets(first, other)]
    for stretch, other in pairs:
        yield from _corner(stretch, other, depth)
        for again, third in pairs:
            if again is other and third is not stretch:
                yield from _two_corners(stretch, other, third, depth)


@dataclass(frozen=True, eq=False)
class _Stretch:
    """Free wall."""

    wall: Wall
    low: float
    high: float

    @property
    def length(self) -> float:
        return self.high - self.low

    def run(self, depth: float) -> Run:
        """Over all of it."""
        at_low: End = "wall" if self.low < _AT_CORNER_M else "free"
        at_high: End = "wall" if self.high > self.wall.length_m - _AT_CORNER_M else "free"
        return _run(self.wall, (self.low, self.high), depth, (at_low, at_high))


def _run(wall: Wall, span: Span, depth: float, ends: tuple[End, End]) -> Run:
    cells = int((span[1] - span[0] + 1e-6) / CELL_M)
    rest = span[1] - span[0] - cells * CELL_M
    if "free" not in ends:
        return Run(wall, span[0], cells, depth, ends, rest)
    return Run(wall, span[0] + (rest if ends[0] == "free" else 0.0), cells, depth, ends)


def _cut(run: Run) -> Iterator[Run]:
    """The run, and shorter ones that end earlier at one end."""
    if run.cells <= MOST_CELLS:
        yield run
    for length in _LENGTHS_M:
        cells = round(length / CELL_M)
        spare = run.cells - cells
        if spare < 6:
            continue
        if run.ends[1] in ("free", "wall"):
            yield replace(run, cells=cells, ends=(run.ends[0], "free"), slack=0.0)
        if run.ends[0] in ("free", "wall"):
            low = run.high - cells * CELL_M
            yield replace(run, low=low, cells=cells, ends=("free", run.ends[1]), slack=0.0)


def _faces(stretch: _Stretch, other: _Stretch, depth: float) -> bool:
    """Whether two walls look at each other, with an aisle between their runs."""
    apart = stretch.wall.local(other.wall.start_m)[1]
    if stretch.wall.along @ other.wall.along > -1 + _SQUARE:
        return False
    ends = stretch.wall.local(
        np.array([other.wall.at(other.low, 0.0), other.wall.at(other.high, 0.0)])
    )
    beside = min(stretch.high, ends[:, 0].max()) - max(stretch.low, ends[:, 0].min())
    aisle = apart - 2 * depth
    return bool(_BETWEEN_FRONTS_M <= aisle <= _WIDEST_AISLE_M and beside > LEAST_M)


def _meets(stretch: _Stretch, other: _Stretch) -> bool:
    """Whether a stretch ends in the square inner corner where another one begins."""
    return bool(
        np.hypot(*(stretch.wall.at(stretch.wall.length_m, 0.0) - other.wall.start_m)) < _AT_CORNER_M
        and stretch.wall.inward @ other.wall.along > 1 - _SQUARE**2
        and stretch.high > stretch.wall.length_m - _AT_CORNER_M
        and other.low < _AT_CORNER_M
    )


def _corner(stretch: _Stretch, other: _Stretch, depth: float) -> Iterator[Shape]:
    """L: the unit in the corner belongs to one of the two runs."""
    first, second = stretch.run(depth), other.run(depth)
    blind = depth + LEAST_DOOR_M
    if other.length >= blind and stretch.length - depth >= LEAST_M:
        begins = _run(
            stretch.wall,
            (stretch.low, stretch.high - depth),
            depth,
            (first.ends[0], "beside corner"),
        )
        goes_on = replace(second, ends=("corner", second.ends[1]))
        yield from _ls(begins, goes_on)
    if stretch.length >= blind and other.length - depth >= LEAST_M:
        begins = replace(first, ends=(first.ends[0], "corner"))
        span = (other.low + depth, other.high)
        goes_on = _run(other.wall, span, depth, ("beside corner", second.ends[1]))
        yield from _ls(begins, goes_on)


def _ls(run: Run, other: Run) -> Iterator[Shape]:
    yield from (Shape("L", runs) for runs in product(_cut(run), _cut(other)))


def _two_corners(
    stretch: _Stretch, middle: _Stretch, other: _Stretch, depth: float
) -> Iterator[Shape]:
    """U: the middle run has both corners."""
    aisle = middle.length - 2 * depth
    if aisle < _BETWEEN_FRONTS_M or min(stretch.length, other.length) - depth < LEAST_M:
        return
    if middle.length > MOST_CELLS * CELL_M:
        return
    along = replace(middle.run(depth), ends=("corner", "corner"))
    first, last = stretch.run(depth), other.run(depth)
    left = _run(
        stretch.wall, (stretch.low, stretch.high - depth), depth, (first.ends[0], "beside corner")
    )
    right = _run(
        other.wall, (other.low + depth, other.high), depth, ("beside corner", last.ends[1])
    )
    for begins, ends in product(_cut(left), _cut(right)):
        yield Shape("U", (begins, along, ends))


def seen(site: Site, shape: Shape) -> Shape:
    """The shape, its runs with the free floor before them."""
    return replace(shape, runs=tuple(
        replace(run, clear=_clear(site, run, [other for other in shape.runs if other is not run]))
        for run in shape.runs
    ))  # fmt: skip


def _clear(site: Site, run: Run, others: Sequence[Run]) -> FloatArray:
    s = run.low + (np.arange(run.cells) + 0.5) * CELL_M
    points = run.wall.start_m + s[:, None] * run.wall.along + run.depth * run.wall.inward
    sides = [np.stack([c, np.roll(c, -1, axis=0)], axis=1) for c in (o.corners for o in others)]
    return site.clear_m(points, run.wall.inward, np.concatenate([np.zeros((0, 2, 2)), *sides]))
