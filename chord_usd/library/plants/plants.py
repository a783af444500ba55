"""Plants that stand on floors, in pots and baskets."""

from __future__ import annotations

from collections.abc import Callable

from chord_usd.library.kit.model import Part
from chord_usd.library.kit.solids import Size
from chord_usd.library.plants.leaves import (
    PotKind,
    grown,
    pot,
)


def potted(
    size_m: Size, kind: PotKind, radius_m: float, height_m: float, draw: Callable
) -> tuple[Part, ...]:
    length, width, height = size_m
    vessel = pot(kind, radius_m, height_m)
    named = draw(size_m, vessel)
    return (*vessel.parts, *grown(named, length, width, vessel.soil_m, height))
