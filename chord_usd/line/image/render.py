"""StageFile -> pictures: reads the cameras, starts Blender in its own process, follows it.

bpy carries a second, older pxr, so the two never share a process: the stage is read here with
usd-core, `worker` renders it, and what comes back becomes files here.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cached_property, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.errors import DiskFullError, RenderError
from chord_usd.base.runtime.files import folder_for_many
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.runtime.scratch import scratch_folder
from chord_usd.base.runtime.stages import StageFiles, files_of
from chord_usd.line.image.blender import run_blender
from chord_usd.line.image.exr import colour_channels, write_exr
from chord_usd.line.image.job import PICTURE_FILE, Job, Negative, Part
from chord_usd.line.image.joined import joined_rooms
from chord_usd.line.image.made import (
    missing_files,
    missing_words,
    picture_record,
    require_files,
    settings_record,
    stage_digest,
)
from chord_usd.line.image.marks import Marks, marked_stage, read_marks
from chord_usd.line.image.options import WEB, RenderOptions
from chord_usd.line.image.picture_layers import lit_stage
from chord_usd.line.image.products import are_finished, product_files, write_coco, write_products
from chord_usd.line.image.render_parts import is_finished_part, merge_parts, part_file, write_part
from chord_usd.line.image.stage_cameras import (
    DEFAULT_CAMERA,
    StageCamera,
    StageViews,
    read_views,
)
from chord_usd.line.image.takes import Take, read_take

if TYPE_CHECKING:
    from chord_usd.line.image.room_labels import RoomLabel

WriteGlb = Callable[[Path, Path], None]
"""Writes a stage to a .glb."""

_NO_MARKS = Marks((), ())


@dataclass(frozen=True)
class Rendered:
    """What a run left."""

    files: tuple[Path, ...]
    """All pictures, camera by camera; parts of them where parts were asked for."""
    rendered: int
    """How many cameras were rendered or merged, and not found finished."""
    device: str
    """What Cycles ran on; empty where nothing was rendered."""
    warnings: tuple[str, ...] = ()
    """What a user should know of the stage."""

    @property
    def pictures(self) -> tuple[Path, ...]:
        """`<camera>.png` of each camera; all files where rgb was not asked for."""
        pngs = [file for file in self.files if file.name.count(".") == 1 and file.suffix == ".png"]
        return tuple(pngs) or self.files


def render_stage(
    stage: Path,
    folder: Path,
    options: RenderOptions,
    progress: Progress | None = None,
    write_glb: WriteGlb | None = None,
) -> Rendered:
    """Render the stage's cameras into a folder, `<camera>.png` and the other passes beside it.

    progress: called with the samples done and the samples of all pictures together. write_glb:
    writes a stage as a .glb, which the engine "web" asks for. The files of
    a camera appear together or not at all; an interrupt ends Blender and leaves no part of one.
    Raises StageError for a stage that cannot be read, RenderError for files that it lacks, a camera
    or room that is not in it, a missing device and a failure inside Blender, OutputError for a
    folder that cannot be written or a full disk.
    """
    with _opened(stage, folder, options) as run:
        cameras = run.cameras
        due = [
            camera
            for camera in cameras
            if not (options.skip_existing and run.is_finished(camera, options.part))
        ]
        if due and options.merge:
            _merge(run, due)
        elif due:
            with folder_for_many(folder):
                _render(run, due, progress, write_glb)
    made = [file for camera in cameras for file in run.files(camera.name)]
    if "instance" in options.passes and options.part is None:
        names = [camera.name for camera in cameras]
        made.append(write_coco(folder, names, options.label_set))
    return Rendered(tuple(made), len(due), run.device, tuple(_warnings(run)))


def unfinished(
    stage: Path, folder: Path, options: RenderOptions, parts: Sequence[Part | None] = (None,)
) -> list[tuple[str, Part | None]]:
    """(camera, part) of all that is not in the folder yet, whole and made from the same.

    options: with a tile or a sample block where parts are asked for. Raises as render_stage does,
    but for what Blender says.
    """
    with _opened(stage, folder, options) as run:
        return [
            (camera.name, part)
            for camera in run.cameras
            for part in parts
            if not run.is_finished(camera, part)
        ]


def _warnings(run: _Run) -> Iterator[str]:
    if missing := missing_files(run.stage_files):
        yield f"{run.stage}: {missing_words(missing)}; plain colours stand in"
    if [camera.name for camera in run.views.cameras] == [DEFAULT_CAMERA]:
        yield f"{run.stage}: has no camera; took a view of everything"


def camera_names(stage: Path, options: RenderOptions) -> list[str]:
    """The cameras that render_stage would use. Raises StageError, RenderError."""
    with lit_stage(stage, options.lighting, options.sky, options.roof) as lit:
        return [camera.name for camera in _chosen(stage, lit, read_views(lit), options)]


@dataclass
class _Run:
    """What is asked for, and where it goes."""

    stage: Path
    lit: Path
    """The stage, or a layer over it, which is what Blender opens."""
    folder: Path
    views: StageViews
    options: RenderOptions
    stage_files: StageFiles
    cameras: list[StageCamera] = field(init=False)
    device: str = ""

    def __post_init__(self) -> None:
        self.cameras = _chosen(self.stage, self.lit, self.views, self.options)
        self._settings = settings_record(self.options)
        self._stage_sha256 = stage_digest(self.stage_files)
        self._made: dict[str, dict[str, Any]] = {}

    @cached_property
    def labels(self) -> tuple[RoomLabel, ...]:
        """What is written on pictures from straight above."""
        if not self.options.room_names:
            return ()
        from chord_usd.line.image.room_labels import read_labels

        return read_labels(self.lit)

    def made(self, camera: StageCamera) -> dict[str, Any]:
        """What a camera's picture is made from."""
        if camera.name not in self._made:
            record = picture_record(self._settings, self._stage_sha256, camera)
            self._made[camera.name] = record
        return self._made[camera.name]

    def files(self, camera: str) -> list[Path]:
        """What a camera's picture is written to."""
        if self.options.part is not None:
            return [part_file(self.folder, camera, self.options.part)]
        return product_files(self.folder, camera, self.options.passes)

    def is_finished(self, camera: StageCamera, part: Part | None) -> bool:
        """Whether an earlier run left it whole, made from the same."""
        made = self.made(camera)
        if part is not None:
            return is_finished_part(self.folder, camera.name, part, made)
        return are_finished(self.folder, camera.name, made)

    def write(self, take: Take, marks: Marks) -> None:
        """Write what was taken."""
        made = self.made(take.view)
        if self.options.part is not None:
            write_part(take, self.folder, self.options.part, made)
        else:
            passes = self.options.passes
            write_products(take, self.folder, passes, marks.things, made, self.labels)


