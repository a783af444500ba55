"""Faintly drawn fixtures count where their rooms lack them, and nowhere else."""

from __future__ import annotations

import pytest

from chord_usd.base.scene.types import Box, Item, Room, RoomKind, frozen_array
from chord_usd.line.plan.seen_pieces import with_needed

SQUARE = frozen_array([(0, 0), (3, 0), (3, 3), (0, 3)])


def piece(category: str, x: float, score: float) -> Item:
    return Item("", category, Box((x, 1.0, 0.0), (0.5, 0.5, 0.5), 0.0), score=score)


@pytest.mark.parametrize(
    ("kind", "sure", "faint", "added"),
    [
        ("bathroom", [], [piece("toilet", 1, 0.2), piece("toilet", 2, 0.1)], [0.2]),
        ("bathroom", [piece("toilet", 1, 0.6)], [piece("toilet", 2, 0.2)], []),
        ("bathroom", [piece("bathtub", 1, 0.6)], [piece("shower", 2, 0.2)], []),
        ("bedroom", [], [piece("toilet", 1, 0.2)], []),
        ("bathroom", [], [piece("toilet", 5, 0.2)], []),
    ],
    ids=["lacks", "has", "has another", "other kind", "beside"],
)
def test_a_faint_piece_counts_where_its_room_lacks_one(
    kind: RoomKind, sure: list[Item], faint: list[Item], added: list[float]
) -> None:
    """Toilets of thin strokes were dropped, and others built elsewhere in the room."""
    found = with_needed(sure, faint, [Room("a", kind, SQUARE)])
    assert found[: len(sure)] == sure
    assert [one.score for one in found[len(sure) :]] == added
