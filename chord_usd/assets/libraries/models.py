"""What a library says about a model, before its mesh is read."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

SizeM = tuple[float, float, float]

Axis = str
"""One of +x, -x, +y, -y, +z, -z."""
AXES = ("+x", "-x", "+y", "-y", "+z", "-z")


@dataclass(frozen=True)
class Model:
    """One entry of a library."""

    id: str
    """As the library writes it."""
    category: str
    """A category of the palette, or any words that say what it is."""
    file: str
    """The mesh, relative to the library."""
    size_m: SizeM | None = None
    """Length, width and height in the catalogue; None takes the mesh's own."""
    unit_m: float | None = None
    """Metres per unit of the mesh; None is what its format says, or what fits its category."""
    up: Axis | None = None
    """The mesh's axis that points up; None is what its format says."""
    front: Axis | None = None
    """The axis that the front faces."""
    rotation: tuple[float, ...] = ()
    """Nine numbers, row by row, that the catalogue turns the mesh with, in its own axes."""
    label: str = ""
    licence: str = ""
    author: str = ""


class Library(Protocol):
    """A folder or archive with models."""

    name: str

    def models(self) -> list[Model]:
        """All entries, in the order of the catalogue. Raises AssetError for a damaged one."""

    def opened(self, model: Model) -> AbstractContextManager[Path]:
        """The mesh as a file with its textures beside it, for as long as the context lasts.

        Raises AssetError when it is missing.
        """


@dataclass(frozen=True)
class Refused:
    """A model that cannot be used, and why."""

    id: str
    why: str


def numbered(wanted: str, taken: set[str]) -> Iterator[str]:
    """wanted, then wanted_2, wanted_3 …, those that are not taken."""
    number = 1
    while True:
        name = wanted if number == 1 else f"{wanted}_{number}"
        if name not in taken:
            yield name
        number += 1
