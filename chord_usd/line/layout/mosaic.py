"""Pictures too large for the network to look at, as one batch of views (views.cut_views).

All views look at one noisy state and step down together: at each step what a view says of its own
floor is put in its place, so that its neighbours see it at the next. Nothing has to be joined
afterwards, and no view comes first.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.palette import BACKGROUND_RGB, category
from chord_usd.base.scene.types import CANVAS_PX, WALL_THICKNESS_M, BoolArray, ByteArray
from chord_usd.line.layout.condition import floor_regions
from chord_usd.line.layout.denoiser import Estimate, Plans
from chord_usd.line.layout.schedule import State

VIEWS_AT_ONCE = 4
"""In one batch: more are no faster on a processor, and take more memory."""

Describe = Callable[[Sequence[ByteArray], Sequence[float], Sequence[State] | None], Plans]
"""Pictures of one size, their metres per pixel and drafts to what the network sees of them."""
Look = Callable[[State, Sequence[int], Plans], Estimate]
"""The network: of a noisy batch, its times and its plans."""


@dataclass(frozen=True, eq=False)
class _Batch:
    """Views of one size."""

    plans: Plans
    places: tuple[tuple[int, View], ...]
    """Of each view the index of its picture."""


@dataclass(frozen=True, eq=False)
class Mosaic:
    """A batch of large pictures, all of one size, as the views on them."""

    inside: BoolArray
    """(B, 1, H, W) floor; items exist nowhere else."""
    batches: tuple[_Batch, ...]

    def estimate(
        self, state: State, times: Sequence[int], look: Look, bare: tuple[State, State]
    ) -> Estimate:
        """What the views say of a noisy batch (B, C, H, W), each of its own floor.

        bare: output and clean state of what is no floor, (1, planes, 1, 1) each.
        """
        output, clean = (
            np.broadcast_to(of, (len(state), of.shape[1], *state.shape[2:])).copy() for of in bare
        )
        for batch in self.batches:
            parts = np.stack([state[index][:, *view.window] for index, view in batch.places])
            said = look(parts, [times[index] for index, _ in batch.places], batch.plans)
            assert said.clean is not None
            for place, (index, view) in enumerate(batch.places):
                for whole, part in ((output, said.output), (clean, said.clean)):
                    whole[index][:, *view.window][:, view.decided] = part[place][:, view.decided]
        return Estimate(output, clean)


def mosaic_of(
    pictures: Sequence[ByteArray],
    m_per_px: Sequence[float],
    multiple_px: int,
    describe: Describe,
    region: BoolArray | None = None,
    drafts: Sequence[State] | None = None,
) -> Mosaic:
    """Pictures (H, W, 3) of one size as a mosaic.

    multiple_px: of which the sides of pictures and views are multiples. region: (H, W) the floor
    that matters; views that decide about none of it are left out. drafts: (planes, H, W) of each.
    """
    inside = np.zeros((len(pictures), 1, *pictures[0].shape[:2]), np.bool_)
    places = []
    for index, (rgb, scale) in enumerate(zip(pictures, m_per_px, strict=True)):
        for view in cut_views(rgb, scale, multiple_px):
            inside[index, 0][view.window] |= view.decided
            if region is None or (region[view.window] & view.decided).any():
                places.append((index, view))
    return Mosaic(inside, tuple(_batches(places, m_per_px, describe, drafts)))


def _batches(
    places: Sequence[tuple[int, View]],
    m_per_px: Sequence[float],
    describe: Describe,
    drafts: Sequence[State] | None,
) -> Iterator[_Batch]:
    for size in dict.fromkeys(view.decided.shape for _, view in places):
        group = [place for place in places if place[1].decided.shape == size]
        for start in range(0, len(group), VIEWS_AT_ONCE):
            part = group[start : start + VIEWS_AT_ONCE]
            scales = [m_per_px[index] for index, _ in part]
            seen = drafts and [drafts[index][:, *view.window] for index, view in part]
            yield _Batch(describe([view.rgb for _, view in part], scales, seen), tuple(part))


# The views through which the network looks at a house that is larger than it was trained ---------

# A view is drawn as if the house ended at its edge: to the network it is one more house of the
# usual size. Views overlap; each room belongs to one of them, which decides what stands there,
# and others see it. Rooms that no wall parts stay together, but for halls that are larger than
# any view: those are cut, and each part is seen with OVERLAP_M of what goes on beyond it.

OVERLAP_M = 2.5
"""How far a view sees beyond the floor that it decides about: about the longest piece."""

LEAST_STRIP_M = 1.0
"""Of a room at the edge of a view, what must be seen of it for it to be a room."""

_WALL_RGB, _DOOR_RGB = category("wall").rgb, category("door").rgb

Labels = npt.NDArray[np.int32]
Corner = npt.NDArray[np.int64]
"""(2,) row and column."""


@dataclass(frozen=True, eq=False)
class View:
    """What the network sees through one window."""

    window: Window
    """Rows and columns of the picture."""
    rgb: ByteArray
    """(h, w, 3) the plan in the window, with the rooms in sight and their walls only."""
    decided: BoolArray
    """(h, w) floor that this view decides about."""


@dataclass(frozen=True, eq=False)
class _Part:
    """Connected floor, or a part of it, that one view decides about."""

    label: int
    decided: tuple[Corner, Corner]
    """First and behind-the-last corner of a box: floor of this label in it belongs to the part."""
    needed: tuple[Corner, Corner]
    """The same of what must be in sight."""


@dataclass(frozen=True, eq=False)
class _House:
    """A large plan picture and its floors."""

    rgb: ByteArray
    labels: Labels
    """(H, W) number of connected floor, 0 elsewhere."""
    gaps: BoolArray
    """(H, W) passages in walls."""
    boxes: npt.NDArray[np.int64]
    """(N, 2, 2) by label: first and behind-the-last corner, walls included."""
    wall_px: int
    around_px: int
    """How far views see beyond what they are about."""
    least_px: int
    """Narrower floor at a view's edge is left out."""


