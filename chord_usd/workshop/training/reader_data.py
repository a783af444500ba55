"""Crops of crowded pages to learn reading from: drawn for ever by worker processes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import torch
from torch import Tensor
from torch.utils.data import IterableDataset, get_worker_info

from chord_usd.base.raster.page_labels import (
    KIND_NAMES,
    KIND_STEP_PX,
    OUTSIDE,
    POINT_NAMES,
    built_of,
    laid_of,
)
from chord_usd.base.scene.types import ByteArray, FloatArray, Plan, learned_kind
from chord_usd.workshop.data.drawn.crowded import draw_page
from chord_usd.workshop.data.drawn.no_plans import draw_no_plan
from chord_usd.workshop.data.drawn.truth import CrowdedPage, DrawnStorey
from chord_usd.workshop.data.splits import TEST_SEED, is_test_seed

Batch = tuple[Tensor, Tensor, Tensor, Tensor, Tensor]
"""Colours (B, 3, S, S) uint8, what is built and what is drawn over it (B, S, S) uint8, points
(B, 3, S, S) uint8: 255 at a point, less about it; kinds of floors (B, K, K) uint8, K = S /
KIND_STEP_PX, NO_KIND where there is none."""

NO_KIND = 255

CROP_PX = 384

SIDES_PX = (360, 860)
"""Lengths that a page's longer side is brought to before it is cropped: plans are read at several
sizes, since nothing says at first how many pixels a wall has."""

TEST_SIDE_PX = 672
"""That of held-out pages."""

POOL = 24
"""Pages that are kept, to take crops from."""
CROPS = 6
"""Taken before another page takes a page's place, on average."""

NO_PLANS = 0.06
"""Share of pages that show no plan."""

FLATS = 0.2
"""Share of pages that show real flats, where there are any."""

_RADIUS_PX = 6
_SPREAD_PX = 1.8
_LARGEST = 1.6
"""A page is not enlarged more than this."""


@dataclass(frozen=True, eq=False)
class Crop:
    """A square piece of a page at some size."""

    rgb: ByteArray
    labels: ByteArray
    kinds: ByteArray
    """Of floors: index in KIND_NAMES, or NO_KIND."""
    points: FloatArray
    """(P, 3) as CrowdedPage has them; some may lie outside."""


