"""What was read from a drawing, drawn over it: a user sees at a glance what went wrong.

Rooms carry the numbers by which `--rooms` corrects them, openings the short forms of their ids, and
what is doubted is red and listed below the drawing.
"""

from __future__ import annotations

import io
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from PIL import Image, ImageDraw

from chord_usd.base.errors import PlanError
from chord_usd.base.raster.lettering import text_size, write_text
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.scene import palette
from chord_usd.base.scene.drawn_pieces import drawn_items
from chord_usd.base.scene.geometry import footprint, room_polygon
from chord_usd.base.scene.palette import Rgb
from chord_usd.base.scene.types import ByteArray, FloatArray, Opening, PixelFrame, Plan, Room
from chord_usd.base.scene.units import px_from_m
from chord_usd.line.plan.picture import read_picture
from chord_usd.line.plan.placement import PAGE, WARNINGS, frame_of, straightening_of
from chord_usd.line.plan.sheet import straightened
from chord_usd.line.plan.vector import is_svg, is_vector
from chord_usd.line.plan.vector.backdrop import backdrop
from chord_usd.line.plan.vector.pdf import read_pages
from chord_usd.line.plan.vector.svg_page import read_page
from chord_usd.line.plan.verdict import SAID, VERDICT, doubted_by

_FADE = 0.6
"""How much the drawing fades towards white below what was read."""

_ROOM_RGB: Rgb = (190, 90, 10)
_PASSAGE_RGB: Rgb = (200, 60, 200)
_DOUBT_RGB: Rgb = (210, 20, 30)
_PAPER: Rgb = (255, 255, 255)
_SUBPIXEL_BITS = 4
_LETTERS_PER_SIDE = 70
_DRAWING_PX = 1600
_LETTER_PX = (11, 40)
"""Letters are so high at least and at most."""


def overlay(plan: Plan, rgb: ByteArray) -> ByteArray:
    """(H, W, 3) the drawing, faded, with rooms, doors, windows and passages outlined and numbered.

    rgb: the drawing that plan was read from. Raises PlanError for a plan not read from a picture.
    """
    frame = frame_of(plan)
    if frame is None:
        raise PlanError(
            "the plan was not read from a picture", expected="a plan that was read from a drawing"
        )
    canvas = (255 - (255 - rgb.astype(np.float32)) * (1.0 - _FADE)).astype(np.uint8)
    line_px = max(1, round(max(rgb.shape) / 600))
    for item in drawn_items(plan.extra):
        color = _darker(palette.category(item.category).rgb)
        corners = px_from_m(footprint(item.box), frame)
        front = (corners[1] + corners[2]) / 2
        _outline(canvas, corners, color, line_px)
        _outline(canvas, np.array([corners.mean(axis=0), front]), color, line_px)
    doubted = _doubted(plan)
    for room in plan.rooms:
        color = _DOUBT_RGB if room.id in doubted else _ROOM_RGB
        _outline(canvas, px_from_m(room.polygon_m, frame), color, line_px)
    for opening in plan.openings:
        color = _DOUBT_RGB if opening.id in doubted else _opening_rgb(opening)
        _outline(canvas, px_from_m(footprint(opening.box), frame), color, 2 * line_px)
    return _lettered(canvas, plan, frame, doubted)


def doubts_of(plan: Plan) -> list[str]:
    """The plan's verdict and warnings, with rooms as the overlay numbers them: "4 (living1)"."""
    numbers = {room.id: f"{number} ({room.id})" for number, room in enumerate(plan.rooms, 1)}
    warnings = map(str, plan.extra.get(WARNINGS, ()))
    doubts = [re.sub(r"\w+", lambda m: numbers.get(m[0], m[0]), doubt) for doubt in warnings]
    verdict = plan.extra.get(VERDICT)
    return (
        [SAID[verdict], *doubts] if verdict in SAID and (doubts or verdict != "right") else doubts
    )


def with_doubts(picture: ByteArray, doubts: Sequence[str]) -> ByteArray:
    """(H, W, 3) the picture with doubts listed below it; as it is where there are none."""
    if not doubts:
        return picture
    size_px = _letter_px(picture)
    width = picture.shape[1]
    lines = [line for doubt in doubts for line in _wrapped(f"! {doubt}", size_px, width - size_px)]
    strip = Image.new("RGB", (width, round((len(lines) + 1) * 1.25 * size_px)), _PAPER)
    text = "\n".join(lines)
    write_text(ImageDraw.Draw(strip), (size_px / 2, size_px / 2), text, size_px, _DOUBT_RGB, "la")
    return np.concatenate([picture, np.asarray(strip)])


def draw_overlay(plan: Plan, source: Path, target: Path) -> None:
    """Write the overlay of a plan, and its doubts, on the file it was read from.

    Raises ChordError.
    """
    buffer = io.BytesIO()
    picture = with_doubts(overlay_on(plan, source), doubts_of(plan))
    Image.fromarray(picture, "RGB").save(buffer, "PNG")
    write_atomic(target, buffer.getvalue())


def overlay_on(plan: Plan, source: Path) -> ByteArray:
    """(H, W, 3) the overlay on a picture, a page, or the shapes of a vector file."""
    return overlay(*drawing_of(plan, source))


