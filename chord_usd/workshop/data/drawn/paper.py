"""What happens to a drawing on its way into a computer: skew, shadow, blur, noise, JPEG."""

from __future__ import annotations

import io
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from chord_usd.base.scene.types import ByteArray, FloatArray, frozen_array
from chord_usd.workshop.data.drawn.page_styles import Style

_TABLE_RGB = (112, 84, 60)
_TABLE_MARGIN = 0.12
"""Of the sheet's size, that can be seen of the table round it."""

_FOCAL = 1.1
"""Of the camera, in widths of the picture."""


def soil(rgb: ByteArray, style: Style, rng: np.random.Generator) -> tuple[ByteArray, FloatArray]:
    """(H, W, 3) the drawing as it arrives, and (3, 3) from its own pixels to that picture's."""
    picture: NDArray[Any] = rgb.astype(np.float32)
    matrix = np.eye(3)
    if style.skew_deg:
        center = rgb.shape[1] / 2, rgb.shape[0] / 2
        matrix[:2] = cv2.getRotationMatrix2D(center, -style.skew_deg, 1.0)
        size = rgb.shape[1], rgb.shape[0]
        picture = cv2.warpAffine(picture, matrix[:2], size, borderValue=style.paper_rgb)
    if style.tilt:
        picture, matrix = _photographed(picture, style, rng)
    if style.shadow:
        rows, columns = np.mgrid[0 : picture.shape[0], 0 : picture.shape[1]]
        slope = rows / picture.shape[0] + columns / picture.shape[1]
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
    return frozen_array(dirty, np.uint8), matrix


def _photographed(
    sheet: NDArray[Any], style: Style, rng: np.random.Generator
) -> tuple[NDArray[Any], FloatArray]:
    """The sheet on a table, seen at a slant, and (3, 3) from its pixels to the photo's."""
    height, width = sheet.shape[:2]
    focal = _FOCAL * max(width, height)
    # The camera is tipped about both axes of the sheet, by tilt radians per 0.1 or so.
    tip_x, tip_y = rng.choice([-1.0, 1.0], 2) * style.tilt * rng.uniform(2.0, 4.0, 2)
    turn, _ = cv2.Rodrigues(np.array([tip_x, tip_y, rng.uniform(-0.04, 0.04)]))
    corners = np.array([[0, 0], [width, 0], [width, height], [0, height]], np.float64)
    placed = np.column_stack([corners - np.array([width, height]) / 2, np.zeros(4)]) @ turn.T
    seen = focal * placed[:, :2] / (placed[:, 2:] + focal)
    low, high = seen.min(axis=0), seen.max(axis=0)
    # The camera looks at the middle of what it sees.
    half = np.maximum(np.abs(low), np.abs(high)) * (1 + _TABLE_MARGIN)
    size = int(2 * half[0]), int(2 * half[1])
    matrix = cv2.getPerspectiveTransform(
        corners.astype(np.float32), (seen + half).astype(np.float32)
    )
    table = tuple(float(v) for v in _TABLE_RGB)
    photo = cv2.warpPerspective(
        sheet,
        matrix,
        size,
        flags=cv2.INTER_LINEAR,
        borderMode=cv2.BORDER_CONSTANT,
        borderValue=table,
    )
    return photo, np.asarray(matrix, np.float64)
