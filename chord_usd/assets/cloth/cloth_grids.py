"""Grids of points as sheets, thick sheets and bags."""

from __future__ import annotations

import numpy as np


def grid_faces(rows: int, columns: int) -> np.ndarray:
    """(T, 3) triangles of a grid of points; its front is where rows run down, columns right."""
    index = np.arange(rows * columns).reshape(rows, columns)
    a, b = index[:-1, :-1].ravel(), index[1:, :-1].ravel()
    c, d = index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    return np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)])
