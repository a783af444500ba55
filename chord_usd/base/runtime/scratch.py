"""Folders for unfinished files. The next run clears away the folders of a run that was killed.

A folder in use holds a locked file; the kernel lets go of the lock when its holder dies, however
it dies. A folder without the file, or with another one of that name, is not ours to remove.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

from chord_usd.base.runtime import interrupts

try:
    import fcntl
except ImportError:  # pragma: no cover (not on Linux: leftovers stay, nothing else changes)
    fcntl = None  # type: ignore[assignment]

PREFIX = ".chord-usd-"
LOCK_FILE = ".lock"
_ATTEMPTS, _PAUSE_S = 5, 0.02
_MARK = b"chord-usd is at work here, or was killed here\n"


class Scratch:
    """A folder of our own and the lock on it."""

    def __init__(self, parent: Path) -> None:
        """Make a hidden folder in parent, after clearing away dead runs' folders. Raises OSError.

        To be called while interrupts are held, until somebody has it who will remove it.
        """
        sweep(parent)
        self.folder = Path(tempfile.mkdtemp(prefix=PREFIX, dir=parent))
        self._handle = -1
        try:
            self._claim()
        except OSError:
            self.remove()  # a full disk: without its mark nobody would clear it away
            raise

    def _claim(self) -> None:
        self._handle = os.open(self.folder / LOCK_FILE, os.O_RDWR | os.O_CREAT | os.O_EXCL, 0o600)
        _lock(self._handle)
        # Marked once it is locked: who finds a mark and no lock knows that its maker is dead.
        os.write(self._handle, _MARK)

    def remove(self) -> None:
        """Remove the folder with all that is left in it."""
        # A library that did not heed an interrupt may still be writing into it.
        for _ in range(_ATTEMPTS):
            shutil.rmtree(self.folder, ignore_errors=True)
            if not self.folder.exists():
                break
            time.sleep(_PAUSE_S)
        if self._handle >= 0:
            os.close(self._handle)
            self._handle = -1


@contextlib.contextmanager
def scratch_folder(parent: Path | None = None) -> Iterator[Path]:
    """A folder that is gone after the block; parent: by default that of temporary files."""
    with ExitStack() as stack:
        with interrupts.held():
            scratch = Scratch(parent or Path(tempfile.gettempdir()))
            stack.callback(scratch.remove)
        yield scratch.folder


def sweep(parent: Path) -> None:
    """Remove the folders in parent whose makers were killed."""
    with contextlib.suppress(OSError), os.scandir(parent) as entries:
        for entry in entries:
            if entry.name.startswith(PREFIX) and entry.is_dir(follow_symlinks=False):
                _remove_if_dead(Path(entry.path))


def _remove_if_dead(folder: Path) -> None:
    try:
        handle = os.open(folder / LOCK_FILE, os.O_RDWR | os.O_NOFOLLOW)
    except OSError:
        return
    try:
        if os.read(handle, len(_MARK) + 1) == _MARK and _lock(handle):
            shutil.rmtree(folder, ignore_errors=True)
    except OSError:
        pass
    finally:
        os.close(handle)


def _lock(handle: int) -> bool:
    """Whether the lock could be taken."""
    if fcntl is None:
        return False
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return False
    return True
