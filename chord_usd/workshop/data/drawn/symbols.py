"""Furniture and fixtures from above, as several hands draw them, and flights of stairs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import shapely
from shapely import affinity
from shapely.geometry import LineString, Point, Polygon
from shapely.geometry.base import BaseGeometry

from chord_usd.base.raster.page_labels import PIECE
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import Item
from chord_usd.workshop.data.drawn.fills import tiles
from chord_usd.workshop.data.drawn.fixture_symbols import bidet
from chord_usd.workshop.data.drawn.from_above import draw_from_above
from chord_usd.workshop.data.drawn.furniture_symbols import DRAWN
from chord_usd.workshop.data.drawn.labelled_canvas import Canvas
from chord_usd.workshop.data.drawn.page_looks import Look
from chord_usd.workshop.data.drawn.page_styles import RGB

Shapes = list[BaseGeometry]
Draw = Callable[[float, float, np.random.Generator], Shapes]
"""Shapes of a piece of a length and a depth, its back at +y and its middle at the origin: the
first one is its body."""

FIXTURES = having("fixture")
"""What stays when people move out."""


_ALIKE = 0.85
"""Of the pieces of a category on a page with a habit, this share looks alike."""
_SOLID, _SMALL_M2 = 0.12, 0.05
"""Share of hands that fill inner shapes with ink, and how small these are."""

_HUNG = 0.3
"""Share of hands that dash cabinets above worktops."""
_BROKEN, _BROKEN_M = 0.12, (0.04, 0.12)
"""Share of hands that draw furniture, not fixtures, in broken strokes, and their lengths."""
_BIDETS = 0.15
"""Share of WCs with a bidet beside them."""

_MESHES = 0.65
"""Share of pages with furniture in colours that show ours."""


@dataclass(eq=False)
class Hand:
    """How one person draws furniture; colours are kept for each category."""

    look: Look
    rng: np.random.Generator
    is_round: bool = False
    line_px: int = 1
    has_worktop_lines: bool = True
    has_meshes: bool = False
    """Pieces are our own, seen from above."""
    habit: int | None = None
    """Seed of the symbols of a page on which all of a category look alike, as real ones do; None:
    few symbols, each drawn by itself."""
    is_solid: bool = False
    """Inner shapes, such as rings and bowls, are filled with ink."""
    broken_m: float = 0.0
    """Length of the strokes in which furniture is drawn; 0: unbroken."""
    colors: dict[str, RGB] = field(default_factory=dict)

    def color(self, category: str) -> RGB | None:
        """What a piece is filled with; None for nothing."""
        if self.look.pieces == "lines":
            return None
        if self.look.pieces == "white":
            return (255, 255, 255)
        if category not in self.colors:
            if self.look.pieces == "grey":
                values = np.full(3, self.rng.uniform(110, 245))
            elif self.rng.random() < 0.5:  # wood and cloth, in photographs
                values = self.rng.uniform(60, 235) * np.array([1.0, 0.9, 0.78])
            else:
                values = self.rng.uniform(70, 240) + self.rng.normal(0, 25, 3)
            red, green, blue = (int(v) for v in np.clip(values, 0, 255))
            self.colors[category] = (red, green, blue)
        return self.colors[category]

    def shapes(self, item: Item) -> Shapes:
        """The symbol of a piece."""
        length, depth = item.box.size_m[:2]
        if self.habit is None:
            return _DRAWN.get(item.category, _plain)(length, depth, self.rng)
        draw = DRAWN.get(item.category, _plain)
        is_usual = self.rng.random() < _ALIKE
        seed = self.habit if is_usual else int(self.rng.integers(1 << 30))
        return draw(length, depth, np.random.default_rng((seed, *item.category.encode())))


def draw_items(
    canvas: Canvas,
    items: tuple[Item, ...],
    look: Look,
    rng: np.random.Generator,
    *,
    is_varied: bool = False,
) -> tuple[Item, ...]:
    """Furniture and fixtures, labelled; the drawn ones. is_varied: with symbols of many hands."""
    if look.pieces == "none":
        return ()
    has_meshes = look.pieces == "photo" and rng.random() < _MESHES
    hand = Hand(look, rng, bool(rng.random() < 0.4), 1, bool(rng.random() < 0.5), has_meshes)
    if is_varied:
        _vary(hand, canvas, items)
    drawn = []
    for item in items:
        is_fixture = item.category in FIXTURES
        if look.only_fixtures and not is_fixture:
            continue
        if rng.random() >= look.pieces_kept and not is_fixture:
            continue
        _draw_item(canvas, item, hand)
        drawn.append(item)
        if item.category == "toilet" and is_varied and rng.random() < _BIDETS:
            _draw_bidet(canvas, item, items, hand)
    return tuple(drawn)


def _draw_bidet(canvas: Canvas, toilet: Item, items: tuple[Item, ...], hand: Hand) -> None:
    """A bidet beside a WC, where nothing stands there."""
    side = float(hand.rng.choice([-1, 1])) * hand.rng.uniform(0.5, 0.7)
    turn = math.radians(toilet.box.yaw_deg)
    x, y, z = toilet.box.center_m
    at = (x + side * math.cos(turn), y + side * math.sin(turn), z)
    box = replace(toilet.box, center_m=at, size_m=(0.37, 0.55, 0.4))
    shape = footprint_polygon(box)
    if any(shape.intersects(footprint_polygon(item.box)) for item in items):
        return
    for outline in bidet(*box.size_m[:2], hand.rng):
        placed = affinity.rotate(outline, box.yaw_deg, origin=(0, 0))
        canvas.outline(affinity.translate(placed, *at[:2]), hand.look.piece_rgb, hand.line_px)
    canvas.fill(shape, None, laid=PIECE)


def _vary(hand: Hand, canvas: Canvas, items: tuple[Item, ...]) -> None:
    """Symbols of a habit, in finer or thicker strokes; worktops as runs without joints."""
    rng = hand.rng
    hand.habit = int(rng.integers(1 << 30))
    hand.is_round = False
    hand.is_solid = bool(rng.random() < _SOLID)
    if rng.random() < _BROKEN:
        hand.broken_m = float(rng.uniform(*_BROKEN_M))
    thick = max(1, round(rng.uniform(0.01, 0.03) * canvas.px_per_m))
    hand.line_px = int(rng.choice([1, 1, thick]))
    if hand.has_worktop_lines:
        return
    units = [footprint_polygon(item.box) for item in items if item.category in having("worktop")]
    run = shapely.union_all([unit.buffer(0.02, join_style="mitre") for unit in units])
    if rng.random() < _HUNG:
        # What hangs above the worktop is dashed.
        inner = run.buffer(-rng.uniform(0.2, 0.28), join_style="mitre")
        canvas.outline(inner, hand.look.piece_rgb, 1, 0.1)
    if hand.look.pieces not in ("lines", "photo") or rng.random() < 0.2:
        canvas.fill(run, hand.color("worktop"))
    canvas.outline(run, hand.look.piece_rgb, hand.line_px)


def _draw_item(canvas: Canvas, item: Item, hand: Hand) -> None:
    length, depth = item.box.size_m[:2]
    look, rng = hand.look, hand.rng
    shapes = hand.shapes(item)
    if hand.is_round and isinstance(shapes[0], Polygon) and min(length, depth) > 0.25:
        shapes[0] = shapes[0].buffer(-0.06, join_style="mitre").buffer(0.06)
    placed = [
        affinity.translate(
            affinity.rotate(shape, item.box.yaw_deg, origin=(0, 0)), *item.box.center_m[:2]
        )
        for shape in shapes
    ]
    canvas.fill(footprint_polygon(item.box), None, laid=PIECE)
    if hand.has_meshes and draw_from_above(canvas, item, rng, has_shadow=look.has_shadows):
        return
    fill = hand.color(item.category)
    if hand.habit is not None and item.category in having("worktop") and not hand.has_worktop_lines:
        fill = None
    if fill is not None:
        _fill_body(canvas, placed[0], fill, hand)
    has_lines = look.pieces != "photo" or rng.random() < 0.4
    dash_m = 0.0 if item.category in FIXTURES else hand.broken_m
    for index, shape in enumerate(placed):
        if index and fill is not None and isinstance(shape, Polygon) and rng.random() < 0.7:
            shade = rng.integers(-30, 45)
            red, green, blue = (int(np.clip(v + shade, 0, 255)) for v in fill)
            canvas.fill(shape, (red, green, blue))
        if index and hand.is_solid and _is_small(shape):
            canvas.fill(shape, look.piece_rgb)
        if not index and item.category in having("worktop") and not hand.has_worktop_lines:
            continue
        if has_lines:
            canvas.outline(shape, look.piece_rgb, hand.line_px, dash_m)


def _is_small(shape: BaseGeometry) -> bool:
    return isinstance(shape, Polygon) and shape.area < _SMALL_M2


def _fill_body(canvas: Canvas, body: BaseGeometry, rgb: RGB, hand: Hand) -> None:
    if hand.look.has_shadows:
        shadow = affinity.translate(body, 0.05, -0.05)
        canvas.paint(shadow, np.zeros((8, 8, 3), np.uint8), opacity=0.35)
    if hand.look.pieces == "photo" and hand.rng.random() < 0.5:
        canvas.paint(body, tiles(canvas.px_per_m, np.array(rgb, np.float64), hand.rng))
    else:
        canvas.fill(body, rgb)


def _box(left: float, low: float, right: float, high: float) -> Polygon:
    return shapely.box(min(left, right), min(low, high), max(left, right), max(low, high))


def _oval(x: float, y: float, wide: float, deep: float) -> Polygon:
    return affinity.translate(affinity.scale(Point(0, 0).buffer(1.0, 8), wide, deep), x, y)


def _soft(left: float, low: float, right: float, high: float, radius: float) -> Polygon:
    return _box(left, low, right, high).buffer(-radius, join_style="mitre").buffer(radius, 4)


def _plain(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    body = _box(-length / 2, -depth / 2, length / 2, depth / 2)
    if rng.random() < 0.3:
        return [body, body.buffer(-0.1 * min(length, depth), join_style="mitre")]
    return [body]


def _cupboard(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """A box with one diagonal or two, a rail with hangers, or doors."""
    body = _box(-length / 2, -depth / 2, length / 2, depth / 2)
    diagonal = LineString([(-length / 2, -depth / 2), (length / 2, depth / 2)])
    other = LineString([(-length / 2, depth / 2), (length / 2, -depth / 2)])
    rail: Shapes = [LineString([(-length / 2, 0), (length / 2, 0)])]
    rail += [
        LineString([(x, -0.35 * depth), (x + 0.06, 0.35 * depth)])
        for x in np.arange(-length / 2 + 0.1, length / 2 - 0.1, 0.15)
    ]
    front = LineString([(-length / 2, -0.4 * depth), (length / 2, -0.4 * depth)])
    choices: tuple[Shapes, ...] = ([diagonal], [diagonal, other], rail, [front], [])
    return [body, *choices[int(rng.integers(len(choices)))]]


def _bed(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    body = _box(-length / 2, -depth / 2, length / 2, depth / 2)
    count = 1 if length < 1.3 else 2
    shapes: Shapes = [body]
    for index in range(count):
        middle = (index - (count - 1) / 2) * length * 0.46
        half = 0.2 * length if count == 2 else 0.36 * length
        shapes.append(_soft(middle - half, 0.26 * depth, middle + half, 0.45 * depth, 0.05))
    fold = rng.uniform(0.05, 0.2) * depth
    if rng.random() < 0.7:
        shapes.append(_box(-length / 2, -depth / 2, length / 2, fold))
    if rng.random() < 0.3:
        corner = [(-length / 2, fold), (length / 2, fold), (length / 2, fold - 0.3 * depth)]
        shapes.append(Polygon(corner))
    return shapes


def _sofa(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    body = _box(-length / 2, -depth / 2, length / 2, depth / 2)
    arm = min(0.18, 0.15 * length)
    shapes: Shapes = [body]
    seats = max(1, round((length - 2 * arm) / 0.75))
    wide = (length - 2 * arm) / seats
    for index in range(seats):
        left = -length / 2 + arm + index * wide
        shapes.append(_soft(left, -depth / 2, left + wide, 0.25 * depth, 0.04))
    if rng.random() < 0.5:
        shapes.append(_box(-length / 2, 0.25 * depth, length / 2, depth / 2))
    return shapes


def _toilet(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    bowl = _oval(0, -0.12 * depth, 0.42 * length, 0.37 * depth)
    tank = _box(-length / 2, 0.27 * depth, length / 2, depth / 2)
    if rng.random() < 0.3:
        return [bowl.union(_box(-0.3 * length, 0, 0.3 * length, depth / 2)), bowl]
    inner = _oval(0, -0.12 * depth, 0.28 * length, 0.25 * depth)
    return [tank, bowl, inner] if rng.random() < 0.5 else [tank, bowl]


def _basin(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    body = _box(-length / 2, -depth / 2, length / 2, depth / 2)
    if rng.random() < 0.25:
        body = _soft(-length / 2, -depth / 2, length / 2, depth / 2, 0.4 * depth)
    bowl = _oval(0, 0, min(0.42 * length, 0.3), 0.32 * depth)
    if rng.random() < 0.3:
        bowl = _soft(-0.3 * length, -0.32 * depth, 0.3 * length, 0.32 * depth, 0.05)
    tap = _oval(0, 0.38 * depth, 0.03, 0.03)
    return [body, bowl, tap]


def _bath(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    body = _box(-length / 2, -depth / 2, length / 2, depth / 2)
    short = min(length, depth)
    edge = 0.08 * max(length, depth)
    radius = rng.uniform(0.1, 0.3) * short
    inner = _soft(
        -length / 2 + edge, -depth / 2 + edge, length / 2 - edge, depth / 2 - edge, radius
    )
    drain = _oval(-0.36 * length if length > depth else 0, 0 if length > depth else 0.36 * depth,
                  0.04, 0.04)  # fmt: skip
    return [body, inner, drain]


def _shower(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    shapes = _cupboard(length, depth, rng)[:1]
    corners = [(-length / 2, -depth / 2), (length / 2, depth / 2)]
    others = [(-length / 2, depth / 2), (length / 2, -depth / 2)]
    kind = int(rng.integers(4))
    if kind == 0:
        return [*shapes, LineString(corners), LineString(others), _oval(0, 0, 0.05, 0.05)]
    if kind == 1:
        return [*shapes, _oval(0.3 * length, 0.3 * depth, 0.1, 0.1), LineString(corners)]
    if kind == 2:
        quarter = Point(length / 2, depth / 2).buffer(max(length, depth))
        return [shapes[0].intersection(quarter), _oval(0.1, 0.1, 0.04, 0.04)]
    lines: Shapes = [
        LineString([(-length / 2, y), (length / 2, y)])
        for y in np.arange(-depth / 2, depth / 2, 0.12)
    ]
    return [*shapes, *lines]


def _hob(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    body = _box(-length / 2, -depth / 2, length / 2, depth / 2)
    radius = 0.13 * min(length, depth)
    half = min(length, 0.6) / 2
    rings: Shapes = [
        _oval(x * 0.5 * half, y * 0.22 * depth, radius, radius) for x in (-1, 1) for y in (-1, 1)
    ]
    frame = _box(-half * 0.95, -0.42 * depth, half * 0.95, 0.42 * depth)
    return [body, frame, *rings] if rng.random() < 0.6 else [body, *rings]


def _sink(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    body = _box(-length / 2, -depth / 2, length / 2, depth / 2)
    half = min(length, 0.9) / 2
    bowl = _soft(-half * 0.9, -0.3 * depth, -half * 0.05, 0.3 * depth, 0.05)
    other = _soft(half * 0.05, -0.3 * depth, half * 0.9, 0.3 * depth, 0.05)
    ribs: Shapes = [
        LineString([(x, -0.28 * depth), (x, 0.28 * depth)])
        for x in np.linspace(half * 0.15, half * 0.85, 5)
    ]
    return [body, bowl, other] if rng.random() < 0.5 else [body, bowl, *ribs]


def _washer(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    body = _box(-length / 2, -depth / 2, length / 2, depth / 2)
    if rng.random() < 0.6:
        return [body, _oval(0, 0, 0.36 * length, 0.36 * depth)]
    return [body, LineString([(-length / 2, -depth / 2), (length / 2, depth / 2)])]


def _table(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    if rng.random() < 0.3:
        return [_oval(0, 0, length / 2, depth / 2)]
    return _plain(length, depth, rng)


def _chair(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    if rng.random() < 0.25:
        return [_oval(0, 0, length / 2, depth / 2)]
    seat = _soft(-length / 2, -depth / 2, length / 2, 0.35 * depth, 0.06)
    return [seat, _box(-0.45 * length, 0.35 * depth, 0.45 * length, depth / 2)]


_DRAWN: dict[str, Draw] = {
    "bed": _bed, "sofa": _sofa, "leisure_sofa": _sofa, "single_sofa": _sofa, "toilet": _toilet,
    "washbasin": _basin, "washing_set": _basin, "bathtub": _bath, "shower": _shower,
    "cooker_cabinet": _hob, "sink_cabinet": _sink, "washing_machine": _washer,
    "table": _table, "dining_table": _table, "coffee_table": _table, "side_coffee_table": _table,
    "chair": _chair, "cabinet": _cupboard, "refrigerator": _cupboard, "dining_cabinet": _cupboard,
}  # fmt: skip


def plant(middle: tuple[float, float], radius: float, rng: np.random.Generator) -> Shapes:
    """A pot plant or a tree: leaves about a middle."""
    shapes: Shapes = [Point(*middle).buffer(radius, 6)]
    for angle in np.linspace(0, 2 * math.pi, int(rng.integers(5, 12)), endpoint=False):
        tip = middle[0] + radius * math.cos(angle), middle[1] + radius * math.sin(angle)
        shapes.append(LineString([middle, tip]))
    return shapes
