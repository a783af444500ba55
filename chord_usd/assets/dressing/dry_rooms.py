"""Designs of lamps, of walls and floors of dry rooms, of what stands on shelves."""

from __future__ import annotations

from chord_usd.assets.dressing import (
    ceiling_lamps,
    mirrors,
    pendants,
    pictures,
    plants,
    shelves,
)

_MODULES = (ceiling_lamps, pendants, mirrors, shelves, pictures, plants)

DESIGNS = tuple(design for module in _MODULES for design in module.DESIGNS)
