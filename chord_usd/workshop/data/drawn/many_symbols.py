"""Symbols of furniture and fixtures in many hands, by category."""

from __future__ import annotations

from chord_usd.workshop.data.drawn.fixture_symbols import (
    basin,
    hob,
    shower,
    sink,
    toilet,
    tub,
)
from chord_usd.workshop.data.drawn.furniture_symbols import (
    armchair,
    bed,
    chair,
    desk,
    fridge,
    oven,
    sofa,
    table,
    wardrobe,
    washer,
)
from chord_usd.workshop.data.drawn.symbol_shapes import Draw

DRAWN: dict[str, Draw] = {
    "bed": bed, "sofa": sofa, "leisure_sofa": armchair, "single_sofa": armchair, "toilet": toilet,
    "washbasin": basin, "washing_set": basin, "bathtub": tub, "shower": shower,
    "cooker_cabinet": hob, "sink_cabinet": sink, "washing_machine": washer, "table": desk,
    "dining_table": table, "coffee_table": table, "side_coffee_table": table, "chair": chair,
    "cabinet": wardrobe, "refrigerator": fridge, "electrical_floor_cabinet": oven,
}  # fmt: skip
"""How pieces of each category are drawn; every call another way, by its generator."""
