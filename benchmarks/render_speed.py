"""What each lever of a render gives: processor seconds to a picture of equal quality.

    python benchmarks/render_speed.py STAGE ... [--camera NAME ...] [--size WxH] [--reference N]

Each way of rendering is tried with rising sample counts and compared, as a finished picture, with
one of many samples by Blender's default settings. The seconds at 35 dB lie between two tries, on
a straight line of PSNR over the logarithm of seconds. Processor time, since a shared machine's
clock says little; the import of the stage is counted apart, it is paid once for all cameras.

References and tries are kept in --keep: what was there when a run ended is not made again. A
reference is the mean of denoised pictures of --block samples, each with noise of its own.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
import sys
import tempfile
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from results import write_section

from chord_usd.image.blender import run_blender
from chord_usd.image.exr import read_exr, write_exr
from chord_usd.image.job import COLOUR_FILE, PICTURE_FILE, Job, Negative, Quality
from chord_usd.image.joined import joined_rooms
from chord_usd.image.options import QUALITIES
from chord_usd.image.stage_cameras import StageCamera, read_views
from chord_usd.runtime.files import hash_file
from chord_usd.scene.types import FloatArray

GOAL_DB = 35.0
FURTHER_DB = 36.0
"""Where the gain is told, too: the fewer the samples, the more a kept scene counts."""
SAMPLES = (4, 8, 16, 32)

BLENDER = Quality(
    noise=0.01,
    bounces=12,
    diffuse_bounces=4,
    glossy_bounces=4,
    transmission_bounces=12,
    caustics=True,
    light_tree_lamps=0,
    own_lamps=False,
    sample_glow=True,
    matte_bounces=False,
    clear_glass=False,
    portals=False,
    keep_scene=False,
)
"""Blender's own settings, its denoiser on; at the exposures of rooms its clamp is near ours."""

OURS = QUALITIES["good"]

FIRST, LAST = "Blender's defaults, denoised", "ours"

WAYS: dict[str, Quality] = {
    FIRST: BLENDER,
    LAST: OURS,
    "ours, all lamps": replace(OURS, own_lamps=False),
    "ours, light tree": replace(OURS, light_tree_lamps=0),
    "ours, shadow rays to sky and screens": replace(OURS, sample_glow=True),
    "ours, bounces off whole materials": replace(OURS, matte_bounces=False),
    "ours, portals": replace(OURS, portals=True),
    "ours, glass in the way of light": replace(OURS, clear_glass=False),
    "ours, 12 bounces": replace(OURS, bounces=12),
    "ours, 4 bounces": replace(OURS, bounces=4, diffuse_bounces=3),
    "ours, caustics": replace(OURS, caustics=True),
    "ours, fireflies not clamped": replace(OURS, clamp=False),
    "ours, path guiding": replace(OURS, guiding=True),
    "ours, fast prefilter": replace(OURS, prefilter="FAST"),
    "ours, no prefilter": replace(OURS, prefilter="NONE"),
    "ours, textures of 512 pixels": replace(OURS, texture_px=512),
    "ours, nothing kept between pictures": replace(OURS, keep_scene=False),
    "ours, not denoised": replace(OURS, denoise=False),
}


@dataclass(frozen=True)
class Try:
    """One way with one sample count, over all cameras."""

    samples: int
    cpu_s: FloatArray
    """(N,) of each picture."""
    psnr_db: FloatArray
    """(N,) of each picture."""
    brighter: FloatArray
    """(N,) mean by which each is too bright, in levels of 255: what no number of samples mends."""


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    options = _options()
    options.keep.mkdir(parents=True, exist_ok=True)
    houses = [House.of(stage, options) for stage in options.stage]
    tried = {name: _tries(name, houses, options) for name in options.way or WAYS}
    rows = [(name, _row(tries)) for name, tries in tried.items()]
    if {FIRST, LAST} <= tried.keys():
        for goal_db in (GOAL_DB, FURTHER_DB):
            gain = _gain(tried[FIRST], tried[LAST], goal_db)
            rows.append((f"{LAST}, times as fast to {goal_db:.0f} dB", gain))
    count = sum(len(house.job.cameras) for house in houses)
    note = (
        f"Processor seconds a picture to {GOAL_DB:.0f} dB, the PSNR at "
        f"{', '.join(map(str, options.samples))} samples, and by how many levels of 255 the last "
        f"are brighter; means of {count} rooms of "
        f"{len(houses)} house{'s' * (len(houses) > 1)} at {options.size} against "
        f"{options.reference} samples by Blender's defaults."
    )
    sys.stdout.write(write_section("render", rows, note))


