"""Takes of a house by a browser, as Blender makes them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from chord_usd.line.image.exposure import KEY, exposure_ev, tone
from chord_usd.line.image.exr import PixelArray
from chord_usd.line.image.job import Job
from chord_usd.line.image.joined import lit_with
from chord_usd.line.image.marks import Marks
from chord_usd.line.image.stage_cameras import StageCamera
from chord_usd.line.image.takes import Take
from chord_usd.line.image.web.browser import Studio, studio

DEVICE = "Chromium, without a GPU"

_LUMA = (0.2126, 0.7152, 0.0722)
_BELOW = 0.25
"""What studio.js adds to the number of a thing whose surface looks down."""


def web_takes(job: Job, marks: Marks, write_house: Callable[[Path], None]) -> Iterator[Take]:
    """What each camera of a job sees. write_house: writes the stage as a .glb.

    Raises RenderError, MissingExtraError as studio does.
    """
    numbers = {thing.path: thing.number for thing in marks.things}
    with studio(write_house, numbers, (job.width_px, job.height_px)) as opened:
        for view in job.cameras:
            yield _take(opened, job, view)


def _take(opened: Studio, job: Job, view: StageCamera) -> Take:
    picture = light = depth = normal = numbers = None
    stops = 0.0
    if job.colour:
        light, albedo = opened.shoot(view, sorted(lit_with(view.room, job.joined)))
        stops = _stops(light, albedo) if job.exposure_ev is None else job.exposure_ev
        picture = Path(job.folder) / f"{view.name}.png"
        picture.write_bytes(opened.develop(stops))
    if job.data:
        depth, normal, numbers = _unpacked(opened.measure(view))
    return Take(view, stops, picture, None, light, depth, normal, numbers)


def _stops(light: PixelArray, albedo: PixelArray) -> float:
    return exposure_ev(light @ _LUMA, KEY * tone(albedo @ _LUMA))


def _unpacked(data: PixelArray) -> tuple[PixelArray, PixelArray, PixelArray]:
    """Depth, normal and numbers, as takes have them, from what studio.js packs."""
    numbers = np.floor(data[..., 0])
    below = data[..., 0] - numbers >= _BELOW
    empty = data[..., 1] <= 0.0
    x, y = data[..., 2], data[..., 3]
    z = np.sqrt(np.maximum(1.0 - x**2 - y**2, 0.0)) * np.where(below, -1.0, 1.0)
    normal = np.where(empty[..., None], 0.0, np.stack([x, y, z], axis=-1))
    depth = np.where(empty, np.inf, data[..., 1])
    return depth.astype(np.float32), normal.astype(np.float32), np.where(empty, 0.0, numbers)
