"""Traced floor plans (line drawings in pixels): loose wall segments to closed cells, and scale."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import polygonize, unary_union
from shapely.strtree import STRtree

Segment = tuple[float, float, float, float]
"""x0, y0, x1, y1."""

_SNAP_PX = 3.0
"""Lines nearer than this to each other, or to level and upright, are one line drawn twice."""

_GAP_PX = 10.0
"""Loose ends are drawn on to the next wall over at most this distance."""


@dataclass(frozen=True)
class Mark:
    """A labelled box of the drawing: a room's name or a fixture."""

    label: str
    x0: float
    y0: float
    x1: float
    y1: float

    @property
    def center(self) -> tuple[float, float]:
        """Its middle."""
        return (self.x0 + self.x1) / 2, (self.y0 + self.y1) / 2

    @property
    def long_side(self) -> float:
        """The longer of its two sides."""
        return max(self.x1 - self.x0, self.y1 - self.y0)


def closed_cells(walls: Iterable[Segment]) -> list[Polygon]:
    """The regions that wall segments enclose, after snapping and closing small gaps. Pixels."""
    segments = _snapped([segment for segment in walls if segment[:2] != segment[2:]])
    lines = [LineString([s[:2], s[2:]]) for s in segments if s[:2] != s[2:]]
    if not lines:
        return []
    lines += _bridges(lines)
    return [cell for cell in polygonize(unary_union(lines)) if cell.area > 1.0]


def _snapped(segments: Sequence[Segment]) -> list[Segment]:
    """Straighten lines that are almost level or upright, and put near coordinates on one line."""
    x_of = _merged_coordinates([v for s in segments for v in (s[0], s[2])])
    y_of = _merged_coordinates([v for s in segments for v in (s[1], s[3])])
    snapped = []
    for x0, y0, x1, y1 in segments:
        a, b, c, d = x_of[x0], y_of[y0], x_of[x1], y_of[y1]
        if abs(x1 - x0) <= _SNAP_PX < abs(y1 - y0) and a != c:
            a = c = min(a, c)
        elif abs(y1 - y0) <= _SNAP_PX < abs(x1 - x0) and b != d:
            b = d = min(b, d)
        snapped.append((a, b, c, d))
    return snapped


def _merged_coordinates(values: Sequence[float]) -> dict[float, float]:
    """Each value, and the most frequent value of its group of near ones."""
    unique, counts = np.unique(values, return_counts=True)
    merged: dict[float, float] = {}
    start = 0
    for index in range(1, len(unique) + 1):
        if index < len(unique) and unique[index] - unique[start] <= _SNAP_PX:
            continue
        best = start + int(np.argmax(counts[start:index]))
        merged.update({float(value): float(unique[best]) for value in unique[start:index]})
        start = index
    return merged


def _bridges(lines: list[LineString]) -> list[LineString]:
    """Short lines that carry loose ends on to the wall they almost reach."""
    tree = STRtree(lines)
    tips = [Point(line.coords[end]) for line in lines for end in (0, -1)]
    near = tree.query(tips, predicate="dwithin", distance=0.01)
    meets = np.bincount(near[0], minlength=len(tips))
    bridges = []
    for number in np.flatnonzero(meets < 2):
        index, tip = int(number) // 2, np.array(tips[number].coords[0])
        tail = np.array(lines[index].coords[-1 if number % 2 == 0 else 0])
        onward = (tip - tail) / np.linalg.norm(tip - tail)
        ray = LineString([tip + 1e-6 * onward, tip + _GAP_PX * onward])
        hits = [ray.intersection(lines[i]) for i in tree.query(ray) if i != index]
        hits = [hit for hit in hits if not hit.is_empty]
        if hits:
            nearest = min(hits, key=tips[number].distance)
            bridges.append(LineString([tuple(tip), nearest.coords[0]]))
        else:
            bridges += _to_nearest(tree, lines, index, tips[number])
    return bridges


def _to_nearest(tree: STRtree, lines: list[LineString], index: int, tip: Point) -> list[LineString]:
    """A loose end that points past everything goes to the nearest wall, if that is very near."""
    near = [i for i in tree.query(tip.buffer(2 * _SNAP_PX)) if i != index]
    if not near:
        return []
    line = lines[min(near, key=lambda i: lines[i].distance(tip))]
    foot = line.interpolate(line.project(tip))
    if not 0.0 < foot.distance(tip) <= 2 * _SNAP_PX:
        return []
    return [LineString([tip, foot])]


# --- scale -----------------------------------------------------------------------------------

_DOOR_M = 0.80
"""Width of a narrow door; what gives a drawing its scale."""

# Other things of steady size, on the same footing as the doors: medians over all 1,017 Japanese
# flats when each is scaled by its doors alone. Doors are few and short (a pixel is 3 %), so the
# median of all cues is steadier than the doors by themselves.
_BATHTUB_M = 1.43
_TOILET_ROOM_M = 1.08
_BATHROOM_M = 1.88


def px_per_m(cells: Sequence[Polygon], marks: Sequence[Mark], doors: Sequence[Segment]) -> float:
    """Scale of a drawing: the median of estimates by doors, bathtub, toilet room and bathroom.

    cells, marks and doors in pixels. Returns 0.0 where nothing shows the scale.
    """
    cues = []
    leaves = [math.dist(door[:2], door[2:]) for door in doors]
    if leaves:
        # Windows and sliding doors are wide; the narrow fifth are leaves.
        cues += [float(np.percentile(leaves, 20)) / _DOOR_M] * 2
    cues += [mark.long_side / _BATHTUB_M for mark in marks if mark.label == "bathtub"]
    names = {index: _names_in(cell, marks) for index, cell in enumerate(cells)}
    for index, cell in enumerate(cells):
        left, low, right, high = cell.bounds
        if names[index] == {"restroom"}:
            cues.append(min(right - left, high - low) / _TOILET_ROOM_M)
        elif names[index] == {"bathroom"}:
            cues.append(math.sqrt(cell.area) / _BATHROOM_M)
    return float(np.exp(np.median(np.log(cues)))) if cues else 0.0


FIXTURES = ("toilet", "bathtub", "cooking_counter", "washing_basin", "special", "stairs", "point",
            "PS")  # fmt: skip
"""Marks that are not the name of a room."""


def _names_in(cell: Polygon, marks: Sequence[Mark]) -> set[str]:
    return {
        mark.label
        for mark in marks
        if mark.label not in FIXTURES and cell.contains(Point(mark.center))
    }
