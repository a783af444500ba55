"""Symbols of furniture and appliances in many hands."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from shapely import affinity
from shapely.geometry import Polygon

from chord_usd.workshop.data.drawn.fixture_symbols import (
    basin,
    hob,
    shower,
    sink,
    toilet,
    tub,
)
from chord_usd.workshop.data.drawn.symbol_shapes import (
    Draw,
    Shapes,
    box,
    diagonals,
    inset,
    line,
    oval,
    rectangle,
    scaled,
    soft,
    taper,
    word_of,
)


def bed(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """Pillows, blankets, folded corners, head boards."""
    half, back, front = length / 2, depth / 2, -depth / 2
    body: Polygon = rectangle(length, depth)
    if rng.random() < 0.2:
        body = soft(-half, front, half, back, 0.08)
    shapes: Shapes = [body]
    head = 0.0
    if rng.random() < 0.25:
        head = rng.uniform(0.04, 0.12)
        shapes.append(box(-half, back - head, half, back))
    count = 1 if length < 1.15 else (2 if length < 1.3 or rng.random() < 0.85 else 1)
    tall = rng.uniform(0.25, 0.5)
    gap = rng.uniform(0.03, 0.1)
    top = back - head - gap
    for index in range(count):
        wide = (length - (count + 1) * gap) / count
        left = -half + gap + index * (wide + gap)
        radius = float(rng.choice([0.0, 0.06, 0.15]))
        shapes.append(soft(left, top - tall, left + wide, top, radius))
        if rng.random() < 0.1:
            shapes.append(scaled(box(left, top - tall, left + wide, top), 0.7))
    fold = top - tall - rng.uniform(0.02, 0.3)
    shapes += _blanket(half, front, fold, rng)
    if rng.random() < 0.15:
        shapes.append(box(-half, front, half, front + rng.uniform(0.3, 0.6)))
    if rng.random() < 0.1:
        shapes += [line((x, front), (x, fold)) for x in np.arange(-half + 0.1, half, 0.15)]
    return shapes


def _blanket(half: float, front: float, fold: float, rng: np.random.Generator) -> Shapes:
    """From the foot of a bed up to the fold, in one of several ways."""
    shapes: Shapes = []
    kind = int(rng.integers(8))
    if kind == 0:
        shapes.append(line((-half, fold), (half, fold)))
    elif kind == 1:
        shapes.append(box(-half, front, half, fold))
        shapes.append(line((-half, fold - 0.2), (half, fold - 0.2)))
    elif kind in (2, 3):  # a corner turned down
        width, high = rng.uniform(0.6, 1.8) * half, rng.uniform(0.2, 0.6)
        side = float(rng.choice([-1, 1]))
        shapes.append(line((-half, fold), (half, fold)))
        fly = Polygon([(half, fold), (half - width, fold), (half, fold - high)])
        mirrored = Polygon([(half - width, fold), (half, fold - high), (half - width, fold - high)])
        corner = fly if rng.random() < 0.6 else mirrored
        shapes.append(affinity.scale(corner, side, 1.0, origin=(0, 0)))
    elif kind == 4:
        shapes.append(soft(-half + 0.04, front + 0.04, half - 0.04, fold, 0.1))
    elif kind == 5:  # one blanket each
        shapes += [box(-half, front, 0, fold), box(0, front, half, fold)]
    elif kind == 6:
        shapes.append(line((-half, fold), (half, fold - rng.uniform(-0.5, 0.5))))
    return shapes


def sofa(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """Arms, back and seats in several forms."""
    half, back, front = length / 2, depth / 2, -depth / 2
    arm, rest = rng.uniform(0.08, 0.24), rng.uniform(0.12, 0.3)
    kind = int(rng.integers(6))
    body: Polygon = rectangle(length, depth)
    if kind == 0:
        body = soft(-half, front, half, back, rng.uniform(0.08, 0.3))
    if kind == 1:
        arm = 0.0
    seats = max(1, round((length - 2 * arm) / rng.uniform(0.6, 0.9)))
    wide = (length - 2 * arm) / seats
    shapes: Shapes = [body]
    low = front + (rng.uniform(0.0, 0.08) if rng.random() < 0.3 else 0.0)
    for index in range(seats):
        left = -half + arm + index * wide
        radius = float(rng.choice([0.0, 0.04, 0.1]))
        shapes.append(soft(left, low, left + wide, back - rest, radius))
        if kind == 2:
            shapes.append(soft(left, back - rest, left + wide, back - 0.05, 0.05))
    if kind == 3:
        shapes[1:] = [line((-half + arm, front), (-half + arm, back - rest),
                            (half - arm, back - rest), (half - arm, front))]  # fmt: skip
    if kind == 4 and arm:
        shapes += [
            soft(x, front - 0.02, x + arm, back - rest, 0.5 * arm) for x in (-half, half - arm)
        ]
    if rng.random() < 0.2:
        shapes += [affinity.rotate(soft(x - 0.18, -0.18, x + 0.18, 0.18, 0.08), 40)
                   for x in (-half + 0.4, half - 0.4)]  # fmt: skip
    if length > 2.0 and rng.random() < 0.25:
        side = float(rng.choice([-1, 1]))
        reach = rng.uniform(0.4, 0.8)
        chaise = box(side * half, front - reach, side * (half - 0.85), front)
        shapes[0] = body.union(chaise)
    return shapes


def armchair(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """A sofa for one, a tub chair, an easy chair."""
    if rng.random() < 0.2:
        body = oval(0, 0, length / 2, depth / 2)
        return [body, oval(0, -0.1 * depth, 0.33 * length, 0.33 * depth)]
    return sofa(length, depth, rng)


def table(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """Square, round, oval; plain or with a rim, panes or a middle line."""
    kind = int(rng.integers(8))
    body: Polygon = rectangle(length, depth)
    if kind < 2:
        body = oval(0, 0, length / 2, depth / 2)
    elif kind == 2:
        left, low, right, high = body.bounds
        body = soft(left, low, right, high, rng.uniform(0.05, 0.3) * depth)
    shapes: Shapes = [body]
    more = int(rng.integers(6))
    if more == 0:
        shapes.append(scaled(body, rng.uniform(0.75, 0.93)))
    elif more == 1:
        shapes.append(line((-length / 2, 0), (length / 2, 0)))
    elif more == 2:
        shapes += [line((x - 0.1, -0.1), (x + 0.1, 0.1)) for x in (-0.12, 0, 0.12)]
    return shapes


def desk(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """A desk with a screen, a lamp, drawers, or nothing."""
    shapes: Shapes = [rectangle(length, depth)]
    kind = int(rng.integers(4))
    if kind == 0:
        shapes += [
            box(-0.25, 0.2 * depth, 0.25, 0.3 * depth),
            box(-0.2, -0.3 * depth, 0.2, -0.1 * depth),
        ]
    elif kind == 1:
        shapes.append(box(length / 2 - 0.4, -depth / 2, length / 2, depth / 2))
    elif kind == 2:
        shapes.append(oval(-0.35 * length, 0.25 * depth, 0.08, 0.08))
    return shapes


def chair(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """A seat with a back."""
    half, back, front = length / 2, depth / 2, -depth / 2
    kind = int(rng.integers(7))
    seat = soft(-half, front, half, 0.35 * depth, 0.06)
    if kind == 0:
        return [oval(0, 0, half, depth / 2)]
    if kind == 1:
        return [rectangle(length, depth)]
    if kind == 2:
        return [taper(half, half, back, front)]
    if kind == 3:
        ring = oval(0, 0, half, depth / 2)
        return [ring, ring.intersection(box(-half, 0.15 * depth, half, back))]
    if kind == 4:
        return [
            soft(-half, front, half, back, 0.1),
            line((-half, 0.25 * depth), (half, 0.25 * depth)),
        ]
    if kind == 5:
        arms = [soft(x - 0.04, front, x + 0.04, 0.3 * depth, 0.03) for x in (-half, half)]
        return [seat, box(-0.9 * half, 0.35 * depth, 0.9 * half, back), *arms]
    return [seat, box(-0.9 * half, 0.35 * depth, 0.9 * half, back)]


def wardrobe(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """Diagonals, rails with hangers, doors, boards, one cross a leaf."""
    half, back, front = length / 2, depth / 2, -depth / 2
    first, other = diagonals(length, depth)
    count = max(1, round(length / rng.uniform(0.45, 0.7)))
    edges = np.linspace(-half, half, count + 1)
    parts: Shapes = [line((x, front), (x, back)) for x in edges[1:-1]]
    kind = int(rng.integers(10))
    shapes: Shapes = [rectangle(length, depth)]
    if kind == 0:
        shapes.append(first)
    elif kind == 1:
        shapes += [first, other]
    elif kind in (2, 3):
        shapes.append(line((-half, 0), (half, 0)))
        step, lean = rng.uniform(0.06, 0.18), rng.uniform(-0.08, 0.08)
        shapes += [line((x + rng.normal(0, 0.01), -0.35 * depth), (x + lean, 0.35 * depth))
                   for x in np.arange(-half + 0.08, half - 0.08, step)]  # fmt: skip
    elif kind == 4:
        shapes += parts + [line((a, front), (b, back)) for a, b in pairwise(edges)]
    elif kind == 5:
        shapes += parts
        for a, b in pairwise(edges):
            shapes += [line((a, front), (b, back)), line((a, back), (b, front))]
    elif kind == 6:
        shapes += [line((-half, front + 0.04), (half, front + 0.04)), *parts]
    elif kind == 7:
        shapes += [line((-half, y), (half, y)) for y in np.linspace(front, back, 5)[1:-1]]
    elif kind == 8:
        shapes += [line((-half, 0), (half, 0)), *parts]
    return shapes


def fridge(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """A diagonal, a cross, a letter, a star, a door."""
    body = rectangle(length, depth)
    first, other = diagonals(length, depth)
    word = str(rng.choice(["F", "R", "K", "KS", "REF", "FR"]))
    front = line((-length / 2, -0.4 * depth), (length / 2, -0.4 * depth))
    star: Shapes = [affinity.rotate(line((-0.16, 0), (0.16, 0)), angle, origin=(0, 0))
                    for angle in (0, 60, 120)]  # fmt: skip
    choices: tuple[Shapes, ...] = (
        [first], [first, other], word_of(word, length, depth), word_of(word, length, depth), star,
        [front], [inset(body, 0.05)], [front, line((0, -depth / 2), (0, -0.4 * depth))],
    )  # fmt: skip
    return [body, *choices[int(rng.integers(len(choices)))]]


def washer(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """A drum, a letter, a cross, a panel."""
    body: Polygon = rectangle(length, depth)
    if rng.random() < 0.2:
        left, low, right, high = body.bounds
        body = soft(left, low, right, high, 0.06)
    radius = min(length, depth) * rng.uniform(0.25, 0.42)
    drum = oval(0, rng.uniform(-0.1, 0.1) * depth, radius, radius)
    first, other = diagonals(length, depth)
    word = str(rng.choice(["W", "WM", "LM", "M", "S"]))
    panel = line((-length / 2, 0.35 * depth), (length / 2, 0.35 * depth))
    choices: tuple[Shapes, ...] = (
        [drum], [drum], [drum, scaled(drum, 0.6)], [drum, panel], word_of(word, length, depth),
        [drum, *word_of(word, 0.7 * length, 0.7 * depth)], [first], [first, other],
        [inset(body, 0.06, 0.05), drum],
    )  # fmt: skip
    return [body, *choices[int(rng.integers(len(choices)))]]


def oven(length: float, depth: float, rng: np.random.Generator) -> Shapes:
    """An appliance below a worktop: its letters, or a plain box."""
    body = rectangle(length, depth)
    return [body, *word_of("DW", length, depth)] if rng.random() < 0.3 else [body]


# Symbols of furniture and fixtures in many hands, by category ------------------------------------

DRAWN: dict[str, Draw] = {
    "bed": bed, "sofa": sofa, "leisure_sofa": armchair, "single_sofa": armchair, "toilet": toilet,
    "washbasin": basin, "washing_set": basin, "bathtub": tub, "shower": shower,
    "cooker_cabinet": hob, "sink_cabinet": sink, "washing_machine": washer, "table": desk,
    "dining_table": table, "coffee_table": table, "side_coffee_table": table, "chair": chair,
    "cabinet": wardrobe, "refrigerator": fridge, "electrical_floor_cabinet": oven,
}  # fmt: skip
"""How pieces of each category are drawn; every call another way, by its generator."""
