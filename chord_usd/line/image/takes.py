"""What one camera saw, as arrays: the same from a whole render and from merged parts."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from chord_usd.line.image.exr import Channels, PixelArray, read_exr
from chord_usd.line.image.job import COLOUR_FILE, DATA_FILE, LAYERS_FILE, PICTURE_FILE
from chord_usd.line.image.stage_cameras import StageCamera

_LAYER = "ViewLayer"
_NOTHING_M = 1e9
"""Cycles gives pixels that show nothing a depth of 1e10."""


@dataclass(frozen=True, eq=False)
class Take:
    """What one camera saw; fields that were not asked for are None."""

    view: StageCamera
    exposure_ev: float
    picture: Path | None = None
    """PNG out of Blender."""
    layers: Path | None = None
    """Multilayer EXR out of Blender."""
    colour: PixelArray | None = None
    """(H, W, 3 or 4) linear Rec.709 light; 4 where the background is transparent."""
    depth_m: PixelArray | None = None
    """(H, W) along the camera's axis; infinite where there is nothing."""
    normal: PixelArray | None = None
    """(H, W, 3) in the world, unit length; 0 where there is nothing."""
    numbers: PixelArray | None = None
    """(H, W) whole numbers of things; 0 where there is nothing."""

    def developed(self, picture: Path) -> Take:
        """The take with the picture that became of its light."""
        return replace(self, picture=picture)


def read_take(
    folder: Path, view: StageCamera, exposure_ev: float, *, colour: bool, data: bool
) -> Take:
    """What Blender left of one camera in its folder. Raises OSError for a file cut short."""
    picture, layers = (folder / name.format(view.name) for name in (PICTURE_FILE, LAYERS_FILE))
    light = None
    if colour:
        channels, _ = read_exr(folder / COLOUR_FILE.format(view.name))
        light = np.stack([channels[name] for name in "RGBA" if name in channels], axis=-1)
    depth = normal = numbers = None
    if data:
        channels, _ = read_exr(folder / DATA_FILE.format(view.name))
        depth, normal, numbers = _data(channels)
    return Take(
        view,
        exposure_ev,
        picture if picture.exists() else None,
        layers if layers.exists() else None,
        light,
        depth,
        normal,
        numbers,
    )


def _data(channels: Channels) -> tuple[PixelArray, PixelArray, PixelArray]:
    depth = channels[f"{_LAYER}.Depth.Z"]
    empty = depth > _NOTHING_M
    normal = np.stack([channels[f"{_LAYER}.Normal.{axis}"] for axis in "XYZ"], axis=-1)
    length = np.linalg.norm(normal, axis=-1, keepdims=True)
    normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
    normal[empty] = 0.0
    numbers = np.where(empty, 0.0, np.round(channels[f"{_LAYER}.Combined.R"]))
    return np.where(empty, np.inf, depth).astype(np.float32), normal, numbers.astype(np.float32)
