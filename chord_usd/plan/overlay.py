"""What was read from a drawing, drawn over it: a user sees at a glance what went wrong."""

from __future__ import annotations

import io
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np

from chord_usd import palette
from chord_usd.errors import PlanError
from chord_usd.geometry import footprint
from chord_usd.plan.picture import read_picture
from chord_usd.plan.placement import PAGE, frame_of, straightening_of
from chord_usd.plan.sheet import straightened
from chord_usd.plan.vector.backdrop import backdrop
from chord_usd.plan.vector.formats import is_vector
from chord_usd.plan.vector.pdf import read_pages
from chord_usd.runtime.files import write_atomic
from chord_usd.types import ByteArray, FloatArray, Plan
from chord_usd.units import px_from_m

_FADE = 0.6
"""How much the drawing fades towards white below what was read."""

_ROOM_RGB = (230, 120, 30)
_PASSAGE_RGB = (200, 60, 200)
_SUBPIXEL_BITS = 4


def overlay(plan: Plan, rgb: ByteArray) -> ByteArray:
    """(H, W, 3) the drawing, faded, with rooms, doors, windows and passages outlined.

    rgb: the drawing that plan was read from. Raises PlanError for a plan not read from a picture.
    """
    frame = frame_of(plan)
    if frame is None:
        raise PlanError(
            "the plan was not read from a picture", expected="a plan read by chord-usd plan read"
        )
    canvas = (255 - (255 - rgb.astype(np.float32)) * (1.0 - _FADE)).astype(np.uint8)
    line_px = max(1, round(max(rgb.shape) / 600))
    for room in plan.rooms:
        corners = px_from_m(room.polygon_m, frame)
        _outline(canvas, corners, _ROOM_RGB, line_px)
        name = room.id if room.kind == "unknown" else f"{room.id} {room.kind}"
        _write(canvas, name, corners, line_px)
    for opening in plan.openings:
        color = _PASSAGE_RGB
        if opening.kind != "passage":
            color = palette.category(opening.kind).rgb
        _outline(canvas, px_from_m(footprint(opening.box), frame), color, 2 * line_px)
    return canvas


def draw_overlay(plan: Plan, source: Path, target: Path) -> None:
    """Write the overlay of a plan on the file it was read from. Raises ChordError."""
    from PIL import Image

    buffer = io.BytesIO()
    picture = overlay_on(plan, source)
    Image.fromarray(picture, "RGB").save(buffer, "PNG")
    write_atomic(target, buffer.getvalue())


def overlay_on(plan: Plan, source: Path) -> ByteArray:
    """(H, W, 3) the overlay on a picture, a page, or the shapes of a vector file."""
    if is_vector(source):
        rgb, entry = backdrop(source, plan)
        return overlay(replace(plan, extra={**plan.extra, **entry}), rgb)
    if source.suffix.lower() == ".pdf":
        number = int(plan.extra.get(PAGE, 1))
        return overlay(plan, next(p.rgb for p in read_pages(source) if p.number == number))
    done = straightening_of(plan)
    rgb = read_picture(source).rgb
    return overlay(plan, straightened(rgb, done, rgb.shape) if done.entry() else rgb)


def _outline(
    canvas: ByteArray, corners_px: FloatArray, rgb: tuple[int, int, int], line_px: int
) -> None:
    # cv2 puts pixel centres at whole numbers.
    points = np.rint((corners_px - 0.5) * 2**_SUBPIXEL_BITS).astype(np.int32)
    cv2.polylines(canvas, [points], True, rgb, line_px, cv2.LINE_AA, _SUBPIXEL_BITS)


def _write(canvas: ByteArray, text: str, corners_px: FloatArray, line_px: int) -> None:
    x, y = ((corners_px.min(axis=0) + corners_px.max(axis=0)) / 2).tolist()
    scale = 0.4 * max(line_px, 1)
    (width, height), _ = cv2.getTextSize(text, cv2.FONT_HERSHEY_SIMPLEX, scale, line_px)
    place = round(x - width / 2), round(y + height / 2)
    cv2.putText(
        canvas, text, place, cv2.FONT_HERSHEY_SIMPLEX, scale, _ROOM_RGB, line_px, cv2.LINE_AA
    )
