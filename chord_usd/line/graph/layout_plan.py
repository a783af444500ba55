"""The plan in a layout raster: rooms, doors, windows and passages under and between the items.

For rasters that come alone. Where the plan is known as vectors, those are used instead.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.errors import SceneError
from chord_usd.base.raster.vectorize import RotatedBox, rotated_box_from_mask
from chord_usd.base.raster.windows import components, label_windows
from chord_usd.base.scene.palette import PLAN_CATEGORIES
from chord_usd.base.scene.types import (
    BASE_AND_HEIGHT_M,
    WALL_THICKNESS_M,
    BoolArray,
    Box,
    Opening,
    OpeningKind,
    PixelFrame,
    Plan,
    Room,
    frozen_array,
)
from chord_usd.base.scene.units import m_from_px
from chord_usd.line.graph.colours import CLEAR, SHADE_KINDS, LayoutPixels
from chord_usd.line.graph.faces import settle_faces
from chord_usd.line.graph.outlines import outline_of
from chord_usd.line.graph.wall_sides import Walls

IntArray = npt.NDArray[np.int32]

_LEAST_ROOM_M2 = 0.5
_LEAST_OPENING_M = 0.3
_STRAIGHT = 0.7
"""A straight bar fills so much of its rotated box; one round a corner does not."""
_WHITE = SHADE_KINDS.index("unknown")
_CLASSES = {row.name: row.detector_class for row in PLAN_CATEGORIES}


def read_plan(pixels: LayoutPixels, frame: PixelFrame) -> Plan:
    """Rooms and openings. Raises SceneError when no enclosed floor is found.

    Rooms are told apart by walls, doors, windows, and by their shades where they touch; kinds come
    from the shades (name_rooms names white ones).
    """
    passages = _passages(pixels, frame)
    labels = _label_rooms(pixels, passages, frame)
    rooms = _rooms(labels, pixels, frame)
    if not rooms:
        raise SceneError(
            "no closed room was found in the layout",
            expected="floors enclosed by black walls",
            try_="chord-usd plan draw plan.json -o plan.png shows what a raster looks like",
        )
    bars: list[tuple[OpeningKind, RotatedBox]] = []
    kinds: tuple[OpeningKind, ...] = ("door", "window")
    for kind in kinds:
        for part in _parts(pixels.structure == _CLASSES[kind]):
            bars += [(kind, arm) for arm in _arms(part, WALL_THICKNESS_M / frame.m_per_px)]
    bars += [("passage", part.box()) for part in passages]
    openings = _openings(bars, rooms, frame)
    return Plan(tuple(rooms), tuple(openings))


def _passages(pixels: LayoutPixels, frame: PixelFrame) -> list[_Part]:
    """White bars as thin as a wall between shaded rooms."""
    white = (pixels.structure == CLEAR) & (pixels.shade == _WHITE)
    thickness_px = WALL_THICKNESS_M / frame.m_per_px
    found = []
    for part in _parts(white):
        if part.touches_border:
            continue
        box = part.box()
        straight = part.size > _STRAIGHT * box.length_px * box.width_px
        if straight and abs(box.width_px - thickness_px) <= 1.5 and box.length_px > box.width_px:
            found.append(part)
    return found


def _label_rooms(pixels: LayoutPixels, passages: Sequence[_Part], frame: PixelFrame) -> IntArray:
    """(H, W) number of each room, 0 elsewhere; slivers join the room beside them."""
    floor = pixels.structure == CLEAR
    for passage in passages:
        floor[passage.window] &= ~passage.mask
    labels = np.zeros(floor.shape, dtype=np.int32)
    slivers = np.zeros(floor.shape, dtype=bool)
    least_px = _LEAST_ROOM_M2 / frame.m_per_px**2
    count = 0
    for shade in np.unique(pixels.shade[floor]):
        for part in _parts(floor & (pixels.shade == shade)):
            if shade == _WHITE and part.touches_border:
                continue
            if part.size < least_px:
                slivers[part.window] |= part.mask
                continue
            count += 1
            labels[part.window][part.mask] = count
    return _filled(labels, slivers)


def _filled(labels: IntArray, slivers: BoolArray) -> IntArray:
    """Slivers, one pixel rim after the other, take the number of a room that they touch."""
    labels = labels.copy()
    kernel = np.ones((3, 3), dtype=np.uint8)
    while slivers.any():
        grown = cv2.dilate(labels.astype(np.float32), kernel).astype(np.int32)
        reached = slivers & (grown > 0)
        if not reached.any():
            break
        labels[reached] = grown[reached]
        slivers = slivers & ~reached
    return labels


def _rooms(labels: IntArray, pixels: LayoutPixels, frame: PixelFrame) -> list[Room]:
    """Rooms from top to bottom, left to right."""
    outlines = []
    thickness_px = WALL_THICKNESS_M / frame.m_per_px
    for index, window in enumerate(label_windows(labels)):
        assert window is not None, "labels are 1 to their largest"
        mask = labels[window] == index + 1
        kind = SHADE_KINDS[int(np.bincount(pixels.shade[window][mask]).argmax())]
        outline = outline_of(mask) + np.array([window[1].start, window[0].start])
        outlines.append((kind, settle_faces(outline, pixels.structure, thickness_px)))
    outlines.sort(key=lambda outline: tuple(outline[1].min(axis=0)[::-1]))
    counts: dict[str, int] = {}
    rooms = []
    for kind, polygon_px in outlines:
        name = "room" if kind == "unknown" else kind
        counts[name] = counts.get(name, 0) + 1
        polygon_m = frozen_array(m_from_px(polygon_px, frame))
        rooms.append(Room(f"{name}{counts[name]}", kind, polygon_m))
    return rooms


def _openings(
    bars: Sequence[tuple[OpeningKind, RotatedBox]], rooms: Sequence[Room], frame: PixelFrame
) -> Iterator[Opening]:
    counts: dict[str, int] = {}
    walls = Walls(rooms)
    for kind, box in bars:
        length_m = box.length_px * frame.m_per_px
        if length_m < _LEAST_OPENING_M:
            continue
        base_m, height_m = BASE_AND_HEIGHT_M[kind]
        # Canvas angles run clockwise, yaw counter-clockwise.
        yaw_deg = -box.angle_deg % 180.0
        center, along_deg, joined = walls.place(m_from_px(np.array(box.center_px), frame), yaw_deg)
        counts[kind] = counts.get(kind, 0) + 1
        yield Opening(
            f"{kind}{counts[kind]}",
            kind,
            Box((*center, base_m), (length_m, WALL_THICKNESS_M, height_m), along_deg),
            joined,
        )


def _arms(part: _Part, thickness_px: float) -> list[RotatedBox]:
    """The bar; or its two arms where it runs round a corner, as corner windows do."""
    box = part.box()
    if part.size > _STRAIGHT * box.length_px * box.width_px:
        return [box]
    reach = round(1.5 * thickness_px) + 1
    row = np.ones((1, reach), dtype=np.uint8)
    flat = cv2.morphologyEx(part.mask.astype(np.uint8), cv2.MORPH_OPEN, row) > 0
    rest = part.mask & ~flat
    if not flat.any() or not rest.any():
        return [box]
    return [replace(part, mask=flat).box(), replace(part, mask=rest).box()]


@dataclass(frozen=True, eq=False)
class _Part:
    """A 4-connected region and the window of the canvas that it fills."""

    mask: BoolArray
    window: tuple[slice, slice]
    touches_border: bool

    @property
    def size(self) -> int:
        """Pixels."""
        return int(self.mask.sum())

    def box(self) -> RotatedBox:
        """The rectangle it shows, on the canvas."""
        box = rotated_box_from_mask(self.mask)
        rows, columns = self.window
        x, y = box.center_px
        return replace(box, center_px=(x + columns.start, y + rows.start))


def _parts(mask: BoolArray) -> Iterator[_Part]:
    """4-connected parts of a mask, in the order of their first pixels."""
    labels, windows = components(mask)
    height, width = mask.shape
    for index, window in enumerate(windows):
        rows, columns = window
        outside = rows.start == 0 or columns.start == 0
        outside = outside or rows.stop == height or columns.stop == width
        yield _Part(labels[window] == index + 1, window, outside)
