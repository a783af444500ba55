"""StageFile -> pictures: reads the cameras, starts Blender in its own process, follows it.

bpy carries a second, older pxr, so the two never share a process: the cameras are read here with
usd-core, and blender_worker.py does the rest.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from chord_usd.errors import OutputError, RenderError
from chord_usd.image.blender import run_blender
from chord_usd.image.cameras import StageCamera, StageViews, read_views
from chord_usd.image.lighting import lit_stage
from chord_usd.progress import Progress

PASSES = ("rgb",)
"""Passes that can be rendered."""

PLANNED_PASSES = ("depth", "normal", "instance", "semantic")

DEVICES = ("auto", "cpu", "gpu", "cuda", "optix", "hip", "oneapi", "metal")


@dataclass(frozen=True)
class RenderOptions:
    """How to take pictures of a stage."""

    cameras: tuple[str, ...] = ()
    """Names of the cameras to use; empty for all."""
    rooms: tuple[str, ...] = ()
    """Only cameras that stand in these rooms; empty for all."""
    resolution_px: tuple[int, int] = (1280, 720)
    """Width and height."""
    samples: int = 128
    """Paths traced through each pixel, at most."""
    seed: int = 0
    """Of the noise; the same seed gives the same picture."""
    passes: tuple[str, ...] = ("rgb",)
    engine: str = "cycles"
    device: str = "auto"
    """auto (a GPU if there is one), cpu, gpu or a backend such as cuda."""
    tile: tuple[int, int] | None = None
    """(index, count): the index-th of count horizontal bands, the top one 0. Bands are not
    denoised, so that they fit together without a seam."""
    skip_existing: bool = False
    """Leave pictures alone that are there already and decode to the wanted size."""
    exposure_ev: float | None = None
    """Exposure in stops for every picture; None meters each one."""
    lighting: str = ""
    """Choice of the stage's variant set `lighting`; empty for the one it has selected."""

    def __post_init__(self) -> None:
        """Raises RenderError for a combination that cannot be rendered."""
        _check_options(self)


def render_stage(
    stage: Path, folder: Path, options: RenderOptions, progress: Progress | None = None
) -> list[Path]:
    """Render the stage's cameras into `<folder>/<camera>.png`; returns the files, in order.

    progress: called with the samples done and the samples of all pictures together. Every picture
    appears whole or not at all; an interrupt ends Blender and leaves no part of one. Raises
    StageError for a stage that cannot be read, RenderError for a camera or room that is not in
    it, for a missing device and for a failure inside Blender, OutputError for a folder that
    cannot be written or a full disk.
    """
    with lit_stage(stage, options.lighting) as lit:
        return _render(stage, lit, folder, options, progress)


def _render(
    stage: Path, lit: Path, folder: Path, options: RenderOptions, progress: Progress | None
) -> list[Path]:
    """lit: the stage, or a layer over it, which is what Blender opens."""
    views = read_views(lit)
    cameras = _chosen(stage, views, options)
    files = {c.name: folder.absolute() / picture_name(c.name, options.tile) for c in cameras}
    due = [
        camera
        for camera in cameras
        if not (options.skip_existing and is_finished(files[camera.name], _size_px(options)))
    ]
    _make_folder(folder)
    if due:
        follow = _Follower([camera.name for camera in due], options.samples, progress)
        try:
            run_blender(_job(lit, views, due, files, options), follow)
        finally:
            # The worker removes its own parts, unless it was ended.
            for camera in due:
                files[camera.name].with_suffix(".part.png").unlink(missing_ok=True)
    return list(files.values())


def picture_name(camera: str, tile: tuple[int, int] | None = None) -> str:
    """File name of a camera's picture, or of one band of it."""
    if tile is None:
        return f"{camera}.png"
    return f"{camera}.tile-{tile[0]}-of-{tile[1]}.png"


def is_finished(file: Path, size_px: tuple[int, int]) -> bool:
    """Whether a picture is there, decodes to its last row and has this width and height."""
    from PIL import Image

    try:
        with Image.open(file) as picture:
            picture.load()
            return bool(picture.size == size_px)
    except (OSError, SyntaxError):
        return False


class _Follower:
    """Adds up what the worker reports for each camera."""

    def __init__(self, cameras: list[str], samples: int, progress: Progress | None) -> None:
        self._done = dict.fromkeys(cameras, 0.0)
        self._samples = samples
        self._progress = progress

    def __call__(self, message: dict[str, Any]) -> None:
        if "progress" in message:
            told = message["progress"]
            self._done[told["camera"]] = told["done"] / told["total"]
        if "written" in message:
            self._done[message["written"]] = 1.0
        if self._progress is not None:
            total = self._samples * len(self._done)
            self._progress(round(self._samples * sum(self._done.values())), total)


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
        writable = os.access(folder, os.W_OK | os.X_OK)
    except OSError:
        writable = False
    if not writable:
        raise OutputError(
            "cannot be written to", where=str(folder), expected="a folder for pictures", try_="-o"
        )


