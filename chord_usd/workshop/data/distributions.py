"""How pieces are sized and placed, measured, and how far two sets of rooms are apart in it.

Everything is a distribution of single numbers; two of them are compared by the Wasserstein
distance, which has the unit of what is measured: how far, on average, a value would have to be
moved to turn one distribution into the other.
"""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import shapely

from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    front_direction,
    room_polygon,
)
from chord_usd.base.scene.types import Item, RoomKind, SceneGraph

PIECES: tuple[str, ...] = (
    "bed", "bedside_table", "cabinet", "table", "sofa", "coffee_table", "tv_cabinet",
    "side_coffee_table", "single_sofa", "dining_table", "chair",
)  # fmt: skip
"""What stands in bedrooms and living rooms of both."""

PAIRS: tuple[tuple[str, str], ...] = (
    ("bedside_table", "bed"), ("cabinet", "bed"), ("table", "bed"), ("coffee_table", "sofa"),
    ("tv_cabinet", "sofa"), ("side_coffee_table", "sofa"), ("single_sofa", "sofa"),
    ("chair", "dining_table"),
)  # fmt: skip
"""For each piece of the first category, how far the nearest of the second is."""

KINDS: tuple[RoomKind, ...] = ("bedroom", "living", "dining")

FEWEST = 20
"""Distributions of fewer values are not compared."""

Key = tuple[str, str]
"""What is measured, and of what: ("length m", "bed")."""

Samples = Mapping[Key, list[float]]


class Distance(NamedTuple):
    """How far two distributions are apart."""

    measure: str
    piece: str
    ours: float
    """Median."""
    theirs: float
    distance: float
    """Wasserstein distance, in the unit of the measure."""
    ours_n: int
    theirs_n: int


def measure(scenes: Iterable[SceneGraph]) -> Samples:
    """Sizes, gaps to the wall and to partners, and how squarely pieces stand to their wall.

    "length m", "depth m", "height m": of the piece. "wall m": from the middle of its back to the
    nearest wall. "turn deg": from looking straight away from that wall, 0 to 180. "gap m": between
    the footprints of a piece and the nearest of its partners in the same room.
    """
    samples: dict[Key, list[float]] = defaultdict(list)
    for scene in scenes:
        for room in scene.rooms:
            if room.kind not in KINDS:
                continue
            items = [item for item in scene.items_of(room.id) if item.category in PIECES]
            outline = room_polygon(room).exterior
            for key, value in (*_sizes(items), *_to_walls(items, outline), *_gaps(items)):
                samples[key].append(value)
    return samples


def compare(ours: Samples, theirs: Samples) -> list[Distance]:
    """A row for every measure that both sides have enough values of, in a steady order."""
    from scipy.stats import wasserstein_distance

    rows = []
    for key in sorted(ours.keys() & theirs.keys()):
        a, b = sorted(ours[key]), sorted(theirs[key])
        if min(len(a), len(b)) >= FEWEST:
            distance = float(wasserstein_distance(a, b))
            medians = a[len(a) // 2], b[len(b) // 2]
            rows.append(Distance(*key, *medians, distance, len(a), len(b)))
    return rows


def as_text(rows: Iterable[Distance]) -> str:
    """The table, for people."""
    lines = [
        f"{'measure':<10} {'piece':<26} {'ours':>7} {'theirs':>7} {'distance':>8} {'n':>6} {'n':>6}"
    ]
    lines += [
        f"{row.measure:<10} {row.piece:<26} {row.ours:>7.2f} {row.theirs:>7.2f} "
        f"{row.distance:>8.3f} {row.ours_n:>6} {row.theirs_n:>6}"
        for row in rows
    ]
    return "\n".join(lines)


def _sizes(items: Iterable[Item]) -> Iterator[tuple[Key, float]]:
    for item in items:
        for name, value in zip(("length m", "depth m", "height m"), item.box.size_m, strict=True):
            yield (name, item.category), value


def _to_walls(items: Iterable[Item], outline: shapely.LinearRing) -> Iterator[tuple[Key, float]]:
    for item in items:
        corners = footprint(item.box)
        back = shapely.Point((corners[0] + corners[3]) / 2)
        yield ("wall m", item.category), float(outline.distance(back))
        yield ("turn deg", item.category), _turn_deg(item, outline, back)


def _turn_deg(item: Item, outline: shapely.LinearRing, back: shapely.Point) -> float:
    """Between the front and the inward normal of the wall that is nearest to the back."""
    points = list(outline.coords)
    sides = [shapely.LineString(points[i : i + 2]) for i in range(len(points) - 1)]
    nearest = min(range(len(sides)), key=lambda i: sides[i].distance(back))
    (ax, ay), (bx, by) = points[nearest], points[nearest + 1]
    # Corners run counter-clockwise: the room is on the left of every side.
    front_x, front_y = front_direction(item.box.yaw_deg)
    length = math.hypot(bx - ax, by - ay)
    cosine = (front_y * (bx - ax) - front_x * (by - ay)) / length if length else 0.0
    return math.degrees(math.acos(max(-1.0, min(1.0, cosine))))


def _gaps(items: list[Item]) -> Iterator[tuple[Key, float]]:
    prints = [footprint_polygon(item.box) for item in items]
    for first, second in PAIRS:
        others = [p for p, item in zip(prints, items, strict=True) if item.category == second]
        if not others:
            continue
        for outline, item in zip(prints, items, strict=True):
            if item.category == first:
                yield ("gap m", f"{first} - {second}"), min(outline.distance(o) for o in others)
