"""Houses in the forms that other data sets keep them in."""

from __future__ import annotations

import math
from typing import Any

FRONT_BED = {"uid": "bed/model", "jid": "m1", "valid": True, "size": [1.8, 1.0, 2.1]}
FRONT_LAMP = {"uid": "lamp/model", "jid": "m2", "valid": True, "size": [0.4, 1.5, 0.4]}


def front_house(angle_deg: float = 0.0) -> dict[str, Any]:
    """A bedroom of 4 x 3 m whose floor is two triangles; a bed with its back to z = 0."""
    floor = {
        "uid": "floor", "type": "Floor", "faces": [0, 1, 2, 0, 2, 3],
        "xyz": [0, 0, 0, 4, 0, 0, 4, 0, 3, 0, 0, 3],
    }  # fmt: skip
    half = math.radians(angle_deg) / 2
    rot = [0.0, math.sin(half), 0.0, math.cos(half)]
    children = [
        {"ref": "floor", "pos": [0, 0, 0], "rot": [0, 0, 0, 1], "scale": [1, 1, 1]},
        {"ref": "bed/model", "pos": [2.0, 0, 1.05], "rot": rot, "scale": [1.0, 1.0, 1.0]},
        {"ref": "lamp/model", "pos": [3.5, 0, 2.5], "rot": rot, "scale": [1, 1, 1]},
    ]
    room = {"type": "MasterBedroom", "instanceid": "MasterBedroom-1", "children": children}
    return {
        "uid": "house-1", "furniture": [FRONT_BED, FRONT_LAMP], "mesh": [floor],
        "scene": {"room": [room]},
    }  # fmt: skip


def points(*corners: tuple[float, float]) -> list[dict[str, float]]:
    return [{"x": x, "y": 0.0, "z": z} for x, z in corners]


def procthor_house() -> dict[str, Any]:
    """Bedroom and bathroom, 4 m and 2 m wide and 4 m deep, with a door between them."""
    wall = [*points((4, 0), (4, 4)), {"x": 4, "y": 3, "z": 0}, {"x": 4, "y": 3, "z": 4}]
    outer = [*points((0, 0), (4, 0)), {"x": 0, "y": 3, "z": 0}, {"x": 4, "y": 3, "z": 0}]
    return {
        "rooms": [
            {"id": "room|1", "roomType": "Bedroom",
             "floorPolygon": points((0, 0), (0, 4), (4, 4), (4, 0))},
            {"id": "room|2", "roomType": "Bathroom",
             "floorPolygon": points((4, 0), (4, 4), (6, 4), (6, 0))},
        ],
        "walls": [{"id": "wall|a", "polygon": wall}, {"id": "wall|b", "polygon": outer}],
        "doors": [{"id": "door|1", "room0": "room|1", "room1": "room|2", "wall0": "wall|a",
                   "holePolygon": [{"x": 1, "y": 0}, {"x": 1.9, "y": 2.1}], "openable": True}],
        "windows": [{"id": "window|1", "room0": "room|1", "room1": "room|1", "wall0": "wall|b",
                     "holePolygon": [{"x": 1, "y": 0.9}, {"x": 3, "y": 2.0}]}],
        "objects": [
            {"id": "Bed|1|0", "assetId": "Bed_1", "position": {"x": 2, "y": 0.5, "z": 3.0},
             "rotation": {"x": 0, "y": 180, "z": 0}},
            {"id": "SideTable|1|1", "assetId": "none", "position": {"x": 0.25, "y": 0.3, "z": 3.75},
             "rotation": {"x": 0, "y": 180, "z": 0}},
            {"id": "Toilet|2|0", "assetId": "Toilet_1", "position": {"x": 5, "y": 0.5, "z": 0.35},
             "rotation": {"x": 0, "y": 90, "z": 0}},
            {"id": "Painting|2|0", "position": {"x": 5, "y": 2, "z": 0}, "rotation": {"y": 0}},
        ],
    }  # fmt: skip


PX_PER_M = 40


def px(*metres: float) -> list[int]:
    return [round(value * PX_PER_M) for value in metres]


def line(x0: float, y0: float, x1: float, y1: float, label: str) -> list[object]:
    return [*px(x0, y0, x1, y1), label, 1, 1]


def label(x: float, y: float, name: str) -> list[object]:
    return line(x - 0.3, y - 0.2, x + 0.3, y + 0.2, name)


def flat_lines() -> list[list[object]]:
    """A living room with a kitchen corner, a bedroom with a balcony, a bathroom, an entrance."""
    walls = [
        (0, 0, 9, 0), (9, 0, 9, 6.5), (9, 6.5, 0, 6.5), (0, 6.5, 0, 0),
        (5, 0, 5, 6.5), (5, 2, 9, 2), (7, 0, 7, 2),
        (5, 6.5, 5, 8), (5, 8, 9, 8), (9, 8, 9, 6.5),
    ]  # fmt: skip
    doors = [
        (5, 0.6, 5, 1.4), (7.6, 2, 8.4, 2), (5, 3, 5, 3.8), (6, 0, 6.8, 0), (6, 6.5, 8, 6.5),
        (1, 6.5, 3, 6.5), (7, 0.6, 7, 1.4),
    ]  # fmt: skip
    names = [
        (2.5, 4.5, "living_room"), (1, 1.5, "kitchen"), (7, 4, "bedroom"), (8, 1, "bathroom"),
        (6, 1, "entrance"), (7, 7.2, "balcony"),
    ]  # fmt: skip
    return [
        *(line(*wall, "wall") for wall in walls),
        *(line(*door, "door") for door in doors),
        *(label(*name) for name in names),
        line(0.2, 0.2, 2.4, 0.8, "cooking_counter"),
    ]
