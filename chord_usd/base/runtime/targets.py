"""Which targets may be written, and the errors for those that may not."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import os
import re
import shutil
import stat
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path, PurePosixPath
from typing import Literal

from chord_usd.base.errors import DiskFullError, OutputError, reason_of
from chord_usd.base.runtime import interrupts
from chord_usd.base.runtime.scratch import PREFIX as SCRATCH_PREFIX

FolderMode = Literal["new", "replace", "renew", "add"]
"""What becomes of a folder that holds something already. new: it is refused. replace: what this
program wrote there as one output is replaced. renew: as replace, and its files that were
damaged or changed are set aside, which replace refuses. add: new files join its files."""

_FULL_DISK = (errno.ENOSPC, errno.EDQUOT)
FREE_SPACE = "free some space, or write to another disk"

NEARLY_FULL_BYTES = 16 * 2**20
"""Less than this free: no house fits, and a writer that failed without words failed for it."""


def check_run_folder(folder: Path) -> None:
    """Raise OutputError for a folder that a training run may not write its files into."""
    if os.path.lexists(folder) and not folder.is_dir():
        raise OutputError("is no folder", where=str(folder), expected="a folder, or nothing")
    if folder.is_dir() and not Manifest(folder).is_of_a_run:
        refuse_folder(folder, "new")


def begin_run(folder: Path) -> None:
    """Take a folder for a training run, which rewrites its files again and again.

    Raises OutputError for a folder that holds anything but such a run, or cannot be written.
    """
    check_run_folder(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
        Manifest(folder).note_run()
        interrupts.delivered.append(folder)
    except OSError as error:
        raise output_error(error, folder) from error


def refuse_full_disk(folder: Path, target: Path) -> None:
    """Raise DiskFullError where a folder that is there has no space for a house."""
    with contextlib.suppress(OSError):
        if shutil.disk_usage(folder).free < NEARLY_FULL_BYTES:
            raise DiskFullError("the disk is full", where=str(target), try_=FREE_SPACE)


def check_file_target(target: Path) -> None:
    """Raise OutputError for a target that is there and no plain file."""
    try:
        mode = target.lstat().st_mode
    except OSError:
        return  # not there, or not to be seen: writing will show
    if stat.S_ISREG(mode):
        return
    if stat.S_ISLNK(mode):
        raise OutputError(
            "is a symbolic link", where=str(target), expected="a file", try_="the path it leads to"
        )
    what = "is a folder" if stat.S_ISDIR(mode) else "is no regular file"
    raise OutputError(what, where=str(target), expected="a file name to write")


def refuse_folder(folder: Path, mode: FolderMode) -> None:
    """Raise OutputError for a folder whose content may not be replaced or added to."""
    there = sorted(entry.name for entry in folder.iterdir() if entry.name != MANIFEST_FILE)
    there = [name for name in there if not name.startswith(SCRATCH_PREFIX)]
    manifest = Manifest(folder)
    if not there or (mode in ("replace", "renew") and manifest.is_of_a_whole_folder):
        return
    if mode == "add" and manifest.hashes:
        return
    ours = mode == "new" and manifest.is_of_a_whole_folder
    raise OutputError(
        f"holds {_listed(there)}"
        + ("" if ours else ", which this program did not write as one output"),
        where=str(folder),
        expected="an empty folder, or none yet",
        try_=("<overwrite>", "another <output>") if ours else "another <output>",
    )


def _listed(names: list[str]) -> str:
    first = ", ".join(names[:3])
    return first if len(names) <= 3 else f"{first} and {len(names) - 3} more"


def not_ours(target: Path) -> OutputError:
    """The error for a file that is not replaced."""
    return OutputError(
        "was not written by chord-usd, or was changed since",
        where=str(target),
        expected="a name that is free",
        try_="move it away, or another -o",
    )


def output_error(error: OSError, target: Path) -> OutputError:
    """The error for a target that cannot be written."""
    if is_full(error):
        return DiskFullError("the disk is full", where=str(target), try_=FREE_SPACE)
    return OutputError(
        f"cannot be written ({reason_of(error)})",
        where=str(target),
        expected="a path in a writable folder",
        try_="another <output> path",
    )


def is_full(error: OSError) -> bool:
    """Whether the disk is."""
    # Copies of whole folders gather what failed, as words.
    gathered = isinstance(error, shutil.Error) and os.strerror(errno.ENOSPC) in str(error)
    return gathered or error.errno in _FULL_DISK


# Which files of a folder this program wrote, so that it replaces those and no others -------------

# `.chord-usd.manifest` has a line per file, as sha256sum writes and checks them. A file that was
# changed since is somebody's work: it counts as not ours. Lines are only ever added, with a lock,
# so that several processes may write into one folder; the last line of a file holds.

try:
    import fcntl
except ImportError:  # pragma: no cover (not on Linux)
    fcntl = None  # type: ignore[assignment]

MANIFEST_FILE = ".chord-usd.manifest"

_WHOLE = "# all of this folder is one output"
_RUN = "# a training run goes on in this folder"
_LINE = re.compile(r"([0-9a-f]{64})  (.+)")


class Manifest:
    """What is noted in a folder; it may hold no manifest yet, or not exist."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    @property
    def path(self) -> Path:
        """Where it lies."""
        return self._folder / MANIFEST_FILE

    @cached_property
    def _lines(self) -> list[str]:
        try:
            if self.path.is_symlink():
                return []
            return self.path.read_text(encoding="utf-8", errors="replace").splitlines()
        except OSError:
            return []

    @property
    def is_of_a_whole_folder(self) -> bool:
        """Whether the folder was written as one output, and may be replaced as one."""
        return _WHOLE in self._lines

    @property
    def is_of_a_run(self) -> bool:
        """Whether a training run of this program has the folder to itself."""
        return _RUN in self._lines

    def note_run(self) -> None:
        """Take the folder for a training run. Raises OSError."""
        if not self.is_of_a_run:
            self._append(f"{_RUN}\n")

    @cached_property
    def hashes(self) -> Mapping[str, str]:
        """SHA-256 of each file when it was written, by its POSIX path in the folder."""
        matches = (_LINE.fullmatch(line) for line in self._lines)
        return {match[2]: match[1] for match in matches if match and _stays_inside(match[2])}

    def lists(self, file: Path) -> bool:
        """Whether this program wrote a file of this name into the folder."""
        return file.relative_to(self._folder).as_posix() in self.hashes

    def owns(self, file: Path) -> bool:
        """Whether this program wrote a file of the folder, and nobody has changed it since."""
        noted = self.hashes.get(file.relative_to(self._folder).as_posix())
        try:
            if noted is None or not _is_plain(file, self._folder):
                return False
            # A crash may leave an empty file, which is nobody's work.
            return file.stat().st_size == 0 or hash_file(file) == noted
        except OSError:
            return False

    def files(self) -> Iterator[Path]:
        """The files that it owns, its nested folders' manifests with theirs included."""
        for name in self.hashes:
            file = self._folder / name
            if self.owns(file):
                yield file
        for nested in self._folder.glob(f"*/**/{MANIFEST_FILE}"):
            if _is_plain(nested, self._folder):
                yield from Manifest(nested.parent).files()
                yield nested

    def note(self, files: Iterable[Path], *, whole: bool = False) -> None:
        """Add files of the folder, as they are now. Raises OSError."""
        lines = [_WHOLE] if whole and not self.is_of_a_whole_folder else []
        for file in sorted(files):
            name = file.relative_to(self._folder).as_posix()
            digest = hash_file(file)
            # A name with a line break is never ours again, which is safe.
            if self.hashes.get(name) != digest and "\n" not in name:
                lines.append(f"{digest}  {name}")
        if lines:
            self._append("\n".join([*lines, ""]))

    def _append(self, text: str) -> None:
        handle = os.open(self.path, os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW, 0o644)
        try:
            if fcntl is not None:
                # Some network file systems have no locks; a single write mostly holds together.
                with contextlib.suppress(OSError):
                    fcntl.flock(handle, fcntl.LOCK_EX)
            data = text.encode("utf-8", errors="surrogateescape")
            while data:
                data = data[os.write(handle, data) :]
        finally:
            os.close(handle)
        for cached in ("_lines", "hashes"):
            self.__dict__.pop(cached, None)


