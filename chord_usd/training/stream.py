"""Houses as an endless stream of training samples, made by worker processes as they are needed."""

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
from chord_usd.types import Plan, SceneGraph

Sample = dict[str, Tensor]


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


class LayoutStream(IterableDataset[Sample]):
    """Samples of plan and layout, never ending; each worker has its own random stream.

    A sample holds rgb (H, W, 3) uint8 and pixels (PIXEL_PLANES, H, W) uint8 and grid
    (GRID_PLANES, H/cell, W/cell) float32 of the plan, labels (H, W) uint8, front (H, W) bool and
    layout (H, W, 3) uint8.
    """

    def __init__(self, config: StreamConfig, real_plans: Sequence[Plan], cell_px: int) -> None:
        self.config = config
        self.real_plans = real_plans
        self.cell_px = cell_px

    def __iter__(self) -> Iterator[Sample]:
        worker = get_worker_info()
        rng = np.random.default_rng((self.config.seed, worker.id if worker else 0))
        while True:
            yield self._sample(rng)

    def _sample(self, rng: np.random.Generator) -> Sample:
        house = random_pose(self._furnished_house(rng), rng)
        frame = raster.fit_frame(house.plan, margin_px=int(rng.integers(*self.config.margin_px)))
        shade = bool(rng.random() < self.config.shading_chance)
        plan_image = raster.draw_plan(house.plan, frame, shade=shade)
        labels, front = raster.draw_items(house.items, frame)
        condition = plan_condition(plan_image.rgb, frame.m_per_px, self.cell_px)
        arrays = {
            "rgb": plan_image.rgb,
            "pixels": condition.pixels,
            "grid": condition.grid,
            "labels": labels,
            "front": front,
            "layout": raster.paint_layout(plan_image, labels, front),
        }
        return {name: torch.from_numpy(np.array(array)) for name, array in arrays.items()}

    def _furnished_house(self, rng: np.random.Generator) -> SceneGraph:
        if self.real_plans and rng.random() < self.config.real_share:
            plan = self.real_plans[int(rng.integers(len(self.real_plans)))]
            return furnish(plan, rng)
        seed = int(rng.integers(2**40))
        while is_test_seed(seed):
            seed = int(rng.integers(2**40))
        house_rng = np.random.default_rng(seed)
        return furnish(random_plan(house_rng), house_rng)


def sample_loader(stream: LayoutStream, batch: int, workers: int) -> DataLoader[Sample]:
    """Batches of the stream; with workers = 0 they are made in this process."""
    return DataLoader(
        stream,
        batch_size=batch,
        num_workers=workers,
        prefetch_factor=4 if workers else None,
        worker_init_fn=_single_thread if workers else None,
        persistent_workers=bool(workers),
        pin_memory=torch.cuda.is_available(),
    )


def _single_thread(_worker: int) -> None:
    # Workers draw with OpenCV; its own threads would fight the training for the same cores.
    import cv2

    cv2.setNumThreads(1)
    torch.set_num_threads(1)
