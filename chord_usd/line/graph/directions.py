"""Directions that walls run in, which the items along them share."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.types import FloatArray, PixelFrame, Room
from chord_usd.base.scene.units import fold_deg, px_from_m
from chord_usd.line.graph.colours import CLEAR, LabelArray

SAME_DEG = 1.5
"""Directions closer than this are one."""

_END_PX = 1.0
"""Error of an end of a side: short sides give their direction poorly."""

_LEAST_SIDE_PX = 12.0
"""Shorter stretches of a pixelated outline have no direction to speak of."""


@dataclass(frozen=True, eq=False)
class Directions:
    """The directions of a house's walls. A wall and its perpendiculars are one direction."""

    angles_deg: FloatArray
    """(K,) counter-clockwise, in [-45, 45)."""
    segments: FloatArray
    """(S, 4) x0, y0, x1, y1 of the sides of rooms, upright pixels (y up)."""
    of_segment: npt.NDArray[np.intp]
    """(S,) index into angles_deg."""
    room_of_segment: npt.NDArray[np.intp]
    """(S,) index of the room whose side it is."""

    def weight(self, angle_deg: float) -> float:
        """Length of wall in a direction, as a share of the most frequent direction's; [0, 1]."""
        lengths = np.hypot(*(self.segments[:, 2:] - self.segments[:, :2]).T)
        totals = np.bincount(self.of_segment, lengths, minlength=len(self.angles_deg))
        length = totals[self.angles_deg == angle_deg].sum()
        return float(length / totals.max()) if totals.size and totals.max() > 0.0 else 1.0

    def near(self, point: FloatArray) -> list[float]:
        """Directions of the room around an upright point (2,), the nearest side's first.

        A side gives its direction to what is no farther from it than it is long.
        """
        if not len(self.segments):
            return [0.0]
        distance = _distance(point, self.segments)
        lengths = np.hypot(*(self.segments[:, 2:] - self.segments[:, :2]).T)
        in_room = self.room_of_segment == self.room_of_segment[distance.argmin()]
        reaching = in_room & (distance <= lengths)
        counted = np.flatnonzero(reaching if reaching.any() else in_room)
        counted = counted[np.argsort(distance[counted], kind="stable")]
        return [float(self.angles_deg[index]) for index in dict.fromkeys(self.of_segment[counted])]


def plan_directions(rooms: Iterable[Room], frame: PixelFrame) -> Directions:
    """Directions of the rooms' sides."""
    segments, of_room = [], []
    for index, room in enumerate(rooms):
        corners = px_from_m(room.polygon_m, frame) * (1.0, -1.0)
        segments += np.hstack([corners, np.roll(corners, -1, axis=0)]).tolist()
        of_room += [index] * len(corners)
    angles = [_angle(np.array(segment)) for segment in segments]
    return _grouped(segments, angles, of_room)


def raster_directions(structure: LabelArray) -> Directions:
    """Directions of the outlines of floor regions in a raster, (H, W) structure labels."""
    segments, angles, of_region = [], [], []
    clear = (structure == CLEAR).astype(np.uint8)
    contours, _ = cv2.findContours(clear, cv2.RETR_CCOMP, cv2.CHAIN_APPROX_NONE)
    for index, contour in enumerate(contours):
        if len(contour) >= _LEAST_SIDE_PX:
            for run in _straight_runs(contour[:, 0, :].astype(np.float64)):
                upright = (run + 0.5) * (1.0, -1.0)
                segments.append([*upright[0], *upright[-1]])
                angles.append(_run_angle(upright))
                of_region.append(index)
    return _grouped(segments, angles, of_region)


def _straight_runs(points: FloatArray) -> Iterable[FloatArray]:
    """The runs of outline pixels (N, 2) between the corners of a polygon close to them."""
    corners = cv2.approxPolyDP(points.astype(np.int32), 1.5, True)[:, 0, :]
    index = sorted(int(np.abs(points - corner).sum(axis=1).argmin()) for corner in corners)
    for first, last in zip(index, [*index[1:], index[0] + len(points)], strict=True):
        run = points[np.arange(first, last + 1) % len(points)]
        if np.hypot(*(run[-1] - run[0])) >= _LEAST_SIDE_PX:
            # Corner pixels belong to two sides.
            yield run[2:-2] if len(run) > 8 else run


def _run_angle(run: FloatArray) -> float:
    """Angle of the least-squares line through a run of points (N, 2), degrees."""
    dx, dy = run.max(axis=0) - run.min(axis=0)
    if min(dx, dy) < 1.0:
        return 0.0 if dx >= dy else 90.0
    _, _, axes = np.linalg.svd(run - run.mean(axis=0), full_matrices=False)
    return float(np.degrees(np.arctan2(axes[0, 1], axes[0, 0])))


def _angle(segment: FloatArray) -> float:
    dx, dy = segment[2:] - segment[:2]
    # Exact multiples of a quarter turn stay exact.
    return 0.0 if abs(dx) < 1e-9 or abs(dy) < 1e-9 else float(np.degrees(np.arctan2(dy, dx)))


def _grouped(
    segments: Sequence[Sequence[float]], angles_deg: Sequence[float], rooms: Sequence[int]
) -> Directions:
    """Merge directions that are nearly the same, weighted by length."""
    array = np.array(segments, dtype=np.float64).reshape(-1, 4)
    folded = np.array([fold_deg(angle) for angle in angles_deg])
    lengths = np.hypot(array[:, 2] - array[:, 0], array[:, 3] - array[:, 1])
    of_segment = np.full(len(array), -1, dtype=np.intp)
    angles: list[float] = []
    reach = np.maximum(SAME_DEG, np.degrees(_END_PX / np.maximum(lengths, 1e-9)))
    while (of_segment < 0).any():
        free = of_segment < 0
        center = folded[np.where(free, lengths, -1.0).argmax()]
        shift = (folded - center + 45.0) % 90.0 - 45.0
        near = free & (np.abs(shift) <= reach)
        mean = float(np.average(shift[near], weights=lengths[near] + 1e-9))
        exact = bool((folded[near] == 0.0).any())
        of_segment[near] = len(angles)
        angles.append(0.0 if exact else fold_deg(float(center) + mean))
    return Directions(np.array(angles), array, of_segment, np.array(rooms, np.intp))


def _distance(point: FloatArray, segments: FloatArray) -> FloatArray:
    """(S,) distance of a point from each segment."""
    start, along = segments[:, :2], segments[:, 2:] - segments[:, :2]
    square = np.maximum((along**2).sum(axis=1), 1e-12)
    share = np.clip(((point - start) * along).sum(axis=1) / square, 0.0, 1.0)
    return np.hypot(*(start + share[:, None] * along - point).T)
