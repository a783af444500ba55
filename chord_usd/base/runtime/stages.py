"""Stages and layers: opened here and nowhere else, and those from strangers looked at first.

A stage names other files, and USD opens whatever it names: a pipe that never ends, a file of
somebody else, a thousand layers that each refer to a thousand more. So a stage is tried in a
process of its own (base/runtime/confined.py) before it is opened in this one, and what is copied
somewhere comes from the list of files that the trial returns.
"""

from __future__ import annotations

import logging
import os
import stat
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.errors import ChordError, StageError, reason_of
from chord_usd.base.runtime.archives import Archive
from chord_usd.base.runtime.confined import decode
from chord_usd.base.runtime.inputs import STAGE_SUFFIXES
from chord_usd.base.runtime.locations import absolute, open_folders

if TYPE_CHECKING:
    from pxr import Sdf, Usd

EXPECTED = "a .usda, .usdc or .usdz stage"

MOST_LAYERS, MOST_PRIMS, DEEPEST = 10_000, 1_000_000, 256
"""A house has a hundred layers, 20,000 prims with those inside instances, ten above one another."""

_log = logging.getLogger(__name__)
_SPECIAL = (stat.S_ISFIFO, stat.S_ISCHR, stat.S_ISBLK, stat.S_ISSOCK)
_EXPRESSION = "`"
_UDIM = "<UDIM>"


@dataclass(frozen=True)
class StageFiles:
    """The files that a stage is made of, absolute; a package counts as one file."""

    layers: tuple[Path, ...]
    """The stage's own file first."""
    others: tuple[Path, ...]
    """Textures and what else it names."""
    missing: tuple[str, ...]
    """Asset paths that lead to no file, as they are written."""

    def outside(self, folders: Iterable[Path]) -> Path | None:
        """The first file, after the stage's own, that lies in none of the folders; links count
        as what they lead to. A folder can be a package."""
        roots = [Path(os.path.realpath(folder)) for folder in folders]
        for file in (*self.layers[1:], *self.others):
            real = Path(os.path.realpath(file))
            if not any(real.is_relative_to(root) for root in roots):
                return file
        return None


def open_stage(path: Path, *, load: bool = True) -> Usd.Stage:
    """The stage at path, which may be a stranger's; payloads loaded or not.

    Raises StageError when there is none, or one that cannot be opened safely.
    """
    look_through([path])
    return open_known(path, load=load)


def open_known(path: Path, *, load: bool = True) -> Usd.Stage:
    """A stage that was looked through already, or that this program made.

    Raises StageError when it cannot be opened.
    """
    from pxr import Usd

    _require_file(path)
    with _usd_errors(path):
        return Usd.Stage.Open(str(path), Usd.Stage.LoadAll if load else Usd.Stage.LoadNone)


def open_layer(path: Path) -> Sdf.Layer:
    """One layer, without what it refers to. Raises StageError when it cannot be opened."""
    from pxr import Sdf

    _require_file(path)
    with _usd_errors(path):
        layer = Sdf.Layer.FindOrOpen(str(path))
    if not layer:
        raise _not_a_stage(path)
    return layer


