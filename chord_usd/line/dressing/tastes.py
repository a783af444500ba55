"""How much of what each style shows."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Taste:
    """What a style does with a room. Shares and chances are in [0, 1]."""

    pictures: float
    """Share of the places for pictures that are used."""
    gallery: float
    """Chance that a place has a group of them in place of one."""
    symmetric: bool
    """Whether things stand in pairs about an axis, or in groups beside it."""
    cushions: int
    """Most cushions on a sofa."""
    throws: float
    plants: int
    """Most plants on the floor of a room."""
    curtains: float
    """Chance that a house has curtains rather than blinds where people sit and sleep."""
    sheers: float
    """Chance that a room's curtains are sheer ones, drawn."""
    rugs: float
    boards: float
    """Share of the length of boards and shelves that is filled."""
    shelves: float
    """Chance of a wall shelf where there is a place for one."""
    wall_lamps: float
    mirrors: float
    radiators: float
    open_kitchen: float
    """Chance that a place over the worktop has a rail or a shelf in place of a cabinet."""
    little: float
    """Share of small things that are put out at all: jars, bottles, candles."""


TASTES: dict[str, Taste] = {
    "modern": Taste(0.75, 0.3, False, 4, 0.6, 2, 0.85, 0.35, 0.85, 0.5, 0.4, 0.4, 0.5, 0.6, 0.1,
                    0.7),
    "scandinavian": Taste(0.8, 0.5, False, 4, 0.85, 3, 0.9, 0.4, 0.9, 0.5, 0.6, 0.5, 0.6, 0.8,
                          0.35, 0.8),
    "classic": Taste(1.0, 0.6, True, 5, 0.6, 2, 1.0, 0.2, 0.95, 0.65, 0.35, 0.9, 0.9, 0.9, 0.05,
                     1.0),
    "industrial": Taste(0.85, 0.45, False, 3, 0.6, 2, 0.55, 0.1, 0.8, 0.6, 0.7, 0.6, 0.5, 0.9, 0.4,
                        0.85),
    "japanese": Taste(0.55, 0.1, False, 3, 0.5, 2, 0.35, 0.5, 0.8, 0.4, 0.5, 0.3, 0.3, 0.2, 0.3,
                      0.6),
}  # fmt: skip
"""By name of the style (scene.styles)."""


def taste_of(style: str) -> Taste:
    """That of a style; of modern for one that has none."""
    return TASTES.get(style, TASTES["modern"])
