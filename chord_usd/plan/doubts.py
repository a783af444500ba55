"""Readings that cannot be right are refused; what is uncertain is said."""

from __future__ import annotations

from collections.abc import Sequence

import cv2
import numpy as np
from shapely.geometry import Polygon

from chord_usd.errors import PlanError
from chord_usd.plan.labels import texts_in
from chord_usd.plan.measures import parse_measure
from chord_usd.plan.openings import CONFIDENCE
from chord_usd.plan.regions import Outline
from chord_usd.plan.strokes import Strokes
from chord_usd.plan.text import Text
from chord_usd.room_names import room_kind
from chord_usd.types import BoolArray, ByteArray, FloatArray, PixelFrame, Plan, RoomKind
from chord_usd.units import px_from_m

_HOUSE_M2 = (4.0, 3000.0)
_LEAST_COVERED = 0.35
"""Share of what the walls surround that must be rooms; where it is less, walls were missed."""

_UNCERTAIN = 0.5
_MOST_NAMES = 4
"""An open plan has up to three names; more are a sign of walls that were not seen."""

_OWN_ROOM: frozenset[RoomKind] = frozenset({"bedroom", "bathroom", "study"})
"""These have walls of their own."""

_CUT_SHARE = 0.04
"""A wall along so much of the picture's edge means that the drawing goes on beyond it."""

_WALLS_NEAR = 2.5
"""A room so many wall thicknesses from the picture's edge ends there."""

_RIM_PX = 3
_COLOR_STEP = 16
_SAME_COLOR, _FLAT = 28, 14
_MOST_FLOORS = 12
_LETTER_PX = 9
_PATCH_SHARE, _WALLED_RIM = 0.12, 0.5
"""A colour that fills so much of a room, and has so much of its rim along walls, is a floor."""


def refuse_nonsense(outlines: Sequence[Outline], strokes: Strokes, frame: PixelFrame) -> None:
    """Raises PlanError for what is most likely no plan, or one of which only a part was seen."""
    floor_px = sum(Polygon(outline.polygon_px).area for outline in outlines)
    floor_m2 = floor_px * frame.m_per_px**2
    if not _HOUSE_M2[0] <= floor_m2 <= _HOUSE_M2[1]:
        raise PlanError(
            f"what was read has a floor of {floor_m2:.3g} m²",
            expected=f"a dwelling of {_HOUSE_M2[0]:g} to {_HOUSE_M2[1]:g} m²",
            try_="--scale M_PER_PX",
        )
    covered = floor_px / max(_surrounded_px(outlines, strokes), 1.0)
    if covered < _LEAST_COVERED:
        raise PlanError(
            f"only {covered:.0%} of what the walls surround could be read as rooms",
            expected="walls that close round every room, but for doors and windows",
            try_="a clearer drawing, cut to one floor, with the walls filled in black",
        )


def _surrounded_px(outlines: Sequence[Outline], strokes: Strokes) -> float:
    """Pixels within the hull of all walls that hang together with those round the rooms."""
    rooms = np.zeros(strokes.wall.shape, np.uint8)
    for outline in outlines:
        cv2.fillPoly(rooms, [np.rint(outline.polygon_px).astype(np.int32)], (1.0,))
    reach = 2 * max(round(3.0 * strokes.thickness_px), 4) + 1
    near = cv2.dilate((strokes.wall | (rooms > 0)).astype(np.uint8), np.ones((reach, reach)))
    _, labels = cv2.connectedComponents(near)
    own = np.unique(labels[rooms > 0])
    points = np.argwhere((strokes.wall | (rooms > 0)) & np.isin(labels, own[own > 0]))
    return float(cv2.contourArea(cv2.convexHull(points.astype(np.int32))))


def doubts(
    plan: Plan, rgb: ByteArray, strokes: Strokes, texts: Sequence[Text], frame: PixelFrame
) -> list[str]:  # fmt: skip
    """What a user should look at, in sentences. rgb, texts: of the picture that lies in frame."""
    told = []
    several = [room.id for room in plan.rooms if _is_several(texts_in(room, texts, frame))]
    if several:
        told.append(
            f"{', '.join(several)}: what is printed there is of several rooms; an opening "
            "or a wall may be missing"
        )
    patched = [room.id for room in plan.rooms if _is_patched(px_from_m(room.polygon_m, frame), rgb)]
    if patched:
        told.append(
            f"{', '.join(patched)}: the floor is drawn in several colours; it may be several "
            "rooms, without a wall between them or with one that was not seen"
        )
    shaky = [room.id for room in plan.rooms if room.extra.get(CONFIDENCE, 1.0) < _UNCERTAIN]
    if shaky:
        told.append(f"the outlines of {', '.join(shaky)} are uncertain")
    vague = [o.id for o in plan.openings if o.extra.get(CONFIDENCE, 1.0) < _UNCERTAIN]
    if vague:
        told.append(f"it is uncertain what {', '.join(vague)} {'is' if len(vague) == 1 else 'are'}")
    sides = _cut_sides(strokes, [px_from_m(room.polygon_m, frame) for room in plan.rooms])
    if sides:
        told.append(f"the drawing seems to be cut off at its {' and '.join(sides)} edge")
    return told


