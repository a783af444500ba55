"""Doors, windows and passages, found along the walls between rooms.

A wall is a strip between two faces. What a network says across it, averaged from face to face, is a
profile along it: where the profile says wall there is wall, and what lies between opens. So holes
that are seen faintly are found whole, with straight ends, and stand in their wall.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, pairwise
from typing import TYPE_CHECKING

import cv2
import numpy as np

from chord_usd.base.raster.page_labels import (
    BUILT_WEIGHTS,
    DOOR,
    FLOOR,
    OUTSIDE,
    PASSAGE,
    WALL,
    WINDOW,
)
from chord_usd.base.scene.geometry import gaps
from chord_usd.base.scene.types import FloatArray, OpeningKind

if TYPE_CHECKING:
    from chord_usd.line.plan.segment import Segments

_DEEPEST = 3.5
"""A wall is at most so many times as thick as the usual one."""

_OPPOSED = -0.97
"""Cosine between the outward normals of a wall's two faces, at most."""

_LEAST_OVERLAP_PX = 4.0
_ACROSS = (0.2, 0.35, 0.5, 0.65, 0.8)
"""Where a wall is looked at, as shares of its depth."""

_HEEDED = np.array(BUILT_WEIGHTS) ** 0.7
"""How much more of each class the network sees than there is, having learned that missing it costs
more."""

_MIDDLE = np.array([0.4, 0.5, 0.6])

_IS_WALL = 0.5
_AT_END = 0.3
"""Share of wall where an opening ends: the network blurs jambs outwards, by a pixel at a half.
The openings that exist, and the scale that doors give, follow from the half."""

_LEAST_LENGTH = 1.6
"""What is shorter than so many usual walls are thick is no opening."""

_LEAST_SIGN = {DOOR: 0.12, WINDOW: 0.25, PASSAGE: 0.12}
"""Of 22 windows with less than 0.4 on 40 held-out pages 3 were right."""

_IS_FLOOR, _PASSAGE_DEEP = 0.5, 2.0
"""A hole between rooms without any sign of a door is a passage if floor runs through it, and no
wardrobe if it is no deeper than so many usual walls are thick."""

_JOINED_PX, _JOINED = 2.5, 0.35
"""Pieces of one window that are no farther apart are one; of a door, as a share of a thickness. Two
windows side by side have a slim pier between them."""

_MULLION = 0.15
"""Share of wall by which what is seen between two windows side by side stands out: a post of 10 cm
is three pixels or fewer, and blurred."""

_KINDS: dict[int, OpeningKind] = {DOOR: "door", WINDOW: "window", PASSAGE: "passage"}


@dataclass(frozen=True, eq=False)
class WallOpening:
    """An opening in a wall, in continuous pixels."""

    kind: OpeningKind
    center_px: FloatArray
    along: FloatArray
    """(2,) unit direction of the wall."""
    length_px: float
    depth_px: float
    rooms: tuple[tuple[int, FloatArray], ...]
    """The rooms it joins, one or two: index, and unit normal out of the room into the wall."""
    confidence: float
    """Chance of its kind, averaged over it."""
    insets_px: tuple[float, float] = (0.0, 0.0)
    """How far inside its ends, along, the jambs are: what is seen is a little longer."""
    is_guess: bool = False
    """Whether it is there since rooms have to be entered."""
    wall: int = -1
    """Number of the wall that it was seen in: two windows seen in one wall are two."""


@dataclass(frozen=True, eq=False)
class _Edge:
    """An edge of a room."""

    room: int
    start: FloatArray
    along: FloatArray
    outward: FloatArray
    length: float


@dataclass(frozen=True, eq=False)
class Wall:
    """A strip between two faces, or between a face and the outside."""

    edge: _Edge
    low: float
    high: float
    """From where to where along the edge."""
    depth: float
    other: _Edge | None

    def is_deep(self, thickness_px: float) -> bool:
        """Whether wardrobes rather than a way may be in it. thickness_px: of the usual wall."""
        return self.depth > _PASSAGE_DEEP * thickness_px


