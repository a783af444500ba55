"""A second zone of a large living room, where its sofa leaves much of the floor: a place to work or
read at a wall, a desk with its chair and a bookcase beside it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from chord_usd.base.metrics.design.living_rules import LARGE_M2
from chord_usd.base.metrics.design.view import View
from chord_usd.base.scene.geometry import to_world
from chord_usd.base.scene.types import Box, Item
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.lists.changes import Change, Size, at_walls, new_piece

_DESK_M: Size = (1.4, 0.65, 0.75)
_CHAIR_M: Size = (0.5, 0.5, 0.9)
_BOOKS_M: Size = (1.2, 0.36, 2.0)
_CHAIR_OUT_M = 0.25
"""From the front edge of the desk to the middle of its chair."""
_BESIDE_M = 0.05
_STEP_M = 0.6


def second_zone(view: View) -> Iterator[Change]:
    """A large room with a desk and a bookcase at each wall, or with the bookcase alone."""
    if view.shell.area_m2 < LARGE_M2:
        return
    if not view.of("table"):
        for wall in at_walls(view, (_DESK_M[0] + _BESIDE_M + _BOOKS_M[0], *_DESK_M[1:]), _STEP_M):
            for side in (-1, 1):
                yield (*view.items, *_desk(view, wall, side))
    for box in at_walls(view, _BOOKS_M, _STEP_M):
        yield (*view.items, _books(view, box))


def _desk(view: View, wall: Box, side: int) -> Iterator[Item]:
    """In a strip at a wall, the desk at its right (1) or left (-1), the bookcase at the other."""
    half, back = wall.size_m[0] / 2, wall.size_m[1] / 2
    desk = _at(wall, (side * (half - _DESK_M[0] / 2), 0.0), _DESK_M)
    yield new_piece(view, "table", desk)
    chair = _at(desk, (0.0, -(_DESK_M[1] / 2 + _CHAIR_OUT_M)), _CHAIR_M)
    chair = replace(chair, yaw_deg=wrap_deg(desk.yaw_deg + 180.0))
    yield new_piece(view, "chair", chair, len(view.of("chair")))
    shelves = (-side * (half - _BOOKS_M[0] / 2), back - _BOOKS_M[1] / 2)
    yield _books(view, _at(wall, shelves, _BOOKS_M))


def _books(view: View, box: Box) -> Item:
    return new_piece(view, "cabinet", box, len(view.of("cabinet")))


def _at(box: Box, place: tuple[float, float], size: Size) -> Box:
    """A piece that faces the same way about a place in the frame of another, y to the back."""
    x, y = to_world(box, place)
    return Box((float(x), float(y), 0.0), size, box.yaw_deg)
