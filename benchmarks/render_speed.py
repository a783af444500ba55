"""What each lever of a render gives: processor seconds to a picture of equal quality.

    python benchmarks/render_speed.py STAGE[:ROOM,...] ... [--size WxH] [--reference N]

Each way of rendering is tried with rising sample counts and compared, as a finished picture, with
one of many samples by Blender's default settings that clamps nothing. The seconds at 35 dB lie
between two tries, on a straight line of PSNR over the logarithm of seconds. Processor time, since
a shared machine's clock says little; the import of the stage is counted apart. Every room has a
run and an exposure of its own, so each picture is the first of its scene.

References and tries are kept in --keep: what was there when a run ended is not made again. A
reference is the mean of denoised pictures of --block samples, each with noise of its own; how far
the mean of one half of them lies from that of the other tells its noise.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import shutil
import sys
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from results import write_section

from chord_usd.base.runtime.files import hash_file
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.image.blender import run_blender
from chord_usd.line.image.exr import read_exr, write_exr
from chord_usd.line.image.job import COLOUR_FILE, PICTURE_FILE, Job, Negative, Quality
from chord_usd.line.image.joined import joined_rooms
from chord_usd.line.image.options import QUALITIES
from chord_usd.line.image.stage_cameras import read_views

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
    keep_scene=False,
)
"""Blender's own settings, its denoiser on."""

BLENDER_CLAMP = 10.0
"""Radiance at which Blender cuts indirect light; ours counts in what is white in the picture."""

OURS = QUALITIES["good"]

FIRST, LAST = "Blender's defaults, denoised", "ours"

