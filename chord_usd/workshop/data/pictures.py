"""Houses drawn side by side, to be looked at."""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from chord_usd.base.raster.canvas import draw_plan, layout_image
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.scene.types import CANVAS_PX, SceneGraph

GAP_PX = 4
_GAP_GREY = 120


def draw_sheet(scenes: Sequence[SceneGraph], path: Path) -> None:
    """Write a PNG with the layout raster of every scene, in rows. Raises OutputError."""
    columns = math.ceil(math.sqrt(len(scenes)))
    rows = math.ceil(len(scenes) / columns)
    step = CANVAS_PX + GAP_PX
    shape = (rows * step + GAP_PX, columns * step + GAP_PX, 3)
    sheet = np.full(shape, _GAP_GREY, np.uint8)
    for index, scene in enumerate(scenes):
        top, left = (GAP_PX + step * place for place in divmod(index, columns))
        layout = layout_image(draw_plan(scene.plan), scene.items)
        sheet[top : top + CANVAS_PX, left : left + CANVAS_PX] = layout.rgb
    buffer = io.BytesIO()
    Image.fromarray(sheet).save(buffer, "PNG")
    write_atomic(path, buffer.getvalue())
