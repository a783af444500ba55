"""Kept pictures: what the program draws has to look as it did when somebody last looked at it."""

from __future__ import annotations

import os
from pathlib import Path

import cv2
import numpy as np
import numpy.typing as npt
from PIL import Image

FOLDER = Path(__file__).parent / "fixtures" / "golden"
WRITE = "CHORD_USD_WRITE_GOLDEN"
"""Set, it writes the kept pictures: look at them before they are committed."""

LEAST_SSIM = 0.98
WIDEST_PX = 320


def require_alike(name: str, rgb: npt.NDArray[np.uint8], scratch: Path) -> None:
    """A picture has to be as large as the kept picture of this name, and its SSIM above LEAST_SSIM.

    rgb: (H, W, 3). scratch: folder for the picture, to look at.
    """
    small = shrunk(rgb)
    kept_file = FOLDER / f"{name}.png"
    if os.environ.get(WRITE):
        Image.fromarray(small).save(kept_file, optimize=True)
    kept = np.asarray(Image.open(kept_file).convert("RGB"))
    Image.fromarray(small).save(scratch / f"{name}.png")
    assert kept.shape == small.shape
    likeness = ssim(kept, small)
    assert likeness > LEAST_SSIM, f"SSIM {likeness:.3f}; see {scratch / name}.png and {kept_file}"


def shrunk(rgb: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """The picture at most WIDEST_PX wide."""
    height, width = rgb.shape[:2]
    if width <= WIDEST_PX:
        return rgb
    size = (WIDEST_PX, round(height * WIDEST_PX / width))
    return np.asarray(cv2.resize(rgb, size, interpolation=cv2.INTER_AREA))


def ssim(one: npt.NDArray[np.uint8], other: npt.NDArray[np.uint8]) -> float:
    """Mean structural similarity of two pictures, (H, W, 3), over windows of sigma 1.5 pixels."""

    def mean(values: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return np.asarray(cv2.GaussianBlur(values, (11, 11), 1.5))

    a, b = (picture.astype(np.float64) for picture in (one, other))
    low, least = (0.01 * 255) ** 2, (0.03 * 255) ** 2
    mean_a, mean_b = mean(a), mean(b)
    across = mean(a * b) - mean_a * mean_b
    var_a, var_b = mean(a * a) - mean_a**2, mean(b * b) - mean_b**2
    likeness = (2 * mean_a * mean_b + low) * (2 * across + least)
    likeness /= (mean_a**2 + mean_b**2 + low) * (var_a + var_b + least)
    return float(likeness.mean())
