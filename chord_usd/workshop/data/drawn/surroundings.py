"""What else is on a page: terraces, plots, neighbours, titles, arrows, legends, logos, frames."""

from __future__ import annotations

import math

import numpy as np
import shapely
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from chord_usd.base.raster.page_labels import WRITING
from chord_usd.base.scene.types import FloatArray
from chord_usd.workshop.data.drawn.dimensions import write
from chord_usd.workshop.data.drawn.fills import fill_wall, tiles
from chord_usd.workshop.data.drawn.labelled_canvas import Canvas, rectangle
from chord_usd.workshop.data.drawn.masonry import Masonry
from chord_usd.workshop.data.drawn.page_looks import Look
from chord_usd.workshop.data.drawn.page_styles import RGB
from chord_usd.workshop.data.drawn.page_words import room_name, title
from chord_usd.workshop.data.drawn.symbols import plant


def draw_outdoors(canvas: Canvas, house: Masonry, look: Look, rng: np.random.Generator) -> None:
    """Terraces, paths, plots, cars and trees round the house. All of it stays outside."""
    left, low, right, high = house.house.bounds
    if rng.random() < look.surroundings * 0.4:
        _draw_plot(canvas, house, look, rng)
    while rng.random() < look.surroundings:
        # Against one side of the house.
        size = rng.uniform(1.0, 5.0, 2)
        spot = np.array([rng.uniform(left, right), rng.uniform(low, high)])
        side = int(rng.integers(4))
        spot[side % 2] = (left, low, right, high)[side] + (size[side % 2] / 2) * (-1, -1, 1, 1)[
            side
        ]
        area = shapely.box(*(spot - size / 2), *(spot + size / 2)).difference(house.house)
        _draw_terrace(canvas, area, look, rng)
    for _ in range(int(rng.poisson(3 * look.surroundings))):
        spot = rng.uniform((left - 1.5, low - 1.5), (right + 1.5, high + 1.5))
        tree = plant((spot[0], spot[1]), float(rng.uniform(0.2, 1.0)), rng)
        if not tree[0].intersects(house.house):
            rgb: RGB = (110, 160, 100) if rng.random() < 0.4 else look.piece_rgb
            if rng.random() < 0.4:
                canvas.fill(tree[0], (190, 215, 170))
            for shape in tree:
                canvas.outline(shape, rgb)


def _draw_terrace(canvas: Canvas, area: BaseGeometry, look: Look, rng: np.random.Generator) -> None:
    kind = rng.choice(["tiles", "lines", "hatch", "plain", "steps"])
    if kind == "tiles":
        base = np.array(look.paper_rgb) - rng.uniform(0, 40)
        canvas.paint(area, tiles(canvas.px_per_m, base, rng))
    elif kind == "hatch":
        fill_wall(canvas, area, str(rng.choice(["hatched", "dotted", "crossed"])), look, rng)  # type: ignore[arg-type]
    elif kind == "steps":
        left, low, right, high = area.bounds
        for y in np.arange(low, high, 0.3):
            canvas.line([(left, y), (right, y)], look.piece_rgb)  # type: ignore[list-item]
    if rng.random() < 0.7:
        dash = 0.15 if rng.random() < 0.3 else 0.0
        canvas.outline(area, look.piece_rgb, 1, dash)
    if rng.random() < 0.4:
        name = room_name(look.language, "balcony", rng)
        spot = np.array(area.representative_point().coords[0]) if not area.is_empty else None
        if spot is not None:
            height = round(look.letters_m * canvas.px_per_m)
            write(canvas, name, canvas.px(spot), height, look.ink_rgb, look.font)


def _draw_plot(canvas: Canvas, house: Masonry, look: Look, rng: np.random.Generator) -> None:
    """The border of the ground: a line, a fence or a wall that belongs to no house."""
    border = house.house.envelope.buffer(rng.uniform(0.6, 2.5), join_style="mitre")
    if rng.random() < 0.3:
        ring = border.difference(border.buffer(-rng.uniform(0.1, 0.25), join_style="mitre"))
        fill_wall(canvas, ring, look.outer_fill, look, rng)
        return
    if rng.random() < 0.4:
        red, green, blue = (int(v) for v in rng.uniform(200, 250, 3))
        canvas.fill(border.difference(house.house), (red, green, blue))
    canvas.outline(border, look.piece_rgb, 1, dash_m=float(rng.choice([0.0, 0.3, 0.6])))


