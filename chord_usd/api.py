"""The program from Python: a plan becomes a House, and a House can be looked at, changed, rendered.

    import chord_usd

    house = chord_usd.generate("plan.png")
    house.rooms
    house.render("living")

A thin face over what the commands call: the same plan, seed and settings give the same bytes.
Lengths are metres, angles degrees counter-clockwise from +x, z is up (CONVENTIONS.md). Whatever
cannot be used raises a ChordError, whose sentence says what, where, what was expected and what to
try. Heavy libraries are imported by the first call that needs them.
"""

from __future__ import annotations

import io
import shutil
import tempfile
import warnings
import weakref
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, Unpack

from chord_usd.base.errors import ChordError, RenderError
from chord_usd.base.runtime import house_history
from chord_usd.base.runtime.files import deliver
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.runtime.locations import absolute
from chord_usd.base.runtime.progress import PROGRESS_STYLES, ProgressStyle, Stopwatch, make_reporter
from chord_usd.base.scene.settings import HouseOptions, described, with_keywords

if TYPE_CHECKING:
    from PIL import Image

    from chord_usd.base.runtime.targets import FolderMode
    from chord_usd.base.scene.types import Item, RoomKind
    from chord_usd.line.stage.check.check_stage import Report
    from chord_usd.line.stage.export.exchange.built_house import House as BuiltHouse

FilePath = str | PathLike[str]
Quality = Literal["draft", "good", "final"]
Package = Literal[
    "web", "ar", "gltf", "ifc", "dxf", "ros", "robot", "mujoco", "urdf", "sdf", "habitat",
    "materialx",
]  # fmt: skip


@dataclass(frozen=True)
class Piece:
    """A piece of furniture, an object on one, or something that a room is dressed with."""

    id: str
    """Name of its prim, such as Desk_0; no other of the house has it."""
    category: str
    """Name in the category table, such as desk or double_sofa."""
    size_m: tuple[float, float, float]
    """Length (along its own x), width (depth) and height."""
    center_m: tuple[float, float, float]
    """x and y of the centre, z of the underside, in the world."""
    yaw_deg: float
    """How far it is turned, counter-clockwise; at 0 its front faces -y."""
    carries: tuple[Piece, ...] = ()
    """What stands on it, in the world, too."""


@dataclass(frozen=True)
class Room:
    """A room and what is in it."""

    id: str
    """Name of its prim, such as Bedroom_0."""
    kind: RoomKind
    name: str
    """What people call it: as printed on the plan, else its kind and number, such as Bedroom 1."""
    area_m2: float
    """Of the floor between the inner faces of its walls."""
    pieces: tuple[Piece, ...]
    dressing: tuple[Piece, ...]
    """What hangs, lies and stands in it besides."""
    storey: str = ""
    """Title of its storey, in a house of several."""


