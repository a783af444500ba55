"""What validators ask of a mesh: points that differ, and faces that meet along edges only."""

from __future__ import annotations

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components


def points_differ(points_m: np.ndarray) -> bool:
    """Whether no two of (N, 3) points are one in single precision, in which they are written."""
    written = points_m.astype(np.float32)
    return len(np.unique(written, axis=0)) == len(written)


def is_manifold(faces: np.ndarray) -> bool:
    """Whether an edge of (T, 3) triangles has two faces at most, and those at a point are joined
    by edges."""
    ahead = np.roll(faces, -1, axis=1)
    ends = np.sort(np.stack([faces, ahead], axis=-1).reshape(-1, 2), axis=1)
    _, edge, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
    if count.max() > 2:
        return False
    order = np.argsort(edge.reshape(-1), kind="stable")
    first = (np.cumsum(count) - count)[count == 2]
    one, other = order[first], order[first + 1]
    corners = np.arange(faces.size).reshape(faces.shape)
    links = []
    for end in (0, 1):
        point = ends[one, end][:, None]
        links.append([corners[side // 3][faces[side // 3] == point] for side in (one, other)])
    rows, columns = np.concatenate(links, axis=1)
    joined = coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(faces.size, faces.size))
    _, fan = connected_components(joined, directed=False)
    return len(np.unique(np.stack([faces.reshape(-1), fan]), axis=1).T) == len(np.unique(faces))