def draw_neighbours(canvas: Canvas, house: Masonry, look: Look, rng: np.random.Generator) -> None:
    """Stubs of walls, stairs and shafts of what adjoins; drawn paler or hatched as a rule."""
    left, low, right, high = house.house.bounds
    share = rng.uniform(0.3, 0.7)
    mixed = np.array(look.wall_rgb) * (1 - share) + np.array(look.paper_rgb) * share
    red, green, blue = (int(v) for v in mixed)
    deep = look.inner_wall_m
    for _ in range(int(rng.integers(1, 5))):
        side = int(rng.integers(4))
        along = np.eye(2)[side % 2] * (-1.0, -1.0, 1.0, 1.0)[side]
        across = np.array([-along[1], along[0]])
        reach = rng.uniform(0.8, 3.5)
        start = np.array([rng.uniform(left, right), rng.uniform(low, high)])
        start[side % 2] = (left, low, right, high)[side]
        stub = rectangle(start + along * reach / 2, along, reach, deep)
        stub = stub.union(
            rectangle(start + along * reach + across * 0.7, across, rng.uniform(0.5, 2.5), deep)
        )
        canvas.fill(stub.difference(house.house), (red, green, blue))


def draw_page_furniture(canvas: Canvas, look: Look, rng: np.random.Generator) -> None:
    """Titles, an arrow to the north, a scale bar, a legend, a logo, a frame."""
    share = look.furniture_of_page
    canvas.origin_m = np.zeros(2)
    for _ in range(int(rng.poisson(2.5 * share))):
        text = title(rng)
        height = int(np.clip(rng.uniform(0.01, 0.04) * canvas.height, 7, 26))
        margin = rng.choice([rng.uniform(0.01, 0.07), rng.uniform(0.93, 0.99)])
        spot = np.array([rng.uniform(0.15, 0.85) * canvas.width, margin * canvas.height])
        write(canvas, text, spot, height, look.ink_rgb, look.font + int(rng.random() < 0.3))
    if rng.random() < share:
        _draw_north(canvas, look, rng)
    if rng.random() < share * 0.4:
        _draw_scale_bar(canvas, look, rng)
    if rng.random() < share * 0.3:
        _draw_legend(canvas, look, rng)
    if rng.random() < share * 0.5:
        _draw_logo(canvas, look, rng)
    if rng.random() < share * 0.25:
        inset = rng.uniform(0.05, 0.4)
        wide, tall = canvas.width / canvas.px_per_m, canvas.height / canvas.px_per_m
        frame = shapely.box(inset, inset, wide - inset, tall - inset)
        canvas.outline(frame, look.ink_rgb, int(rng.integers(1, 4)))
    if rng.random() < share * 0.1:
        _draw_watermark(canvas, look, rng)


def _free_spot(canvas: Canvas, rng: np.random.Generator, radius_m: float) -> FloatArray | None:
    """A place on the page, metres, with nothing built within a radius."""
    size = np.array([canvas.width, canvas.height]) / canvas.px_per_m
    for _ in range(12):
        spot = rng.uniform(radius_m, np.maximum(size - radius_m, radius_m + 0.1))
        ring = spot + radius_m * np.array([[-1, -1], [-1, 1], [1, -1], [1, 1], [0, 0]])
        if all(canvas.is_free(*point) for point in canvas.px(ring)):
            return np.asarray(spot)
    return None


def _draw_north(canvas: Canvas, look: Look, rng: np.random.Generator) -> None:
    radius = float(rng.uniform(0.3, 0.9))
    spot = _free_spot(canvas, rng, radius)
    if spot is None:
        return
    turn = rng.uniform(0, 2 * math.pi)
    way = np.array([math.cos(turn), math.sin(turn)])
    side = np.array([-way[1], way[0]])
    disc = Point(*spot).buffer(radius * rng.uniform(0.5, 0.9))
    if rng.random() < 0.6:
        canvas.outline(disc, look.ink_rgb)
    points = int(rng.choice([1, 1, 4, 8]))
    for index in range(points):
        angle = 2 * math.pi * index / points
        ahead = way * math.cos(angle) + side * math.sin(angle)
        beside = np.array([-ahead[1], ahead[0]])
        reach = radius * (1.0 if index % 2 == 0 else 0.6)
        half = Polygon([spot + ahead * reach, spot + beside * radius * 0.18, spot])
        canvas.fill(half, look.ink_rgb)
        canvas.outline(
            LineString([spot + ahead * reach, spot - beside * radius * 0.18, spot]), look.ink_rgb
        )
    height = round(radius * 0.5 * canvas.px_per_m)
    write(canvas, "N", canvas.px(spot + way * radius * 1.2), height, look.ink_rgb, look.font)
    canvas.fill(disc, None, laid=WRITING)


