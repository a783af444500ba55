"""Outputs that appear whole or not at all, and that take the place of nothing but their own kind.

Everything is written in a hidden folder beside its target and renamed into place, so that an
interrupt, a crash or a full disk leaves what was there before. What may be replaced: the file that
the user named, and files that this program wrote and nobody has changed since (manifest.py).
"""

from __future__ import annotations

import contextlib
import errno
import itertools
import os
import shutil
from collections.abc import Callable, Iterator
from itertools import takewhile
from pathlib import Path

from chord_usd.base.errors import ChordError, DiskFullError, OutputError
from chord_usd.base.runtime import interrupts
from chord_usd.base.runtime.locations import absolute, cache_folder
from chord_usd.base.runtime.scratch import PREFIX as SCRATCH_PREFIX
from chord_usd.base.runtime.scratch import Scratch
from chord_usd.base.runtime.targets import (
    FREE_SPACE,
    MANIFEST_FILE,
    NEARLY_FULL_BYTES,
    FolderMode,
    Manifest,
    check_file_target,
    hash_file,
    is_full,
    not_ours,
    output_error,
    refuse_folder,
    same_bytes,
)

__all__ = [
    "Copies",
    "Delivery",
    "deliver",
    "destination",
    "folder_for_many",
    "hash_file",
    "link_or_copy",
    "output_folder",
    "write_atomic",
]

CHANGED = ".changed"
"""Added to the name of a file that is set aside, since somebody may have worked on it."""


def destination(folder: Path) -> Path:
    """Where what is written in this folder will appear: itself, unless a Delivery hides it."""
    folder = absolute(folder)
    hidden = (i for i, part in enumerate(folder.parts) if part.startswith(SCRATCH_PREFIX))
    first = next(hidden, None)
    if first is None:
        return folder
    # A hidden folder has one for what is new in it.
    return destination(Path(*folder.parts[:first], *folder.parts[first + 2 :]))


def write_atomic(path: Path, data: bytes | str, *, asked: bool = True) -> None:
    """Write a file whole or not at all; text is UTF-8. Missing parent folders are made.

    asked: as Delivery.place has it. Raises OutputError when the folder is not writable, the target
    is no regular file or the disk is full.
    """
    content = data.encode() if isinstance(data, str) else data
    with deliver() as delivery:
        delivery.place(path, asked=asked).write_bytes(content)


@contextlib.contextmanager
def output_folder(path: Path, mode: FolderMode = "new") -> Iterator[Path]:
    """Yield an empty folder to fill; what it holds comes to path when the block ends well.

    Raises OutputError for a path that holds anything that may not be replaced (FolderMode).
    """
    with deliver() as delivery:
        yield delivery.place_folder(path, mode)