WAYS: dict[str, Quality] = {
    FIRST: BLENDER,
    LAST: OURS,
    "ours, all lamps": replace(OURS, own_lamps=False),
    "ours, light tree": replace(OURS, light_tree_lamps=0),
    "ours, shadow rays to screens": replace(OURS, sample_glow=True),
    "ours, bounces off whole materials": replace(OURS, matte_bounces=False),
    "ours, glass in the way of light": replace(OURS, clear_glass=False),
    "ours, 12 bounces": replace(OURS, bounces=12),
    "ours, 4 bounces": replace(OURS, bounces=4, diffuse_bounces=3),
    "ours, caustics": replace(OURS, caustics=True),
    "ours, fireflies not clamped": replace(OURS, clamp=0.0),
    "ours, clamped at 10 times white": replace(OURS, clamp=10.0),
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
    rooms = [room for stage in options.stage for room in Room.all_of(stage, options)]
    tried = {name: _tries(name, rooms, options) for name in options.way or WAYS}
    rows = [(name, _row(tries)) for name, tries in tried.items()]
    if {FIRST, LAST} <= tried.keys():
        for goal_db in (GOAL_DB, FURTHER_DB):
            gain = _gain(tried[FIRST], tried[LAST], goal_db)
            rows.append((f"{LAST}, times as fast to {goal_db:.0f} dB", gain))
    note = (
        f"Processor seconds a picture to {GOAL_DB:.0f} dB, the PSNR at "
        f"{', '.join(map(str, options.samples))} samples, and by how many levels of 255 the last "
        f"are brighter; means of {len(rooms)} rooms of "
        f"{len(options.stage)} house{'s' * (len(options.stage) > 1)} at {options.size} against "
        f"{options.reference} samples by Blender's defaults that clamp nothing, whose own noise is "
        f"{_listed(room.noise_db for room in rooms)} dB below white."
    )
    sys.stdout.write(write_section("render", rows, note))


def _tries(name: str, rooms: list[Room], options: argparse.Namespace) -> list[Try]:
    tries = []
    for samples in options.samples:
        quality = replace(WAYS[name], samples=samples)
        found = [room.judged(room.clamped(quality) if name == FIRST else quality) for room in rooms]
        tries.append(Try(samples, *map(np.array, zip(*found, strict=True))))
        sys.stderr.write(f"{name}: {tries[-1]}\n")
    return tries


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stage", nargs="+", help="house.usda, or house.usda:Kitchen_0,Bedroom_0")
    parser.add_argument("--size", default="640x360")
    parser.add_argument("--reference", type=int, default=4096, help="samples (4096)")
    parser.add_argument("--block", type=int, default=256, help="samples rendered at once (256)")
    parser.add_argument("--samples", type=int, nargs="+", default=SAMPLES)
    parser.add_argument("--way", action="append", choices=WAYS, default=[])
    parser.add_argument("--keep", type=Path, default=Path("runs/reference"))
    return parser.parse_args()


@dataclass(frozen=True)
class Room:
    """A camera in a room, and what its picture should look like."""

    shelf: Shelf
    job: Job
    wanted: FloatArray
    """(H, W, 3) in 0 to 255."""
    noise_db: float
    """How far the noise of that lies below white."""

    @classmethod
    def all_of(cls, asked: str, options: argparse.Namespace) -> Iterator[Room]:
        """Their references are made now, where they are not kept already."""
        path, _, names = asked.partition(":")
        stage = Path(path)
        width, height = map(int, options.size.split("x"))
        views = read_views(stage)
        for camera in views.cameras:
            if camera.room not in (names.split(",") if names else views.rooms):
                continue
            job = Job(
                folder="",
                stage=str(stage.absolute()),
                cameras=(camera,),
                width_px=width,
                height_px=height,
                has_dome=views.has_dome,
                rooms=views.rooms,
                joined=joined_rooms(stage),
            )
            shelf = Shelf(options.keep, hash_file(stage))
            exposed = replace(job, exposure_ev=shelf.exposure_ev(job))
            yield cls(shelf, exposed, *shelf.reference(exposed, options))

    def clamped(self, quality: Quality) -> Quality:
        """With Blender's own clamp, which asks for no exposure."""
        return replace(quality, clamp=BLENDER_CLAMP * 2.0 ** (self.job.exposure_ev or 0.0))

    def judged(self, quality: Quality) -> tuple[float, float, float]:
        """Processor seconds, PSNR, and the levels by which the picture is too bright."""
        cpu_s, picture = self.shelf.picture(replace(self.job, quality=quality))
        return cpu_s, _psnr_db(picture, self.wanted), float((picture - self.wanted).mean())


@dataclass(frozen=True)
class Shelf:
    """Pictures kept from run to run, by what they are pictures of."""

    folder: Path
    stage_hash: str

    def exposure_ev(self, job: Job) -> float:
        """One exposure for all pictures of a room, so that they can be compared."""
        first = replace(job, quality=replace(BLENDER, samples=1))
        file = self.folder / f"{self._key(first)}.json"
        if not file.exists():
            with tempfile.TemporaryDirectory() as folder:
                file.write_text(json.dumps(_run(replace(first, folder=folder))))
        return next(float(m["exposure_ev"]) for m in json.loads(file.read_text()) if "taken" in m)

    def reference(self, job: Job, options: argparse.Namespace) -> tuple[FloatArray, float]:
        """The picture by Blender's defaults, (H, W, 3) in 0 to 255, and its noise in dB."""
        best = replace(BLENDER, samples=options.block, noise=0.0, clamp=0.0)
        light: list[np.ndarray] = []
        for block in range(max(2, options.reference // options.block)):
            one = replace(job, quality=best, seed=1000 + block)
            channels, _ = read_exr(self._taken(one) / COLOUR_FILE.format(job.cameras[0].name))
            light.append(np.stack([channels[name] for name in "RGB"], axis=-1))
        whole, *halves = _developed([light, light[::2], light[1::2]], job.exposure_ev or 0.0)
        # The mean of two halves has half of their difference as its noise.
        return whole, _psnr_db(*halves) + 20.0 * np.log10(2.0)

    def picture(self, job: Job) -> tuple[float, FloatArray]:
        """Processor seconds of the picture, and the picture, (H, W, 3)."""
        folder = self._taken(job)
        messages = json.loads((folder / "messages.json").read_text())
        cpu_s = next(float(m["cpu_s"]) for m in messages if "taken" in m)
        return cpu_s, _read(folder / PICTURE_FILE.format(job.cameras[0].name))

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


def _developed(sets: list[list[np.ndarray]], exposure_ev: float) -> list[FloatArray]:
    """A picture, (H, W, 3), of the mean of each set of linear light."""
    with tempfile.TemporaryDirectory() as folder:
        negatives = []
        for number, light in enumerate(sets):
            linear, mean = Path(folder, f"{number}.exr"), np.mean(light, axis=0)
            write_exr(linear, {name: mean[..., at] for at, name in enumerate("RGB")})
            negatives.append(Negative(str(linear), f"{folder}/{number}.png", exposure_ev))
        run_blender(Job(folder=folder, negatives=tuple(negatives)), lambda message: None)
        return [_read(Path(negative.picture)) for negative in negatives]


def _psnr_db(picture: FloatArray, other: FloatArray) -> float:
    return float(10.0 * np.log10(255.0**2 / np.mean((picture - other) ** 2)))


def _listed(numbers: Iterable[float]) -> str:
    return ", ".join(f"{one:.1f}" for one in numbers)


def _read(picture: Path) -> np.ndarray:
    return np.asarray(Image.open(picture).convert("RGB")).astype(float)


def _row(tries: list[Try]) -> str:
    decibels, cpu_s = _means(tries)
    quality = _listed(decibels)
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
    each = _listed(sorted(rooms)) or "none"
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
