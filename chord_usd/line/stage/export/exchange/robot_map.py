"""A house as robots know it: an occupancy grid for map_server, rooms and doors, free poses."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from pxr import Usd

from chord_usd.base.metrics.clear_floor import open_borders
from chord_usd.base.metrics.walk import WALKER_RADIUS_M, Walk, entrance
from chord_usd.base.scene.geometry import polygons_of, room_polygon
from chord_usd.base.scene.types import BoolArray, FloatArray, Opening, Room
from chord_usd.line.stage.check.check_stairs import stage_walks, stair_faults
from chord_usd.line.stage.export.exchange.built_house import House, houses_of
from chord_usd.line.stage.export.exchange.occupancy import FREE, RESOLUTION_M, Grid, Window

_MOST_SPAWNS = 5
_SPAWNS_APART_M = 0.75
_WAYS = 16
"""Directions that a pose may look in."""


def write_map(stage: Usd.Stage, folder: Path) -> None:
    """Write map.yaml, map.pgm, rooms.json and spawns.json; of a house of storeys, these in a folder
    for each, and house.json, which says how stairs join them. Raises StageError."""
    storeys = surveyed(stage)
    for storey in storeys:
        place = folder / storey.house.storey.lower() if storey.house.storey else folder
        place.mkdir(exist_ok=True)
        _write_storey(place, storey.house, storey.grid, storey.reach)
    if len(storeys) > 1:
        houses, reaches = [storey.house for storey in storeys], [storey.reach for storey in storeys]
        _write(folder / "house.json", _house(houses, reaches))


@dataclass(frozen=True, eq=False)
class Survey:
    """A storey, its map, and where a robot can be."""

    house: House
    grid: Grid
    reach: Reach

    @property
    def rooms(self) -> dict[str, Any]:
        """Rooms and doors, as rooms.json has them."""
        return _rooms(self.house, self.reach)

    @property
    def ways_out(self) -> dict[str, list[dict[str, float]]]:
        """Free poses from which a way leads to the entrance, by the ids of rooms."""
        free = self.grid.image == FREE
        return {
            room.id: list(_poses(*self.reach.joined_in(room.id), self.grid, free))
            for room in self.house.plan.rooms
        }


def surveyed(stage: Usd.Stage) -> list[Survey]:
    """The storeys of a house, the lowest first. Raises StageError."""
    houses = houses_of(stage)
    grids = [Grid.around(house) for house in houses]
    for grid, house in zip(grids, houses, strict=True):
        grid.fill(house, stage)
    return list(map(Survey, houses, grids, _reaches(grids, houses)))


def _write_storey(folder: Path, house: House, grid: Grid, reach: Reach) -> None:
    header = f"P5\n{grid.image.shape[1]} {grid.image.shape[0]}\n255\n"
    (folder / "map.pgm").write_bytes(header.encode() + grid.image.tobytes())
    west, south = grid.origin_m
    (folder / "map.yaml").write_text(
        "image: map.pgm\nmode: trinary\n"
        f"resolution: {RESOLUTION_M}\norigin: [{west:.2f}, {south:.2f}, 0.0]\n"
        "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
    )
    _write(folder / "rooms.json", _rooms(house, reach))
    _write(folder / "spawns.json", _spawns(house, grid, reach))


def _write(path: Path, data: dict[str, Any]) -> None:
    path.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


@dataclass(frozen=True, eq=False)
class Reach:
    """Where the middle of a robot can be, and which of it the entrance leads to."""

    clear: BoolArray
    """(H, W)"""
    joined: BoolArray
    """(H, W) the part of it that the entrance leads to."""
    rooms: dict[str, tuple[Window, BoolArray]]
    """Cells of each room, by id."""
    shut: frozenset[str]
    """Ids of the rooms that no way leads to, as the certificate has them."""

    def joined_in(self, room_id: str) -> tuple[Window, BoolArray]:
        """Where in a room the entrance leads a robot."""
        window, cells = self.rooms[room_id]
        return window, cells & self.joined[window]

    def able(self, room_id: str) -> tuple[Window, BoolArray]:
        """Where in a room a robot can be: where the entrance leads, if it leads there."""
        window, joined = self.joined_in(room_id)
        cells = self.rooms[room_id][1]
        return window, joined if joined.any() else cells & self.clear[window]


def _reaches(grids: Sequence[Grid], houses: Sequence[House]) -> list[Reach]:
    """What the certificate's walker reaches, and of that what is free on the grids."""
    storeys = [house.scene_as_stated for house in houses]
    walks = stage_walks(storeys, stair_faults(storeys))
    return [_reach(*each) for each in zip(grids, houses, walks, strict=True)]


