"""What is asked of Blender's process. Plain data that crosses as JSON; imports nothing heavy."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass

from chord_usd.line.image.stage_cameras import StageCamera

EXIT_NO_DEVICE = 3
EXIT_UNREADABLE = 4

PICTURE_FILE = "{}.png"
COLOUR_FILE = "{}.exr"
DATA_FILE = "{}.data.exr"
LAYERS_FILE = "{}.layers.exr"
"""What Blender leaves in the job's folder for each camera."""


DENOISERS = ("openimagedenoise", "optix")


@dataclass(frozen=True)
class Quality:
    """What a picture may cost. Each field is a lever that benchmarks/render_speed.py measures."""

    samples: int = 128
    """Paths traced through each pixel, at most."""
    above: int = 1
    """Times as many samples from above, where paper shows through alpha, which stays noisy."""
    noise: float = 0.02
    """A pixel with less noise than this gets no more samples; 0 samples all pixels alike."""
    least_samples: int = 0
    """Samples that every pixel gets before its noise is judged; 0 lets Cycles choose."""
    bounces: int = 8
    diffuse_bounces: int = 4
    glossy_bounces: int = 4
    caustics: bool = False
    """Light that mirrors and glass throw on other things: dear, and mostly fireflies."""
    transmission_bounces: int = 6
    light_tree_lamps: int = 2
    """From so many lamps on, choose among them by how much they can give to a point. Below 8 that
    costs more than it gives; but without it the noise follows the order that Cycles has lamps in,
    which is another one in every run."""
    own_lamps: bool = True
    """In a room, let only the lamps shine whose light can come in: lamps of rooms that a passage or
    glass joins to it."""
    sample_glow: bool = False
    """In houses, send shadow rays to screens, too. Few arrive."""
    matte_bounces: bool = True
    """Take surfaces for matte and plain where scattered light meets them."""
    clear_glass: bool = True
    """In houses, let shadow rays and scattered light pass through windows as if they stood open."""
    guiding: bool = False
    """Learn where light comes from while rendering."""
    clamp: float = 40.0
    """Cut indirect light that is this many times as bright as white, which would be a firefly; 0
    cuts none. At 10, rooms are up to three levels of 255 darker, at any number of samples."""
    denoise: bool = True
    denoiser: str = "openimagedenoise"
    """One of DENOISERS; a GPU's own is quicker, and differs between GPUs."""
    prefilter: str = "ACCURATE"
    """How the denoiser's guides are cleaned: NONE, FAST or ACCURATE."""
    keep_scene: bool = True
    """Keep what Cycles built for one picture for the next one."""
    texture_px: int = 0
    """Longest side of a texture in memory; 0 for as large as it is."""


@dataclass(frozen=True)
class Part:
    """A share of a picture: one horizontal band of its pixels, and one block of its samples."""

    tile: tuple[int, int] = (0, 1)
    """(index, count); the bands are counted from the top."""
    block: tuple[int, int] = (0, 1)
    """(index, count); the blocks are equal."""

    def rows_px(self, height_px: int) -> tuple[int, int]:
        """First row of the band and the row after its last one, counted from the top."""
        index, count = self.tile
        return height_px * index // count, height_px * (index + 1) // count


@dataclass(frozen=True)
class Negative:
    """Linear light on its way to a picture."""

    file: str
    """EXR, RGB or RGBA."""
    picture: str
    """PNG to write."""
    exposure_ev: float


@dataclass(frozen=True)
class Job:
    """Everything one run of Blender does."""

    folder: str
    """Where its files go (PICTURE_FILE and its siblings)."""
    stage: str = ""
    cameras: tuple[StageCamera, ...] = ()
    width_px: int = 0
    height_px: int = 0
    quality: Quality = Quality()
    seed: int = 0
    device: str = "cpu"
    """auto, cpu, gpu or a backend's name in lower case."""
    part: Part | None = None
    """Of each picture; None for pictures that are whole, and denoised."""
    colour: bool = True
    """Render light."""
    layers: bool = False
    """Keep light with its passes, Cryptomatte and the denoiser's guides in one file."""
    data: bool = False
    """Render depth, normals and which thing each pixel shows."""
    rooms: tuple[str, ...] = ()
    """Names of the rooms of the house; empty for a stage that is none."""
    joined: tuple[tuple[str, str], ...] = ()
    """Rooms between which light goes."""
    has_dome: bool = False
    """Whether the stage brings its own sky."""
    exposure_ev: float | None = None
    """Fixed exposure for all pictures; None meters each one."""
    allow_missing: bool = False
    """Let plain colours stand in for pictures that cannot be read."""
    negatives: tuple[Negative, ...] = ()
    """To develop, without a stage."""


def write_job(job: Job) -> str:
    """The job as JSON."""
    return json.dumps(asdict(job))


def read_job(text: str) -> Job:
    """The job that write_job wrote."""
    fields = json.loads(text)
    part = fields["part"]
    fields |= {
        "cameras": tuple(_camera(camera) for camera in fields["cameras"]),
        "quality": Quality(**fields["quality"]),
        "part": part and Part(tuple(part["tile"]), tuple(part["block"])),
        "rooms": tuple(fields["rooms"]),
        "joined": tuple(tuple(pair) for pair in fields["joined"]),
        "negatives": tuple(Negative(**negative) for negative in fields["negatives"]),
    }
    return Job(**fields)


def _camera(fields: dict) -> StageCamera:
    pairs = {name: tuple(fields[name]) for name in ("shift", "clip_m")}
    return StageCamera(**{**fields, **pairs, "matrix": tuple(map(tuple, fields["matrix"]))})
