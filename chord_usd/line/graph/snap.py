"""Items of a layout raster, to the pixel: every box is fitted to the pixels of its own colour.

What wins. The colour of a pixel decides its category, always. Where the pixels of a patch make a
rectangle with its front mark, they decide the box as well, whatever the detector said. The
detector decides where pixels are ambiguous: how many pieces a patch without clear marks holds, and
whether a patch too small for its category is an item (it saw one there) or a speck. Proposals with
too few pixels of their colour are dropped; patches that the detector missed are kept.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from chord_usd.base.raster.windows import Window, label_windows
from chord_usd.base.scene.oriented_rect import OrientedRect
from chord_usd.base.scene.palette import HOUSE_CATEGORIES, PLAN_CATEGORIES, Category, Mount
from chord_usd.base.scene.types import BoolArray, Detection, FloatArray, LayoutImage, frozen_array
from chord_usd.base.scene.units import fold_deg
from chord_usd.line.graph.colours import CLEAR, NO_ITEM, LabelArray, LayoutPixels, read_pixels
from chord_usd.line.graph.detect import LEAST_SIDE_PX
from chord_usd.line.graph.directions import Directions, raster_directions
from chord_usd.line.graph.patches import (
    MARGIN_PX,
    Patch,
    UsualSize,
    cut_patch,
    explain,
    is_another,
    mark_fits,
    uncovered,
)
from chord_usd.line.graph.rectangles import Piece, canvas_corners, front_mark

LEAST_SHARE = 0.35
"""Patches smaller than this share of the smallest usual piece of their category are specks..."""
LEAST_SHARE_SEEN = 0.15
"""...unless the detector proposes a piece there: then they may be this small."""

SURE_SCORE = 0.5
"""Proposals below this confidence neither split a patch nor make a piece of a speck."""

LEAST_FIT = 0.1
"""Pieces that the pixels bear out worse, [0, 1], are noise unless the detector has them."""
LEAST_SIDE_SHARE = 0.4
"""So are pieces with a side shorter than this share of the smallest usual one, less a pixel."""

_LEAST_PX = 2
_NEAR_PX = 2
"""Fragments this near to a patch of their category belong to it."""
_SUPPORT = 0.3
"""Share of a proposal that pixels of its colour must cover, and overlap that makes a match."""
_NETWORK_PX = 1.0
"""What the network's edges may be off."""
_THIN_PX = 2.5
_ONE_ROW_PX = 1.5
"""Depths up to here are painted as one row of pixels, mostly."""


@dataclass(frozen=True, eq=False)
class FoundItem:
    """A detection and what is known about it."""

    detection: Detection
    front_seen: bool
    """Whether a front mark gave the orientation; else the nearest wall did."""
    in_detector: bool
    """Whether the detector proposed it, too."""


def decode_items(layout: LayoutImage) -> list[Detection]:
    """Items of a layout raster by colour alone, without a detector. Best fits first.

    Exact on clean rasters: edges within half a pixel of what was drawn.
    """
    items = find_items(read_pixels(layout.rgb), layout.frame.m_per_px)
    return [item.detection for item in items]


def find_items(
    pixels: LayoutPixels,
    m_per_px: float,
    directions: Directions | None = None,
    proposals: Iterable[Detection] = (),
    categories: Sequence[Category] = HOUSE_CATEGORIES,
) -> list[FoundItem]:
    """Items in decoded pixels, helped by the detector's proposals.

    directions: of the walls; read from the pixels where not given. categories: of the level of the
    pixels' item labels. Ordered by category, then by position, so that equal
    rasters give equal lists.
    """
    directions = directions or raster_directions(pixels.structure)
    by_category: dict[str, list[Detection]] = {}
    for proposal in proposals:
        by_category.setdefault(proposal.category, []).append(proposal)
    items: list[FoundItem] = []
    for row, window in zip(categories, _windows(pixels.item), strict=False):
        if window:
            seen = by_category.get(row.name, [])
            items += _of_category(pixels, row, window, m_per_px, directions, seen)
    return items


def _windows(item: LabelArray) -> Iterator[Window | None]:
    """For each category the window of its pixels and what surrounds them; None without any."""
    for spans in label_windows(item + 1):
        if spans is None:
            yield None
            continue
        rows, columns = (
            slice(max(span.start - MARGIN_PX, 0), span.stop + MARGIN_PX) for span in spans
        )
        yield rows, columns


