"""Wardrobes as long as those who sleep in a bedroom need: longer, another, or in place of what a
room can do without."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np

from chord_usd.base.metrics.design.bedroom_rules import bedside, wardrobes
from chord_usd.base.metrics.design.dining_rules import chairs_of
from chord_usd.base.metrics.design.view import View, sleepers_of
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Item
from chord_usd.line.lists.changes import (
    Change,
    at_walls,
    grown,
    loose,
    new_piece,
    with_box,
)
from chord_usd.line.lists.pieces import TALL_M, WARDROBE_DEPTH_M

WARDROBE_M = 0.6
"""Depth."""
LEAST_M, MOST_M = 0.6, 2.6
SPARE_M = 0.04
"""More wardrobe than is needed: painting takes a centimetre."""
_LOOSE = ("table", "leisure_sofa", "lounge", "side_coffee_table")
_SLID_M = (0.0, 0.2, -0.2, 0.4, -0.4)
"""Of a bed along its wall."""
_STEP_M = 0.25


def longer_wardrobe(view: View) -> Iterator[Change]:
    """The longest cabinet, deep and long enough to hang clothes for all."""
    cabinets = view.of("cabinet")
    if not cabinets:
        return
    at = max(
        cabinets,
        key=lambda cabinet: (view.depth[cabinet] >= WARDROBE_DEPTH_M, view.length[cabinet]),
    )
    others = sum(view.length[wardrobe] for wardrobe in wardrobes(view) if wardrobe != at)
    most = CATEGORIES["cabinet"].length_m[1]
    needed = float(np.clip(sleepers_of(view) - others, view.length[at], most))
    depth = max(float(view.depth[at]), WARDROBE_M)
    tall = replace(view.items[at].box, size_m=(*view.items[at].box.size_m[:2], TALL_M))
    lengths = np.arange(needed, view.length[at] - 0.01, -0.2).tolist()
    for length in (*lengths, float(view.length[at])):
        for box in grown(tall, length, depth):
            yield with_box(view, at, box)


def another_wardrobe(view: View) -> Iterator[Change]:
    """Another wardrobe, for those who have none."""
    there = float(view.length[wardrobes(view)].sum())
    missing = sleepers_of(view) - there
    if missing <= 0.05:
        return
    for length in dict.fromkeys((max(missing + SPARE_M, LEAST_M), 0.8)):
        for box in at_walls(view, (min(length, 2.4), WARDROBE_M, TALL_M)):
            yield (*view.items, new_piece(view, "cabinet", box))


def wardrobe_instead(view: View) -> Iterator[Change]:
    """A wardrobe for all in place of other cabinets, or of a desk and loose seats, too, the bed
    moved along its wall."""
    needed = sleepers_of(view) + SPARE_M
    if float(view.length[wardrobes(view)].sum()) > needed - 2 * SPARE_M or not view.of("bed"):
        return
    stored = loose(view, view.of("cabinet", "wardrobe"))
    seated = {chair for table in view.of("dining_table") for chair in chairs_of(view, table)}
    spare = [*view.of(*_LOOSE), *(at for at in view.of("chair") if at not in seated)]
    spare = loose(view, spare)
    lengths = dict.fromkeys(min(max(part, LEAST_M), MOST_M) for part in (needed, needed / 2))
    for gone in [stored, [*stored, *spare]] if spare else [stored]:
        for length, rest in product(lengths, _bed_slid(view, gone)):
            for box in at_walls(view, (length, WARDROBE_M, TALL_M), _STEP_M):
                yield (*rest, new_piece(view, "cabinet", box))


def _bed_slid(view: View, gone: list[int]) -> Iterator[tuple[Item, ...]]:
    """The room without some pieces, its bed and what belongs to it moved along its wall."""
    bed = view.of("bed")[0]
    group = [bed, *bedside(view, bed), *view.of("bed_background")]
    turn = float(view.yaw[bed])
    for slide in _SLID_M:
        yield tuple(
            _along(item, slide, turn) if at in group and slide else item
            for at, item in enumerate(view.items) if at not in gone
        )  # fmt: skip


def _along(item: Item, slide: float, turn: float) -> Item:
    """A piece moved in a direction of the world."""
    x, y, z = item.box.center_m
    dx, dy = slide * np.cos(np.radians(turn)), slide * np.sin(np.radians(turn))
    return replace(item, box=replace(item.box, center_m=(float(x + dx), float(y + dy), z)))
