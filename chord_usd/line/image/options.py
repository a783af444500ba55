"""How to take pictures of a stage."""

from __future__ import annotations

from dataclasses import dataclass, replace

from chord_usd.base.errors import RenderError
from chord_usd.base.scene.label_sets import LABEL_SETS, OWN
from chord_usd.line.image.job import DENOISERS, Part, Quality
from chord_usd.line.image.products import PASSES

DEVICES = ("auto", "cpu", "gpu", "cuda", "optix", "hip", "oneapi", "metal")

QUALITIES = {
    "draft": Quality(samples=4, above=2, noise=0.1, prefilter="FAST"),
    "good": Quality(),
    "final": Quality(samples=1024, noise=0.005, bounces=12, diffuse_bounces=6, matte_bounces=False),
}

NO_DENOISER = "none"
LIGHT_PASSES = ("rgb", "layers")

_PICTURE_PX = (1280, 720)
_DRAFT_PX = (640, 360)
"""Every room of a house in two minutes, on two processor cores."""


def usual_px(quality: str) -> tuple[int, int]:
    """Width and height of pictures of a quality, where none are asked for."""
    return _DRAFT_PX if quality == "draft" else _PICTURE_PX


CYCLES, WEB = ENGINES = ("cycles", "web")
"""Light is traced by Blender, or drawn by three.js in a browser: a second or so a picture."""


@dataclass(frozen=True)
class RenderOptions:
    """How to take pictures of a stage."""

    cameras: tuple[str, ...] = ()
    """Names of the cameras to use; empty for all."""
    rooms: tuple[str, ...] = ()
    """Only cameras that stand in these rooms; empty for all."""
    walkthrough: int = 0
    """Instead of the stage's cameras, this many along a walk through the doors; 0 for none."""
    turntable: str = ""
    """Instead of the stage's cameras, views around this room, which stands alone."""
    frames: int = 36
    """Views of a turntable."""
    frame: tuple[int, int] | None = None
    """Of a walk or turntable only the views from one to another number, both included; from 0."""
    resolution_px: tuple[int, int] = (1280, 720)
    """Width and height."""
    quality: Quality = QUALITIES["good"]
    samples: int | None = None
    """Paths traced through each pixel, at most; None for the number of the quality."""
    denoiser: str = DENOISERS[0]
    """One of job.DENOISERS, or none."""
    seed: int = 0
    """Of the noise; the same seed gives the same picture."""
    passes: tuple[str, ...] = ("rgb",)
    label_set: str = OWN
    """One of scene.label_sets: what `coco.json` calls things."""
    engine: str = CYCLES
    """One of ENGINES."""
    device: str = "auto"
    """auto (a GPU if there is one), cpu, gpu or a backend such as cuda."""
    tile: tuple[int, int] | None = None
    """(index, count): the index-th of count horizontal bands, the top one 0."""
    sample_block: tuple[int, int] | None = None
    """(index, count): the index-th of count equal shares of the samples."""
    merge: bool = False
    """Put tiles and sample blocks together that lie in the folder, instead of rendering."""
    skip_existing: bool = False
    """Leave pictures alone that are there already, whole, and made in the same way."""
    allow_missing: bool = False
    """Render plain colours in place of files that the stage lacks, instead of refusing it."""
    room_names: bool = False
    """Write names and areas of rooms on pictures from straight above."""
    exposure_ev: float | None = None
    """Exposure in stops for every picture; None meters each one."""
    lighting: str = ""
    """Choice of the stage's variant set `lighting`; empty for the one it has selected."""
    sky: str = ""
    """Name of a sky (scene.skies) or an HDRI's file, in place of the stage's; empty for that."""
    roof: str = ""
    """Choice of the stage's variant set `roof`; empty for the one it has selected."""

    def __post_init__(self) -> None:
        """Raises RenderError for a combination that cannot be rendered."""
        _check_numbers(self)
        _check_parts(self)
        _check_words(self)

    @property
    def traced(self) -> Quality:
        """The quality, with samples and denoiser asked for."""
        samples = self.quality.samples if self.samples is None else self.samples
        denoise = self.quality.denoise and self.denoiser != NO_DENOISER
        denoiser = self.denoiser if denoise else self.quality.denoiser
        return replace(self.quality, samples=samples, denoise=denoise, denoiser=denoiser)

    @property
    def part(self) -> Part | None:
        """The part of each picture that is asked for; None for whole pictures."""
        if self.tile is None and self.sample_block is None:
            return None
        return Part(self.tile or (0, 1), self.sample_block or (0, 1))

    @property
    def data(self) -> bool:
        """Whether a pass is asked for that shows things and no light."""
        return any(name not in LIGHT_PASSES for name in self.passes)

    @property
    def light(self) -> bool:
        """Whether a pass is asked for that shows light."""
        return any(name in LIGHT_PASSES for name in self.passes)


