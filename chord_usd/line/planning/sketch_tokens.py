"""Bubble diagrams as sequences of small numbers: what the sketching network reads and writes.

A house is written in one order: its floor area, how many rooms of each kind, then every room's
bubble, kind by kind and from left to right. Each position of the sequence holds up to SLOTS values
of one vocabulary; what they mean follows from the position's role.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.raster import plan_labels
from chord_usd.base.raster.bubbles import Bubble
from chord_usd.base.scene.types import BoolArray, ByteArray, FloatArray, RoomKind
from chord_usd.base.scene.wish import WISHED_KINDS
from chord_usd.line.planning.words import MOST_COUNTED

Ints = npt.NDArray[np.int64]
Floats = npt.NDArray[np.float32]

SLOTS = 3
"""x, y and radius of a bubble; an area and a count are one value."""

_LEAST_AREA_M2, _AREA_STEP = 8.0, 1.08
AREAS = 48
"""8 to 298 m², each 8 % larger than the one before."""
COUNTS = MOST_COUNTED + 1
_STEP_M = 0.2
PLACES = 128
"""Places on a sheet: 25.6 m, in steps of 0.2 m from its middle."""
_LEAST_RADIUS_M, _RADIUS_STEP_M = 0.25, 0.1
RADII = 32

NOTHING = 0
"""The value of an empty slot."""
_FIRST_AREA = 1
_FIRST_COUNT = _FIRST_AREA + AREAS
_FIRST_X = _FIRST_COUNT + COUNTS
_FIRST_Y = _FIRST_X + PLACES
_FIRST_RADIUS = _FIRST_Y + PLACES
VOCABULARY = _FIRST_RADIUS + RADII

AREA_ROLE = 0
FIRST_COUNT_ROLE = 1
FIRST_ROOM_ROLE = FIRST_COUNT_ROLE + len(WISHED_KINDS)
ROLES = FIRST_ROOM_ROLE + len(WISHED_KINDS)
HEADING = FIRST_ROOM_ROLE
"""Positions before the first room."""

CELL_M = 0.8
SHELL_CELLS = 32
_DRAWN_MARKS = (plan_labels.WALL, plan_labels.WINDOW, plan_labels.DOOR)
SHELL_MARKS = 1 + len(_DRAWN_MARKS)
"""House, wall, window and door in each cell; all 0 where the house's shape is left open."""
_PATCH_CELLS = 8
SHELL_PATCHES = (SHELL_CELLS // _PATCH_CELLS) ** 2
SHELL_CHANNELS = _PATCH_CELLS**2 * SHELL_MARKS


@dataclass(frozen=True, eq=False)
class Sequences:
    """Several houses of one length L, or one; unused positions at the end have no values."""

    roles: Ints
    """(..., L) in [0, ROLES)."""
    left: Ints
    """(..., L) rooms of the kind that are still to come, this one counted; 0 before the rooms."""
    values: Ints
    """(..., L, SLOTS) in [0, VOCABULARY)."""


def value_range(role: int, slot: int) -> tuple[int, int]:
    """The first value that can stand in a slot, and the one after the last; (0, 1) for none."""
    if role >= FIRST_ROOM_ROLE:
        first, count = ((_FIRST_X, PLACES), (_FIRST_Y, PLACES), (_FIRST_RADIUS, RADII))[slot]
    elif slot:
        first, count = NOTHING, 1
    elif role == AREA_ROLE:
        first, count = _FIRST_AREA, AREAS
    else:
        first, count = _FIRST_COUNT, COUNTS
    return first, first + count


def allowed_values() -> BoolArray:
    """(ROLES, SLOTS, VOCABULARY) which values can stand where."""
    allowed = np.zeros((ROLES, SLOTS, VOCABULARY), np.bool_)
    for role in range(ROLES):
        for slot in range(SLOTS):
            allowed[role, slot, slice(*value_range(role, slot))] = True
    return allowed


def area_value(area_m2: float) -> int:
    """The value of a floor area."""
    step = np.log(max(area_m2, 1.0) / _LEAST_AREA_M2) / np.log(_AREA_STEP)
    return _FIRST_AREA + int(np.clip(round(float(step)), 0, AREAS - 1))


def area_of(value: int) -> float:
    """The floor area, in square metres, that a value stands for."""
    return float(_LEAST_AREA_M2 * _AREA_STEP ** (value - _FIRST_AREA))


def count_value(count: int) -> int:
    """The value of a number of rooms; larger ones than MOST_COUNTED look the same."""
    return _FIRST_COUNT + min(count, MOST_COUNTED)


def counts_of(values: Ints) -> dict[RoomKind, int]:
    """Rooms by kind, of a heading (HEADING, SLOTS)."""
    counts = values[FIRST_COUNT_ROLE:FIRST_ROOM_ROLE, 0] - _FIRST_COUNT
    return {kind: int(count) for kind, count in zip(WISHED_KINDS, counts, strict=True)}


def rooms_of(counts: Mapping[RoomKind, int]) -> tuple[Ints, Ints]:
    """(R,) roles, and rooms left, of the positions that stand for so many rooms."""
    roles: list[int] = []
    left: list[int] = []
    for index, kind in enumerate(WISHED_KINDS):
        count = min(counts.get(kind, 0), MOST_COUNTED)
        roles += [FIRST_ROOM_ROLE + index] * count
        left += range(count, 0, -1)
    return np.array(roles, np.int64), np.array(left, np.int64)


def sequence_of(bubbles: Sequence[Bubble], area_m2: float) -> Sequences:
    """One house; its bubbles in metres from the middle of the sheet."""
    counts = {kind: sum(bubble.kind == kind for bubble in bubbles) for kind in WISHED_KINDS}
    roles, left = rooms_of(counts)
    heading = np.zeros((HEADING, SLOTS), np.int64)
    heading[AREA_ROLE, 0] = area_value(area_m2)
    heading[FIRST_COUNT_ROLE:, 0] = [count_value(counts[kind]) for kind in WISHED_KINDS]
    rooms = []
    for kind in WISHED_KINDS:
        of_kind = sorted(
            (bubble for bubble in bubbles if bubble.kind == kind), key=lambda bubble: bubble.x_m
        )
        rooms += [_bubble_values(bubble) for bubble in of_kind[:MOST_COUNTED]]
    values = np.concatenate([heading, np.array(rooms, np.int64).reshape(-1, SLOTS)])
    return Sequences(
        np.concatenate([np.arange(HEADING), roles]),
        np.concatenate([np.zeros(HEADING, np.int64), left]),
        values,
    )


def bubbles_from(roles: Ints, values: Ints) -> tuple[Bubble, ...]:
    """The bubbles of rooms (R,), (R, SLOTS), in metres from the middle of the sheet."""
    bubbles = []
    for role, row in zip(roles, values, strict=True):
        x_m, y_m = place_m(place_index(row))
        radius = float(radius_m(radius_index(row)))
        kind = WISHED_KINDS[role - FIRST_ROOM_ROLE]
        bubbles.append(Bubble(kind, float(x_m), float(y_m), radius))
    return tuple(bubbles)


def place_index(values: Ints) -> Ints:
    """(2,) which place along x and along y the values (SLOTS,) of a bubble name."""
    return values[:2] - (_FIRST_X, _FIRST_Y)


def place_m(index: Ints) -> FloatArray:
    """Metres from the middle of the sheet."""
    return np.asarray((index - PLACES / 2 + 0.5) * _STEP_M)


def radius_index(values: Ints) -> int:
    """Which radius the values (SLOTS,) of a bubble name."""
    return int(values[2]) - _FIRST_RADIUS


def radius_m(index: Ints | int) -> FloatArray:
    """Metres."""
    return np.asarray(_LEAST_RADIUS_M + index * _RADIUS_STEP_M)


def shell_cells(labels: ByteArray, m_per_px: float) -> Floats:
    """(SHELL_MARKS, SHELL_CELLS, SHELL_CELLS) an open plan (plan_labels.open_plan), coarsely.

    labels: (H, W), square; its middle is the middle of the sheet. Values are shares in [0, 1].
    """
    side = round(labels.shape[0] * m_per_px / CELL_M)
    masks = [labels != plan_labels.OUTSIDE, *(labels == mark for mark in _DRAWN_MARKS)]
    cells = np.stack(
        [
            cv2.resize(mask.astype(np.float32), (side, side), interpolation=cv2.INTER_AREA)
            for mask in masks
        ]
    )
    margin = (SHELL_CELLS - side) // 2
    return np.pad(cells, ((0, 0), (margin, margin), (margin, margin)))


def shell_patches(cells: Floats) -> Floats:
    """(SHELL_PATCHES, SHELL_CHANNELS) the cells of a shell as the network sees them."""
    along = SHELL_CELLS // _PATCH_CELLS
    patches = cells.reshape(SHELL_MARKS, along, _PATCH_CELLS, along, _PATCH_CELLS)
    return patches.transpose(1, 3, 0, 2, 4).reshape(SHELL_PATCHES, SHELL_CHANNELS)


def no_shell() -> Floats:
    """The patches of a house whose shape is left open."""
    return np.zeros((SHELL_PATCHES, SHELL_CHANNELS), np.float32)


def _bubble_values(bubble: Bubble) -> tuple[int, int, int]:
    radius = round((bubble.radius_m - _LEAST_RADIUS_M) / _RADIUS_STEP_M)
    return (
        _FIRST_X + _place(bubble.x_m),
        _FIRST_Y + _place(bubble.y_m),
        _FIRST_RADIUS + min(max(radius, 0), RADII - 1),
    )


def _place(position_m: float) -> int:
    return min(max(int(np.floor(position_m / _STEP_M)) + PLACES // 2, 0), PLACES - 1)
