"""The things on a supporting piece as a list, and its rim and what is beside it as segments.

Everything is told in the piece's own frame, to the centimetre. A thing is a category, the way it
faces, and the lines that its footprint would lie between if it were turned to the nearest side of
the piece: things that lie a little askew are told with the lines of those that do not.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from chord_usd.base.metrics.overlap import items_overlap
from chord_usd.base.raster.relief import Relief
from chord_usd.base.raster.table_top import NEIGHBOURS, SIDES, Border, TableTop
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.palette import CATEGORIES, SUPPORTS, Level, ranked
from chord_usd.base.scene.types import LEARNED_KINDS, Box, FloatArray, Item, learned_kind
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.lists.list_sampler import Heat, ListDrawer, Subject, load_lists, without
from chord_usd.line.lists.vocabulary import Element, Floats, Ints, Vocabulary

STEP_M = 0.01
PLACES = 256
"""2.56 m, in steps of STEP_M from the middle of the piece; larger ones are told smaller."""
LARGEST_M = 2.5

YAW_STEP_DEG = 5.0
YAWS = 72
_QUARTER = YAWS // 4

MOST_THINGS = 20
MOST_SEGMENTS = 48

CATEGORY_ORDER = ranked(Level.TABLE)
"""What a piece is for first, then what is put where there is room."""

SEGMENT_KINDS = ("rim", *NEIGHBOURS)

SMOOTH_M = 0.014
"""How far the segments may lie off a round rim."""
_LEAST_PART_M2 = 1e-3
"""Smaller parts of a top, and holes in it, are grooves."""
_FINE = 2
"""Parts of a cell in which rims are found."""

AREAS = 20
_LEAST_AREA_M2, _AREA_STEP = 0.05, 1.25

_INDEX = {name: index for index, name in enumerate(CATEGORY_ORDER)}

THINGS = Vocabulary(
    categories=CATEGORY_ORDER,
    ranges=(("yaw", YAWS), ("x", PLACES), ("y", PLACES)),
    slots=("yaw", "x", "y", "x", "y"),
    segments=1 + len(SEGMENT_KINDS),
    facts=(len(SUPPORTS), len(LEARNED_KINDS), AREAS),
    flags=len(SIDES) * len(NEIGHBOURS),
    most=MOST_THINGS,
)


def scale_of(top: TableTop) -> float:
    """By which a piece is told smaller; 1 for all but the longest."""
    return min(1.0, LARGEST_M / max(top.size_m))


def segments_of(top: TableTop) -> Ints:
    """(S, SEGMENT_FIELDS) stretches of its sides with a neighbour, then its rim and its holes."""
    lines = [_border_line(border, top.size_m) for border in top.borders]
    kinds = [1 + SEGMENT_KINDS.index(border.kind) for border in top.borders]
    rims = np.concatenate([np.zeros((0, 4)), *_rims(top)])
    lines_m = np.concatenate([np.array(lines).reshape(-1, 4), rims])[:MOST_SEGMENTS]
    kinds_told = np.array([*kinds, *[1] * len(rims)], np.int64)[:MOST_SEGMENTS]
    return np.concatenate([kinds_told[:, None], place(lines_m * scale_of(top))], axis=1)


def _border_line(border: Border, size_m: tuple[float, float]) -> tuple[float, ...]:
    """x and y of both ends."""
    half_x, half_y = size_m[0] / 2, size_m[1] / 2
    if border.side in ("back", "front"):
        y = half_y if border.side == "back" else -half_y
        return border.from_m, y, border.to_m, y
    x = half_x if border.side == "right" else -half_x
    return x, border.from_m, x, border.to_m


def _rims(top: TableTop) -> list[FloatArray]:
    """(N, 4) sides of every outline of the free top, outer ones and those of holes, large first."""
    rows, columns = top.free.shape
    cell = np.array([top.size_m[0] / columns, -top.size_m[1] / rows]) / _FINE
    size = (columns * _FINE, rows * _FINE)
    fine = cv2.resize(top.free.astype(np.uint8), size, interpolation=cv2.INTER_NEAREST_EXACT)
    outlines, _ = cv2.findContours(fine, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    sizes = [cv2.contourArea(outline) * abs(cell[0] * cell[1]) for outline in outlines]
    faults = []
    for index in np.argsort(sizes)[::-1]:
        if sizes[index] < _LEAST_PART_M2:
            break
        eased = cv2.approxPolyDP(outlines[index], SMOOTH_M / float(np.abs(cell).max()), True)
        points = (eased[:, 0] + 0.5) * cell + np.array(top.size_m) * (-0.5, 0.5)
        faults.append(np.concatenate([points, np.roll(points, -1, axis=0)], axis=1))
    return faults


def facts_of(top: TableTop) -> Ints:
    """(3,) category, kind of room, area."""
    area = max(top.size_m[0] * top.size_m[1], _LEAST_AREA_M2)
    step = int(math.log(area / _LEAST_AREA_M2) / math.log(_AREA_STEP))
    kinds = SUPPORTS.index(top.category), LEARNED_KINDS.index(learned_kind(top.room))
    return np.array([*kinds, min(step, AREAS - 1)], np.int64)


def flags_of(top: TableTop) -> Floats:
    """How many neighbours of each kind are at each side."""
    counts = np.zeros((len(SIDES), len(NEIGHBOURS)), np.float32)
    for border in top.borders:
        counts[SIDES.index(border.side), tuple(NEIGHBOURS).index(border.kind)] += 1.0
    return counts.reshape(-1)


def place(position_m: FloatArray) -> Ints:
    """The line of the grid nearest to a coordinate."""
    index = np.rint(position_m / STEP_M).astype(np.int64) + PLACES // 2
    return np.clip(index, 0, PLACES - 1)


def place_m(index: Ints) -> FloatArray:
    """Metres from the middle of the piece."""
    return (np.asarray(index) - PLACES // 2) * STEP_M


def things_of(items: Iterable[Item], top: TableTop) -> list[Element]:
    """The things on a piece, in the order of the vocabulary, then from left to right."""
    scale = scale_of(top)
    elements = [_element(item, scale) for item in items if item.category in _INDEX]
    return sorted(
        elements, key=lambda element: (element.category, element.values[1], element.values[2])
    )


def _element(item: Item, scale: float) -> Element:
    yaw = round(item.box.yaw_deg / YAW_STEP_DEG) % YAWS
    middle = np.array(item.box.center_m[:2])
    half = np.array(_swapped(item.box.size_m[:2], yaw)) / 2
    low, high = place((middle - half) * scale), place((middle + half) * scale)
    lines = int(low[0]), int(low[1]), int(high[0]), int(high[1])
    return Element(_INDEX[item.category], (yaw, *lines))


def _swapped(size: tuple[float, float], yaw: int) -> tuple[float, float]:
    """Length and depth of what faces this way as extents in x and y, and back."""
    is_across = (yaw + _QUARTER // 2) // _QUARTER % 2 == 1
    return (size[1], size[0]) if is_across else (size[0], size[1])


def items_from(elements: Iterable[Element], top: TableTop) -> list[Item]:
    """The things that a list tells, in the frame of the piece; those without extent are left out.

    All stand at height zero, which is the top. Their heights are usual ones.
    """
    scale = scale_of(top)
    items: list[Item] = []
    for element in elements:
        yaw, x0, y0, x1, y1 = element.values
        if x1 <= x0 or y1 <= y0:
            continue
        low, high = place_m(np.array([[x0, y0], [x1, y1]])) / scale
        x_m, y_m = (low + high) / 2
        long, deep = _swapped((float(high[0] - low[0]), float(high[1] - low[1])), yaw)
        name = CATEGORY_ORDER[element.category]
        height_m = round(sum(CATEGORIES[name].height_m) / 2, 3)
        box = Box((float(x_m), float(y_m), 0.0), (long, deep, height_m),
                  wrap_deg(yaw * YAW_STEP_DEG))  # fmt: skip
        items.append(Item(f"{name}_{len(items)}", name, box))
    return items


# Tops -> what stands on them, by lists alone: all tops together, the best of several -------------

DRAFTS, KEPT = 10, 6
"""Of each top, at most; of one list."""
OFF = 0.05
"""A smaller share of a thing's footprint beside the piece is rounding of cells."""