def _tries(name: str, houses: list[House], options: argparse.Namespace) -> list[Try]:
    tries = []
    for samples in options.samples:
        quality = replace(WAYS[name], samples=samples)
        found = [house.judged(quality) for house in houses]
        tries.append(Try(samples, *(np.concatenate(column) for column in zip(*found, strict=True))))
        sys.stderr.write(f"{name}: {tries[-1]}\n")
    return tries


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stage", type=Path, nargs="+")
    parser.add_argument("--camera", action="append", default=[], help="of this room; all rooms")
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--reference", type=int, default=4096, help="samples (4096)")
    parser.add_argument("--block", type=int, default=256, help="samples rendered at once (256)")
    parser.add_argument("--samples", type=int, nargs="+", default=SAMPLES)
    parser.add_argument("--way", action="append", choices=WAYS, default=[])
    parser.add_argument("--keep", type=Path, default=Path("runs/reference"))
    return parser.parse_args()


@dataclass(frozen=True)
class House:
    """A stage, and what pictures of its rooms should look like."""

    shelf: Shelf
    job: Job
    wanted: list[FloatArray]
    """A picture per camera, (H, W, 3) in 0 to 255."""

    @classmethod
    def of(cls, stage: Path, options: argparse.Namespace) -> House:
        """Its references are made now, where they are not kept already."""
        width, height = map(int, options.size.split("x"))
        views = read_views(stage)
        chosen = tuple(c for c in views.cameras if c.room in (options.camera or views.rooms))
        job = Job(
            folder="",
            stage=str(stage.absolute()),
            cameras=chosen,
            width_px=width,
            height_px=height,
            has_dome=views.has_dome,
            rooms=views.rooms,
            joined=joined_rooms(stage),
        )
        shelf = Shelf(options.keep, hash_file(stage))
        exposed = replace(job, exposure_ev=shelf.exposure_ev(job))
        return cls(shelf, exposed, [shelf.reference(exposed, c, options) for c in chosen])

    def judged(self, quality: Quality) -> tuple[list[float], list[float], list[float]]:
        """By each camera: processor seconds, PSNR, and the levels by which it is too bright."""
        cpu_s, pictures = self.shelf.pictures(replace(self.job, quality=quality))
        off = [a - b for a, b in zip(pictures, self.wanted, strict=True)]
        psnr_db = [10.0 * np.log10(255.0**2 / np.mean(one**2)) for one in off]
        return cpu_s, psnr_db, [float(one.mean()) for one in off]