# --- what to render -----------------------------------------------------------------------------


def _check_options(options: RenderOptions) -> None:
    width_px, height_px = options.resolution_px
    if not (4 <= width_px <= 16384 and 4 <= height_px <= 16384):
        raise RenderError(
            f"a picture of {width_px}x{height_px} cannot be rendered",
            where="--resolution",
            expected="4 to 16384 pixels each way, such as 1280x720",
        )
    if not 1 <= options.samples <= 65536:
        raise RenderError(f"{options.samples} samples", where="--samples", expected="1 to 65536")
    if not 0 <= options.seed < 2**31:
        raise RenderError(f"seed {options.seed}", where="--seed", expected="0 to 2147483647")
    if options.engine != "cycles":
        raise RenderError(f"unknown engine '{options.engine}'", where="--engine", expected="cycles")
    if options.device not in DEVICES:
        raise RenderError(
            f"unknown device '{options.device}'",
            where="--device",
            expected=f"one of {', '.join(DEVICES)}",
        )
    if options.tile is not None and not 0 <= options.tile[0] < options.tile[1] <= height_px:
        raise RenderError(
            f"there is no tile {options.tile[0]} of {options.tile[1]}",
            where="--tile",
            expected="I/N with I from 0 to N-1, and no more tiles than rows of pixels",
        )
    for name in options.passes:
        _check_pass(name)


def _check_pass(name: str) -> None:
    if name in PASSES:
        return
    if name in PLANNED_PASSES:
        raise RenderError(
            f"pass '{name}' cannot be rendered by this version yet",
            where="--passes",
            expected=", ".join(PASSES),
        )
    raise RenderError(
        f"unknown pass '{name}'",
        where="--passes",
        expected=f"one of {', '.join((*PASSES, *PLANNED_PASSES))}",
    )


def _chosen(stage: Path, views: StageViews, options: RenderOptions) -> list[StageCamera]:
    """The cameras the options name. Raises RenderError with the names there are."""
    if not views.cameras:
        raise RenderError("has no camera", where=str(stage), expected="a Camera prim")
    _check_names(stage, "camera", options.cameras, [camera.name for camera in views.cameras])
    _check_names(stage, "room", options.rooms, views.rooms)
    chosen = [
        camera
        for camera in views.cameras
        if (not options.cameras or camera.name in options.cameras)
        and (not options.rooms or camera.room in options.rooms)
    ]
    if not chosen:
        raise RenderError(
            "no camera fits both --camera and --room" if options.cameras else "no camera there",
            where=f"{stage}, {', '.join(options.rooms)}",
            expected=f"one of {', '.join(camera.name for camera in views.cameras)}",
        )
    return chosen


def _check_names(stage: Path, what: str, wanted: Sequence[str], there: Sequence[str]) -> None:
    for name in wanted:
        if name not in there:
            near = get_close_matches(name, there, n=1)
            raise RenderError(
                f"has no {what} named '{name}'",
                where=str(stage),
                expected=f"one of {', '.join(there)}" if there else "a stage with one",
                try_=f"--{what} {near[0]}" if near else "",
            )


def _size_px(options: RenderOptions) -> tuple[int, int]:
    width_px, height_px = options.resolution_px
    if options.tile is None:
        return width_px, height_px
    index, count = options.tile
    return width_px, height_px * (index + 1) // count - height_px * index // count


def _job(
    stage: Path,
    views: StageViews,
    cameras: list[StageCamera],
    files: dict[str, Path],
    options: RenderOptions,
) -> dict[str, Any]:
    """The worker's Job, as plain values."""
    return {
        "stage": str(stage.absolute()),
        "has_dome": views.has_dome,
        "shots": [
            {
                "name": camera.name,
                "file": str(files[camera.name]),
                "matrix": camera.matrix,
                "focal_m": camera.focal_m,
                "aperture_m": camera.aperture_m,
                "shift": camera.shift,
                "orthographic": camera.orthographic,
                "clip_m": camera.clip_m,
                "focus_m": camera.focus_m,
                "f_stop": camera.f_stop,
                "from_above": camera.from_above,
            }
            for camera in cameras
        ],
        "width_px": options.resolution_px[0],
        "height_px": options.resolution_px[1],
        "samples": options.samples,
        "seed": options.seed,
        "device": options.device,
        "tile": options.tile,
        "exposure_ev": options.exposure_ev,
    }