def find_openings(
    polygons_px: Sequence[FloatArray], segments: Segments, thickness_px: float
) -> list[WallOpening]:
    """What opens in the walls of rooms. polygons_px: (N, 2) each, as from polygon_from_mask.

    thickness_px: of the usual wall.
    """
    openings: list[WallOpening] = []
    for number, wall in enumerate(walls_between(polygons_px, segments, thickness_px)):
        openings += [replace(o, wall=number) for o in _in_wall(wall, segments, thickness_px)]
    return _joined(openings, thickness_px)


def _edges(room: int, polygon: FloatArray) -> Iterator[_Edge]:
    for start, stop in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        length = float(np.hypot(*(stop - start)))
        if length > _LEAST_OVERLAP_PX:
            along = (stop - start) / length
            # Clockwise in numbers: outside lies to the left.
            yield _Edge(room, start, along, np.array([-along[1], along[0]]), length)


# Walls -------------------------------------------------------------------------------------------


def walls_between(
    polygons_px: Sequence[FloatArray], segments: Segments, thickness_px: float
) -> Iterator[Wall]:
    """Strips between facing edges of two rooms, and from edges that face none to the outside."""
    edges = [edge for room, polygon in enumerate(polygons_px) for edge in _edges(room, polygon)]
    reach = max(_DEEPEST * thickness_px, _LEAST_OVERLAP_PX)
    covered: dict[_Edge, list[tuple[float, float]]] = {edge: [] for edge in edges}
    for face, other in combinations(edges, 2):
        if face.room == other.room or face.outward @ other.outward > _OPPOSED:
            continue
        ends = np.stack([other.start, other.start + other.length * other.along]) - face.start
        depth = float((ends @ face.outward).mean())
        low, high = max(0.0, float((ends @ face.along).min())), min(
            face.length, float((ends @ face.along).max()))  # fmt: skip
        if not -1.0 < depth < reach or high - low < _LEAST_OVERLAP_PX:
            continue
        strip = _sampled(segments.built[OUTSIDE], face, np.arange(low, high, 2.0), _MIDDLE * depth)
        if strip.mean() > _IS_WALL:  # two houses, or two storeys side by side
            continue
        covered[face].append((low, high))
        turned = face.start - other.start
        spans = [float((turned + place * face.along) @ other.along) for place in (low, high)]
        covered[other].append((min(spans), max(spans)))
        yield Wall(face, low, high, max(depth, 1.0), other)
    for edge, spans_px in covered.items():
        for low, high in gaps(spans_px, edge.length):
            if high - low <= _LEAST_OVERLAP_PX:
                continue
            outer = _outer_depth(edge, low, high, segments, reach) or thickness_px
            yield Wall(edge, low, high, outer, None)


def _outer_depth(
    edge: _Edge, low: float, high: float, segments: Segments, reach: float
) -> float | None:
    """How deep a wall towards the outside is; None where the outside is not near."""
    along, across = np.arange(low + 0.5, high, 2.0), np.arange(0.5, reach, 1.0)
    outside = _sampled(segments.built[OUTSIDE], edge, along, across) > _IS_WALL
    depths = np.where(outside.any(axis=1), across[outside.argmax(axis=1)], np.nan)
    return None if np.isnan(depths).all() else max(float(np.nanmedian(depths)) - 0.5, 1.0)


def _sampled(
    values: np.ndarray, edge: _Edge, along: FloatArray, across: FloatArray
) -> np.ndarray:  # fmt: skip
    """(along, across) values at distances along an edge and outwards from it."""
    spots = (
        edge.start + along[:, None, None] * edge.along + across[None, :, None] * edge.outward - 0.5
    ).astype(np.float32)
    return cv2.remap(
        values, spots[..., 0], spots[..., 1], cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )


# Profiles ----------------------------------------------------------------------------------------


