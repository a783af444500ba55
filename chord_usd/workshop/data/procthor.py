"""ProcTHOR houses (Deitke et al., NeurIPS 2022) as scene graphs.

Unity's frame is left-handed, metres, y up, angles clockwise seen from above, and assets face +z;
ours is right-handed, z up, and pieces face -y. So (x, y, z) becomes (x, z, y) and a turn of a
degrees becomes a yaw of 180 - a. Walls there have no thickness: here every room gives up half a
wall all round, and what stood against a wall moves in with it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from shapely.geometry import Point, Polygon
from shapely.geometry.polygon import orient

from chord_usd.base.errors import SceneError
from chord_usd.base.metrics.design.unsaid import UNSAID
from chord_usd.base.runtime.json_text import parse_json
from chord_usd.base.scene.geometry import refuse_unreachable, room_polygon
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    Box,
    Item,
    Opening,
    OpeningKind,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)
from chord_usd.workshop.data.nudge import nudged

CATEGORY: dict[str, str] = {
    "Bed": "bed",
    "Dresser": "cabinet",
    "ShelvingUnit": "cabinet",
    "Desk": "table",
    "Sofa": "sofa",
    "ArmChair": "single_sofa",
    "TVStand": "tv_cabinet",
    "CoffeeTable": "coffee_table",
    "DiningTable": "dining_table",
    "Chair": "chair",
    "SideTable": "side_coffee_table",
    "CounterTop": "double_door_floor_cabinet",
    "Fridge": "refrigerator",
    "Sink": "washbasin",
    "Toilet": "toilet",
    "WashingMachine": "washing_machine",
    "ClothesDryer": "washing_machine",
}
"""Its types of objects as ours; what stands on something, or has no place in ours, is left out."""

_KINDS: dict[str, RoomKind] = {
    "Bedroom": "bedroom",
    "LivingRoom": "living",
    "Kitchen": "kitchen",
    "Bathroom": "bathroom",
}

Sizes = Mapping[str, tuple[float, float, float]]
"""Length, depth and height of an asset, metres, by its id."""


def read_asset_sizes(path: Path) -> Sizes:
    """ProcTHOR's asset-database.json: the bounding boxes of all assets. Raises SceneError."""
    try:
        database = parse_json(path.read_bytes(), str(path), SceneError)
        return {
            asset["assetId"]: _size(asset["boundingBox"])
            for assets in database.values()
            for asset in assets
        }
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise SceneError(
            f"cannot be read: {error!r}", where=str(path), expected="ProcTHOR's asset-database.json"
        ) from None


def _size(bounds: Mapping[str, float]) -> tuple[float, float, float]:
    return float(bounds["x"]), float(bounds["z"]), float(bounds["y"])


def house_from_procthor(record: Mapping[str, Any], sizes: Sizes) -> SceneGraph:
    """A house of ProcTHOR. Raises SceneError where a key is missing or a room has no floor.

    sizes: of the assets, which its houses do not hold; pieces of unknown assets get the usual
    size of their category.
    """
    try:
        rooms = tuple(_room(entry) for entry in record["rooms"])
        walls = {wall["id"]: wall["polygon"] for wall in record["walls"]}
        ids = {room.id for room in rooms}
        doors = enumerate(record["doors"], start=1)
        windows = enumerate(record["windows"], start=1)
        openings = (
            *(_opening("door", index, hole, walls, ids) for index, hole in doors),
            *(_opening("window", index, hole, walls, ids) for index, hole in windows),
        )
        items = [
            _item(entry, rooms, sizes, number) for number, entry in enumerate(record["objects"])
        ]
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        raise SceneError(f"no house of ProcTHOR: {error!r}") from None
    known = all(entry.get("assetId") in sizes for entry in record["objects"])
    extra = {} if known else {UNSAID: ["sizes"]}
    placed = tuple(item for item in items if item is not None)
    return SceneGraph(rooms, openings, placed, extra=extra)


def _room(entry: Mapping[str, Any]) -> Room:
    corners = [(float(p["x"]), float(p["z"])) for p in entry["floorPolygon"]]
    refuse_unreachable(corners)
    floor = Polygon(corners)
    face = floor.buffer(-WALL_THICKNESS_M / 2, join_style="mitre")
    if not isinstance(face, Polygon) or face.is_empty:
        raise SceneError("a room is narrower than its walls", where=str(entry["id"]))
    outline = frozen_array(orient(face).simplify(1e-3).exterior.coords[:-1])
    kind = _KINDS.get(entry["roomType"], "unknown")
    return Room(str(entry["id"]), kind, outline, str(entry["roomType"]))


def _opening(
    kind: OpeningKind,
    index: int,
    hole: Mapping[str, Any],
    walls: Mapping[str, Sequence[Mapping[str, float]]],
    ids: set[str],
) -> Opening:
    """The hole's x runs along the bottom of its wall, from the wall's first corner."""
    corners = [np.array([p["x"], p["z"]], dtype=np.float64) for p in walls[hole["wall0"]][:2]]
    refuse_unreachable(corners)
    along = (corners[1] - corners[0]) / np.linalg.norm(corners[1] - corners[0])
    # Older houses say min and max instead.
    ends = hole["holePolygon"] if "holePolygon" in hole else [*hole["boundingBox"].values()]
    low, high = sorted(float(end["x"]) for end in ends)
    base, top = sorted(float(end["y"]) for end in ends)
    center = corners[0] + along * (low + high) / 2
    is_passage = kind == "door" and not hole.get("openable", True)
    box = Box(
        (float(center[0]), float(center[1]), base),
        (high - low, WALL_THICKNESS_M, top - base),
        math.degrees(math.atan2(along[1], along[0])) % 180.0,
    )
    rooms = tuple(sorted({str(hole["room0"]), str(hole["room1"])} & ids))
    return Opening(f"{kind}{index}", "passage" if is_passage else kind, box, rooms)


def _item(
    entry: Mapping[str, Any], rooms: Sequence[Room], sizes: Sizes, number: int
) -> Item | None:
    category = CATEGORY.get(str(entry["id"]).split("|")[0])
    if category is None:
        return None
    x, y = float(entry["position"]["x"]), float(entry["position"]["z"])
    refuse_unreachable((x, y))
    home = min(rooms, key=lambda room: room_polygon(room).distance(Point(x, y)))
    if category == "side_coffee_table" and home.kind == "bedroom":
        category = "bedside_table"
    row = CATEGORIES[category]
    usual = tuple(sum(span) / 2 for span in (row.length_m, row.width_m, row.height_m))
    size = sizes.get(entry.get("assetId", ""), usual)
    yaw_deg = (180.0 - float(entry["rotation"]["y"]) + 180.0) % 360.0 - 180.0
    box = Box((x, y, row.mount_height_m), (size[0], size[1], size[2]), yaw_deg)
    return Item(
        f"{home.id}/{category}_{number}",
        category,
        nudged(box, room_polygon(home), [WALL_THICKNESS_M / 2]),
        home.id,
    )
