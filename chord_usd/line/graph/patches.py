"""One connected patch of one category -> the pieces that, drawn again, give it.

Two cabinets side by side are one patch of yellow. Several explanations are tried (one piece; one
piece per front mark; one per proposal of the detector), each is drawn again in thought, and the
one whose drawing differs least from the pixels wins.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
import numpy.typing as npt

from chord_usd.base.scene.oriented_rect import OrientedRect
from chord_usd.base.scene.palette import FRONT_MARK_LENGTH, FRONT_MARK_WIDTH, Category
from chord_usd.base.scene.types import BoolArray, FloatArray
from chord_usd.base.scene.units import fold_deg
from chord_usd.line.graph.directions import Directions
from chord_usd.line.graph.rectangles import (
    Evidence,
    Piece,
    fit_at_angle,
    fit_free,
    front_mark,
    settle_edges,
    upright_points,
)

MARGIN_PX = 4
"""How far around a patch its surroundings count."""

_OTHER_ITEM_WEIGHT = 0.6
"""Cost of covering a pixel of another item: it may have been painted over this one."""

_WRONG_MARK_COST = 0.5
_LOST_MARK_COST = 0.25
_PIECE_COST, _PIECE_SHARE = 1.0, 0.15
"""Cost of each further piece, in pixels and as a share of what one piece leaves unexplained: the
simplest explanation wins, and torn edges are no reason for more pieces."""
_DOUBLE_SHARE = 0.6
"""A piece that lies so far within another is the same one, read twice."""
_UNUSUAL_SIZE_COST = 4.0
"""Cost of a piece shorter or longer, or narrower or wider, than pieces of its category are."""
_UNUSUAL_SHARE = (0.65, 1.3)
"""Tolerance of the usual range of sizes; a pixel more at either end."""

_UNUSUAL_AGREEMENT = 0.2
"""Cost of a side of unusual length, to a piece that a mark may belong to."""

_GOOD_SHARE = 0.02
"""An explanation that errs on a smaller share of the pixels needs no rival."""

_RARE_SHARE = 0.05
"""Cost, as a share of the pixels, of a direction that hardly any wall has."""
_CLEAR_SHARE = 0.05
"""A rectangle that errs on a smaller share of the pixels is drawn clearly."""
_LEAST_FREE_PX = 60
"""Fewer pixels have no direction of their own."""
_LEAST_SKEW_PX = 2.0
"""Nor has a side that runs out of a wall's direction by less, if not all but every pixel says so: a
torn edge does as much."""

_LEAST_MARK_OVERLAP = 0.2


@dataclass(frozen=True)
class UsualSize:
    """Range of sizes of a category, in pixels."""

    length: tuple[float, float]
    width: tuple[float, float]

    @classmethod
    def of(cls, row: Category, m_per_px: float) -> UsualSize:
        """From the palette's metres; nothing is painted thinner than a pixel."""
        (a, b), (c, d) = (
            (max(low / m_per_px, 1.0), max(high / m_per_px, 1.0))
            for low, high in (row.length_m, row.width_m)
        )
        return cls((a, b), (c, d))

    @property
    def least_area(self) -> float:
        """Square pixels of the smallest usual piece."""
        return self.length[0] * self.width[0]

    def unusual_sides(self, piece: Piece) -> int:
        """How many of the piece's two sides are out of range."""
        sides = piece.rectangle.u1 - piece.rectangle.u0, piece.rectangle.v1 - piece.rectangle.v0
        if piece.quarter_turns is None:
            sides = (max(sides), min(sides))
        elif piece.quarter_turns % 2:
            sides = sides[::-1]
        ranges = (self.length, self.width)
        return sum(
            not _UNUSUAL_SHARE[0] * low - 1.0 <= side <= _UNUSUAL_SHARE[1] * high + 1.0
            for side, (low, high) in zip(sides, ranges, strict=True)
        )


@dataclass(frozen=True, eq=False)
class Patch:
    """Connected pixels of one category and what surrounds them."""

    evidence: Evidence
    marked: BoolArray
    """(N,) which members are of a front mark."""
    usual_px: UsualSize

    @property
    def size(self) -> int:
        """Pixels."""
        return len(self.evidence.members)


