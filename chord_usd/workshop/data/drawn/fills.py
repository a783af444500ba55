"""What walls and floors are filled with: hatches, tiles, planks, photographs of materials."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np
import shapely
from shapely.geometry import Point
from shapely.geometry.base import BaseGeometry
from shapely.ops import nearest_points

from chord_usd.base.raster.page_labels import FLOOR, WALL
from chord_usd.base.runtime.locations import materials_folder
from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.types import ByteArray, RoomKind
from chord_usd.workshop.data.drawn.labelled_canvas import Canvas
from chord_usd.workshop.data.drawn.masonry import Masonry
from chord_usd.workshop.data.drawn.page_looks import Look, WallFill
from chord_usd.workshop.data.drawn.page_styles import RGB

_KIND_RGB: dict[RoomKind, tuple[RGB, ...]] = {
    "living": ((255, 222, 222), (250, 235, 200), (255, 245, 190), (200, 200, 200)),
    "dining": ((255, 222, 222), (250, 225, 190), (240, 240, 215), (210, 225, 190)),
    "bedroom": ((255, 208, 98), (215, 230, 245), (255, 235, 180), (102, 194, 165)),
    "kitchen": ((245, 215, 205), (255, 200, 200), (230, 240, 200), (252, 141, 98)),
    "bathroom": ((140, 225, 245), (205, 235, 240), (190, 215, 240), (141, 160, 203)),
    "balcony": ((220, 240, 210), (235, 235, 235), (255, 255, 255), (179, 179, 179)),
    "corridor": ((205, 198, 185), (240, 240, 225), (245, 225, 190), (229, 196, 148)),
    "study": ((255, 214, 140), (230, 220, 245), (220, 235, 220), (231, 138, 195)),
    "store": ((198, 194, 186), (230, 230, 230), (215, 205, 190), (166, 216, 84)),
    "unknown": ((255, 255, 255), (245, 245, 245), (240, 235, 225), (200, 200, 200)),
}


def draw_floors(canvas: Canvas, house: Masonry, look: Look, rng: np.random.Generator) -> None:
    """Label the house as floor, and colour its rooms."""
    bare = look.paper_rgb if look.floors in ("bare", "kinds") else look.tint_rgb
    canvas.fill(house.house, bare, built=FLOOR, laid=0)
    if look.floors in ("bare", "tinted"):
        if rng.random() < look.wet_tiles:
            _tile_wet_rooms(canvas, house, bare, rng)
        return
    palette = int(rng.integers(4))
    dry, wet = _texture(canvas, look, rng), _texture(canvas, look, rng)
    for kind, area in house.rooms:
        if look.floors == "kinds":
            rgb = _KIND_RGB[kind][palette] if rng.random() < 0.9 else look.paper_rgb
            canvas.fill(area, rgb)
            continue
        is_wet = kind in ("bathroom", "kitchen", "balcony")
        if look.floors == "textured" and rng.random() < 0.4:
            continue
        texture = wet if is_wet else dry
        canvas.paint(area, texture if rng.random() < 0.8 else _texture(canvas, look, rng))


def _tile_wet_rooms(canvas: Canvas, house: Masonry, bare: RGB, rng: np.random.Generator) -> None:
    texture = tiles(canvas.px_per_m, np.array(bare, np.float64), rng)
    kinds: tuple[RoomKind, ...] = ("bathroom", "balcony", "kitchen")
    tiled = kinds[: int(rng.integers(1, 4))]
    for kind, area in house.rooms:
        if kind in tiled:
            canvas.paint(area, texture)


def _texture(canvas: Canvas, look: Look, rng: np.random.Generator) -> ByteArray:
    if look.floors == "photo" and rng.random() < 0.8:
        return _photograph(canvas, rng)
    base = np.array(rng.uniform(150, 250) + rng.uniform(-20, 20, 3))
    if look.floors == "textured":
        base = np.array(look.tint_rgb) - rng.uniform(0, 25)
    return tiles(canvas.px_per_m, base, rng)


def tiles(px_per_m: float, base: np.ndarray, rng: np.random.Generator) -> ByteArray:
    """A drawn pattern: tiles, planks, parquet in herringbone, or grain."""
    kind = rng.choice(["tiles", "planks", "bond", "diagonal", "grain"])
    step = max(4, int(rng.uniform(0.12, 0.7) * px_per_m))
    size = step * max(1, 48 // step) * 2
    tile = np.full((size, size, 3), base, np.float32)
    joint = base - rng.uniform(8, 60)
    if kind == "grain":
        coarse = rng.normal(0, rng.uniform(3, 14), (size // 3 + 1, size // 3 + 1))
        tile += cv2.resize(coarse.astype(np.float32), (size, size))[..., None]
    elif kind == "diagonal":
        rows, columns = np.indices((size, size))
        tile[(rows + columns) % step < 1] = joint
        if rng.random() < 0.5:
            tile[(rows - columns) % step < 1] = joint
    else:
        narrow = step if kind == "tiles" else max(3, step // 3)
        tile[::narrow] = joint
        for row in range(0, size, narrow):
            shift = 0 if kind == "tiles" else int(rng.integers(size)) if kind == "planks" else (
                step // 2 * (row // narrow % 2)
            )  # fmt: skip
            every = size if kind == "planks" else step
            tile[row : row + narrow, shift % every :: every] = joint
    if rng.random() < 0.5:
        tile = np.rot90(tile).copy()
    return np.clip(tile, 0, 255).astype(np.uint8)


def _photograph(canvas: Canvas, rng: np.random.Generator) -> ByteArray:
    """A shipped floor or wall material, in a random size and brightness."""
    pictures = _material_pictures()
    if not pictures:
        return tiles(canvas.px_per_m, rng.uniform(120, 230, 3), rng)
    picture = pictures[int(rng.integers(len(pictures)))]
    side = int(np.clip(rng.uniform(0.8, 2.0) * canvas.px_per_m, 24, 200))
    small = cv2.resize(picture, (side, side), interpolation=cv2.INTER_AREA).astype(np.float32)
    bright = small * rng.uniform(0.75, 1.25) + rng.uniform(-20, 30)
    return np.clip(bright, 0, 255).astype(np.uint8)


@cache
def _material_pictures() -> tuple[ByteArray, ...]:
    pictures = []
    for path in sorted(materials_folder().glob("*/maps/*base_color.*")):
        picture = cv2.imread(str(path))
        if picture is not None:
            small = cv2.resize(picture, (200, 200), interpolation=cv2.INTER_AREA)
            pictures.append(np.ascontiguousarray(small[..., ::-1]))
    return tuple(pictures)


# Walls -------------------------------------------------------------------------------------------


def draw_walls(canvas: Canvas, house: Masonry, look: Look, rng: np.random.Generator) -> None:
    """Walls, each part in its fill, labelled."""
    if look.outer_fill == look.inner_fill:
        fill_wall(canvas, house.walls, look.outer_fill, look, rng)
    else:
        fill_wall(canvas, house.inner_walls, look.inner_fill, look, rng)
        outer = house.walls.difference(house.inner_walls.buffer(1e-3))
        fill_wall(canvas, outer, look.outer_fill, look, rng)
    if look.mass_fill != look.outer_fill and not house.masses.is_empty:
        fill_wall(canvas, house.masses.intersection(house.walls), look.mass_fill, look, rng)
    if look.has_joints:
        _draw_joints(canvas, house, look)
    canvas.fill(house.walls, None, built=WALL, laid=0)


def _draw_joints(canvas: Canvas, house: Masonry, look: Look) -> None:
    """Mitres of the outer walls, and a dot at each corner of any."""
    inner = shapely.MultiPoint([c for _, area in house.rooms for c in area.exterior.coords[:-1]])
    for part in polygons_of(house.house):
        for corner in part.exterior.coords[:-1]:
            end = nearest_points(inner, Point(corner))[0]
            if end.distance(Point(corner)) < 1.6 * look.outer_wall_m:
                canvas.line(np.array([corner, (end.x, end.y)]), look.wall_rgb)
    side = 3.0 / canvas.px_per_m
    for part in polygons_of(house.walls):
        for corner in part.exterior.coords[:-1]:
            canvas.fill(Point(corner).buffer(side / 2, cap_style="square"), look.ink_rgb)


def fill_wall(
    canvas: Canvas, area: BaseGeometry, fill: WallFill, look: Look, rng: np.random.Generator
) -> None:
    """Paint the body of a wall."""
    if fill == "solid":
        canvas.fill(area, look.wall_rgb)
        return
    body = look.body_rgb
    if fill == "grey":
        share = rng.uniform(0.25, 0.85)
        paper = np.array(look.paper_rgb) * share
        red, green, blue = (int(v) for v in paper + np.array(look.wall_rgb) * (1 - share))
        body = (red, green, blue)
    canvas.fill(area, body)
    if fill in ("hatched", "crossed", "dotted", "brick"):
        canvas.paint(area, _hatch(canvas, fill, body, look, rng))
    if fill == "layered":
        for part in (0.3, 0.62):
            inner = area.buffer(-part * look.outer_wall_m, join_style="mitre")
            canvas.outline(inner, look.wall_rgb, 1)
    canvas.outline(area, look.wall_rgb, look.line_px)


def _hatch(
    canvas: Canvas, fill: WallFill, body: RGB, look: Look, rng: np.random.Generator
) -> ByteArray:
    step = int(np.clip(rng.uniform(0.04, 0.12) * canvas.px_per_m, 3, 12))
    size = step * 8
    rows, columns = np.indices((size, size))
    if fill == "dotted":
        is_ink = rng.random((size, size)) < rng.uniform(0.05, 0.25)
    elif fill == "brick":
        is_ink = (rows % step < 1) | ((columns + rows // step % 2 * step) % (2 * step) < 1)
    else:
        is_ink = (rows + columns) % step < 1
        if fill == "crossed":
            is_ink |= (rows - columns) % step < 1
    tile = np.empty((size, size, 3), np.uint8)
    tile[:] = body
    tile[is_ink] = look.wall_rgb
    return tile
