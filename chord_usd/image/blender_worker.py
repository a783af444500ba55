"""Runs inside Blender: imports a stage once and renders its cameras with Cycles.

Started by render.py as a process of its own, since bpy carries a second, older pxr. One job comes
in on standard input as JSON (see Job); one JSON object per line goes out on standard output:
`{"progress": {"camera": …, "done": samples, "total": samples}}` and `{"written": camera}`. Whatever
Blender itself prints goes to standard error. Imports nothing of chord_usd.

Exit codes: 0 all pictures written; 1 Blender failed; 3 the wanted device is not there; 75 the
disk is full (do not try again).
"""

from __future__ import annotations

import json
import math
import os
import re
import sys
import tempfile
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

EXIT_NO_DEVICE = 3
EXIT_DISK_FULL = 75

GPU_BACKENDS = ("OPTIX", "CUDA", "HIP", "ONEAPI", "METAL")
"""In the order they are tried."""

METER_WIDTH_PX = 96
METER_SAMPLES = 16
KEY = 0.36
KEY_FROM_ABOVE = 0.2
"""Log-average luminance of a finished picture. Above a grey card's 0.18: rooms are mostly pale.
From above one sees their floors instead, which are darker."""

EXPOSURE_RANGE_EV = (-12.0, 12.0)

FIREFLY_WHITE = 10.0
"""Indirect light is clamped at this many times white. An absolute limit would take the bounced
light out of a stage whose lamps are given in large numbers."""

SUN_IMPORT = 4.0
"""The importer makes suns this many times as strong as USD means them, measured on white."""

CEILING = "Ceiling"
"""Names of ceilings start so."""

SKY_STRENGTH = 6.0
"""Radiance outside, for stages without a sky of their own: several times that of a lit wall."""

SKY_STOPS = (
    (0.0, (0.30, 0.28, 0.26)),
    (0.495, (0.42, 0.40, 0.37)),
    (0.505, (0.95, 0.97, 1.0)),
    (0.7, (0.62, 0.78, 1.0)),
    (1.0, (0.40, 0.60, 1.0)),
)
"""Linear colours from straight down (0) over the horizon (0.5) to straight up (1): soft daylight
over pale ground, so that one does not look into a void through a window."""

BACKDROP_RGB = (240, 241, 243)
"""8-bit paper on which a house seen from above lies, instead of in the sky."""

_SAMPLE = re.compile(r"Sample (\d+)/(\d+)")


@dataclass(frozen=True)
class Shot:
    """One picture to take. World units are metres."""

    name: str
    matrix: tuple[tuple[float, ...], ...]
    """(4, 4) camera to world, column vectors; looks along its own -z, y up."""
    file: str
    """Where the finished picture goes."""
    focal_m: float
    aperture_m: float
    """Width of the sensor; of the view, where orthographic."""
    shift: tuple[float, float]
    """How far the view is shifted right and up, over its width."""
    orthographic: bool
    clip_m: tuple[float, float]
    focus_m: float
    """Distance that is sharp; used where f_stop > 0."""
    f_stop: float
    from_above: bool
    """The camera sees through ceilings, and the house lies on a plain backdrop."""


@dataclass(frozen=True)
class Job:
    """Everything one run does; render.py writes it."""

    stage: str
    shots: tuple[Shot, ...]
    width_px: int
    height_px: int
    samples: int
    seed: int
    device: str
    """auto, cpu, gpu or a backend's name in lower case."""
    tile: tuple[int, int] | None
    """(index, count) of the horizontal band to render, counted from the top; None for all."""
    has_dome: bool
    """Whether the stage brings its own sky."""
    exposure_ev: float | None
    """Fixed exposure for all pictures; None meters each one."""


class DeviceMissingError(Exception):
    """The device the job names is not in this machine."""


class FullDiskError(Exception):
    """A picture was cut short, and the disk has no room left."""


def main() -> int:
    """Read the job, render it, return the exit code."""
    report = _claim_stdout()
    job = _read_job(sys.stdin.read())
    _end_with_parent()
    try:
        _render_job(job, report)
    except DeviceMissingError as error:
        sys.stderr.write(f"{error}\n")
        return EXIT_NO_DEVICE
    except FullDiskError as error:
        sys.stderr.write(f"{error}\n")
        return EXIT_DISK_FULL
    return 0


