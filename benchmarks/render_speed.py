"""What each lever of a render gives: processor seconds to a picture of equal quality.

    python benchmarks/render_speed.py STAGE [--camera NAME ...] [--size WxH] [--reference N]

Each way of rendering is tried with rising sample counts and compared, as a finished picture, with
one of many samples by Blender's default settings. The seconds at 35 dB lie between two tries, on
a straight line of PSNR over the logarithm of seconds. Processor time, since a shared machine's
clock says little; the import of the stage is counted apart, it is paid once for all cameras.
"""

from __future__ import annotations

import argparse
import json
import resource
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from results import write_section

from chord_usd.image.blender import run_blender
from chord_usd.image.cameras import read_views
from chord_usd.image.job import PICTURE_FILE, Job, Quality
from chord_usd.image.marks import marked_stage, read_marks
from chord_usd.image.options import QUALITIES

GOAL_DB = 35.0
SAMPLES = (8, 16, 32, 64)

BLENDER = Quality(
    noise=0.01,
    bounces=12,
    diffuse_bounces=4,
    glossy_bounces=4,
    clamp=False,
    caustics=True,
    keep_scene=False,
)
"""Blender's own settings, its denoiser on."""

OURS = QUALITIES["good"]

WAYS: dict[str, Quality] = {
    "Blender's defaults, denoised": BLENDER,
    "ours": OURS,
    "ours, 12 bounces": replace(OURS, bounces=12),
    "ours, caustics": replace(OURS, caustics=True),
    "ours, fireflies not clamped": replace(OURS, clamp=False),
    "ours, no light tree": replace(OURS, light_tree=False),
    "ours, rooms out of sight hidden": replace(OURS, hide_rooms=True),
    "ours, path guiding": replace(OURS, guiding=True),
    "ours, fast prefilter": replace(OURS, prefilter="FAST"),
    "ours, no prefilter": replace(OURS, prefilter="NONE"),
    "ours, 4 bounces (draft)": replace(OURS, bounces=4, diffuse_bounces=3),
    "ours, not denoised": replace(OURS, denoise=False),
}


@dataclass(frozen=True)
class Try:
    """One way with one sample count, over all cameras."""

    samples: int
    cpu_s: float
    """Of a picture, the mean over the cameras."""
    psnr_db: float
    """The mean over the cameras."""


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stage", type=Path)
    parser.add_argument("--camera", action="append", default=[])
    parser.add_argument("--size", default="192x108")
    parser.add_argument("--reference", type=int, default=1024)
    parser.add_argument("--log", type=Path, help="a line of JSON for each try, as it is made")
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    marks = read_marks(options.stage)
    views = read_views(options.stage)
    chosen = tuple(c for c in views.cameras if not options.camera or c.name in options.camera)
    with marked_stage(options.stage, marks) as stage:
        job = Job(
            folder="",
            stage=str(stage),
            cameras=chosen,
            width_px=width,
            height_px=height,
            has_dome=views.has_dome,
            rooms=marks.room_of_numbers(),
            neighbours=marks.neighbours,
        )
        exposed = replace(job, exposure_ev=_exposure_ev(job))
        best = replace(BLENDER, samples=options.reference, noise=0.0)
        _, reference = _pictures(replace(exposed, quality=best))
        rows = []
        for name, quality in WAYS.items():
            tries = []
            for samples in SAMPLES:
                one = replace(exposed, quality=replace(quality, samples=samples))
                tries.append(_judge(samples, *_pictures(one), reference))
                if options.log:
                    with options.log.open("a") as log:
                        log.write(json.dumps({"way": name, **vars(tries[-1])}) + "\n")
            rows.append((name, _row(tries)))
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024
    note = (
        f"Processor seconds a picture to {GOAL_DB:.0f} dB, and the PSNR at {SAMPLES} samples; "
        f"means of {len(chosen)} rooms at {options.size} against {options.reference} samples by "
        f"Blender's defaults. Largest process {peak:.0f} MiB. Small pictures: the denoiser and "
        "the loading of the scene weigh more than at 1280x720."
    )
    sys.stdout.write(write_section("render", rows, note))


def _exposure_ev(job: Job) -> float:
    """One exposure for all pictures, so that they can be compared: what the first room asks for."""
    messages, _ = _run(replace(job, cameras=job.cameras[:1], quality=replace(OURS, samples=1)))
    return next(float(m["exposure_ev"]) for m in messages if "taken" in m)


def _pictures(job: Job) -> tuple[float, list[np.ndarray]]:
    """Mean processor seconds of a picture, and the pictures, (H, W, 3) each."""
    messages, pictures = _run(job)
    return float(np.mean([m["cpu_s"] for m in messages if "taken" in m])), pictures


def _run(job: Job) -> tuple[list[dict[str, Any]], list[np.ndarray]]:
    messages: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        run_blender(replace(job, folder=folder), messages.append)
        files = [Path(folder) / PICTURE_FILE.format(camera.name) for camera in job.cameras]
        return messages, [np.asarray(Image.open(file)).astype(float) for file in files]


def _judge(samples: int, cpu_s: float, found: list[np.ndarray], wanted: list[np.ndarray]) -> Try:
    errors = [np.mean((one - other) ** 2) for one, other in zip(found, wanted, strict=True)]
    return Try(samples, cpu_s, float(np.mean([10 * np.log10(255**2 / error) for error in errors])))


def _row(tries: list[Try]) -> str:
    quality = ", ".join(f"{one.psnr_db:.1f}" for one in tries)
    decibels = [one.psnr_db for one in tries]
    if max(decibels) < GOAL_DB:
        return f"not reached ({quality} dB)"
    rising = np.maximum.accumulate(decibels)
    seconds = np.exp(np.interp(GOAL_DB, rising, np.log([one.cpu_s for one in tries])))
    below = "at most " if decibels[0] >= GOAL_DB else ""
    return f"{below}{seconds:.1f} s ({quality} dB)"


if __name__ == "__main__":
    main()
