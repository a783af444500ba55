"""OpenEXR files as named channels."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt

PixelArray = npt.NDArray[np.float32]

Channels = dict[str, PixelArray]
"""(H, W) each, by names such as R, Z or N.X."""


def read_exr(path: Path) -> tuple[Channels, dict[str, object]]:
    """Channels of a file and its header. Raises OSError for one that is cut short or damaged."""
    import OpenEXR

    try:
        file = OpenEXR.File(str(path), separate_channels=True)
        planes = file.channels()
        channels = {name: np.asarray(planes[name].pixels, dtype=np.float32) for name in planes}
        return channels, file.header()
    except Exception as error:  # the library raises plain RuntimeErrors, ValueErrors, TypeErrors
        raise OSError(f"{path}: cannot be read as OpenEXR ({error})") from error


def colour_channels(colour: PixelArray) -> Channels:
    """R, G, B and, where there are four, A of (H, W, 3 or 4) light."""
    return {name: colour[..., at] for at, name in enumerate("RGBA"[: colour.shape[2]])}


def write_exr(
    path: Path,
    channels: Mapping[str, PixelArray],
    notes: Mapping[str, str] | None = None,
    *,
    half: bool = False,
) -> None:
    """Write channels of one size, losslessly; notes go into the header.

    half: 16-bit floats, enough for colour. A full disk is a RuntimeError of the library's.
    """
    import OpenEXR

    header = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        **(notes or {}),
    }
    kind = np.float16 if half else np.float32
    pixels = {
        # Beyond its largest number a half would become infinite.
        name: np.ascontiguousarray(np.clip(values, -65504, 65504) if half else values, dtype=kind)
        for name, values in channels.items()
    }
    with OpenEXR.File(header, pixels) as file:
        file.write(str(path))
