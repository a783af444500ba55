"""The paper's own tables of its data set (CHOrD, supplementary, section on the data set).

The tables do not agree with each other: 88,973 non-empty rooms of 94,964 would be an empty-room
rate of 0.063, and the text says 0.2902. Both are kept.
"""

from __future__ import annotations

from chord_usd.base.scene.types import RoomKind
from chord_usd.workshop.data.floorplans.programme import ROOM_COUNT_HISTOGRAM

HOUSES = 9706

ITEMS: dict[str, int] = {
    "bed": 24354, "cabinet": 19365, "bed_background": 16619, "bedside_table": 10439,
    "table": 9359, "leisure_sofa": 8953, "sofa": 8430, "tv_cabinet": 7935,
    "sofa_background": 7019, "coffee_table": 7005, "dining_cabinet": 5368, "shoe_cabinet": 4817,
    "single_sofa": 3939, "dining_table": 3444, "side_coffee_table": 4195,
    "single_door_floor_cabinet": 15889, "double_door_floor_cabinet": 14156,
    "cooker_cabinet": 6904, "sink_cabinet": 6773, "electrical_floor_cabinet": 2081,
    "refrigerator": 1307, "shower": 15174, "toilet": 15026, "washbasin": 12517,
    "washing_machine": 970, "washing_set": 4153,
}  # fmt: skip
"""Occurrences of its 26 categories; it counts neither chairs nor bathtubs."""

ROOM_COUNTS: dict[int, int] = {**ROOM_COUNT_HISTOGRAM, 28: 1}
"""Houses by number of rooms."""

ROOMS_PER_HOUSE = 9.78

NON_EMPTY_ROOMS: dict[str, int] = {
    "living": 15115, "bedroom": 40983, "kitchen": 8262, "bathroom": 16351, "balcony": 8262,
}  # fmt: skip

ROOM_GROUPS: dict[str, tuple[RoomKind, ...]] = {
    "living": ("living", "dining"),
    "bedroom": ("bedroom", "study"),
    "kitchen": ("kitchen",),
    "bathroom": ("bathroom",),
    "balcony": ("balcony",),
}
"""Our kinds of room by the row of NON_EMPTY_ROOMS they fall under."""

EMPTY_ROOM_RATE, POR, PIOU = 0.2902, 0.0044, 0.0018
"""From its table of data quality."""
