"""Procedural tabletops: supporting pieces laid as people lay them. Seeded, endless, fast.

tops      which piece, how large, of what outline, beside what
board     what still fits where
work      desks        meals    dining tables and worktops
leisure   coffee tables, side tables, bedside tables, TV cabinets
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chord_usd.base.raster.table_top import TableTop
from chord_usd.base.scene.types import Item
from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.tabletops import leisure, meals, work
from chord_usd.workshop.data.tabletops.board import Board, Place
from chord_usd.workshop.data.tabletops.tops import Piece, random_piece


@dataclass(frozen=True, eq=False)
class Tabletop:
    """One supporting piece and what is on it."""

    top: TableTop
    items: tuple[Item, ...]
    """In the piece's own frame, as its children; z is counted from the top."""
    piece: Piece


def random_tabletop(rng: np.random.Generator) -> Tabletop:
    """A random supporting piece, laid. The same state of rng gives the same tabletop."""
    dice = Dice(rng)
    piece = random_piece(dice)
    return Tabletop(piece.top, lay(piece, dice), piece)


def lay(piece: Piece, dice: Dice) -> tuple[Item, ...]:
    """What stands on a piece; nothing where it is too small for anything."""
    board = Board(piece.outline, dice)
    front = Place(board, "front")
    if piece.category == "table":
        side, seat = work.sitter_of(piece)
        place = Place(board, side)
        work.lay_desk(place, place.along(seat), piece.room)
    elif piece.category == "dining_table":
        meals.lay_dining_table(front, piece)
    elif piece.category == "coffee_table":
        leisure.lay_coffee_table(Place(board, leisure.main_side(piece)), piece)
    elif piece.category == "side_coffee_table":
        leisure.lay_side_table(Place(board, leisure.main_side(piece)), piece)
    elif piece.category == "bedside_table":
        leisure.lay_bedside_table(front, piece)
    elif piece.category == "tv_cabinet":
        leisure.lay_tv_cabinet(front, piece)
    else:
        meals.lay_worktop(front)
    return board.items()
