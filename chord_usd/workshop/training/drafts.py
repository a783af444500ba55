"""Drafts to learn from: a layout as a list network would tell it, or part of it, or nothing.

What lists get wrong is what the layout network shall mend: places to a hand's breadth, sizes to a
tenth. Now and then a piece is missing or one too many stands about, so that the picture stays the
judge.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from chord_usd.base.scene.types import Box, Item, PixelFrame, Room, SceneGraph
from chord_usd.line.layout.draft import Draft


@dataclass(frozen=True)
class Roughness:
    """How drafts differ from what they are of."""

    place_m: float = 0.04
    """Standard deviation, along each axis."""
    size: float = 0.03
    """Of the logarithm of lengths and widths."""
    missing: float = 0.02
    """Chance of a piece not to be in the draft."""
    extra: float = 0.02
    """Chance of a piece to stand in the draft once more, somewhere near."""
    extra_m: float = 0.8
    """How far from the piece, a standard deviation."""


ROUGHNESS = Roughness()

NOTHING_KNOWN, ALL_KNOWN = 0.3, 0.5
"""Shares of houses without any draft, which the pure model is for, and with one for all rooms;
the others have drafts for some rooms."""


def random_draft(house: SceneGraph, frame: PixelFrame, rng: np.random.Generator) -> Draft:
    """What the network is shown of a house it learns from."""
    share = rng.random()
    rooms: Sequence[Room] = house.rooms
    if share < NOTHING_KNOWN:
        rooms = ()
    elif share > NOTHING_KNOWN + ALL_KNOWN:
        rooms = [room for room in rooms if rng.random() < rng.random()]
    return rough_draft(house, frame, rng, rooms)


def rough_draft(
    house: SceneGraph,
    frame: PixelFrame,
    rng: np.random.Generator,
    rooms: Sequence[Room] | None = None,
) -> Draft:
    """A draft of these rooms of a house, by default of all, as rough as lists are."""
    rooms = house.rooms if rooms is None else rooms
    ids = {room.id for room in rooms}
    items = [item for item in house.items if item.room_id in ids]
    return Draft.of(_rough(items, rng, ROUGHNESS), rooms, frame)


def _rough(items: Sequence[Item], rng: np.random.Generator, roughness: Roughness) -> Iterator[Item]:
    for item in items:
        if rng.random() >= roughness.missing:
            yield _moved(item, roughness.place_m, roughness.size, rng)
        if rng.random() < roughness.extra:
            yield _moved(item, roughness.extra_m, roughness.size, rng)


def _moved(item: Item, place_m: float, size: float, rng: np.random.Generator) -> Item:
    x, y = item.box.center_m[:2] + rng.normal(0.0, place_m, 2)
    length, width = item.box.size_m[:2] * np.exp(rng.normal(0.0, size, 2))
    center = (float(x), float(y), item.box.center_m[2])
    box = Box(center, (float(length), float(width), item.box.size_m[2]), item.box.yaw_deg)
    return replace(item, box=box)
