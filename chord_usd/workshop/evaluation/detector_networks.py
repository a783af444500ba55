"""The detector's networks by themselves: mean average precision of items and rooms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np

from chord_usd.base.metrics.detection import Proposal, average_precisions, judged
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.types import BoolArray, FloatArray, PixelFrame, Plan
from chord_usd.base.scene.units import px_from_m
from chord_usd.line.graph.detect import (
    CLASSES,
    LEAST_SCORE,
    ROOM_CLASSES,
    ItemDetector,
    Kind,
    RoomSegmenter,
    load_item_detector,
    load_room_segmenter,
    taught_box,
)
from chord_usd.workshop.evaluation.detector_cases import Case

CvBox = tuple[tuple[float, float], tuple[float, float], float]


@dataclass(frozen=True)
class NetworkScores:
    """What a network proposes, before any pixel is asked."""

    map50: float
    """Mean over the classes that occur of the average precision at an overlap of one half."""
    by_class: dict[str, float]
    """Average precision of each class that occurs."""
    truths: int
    """How many items or rooms there were to find."""


def score_checkpoint(kind: Kind, folder: Path, cases: Sequence[Case]) -> NetworkScores:
    """Scores of the network in folder. Raises CheckpointError when it cannot be loaded."""
    if kind == "items":
        return score_item_detector(cases, load_item_detector(folder))
    return score_room_segmenter(cases, load_room_segmenter(folder))


def score_item_detector(cases: Sequence[Case], detector: ItemDetector) -> NetworkScores:
    """Oriented boxes against the items of these layouts, both LEAST_SIDE_PX long and wide at least:
    how the network is taught them."""
    proposals: list[Proposal] = []
    truths: list[int] = []
    for case in cases:
        rows = detector.rows(case.layout.rgb, LEAST_SCORE)
        frame = case.layout.frame
        mine = [_as_cv(row[[0, 1, 2, 3, 6]]) for row in rows]
        boxes = [_as_cv(taught_box(item.box, frame)) for item in case.items]
        labels = [category(item.category).detector_class for item in case.items]
        overlap = np.array([[_box_iou(a, b) for b in boxes] for a in mine])
        proposals += judged(
            rows[:, 5].astype(int), rows[:, 4], overlap, np.array(labels, dtype=int)
        )
        truths += labels
    return _scores("items", proposals, truths)


def score_room_segmenter(cases: Sequence[Case], segmenter: RoomSegmenter) -> NetworkScores:
    """Masks against the rooms of the cases whose plan is known."""
    proposals: list[Proposal] = []
    truths: list[int] = []
    for case in cases:
        if case.plan is None:
            continue
        rooms = segmenter.segment(case.layout.rgb, LEAST_SCORE)
        labels, masks = _room_masks(case.plan, case.layout.frame)
        overlap = np.array(
            [
                [(room.mask & b).sum() / max(1, (room.mask | b).sum()) for b in masks]
                for room in rooms
            ]
        )
        kinds = np.array([ROOM_CLASSES.index(room.kind) for room in rooms], dtype=int)
        scores = np.array([room.score for room in rooms])
        proposals += judged(kinds, scores, overlap, np.array(labels, dtype=int))
        truths += labels
    return _scores("rooms", proposals, truths)


def _scores(kind: Kind, proposals: Sequence[Proposal], truths: Sequence[int]) -> NetworkScores:
    precisions = average_precisions(proposals, np.array(truths, dtype=int))
    by_class = {CLASSES[kind][label]: round(value, 4) for label, value in precisions.items()}
    mean = float(np.mean(list(precisions.values()))) if precisions else 0.0
    return NetworkScores(round(mean, 4), by_class, len(truths))


def _room_masks(plan: Plan, frame: PixelFrame) -> tuple[list[int], list[BoolArray]]:
    """Class and floor of every room whose kind is known."""
    labels, masks = [], []
    for room in plan.rooms:
        if room.kind == "unknown":
            continue
        canvas = np.zeros((frame.height_px, frame.height_px), dtype=np.uint8)
        # fillPoly counts pixel centres as whole numbers.
        corners = np.rint((px_from_m(room.polygon_m, frame) - 0.5) * 16).astype(np.int32)
        cv2.fillPoly(canvas, [corners], (1,), shift=4)
        labels.append(ROOM_CLASSES.index(room.kind))
        masks.append(canvas > 0)
    return labels, masks


def _as_cv(box: FloatArray) -> CvBox:
    x, y, length, width, radians = (float(value) for value in box)
    return (x, y), (length, width), float(np.degrees(radians))


def _box_iou(first: CvBox, second: CvBox) -> float:
    (ax, ay), (al, aw), _ = first
    (bx, by), (bl, bw), _ = second
    if np.hypot(ax - bx, ay - by) > (al + aw + bl + bw) / 2:
        return 0.0
    outline = cv2.rotatedRectangleIntersection(first, second)[1]
    if outline is None:
        return 0.0
    both = cv2.contourArea(cv2.convexHull(outline))
    return float(both / max(al * aw + bl * bw - both, 1e-9))
