"""What is written into and round a plan: names, sizes, chains of dimensions."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import shapely
from shapely.geometry import Polygon

from chord_usd.base.raster.page_labels import WRITING
from chord_usd.base.scene.types import FloatArray
from chord_usd.workshop.data.drawn.labelled_canvas import Canvas
from chord_usd.workshop.data.drawn.masonry import Masonry
from chord_usd.workshop.data.drawn.page_looks import Look
from chord_usd.workshop.data.drawn.page_styles import RGB
from chord_usd.workshop.data.drawn.page_words import SIZE_STYLES, ink_of, room_name, room_size

_SMALLEST_PX = 7


def write(
    canvas: Canvas, text: str, middle_px: FloatArray, height_px: int, rgb: RGB, font: int,
    *, is_upright: bool = False,
) -> None:  # fmt: skip
    """A line of text centred on a pixel; upright lines read from below."""
    if not text:
        return
    ink = ink_of(text, max(_SMALLEST_PX, height_px), font)
    if is_upright:
        ink = np.rot90(ink)
    corner = np.rint(middle_px - np.array([ink.shape[1], ink.shape[0]]) / 2).astype(int)
    canvas.blend((int(corner[0]), int(corner[1])), ink, rgb, WRITING)


def write_names(canvas: Canvas, house: Masonry, look: Look, rng: np.random.Generator) -> None:
    """Names and sizes in the middle of rooms."""
    style = int(rng.integers(SIZE_STYLES))
    letters_px = look.letters_m * canvas.px_per_m
    has_numbers = rng.random() < 0.06
    for index, (kind, area) in enumerate(house.rooms):
        lines = []
        if rng.random() < look.names:
            name = room_name(look.language, kind, rng)
            lines.append(str(index + 1) if has_numbers else name.upper() if look.is_upper else name)
        if rng.random() < look.sizes and area.area > 3.0:
            lines += room_size(area, style)
        if lines:
            _write_lines(canvas, area, lines, letters_px, look, rng)


def _write_lines(
    canvas: Canvas,
    area: Polygon,
    lines: list[str],
    letters_px: float,
    look: Look,
    rng: np.random.Generator,
) -> None:
    left, low, right, high = np.array(area.bounds) * canvas.px_per_m
    middle = np.array(shapely.maximum_inscribed_circle(area, tolerance=0.2).coords[0])
    middle = middle + rng.normal(0, 0.12, 2)
    letters_px = max(letters_px, _SMALLEST_PX)
    longest = max(ink_of(line, round(letters_px), look.font).shape[1] for line in lines)
    # Rooms too narrow for their names have them along, or in smaller letters.
    is_upright = longest > 0.9 * (right - left) and high - low > 1.3 * (right - left)
    room = (high - low if is_upright else right - left) * 0.95
    height = max(_SMALLEST_PX, round(letters_px * min(1.0, room / longest)))
    if longest * height / letters_px > 1.5 * room and rng.random() < 0.8:
        return
    place = canvas.px(middle)
    for index, line in enumerate(lines):
        offset = (index - (len(lines) - 1) / 2) * 1.3 * height
        spot = place + np.array([offset, 0.0] if is_upright else [0.0, offset])
        tall = height if index == 0 else round(0.8 * height)
        write(canvas, line, spot, tall, look.ink_rgb, look.font, is_upright=is_upright)


# Dimensions --------------------------------------------------------------------------------------


def draw_chains(canvas: Canvas, house: Masonry, look: Look, rng: np.random.Generator) -> None:
    """Chains of dimensions beside the house, in up to three rows a side."""
    left, low, right, high = house.house.bounds
    mark = _Mark(look, rng)
    for side in range(4):
        if rng.random() >= look.chains:
            continue
        axis = side % 2
        stops = _stops(house, axis, rng)
        base = (low, left, high, right)[side]
        way = -1.0 if side < 2 else 1.0
        first = rng.uniform(0.4, 1.0)
        for row in range(int(rng.integers(1, 4))):
            place = base + way * (first + row * mark.row_m)
            chain = stops if row == 0 else stops[:: max(1, len(stops) - 1)] if row == 2 else [
                stops[0], *stops[2:-1:2], stops[-1]
            ]  # fmt: skip
            mark.draw(canvas, axis, place, chain, base if rng.random() < 0.5 else None)


def draw_inner_dimensions(
    canvas: Canvas, house: Masonry, look: Look, rng: np.random.Generator
) -> None:
    """Lines from wall to wall through rooms, and circles in which a wheelchair turns."""
    mark = _Mark(look, rng)
    for _, area in house.rooms:
        if rng.random() >= look.inner_dimensions:
            continue
        if rng.random() < 0.3:
            spot = shapely.maximum_inscribed_circle(area, tolerance=0.2)
            ring = shapely.Point(spot.coords[0]).buffer(0.75)
            canvas.outline(ring, look.ink_rgb, 1, dash_m=0.12)
        left, low, right, high = area.bounds
        mark.draw(canvas, 0, low + rng.uniform(0.15, 0.85) * (high - low), [left, right], None)
        mark.draw(canvas, 1, left + rng.uniform(0.15, 0.85) * (right - left), [low, high], None)


def draw_axes(canvas: Canvas, house: Masonry, look: Look, rng: np.random.Generator) -> None:
    """An engineer's grid: dashed lines through all of the house, with a letter at their ends."""
    left, low, right, high = house.house.bounds
    letters = rng.permutation(list("ABCDEF123456"))
    for axis in (0, 1):
        ends = np.array([(low, high), (left, right)][axis]) + np.array([-1.0, 1.0]) * 0.8
        for index, place in enumerate(_stops(house, axis, rng)[:6]):
            line = np.array([[place, ends[0]], [place, ends[1]]])[:, :: 1 - 2 * axis]
            canvas.line(line, look.piece_rgb, 1, dash_m=0.35)
            spot = line[1] + (line[1] - line[0]) * 0.02
            canvas.outline(shapely.Point(spot).buffer(0.25), look.ink_rgb)
            height = round(0.25 * canvas.px_per_m)
            write(canvas, str(letters[index]), canvas.px(spot), height, look.ink_rgb, look.font)


