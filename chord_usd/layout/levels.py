"""The levels of the hierarchy, and what a network of each is made for.

Network, schedule, sampler and training loop are the same at every level (paper, section
"Multi-level scene graph"); only the picture that layouts are drawn over differs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from chord_usd import palette
from chord_usd.layout import condition, table_condition
from chord_usd.layout.config import LayoutConfig
from chord_usd.layout.measures import Condition
from chord_usd.types import ByteArray

Describe = Callable[[ByteArray, float, int], Condition]
"""Picture (H, W, 3), metres per pixel and pixels per grid cell to what the network sees."""


@dataclass(frozen=True)
class LevelTraits:
    """What sets one level apart."""

    level: palette.Level
    """Whose categories are painted."""
    class_count: int
    """Label 0 is the bare ground, label 1 + detector_class an item."""
    describe: Describe
    pixel_planes: int
    grid_planes: int
    ground_plane: int
    """Of the pixels: where items can be."""
    area_plane: int
    """Of the grid: log(1 + area in m²) / AREA_SCALE of the region a cell belongs to."""
    usual_area_m2: float
    """A region of this area weighs one per pixel in training."""
    weighed_area_m2: tuple[float, float]
    """Smaller and larger regions count as these."""


LEVELS: dict[str, LevelTraits] = {
    "house": LevelTraits(
        level=palette.Level.HOUSE,
        class_count=1 + len(palette.HOUSE_CATEGORIES),
        describe=condition.plan_condition,
        pixel_planes=condition.PIXEL_PLANES,
        grid_planes=condition.GRID_PLANES,
        ground_plane=condition.FLOOR_PLANE,
        area_plane=condition.AREA_PLANE,
        usual_area_m2=8.0,
        weighed_area_m2=(1.0, 40.0),
    ),
    "table": LevelTraits(
        level=palette.Level.TABLE,
        class_count=1 + len(palette.TABLE_CATEGORIES),
        describe=table_condition.table_condition,
        pixel_planes=table_condition.PIXEL_PLANES,
        grid_planes=table_condition.GRID_PLANES,
        ground_plane=table_condition.TOP_PLANE,
        area_plane=table_condition.AREA_PLANE,
        usual_area_m2=0.5,
        weighed_area_m2=(0.1, 2.0),
    ),
}


def traits_of(config: LayoutConfig) -> LevelTraits:
    """The traits of the level that a network is configured for."""
    return LEVELS[config.level]
