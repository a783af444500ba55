"""What is measured on shipped assets, kept beside them: they never change."""

from __future__ import annotations

import contextlib
import hashlib
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load, save

from chord_usd.base.errors import ChordError
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.locations import cache_folder
from chord_usd.base.scene.types import FloatArray

Arrays = dict[str, FloatArray]


def kept(asset_path: Path, name: str, source: Path, measure: Callable[[], Arrays]) -> Arrays:
    """What measure returns for an asset, or returned when it was asked last.

    name: of what is measured. source: the module that measures, whose change makes it anew. Only
    assets in the cache are kept so; without complaint where it cannot be written. Held to seven
    digits.
    """
    folder = asset_path.parent.parent
    if folder.parent != cache_folder():
        return measure()
    place = folder.with_name(f"{folder.name}-{name}-{_hash(source)}")
    file = place / f"{asset_path.stem}.safetensors"
    arrays = _load(file)
    if arrays is None:
        _keep(file, measure())
        arrays = _load(file)
    return measure() if arrays is None else arrays


@lru_cache(maxsize=8)
def _hash(source: Path) -> str:
    return hashlib.sha256(source.read_bytes()).hexdigest()[:8]


def _load(file: Path) -> Arrays | None:
    """None where there is none, or not a whole one."""
    try:
        arrays = load(file.read_bytes())
    except (OSError, SafetensorError):
        return None
    return {name: array.astype(np.float64) for name, array in arrays.items()}


def _keep(file: Path, arrays: Arrays) -> None:
    packed = save({name: np.ascontiguousarray(a, dtype=np.float32) for name, a in arrays.items()})
    with contextlib.suppress(OSError, ChordError):
        file.parent.mkdir(parents=True, exist_ok=True)
        write_atomic(file, packed)
