"""How light is traced and how the picture is exposed."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from chord_usd.line.image.exposure import exposure_ev, tone
from chord_usd.line.image.exr import Channels, read_exr
from chord_usd.line.image.job import Job, Part

METER_WIDTH_PX = 96
METER_SAMPLES = 16
_LUMA = (0.2126, 0.7152, 0.0722)

_ROOM_ALPHA = 0.6
"""Pixels that show less than this of anything but sky are a view through a window."""


def set_quality(scene: Any, job: Job) -> None:
    """Settings for interiors: few bounces, no caustics, denoised."""
    cycles, render, quality = scene.cycles, scene.render, job.quality
    cycles.seed = job.seed
    cycles.max_bounces = quality.bounces
    cycles.diffuse_bounces = quality.diffuse_bounces
    cycles.glossy_bounces = quality.glossy_bounces
    cycles.transmission_bounces = quality.transmission_bounces
    cycles.transparent_max_bounces = 8
    cycles.volume_bounces = 0
    cycles.caustics_reflective = cycles.caustics_refractive = quality.caustics
    cycles.blur_glossy = 1.0
    cycles.use_guiding = quality.guiding
    # A part must equal the same pixels of the whole picture, and these three look around.
    whole = job.part is None
    render.dither_intensity = 1.0 if whole else 0.0
    cycles.use_adaptive_sampling = whole and quality.noise > 0.0
    cycles.adaptive_threshold = quality.noise
    cycles.adaptive_min_samples = quality.least_samples
    cycles.use_denoising = whole and quality.denoise
    cycles.denoiser = quality.denoiser.upper()
    cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
    cycles.denoising_prefilter = quality.prefilter
    render.use_persistent_data = quality.keep_scene
    if quality.texture_px:
        render.use_simplify = True
        cycles.texture_limit_render = str(quality.texture_px)
    render.resolution_x, render.resolution_y = job.width_px, job.height_px
    render.resolution_percentage = 100
    set_look(scene)


def set_samples(scene: Any, samples: int, part: Part | None) -> None:
    """Samples of the whole picture, of which a part takes its block."""
    cycles = scene.cycles
    cycles.samples = samples
    cycles.use_sample_subset = part is not None
    if part is not None:
        index, count = part.block
        cycles.sample_offset = samples // count * index
        cycles.sample_subset_length = samples // count


def set_look(scene: Any) -> None:
    """How scene-linear light becomes a picture."""
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Medium High Contrast"


def expose(scene: Any, exposure_ev: float, clamp: float) -> None:
    """Set the exposure, and clamp fireflies at so many times what is white after it.

    An absolute limit would take the bounced light out of a stage whose lamps are given in large
    numbers.
    """
    scene.view_settings.exposure = exposure_ev
    scene.cycles.sample_clamp_indirect = clamp * 2.0**-exposure_ev


def metered_exposure_ev(scene: Any, job: Job, key: float) -> float:
    """Stops that bring the room's log-average luminance to a key.

    Metered on a tiny noisy rendering of the whole view, so every part of a picture gets the same.
    What is seen of the sky does not count.
    """
    luminance, albedo = _metered(scene, job)
    return exposure_ev(luminance, key * tone(albedo))


def _metered(scene: Any, job: Job) -> tuple[np.ndarray, np.ndarray]:
    """(N,) luminance and albedo of what a small noisy picture shows of the room."""
    render, cycles, layer = scene.render, scene.cycles, scene.view_layers[0]
    denoised = cycles.use_denoising
    render.resolution_percentage = max(1, math.ceil(100 * METER_WIDTH_PX / job.width_px))
    cycles.use_denoising = False
    layer.cycles.denoising_store_passes = True
    set_samples(scene, METER_SAMPLES, None)
    cycles.sample_clamp_indirect = 0.0
    render.use_border = False
    picture = render.image_settings
    picture.media_type, picture.file_format = "MULTI_LAYER_IMAGE", "OPEN_EXR_MULTILAYER"
    picture.use_exr_interleave = True
    has_sky, render.film_transparent = not render.film_transparent, True
    render.filepath = str(Path(job.folder) / "meter.exr")
    bpy.ops.render.render(write_still=True)
    channels, _ = read_exr(Path(render.filepath))
    light, albedo = (
        np.stack([_channel(channels, f"{name}.{colour}") for colour in "RGB"], axis=-1) @ _LUMA
        for name in ("Combined", "Denoising Albedo")
    )
    shown = _channel(channels, "Combined.A") > (_ROOM_ALPHA if has_sky else -1.0)
    layer.cycles.denoising_store_passes = False
    render.film_transparent = not has_sky
    render.resolution_percentage, cycles.use_denoising = 100, denoised
    return light[shown], albedo[shown]


def _channel(channels: Channels, name: str) -> np.ndarray:
    """A channel, whatever its layer is called."""
    return next(values for key, values in channels.items() if key.endswith(f".{name}"))