def drawing_of(plan: Plan, source: Path) -> tuple[Plan, ByteArray]:
    """The plan that says where its drawing lies, and (H, W, 3) that drawing, upright.

    Raises ChordError.
    """
    if is_svg(source) and frame_of(plan) is not None:
        return plan, _upright(plan, read_page(source).rgb)
    if is_vector(source):
        rgb, entry = backdrop(source, plan)
        return replace(plan, extra={**plan.extra, **entry}), rgb
    if source.suffix.lower() == ".pdf":
        number = int(plan.extra.get(PAGE, 1))
        return plan, next(p.rgb for p in read_pages(source) if p.number == number)
    return plan, _upright(plan, read_picture(source).rgb)


def _upright(plan: Plan, rgb: ByteArray) -> ByteArray:
    """A picture as it was straightened before the plan was read from it."""
    done = straightening_of(plan)
    return straightened(rgb, done, rgb.shape) if done.entry() else rgb


def write_drawing(plan: Plan, source: Path, target: Path) -> PixelFrame | None:
    """Write the drawing to draw over, its longer side at most 1600 pixels; returns where it lies,
    None for a plan that was not read from a picture. Raises ChordError."""
    placed, rgb = drawing_of(plan, source)
    frame = frame_of(placed)
    picture = Image.fromarray(rgb, "RGB")
    share = min(_DRAWING_PX / max(picture.size), 1.0)
    if share < 1.0:
        sides = [max(round(side * share), 1) for side in picture.size]
        picture = picture.resize(sides, Image.Resampling.BOX)
    buffer = io.BytesIO()
    picture.save(buffer, "PNG")
    write_atomic(target, buffer.getvalue())
    if frame is None or share == 1.0:
        return frame
    return PixelFrame(frame.m_per_px / share, frame.origin_m, picture.height)


def _outline(canvas: ByteArray, corners_px: FloatArray, rgb: Rgb, line_px: int) -> None:
    # cv2 puts pixel centres at whole numbers.
    points = np.rint((corners_px - 0.5) * 2**_SUBPIXEL_BITS).astype(np.int32)
    cv2.polylines(canvas, [points], True, rgb, line_px, cv2.LINE_AA, _SUBPIXEL_BITS)


def _opening_rgb(opening: Opening) -> Rgb:
    return _PASSAGE_RGB if opening.kind == "passage" else palette.category(opening.kind).rgb


def _doubted(plan: Plan) -> set[str]:
    """Ids of rooms and openings that a doubt is about."""
    return {
        doubted for text in plan.extra.get(WARNINGS, ()) for doubted in doubted_by(plan, str(text))
    }


# Letters -----------------------------------------------------------------------------------------


def _lettered(canvas: ByteArray, plan: Plan, frame: PixelFrame, doubted: set[str]) -> ByteArray:
    picture = Image.fromarray(canvas, "RGB")
    draw = ImageDraw.Draw(picture)
    size_px = _letter_px(canvas)
    for opening in plan.openings:
        color = _DOUBT_RGB if opening.id in doubted else _darker(_opening_rgb(opening))
        x, y = px_from_m(np.array([opening.box.center_m[:2]]), frame)[0].tolist()
        small = max(round(0.75 * size_px), _LETTER_PX[0])
        write_text(draw, (x, y), _short(opening), small, color, "mm", _PAPER)
    for item in drawn_items(plan.extra):
        row = palette.category(item.category)
        x, y = px_from_m(np.array([item.box.center_m[:2]]), frame)[0].tolist()
        small = max(round(0.6 * size_px), _LETTER_PX[0])
        write_text(draw, (x, y), row.label.lower(), small, _darker(row.rgb), "mm", _PAPER)
    for number, room in enumerate(plan.rooms, 1):
        color = _DOUBT_RGB if room.id in doubted or room.kind == "unknown" else _ROOM_RGB
        inside = room_polygon(room).representative_point()
        x, y = px_from_m(np.array([[inside.x, inside.y]]), frame)[0].tolist()
        corners_px = px_from_m(room.polygon_m, frame)
        label = _label(number, room)
        fitting = _fitting(label, size_px, float(np.ptp(corners_px[:, 0])))
        write_text(draw, (x, y), label, fitting, color, "mm", _PAPER)
    return np.asarray(picture)


def _letter_px(canvas: ByteArray) -> int:
    return int(np.clip(max(canvas.shape) / _LETTERS_PER_SIDE, *_LETTER_PX))


def _label(number: int, room: Room) -> str:
    """The number, the kind, and what is printed there where that says something else."""
    kind = "not known" if room.kind == "unknown" else room.kind
    is_same = room.name.casefold() in ("", room.kind)
    return f"{number} {kind}" if is_same else f"{number} {kind}\n{room.name[:40]}"


def _short(opening: Opening) -> str:
    """ "door12" -> "d12"; other ids as they are."""
    match = re.fullmatch(rf"{opening.kind}(\d+)", opening.id)
    return f"{opening.kind[0]}{match[1]}" if match else opening.id[:12]


def _fitting(text: str, size_px: int, width_px: float) -> int:
    """The size at which a text is no wider than a room, if it can be read then."""
    share = width_px / max(text_size(text, size_px)[0], 1.0)
    return max(min(size_px, int(size_px * share)), _LETTER_PX[0])


def _wrapped(text: str, size_px: int, width_px: float) -> list[str]:
    """Lines no wider than a width, broken at blanks."""
    lines = [""]
    for word in text.split():
        longer = f"{lines[-1]} {word}".strip()
        if lines[-1] and text_size(longer, size_px)[0] > width_px:
            lines.append(f"  {word}")
        else:
            lines[-1] = longer
    return lines


def _darker(rgb: Rgb) -> Rgb:
    red, green, blue = (channel * 2 // 3 for channel in rgb)
    return red, green, blue