class House:
    """A furnished house: a USD stage, and what can be done with it. Made by generate and open.

    A house without a path of its own lies in a temporary folder, which goes when the last House in
    it does: save keeps it. In a notebook a House shows itself from above.
    """

    def __init__(self, path: FilePath, folder: _Folder | None = None) -> None:
        """The house at path, a stage that this program wrote; use open, which looks at it first."""
        self.path = absolute(Path(path))
        """Of the stage; what it points to lies beside it."""
        self._folder = folder
        self._written: tuple[int, int] | None = None
        self._read: tuple[tuple[int, int], list[BuiltHouse]] | None = None

    def __repr__(self) -> str:
        return f"House({str(self.path)!r})"

    def _repr_png_(self) -> bytes:
        """What a notebook shows: preview."""
        png = io.BytesIO()
        self.preview().save(png, format="PNG")
        return png.getvalue()

    @property
    def rooms(self) -> tuple[Room, ...]:
        """The rooms as they stand now, in the order of the plan, the lowest
        storey first. Raises StageError."""
        return tuple(room for storey in self._seen() for room in _rooms(storey))

    def preview(self) -> Image.Image:
        """The house from above, labelled, north (+y) up: RGB, the longer side 1200 pixels, drawn in
        a second without Blender; storeys side by side. Raises StageError."""
        from PIL import Image

        from chord_usd.line.image.preview import storeys_rgb

        return Image.fromarray(storeys_rgb([storey.drawn_graph for storey in self._seen()]))

    def check(self) -> Report:
        """What `chord-usd check` measures: `report.holds` is the certificate, `report.collisions`
        and others say what is wrong; paths are prim paths. Raises StageError."""
        from chord_usd.line.stage.check.check_stage import check_stage

        return check_stage(self.path, trusted=self._is_as_written())

    def render(
        self,
        view: str = "Isometric",
        *,
        size: tuple[int, int] | None = None,
        samples: int | None = None,
        quality: Quality = "draft",
        lighting: str = "",
        sky: str = "",
        roof: str = "",
        seed: int = 0,
        device: str = "auto",
        progress: ProgressStyle = "none",
    ) -> Image.Image:
        """A picture by Blender Cycles: RGB, 8 bits.

        view: a camera (Isometric, Top, or a room's) or a room as people call it ("living",
        "bedroom 2"). size: width and height in pixels, (640, 360) for drafts, else (1280, 720).
        samples: paths a pixel, at most, 1 to 65536; 8, 128 or 1024 by the quality. lighting: day,
        evening or night. sky: a name or an HDRI's file, in place of the stage's. roof:
        one that the house was generated with. device: auto, cpu,
        gpu or a backend such as cuda. Raises RenderError, StageError.
        """
        from PIL import Image

        from chord_usd.line.image.options import QUALITIES, RenderOptions, usual_px
        from chord_usd.line.image.render import render_stage

        if quality not in QUALITIES:
            raise RenderError(
                f"there is no quality {quality!r}", expected=f"one of {', '.join(QUALITIES)}"
            )
        options = RenderOptions(
            cameras=(self._camera(view),), resolution_px=size or usual_px(quality),
            quality=QUALITIES[quality], samples=samples, lighting=lighting, sky=sky, roof=roof,
            seed=seed, device=device,
        )  # fmt: skip
        with (
            tempfile.TemporaryDirectory(prefix="chord-usd-") as folder,
            _watch(progress).step("render") as report,
        ):
            rendered = render_stage(self.path, Path(folder), options, report)
            _warn(rendered.warnings)
            with Image.open(rendered.pictures[0]) as picture:
                return picture.convert("RGB")

    def regenerate(
        self,
        room: str,
        *,
        seed: int | None = None,
        wish: str = "",
        without: str = "",
        keep: Sequence[str] = (),
        style: str = "",
        dressing: bool = True,
        tabletop: bool = True,
        steps: int | None = None,
        asset_folders: Sequence[FilePath] = (),
        device: str = "auto",
        progress: ProgressStyle = "none",
    ) -> House:
        """Furnish one room again, in its place on the stage; nothing else changes. Returns itself.

        room: its id, or as people call it. seed: 0 to 2**31 - 1; None takes the one after the
        room's last. wish, without: pieces that the room must and must not hold, "desk, two
        chairs". keep: ids of pieces that stay. style: "" for that of the house. steps: of the
        sampler, 1 to 1000; None takes the checkpoint's own. asset_folders: of further meshes.
        device: auto, cpu or cuda. Raises ChordError, and the stage is as it was.
        """
        from chord_usd.base.runtime.alone import alone_with
        from chord_usd.line.lists.wishes import read_pieces
        from chord_usd.line.pipeline import Settings, one_room

        settings = Settings(
            steps=steps, device=device, asset_folders=_folders(asset_folders), style=style,
            dressing=dressing, tabletop=tabletop,
        )  # fmt: skip
        watch = _watch(progress)
        with alone_with(self.path):
            made = one_room.regenerate(
                self.path, room, settings, watch, seed, keep=keep,
                wishes=read_pieces(wish or None, without or None),
            )  # fmt: skip
            with watch.step("stage"):
                one_room.write_regenerated(made, self.path)
        self._written = _state(self.path)
        return self

    def edit(
        self,
        sentence: str,
        *,
        storey: str = "",
        dry_run: bool = False,
        force: bool = False,
        asset_folders: Sequence[FilePath] = (),
        progress: ProgressStyle = "none",
    ) -> tuple[str, ...]:
        """Do what a sentence says ("put a plant in bedroom 1, no rug in the hall"), in its place
        on the stage; returns what was understood, a line for each thing, or an answer.

        storey: name or number of the one that is meant, where a house has several and the sentence
        means something on more than one. dry_run: try it, and change nothing. force: do it also
        where it makes the house worse. asset_folders: of further meshes. All of it is done or,
        where a part has no meaning or no place, or makes the house worse, nothing: then it raises
        ChordError.
        """
        from chord_usd.line.pipeline import Settings
        from chord_usd.line.pipeline.edit_house import edit

        settings = Settings(asset_folders=_folders(asset_folders), style="")
        watch = _watch(progress)
        reading, *_ = edit(
            self.path, sentence, self.path, settings, watch, storey=storey, force=force,
            dry_run=dry_run,
        )  # fmt: skip
        self._written = self._written if dry_run or not reading.is_change else _state(self.path)
        return tuple(reading.understood.told)

    def set_state(self, states: str) -> tuple[str, ...]:
        """Open and close doors and switch lamps ("doors: closed; bedroom 1 lamp: off"), in place
        on the stage; returns the paths of the prims that have a state now. Raises ChordError for
        what is not there, and then changes nothing."""
        from chord_usd.line.pipeline.house_states import set_states

        stated = set_states(self.path, self.path, states)
        self._written = _state(self.path)
        return tuple(dict.fromkeys(path for state in stated for path in state.paths))

    @property
    def history(self) -> tuple[house_history.Change, ...]:
        """What was done to the house, the earliest first, as far as it is kept. Raises
        StageError for a history of another version."""
        return house_history.read_history(self.path).changes

    def undo(self) -> house_history.Change:
        """Give the house the state before its latest change; returns that change. Raises
        StageError where no earlier state is kept whole, OutputError while it is being changed."""
        return self._put_back(house_history.undo(self.path))

    def redo(self) -> house_history.Change:
        """Do again what was undone last; returns that change. Raises as undo does."""
        return self._put_back(house_history.redo(self.path))

    def go_to(self, number: int) -> house_history.Change:
        """Give the house the state of any change of its history. Raises as undo does."""
        return self._put_back(house_history.go_to(self.path, number))

    def _put_back(self, change: house_history.Change) -> house_history.Change:
        self._written = _state(self.path)
        return change

    def export(self, target: Package, path: FilePath, *, overwrite: bool = False) -> Path:
        """Write the house as a package for other programs; returns its path.

        target: web or ar (.usdz), gltf (.glb), ifc, dxf, ros or mujoco (folders, new or empty).
        overwrite: replace what this program wrote into the folder before. Raises OutputError for a
        path of another suffix or one that cannot be written, StageError, MissingExtraError.
        """
        from chord_usd.faces.commands.paths import output_package
        from chord_usd.line.stage.export.export_stage import export_stage

        self._refuse_clash(path, output_package)
        export_stage(self.path, Path(path), target, _mode(overwrite))
        return Path(path)

    def save(self, folder: FilePath, *, overwrite: bool = False) -> House:
        """Copy the stage and all it points to into a folder, new or empty; returns that house.

        overwrite: replace what this program wrote into the folder before. Raises OutputError,
        StageError for a stage with files elsewhere.
        """
        from chord_usd.faces.commands.paths import output_folder
        from chord_usd.line.stage.export.export_stage import copy_stage

        self._refuse_clash(folder, output_folder)
        saved = House(copy_stage(self.path, Path(folder), _mode(overwrite)))
        saved._written = _state(saved.path) if self._is_as_written() else None
        return saved

    def _seen(self) -> list[BuiltHouse]:
        """The storeys as the stage has them, the lowest first; read again once it has changed."""
        from chord_usd.base.runtime.stages import open_known, open_stage, reading
        from chord_usd.line.stage.export.exchange.built_house import houses_of

        state = _state(self.path)
        if self._read is None or state is None or self._read[0] != state:
            with reading(self.path):
                opened = open_known if self._is_as_written() else open_stage
                house = houses_of(opened(self.path))
            if state is None:
                return house
            self._read = state, house
        return self._read[1]

    def _is_as_written(self) -> bool:
        """Whether this process wrote the stage, so that it need not be looked through first."""
        return self._written is not None and self._written == _state(self.path)

    def _camera(self, view: str) -> str:
        """The camera that is meant. Raises RenderError."""
        from chord_usd.line.image.options import RenderOptions
        from chord_usd.line.image.render import camera_names
        from chord_usd.line.pipeline.named_room import named_room

        names = camera_names(self.path, RenderOptions())
        if view in names:
            return view
        try:
            room = named_room(self.path, view)
        except ChordError as error:
            raise RenderError(
                f"has no camera or room {view!r}", where=str(self.path),
                expected=f"one of {', '.join(names)}",
            ) from error  # fmt: skip
        return camera_names(self.path, RenderOptions(rooms=(room,)))[0]

    def _refuse_clash(self, path: FilePath, role: Any) -> None:
        from chord_usd.faces.commands.paths import Named, check_named

        check_named([Named("house", self.path, Path), Named("output", Path(path), role)])