def borders_between(
    polygons_px: Sequence[FloatArray], segments: Segments, thickness_px: float
) -> dict[tuple[int, int], FloatArray]:
    """By pairs of rooms the length of what parts them, and how much of it is no wall, and a door,
    pixels."""
    totals: dict[tuple[int, int], FloatArray] = {}
    for wall in walls_between(polygons_px, segments, thickness_px):
        if wall.other is not None:
            first, second = sorted((wall.edge.room, wall.other.room))
            profile = profile_of(wall, segments)
            sums = [1.0, 1.0 - profile[WALL].mean(), profile[DOOR].mean()]
            added = (wall.high - wall.low) * np.array(sums)
            totals[first, second] = totals.get((first, second), np.zeros(3)) + added
    return totals


def profile_of(wall: Wall, segments: Segments) -> FloatArray:
    """(7, N) shares of what is built, pixel by pixel along a wall, averaged across it."""
    along = np.arange(wall.low + 0.5, wall.high, 1.0)
    across = np.array(_ACROSS) * wall.depth
    profile = np.stack([
        _sampled(plane, wall.edge, along, across).mean(axis=1) for plane in segments.built
    ])  # fmt: skip
    profile /= _HEEDED[:, None]
    return np.asarray(profile / profile.sum(axis=0))


def _in_wall(wall: Wall, segments: Segments, thickness_px: float) -> Iterator[WallOpening]:
    """The openings of a wall. thickness_px: of the usual wall."""
    least_px = _LEAST_LENGTH * thickness_px
    may_run_on = wall.other is not None and not wall.is_deep(thickness_px)
    along = np.arange(wall.low + 0.5, wall.high, 1.0)
    profile = profile_of(wall, segments)
    is_open = profile[WALL] < _IS_WALL
    for first, last in _runs(is_open):
        part = profile[:, first : last + 1]
        for start, stop, label in _by_kind(part, least_px):
            sign = float(part[label, start:stop].mean())
            is_sure = sign >= _LEAST_SIGN[label]
            runs_on = may_run_on and part[FLOOR, start:stop].mean() >= _IS_FLOOR
            if stop - start < least_px or not (is_sure or runs_on):
                continue
            kind = _KINDS[label] if is_sure else "passage"
            panes = [(start, stop)]
            if kind == "window":
                panes = _panes(part[WALL], start, stop, least_px)
            for low, high in panes:
                opening = _opening(wall, kind, along[first] + low - 0.5, high - low, sign)
                insets = _insets(profile[WALL], first, last, low, high)
                yield replace(opening, insets_px=insets)


def _runs(is_open: np.ndarray) -> Iterator[tuple[int, int]]:
    """First and last index of each run."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], is_open.astype(np.int8), [0]])))
    yield from ((int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True))


def _by_kind(profile: np.ndarray, least_px: float) -> Iterator[tuple[int, int, int]]:
    """Stretches of a hole of one kind each, with the kind's label; short ones go to the longest."""
    labels = np.array(tuple(_KINDS))
    kinds = labels[profile[labels].argmax(axis=0)]
    cuts = [0, *(np.flatnonzero(np.diff(kinds)) + 1).tolist(), len(kinds)]
    stretches = [(a, b, int(kinds[a])) for a, b in pairwise(cuts)]
    if min(b - a for a, b, _ in stretches) >= least_px:
        yield from stretches
        return
    yield 0, len(kinds), int(labels[profile[labels].sum(axis=1).argmax()])


def _panes(walled: FloatArray, start: int, stop: int, least_px: float) -> list[tuple[int, int]]:
    """A window as those side by side between which a post is seen. walled: share of wall."""
    share = walled[start:stop]
    before, after = np.minimum.accumulate(share), np.minimum.accumulate(share[::-1])[::-1]
    standing = share - np.maximum(before, after)
    for at in np.argsort(-standing, kind="stable"):
        if standing[at] < _MULLION:
            break
        foot = np.flatnonzero(share < share[at] - standing[at] / 2)
        low, high = start + foot[foot < at].max() + 1, start + foot[foot > at].min()
        if min(low - start, stop - high) >= least_px:
            return [
                *_panes(walled, start, int(low), least_px),
                *_panes(walled, int(high), stop, least_px),
            ]
    return [(start, stop)]


