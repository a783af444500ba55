"""A labelled picture of a scene graph from above, drawn in a blink, without Blender."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from PIL import Image, ImageDraw
from shapely.geometry import Polygon
from shapely.geometry.base import BaseGeometry

from chord_usd.base.raster.lettering import text_size, write_text
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    free_spot,
    polygons_of,
    room_polygon,
    to_world,
    wall_area,
)
from chord_usd.base.scene.palette import CATEGORIES, Rgb
from chord_usd.base.scene.types import (
    Box,
    FloatArray,
    Item,
    Opening,
    PixelFrame,
    RoomKind,
    SceneGraph,
)
from chord_usd.base.scene.units import px_from_m
from chord_usd.line.image.preview_marks import Mark, with_marks

PICTURE_PX = 1200
"""Longer side of the picture."""

MARGIN_PX = 36
LEGEND_PX = 220
"""Width of the column that explains the numbers of items too small for their name."""

SUPERSAMPLE = 3
"""Shapes are drawn this many times larger and averaged down."""

FONT_PX = (17, 15, 13, 11)
"""Sizes tried for a label, largest first; a name that fits at none becomes a number."""

PAPER: Rgb = (255, 255, 255)
INK: Rgb = (38, 42, 48)
WALL: Rgb = (70, 74, 82)
GLASS: Rgb = (150, 200, 235)
LEAF: Rgb = (150, 105, 65)

ROOM_TINTS: dict[RoomKind, Rgb] = {
    "living": (250, 243, 228),
    "dining": (250, 236, 222),
    "bedroom": (232, 239, 250),
    "kitchen": (250, 228, 226),
    "bathroom": (222, 243, 244),
    "balcony": (230, 243, 226),
    "corridor": (240, 240, 238),
    "study": (238, 232, 248),
    "store": (236, 233, 226),
    "unknown": (244, 244, 244),
    "washroom": (219, 233, 240),
    "wc": (214, 240, 232),
}


def draw_preview(graph: SceneGraph, path: Path) -> None:
    """Write a PNG of the house from above: rooms, walls, openings, items and their fronts.

    North (+y) is up. An item too small for its name carries a number, explained at the side.
    Raises OutputError when the file cannot be written.
    """
    draw_storeys([graph], path)


def draw_storeys(
    graphs: Sequence[SceneGraph], path: Path, marks: Sequence[Sequence[Mark]] = ()
) -> None:
    """Write a PNG of storeys side by side, the first to the left. Raises as draw_preview.

    marks: of each storey, drawn on it and written beside it.
    """
    png = io.BytesIO()
    Image.fromarray(storeys_rgb(graphs, marks)).save(png, format="PNG")
    write_atomic(path, png.getvalue())


def storeys_rgb(graphs: Sequence[SceneGraph], marks: Sequence[Sequence[Mark]] = ()) -> np.ndarray:
    """The picture that draw_storeys writes: (H, W, 3) uint8."""
    marked = marks or [()] * len(graphs)
    pictures = [
        preview_rgb(graph, graph_marks) for graph, graph_marks in zip(graphs, marked, strict=True)
    ]
    height = max(picture.shape[0] for picture in pictures)
    sheet = np.full(
        (height, sum(picture.shape[1] for picture in pictures), 3), PAPER, dtype=np.uint8
    )
    left = 0
    for picture in pictures:
        sheet[: picture.shape[0], left : left + picture.shape[1]] = picture
        left += picture.shape[1]
    return sheet


def preview_rgb(graph: SceneGraph, marks: Sequence[Mark] = ()) -> np.ndarray:
    """The picture that draw_preview writes: (H, W, 3) uint8, the longer side PICTURE_PX without the
    column of marks."""
    sheet = Sheet.around(graph)
    _draw_shell(sheet, graph)
    drawn = [(item, _draw_dressing) for item in graph.dressing]
    drawn += [(item, _draw_item) for item in graph.items]
    # Of what is equally high the dressing comes first: rugs lie under furniture.
    for item, paint in sorted(drawn, key=lambda pair: pair[0].box.center_m[2]):
        paint(sheet, item)
    picture = sheet.finished()
    draw = ImageDraw.Draw(picture)
    _label_items(sheet, draw, graph.items)
    _label_rooms(sheet, draw, graph)
    _draw_scale(sheet, draw)
    return with_marks(np.asarray(picture), sheet.frame, marks)


# --- the sheet ----------------------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Sheet:
    """A canvas with a place in the world. Shapes take metres."""

    rgb: np.ndarray
    """(H, W, 3) uint8, SUPERSAMPLE times the finished picture."""
    frame: PixelFrame
    """Of the finished picture."""

    @classmethod
    def around(cls, graph: SceneGraph) -> Sheet:
        """An empty sheet that holds the house, its margin and the legend."""
        low_m, high_m = _bounds(graph)
        extent_m = high_m - low_m
        room_px = PICTURE_PX - 2 * MARGIN_PX
        m_per_px = max(extent_m[0] / (room_px - LEGEND_PX), extent_m[1] / room_px)
        width_px = round(extent_m[0] / m_per_px) + 2 * MARGIN_PX + LEGEND_PX
        height_px = round(extent_m[1] / m_per_px) + 2 * MARGIN_PX
        origin_m = low_m - MARGIN_PX * m_per_px
        shape = (height_px * SUPERSAMPLE, width_px * SUPERSAMPLE, 3)
        return cls(
            rgb=np.full(shape, PAPER, dtype=np.uint8),
            frame=PixelFrame(m_per_px, (float(origin_m[0]), float(origin_m[1])), height_px),
        )

    def fill(self, area: BaseGeometry, rgb: Rgb, opacity: float = 1.0) -> None:
        """Paint an area given in metres."""
        rings = [
            self._fixed_point(np.array(ring.coords))
            for polygon in polygons_of(area)
            for ring in (polygon.exterior, *polygon.interiors)
        ]
        if not rings:
            return
        if opacity == 1.0:
            cv2.fillPoly(self.rgb, rings, rgb, cv2.LINE_AA, _SHIFT)
            return
        # Blending the whole sheet for each small box would take a second per house.
        corners = np.concatenate(rings) >> _SHIFT
        x_px, y_px = np.maximum(corners.min(axis=0) - 2, 0)
        x_end_px, y_end_px = corners.max(axis=0) + 3
        window = self.rgb[y_px:y_end_px, x_px:x_end_px]
        painted = window.copy()
        shift = np.array([x_px, y_px], dtype=np.int32) << _SHIFT
        cv2.fillPoly(painted, [ring - shift for ring in rings], rgb, cv2.LINE_AA, _SHIFT)
        window[:] = cv2.addWeighted(painted, opacity, window, 1.0 - opacity, 0.0)

    def line(self, points_m: FloatArray, rgb: Rgb, width_px: float, closed: bool = False) -> None:
        """Draw a line through points (N, 2) in metres; width in pixels of the finished picture."""
        thickness = max(1, round(width_px * SUPERSAMPLE))
        points = [self._fixed_point(points_m)]
        cv2.polylines(self.rgb, points, closed, rgb, thickness, cv2.LINE_AA, _SHIFT)

    def finished(self) -> Image.Image:
        """The picture at its final size."""
        height_px, width_px = self.rgb.shape[0] // SUPERSAMPLE, self.rgb.shape[1] // SUPERSAMPLE
        small = cv2.resize(self.rgb, (width_px, height_px), interpolation=cv2.INTER_AREA)
        return Image.fromarray(small)

    def px(self, points_m: FloatArray) -> FloatArray:
        """Where points in metres lie in the finished picture."""
        return px_from_m(points_m, self.frame)

    def _fixed_point(self, points_m: FloatArray) -> np.ndarray:
        # OpenCV puts whole numbers at the centres of pixels, hence the half.
        points_px = self.px(points_m) * SUPERSAMPLE - 0.5
        return np.round(points_px * 2**_SHIFT).astype(np.int32)


_SHIFT = 4
"""Fractional bits of the coordinates handed to OpenCV."""


def _bounds(graph: SceneGraph) -> tuple[FloatArray, FloatArray]:
    corners = [room.polygon_m for room in graph.rooms]
    corners += [footprint(item.box) for item in graph.items]
    if not corners:
        return np.zeros(2), np.ones(2)
    points_m = np.concatenate(corners)
    walls_m = 0.3
    return points_m.min(axis=0) - walls_m, points_m.max(axis=0) + walls_m


# --- shapes -------------------------------------------------------------------------------------


def _draw_shell(sheet: Sheet, graph: SceneGraph) -> None:
    if graph.rooms:
        sheet.fill(wall_area(graph.rooms), WALL)
    for room in graph.rooms:
        sheet.fill(room_polygon(room), ROOM_TINTS[room.kind])
    for opening in graph.openings:
        _draw_opening(sheet, opening)


def _draw_opening(sheet: Sheet, opening: Opening) -> None:
    sheet.fill(footprint_polygon(opening.box), PAPER)
    length_m, width_m, _ = opening.box.size_m
    half_m, face_m = length_m / 2, width_m / 2
    if opening.kind == "window":
        sheet.fill(footprint_polygon(opening.box), GLASS, 0.5)
        for y_m in (-face_m, 0.0, face_m):
            sheet.line(to_world(opening.box, [(-half_m, y_m), (half_m, y_m)]), WALL, 1.2)
    if opening.kind == "door":
        # The plan does not say which way a door opens: a closed leaf claims nothing.
        sheet.line(to_world(opening.box, [(-half_m, 0.0), (half_m, 0.0)]), LEAF, 4.0)
    for x_m in (-half_m, half_m):
        sheet.line(to_world(opening.box, [(x_m, -face_m), (x_m, face_m)]), WALL, 1.2)


def _draw_item(sheet: Sheet, item: Item) -> None:
    rgb = _color(item)
    edge = _darker(rgb)
    sheet.fill(footprint_polygon(item.box), rgb, 0.55)
    sheet.line(footprint(item.box), edge, 1.6, closed=True)
    _draw_front(sheet, item.box, edge)
    for child in item.children:
        corners_m = to_world(item.box, footprint(child.box))
        sheet.line(corners_m, edge, 1.0, closed=True)


def _draw_dressing(sheet: Sheet, item: Item) -> None:
    """Lightly and without a name: it is much, small, and above or below the furniture."""
    rgb = _color(item)
    sheet.fill(footprint_polygon(item.box), rgb, 0.25)
    sheet.line(footprint(item.box), _darker(rgb), 0.6, closed=True)


def _draw_front(sheet: Sheet, box: Box, rgb: Rgb) -> None:
    """A triangle inside the front edge, pointing out."""
    length_m, width_m, _ = box.size_m
    tip_m = -width_m / 2
    reach_m = min(0.14, 0.3 * width_m, 0.3 * length_m)
    corners = [(-reach_m, tip_m + reach_m), (0.0, tip_m), (reach_m, tip_m + reach_m)]
    triangle_m = to_world(box, corners)
    sheet.fill(Polygon(triangle_m), rgb)


def _darker(rgb: Rgb) -> Rgb:
    red, green, blue = (round(channel * 0.55) for channel in rgb)
    return red, green, blue


def _color(item: Item) -> Rgb:
    row = CATEGORIES.get(item.category)
    return row.rgb if row is not None else (160, 160, 160)


# --- words --------------------------------------------------------------------------------------


def _label_items(sheet: Sheet, draw: ImageDraw.ImageDraw, items: Iterable[Item]) -> None:
    """Each item's name in its box, or a number there and the name in the legend."""
    numbers: dict[str, int] = {}
    for item in items:
        row = CATEGORIES.get(item.category)
        label = row.label if row is not None else item.category
        corners_px = sheet.px(footprint(item.box))
        space_px = corners_px.max(axis=0) - corners_px.min(axis=0)
        center_px = corners_px.mean(axis=0)
        fitted = _fit(label, space_px)
        if fitted is None:
            number = numbers.setdefault(label, len(numbers) + 1)
            fitted = (str(number), FONT_PX[-1])
        _write(draw, center_px, *fitted)
    x_px = draw.im.size[0] - LEGEND_PX + 8
    for row_index, (label, number) in enumerate(numbers.items()):
        y_px = MARGIN_PX + 22 * row_index
        write_text(draw, (x_px, y_px), f"{number}  {label}", 14, INK, "la")