def cut_views(
    rgb: ByteArray, m_per_px: float, multiple_px: int, most_px: int = CANVAS_PX
) -> list[View]:
    """Views of at most most_px by most_px pixels that together decide about all floor.

    rgb: (H, W, 3) plan raster. Its sides, most_px and the sides of views are multiples of
    multiple_px.
    The number of views grows with the house's area.
    """
    house = _house(rgb, m_per_px)
    parts = _parts(house, most_px)
    return [_view(house, group, multiple_px) for group in _grouped(parts, most_px)]


def _house(rgb: ByteArray, m_per_px: float) -> _House:
    regions, gaps = floor_regions(rgb, m_per_px)
    _, labels, stats, _ = cv2.connectedComponentsWithStats(
        (regions > 0).astype(np.uint8), connectivity=4
    )
    wall_px = math.ceil(WALL_THICKNESS_M / m_per_px)
    first = stats[:, [cv2.CC_STAT_TOP, cv2.CC_STAT_LEFT]].astype(np.int64)
    last = first + stats[:, [cv2.CC_STAT_HEIGHT, cv2.CC_STAT_WIDTH]]
    edge_px = wall_px + BORDER_PX
    boxes = np.stack([first - edge_px, last + edge_px], axis=1).clip(0, labels.shape)
    around_px, least_px = round(OVERLAP_M / m_per_px), round(LEAST_STRIP_M / m_per_px)
    return _House(rgb, np.asarray(labels), gaps, boxes, wall_px, around_px, least_px)


