"""Whole houses as readers give them, with sizes that no draughtsman would draw.

A house depends on its seed alone. Its rooms and openings keep to the rules of CHOrD JSON, so that
each is either built or refused in one sentence.
"""

from __future__ import annotations

from math import cos, radians, sin
from random import Random
from typing import Any

from chord_usd.base.scene.palette import HOUSE_CATEGORIES
from chord_usd.base.scene.types import ROOM_KINDS

Corner = list[float]
Json = dict[str, Any]

_EDGES_CM = (0.1, 1.0, 5.0, 24.9, 25.0, 25.1, 40.0, 42.0, 43.0, 45.0, 90.0, 119.0, 127.0, 250.0)
"""Sizes near which parts of openings come and go."""


def odd_house(seed: int) -> Json:
    """CHOrD JSON of a house with rooms, openings and furniture of all sizes, lengths in cm."""
    rng = Random(f"odd house {seed}")
    wall_cm = rng.choice((24.0, 24.0, rng.uniform(2.0, 70.0)))
    rooms = [_room(rng, at, box, wall_cm) for at, box in enumerate(_boxes(rng))]
    openings = [_opening(rng, rng.choice(rooms), wall_cm) for _ in range(rng.randint(0, 8))]
    pieces = [_piece(rng, rng.choice(rooms)) for _ in range(rng.randint(0, 4))]
    house: Json = {"rooms": rooms, "windowsDoors": openings, "furniture": pieces}
    turn = rng.random()
    if turn < 0.15:
        _turn(house, rng.uniform(-3.0, 3.0) if turn < 0.1 else rng.uniform(0.0, 360.0))
    return house


def _boxes(rng: Random) -> list[Corner]:
    """(left, low, right, high) of a rectangle that is cut at random."""
    side = rng.choice((rng.uniform(30.0, 400.0), rng.uniform(400.0, 1500.0)))
    boxes: list[Corner] = [[0.0, 0.0, side, side * rng.uniform(0.3, 1.5)]]
    for _ in range(rng.randint(0, 4)):
        left, low, right, high = boxes.pop(rng.randrange(len(boxes)))
        share = rng.uniform(0.05, 0.95)
        if right - left > high - low:
            cut = left + share * (right - left)
            boxes += [[left, low, cut, high], [cut, low, right, high]]
        else:
            cut = low + share * (high - low)
            boxes += [[left, low, right, cut], [left, cut, right, high]]
    return boxes


def _room(rng: Random, at: int, box: Corner, wall_cm: float) -> Json:
    gap = min(wall_cm / 2, 0.4 * min(box[2] - box[0], box[3] - box[1]))
    left, low, right, high = box[0] + gap, box[1] + gap, box[2] - gap, box[3] - gap
    corners = [[left, low], [right, low], [right, high], [left, high]]
    shape = rng.random()
    if shape < 0.2:  # an L, whose arms may be as thin as a hair
        x, y = left + rng.uniform(0, 1) * (right - left), low + rng.uniform(0, 1) * (high - low)
        corners[2:3] = [[right, y], [x, y], [x, high]]
    elif shape < 0.3:  # a slanted or almost straight wall
        corners[2][1] -= rng.choice((0.001, 0.3, 0.5 * (high - low)))
    elif shape < 0.4:  # corners in a line, and one out of it by a hair
        corners[1:1] = [[left + 0.5 * (right - left), low + rng.choice((0.0, 1e-4, 0.05))]]
    kind = rng.choice(ROOM_KINDS)
    return {"roomId": f"r{at}", "roomName": kind, "roomType": 1, "wallPoints": corners}


def _size(rng: Random, most_cm: float) -> float:
    return rng.choice((rng.choice(_EDGES_CM), rng.uniform(0.5, 60.0), rng.uniform(1.0, most_cm)))


def _opening(rng: Random, room: Json, wall_cm: float) -> Json:
    """In a wall of the room, or somewhere about it; as wide as the wall, or not at all so."""
    corners = room["wallPoints"]
    index = rng.randrange(len(corners))
    (x0, y0), (x1, y1) = corners[index], corners[(index + 1) % len(corners)]
    along = rng.choice((0.5, rng.uniform(-0.05, 1.05)))
    is_level = abs(x1 - x0) > abs(y1 - y0)
    out = (wall_cm / 2) * rng.choice((1.0, 1.0, 1.0, rng.uniform(-2.0, 2.0)))
    x, y = x0 + along * (x1 - x0), y0 + along * (y1 - y0)
    if is_level:
        y += out if x1 < x0 else -out
    else:
        x += out if y1 > y0 else -out
    sill = rng.choice((0.0, 0.0, rng.uniform(0.0, 60.0), rng.uniform(0.0, 400.0)))
    turn = 0.0 if is_level else 90.0
    return {
        "type": rng.choice(("door", "door", "window", "window", "passage")),
        "pos": [x, y, sill], "length": _size(rng, 600.0),
        "width": rng.choice((wall_cm, _size(rng, 80.0))), "height": _size(rng, 400.0),
        "rotate": turn + rng.choice((0.0, 180.0, 0.0, rng.uniform(-4.0, 4.0))),
    }  # fmt: skip


def _piece(rng: Random, room: Json) -> Json:
    category = rng.choice(HOUSE_CATEGORIES)
    (x0, y0), _, (x1, y1) = room["wallPoints"][:3]
    share_x, share_y = rng.uniform(-0.1, 1.1), rng.uniform(-0.1, 1.1)
    return {
        "type": category.name, "pos": [x0 + share_x * (x1 - x0), y0 + share_y * (y1 - y0), 0.0],
        "length": _size(rng, 300.0), "width": _size(rng, 300.0), "height": _size(rng, 260.0),
        "rotate": rng.choice((0.0, 90.0, rng.uniform(-180.0, 180.0))),
    }  # fmt: skip


def _turn(house: Json, by_deg: float) -> None:
    """Turn all of it about the origin, as a drawing that was scanned askew."""
    c, s = cos(radians(by_deg)), sin(radians(by_deg))
    for room in house["rooms"]:
        room["wallPoints"] = [[c * x - s * y, s * x + c * y] for x, y in room["wallPoints"]]
    for one in (*house["windowsDoors"], *house["furniture"]):
        x, y, z = one["pos"]
        one["pos"], one["rotate"] = [c * x - s * y, s * x + c * y, z], one["rotate"] + by_deg
