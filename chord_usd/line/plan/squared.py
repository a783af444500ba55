"""Outlines squared: what runs nearly along an axis, and is torn rather than slanted, lies along it.

A network sees the rim of a wall torn where something is drawn at it, and a line through torn rim
runs askew. A wall that is really askew has a rim that climbs evenly; a torn one jumps.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from shapely.geometry import Polygon

from chord_usd.base.scene.types import BoolArray, FloatArray

_NEARLY_DEG = 15.0
"""Edges nearer to an axis may lie along it."""
_EXACT_DEG = 0.1
_ASKEW_DEG = 4.0
"""Walls are not meant to be less askew: drawings by hand are."""
_FLAT_PX = 1.5
"""Who strays less from an axis lies along it."""
_SHORT, _STRAYS = 8.0, 1.2
"""An edge no longer than so many thicknesses of a wall is torn if it strays by no more than so
many: rims that a network saw climb as evenly where they are torn."""
_JUMP = 0.6
"""Steps of so many thicknesses of a wall are meant; smaller ones are torn rim."""
_CHAMFER = 1.6
"""A slanted edge that cuts a corner off is meant if longer than so many."""
_SLANT_DEG, _PHOTO = 2.5, 0.3
"""Where more than this share of all edges is askew by more, the picture was taken at a slant, and
no edge shows what is torn."""
_ALIKE = 0.85
"""Share of the area about both outlines that they share at least, or the first one stays."""


@dataclass(frozen=True, eq=False)
class _Line:
    start: FloatArray
    stop: FloatArray
    axis: int | None
    """Which coordinate is the same all along it; None where it is slanted."""

    @property
    def length(self) -> float:
        return float(np.hypot(*(self.stop - self.start)))

    @property
    def place(self) -> float:
        """That coordinate."""
        return float(self.start[self.axis or 0])


def is_askew(polygons: Sequence[FloatArray]) -> bool:
    """Whether outlines, (N, 2) each, are of a picture taken at a slant."""
    runs = np.concatenate([np.roll(polygon, -1, axis=0) - polygon for polygon in polygons])
    lengths = np.hypot(*runs.T)
    angles = np.degrees(np.arctan2(*np.abs(runs).T)) % 90.0
    off_deg = np.minimum(angles, 90.0 - angles)
    return bool(
        lengths[(off_deg > _SLANT_DEG) & (off_deg < _NEARLY_DEG)].sum() > _PHOTO * lengths.sum()
    )


def squared(polygon: FloatArray, mask: BoolArray, thickness_px: float) -> FloatArray:
    """(M, 2) the outline, (N, 2), of a region squared, in continuous pixels.

    mask: (H, W) the region. thickness_px: of the usual wall.
    """
    rim = _rim(mask)
    corners = zip(polygon, np.roll(polygon, -1, axis=0), strict=True)
    lines = [line for start, stop in corners for line in _lines(start, stop, rim, thickness_px)]
    lines = _merged(_without_chamfers(lines, _CHAMFER * thickness_px), _JUMP * thickness_px)
    outline = _corners(lines)
    if len(outline) < 4 or not Polygon(outline).is_valid:
        return polygon
    before, after = Polygon(polygon), Polygon(outline)
    is_alike = before.intersection(after).area > _ALIKE * before.union(after).area
    return outline if is_alike else polygon


def _rim(mask: BoolArray) -> FloatArray:
    """(N, 2) middles of a region's outermost pixels."""
    edges, _ = cv2.findContours(mask.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    return np.concatenate([edge[:, 0] for edge in edges]) + 0.5


def _lines(
    start: FloatArray, stop: FloatArray, rim: FloatArray, thickness_px: float
) -> list[_Line]:
    """What an edge is: a line, or two along an axis with a step between them."""
    run = stop - start
    axis = int(np.abs(run).argmin())
    off_deg = np.degrees(np.arctan2(abs(run[axis]), abs(run[1 - axis])))
    if off_deg < _EXACT_DEG:
        return [_Line(start, stop, axis)]
    if off_deg > _NEARLY_DEG:
        return [_Line(start, stop, None)]
    along, away = _beside(start, stop, rim, thickness_px)
    if len(along) < 4 or abs(run[axis]) < _FLAT_PX:
        return [_along(start, stop, axis, float(start[axis] + stop[axis]) / 2)]
    slope = np.polyfit(along, away, 1)
    climbing = float(np.std(away - np.polyval(slope, along)))
    cut, steps = _best_step(along, away)
    # Half a pixel from the middles of the outermost pixels to their edge, to the slant's side.
    middle = float(np.median(start[axis] + (stop - start)[axis] * along))
    outward = float(np.clip(middle - np.median(away), -0.5, 0.5))
    is_short = np.hypot(*run) < _SHORT * thickness_px and abs(run[axis]) < _STRAYS * thickness_px
    if off_deg > _ASKEW_DEG and climbing <= steps.spread and not is_short:
        return [_Line(start, stop, None)]
    if abs(steps.after - steps.before) < _JUMP * thickness_px:
        longer = steps.before if cut > 0.5 else steps.after
        return [_along(start, stop, axis, longer + outward)]
    corner = start + run * cut
    return [
        _along(start, corner, axis, steps.before + outward),
        _along(corner, stop, axis, steps.after + outward),
    ]


@dataclass(frozen=True)
class _Steps:
    before: float
    after: float
    spread: float
    """Standard deviation about both."""


def _beside(
    start: FloatArray, stop: FloatArray, rim: FloatArray, thickness_px: float
) -> tuple[FloatArray, FloatArray]:
    """Rim along an edge: where, from 0 at its start to 1, and its coordinate across the axis."""
    run = stop - start
    length = float(np.hypot(*run))
    offset = rim - start
    along = offset @ run / length**2
    aside = np.abs(offset @ np.array([-run[1], run[0]])) / length
    axis = int(np.abs(run).argmin())
    is_near = (aside < thickness_px) & (along > 0.0) & (along < 1.0)
    order = np.argsort(along[is_near])
    return along[is_near][order], rim[is_near][order, axis]


def _best_step(along: FloatArray, away: FloatArray) -> tuple[float, _Steps]:
    """Where a rim jumps, and from what to what."""
    best = 0.5, _Steps(0.0, 0.0, np.inf)
    for cut in range(2, len(along) - 1):
        parts = away[:cut], away[cut:]
        levels = [float(np.median(part)) for part in parts]
        strays = np.concatenate([p - level for p, level in zip(parts, levels, strict=True)])
        spread = float(np.sqrt(np.mean(strays**2)))
        if spread < best[1].spread:
            best = float(along[cut]), _Steps(levels[0], levels[1], spread)
    return best


def _along(start: FloatArray, stop: FloatArray, axis: int, place: float) -> _Line:
    """A line along an axis, from where a slanted one starts to where it stops."""
    ends = np.array([start, stop])
    ends[:, axis] = place
    return _Line(ends[0], ends[1], axis)


def _without_chamfers(lines: list[_Line], longest_px: float) -> list[_Line]:
    """Without short slanted edges between two that meet at a right angle."""
    neighbours = zip([lines[-1], *lines[:-1]], lines, [*lines[1:], lines[0]], strict=True)
    return [
        line
        for before, line, after in neighbours
        if line.axis is not None
        or line.length > longest_px
        or before.axis is None
        or after.axis is None
        or before.axis == after.axis
    ]


def _merged(lines: list[_Line], step_px: float) -> list[_Line]:
    """Neighbours along one axis that are one line, or have no more than a torn step between."""
    index = 0
    while len(lines) > 3 and index < len(lines):
        line, after = lines[index], lines[(index + 1) % len(lines)]
        if line.axis is None or line.axis != after.axis or abs(line.place - after.place) > step_px:
            index += 1
            continue
        longer = max(line, after, key=lambda each: each.length)
        lines[index] = _along(line.start, after.stop, line.axis, longer.place)
        del lines[(index + 1) % len(lines)]
    return lines


def _corners(lines: Sequence[_Line]) -> FloatArray:
    """Where each line meets the next; both ends of a step where they are parallel."""
    corners = []
    for line, after in zip(lines, [*lines[1:], *lines[:1]], strict=True):
        first, second = line.stop - line.start, after.stop - after.start
        sine = first[0] * second[1] - first[1] * second[0]
        if abs(sine) <= 0.1 * np.hypot(*first) * np.hypot(*second):
            corners += [line.stop, _at_height(after, line.stop)]
            continue
        gap = after.start - line.start
        share = (gap[0] * second[1] - gap[1] * second[0]) / sine
        corners.append(line.start + share * first)
    return np.array(corners)


def _at_height(after: _Line, corner: FloatArray) -> FloatArray:
    """Where the next line begins if it begins beside a corner."""
    if after.axis is None:
        return after.start
    beside = corner.copy()
    beside[after.axis] = after.place
    return beside
