"""What every home has on its walls: radiators, switches, sockets, a television."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from chord_usd.base.metrics.design.screens import BESIDE_CURTAINS_M, BESIDE_M, places_on_walls
from chord_usd.base.metrics.design.view import View
from chord_usd.base.places.wall_frames import BEHIND_M, Hole, WallFace
from chord_usd.base.scene.geometry import front_direction, to_world
from chord_usd.base.scene.light_panel import panel_for
from chord_usd.base.scene.types import ROOM_HEIGHT_M, WET_KINDS, Asset, Box, Item, Room, RoomKind
from chord_usd.line.dressing.room_frame import RoomFrame
from chord_usd.line.dressing.stock import nearest_length, within

_RADIATOR_BASE_M = 0.12
_UNDER_SILL_M = 0.1
_SWITCH_BASE_M = 1.05
_BESIDE_DOOR_M = 0.17
"""From a door's hole to the middle of its switch."""

_SOCKET_BASE_M = 0.3
_BESIDE_PIECE_M = 0.1
_WORKTOP_SOCKET_M = 1.12
_HEATED = ("living", "dining", "bedroom", "study", "unknown", "kitchen")
"""Kinds of rooms with a radiator, in homes with radiators; the others have floors that heat."""
_HIGH_M, _DEEP_M = 0.7, 0.16
_WALL_LONG_M, _ENDS_M = 0.8, 0.1
"""Usual length of a radiator that hangs under no window, and bare wall beside it."""


def dress_fittings(frame: RoomFrame) -> None:
    """What every home has on its walls, whatever its style: heat, switches, power."""
    if frame.house.chance("radiators", frame.taste.radiators) and frame.kind in _HEATED:
        _heat(frame)
    _switch(frame)
    _sockets(frame)


def hang_television(frame: RoomFrame, view: View) -> None:
    """Where the sofa sees it, or else the bed, in rooms whose cabinets carry none: before windows
    they are bare."""
    if len(view.of("tv_cabinet")) > len(view.bare):
        return
    largest = sorted(
        frame.stock.offered("television"), key=lambda asset: (-asset.size_m[0], asset.id)
    )
    for beside_m, asset in product((BESIDE_CURTAINS_M, BESIDE_M), largest):
        for box in places_on_walls(view, asset.size_m, beside_m):
            step = BEHIND_M * front_direction(box.yaw_deg)
            x, y, z = box.center_m
            off_wall = replace(box, center_m=(x + float(step[0]), y + float(step[1]), z))
            if frame.dressed("television") or frame.put_where_free(asset, off_wall):
                return


def heated_alike(
    rooms: Iterable[Room], dressing: Sequence[Item], new: Collection[str]
) -> list[Item]:
    """The dressing of a home with heating in every room that people live in, or in none: without
    the new radiators of these ids where a room has no place for one."""
    heated = {item.room_id for item in dressing if item.category == "radiator"}
    if all(room.id in heated for room in rooms if room.kind in _HEATED):
        return list(dressing)
    cold = {room.id for room in rooms if room.kind in _HEATED}
    return [item for item in dressing if item.category != "radiator" or item.id not in new
            or item.room_id not in cold]  # fmt: skip


def _heat(frame: RoomFrame) -> None:
    """Radiators under the windows; in a room that has none there, on a bare wall."""
    for face, hole in frame.holes("window"):
        _radiator(frame, face, hole)
    if frame.dressed("radiator"):
        return
    offered = within(frame.stock.offered("radiator"), (9.0, _DEEP_M, _HIGH_M), (0.0, 0.0, 0.3))
    family = frame.stock.family(offered, "radiator")
    lit = [face for face, _ in frame.holes("window")]
    for asset in sorted(family, key=lambda asset: (abs(asset.size_m[0] - _WALL_LONG_M), asset.id)):
        top_m, deep_m = _RADIATOR_BASE_M + asset.size_m[2], asset.size_m[1] + 0.03
        spans = [
            (face not in lit, start - end, face, (start + end) / 2)
            for face in frame.faces
            for start, end in face.free_spans(frame.taken, _RADIATOR_BASE_M, top_m, deep_m)
            if end - start >= asset.size_m[0] + 2 * _ENDS_M
        ]
        for _, _, face, middle in sorted(spans, key=lambda span: span[:2]):
            if _hung(frame, asset, face.box(middle, _RADIATOR_BASE_M, asset.size_m)):
                return


def _hung(frame: RoomFrame, asset: Asset, box: Box) -> bool:
    """A radiator on a wall, where one still gets by."""
    if frame.walkways.stay_with(box, at_ease=False) and frame.put_where_free(asset, box):
        frame.walkways.take(box)
        return True
    return False