def _is_several(texts: Sequence[Text]) -> bool:
    """Whether what is printed in a room is of more rooms than an open plan has parts."""
    measures = [parse_measure(text.text) for text in texts]
    sized = sum(measure is not None and measure.kind != "length" for measure in measures)
    kinds = [kind for kind in (room_kind(text.text) for text in texts) if kind != "unknown"]
    own = sum(kind in _OWN_ROOM for kind in kinds)
    return sized > 1 or len(kinds) >= _MOST_NAMES or (own > 0 and len(kinds) > 1)


def _is_patched(polygon_px: FloatArray, rgb: ByteArray) -> bool:
    """Whether a room's floor, (N, 2) corners, has two colours that each fill it from wall to wall.

    rgb: (H, W, 3). Beds and rugs have colours, too, but little of their rim lies along walls.
    """
    low = np.floor(polygon_px.min(axis=0)).astype(int).clip(0)
    high = np.ceil(polygon_px.max(axis=0)).astype(int) + 1
    window = rgb[low[1] : high[1], low[0] : high[0]]
    floor = np.zeros(window.shape[:2], np.uint8)
    cv2.fillPoly(floor, [np.rint(polygon_px - low - 0.5).astype(np.int32)], (1.0,))
    inner = cv2.erode(floor, np.ones((2 * _RIM_PX + 1,) * 2, np.uint8)) > 0
    codes = (window[inner] // _COLOR_STEP).astype(np.int32) @ np.array([256, 16, 1])
    values, counts = np.unique(codes, return_counts=True)
    found: list[FloatArray] = []
    for code in values[np.argsort(-counts)][:_MOST_FLOORS]:
        color = window[inner][codes == code].mean(axis=0)
        is_new = all(np.abs(color - other).max() > _SAME_COLOR for other in found)
        if is_new and _fills(cv2.inRange(window, color - _FLAT, color + _FLAT), inner):
            found.append(color)
    return len(found) > 1


def _fills(color: cv2.typing.MatLike, inner: BoolArray) -> bool:
    """Whether a colour's largest patch in a room is much of it, and mostly bounded by its walls."""
    # Letters and furniture lie on a floor.
    own = cv2.morphologyEx(color, cv2.MORPH_CLOSE, np.ones((_LETTER_PX,) * 2, np.uint8)) > 0
    count, labels, stats, _ = cv2.connectedComponentsWithStats((own & inner).astype(np.uint8))
    if count < 2:
        return False
    label = 1 + int(np.argmax(stats[1:, cv2.CC_STAT_AREA]))
    patch = (labels == label).astype(np.uint8)
    if patch.sum() < _PATCH_SHARE * inner.sum():
        return False
    rim = (patch > 0) & (cv2.erode(patch, np.ones((3, 3), np.uint8)) == 0)
    border = inner & (cv2.erode(inner.astype(np.uint8), np.ones((7, 7), np.uint8)) == 0)
    return bool((rim & border).sum() > _WALLED_RIM * rim.sum())


def _cut_sides(strokes: Strokes, polygons_px: Sequence[FloatArray]) -> list[str]:
    """Edges of the picture that walls run out of, but for those of rooms that end there."""
    height, width = strokes.wall.shape
    margin = max(4, round(0.012 * min(height, width)))
    wall, reach = strokes.wall, margin + _WALLS_NEAR * strokes.thickness_px
    strips = {
        "upper": (wall[:margin].any(axis=0), 1, 0),
        "lower": (wall[-margin:].any(axis=0), 1, height),
        "left": (wall[:, :margin].any(axis=1), 0, 0),
        "right": (wall[:, -margin:].any(axis=1), 0, width),
    }
    cut = []
    for name, (strip, axis, edge) in strips.items():
        if strip.mean() >= 1 - _CUT_SHARE:
            continue
        open_ended = strip.copy()
        for polygon in polygons_px:
            if np.abs(polygon[:, axis] - edge).min() < reach:
                beside = polygon[np.abs(polygon[:, axis] - edge) < reach, 1 - axis]
                first, last = beside.min() - reach, beside.max() + reach
                open_ended[max(round(first), 0) : max(round(last), 0)] = False
        if open_ended.any():
            cut.append(name)
    return cut
