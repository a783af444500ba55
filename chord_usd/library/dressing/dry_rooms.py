"""Designs of lamps, of walls and floors of dry rooms, of what stands on shelves."""

from __future__ import annotations

from chord_usd.library.dressing import (
    books,
    boxes,
    ceiling_lamps,
    clocks,
    containers,
    mirrors,
    ornaments,
    pendants,
    plants,
    radiators,
    shelves,
    standing_lamps,
    trailing_plants,
    umbrella_stands,
    vases,
    wall_fittings,
    wall_lamps,
    wall_pictures,
)

_MODULES = (
    books,
    boxes,
    ceiling_lamps,
    clocks,
    containers,
    mirrors,
    ornaments,
    pendants,
    wall_pictures,
    plants,
    radiators,
    shelves,
    standing_lamps,
    trailing_plants,
    umbrella_stands,
    vases,
    wall_fittings,
    wall_lamps,
)

DESIGNS = tuple(design for module in _MODULES for design in module.DESIGNS)