def cut_patch(
    member: BoolArray,
    front: BoolArray,
    any_item: BoolArray,
    usual_px: UsualSize,
    origin: tuple[int, int] = (0, 0),
) -> Patch:
    """The patch of these pixels. front: marks, any_item: of whatever category.

    All three show the same window of the canvas, which starts at origin (row, column) and goes
    MARGIN_PX beyond the patch where the canvas does.
    """
    rows, columns = np.flatnonzero(member.any(axis=1)), np.flatnonzero(member.any(axis=0))
    top, left = max(rows[0] - MARGIN_PX, 0), max(columns[0] - MARGIN_PX, 0)
    window = slice(top, rows[-1] + MARGIN_PX + 1), slice(left, columns[-1] + MARGIN_PX + 1)
    inside = member[window]
    weights = np.where(any_item[window], _OTHER_ITEM_WEIGHT, 1.0)
    top, left = top + origin[0], left + origin[1]
    evidence = Evidence(
        upright_points(inside, top, left), upright_points(~inside, top, left), weights[~inside]
    )
    return Patch(evidence, front[window][inside], usual_px)


def explain(
    patch: Patch, directions: Directions, proposals: Sequence[OrientedRect] = ()
) -> tuple[list[Piece], float]:
    """The pieces a patch is made of, and the cost of the explanation in pixels."""
    best = [_single(patch, directions)]
    cost = _cost(patch, best)
    further = _PIECE_COST + _PIECE_SHARE * cost
    blobs = _mark_blobs(patch)
    if cost <= _GOOD_SHARE * patch.size and len(blobs) < 2:
        return best, cost
    rivals = []
    if len(blobs) > 1:
        angles = _patch_angles(patch, directions, best[0].rectangle)
        rivals += [_split_by_marks(patch, blobs, angle) for angle in angles]
    if len(proposals) > 1 and not blobs:
        # Marks part pieces better than proposals do, which tear at ragged edges.
        rivals.append(_split_by_proposals(patch, proposals, best[0].rectangle.angle_deg))
    rivals += [_refit(patch, rival) for rival in rivals if rival]
    for rival in rivals:
        rival_cost = _cost(patch, rival) + further * (len(rival) - 1)
        if rival and rival_cost < cost:
            best, cost = rival, rival_cost
    return best, drawing_cost(patch, best)


def _cost(patch: Patch, pieces: Sequence[Piece]) -> float:
    """Drawing cost plus what makes an explanation unlikely by itself."""
    unusual = sum(patch.usual_px.unusual_sides(piece) for piece in pieces)
    return drawing_cost(patch, pieces) + _UNUSUAL_SIZE_COST * unusual


def drawing_cost(patch: Patch, pieces: Sequence[Piece]) -> float:
    """How far the pixels are from the pieces drawn again, in pixels."""
    members, outsiders = patch.evidence.members, patch.evidence.outsiders
    times = np.zeros(len(members), dtype=int)
    spilt = np.zeros(len(outsiders), dtype=bool)
    expected = np.zeros(len(members), dtype=bool)
    for piece in pieces:
        times += piece.rectangle.covers(members)
        spilt |= piece.rectangle.covers(outsiders)
        if piece.quarter_turns is not None:
            expected |= front_mark(piece.rectangle, piece.quarter_turns).covers(members)
    cost = float((times == 0).sum() + np.maximum(times - 1, 0).sum())
    cost += float(patch.evidence.weights[spilt].sum())
    cost += _WRONG_MARK_COST * float((patch.marked & ~expected).sum())
    return cost + _LOST_MARK_COST * float((expected & ~patch.marked).sum())


def uncovered(patch: Patch, pieces: Sequence[Piece]) -> BoolArray:
    """(N,) members that no piece covers, grown by a pixel of tolerance."""
    left = np.ones(patch.size, dtype=bool)
    for piece in pieces:
        left &= ~piece.rectangle.grown(1.0).covers(patch.evidence.members)
    return left


def fit(evidence: Evidence, directions: Directions) -> OrientedRect:
    """The rectangle of some pixels, along a wall's direction.

    Torn patches are often a little rounder than they should be, which a slanted rectangle suits
    well: only pixels that draw a direction of their own clearly are given it.
    """
    members = evidence.members
    low, high = members.min(axis=0) - 0.5, members.max(axis=0) + 0.5
    box = OrientedRect(0.0, low[0], high[0], low[1], high[1])
    if round(box.area) == len(members):
        return box
    angles = directions.near(members.mean(axis=0))
    fitted = [fit_at_angle(evidence, angle) for angle in angles]
    costs = np.array([evidence.cost(rectangle) for rectangle in fitted])
    slack, clear = 0.5 + 0.01 * len(members), 1.0 + _CLEAR_SHARE * len(members)
    if costs.min() <= clear:
        # Nearer walls come first.
        return fitted[int(np.flatnonzero(costs <= costs.min() + slack)[0])]
    if len(members) >= _LEAST_FREE_PX:
        free = fit_free(evidence)
        bound = slack if _skew_px(free, angles) < _LEAST_SKEW_PX else clear
        if evidence.cost(free) <= min(bound, 0.5 * float(costs.min())):
            return free
    rare = np.array([1.0 - directions.weight(angle) for angle in angles])
    return fitted[int(np.argmin(costs + _RARE_SHARE * len(members) * rare))]