def _reach(grid: Grid, house: House, walked: Walk) -> Reach:
    free = (grid.image == FREE).astype(np.uint8)
    distance = cv2.distanceTransform(free, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)
    # To the corner of the nearest cell that is not free.
    clear = (distance - math.sqrt(0.5)) * RESOLUTION_M >= WALKER_RADIUS_M
    joined = np.zeros_like(clear)
    for part in polygons_of(walked.reached):
        window, within = grid.cells_in(part)
        joined[window] |= within & clear[window]
    rooms = {room.id: grid.cells_in(room_polygon(room)) for room in house.plan.rooms}
    shut = frozenset(path.rsplit("/", 1)[-1] for path in walked.unreachable)
    return Reach(clear, joined, rooms, shut)


# Rooms and doors ----------------------------------------------------------------------------------


def _house(houses: Sequence[House], reaches: Sequence[Reach]) -> dict[str, Any]:
    """Storeys, and stairs as edges between their rooms."""
    return {
        "frame": "map",
        "units": "metres, radians",
        "storeys": [
            {
                "folder": house.storey.lower(), "name": house.storey_title,
                "elevation": round(house.elevation_m, 4),
                "rooms": [room.id for room in house.plan.rooms],
                "reachable": any(room.id not in reach.shut for room in house.plan.rooms),
            }
            for house, reach in zip(houses, reaches, strict=True)
        ],
        "stairs": stair_entries(houses),
    }  # fmt: skip


def stair_entries(houses: Sequence[House]) -> list[dict[str, Any]]:
    """Stairs of a house, the lowest storey first, as edges between rooms."""
    return [
        {
            "id": stair.id, "form": stair.form, "storeys": [low, low + 1],
            "rooms": list(stair.rooms),
            "foot": _pose(stair.walk_m[0], stair.walk_m[1]),
            "top": _pose(stair.walk_m[-1], 2 * stair.walk_m[-1] - stair.walk_m[-2]),
            "rise": round(float(stair.walk_m[-1, 2]), 4),
            "length": round(float(np.linalg.norm(np.diff(stair.walk_m, axis=0), axis=1).sum()), 4),
        }
        for low, house in enumerate(houses) for stair in house.stairs
    ]  # fmt: skip


def _pose(at_m: FloatArray, ahead_m: FloatArray) -> dict[str, float]:
    """Where one stands at an end of a stair, and the way one goes up there."""
    x, y, _ = at_m.tolist()
    along = ahead_m - at_m
    yaw_deg = float(np.degrees(np.arctan2(along[1], along[0])))
    return {"x": round(x, 4), "y": round(y, 4), "yaw": _radians(yaw_deg)}


def _rooms(house: House, reach: Reach) -> dict[str, Any]:
    doors = [*_doors(house), *_open_edges(house)]
    front = entrance(house.graph)
    return {
        "frame": "map",
        "units": "metres, radians",
        "entrance": front.id if front else None,
        "rooms": [_room(room, house, reach, doors) for room in house.plan.rooms],
        "doors": doors,
    }


def _room(
    room: Room, house: House, reach: Reach, doors: list[dict[str, Any]]
) -> dict[str, Any]:  # fmt: skip
    return {
        "id": room.id,
        "name": house.titles[room.id],
        "class": room.kind,
        "area": round(room_polygon(room).area, 3),
        "polygon": np.round(room.polygon_m, 4).tolist(),
        "doors": [door["id"] for door in doors if room.id in door["rooms"]],
        "reachable": room.id not in reach.shut,
    }


