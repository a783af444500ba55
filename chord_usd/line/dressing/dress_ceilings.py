"""The fittings of ceilings: one over every dining table, one at the middle of every other room."""

from __future__ import annotations

from chord_usd.base.scene.light_panel import panel_for
from chord_usd.base.scene.types import ROOM_HEIGHT_M, WET_KINDS, Asset, Box, Item, RoomKind
from chord_usd.line.dressing.room_frame import RoomFrame
from chord_usd.line.dressing.stock import within

HEAD_M = 2.0
"""Nothing hangs lower, but over tables."""

_OVER_TABLE_M = 0.65
"""Least from a table's top to the lamp over it."""

_NEAR_TABLE_M = 1.2
"""A lamp over a table so near to the middle of the room is its lamp, too."""

_LARGE_M2 = 14.0
_TABLES = ("dining_table",)


def dress_ceilings(frame: RoomFrame) -> None:
    """Pendants over dining tables, then the room's own fitting where none is at its middle."""
    panel = panel_for(frame.floor)
    lit = False
    for table in frame.of(*_TABLES):
        lamp = _pendant(frame, table)
        if lamp is not None:
            x, y, _ = lamp.box.center_m
            far = max(abs(x - panel.center_m[0]), abs(y - panel.center_m[1]))
            lit = lit or far < _NEAR_TABLE_M
    if not lit:
        _fitting(frame, panel.center_m, panel.yaw_deg)


def _pendant(frame: RoomFrame, table: Item) -> Item | None:
    """A lamp that hangs over the middle of a table, no longer than it."""
    top_m = table.box.top_m
    most_m = (0.8 * table.box.size_m[0], 0.95 * table.box.size_m[1],
              ROOM_HEIGHT_M - top_m - _OVER_TABLE_M)  # fmt: skip
    lamps = within(frame.stock.offered("pendant_lamp"), most_m)
    lamps = list(frame.stock.family(lamps, "pendant_lamp"))
    for lamp in sorted(lamps, key=lambda a: (-a.size_m[0], -a.size_m[2], a.id)):
        x, y, _ = table.box.center_m
        center_m = (x, y, ROOM_HEIGHT_M - lamp.size_m[2])
        item = frame.put_where_free(
            lamp, Box(center_m, lamp.size_m, table.box.yaw_deg), rests_on=None
        )
        if item is not None:
            return item
    return None


def _fitting(frame: RoomFrame, at_m: tuple[float, float], yaw_deg: float) -> Item | None:
    """A lamp at the ceiling that nobody hits."""
    lamps = within(frame.stock.offered("ceiling_lamp"), (9.0, 9.0, ROOM_HEIGHT_M - HEAD_M))
    if _use(frame.kind) == "wet":
        lamps = [lamp for lamp in lamps if lamp.size_m[2] <= 0.3] or lamps
    family = frame.stock.family(lamps, f"ceiling_lamp/{_use(frame.kind)}")
    large = frame.floor.area > _LARGE_M2
    return _first_that_fits(frame, sorted(family, key=lambda a: (a.size_m[0], a.id), reverse=large),
                            at_m, yaw_deg)  # fmt: skip


def _use(kind: RoomKind) -> str:
    """Rooms of one use have lamps of one family."""
    served = (*WET_KINDS, "balcony", "store", "corridor", "kitchen")
    return "wet" if kind in served else "lived"


def _first_that_fits(
    frame: RoomFrame, lamps: list[Asset], at_m: tuple[float, float], yaw_deg: float
) -> Item | None:
    for lamp in lamps:
        box = Box((*at_m, ROOM_HEIGHT_M - lamp.size_m[2]), lamp.size_m, yaw_deg)
        item = frame.put_where_free(lamp, box)
        if item is not None:
            return item
    return None