def _skew_px(rectangle: OrientedRect, angles_deg: Iterable[float]) -> float:
    """How far the long side of a rectangle runs out of the nearest of some directions."""
    turn_deg = min(abs(fold_deg(rectangle.angle_deg - angle)) for angle in angles_deg)
    longest = max(rectangle.u1 - rectangle.u0, rectangle.v1 - rectangle.v0)
    return longest * math.sin(math.radians(turn_deg))


def mark_fits(rectangle: OrientedRect, marked: FloatArray) -> FloatArray:
    """(4,) intersection over union of marked points (N, 2) and the front mark at each side."""
    fits = []
    for quarter_turns in range(4):
        mark = front_mark(rectangle, quarter_turns)
        hit = float(mark.covers(marked).sum())
        fits.append(hit / (mark.area + len(marked) - hit))
    return np.array(fits)


def _front_of(rectangle: OrientedRect, marked: FloatArray) -> int | None:
    """Quarter turns at which the front mark lies best on the marked points (N, 2), if it does."""
    fits = mark_fits(rectangle, marked)
    return int(fits.argmax()) if fits.max() >= _LEAST_MARK_OVERLAP else None


def _single(patch: Patch, directions: Directions) -> Piece:
    rectangle = fit(patch.evidence, directions)
    return Piece(rectangle, _front_of(rectangle, patch.evidence.members[patch.marked]))


def _patch_angles(patch: Patch, directions: Directions, single: OrientedRect) -> list[float]:
    """Directions the pieces of a patch may share: exact for rows, a guess for L shapes."""
    angles = directions.near(patch.evidence.members.mean(axis=0))[:3]
    return angles if single.angle_deg in angles else [*angles, single.angle_deg]


def _mark_blobs(patch: Patch) -> list[BoolArray]:
    """(N,) masks of the connected marks of a patch; single stray pixels beside real ones drop."""
    if not patch.marked.any():
        return []
    points = patch.evidence.members[patch.marked]
    columns = np.floor(points[:, 0] - points[:, 0].min()).astype(int)
    rows = np.floor(points[:, 1] - points[:, 1].min()).astype(int)
    canvas = np.zeros((rows.max() + 1, columns.max() + 1), dtype=np.uint8)
    canvas[rows, columns] = 1
    count, labels = cv2.connectedComponents(canvas, connectivity=8)
    of_point = np.zeros(patch.size, dtype=int)
    of_point[patch.marked] = labels[rows, columns]
    blobs = [of_point == label for label in range(1, count)]
    largest = max(int(blob.sum()) for blob in blobs)
    return [blob for blob in blobs if blob.sum() > 1 or largest < 6]


def _split_by_marks(patch: Patch, blobs: Sequence[BoolArray], angle_deg: float) -> list[Piece]:
    """One piece per mark, all in one direction (modulo quarter turns)."""
    fits = []
    for blob in blobs:
        mark = _mark_rectangle(patch, blob, angle_deg)
        guesses = [_from_mark(patch, mark, quarter_turns) for quarter_turns in range(4)]
        agreement, piece = max(guesses, key=lambda guess: guess[0])
        fits.append((agreement, piece, mark))
    fits.sort(key=lambda fit: -fit[0])
    kept: list[tuple[Piece, OrientedRect]] = []
    for _, piece, mark in fits:
        # A doubled mark gives the same piece twice.
        if is_another(piece, [other for other, _ in kept]):
            kept.append((piece, mark))
    pieces, marks = [piece for piece, _ in kept], [mark for _, mark in kept]
    return settle_edges(patch.evidence, pieces, marks)


def is_another(piece: Piece, others: Iterable[Piece]) -> bool:
    """Whether a piece lies in none of the others, which would be itself, read twice."""
    return all(piece.rectangle.covered_by(other.rectangle) < _DOUBLE_SHARE for other in others)


def _refit(patch: Patch, pieces: Sequence[Piece]) -> list[Piece]:
    """Fits each piece again, to the pixels that are nearer to it than to the others."""
    refitted = []
    owner = _owners(patch, [piece.rectangle for piece in pieces])
    for index, piece in enumerate(pieces):
        rectangle = _fit_own(patch, owner == index, piece.rectangle.angle_deg)
        refitted.append(Piece(rectangle, piece.quarter_turns) if rectangle else piece)
    return refitted


