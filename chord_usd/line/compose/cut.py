"""Runs cut into units of the widths that they are sold in."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from chord_usd.base.scene.types import Box
from chord_usd.line.compose.runs import CELL_M, Run
from chord_usd.line.compose.search import Found, Wanted
from chord_usd.line.compose.site import Wall
from chord_usd.line.compose.talls import TALL_CELLS, TALL_DEPTH_M, TALL_HEIGHT_M
from chord_usd.line.compose.widths import (
    CORNER_DOORS,
    DISHWASHERS,
    FILLED,
    FITS,
    corner_doors,
    splits,
)

Variety = Literal[
    "", "corner left", "corner right", "beside left", "beside right", "dishwasher", "tower",
    "island",
]  # fmt: skip
"""What a unit is beyond its category; in or beside a corner of two runs, which end is there (own
x, which runs against the wall's direction)."""
_BESIDE_FROM = 6
"""Cells of the narrowest unit with a filler."""

SINGLE, DOUBLE = "single_door_floor_cabinet", "double_door_floor_cabinet"
APPLIANCE = "electrical_floor_cabinet"
_DOUBLE_FROM = 12
"""Cells of the narrowest unit with two doors."""
_REFRIGERATOR_M = 1.85
_STRETCHED = 2
"""Cells that plain units are made wider at most, so that no slit is left beside a wall."""


@dataclass(frozen=True)
class Unit:
    """One unit of a composed kitchen."""

    category: str
    box: Box
    variety: Variety = ""


@dataclass
class _Slot:
    """A unit before it has a place: from, to, in cells."""

    category: str
    low: float
    high: float
    variety: Variety = ""

    @property
    def is_plain(self) -> bool:
        return self.category in (SINGLE, DOUBLE)


def units_of(layout: Found, wanted: Wanted, rng: np.random.Generator) -> list[Unit]:
    """The units of a kitchen, run by run."""
    units: list[Unit] = []
    washes = _dishwasher_side(layout) if wanted.appliances else None
    for index, run in enumerate(layout.shape.runs):
        slots = _beside_corner(run, _widened(run, list(_slots(layout, index, washes, rng))))
        units += [_unit(run, slot, wanted.height) for slot in slots]
        units += _tall_units(layout, index)
    apart = layout.talls.wall
    if apart is not None:
        low = layout.talls.low
        units.append(_refrigerator(apart, low, low + TALL_CELLS * CELL_M))
    return units


def _marks(layout: Found, index: int) -> list[tuple[int, int, str]]:
    """What is fixed in a run: first cell, last, category; with both ends."""
    run = layout.shape.runs[index]
    low, high = layout.talls.cells(index, 0), run.cells - layout.talls.cells(index, 1)
    placed = [
        (first, first + cells, category)
        for category, (at, first, cells) in (
            ("sink_cabinet", layout.sink), ("cooker_cabinet", layout.cooker),
        ) if at == index
    ]  # fmt: skip
    return [(low, low, ""), *sorted(placed), (high, high, "")]


def _gap_corners(run: Run, layout: Found, index: int, low: str, high: str) -> tuple[bool, bool]:
    """Whether a gap begins and ends with a unit in a corner."""
    talls = layout.talls
    return (
        not low and run.ends[0] == "corner" and not talls.cells(index, 0),
        not high and run.ends[1] == "corner" and not talls.cells(index, 1),
    )


def _dishwasher_side(layout: Found) -> int | None:
    """0 where a dishwasher stands before the sink, 1 after it; on the side that is longer, which
    leaves space to stand beside its door."""
    index = layout.sink[0]
    run = layout.shape.runs[index]
    options = []
    for (_, low, kind), (high, _, other) in pairwise(_marks(layout, index)):
        if "sink_cabinet" not in (kind, other):
            continue
        corners = _gap_corners(run, layout, index, kind, other)
        gap = high - low - sum((run.hidden + CORNER_DOORS[-1]) * is_corner for is_corner in corners)
        if any(gap >= width and FITS[gap - width] for width in DISHWASHERS):
            options.append((-gap, 1 if kind == "sink_cabinet" else 0))
    return min(options)[1] if options else None


def _slots(
    layout: Found, index: int, washes: int | None, rng: np.random.Generator
) -> Iterator[_Slot]:
    """What stands between the tall units of a run."""
    run = layout.shape.runs[index]
    marks = _marks(layout, index)
    for (start, low, kind), (high, _, other) in pairwise(marks):
        if kind:
            yield _Slot(kind, start, low)
        corners = _gap_corners(run, layout, index, kind, other)
        is_loose = [
            not mark and not layout.talls.cells(index, at) and run.ends[at] in ("free", "wall")
            for at, mark in enumerate((kind, other))
        ]
        washing = None
        if kind == "sink_cabinet" and washes == 1:
            washing = 0
        elif other == "sink_cabinet" and washes == 0:
            washing = 1
        yield from _gap(run, (low, high), corners, is_loose, washing, rng)


def _gap(
    run: Run, gap: tuple[int, int], corners: tuple[bool, bool], is_loose: list[bool],
    washing: int | None, rng: np.random.Generator,
) -> Iterator[_Slot]:  # fmt: skip
    """Units between two that are fixed. washing: at which end there is a dishwasher."""
    low, high = gap
    first: list[_Slot] = []
    last: list[_Slot] = []
    if any(corners):
        doors = _doors(high - low, run.hidden, corners, any(is_loose))
        if doors is None:
            return
        if corners[0]:
            first.append(_Slot(DOUBLE, low, low + run.hidden + doors[0], "corner right"))
            low += run.hidden + doors[0]
        if corners[1]:
            last.append(_Slot(DOUBLE, high - run.hidden - doors[1], high, "corner left"))
            high -= run.hidden + doors[1]
    if washing is not None:
        width = next((w for w in DISHWASHERS if high - low >= w and FITS[high - low - w]), None)
        if width and washing == 0:
            first.append(_Slot(APPLIANCE, low, low + width, "dishwasher"))
            low += width
        elif width:
            last.append(_Slot(APPLIANCE, high - width, high, "dishwasher"))
            high -= width
    if not FITS[high - low]:
        filled = int(FILLED[high - low])
        low, high = (
            (high - filled, high) if is_loose[0] and not is_loose[1] else (low, low + filled)
        )
    yield from first
    ways = splits(high - low)
    row = list(ways[int(rng.integers(len(ways)))])
    rng.shuffle(row)
    for width in row:
        yield _Slot(DOUBLE if width >= _DOUBLE_FROM else SINGLE, low, low + width)
        low += width
    yield from last


def _doors(
    gap: int, hidden: int, corners: tuple[bool, bool], is_loose: bool
) -> tuple[int, int] | None:
    """What opens of the corner units of a gap."""
    if is_loose:
        for shorter in range(4):
            doors = corner_doors(gap - shorter, hidden, *corners)
            if doors:
                return doors
    return corner_doors(gap, hidden, *corners)


def _widened(run: Run, slots: list[_Slot]) -> list[_Slot]:
    """The units, plain ones wider by what is left beside a wall and between two fixed ends."""
    slack = run.slack / CELL_M
    plain = [slot for slot in slots if slot.is_plain]
    if not slots or not plain:
        return slots
    if run.ends[0] == "wall" and 0 < slots[0].low <= _STRETCHED and slots[0].is_plain:
        slots[0].low = 0
    if run.ends[1] == "wall" and 0 < run.cells - slots[-1].high <= _STRETCHED:
        slack += run.cells - slots[-1].high
    if slack:
        # The last one: whatever comes before it stands where the search had it.
        widest = max(plain, key=lambda slot: slot.low)
        after = [slot for slot in slots if slot.low >= widest.high - 1e-6]
        widest.high += slack
        for slot in after:
            slot.low += slack
            slot.high += slack
    return slots


def _beside_corner(run: Run, slots: list[_Slot]) -> list[_Slot]:
    """The units, plain ones at a corner with a filler there."""
    ends: tuple[tuple[int, Variety], ...] = ((0, "beside right"), (-1, "beside left"))
    for at, variety in ends:
        if run.ends[at] == "beside corner" and slots:
            slot = slots[at]
            is_wide = slot.high - slot.low >= _BESIDE_FROM
            if slot.is_plain and not slot.variety and is_wide and _touches(run, slot, at):
                slot.variety = variety
    return slots


def _touches(run: Run, slot: _Slot, at: int) -> bool:
    """Whether a unit stands at an end of its run: before tall ones there is none in the corner."""
    return slot.low < 1.0 if at == 0 else slot.high > run.cells - 1.0


def _unit(run: Run, slot: _Slot, height: float) -> Unit:
    low, high = run.low + slot.low * CELL_M, run.low + slot.high * CELL_M
    category = slot.category
    if slot.is_plain:
        category = DOUBLE if high - low >= _DOUBLE_FROM * CELL_M - 1e-6 else SINGLE
    return Unit(category, box_at(run.wall, low, high, run.depth, height), slot.variety)


def _tall_units(layout: Found, index: int) -> Iterator[Unit]:
    talls, run = layout.talls, layout.shape.runs[index]
    if talls.run != index:
        return
    width = TALL_CELLS * CELL_M
    ends = (run.low, run.low + talls.cells(index, 0) * CELL_M)
    if talls.end == 1:
        ends = (run.high, run.high - talls.cells(index, 1) * CELL_M)
    outer, inner = ends
    step = width if inner > outer else -width
    yield _refrigerator(run.wall, min(inner - step, inner), max(inner - step, inner))
    if talls.tower:
        low = min(outer, outer + step)
        box = box_at(run.wall, low, low + width, TALL_DEPTH_M, TALL_HEIGHT_M)
        yield Unit(APPLIANCE, box, "tower")


def _refrigerator(wall: Wall, low: float, high: float) -> Unit:
    return Unit("refrigerator", box_at(wall, low, high, TALL_DEPTH_M, _REFRIGERATOR_M))


def box_at(wall: Wall, low: float, high: float, depth: float, height: float) -> Box:
    """A box with its back on a wall."""
    x_m, y_m = wall.at((low + high) / 2, depth / 2)
    yaw_deg = math.degrees(math.atan2(wall.inward[0], -wall.inward[1]))
    quarter = round(yaw_deg / 90.0) * 90.0
    yaw_deg = quarter if abs(yaw_deg - quarter) < 1e-6 else yaw_deg
    return Box((float(x_m), float(y_m), 0.0), (high - low, depth, height),
               180.0 if yaw_deg == -180.0 else yaw_deg)  # fmt: skip