def generate(
    plan: FilePath | Sequence[FilePath],
    output: FilePath | None = None,
    *,
    progress: ProgressStyle = "none",
    **options: Unpack[HouseOptions],
) -> House:
    """Furnish a floor plan: what `chord-usd generate` does. Takes about a minute on two cores.

    Args:
        plan: picture, PDF, SVG, DXF, IFC, Sweet Home 3D or CHOrD JSON; several are the storeys of
            a house, the lowest first.
        output: the stage, .usda, .usd, .usdc or .usdz; None for a temporary folder that lives as
            long as the House.
        progress: form of progress on stderr (none, bar, lines, json).

    Warnings of the plan are warnings of Python. Raises ChordError (PlanError for a file that is no
    plan, OutputError for a target that cannot be written), and nothing is written.
    """
    from chord_usd.base.scene.settings import Settings
    from chord_usd.faces.commands.paths import Named, check_named, output_file
    from chord_usd.line import pipeline

    given: dict[str, Any] = {**options}
    given["asset_folders"] = _folders(given.get("asset_folders", ()))
    settings = Settings(**given)
    pipeline.require(settings)
    plans = [Path(plan)] if isinstance(plan, str | PathLike) else [Path(file) for file in plan]
    if not plans:
        raise ChordError("no plan was given", where="plan", expected="a file, or several")
    for file in plans:
        refuse_odd_file(file)
    folder = _Folder() if output is None else None
    house = House(folder.path / "house.usda" if folder else output or "", folder)
    named = [Named("plan", file, Path) for file in plans]
    check_named([*named, Named("output", house.path, output_file)])
    deed = house_history.Deed("generate", ", ".join(file.name for file in plans))
    with house_history.recorded(house.path, deed), deliver() as delivery:
        target = delivery.place(house.path)
        _warn(pipeline.generate(plans, target, settings, _watch(progress)).warnings)
    house._written = _state(house.path)
    return house