def _stays_inside(name: str) -> bool:
    path = PurePosixPath(name)
    return not path.is_absolute() and ".." not in path.parts


def _is_plain(file: Path, folder: Path) -> bool:
    """Whether it is a file of its own, reached through folders and not through links."""
    between = [
        file,
        *(parent for parent in file.parents if parent.is_relative_to(folder) and parent != folder),
    ]
    return file.is_file() and not any(path.is_symlink() for path in between)


# SHA-256 of files --------------------------------------------------------------------------------


def hash_file(path: Path) -> str:
    """SHA-256 of a file's bytes, in hexadecimal. Raises OSError."""
    state = path.stat()
    if state.st_nlink == 1:
        return _hash(path)
    # One of many names of a file: a house has the same picture in ten packages.
    file = (state.st_dev, state.st_ino, state.st_size, state.st_mtime_ns, state.st_ctime_ns)
    if file not in _hashes:
        _hashes[file] = _hash(path)
    return _hashes[file]


_hashes: dict[tuple[int, ...], str] = {}


def _hash(path: Path) -> str:
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def same_bytes(first: Path, second: Path) -> bool:
    """Whether two files hold the same. Raises OSError."""
    if first.stat().st_size != second.stat().st_size:
        return False
    return hash_file(first) == hash_file(second)
