"""Copies of what a house points to, beside it, so that its folder can be moved and mailed.

A package is a folder: an asset's or a look's interface layer with everything it refers to. Houses
in one folder share their packages.
"""

from __future__ import annotations

import shutil
from pathlib import Path

from chord_usd.errors import AssetError
from chord_usd.runtime.files import hash_file


class Packages:
    """The packages of one kind that a house uses, such as its assets."""

    def __init__(self, staged: Path, final: Path, kind: str) -> None:
        """staged: folder being written; final: where it will appear; kind: name of the folder."""
        self._staged, self._final, self._kind = staged / kind, final / kind, kind
        self._names: dict[Path, str] = {}

    def add(self, interface: Path) -> str:
        """Take in the package of this interface layer; returns the path for a reference.

        Raises AssetError when the layer is not there.
        """
        source = interface.parent.absolute()
        if source not in self._names:
            if not interface.is_file():
                raise AssetError(
                    "the asset's layer is missing",
                    where=str(interface),
                    expected="a USD layer with a default prim",
                    try_="chord-usd assets build",
                )
            self._names[source] = self._free_name(source.name)
            self._copy(source, self._names[source])
        return f"./{self._kind}/{self._names[source]}/{interface.name}"

    def _free_name(self, name: str) -> str:
        """The package's own name, numbered where two packages of one house share it."""
        taken = set(self._names.values())
        candidates = (name, *(f"{name}_{number}" for number in range(2, len(taken) + 3)))
        return next(candidate for candidate in candidates if candidate not in taken)

    def _copy(self, source: Path, name: str) -> None:
        """Copy what another house of the folder has not brought already."""
        staged, final = self._staged / name, self._final / name
        if not final.exists():
            shutil.copytree(source, staged, copy_function=shutil.copyfile)
            return
        for file in sorted(path for path in source.rglob("*") if path.is_file()):
            relative = file.relative_to(source)
            if not _is_copy(file, final / relative):
                (staged / relative).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(file, staged / relative)


def _is_copy(file: Path, other: Path) -> bool:
    """Whether other is there and holds the same bytes."""
    if not other.is_file() or other.stat().st_size != file.stat().st_size:
        return False
    return hash_file(other) == hash_file(file)
