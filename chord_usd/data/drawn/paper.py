"""What happens to a drawing on its way into a computer: skew, shadow, blur, noise, JPEG."""

from __future__ import annotations

import io
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from chord_usd.data.drawn.styles import Style
from chord_usd.types import ByteArray, frozen_array


def soil(rgb: ByteArray, style: Style, rng: np.random.Generator) -> ByteArray:
    """(H, W, 3) the drawing as it arrives; its size stays."""
    picture: NDArray[Any] = rgb.astype(np.float32)
    if style.skew_deg:
        center = rgb.shape[1] / 2, rgb.shape[0] / 2
        matrix = cv2.getRotationMatrix2D(center, -style.skew_deg, 1.0)
        size = rgb.shape[1], rgb.shape[0]
        picture = cv2.warpAffine(picture, matrix, size, borderValue=(255.0, 255.0, 255.0))
    if style.shadow:
        rows, columns = np.mgrid[0 : rgb.shape[0], 0 : rgb.shape[1]]
        slope = rows / rgb.shape[0] + columns / rgb.shape[1]
        picture = picture * (1.0 - style.shadow * slope / 2)[..., None]
    if style.blur_px:
        picture = cv2.GaussianBlur(picture, (0, 0), style.blur_px)
    if style.noise:
        picture = picture + rng.normal(0.0, style.noise, picture.shape)
    dirty = np.clip(np.rint(picture), 0, 255).astype(np.uint8)
    if style.jpeg:
        buffer = io.BytesIO()
        Image.fromarray(dirty).save(buffer, "JPEG", quality=style.jpeg)
        dirty = np.asarray(Image.open(buffer))
    return frozen_array(dirty, np.uint8)
