"""Plan and layout rasters as PNG files that remember their pixel frame and provenance.

The frame travels in a text chunk named "chord", so that a layout read back lies where it was drawn,
to the last digit. Other programs ignore the chunk.
"""

from __future__ import annotations

import io
import json
import math
import warnings
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.base.errors import SceneError
from chord_usd.base.raster.canvas import LARGEST_CANVAS_PX
from chord_usd.base.runtime.confined import decode
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.scene.limits import M_PER_PX
from chord_usd.base.scene.types import (
    CANVAS_PX,
    LayoutImage,
    PixelFrame,
    PlanImage,
    Provenance,
    frozen_array,
)

TEXT_CHUNK = "chord"

_FARTHEST_M = 2000.0
"""From the world's origin to a canvas: no CHOrD JSON file reaches beyond half of it."""


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
    rgb, described = decode("layout raster", path, where=str(path), error=SceneError)
    height_px = rgb.shape[0]
    if m_per_px is not None:
        return LayoutImage(rgb, PixelFrame(m_per_px, (0.0, 0.0), height_px))
    if described is None:
        raise SceneError(
            "does not say how large its pixels are",
            where=str(path),
            expected="a layout that this program wrote",
            try_="<m_per_px>",
        )
    try:
        frame, provenance = read_chunk(described)
    except SceneError as error:
        raise SceneError(
            f"the {TEXT_CHUNK!r} text in the picture is damaged: {error}",
            where=str(path),
            try_="<m_per_px>",
        ) from error
    if frame.height_px != height_px:
        raise SceneError(
            f"was drawn {frame.height_px} pixels high and is {height_px} now",
            where=str(path),
            expected="a layout at the size it was written in",
            try_="<m_per_px>",
        )
    return LayoutImage(rgb, frame, provenance or Provenance())


def _open(path: Path) -> tuple[np.ndarray[Any, Any], str | None]:
    """RGB, and the text of the "chord" chunk."""
    from PIL import Image, UnidentifiedImageError

    refuse_odd_file(path, SceneError)
    try:
        with warnings.catch_warnings():
            # Pillow warns of a possible decompression bomb, then stops at twice that size.
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(path, formats=("PNG",)) as picture:
                # Before a pixel is decoded: a small file may stand for gigabytes of them.
                _refuse_odd_size(picture.size, path)
                text = getattr(picture, "text", {}).get(TEXT_CHUNK)
                rgb = frozen_array(np.asarray(picture.convert("RGB")), np.uint8)
        return rgb, text
    except (
        UnidentifiedImageError, OSError, SyntaxError, ValueError,
        Image.DecompressionBombWarning, Image.DecompressionBombError,
    ) as error:  # fmt: skip
        raise SceneError(
            "is not a picture that can be read", where=str(path), expected="a layout raster (PNG)"
        ) from error


def _refuse_odd_size(size: tuple[int, int], path: Path) -> None:
    width_px, height_px = size
    if height_px != width_px or not CANVAS_PX <= height_px <= LARGEST_CANVAS_PX:
        raise SceneError(
            f"is {width_px}×{height_px} pixels",
            where=str(path),
            expected=f"a layout raster of {CANVAS_PX}×{CANVAS_PX}, or a larger square",
            try_="<layout>",
        )


def read_chunk(text: str) -> tuple[PixelFrame, Provenance | None]:
    """What the "chord" text of a picture says; provenance is that of a layout, None of a plan.

    Anyone can have written it. Raises SceneError for what is no frame of a house.
    """
    data = parse_json(text, "the chunk", SceneError)
    if not isinstance(data, dict) or not isinstance(data.get("frame"), dict):
        raise SceneError("holds no frame")
    frame, provenance = data["frame"], data.get("provenance")
    m_per_px, height_px = _number(frame, "m_per_px"), frame.get("height_px")
    origin = frame.get("origin_m")
    if not isinstance(origin, list) or len(origin) != 2:
        raise SceneError("origin_m is no point")
    x_m, y_m = (_number({"origin_m": value}, "origin_m") for value in origin)
    if not M_PER_PX[0] <= m_per_px <= M_PER_PX[1]:
        raise SceneError(f"m_per_px is {m_per_px:g}", expected=f"{M_PER_PX[0]} to {M_PER_PX[1]:g}")
    if not (abs(x_m) <= _FARTHEST_M and abs(y_m) <= _FARTHEST_M):
        raise SceneError(f"origin_m is beyond {_FARTHEST_M:.0f} m")
    if type(height_px) is not int or not 0 < height_px <= LARGEST_CANVAS_PX:
        raise SceneError("height_px is no number of pixels")
    known = None if provenance is None else _provenance(provenance)
    return PixelFrame(m_per_px, (x_m, y_m), height_px), known


def _number(data: dict[str, Any], key: str) -> float:
    value = data.get(key)
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise SceneError(f"{key} is no number")
    try:
        return float(value)
    except OverflowError:
        return math.inf


def _provenance(data: object) -> Provenance:
    usual = asdict(Provenance())
    if not isinstance(data, dict) or not set(data) <= set(usual):
        raise SceneError("provenance has keys that are not known")
    for key, value in data.items():
        if not isinstance(value, type(usual[key])):
            raise SceneError(f"provenance: {key} is of the wrong kind")
    return Provenance(**data)
