"""What a few centimetres mend in a draft, before drafts are compared: lists write on a grid of
5 cm, and nearly every list of a living room has a piece a step into another or before a door.

A piece moves or gets shorter by no more than MOST_M, and only where that leaves less wrong.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from chord_usd.base.metrics.design.price import conflicts
from chord_usd.base.metrics.design.shell import TOUCH_M
from chord_usd.base.metrics.design.view import View
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Box, FloatArray

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
            tried = View(view.shell, tuple(items), view.screens)
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
