"""Bubble diagrams to look at: what the network sketches for held-out houses."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from chord_usd.base.raster import plan_labels
from chord_usd.base.raster.bubbles import bubbles_of, with_bubbles
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.scene.palette import ROOM_RGB, ROOM_SHADES
from chord_usd.base.scene.types import ByteArray, PlanImage
from chord_usd.base.scene.wish import WISHED_KINDS, Wish
from chord_usd.line.planning.floor_sheet import on_sheet, sheet_for_area, shell_sheet
from chord_usd.line.planning.sketcher import Ground, Sketcher, open_ground
from chord_usd.workshop.evaluation.floors import FloorCase
from chord_usd.workshop.evaluation.report import framed, picture_png

SEEDS = 5


def draw_sketches(sketcher: Sketcher, cases: Sequence[FloorCase], path: Path) -> None:
    """Write a PNG: for each case a row of diagrams for its text, and one for its outer walls.

    First in a row is the house that the case was made from.
    """
    rows = []
    for case in cases:
        shell, ground = shell_sheet(case.shell)
        blank = sheet_for_area(case.wish.area_m2 or 0.0)
        middle = plan_labels.label_frame(case.plan, blank.frame.m_per_px)
        true = bubbles_of(case.plan)
        rows += [
            [
                with_bubbles(PlanImage(blank.rgb, middle), true),
                *_drawn(sketcher, case.wish, open_ground(), None),
            ],
            [with_bubbles(shell, true), *_drawn(sketcher, Wish(), ground, shell)],
        ]
    sheet = [np.hstack([framed(_coloured(image.rgb)) for image in row]) for row in rows]
    write_atomic(path, picture_png(np.vstack(sheet)))


def _drawn(
    sketcher: Sketcher, wish: Wish, ground: Ground, shell: PlanImage | None
) -> list[PlanImage]:
    drawn = []
    for sketch in sketcher.sketch(wish, ground, SEEDS, 0):
        sheet = shell or sheet_for_area(sketch.area_m2)
        drawn.append(with_bubbles(sheet, on_sheet(sheet, sketch.bubbles)))
    return drawn


def _coloured(rgb: ByteArray) -> ByteArray:
    """Shades of rooms, which a network can distinguish, in colours that people can distinguish."""
    coloured = rgb.copy()
    for kind in WISHED_KINDS:
        coloured[(rgb == ROOM_SHADES[kind]).all(axis=2)] = ROOM_RGB[kind]
    return coloured
