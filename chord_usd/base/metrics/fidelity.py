"""Output against truth: plans, orientations and rasters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import shapely

from chord_usd.base.metrics.footprints import GRID_M, footprints_of
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import FloatArray, Item, Opening, OpeningKind, Plan
from chord_usd.base.scene.units import rotation_2d, wrap_deg

PLAN_TOLERANCE_M = 0.1
"""Walls and openings of two plans agree when they are no further apart than this."""

MIN_MATCH_IOU = 0.5
"""Two items of one category are the same item from this overlap on."""

MAX_TURN_DEG = 10.0
"""A front points the right way when it is no further off than this."""


@dataclass(frozen=True)
class F1:
    """Agreement of a read set with a true one. Metres for walls, counts for openings."""

    read: float
    truth: float
    read_matched: float
    """How much of `read` lies near something true."""
    truth_matched: float
    """How much of `truth` lies near something read."""

    @property
    def value(self) -> float:
        """2 · precision · recall / (precision + recall); 1.0 where both sets are empty."""
        if self.read == 0 and self.truth == 0:
            return 1.0
        precision = self.read_matched / self.read if self.read else 0.0
        recall = self.truth_matched / self.truth if self.truth else 0.0
        total = precision + recall
        return 2 * precision * recall / total if total else 0.0


@dataclass(frozen=True)
class PlanFidelity:
    """How faithful a plan is to the one it was made from."""

    walls: F1
    doors: F1
    windows: F1
    passages: F1
    room_iou: float
    """Mean over true rooms of the intersection over union with their match; none counts 0."""
    rooms: int


def plan_fidelity(plan: Plan, truth: Plan) -> PlanFidelity:
    """Wall, door, window and passage F1 at PLAN_TOLERANCE_M, and room IoU."""
    return PlanFidelity(
        walls=wall_f1(plan, truth),
        doors=opening_f1(plan, truth, "door"),
        windows=opening_f1(plan, truth, "window"),
        passages=opening_f1(plan, truth, "passage"),
        room_iou=room_iou(plan, truth),
        rooms=len(truth.rooms),
    )


def wall_f1(plan: Plan, truth: Plan) -> F1:
    """Agreement of wall faces: length of one plan's room outlines near the other's."""
    ours, theirs = _wall_faces(plan), _wall_faces(truth)
    return F1(
        read=ours.length,
        truth=theirs.length,
        read_matched=ours.intersection(theirs.buffer(PLAN_TOLERANCE_M)).length,
        truth_matched=theirs.intersection(ours.buffer(PLAN_TOLERANCE_M)).length,
    )


def _wall_faces(plan: Plan) -> shapely.Geometry:
    return shapely.union_all([room_polygon(room).exterior for room in plan.rooms])


def opening_f1(plan: Plan, truth: Plan, kind: OpeningKind) -> F1:
    """Agreement of openings of one kind: both ends within PLAN_TOLERANCE_M, matched one to one."""
    ours = [opening for opening in plan.openings if opening.kind == kind]
    theirs = [opening for opening in truth.openings if opening.kind == kind]
    if not ours or not theirs:
        return F1(len(ours), len(theirs), 0, 0)
    ends_a = np.array([_ends(opening) for opening in ours])[:, None]
    ends_b = np.array([_ends(opening) for opening in theirs])[None, :]

    def furthest(a: FloatArray, b: FloatArray) -> FloatArray:
        distance: FloatArray = np.linalg.norm(a - b, axis=-1).max(axis=-1)
        return distance

    # An opening has no direction: its two ends may come in either order.
    distance_m = np.minimum(furthest(ends_a, ends_b), furthest(ends_a, ends_b[:, :, ::-1]))
    pairs = _match(-distance_m, accept=lambda score: score >= -PLAN_TOLERANCE_M)
    return F1(len(ours), len(theirs), len(pairs), len(pairs))


def _ends(opening: Opening) -> FloatArray:
    """(2, 2) end points of the opening's centre line, metres."""
    half = rotation_2d(opening.box.yaw_deg) @ np.array([opening.box.size_m[0] / 2, 0.0])
    center = np.array(opening.box.center_m[:2])
    return np.stack([center - half, center + half])


def room_iou(plan: Plan, truth: Plan) -> float:
    """Mean over true rooms of IoU with the read room matched to it; 1.0 where there is none."""
    if not truth.rooms:
        return 1.0
    if not plan.rooms:
        return 0.0
    score = _iou_table(
        np.array([room_polygon(room) for room in plan.rooms]),
        np.array([room_polygon(room) for room in truth.rooms]),
    )
    pairs = _match(score, accept=lambda iou: iou > 0)
    return float(sum(score[a, b] for a, b in pairs)) / len(truth.rooms)


def match_items(items: Sequence[Item], truth: Sequence[Item]) -> list[tuple[Item, Item]]:
    """Pairs (item, truth) of one category with footprint IoU of MIN_MATCH_IOU or more, one to one.

    Best overlaps are paired first. 2 · pairs / (items + truth) is the F1 of detection.
    """
    if not items or not truth:
        return []
    score = _iou_table(footprints_of(items).polygons, footprints_of(truth).polygons)
    ours = np.array([item.category for item in items])[:, None]
    theirs = np.array([item.category for item in truth])[None, :]
    score = np.where(ours == theirs, score, 0.0)
    pairs = _match(score, accept=lambda iou: iou >= MIN_MATCH_IOU)
    return [(items[a], truth[b]) for a, b in pairs]


def orientation(items: Sequence[Item], truth: Sequence[Item]) -> tuple[float, int]:
    """Share of matched items whose front is within MAX_TURN_DEG of the truth, and their number.

    Items without a match are not counted; (0.0, 0) where none matches.
    """
    pairs = match_items(items, truth)
    right = sum(abs(wrap_deg(a.box.yaw_deg - b.box.yaw_deg)) <= MAX_TURN_DEG for a, b in pairs)
    return (right / len(pairs) if pairs else 0.0), len(pairs)


def _iou_table(polygons: npt.NDArray, truth: npt.NDArray) -> FloatArray:
    """(len(polygons), len(truth)) intersection over union of polygons."""
    rows, columns = shapely.STRtree(truth).query(polygons, predicate="intersects")
    shared = shapely.area(shapely.intersection(polygons[rows], truth[columns], grid_size=GRID_M))
    areas = shapely.area(polygons)[rows] + shapely.area(truth)[columns] - shared
    iou = np.zeros((len(polygons), len(truth)))
    iou[rows, columns] = shared / np.maximum(areas, 1e-12)
    return iou


def _match(score: FloatArray, accept: Callable[[float], bool]) -> list[tuple[int, int]]:
    """Rows and columns paired one to one, highest score first, ties by index."""
    pairs: list[tuple[int, int]] = []
    rows: set[int] = set()
    columns: set[int] = set()
    for flat in np.argsort(-score, axis=None, kind="stable"):
        row, column = (int(k) for k in np.unravel_index(flat, score.shape))
        if not accept(score[row, column]):
            break
        if row not in rows and column not in columns:
            rows.add(row)
            columns.add(column)
            pairs.append((row, column))
    return pairs
