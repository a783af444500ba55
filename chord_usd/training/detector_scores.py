"""Scores of the detector on held-out houses: mean average precision at an overlap of one half."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from chord_usd.data.splits import TEST_SEED, split_hash
from chord_usd.graph.detect import CLASSES, Kind, load_item_detector, load_room_segmenter
from chord_usd.training.detector_data import CLEAN, MASK_STEP_PX, Sample, held_out
from chord_usd.types import FloatArray

_LEAST_SCORE = 0.01
"""Precision is integrated down to this confidence."""

IOU = 0.5
"""A proposal is right when it overlaps a truth of its class by at least this."""


@dataclass(frozen=True)
class Scores:
    """What a checkpoint reaches on clean layouts of held-out houses."""

    map50: float
    """Mean over the classes that occur of the average precision at IOU."""
    by_class: dict[str, float]
    """Average precision of each class that occurs."""
    houses: int
    truths: int
    """How many items or rooms there were to find."""
    split: str
    """Hash of the names of these houses."""

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return asdict(self)


@dataclass(frozen=True)
class _Found:
    score: float
    right: bool


def score_checkpoint(kind: Kind, folder: Path, houses: int) -> Scores:
    """Score the checkpoint in folder on the first held-out houses."""
    match = _item_matcher(folder) if kind == "items" else _room_matcher(folder)
    found: dict[int, list[_Found]] = {}
    counts = np.zeros(len(CLASSES[kind]), dtype=int)
    for sample in held_out(houses, CLEAN):
        truths = sample.boxes[:, 0] if kind == "items" else sample.room_classes
        np.add.at(counts, truths.astype(int), 1)
        for label, result in match(sample):
            found.setdefault(label, []).append(result)
    by_class = {
        CLASSES[kind][label]: round(average_precision(found.get(label, []), int(count)), 4)
        for label, count in enumerate(counts)
        if count
    }
    mean = float(np.mean(list(by_class.values()))) if by_class else 0.0
    split = split_hash(str(TEST_SEED + index) for index in range(houses))
    return Scores(round(mean, 4), by_class, houses, int(counts.sum()), split)


def average_precision(found: Iterable[_Found], truths: int) -> float:
    """Area under the precision-recall curve, precision made monotonous (as in COCO). [0, 1]."""
    ranked = sorted(found, key=lambda one: -one.score)
    if not ranked or not truths:
        return 0.0
    right = np.cumsum([one.right for one in ranked])
    precision = right / np.arange(1, len(ranked) + 1)
    precision = np.maximum.accumulate(precision[::-1])[::-1]
    recall = right / truths
    return float(np.sum(np.diff(recall, prepend=0.0) * precision))


def _item_matcher(folder: Path) -> Any:
    detector = load_item_detector(folder)

    def match(sample: Sample) -> list[tuple[int, _Found]]:
        rows = detector.raw(sample.rgb[None], _LEAST_SCORE)[0]
        classes, scores = rows[:, 5].astype(int), rows[:, 4]
        boxes = [_as_cv(row[[0, 1, 2, 3, 6]]) for row in rows]
        truths = [_as_cv(row[1:]) for row in sample.boxes]
        overlap = np.array([[_box_iou(a, b) for b in truths] for a in boxes])
        return _matched(classes, scores, overlap, sample.boxes[:, 0].astype(int))

    return match


def _room_matcher(folder: Path) -> Any:
    segmenter = load_room_segmenter(folder)

    def match(sample: Sample) -> list[tuple[int, _Found]]:
        rooms = segmenter.segment_batch(sample.rgb[None], _LEAST_SCORE)[0]
        middle = MASK_STEP_PX // 2
        masks = [room.mask[middle::MASK_STEP_PX, middle::MASK_STEP_PX] for room in rooms]
        truths = [sample.room_map == 1 + index for index in range(len(sample.room_classes))]
        overlap = np.array([[(a & b).sum() / max(1, (a | b).sum()) for b in truths] for a in masks])
        labels = np.array([CLASSES["rooms"].index(room.kind) for room in rooms], dtype=int)
        scores = np.array([room.score for room in rooms])
        return _matched(labels, scores, overlap, sample.room_classes.astype(int))

    return match


def _matched(
    labels: np.ndarray, scores: FloatArray, overlap: FloatArray, truths: np.ndarray
) -> list[tuple[int, _Found]]:
    """Best proposals first, each truth given away once."""
    taken = np.zeros(len(truths), dtype=bool)
    results = []
    for index in np.argsort(-scores, kind="stable"):
        free = np.flatnonzero((truths == labels[index]) & ~taken)
        right = False
        if len(free):
            best = free[overlap[index, free].argmax()]
            right = bool(overlap[index, best] >= IOU)
            taken[best] |= right
        results.append((int(labels[index]), _Found(float(scores[index]), right)))
    return results


def _as_cv(box: FloatArray) -> tuple[Any, ...]:
    x, y, length, width, radians = (float(value) for value in box)
    return (x, y), (length, width), float(np.degrees(radians))


def _box_iou(first: tuple[Any, ...], second: tuple[Any, ...]) -> float:
    (ax, ay), (al, aw), _ = first
    (bx, by), (bl, bw), _ = second
    if np.hypot(ax - bx, ay - by) > (al + aw + bl + bw) / 2:
        return 0.0
    outline = cv2.rotatedRectangleIntersection(first, second)[1]
    if outline is None:
        return 0.0
    both = cv2.contourArea(cv2.convexHull(outline))
    return float(both / max(al * aw + bl * bw - both, 1e-9))
