"""What is written on a plan: names of rooms, their sizes, dimension chains."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import cv2
import numpy as np
import shapely
from PIL import Image, ImageDraw, ImageFont

from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import ByteArray, FloatArray, PixelFrame, Plan, Room, RoomKind
from chord_usd.base.scene.units import px_from_m
from chord_usd.workshop.data.drawn.page_styles import RGB, Style

_WORDS: dict[str, dict[RoomKind, str]] = {
    "en": {
        "living": "Living Room", "dining": "Dining Room", "bedroom": "Bedroom",
        "kitchen": "Kitchen", "bathroom": "Bathroom", "balcony": "Balcony", "corridor": "Hall",
        "study": "Study", "store": "Store",
    },
    "de": {
        "living": "Wohnzimmer", "dining": "Esszimmer", "bedroom": "Schlafzimmer",
        "kitchen": "Küche", "bathroom": "Bad", "balcony": "Balkon", "corridor": "Flur",
        "study": "Arbeitszimmer", "store": "Abstellraum",
    },
    "fr": {
        "living": "Séjour", "dining": "Salle à manger", "bedroom": "Chambre",
        "kitchen": "Cuisine", "bathroom": "Salle de bain", "balcony": "Balcon",
        "corridor": "Entrée", "study": "Bureau", "store": "Cellier",
    },
    "es": {
        "living": "Salón", "dining": "Comedor", "bedroom": "Dormitorio", "kitchen": "Cocina",
        "bathroom": "Baño", "balcony": "Terraza", "corridor": "Pasillo", "study": "Estudio",
        "store": "Trastero",
    },
    "pt": {
        "living": "Sala", "dining": "Sala de jantar", "bedroom": "Quarto", "kitchen": "Cozinha",
        "bathroom": "Banheiro", "balcony": "Varanda", "corridor": "Corredor",
        "study": "Escritório", "store": "Despensa",
    },
    "sv": {
        "living": "VARDAGSRUM", "dining": "MATPLATS", "bedroom": "SOVRUM", "kitchen": "KÖK",
        "bathroom": "BADRUM", "balcony": "BALKONG", "corridor": "HALL", "study": "ARBETSRUM",
        "store": "FÖRRÅD",
    },
    "fi": {
        "living": "Olohuone", "dining": "Ruokailu", "bedroom": "Makuuhuone",
        "kitchen": "Keittiö", "bathroom": "Kylpyhuone", "balcony": "Parveke",
        "corridor": "Eteinen", "study": "Työhuone", "store": "Varasto",
    },
}  # fmt: skip

_INCHES_PER_M = 39.37
_SMALLEST_LETTERS_PX = 8


def write_names(canvas: ByteArray, plan: Plan, frame: PixelFrame, style: Style) -> set[str]:
    """Write each room's name and size in its middle, one below the other.

    Returns the rooms whose names had place.
    """
    letters_px = max(9, round(style.letters_m / frame.m_per_px))
    named = set()
    for room in plan.rooms:
        lines = []
        if style.has_names and room.kind != "unknown":
            lines.append(_WORDS[style.language][room.kind])
        if (size := _size(room, style)) and room_polygon(room).area > 3.0:
            lines.append(size)
        x, y = px_from_m(middle_of(room), frame)
        low, high = room.polygon_m.min(axis=0), room.polygon_m.max(axis=0)
        wide, tall = ((high - low) / frame.m_per_px).tolist()
        needed = max((_width(line, letters_px) for line in lines), default=0.0)
        # A narrow room has its name along it, in smaller letters where that does not suffice.
        upright = needed > 0.9 * wide and tall > wide
        own_px = round(letters_px * min(1.0, 0.9 * (tall if upright else wide) / max(needed, 1.0)))
        if own_px < _SMALLEST_LETTERS_PX:
            continue
        if style.has_names and room.kind != "unknown":
            named.add(room.id)
        # Kept within the bounds of a room whose widest part lies at one end.
        bounds = px_from_m(np.array([low, high]), frame)
        axis, half = int(upright), min(needed * own_px / letters_px, wide if not upright else tall)
        least, most = sorted(bounds[:, axis].tolist())
        spot = np.array([x, y])
        spot[axis] = np.clip(spot[axis], least + 0.55 * half, max(most - 0.55 * half, least))
        x, y = spot.tolist()
        for index, line in enumerate(lines):
            offset = (index - (len(lines) - 1) / 2) * 1.3 * own_px
            place = (x + offset, y) if upright else (x, y + offset)
            write(canvas, line, place, own_px, style.line_rgb, upright=upright)
    return named


def _width(line: str, letters_px: int) -> float:
    return float(_font(letters_px).getlength(line))


def middle_of(room: Room) -> FloatArray:
    """The point of a room that lies deepest in it, metres; its name stands there."""
    return np.array(shapely.maximum_inscribed_circle(room_polygon(room)).coords[0])


def _size(room: Room, style: Style) -> str:
    low, high = room.polygon_m.min(axis=0), room.polygon_m.max(axis=0)
    width, depth = (high - low).tolist()
    if style.sizes == "area":
        return f"{room_polygon(room).area:.1f} m²"
    if style.sizes == "none" or room_polygon(room).area < 0.95 * width * depth:
        return ""
    if style.sizes == "metres":
        return f"{width:.2f} x {depth:.2f} m"
    if style.sizes == "centimetres":
        return f"{width * 100:.0f} x {depth * 100:.0f}"
    return " x ".join(_feet(side) for side in (width, depth))


def _feet(length_m: float) -> str:
    feet, inches = divmod(round(length_m * _INCHES_PER_M), 12)
    return f"{feet}'{inches}\""


def write(
    canvas: ByteArray, text: str, center: tuple[float, float], height_px: int, rgb: RGB,
    *, upright: bool = False,
) -> None:  # fmt: skip
    """Write a line of text centred on a point; upright lines read from below."""
    font = _font(height_px)
    left, top, right, bottom = (round(v) for v in font.getbbox(text))
    patch = Image.new("L", (right - left + 4, bottom - top + 4), 0)
    ImageDraw.Draw(patch).text((2 - left, 2 - top), text, fill=255, font=font)
    ink = np.asarray(patch.rotate(90, expand=True) if upright else patch, np.float64) / 255
    x, y = round(center[0] - ink.shape[1] / 2), round(center[1] - ink.shape[0] / 2)
    if x < 0 or y < 0 or x + ink.shape[1] > canvas.shape[1] or y + ink.shape[0] > canvas.shape[0]:
        return
    window = canvas[y : y + ink.shape[0], x : x + ink.shape[1]]
    window[:] = np.rint(window * (1 - ink[..., None]) + np.array(rgb) * ink[..., None])


@cache
def _font(height_px: int) -> ImageFont.FreeTypeFont:
    """The font that matplotlib carries; the machine may have none."""
    import matplotlib

    path = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans.ttf"
    return ImageFont.truetype(str(path), height_px)


def draw_dimensions(canvas: ByteArray, plan: Plan, frame: PixelFrame, style: Style) -> None:
    """A chain along the lower side with a length for each room there, one over all on the left."""
    corners = np.concatenate([room.polygon_m for room in plan.rooms])
    low, high = corners.min(axis=0), corners.max(axis=0)
    bottom = [r for r in plan.rooms if r.polygon_m[:, 1].min() < low[1] + 0.3]
    ends_m = [(r.polygon_m[:, 0].min(), r.polygon_m[:, 0].max()) for r in bottom]
    xs = sorted({round(float(x), 2) for pair in ends_m for x in pair})
    letters_px = max(9, round(0.8 * style.letters_m / frame.m_per_px))
    row = float(low[1]) - 0.9
    _chain(canvas, [px_from_m((x, row), frame) for x in xs], xs, letters_px, style)
    ends = [px_from_m((low[0] - 0.9, y), frame) for y in (low[1], high[1])]
    _chain(canvas, ends, [float(low[1]), float(high[1])], letters_px, style)


def _chain(
    canvas: ByteArray, points: list[FloatArray], places: list[float], letters_px: int, style: Style
) -> None:
    upright = bool(abs(points[-1][1] - points[0][1]) > abs(points[-1][0] - points[0][0]))
    ends = [(round(float(p[0])), round(float(p[1]))) for p in points]
    cv2.line(canvas, ends[0], ends[-1], style.line_rgb, 1, cv2.LINE_AA)
    for x, y in ends:
        cv2.line(canvas, (x - 5, y + 5), (x + 5, y - 5), style.line_rgb, 2, cv2.LINE_AA)
    for start, stop, here, other in zip(points, points[1:], places, places[1:], strict=False):
        length_m = abs(other - here)
        if length_m > 1.0:
            text = f"{length_m * 1000:.0f}"
            middle = (start + stop) / 2
            shift = (-0.9 * letters_px, 0.0) if upright else (0.0, -0.9 * letters_px)
            place = (float(middle[0]) + shift[0], float(middle[1]) + shift[1])
            write(canvas, text, place, letters_px, style.line_rgb, upright=upright)
