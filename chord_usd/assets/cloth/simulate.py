"""Makes the stored cloths again: `python -m chord_usd.assets.cloth.simulate [NAME …]`.

Needs Blender's bpy and about a minute a cloth. The files differ by a hair from machine to machine,
since a simulation does; that is why they are stored.
"""

from __future__ import annotations

import sys
from collections.abc import Callable

import numpy as np

from chord_usd.assets.cloth.hangings import Hanging, hung
from chord_usd.assets.cloth.stored import save
from chord_usd.scene.types import FloatArray

Made = tuple[FloatArray, np.ndarray, FloatArray]
"""Points, faces, cloth coordinates."""

_HANGINGS = {
    "curtain_wave_narrow": Hanging("wave", 0.6, 5, 2.0, 5, seed=1),
    "curtain_wave_wide": Hanging("wave", 1.2, 10, 2.0, 10, seed=2),
    "curtain_wave_open": Hanging("wave", 0.34, 6, 4.2, 6, seed=4),
    "curtain_pinch_narrow": Hanging("pinch", 0.6, 4, 2.0, 4, seed=12),
    "curtain_pinch_wide": Hanging("pinch", 1.2, 9, 2.0, 9, seed=13),
    "curtain_pinch_open": Hanging("pinch", 0.34, 5, 4.0, 5, seed=14),
    "curtain_pinch_tied": Hanging("pinch", 0.46, 5, 3.0, 5, is_tied=True, seed=5),
    "curtain_gather_narrow": Hanging("gather", 0.6, 10, 2.0, 5, seed=3),
    "curtain_gather_wide": Hanging("gather", 1.2, 17, 2.0, 9, seed=6),
    "curtain_gather_open": Hanging("gather", 0.34, 9, 3.4, 5, seed=7),
}


def makers() -> dict[str, Callable[[], Made]]:
    """How each stored cloth is made, by its name."""
    return {name: lambda one=one: hung(one) for name, one in _HANGINGS.items()}


def main(names: list[str]) -> None:
    """Simulate these cloths, all of them by default, and store them."""
    every = makers()
    for name in names or list(every):
        print(save(name, *every[name]()))  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1:])
