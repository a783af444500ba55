"""Designs of what rooms are dressed with: textiles, lamps, pictures, plants, fittings."""

from __future__ import annotations

from chord_usd.assets.dressing import ceiling_lamps, mirrors, pendants, shelves
from chord_usd.assets.model import Design


def designs() -> tuple[Design, ...]:
    """All of them, in no particular order."""
    modules = (ceiling_lamps, pendants, mirrors, shelves)
    return tuple(design for module in modules for design in module.DESIGNS)
