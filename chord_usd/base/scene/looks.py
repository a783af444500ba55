"""Looks of walls and floors: material packages, and the sources of looks for a room.

A look is a folder with look.json, a USD material package and its maps.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Protocol

from chord_usd.base.errors import AssetError
from chord_usd.base.runtime.locations import materials_folder
from chord_usd.base.scene.types import ROOM_KINDS, Room, RoomKind

LOOK_FILE = "look.json"

Surface = Literal["floor", "wall", "both"]
SURFACES: tuple[Surface, ...] = Surface.__args__  # type: ignore[attr-defined]


@dataclass(frozen=True)
class Look:
    """One material of floors or walls."""

    name: str
    """Folder, layer and prim name: Planks_1f3a9c/Planks_1f3a9c.usda</Planks_1f3a9c>."""
    label: str
    """For people."""
    surface: Surface
    kinds: tuple[RoomKind, ...]
    """Room kinds it suits."""
    tile_m: tuple[float, float]
    """Size of one repeat of the maps; the material's default uvScale is its inverse."""
    usd_path: Path
    licence: str
    author: str
    standing: bool = False
    """Whether it begins at the floor, such as panels with a rail."""
    family: str = ""
    """What it was drawn by, if it was."""


class LookSource(Protocol):
    """Where the looks of a house come from."""

    def choices(self, part: Literal["floor", "wall"], room: Room, count: int) -> Sequence[Look]:
        """Looks that suit this room, at most count different ones, the chosen look first."""


def looks_in(folder: Path | None = None) -> list[Path]:
    """The look.json of each look in a folder, sorted by name; by default a user's own beside the
    families that ship."""
    return sorted((materials_folder() if folder is None else folder).glob(f"*/{LOOK_FILE}"))


def look_of(folder: Path) -> Look:
    """The look in a folder. Raises AssetError for a damaged look.json."""
    file = folder / LOOK_FILE
    data = read_entry(file)
    try:
        return _look(data, folder)
    except (ValueError, KeyError, TypeError) as error:
        raise _unreadable(file, error) from None


def read_entry(file: Path) -> dict[str, Any]:
    """What a look.json holds. Raises AssetError."""
    try:
        entry = json.loads(file.read_text(encoding="utf-8"))
        if not isinstance(entry, dict):
            raise TypeError("is no object")
        return entry
    except (OSError, ValueError, TypeError) as error:
        raise _unreadable(file, error) from None


def _unreadable(file: Path, error: Exception) -> AssetError:
    return AssetError(
        f"the look cannot be read ({error})",
        where=str(file),
        expected='{"name", "label", "surface", "kinds", "tile_m", "licence", "author"}',
    )


def _look(data: Mapping[str, Any], folder: Path) -> Look:
    """Checked fields; raises ValueError, KeyError or TypeError where one is wrong."""
    width, height = (float(side) for side in data["tile_m"])
    if data["surface"] not in SURFACES:
        raise ValueError(f"surface is {data['surface']!r}, not one of {', '.join(SURFACES)}")
    strange = [kind for kind in data["kinds"] if kind not in ROOM_KINDS]
    if strange:
        raise ValueError(f"unknown room kind {strange[0]!r}")
    if not (0.0 < width < 100.0 and 0.0 < height < 100.0):
        raise ValueError(f"tile_m is {data['tile_m']}, not two lengths in metres")
    usd_path = folder / f"{data['name']}.usda"
    if not usd_path.is_file():
        raise ValueError(f"{usd_path.name} is missing")
    return Look(
        name=str(data["name"]),
        label=str(data["label"]),
        surface=data["surface"],
        kinds=tuple(data["kinds"]),
        tile_m=(width, height),
        usd_path=usd_path,
        licence=str(data["licence"]),
        author=str(data["author"]),
        standing=bool(data.get("standing", False)),
        family=str(data.get("family", "")),
    )