def _of_category(
    pixels: LayoutPixels,
    row: Category,
    window: tuple[slice, slice],
    m_per_px: float,
    directions: Directions,
    proposals: Sequence[Detection],
) -> list[FoundItem]:
    usual_px = UsualSize.of(row, m_per_px)
    seen = [(proposal, proposed_rect(proposal, usual_px)) for proposal in proposals]
    thin = usual_px.width[0] < _THIN_PX
    near = pixels.window(window)
    origin = window[0].start, window[1].start
    items: list[FoundItem] = []
    for mask in _patches(near, row.detector_class, thin):
        patch = cut_patch(mask, near.front, near.item != NO_ITEM, usual_px, origin)
        inside = [
            rectangle
            for proposal, rectangle in seen
            if proposal.score >= SURE_SCORE and _support(patch, rectangle) >= _SUPPORT
        ]
        if patch.size < _least_size_px(usual_px, bool(inside)):
            continue
        for piece, cost in _explained(patch, directions, inside):
            item = _found_item(pixels, row, m_per_px, patch, piece, cost, seen)
            if item.in_detector or _is_plausible(piece, cost, usual_px):
                items.append(item)
    return items


def _patches(pixels: LayoutPixels, label: int, thin: bool) -> Iterable[BoolArray]:
    """Connected pixels of one category; fragments without a mark join the patch beside them.

    Pixels that touch at a corner only are together in thin things (a slanted panel is a staircase)
    and apart in others (slanted chairs in a row).
    """
    member = pixels.item == label
    joined = member.astype(np.uint8)
    if thin:
        # Noise breaks a line of single pixels into dashes.
        closed = cv2.morphologyEx(joined, cv2.MORPH_CLOSE, np.ones((5, 5), np.uint8))
        joined = np.where(pixels.structure == CLEAR, closed, joined)
    count, labels = cv2.connectedComponents(joined, connectivity=8 if thin else 4)
    labels = np.where(member, labels, 0)
    if count > 2:
        whole = np.zeros(count, dtype=bool)
        whole[labels[member & pixels.front]] = True
        if not whole[1:].all():
            labels = _fragments_joined(labels, whole)
    for index in np.unique(labels[member]):
        yield labels == index


def _fragments_joined(labels: np.ndarray, whole: BoolArray) -> np.ndarray:
    joined = labels.copy()
    kernel = np.ones((2 * _NEAR_PX + 1, 2 * _NEAR_PX + 1), dtype=np.uint8)
    for label in np.flatnonzero(~whole[1:]) + 1:
        near = labels[cv2.dilate((labels == label).astype(np.uint8), kernel) > 0]
        votes = np.bincount(near[(near > 0) & (near != label)], minlength=1)
        if votes.any():
            joined[joined == label] = joined[labels == int(votes.argmax())][0]
    return joined


def _least_size_px(usual_px: UsualSize, seen: bool) -> float:
    return max(_LEAST_PX, (LEAST_SHARE_SEEN if seen else LEAST_SHARE) * usual_px.least_area)


def _explained(
    patch: Patch, directions: Directions, proposals: Sequence[OrientedRect]
) -> list[tuple[Piece, float]]:
    """Pieces of a patch with their share of wrong pixels; what is left over is explained again."""
    pieces, cost = explain(patch, directions, proposals)
    share = min(1.0, cost / patch.size)
    result = [(piece, share) for piece in pieces]
    rest = uncovered(patch, pieces)
    if _least_size_px(patch.usual_px, False) <= rest.sum() < patch.size:
        left = replace(
            patch,
            evidence=replace(
                patch.evidence,
                members=patch.evidence.members[rest],
                outsiders=np.concatenate([patch.evidence.outsiders, patch.evidence.members[~rest]]),
                weights=np.concatenate([patch.evidence.weights, np.ones(int((~rest).sum()))]),
            ),
            marked=patch.marked[rest],
        )
        # Torn pixels may be left over by every piece that explains them, and ask for it for ever.
        again = _explained(left, directions, ())
        result += [entry for entry in again if is_another(entry[0], pieces)]
    return result


def _is_plausible(piece: Piece, wrong_share: float, usual_px: UsualSize) -> bool:
    rectangle = piece.rectangle
    sides = sorted((rectangle.u1 - rectangle.u0, rectangle.v1 - rectangle.v0))
    least = sorted((usual_px.length[0], usual_px.width[0]))
    fits = all(a >= LEAST_SIDE_SHARE * b - 1.0 for a, b in zip(sides, least, strict=True))
    return fits and 1.0 - wrong_share >= LEAST_FIT


