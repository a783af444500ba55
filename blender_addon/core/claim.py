"""Who works on a house: one Blender at a time, by a lock that ends with its process."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path
from typing import IO

LOCK = ".chord-usd.lock"


class Claims:
    """The houses that this Blender works on."""

    def __init__(self) -> None:
        self._held: dict[Path, IO[str]] = {}
        self._made: dict[Path, list[Path]] = {}

    def take(self, folder: Path) -> bool:
        """Claim a house's folder, made where it is not there; False where another has it.

        A folder that cannot be written or locked is nobody's: True.
        """
        folder = folder.absolute()
        if folder in self._held:
            return True
        missing = [path for path in (folder, *folder.parents) if not path.exists()]
        try:
            folder.mkdir(parents=True, exist_ok=True)
            file = (folder / LOCK).open("a", encoding="utf-8")
        except OSError:
            return True
        if not _lock(file):
            file.close()
            return False
        self._held[folder] = file
        self._made[folder] = missing
        return True

    def take_new(self, wanted: Path) -> Path:
        """Claim this folder, or the first one of its name with a number that holds nothing yet.

        A house that is there already keeps its place, with all that was changed in it.
        """
        number = 1
        folder = wanted
        while not (_holds_nothing(folder) and self.take(folder)):
            number += 1
            folder = wanted.with_name(f"{wanted.name} {number}")
        return folder

    def drop_empty(self) -> None:
        """Let go of folders that nothing came into: of those that were claimed nothing is left.

        Takes away the lock, and folders that were made for it and are empty.
        """
        for folder in filter(_holds_nothing, list(self._held)):
            with suppress(OSError):
                (folder / LOCK).unlink()  # before it is free, so that nobody locks what is gone
            self._held.pop(folder).close()
            with suppress(OSError):
                for path in self._made.pop(folder):  # rmdir removes no folder that holds anything
                    path.rmdir()

    def release(self, *, but_empty: bool = False) -> None:
        """Let go of all of them. but_empty: not of those that a job may be writing yet."""
        if not but_empty:
            self.drop_empty()
        for folder in [held for held in self._held if not _holds_nothing(held)]:
            self._held.pop(folder).close()
            self._made.pop(folder)


def _holds_nothing(folder: Path) -> bool:
    """Whether a folder is not there, or is empty but for a lock.

    A folder that cannot be read counts as empty: the program says why it cannot write there.
    """
    try:
        return all(entry.name == LOCK for entry in folder.iterdir())
    except NotADirectoryError:
        return not folder.parent.is_dir()
    except OSError:
        return True


def _lock(file: IO[str]) -> bool:
    try:
        if sys.platform == "win32":
            import msvcrt

            msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
        else:
            import fcntl

            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except (BlockingIOError, PermissionError):
        return False
    except OSError:
        return True  # a file system without locks
    return True