def _claim_stdout() -> Callable[[dict[str, Any]], None]:
    """Keep standard output for reports; Blender's own prints go to standard error."""
    lines = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)

    def report(message: dict[str, Any]) -> None:
        lines.write(json.dumps(message) + "\n")

    return report


def _read_job(text: str) -> Job:
    fields = json.loads(text)
    shots = tuple(
        Shot(**{**shot, "matrix": tuple(map(tuple, shot["matrix"]))}) for shot in fields["shots"]
    )
    return Job(**{**fields, "shots": shots})


def _end_with_parent() -> None:
    """Stop when the process that started this one is gone: a render holds a machine for hours."""
    parent = os.getppid()

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(1.0)
        os._exit(143)

    threading.Thread(target=watch, daemon=True).start()


def _render_job(job: Job, report: Callable[[dict[str, Any]], None]) -> None:
    scene = _import_stage(job)
    _choose_device(scene, job.device)
    _set_quality(scene, job)
    camera = bpy.data.objects.new("ShotCamera", bpy.data.cameras.new("ShotCamera"))
    scene.collection.objects.link(camera)
    scene.camera = camera
    for shot in job.shots:
        _aim(camera, shot)
        _open_roof(scene, shot.from_above)
        key = KEY_FROM_ABOVE if shot.from_above else KEY
        _expose(
            scene,
            _metered_exposure_ev(scene, job, key) if job.exposure_ev is None else job.exposure_ev,
        )
        _take(scene, job, shot, report)
        report({"written": shot.name})


# --- scene --------------------------------------------------------------------------------------


def _import_stage(job: Job) -> Any:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    # Without a world the importer drops a DomeLight silently.
    scene.world = bpy.data.worlds.new("World")
    bpy.ops.wm.usd_import(
        filepath=job.stage,
        import_cameras=False,
        set_frame_range=False,
        import_textures_mode="IMPORT_PACK",  # of .usdz packages; files elsewhere are left there
        mtl_name_collision_mode="MAKE_UNIQUE",
    )
    for mesh in bpy.data.meshes:
        # USD draws faces without normals flat, Blender's importer makes them smooth.
        if not mesh.has_custom_normals:
            mesh.shade_flat()
    for light in bpy.data.lights:
        if light.type == "SUN":
            light.energy /= SUN_IMPORT
    if not job.has_dome:
        _paint_sky(scene.world)
    return scene


def _paint_sky(world: Any) -> None:
    """A world whose colour follows SKY_STOPS from nadir to zenith."""
    nodes, links = world.node_tree.nodes, world.node_tree.links
    direction = nodes.new("ShaderNodeTexCoord")
    split = nodes.new("ShaderNodeSeparateXYZ")
    height = nodes.new("ShaderNodeMapRange")
    height.inputs["From Min"].default_value = -1.0
    ramp = nodes.new("ShaderNodeValToRGB")
    stops = ramp.color_ramp.elements
    while len(stops) < len(SKY_STOPS):
        stops.new(0.5)
    for stop, (position, rgb) in zip(stops, SKY_STOPS, strict=True):
        stop.position, stop.color = position, (*rgb, 1.0)
    background = nodes["Background"]
    background.inputs["Strength"].default_value = SKY_STRENGTH
    links.new(direction.outputs["Generated"], split.inputs["Vector"])
    links.new(split.outputs["Z"], height.inputs["Value"])
    links.new(height.outputs["Result"], ramp.inputs["Fac"])
    links.new(ramp.outputs["Color"], background.inputs["Color"])


def _aim(camera: Any, shot: Shot) -> None:
    """Set the lens from the USD values: the importer gets orthographic cameras wrong tenfold."""
    lens = camera.data
    camera.matrix_world = Matrix(shot.matrix)
    lens.clip_start, lens.clip_end = shot.clip_m
    lens.type = "ORTHO" if shot.orthographic else "PERSP"
    lens.sensor_fit = "HORIZONTAL"
    if shot.orthographic:
        lens.ortho_scale = shot.aperture_m
    else:
        lens.sensor_width = shot.aperture_m * 1000.0  # Blender's lens is in millimetres
        lens.lens = shot.focal_m * 1000.0
    lens.shift_x, lens.shift_y = shot.shift
    lens.dof.use_dof = shot.f_stop > 0
    if shot.f_stop > 0:
        lens.dof.aperture_fstop = shot.f_stop
        lens.dof.focus_distance = shot.focus_m