def layer_beside(identifier: str, *names: str) -> Sdf.Layer | None:
    """The first layer of these names in the folder or package of one that was opened before."""
    from pxr import Sdf

    layer = Sdf.Layer.FindOrOpen(identifier)
    for name in names if layer else ():
        candidate = Sdf.Layer.FindOrOpen(layer.ComputeAbsolutePath(f"./{name}"))
        if candidate:
            return candidate
    return None


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Turn whatever fails in the block into a StageError about the stage at path.

    For code that reads the values of a stranger's stage, which can be of any type and any length.
    """
    silence()
    try:
        yield
    except (ChordError, OSError, MemoryError):
        raise
    except Exception as error:
        cause = " ".join(str(error).split())[:200]
        raise StageError(
            f"holds what cannot be read ({type(error).__name__}: {cause})",
            where=str(path),
            expected="a stage as chord-usd writes it",
            try_=f"usdchecker {path.name}",
        ) from error


def files_of(path: Path) -> StageFiles:
    """The files of a stage from a stranger, found without any harm. Raises StageError."""
    (files,) = look_through([path])
    return files


def own_files(path: Path, where: Path | None = None) -> StageFiles:
    """The same for a stage that everything has to lie in the folder of, or in its package.

    where: what errors name, by default path. Raises StageError that names the first file outside.
    """
    files = files_of(path)
    home = path if path.suffix == ".usdz" else absolute(path).parent
    outside = files.outside([home])
    if outside is not None:
        raise StageError(
            f"points to {outside}",
            where=str(where or path),
            expected="a stage whose files lie in its own folder",
            try_="copy that file beside the stage, and refer to it there",
        )
    return files


def look_through(
    paths: Sequence[Path], meanwhile: Callable[[], object] | None = None
) -> tuple[StageFiles, ...]:
    """Try stages in a process of their own; returns their files.

    meanwhile: called while that process works, if it has to. Raises StageError for one that is
    missing, damaged, endless, or far too large, and for one that refers to files outside the
    folders that are open (locations.open_folders).
    """
    for path in paths:
        _require_file(path)
    unknown = [path for path in paths if not _is_remembered(path)]
    if unknown:
        others = f" and {len(unknown) - 1} others" if len(unknown) > 1 else ""
        where = f"{unknown[0]}{others}"
        names = tuple(str(absolute(path)) for path in unknown)
        results = decode("stages", names, where=where, error=StageError, meanwhile=meanwhile)
        for path, files in zip(unknown, results, strict=True):
            _remembered[absolute(path)] = files, _states(files)
    silence()
    looked = tuple(_remembered[absolute(path)][0] for path in paths)
    if folders := open_folders():
        for path, files in zip(paths, looked, strict=True):
            if files.outside(folders) is not None:
                raise StageError(
                    "refers to files outside the folder that is open",
                    where=str(path),
                    expected="a house with all its files below that folder",
                )
    return looked


_State = tuple[int, int] | None
_remembered: dict[Path, tuple[StageFiles, tuple[_State, ...]]] = {}


def _is_remembered(path: Path) -> bool:
    """Whether the stage was looked through, and none of its files has changed since; where some
    are missing, they may have come."""
    known = _remembered.get(absolute(path))
    return known is not None and not known[0].missing and known[1] == _states(known[0])


def _states(files: StageFiles) -> tuple[_State, ...]:
    return tuple(_state(file) for file in (*files.layers, *files.others))


def _state(path: Path) -> _State:
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size


def _require_file(path: Path) -> None:
    """Raises StageError for a path that is none of a regular file."""
    try:
        if path.is_dir():
            what = "is a folder"
        elif path.is_file():
            return
        else:
            what = "is no regular file" if path.exists() else "there is no such file"
    except (OSError, ValueError) as error:
        what = reason_of(error) if isinstance(error, OSError) else str(error)
    try_ = f"<generate=-o {path.name}>"
    raise StageError(what, where=str(path), expected=EXPECTED, try_=try_)


def _not_a_stage(path: Path) -> StageError:
    return StageError(
        "cannot be opened as a stage",
        where=str(path),
        expected=EXPECTED,
        try_=f"<generate=-o {path.name}>",
    )


@contextmanager
def _usd_errors(path: Path) -> Iterator[None]:
    from pxr import Tf

    silence()
    try:
        yield
    except (Tf.ErrorException, RuntimeError) as error:
        raise _not_a_stage(path) from error


_delegates: list[Any] = []


def silence() -> None:
    """Keep USD's own diagnostics off standard error from now on.

    They name our temporary files and come by the dozen. What matters of them is in our errors and
    in what `check` reports. With the log at DEBUG, as --debug sets it, USD says them itself, at
    once.
    """
    from pxr import UsdUtils

    if _log.isEnabledFor(logging.DEBUG):
        return
    if _delegates:
        _delegates[0].TakeUncoalescedDiagnostics()  # else they would pile up
    else:
        _delegates.append(UsdUtils.CoalescingDiagnosticDelegate())


# --- the trial, in a process of its own ---------------------------------------------------------


def _try_all(paths: tuple[str, ...]) -> list[StageFiles]:
    # Threads count as memory. Read by USD when it is imported.
    os.environ["PXR_WORK_THREAD_LIMIT"] = "1"
    # Else every layer in a package maps all of the package: 7 GB for a dressed house of 27 MB.
    os.environ["USDC_USE_ASSET"] = "1"
    from pxr import Ar

    with Ar.ResolverScopedCache():
        return [_try(Path(path)) for path in paths]


def _try(path: Path) -> StageFiles:
    """Open a stage with everything in it, once its files are known to be files."""
    silence()
    tree = _Walk(path)  # while it is here, its layers need not be read again
    tree.follow()
    files = tree.files
    stage = open_known(path)
    count_prims(stage, path)
    for prim in _prims_once(stage):
        for attribute in prim.GetAuthoredAttributes():
            value = attribute.Get()
            if attribute.SplitName()[0] == "xformOp" or attribute.GetName() in _EXTENTS:
                _require_place(value, attribute, path)
    used = {_file_of(layer.realPath) for layer in stage.GetUsedLayers() if layer.realPath}
    more = sorted(used.difference(files.layers))  # asset paths that are expressions
    return StageFiles((*files.layers, *more), files.others, files.missing)


_EXTENTS = ("points", "extent", "extentsHint")


def _require_place(value: object, attribute: Usd.Attribute, path: Path) -> None:
    """Raises StageError for a placement or a size that is no number, or that leaves no size."""
    import numpy as np

    numbers = np.asarray(value if value is not None else ())
    if numbers.dtype.kind != "f":
        return
    factors = np.linalg.det(numbers) if numbers.shape[-2:] == (4, 4) else numbers
    scales = attribute.GetTypeName() == "matrix4d" or "scale" in attribute.SplitName()
    if np.isfinite(numbers).all() and not (scales and np.any(factors == 0.0)):
        return
    raise StageError(
        f"{attribute.GetPath()} is {'zero' if np.isfinite(numbers).all() else 'not finite'}",
        where=str(path),
        expected="numbers that leave a piece its size" if scales else "numbers",
        try_="set it again, or take the piece out",
    )


ELEVATION = "chord:elevation_m"
"""Attribute of the groups that hold the rooms of a storey."""


def storey_prims(stage: Usd.Stage) -> list[Usd.Prim]:
    """The groups of a house's storeys, the lowest first; none in a house of one."""
    house = stage.GetDefaultPrim()
    rooms = house.GetChild("Rooms") if house else None
    return [prim for prim in (rooms.GetChildren() if rooms else ()) if prim.HasAttribute(ELEVATION)]