@contextlib.contextmanager
def folder_for_many(folder: Path) -> Iterator[None]:
    """See early that a folder can be written, for a job that takes long and writes file by file.

    It is made where it is not there; where nothing came into it, it is gone again after the block.
    Raises OutputError.
    """
    missing = [path for path in (absolute(folder), *absolute(folder).parents) if not path.exists()]

    def unmake() -> None:
        with contextlib.suppress(OSError):  # rmdir removes no folder that holds anything
            for path in missing:
                path.rmdir()

    interrupts.on_hard_end.append(unmake)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not os.access(folder, os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    except OSError as error:
        raise output_error(error, folder) from error
    try:
        yield
    finally:
        unmake()
        interrupts.on_hard_end.remove(unmake)


@contextlib.contextmanager
def deliver() -> Iterator[Delivery]:
    """Yield a Delivery; its files move to their targets, all of them, when the block ends well.

    Raises OutputError when a target cannot be written or may not be replaced; other errors of the
    block pass through, after its files are removed.
    """
    delivery = Delivery()
    interrupts.on_hard_end.append(delivery.withdraw)
    try:
        yield delivery
        delivery.commit()
    except OSError as error:
        delivery.withdraw()
        if not delivery.concerns(error):
            raise
        raise output_error(error, delivery.first_target) from error
    except Exception as error:
        full = delivery.disk_is_full()
        delivery.withdraw()
        if not full or isinstance(error, ChordError):
            raise
        raise DiskFullError(
            "the disk is full", where=str(delivery.first_target), try_=FREE_SPACE
        ) from error
    except BaseException:
        delivery.withdraw()
        raise
    finally:
        interrupts.on_hard_end.remove(delivery.withdraw)


class Delivery:
    """Files on their way: each is written in a hidden folder beside its target. Use deliver()."""

    def __init__(self) -> None:
        self._parcels: list[_Parcel] = []
        self._made_folders: list[Path] = []
        self._undo: list[tuple[Path, Path | None]] = []

    def place(
        self, target: Path, *, asked: bool = True, ours: Callable[[Path], bool] | None = None
    ) -> Path:
        """The path to write, for a file that is to appear at target.

        The path returned has the target's name; whatever else is written beside it (the folders
        of a stage) appears beside the target. asked: whether the user named this very file; it is
        replaced then, whoever wrote it. Otherwise it is one of many that a long job writes into a
        folder, again and again: files that were changed since are set aside. ours: whether a file
        that is in no manifest is such a file all the same, since it came from another machine.
        Raises OutputError.
        """
        target = absolute(target)
        check_file_target(target)
        parcel = self._parcel(target.parent, target, {target} if asked else set())
        parcel.sets_aside = not asked
        if ours and target.is_file() and ours(target):
            parcel.asked.add(target)
        return parcel.new / target.name

    def place_folder(self, target: Path, mode: FolderMode = "new") -> Path:
        """An empty folder to fill, whose content is to appear in the folder target.

        Raises OutputError for a target that is no folder, or holds what may not be replaced.
        """
        target = absolute(target)
        if target.is_dir():
            target = target.resolve()
            refuse_folder(target, mode)
            parcel = self._parcel(target, target, set())
            parcel.whole, parcel.replaces = mode != "add", mode in ("replace", "renew")
            parcel.sets_aside = mode == "renew"
            return parcel.new
        if os.path.lexists(target):
            raise OutputError("is no folder", where=str(target), expected="a folder, or nothing")
        parcel = self._parcel(target.parent, target, {target})
        parcel.whole, parcel.is_new_folder = mode != "add", True
        folder = parcel.new / target.name
        folder.mkdir()
        return folder

    def commit(self) -> None:
        """Move everything into place. Raises OSError, OutputError."""
        for parcel in self._parcels:
            parcel.prepare()
        with interrupts.held():
            moves = [move for parcel in self._parcels for move in parcel.moves()]
            for parcel, source, target in moves:
                self._move(parcel, source, target)
            for parcel in self._parcels:
                for stale in parcel.stale():
                    self._take_away(parcel, stale)
                parcel.note()
            interrupts.delivered += [p.target for p in self._parcels if not p.is_unseen]
        self._clean()

    def _parcel(self, home: Path, target: Path, asked: set[Path]) -> _Parcel:
        try:
            with interrupts.held():
                self._make_parents(home)
                self._parcels.append(_Parcel(Scratch(home), home, target, asked))
                self._parcels[-1].open()
        except OSError as error:
            raise output_error(error, target) from error
        return self._parcels[-1]

    def _make_parents(self, folder: Path) -> None:
        missing = takewhile(lambda parent: not parent.exists(), (folder, *folder.parents))
        for parent in reversed(list(missing)):
            parent.mkdir(exist_ok=True)
            self._made_folders.append(parent)

    def _move(self, parcel: _Parcel, source: Path, target: Path) -> None:
        self._make_parents(target.parent)
        if source.is_dir():
            self._move_folder(parcel, source, target)
            return
        kept: Path | None = None
        if os.path.lexists(target):
            if not parcel.may_take(source, target):
                return
            if parcel.is_to_be_set_aside(target):
                aside = _free_name(target)
                link_or_copy(target, aside)
                self._undo.append((aside, None))
            kept = parcel.keep()
            # A hard link leaves the old file in its place until the new one takes it.
            link_or_copy(target, kept)
        self._undo.append((target, kept))
        source.replace(target)
        parcel.written.append(target)

    def _move_folder(self, parcel: _Parcel, source: Path, target: Path) -> None:
        """Whole where nothing is there: a stage has hundreds of files beside it."""
        if os.path.lexists(target):
            if parcel.is_new_folder:
                check_file_target(target)
        elif self._renamed(parcel, source, target):
            return
        for inner in sorted(source.iterdir()):
            self._move(parcel, inner, target / inner.name)

    def _renamed(self, parcel: _Parcel, source: Path, target: Path) -> bool:
        """Whether a folder could be moved as one; not where another process has made it by now."""
        walked = list(os.walk(source))
        folders = [target / Path(at).relative_to(source) for at, _, _ in walked]
        files = [
            folder / name
            for folder, (_, _, names) in zip(folders, walked, strict=True)
            for name in names
        ]
        undone = len(self._undo)
        self._made_folders += folders
        self._undo += [(file, None) for file in files]
        try:
            source.rename(target)
        except OSError as error:
            del self._undo[undone:]
            if error.errno in (errno.ENOTEMPTY, errno.EEXIST):
                return False
            raise
        parcel.written += files
        return True

    def _take_away(self, parcel: _Parcel, stale: Path) -> None:
        kept = parcel.keep()
        self._undo.append((stale, kept))
        stale.rename(kept)
        with contextlib.suppress(OSError):
            for folder in takewhile(lambda parent: parent != parcel.home, stale.parents):
                folder.rmdir()

    def withdraw(self) -> None:
        """Put everything back as it was."""
        for target, kept in reversed(self._undo):
            with contextlib.suppress(OSError):
                if kept is not None:
                    target.parent.mkdir(parents=True, exist_ok=True)
                    kept.replace(target)
                else:
                    target.unlink(missing_ok=True)
        self._undo.clear()
        self._clean()
        for folder in reversed(self._made_folders):
            with contextlib.suppress(OSError):
                folder.rmdir()

    def _clean(self) -> None:
        for parcel in self._parcels:
            parcel.scratch.remove()

    @property
    def first_target(self) -> Path:
        """For words about what could not be written."""
        return self._parcels[0].target if self._parcels else Path()

    def concerns(self, error: OSError) -> bool:
        """Whether the error is about writing the outputs, not about reading some input."""
        if is_full(error) or error.errno == errno.EROFS:
            return bool(self._parcels)
        named = str(error.filename)
        return any(
            named.startswith((str(p.scratch.folder), str(p.target))) or named == str(p.home)
            for p in self._parcels
        )

    def disk_is_full(self) -> bool:
        """Whether so little is left that a failure without words is one of space."""
        with contextlib.suppress(OSError):
            return any(shutil.disk_usage(p.home).free < NEARLY_FULL_BYTES for p in self._parcels)
        return False


class _Parcel:
    """One hidden folder and the folder that its content goes to."""

    def __init__(self, scratch: Scratch, home: Path, target: Path, asked: set[Path]) -> None:
        self.scratch, self.home, self.target, self.asked = scratch, home, target, asked
        self.new, self._old = scratch.folder / "new", scratch.folder / "old"
        self.whole = self.replaces = self.sets_aside = self.is_new_folder = False
        self._manifest = Manifest(home)
        self._kept = 0
        self.written: list[Path] = []
        """What has taken its place."""
        self._delivered: set[Path] = set()

    def open(self) -> None:
        """Make room in the hidden folder. Raises OSError."""
        self.new.mkdir()
        self._old.mkdir()

    @property
    def is_unseen(self) -> bool:
        """Whether it lies in another delivery's hidden folder, or in the cache: nobody asked."""
        is_scratch = any(part.startswith(SCRATCH_PREFIX) for part in self.home.parts)
        return is_scratch or self.home.is_relative_to(absolute(cache_folder()))

    def prepare(self) -> None:
        """What takes time, before anything moves."""
        self._manifest = Manifest(self.home)  # others may have written here meanwhile
        if self.is_new_folder:
            folder = self.new / self.target.name
            Manifest(folder).note(_files_in(folder), whole=self.whole)
        # Only the target: a stage has hundreds of files beside it, and syncing each of them
        # takes seconds on a busy disk.
        elif (self.new / self.target.name).is_file():
            _sync(self.new / self.target.name)

    def moves(self) -> list[tuple[_Parcel, Path, Path]]:
        """(self, from, to), the target itself last: it must not point to files still missing."""
        if self.is_new_folder:
            return [(self, self.new / self.target.name, self.target)]
        if self.replaces:
            self._delivered = {self.home / f.relative_to(self.new) for f in _files_in(self.new)}
        pairs = [(self, path, self.home / path.name) for path in self.new.iterdir()]
        return sorted(
            (move for move in pairs if move[2] != self._manifest.path),
            key=lambda move: (move[2] == self.target, move[2]),
        )

    def may_take(self, source: Path, target: Path) -> bool:
        """Whether a file takes the place of target, which is there; not where it is the same.

        Raises OutputError where target is not ours to replace.
        """
        check_file_target(target)
        if same_bytes(source, target):
            return False
        is_ours = target in self.asked or self._manifest.owns(target)
        if not is_ours and not self.is_to_be_set_aside(target):
            raise not_ours(target)
        return True

    def is_to_be_set_aside(self, target: Path) -> bool:
        """Whether target was ours and was changed, and a copy of it is to stay."""
        return self.sets_aside and self._manifest.lists(target) and not self._manifest.owns(target)

    def keep(self) -> Path:
        """A place for what is replaced, until all is well."""
        self._kept += 1
        return self._old / str(self._kept)

    def stale(self) -> list[Path]:
        """Of a folder that is replaced: what is ours and has no successor."""
        if not self.replaces:
            return []
        return sorted(set(self._manifest.files()) - self._delivered)

    def note(self) -> None:
        """List what was written, but for what the user named, which is theirs to name again."""
        if not self.is_new_folder:
            ours = [file for file in self.written if file not in self.asked]
            self._manifest.note(ours, whole=self.whole)


def _files_in(folder: Path) -> list[Path]:
    """All files, but for the folder's own manifest: the mover of the files lists them again."""
    manifest = folder / MANIFEST_FILE
    there = (Path(at, name) for at, _, names in os.walk(folder) for name in names)
    return sorted(path for path in there if path.is_file() and path != manifest)


def _sync(path: Path) -> None:
    with path.open("rb") as file:
        os.fsync(file.fileno())


def _free_name(file: Path) -> Path:
    """Where a file that was changed is kept: beside it, under a name that nothing has."""
    names = (f"{file.name}{CHANGED}{number or ''}" for number in itertools.count())
    return next(file.with_name(name) for name in names if not file.with_name(name).exists())


class Copies:
    """Copies of files that are one file where their sources are: pictures of a house are links."""

    def __init__(self) -> None:
        self._made: dict[tuple[int, int], Path] = {}

    def add(self, source: Path, target: Path) -> None:
        """Copy source to target, whose folder is made. Raises OSError."""
        target.parent.mkdir(parents=True, exist_ok=True)
        state = source.stat()
        made = self._made.setdefault((state.st_dev, state.st_ino), target)
        if made == target:
            shutil.copyfile(source, target)
        else:
            link_or_copy(made, target)


def link_or_copy(source: Path, target: Path) -> None:
    """Let target be the same file as source, or a copy where a file system has no links."""
    try:
        os.link(source, target)
    except OSError:
        if not (target.exists() and source.samefile(target)):
            shutil.copy2(source, target)
