"""Balconies, corridors, studies and stores."""

from __future__ import annotations

from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.workshop.data.furnish import sizes
from chord_usd.workshop.data.furnish.floor import Floor
from chord_usd.workshop.data.furnish.storage import (
    anchored,
    best_spot,
    put_armchair,
    put_cabinet,
    put_shoe_cabinet,
)
from chord_usd.workshop.data.furnish.workplace import put_desk


def furnish_balcony(floor: Floor, *, with_laundry: bool) -> None:
    """Laundry at one end, else an armchair, else nothing."""
    dice = floor.dice
    if with_laundry:
        category = "washing_set" if dice.random() < 0.93 else "washing_machine"
        _put_laundry(floor, category)
    if floor.area_m2 > 3.0 and dice.random() < floor.mix.balcony_armchair:
        put_armchair(floor)


def _put_laundry(floor: Floor, category: str) -> None:
    """The usual size, else the smallest, as balconies are narrow."""
    row = CATEGORIES[category]
    usual = sizes.sampled(floor.dice, category, deepest=0.65)
    for size in (usual, (row.length_m[0], row.width_m[0], usual[2])):
        spot = best_spot(floor, size, 0.55, size[0], lambda f, s, wanted: -abs(s.length - wanted))
        if spot:
            floor.new_group()
            floor.put(category, spot.wall, anchored(floor, spot, size[0]), size, reach=0.55)
            return


def furnish_corridor(floor: Floor) -> None:
    """A shoe cabinet at the entrance, now and then a cabinet."""
    if floor.dice.random() < 0.95:
        put_shoe_cabinet(floor)
    if floor.area_m2 > 6.0 and floor.dice.random() < 0.15:
        put_cabinet(floor, tall=False, longest=1.2)


def furnish_study(floor: Floor) -> None:
    """Desk and chair, a cabinet for books, an armchair where there is room."""
    dice = floor.dice
    put_desk(floor, core=True)
    if dice.random() < floor.mix.shelf:
        put_cabinet(floor, tall=True, longest=dice.uniform(1.0, 2.4))
    if floor.area_m2 > 8.0 and dice.random() < floor.mix.study_armchair:
        put_armchair(floor)


def furnish_store(floor: Floor) -> None:
    """A cabinet in less than half of them."""
    if floor.dice.random() < floor.mix.store_cabinet:
        put_cabinet(floor, tall=True, longest=floor.dice.uniform(1.0, 2.4))