generate.__signature__ = with_keywords(generate)  # type: ignore[attr-defined]
generate.__doc__ = f"{generate.__doc__}\n{described(HouseOptions.__annotations__)}"


def open(path: FilePath) -> House:
    """The house at path, a stage that this program wrote (.usda, .usd, .usdc, .usdz).

    Raises StageError for what is no stage, is not safe to open, or holds no rooms.
    """
    house = House(path)
    house._seen()
    return house


class _Folder:
    """A temporary folder that goes when nothing refers to it any more."""

    def __init__(self) -> None:
        self.path = Path(tempfile.mkdtemp(prefix="chord-usd-"))
        weakref.finalize(self, shutil.rmtree, self.path, ignore_errors=True)


def _rooms(house: BuiltHouse) -> Iterator[Room]:
    from chord_usd.base.scene.geometry import room_polygon

    for room in house.graph.rooms:
        yield Room(
            room.id, room.kind, house.titles[room.id], float(room_polygon(room).area),
            tuple(_piece(item, house) for item in house.graph.items_of(room.id)),
            tuple(_piece(item, house) for item in house.graph.dressing_of(room.id)),
            house.storey_title,
        )  # fmt: skip


def _piece(item: Item, house: BuiltHouse) -> Piece:
    # Of /House/Rooms/Bedroom_0/Furniture/Desk_0/Desk, where a desk carries things, Desk_0.
    at = 6 if house.storey else 5
    name = item.id.rsplit("/Items/", 1)[-1] if "/Items/" in item.id else item.id.split("/")[at]
    carries = tuple(_piece(child, house) for child in item.children)
    x, y, z = item.box.center_m
    middle = (x, y, z + house.elevation_m)
    return Piece(name, item.category, item.box.size_m, middle, item.box.yaw_deg, carries)


def _watch(progress: ProgressStyle) -> Stopwatch:
    if progress not in PROGRESS_STYLES:
        styles = ", ".join(PROGRESS_STYLES)
        raise ChordError(f"there is no progress {progress!r}", expected=f"one of {styles}")
    return Stopwatch(make_reporter(progress))


def _warn(lines: Iterable[str]) -> None:
    for warning in lines:
        warnings.warn(warning, stacklevel=3)


def _folders(paths: Sequence[FilePath]) -> tuple[Path, ...]:
    return tuple(Path(path) for path in paths)


def _mode(overwrite: bool) -> FolderMode:
    return "replace" if overwrite else "new"


def _state(path: Path) -> tuple[int, int] | None:
    """What differs once a file was written again; None where there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size