def _insets(
    walled: FloatArray, first: int, last: int, start: int, stop: int
) -> tuple[float, float]:
    """How far inside the ends of a stretch of a hole the jambs are.

    walled: share of wall. first, last: of the hole. start, stop: of the stretch, from first.
    """
    middle = (first + start + first + stop - 1) // 2
    padded = np.pad(walled, 1, constant_values=1.0)  # walls stand at both ends
    low = _inset(padded[first : middle + 2]) if start == 0 else 0.0
    high = _inset(padded[middle + 1 : last + 3][::-1]) if first + stop > last else 0.0
    return low, high


def _inset(walled: FloatArray) -> float:
    """Where the wall ends, in pixels after the first; 0 where it never does."""
    clear = np.flatnonzero(walled <= _AT_END)
    if not len(clear):
        return 0.0
    before, after = walled[clear[0] - 1], walled[clear[0]]
    return float(clear[0] - 1.5 + (before - _AT_END) / (before - after))


def _opening(
    wall: Wall, kind: OpeningKind, start: float, length: float, sign: float
) -> WallOpening:
    edge = wall.edge
    center = edge.start + (start + length / 2) * edge.along + wall.depth / 2 * edge.outward
    rooms = [(edge.room, edge.outward)]
    if wall.other is not None:
        rooms.append((wall.other.room, wall.other.outward))
    sure = round(min(1.0, sign), 2)
    return WallOpening(kind, center, edge.along, float(length), wall.depth, tuple(rooms), sure)


def door_in(wall: Wall, start: float, length: float, sign: float) -> WallOpening:
    """A door that has to be in a wall, from start along its edge. sign: how much speaks for it."""
    return replace(_opening(wall, "door", start, length, sign), is_guess=True)


def _joined(openings: list[WallOpening], thickness_px: float) -> list[WallOpening]:
    """Pieces of one opening in a wall whose face has a step are one."""
    kept: list[WallOpening] = []
    for piece in sorted(openings, key=lambda opening: -opening.length_px):
        for index, other in enumerate(kept):
            if _is_same(piece, other, thickness_px):
                kept[index] = _together(other, piece)
                break
        else:
            kept.append(piece)
    return kept


def _is_same(first: WallOpening, other: WallOpening, thickness_px: float) -> bool:
    if first.kind == "window" and first.wall == other.wall:
        return False
    if first.kind != other.kind or {r for r, _ in first.rooms} != {r for r, _ in other.rooms}:
        return False
    between = first.center_px - other.center_px
    apart = abs(float(between @ other.along)) - (first.length_px + other.length_px) / 2
    aside = abs(float(between @ np.array([-other.along[1], other.along[0]])))
    is_parallel = abs(float(first.along @ other.along)) > -_OPPOSED
    return (
        is_parallel
        and apart < (_JOINED_PX if first.kind == "window" else _JOINED * thickness_px)
        and aside < thickness_px
    )


def _together(piece: WallOpening, other: WallOpening) -> WallOpening:
    """The opening from the far end of the piece to that of the other, in the wall of the piece."""
    shift = float((other.center_px - piece.center_px) @ piece.along)
    insets = other.insets_px if float(piece.along @ other.along) > 0 else other.insets_px[::-1]
    pieces = (0.0, piece.length_px, piece.insets_px), (shift, other.length_px, insets)
    low, first = min((middle - length / 2, inset[0]) for middle, length, inset in pieces)
    high, last = max((middle + length / 2, inset[1]) for middle, length, inset in pieces)
    return replace(
        piece,
        center_px=piece.center_px + (low + high) / 2 * piece.along,
        length_px=high - low,
        insets_px=(first, last),
    )
