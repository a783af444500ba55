"""Seamless fields for wall and floor looks: noise, cells, blur, normals. All wrap around.

Fields are (H, W) float64 arrays, row 0 at the top; one tile of the look, edges meeting.
"""

from __future__ import annotations

import numpy as np

from chord_usd.base.scene.types import FloatArray

Shape = tuple[int, int]


def spectral_noise(
    rng: np.random.Generator,
    shape: Shape,
    *,
    slope: float = 1.5,
    lowest: float = 1.0,
    highest: float = 1e9,
    stretch: tuple[float, float] = (1.0, 1.0),
) -> FloatArray:
    """Gaussian noise whose amplitude falls as 1 / frequency ** slope; mean 0, deviation 1.

    lowest, highest: cycles per tile between which it has any content. stretch: how much longer
    its features are along x and along y.
    """
    white = np.fft.rfft2(rng.standard_normal(shape))
    cycles_y = np.fft.fftfreq(shape[0], 1.0 / shape[0])[:, None] * stretch[1]
    cycles_x = np.fft.rfftfreq(shape[1], 1.0 / shape[1])[None, :] * stretch[0]
    cycles = np.hypot(cycles_x, cycles_y)
    passed = (cycles >= lowest) & (cycles <= highest)
    gain = np.where(passed, np.maximum(cycles, 1e-9) ** -slope, 0.0)
    field = np.fft.irfft2(white * gain, s=shape)
    field -= field.mean()
    return field / max(float(field.std()), 1e-12)


def blurred(field: FloatArray, radius_px: float) -> FloatArray:
    """Gaussian blur of this standard deviation, wrapping around."""
    freq_y = np.fft.fftfreq(field.shape[0])[:, None]
    freq_x = np.fft.rfftfreq(field.shape[1])[None, :]
    gain = np.exp(-2.0 * (np.pi * radius_px) ** 2 * (freq_x**2 + freq_y**2))
    return np.fft.irfft2(np.fft.rfft2(field) * gain, s=field.shape)


def shifted_samples(field: FloatArray, rows: FloatArray, columns: FloatArray) -> FloatArray:
    """The field looked up at other pixels, wrapping around; for warps and for boards' own grain."""
    height, width = field.shape
    return field[
        np.round(rows).astype(np.int64) % height, np.round(columns).astype(np.int64) % width
    ]


def pixel_grid(shape: Shape) -> tuple[FloatArray, FloatArray]:
    """Row and column number of each pixel, as floats."""
    rows, columns = np.indices(shape, dtype=np.float64)
    return rows, columns


def cells(rng: np.random.Generator, shape: Shape, count: int) -> tuple[np.ndarray, FloatArray]:
    """Voronoi cells of random seeds: (H, W) cell number, and distance to the cell's border in
    shares of the tile (half the difference of the distances to the two nearest seeds)."""
    from scipy.spatial import cKDTree

    seeds = rng.random((count, 2))
    rows, columns = pixel_grid(shape)
    points = np.stack([(rows + 0.5) / shape[0], (columns + 0.5) / shape[1]], axis=-1)
    near, index = cKDTree(seeds, boxsize=1.0).query(points.reshape(-1, 2), k=2)
    inside = (near[:, 1] - near[:, 0]) / 2
    return index[:, 0].reshape(shape), inside.reshape(shape)


def normal_map(height_m: FloatArray, tile_m: tuple[float, float]) -> FloatArray:
    """(H, W, 3) normals in [0, 1] (OpenGL: green is up) of a height field in metres."""
    step_x = tile_m[0] / height_m.shape[1]
    step_y = tile_m[1] / height_m.shape[0]
    slope_x = (np.roll(height_m, -1, axis=1) - np.roll(height_m, 1, axis=1)) / (2 * step_x)
    # Rows run down, v runs up.
    slope_y = (np.roll(height_m, 1, axis=0) - np.roll(height_m, -1, axis=0)) / (2 * step_y)
    normal = np.stack([-slope_x, -slope_y, np.ones_like(slope_x)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    return normal * 0.5 + 0.5
