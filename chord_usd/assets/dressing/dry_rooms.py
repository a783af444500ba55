"""Designs of lamps, of walls and floors of dry rooms, of what stands on shelves."""

from __future__ import annotations

from chord_usd.assets.dressing import (
    books,
    ceiling_lamps,
    containers,
    mirrors,
    ornaments,
    pendants,
    pictures,
    plants,
    shelves,
    standing_lamps,
    wall_fittings,
    wall_lamps,
)

_MODULES = (
    ceiling_lamps,
    pendants,
    mirrors,
    shelves,
    pictures,
    plants,
    wall_fittings,
    books,
    standing_lamps,
    wall_lamps,
    containers,
    ornaments,
)

DESIGNS = tuple(design for module in _MODULES for design in module.DESIGNS)