def _found_item(
    pixels: LayoutPixels,
    row: Category,
    m_per_px: float,
    patch: Patch,
    piece: Piece,
    wrong_share: float,
    seen: Sequence[tuple[Detection, OrientedRect]],
) -> FoundItem:
    marked = patch.evidence.members[patch.marked]
    marked = marked[piece.rectangle.grown(1.0).covers(marked)]
    turns, front_seen = facing(pixels, piece, marked, row.mount, patch.usual_px)
    rectangle = thinned(piece.rectangle, turns, row, m_per_px)
    overlaps = [(_overlap(piece.rectangle, other), proposal.score) for proposal, other in seen]
    best, score = max(overlaps, default=(0.0, 0.0))
    in_detector = bool(best >= _SUPPORT)
    mask = np.zeros(pixels.item.shape, dtype=bool)
    members = patch.evidence.members[piece.rectangle.grown(0.5).covers(patch.evidence.members)]
    mask[(-members[:, 1]).astype(int), members[:, 0].astype(int)] = True
    mask.setflags(write=False)
    detection = Detection(
        category=row.name,
        corners_px=frozen_array(canvas_corners(rectangle, turns)),
        score=score if in_detector else 1.0 - wrong_share,
        mask=mask,
    )
    return FoundItem(detection, front_seen, in_detector)


def thinned(rectangle: OrientedRect, turns: int, row: Category, m_per_px: float) -> OrientedRect:
    """Whatever is painted a single row of pixels thick, growing to the front, given back the
    depth that is most likely: the middle, as ratios go, of the depths that look so."""
    depth = rectangle.v1 - rectangle.v0 if turns % 2 == 0 else rectangle.u1 - rectangle.u0
    least, most = (side / m_per_px for side in row.width_m)
    if least >= _ONE_ROW_PX or depth > _ONE_ROW_PX:
        return rectangle
    excess = depth - math.sqrt(least * min(most, _ONE_ROW_PX))
    if turns == 0:
        return replace(rectangle, v0=rectangle.v0 + excess)
    if turns == 1:
        return replace(rectangle, u1=rectangle.u1 - excess)
    if turns == 2:
        return replace(rectangle, v1=rectangle.v1 - excess)
    return replace(rectangle, u0=rectangle.u0 + excess)


def proposed_rect(proposal: Detection, usual_px: UsualSize) -> OrientedRect:
    """Where the network proposes a piece, upright pixels."""
    return _true_sized(_as_rectangle(proposal.corners_px), usual_px)


def _as_rectangle(corners_px: FloatArray) -> OrientedRect:
    """An oriented box given by its corners on the canvas (y down)."""
    upright = corners_px * (1.0, -1.0)
    side = upright[3] - upright[0]
    angle = fold_deg(float(np.degrees(np.arctan2(side[1], side[0]))))
    local = OrientedRect(angle, 0, 0, 0, 0).local(upright)
    (u0, v0), (u1, v1) = local.min(axis=0), local.max(axis=0)
    return OrientedRect(angle, float(u0), float(u1), float(v0), float(v1))


def _true_sized(proposal: OrientedRect, usual_px: UsualSize) -> OrientedRect:
    """A proposal without what the network adds to small pieces (detect.LEAST_SIDE_PX)."""
    most = sorted((usual_px.length[1], usual_px.width[1]))
    u, v = proposal.u1 - proposal.u0, proposal.v1 - proposal.v0
    across = min(u, most[u > v]) if u <= LEAST_SIDE_PX + _NETWORK_PX else u
    along = min(v, most[v >= u]) if v <= LEAST_SIDE_PX + _NETWORK_PX else v
    return _resized(proposal, across, along)


def _resized(rectangle: OrientedRect, across: float, along: float) -> OrientedRect:
    """The same centre and direction, other sides."""
    u, v = (rectangle.u0 + rectangle.u1) / 2, (rectangle.v0 + rectangle.v1) / 2
    spans = (u - across / 2, u + across / 2, v - along / 2, v + along / 2)
    return OrientedRect(rectangle.angle_deg, *spans)


def _support(patch: Patch, proposal: OrientedRect) -> float:
    """Share of a proposal, which may be a pixel off, that the pixels of a patch cover."""
    covered = proposal.grown(_NETWORK_PX).covers(patch.evidence.members).sum()
    return float(covered) / max(proposal.area, 1.0)