def _open_roof(scene: Any, is_open: bool) -> None:
    """Let the camera see through ceilings and sky, or not.

    Ceilings go on casting shadows: so the rooms keep the light they have inside.
    """
    for thing in bpy.data.objects:
        if thing.type == "MESH" and thing.name.startswith(CEILING):
            thing.visible_camera = not is_open
    scene.render.film_transparent = is_open


# --- Cycles -------------------------------------------------------------------------------------


def _choose_device(scene: Any, wanted: str) -> None:
    """Select CPU or GPU. `auto` takes the first GPU there is, else the CPU."""
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    if wanted == "cpu":
        return
    preferences = bpy.context.preferences.addons["cycles"].preferences
    backends = GPU_BACKENDS if wanted in ("auto", "gpu") else (wanted.upper(),)
    for backend in backends:
        try:
            preferences.compute_device_type = backend
        except TypeError:  # this build of Blender does not know the backend
            continue
        preferences.refresh_devices()
        found = [device for device in preferences.devices if device.type == backend]
        if found:
            for device in preferences.devices:
                device.use = device in found
            scene.cycles.device = "GPU"
            return
    if wanted != "auto":
        raise DeviceMissingError(f"this machine has no {wanted} device that Blender can use")


def _set_quality(scene: Any, job: Job) -> None:
    """Settings for interiors: few bounces, clamped fireflies, light tree, denoised."""
    cycles, render = scene.cycles, scene.render
    cycles.samples, cycles.seed = job.samples, job.seed
    cycles.max_bounces = 8
    cycles.diffuse_bounces = 4
    cycles.glossy_bounces = 4
    cycles.transmission_bounces = 6
    cycles.transparent_max_bounces = 8
    cycles.volume_bounces = 0
    cycles.caustics_reflective = cycles.caustics_refractive = False
    cycles.blur_glossy = 1.0
    cycles.use_light_tree = True
    # A tile must equal the same pixels of the whole picture, and these three look around.
    whole = job.tile is None
    render.dither_intensity = 1.0 if whole else 0.0
    cycles.use_adaptive_sampling = whole
    cycles.adaptive_threshold = 0.02
    cycles.use_denoising = whole
    cycles.denoiser = "OPENIMAGEDENOISE"
    cycles.denoising_input_passes = "RGB_ALBEDO_NORMAL"
    cycles.denoising_prefilter = "ACCURATE"
    render.use_persistent_data = True
    render.resolution_x, render.resolution_y = job.width_px, job.height_px
    render.resolution_percentage = 100
    scene.view_settings.view_transform = "AgX"
    scene.view_settings.look = "AgX - Medium High Contrast"


def _expose(scene: Any, exposure_ev: float) -> None:
    """Set the exposure, and clamp fireflies at a brightness that is white after it."""
    scene.view_settings.exposure = exposure_ev
    scene.cycles.sample_clamp_indirect = FIREFLY_WHITE * 2.0**-exposure_ev


def _metered_exposure_ev(scene: Any, job: Job, key: float) -> float:
    """Stops that bring the picture's log-average luminance to key.

    Metered on a tiny noisy rendering of the whole view, so every tile of a picture gets the same.
    """
    render, cycles = scene.render, scene.cycles
    kept = (render.resolution_percentage, cycles.samples, cycles.use_denoising)
    render.resolution_percentage = max(1, math.ceil(100 * METER_WIDTH_PX / job.width_px))
    cycles.samples, cycles.use_denoising = METER_SAMPLES, False
    cycles.sample_clamp_indirect = 0.0
    render.use_border = False
    render.image_settings.file_format = "OPEN_EXR"
    with tempfile.TemporaryDirectory(prefix="chord-usd-") as folder:
        render.filepath = str(Path(folder) / "meter.exr")
        bpy.ops.render.render(write_still=True)
        image = bpy.data.images.load(render.filepath)
        rgba = np.empty(image.size[0] * image.size[1] * image.channels, dtype=np.float32)
        image.pixels.foreach_get(rgba)
        rgb = rgba.reshape(-1, image.channels)[:, :3].astype(np.float64)
        bpy.data.images.remove(image)
    render.resolution_percentage, cycles.samples, cycles.use_denoising = kept
    return exposure_ev(rgb @ np.array([0.2126, 0.7152, 0.0722]), key)


