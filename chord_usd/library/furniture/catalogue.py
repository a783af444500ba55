"""Every design of the embedded database, in a fixed order."""

from __future__ import annotations

from functools import lru_cache

from chord_usd.library import dressing
from chord_usd.library.furniture import (
    bathtubs,
    beds,
    cabinets,
    desk_devices,
    desktop,
    kitchen_units,
    laundry,
    panels,
    seats,
    showers,
    sideboards,
    table_lamps,
    table_plants,
    tables,
    tableware,
    toilets,
    washbasins,
)
from chord_usd.library.kit.model import Design


@lru_cache(maxsize=1)
def designs() -> tuple[Design, ...]:
    """All designs, sorted by category and id."""
    living = (beds, seats, tables, cabinets, sideboards, panels)
    wet = (kitchen_units, toilets, bathtubs, washbasins, showers, laundry)
    small = (desktop, desk_devices, table_lamps, table_plants, tableware)
    found = [design for module in (*living, *wet, *small) for design in module.DESIGNS]
    found += dressing.designs()
    return tuple(sorted(found, key=lambda design: (design.category, design.id)))
