"""What a surface is made of, before it has a colour: one seamless tile of grain, weave or veins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chord_usd.library.textures.fields import Ground, Raster


@dataclass(frozen=True, eq=False)
class Pattern:
    """One seamless tile, u (columns, to the right) along the grain; edges meet."""

    ground: Ground
    depth: Raster
    """(H, W) how much darker than its mean a point is, as a share; negative where lighter."""
    height_m: Raster
    """(H, W) relief in metres."""
    roughness: Raster
    """(H, W) as a factor of the finish's own, about 1."""
    tinted: float = 1.0
    """1 where what is dark is also more colourful, as of stained wood; 0 for plain shade."""
    warmth: Raster | None = None
    """(H, W) share by which a point is redder and less blue."""


def even(ground: Ground, value: float) -> Raster:
    """(H, W) one value everywhere."""
    return np.full(ground.shape, value, dtype=np.float32)


def centred(field: Raster, most: float = 3.0) -> Raster:
    """Mean 0; outliers beyond most deviations are cut, which would betray the repeat of a tile."""
    field = field - field.mean()
    limit = most * float(field.std())
    clipped: Raster = np.clip(field, -limit, limit)
    return clipped - clipped.mean()
