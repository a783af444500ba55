"""Outputs that appear whole or not at all.

Everything is written beside its target and renamed into place, so that an interrupt, a crash or a
full disk leaves what was there before. Raises errors.OutputError.
"""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import shutil
import tempfile
from collections.abc import Iterator
from itertools import takewhile
from pathlib import Path

from chord_usd.errors import ChordError, DiskFullError, OutputError, reason_of

_FULL_DISK = (errno.ENOSPC, errno.EDQUOT)
_NEARLY_FULL_BYTES = 16 * 2**20
"""Less than this free: a writer that failed without words of its own failed for want of space.
Libraries seldom tell, and what they had half written may be gone before anyone can look."""


HIDDEN_PREFIX = ".chord-usd-"
"""Of the folders that outputs are written in, beside their targets."""


def destination(folder: Path) -> Path:
    """Where what is written in this folder will appear: itself, unless a Delivery hides it."""
    folder = _absolute(folder)
    while folder.name.startswith(HIDDEN_PREFIX):
        folder = folder.parent
    return folder


def write_atomic(path: Path, data: bytes | str) -> None:
    """Write a file whole or not at all; text is UTF-8. Missing parent folders are made.

    Raises OutputError when the folder is not writable, the target is a folder or the disk is full.
    """
    content = data.encode() if isinstance(data, str) else data
    with deliver() as delivery:
        delivery.place(path).write_bytes(content)


@contextlib.contextmanager
def output_folder(path: Path) -> Iterator[Path]:
    """Yield an empty folder to fill; it becomes path when the block ends without an error.

    An older folder at path is replaced as a whole. Raises OutputError.
    """
    path = _absolute(path)
    if path.exists() and not path.is_dir():
        raise OutputError("is a file", where=str(path), expected="a folder, or nothing yet")
    with deliver() as delivery:
        folder = delivery.place(path, folder=True)
        folder.mkdir()
        yield folder


@contextlib.contextmanager
def deliver() -> Iterator[Delivery]:
    """Yield a Delivery; its files move to their targets, all of them, when the block ends well.

    Raises OutputError when a target cannot be written; other errors of the block pass through,
    after its files are removed.
    """
    delivery = Delivery()
    try:
        yield delivery
        delivery._commit()
    except OSError as error:
        delivery._withdraw()
        if not delivery._concerns(error):
            raise
        raise _output_error(error, delivery._first_target()) from error
    except Exception as error:
        full = delivery._disk_is_full()
        delivery._withdraw()
        if not full or isinstance(error, ChordError):
            raise
        raise DiskFullError(
            "the disk is full", where=str(delivery._first_target()), try_=_FREE_SPACE
        ) from error
    except BaseException:
        delivery._withdraw()
        raise
    delivery._clean()