def _draw_scale_bar(canvas: Canvas, look: Look, rng: np.random.Generator) -> None:
    spot = _free_spot(canvas, rng, 0.8)
    if spot is None:
        return
    count, step = int(rng.integers(2, 6)), float(rng.choice([0.5, 1.0, 1.0]))
    for index in range(count):
        left = spot[0] + index * step
        part = shapely.box(left, spot[1], left + step, spot[1] + 0.12)
        canvas.fill(part, look.ink_rgb if index % 2 else look.paper_rgb, laid=WRITING)
        canvas.outline(part, look.ink_rgb)
        label = canvas.px(np.array([left, spot[1] + 0.35]))
        write(canvas, f"{index * step:g}", label, 9, look.ink_rgb, look.font)


def _draw_legend(canvas: Canvas, look: Look, rng: np.random.Generator) -> None:
    """A table: rooms and areas, or symbols."""
    rows, high = int(rng.integers(3, 9)), 0.4
    wide = float(rng.uniform(1.8, 3.5))
    spot = _free_spot(canvas, rng, 0.9)
    if spot is None:
        return
    for row in range(rows):
        cell = shapely.box(
            spot[0], spot[1] - row * high, spot[0] + wide, spot[1] - (row - 1) * high
        )
        if rng.random() < 0.9:
            canvas.outline(cell, look.ink_rgb)
        text = f"{row + 1} {room_name(look.language, 'living' if row else 'kitchen', rng)}"
        middle = canvas.px(np.array([spot[0] + wide / 2, spot[1] - (row - 0.5) * high]))
        write(canvas, text, middle, round(0.22 * canvas.px_per_m), look.ink_rgb, look.font)
        canvas.fill(cell, None, laid=WRITING)


def _draw_logo(canvas: Canvas, look: Look, rng: np.random.Generator) -> None:
    radius = float(rng.uniform(0.4, 0.9))
    spot = _free_spot(canvas, rng, radius)
    if spot is None:
        return
    red, green, blue = (int(v) for v in rng.uniform(0, 220, 3))
    kind = int(rng.integers(3))
    area = Point(*spot).buffer(radius * 0.8) if kind == 0 else shapely.box(
        *(spot - radius * 0.8), *(spot + radius * np.array([0.8, 0.3]))
    )  # fmt: skip
    if kind < 2:
        canvas.fill(area, (red, green, blue))
    else:
        canvas.outline(area, (red, green, blue), 2)
    words = ("HOME", "estates", "Keller & Co", "casa", "IMMO", "Bay Homes")
    height = round(rng.uniform(0.2, 0.4) * canvas.px_per_m)
    text = words[int(rng.integers(len(words)))]
    rgb: RGB = (255, 255, 255) if kind < 2 else (red, green, blue)
    write(canvas, text, canvas.px(spot), height, rgb, look.font)
    canvas.fill(area, None, laid=WRITING)


def _draw_watermark(canvas: Canvas, look: Look, rng: np.random.Generator) -> None:
    """Pale letters across the page, under which all stays what it is."""
    before = canvas.rgb.copy()
    labels = canvas.labels.copy()
    middle = np.array([canvas.width, canvas.height]) * rng.uniform(0.35, 0.65, 2)
    height = int(np.clip(canvas.width / 10, 12, 90))
    write(canvas, "SAMPLE" if rng.random() < 0.5 else "© PLANS", middle, height, look.ink_rgb, 0)
    share = rng.uniform(0.7, 0.9)
    canvas.rgb[:] = before * share + canvas.rgb * (1 - share)
    canvas.labels[:] = labels
