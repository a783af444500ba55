"""The sheets that floors are planned on."""

from __future__ import annotations

import numpy as np

from chord_usd.palette import BACKGROUND_RGB
from chord_usd.types import ByteArray, PixelFrame, PlanImage


def blank_sheet(frame: PixelFrame) -> PlanImage:
    """A sheet with nothing on it."""
    rgb: ByteArray = np.full((frame.height_px, frame.height_px, 3), BACKGROUND_RGB, np.uint8)
    return PlanImage(rgb, frame)
