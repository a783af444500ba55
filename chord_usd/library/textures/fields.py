"""What looks and finishes are drawn on, in metres: noise, lookups, cells, shapes, normals.

Fields are (H, W) float32 arrays, row 0 at the top: one repeat of a surface, which wraps around.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

Raster = np.ndarray
"""(H, W) or (H, W, 3), single precision: twice as fast, and far finer than a map."""
Shape = tuple[int, int]
Rgb = tuple[int, int, int]
Points = Sequence[tuple[float, float]]


@dataclass(frozen=True)
class Ground:
    """The raster of one repeat."""

    px: int
    """Rows and columns."""
    tile_m: tuple[float, float]
    """Size of the repeat, along x and y."""

    @property
    def shape(self) -> Shape:
        """Rows and columns."""
        return self.px, self.px

    @property
    def px_m(self) -> float:
        """The longer side of a pixel."""
        return max(self.tile_m) / self.px

    @cached_property
    def x_m(self) -> Raster:
        """(W,) middles of the columns."""
        return ((np.arange(self.px) + 0.5) / self.px * self.tile_m[0]).astype(np.float32)

    @cached_property
    def y_m(self) -> Raster:
        """(H,) middles of the rows; y points up."""
        return ((self.px - 0.5 - np.arange(self.px)) / self.px * self.tile_m[1]).astype(np.float32)

    def turned(self) -> Ground:
        """The same with x and y exchanged."""
        return Ground(self.px, (self.tile_m[1], self.tile_m[0]))


def noise(
    rng: np.random.Generator,
    ground: Ground,
    slope: float = 1.5,
    *,
    longest_m: float = math.inf,
    shortest_m: float = 0.0,
    stretch: tuple[float, float] = (1.0, 1.0),
) -> Raster:
    """Gaussian noise whose amplitude falls as 1 / frequency ** slope; mean 0, deviation 1.

    longest_m, shortest_m: wavelengths between which it has any content. stretch: how much longer
    its features are along x and along y.
    """
    from scipy import fft

    side = ground.px
    most_x, most_y = (
        min(side // 2 - 1, math.ceil(tile / max(shortest_m * long, 1e-9)))
        for tile, long in zip(ground.tile_m, stretch, strict=True)
    )
    count_y = np.concatenate([np.arange(most_y + 1), np.arange(-most_y, 0)])
    across = (np.arange(most_x + 1) / ground.tile_m[0] * stretch[0]).astype(np.float32)
    up = (count_y / ground.tile_m[1] * stretch[1]).astype(np.float32)
    squared = (across * across)[None, :] + (up * up)[:, None]
    squared[0, 0] = 1.0
    gain = np.exp(np.float32(-slope / 2) * np.log(squared))
    gain[squared < 1.0 / longest_m**2] = 0.0
    gain[0, 0] = 0.0
    if shortest_m > 0.0:
        gain[squared > 1.0 / shortest_m**2] = 0.0
    waves = rng.standard_normal((*gain.shape, 2), dtype=np.float32).view(np.complex64)[..., 0]
    spectrum = np.zeros((side, side // 2 + 1), dtype=np.complex64)
    waves *= gain
    spectrum[: most_y + 1, : most_x + 1] = waves[: most_y + 1]
    spectrum[side - most_y :, : most_x + 1] = waves[most_y + 1 :]
    field: Raster = fft.irfft2(spectrum, s=ground.shape)
    field -= field.mean()
    field /= max(float(field.std()), 1e-12)
    return field


def looked_up(field: Raster, ground: Ground, x_m: Raster, y_m: Raster) -> Raster:
    """The field at other places, wrapping around; for warps and for boards' own grain."""
    side = ground.px
    column = _wrapped((x_m * np.float32(side / ground.tile_m[0])).astype(np.int32), side)
    row = _wrapped((y_m * np.float32(-side / ground.tile_m[1])).astype(np.int32), side)
    return field.reshape(-1).take(row * side + column)


def _wrapped(number: np.ndarray, side: int) -> np.ndarray:
    power_of_two = side & (side - 1) == 0
    return number & (side - 1) if power_of_two else number % side


