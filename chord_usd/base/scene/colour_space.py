"""How different two colours look."""

from __future__ import annotations

import numpy as np

Rgb = tuple[int, int, int]
"""sRGB, 0 to 255."""

_LMS = np.array([[0.4122214708, 0.5363325363, 0.0514459929],
                 [0.2119034982, 0.6806995451, 0.1073969566],
                 [0.0883024619, 0.2817188376, 0.6299787005]])  # fmt: skip
_LAB = np.array([[0.2104542553, 0.7936177850, -0.0040720468],
                 [1.9779984951, -2.4285922050, 0.4505937099],
                 [0.0259040371, 0.7827717662, -0.8086757660]])  # fmt: skip

ALIKE = 0.1
"""Colours no farther apart than this go by the same name."""


def lightness(rgb: Rgb) -> float:
    """From 0, black, to 1, white, as it is seen."""
    return float(_oklab(rgb)[0])


def colour_distance(first: Rgb, second: Rgb) -> float:
    """Distance in Oklab (Ottosson 2020), in which white and black are 1 apart; hue counts twice."""
    away = (_oklab(first) - _oklab(second)) * (1.0, 2.0, 2.0)
    return float(np.hypot(away[0], np.hypot(away[1], away[2])))


def _oklab(rgb: Rgb) -> np.ndarray:
    level = np.array(rgb) / 255.0
    linear = np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4)
    return np.asarray(_LAB @ np.cbrt(_LMS @ linear))