def _fit(label: str, space_px: FloatArray) -> tuple[str, int] | None:
    """The label, broken into lines where needed, and the largest size that fits the space."""
    for size_px in FONT_PX:
        for text in (label, label.replace(" ", "\n")):
            width_px, height_px = text_size(text, size_px)
            if width_px <= space_px[0] - 6 and height_px <= space_px[1] - 4:
                return text, size_px
    return None


def _label_rooms(sheet: Sheet, draw: ImageDraw.ImageDraw, graph: SceneGraph) -> None:
    """Kind and floor area, where the room is widest and free of furniture."""
    for room in graph.rooms:
        area_m2 = room_polygon(room).area
        name = room.name or room.kind.capitalize()
        text = f"{name}\n{area_m2:.1f} sq m"
        half_px = text_size(text, 16)[0] / 2 + 4
        pieces = [footprint_polygon(item.box) for item in graph.items_of(room.id)]
        x_px, y_px = sheet.px(np.array(free_spot(room_polygon(room), pieces)))
        corners_px = sheet.px(room.polygon_m)[:, 0]
        if corners_px.max() - corners_px.min() > 2 * half_px:
            x_px = np.clip(x_px, corners_px.min() + half_px, corners_px.max() - half_px)
        _write(draw, np.array([x_px, y_px]), text, 16, halo=ROOM_TINTS[room.kind])


def _write(
    draw: ImageDraw.ImageDraw, at_px: FloatArray, text: str, size_px: int, halo: Rgb = PAPER
) -> None:
    write_text(draw, (float(at_px[0]), float(at_px[1])), text, size_px, INK, "mm", halo)


def _draw_scale(sheet: Sheet, draw: ImageDraw.ImageDraw) -> None:
    """A bar of one metre in the lower right corner."""
    length_px = 1.0 / sheet.frame.m_per_px
    x_px = draw.im.size[0] - LEGEND_PX + 8
    y_px = sheet.frame.height_px - MARGIN_PX
    draw.line((x_px, y_px, x_px + length_px, y_px), fill=INK, width=2)
    for end_px in (x_px, x_px + length_px):
        draw.line((end_px, y_px - 5, end_px, y_px + 5), fill=INK, width=2)
    write_text(draw, (x_px + length_px / 2, y_px - 8), "1 m", 14, INK, "mb")