def exposure_ev(luminance: Any, key: float) -> float:
    """Stops from scene-linear luminances to a log-average of key.

    The darkest tenth is left out: what no light reaches should stay dark. 0.0 for a black scene.
    """
    lit = np.sort(np.asarray(luminance).ravel())
    lit = lit[len(lit) // 10 :]
    lit = lit[lit > 1e-6]
    if not len(lit):
        return 0.0
    log_average = float(np.exp2(np.log2(lit).mean()))
    return float(np.clip(math.log2(key / log_average), *EXPOSURE_RANGE_EV))


# --- pictures -----------------------------------------------------------------------------------


def _take(scene: Any, job: Job, shot: Shot, report: Callable[[dict[str, Any]], None]) -> None:
    """Render one shot into X.part.png, look whether it is whole, and give it its name.

    Blender says "Saved" and exits 0 for a file that a full disk cut short.
    """
    final = Path(shot.file)
    part = final.with_suffix(".part.png")
    scene.render.filepath = str(part)
    size_px = _frame_tile(scene, job)
    # The metering picture was of another format; Blender then forgets the depth of this one.
    picture = scene.render.image_settings
    picture.file_format, picture.color_depth = "PNG", "8"
    picture.color_mode = "RGBA" if shot.from_above else "RGB"

    def on_stats(status: str, *_: Any) -> None:
        found = _SAMPLE.search(status)
        if found:
            done, total = map(int, found.groups())
            report({"progress": {"camera": shot.name, "done": done, "total": total}})

    bpy.app.handlers.render_stats.append(on_stats)
    try:
        bpy.ops.render.render(write_still=True)
        _check_whole(part, size_px)
        if shot.from_above:
            _lay_on_backdrop(part)
            _check_whole(part, size_px)
        part.replace(final)
    finally:
        bpy.app.handlers.render_stats.remove(on_stats)
        part.unlink(missing_ok=True)


def _frame_tile(scene: Any, job: Job) -> tuple[int, int]:
    """Restrict the render to the job's band; returns the width and height of the picture."""
    render = scene.render
    render.use_border = render.use_crop_to_border = job.tile is not None
    if job.tile is None:
        return job.width_px, job.height_px
    index, count = job.tile
    top = job.height_px * index // count
    bottom = job.height_px * (index + 1) // count
    # A quarter of a pixel inside: k / height is a pixel off now and then. Blender counts from
    # the bottom.
    render.border_min_x, render.border_max_x = 0.0, 1.0
    render.border_min_y = (job.height_px - bottom + 0.25) / job.height_px
    render.border_max_y = (job.height_px - top + 0.25) / job.height_px
    return job.width_px, bottom - top


def _lay_on_backdrop(path: Path) -> None:
    from PIL import Image

    with Image.open(path) as picture:
        backdrop = Image.new("RGBA", picture.size, (*BACKDROP_RGB, 255))
        backdrop.alpha_composite(picture.convert("RGBA"))
    backdrop.convert("RGB").save(path, format="PNG")


def _check_whole(path: Path, size_px: tuple[int, int]) -> None:
    """Raise unless the file is a picture of this size that decodes to its last row."""
    from PIL import Image

    try:
        with Image.open(path) as picture:
            picture.load()
            found_px = picture.size
    except OSError as error:
        if _disk_is_full(path.parent):
            raise FullDiskError(f"{path}: the disk is full") from error
        raise
    if found_px != size_px:
        raise ValueError(f"{path} is {found_px} pixels, expected {size_px}")
    with path.open("rb") as file:
        os.fsync(file.fileno())


def _disk_is_full(folder: Path) -> bool:
    """Whether a further 64 KiB cannot be written here."""
    try:
        with tempfile.TemporaryFile(dir=folder) as probe:
            probe.write(b"\0" * 65536)
            probe.flush()
            os.fsync(probe.fileno())
    except OSError:
        return True
    return False


if __name__ == "__main__":
    code = main()
    sys.stdout.flush()
    sys.exit(code)
