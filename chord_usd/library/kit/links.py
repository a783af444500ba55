"""A piece of furniture as rigid bodies: a base, and whatever moves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.library.kit.leaf_clearance import CLEAR_M
from chord_usd.library.kit.model import Part
from chord_usd.library.kit.moves import Hinge, Leaf, Motion, Slide, leaves_of
from chord_usd.library.kit.shading import separate
from chord_usd.library.kit.solids import Solid, box, joined

BASE = "Base"

_GRIPPED = "handle"
"""Slot of what hands open a leaf by."""

_PLAY_M = 0.001
"""Colliders of what moves are so much smaller on all sides, so that nothing touches when shut."""

_THINNEST = 1 / 6
"""Largest share of its thickness that the collider of a front gives up behind."""


@dataclass(frozen=True)
class Piece:
    """A mesh of a body and the boxes, (N, 2, 3), of its colliders."""

    part: Part
    colliders_m: tuple[FloatArray, ...]
    collides_itself: bool = False
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
    leaves = leaves_of([move for part in parts for move in part.moves])
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
    return next(move.solid for part in parts for move in part.moves if move.leaf is leaf)


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
        colliders = tuple(part.collider_boxes_m().values())
        yield Piece(part, colliders, part.collider not in ("boundingCube", None))
        return
    boards = [board for inner in insides for board in inner.boards]
    if boards:
        yield _boards(part, f"{part.name}_Boards", boards, 0.0)
    if part.still is not None:
        rest = replace(part, name=f"{part.name}_Rest", solid=part.still, uvs=None)
        yield Piece(rest, tuple(solid.bounds_m() for solid in part.still_colliders))


def _boards(part: Part, name: str, boards: Sequence[Solid], play_m: float) -> Piece:
    made = replace(part, name=name, solid=joined(boards), uvs=None)
    return Piece(made, tuple(_shrunk(board.bounds_m(), play_m) for board in boards))


def _moving_piece(part: Part, leaf: Leaf, *, is_front: bool) -> Piece:
    """The portion of a part that goes with a leaf. Bars and posts of handles collide one by one, so
    that fingers go behind them."""
    mine = [move for move in part.moves if move.leaf is leaf]
    solid = joined([move.solid for move in mine])
    colliders = [box for move in mine for box in move.colliders]
    if not colliders and (is_front or part.collider is not None):
        colliders = [solid]
    if not colliders and part.slot == _GRIPPED:
        colliders = separate(solid)
    made = replace(part, solid=solid, uvs=None)
    boxes = [_shrunk(solid.bounds_m(), _PLAY_M) for solid in colliders]
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


# Bodies of furniture made hollow: boards around what doors and drawers open into, ----------------

# the doors, drawers behind their fronts.

_BOARD_M, _BACK_M = 0.018, 0.008
_EDGE_M = 0.002
"""Boards between compartments stand so far behind the front edges of the body."""

_RUNNER_M = 0.013
"""Between the side of a drawer and the body, where its runners are."""
_DRAWER_BOARD_M, _BOTTOM_M = 0.012, 0.006
_DEEPEST_DRAWER_M = 0.55
_DRAWN_OUT = 0.8
"""Share of its depth by which a drawer comes out."""
_LOWEST_DRAWER_M = 0.05

_SHELF_EVERY_M, _SHELF_BACK_M = 0.38, 0.03
_HANGING_FROM_M, _HANGING_DEPTH_M, _HAT_M, _RAIL_M = 1.3, 0.42, 0.3, 0.024
_FRONT_M = 0.05
"""How far the back of a front may be from the body that it opens."""
_BEHIND_M = 0.02
_LEAST_M = 0.04
_LAP_M = 0.03
"""Sliding doors reach so far over each other."""


@dataclass(frozen=True, eq=False)
class Front:
    """A leaf and what it fills when it is shut, (2, 3)."""

    leaf: Leaf
    bounds_m: FloatArray

    def span(self, axis: int) -> tuple[float, float]:
        """Along an axis."""
        return float(self.bounds_m[0][axis]), float(self.bounds_m[1][axis])


@dataclass
class Inner:
    """What a body is made of, once it is open."""

    boards: list[Solid] = field(default_factory=list)
    drawers: dict[Leaf, list[Solid]] = field(default_factory=dict)
    """Boards that travel with a leaf."""
    motions: dict[Leaf, Slide] = field(default_factory=dict)
    """Of drawers, whose way depends on how deep the body is."""


@dataclass(frozen=True)
class _Room:
    """What is between boards: low and high along x and z, and the plane of the back."""

    x: tuple[float, float]
    z: tuple[float, float]
    front_y: float
    back_y: float

    @property
    def depth_m(self) -> float:
        return self.back_y - self.front_y

    def board(self, x: tuple[float, float], z: tuple[float, float], *, behind_m: float) -> Solid:
        """A board over x and z, from so far behind the front to the back."""
        return _block(x, (self.front_y + behind_m, self.back_y), z)


def open_up(case: Solid, fronts: Sequence[Front]) -> Inner:
    """A closed body as boards, with what is behind each of the fronts that lie before it."""
    low, high = case.bounds_m()
    x, y, z = ((float(a), float(b)) for a, b in zip(low, high, strict=True))
    board = min(_BOARD_M, (x[1] - x[0]) / 8, (z[1] - z[0]) / 8)
    room = _Room((x[0] + board, x[1] - board), (z[0] + board, z[1] - board), y[0], y[1] - _BACK_M)
    inner = Inner([
        _block((x[0], room.x[0]), y, z),
        _block((room.x[1], x[1]), y, z),
        _block(room.x, y, (z[0], room.z[0])),
        _block(room.x, y, (room.z[1], z[1])),
        _block(room.x, (room.back_y, y[1]), room.z),
    ])  # fmt: skip
    before = [front for front in fronts if _is_before(front, case)]
    if before:
        _divide(room, before, board, inner)
    return inner


def _is_before(front: Front, case: Solid) -> bool:
    low, high = case.bounds_m()
    gap = low[1] - front.bounds_m[1][1]
    overlap = [min(high[a], front.bounds_m[1][a]) - max(low[a], front.bounds_m[0][a])
               for a in (0, 2)]  # fmt: skip
    return -_FRONT_M < gap < _FRONT_M and min(overlap) > _LEAST_M


def _divide(room: _Room, fronts: Sequence[Front], board: float, inner: Inner) -> None:
    """Boards between what is to be apart, again and again; then what is inside each room."""
    for axis in (2, 0):
        groups = _apart(fronts, axis)
        if len(groups) < 2:
            continue
        cuts = [(max(f.span(axis)[1] for f in before) + min(f.span(axis)[0] for f in after)) / 2
                for before, after in pairwise(groups)]  # fmt: skip
        span = room.z if axis == 2 else room.x
        for cut in cuts:
            across = (cut - board / 2, cut + board / 2)
            sides = (room.x, across) if axis == 2 else (across, room.z)
            inner.boards.append(room.board(*sides, behind_m=_EDGE_M))
        lows = [span[0], *(cut + board / 2 for cut in cuts)]
        highs = [*(cut - board / 2 for cut in cuts), span[1]]
        for group, part in zip(groups, zip(lows, highs, strict=True), strict=True):
            within = replace(room, z=part) if axis == 2 else replace(room, x=part)
            _divide(within, group, board, inner)
        return
    _fill(room, fronts, inner)


def _apart(fronts: Sequence[Front], axis: int) -> list[list[Front]]:
    """Fronts in groups along an axis that a board is to part, lowest first."""
    groups: list[list[Front]] = []
    for front in sorted(fronts, key=lambda front: front.span(axis)[0]):
        last = groups[-1] if groups else []
        if last and front.span(axis)[0] < max(f.span(axis)[1] for f in last) - _LAP_M:
            last.append(front)
        else:
            groups.append([front])
    merged: list[list[Front]] = groups[:1]
    for group in groups[1:]:
        if _share_room(merged[-1], group, axis):
            merged[-1] += group
        else:
            merged.append(group)
    return merged


def _share_room(before: Sequence[Front], after: Sequence[Front], axis: int) -> bool:
    """Whether no board goes between: drawers above each other, doors that open away from each
    other."""
    if axis == 2:
        return all(front.leaf.holds for front in (*before, *after))
    if len(before) != 1 or len(after) != 1:
        return False
    return _is_hung(before[0], 0) and _is_hung(after[0], 1)


def _is_hung(front: Front, end: int) -> bool:
    """Whether a door hangs at its left (0) or right (1) end."""
    motion = front.leaf.motion
    if not isinstance(motion, Hinge) or motion.axis != "z":
        return False
    near = [abs(motion.at_m[0] - at) for at in front.span(0)]
    return near[end] < near[1 - end]


def _fill(room: _Room, fronts: Sequence[Front], inner: Inner) -> None:
    for front in fronts:
        if front.leaf.holds:
            _add_holder(room, front, inner)
    if any(not f.leaf.holds and f.leaf.inside == "shelves" for f in fronts):
        inner.boards += _shelves(room)


def _shelves(room: _Room) -> Iterator[Solid]:
    """Shelves; a rail for clothes under a shelf for hats where it is high and deep enough."""
    tall = room.z[1] - room.z[0]
    if tall > _HANGING_FROM_M and room.depth_m > _HANGING_DEPTH_M:
        z = room.z[1] - _HAT_M
        yield room.board(room.x, (z, z + _BOARD_M), behind_m=_SHELF_BACK_M)
        y = (room.front_y + room.back_y) / 2
        across = (y - _RAIL_M / 2, y + _RAIL_M / 2)
        yield _block(room.x, across, (z - 0.05 - _RAIL_M, z - 0.05))
        return
    count = max(0, round(tall / _SHELF_EVERY_M) - 1)
    for index in range(count):
        z = room.z[0] + tall * (index + 1) / (count + 1)
        yield room.board(room.x, (z - _BOARD_M / 2, z + _BOARD_M / 2), behind_m=_SHELF_BACK_M)


def _add_holder(room: _Room, front: Front, inner: Inner) -> None:
    x = (max(room.x[0], front.span(0)[0]) + _RUNNER_M, min(room.x[1], front.span(0)[1]) - _RUNNER_M)
    low = max(room.z[0], front.span(2)[0]) + 0.01
    high = min(room.z[1], front.span(2)[1] - 0.15 * (front.span(2)[1] - low)) - 0.01
    y = front.span(1)[1]
    if high - low < _LOWEST_DRAWER_M or x[1] - x[0] < _LOWEST_DRAWER_M:
        return
    if isinstance(front.leaf.motion, Slide):
        deep = min(room.back_y - _BEHIND_M - y, _DEEPEST_DRAWER_M)
        inner.drawers[front.leaf] = _tray(x, (y, y + deep), (low, high))
        inner.motions[front.leaf] = replace(front.leaf.motion, opens_m=-_DRAWN_OUT * deep)
        return
    # What tilts with a flap stays below the arc that its upper edge makes.
    deep = min(room.depth_m - _BEHIND_M, 0.5 * (high - low))
    inner.drawers[front.leaf] = _tray(x, (y, y + deep), (low, low + 0.6 * (high - low)))


def _tray(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> list[Solid]:
    """Bottom, two sides and back behind a front."""
    thick = _DRAWER_BOARD_M
    inside = (x[0] + thick, x[1] - thick)
    return [
        _block((x[0], inside[0]), y, z),
        _block((inside[1], x[1]), y, z),
        _block(inside, (y[1] - thick, y[1]), z),
        _block(inside, (y[0], y[1] - thick), (z[0], z[0] + _BOTTOM_M)),
    ]


def _block(x: tuple[float, float], y: tuple[float, float], z: tuple[float, float]) -> Solid:
    size = (x[1] - x[0], y[1] - y[0], z[1] - z[0])
    return box(size).moved((x[0] + x[1]) / 2, (y[0] + y[1]) / 2, z[0])