TABLE_HEAT = Heat(categories=1.0)
"""As full as tables are: sharper lists are shorter."""

_ALL = without(THINGS.categories, THINGS)


class TopLister:
    """Writes down what stands on tops."""

    def __init__(self, drawer: ListDrawer, drafts: int = DRAFTS, heat: Heat = TABLE_HEAT) -> None:
        """drafts: of each top, at most; the first without faults is taken, or the best."""
        self._drawer, self.drafts, self._heat = drawer, drafts, heat

    @property
    def content_hash(self) -> str:
        """Of the weights."""
        return self._drawer.content_hash

    def things(
        self, tops: Sequence[TableTop], seeds: Sequence[int], progress: Progress | None = None
    ) -> list[list[Item]]:
        """Things on each top, in its frame; a top's seed alone varies its own.

        Of tops with faults further drafts tell the same things at other places: short lists gain
        nothing by it. Only the things that do not fit after KEPT drafts are drawn again.
        """
        subjects = [Subject(segments_of(top), facts_of(top), flags_of(top)) for top in tops]
        rngs = [np.random.default_rng(seed) for seed in seeds]
        best: list[list[Item]] = [[] for _ in tops]
        faults = np.full(len(tops), np.inf)
        asked = list(subjects)
        for draft in range(self.drafts):
            waiting = [int(index) for index in np.flatnonzero(faults > 0.0)]
            if not waiting:
                break
            if draft == KEPT:
                asked = subjects
            drawn = self._drawer.draw(
                [asked[index] for index in waiting], [rngs[index] for index in waiting], self._heat
            )
            for index, listed in zip(waiting, drawn, strict=True):
                items = items_from(listed.elements, tops[index])
                wrong = top_faults(items, tops[index])
                if wrong < faults[index]:
                    best[index], faults[index] = items, wrong
                if draft == 0 and items:
                    categories = tuple(element.category for element in listed.elements)
                    asked[index] = replace(subjects[index], wanted=categories, excluded=_ALL)
            if progress:
                progress(draft + 1, self.drafts)
        return best


def top_faults(things: Sequence[Item], top: TableTop) -> float:
    """What is wrong per thing, in square metres: things in each other or beside the top. A top
    without anything is worst."""
    if not things:
        return 1.0
    relief = Relief(top.free.astype(np.float64), (*top.size_m, 1.0))
    total = sum(pair.area_m2 for pair in items_overlap(things).overlapping if not pair.natural)
    total += sum(_beside_m2(thing, relief) for thing in things)
    return total / len(things)


def _beside_m2(thing: Item, relief: Relief) -> float:
    """How much of a thing's footprint lies beside the top, or on what rises from it, if only a
    cell."""
    mask, window = relief.under(thing.box)
    length, depth, _ = thing.box.size_m
    off = length * depth - float(mask.sum()) * relief.cell_m2
    risen = float((mask & ~relief.free[window]).sum()) * relief.cell_m2
    return risen + (off if off > OFF * length * depth else 0.0)


def load_lister(folder: Path, drafts: int = DRAFTS) -> TopLister:
    """The network of a checkpoint folder. Raises CheckpointError for an unusable one."""
    return TopLister(load_lists(folder, THINGS), drafts)