@dataclass(frozen=True)
class Shelf:
    """Pictures kept from run to run, by what they are pictures of."""

    folder: Path
    stage_hash: str

    def exposure_ev(self, job: Job) -> float:
        """One exposure for all pictures, so that they can be compared: what the first room asks."""
        first = replace(job, cameras=job.cameras[:1], quality=replace(BLENDER, samples=1))
        file = self.folder / f"{self._key(first)}.json"
        if not file.exists():
            with tempfile.TemporaryDirectory() as folder:
                file.write_text(json.dumps(_run(replace(first, folder=folder))))
        return next(float(m["exposure_ev"]) for m in json.loads(file.read_text()) if "taken" in m)

    def reference(self, job: Job, camera: StageCamera, options: argparse.Namespace) -> FloatArray:
        """The picture of one camera by Blender's defaults, (H, W, 3) in 0 to 255."""
        best = replace(BLENDER, samples=options.block, noise=0.0)
        light = []
        for block in range(max(1, options.reference // options.block)):
            one = replace(job, cameras=(camera,), quality=best, seed=1000 + block)
            channels, _ = read_exr(self._taken(one) / COLOUR_FILE.format(camera.name))
            light.append(np.stack([channels[name] for name in "RGB"], axis=-1))
        with tempfile.TemporaryDirectory() as folder:
            linear, picture = Path(folder, "mean.exr"), Path(folder, "mean.png")
            mean = np.mean(light, axis=0)
            write_exr(linear, {name: mean[..., at] for at, name in enumerate("RGB")})
            negative = Negative(str(linear), str(picture), float(job.exposure_ev or 0.0))
            run_blender(Job(folder=folder, negatives=(negative,)), lambda message: None)
            return _read(picture)

    def pictures(self, job: Job) -> tuple[list[float], list[FloatArray]]:
        """Processor seconds of each picture, and the pictures, (H, W, 3) each."""
        folder = self._taken(job)
        taken = [m for m in json.loads((folder / "messages.json").read_text()) if "taken" in m]
        files = [folder / PICTURE_FILE.format(camera.name) for camera in job.cameras]
        return [float(m["cpu_s"]) for m in taken], [_read(file) for file in files]

    def _taken(self, job: Job) -> Path:
        """The folder with all files of a job, rendered now if it was not before."""
        folder = self.folder / self._key(job)
        if not (folder / "messages.json").exists():
            shutil.rmtree(folder, ignore_errors=True)
            folder.mkdir()
            messages = _run(replace(job, folder=str(folder)))
            (folder / "messages.json").write_text(json.dumps(messages))
        return folder

    def _key(self, job: Job) -> str:
        """Of what it shows and how. A lever that stands as in Blender does not count: references
        outlive the day when a new one is added to our settings."""
        levers, blender = asdict(job.quality), asdict(BLENDER)
        turned = {name: value for name, value in levers.items() if value != blender[name]}
        what = asdict(job) | {"stage": self.stage_hash, "quality": turned}
        if not job.quality.own_lamps:
            what["joined"] = ()  # which only tells whose lamps shine
        return hashlib.sha256(json.dumps(what, sort_keys=True).encode()).hexdigest()[:16]


def _run(job: Job) -> list[dict[str, Any]]:
    messages: list[dict[str, Any]] = []
    run_blender(job, messages.append)
    return [message for message in messages if "progress" not in message]


def _read(picture: Path) -> np.ndarray:
    return np.asarray(Image.open(picture).convert("RGB")).astype(float)


def _row(tries: list[Try]) -> str:
    decibels, cpu_s = _means(tries)
    quality = ", ".join(f"{one:.1f}" for one in decibels)
    quality += f" dB; {tries[-1].brighter.mean():+.1f}"
    if max(decibels) < GOAL_DB:
        return f"not reached in {cpu_s[-1]:.1f} s ({quality})"
    below = "at most " if decibels[0] >= GOAL_DB else ""
    return f"{below}{_seconds(decibels, cpu_s, GOAL_DB):.1f} s ({quality})"


def _seconds(decibels: list[float], cpu_s: list[float], goal_db: float) -> float:
    """Processor seconds to a goal."""
    rising = np.maximum.accumulate(decibels)
    return float(np.exp(np.interp(goal_db, rising, np.log(cpu_s))))


def _gain(theirs: list[Try], ours: list[Try], goal_db: float) -> str:
    """How many times as fast, by the means, and in each room that both bring to the goal."""
    whole = [_means(tries) for tries in (theirs, ours)]
    if not all(_reaches(decibels, goal_db) for decibels, _ in whole):
        return "not told: not reached within these samples"
    rooms = []
    for at in range(len(ours[0].cpu_s)):
        both = [_of_room(tries, at) for tries in (theirs, ours)]
        if all(_reaches(decibels, goal_db) for decibels, _ in both):
            rooms.append(_seconds(*both[0], goal_db) / _seconds(*both[1], goal_db))
    each = ", ".join(f"{one:.1f}" for one in sorted(rooms)) or "none"
    times = _seconds(*whole[0], goal_db) / _seconds(*whole[1], goal_db)
    return f"{times:.2f} (by room, where measured: {each})"


def _reaches(decibels: list[float], goal_db: float) -> bool:
    """Whether the goal lies between two tries, not before the first."""
    return decibels[0] < goal_db <= max(decibels)


def _means(tries: list[Try]) -> tuple[list[float], list[float]]:
    """PSNR and seconds of each try."""
    return [float(t.psnr_db.mean()) for t in tries], [float(t.cpu_s.mean()) for t in tries]


def _of_room(tries: list[Try], at: int) -> tuple[list[float], list[float]]:
    return [float(t.psnr_db[at]) for t in tries], [float(t.cpu_s[at]) for t in tries]


if __name__ == "__main__":
    main()
