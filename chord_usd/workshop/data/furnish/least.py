"""Rooms too cramped for the usual furniture of their kind: what they need in its smallest form."""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial

from chord_usd.base.scene.types import RoomKind
from chord_usd.workshop.data.furnish.appliances import WASHING_MACHINE
from chord_usd.workshop.data.furnish.floor import Floor, Size
from chord_usd.workshop.data.furnish.free_spans import Wall
from chord_usd.workshop.data.furnish.joint import Fitting, Part, place_jointly

MOST_TRIES = 24
"""Placements tried for each order of a programme."""

_CHAIR: Size = (0.44, 0.48, 0.85)

_TOILET = Fitting("toilet", (0.4, 0.62, 0.78), 0.4)
_SMALL_TOILET = Fitting("toilet", (0.36, 0.5, 0.78), 0.35)
_BASIN = Fitting("washbasin", (0.45, 0.35, 0.85), 0.4)
_SMALL_BASIN = Fitting("washbasin", (0.35, 0.25, 0.85), 0.3)
_SHOWER = Fitting("shower", (0.75, 0.75, 2.0), 0.35, longest_m=1.4)
_LOW_BATH = Fitting("bathtub", (1.3, 0.68, 0.5), 0.35, longest_m=1.8)
_SINK = Fitting("sink_cabinet", (0.6, 0.5, 0.85), 0.45)
_COOKER = Fitting("cooker_cabinet", (0.6, 0.5, 0.85), 0.45)
_REFRIGERATOR = Fitting("refrigerator", (0.55, 0.55, 1.6), 0.45)
_BED = Fitting("bed", (0.9, 1.9, 0.85), 0.0)
_WARDROBE = Fitting("cabinet", (0.8, 0.55, 2.0), 0.4)
_CHEST = Fitting("cabinet", (0.6, 0.4, 0.8), 0.35)
_SEAT = Fitting(
    "leisure_sofa", (0.65, 0.65, 0.75), 0.3,
    parts=(Part("coffee_table", (0.6, 0.5, 0.4), 0.0, 1.15, 0),), deep_m=1.4,
)  # fmt: skip
_SOFA = Fitting(
    "sofa", (1.4, 0.8, 0.75), 0.3, parts=(Part("coffee_table", (0.6, 0.5, 0.4), 0.0, 1.3, 0),),
    deep_m=1.55,
)  # fmt: skip
_TABLE_FOR_TWO = Fitting(
    "dining_table", (0.8, 0.75, 0.75), 0.2, slot_m=1.8,
    parts=(Part("chair", _CHAIR, -0.64, 0.375, 3), Part("chair", _CHAIR, 0.64, 0.375, 1)),
)  # fmt: skip
_TABLE_IN_CORNER = Fitting(
    "dining_table", (0.8, 0.75, 0.75), 0.2, slot_m=0.9,
    parts=(Part("chair", (0.4, 0.48, 0.85), -0.2, 0.99, 2),
           Part("chair", (0.4, 0.48, 0.85), 0.2, 0.99, 2)), deep_m=1.23,
)  # fmt: skip

PROGRAMMES: dict[RoomKind, tuple[tuple[Fitting, ...], ...]] = {
    "bathroom": (
        (_SHOWER, _TOILET, _BASIN), (_SHOWER, _SMALL_TOILET, _SMALL_BASIN),
        (_LOW_BATH, _SMALL_TOILET, _SMALL_BASIN), (_SMALL_TOILET, _SMALL_BASIN),
        (_SHOWER, _SMALL_TOILET), (_SHOWER, _SMALL_BASIN), (_TOILET,), (_SMALL_TOILET,),
        (_SMALL_BASIN,),
    ),
    "washroom": ((WASHING_MACHINE, _SMALL_BASIN), (WASHING_MACHINE,), (_SMALL_BASIN,)),
    "wc": ((_TOILET, _SMALL_BASIN), (_SMALL_TOILET, _SMALL_BASIN), (_TOILET,), (_SMALL_TOILET,)),
    "kitchen": ((_SINK, _COOKER, _REFRIGERATOR), (_SINK, _COOKER), (_SINK,)),
    "bedroom": ((_BED, _WARDROBE), (_BED, _CHEST), (_BED,), (_WARDROBE,), (_CHEST,)),
    "living": (
        (_SOFA,), (_SEAT,), (Fitting("leisure_sofa", (0.6, 0.6, 0.75), 0.3),),
        (Fitting("tv_cabinet", (1.0, 0.3, 0.45), 0.4),), (_CHEST,),
    ),
    "dining": (
        (_TABLE_FOR_TWO,), (_TABLE_IN_CORNER,),
        (Fitting("dining_table", (0.8, 0.75, 0.75), 0.3),),
        (Fitting("dining_cabinet", (0.8, 0.35, 0.85), 0.4),),
    ),
    "study": ((Fitting("table", (0.8, 0.45, 0.75), 0.5),), (_CHEST,)),
}  # fmt: skip
"""By kind of room, what one would rather have first."""
STUDIO = ((_BED, _SOFA), (_BED, _SEAT), (_BED,), *PROGRAMMES["living"])
"""The same of a living room where people sleep."""


def furnish_least(floor: Floor, fewest: int = 1) -> None:
    """Stand the first programme that cuts off no door; nothing where none does.

    To be called for a room that holds nothing, as narrow as can be. fewest: pieces of the
    programmes to try.
    """
    programmes = STUDIO if floor.is_studio else PROGRAMMES.get(floor.kind, ())
    for programme in programmes:
        if len(programme) >= fewest and place_jointly(
            floor, programme, partial(_far_from_doors, floor), MOST_TRIES, any_order=True
        ):
            return


def _far_from_doors(
    floor: Floor, fitting: Fitting, wall: Wall, s: float, corners: int, used: Sequence[Wall]
) -> float:
    del used
    return floor.distance_to_door(*wall.world(s, fitting.size[1] / 2)) + 0.3 * corners
