"""How often homes hold what a room could do without: shares of the rooms where a piece may fit.

Two mixes: PAPER furnishes as sparsely as the paper's houses, HOMES as people live. Where the shares
of HOMES come from:

- Bedside tables: 1,098 rooms with a bed of 3D-FRONT have none, one or two beside wide beds in 24,
  20 and 55 of 100, beside narrow ones in 54, 23 and 23.
- Wardrobe or chest: 61 of 100 rooms there, which leaves out what is built in; we draw that, too.
- Television in bedrooms there: 8 of 100 below 10 m2, 14 below 14 m2, 28 below 20 m2, 44 above.
  Desk or dressing table: 13 to 37. We take more desks: those bedrooms have studies beside them.
- Living rooms there (1,044): coffee table 78, television 66, side table 47, armchair 35 to 50,
  sideboard or cabinet 37 to 55 of 100. Ours need one of the first two to be complete.
- Refrigerators: nearly every household (99.8 of 100 in the Residential Energy Consumption Survey of
  the United States, 2020), washing machines too; drawn where they fit.
- Baths: 96 of 100 real flats of data.flats show a tub. As many western homes have showers only, a
  third is taken for procedural houses; drawings of flats are followed.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import Literal

Statistics = Literal["homes", "paper"]
"""Whose houses to imitate."""


@dataclass(frozen=True)
class Mix:
    """Shares in [0, 1]; shares of counts begin at none."""

    bed_m_per_m2: float
    """How much wider the bed is in a larger room."""
    bedside_wide: tuple[float, float, float]
    """Beds with none, one and two bedside tables; wide beds here, narrow ones below."""
    bedside_narrow: tuple[float, float, float]
    storage: float
    """Bedrooms above 8 m2 with a wardrobe or chest; smaller ones below."""
    storage_small: float
    chest: float
    """Of these, low ones."""
    chest_besides: float
    """Bedrooms with a chest besides, from an area on."""
    chest_from_m2: float
    desk: float
    bedroom_television: float
    bedroom_armchair: float
    """From an area on."""
    bedroom_armchair_from_m2: float
    shelf: float
    """Studies with a cabinet for books."""
    study_armchair: float
    store_cabinet: float
    coffee_table: float
    side_table: float
    single_sofas: tuple[float, float, float]
    living_armchair: float
    living_cabinet: float
    living_covered: float
    """Share of the floor of large ones from which on nothing more is put down."""
    shoe_cabinet: float
    living_dining: float
    """Large living rooms of houses without a dining room that hold the table; others below."""
    living_dining_small: float
    dining_cabinet: float
    """Dining rooms with one; living rooms with a dining table and without below."""
    dining_cabinet_at_table: float
    dining_cabinet_living: float
    refrigerator: float
    electrical: float
    """Kitchens with an oven or microwave in a cabinet."""
    single_door: float
    """Cabinets with one door that a composed kitchen keeps: the paper's kitchens have fewer."""
    washbasin: float
    """Bathrooms up to 5.5 m2 with the basin inside, not in front of them."""
    bathtub: float
    washing_machine: float
    """Bathrooms above 5 m2 with one."""
    refrigerator_anywhere: float
    """Houses that take one elsewhere where the row of the kitchen has no room for it; houses with a
    washing machine in any room that can hold one below.
    """
    washing_machine_anywhere: float
    balcony_armchair: float


PAPER = Mix(
    bed_m_per_m2=0.085, bedside_wide=(0.64, 0.14, 0.22), bedside_narrow=(0.66, 0.32, 0.02),
    storage=0.68, storage_small=0.5, chest=0.45, chest_besides=0.08, chest_from_m2=16.0,
    desk=0.5, bedroom_television=0.25, bedroom_armchair=0.36, bedroom_armchair_from_m2=15.0,
    shelf=0.5, study_armchair=0.4, store_cabinet=0.4, coffee_table=0.85, side_table=0.4,
    single_sofas=(0.25, 0.4, 0.35), living_armchair=0.55, living_cabinet=0.1, living_covered=0.0,
    shoe_cabinet=0.8, living_dining=0.3, living_dining_small=0.06, dining_cabinet=0.75,
    dining_cabinet_at_table=0.6, dining_cabinet_living=0.4, refrigerator=0.13,
    electrical=0.22, single_door=0.58, washbasin=0.72, bathtub=0.08, washing_machine=0.06,
    refrigerator_anywhere=0.0, washing_machine_anywhere=0.0, balcony_armchair=0.3,
)  # fmt: skip

HOMES = Mix(
    bed_m_per_m2=0.07, bedside_wide=(0.05, 0.15, 0.8), bedside_narrow=(0.2, 0.7, 0.1),
    storage=0.95, storage_small=0.9, chest=0.25, chest_besides=0.7, chest_from_m2=10.0,
    desk=0.75, bedroom_television=0.5, bedroom_armchair=0.5, bedroom_armchair_from_m2=10.0,
    shelf=0.9, study_armchair=0.4, store_cabinet=0.6, coffee_table=0.95, side_table=0.75,
    single_sofas=(0.1, 0.4, 0.5), living_armchair=0.7, living_cabinet=0.75, living_covered=0.27,
    shoe_cabinet=0.8, living_dining=0.9, living_dining_small=0.6, dining_cabinet=0.75,
    dining_cabinet_at_table=0.6, dining_cabinet_living=0.65, refrigerator=1.0, electrical=0.85,
    single_door=1.0, washbasin=1.0, bathtub=0.33, washing_machine=0.45, refrigerator_anywhere=1.0,
    washing_machine_anywhere=1.0, balcony_armchair=0.3,
)  # fmt: skip

MIXES: dict[Statistics, Mix] = {"homes": HOMES, "paper": PAPER}


def count_of(dice: random.Random, shares: tuple[float, float, float]) -> int:
    """None, one or two."""
    return dice.choices((0, 1, 2), shares)[0]
