"""Cabinets on the walls of kitchens: closed, glazed, open; their fronts match those below."""

from __future__ import annotations

from chord_usd.library.kit.joinery import FRONT_M, Cell, cells, hung
from chord_usd.library.kit.model import Part, hollow_part, moving_part
from chord_usd.library.kit.moves import door
from chord_usd.library.kit.solids import (
    Size,
    Solid,
    block,
    box,
    extruded,
    joined,
    lathe,
    ring,
)
from chord_usd.library.kitchen.kitchen_fronts import (
    FrontForm,
    kitchen_fronts,
    pull_bar,
    reach_m,
)

_BOARD_M = 0.018


_WIDEST_DOOR_M = 0.5


def wall_cabinet(size_m: Size, *, form: FrontForm) -> tuple[Part, ...]:
    """A closed cabinet: one door, or two where it is wide."""
    length, depth, height = size_m
    y = -depth / 2 + reach_m(form) + FRONT_M
    case = block((length, depth / 2 - y, height), 0.002).moved(y=(depth / 2 + y) / 2)
    face = _face(length, height)
    return (hollow_part("Body", case), *kitchen_fronts(face, y, form, low=True))


def _face(length: float, height: float) -> list[Cell]:
    columns = 1 if length <= _WIDEST_DOOR_M else 2
    return list(cells(length, height - 0.004, columns, z_m=0.002))


def _carcass(length: float, depth: float, height: float, y: float) -> list[Solid]:
    """Sides, top, bottom, back: the front open, at y."""
    deep = depth / 2 - y
    middle = y + deep / 2
    side = block((_BOARD_M, deep, height), 0.0015)
    plate = block((length - 2 * _BOARD_M + 0.002, deep - 0.001, _BOARD_M), 0.0015)
    back = box((length - 2 * _BOARD_M + 0.004, 0.008, height - 2 * _BOARD_M + 0.003))
    return [
        side.moved((length - _BOARD_M) / 2, middle),
        side.moved(-(length - _BOARD_M) / 2, middle),
        plate.moved(y=middle, z=0.0005),
        plate.moved(y=middle, z=height - _BOARD_M - 0.0005),
        back.moved(y=depth / 2 - 0.006, z=_BOARD_M - 0.0015),
    ]


def open_cabinet(size_m: Size) -> tuple[Part, ...]:
    """A cabinet without doors and one board, with bowls and glasses in it."""
    length, depth, height = size_m
    case = _carcass(length, depth, height, -depth / 2)
    board = block((length - 2 * _BOARD_M + 0.003, depth - 0.02, _BOARD_M), 0.0015)
    boards = (*case, board.moved(y=0.004, z=height / 2))
    ware, glasses = _tableware(length - 0.1, height)
    return (
        Part("Case", joined(boards), "front", colliders=boards),
        Part("Ware", ware, "ware", collider=None),
        Part("Glasses", glasses, "glass", collider=None),
    )


def _tableware(length: float, height: float, y: float = 0.0) -> tuple[Solid, Solid]:
    """Bowls and plates below, glasses above, as wide as there is room."""
    bowl = lathe(
        [(0.03, 0), (0.065, 0.04), (0.068, 0.055), (0.064, 0.055), (0.03, 0.008), (0, 0.008)], 20
    )
    plates = lathe(
        [(0.05, 0), (0.1, 0.014), (0.1, 0.06), (0.094, 0.06), (0.05, 0.05), (0, 0.05)], 28
    )
    cup = lathe([(0.026, 0), (0.034, 0.11), (0.032, 0.11), (0.024, 0.006), (0, 0.006)], 14)
    low, high = _BOARD_M, height / 2 + _BOARD_M
    ware = [plates.moved(-length / 2 + 0.1, y, low)]
    if length > 0.42:
        x = length / 2 - 0.07
        ware += [bowl.moved(x, y, low + 0.022 * n) for n in range(3)]
    count = max(2, int(length / 0.09))
    pitch = length / count
    cups = [
        cup.moved(-length / 2 + pitch * (n + 0.5), y + 0.03 * (n % 2), high) for n in range(count)
    ]
    return joined(ware), joined(cups)


def glazed_cabinet(size_m: Size, *, form: FrontForm) -> tuple[Part, ...]:
    """Doors of glass in frames, and what stands behind them."""
    length, depth, height = size_m
    y = -depth / 2 + reach_m(form) + FRONT_M
    board = box((length - 2 * _BOARD_M + 0.003, depth / 2 - y - 0.03, _BOARD_M))
    middle = board.moved(y=(y + depth / 2) / 2, z=height / 2)
    case = (*_carcass(length, depth, height, y), middle)
    wide = 0.05 if form == "shaker" else 0.03
    frames, panes, grips = [], [], []
    for cell in _face(length, height):
        frames.append(_glazed_frame(cell, y, wide, crossed=form == "shaker"))
        pane = box((cell.length_m - 2 * wide + 0.01, 0.004, cell.height_m - 2 * wide + 0.01))
        panes.append(pane.moved(cell.x_m, y - FRONT_M / 2, cell.z_m + wide - 0.005))
    ware, glasses = _tableware(length - 0.1, height, (y + depth / 2) / 2)
    leaves = [
        door(frame, hung=hung(cell))
        for cell, frame in zip(_face(length, height), frames, strict=True)
    ]
    parts = [
        Part("Case", joined(case), "body", colliders=case),
        moving_part("Doors", frames, "front", leaves),
        moving_part("Panes", panes, "glass", leaves, None),
        Part("Ware", ware, "ware", collider=None),
        Part("Glasses", glasses, "glass", collider=None),
    ]
    if form in ("bar", "shaker"):
        for cell in _face(length, height):
            inner = 1.0 if hung(cell) == "left" else -1.0
            made = pull_bar(0.16).turned("y", 90)
            grips.append(
                made.moved(
                    cell.x_m + inner * (cell.length_m / 2 - wide / 2), y - FRONT_M, cell.z_m + 0.15
                )
            )
        parts.append(moving_part("Door_Handles", grips, "handle", leaves, None))
    return tuple(parts)


def _glazed_frame(cell: Cell, y: float, wide: float, *, crossed: bool) -> Solid:
    outline = ring(cell.length_m, cell.height_m, 0.0, 0.0, 0)[:, :2]
    hole = ring(cell.length_m - 2 * wide, cell.height_m - 2 * wide, 0.0, 0.0, 0)[:, :2]
    frame = extruded(outline, FRONT_M, [hole]).turned("x", 90)
    frame = frame.moved(cell.x_m, y, cell.z_m + cell.height_m / 2)
    if not crossed:
        return frame
    upright = box((0.016, 0.012, cell.height_m - 2 * wide + 0.004))
    lying = box((cell.length_m - 2 * wide + 0.004, 0.0118, 0.016))
    return joined([
        frame,
        upright.moved(cell.x_m, y - FRONT_M / 2 - 0.001, cell.z_m + wide - 0.002),
        lying.moved(cell.x_m, y - FRONT_M / 2 - 0.001, cell.z_m + cell.height_m * 0.62),
    ])  # fmt: skip
