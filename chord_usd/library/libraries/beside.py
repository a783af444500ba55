"""The files that an OBJ or a glTF names: materials, textures, buffers."""

from __future__ import annotations

import os
from pathlib import Path

from trimesh.resolvers import Resolver

MOST_BYTES = 600 * 2**20


class Beside(Resolver):  # type: ignore[misc]
    """What trimesh asks for files by name; it gives none from outside a library."""

    def __init__(self, folder: Path, home: Path) -> None:
        """folder: where names start from; home: where files have to lie, links followed."""
        self._folder, self._home = folder, home
        self.refused = ""
        """The last name that led outside."""

    def get(self, name: str) -> bytes:
        """The bytes of a file. Raises FileNotFoundError."""
        name = name.strip()
        place = Path(os.path.realpath(self._folder / name.replace("\\", "/")))
        if not place.is_relative_to(self._home):
            self.refused = name
            raise FileNotFoundError(name)
        if not place.is_file() or place.stat().st_size > MOST_BYTES:
            raise FileNotFoundError(name)
        return place.read_bytes()

    def write(self, name: str, data: bytes) -> None:
        """Part of what trimesh calls a resolver; reading needs none of it."""
        raise NotImplementedError

    def namespaced(self, namespace: str) -> Beside:
        """The same, for names that start from a folder further down."""
        return Beside(self._folder / namespace, self._home)

    def keys(self) -> list[str]:
        """No names are offered, only given when asked for."""
        return []
