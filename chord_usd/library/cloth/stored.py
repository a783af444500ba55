"""Reads and writes the stored cloths: points in steps of a 65,535th of their bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from chord_usd.base.errors import AssetError
from chord_usd.base.scene.types import FloatArray, frozen_array
from chord_usd.library.kit.solids import Solid

FOLDER = Path(__file__).parent
_STEPS = 65_535


@dataclass(frozen=True, eq=False)
class Cloth:
    """A mesh with the place of each point on the flat cloth."""

    solid: Solid
    """Open where the cloth is a sheet, closed where it is stuffed or thick."""
    uvs_m: FloatArray
    """(N, 2), metres on the cloth before it was draped."""

    def corner_uvs_m(self) -> FloatArray:
        """(3 T, 2), as Part.uvs wants them."""
        return self.uvs_m[self.solid.faces.reshape(-1)]

    def scaled(self, x: float = 1.0, y: float = 1.0, z: float = 1.0) -> Cloth:
        """Stretched; the weave keeps its size: u grows with x, v with the larger of y and z."""
        uvs = self.uvs_m * [abs(x), max(abs(y), abs(z))]
        return Cloth(self.solid.scaled(x, y, z), frozen_array(uvs))

    def moved(self, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> Cloth:
        """Shifted by metres."""
        return replace(self, solid=self.solid.moved(x, y, z))


def save(name: str, points_m: FloatArray, faces: np.ndarray, uvs_m: FloatArray) -> Path:
    """Store a cloth of at most 65,536 points; returns its file. The same cloth, the same bytes."""
    file = FOLDER / f"{name}.npz"
    packed = {}
    for key, values in (("points", points_m), ("uvs", uvs_m)):
        low, high = values.min(axis=0), values.max(axis=0)
        span = np.maximum(high - low, 1e-9)
        packed[key] = _steps_between(np.round((values - low) / span * _STEPS))
        packed[f"{key}_bounds"] = np.array([low, low + span], dtype=np.float32)
    np.savez_compressed(file, faces=_steps_between(np.asarray(faces)), **packed)
    return file


def _steps_between(values: np.ndarray) -> np.ndarray:
    """From each row to the next, modulo 65,536: neighbours differ by little, which packs well."""
    whole = values.astype(np.uint16)
    return np.diff(whole, axis=0, prepend=np.zeros_like(whole[:1]))


def _added_up(steps: np.ndarray) -> np.ndarray:
    return np.cumsum(steps, axis=0, dtype=np.uint16)


def names() -> tuple[str, ...]:
    """Names of the stored cloths, in order."""
    return tuple(sorted(file.stem for file in FOLDER.glob("*.npz")))


@lru_cache(maxsize=64)
def stored(name: str) -> Cloth:
    """The cloth of this name. Raises AssetError where there is none."""
    file = FOLDER / f"{name}.npz"
    if not file.is_file():
        raise AssetError(
            f"there is no stored cloth '{name}'", expected=f"one of {', '.join(names())}"
        )
    with np.load(file) as packed:
        points, uvs = (_unpacked(packed, key) for key in ("points", "uvs"))
        faces = _added_up(packed["faces"]).astype(np.int64)
    return Cloth(Solid(frozen_array(points), frozen_array(faces, np.int64)), frozen_array(uvs))


def _unpacked(packed: np.lib.npyio.NpzFile, key: str) -> FloatArray:
    low, high = packed[f"{key}_bounds"].astype(np.float64)
    return low + _added_up(packed[key]).astype(np.float64) / _STEPS * (high - low)
