"""A sheet that is drawn on in metres, with the label of every pixel kept beside its colour."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from shapely.geometry import LineString, Polygon
from shapely.geometry.base import BaseGeometry

from chord_usd.base.raster.page_labels import LAID_SHIFT
from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.types import BoolArray, ByteArray, FloatArray
from chord_usd.workshop.data.drawn.page_styles import RGB

_SHIFT = 3
"""Binary digits behind the point in OpenCV's coordinates."""
_BUILT_MASK = (1 << LAID_SHIFT) - 1

Window = tuple[slice, slice]


class Canvas:
    """Colours and labels of a page. y points up in metres and down in pixels."""

    def __init__(self, size_m: FloatArray, px_per_m: float, paper_rgb: RGB) -> None:
        self.px_per_m = px_per_m
        self.width, self.height = (max(8, int(v)) for v in np.ceil(size_m * px_per_m))
        self.rgb: ByteArray = np.full((self.height, self.width, 3), paper_rgb, np.uint8)
        self.labels: ByteArray = np.zeros((self.height, self.width), np.uint8)
        self.paper_rgb = paper_rgb
        self.origin_m = np.zeros(2)
        """Where what is drawn next has its origin on the sheet."""

    def matrix(self) -> FloatArray:
        """(3, 3) from metres on the sheet to continuous pixels."""
        scale = self.px_per_m
        return np.array([[scale, 0.0, 0.0], [0.0, -scale, self.height], [0.0, 0.0, 1.0]])

    def px(self, points_m: FloatArray) -> FloatArray:
        """Continuous pixels of (N, 2) points."""
        points = (np.asarray(points_m, np.float64)[..., :2] + self.origin_m) * self.px_per_m
        points[..., 1] = self.height - points[..., 1]
        return points

    def fill(
        self, area: BaseGeometry, rgb: RGB | None, built: int | None = None, laid: int | None = None
    ) -> None:
        """Paint an area, and say what it is."""
        rings = self._rings(area)
        if not rings:
            return
        if rgb is not None:
            cv2.fillPoly(self.rgb, rings, rgb, cv2.LINE_AA, _SHIFT)
        if built is not None or laid is not None:
            window, mask = self._mask(rings)
            self._label(window, mask, built, laid)

    def line(
        self,
        points_m: FloatArray | Sequence[FloatArray],
        rgb: RGB,
        width_px: int = 1,
        dash_m: float = 0.0,
        laid: int | None = None,
    ) -> None:
        """A stroke along points; dashed where dash_m is given."""
        points_m = np.asarray(points_m, np.float64)
        strokes = _dashes(points_m, dash_m) if dash_m else [points_m]
        pixels = [self._fixed(stroke) for stroke in strokes]
        cv2.polylines(self.rgb, pixels, False, rgb, width_px, cv2.LINE_AA, _SHIFT)
        if laid is not None:
            line = np.rint(self.px(points_m) - 0.5).astype(np.int32)
            mask = np.zeros(self.labels.shape, np.uint8)
            cv2.polylines(mask, [line], False, (1,), width_px + 2)
            self._label((slice(None), slice(None)), mask > 0, None, laid)

    def outline(self, area: BaseGeometry, rgb: RGB, width_px: int = 1, dash_m: float = 0.0) -> None:
        """The edges of an area."""
        for part in polygons_of(area):
            for ring in (part.exterior, *part.interiors):
                self.line(np.array(ring.coords), rgb, width_px, dash_m)
        if isinstance(area, LineString):
            self.line(np.array(area.coords), rgb, width_px, dash_m)

    def paint(self, area: BaseGeometry, colors: ByteArray, opacity: float = 1.0) -> None:
        """Lay a texture, repeated from the area's upper left corner, over an area."""
        rings = self._rings(area)
        if not rings:
            return
        window, mask = self._mask(rings)
        height, width = mask.shape
        rows, columns = -(-height // colors.shape[0]), -(-width // colors.shape[1])
        tiled = np.tile(colors, (rows, columns, 1))[:height, :width][mask]
        under = self.rgb[window]
        if opacity < 1.0:
            tiled = (under[mask] * (1.0 - opacity) + tiled * opacity).astype(np.uint8)
        under[mask] = tiled

    def blend(
        self, corner_px: tuple[int, int], ink: FloatArray, rgb: RGB, laid: int | None = None
    ) -> None:
        """Ink, (h, w) in [0, 1], with its upper left pixel at (column, row); clipped."""
        x, y = corner_px
        left, top = max(0, x), max(0, y)
        right, bottom = min(self.width, x + ink.shape[1]), min(self.height, y + ink.shape[0])
        if right <= left or bottom <= top:
            return
        part = ink[top - y : bottom - y, left - x : right - x, None]
        under = self.rgb[top:bottom, left:right]
        under[:] = under * (1.0 - part) + np.array(rgb) * part
        if laid is not None:
            window = slice(top, bottom), slice(left, right)
            self._label(window, np.ones(part.shape[:2], np.bool_), None, laid)

    def paste(self, corner_px: tuple[int, int], picture: ByteArray, opacity: FloatArray) -> None:
        """A picture, (h, w, 3), with (h, w) opacities in [0, 1]; clipped."""
        x, y = corner_px
        left, top = max(0, x), max(0, y)
        right, bottom = min(self.width, x + opacity.shape[1]), min(self.height, y + len(opacity))
        if right <= left or bottom <= top:
            return
        inner = slice(top - y, bottom - y), slice(left - x, right - x)
        share = opacity[inner][..., None]
        under = self.rgb[top:bottom, left:right]
        under[:] = under * (1.0 - share) + picture[inner] * share

    def is_free(self, x_px: float, y_px: float) -> bool:
        """Whether a pixel lies on the page and outside."""
        column, row = int(x_px), int(y_px)
        if not (0 <= column < self.width and 0 <= row < self.height):
            return False
        return not self.labels[row, column]

    def _fixed(self, points_m: FloatArray) -> np.ndarray:
        return np.rint((self.px(points_m) - 0.5) * (1 << _SHIFT)).astype(np.int32)

    def _rings(self, area: BaseGeometry) -> list[np.ndarray]:
        return [
            self._fixed(np.array(ring.coords))
            for part in polygons_of(area)
            for ring in (part.exterior, *part.interiors)
        ]

    def _mask(self, rings: Sequence[np.ndarray]) -> tuple[Window, BoolArray]:
        """Pixels within rings, in the window that holds them."""
        points = np.concatenate(rings) >> _SHIFT
        low = np.clip(points.min(axis=0) - 1, 0, (self.width, self.height))
        high = np.clip(points.max(axis=0) + 2, 0, (self.width, self.height))
        mask = np.zeros((max(0, high[1] - low[1]), max(0, high[0] - low[0])), np.uint8)
        window = slice(low[1], high[1]), slice(low[0], high[0])
        if mask.size:
            moved = [ring - (low << _SHIFT).astype(np.int32) for ring in rings]
            cv2.fillPoly(mask, moved, (1,), cv2.LINE_8, _SHIFT)
        return window, mask > 0

    def _label(self, window: Window, mask: BoolArray, built: int | None, laid: int | None) -> None:
        labels = self.labels[window]
        if built is not None:
            labels[mask] = built
        if laid is not None:
            labels[mask] = (labels[mask] & _BUILT_MASK) | (laid << LAID_SHIFT)


def _dashes(points_m: FloatArray, dash_m: float) -> list[FloatArray]:
    """Every other piece of a line."""
    steps = np.hypot(*np.diff(points_m, axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    dashes = []
    for start in np.arange(0.0, along[-1], 2 * dash_m):
        ends = np.array([start, min(start + dash_m, along[-1])])
        dashes.append(np.stack([np.interp(ends, along, points_m[:, k]) for k in (0, 1)], axis=1))
    return dashes or [points_m]


def rectangle(middle: FloatArray, along: FloatArray, length: float, depth: float) -> Polygon:
    """An upright or slanted rectangle; along: unit vector of its length."""
    across = np.array([-along[1], along[0]])
    half, deep = along * length / 2, across * depth / 2
    return Polygon([middle - half - deep, middle + half - deep, middle + half + deep,
                    middle - half + deep])  # fmt: skip