def _overlap(piece: OrientedRect, proposal: OrientedRect) -> float:
    """Intersection over union; of panels, both as deep as the network is taught them."""
    if max(piece.u1 - piece.u0, piece.v1 - piece.v0) >= LEAST_SIDE_PX:
        piece, proposal = (
            _resized(
                rect, max(rect.u1 - rect.u0, LEAST_SIDE_PX), max(rect.v1 - rect.v0, LEAST_SIDE_PX)
            )
            for rect in (piece, proposal)
        )
    both = piece.covered_by(proposal) * piece.area
    return both / max(piece.area + proposal.area - both, 1e-9)


# Which way a piece faces: by its front mark; where that is torn, by the wall behind it, ----------

LEAST_MARK_FIT = 0.2
"""A mark that fits its place worse than this (intersection over union) does not count."""

_WALL_WORD, _SPLIT_WORD, _UNUSUAL_WORD, _LONG_WORD = 0.3, 0.2, 0.25, 0.3
"""Weights of a wall behind, the splitting of a patch, an unusual size and a long front, beside a
mark's fit. A clean mark fits by 0.6 or more better than at any other side, so it always wins."""

_SAME_MARK = 0.7
_LOOK_PX = np.array([0.8, 1.6, 2.4])
"""Distances behind an edge at which a wall is looked for."""
_LOOK_SHARES = np.array([0.15, 0.4, 0.6, 0.85])

_DOOR = next(row.detector_class for row in PLAN_CATEGORIES if row.name == "door")


def facing(
    pixels: LayoutPixels, piece: Piece, marked: FloatArray, mount: Mount, usual_px: UsualSize
) -> tuple[int, bool]:
    """Quarter turns of a piece, and whether its mark shows them.

    marked: (N, 2) upright points of the patch that are of a front mark.
    """
    rectangle = piece.rectangle
    fits = mark_fits(rectangle, marked)
    if mount is Mount.WALL:
        fits = fits * long_fronts(rectangle)  # panels hang flat, whatever their mark has become
    if fits.max() < LEAST_MARK_FIT:
        walls = walls_behind(pixels, rectangle, range(4))
        return int(np.argmax(walls + _LONG_WORD * long_fronts(rectangle))), False
    turns = int(fits.argmax())
    opposite = (turns + 2) % 4
    thin = front_mark(rectangle, opposite).covered_by(front_mark(rectangle, turns)) > _SAME_MARK
    if thin or mount is Mount.WALL:
        # The mark of a piece a pixel or two thick does not part its front from its back.
        choices = (turns, opposite)
        return choices[int(np.argmax(walls_behind(pixels, rectangle, choices)))], True
    word = fits + _WALL_WORD * walls_behind(pixels, rectangle, range(4))
    if piece.quarter_turns is not None:
        word[piece.quarter_turns] += _SPLIT_WORD
    unusual = [usual_px.unusual_sides(Piece(rectangle, choice)) for choice in range(4)]
    return int(np.argmax(word - _UNUSUAL_WORD * np.array(unusual))), True


def long_fronts(rectangle: OrientedRect) -> FloatArray:
    """(4,) 1 where the front would be a longer side."""
    across, along = rectangle.u1 - rectangle.u0, rectangle.v1 - rectangle.v0
    return np.array([across >= along, along >= across] * 2, dtype=np.float64)


def walls_behind(
    pixels: LayoutPixels, rectangle: OrientedRect, choices: Iterable[int]
) -> FloatArray:
    """Share of wall or window right behind the back, for each choice of quarter turns."""
    corners = np.array([canvas_corners(rectangle, turns) for turns in choices])
    back_left, front_left, back_right = corners[:, 0], corners[:, 1], corners[:, 3]
    outward = back_left - front_left
    outward = outward / np.maximum(np.hypot(outward[:, 0], outward[:, 1]), 1e-9)[:, None]
    along = back_left[:, None] + (back_right - back_left)[:, None] * _LOOK_SHARES[:, None]
    points = along[:, :, None] + outward[:, None, None] * _LOOK_PX[:, None]
    height, width = pixels.structure.shape
    columns, rows = np.moveaxis(np.floor(points).astype(int), -1, 0)
    inside = (columns >= 0) & (columns < width) & (rows >= 0) & (rows < height)
    seen = pixels.structure[np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)]
    solid = inside & (seen != CLEAR) & (seen != _DOOR)
    shares: FloatArray = solid.mean(axis=(1, 2))
    return shares
