"""Crops of crowded pages, taken where the network learns: on a GPU, pages are kept there."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from queue import Empty, Queue

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from chord_usd.data.drawn.crowded import draw_page
from chord_usd.data.splits import TEST_SEED
from chord_usd.raster.page_labels import KIND_STEP_PX, LAID_MASK, LAID_SHIFT, OUTSIDE, POINT_NAMES
from chord_usd.scene.types import FloatArray, Plan
from chord_usd.training.reader_pages import NO_KIND, LabelledPage, labelled, page_supply

Batch = tuple[Tensor, Tensor, Tensor, Tensor, Tensor]
"""Colours (B, 3, S, S) uint8, what is built and what is drawn over it (B, S, S) uint8, points
(B, 3, S, S) float32: 1 at a point, less about it; kinds of floors (B, K, K) uint8, K = S /
KIND_STEP_PX, NO_KIND where there is none."""

SIDES_PX = (360, 860)
"""Lengths that a page's longer side is brought to before it is cropped: plans are read at several
sizes, since nothing says at first how many pixels a wall has."""

TEST_SIDE_PX = 672
"""That of held-out pages."""

_LARGEST = 1.6
"""A page is not enlarged more than this."""

_RADIUS_PX = 6
_SPREAD_PX = 1.8


@dataclass(frozen=True)
class Diet:
    """What a network is given."""

    batch: int
    crop_px: int
    """Side of a crop; a multiple of 32."""
    pool: int
    """Pages that are kept, to take crops from."""
    crops_a_page: float
    """The least, on average, before a new page takes a page's place."""
    workers: int
    device: str = "cpu"


@dataclass(frozen=True, eq=False)
class _KeptPage:
    """A page on the device."""

    rgb: Tensor
    """(1, 3, H, W) uint8."""
    labels: Tensor
    """(1, 2, H, W) uint8: labels and kinds."""
    beyond: Tensor
    """(2,) labels and kinds of what lies beyond its edges."""
    points: FloatArray
    spots: FloatArray


def kept(page: LabelledPage, device: str) -> _KeptPage:
    """The page, where crops are taken."""
    rgb = _sent(page.rgb.transpose(2, 0, 1)[None], device)
    labels = _sent(np.stack([page.labels, page.kinds])[None], device)
    beyond = _sent(np.array([OUTSIDE, NO_KIND], np.uint8), device)
    return _KeptPage(rgb, labels, beyond, page.points, page.spots)


def _sent(array: np.ndarray, device: str) -> Tensor:
    """A copy on the device; nothing waits for it there."""
    tensor = torch.tensor(np.ascontiguousarray(array))
    return tensor.pin_memory().to(device, non_blocking=True) if device != "cpu" else tensor


def crop_batches(diet: Diet, seed: int, flats: Sequence[Plan] = ()) -> Iterator[Batch]:
    """Batches, never ending, of pages that worker processes draw meanwhile."""
    rng = np.random.default_rng((seed, diet.workers))
    with page_supply(diet.workers, seed, flats) as supply:
        pages = [kept(supply.get(), diet.device) for _ in range(min(diet.batch, diet.pool))]
        due = 0.0
        while True:
            due = min(due + diet.batch / diet.crops_a_page, diet.pool)
            due -= _renew(pages, supply, int(due), diet, rng)
            chosen = [pages[int(rng.integers(len(pages)))] for _ in range(diet.batch)]
            sides = rng.uniform(*SIDES_PX, diet.batch)
            crops = (
                crop_of(page, side, diet.crop_px, rng)
                for page, side in zip(chosen, sides, strict=True)
            )
            yield batch_of([posed(crop, rng) for crop in crops])


def _renew(
    pages: list[_KeptPage], supply: Queue[LabelledPage], most: int, diet: Diet,
    rng: np.random.Generator,
) -> int:  # fmt: skip
    """Take up to so many of the pages that are ready, and say how many those were."""
    for taken in range(most):
        try:
            page = kept(supply.get_nowait(), diet.device)
        except Empty:
            return taken
        if len(pages) < diet.pool:
            pages.append(page)
        else:
            pages[int(rng.integers(diet.pool))] = page
    return most


def held_out(count: int) -> list[Batch]:
    """Crops of the first test pages, one a batch, always the same."""
    rng = np.random.default_rng(0)
    pages = (kept(labelled(draw_page(TEST_SEED + index), rng), "cpu") for index in range(count))
    return [batch_of([crop_of(page, TEST_SIDE_PX, 384, rng)]) for page in pages]


# Crops -------------------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Crop:
    """A square piece of a page at some size."""

    rgb: Tensor
    """(3, S, S) uint8."""
    labels: Tensor
    """(2, S, S) uint8: labels and kinds."""
    points: FloatArray
    """(P, 3) as CrowdedPage has them."""


