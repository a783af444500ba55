"""A piece of furniture as rigid bodies: a base, and whatever moves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.hollows import Front, Inner, open_up
from chord_usd.library.kit.leaf_clearance import CLEAR_M
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.moves import Leaf, Motion, leaves_of
from chord_usd.library.kit.shading import separate
from chord_usd.library.kit.solids import Solid, joined

BASE = "Base"

_GRIPPED = "handle"
"""Slot of what hands open a leaf by."""

_PLAY_M = 0.001
"""Colliders of what moves are so much smaller on all sides, so that nothing touches when shut."""

_THINNEST = 1 / 6
"""Largest share of its thickness that the collider of a front gives up behind."""


@dataclass(frozen=True)
class Piece:
    """A mesh of a body and the boxes, (N, 2, 3), that it is felt as."""

    part: Part
    felt_m: tuple[FloatArray, ...]
    is_felt_itself: bool = False
    """Whether its collider is its mesh, as the part says."""


@dataclass(frozen=True)
class Link:
    """A rigid body of a jointed piece."""

    name: str
    motion: Motion | None
    """None for the base."""
    pieces: tuple[Piece, ...]
    reused: tuple[str, ...] = ()
    """Names of parts that are as they are in the fixed piece."""


def opens(parts: Iterable[Part]) -> bool:
    """Whether anything of a piece moves."""
    return any(part.moves for part in parts)


def links_of(parts: Sequence[Part]) -> list[Link]:
    """Base and leaves of a piece, named; leaves are numbered by their kind."""
    leaves = leaves_of([one for part in parts for one in part.moves])
    fronts = [Front(leaf, _front_of(leaf, parts).bounds_m()) for leaf in leaves]
    insides = {part.name: [open_up(case, fronts) for case in part.hollow] for part in parts}
    base: list[Piece] = []
    moved: dict[Leaf, list[Piece]] = {leaf: [] for leaf in leaves}
    motions = {leaf: leaf.motion for leaf in leaves}
    for part in parts:
        base += _still_pieces(part, insides[part.name])
        for leaf in leaves_of(part.moves):
            moved[leaf].append(_moving_piece(part, leaf, is_front=not moved[leaf]))
        for inner in insides[part.name]:
            motions |= inner.motions
            for leaf, boards in inner.drawers.items():
                moved[leaf].append(_boards(part, f"{part.name}_Box", boards, _PLAY_M))
    reused = tuple(part.name for part in parts if part.stays)
    names = _names(leaves)
    return [
        Link(BASE, None, tuple(base), reused),
        *(Link(names[leaf], motions[leaf], tuple(moved[leaf])) for leaf in leaves),
    ]


def _front_of(leaf: Leaf, parts: Iterable[Part]) -> Solid:
    """The first that was drawn of a leaf: its front, before handles and glass."""
    return next(one.solid for part in parts for one in part.moves if one.leaf is leaf)


def _names(leaves: Iterable[Leaf]) -> dict[Leaf, str]:
    counts: dict[str, int] = {}
    names = {}
    for leaf in leaves:
        counts[leaf.kind] = counts.get(leaf.kind, 0) + 1
        names[leaf] = f"{leaf.kind}_{counts[leaf.kind]}"
    return names


def _still_pieces(part: Part, insides: Sequence[Inner]) -> Iterator[Piece]:
    """What of a part belongs to the base."""
    if part.stays:
        felt = tuple(part.felt_boxes_m().values())
        yield Piece(part, felt, part.collider not in ("boundingCube", None))
        return
    boards = [board for inner in insides for board in inner.boards]
    if boards:
        yield _boards(part, f"{part.name}_Boards", boards, 0.0)
    if part.still is not None:
        rest = replace(part, name=f"{part.name}_Rest", solid=part.still, uvs=None)
        yield Piece(rest, tuple(one.bounds_m() for one in part.still_felt))


def _boards(part: Part, name: str, boards: Sequence[Solid], play_m: float) -> Piece:
    made = replace(part, name=name, solid=joined(boards), uvs=None)
    return Piece(made, tuple(_shrunk(board.bounds_m(), play_m) for board in boards))


def _moving_piece(part: Part, leaf: Leaf, *, is_front: bool) -> Piece:
    """What of a part goes with a leaf. Bars and posts of handles are felt one by one, so that
    fingers go behind them."""
    mine = [one for one in part.moves if one.leaf is leaf]
    solid = joined([one.solid for one in mine])
    felt = [box for one in mine for box in one.felt]
    if not felt and (is_front or part.collider is not None):
        felt = [solid]
    if not felt and part.slot == _GRIPPED:
        felt = separate(solid)
    made = replace(part, solid=solid, uvs=None)
    boxes = [_shrunk(one.bounds_m(), _PLAY_M) for one in felt]
    if is_front:
        boxes = [_cleared_behind(box, leaf.motion) for box in boxes]
    return Piece(made, tuple(boxes))


def _cleared_behind(bounds_m: FloatArray, motion: Motion) -> FloatArray:
    """The collider of a front with CLEAR_M to what its back leans on when it is shut."""
    way = motion.starts(bounds_m.mean(axis=0))
    axis = int(np.abs(way).argmax())
    behind = 0 if way[axis] > 0.0 else 1
    inset = min(CLEAR_M - _PLAY_M, _THINNEST * float(np.ptp(bounds_m[:, axis])))
    made = bounds_m.copy()
    made[behind, axis] += inset if behind == 0 else -inset
    return made


def _shrunk(bounds_m: FloatArray, by_m: float) -> FloatArray:
    least = (bounds_m[1] - bounds_m[0]) / 10
    inset = np.minimum(by_m, least)
    return np.array([bounds_m[0] + inset, bounds_m[1] - inset])
