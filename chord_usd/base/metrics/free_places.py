"""Where an item could stand without anything to find fault with; for what moves items."""

from __future__ import annotations

from collections.abc import Iterable

import shapely

from chord_usd.base.metrics.clear_floor import ClearFloor, is_high_enough
from chord_usd.base.metrics.overlap import MIN_OVERLAP_M2, overlaps_by_nature
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.places import FreePlaces
from chord_usd.base.scene.types import Item


def free_places(
    item: Item,
    floor: shapely.Polygon | None,
    items: Iterable[Item],
    clear: Iterable[ClearFloor],
    *,
    anew: bool = False,
) -> FreePlaces:
    """Places in an item's room where it is in no other item and before no opening.

    floor: of its room, None where it is in none. items: all of the house; those that overlap it by
    nature are not in its way. It comes no farther before openings that it stands before; anew: it
    comes before none.
    """
    others = [
        footprint_polygon(other.box)
        for other in items
        if other.id != item.id and not overlaps_by_nature(item, other)
    ]
    kept_free = [ground for opening, ground in clear if is_high_enough(item, opening)]
    here = None if anew else item.box
    return FreePlaces(here, floor, [*others, *kept_free], touch_m2=MIN_OVERLAP_M2)
