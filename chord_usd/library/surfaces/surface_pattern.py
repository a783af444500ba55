"""What a surface is made of, before it has a colour: one seamless tile of grain, weave or veins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chord_usd.base.scene.types import FloatArray

TileM = tuple[float, float]


@dataclass(frozen=True, eq=False)
class Pattern:
    """One seamless tile, u (columns, to the right) along the grain; edges meet."""

    tile_m: TileM
    """Size along u and v."""
    depth: FloatArray
    """(H, W) how much darker than its mean a point is, as a share; negative where lighter."""
    height_m: FloatArray
    """(H, W) relief in metres."""
    roughness: FloatArray
    """(H, W) as a factor of the finish's own, about 1."""
    tinted: float = 1.0
    """1 where what is dark is also more colourful, as of stained wood; 0 for plain shade."""
    warmth: FloatArray | None = None
    """(H, W) share by which a point is redder and less blue."""


def grid_m(px: int, tile_m: TileM) -> tuple[FloatArray, FloatArray]:
    """u and v of the pixels' centres in metres, each (px, px); row 0 is at the top."""
    steps = (np.arange(px) + 0.5) / px
    u, v = np.meshgrid(steps * tile_m[0], (1.0 - steps) * tile_m[1])
    return u, v


def smoothstep(low: float, high: float, value: FloatArray) -> FloatArray:
    """0 below low, 1 above high, smooth between."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return share * share * (3.0 - 2.0 * share)


def centred(field: FloatArray, most: float = 3.0) -> FloatArray:
    """Mean 0; outliers beyond most deviations are cut, which would betray the repeat of a tile."""
    field = field - field.mean()
    limit = most * float(field.std())
    clipped: FloatArray = np.clip(field, -limit, limit)
    return clipped - clipped.mean()


def grains(rng: np.random.Generator, px: int, across: int) -> tuple[np.ndarray, FloatArray]:
    """Cells around across ** 2 seeds that lie about evenly: (px, px) number of the cell, and
    distance to the cell's border in widths of a cell, up to about a half. It wraps around."""
    jitter = rng.uniform(0.08, 0.92, (2, across, across))
    row, column = np.indices((px, px))
    at = [(one + 0.5) * across / px for one in (row, column)]
    home = [one.astype(np.int64) for one in at]
    first, second = np.full((px, px), 9.0), np.full((px, px), 9.0)
    number = np.zeros((px, px), dtype=np.int64)
    for down in (-1, 0, 1):
        for right in (-1, 0, 1):
            y, x = home[0] + down, home[1] + right
            index = (y % across) * across + x % across
            away = np.hypot(
                y + jitter[0].reshape(-1)[index] - at[0], x + jitter[1].reshape(-1)[index] - at[1]
            )
            second = np.minimum(second, np.maximum(first, away))
            number = np.where(away < first, index, number)
            first = np.minimum(first, away)
    return number, (second - first) / 2
