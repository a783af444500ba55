"""Widths that units are sold in, and how a gap is filled with them. In cells of CELL_M."""

from __future__ import annotations

from functools import cache

import numpy as np

from chord_usd.line.compose.runs import CELL_M, MOST_CELLS

WIDTHS_M = 0.15, 0.2, 0.3, 0.4, 0.45, 0.5, 0.6, 0.8, 0.9, 1.0
WIDTHS = tuple(round(width / CELL_M) for width in WIDTHS_M)
_NARROW = 6
"""Pull-outs are narrower: dear for what they hold."""
LONGEST = MOST_CELLS + 1

CORNER_DOORS = 9, 8, 10, 7, 6
"""Of what opens of a corner unit, with the filler beside it; the best first."""
DISHWASHERS = 12, 9


@cache
def splits(gap: int) -> tuple[tuple[int, ...], ...]:
    """The ways to fill a gap with the fewest units, ascending; () where there is none."""
    if gap == 0:
        return ((),)
    best: dict[tuple[int, ...], None] = {}
    fewest = 1e9
    for width in WIDTHS:
        rest = splits(gap - width) if gap >= width else ()
        for way in rest:
            row = tuple(sorted((*way, width)))
            cost = sum(2 if width < _NARROW else 1 for width in row)
            if cost < fewest:
                best, fewest = {}, cost
            if cost == fewest:
                best[row] = None
    return tuple(best)


def _narrow(gap: int) -> int:
    return min((sum(width < _NARROW for width in way) for way in splits(gap)), default=0)


FITS = np.array([bool(splits(gap)) for gap in range(LONGEST)])
"""(LONGEST,) whether units fill a gap."""
NARROW = np.array([_narrow(gap) for gap in range(LONGEST)])
"""(LONGEST,) pull-outs in a gap that units fill."""
FILLED = np.array([max(width for width in range(gap + 1) if FITS[width]) for gap in range(LONGEST)])
"""(LONGEST,) most of a gap that units fill."""


def corner_doors(gap: int, hidden: int, low: bool, high: bool) -> tuple[int, int] | None:
    """What opens of the units in the corners at both ends of a gap, 0 where there is no corner;
    None where no units fill the rest."""
    for first in CORNER_DOORS if low else (-hidden,):
        for last in CORNER_DOORS if high else (-hidden,):
            rest = gap - 2 * hidden - first - last
            if rest >= 0 and FITS[rest]:
                return max(first, 0), max(last, 0)
    return None


@cache
def cornered(hidden: int) -> tuple[bool, ...]:
    """By gap, whether a corner unit and others fill it."""
    return tuple(corner_doors(gap, hidden, True, False) is not None for gap in range(LONGEST))


@cache
def washed(hidden: int) -> tuple[bool, ...]:
    """By gap, whether a dishwasher and others fill it. hidden: cells of a unit in its corner."""
    corner = hidden + CORNER_DOORS[-1] if hidden else 0
    return tuple(
        any(gap - corner - width >= 0 and FITS[gap - corner - width] for width in DISHWASHERS)
        for gap in range(LONGEST)
    )