def _parts(house: _House, most_px: int) -> list[_Part]:
    """Every connected floor; one that no window can hold is cut."""
    parts = []
    for label in range(1, len(house.boxes)):
        low, high = house.boxes[label]
        around = np.minimum(house.around_px, (most_px - (high - low)) // 2)
        counts = np.ones(2, np.int64)
        if around.min() < 0:
            around = np.full(2, house.around_px)
            # Corners are rounded, which may make a part a pixel larger.
            counts = -(-(high - low) // (most_px - 2 * house.around_px - 1))
        steps = (high - low) / counts
        for cell in np.ndindex(*counts.tolist()):
            first = np.rint(low + steps * cell).astype(np.int64)
            last = np.rint(low + steps * (np.array(cell) + 1)).astype(np.int64)
            near = (first - around).clip(0), np.minimum(last + around, house.labels.shape)
            parts.append(_Part(label, (first, last), near))
    return parts


def _grouped(parts: Sequence[_Part], most_px: int) -> list[list[_Part]]:
    """Parts halved across the longer side until each half can be seen through one window."""
    if not parts:
        return []
    low, high = _union(parts)
    if len(parts) == 1 or (high - low <= most_px).all():
        return [list(parts)]
    axis = int((high - low).argmax())
    centers = np.array([part.needed[0][axis] + part.needed[1][axis] for part in parts]) / 2
    before = centers < (low[axis] + high[axis]) / 2
    if before.all() or not before.any():
        before = np.arange(len(parts)) < len(parts) // 2
    halves = [
        [part for part, is_before in zip(parts, before, strict=True) if is_before == side]
        for side in (True, False)
    ]
    return [group for half in halves for group in _grouped(half, most_px)]


def _union(parts: Sequence[_Part]) -> tuple[Corner, Corner]:
    low = np.min([part.needed[0] for part in parts], axis=0)
    return low, np.max([part.needed[1] for part in parts], axis=0)


def _view(house: _House, group: Sequence[_Part], multiple_px: int) -> View:
    low, high = _union(group)
    size = multiple_px * -(-(high - low) // multiple_px)
    corner = np.clip((low + high - size) // 2, 0, np.array(house.labels.shape) - size)
    (top, left), (bottom, right) = corner.tolist(), (corner + size).tolist()
    window = slice(top, bottom), slice(left, right)
    labels = house.labels[window]
    decided = np.zeros(labels.shape, np.bool_)
    for part in group:
        rows, columns = (
            slice(max(int(first) - int(start), 0), int(last) - int(start))
            for first, last, start in zip(*part.decided, corner, strict=True)
        )
        decided[rows, columns] |= labels[rows, columns] == part.label
    return View(window, _drawn(house, window, decided), decided)


def _drawn(house: _House, window: Window, decided: BoolArray) -> ByteArray:
    """The window as if the house ended at its edge: floors that go on beyond it end in a wall.

    Strips of floor that no view would be about are left out; passages to them become doors.
    """
    rgb, labels = house.rgb[window].copy(), house.labels[window]
    edge_px = house.wall_px + BORDER_PX
    within = np.zeros(labels.shape, np.bool_)
    within[edge_px:-edge_px, edge_px:-edge_px] = True
    shown = (labels > 0) & within
    shown &= ~_strips(shown, house.least_px) | decided
    walled = cv2.dilate(shown.astype(np.uint8), _square(house.wall_px)) > 0
    rgb[(labels > 0) & ~shown & walled & ~within] = _WALL_RGB
    wall = (rgb == _WALL_RGB).all(axis=2)
    rgb[~walled | ((labels > 0) & ~shown & ~wall)] = BACKGROUND_RGB
    count, gaps = cv2.connectedComponents(house.gaps[window].astype(np.uint8), connectivity=4)
    for gap in range(1, count):
        pixels = gaps == gap
        beside = cv2.dilate(pixels.astype(np.uint8), _square(1)) > 0
        if (beside & (labels > 0) & ~shown).any():
            rgb[pixels & walled] = _DOOR_RGB
    return rgb


def _strips(floor: BoolArray, least_px: int) -> BoolArray:
    """(H, W) connected floor that is narrower than least_px in either direction."""
    _, parts, stats, _ = cv2.connectedComponentsWithStats(floor.astype(np.uint8), connectivity=4)
    sides = stats[:, [cv2.CC_STAT_WIDTH, cv2.CC_STAT_HEIGHT]]
    return np.asarray((sides.min(axis=1) < least_px)[parts]) & floor


def _square(reach_px: int) -> ByteArray:
    return np.ones((2 * reach_px + 1, 2 * reach_px + 1), np.uint8)


# The part of the canvas that a house fills: the network need not look at the empty rest ----------

BORDER_PX = 2
"""White all around the house, so that what lies outside it stays one region."""

WindowSize = tuple[int, int]
"""Height and width in pixels."""

Window = tuple[slice, slice]
"""Rows and columns of the canvas."""


def window_size(rgb: ByteArray, multiple_px: int) -> WindowSize:
    """Smallest window around all that is drawn, sides a multiple of multiple_px, within the canvas.

    rgb: (H, W, 3) raster whose sides are multiples of multiple_px themselves.
    """
    low, high = _extent(rgb)
    needed = high - low + 2 * BORDER_PX
    sides = np.minimum(-(-needed // multiple_px) * multiple_px, rgb.shape[:2])
    return int(sides[0]), int(sides[1])


def window_of(rgb: ByteArray, size: WindowSize) -> Window:
    """Rows and columns of a window of this size with the drawing in its middle."""
    low, high = _extent(rgb)
    first = (low + high - np.array(size)) // 2
    top, left = np.clip(first, 0, np.array(rgb.shape[:2]) - size)
    return slice(int(top), int(top) + size[0]), slice(int(left), int(left) + size[1])


def _extent(rgb: ByteArray) -> tuple[np.ndarray, np.ndarray]:
    """First and behind-the-last (row, column) of what is not background."""
    drawn = (rgb != np.array(BACKGROUND_RGB, np.uint8)).any(axis=2)
    rows, columns = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    if not len(rows):
        return np.zeros(2, int), np.array(rgb.shape[:2])
    return np.array([rows[0], columns[0]]), np.array([rows[-1] + 1, columns[-1] + 1])
