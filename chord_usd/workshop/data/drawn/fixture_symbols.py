"""Symbols of fixtures in many hands: WC, basin, bath, shower, hob, sink."""

from __future__ import annotations

import math

import numpy as np
from shapely import affinity
from shapely.geometry import Point, Polygon

from chord_usd.workshop.data.drawn.symbol_shapes import (
    Shapes,
    box,
    diagonals,
    inset,
    line,
    oval,
    rectangle,
    scaled,
    soft,
    tap_of,
    taper,
)

_OPEN_SHOWERS = 0.35
"""Share of showers without a tray."""


def toilet(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """Cistern and bowl, a bowl on the wall, squarish ones."""
    half, back, front = length / 2, depth / 2, -depth / 2
    deep = depth * rng.uniform(0.2, 0.34)
    tank = box(-half, back - deep, half, back)
    if rng.random() < 0.3:
        tank = soft(-half, back - deep, half, back, 0.05)
    bowl_back = back - deep + rng.uniform(-0.02, 0.08)
    middle, reach = (bowl_back + front) / 2, (bowl_back - front) / 2
    wide = half * rng.uniform(0.7, 0.98)
    kind = int(rng.integers(8))
    if kind < 3:
        bowl: Polygon = oval(0, middle, wide, reach)
    elif kind == 3:
        bowl = taper(wide, wide * rng.uniform(0.75, 1.0), back - deep, front)
    elif kind == 4:
        bowl = soft(-wide, front, wide, back - deep, 0.6 * wide)
    elif kind == 5:  # hung on the wall: no cistern
        body = taper(wide, wide * rng.uniform(0.85, 1.0), back, front)
        return [body, scaled(body, rng.uniform(0.6, 0.8))] if rng.random() < 0.7 else [body]
    elif kind == 6:  # bowl and cistern in one line
        body = box(-0.8 * half, middle, 0.8 * half, back).union(oval(0, middle, wide, reach))
        seat = oval(0, middle, 0.7 * wide, 0.75 * reach)
        return [body, seat, line((-0.8 * half, back - deep), (0.8 * half, back - deep))]
    else:
        bowl = oval(0, front + wide, wide, wide)
        tank = box(-half, front + 1.9 * wide, half, back)
    shapes: Shapes = [tank, bowl]
    if rng.random() < 0.55:
        shapes.append(scaled(bowl, rng.uniform(0.55, 0.8)))
    if rng.random() < 0.2:
        shapes.append(oval(0, back - deep / 2, 0.03, 0.03))
    if rng.random() < 0.15:
        shapes.append(line((-wide, bowl_back - 0.04), (wide, bowl_back - 0.04)))
    return shapes


def _bowl(x: float, y: float, wide: float, deep: float, rng: np.random.Generator) -> Shapes:
    """A wash bowl about a middle."""
    kind = int(rng.integers(6))
    if kind < 2:
        return [oval(x, y, wide, deep)]
    if kind == 2:
        return [soft(x - wide, y - deep, x + wide, y + deep, 0.3 * deep)]
    if kind == 3:
        size = min(wide, deep)
        return [oval(x, y, size, size), oval(x, y, 0.03, 0.03)]
    if kind == 4:  # straight at the back
        half = oval(x, y + deep, wide, 2 * deep)
        return [half.intersection(box(x - wide, y - deep, x + wide, y + deep))]
    return [oval(x, y, wide, deep), oval(x, y, 0.75 * wide, 0.75 * deep), oval(x, y, 0.025, 0.025)]


def basin(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """A wash basin, or a vanity with one bowl or two."""
    half, back, front = length / 2, depth / 2, -depth / 2
    body = rectangle(length, depth)
    bowls = 2 if length > 1.05 and rng.random() < 0.6 else 1
    if bowls == 1 and length < 0.85:
        kind = int(rng.integers(7))
        if kind == 0:
            body = taper(half, min(half, 0.6 * depth), back, front)
        elif kind == 1:
            body = soft(-half, front, half, back, 0.45 * depth)
        elif kind == 2:  # half an ellipse against the wall
            body = oval(0, back, half, depth).intersection(body)
        elif kind == 3:
            body = Polygon([(-half, back), (half, back), (0.7 * half, front), (-0.7 * half, front)])
        elif kind == 4:
            inner = scaled(body, rng.uniform(0.65, 0.85))
            return [body, inner, *tap_of(0.42 * depth, rng)]
        elif kind == 5:
            body = oval(0, 0, half, depth / 2)
    wide, deep = min(0.8 * half / bowls, rng.uniform(0.18, 0.3)), rng.uniform(0.28, 0.38) * depth
    shapes: Shapes = [body]
    for index in range(bowls):
        x = (index - (bowls - 1) / 2) * length * 0.5
        if bowls == 1 and length > 0.9 and rng.random() < 0.3:
            x = rng.choice([-1, 1]) * (half - wide - 0.1)
        bowl = [*_bowl(0, -0.04 * depth, wide, deep, rng), *tap_of(0.42 * depth, rng)]
        shapes += [affinity.translate(shape, x, 0) for shape in bowl]
    return shapes


def tub(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """A bath: the box and the basin in it, in several forms; standing free; with a slanted side."""
    half, back = length / 2, depth / 2
    body = rectangle(length, depth)
    edge = rng.uniform(0.03, 0.12)
    kind = int(rng.integers(8))
    side = float(rng.choice([-1, 1]))
    if kind < 2:
        inner: Polygon = inset(body, edge, rng.uniform(0.05, 0.3) * depth)
    elif kind == 2:
        inner = oval(0, 0, half - edge, back - edge)
    elif kind < 5:  # one end round, the other straight or nearly
        radius = back - edge
        straight = soft(edge - half, edge - back, half - edge - radius, back - edge, 0.05)
        straight = straight.union(box(0, edge - back, half - edge - radius, back - edge))
        inner = straight.union(oval(half - edge - radius, 0, radius, radius))
    elif kind == 5:  # narrower at the feet
        low = rng.uniform(0.5, 0.8) * (back - edge)
        corners = [(edge - half, back - edge), (edge - half, edge - back), (half - edge, -low),
                   (half - edge, low)]  # fmt: skip
        inner = Polygon(corners).buffer(-0.1).buffer(0.1, 4)
    elif kind == 6:
        body = soft(-half, -back, half, back, rng.uniform(0.3, 0.5) * depth)
        inner = inset(body, edge + 0.02, 0.4 * depth)
    else:
        body = Polygon([(-half, back), (-half, -0.3 * back), (-0.4 * half, -back), (half, -back),
                        (half, back)])  # fmt: skip
        inner = body.buffer(-edge - 0.05).buffer(0.05, 4)
    shapes: Shapes = [body, inner]
    if rng.random() < 0.3:
        shapes.append(scaled(inner, rng.uniform(0.8, 0.93)))
    if rng.random() < 0.7:
        radius = rng.uniform(0.025, 0.05)
        x = (half - edge - rng.uniform(0.1, 0.3)) * float(
            rng.choice([-1, 1, 0], p=[0.45, 0.45, 0.1])
        )
        shapes.append(oval(x, 0, radius, radius))
    if rng.random() < 0.25:
        x = -half + 0.5 * edge
        shapes += [oval(x, y, 0.025, 0.025) for y in (-0.08, 0.08)]
    return [affinity.scale(shape, side, 1.0, origin=(0, 0)) for shape in shapes]


def shower(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """A tray: crossed, drained, tiled, round or cut at one corner, with or without a screen."""
    half, back = length / 2, depth / 2
    body: Polygon = rectangle(length, depth)
    side = float(rng.choice([-1, 1]))
    if rng.random() < _OPEN_SHOWERS:
        return _open_shower(half, back, side, rng)
    shapes: Shapes = []
    if rng.random() < 0.3:  # round, or cut at the corner that lies open
        radius = min(length, depth) * rng.uniform(0.55, 1.0)
        corner = (-half + radius, -back + radius)
        cut = box(-half, -back, *corner).difference(Point(*corner).buffer(radius, 16))
        if rng.random() < 0.3:
            cut = Polygon([(-half, -back), (corner[0], -back), (-half, corner[1])])
        body = body.difference(cut)
        shapes.append(body.buffer(-rng.uniform(0.03, 0.08), join_style="mitre"))
    shapes += _fall(body, half, back, rng)
    if rng.random() < 0.15:
        shapes.append(line((-half, -back), (-half - 0.5, -back - 0.5)))
    return [affinity.scale(shape, side, 1.0, origin=(0, 0)) for shape in [body, *shapes]]


def _fall(body: Polygon, half: float, back: float, rng: np.random.Generator) -> Shapes:
    """What says of a tray that water runs off it, or falls on it."""
    first, other = diagonals(2 * half, 2 * back)
    shapes: Shapes = []
    drain = oval(0, 0, *[rng.uniform(0.03, 0.07)] * 2)
    kind = int(rng.integers(9))
    if kind == 0:
        shapes += [first, other, drain]
    elif kind == 1:
        shapes += [first, other]
    elif kind == 2:
        shapes += [first]
    elif kind == 3:
        shapes += [drain, inset(body, rng.uniform(0.03, 0.1), rng.uniform(0, 0.1))]
    elif kind == 4:  # a head in the corner, with its spray
        tip = (half - 0.12, back - 0.12)
        shapes += [oval(*tip, 0.06, 0.06), drain]
        shapes += [line(tip, (tip[0] - 0.5 * math.cos(a), tip[1] - 0.5 * math.sin(a)))
                   for a in (0.3, 0.6, 0.9, 1.2)]  # fmt: skip
    elif kind == 5:
        step = rng.uniform(0.09, 0.2)
        shapes += [line((-half, y), (half, y)) for y in np.arange(-back + step, back, step)]
        if rng.random() < 0.6:
            shapes += [line((x, -back), (x, back)) for x in np.arange(-half + step, half, step)]
    elif kind == 6:
        shapes += [drain] + [line((0, 0), (x, y)) for x in (-half, half) for y in (-back, back)]
        shapes += [inset(body, 0.04)]
    elif kind == 7:
        shapes += [oval(half - 0.2, back - 0.2, 0.1, 0.1), oval(half - 0.2, back - 0.2, 0.05, 0.05)]
    else:
        grid = [(x, y) for x in np.linspace(-0.6, 0.6, 5) for y in np.linspace(-0.6, 0.6, 5)]
        shapes += [oval(x * half, y * back, 0.012, 0.012) for x, y in grid]
    return shapes


def _open_shower(half: float, back: float, side: float, rng: np.random.Generator) -> Shapes:
    """Without a tray: a head on its arm, tiles or none, a screen at a side, in front or none."""
    shapes: Shapes = []
    screen = box(side * half, -back, side * (half - 0.03), back)
    where = int(rng.integers(4))
    if where == 0:
        screen = box(-half, -back, half, 0.03 - back)
    if where < 3:
        shapes.append(screen)
    if rng.random() < 0.4:
        step = rng.uniform(0.2, 0.45)
        shapes += [line((-half, y), (half, y)) for y in np.arange(step - back, back, step)]
        shapes += [line((x, -back), (x, back)) for x in np.arange(step - half, half, step)]
    reach, radius = rng.uniform(0.1, 0.45), rng.uniform(0.05, 0.16)
    x = float(rng.choice([0.0, 0.0, rng.uniform(-0.5, 0.5) * half]))
    head = oval(x, back - reach - radius, radius, radius)
    shapes.append(head)
    if rng.random() < 0.4:
        shapes.append(scaled(head, rng.uniform(0.3, 0.75)))
    wide = float(rng.choice([0.0, 0.015, 0.03]))
    shapes += [line((x + off, back), (x + off, back - reach)) for off in sorted({-wide, wide})]
    if rng.random() < 0.4:
        shapes.append(box(x - 0.08, back - 0.03, x + 0.08, back))
    return shapes


def bidet(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """An oval bowl with a tap, and no cistern."""
    back = depth / 2
    body = taper(length / 2, length / 2.3, back, -back)
    if rng.random() < 0.4:
        body = oval(0, 0, length / 2, back)
    return [body, scaled(body, rng.uniform(0.6, 0.8)), oval(0, 0.3 * depth, 0.03, 0.03)]


def _ring(x: float, y: float, radius: float, way: int) -> Shapes:
    ring = oval(x, y, radius, radius)
    if way == 1:
        return [ring, oval(x, y, 0.5 * radius, 0.5 * radius)]
    if way == 2:
        return [
            ring,
            line((x - radius, y), (x + radius, y)),
            line((x, y - radius), (x, y + radius)),
        ]
    if way == 3:
        return [
            box(x - radius, y - radius, x + radius, y + radius),
            oval(x, y, 0.6 * radius, 0.6 * radius),
        ]
    if way == 4:
        shapes: Shapes = [ring]
        for angle in (0.79, 2.36, 3.93, 5.5):
            c, s = radius * math.cos(angle), radius * math.sin(angle)
            shapes.append(line((x + 0.6 * c, y + 0.6 * s), (x + 1.3 * c, y + 1.3 * s)))
        return shapes
    return [ring]


_RINGS: tuple[tuple[tuple[float, float, float], ...], ...] = (
    ((-0.5, 0.45, 1), (0.5, 0.45, 1), (-0.5, -0.45, 1), (0.5, -0.45, 1)),
    ((-0.5, 0.45, 1), (0.5, 0.45, 1), (-0.5, -0.45, 1), (0.5, -0.45, 1)),
    ((-0.5, 0.45, 0.8), (0.5, 0.45, 1.1), (-0.5, -0.45, 1.1), (0.5, -0.45, 0.8)),
    ((-0.6, 0.5, 0.8), (0.6, 0.5, 0.8), (-0.6, -0.5, 0.8), (0.6, -0.5, 0.8), (0, 0, 1.1)),
    ((-0.5, -0.2, 1.2), (0.5, -0.2, 1.2), (0, 0.55, 0.6)),
    ((-0.48, 0, 1.1), (0.48, 0, 1.1)),
    ((0, 0.48, 0.9), (0, -0.48, 1.1)),
    ((-0.65, 0.45, 0.8), (0, 0.45, 0.8), (0.65, 0.45, 0.8), (-0.65, -0.45, 0.8), (0, -0.45, 0.8),
     (0.65, -0.45, 0.8)),
    ((-0.5, 0.3, 1), (0.5, 0.3, 1), (0, -0.5, 1)),
)  # fmt: skip
"""Hobs: (x, y, radius) of rings, in half sides of the hob and usual radii."""


def hob(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """Rings of many kinds, in a frame or on the worktop, with knobs, as gas, glass or a range."""
    body = rectangle(length, depth)
    half = min(length, rng.choice([0.6, 0.6, 0.75])) / 2 * rng.uniform(0.85, 1.0)
    deep = depth / 2 * rng.uniform(0.75, 0.97)
    rings = _RINGS[int(rng.integers(len(_RINGS)))]
    way = int(rng.choice(6, p=[0.45, 0.22, 0.1, 0.08, 0.05, 0.1]))
    radius = min(half, deep) * rng.uniform(0.27, 0.38)
    if len(rings) == 2 and rings[0][0] == 0:
        half = min(half, 0.18)
    shapes: Shapes = [body]
    if rng.random() < 0.7:
        shapes.append(soft(-half, -deep, half, deep, rng.uniform(0, 0.06)))
    for x, y, size in rings:
        shapes += _ring(x * half, y * deep, min(radius, 0.45 * half) * size, way)
    if rng.random() < 0.25:
        knobs = np.linspace(-0.7, 0.7, 4) * half
        shapes += [oval(x, -0.92 * deep, 0.02, 0.02) for x in knobs]
    if rng.random() < 0.12:
        shapes += [line((x, -deep), (x, deep)) for x in (-0.5 * half, 0.5 * half)]
        shapes += [line((-half, y), (half, y)) for y in (-0.45 * deep, 0.45 * deep)]
    if rng.random() < 0.15:
        shapes.append(line((-half, 0.8 * deep), (half, 0.8 * deep)))
    return shapes


def sink(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """One bowl, two, one and a half, round ones; with a drainer or none; in a frame or none."""
    body = rectangle(length, depth)
    half, deep = min(length, rng.uniform(0.5, 1.0)) / 2, depth / 2 * rng.uniform(0.6, 0.85)
    edge = rng.uniform(0.02, 0.06)
    radius = rng.uniform(0.0, 0.08)
    side = float(rng.choice([-1, 1]))
    shapes: Shapes = []
    if rng.random() < 0.5:
        shapes.append(soft(-half, -deep, half, deep, radius))
    kind = int(rng.integers(7))
    left, right, low, high = edge - half, half - edge, edge - deep, deep - 2 * edge
    if half < 0.32 or kind == 0:
        half_m = min(right, 0.3)
        bowls = [soft(-half_m, low, half_m, high, radius)]
    elif kind in (1, 2):
        bowls = [soft(left, low, -edge / 2, high, radius), soft(edge / 2, low, right, high, radius)]
    elif kind == 3:
        bowls = [soft(left, low, 0.3 * half, high, radius),
                 soft(0.3 * half + edge, 0, right, high, radius)]  # fmt: skip
    elif kind == 4:
        half_m = min(0.45 * half, high)
        bowls = [oval(-0.5 * half, 0, half_m, half_m)]
        if rng.random() < 0.5:
            bowls.append(oval(0.5 * half, 0, half_m, half_m))
    else:
        bowls = [soft(left, low, 0.1 * half, high, radius)]
        count = int(rng.integers(3, 8))
        xs = np.linspace(0.25 * half, right - 0.03, count)
        shapes += [line((x, low + 0.03), (x, high - 0.03)) for x in xs]
        if rng.random() < 0.3:
            shapes.append(soft(0.2 * half, low, right, high, radius))
    shapes += bowls
    if rng.random() < 0.6:
        shapes += [oval(*_middle(bowl), 0.03, 0.03) for bowl in bowls]
    if rng.random() < 0.12:
        shapes += [line(*_ends(bowl)) for bowl in bowls]
    shapes += [
        affinity.translate(shape, side * rng.uniform(0, 0.1), 0) for shape in tap_of(deep, rng)
    ]
    return [body, *(affinity.scale(shape, side, 1.0, origin=(0, 0)) for shape in shapes)]


def _middle(shape: Polygon) -> tuple[float, float]:
    return shape.centroid.x, shape.centroid.y


def _ends(shape: Polygon) -> tuple[tuple[float, float], tuple[float, float]]:
    left, low, right, high = shape.bounds
    return (left, low), (right, high)
