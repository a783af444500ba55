"""Rooms as sets of boxes in numbers that noise can be added to, and back.

A slot holds a category as a one-hot code, -1 and 1, one more for an empty slot, then the box of the
piece: x and y of its middle, length of its extent along x and y, cosine and sine of the way it
faces. Rooms, frames and batches are the same as for lists (pieces.py).
"""

from __future__ import annotations

import numpy as np
import torch
from torch import Tensor

from chord_usd.line.lists.pieces import PIECES, PLACES, STEP_M, YAWS
from chord_usd.line.lists.vocabulary import CATEGORY_ROLE, Element, Floats
from chord_usd.workshop.training.lists_data import Batch

CATEGORIES = len(PIECES.categories)
EMPTY = CATEGORIES
"""The code of a slot without a piece."""
BOX = 6
"""Numbers of a box."""
WIDTH = CATEGORIES + 1 + BOX
"""Numbers of a slot."""
SLOTS = PIECES.most

MIDDLE_M, EXTENT_M = 2.0, 1.0
"""What middles are divided by, and what is taken from extents: both come to about 1."""


def slots_of(batch: Batch) -> Tensor:
    """(B, SLOTS, WIDTH) the pieces of a batch of lists; empty slots have boxes of zeros."""
    _, _, _, roles, _, values = batch
    slots = torch.zeros(len(roles), SLOTS, WIDTH)
    slots[..., : CATEGORIES + 1] = codes_of(torch.full(slots.shape[:2], EMPTY))
    held = roles != CATEGORY_ROLE
    row, _ = held.nonzero(as_tuple=True)
    slot = (held.cumsum(1) - 1)[held]
    starts = torch.tensor([PIECES.first[name] for name in PIECES.slots])
    yaw, *corners = (values[held] - starts).unbind(-1)
    low, high = (torch.stack(pair, dim=-1) for pair in (corners[:2], corners[2:]))
    turn = yaw * (2.0 * torch.pi / YAWS)
    slots[row, slot] = torch.cat(
        [
            codes_of(roles[held] - 1),
            ((low + high) / 2 - PLACES // 2) * STEP_M / MIDDLE_M,
            (high - low) * STEP_M - EXTENT_M,
            torch.stack([turn.cos(), turn.sin()], dim=-1),
        ],
        dim=-1,
    )
    return slots


def codes_of(categories: Tensor) -> Tensor:
    """(..., CATEGORIES + 1) -1, and 1 for the category."""
    return torch.nn.functional.one_hot(categories, CATEGORIES + 1) * 2.0 - 1.0


def elements_of(slots: Floats) -> tuple[Element, ...]:
    """The pieces of one room's slots, (SLOTS, WIDTH), in the order of lists.

    Boxes lie on the grid of lists, and are at least a step long.
    """
    elements = []
    for slot in slots:
        category = int(slot[: CATEGORIES + 1].argmax())
        if category == EMPTY:
            continue
        middle, extent, facing = np.split(slot[CATEGORIES + 1 :].astype(np.float64), 3)
        half = np.maximum(extent + EXTENT_M, STEP_M) / 2
        ends = np.stack([middle * MIDDLE_M - half, middle * MIDDLE_M + half])
        low, high = np.clip(np.rint(ends / STEP_M).astype(int) + PLACES // 2, 0, PLACES - 1)
        yaw = round(float(np.arctan2(facing[1], facing[0])) / (2 * np.pi) * YAWS) % YAWS
        elements.append(Element(category, (yaw, *map(int, low), *map(int, high))))
    return tuple(
        sorted(
            elements, key=lambda element: (element.category, element.values[1], element.values[2])
        )
    )
