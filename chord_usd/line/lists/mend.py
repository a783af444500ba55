"""What a few centimetres mend in a draft, before drafts are compared: lists write on a grid of
5 cm, and nearly every list of a living room has a piece a step into another or before a door.

A piece moves or gets shorter by no more than MOST_M, and only where that leaves less wrong.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from chord_usd.base.metrics.complete import lacking
from chord_usd.base.metrics.design.price import conflicts, quick_price
from chord_usd.base.metrics.design.shell import TOUCH_M, Shell
from chord_usd.base.metrics.design.view import View
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Box, FloatArray

T = TypeVar("T")

MOST_M = 0.2
TIMES = 6
"""Changes of one draft at most."""
_SPARE_M = 0.005
"""A piece is moved so much farther than to touch."""


def mended(view: View) -> View:
    """The draft with small conflicts put right."""
    deep = conflicts(view)
    stuck: set[int] = set()
    for _ in range(TIMES):
        worst = np.where((deep > TOUCH_M) & (deep <= MOST_M), deep, 0.0).max(axis=1, initial=0.0)
        worst[list(stuck)] = 0.0
        if not worst.any():
            break
        at = int(worst.argmax())
        better = _best_change(view, at, deep)
        if better is None:
            stuck.add(at)
        else:
            view, deep = better
    return view


def cleared(view: View) -> View:
    """The draft without pieces that are still in others, before openings or in walls: they are left
    out of any house. Of those in each other the one goes without which the room costs least; what a
    room cannot do without stays."""
    while ((deep := conflicts(view)) > TOUCH_M).any():
        least = needed_there(view.shell, view.categories)
        wrong = np.flatnonzero((deep > TOUCH_M).any(axis=1)).tolist()
        units = [at for at in wrong if view.categories[at] in KITCHEN_UNITS]
        if units:  # runs are composed later: which of many units goes first is worth no search
            wrong = [max(units, key=lambda at: float(deep[at].max()))]
        going = dict.fromkeys(
            one for at in wrong
            for one in (at, *np.flatnonzero(view.depths[at] > TOUCH_M).tolist())
            if one == at or deep[at, 0] > TOUCH_M
        )  # fmt: skip
        lefts = (View(view.shell, tuple(_without(view.items, one)), view.hung) for one in going)
        options = [left for left in lefts if needed_there(left.shell, left.categories) >= least]
        if not options:
            break
        view = min(options, key=quick_price) if len(options) > 1 else options[0]
    return view


def needed_there(shell: Shell, categories: Sequence[str]) -> int:
    """How much of what its room cannot do without is there; a bed is never done without."""
    return ("bed" in categories) - len(lacking(shell.kind, shell.area_m2, categories))


def _without(values: Sequence[T], at: int) -> list[T]:
    return [*values[:at], *values[at + 1 :]]


def _best_change(view: View, at: int, deep: FloatArray) -> tuple[View, FloatArray] | None:
    """Of the piece, or else of those that it is in, the change that leaves least wrong."""
    best, least = None, float(deep.sum()) - TOUCH_M
    steps = sorted({float(depth) for depth in deep[at] if TOUCH_M < depth <= MOST_M})
    for one in dict.fromkeys([at, *np.flatnonzero(view.depths[at] > TOUCH_M).tolist()]):
        boxes = (
            box
            for step in steps
            for box in _changes(view.items[one].box, view.categories[one], step)
        )
        for box in boxes:
            items = list(view.items)
            items[one] = replace(items[one], box=box)
            tried = View(view.shell, tuple(items), view.hung)
            left = conflicts(tried)
            if left.sum() < least:
                best, least = (tried, left), float(left.sum())
        if best is not None:
            break
    return best


def _changes(box: Box, category: str, depth: float) -> Iterator[Box]:
    """The box moved by a depth along each of its axes, or shorter by it at each end."""
    step = depth + _SPARE_M
    turn = np.radians(box.yaw_deg)
    right = np.array([np.cos(turn), np.sin(turn)])
    front = np.array([np.sin(turn), -np.cos(turn)])
    x, y, z = box.center_m
    for direction in (right, -right, front, -front):
        dx, dy = (direction * step).tolist()
        yield replace(box, center_m=(x + dx, y + dy, z))
    length, width, height = box.size_m
    row = CATEGORIES.get(category)
    if row is not None and length - step >= row.length_m[0]:
        for side in (0.5, -0.5):
            dx, dy = (right * step * side).tolist()
            yield replace(box, center_m=(x + dx, y + dy, z), size_m=(length - step, width, height))
