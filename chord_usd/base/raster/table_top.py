"""The top view of one supporting piece: what a tabletop layout is conditioned on and drawn over.

Everything is in the piece's own frame, which is also that of its children: length along x, front
towards -y, so the front is at the lower edge of the picture.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import cv2
import numpy as np

from chord_usd.base.scene import palette
from chord_usd.base.scene.types import BoolArray, ByteArray, PixelFrame, PlanImage, RoomKind

CANVAS_M = 2.0
"""Side of the square that is drawn (paper, section "Fine-grained layout synthesis")."""

TABLE_CANVAS_PX = 128
"""A cup is nine pixels wide then, as a chair is in the raster of a house."""

BORDER_M = 0.06
"""Width of the strip around the top that shows what is beside it."""

Side = Literal["back", "front", "left", "right"]
SIDES: tuple[Side, ...] = Side.__args__  # type: ignore[attr-defined]

Neighbour = Literal["wall", "seat", "bed"]
NEIGHBOURS: dict[Neighbour, str] = {"wall": "wall", "seat": "chair", "bed": "bed"}
"""What may be beside a top, and the category whose colour shows it."""


@dataclass(frozen=True)
class Border:
    """What is beside a stretch of a top's edge."""

    side: Side
    kind: Neighbour
    from_m: float
    """Along own x at the back and front, along own y at the left and right."""
    to_m: float


@dataclass(frozen=True, eq=False)
class TableTop:
    """A supporting piece seen from above."""

    category: str
    """One of palette.SUPPORTS."""
    size_m: tuple[float, float]
    """Length and width (depth)."""
    free: BoolArray
    """(rows, columns) of the footprint, first row at the back: where something can stand."""
    borders: tuple[Border, ...] = ()
    room: RoomKind = "unknown"
    """Where it stands; no picture shows it."""


def table_frame(size_m: tuple[float, float]) -> PixelFrame:
    """The frame of a top of this size, its origin in the middle of the canvas.

    The canvas is CANVAS_M wide; only what is longer than that is drawn smaller.
    """
    side_m = max(CANVAS_M, max(size_m) + 4 * BORDER_M)
    return PixelFrame(side_m / TABLE_CANVAS_PX, (-side_m / 2, -side_m / 2), TABLE_CANVAS_PX)


def draw_table(top: TableTop, frame: PixelFrame | None = None) -> PlanImage:
    """The top in the grey of its category on white; around it walls, seats and beds as strips."""
    frame = frame or table_frame(top.size_m)
    rgb = np.full((frame.height_px, frame.height_px, 3), palette.BACKGROUND_RGB, np.uint8)
    for border in top.borders:
        rgb[_strip(border, top.size_m, frame)] = border_rgb(border.kind)
    half_length, half_width = top.size_m[0] / 2, top.size_m[1] / 2
    window = _window((-half_length, half_length), (-half_width, half_width), frame)
    shape = rgb[window].shape[:2]
    if all(shape):
        free = cv2.resize(
            top.free.astype(np.uint8), shape[::-1], interpolation=cv2.INTER_NEAREST_EXACT
        )
        rgb[window][free > 0] = palette.TOP_SHADES[top.category]
    rgb.setflags(write=False)
    return PlanImage(rgb, frame)


def top_mask(rgb: ByteArray) -> BoolArray:
    """(H, W) pixels of a top, of whatever category, in a top view."""
    grey = (rgb[..., 0] == rgb[..., 1]) & (rgb[..., 1] == rgb[..., 2])
    levels = [shade[0] for shade in palette.TOP_SHADES.values()]
    return np.asarray(grey & np.isin(rgb[..., 0], levels), np.bool_)


def border_rgb(kind: Neighbour) -> palette.Rgb:
    """The colour of a strip."""
    rgb = palette.category(NEIGHBOURS[kind]).rgb
    return rgb if kind == "wall" else palette.painted(palette.BACKGROUND_RGB, rgb)


def _strip(border: Border, size_m: tuple[float, float], frame: PixelFrame) -> tuple[slice, slice]:
    """The pixels just outside the stretch of the edge."""
    along = (border.from_m, border.to_m)
    if border.side in ("back", "front"):
        edge = size_m[1] / 2
        across = (edge, edge + BORDER_M) if border.side == "back" else (-edge - BORDER_M, -edge)
        return _window(along, across, frame)
    edge = size_m[0] / 2
    across = (edge, edge + BORDER_M) if border.side == "right" else (-edge - BORDER_M, -edge)
    return _window(across, along, frame)


def _window(
    x_m: tuple[float, float], y_m: tuple[float, float], frame: PixelFrame
) -> tuple[slice, slice]:
    """Rows and columns of the pixels whose centres lie in these spans."""
    columns = [(x - frame.origin_m[0]) / frame.m_per_px for x in x_m]
    rows = [frame.height_px - (y - frame.origin_m[1]) / frame.m_per_px for y in y_m[::-1]]
    (left, right), (high, low) = (
        [int(np.clip(np.ceil(edge - 0.5), 0, frame.height_px)) for edge in span]
        for span in (columns, rows)
    )
    return slice(high, low), slice(left, right)