def _doors(house: House) -> Iterator[dict[str, Any]]:
    """Doors and passages; the outside is no room."""
    for opening in house.plan.openings:
        if opening.kind != "window":
            yield _door(opening, house)


def _door(opening: Opening, house: House) -> dict[str, Any]:
    stated = house.stated.get(opening.id)
    x, y, _ = opening.box.center_m
    return {
        "id": opening.id, "kind": opening.kind, "rooms": list(opening.room_ids),
        "x": round(x, 4), "y": round(y, 4),
        # Across the wall: the way one drives through.
        "yaw": _radians(opening.box.yaw_deg + 90.0),
        "width": round(opening.box.size_m[0], 4), "height": round(opening.box.size_m[2], 4),
        "state": stated.state if stated else None,
    }  # fmt: skip


def _open_edges(house: House) -> Iterator[dict[str, Any]]:
    """Where rooms touch and nothing parts them: the longest straight side of each pair."""
    borders = open_borders(house.plan.rooms, house.plan.openings)
    for border_id, sides in groupby(borders, lambda border: border.id):
        border = max(sides, key=lambda side: side.box.size_m[0])
        yield {**_door(border, house), "id": border_id, "kind": "open", "height": None}


def _radians(yaw_deg: float) -> float:
    """Within half a turn of 0."""
    yaw = math.remainder(math.radians(yaw_deg), 2 * math.pi)
    return math.trunc(yaw * 1e4) / 1e4  # rounded, half a turn would be more than one


# Poses --------------------------------------------------------------------------------------------


def _spawns(house: House, grid: Grid, reach: Reach) -> dict[str, Any]:
    free = grid.image == FREE
    return {
        "frame": "map",
        "radius": WALKER_RADIUS_M,
        "rooms": {
            room.id: list(_poses(*reach.able(room.id), grid, free)) for room in house.plan.rooms
        },
    }


def _poses(
    window: Window, able: BoolArray, grid: Grid, free: BoolArray
) -> Iterator[dict[str, Any]]:
    """Poses far from each other, the first in the middle of the room's free floor.

    able: where in a window of the grid a robot can be.
    """
    rows, columns = np.nonzero(able)
    if not len(rows):
        return
    padded = np.pad(able.astype(np.uint8), 1)
    room_m = cv2.distanceTransform(padded, cv2.DIST_L2, cv2.DIST_MASK_PRECISE)[1:-1, 1:-1]
    # Of several as far from everything the first: the last digits are not the same in each run.
    chosen = int(np.argmax(room_m[rows, columns].round(3)))
    rows, columns = rows + window[0].start, columns + window[1].start
    at = np.column_stack([rows, columns]).astype(np.float64)
    away = np.full(len(at), np.inf)
    for _ in range(_MOST_SPAWNS):
        x, y = grid.at_m(rows[chosen], columns[chosen])
        yaw = _yaw_of_widest_view(free, int(rows[chosen]), int(columns[chosen]))
        yield {"x": round(float(x), 4), "y": round(float(y), 4), "yaw": yaw}
        away = np.minimum(away, np.hypot(*(at - at[chosen]).T) * RESOLUTION_M)
        chosen = int(np.argmax(away))
        if away[chosen] < _SPAWNS_APART_M:
            return


def _yaw_of_widest_view(free: BoolArray, row: int, column: int) -> float:
    """The direction with most free floor straight ahead."""
    steps = np.arange(1, int(math.hypot(*free.shape)) + 1)
    longest, best = -1, 0.0
    for number in range(_WAYS):
        yaw = 2 * math.pi * number / _WAYS
        rows = np.rint(row - steps * math.sin(yaw)).astype(int)
        columns = np.rint(column + steps * math.cos(yaw)).astype(int)
        inside = (rows >= 0) & (rows < free.shape[0]) & (columns >= 0) & (columns < free.shape[1])
        seen = np.zeros(len(steps), dtype=bool)
        seen[inside] = free[rows[inside], columns[inside]]
        length = int(np.argmin(seen)) if not seen.all() else len(seen)
        if length > longest:
            longest, best = length, yaw
    return _radians(math.degrees(best))
