"""The sheets that floors are planned on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from chord_usd.base.raster import plan_labels
from chord_usd.base.raster.bubbles import Bubble, touching_pairs
from chord_usd.base.scene.palette import BACKGROUND_RGB
from chord_usd.base.scene.types import BoolArray, ByteArray, PixelFrame, Plan, PlanImage
from chord_usd.base.scene.units import px_from_m
from chord_usd.line.planning.outline import shell_labels
from chord_usd.line.planning.sketch_tokens import PLACES, place_m, shell_cells, shell_patches
from chord_usd.line.planning.sketcher import Ground


def blank_sheet(frame: PixelFrame) -> PlanImage:
    """A sheet with nothing on it."""
    rgb: ByteArray = np.full((frame.height_px, frame.height_px, 3), BACKGROUND_RGB, np.uint8)
    return PlanImage(rgb, frame)


def sheet_for_area(area_m2: float) -> PlanImage:
    """A blank sheet of the scale that so much floor is planned at; its middle is the origin."""
    return blank_sheet(plan_labels.sheet_frame(plan_labels.scale_for_area(area_m2)))


def shell_sheet(shell: Plan) -> tuple[PlanImage, Ground]:
    """An open plan, drawn in the middle of a sheet, and as the sketching network sees it."""
    labels, frame = shell_labels(shell)
    patches = shell_patches(shell_cells(labels, frame.m_per_px))
    sheet = PlanImage(plan_labels.paint_labels(labels), frame)
    return sheet, Ground(patches, _free_at(labels, frame.m_per_px))


def _free_at(labels: ByteArray, m_per_px: float) -> BoolArray:
    """(PLACES, PLACES) by x and y: where an open plan has floor."""
    pixels = np.floor(place_m(np.arange(PLACES)) / m_per_px + len(labels) / 2).astype(int)
    on_it = (pixels >= 0) & (pixels < len(labels))
    column = pixels.clip(0, len(labels) - 1)
    row = len(labels) - 1 - column
    floor = labels == plan_labels.label_of("unknown")
    return np.asarray(floor[row[None], column[:, None]] & on_it[:, None] & on_it[None])


def on_sheet(sheet: PlanImage, bubbles: Sequence[Bubble]) -> tuple[Bubble, ...]:
    """Bubbles in metres from the middle of a sheet, where they lie in the world."""
    half_m = plan_labels.CANVAS_PX * sheet.frame.m_per_px / 2
    x_m, y_m = (origin + half_m for origin in sheet.frame.origin_m)
    return tuple(replace(bubble, x_m=bubble.x_m + x_m, y_m=bubble.y_m + y_m) for bubble in bubbles)


def slips(sheet: PlanImage, bubbles: Sequence[Bubble]) -> int:
    """How many bubbles touch others, or lie where no room can be: beside the open plan."""
    drawn = (sheet.rgb != BACKGROUND_RGB[0]).any(axis=2)
    ground = plan_labels.fill_shell(drawn) if drawn.any() else np.ones_like(drawn)
    points = px_from_m(np.array([[bubble.x_m, bubble.y_m] for bubble in bubbles]), sheet.frame)
    columns, rows = np.floor(points).astype(int).T
    within = (rows >= 0) & (rows < ground.shape[0]) & (columns >= 0) & (columns < ground.shape[1])
    free = (ground & ~drawn)[rows.clip(0, len(ground) - 1), columns.clip(0, len(ground) - 1)]
    return touching_pairs(bubbles) + int((~(within & free)).sum())
