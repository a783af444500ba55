"""Crowded pages: furnished procedural houses drawn as real plans are, with the truth per pixel.

Real plans differ from clean ones in content rather than in ink: furniture is drawn in, walls are of
several thicknesses, doors stand in corners, and pages hold much beside the plan.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import shapely
from shapely.geometry import Polygon
from shapely.geometry.polygon import orient

from chord_usd.base.raster.page_labels import CORNER, HINGE, JAMB
from chord_usd.base.scene.geometry import footprint_polygon, polygons_of, room_polygon, rooms_beside
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    Box,
    FloatArray,
    Item,
    Plan,
    Room,
    frozen_array,
)
from chord_usd.workshop.data.drawn.dimensions import (
    draw_axes,
    draw_chains,
    draw_inner_dimensions,
    write_names,
)
from chord_usd.workshop.data.drawn.drawn_openings import Leaf, draw_gap
from chord_usd.workshop.data.drawn.fills import draw_floors, draw_walls
from chord_usd.workshop.data.drawn.labelled_canvas import Canvas
from chord_usd.workshop.data.drawn.masonry import Masonry, build
from chord_usd.workshop.data.drawn.page_looks import Look, random_look
from chord_usd.workshop.data.drawn.stairs import Flight, draw_stairs, with_stairs
from chord_usd.workshop.data.drawn.styled_plans import without_seams
from chord_usd.workshop.data.drawn.surroundings import (
    draw_neighbours,
    draw_outdoors,
    draw_page_furniture,
)
from chord_usd.workshop.data.drawn.symbols import draw_items
from chord_usd.workshop.data.drawn.truth import CrowdedPage, DrawnStorey
from chord_usd.workshop.data.drawn.wear import Picture, worn
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan

_STOREYS = (0.78, 0.17, 0.05)
"""Shares of pages with one, two and three storeys."""

_OPEN_KITCHENS = 0.5
"""Share of storeys whose kitchen lies open to the room beside it."""

_TIGHT = 0.2
"""Share of pages that are cut to the walls, as pictures of data sets are."""

_PX = (420, 1150)
"""Of a page's longer side."""


@dataclass(frozen=True, eq=False)
class _Placed:
    """A storey and where its own origin lies on the sheet."""

    house: Masonry
    flights: tuple[Flight, ...]
    origin_m: FloatArray


def draw_page(
    seed: int, look: Look | None = None, flats: Sequence[Plan] = (), *, is_varied: bool = False
) -> CrowdedPage:
    """The page of a seed; look: drawn too where it is not given; flats: shown in place of
    procedural plans; is_varied: furniture and fixtures in symbols of many hands."""
    rng, walls = np.random.default_rng(seed), np.random.default_rng((seed, 1))
    look = random_look(rng) if look is None else look
    count = int(rng.choice(len(_STOREYS), p=_STOREYS)) + 1
    houses = []
    for _ in range(count):
        plan = flats[int(rng.integers(len(flats)))] if flats else random_plan(rng)
        if walls.random() < _OPEN_KITCHENS:
            plan = with_open_kitchen(plan, walls)
        house = build(furnish(plan, rng, "homes"), look, rng)
        houses.append(with_stairs(house, look, rng))
    placed, size_m = _laid_out(houses, look, rng)
    side = rng.uniform(*_PX) * (1.2 if count > 1 else 1.0)
    canvas = Canvas(size_m, side / float(size_m.max()), look.paper_rgb)
    for storey in placed:
        _draw_around(canvas, storey, look, rng)
    drawn = [_draw_storey(canvas, storey, look, rng, is_varied) for storey in placed]
    draw_page_furniture(canvas, look, rng)
    page = worn(Picture(canvas.rgb, canvas.labels, canvas.matrix()), look, rng)
    storeys = tuple(
        _as_vectors(storey, *drawing) for storey, drawing in zip(placed, drawn, strict=True)
    )
    points = _points(storeys, page.matrix, page.rgb.shape)
    return CrowdedPage(
        frozen_array(page.rgb, np.uint8), frozen_array(page.labels, np.uint8), points, storeys,
        page.matrix,
    )  # fmt: skip