@contextmanager
def _opened(stage: Path, folder: Path, options: RenderOptions) -> Iterator[_Run]:
    """What is asked of a stage. Raises StageError, RenderError."""
    files = files_of(stage)
    if not options.allow_missing:
        require_files(stage, files)
    with lit_stage(stage, options.lighting, options.sky, options.roof) as lit:
        yield _Run(stage, lit, folder, read_views(lit), options, files)


def _render(
    run: _Run, cameras: list[StageCamera], progress: Progress | None, write_glb: WriteGlb | None
) -> None:
    options = run.options
    first_block = options.part is None or options.part.block[0] == 0
    data, colour = options.data and first_block, options.light
    marks = read_marks(run.lit) if data else _NO_MARKS
    with (
        scratch_folder() as raw,
        marked_stage(run.lit, marks)
        if marks.numbers and options.engine != WEB
        else nullcontext(run.lit) as seen,
    ):
        job = Job(
            folder=str(raw),
            stage=str(absolute(seen)),
            cameras=tuple(cameras),
            width_px=options.resolution_px[0],
            height_px=options.resolution_px[1],
            quality=options.traced,
            seed=options.seed,
            device=options.device,
            part=options.part,
            colour=colour,
            layers="layers" in options.passes,
            data=data,
            rooms=run.views.rooms,
            joined=joined_rooms(run.lit) if colour else (),
            has_dome=run.views.has_dome,
            exposure_ev=options.exposure_ev,
            allow_missing=options.allow_missing,
        )
        if options.engine == WEB:
            if write_glb is None:
                raise RenderError("the engine web needs write_glb", try_="<engine=cycles>")
            _draw(run, job, marks, progress, partial(write_glb, run.lit))
        else:
            run_blender(job, _Follower(run, job, marks, progress))


def _draw(
    run: _Run,
    job: Job,
    marks: Marks,
    progress: Progress | None,
    write_house: Callable[[Path], None],
) -> None:
    """Take the pictures in a browser."""
    from chord_usd.line.image.web.web_takes import DEVICE, web_takes

    run.device = DEVICE
    for done, take in enumerate(web_takes(job, marks, write_house), start=1):
        run.write(take, marks)
        if progress is not None:
            progress(done, len(job.cameras))


