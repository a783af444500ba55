"""What a library says about a model, before its mesh is read."""

from __future__ import annotations

from collections.abc import Collection
from contextlib import AbstractContextManager
from dataclasses import dataclass
from itertools import chain, count
from pathlib import Path
from typing import Protocol

from chord_usd.library.design_tables import SizeM

Axis = str
"""One of +x, -x, +y, -y, +z, -z."""
AXES = ("+x", "-x", "+y", "-y", "+z", "-z")

UNITS_M = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""What models are measured in, the likeliest first."""


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
    tags: tuple[str, ...] = ()
    """Names of library.database.TAGS."""


class Library(Protocol):
    """A folder or archive with models."""

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


def free_name(wanted: str, taken: Collection[str]) -> str:
    """The name wanted, or the first of wanted_2, wanted_3 … that is not taken."""
    names = (f"{wanted}_{number}" for number in count(2))
    return next(name for name in chain([wanted], names) if name not in taken)