def blurred(field: Raster, ground: Ground, radius_m: float) -> Raster:
    """Gaussian blur of this standard deviation."""
    from scipy import fft

    up, across = (
        np.exp(-2.0 * (math.pi * radius_m / tile * waves) ** 2).astype(np.float32)
        for tile, waves in zip(
            ground.tile_m[::-1],
            (np.fft.fftfreq(ground.px, 1 / ground.px), np.arange(ground.px // 2 + 1)),
            strict=True,
        )
    )
    waves = fft.rfft2(np.asarray(field, dtype=np.float32))
    waves *= up[:, None]
    waves *= across[None, :]
    soft: Raster = fft.irfft2(waves, s=ground.shape)
    return soft


def smoothstep(low: float, high: float, value: Raster) -> Raster:
    """0 below low, 1 above high, smooth between."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def grains(rng: np.random.Generator, ground: Ground, across: int) -> tuple[np.ndarray, Raster]:
    """Cells around across ** 2 points that are spread about evenly.

    (H, W) number of the cell, and distance to the cell's border in widths of a cell, up to about
    a half.
    """
    jitter = rng.uniform(0.08, 0.92, (2, across * across)).astype(np.float32)
    at = ((np.arange(ground.px) + 0.5) * across / ground.px).astype(np.float32)
    home = at.astype(np.int32)
    first, second = (np.full(ground.shape, 81.0, dtype=np.float32) for _ in range(2))
    number = np.zeros(ground.shape, dtype=np.int32)
    for down in (-1, 0, 1):
        y = home + down
        for right in (-1, 0, 1):
            x = home + right
            index = (y % across * across)[:, None] + (x % across)[None, :]
            rise = jitter[0].take(index)
            rise += (y - at)[:, None]
            away = jitter[1].take(index)
            away += (x - at)[None, :]
            away *= away
            away += rise * rise
            np.minimum(second, np.maximum(first, away), out=second)
            np.copyto(number, index, where=away < first, casting="same_kind")
            np.minimum(first, away, out=first)
    return number, (np.sqrt(second) - np.sqrt(first)) / 2


def normal_map(height_m: Raster, tile_m: tuple[float, float]) -> Raster:
    """(H, W, 3) normals in [0, 1] (OpenGL: green is up) of a height field in metres."""
    step_x = tile_m[0] / height_m.shape[1]
    step_y = tile_m[1] / height_m.shape[0]
    slope_x = (np.roll(height_m, -1, axis=1) - np.roll(height_m, 1, axis=1)) / (2 * step_x)
    # Rows run down, v runs up.
    slope_y = (np.roll(height_m, 1, axis=0) - np.roll(height_m, -1, axis=0)) / (2 * step_y)
    normal = np.stack([-slope_x, -slope_y, np.ones_like(slope_x)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return normal * 0.5 + 0.5


def stamped(
    ground: Ground, shapes: Iterable[tuple[Points, Rgb]], background: Rgb, times: int = 2
) -> Raster:
    """(H, W, 3) polygons over each other, in metres, with smooth edges; they wrap around."""
    from PIL import Image, ImageDraw

    side = ground.px * times
    image = Image.new("RGB", (side, side), background)
    pen = ImageDraw.Draw(image)
    scale_x, scale_y = side / ground.tile_m[0], side / ground.tile_m[1]
    for points, colour in shapes:
        xs, ys = [x * scale_x for x, _ in points], [-y * scale_y for _, y in points]
        for shift_x in _turns(xs, side):
            for shift_y in _turns(ys, side):
                moved = [(x - shift_x, y - shift_y) for x, y in zip(xs, ys, strict=True)]
                pen.polygon(moved, fill=colour)
    small = image.resize((ground.px, ground.px), Image.Resampling.BOX)
    return np.asarray(small, dtype=np.float32)


def _turns(places: Sequence[float], side: int) -> range:
    """By how much places between 0 and side are passed, in whole sides."""
    low, high = min(places), max(places)
    return range(math.floor(low / side) * side, math.floor(high / side) * side + 1, side)