class _Follower:
    """Adds up what the worker reports, and turns what it has taken into files."""

    def __init__(self, run: _Run, job: Job, marks: Marks, progress: Progress | None) -> None:
        self._run, self._job, self._marks, self._progress = run, job, marks, progress
        self._views = {camera.name: camera for camera in job.cameras}
        self._done = dict.fromkeys(self._views, 0.0)

    def __call__(self, message: dict[str, Any]) -> None:
        if "device" in message:
            self._run.device = message["device"]
            return
        if "progress" in message:
            progress = message["progress"]
            self._done[progress["camera"]] = progress["done"] / progress["total"]
        if "taken" in message:
            self._keep(message["taken"], message["exposure_ev"])
            self._done[message["taken"]] = 1.0
        if self._progress is not None:
            samples = self._job.quality.samples
            total = samples * len(self._done)
            self._progress(round(samples * sum(self._done.values())), total)

    def _keep(self, camera: str, exposure_ev: float) -> None:
        raw = Path(self._job.folder)
        try:
            take = read_take(
                raw,
                self._views[camera],
                exposure_ev,
                colour=self._job.colour,
                data=self._job.data,
            )
        except OSError as error:
            # Blender says "Saved" and exits 0 for a file that a full disk cut short.
            raise DiskFullError(
                "Blender left a file that is cut short; the disk may be full",
                where=str(raw.parent),
                try_="free some space there, or set TMPDIR to another disk",
            ) from error
        self._run.write(take, self._marks)
        for file in raw.glob(f"{camera}.*"):
            file.unlink()


def _merge(run: _Run, cameras: list[StageCamera]) -> None:
    marks = read_marks(run.lit) if run.options.data else _NO_MARKS
    with scratch_folder() as raw:
        takes = [merge_parts(run.folder, view, run.made(view)) for view in cameras]
        negatives = []
        for take in takes:
            if take.colour is None:
                continue
            linear = raw / f"{take.view.name}.exr"
            write_exr(linear, colour_channels(take.colour))
            picture = raw / PICTURE_FILE.format(take.view.name)
            negatives.append(Negative(str(linear), str(picture), take.exposure_ev))
        if negatives:
            run_blender(Job(folder=str(raw), negatives=tuple(negatives)), lambda message: None)
        for take in takes:
            picture = raw / PICTURE_FILE.format(take.view.name)
            run.write(take.developed(picture), marks)


# --- what to render -----------------------------------------------------------------------------


def _chosen(stage: Path, lit: Path, views: StageViews, options: RenderOptions) -> list[StageCamera]:
    """The cameras the options name, framed. Raises RenderError with the names there are."""
    if options.walkthrough:
        from chord_usd.line.image.walkthrough import walk_cameras

        there: Sequence[StageCamera] = walk_cameras(lit, options.walkthrough)
    elif options.turntable:
        from chord_usd.line.image.turntable import turn_cameras

        there = turn_cameras(lit, options.turntable, options.frames)
    else:
        there = views.cameras
    if options.frame is not None:
        there = there[options.frame[0] : options.frame[1] + 1]
    if not there:
        raise RenderError(
            "holds nothing to look at", where=str(stage), expected="a stage with meshes"
        )
    _check_names(stage, "camera", options.cameras, [camera.name for camera in there])
    _check_names(stage, "room", options.rooms, views.rooms)
    chosen = [
        camera.framed(options.resolution_px)
        for camera in there
        if (not options.cameras or camera.name in options.cameras)
        and (not options.rooms or camera.room in options.rooms)
    ]
    if options.engine == WEB:
        chosen = _inside(chosen, options.cameras)
    if not chosen:
        raise RenderError(
            "no such camera in these rooms" if options.cameras else "no camera there",
            where=f"{stage}, {', '.join(options.rooms)}",
            expected=f"one of {', '.join(camera.name for camera in there)}",
        )
    return chosen


def _inside(cameras: list[StageCamera], named: Sequence[str]) -> list[StageCamera]:
    """Cameras whose house is whole: a browser cuts no walls. Raises RenderError for a named camera
    that sees it cut open."""
    cut = [camera for camera in cameras if camera.from_above or camera.cut_m or camera.is_alone]
    for camera in cut:
        if camera.name in named:
            raise RenderError(
                f"camera '{camera.name}' sees the house cut open",
                where="<engine=web>",
                expected="cameras in rooms",
                try_=f"<engine=cycles> <camera={camera.name}>",
            )
    return [camera for camera in cameras if camera not in cut and not camera.orthographic]


def _check_names(stage: Path, what: str, wanted: Sequence[str], there: Sequence[str]) -> None:
    for name in wanted:
        if name not in there:
            near = get_close_matches(name, there, n=1)
            raise RenderError(
                f"has no {what} named '{name}'",
                where=str(stage),
                expected=f"one of {', '.join(there)}" if there else "a stage with one",
                try_=f"<{what}={near[0]}>" if near else "",
            )
