"""Over the worktop: hood, wall cabinets, splashback, rail."""

from __future__ import annotations

from chord_usd.dressing.room_frame import RoomFrame
from chord_usd.dressing.stock import nearest_length, stretched
from chord_usd.dressing.wall_faces import WallFace
from chord_usd.scene.types import ROOM_HEIGHT_M, Item

WORKTOP = (
    "single_door_floor_cabinet", "double_door_floor_cabinet", "cooker_cabinet", "sink_cabinet",
    "electrical_floor_cabinet",
)  # fmt: skip
"""Categories of a run with a worktop."""

_CABINET_BASE_M = 1.42
_HOOD_BASE_M = 1.58
_RAIL_BASE_M = 1.22
_LEAST_HEAD_M = 0.45
"""Between a worktop and what hangs over it."""

_RUN_GAP_M = 0.06
_LEAST_SPLASH_M = 0.3
_WORKTOP_M = 1.0
"""Higher pieces have no worktop."""

Placed = tuple[Item, float, float]
"""A unit, and where it begins and ends along its wall."""


def dress_kitchen(frame: RoomFrame) -> None:
    """Every run of units, wall by wall."""
    for face in frame.faces:
        units = _units_at(frame, face)
        for item, low, high in units:
            if item.category == "cooker_cabinet":
                _hood(frame, face, item, low, high)
        for item, low, high in units:
            if item.category not in ("cooker_cabinet",):
                _over(frame, face, item, low, high)
        for run in _runs(units):
            _splashback(frame, face, run)


def _units_at(frame: RoomFrame, face: WallFace) -> list[Placed]:
    """Low units with their back to a wall, from left to right."""
    found = []
    for item in frame.of(*WORKTOP):
        if item.box.size_m[2] <= _WORKTOP_M and face.has_back_of(item.box):
            low, high, _, _ = face.span_of(item.box)
            found.append((item, max(low, 0.0), min(high, face.length_m)))
    return sorted(found, key=lambda one: one[1])


def _runs(units: list[Placed]) -> list[list[Placed]]:
    """Units that touch each other."""
    runs: list[list[Placed]] = []
    for unit in units:
        if runs and unit[1] - runs[-1][-1][2] < _RUN_GAP_M:
            runs[-1].append(unit)
        else:
            runs.append([unit])
    return runs


def _hood(frame: RoomFrame, face: WallFace, cooker: Item, low: float, high: float) -> None:
    """Over the cooker, as long as it is."""
    offered = [
        hood
        for hood in frame.stock.offered("cooker_hood")
        if hood.size_m[0] <= (high - low) + 0.06 and _HOOD_BASE_M + hood.size_m[2] <= ROOM_HEIGHT_M
    ]
    hood = nearest_length(frame.stock.family(offered, "cooker_hood"), high - low)
    if hood is None:
        return
    # A chimney hood reaches the ceiling: it is as high as the room lets it be.
    height = hood.size_m[2]
    if height > 0.75:
        height = stretched(height, ROOM_HEIGHT_M - 0.002 - _HOOD_BASE_M)
    size_m = (hood.size_m[0], hood.size_m[1], height)
    frame.put_where_free(hood, face.box((low + high) / 2, _HOOD_BASE_M, size_m), rests_on=None)


def _over(frame: RoomFrame, face: WallFace, unit: Item, low: float, high: float) -> None:
    """A wall cabinet over a unit and as long as it, where the wall is free."""
    cabinets = frame.stock.family(frame.stock.offered("wall_cabinet"), "wall_cabinet")
    if not cabinets:
        return
    heights = sorted({asset.size_m[2] for asset in cabinets if asset.size_m[2] >= 0.5})
    if not heights:
        return
    tall = heights[int(len(heights) * frame.house.share("wall_cabinet_height"))]
    row = [asset for asset in cabinets if asset.size_m[2] == tall]
    for spans in (_split(low, high, row),):
        for asset, start, end in spans:
            box = face.box((start + end) / 2, _CABINET_BASE_M, (end - start, *asset.size_m[1:]))
            frame.put_where_free(asset, box)


def _split(low: float, high: float, row: list) -> list:
    """Cabinets that fill a stretch, one or several alike."""
    for count in range(1, 5):
        length = (high - low) / count
        asset = nearest_length(row, length)
        if asset is not None and abs(stretched(asset.size_m[0], length) - length) < 1e-6:
            return [
                (asset, low + index * length, low + (index + 1) * length) for index in range(count)
            ]
    return []


def _splashback(frame: RoomFrame, face: WallFace, run: list[Placed]) -> None:
    """Behind a run, between its worktop and what hangs over it, but for windows."""
    top_m = max(item.box.size_m[2] for item, _, _ in run)
    low, high = run[0][1], run[-1][2]
    offered = frame.stock.family(frame.stock.offered("splashback"), "splashback")
    if not offered or high - low < _LEAST_SPLASH_M:
        return
    room_above = _CABINET_BASE_M - top_m - 0.004
    for start, end in face.free_spans(frame.taken, top_m + 0.05, _CABINET_BASE_M, 0.02):
        start, end = max(start, low), min(end, high)
        if end - start < _LEAST_SPLASH_M:
            continue
        for asset, left, right in _split(start, end, list(offered)):
            height = min(asset.size_m[2] * 1.15, room_above)
            if height < asset.size_m[2] * 0.7:
                continue
            size_m = (right - left, asset.size_m[1], height)
            box = face.box((left + right) / 2, top_m + 0.002, size_m)
            frame.put_where_free(asset, box)