def _laid_out(
    houses: list[tuple[Masonry, tuple[Flight, ...]]], look: Look, rng: np.random.Generator
) -> tuple[list[_Placed], FloatArray]:
    """Storeys side by side or one above the other, and the size of the sheet, metres."""
    margins = rng.uniform(0.3, 2.0, 4)
    if rng.random() < _TIGHT:
        margins = rng.uniform(0.0, 0.2, 4)
    elif look.chains or rng.random() < 0.3:
        margins += rng.uniform(0.5, 3.0, 4)
    is_row = rng.random() < 0.65
    cursor, placed = margins[:2].copy(), []
    far = np.zeros(2)
    for house, flights in houses:
        low = np.array(house.house.bounds[:2])
        size = np.array(house.house.bounds[2:]) - low
        shift = rng.uniform(0, 0.6, 2) * (not is_row, is_row)
        origin = cursor + shift - low
        placed.append(_Placed(house, flights, origin))
        far = np.maximum(far, origin + low + size)
        cursor[0 if is_row else 1] = far[0 if is_row else 1] + rng.uniform(0.4, 2.5)
    return placed, far + margins[2:]


def _draw_around(canvas: Canvas, storey: _Placed, look: Look, rng: np.random.Generator) -> None:
    """What lies outside, before any storey is drawn over it."""
    canvas.origin_m = storey.origin_m
    draw_outdoors(canvas, storey.house, look, rng)
    if rng.random() < look.surroundings * 0.6:
        draw_neighbours(canvas, storey.house, look, rng)


def _draw_storey(
    canvas: Canvas, placed: _Placed, look: Look, rng: np.random.Generator, is_varied: bool
) -> tuple[list[Leaf], tuple[Item, ...]]:
    """What is drawn of a storey: leaves of doors, and pieces."""
    house = placed.house
    canvas.origin_m = placed.origin_m
    draw_floors(canvas, house, look, rng)
    flights = draw_stairs(canvas, placed.flights, look, rng)
    clear = tuple(
        item for item in house.items if not footprint_polygon(item.box).intersects(flights)
    )
    pieces = draw_items(canvas, clear, look, rng, is_varied=is_varied)
    draw_walls(canvas, house, look, rng)
    leaves = [leaf for gap in house.gaps for leaf in draw_gap(canvas, gap, look, rng)]
    draw_inner_dimensions(canvas, house, look, rng)
    if rng.random() < look.axes:
        draw_axes(canvas, house, look, rng)
    write_names(canvas, house, look, rng)
    draw_chains(canvas, house, look, rng)
    return leaves, pieces


# Vectors -----------------------------------------------------------------------------------------


def _as_vectors(placed: _Placed, leaves: list[Leaf], pieces: tuple[Item, ...]) -> DrawnStorey:
    """A storey in metres on the sheet."""
    plan, shift = placed.house.plan(), placed.origin_m
    rooms = tuple(
        replace(room, polygon_m=frozen_array(room.polygon_m + shift)) for room in plan.rooms
    )
    boxes = [_moved(opening.box, shift) for opening in plan.openings]
    openings = tuple(
        replace(opening, box=box, room_ids=rooms_beside(box, rooms))
        for opening, box in zip(plan.openings, boxes, strict=True)
    )
    rings = [
        np.array(ring.coords) + shift
        for part in polygons_of(placed.house.walls)
        for ring in (shapely.geometry.polygon.orient(part).exterior, *part.interiors)
    ]
    hinges = tuple((leaf.opening_id, leaf.hinge + shift, leaf.tip + shift) for leaf in leaves)
    moved = tuple(replace(item, box=_moved(item.box, shift)) for item in pieces)
    return DrawnStorey(Plan(rooms, openings), tuple(rings), hinges, moved)


def _moved(box: Box, shift: FloatArray) -> Box:
    x, y, z = box.center_m
    return replace(box, center_m=(x + float(shift[0]), y + float(shift[1]), z))


