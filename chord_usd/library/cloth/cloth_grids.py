"""Grids of points as sheets, thick sheets and bags."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chord_usd.base.scene.types import FloatArray

Made = tuple[FloatArray, np.ndarray, FloatArray]
"""Points, faces, cloth coordinates."""


def grid_faces(rows: int, columns: int) -> np.ndarray:
    """(T, 3) triangles of a grid of points; its front is where rows run down, columns right."""
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b = index[:-1, :-1].ravel(), index[1:, :-1].ravel()
    c, d = index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    return np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])


def bag(length_m: float, width_m: float, columns: int, rows: int, swell_m: float) -> Bag:
    """Two sheets of columns by rows cells sewn together at their edges, a little apart inside."""
    x = np.linspace(-length_m / 2, length_m / 2, columns + 1)
    y = np.linspace(-width_m / 2, width_m / 2, rows + 1)
    xx, yy = np.meshgrid(x, y)
    swell = swell_m * (1 - (2 * xx / length_m) ** 2) * (1 - (2 * yy / width_m) ** 2)
    index = np.arange(xx.size).reshape(xx.shape)
    inner = index[1:-1, 1:-1]
    below = index.copy()
    below[1:-1, 1:-1] = xx.size + np.arange(inner.size).reshape(inner.shape)
    top = np.stack([xx, yy, swell], axis=-1).reshape(-1, 3)
    bottom = np.stack([xx, yy, -swell], axis=-1)[1:-1, 1:-1].reshape(-1, 3)
    return Bag(np.concatenate([top, bottom]), index, below)


@dataclass(frozen=True, eq=False)
class Bag:
    """A closed pair of grids."""

    points_m: FloatArray
    """(N, 3), flat but for the swell: their x and y are the coordinates on the cloth."""
    top: np.ndarray
    """(rows + 1, columns + 1) indices of points; points of the edge are also the bottom's."""
    bottom: np.ndarray

    def faces(self) -> np.ndarray:
        """(T, 3) triangles."""
        return np.concatenate([_turned(self.top)[:, ::-1], _turned(self.bottom)])


def _turned(index: np.ndarray) -> np.ndarray:
    a, b = index[:-1, :-1].ravel(), index[1:, :-1].ravel()
    c, d = index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    # Diagonals run out of the corners: cut off, a corner of a bag would be a face twice.
    rows, columns = len(index) - 1, index.shape[1] - 1
    is_left, is_upper = np.arange(columns) < columns / 2, np.arange(rows) < rows / 2
    same_side = (is_upper[:, None] == is_left[None, :]).ravel()
    first = np.where(same_side[:, None], np.stack([a, b, c], -1), np.stack([a, b, d], -1))
    second = np.where(same_side[:, None], np.stack([a, c, d], -1), np.stack([b, c, d], -1))
    return np.concatenate([first, second])


def thickened(
    grid_m: FloatArray, thick_m: float, core_m: tuple[float, float, float] | None = None
) -> tuple[FloatArray, np.ndarray, np.ndarray]:
    """A thick cloth around a sheet (rows, columns, 3) seen from its upper side.

    Its rim is rolled in. An underside closes it; with core_m, a fan to this point, which lies
    within what carries the cloth. Returns points, faces, and for each point the index of the
    grid's point it belongs to.
    """
    rows, columns = grid_m.shape[:2]
    normals = grid_normals(grid_m)
    flat = grid_m.reshape(-1, 3) + 0.5 * thick_m * normals.reshape(-1, 3)
    edge = np.concatenate([
        np.arange(columns), columns * np.arange(1, rows) + columns - 1,
        columns * (rows - 1) + np.arange(columns - 2, -1, -1), columns * np.arange(rows - 2, 0, -1),
    ])  # fmt: skip
    out = _outward(grid_m.reshape(-1, 3), edge, normals.reshape(-1, 3))
    middle, up = grid_m.reshape(-1, 3)[edge], normals.reshape(-1, 3)[edge]
    half = thick_m / 2
    rolls = [
        middle + out * half * 0.75 + up * half * 0.6,
        middle + out * half - up * half * 0.1,
        middle + out * half * 0.5 - up * half * 0.9,
        middle - out * half * 1.2 - up * half * 0.9,
    ]
    inside = np.arange(rows * columns).reshape(rows, columns)[1:-1, 1:-1].ravel()
    if core_m is None:
        below, beneath = grid_m.reshape(-1, 3) - 0.9 * half * normals.reshape(-1, 3), inside
    else:
        below, beneath = np.tile(core_m, (rows * columns, 1)), edge[:1]
    points = np.concatenate([flat, *rolls, below[beneath]])
    owner = np.concatenate([np.arange(rows * columns), *[edge] * len(rolls), beneath])
    faces = [_turned(np.arange(rows * columns).reshape(rows, columns))]
    count, start = len(edge), rows * columns
    here, after = np.arange(count), (np.arange(count) + 1) % count
    inner = edge
    for level in range(len(rolls)):
        outer = start + level * count + np.arange(count)
        faces.append(np.stack([inner[here], outer[after], outer[here]], -1))
        faces.append(np.stack([inner[here], inner[after], outer[after]], -1))
        inner = outer
    if core_m is None:
        under = np.empty(rows * columns, dtype=np.int64)
        under[edge], under[inside] = inner, np.arange(len(points) - len(inside), len(points))
        faces.append(_turned(under.reshape(rows, columns))[:, ::-1])
    else:
        faces.append(np.stack([inner[here], inner[after], np.full(count, len(points) - 1)], -1))
    return points, np.concatenate(faces), owner


def grid_normals(grid_m: FloatArray) -> FloatArray:
    """(rows, columns, 3) unit normals; up where rows run to -y and columns to +x."""
    down, across = np.gradient(grid_m, axis=0), np.gradient(grid_m, axis=1)
    normals = np.cross(down, across)
    return normals / np.maximum(np.linalg.norm(normals, axis=-1, keepdims=True), 1e-12)


def _outward(points: FloatArray, edge: np.ndarray, normals: FloatArray) -> FloatArray:
    along = points[np.roll(edge, -1)] - points[np.roll(edge, 1)]
    out = np.cross(along, normals[edge])
    return -out / np.maximum(np.linalg.norm(out, axis=1, keepdims=True), 1e-12)


def smoothed(grid_m: FloatArray, rounds: int) -> FloatArray:
    """Each point of a grid drawn half-way to the mean of its neighbours, so many times."""
    grid = grid_m.copy()
    for _ in range(rounds):
        padded = np.pad(grid, ((1, 1), (1, 1), (0, 0)), mode="reflect", reflect_type="odd")
        mean = (padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:]) / 4
        grid = 0.5 * grid + 0.5 * mean
    return grid