def room_prims(stage: Usd.Stage) -> list[Usd.Prim]:
    """The rooms of a house, of all its storeys; none on a stage that this program did not write."""
    house = stage.GetDefaultPrim()
    rooms = house.GetChild("Rooms") if house else None
    groups = storey_prims(stage) or ([rooms] if rooms else [])
    return [room for group in groups for room in group.GetChildren()]


def count_prims(stage: Usd.Stage, path: Path) -> None:
    """Raises StageError for more prims, or more of them in one another, than any house has."""
    from pxr import Usd

    for number, prim in enumerate(stage.Traverse(Usd.TraverseInstanceProxies())):
        if number >= MOST_PRIMS:
            raise StageError(f"has more than {MOST_PRIMS:,} prims", where=str(path))
        if prim.GetPath().pathElementCount > DEEPEST:
            raise StageError(f"has more than {DEEPEST} prims in one another", where=str(path))


def _prims_once(stage: Usd.Stage) -> Iterator[Usd.Prim]:
    from pxr import Usd

    yield from stage.TraverseAll()
    for prototype in stage.GetPrototypes():
        yield from Usd.PrimRange(prototype)


def walk(path: Path) -> StageFiles:
    """The files of a stage, found layer by layer without composing it.

    No file is opened before it is known to be one. In this process: for stages that were looked
    through, or that this program made. Raises StageError.
    """
    silence()
    tree = _Walk(path)
    tree.follow()
    return tree.files


