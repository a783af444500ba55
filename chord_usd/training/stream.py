"""Houses as an endless stream of training batches, made by worker processes as they are needed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import DataLoader, IterableDataset, get_worker_info

from chord_usd import raster
from chord_usd.data.augment import random_pose
from chord_usd.data.furnish import furnish
from chord_usd.data.houses import random_plan
from chord_usd.data.splits import is_test_seed
from chord_usd.layout.condition import plan_condition
from chord_usd.layout.config import LayoutConfig
from chord_usd.layout.window import WindowSize, window_of, window_size
from chord_usd.types import BoolArray, ByteArray, Plan, PlanImage, SceneGraph

Batch = dict[str, Tensor]

POOL_BATCHES = 4
"""Batches drawn ahead and sorted by size, so that houses of a batch fill windows of one size."""


@dataclass(frozen=True)
class StreamConfig:
    """What the stream draws from. Shares and chances are in [0, 1]."""

    seed: int = 0
    real_share: float = 0.5
    """Share of houses on real floor plans, where there are any."""
    shading_chance: float = 0.5
    """Chance that rooms are shaded by kind; else the model must guess it."""
    margin_px: tuple[int, int] = (4, 28)
    """Free border of the canvas, which varies the scale."""


@dataclass(frozen=True, eq=False)
class _Drawn:
    """One house on the whole canvas."""

    plan_image: PlanImage
    labels: ByteArray
    front: BoolArray
    window: WindowSize


class LayoutStream(IterableDataset[Batch]):
    """Batches of plans and layouts, never ending; each worker has its own random stream.

    A batch holds, for windows of height H and width W around the houses, rgb (B, H, W, 3) uint8 and
    pixels (B, PIXEL_PLANES, H, W) uint8 and grid (B, GRID_PLANES, H/patch, W/patch) float32 of the
    plans, labels (B, H, W) uint8, front (B, H, W) bool and layout (B, H, W, 3) uint8.
    """

    def __init__(
        self,
        config: StreamConfig,
        real_plans: Sequence[Plan],
        network: LayoutConfig,
        batch: int,
    ) -> None:
        self.config = config
        self.real_plans = real_plans
        self.network = network
        self.batch = batch

    def __iter__(self) -> Iterator[Batch]:
        worker = get_worker_info()
        rng = np.random.default_rng((self.config.seed, worker.id if worker else 0))
        while True:
            pool = [self._draw(rng) for _ in range(self.batch * POOL_BATCHES)]
            pool.sort(key=lambda drawn: drawn.window)
            for first in rng.permutation(POOL_BATCHES) * self.batch:
                yield self._batch(pool[first : first + self.batch])

    def _draw(self, rng: np.random.Generator) -> _Drawn:
        house = random_pose(self._furnished_house(rng), rng)
        frame = raster.fit_frame(house.plan, margin_px=int(rng.integers(*self.config.margin_px)))
        shade = bool(rng.random() < self.config.shading_chance)
        plan_image = raster.draw_plan(house.plan, frame, shade=shade)
        labels, front = raster.draw_items(house.items, frame)
        size = window_size(plan_image.rgb, self.network.window_multiple_px)
        return _Drawn(plan_image, labels, front, size)

    def _batch(self, houses: Sequence[_Drawn]) -> Batch:
        size = (max(house.window[0] for house in houses), max(house.window[1] for house in houses))
        samples = [self._sample(house, size) for house in houses]
        return {
            name: torch.from_numpy(np.stack([sample[name] for sample in samples]))
            for name in samples[0]
        }

    def _sample(self, house: _Drawn, size: WindowSize) -> dict[str, np.ndarray]:
        image = house.plan_image
        window = window_of(image.rgb, size)
        condition = plan_condition(image.rgb[window], image.frame.m_per_px, self.network.patch_px)
        return {
            "rgb": image.rgb[window],
            "pixels": condition.pixels,
            "grid": condition.grid,
            "labels": house.labels[window],
            "front": house.front[window],
            "layout": raster.paint_layout(image, house.labels, house.front)[window],
        }

    def _furnished_house(self, rng: np.random.Generator) -> SceneGraph:
        if self.real_plans and rng.random() < self.config.real_share:
            plan = self.real_plans[int(rng.integers(len(self.real_plans)))]
            return furnish(plan, rng)
        seed = int(rng.integers(2**40))
        while is_test_seed(seed):
            seed = int(rng.integers(2**40))
        house_rng = np.random.default_rng(seed)
        return furnish(random_plan(house_rng), house_rng)


def batch_loader(stream: LayoutStream, workers: int) -> DataLoader[Batch]:
    """The stream's batches; with workers = 0 they are made in this process."""
    return DataLoader(
        stream,
        batch_size=None,
        num_workers=workers,
        prefetch_factor=2 * POOL_BATCHES if workers else None,
        worker_init_fn=_single_thread if workers else None,
        persistent_workers=bool(workers),
        pin_memory=torch.cuda.is_available(),
    )


def _single_thread(_worker: int) -> None:
    # Workers draw with OpenCV; its own threads would fight the training for the same cores.
    import cv2

    cv2.setNumThreads(1)
    torch.set_num_threads(1)
