"""Symbols of fixtures tell what a room is for; furniture and letters do not."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from chord_usd.data.drawn.fixtures import SYMBOLS, Symbol
from chord_usd.plan.fixtures import kind_by_fixtures
from chord_usd.types import BoolArray, FloatArray, RoomKind
from chord_usd.units import rotation_2d

ROOM_M = 4.0
KNOWN = [
    (kind, index)
    for kind, symbols in SYMBOLS.items()
    for index in range(len(symbols))
    if (kind, index) != ("kitchen", 1)  # A sink alone may be a basin.
]


def room_with(lines: list[FloatArray], m_per_px: float, yaw_deg: float) -> RoomKind:
    """What a square room is taken for in which these lines (metres) are drawn."""
    side = round(ROOM_M / m_per_px)
    canvas = np.zeros((side, side), np.uint8)
    turn = rotation_2d(yaw_deg)
    for line in lines:
        placed = line @ turn.T / m_per_px + side / 2
        cv2.polylines(canvas, [np.rint(placed).astype(np.int32)], False, (1.0,), 1)
    corners = np.array([[0, 0], [0, side], [side, side], [side, 0]], np.float64)
    return kind_by_fixtures(corners, canvas > 0, no_letters(side), m_per_px)


def no_letters(side: int) -> BoolArray:
    return np.zeros((side, side), bool)


def lines_of(symbol: Symbol) -> list[FloatArray]:
    return symbol.lines(np.eye(2), np.array([-0.3, -0.3]))


@pytest.mark.parametrize("m_per_px", [0.009, 0.014, 0.02])
@pytest.mark.parametrize("yaw_deg", [0.0, 90.0, 180.0, 270.0])
@pytest.mark.parametrize(("kind", "index"), KNOWN)
def test_each_symbol_tells_its_room(
    kind: RoomKind, index: int, yaw_deg: float, m_per_px: float
) -> None:
    assert room_with(lines_of(SYMBOLS[kind][index]), m_per_px, yaw_deg) == kind


def box(width: float, depth: float, inset: float = 0.0) -> FloatArray:
    low, right, far = inset, width - inset, depth - inset
    return np.array([[low, low], [right, low], [right, far], [low, far], [low, low]])


def ring(radius: float, x: float = 0.0, y: float = 0.0) -> FloatArray:
    angles = np.linspace(0.0, 2 * np.pi, 40)
    return radius * np.stack([np.cos(angles), np.sin(angles)], axis=1) + np.array([x, y])


FURNITURE = {
    "sofa": [box(2.0, 0.9), box(2.0, 0.9, 0.12)],
    "desk": [box(1.4, 0.7), box(1.4, 0.7, 0.12)],
    "round table": [ring(0.5)],
    "stools in a row": [ring(0.15, x, 0.0) for x in (0.0, 0.4, 0.8, 1.2)],
    "wardrobe": [box(1.8, 0.6), ring(0.18, 0.9, 0.3)],
    "lift": [box(1.6, 1.6), np.array([[0, 0], [1.6, 1.6]]), np.array([[1.6, 0], [0, 1.6]])],
}


@pytest.mark.parametrize("name", FURNITURE)
def test_furniture_tells_nothing(name: str) -> None:
    assert room_with(FURNITURE[name], 0.015, 0.0) == "unknown"


def test_the_insides_of_letters_are_no_rings() -> None:
    """Four round letters in two lines look like a hob."""
    side = 250
    canvas, letters = np.zeros((side, side), np.uint8), no_letters(side)
    for x in (100, 120):
        for y in (100, 120):
            cv2.circle(canvas, (x, y), 7, (1.0,), 1)
    corners = np.array([[0, 0], [0, side], [side, side], [side, 0]], np.float64)
    assert kind_by_fixtures(corners, canvas > 0, letters, 0.015) == "kitchen"
    letters[90:130, 90:130] = True
    assert kind_by_fixtures(corners, canvas > 0, letters, 0.015) == "unknown"


def test_a_large_room_with_a_hob_is_an_open_living_room() -> None:
    side = 600
    canvas = np.zeros((side, side), np.uint8)
    for x in (100, 120):
        for y in (100, 120):
            cv2.circle(canvas, (x, y), 7, (1.0,), 1)
    corners = np.array([[0, 0], [0, side], [side, side], [side, 0]], np.float64)
    assert kind_by_fixtures(corners, canvas > 0, no_letters(side), 0.015) == "living"