def _mark_rectangle(patch: Patch, blob: BoolArray, angle_deg: float) -> OrientedRect:
    members = patch.evidence.members
    points = members[blob]
    if angle_deg == 0.0:
        low, high = points.min(axis=0) - 0.5, points.max(axis=0) + 0.5
        return OrientedRect(0.0, low[0], high[0], low[1], high[1])
    near = (np.abs(members - points.mean(axis=0)) <= np.ptp(points, axis=0) / 2 + 4).all(axis=1)
    others = members[near & ~blob]
    outside = patch.evidence.outsiders
    close = (np.abs(outside - points.mean(axis=0)) <= np.ptp(points, axis=0) / 2 + 4).all(axis=1)
    others = np.concatenate([others, outside[close]])
    return fit_at_angle(Evidence(points, others, np.ones(len(others))), angle_deg)


def _from_mark(patch: Patch, mark: OrientedRect, quarter_turns: int) -> tuple[float, Piece]:
    """The piece whose front mark this is if it faces so, and how well the pixels agree, to 1."""
    along_u = quarter_turns % 2 == 0
    (a, b), (near, far) = (
        ((mark.u0, mark.u1), (mark.v0, mark.v1))
        if along_u
        else ((mark.v0, mark.v1), (mark.u0, mark.u1))
    )
    half = (b - a) / FRONT_MARK_LENGTH / 2
    middle = (a + b) / 2
    inward = 1.0 if quarter_turns in (0, 3) else -1.0
    front = near if inward > 0 else far
    local = mark.local(patch.evidence.members)
    across, into = (local[:, 0], local[:, 1]) if along_u else (local[:, 1], local[:, 0])
    strip = np.abs(across - middle) <= max(half / 2, 0.75)
    depth = _run_depth((into[strip] - front) * inward, far - near)
    back = front + inward * depth
    low, high = min(front, back), max(front, back)
    spans = (middle - half, middle + half, low, high)
    if not along_u:
        spans = (low, high, middle - half, middle + half)
    piece = Piece(OrientedRect(mark.angle_deg, *spans), quarter_turns)
    return _agreement(patch, piece), piece


def _run_depth(into: FloatArray, mark_depth: float) -> float:
    """How far the patch goes on behind a mark's front edge, within what the mark's depth allows."""
    least = max((mark_depth - 1.0) / FRONT_MARK_WIDTH, mark_depth)
    most = (mark_depth + 1.0) / FRONT_MARK_WIDTH
    steps = np.bincount(np.floor(into[(into > 0) & (into < most + 1.0)]).astype(int), minlength=1)
    # Along a diagonal, rows of pixels hold half as many as their neighbours.
    gaps = np.flatnonzero(steps < 0.35 * steps.max())
    run = float(gaps[0]) if len(gaps) else float(len(steps))
    return float(np.clip(run, least, most))


def _agreement(patch: Patch, piece: Piece) -> float:
    """Share of a piece's pixels that are as it would be drawn, less for an unusual size."""
    assert piece.quarter_turns is not None
    inside = piece.rectangle.covers(patch.evidence.members)
    spilt = piece.rectangle.covers(patch.evidence.outsiders).sum()
    expected = front_mark(piece.rectangle, piece.quarter_turns).covers(patch.evidence.members)
    right = (expected == patch.marked)[inside].sum()
    penalty = _UNUSUAL_AGREEMENT * patch.usual_px.unusual_sides(piece)
    return float(right / max(inside.sum() + spilt, 1)) - penalty


def _split_by_proposals(
    patch: Patch, proposals: Sequence[OrientedRect], angle_deg: float
) -> list[Piece]:
    """One piece per proposal, each moved onto the pixels that are nearest to it."""
    owner = _owners(patch, proposals)
    pieces = []
    for index in range(len(proposals)):
        nearest = owner == index
        rectangle = _fit_own(patch, nearest, angle_deg)
        if rectangle:
            marked = patch.evidence.members[nearest & patch.marked]
            pieces.append(Piece(rectangle, _front_of(rectangle, marked)))
    return pieces


def _owners(patch: Patch, rectangles: Sequence[OrientedRect]) -> npt.NDArray[np.intp]:
    """(N,) index of the rectangle that each member is deepest in, or least far from."""
    depths = []
    for rectangle in rectangles:
        u, v = rectangle.local(patch.evidence.members).T
        across = np.minimum(u - rectangle.u0, rectangle.u1 - u)
        depths.append(np.minimum(across, np.minimum(v - rectangle.v0, rectangle.v1 - v)))
    return np.argmax(depths, axis=0)


def _fit_own(patch: Patch, nearest: BoolArray, angle_deg: float) -> OrientedRect | None:
    """The rectangle of some members against all other pixels around."""
    if nearest.sum() < 2:
        return None
    members = patch.evidence.members
    rest = np.concatenate([members[~nearest], patch.evidence.outsiders])
    weights = np.concatenate([np.ones(int((~nearest).sum())), patch.evidence.weights])
    return fit_at_angle(Evidence(members[nearest], rest, weights), angle_deg)
