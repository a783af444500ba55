"""ThreeDWorld's furnished floor plans (Gan et al., NeurIPS 2021) as scene graphs.

`floorplan_layouts.json` (tdw.add_ons.floorplan) holds, for each of four scenes, three furnishings
by designers: names of models, where they stand and how they are turned. How large a model is, its
librarian says (models_core.json). Walls are meshes in Unity's bundles: a furnishing says nothing of
rooms, doors and windows. Pieces with small gaps between them are a room here, of the kind that they
make it, its floor what lies between them. Frames are those of
ProcTHOR: (x, y, z) becomes (x, z, y), and a turn of a degrees becomes a yaw of 180 - a.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from shapely.geometry import MultiPoint, Polygon
from shapely.geometry.polygon import orient

from chord_usd.base.errors import SceneError
from chord_usd.base.metrics.design.unsaid import UNSAID
from chord_usd.base.scene.geometry import (
    footprint,
    hanging_together,
    refuse_unreachable,
)
from chord_usd.base.scene.types import Box, Item, Room, RoomKind, SceneGraph, frozen_array

Size = tuple[float, float, float]

_CATEGORY: Mapping[str, str] = {
    "bed": "bed", "sofa": "sofa", "chair": "chair", "table": "table",
    "coffee table, cocktail table": "coffee_table", "refrigerator": "refrigerator",
    "dishwasher": "single_door_floor_cabinet", "cabinet": "double_door_floor_cabinet",
}  # fmt: skip
"""Its WordNet categories as ours; clutter, lamps and pictures are left out."""
_RAISED_M = 0.3
"""Models that begin above this hang on a wall or lie on a piece."""
_ARMCHAIR_M = 0.75
_DINING_M, _DINER_M = (0.68, 0.8), 0.7
"""Heights of dining tables, and their least side."""
_SIDE_M, _LOW_M = 0.7, 0.35
"""Low tables up to so long stand beside seats, unless they are lower than that."""
_DOORS_M = 0.61
_ROOM_M = 1.0
"""Pieces with smaller gaps between them stand in one room."""
_KINDS: tuple[tuple[str, RoomKind], ...] = (
    ("bed", "bedroom"), ("sink_cabinet", "kitchen"), ("sofa", "living"),
    ("dining_table", "dining"),
)  # fmt: skip
"""Of rooms, by their pieces."""


def read_model_sizes(database: Mapping[str, Any]) -> dict[str, tuple[str, Size]]:
    """Of a model librarian's records: (category, length, depth and height in metres) by name."""
    return {
        name: (str(record["wcategory"]), _size(record["bounds"]))
        for name, record in database["records"].items()
    }


def _size(bounds: Mapping[str, Mapping[str, float]]) -> Size:
    return (
        abs(bounds["right"]["x"] - bounds["left"]["x"]),
        abs(bounds["front"]["z"] - bounds["back"]["z"]),
        abs(bounds["top"]["y"] - bounds["bottom"]["y"]),
    )


def is_tdw(record: Any) -> bool:
    """Whether a JSON file holds scenes of numbered furnishings."""
    scene = next(iter(record.values()), None) if isinstance(record, Mapping) else None
    pieces = next(iter(scene.values()), None) if isinstance(scene, Mapping) else None
    first = pieces[0] if isinstance(pieces, list) and pieces else None
    return isinstance(first, Mapping) and {"name", "library", "scale_factor"} <= first.keys()


def furnishings(
    record: Mapping[str, Any], models: Mapping[str, tuple[str, Size]]
) -> Iterator[tuple[str, SceneGraph]]:
    """Each furnishing of the file with its name. Raises SceneError without sizes of its models."""
    if not models:
        raise SceneError(
            "furnishings of ThreeDWorld name models and no sizes",
            expected="its model librarian", try_="--models models_core.json",
        )  # fmt: skip
    for scene, layouts in record.items():
        for number, pieces in layouts.items():
            yield f"floorplan_{scene}_{number}", _furnished(pieces, models)


def _furnished(
    pieces: list[Mapping[str, Any]], models: Mapping[str, tuple[str, Size]]
) -> SceneGraph:
    items: list[Item] = []
    for piece in pieces:
        category, size = models.get(piece["name"], ("", (0.0, 0.0, 0.0)))
        scale = piece["scale_factor"]
        size = (size[0] * scale["x"], size[1] * scale["z"], size[2] * scale["y"])
        x, y, z = (float(piece["position"][axis]) for axis in "xzy")
        ours = category_of(category, piece["name"], size)
        if ours and z < _RAISED_M:
            refuse_unreachable((x, y, z, *size))
            yaw_deg = (360.0 - float(piece["rotation"]["y"])) % 360.0 - 180.0
            box = Box((x, y, 0.0), size, yaw_deg)
            items.append(Item(f"{ours}_{len(items)}", ours, box, ""))
    if not items:
        raise SceneError("a furnishing holds no piece", expected="one of ThreeDWorld")
    rooms: list[Room] = []
    placed: list[Item] = []
    for number, group in enumerate(_groups(items)):
        held = {item.category for item in group}
        kind: RoomKind = next((kind for category, kind in _KINDS if category in held), "unknown")
        outline = frozen_array(orient(_around(group)).exterior.coords[:-1])
        room = Room(f"room{number}", kind, outline)
        rooms.append(room)
        for item in group:
            is_bedside = item.category == "side_coffee_table" and kind == "bedroom"
            ours = "bedside_table" if is_bedside else item.category
            placed.append(Item(f"{room.id}/{ours}_{len(placed)}", ours, item.box, room.id))
    return SceneGraph(tuple(rooms), (), tuple(placed), extra={UNSAID: ["walls", "home"]})


def _around(group: Sequence[Item]) -> Polygon:
    return MultiPoint(np.concatenate([footprint(item.box) for item in group])).convex_hull


def _groups(items: list[Item]) -> list[list[Item]]:
    """Pieces with small gaps between them; groups whose floors cross are one."""
    groups: list[list[Item]] = [[item] for item in items]
    near = _ROOM_M
    while True:
        shapes = [_around(group) for group in groups]
        joined = [
            (a, b)
            for b, shape in enumerate(shapes)
            for a in range(b)
            if shapes[a].distance(shape) <= near
        ]
        if not joined:
            return groups
        together = hanging_together(len(groups), joined)
        groups, near = (
            [[item for at in numbers for item in groups[at]] for numbers in together],
            0.0,
        )


def category_of(wordnet: str, name: str, size: Size) -> str | None:
    """Our category of a model; None for what has no place in ours.

    WordNet's "chair" and "table" are any: armchairs, dining, side and low tables differ by size.
    """
    ours, (length, depth, height) = _CATEGORY.get(wordnet), size
    least, most = sorted((length, depth))
    if ours == "chair":
        return "single_sofa" if least >= _ARMCHAIR_M else "chair"
    if ours == "table" and height < _DINING_M[0]:
        return "side_coffee_table" if most <= _SIDE_M and height > _LOW_M else "coffee_table"
    if ours == "table" and height <= _DINING_M[1] and least >= _DINER_M:
        return "dining_table"
    if ours == "double_door_floor_cabinet" and "sink" in name:
        return "sink_cabinet"
    if ours == "double_door_floor_cabinet" and length <= _DOORS_M:
        return "single_door_floor_cabinet"
    return ours if math.prod(size) > 0.0 else None