@dataclass
class _Walk:
    """Goes through the layers of a stage, the nearest first."""

    path: Path
    layers: dict[Path, None] = field(default_factory=dict)
    others: dict[Path, None] = field(default_factory=dict)
    missing: dict[str, None] = field(default_factory=dict)
    _due: list[str] = field(default_factory=list)
    _seen: set[str] = field(default_factory=set)
    _met: set[str] = field(default_factory=set)
    _below: dict[str, list[str]] = field(default_factory=dict)
    """Sublayers of each layer."""
    _held: list[Any] = field(default_factory=list)
    """Layers are closed, and would be read again, when nobody holds them."""

    @property
    def files(self) -> StageFiles:
        """What was found."""
        return StageFiles(tuple(self.layers), tuple(self.others), tuple(self.missing))

    def follow(self) -> None:
        _require_file(self.path)
        self._add(os.path.abspath(self.path))  # noqa: PTH100 (links stay: paths start from them)
        while self._due:
            if len(self._seen) > MOST_LAYERS:
                raise StageError(f"has more than {MOST_LAYERS:,} layers", where=str(self.path))
            self._open(self._due.pop(0))
        for name in self._below:
            self._count_sublayers(name)

    def _add(self, name: str) -> None:
        if name not in self._seen:
            self._seen.add(name)
            self._due.append(name)

    def _open(self, name: str) -> None:
        file = _file_of(name)
        if file.suffix == ".usdz" and file not in self.layers:
            with Archive(file, StageError, expected="a .usdz package") as archive:
                archive.require_package()
        try:
            layer = open_named(name)
        except StageError as error:
            if not self._held:
                raise
            # Here it may be memory that did not suffice; elsewhere there would be no limit.
            raise StageError(
                f"refers to {file}, which cannot be read",
                where=str(self.path),
                expected="a layer that is whole",
                try_="copy that file again",
            ) from error
        self._held.append(layer)
        self.layers[file] = None
        for asset_path in named_in(name):
            self._meet(asset_path, layer)
        below = (self._resolved(path, layer) for path in layer.subLayerPaths)
        self._below[name] = [sublayer for sublayer in below if sublayer]

    def _count_sublayers(self, root: str) -> None:
        """Raise StageError for a layer with too many below it, counted as often as they occur."""
        count, due = 0, [(root, frozenset([root]))]
        while due:
            name, above = due.pop()
            count += 1
            if count > MOST_LAYERS:
                raise StageError(f"has more than {MOST_LAYERS:,} sublayers", where=str(self.path))
            new = (sublayer for sublayer in self._below.get(name, ()) if sublayer not in above)
            due += [(sublayer, above | {sublayer}) for sublayer in new]

    @staticmethod
    def _resolved(asset_path: str, layer: Sdf.Layer) -> str:
        from pxr import Ar, Sdf

        anchored = Sdf.ComputeAssetPathRelativeToLayer(layer, asset_path)
        return str(Ar.GetResolver().Resolve(anchored).GetPathString())

    def _meet(self, asset_path: str, layer: Sdf.Layer) -> None:

        if asset_path.startswith(_EXPRESSION) or _UDIM in asset_path:
            return
        resolved = self._resolved(asset_path, layer)
        if not resolved:
            self.missing[asset_path] = None
            return
        if resolved in self._met:  # a picture of many materials
            return
        file = _file_of(resolved)
        mode = file.stat().st_mode
        if any(is_kind(mode) for is_kind in _SPECIAL):
            raise StageError(
                f"points to {asset_path}, which is a device or a pipe",
                where=str(self.path),
                expected="layers and pictures",
            )
        if stat.S_ISDIR(mode):
            self.missing[asset_path] = None
            return
        self._met.add(resolved)
        if resolved.rstrip("]").endswith(STAGE_SUFFIXES):
            self._add(resolved)
        else:
            self.others[file] = None


def open_named(name: str) -> Sdf.Layer:
    """A layer by its identifier, which may lead into a package. Raises StageError."""
    from pxr import Sdf

    with _usd_errors(Path(name)):
        layer = Sdf.Layer.FindOrOpen(name)
    if not layer:
        raise _not_a_stage(Path(name))
    return layer


def named_in(name: str) -> list[str]:
    """Every asset path in a layer: sublayers, references, payloads, values; UDIM tiles one by
    one."""
    from pxr import UsdUtils

    tiles = UsdUtils.ExtractExternalReferencesParams()
    tiles.SetResolveUdimPaths(True)
    with _usd_errors(Path(name)):
        lists = UsdUtils.ExtractExternalReferences(name, tiles)
    return [path for group in lists for path in group]


def _file_of(name: str) -> Path:
    """The file on disk that an identifier leads to; of package.usdz[a/b.usda], the package."""
    return Path(os.path.abspath(name.split("[", 1)[0]))  # noqa: PTH100 (not through links)
