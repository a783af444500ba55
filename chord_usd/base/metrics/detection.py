"""Detections against the truth: average precision, and how far edges are off."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.geometry import footprint, to_own
from chord_usd.base.scene.types import Box, FloatArray

IOU = 0.5
"""A proposal is right when it overlaps a truth of its class by at least this."""


@dataclass(frozen=True)
class Proposal:
    """One proposal of a network, judged."""

    label: int
    score: float
    right: bool
    """Whether it matches a truth of its class that no better proposal matches."""


def judged(
    labels: npt.NDArray[np.integer],
    scores: FloatArray,
    overlap: FloatArray,
    truths: npt.NDArray[np.integer],
) -> list[Proposal]:
    """The proposals of one picture, best first; each truth is given away once.

    labels, scores: (P,); truths: (T,) classes; overlap: (P, T) intersection over union.
    """
    taken = np.zeros(len(truths), dtype=bool)
    results = []
    for index in np.argsort(-scores, kind="stable"):
        free = np.flatnonzero((truths == labels[index]) & ~taken)
        right = False
        if len(free):
            best = free[overlap[index, free].argmax()]
            right = bool(overlap[index, best] >= IOU)
            taken[best] |= right
        results.append(Proposal(int(labels[index]), float(scores[index]), right))
    return results


def average_precision(proposals: Iterable[Proposal], truths: int) -> float:
    """Area under the precision-recall curve, precision made monotonous (as in COCO). [0, 1].

    proposals: all of one class; truths: how many there were to find.
    """
    ranked = sorted(proposals, key=lambda proposal: -proposal.score)
    if not ranked or not truths:
        return 0.0
    right = np.cumsum([proposal.right for proposal in ranked])
    precision = right / np.arange(1, len(ranked) + 1)
    precision = np.maximum.accumulate(precision[::-1])[::-1]
    recall = right / truths
    return float(np.sum(np.diff(recall, prepend=0.0) * precision))


def average_precisions(
    proposals: Sequence[Proposal], truths: npt.NDArray[np.integer]
) -> dict[int, float]:
    """Average precision of each class that occurs among the truths (all pictures together)."""
    by_label: dict[int, list[Proposal]] = {}
    for proposal in proposals:
        by_label.setdefault(proposal.label, []).append(proposal)
    labels, counts = np.unique(truths, return_counts=True)
    return {
        int(label): average_precision(by_label.get(int(label), []), int(count))
        for label, count in zip(labels, counts, strict=True)
    }


def edge_errors_m(seen: Box, truth: Box) -> FloatArray:
    """(4,) how far the edges of a footprint lie from the true ones, along the true axes, metres.

    Fronts do not matter: a piece that faces the wrong way has its edges where they should be.
    """
    corners = to_own(truth, footprint(seen))
    half = np.array(truth.size_m[:2]) / 2
    errors: FloatArray = np.abs(
        np.concatenate([corners.max(axis=0) - half, corners.min(axis=0) + half])
    )
    return errors
