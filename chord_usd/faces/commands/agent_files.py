"""What of the disk an agent sees: files below one folder."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from chord_usd.base.runtime.inputs import STAGE_SUFFIXES
from chord_usd.faces.commands.paths import UsageError, refuse_odd_name

MOST_LISTED = 500
"""Files in one answer; an agent reads all of it."""


class AgentFiles:
    """The folder that is open to an agent."""

    def __init__(self, root: Path) -> None:
        self.root = root.resolve()

    def there(self, text: str) -> Path:
        """A file or folder below the root that exists, absolute. Raises UsageError."""
        path = self._below(text)
        if not path.exists():
            raise UsageError(
                "there is no such file", where=text, try_="list_files, which says what there is"
            )
        return path

    def new(self, text: str) -> Path:
        """A path below the root where nothing is yet: tools replace no file. Raises UsageError."""
        path = self._below(text)
        if os.path.lexists(path):
            raise UsageError("is there already", where=text, expected="a new name")
        return path

    def place(self, text: str) -> Path:
        """A folder below the root, there or not. Raises UsageError."""
        path = self._below(text)
        if path.exists() and not path.is_dir():
            raise UsageError("is no folder", where=text, expected="a folder, or a new name")
        return path

    def name(self, path: Path) -> str:
        """A path as an agent has it: below the root."""
        return path.relative_to(self.root).as_posix()

    def _below(self, text: str) -> Path:
        given = Path(text)
        refuse_odd_name("the path", given)
        if not text or given.is_absolute():
            said = "is no path below the root"
        elif ".." in given.parts or not self._real(given).is_relative_to(self.root):
            said = "leads out of the root"
        elif any(part.startswith(".") for part in given.parts):
            said = "is hidden"
        else:
            return self._real(given)
        where = text or "path"
        raise UsageError(said, where=where, expected="a path below the root, as flat/house.usda")

    def _real(self, path: Path) -> Path:
        return Path(os.path.realpath(self.root / path))

    def listed(self, folder: str) -> dict[str, Any]:
        """Houses and other files in a folder and below, without what belongs to a house.

        Links that lead out of the root and hidden files are left out. Raises UsageError.
        """
        start = self.there(folder) if folder not in ("", ".") else self.root
        houses: list[str] = []
        files: list[str] = []
        for path in self._walked(start):
            if len(houses) + len(files) == MOST_LISTED:
                return {"houses": houses, "files": files, "more": True}
            (houses if path.suffix.lower() in STAGE_SUFFIXES else files).append(self.name(path))
        return {"houses": houses, "files": files, "more": False}

    def _walked(self, start: Path) -> Iterator[Path]:
        for folder, below, names in os.walk(start):
            # What a house is made of: hundreds of stages that are no houses.
            parts = {"assets", "materials"} if any(map(_is_house, names)) else set()
            parts |= {f"{Path(name).stem}_architecture" for name in filter(_is_house, names)}
            below[:] = sorted(n for n in below if n not in parts and not n.startswith("."))
            for name in sorted(names):
                path = Path(folder, name)
                inside = self._real(path).is_relative_to(self.root)
                if inside and path.is_file() and not name.startswith("."):
                    yield path


def _is_house(name: str) -> bool:
    return Path(name).suffix.lower() in STAGE_SUFFIXES
