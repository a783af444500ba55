"""Designs of what rooms are dressed with: textiles, lamps, pictures, plants, fittings."""

from __future__ import annotations

from chord_usd.assets.dressing import (
    appliances,
    bath_things,
    dry_rooms,
    kitchen_walls,
    soft_things,
    vessels,
    worktop_things,
)
from chord_usd.assets.model import Design


def designs() -> tuple[Design, ...]:
    """All of them, in no particular order."""
    served = (kitchen_walls, worktop_things, appliances, vessels, bath_things)
    modules = (dry_rooms, *served, soft_things)
    return tuple(design for module in modules for design in module.DESIGNS)