def _stops(house: Masonry, axis: int, rng: np.random.Generator) -> list[float]:
    """Where a chain is divided: at the faces of rooms."""
    faces = {round(area.bounds[axis + k], 1) for _, area in house.rooms for k in (0, 2)}
    ends = [house.house.bounds[axis], house.house.bounds[axis + 2]]
    inner = [face for face in sorted(faces) if ends[0] < face < ends[1] and rng.random() < 0.6]
    return [ends[0], *inner, ends[1]]


class _Mark:
    """How one person draws dimension lines."""

    def __init__(self, look: Look, rng: np.random.Generator) -> None:
        self.rgb = look.ink_rgb if rng.random() < 0.8 else look.door_rgb
        self.font = look.font
        self.end = str(rng.choice(["tick", "arrow", "bar", "dot"]))
        self.is_in_line = bool(rng.random() < 0.3)
        self.unit = int(rng.integers(5))
        self.letters_m = look.letters_m * rng.uniform(0.6, 1.0)
        self.row_m = rng.uniform(0.35, 0.8)

    def draw(
        self, canvas: Canvas, axis: int, place: float, stops: list[float], base: float | None
    ) -> None:
        """A chain along an axis, at a place on the other; witness lines from base, where given."""

        def point(along: float, across: float) -> FloatArray:
            return np.array([along, across] if axis == 0 else [across, along])

        height = max(_SMALLEST_PX, round(self.letters_m * canvas.px_per_m))
        for start, other in pairwise(stops):
            text = self._length(other - start)
            room = (other - start) * canvas.px_per_m
            wide = ink_of(text, height, self.font).shape[1]
            middle = (start + other) / 2
            gap = (wide / 2 + 2) / canvas.px_per_m
            if self.is_in_line and room > wide + 12:
                canvas.line(
                    [point(start, place), point(middle - gap, place)], self.rgb, 1, laid=WRITING
                )
                canvas.line(
                    [point(middle + gap, place), point(other, place)], self.rgb, 1, laid=WRITING
                )
                shift: FloatArray = np.zeros(2)
            else:
                canvas.line([point(start, place), point(other, place)], self.rgb, 1, laid=WRITING)
                shift = (np.array([[0.0, -0.75], [-0.75, 0.0]])[axis] * height).astype(np.float64)
            if room > 0.7 * wide:
                spot = canvas.px(point(middle, place)) + shift
                write(canvas, text, spot, height, self.rgb, self.font, is_upright=axis == 1)
        for stop in stops:
            self._end(canvas, point(stop, place), axis)
            if base is not None:
                near = place + (base - place) * 0.85
                canvas.line([point(stop, place), point(stop, near)], self.rgb, 1, laid=WRITING)

    def _end(self, canvas: Canvas, at: FloatArray, axis: int) -> None:
        size = 4.0 / canvas.px_per_m
        if self.end == "dot":
            canvas.fill(shapely.Point(*at).buffer(size / 1.5), self.rgb, laid=WRITING)
            return
        along = np.eye(2)[axis]
        across = np.eye(2)[1 - axis]
        ways = {
            "tick": [np.array([1.0, 1.0])],
            "bar": [across],
            "arrow": [along + 0.4 * across, along - 0.4 * across],
        }
        for way in ways[self.end]:
            canvas.line([at - way * size, at + way * size], self.rgb, 1, laid=WRITING)

    def _length(self, length_m: float) -> str:
        inches = round(length_m * 39.37)
        ways = (
            f"{length_m:.2f}",
            f"{1000 * length_m:.0f}",
            f"{100 * length_m:.0f}",
            f"{inches // 12}'-{inches % 12}\"",
            f"{length_m:.2f} m".replace(".", ","),
        )
        return ways[self.unit]
