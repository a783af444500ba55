"""Layouts that the layout model painted, as training samples of the detector.

Spoilt drawings only resemble what the model paints. Nobody drew these: the truth is what their
colours say, read without the networks, and the rooms of the plan they were painted on.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from chord_usd.base.raster import canvas
from chord_usd.base.raster.raster_files import read_layout, write_raster
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.types import LayoutImage, Plan
from chord_usd.line.graph.match import items_seen
from chord_usd.line.graph.snap import decode_items
from chord_usd.line.layout.device import in_batches
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.workshop.data.augment import random_pose
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import is_test_seed
from chord_usd.workshop.training.detector_data import Sample, sample_of

_FIRST_SEED = 500_000_000
"""Far from the seeds of other training data, and below the seeds of test houses."""

_MARGIN_PX = (3, 40)
_BATCH = 4


def generated_samples(
    model: LayoutModel, count: int, folder: Path, progress: Progress | None = None
) -> list[Sample]:
    """The first count generated layouts, every second one unshaded.

    They are kept as PNG files in folder; those that lie there are not painted again.
    """
    folder.mkdir(parents=True, exist_ok=True)
    seeds = [seed for seed in range(_FIRST_SEED, _FIRST_SEED + count) if not is_test_seed(seed)]
    missing = [seed for seed in seeds if not _file(folder, seed).is_file()]
    painted = in_batches(partial(_painted, model), missing, _BATCH)
    for done, (seed, layout) in enumerate(zip(missing, painted, strict=True), start=1):
        write_raster(layout, _file(folder, seed))
        if progress:
            progress(done, len(missing))
    return [_sample(read_layout(_file(folder, seed)), _plan(seed)) for seed in seeds]


def _painted(model: LayoutModel, seeds: Sequence[int]) -> list[LayoutImage]:
    images = []
    for seed in seeds:
        plan, margin = _plan(seed), np.random.default_rng(seed).integers(*_MARGIN_PX)
        frame = canvas.fit_frame(plan, margin_px=int(margin))
        images.append(canvas.draw_plan(plan, frame, shade=seed % 2 == 0))
    return model.sample_batch(images, seeds=seeds)


def _plan(seed: int) -> Plan:
    rng = np.random.default_rng(seed)
    return random_pose(random_plan(rng), rng)


def _file(folder: Path, seed: int) -> Path:
    return folder / f"{seed}.png"


def _sample(layout: LayoutImage, plan: Plan) -> Sample:
    items = items_seen(decode_items(layout), layout.frame)
    return sample_of(layout.rgb, items, plan.rooms, layout.frame)
