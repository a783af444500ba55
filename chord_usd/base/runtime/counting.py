"""Numbers with the nouns that they count."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def counted(number: int, noun: str, plural: str = "") -> str:
    """The number and its noun: "1 piece", "2 pieces", "0 pieces".

    noun: the singular. plural: by default noun with an s.
    """
    return f"{number} {noun if number == 1 else plural or noun + 's'}"


def counted_rooms(data: Mapping[str, Any]) -> str:
    """Rooms and furniture of what a verb reports: "3 rooms, 15 pieces of furniture"."""
    return f"{counted(data['rooms'], 'room')}, {counted(data['furniture'], 'piece')} of furniture"