def _points(
    storeys: tuple[DrawnStorey, ...], matrix: FloatArray, shape: tuple[int, ...]
) -> FloatArray:
    """(P, 3) hinges, jambs and corners within a picture."""
    points: list[tuple[float, float, int]] = []
    for storey in storeys:
        points += [(*hinge, HINGE) for _, hinge, _ in storey.hinges_m]
        for opening in storey.plan.openings:
            points += [(*end, JAMB) for end in _jambs(opening.box)]
        for room in without_seams(storey.plan).rooms:
            points += [(*corner, CORNER) for corner in room.polygon_m]
    if not points:
        return np.zeros((0, 3))
    array = np.array(points, np.float64)
    homogeneous = np.column_stack([array[:, :2], np.ones(len(array))]) @ matrix.T
    pixels = homogeneous[:, :2] / homogeneous[:, 2:]
    inside = np.all((pixels >= 0) & (pixels < (shape[1], shape[0])), axis=1)
    return frozen_array(np.column_stack([pixels, array[:, 2]])[inside])


def _jambs(box: Box) -> FloatArray:
    """(2, 2) the middles of an opening's two ends."""
    angle = np.radians(box.yaw_deg)
    half = np.array([np.cos(angle), np.sin(angle)]) * box.size_m[0] / 2
    return np.array(box.center_m[:2]) + np.array([-half, half])


# Kitchens that lie open to the living or dining room, as in most homes built today ---------------

_OVERLAP_M = 0.02
_HALF_WALL_M = (WALL_THICKNESS_M + _OVERLAP_M) / 2
"""Rooms grown by so much overlap in the middle of their wall."""
_LEAST_M = 1.2
"""Of wall that is taken away."""
_GRID_M = 1e-3


def with_open_kitchen(plan: Plan, rng: np.random.Generator) -> Plan:
    """The plan with a kitchen reaching across the wall to a living or dining room, where one lies
    beside it; the two touch then. Some of the wall may stay."""
    kitchens = [room for room in plan.rooms if room.kind == "kitchen"]
    others = [room for room in plan.rooms if room.kind in ("living", "dining")]
    pairs = list(product(kitchens, others))
    for index in rng.permutation(len(pairs)):
        kitchen, other = pairs[index]
        grown = _across_wall(kitchen, other, rng.uniform(0.5, 1.3))
        if grown is None:
            continue
        corners = frozen_array(orient(grown).exterior.coords[:-1])
        opened = replace(kitchen, polygon_m=corners)
        rooms = tuple(opened if room is kitchen else room for room in plan.rooms)
        both = {kitchen.id, other.id}
        kept = tuple(opening for opening in plan.openings if set(opening.room_ids) != both)
        return replace(plan, rooms=rooms, openings=kept)
    return plan


def _across_wall(room: Room, other: Room, share: float) -> Polygon | None:
    """A room with a share of the wall to another one, at most all; None without a straight wall."""
    floors = [room_polygon(room), room_polygon(other)]
    grown = [floor.buffer(_HALF_WALL_M, join_style="mitre") for floor in floors]
    middle = grown[0].intersection(grown[1])
    if middle.geom_type != "Polygon" or floors[0].distance(floors[1]) < WALL_THICKNESS_M / 2:
        return None
    low, high = np.reshape(middle.bounds, (2, 2))
    sides = high - low
    length = float(sides.max()) - 2 * _HALF_WALL_M
    if sides.min() > 3 * _OVERLAP_M or length * share < _LEAST_M:
        return None  # slanted or bent, or too short
    reach = np.where(sides == sides.max(), length * min(share, 1.0), WALL_THICKNESS_M) / 2
    bridge = shapely.box(*((low + high) / 2 - reach), *((low + high) / 2 + reach))
    whole = shapely.union(floors[0], bridge, grid_size=_GRID_M)
    if not isinstance(whole, Polygon) or whole.interiors:
        return None
    return whole
