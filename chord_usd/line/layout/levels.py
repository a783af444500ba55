"""The levels of the hierarchy, and what a network of each is made for.

Network, schedule, sampler and training loop are the same at every level (paper, section
"Multi-level scene graph"); only the picture that layouts are drawn over differs.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from chord_usd.base.raster import plan_labels
from chord_usd.base.raster.canvas import paint_layout
from chord_usd.base.scene import palette
from chord_usd.base.scene.types import BASE_AND_HEIGHT_M, BoolArray, ByteArray, PlanImage
from chord_usd.line.layout import condition, floor_condition, table_condition
from chord_usd.line.layout.condition import Condition
from chord_usd.line.layout.config import LayoutConfig

Describe = Callable[[ByteArray, float, int], Condition]
"""Picture (H, W, 3), metres per pixel and pixels per grid cell to what the network sees."""

Paint = Callable[[PlanImage, ByteArray, BoolArray], ByteArray]
"""What is laid out over, labels (H, W) and front marks (H, W) to the picture (H, W, 3) of it."""


@dataclass(frozen=True)
class LevelTraits:
    """What sets one level apart."""

    class_count: int
    """Label 0 is the bare ground, label 1 + detector_class an item; at the level of floors labels
    come from plan_labels."""
    describe: Describe
    paint: Paint
    pixel_planes: int
    grid_planes: int
    ground_plane: int
    """Of the pixels: where items can be."""
    bare_plane: int | None = None
    """Of the pixels: ground where nothing stands."""
    low_plane: int | None = None
    """Of the pixels: ground where none of tall_labels stands."""
    tall_labels: tuple[int, ...] = ()
    area_plane: int | None = None
    """Of the grid: log(1 + area in m²) / AREA_SCALE of the region a cell belongs to; None where
    regions do not weigh by their area."""
    usual_area_m2: float = 1.0
    """A region of this area weighs one per pixel in training."""
    weighed_area_m2: tuple[float, float] = (1.0, 1.0)
    """Smaller and larger regions count as these."""
    front_amplitude: float = 1.0
    """Of the front mark's bit, in that of a code word's."""
    whole: bool = False
    """Whether the network looks at the whole canvas, and not at what is drawn on it."""


def _paint_table(image: PlanImage, labels: ByteArray, front: BoolArray) -> ByteArray:
    return paint_layout(image, labels, front, palette.Level.TABLE)


def _tall_labels() -> tuple[int, ...]:
    """Of categories whose lowest pieces reach above the sill of a window."""
    return tuple(
        1 + label
        for label, row in enumerate(palette.HOUSE_CATEGORIES)
        if row.mount is palette.Mount.FLOOR and row.height_m[0] > BASE_AND_HEIGHT_M["window"][0]
    )


def _paint_floors(_image: PlanImage, labels: ByteArray, _front: BoolArray) -> ByteArray:
    return plan_labels.paint_labels(labels)


LEVELS: dict[str, LevelTraits] = {
    "house": LevelTraits(
        class_count=1 + len(palette.HOUSE_CATEGORIES),
        describe=condition.plan_condition,
        paint=paint_layout,
        pixel_planes=condition.PIXEL_PLANES,
        grid_planes=condition.GRID_PLANES,
        ground_plane=condition.FLOOR_PLANE,
        bare_plane=condition.DOOR_FLOOR_PLANE,
        low_plane=condition.WINDOW_FLOOR_PLANE,
        tall_labels=_tall_labels(),
        area_plane=condition.AREA_PLANE,
        usual_area_m2=8.0,
        weighed_area_m2=(1.0, 40.0),
    ),
    "table": LevelTraits(
        class_count=1 + len(palette.TABLE_CATEGORIES),
        describe=table_condition.table_condition,
        paint=_paint_table,
        pixel_planes=table_condition.PIXEL_PLANES,
        grid_planes=table_condition.GRID_PLANES,
        ground_plane=table_condition.TOP_PLANE,
        area_plane=table_condition.AREA_PLANE,
        usual_area_m2=0.5,
        weighed_area_m2=(0.1, 2.0),
    ),
    "floor": LevelTraits(
        class_count=len(plan_labels.LABEL_NAMES),
        describe=floor_condition.floor_condition,
        paint=_paint_floors,
        pixel_planes=floor_condition.PIXEL_PLANES,
        grid_planes=floor_condition.GRID_PLANES,
        ground_plane=floor_condition.GROUND_PLANE,
        whole=True,
    ),
}


def traits_of(config: LayoutConfig) -> LevelTraits:
    """The traits of the level that a network is configured for, with its coding of the front."""
    return replace(LEVELS[config.level], front_amplitude=config.front_amplitude)
