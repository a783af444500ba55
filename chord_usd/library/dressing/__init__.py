"""Designs of what rooms are dressed with: textiles, lamps, pictures, plants, fittings."""

from __future__ import annotations

from chord_usd.library.dressing import (
    bath_things,
    bottles,
    cooker_hoods,
    dry_rooms,
    small_appliances,
    soft_things,
    splashbacks,
    vessels,
    wall_cabinets,
    worktop_things,
)
from chord_usd.library.kit.model import Design


def designs() -> tuple[Design, ...]:
    """All of them, in no particular order."""
    over = (wall_cabinets, cooker_hoods, splashbacks)
    served = (*over, worktop_things, small_appliances, bottles, vessels, bath_things)
    modules = (dry_rooms, *served, soft_things)
    return tuple(design for module in modules for design in module.DESIGNS)
