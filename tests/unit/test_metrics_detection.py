"""Average precision on rankings known by hand; edges against boxes moved on purpose."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from chord_usd.base.metrics.detection import (
    Proposal,
    average_precision,
    average_precisions,
    edge_errors_m,
    judged,
)
from chord_usd.base.scene.types import Box

RIGHT, WRONG = True, False


def score(*order: bool, truths: int) -> float:
    found = [Proposal(0, 1 - rank / 9, right) for rank, right in enumerate(order)]
    return average_precision(found, truths)


def test_average_precision_on_known_rankings() -> None:
    assert score(RIGHT, RIGHT, truths=2) == 1.0
    assert score(RIGHT, WRONG, truths=2) == 0.5
    assert score(WRONG, RIGHT, truths=1) == 0.5
    assert score(truths=3) == 0.0


def test_a_truth_is_found_once_and_by_the_surest_proposal() -> None:
    overlap = np.array([[0.9, 0.0], [0.6, 0.0], [0.0, 0.4]])
    results = judged(np.array([1, 1, 1]), np.array([0.5, 0.8, 0.9]), overlap, np.array([1, 1]))
    assert [(one.score, one.right) for one in results] == [(0.9, False), (0.8, True), (0.5, False)]


def test_a_proposal_of_another_class_is_wrong() -> None:
    results = judged(np.array([2]), np.array([0.9]), np.array([[1.0]]), np.array([1]))
    assert not results[0].right
    assert average_precisions(results, np.array([1])) == {1: 0.0}


@pytest.mark.parametrize("yaw_deg", [0.0, 30.0, 90.0, -135.0])
@pytest.mark.parametrize("turn_deg", [0.0, 90.0, 180.0])
def test_edges_are_measured_along_the_true_axes(yaw_deg: float, turn_deg: float) -> None:
    truth = Box((1.0, 2.0, 0.0), (2.0, 1.0, 1.0), yaw_deg)
    size = truth.size_m if turn_deg != 90.0 else (1.0, 2.0, 1.0)
    found = replace(truth, size_m=size, yaw_deg=yaw_deg + turn_deg)
    np.testing.assert_allclose(edge_errors_m(found, truth), 0.0, atol=1e-12)
    wider = replace(truth, size_m=(2.2, 1.0, 1.0))
    np.testing.assert_allclose(edge_errors_m(wider, truth), [0.1, 0.0, 0.1, 0.0], atol=1e-12)
