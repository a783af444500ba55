"""Every design of the embedded database, in a fixed order."""

from __future__ import annotations

from functools import lru_cache
from importlib import import_module

from chord_usd.library.kit.model import Design

_MODULES = {
    "seating": "seats",
    "beds": "beds",
    "tables": "tables",
    "storage": "cabinets sideboards shelves boxes containers umbrella_stands",
    "lighting": "table_lamps standing_lamps wall_lamps ceiling_lamps pendants",
    "plants": "plants table_plants trailing_plants",
    "kitchen": "kitchen_units cooker_hoods splashbacks wall_cabinets worktop_things"
    " small_appliances vessels bottles tableware",
    "bath": "bathtubs washbasins toilets showers laundry bath_things",
    "textiles": "curtains curtain_rails blinds rugs cushions towels",
    "pictures": "wall_pictures panels mirrors clocks",
    "objects": "desktop desk_devices books ornaments vases",
    "fittings": "radiators wall_fittings",
}


@lru_cache(maxsize=1)
def designs() -> tuple[Design, ...]:
    """All designs, sorted by category and id."""
    modules = [
        import_module(f"chord_usd.library.{group}.{name}")
        for group, names in _MODULES.items()
        for name in names.split()
    ]
    drawn = (design for module in modules for design in module.DESIGNS)
    return tuple(sorted(drawn, key=lambda design: (design.category, design.id)))
