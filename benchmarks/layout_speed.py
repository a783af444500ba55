"""Seconds and memory of the layout model, and whether other back ends would run it faster.

python benchmarks/layout_speed.py [--threads N] [--batch N]

ONNX Runtime and OpenVINO are measured where they are installed (with onnx and onnxscript).
"""

from __future__ import annotations

import argparse
import resource
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import torch
from results import write_section

from chord_usd.data.houses import random_plan
from chord_usd.data.splits import TEST_SEED
from chord_usd.layout.checkpoint import load_checkpoint
from chord_usd.layout.sample import LayoutModel
from chord_usd.locations import checkpoint_folder
from chord_usd.raster import draw_plan
from chord_usd.types import PlanImage

REPEATS = 5


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--threads", type=int, default=torch.get_num_threads())
    parser.add_argument("--batch", type=int, default=32)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    checkpoint = load_checkpoint(checkpoint_folder("plan2layout"))
    model, full = LayoutModel(checkpoint), LayoutModel(checkpoint, full=True)
    images = [
        draw_plan(random_plan(np.random.default_rng(TEST_SEED + index)))
        for index in range(options.batch)
    ]
    rows = _one_layout(model, full, images[0]) + _batch(model, images)
    rows += _back_ends(model, full, images[0], options.threads)
    note = f"{options.threads} threads, {model.config.default_steps} steps of DDIM."
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


def _one_layout(model: LayoutModel, full: LayoutModel, image: PlanImage) -> list[tuple[str, str]]:
    same = (model.sample(image).rgb == full.sample(image).rgb).all(axis=2).mean()
    return [
        ("one layout", _seconds(_timed(lambda: model.sample(image), 2))),
        ("one layout, float32 throughout", _seconds(_timed(lambda: full.sample(image), 2))),
        ("pixels that are the same in both", f"{same:.2%}"),
    ]


def _batch(model: LayoutModel, images: list[PlanImage]) -> list[tuple[str, str]]:
    wall, cpu = time.perf_counter(), time.process_time()
    model.sample_batch(images, seeds=range(len(images)))
    timed = (time.perf_counter() - wall) / len(images), (time.process_time() - cpu) / len(images)
    peak_mib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return [
        (f"each of a batch of {len(images)}", _seconds(timed)),
        ("most memory held by then", f"{peak_mib:.0f} MiB"),
    ]


def _back_ends(
    model: LayoutModel, full: LayoutModel, image: PlanImage, threads: int
) -> list[tuple[str, str]]:
    """One step of the network, by back end."""
    plans = model.plans([image], model.windows([image]))
    state = torch.zeros((1, 17, *plans.pixels.shape[-2:]))
    times = torch.tensor([500])
    with torch.inference_mode():
        rows = [
            ("a step, torch", _seconds(_timed(lambda: model.predict(state, times, plans)))),
            ("a step, torch float32", _seconds(_timed(lambda: full.predict(state, times, plans)))),
        ]
    try:
        import onnxruntime
        import openvino
    except ImportError:
        return rows
    inputs = {"state": state, "time": times, "pixels": plans.pixels, "grid": plans.grid}
    feed = {name: tensor.numpy() for name, tensor in inputs.items() if tensor is not None}
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "network.onnx"
        torch.onnx.export(
            model.checkpoint.network, tuple(inputs.values()), str(path),
            input_names=list(feed), dynamo=True, external_data=False,
        )  # fmt: skip
        choices = onnxruntime.SessionOptions()
        choices.intra_op_num_threads = threads
        session = onnxruntime.InferenceSession(str(path), choices)
        compiled = openvino.Core().compile_model(
            str(path), "CPU", {"INFERENCE_NUM_THREADS": threads}
        )
    rows.append(("a step, ONNX Runtime", _seconds(_timed(lambda: session.run(None, feed)))))
    rows.append(("a step, OpenVINO", _seconds(_timed(lambda: compiled(feed)))))
    return rows


if __name__ == "__main__":
    main()
