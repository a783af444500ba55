"""The material library: looks of walls and floors, and which room wears which.

A look is a folder of materials/ with look.json, a USD material package and its maps.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from chord_usd.errors import AssetError
from chord_usd.runtime.locations import materials_folder
from chord_usd.scene.types import ROOM_KINDS, RoomKind

LOOK_FILE = "look.json"

Surface = Literal["floor", "wall", "both"]
SURFACES: tuple[Surface, ...] = Surface.__args__  # type: ignore[attr-defined]


@dataclass(frozen=True)
class Look:
    """One material of the library."""

    name: str
    """Folder, layer and prim name: materials/OakPlank/OakPlank.usda</OakPlank>."""
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


def load_looks(folder: Path | None = None) -> tuple[Look, ...]:
    """All looks of a material library, sorted by name; by default those that are shipped.

    Raises AssetError for a folder without looks and for a damaged look.json.
    """
    folder = materials_folder() if folder is None else folder
    looks = tuple(_read(file) for file in sorted(folder.glob(f"*/{LOOK_FILE}")))
    if not looks:
        raise AssetError(
            "there are no looks here",
            where=str(folder),
            expected=f"folders that each hold a {LOOK_FILE}",
            try_="the materials folder of the package",
        )
    return looks


def sample_look(
    looks: Iterable[Look],
    surface: Literal["floor", "wall"],
    kind: RoomKind,
    rng: np.random.Generator,
) -> Look:
    """A look for this surface of a room of this kind, drawn evenly from those that suit it.

    A kind that no look suits is served as a room of unknown kind, and then from all looks of the
    surface. Raises AssetError where there is none of the surface at all.
    """
    usable = [look for look in looks if look.surface in (surface, "both")]
    if not usable:
        raise AssetError(
            f"the material library has no look for a {surface}",
            expected=f'a {LOOK_FILE} whose surface is "{surface}" or "both"',
        )
    fitting = [look for look in usable if kind in look.kinds]
    neutral = [look for look in usable if "unknown" in look.kinds]
    candidates = fitting or neutral or usable
    return candidates[int(rng.integers(len(candidates)))]


def _read(file: Path) -> Look:
    try:
        return _look(json.loads(file.read_text(encoding="utf-8")), file.parent)
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise AssetError(
            f"the look cannot be read ({error})",
            where=str(file),
            expected='{"name", "label", "surface", "kinds", "tile_m", "licence", "author"}',
        ) from None


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
    )
