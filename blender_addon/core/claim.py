"""Who works on a house: one Blender at a time, by a lock that ends with its process."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import IO

LOCK = ".chord-usd.lock"


class Claims:
    """The houses that this Blender works on."""

    def __init__(self) -> None:
        self._held: dict[Path, IO[str]] = {}

    def take(self, folder: Path) -> bool:
        """Claim a house's folder, made where it is not there; False where another has it.

        A folder that cannot be written or locked is nobody's: True.
        """
        folder = folder.absolute()
        if folder in self._held:
            return True
        try:
            folder.mkdir(parents=True, exist_ok=True)
            file = (folder / LOCK).open("a", encoding="utf-8")
        except OSError:
            return True
        if not _lock(file):
            file.close()
            return False
        self._held[folder] = file
        return True

    def free_folder(self, wanted: Path) -> Path:
        """Claim this folder, or the first free one of its name with a number."""
        number = 1
        folder = wanted
        while not self.take(folder):
            number += 1
            folder = wanted.with_name(f"{wanted.name} {number}")
        return folder

    def release(self) -> None:
        """Let go of all of them."""
        for file in self._held.values():
            file.close()
        self._held.clear()


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
