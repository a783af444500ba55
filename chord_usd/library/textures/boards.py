"""How boards and tiles are laid: which one a place belongs to, and where on it the place is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from chord_usd.library.textures.fields import Ground, Raster


@dataclass(frozen=True, eq=False)
class Boards:
    """A surface divided into boards or tiles. All arrays are (H, W)."""

    ground: Ground
    index: np.ndarray
    """Number of the board, from 0."""
    along_m: Raster
    """Place on the board along its length, from its end."""
    across_m: Raster
    edge_m: Raster
    """Distance to the board's nearest edge, the middle of the joint; below 0 where there is no
    board."""

    @property
    def count(self) -> int:
        """How many boards there are."""
        return int(self.index.max()) + 1

    def joint(self, width_m: float) -> Raster:
        """Share of each place, 0 to 1, that joints of this width cover."""
        px_m = self.ground.px_m
        covered = (np.float32(width_m / 2) - self.edge_m) / px_m + np.float32(0.5)
        # A joint that is finer than a pixel covers a share of it.
        return np.clip(covered, 0.0, 1.0) if width_m > px_m else _thin(self.edge_m, width_m, px_m)

    def each(self, values: Raster) -> Raster:
        """(H, W) or (H, W, n) one value of each board."""
        return values.astype(np.float32)[self.index]


def _thin(edge_m: Raster, width_m: float, px_m: float) -> Raster:
    return np.clip(1.0 - edge_m / px_m, 0.0, 1.0) * np.float32(min(1.0, width_m / px_m))


def running(
    ground: Ground,
    rows: int,
    per_row: int,
    *,
    offset: float | None = None,
    rng: np.random.Generator | None = None,
) -> Boards:
    """Rows of boards along x. offset: share of a board by which each row is shifted; None shifts
    at random and varies the lengths, as a floor layer does."""
    wide, tall = ground.tile_m
    index = np.empty((rows, ground.px), dtype=np.int32)
    along, end = (np.empty((rows, ground.px), dtype=np.float32) for _ in range(2))
    for row in range(rows):
        cuts = np.arange(per_row) / per_row
        if offset is None:
            assert rng is not None
            cuts = cuts + rng.uniform(-0.2, 0.2, per_row) / per_row + rng.random()
        else:
            cuts = cuts + offset * row / per_row
        cuts = np.sort(cuts % 1.0) * wide
        after = np.searchsorted(cuts, ground.x_m, side="right")
        first, last = (after - 1) % per_row, after % per_row
        index[row] = row * per_row + first
        along[row] = (ground.x_m - cuts[first]) % wide
        end[row] = np.minimum(along[row], (cuts[last] - ground.x_m) % wide)
    at = np.minimum((ground.y_m / tall * rows).astype(np.int32), rows - 1)
    across = (ground.y_m % np.float32(tall / rows))[:, None]
    edge = np.minimum(end[at], np.minimum(across, tall / rows - across))
    return Boards(
        ground, index[at], along[at], np.broadcast_to(across, ground.shape), edge.astype(np.float32)
    )


def upright(boards: Boards) -> Boards:
    """Boards that run along y, of boards that run along x on the turned ground."""
    ground = boards.ground.turned()
    # Rows of the one are columns of the other; both count from the bottom left.
    index, along, across, edge = (
        np.ascontiguousarray(field[::-1].T[::-1])
        for field in (boards.index, boards.along_m, boards.across_m, boards.edge_m)
    )
    return Boards(ground, index, along, across, edge)


def herringbone_tile_m(width_m: float, ratio: int, times: tuple[int, int]) -> tuple[float, float]:
    """The repeat of a herringbone whose zigzag runs along y."""
    return math.sqrt(2.0) * ratio * width_m * times[0], math.sqrt(2.0) * width_m * times[1]


def herringbone(ground: Ground, width_m: float, ratio: int) -> Boards:
    """Blocks ratio times as long as wide, at 45 degrees; the ground is a herringbone_tile_m."""
    step = np.float32(1.0 / (math.sqrt(2.0) * width_m))
    x, y = ground.x_m[None, :] * step, ground.y_m[:, None] * step
    u, v = x + y, y - x
    i, j = np.floor(u).astype(np.int32), np.floor(v).astype(np.int32)
    phase = (i - j) % (2 * ratio)
    standing = phase >= ratio
    place = np.where(standing, 2 * ratio - 1 - phase, phase)
    first_i, first_j = np.where(standing, i, i - place), np.where(standing, j - place, j)
    sums = round(2 * ground.tile_m[1] * step)
    differences = round(2 * ground.tile_m[0] * step)
    key = ((first_i + first_j) % sums) * differences + (first_i - first_j) % differences
    along = np.where(standing, v - j, u - i) + place
    across = np.where(standing, u - i, v - j)
    edge = np.minimum(np.minimum(along, ratio - along), np.minimum(across, 1 - across))
    width = np.float32(width_m)
    return Boards(
        ground, _numbered(key * 2 + standing), along * width, across * width, edge * width
    )


def chevron(ground: Ground, columns: int, rows: int, angle_deg: float) -> Boards:
    """Boards cut to points, in an even number of columns; rows: boards in a column."""
    wide, pitch = ground.tile_m[0] / columns, ground.tile_m[1] / rows
    lean, cosine = math.tan(math.radians(angle_deg)), math.cos(math.radians(angle_deg))
    column = np.minimum((ground.x_m / wide).astype(np.int32), columns - 1)
    local = ground.x_m - column * np.float32(wide)
    local = np.where(column % 2 == 0, local, wide - local).astype(np.float32)[None, :]
    height = (ground.y_m[:, None] - local * np.float32(lean)) / np.float32(pitch)
    row = np.floor(height)
    across = (height - row) * np.float32(pitch * cosine)
    index = (row.astype(np.int32) % rows) * columns + column[None, :]
    side = np.minimum(local, np.float32(wide) - local)
    edge = np.minimum(np.minimum(across, np.float32(pitch * cosine) - across), side)
    along = np.broadcast_to(local / np.float32(cosine), ground.shape)
    return Boards(ground, index, along, across, edge.astype(np.float32))


def basket(ground: Ground, blocks: int, strips: int) -> Boards:
    """Squares of strips that lie and stand in turn; blocks: an even number along each side."""
    block = ground.tile_m[0] / blocks
    x, y = (ground.x_m / block)[None, :], (ground.y_m / block)[:, None]
    i = np.minimum(x.astype(np.int32), blocks - 1)
    j = np.minimum(y.astype(np.int32), blocks - 1)
    stands = (i + j) % 2 == 1
    along = np.where(stands, y - j, x - i)
    across = np.where(stands, x - i, y - j) * strips
    strip = np.minimum(across.astype(np.int32), strips - 1)
    across = across - strip
    width = np.float32(block / strips)
    index = (j * blocks + i) * strips + strip
    along_m, across_m = along * np.float32(block), across * width
    edge = np.minimum(
        np.minimum(along_m, np.float32(block) - along_m), np.minimum(across_m, width - across_m)
    )
    return Boards(ground, index, along_m, across_m, edge)


def hexagons(ground: Ground, columns: int, rows: int, *, round_: bool = False) -> Boards:
    """Six-cornered tiles, points up, or round ones in their places; rows: an even number."""
    wide, pitch = ground.tile_m[0] / columns, ground.tile_m[1] / rows
    x, y = ground.x_m[None, :], ground.y_m[:, None]
    nearest: tuple[Raster, ...] | None = None
    for start in (0, 1):  # the rows 0, 2, 4, ..., then the rows 1, 3, 5, ...
        j = np.round((y / pitch - start) / 2) * 2 + start
        i = np.round(x / wide - start / 2)
        dx, dy = x - (i + start / 2) * wide, y - j * pitch
        candidate = (dx * dx + dy * dy, dx, dy, (j % rows) * columns + i % columns)
        if nearest is None:
            nearest = tuple(np.broadcast_to(part, ground.shape) for part in candidate)
        else:
            closer = candidate[0] < nearest[0]
            nearest = tuple(np.where(closer, a, b) for a, b in zip(candidate, nearest, strict=True))
    assert nearest is not None
    square, dx, dy, index = nearest
    if round_:
        edge = wide / 2 - np.sqrt(square)
    else:
        slanted = np.abs(dx) / 2 + np.abs(dy) * (math.sqrt(3.0) / 2)
        edge = wide / 2 - np.maximum(np.abs(dx), slanted)
    place = np.float32(wide / 2)
    return Boards(
        ground, index.astype(np.int32), (dx + place).astype(np.float32),
        (dy + place).astype(np.float32), edge.astype(np.float32),
    )  # fmt: skip


def _numbered(key: np.ndarray) -> np.ndarray:
    """The keys as numbers from 0 without gaps."""
    used = np.zeros(int(key.max()) + 1, dtype=bool)
    used[key.reshape(-1)] = True
    return (np.cumsum(used, dtype=np.int32) - 1)[key]


def years(
    rng: np.random.Generator, boards: Boards, along_m: Raster, wander: Raster, *,
    heart_m: np.ndarray, deep_m: np.ndarray, ring_m: float, period_m: float, waves: int,
    uneven: float = 0.0,
) -> Raster:  # fmt: skip
    """(H, W) age of the wood within its year, 0 to 1: a cut through rings around a tree's heart.

    Where the cut comes near the heart, the rings are open as flames, beside that they are lines.

    along_m, wander: (H, W) place along the tree, which repeats after period_m, and waver of the
    rings. heart_m, deep_m: of each board, where the heart of its tree is across the board and how
    deep below the cut. waves: how often the cut comes near the heart in a period. uneven: by how
    many years rings are wider or narrower than ring_m.
    """
    turn = along_m * np.float32(2.0 * np.pi / period_m)
    turn = turn + boards.each(rng.uniform(0.0, 6.28, boards.count))
    aside = boards.across_m - boards.each(heart_m) + 0.012 * np.sin(turn)
    rise = boards.each(deep_m) * (1.1 + 0.8 * np.sin(float(waves) * turn + 1.0))
    radius = np.sqrt(aside * aside + rise * rise) + 0.0045 * wander
    age = radius / np.float32(ring_m) + boards.each(rng.uniform(0.0, 1.0, boards.count))
    if uneven:
        age += uneven * np.sin(71.0 * radius)
    return age - np.floor(age)
