"""One picture after the other, of a stage that is imported once."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import bpy

from chord_usd.line.image.exposure import KEY, KEY_BY_LAMPS, KEY_FROM_ABOVE
from chord_usd.line.image.job import (
    COLOUR_FILE,
    DATA_FILE,
    LAYERS_FILE,
    PICTURE_FILE,
    Job,
    Negative,
)
from chord_usd.line.image.joined import lit_with
from chord_usd.line.image.stage_cameras import StageCamera
from chord_usd.line.image.worker.bounces import make_bounces_matte
from chord_usd.line.image.worker.cutaway import cut_open, set_on_base, show_alone
from chord_usd.line.image.worker.data import data_scene, render_data
from chord_usd.line.image.worker.devices import choose_device, share_processor
from chord_usd.line.image.worker.lamps import aim_at_lamps, balance, switch_lamps
from chord_usd.line.image.worker.layers import ask_for_layers
from chord_usd.line.image.worker.light import (
    expose,
    metered_exposure_ev,
    set_look,
    set_quality,
    set_samples,
)
from chord_usd.line.image.worker.outside import Outside
from chord_usd.line.image.worker.scene import aim, import_stage, open_roof
from chord_usd.line.image.worker.shades import Shades

Report = Callable[[dict[str, Any]], None]

_SAMPLE = re.compile(r"Sample (\d+)/(\d+)")


def shoot(job: Job, report: Report) -> None:
    """Render all cameras of a job into its folder. Raises DeviceMissingError."""
    scene = import_stage(job)
    device = choose_device(scene, job.device)
    report({"device": device})
    share_processor(scene)
    set_quality(scene, job)
    # Made when all objects are in place: a copy of a scene lists those it had.
    data = data_scene(scene, job) if job.data else None
    outside, shades = Outside(scene, job), Shades(job)
    by_lamps = balance(scene, job)
    aim_at_lamps(job)
    if job.quality.matte_bounces:
        make_bounces_matte()
    cut_m, alone = 0.0, any(view.is_alone for view in job.cameras)
    # A cut is for good: whole views first, then lower and lower ones.
    for view in sorted(job.cameras, key=lambda view: -(view.cut_m or math.inf)):
        started = time.process_time()
        aim(scene.camera, view)
        if view.cut_m and view.cut_m != cut_m:
            cut_m = view.cut_m
            cut_open(cut_m)
        if alone:
            show_alone(view, job.rooms)
        open_roof(scene, view.from_above)
        set_on_base(scene, view.cut_m > 0.0 and not view.is_alone)
        # What is left out of views from above would change the noise of these, as Cycles keeps it.
        scene.render.use_persistent_data = job.quality.keep_scene and not view.from_above
        outside.show_ground(False)
        switch_lamps(scene, job, view.room)
        key = KEY_FROM_ABOVE if view.from_above else KEY_BY_LAMPS if by_lamps else KEY
        has_ground = not (view.from_above or view.is_alone)
        exposure_ev = 0.0
        if job.colour:
            fixed = job.exposure_ev
            # Not as the picture before left them.
            near = lit_with(view.room, job.joined)
            outside.hold(scene.camera, 0.0, near)
            shades.dim()
            exposure_ev = metered_exposure_ev(scene, job, key) if fixed is None else fixed
            expose(scene, exposure_ev, job.quality.clamp)
            outside.show_ground(has_ground)
            outside.hold(scene.camera, exposure_ev, near)
            shades.glow(exposure_ev)
            _take_light(scene, job, view, report)
        if data is not None:
            outside.show_ground(has_ground)
            _frame_part(data, job)
            render_data(data, Path(job.folder) / DATA_FILE.format(view.name))
        cpu_s = time.process_time() - started
        report({"taken": view.name, "exposure_ev": exposure_ev, "cpu_s": cpu_s})


def _take_light(scene: Any, job: Job, view: StageCamera, report: Report) -> None:
    """Render one view as a picture and as linear light."""
    _frame_part(scene, job)
    times = job.quality.above if view.from_above else 1
    set_samples(scene, job.quality.samples * times, job.part)

    # Cycles prints no samples on standard output; its statistics have them.
    def on_stats(status: str, *_: Any) -> None:
        match = _SAMPLE.search(status)
        if match:
            done, total = map(int, match.groups())
            report({"progress": {"camera": view.name, "done": done, "total": total}})

    if job.layers:
        ask_for_layers(scene, Path(job.folder) / LAYERS_FILE.format(view.name))
    bpy.app.handlers.render_stats.append(on_stats)
    try:
        bpy.ops.render.render(write_still=job.layers)
    finally:
        bpy.app.handlers.render_stats.remove(on_stats)
    result = bpy.data.images["Render Result"]
    folder = Path(job.folder)
    if job.part is None:
        _write_png(scene, result, folder / PICTURE_FILE.format(view.name), view.from_above)
    _write_linear(scene, result, folder / COLOUR_FILE.format(view.name), view.from_above)


def _frame_part(scene: Any, job: Job) -> None:
    """Restrict the render to the job's band."""
    render = scene.render
    render.use_border = render.use_crop_to_border = job.part is not None
    if job.part is None:
        return
    top, bottom = job.part.rows_px(job.height_px)
    # A quarter of a pixel inside: k / height is a pixel off now and then. Blender counts from
    # the bottom.
    render.border_min_x, render.border_max_x = 0.0, 1.0
    render.border_min_y = (job.height_px - bottom + 0.25) / job.height_px
    render.border_max_y = (job.height_px - top + 0.25) / job.height_px


def develop(negative: Negative) -> None:
    """Turn linear light into a picture, as it would have come out of a render."""
    scene = bpy.context.scene
    set_look(scene)
    scene.view_settings.exposure = negative.exposure_ev
    image = bpy.data.images.load(negative.file)
    image.colorspace_settings.name = "Linear Rec.709"
    _write_png(scene, image, Path(negative.picture), image.channels == 4)
    bpy.data.images.remove(image)


def _write_png(scene: Any, image: Any, path: Path, transparent: bool) -> None:
    picture = scene.render.image_settings
    picture.media_type, picture.file_format, picture.color_depth = "IMAGE", "PNG", "8"
    picture.color_mode = "RGBA" if transparent else "RGB"
    image.save_render(str(path), scene=scene)


def _write_linear(scene: Any, image: Any, path: Path, transparent: bool) -> None:
    picture = scene.render.image_settings
    picture.media_type, picture.file_format = "IMAGE", "OPEN_EXR"
    picture.color_depth, picture.exr_codec = "32", "ZIP"
    picture.color_mode = "RGBA" if transparent else "RGB"
    image.save_render(str(path), scene=scene)
