"""Pictures as users have them: any format, depth and transparency, or a clear refusal."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from chord_usd.base.errors import PlanError, SceneError
from chord_usd.base.raster.raster_files import TEXT_CHUNK, read_chunk
from chord_usd.base.runtime.confined import decode
from chord_usd.base.runtime.inputs import refuse_odd_file
from chord_usd.base.scene.types import ByteArray, PixelFrame

if TYPE_CHECKING:
    from PIL import Image

SMALLEST_SIDE_PX = 32
LARGEST_SIDE_PX = 12_000

_BAND_PX = 64

_FORMATS = ("PNG", "JPEG", "TIFF", "BMP", "GIF", "WEBP", "PPM", "JPEG2000", "TGA")
"""What is opened at all: Pillow hands EPS to Ghostscript, a program of its own."""

_EXPECTED = "a picture of a floor plan (PNG, JPEG, TIFF, BMP, GIF or WebP)"


@dataclass(frozen=True, eq=False)
class Picture:
    """A picture, and where it lies if it says so."""

    rgb: ByteArray
    """(H, W, 3); transparency is laid over white."""
    frame: PixelFrame | None
    """From the text chunk that raster.raster_files.write_raster leaves."""


def read_picture(path: Path) -> Picture:
    """Read a picture of any kind, upright and 8 bits deep, in a process of its own.

    Raises PlanError for what is no picture, is damaged, or has sides beyond SMALLEST_SIDE_PX and
    LARGEST_SIDE_PX; sizes are checked before anything is decoded.
    """
    picture: Picture = decode("plan picture", path, where=str(path), error=PlanError)
    return picture


def _read(path: Path) -> Picture:
    from PIL import Image, UnidentifiedImageError

    refuse_odd_file(path, PlanError)
    try:
        if path.stat().st_size == 0:
            raise PlanError("is empty", where=str(path), expected=_EXPECTED)
        with warnings.catch_warnings():
            # The sides are checked here, with words of our own.
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)
            with Image.open(path, formats=_FORMATS) as image:
                _check_size(image.size, path)
                described = getattr(image, "text", {}).get(TEXT_CHUNK)
                rgb = _upright_rgb(image)
    except UnidentifiedImageError as error:
        raise PlanError(
            "is not a picture", where=str(path), expected=_EXPECTED, try_="export it as PNG"
        ) from error
    except Image.DecompressionBombError as error:
        raise PlanError(
            "is too large", where=str(path), expected=f"at most {LARGEST_SIDE_PX} pixels a side",
            try_="scale it down to about 2000 pixels",
        ) from error  # fmt: skip
    except (OSError, SyntaxError, ValueError, EOFError) as error:
        if isinstance(error, OSError) and error.errno is not None:
            reason = (error.strerror or str(error)).lower()
            raise PlanError(f"cannot be read ({reason})", where=str(path)) from error
        raise PlanError(
            "is a damaged picture", where=str(path), expected=_EXPECTED, try_="export it again"
        ) from error
    rgb.setflags(write=False)
    return Picture(rgb, _frame(described, rgb.shape[0], path))


def _check_size(size: tuple[int, int], path: Path) -> None:
    if max(size) > LARGEST_SIDE_PX or min(size) < SMALLEST_SIDE_PX:
        raise PlanError(
            f"is {size[0]}×{size[1]} pixels",
            where=str(path),
            expected=f"{SMALLEST_SIDE_PX} to {LARGEST_SIDE_PX} pixels a side",
            try_="scale it to about 1000 pixels",
        )


def _upright_rgb(image: Image.Image) -> ByteArray:
    """(H, W, 3), made in bands: the largest picture must not lie in memory four times."""
    from PIL import ImageOps

    ImageOps.exif_transpose(image, in_place=True)
    is_deep = image.mode.startswith(("I", "F"))
    white = _white(image) if is_deep else 255.0
    width, height = image.size
    rgb = np.empty((height, width, 3), np.uint8)
    for top in range(0, height, _BAND_PX):
        band = image.crop((0, top, width, min(top + _BAND_PX, height)))
        rows = rgb[top : top + _BAND_PX]
        if is_deep:
            rows[:] = np.clip(np.rint(np.asarray(band) * (255.0 / white)), 0, 255)[:, :, None]
        else:
            rows[:] = np.asarray(_opaque(band))
    return rgb


def _opaque(image: Image.Image) -> Image.Image:
    """In RGB, over white."""
    from PIL import Image

    if "A" not in image.mode and "transparency" not in image.info:
        return image.convert("RGB")
    layer = image.convert("RGBA")
    paper = Image.new("RGB", layer.size, "white")
    paper.paste(layer, mask=layer)
    return paper


def _white(image: Image.Image) -> float:
    """The value of white in grey of 16 or 32 bits, or floats: the full range of the type."""
    highest = 1.0 if image.mode.startswith("F") else 65535.0
    # Of a picture with one band; only the types know more.
    most = float(image.getextrema()[1])  # type: ignore[arg-type]
    if most > highest:
        return most
    # Twelve-bit scanners save in sixteen bits.
    return 4095.0 if highest == 65535.0 and most < 4096 else highest


def _frame(described: str | None, height_px: int, path: Path) -> PixelFrame | None:
    if not described:
        return None
    try:
        frame, provenance = read_chunk(described)
    except SceneError:
        return None
    if provenance is not None:
        raise PlanError("is a layout, not a plan", where=str(path), try_="<graph>")
    # A picture that was scaled since keeps the text of the one it was made from.
    return frame if frame.height_px == height_px else None