def _check_numbers(options: RenderOptions) -> None:
    width_px, height_px = options.resolution_px
    if not (4 <= width_px <= 16384 and 4 <= height_px <= 16384):
        raise RenderError(
            f"a picture of {width_px}x{height_px} cannot be rendered",
            where="<resolution>",
            expected="4 to 16384 pixels each way, such as 1280x720",
        )
    samples = options.traced.samples
    if not 1 <= samples <= 65536:
        raise RenderError(f"{samples} samples", where="<samples>", expected="1 to 65536")
    if not 0 <= options.seed < 2**31:
        raise RenderError(f"seed {options.seed}", where="<seed>", expected="0 to 2147483647")
    if not 1 <= options.frames <= 10000:
        raise RenderError(f"{options.frames} frames", where="<frames>", expected="1 to 10000")
    count = options.frames if options.turntable else options.walkthrough
    if options.frame is not None and not 0 <= options.frame[0] <= options.frame[1] < count:
        raise RenderError(
            f"frames {options.frame[0]}-{options.frame[1]}",
            where="<frame>",
            expected=f"0-{count - 1} or fewer" if count else "<walkthrough> or <turntable>",
        )
    if options.turntable and options.walkthrough:
        raise RenderError("a walk and a turntable at once", expected="<walkthrough> or <turntable>")
    if not 0 <= options.walkthrough <= 10000:
        raise RenderError(
            f"a walk of {options.walkthrough} pictures",
            where="<walkthrough>",
            expected="1 to 10000",
        )


def _check_parts(options: RenderOptions) -> None:
    height_px, samples = options.resolution_px[1], options.traced.samples
    if options.tile is not None and not 0 <= options.tile[0] < options.tile[1] <= height_px:
        raise RenderError(
            f"there is no tile {options.tile[0]} of {options.tile[1]}",
            where="<tile>",
            expected="I/N with I from 0 to N-1, and no more tiles than rows of pixels",
        )
    block = options.sample_block
    if block is not None and (not 0 <= block[0] < block[1] or samples % block[1]):
        raise RenderError(
            f"{samples} samples have no block {block[0]} of {block[1]}",
            where="<sample_block>",
            expected="I/N with I from 0 to N-1, and samples that N divides: only equal blocks "
            "average to the picture",
        )
    if "layers" in options.passes and (options.merge or options.part is not None):
        raise RenderError(
            "layers come in no parts", where="<passes>", try_="layers without tiles and blocks"
        )
    if options.merge and options.part is not None:
        raise RenderError("takes all parts there are", where="<merge>", try_="no <tile>")


def _check_words(options: RenderOptions) -> None:
    if options.engine not in ENGINES:
        raise RenderError(
            f"unknown engine '{options.engine}'",
            where="<engine>",
            expected=f"one of {', '.join(ENGINES)}",
        )
    if options.engine == WEB and (options.merge or options.part or "layers" in options.passes):
        raise RenderError(
            "a browser draws whole pictures, without layers", where="<engine=web>", try_="cycles"
        )
    if options.device not in DEVICES:
        raise RenderError(
            f"unknown device '{options.device}'",
            where="<device>",
            expected=f"one of {', '.join(DEVICES)}",
        )
    if options.denoiser not in (NO_DENOISER, *DENOISERS):
        raise RenderError(
            f"unknown denoiser '{options.denoiser}'",
            where="<denoiser>",
            expected=f"one of {', '.join((NO_DENOISER, *DENOISERS))}",
        )
    if options.label_set not in LABEL_SETS:
        raise RenderError(
            f"unknown label set '{options.label_set}'",
            where="<label_set>",
            expected=f"one of {', '.join(LABEL_SETS)}",
        )
    if not options.passes:
        raise RenderError("no pass", where="<passes>", expected=f"some of {', '.join(PASSES)}")
    for name in options.passes:
        if name not in PASSES:
            raise RenderError(
                f"unknown pass '{name}'", where="<passes>", expected=f"one of {', '.join(PASSES)}"
            )