class Delivery:
    """Files on their way: each is written in a hidden folder beside its target."""

    def __init__(self) -> None:
        self._parcels: list[_Parcel] = []
        self._made_folders: list[Path] = []
        self._undo: list[tuple[Path, Path | None]] = []

    def place(self, target: Path, *, folder: bool = False) -> Path:
        """Where to write what shall appear at target.

        The path returned has the target's name; whatever else is written beside it (the folders
        of a stage) appears beside the target. Raises OutputError.
        """
        target = _absolute(target)
        if target.is_dir() and not folder:
            raise OutputError("is a folder", where=str(target), expected="a file name to write")
        try:
            self._make_parents(target.parent)
            hidden = Path(tempfile.mkdtemp(prefix=HIDDEN_PREFIX, dir=target.parent))
        except OSError as error:
            raise _output_error(error, target) from error
        self._parcels.append(_Parcel(hidden, target, folder))
        return hidden / target.name

    def _make_parents(self, folder: Path) -> None:
        missing = takewhile(lambda one: not one.exists(), (folder, *folder.parents))
        for parent in reversed(list(missing)):
            parent.mkdir(exist_ok=True)
            self._made_folders.append(parent)

    def _commit(self) -> None:
        for parcel in self._parcels:
            written = parcel.hidden / parcel.target.name
            # Only the target: a stage has hundreds of files beside it, and syncing each of them
            # takes seconds on a busy disk.
            if written.is_file():
                _sync(written)
        for parcel in self._parcels:
            for source, target in parcel.moves():
                self._move(source, target, parcel.hidden)

    def _move(self, source: Path, target: Path, hidden: Path) -> None:
        self._make_parents(target.parent)
        kept: Path | None = None
        if target.exists() and (target.is_dir() or not _same_bytes(source, target)):
            kept = hidden / f".kept-{len(self._undo)}"
            # A hard link leaves the old file in its place until the new one takes it.
            if target.is_dir():
                target.rename(kept)
            else:
                _link_or_copy(target, kept)
        elif target.exists():
            return
        self._undo.append((target, kept))
        source.replace(target)

    def _withdraw(self) -> None:
        """Put everything back as it was."""
        for target, kept in reversed(self._undo):
            with contextlib.suppress(OSError):
                if target.is_dir():
                    shutil.rmtree(target)
                elif kept is None:
                    target.unlink(missing_ok=True)
                if kept is not None:
                    kept.replace(target)
        self._clean()
        for folder in reversed(self._made_folders):
            with contextlib.suppress(OSError):
                folder.rmdir()

    def _clean(self) -> None:
        for parcel in self._parcels:
            shutil.rmtree(parcel.hidden, ignore_errors=True)

    def _first_target(self) -> Path:
        return self._parcels[0].target if self._parcels else Path()

    def _concerns(self, error: OSError) -> bool:
        """Whether the error is about writing the outputs, not about reading some input."""
        if error.errno in (*_FULL_DISK, errno.EROFS):
            return bool(self._parcels)
        named = str(error.filename)
        return any(
            named.startswith((str(p.hidden), str(p.target))) or named == str(p.target.parent)
            for p in self._parcels
        )

    def _disk_is_full(self) -> bool:
        with contextlib.suppress(OSError):
            return any(
                shutil.disk_usage(p.target.parent).free < _NEARLY_FULL_BYTES for p in self._parcels
            )
        return False


class _Parcel:
    """One hidden folder and the target it stands for."""

    def __init__(self, hidden: Path, target: Path, whole_folder: bool) -> None:
        self.hidden, self.target, self._whole_folder = hidden, target, whole_folder

    def files(self) -> list[Path]:
        return sorted(p for p in self.hidden.rglob("*") if p.is_file())

    def moves(self) -> list[tuple[Path, Path]]:
        """(from, to) pairs, the target itself last: it must not point to files still missing."""
        parent = self.target.parent
        if self._whole_folder:
            return [(self.hidden / self.target.name, self.target)]
        pairs = [(f, parent / f.relative_to(self.hidden)) for f in self.files()]
        return sorted(pairs, key=lambda pair: (pair[1] == self.target, pair))


_FREE_SPACE = "free some space, or write to another disk"


def _output_error(error: OSError, target: Path) -> OutputError:
    if error.errno in _FULL_DISK:
        return DiskFullError("the disk is full", where=str(target), try_=_FREE_SPACE)
    return OutputError(
        f"cannot be written ({reason_of(error)})",
        where=str(target),
        expected="a path in a writable folder",
        try_="another -o path",
    )


def _absolute(path: Path) -> Path:
    return Path(os.path.abspath(path))  # noqa: PTH100 (resolve would follow a link at the target)


def _sync(path: Path) -> None:
    with path.open("rb") as file:
        os.fsync(file.fileno())


def _link_or_copy(source: Path, target: Path) -> None:
    try:
        os.link(source, target)
    except OSError:
        shutil.copy2(source, target)


def _same_bytes(first: Path, second: Path) -> bool:
    if first.stat().st_size != second.stat().st_size:
        return False
    return hash_file(first) == hash_file(second)


def hash_file(path: Path) -> str:
    """SHA-256 of a file's bytes, in hexadecimal."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
