"""Plan and layout rasters as PNG files that remember their pixel frame and provenance.

The frame travels in a text chunk named "chord", so that a layout read back lies where it was drawn,
to the last digit. Other programs ignore the chunk.
"""

from __future__ import annotations

import io
import json
import warnings
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.errors import SceneError
from chord_usd.runtime.files import write_atomic
from chord_usd.raster import LARGEST_CANVAS_PX
from chord_usd.types import CANVAS_PX, LayoutImage, PixelFrame, PlanImage, Provenance, frozen_array

TEXT_CHUNK = "chord"


def write_raster(image: PlanImage | LayoutImage, path: Path) -> None:
    """Write an RGB PNG; the same image gives the same bytes. Raises OutputError."""
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    described: dict[str, Any] = {"frame": asdict(image.frame)}
    if isinstance(image, LayoutImage):
        described["provenance"] = asdict(image.provenance)
    chunks = PngInfo()
    chunks.add_text(TEXT_CHUNK, json.dumps(described, sort_keys=True))
    buffer = io.BytesIO()
    Image.fromarray(image.rgb, "RGB").save(buffer, "PNG", pnginfo=chunks)
    write_atomic(path, buffer.getvalue())


def read_layout(path: Path, m_per_px: float | None = None) -> LayoutImage:
    """Read a layout raster: a square of CANVAS_PX × CANVAS_PX pixels, larger for large houses.

    m_per_px is needed only for pictures without the "chord" chunk, whose origin is taken to be
    (0, 0). Raises SceneError for what is no such picture.
    """
    rgb, described = _open(path)
    height_px, width_px = rgb.shape[:2]
    if height_px != width_px or not CANVAS_PX <= height_px <= LARGEST_CANVAS_PX:
        raise SceneError(
            f"is {width_px}×{height_px} pixels",
            where=str(path),
            expected=f"a layout raster of {CANVAS_PX}×{CANVAS_PX}, or a larger square",
            try_="chord-usd layout plan.png -o layout.png",
        )
    if m_per_px is not None:
        return LayoutImage(rgb, PixelFrame(m_per_px, (0.0, 0.0), height_px))
    if described is None:
        raise SceneError(
            "does not say how large its pixels are",
            where=str(path),
            expected="a layout written by chord-usd layout",
            try_="--scale M_PER_PX",
        )
    frame, provenance = _frame_and_provenance(described, path)
    if frame.height_px != height_px:
        raise SceneError(
            f"was drawn {frame.height_px} pixels high and is {height_px} now",
            where=str(path),
            expected="a layout at the size it was written in",
            try_="--scale M_PER_PX",
        )
    return LayoutImage(rgb, frame, provenance)


def _open(path: Path) -> tuple[np.ndarray[Any, Any], dict[str, Any] | None]:
    from PIL import Image, UnidentifiedImageError

    try:
        with warnings.catch_warnings():
            # Pillow warns of a possible decompression bomb, then stops at twice that size.
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(path) as picture:
                text = getattr(picture, "text", {}).get(TEXT_CHUNK)
                rgb = frozen_array(np.asarray(picture.convert("RGB")), np.uint8)
        return rgb, json.loads(text) if text else None
    except FileNotFoundError:
        raise
    except (
        UnidentifiedImageError, OSError, SyntaxError, ValueError,
        Image.DecompressionBombWarning, Image.DecompressionBombError,
    ) as error:  # fmt: skip
        raise SceneError(
            "is not a picture that can be read", where=str(path), expected="a layout raster (PNG)"
        ) from error


def _frame_and_provenance(described: dict[str, Any], path: Path) -> tuple[PixelFrame, Provenance]:
    try:
        frame = described["frame"]
        x_m, y_m = frame["origin_m"]
        return (
            PixelFrame(float(frame["m_per_px"]), (float(x_m), float(y_m)), frame["height_px"]),
            Provenance(**described.get("provenance", {})),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise SceneError(
            f"the {TEXT_CHUNK!r} text in the picture is damaged",
            where=str(path),
            try_="--scale M_PER_PX",
        ) from error
