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
from chord_usd.types import PixelFrame, Plan, RoomKind

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
    plan: Plan, strokes: Strokes, texts: Sequence[Text], frame: PixelFrame
) -> list[str]:  # fmt: skip
    """What a user should look at, in sentences. texts: of the picture that lies in frame."""
    told = []
    several = [room.id for room in plan.rooms if _is_several(texts_in(room, texts, frame))]
    if several:
        told.append(
            f"{', '.join(several)}: what is printed there is of several rooms; an opening "
            "or a wall may be missing"
        )
    shaky = [room.id for room in plan.rooms if room.extra.get(CONFIDENCE, 1.0) < _UNCERTAIN]
    if shaky:
        told.append(f"the outlines of {', '.join(shaky)} are uncertain")
    vague = [o.id for o in plan.openings if o.extra.get(CONFIDENCE, 1.0) < _UNCERTAIN]
    if vague:
        told.append(f"it is uncertain what {', '.join(vague)} {'is' if len(vague) == 1 else 'are'}")
    sides = _cut_sides(strokes)
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


def _cut_sides(strokes: Strokes) -> list[str]:
    """Edges of the picture that walls run out of."""
    margin = max(4, round(0.012 * min(strokes.wall.shape)))
    wall = strokes.wall
    strips = {
        "upper": wall[:margin].any(axis=0), "lower": wall[-margin:].any(axis=0),
        "left": wall[:, :margin].any(axis=1), "right": wall[:, -margin:].any(axis=1),
    }  # fmt: skip
    return [name for name, strip in strips.items() if 0 < strip.mean() < 1 - _CUT_SHARE]