def _radiator(frame: RoomFrame, face: WallFace, hole: Hole) -> None:
    """Under the window, about its middle."""
    tallest = hole.low_m - _UNDER_SILL_M - _RADIATOR_BASE_M
    low, high = hole.middle_m, hole.middle_m
    spans = face.free_spans(frame.taken, _RADIATOR_BASE_M, hole.low_m - 0.05, 0.16)
    for start, end in spans:
        if start < hole.middle_m < end:
            half = min(hole.middle_m - start, end - hole.middle_m) - 0.03
            low, high = hole.middle_m - half, hole.middle_m + half
    widest = min(high - low, hole.width_m)
    offered = within(frame.stock.offered("radiator"), (widest, 0.15, tallest), (0.0, 0.0, 0.3))
    radiators = frame.stock.family(offered, "radiator")
    asset = nearest_length(radiators, 0.8 * widest)
    if asset is None:
        return
    _hung(frame, asset, face.box(hole.middle_m, _RADIATOR_BASE_M, asset.size_m))


def _switch(frame: RoomFrame) -> None:
    """Beside the door one comes in by, at its handle's side; on the other where that is taken."""
    switches = frame.stock.family(frame.stock.offered("light_switch"), "light_switch")
    if not switches:
        return
    asset = min(switches, key=lambda a: (a.size_m[0], a.id))
    doors = [*frame.holes("door"), *frame.holes("passage")]
    lit = 0
    for face, hole in doors:
        if hole.opening.id in frame.balcony_doors:
            continue
        for middle in _beside(face, hole):
            box = face.box(middle, _SWITCH_BASE_M, asset.size_m)
            if frame.put_where_free(asset, box):
                lit += 1
                break
        if lit >= (2 if frame.kind in ("corridor", "living") else 1):
            return


def _beside(face: WallFace, hole: Hole) -> tuple[float, float]:
    """Beside the handle, then beside the hinge: leaves hang at the left of their door."""
    right_end = to_world(hole.opening.box, (hole.opening.box.size_m[0] / 2, 0.0))
    handle_right = float(face.local(np.array([right_end]))[0, 0]) > hole.middle_m
    left, right = hole.left_m - _BESIDE_DOOR_M, hole.right_m + _BESIDE_DOOR_M
    return (right, left) if handle_right else (left, right)


def _sockets(frame: RoomFrame) -> None:
    """Beside the pieces that want power."""
    sockets = frame.stock.family(frame.stock.offered("socket"), "socket")
    if not sockets:
        return
    small = min(sockets, key=lambda a: (a.size_m[0], a.id))
    wide = max(sockets, key=lambda a: (a.size_m[0], a.id))
    wanting = frame.of("tv_cabinet", "bedside_table", "bed", "table", "sofa")[:4]
    count = 0
    for item in wanting:
        asset = wide if item.category in ("tv_cabinet", "table") else small
        count += _socket_beside(frame, item, asset, _SOCKET_BASE_M)
    for item in frame.of("washbasin")[:1]:
        _socket_beside(frame, item, small, _WORKTOP_SOCKET_M)
    if frame.kind == "kitchen":
        _worktop_sockets(frame, wide)
    if not count and frame.kind in ("living", "dining", "bedroom", "study", "corridor", "unknown"):
        _socket_anywhere(frame, small)


def _socket_beside(frame: RoomFrame, item: Item, asset: Asset, base_m: float) -> int:
    """On the wall behind a piece, just beside it."""
    for face in frame.faces:
        if face.has_back_of(item.box, 0.3):
            low, high, _, _ = face.span_of(item.box)
            reach = _BESIDE_PIECE_M + asset.size_m[0] / 2
            for middle in (high + reach, low - reach):
                if frame.put_where_free(asset, face.box(middle, base_m, asset.size_m)):
                    return 1
    return 0


def _worktop_sockets(frame: RoomFrame, asset: Asset) -> None:
    """Two over the worktop, at its ends."""
    units = frame.of("single_door_floor_cabinet", "double_door_floor_cabinet")
    for item in (units[:1] + units[-1:])[: len(units)]:
        for face in frame.faces:
            if face.has_back_of(item.box):
                low, high, _, _ = face.span_of(item.box)
                for share in (0.3, 0.7):
                    middle = low + share * (high - low)
                    box = frame.against(face, middle, _WORKTOP_SOCKET_M, asset.size_m)
                    if box and frame.put_where_free(asset, box):
                        break


def _socket_anywhere(frame: RoomFrame, asset: Asset) -> None:
    for face in sorted(frame.faces, key=lambda face: -face.length_m):
        spans = face.free_spans(frame.taken, 0.0, 1.0, 0.1)
        for low, high in spans:
            if high - low > 0.6:
                box = face.box(high - 0.25, _SOCKET_BASE_M, asset.size_m)
                if frame.put_where_free(asset, box):
                    return


# The fittings of ceilings: one over every dining table, one at the middle of every other ---------

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
