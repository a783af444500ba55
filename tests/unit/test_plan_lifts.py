"""Lifts are no rooms; bathrooms with crosses of showers, tinted floors and named rooms are."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from chord_usd.line.plan.lifts import is_lift

M_PER_PX = 0.02
SHAFT = np.array([[50, 50], [50, 150], [170, 150], [170, 50]], float)


def drawn(*corners: tuple[int, int, int, int]) -> np.ndarray:
    """Ink of rectangles (left, top, right, bottom) with their diagonals."""
    page = np.zeros((220, 240), np.uint8)
    for left, top, right, bottom in corners:
        cv2.rectangle(page, (left, top), (right, bottom), (1,))
        cv2.line(page, (left, top), (right, bottom), (1,))
        cv2.line(page, (left, bottom), (right, top), (1,))
    return page > 0


CABIN = drawn((70, 65, 150, 135))


def test_a_crossed_cabin_is_a_lift() -> None:
    """It became a bathroom with a shower, and an unknown room."""
    assert is_lift(SHAFT, (), False, CABIN, M_PER_PX)
    assert is_lift(SHAFT, (), False, drawn((50, 50, 170, 150)), M_PER_PX)


@pytest.mark.parametrize("word", ["Lift", "AUFZUG", "电梯", "Ascenseur 630 kg"])
def test_a_floor_named_lift_is(word: str) -> None:
    assert is_lift(SHAFT, (word,), False, np.zeros_like(CABIN), M_PER_PX)


@pytest.mark.parametrize(
    ("named", "ink", "m_per_px"),
    [
        (True, CABIN, M_PER_PX),
        (False, CABIN, 0.008),
        (False, CABIN, 0.05),
        (False, drawn((52, 52, 90, 90)), M_PER_PX),
        (False, np.ones_like(CABIN), M_PER_PX),
        (False, np.zeros_like(CABIN), M_PER_PX),
    ],
    ids=["named", "shower", "hall", "cupboard", "tinted", "bare"],
)
def test_other_floors_are_not(named: bool, ink: np.ndarray, m_per_px: float) -> None:
    assert not is_lift(SHAFT, (), named, ink, m_per_px)
