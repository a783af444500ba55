"""Which files of a folder this program wrote, so that it replaces those and no others.

`.chord-usd.manifest` has a line per file, as sha256sum writes and checks them. A file that was
changed since is somebody's work: it counts as not ours. Lines are only ever added, with a lock, so
that several processes may write into one folder; the last line of a file holds.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import re
from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from pathlib import Path, PurePosixPath

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
        found = (_LINE.fullmatch(line) for line in self._lines)
        return {match[2]: match[1] for match in found if match and _stays_inside(match[2])}

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
    between = [file, *(one for one in file.parents if one.is_relative_to(folder) and one != folder)]
    return file.is_file() and not any(one.is_symlink() for one in between)


# SHA-256 of files --------------------------------------------------------------------------------


def hash_file(path: Path) -> str:
    """SHA-256 of a file's bytes, in hexadecimal. Raises OSError."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def same_bytes(first: Path, second: Path) -> bool:
    """Whether two files hold the same. Raises OSError."""
    if first.stat().st_size != second.stat().st_size:
        return False
    return hash_file(first) == hash_file(second)
