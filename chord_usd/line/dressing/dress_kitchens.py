"""Over the worktop: hood, wall cabinets, splashback, rail."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from chord_usd.base.places.wall_frames import WallFace
from chord_usd.base.raster.relief import Relief
from chord_usd.base.scene.geometry import in_world
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import ROOM_HEIGHT_M, Asset, Box, Item
from chord_usd.line.dressing.room_frame import RoomFrame
from chord_usd.line.dressing.stock import family_of, nearest_length, stretched

_CABINET_BASE_M = 1.44
_CABINET_M = 0.7
_HOOD_BASE_M = 1.62
_CHIMNEY_FROM_M = 0.75
"""Higher hoods have a chimney, which reaches the ceiling."""

_GLAZED = 0.15
"""Share of wall cabinets with glass doors."""

_HOB_M = 0.06
"""What one cooks on is no farther from the height of the worktop."""

_BURNERS = (0.24, 0.2, 0.28)
"""Along the cooker from its middle, as shares of its length up to 0.6 m."""

_SOLE = 0.72
"""Share of its body's radius that a pot stands on."""

_LEVEL_M = 0.003

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
                _hood(frame, face, low, high)
        for item, low, high in units:
            if item.category != "cooker_cabinet":
                _over(frame, face, item, low, high)
        for run in _runs(units):
            _splashback(frame, face, run)
        _rail(frame, face, units)
    for cooker in frame.of("cooker_cabinet"):
        _pots(frame, cooker)


def _units_at(frame: RoomFrame, face: WallFace) -> list[Placed]:
    """Low units with their back to a wall, from left to right."""
    units = []
    for item in frame.of(*having("worktop")):
        if item.box.size_m[2] <= _WORKTOP_M and face.has_back_of(item.box):
            low, high, _, _ = face.span_of(item.box)
            units.append((item, max(low, 0.0), min(high, face.length_m)))
    return sorted(units, key=lambda unit: unit[1])


def _runs(units: list[Placed]) -> list[list[Placed]]:
    """Units that touch each other."""
    runs: list[list[Placed]] = []
    for unit in units:
        if runs and unit[1] - runs[-1][-1][2] < _RUN_GAP_M:
            runs[-1].append(unit)
        else:
            runs.append([unit])
    return runs


def _hood(frame: RoomFrame, face: WallFace, low: float, high: float) -> None:
    """Over the cooker, no wider than it."""
    offered = [
        hood
        for hood in frame.stock.offered("cooker_hood")
        if hood.size_m[0] <= (high - low) + 0.06 and _HOOD_BASE_M + hood.size_m[2] <= ROOM_HEIGHT_M
    ]
    hood = nearest_length(frame.stock.family(offered, "cooker_hood"), high - low)
    if hood is None:
        return
    length, depth, height = hood.size_m
    # One that is built in ends where the cabinets beside it do.
    base_m = max(_CABINET_BASE_M, _CABINET_BASE_M + _CABINET_M - height)
    if height > _CHIMNEY_FROM_M:
        base_m = _HOOD_BASE_M
        height = stretched(height, ROOM_HEIGHT_M - 0.002 - base_m, 0.4)
    length = stretched(length, high - low, 0.06)
    frame.put_where_free(hood, face.box((low + high) / 2, base_m, (length, depth, height)))


def _over(frame: RoomFrame, face: WallFace, unit: Item, low: float, high: float) -> None:
    """A wall cabinet over a unit and as long as it, where the wall is free."""
    for asset, start, end in _split(low, high, _cabinets(frame, unit)):
        box = face.box((start + end) / 2, _CABINET_BASE_M, (end - start, *asset.size_m[1:]))
        frame.put_where_free(asset, box)


def _cabinets(frame: RoomFrame, unit: Item) -> Sequence[Asset]:
    """Those of the house, here and there glazed or open."""
    offered = frame.stock.offered("wall_cabinet")
    is_open = frame.draws.chance(f"open/{unit.id}", frame.taste.open_kitchen)
    is_glazed = frame.draws.chance(f"glazed/{unit.id}", _GLAZED)
    plain = [a for a in offered if not {"open", "glazed"} & set(a.tags)]
    family = frame.stock.family(plain or offered, "wall_cabinet")
    if is_open and frame.stock.offered("wall_cabinet", "open"):
        return frame.stock.offered("wall_cabinet", "open")
    if is_glazed and family:
        start = f"{family_of(family[0])}_"
        glazed = frame.stock.offered("wall_cabinet", "glazed")
        return [a for a in glazed if a.id.startswith(start)] or family
    return family


def _rail(frame: RoomFrame, face: WallFace, units: Sequence[Placed]) -> None:
    """Ladles on the wall beside the cooker."""
    if not frame.draws.chance("utensil_rail", frame.taste.little * 0.7):
        return
    rails = frame.stock.family(frame.stock.offered("utensil_rail"), "utensil_rail")
    at = [(low + high) / 2 for item, low, high in units if item.category == "cooker_cabinet"]
    beside = [unit for unit in units if unit[0].category in having("floor_cabinet")]
    for _, low, high in sorted(
        beside, key=lambda unit: abs((unit[1] + unit[2]) / 2 - (at or [0])[0])
    ):
        for asset in sorted(rails, key=lambda a: (-a.size_m[0], a.id)):
            base_m = _CABINET_BASE_M - 0.05 - asset.size_m[2]
            box = frame.against(face, (low + high) / 2, base_m, asset.size_m)
            if box and asset.size_m[0] < high - low and frame.put_where_free(asset, box):
                return


def _pots(frame: RoomFrame, cooker: Item) -> None:
    """One or two on the hob, over its burners."""
    relief = frame.relief(cooker)
    rng = frame.draws.rng(f"pots/{cooker.id}")
    length, depth, height = cooker.box.size_m
    count = 1 + int(rng.random() < 0.4)
    pots = frame.stock.some(frame.stock.offered("pot"), rng, count)
    for asset, side in zip(pots, (-1, 1), strict=False):
        # The body is as wide as the pot is deep. A long handle is to its right, ears are on both
        # sides.
        beside_m = asset.size_m[0] - asset.size_m[1]
        handle_m = beside_m / 2 if beside_m > 0.5 * asset.size_m[1] else 0.0
        sole_m = _SOLE * asset.size_m[1] / 2
        for back, along in product((-side, side), _BURNERS):
            at = (side * along * min(length, 0.6), back * 0.2 * min(depth, 0.6) + 0.02)
            top_m = _stands_at(relief, at, sole_m)
            if top_m is None or abs(top_m - height) > _HOB_M:
                continue
            local = Box((at[0] + handle_m, at[1], top_m), asset.size_m, 0.0)
            box = in_world(local, cooker.box)
            if frame.put_where_free(asset, box, rests_on=cooker.id, but=(cooker.id,)):
                break


def _stands_at(relief: Relief, at: tuple[float, float], sole_m: float) -> float | None:
    """The height at which a sole of this radius stands; None where it would tip over."""
    rim = [(at[0] + x * sole_m, at[1] + y * sole_m) for x, y in product((-0.5, 0.5), repeat=2)]
    quarters = [relief.highest_m(Box((x, y, 0.0), (sole_m, sole_m, 0.0), 0.0)) for x, y in rim]
    return max(quarters) if max(quarters) - min(quarters) < _LEVEL_M else None


def _split(low: float, high: float, row: Sequence[Asset]) -> list[tuple[Asset, float, float]]:
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