def crop_of(page: _KeptPage, side_px: float, crop_px: int, rng: np.random.Generator) -> Crop:
    """A random crop, most of them where something is built; page: brought to side_px first."""
    size = np.array(page.rgb.shape[:1:-1])
    share = min(side_px / size.max(), _LARGEST)
    # On the page; what lies beyond its edges is filled.
    window = max(1, round(crop_px / share))
    spare = size - window
    low, high = np.minimum(spare, 0), np.maximum(spare, 0)
    spot = rng.integers(low, high + 1)
    if rng.random() < 0.7 and len(page.spots):
        wanted = page.spots[int(rng.integers(len(page.spots)))]
        wanted = wanted - rng.uniform(0.25, 0.75, 2) * window
        spot = np.where(spare > 0, np.clip(wanted, 0, high), spot).astype(int)
    # Of the page's corner, or of any of its pixels.
    column, row = rng.integers(size) if rng.random() < 0.2 else (2, 2)
    paper = page.rgb[0, :, row, column]
    rgb = _window(page.rgb, spot, window, paper).float()
    seen = functional.interpolate(rgb, (crop_px, crop_px), mode="bilinear", antialias=True)
    labels = _window(page.labels, spot, window, page.beyond)
    near = functional.interpolate(labels, (crop_px, crop_px), mode="nearest-exact")
    points = page.points.copy()
    points[:, :2] = (points[:, :2] - spot) * (crop_px / window)
    points = points[np.all((points[:, :2] >= 0) & (points[:, :2] < crop_px), axis=1)]
    return Crop(seen[0].round().clamp(0, 255).byte(), near[0], points)


def _window(array: Tensor, spot: np.ndarray, side: int, beyond: Tensor) -> Tensor:
    """(1, C, side, side) of (1, C, H, W), from pixel (x, y) on."""
    x, y = int(spot[0]), int(spot[1])
    part = array[..., max(0, y) : max(0, y + side), max(0, x) : max(0, x + side)]
    if part.shape[-2:] == (side, side):
        return part
    found = beyond[None, :, None, None].repeat(1, 1, side, side)
    top, left = max(0, -y), max(0, -x)
    found[..., top : top + part.shape[-2], left : left + part.shape[-1]] = part
    return found


def posed(crop: Crop, rng: np.random.Generator) -> Crop:
    """In one of four poses, in other colours."""
    rgb, labels, points = crop.rgb, crop.labels, crop.points.copy()
    if rng.random() < 0.5:
        rgb, labels = rgb.flip(-1), labels.flip(-1)
        points[:, 0] = rgb.shape[-1] - points[:, 0]
    # Most pages are upright, and letters tell.
    if rng.random() < 0.3:
        rgb, labels = rgb.transpose(-1, -2), labels.transpose(-1, -2)
        points[:, :2] = points[:, 1::-1]
    if rng.random() < 0.3:
        rgb = torch.stack([rgb[channel] for channel in rng.permutation(3)])
    if rng.random() < 0.3:
        rgb = ((rgb.float() / 255) ** rng.uniform(0.6, 1.6) * 255).round().byte()
    return Crop(rgb, labels, points)


def batch_of(crops: Sequence[Crop]) -> Batch:
    """Crops side by side."""
    rgb = torch.stack([crop.rgb for crop in crops])
    labels, floors = torch.stack([crop.labels for crop in crops]).unbind(dim=1)
    middle = KIND_STEP_PX // 2
    kinds = floors[:, middle::KIND_STEP_PX, middle::KIND_STEP_PX]
    heat = heat_of([crop.points for crop in crops], rgb.shape[-1], str(rgb.device))
    return rgb, labels & LAID_MASK, labels >> LAID_SHIFT, heat, kinds


def heat_of(points: Sequence[FloatArray], side_px: int, device: str) -> Tensor:
    """(B, 3, S, S): a hill of height 1 about each point of each crop."""
    where = [np.column_stack([np.full(len(own), index), own]) for index, own in enumerate(points)]
    crop, x, y, name = _sent(np.floor(np.concatenate(where).T).astype(np.int64), device)
    steps = torch.arange(-_RADIUS_PX, _RADIUS_PX + 1, device=device)
    down, right = (grid.flatten() for grid in torch.meshgrid(steps, steps, indexing="ij"))
    hill = torch.exp(-(down**2 + right**2) / (2 * _SPREAD_PX**2))
    rows, columns = y[:, None] + down, x[:, None] + right
    is_seen = (rows >= 0) & (rows < side_px) & (columns >= 0) & (columns < side_px)
    plane = (crop * len(POINT_NAMES) + name)[:, None]
    cells = len(points) * len(POINT_NAMES) * side_px**2
    # What is not seen goes into one cell more: to leave it out, the processor would have to wait.
    cell = torch.where(is_seen, (plane * side_px + rows) * side_px + columns, cells)
    heat = torch.zeros(cells + 1, device=device)
    heat.scatter_reduce_(0, cell.flatten(), hill.expand(cell.shape).flatten(), "amax")
    return heat[:-1].view(len(points), len(POINT_NAMES), side_px, side_px)
