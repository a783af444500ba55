"""Seconds and memory of the layout model, with ONNX Runtime and with torch.

python benchmarks/layout_speed.py [--batch N]
"""

from __future__ import annotations

import argparse
import resource
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import torch
from results import write_section

from chord_usd.base.raster.canvas import draw_plan
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.runtime.networks import usable_cores
from chord_usd.base.scene.types import PlanImage
from chord_usd.line.layout.checkpoint import load_checkpoint
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.layout.torch_denoiser import TorchDenoiser
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED

REPEATS = 5


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--batch", type=int, default=32)
    options = parser.parse_args()
    torch.set_num_threads(usable_cores())
    folder = checkpoint_folder("plan2layout")
    model = LayoutModel.load(folder, "cpu")
    checkpoint = load_checkpoint(folder)
    others = {
        "torch": LayoutModel(TorchDenoiser(checkpoint)),
        "torch, float32 throughout": LayoutModel(TorchDenoiser(checkpoint, full=True)),
    }
    images = [
        draw_plan(random_plan(np.random.default_rng(TEST_SEED + index)))
        for index in range(options.batch)
    ]
    rows = _one_layout(model, others, images[0]) + _batch(model, images)
    steps = f"{model.config.default_steps} steps of {model.config.default_sampler.upper()}"
    note = f"{usable_cores()} threads, {steps}, ONNX Runtime."
    sys.stdout.write(write_section("layout model", rows, note))


def _timed(work: Callable[[], Any], repeats: int = REPEATS) -> tuple[float, float]:
    """Wall clock and processor seconds of one call, after one that warms up."""
    work()
    wall, cpu = time.perf_counter(), time.process_time()
    for _ in range(repeats):
        work()
    return (time.perf_counter() - wall) / repeats, (time.process_time() - cpu) / repeats


def _seconds(timed: tuple[float, float]) -> str:
    return f"{timed[0]:.3f} s ({timed[1]:.3f} s of processor time)"


def _one_layout(
    model: LayoutModel, others: dict[str, LayoutModel], image: PlanImage
) -> list[tuple[str, str]]:
    rows = [("one layout", _seconds(_timed(lambda: model.sample(image), 2)))]
    drawn = model.sample(image).rgb
    for name, other in others.items():
        same = (other.sample(image).rgb == drawn).all(axis=2).mean()
        timed = _timed(lambda other=other: other.sample(image), 2)
        rows.append((f"one layout, {name}", f"{_seconds(timed)}, {same:.2%} of pixels the same"))
    return rows


def _batch(model: LayoutModel, images: list[PlanImage]) -> list[tuple[str, str]]:
    wall, cpu = time.perf_counter(), time.process_time()
    model.sample_batch(images, seeds=range(len(images)))
    timed = (time.perf_counter() - wall) / len(images), (time.process_time() - cpu) / len(images)
    peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return [
        (f"each of a batch of {len(images)}", _seconds(timed)),
        ("most memory held by then", f"{peak_mib:.0f} MiB"),
    ]


if __name__ == "__main__":
    main()