def crop_of(page: CrowdedPage, side_px: float, rng: np.random.Generator) -> Crop:
    """A random crop, most of them where something is built; page: brought to side_px first."""
    height, width = page.labels.shape
    share = min(side_px / max(height, width), _LARGEST)
    size = max(8, round(width * share)), max(8, round(height * share))
    way = cv2.INTER_AREA if share < 1.0 else cv2.INTER_LINEAR
    rgb = np.asarray(cv2.resize(page.rgb, size, interpolation=way), np.uint8)
    near = cv2.resize(page.labels, size, interpolation=cv2.INTER_NEAREST)
    labels = np.asarray(near, np.uint8)
    spare = CROP_PX - np.array(size)
    spot = rng.integers(np.minimum(-spare, 0), np.maximum(-spare, 0) + 1)
    inside = np.argwhere(labels)
    if rng.random() < 0.7 and len(inside):
        row, column = inside[int(rng.integers(len(inside)))]
        wanted = np.array([column, row]) - rng.integers(CROP_PX // 4, 3 * CROP_PX // 4, 2)
        spot = np.where(spare < 0, np.clip(wanted, 0, np.maximum(-spare, 0)), spot)
    shares = np.array([size[0] / width, size[1] / height])
    points = page.points.copy()
    points[:, :2] = points[:, :2] * shares - spot
    paper = rgb[2, 2] if rng.random() < 0.8 else rng.integers(0, 256, 3).astype(np.uint8)
    moved = np.array([[shares[0], 0.0, -spot[0]], [0.0, shares[1], -spot[1]], [0.0, 0.0, 1.0]])
    outside = np.array(OUTSIDE, np.uint8)
    kinds = _kinds(page.storeys, moved @ page.to_picture)
    return Crop(_window(rgb, spot, paper), _window(labels, spot, outside), kinds, points)


def _kinds(storeys: Sequence[DrawnStorey], matrix: FloatArray) -> ByteArray:
    """(CROP_PX, CROP_PX) kinds of floors. matrix: (3, 3) from metres to pixels of the crop."""
    kinds = np.full((CROP_PX, CROP_PX), NO_KIND, np.uint8)
    for room in (room for storey in storeys for room in storey.plan.rooms):
        if room.kind == "unknown":
            continue
        seen = np.column_stack([room.polygon_m, np.ones(len(room.polygon_m))]) @ matrix.T
        corners = np.rint(seen[:, :2] / seen[:, 2:] - 0.5).astype(np.int32)
        cv2.fillPoly(kinds, [corners], (KIND_NAMES.index(learned_kind(room.kind)),))
    return kinds


def _window(array: ByteArray, spot: np.ndarray, beyond: np.ndarray) -> ByteArray:
    """A square of CROP_PX from (x, y) on; what lies beyond the array is filled."""
    window = np.empty((CROP_PX, CROP_PX, *array.shape[2:]), np.uint8)
    window[:] = beyond
    x, y = int(spot[0]), int(spot[1])
    left, top = max(0, -x), max(0, -y)
    part = array[max(0, y) : y + CROP_PX, max(0, x) : x + CROP_PX]
    window[top : top + part.shape[0], left : left + part.shape[1]] = part
    return window


def posed(crop: Crop, rng: np.random.Generator) -> Crop:
    """In one of eight poses, in other colours."""
    rgb, labels, kinds, points = crop.rgb, crop.labels, crop.kinds, crop.points.copy()
    if rng.random() < 0.5:
        rgb, labels, kinds = rgb[:, ::-1], labels[:, ::-1], kinds[:, ::-1]
        points[:, 0] = CROP_PX - points[:, 0]
    # Most pages are upright, and letters show it.
    if rng.random() < 0.3:
        rgb, labels, kinds = rgb.transpose(1, 0, 2), labels.T, kinds.T
        points[:, :2] = points[:, 1::-1]
    if rng.random() < 0.3:
        rgb = rgb[..., rng.permutation(3)]
    if rng.random() < 0.3:
        curve = 255 * (np.arange(256) / 255) ** rng.uniform(0.6, 1.6)
        rgb = curve.astype(np.uint8)[rgb]
    return Crop(rgb, labels, kinds, points)


def heat_of(points: FloatArray) -> ByteArray:
    """(3, CROP_PX, CROP_PX): a hill about each point."""
    heat = np.zeros((len(POINT_NAMES), CROP_PX, CROP_PX), np.uint8)
    steps = np.arange(-_RADIUS_PX, _RADIUS_PX + 1)
    hill = np.exp(-(steps[:, None] ** 2 + steps**2) / (2 * _SPREAD_PX**2))
    stamp = np.rint(255 * hill).astype(np.uint8)
    for x, y, kind in points:
        column, row = int(np.floor(x)), int(np.floor(y))
        if not (0 <= column < CROP_PX and 0 <= row < CROP_PX):
            continue
        top, left = max(0, row - _RADIUS_PX), max(0, column - _RADIUS_PX)
        under = heat[int(kind), top : row + _RADIUS_PX + 1, left : column + _RADIUS_PX + 1]
        first = top - row + _RADIUS_PX, left - column + _RADIUS_PX
        part = stamp[first[0] :, first[1] :][: under.shape[0], : under.shape[1]]
        np.maximum(under, part, out=under)
    return heat


def batch_of(crops: Sequence[Crop]) -> Batch:
    """Crops side by side."""
    rgb = np.stack([crop.rgb.transpose(2, 0, 1) for crop in crops])
    labels = np.stack([crop.labels for crop in crops])
    heat = np.stack([heat_of(crop.points) for crop in crops])
    middle = KIND_STEP_PX // 2
    kinds = np.stack([crop.kinds[middle::KIND_STEP_PX, middle::KIND_STEP_PX] for crop in crops])
    arrays = (rgb, built_of(labels), laid_of(labels), heat, kinds)
    tensors = [torch.from_numpy(np.ascontiguousarray(array)) for array in arrays]
    return tensors[0], tensors[1], tensors[2], tensors[3], tensors[4]


def held_out(count: int) -> list[Crop]:
    """Crops of the first test pages, always the same."""
    rng = np.random.default_rng(0)
    return [crop_of(draw_page(TEST_SEED + index), TEST_SIDE_PX, rng) for index in range(count)]


class PageStream(IterableDataset[Batch]):
    """Batches, never ending; each worker draws pages of its own."""

    def __init__(self, batch: int, seed: int, pool: int = POOL, flats: Sequence[Plan] = ()) -> None:
        """flats: plans to draw beside procedural ones."""
        self.batch, self.seed, self.pool, self.flats = batch, seed, pool, flats

    def __iter__(self) -> Iterator[Batch]:
        worker = get_worker_info()
        rng = np.random.default_rng((self.seed, worker.id if worker else 0))
        pages: list[CrowdedPage] = []
        while True:
            crops = []
            for _ in range(self.batch):
                if len(pages) < self.pool:
                    pages.append(_page(rng, self.flats))
                    taken = len(pages) - 1
                else:
                    taken = int(rng.integers(self.pool))
                    if rng.random() < 1.0 / CROPS:
                        pages[taken] = _page(rng, self.flats)
                crops.append(posed(crop_of(pages[taken], rng.uniform(*SIDES_PX), rng), rng))
            yield batch_of(crops)


def _page(rng: np.random.Generator, flats: Sequence[Plan]) -> CrowdedPage:
    seed = int(rng.integers(2**40))
    while is_test_seed(seed):
        seed = int(rng.integers(2**40))
    if rng.random() < NO_PLANS:
        return draw_no_plan(seed)
    return draw_page(seed, flats=flats if rng.random() < FLATS else ())
