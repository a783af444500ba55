"""Readings that cannot be right are refused; what is uncertain is said."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from shapely.geometry import Point, Polygon

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.types import (
    OPEN,
    SURROUNDS,
    WET_KINDS,
    FloatArray,
    PixelFrame,
    Plan,
    RoomKind,
)
from chord_usd.base.scene.units import m_from_px, px_from_m
from chord_usd.line.plan.fitted import Fit
from chord_usd.line.plan.labels import texts_in
from chord_usd.line.plan.measures import distinct, parse_measure
from chord_usd.line.plan.openings import is_guessed
from chord_usd.line.plan.parts import built_parts
from chord_usd.line.plan.placement import CHECK_SCALE
from chord_usd.line.plan.regions import Regions
from chord_usd.line.plan.text import Text
from chord_usd.line.plan.verdict import (
    COUNTED,
    CUT_OFF,
    NO_DOOR,
    NO_ROOM,
    OF_SEVERAL,
    OPEN_OUT,
    UNSURE_RIMS,
    UNSURE_WHAT,
    is_shaky,
    is_vague,
    reached_together,
)

_HOUSE_M2 = (4.0, 3000.0)
_LEAST_COVERED = 0.35
"""Share of what the walls surround that must be rooms; where it is less, walls were missed."""

_MOST_LISTED = 6

_MANY_MISFITS = 0.4
"""Share of printed sizes that do not fit from which on the scale may be wrong."""

_MOST_NAMES = 4
"""An open plan has up to three names; more are a sign of walls that were not seen."""

_OWN_ROOM: frozenset[RoomKind] = frozenset({"bedroom", "study", *WET_KINDS})
"""These have walls of their own."""

_CUT_SHARE = 0.04
"""A picture's edge that is wall but for this share is its frame."""

_CLOSED_SHARE = 0.5
"""Share of a room's side at a picture's edge below which no wall is drawn there."""

_WALLS_NEAR = 2.5
"""A room so many wall thicknesses from the picture's edge ends there."""

_NAME_REACH_M = 0.4
"""A name may stand on the wall of its room."""


def refuse_nonsense(polygons_px: Sequence[FloatArray], regions: Regions, frame: PixelFrame) -> None:
    """Raises PlanError for what is most likely no plan, or one of which only a part was seen."""
    floor_px = sum(Polygon(polygon).area for polygon in polygons_px)
    floor_m2 = floor_px * frame.m_per_px**2
    if not _HOUSE_M2[0] <= floor_m2 <= _HOUSE_M2[1]:
        raise PlanError(
            f"what was read has a floor of {floor_m2:.3g} m²",
            expected=f"a dwelling of {_HOUSE_M2[0]:g} to {_HOUSE_M2[1]:g} m²",
            try_="<m_per_px>",
        )
    covered = floor_px / max(_surrounded_px(polygons_px, regions), 1.0)
    if covered < _LEAST_COVERED:
        raise PlanError(
            f"only {covered:.0%} of what the walls surround could be read as rooms",
            expected="walls that close round every room, but for doors and windows",
            try_="a clearer drawing, cut to one floor, with the walls filled in black",
        )


def is_all_guessed(plan: Plan) -> bool:
    """Whether no room closes, and nothing on the page is sure: noise, fur, or something else."""
    return all(is_shaky(room) and OPEN in room.extra for room in plan.rooms) and all(
        is_vague(opening) for opening in plan.openings
    )


def _surrounded_px(polygons_px: Sequence[FloatArray], regions: Regions) -> float:
    """Pixels within the hull of all that hangs together with the rooms."""
    built, labels = built_parts(regions)
    rooms = np.zeros(built.shape, np.uint8)
    for polygon in polygons_px:
        cv2.fillPoly(rooms, [np.rint(polygon).astype(np.int32)], (1.0,))
    points = np.argwhere(built & np.isin(labels, np.unique(labels[built & (rooms > 0)])))
    return float(cv2.contourArea(cv2.convexHull(points.astype(np.int32))))


@dataclass(frozen=True)
class NamedRooms:
    """What is printed on a page, held against the rooms that were read on it."""

    crowded: tuple[str, ...]
    """Ids of rooms in which the names or sizes of several are printed."""
    homeless: tuple[str, ...]
    """Names within the house's bounds that stand in none of its rooms."""


def named_rooms(plan: Plan, texts: Sequence[Text], frame: PixelFrame) -> NamedRooms:
    """texts: of the picture that lies in frame."""
    kinds = {id(text): room_kind(text.text) for text in texts}
    names = [text for text in texts if kinds[id(text)] != "unknown"]
    crowded = []
    for room in plan.rooms:
        room_texts = texts_in(room, texts, frame)
        said = [kinds[id(text)] for text in room_texts if kinds[id(text)] != "unknown"]
        if _is_several([text.text for text in room_texts], said):
            crowded.append(room.id)
    return NamedRooms(tuple(crowded), tuple(_in_no_room(plan, names, frame)))


def doubts(plan: Plan, regions: Regions, named: NamedRooms, frame: PixelFrame) -> list[str]:
    """What a user should look at, in sentences. frame: where the picture of the regions lies."""
    warnings = [*_doubts_of_rooms(plan, named), *_doubts_of_openings(plan)]
    sides = _cut_sides(regions, [px_from_m(room.polygon_m, frame) for room in plan.rooms])
    if sides:
        warnings.append(f"{CUT_OFF} at its {' and '.join(sides)} edge")
    return warnings


def doubts_of_sizes(plan: Plan, fit: Fit, frame: PixelFrame) -> Iterator[str]:
    """Printed sizes that do not fit the rooms in which they stand."""
    if len(fit.misfits) > _MANY_MISFITS * fit.printed:
        count = len(fit.misfits)
        yield f"{count} of {fit.printed} printed sizes do not fit what was read: {CHECK_SCALE}"
    for misfit in fit.misfits[:_MOST_LISTED]:
        place = Point(*m_from_px(np.array(misfit.at_px), frame))
        room = min(plan.rooms, key=lambda room: room_polygon(room).distance(place))
        unit = "m²" if misfit.kind == "area" else "m"
        read = " x ".join(f"{value:.2f}" for value in misfit.read_m)
        yield f"{room.id}: {misfit.text!r} is printed there, {read} {unit} was read"


def _doubts_of_rooms(plan: Plan, named: NamedRooms) -> list[str]:
    warnings = []
    if named.crowded:
        warnings.append(
            f"{', '.join(named.crowded)}: {OF_SEVERAL}; an opening or a wall may be missing"
        )
    if named.homeless:
        warnings.append(f"{NO_ROOM} {', '.join(map(repr, named.homeless))} is printed")
    if all(room.kind == "unknown" for room in plan.rooms):
        warnings.append("of no room is it known what it is for")
    ajar = [room.id for room in plan.rooms if OPEN in room.extra]
    if ajar:
        warnings.append(f"{_listed(ajar, 'rooms')}: {OPEN_OUT}; a wall may be missing")
    warnings += [
        f"{room.id}: walls within it take up {room.extra[SURROUNDS]:g} m², which are no room"
        for room in plan.rooms
        if SURROUNDS in room.extra
    ]
    shaky = [room.id for room in plan.rooms if is_shaky(room)]
    if shaky:
        warnings.append(f"{UNSURE_RIMS} {_listed(shaky, 'rooms')} are uncertain")
    return warnings


def _listed(ids: Sequence[str], what: str) -> str:
    """Their names, or how many there are where nobody would read them all."""
    if len(ids) <= _MOST_LISTED:
        return ", ".join(ids)
    return f"{len(ids)} {what} {COUNTED}"


def _doubts_of_openings(plan: Plan) -> list[str]:
    warnings = []
    vague = [opening.id for opening in plan.openings if is_vague(opening)]
    if vague:
        is_one = len(vague) == 1
        warnings.append(f"{UNSURE_WHAT} {_listed(vague, 'openings')} {'is' if is_one else 'are'}")
    groups = reached_together(plan)
    if len(groups) > 1:
        apart = [room_id for group in groups[1:] for room_id in group]
        guessed = [opening.id for opening in plan.openings if is_guessed(opening)]
        put = f": {_listed(guessed, 'doors')} put where likeliest" if guessed else ""
        warnings.append(f"{NO_DOOR} {_listed(apart, 'rooms')}; one may be missing{put}")
    return warnings


def _in_no_room(plan: Plan, names: Sequence[Text], frame: PixelFrame) -> Iterator[str]:
    """Names that are printed within the house's bounds, and in none of its rooms."""
    floors = [room_polygon(room).buffer(_NAME_REACH_M) for room in plan.rooms]
    corners = np.concatenate([room.polygon_m for room in plan.rooms])
    low, high = corners.min(axis=0), corners.max(axis=0)
    for name in names:
        place = m_from_px(name.center_px, frame)
        is_within = bool(np.all((low < place) & (place < high)))
        names_room = any(name.text in room.name for room in plan.rooms)
        if is_within and not names_room and not any(f.contains(Point(*place)) for f in floors):
            yield name.text


def _is_several(texts: Sequence[str], kinds: Sequence[RoomKind]) -> bool:
    """Whether what is printed in a room is of more rooms than an open plan has parts.

    kinds: that the names among the texts say.
    """
    measures = [m for m in map(parse_measure, texts) if m is not None]
    sizes = distinct([measure for measure in measures if measure.kind == "size"])
    areas = distinct([measure for measure in measures if measure.kind == "area"])
    separate = sum(kind in _OWN_ROOM for kind in kinds)
    return (
        max(len(sizes), len(areas)) > 1
        or len(kinds) >= _MOST_NAMES
        or (separate > 0 and len(kinds) > 1)
    )


def _cut_sides(regions: Regions, polygons_px: Sequence[FloatArray]) -> list[str]:
    """Edges of the picture that walls run out of, but for walls of rooms that end there, and
    edges that rooms lie open to."""
    margin = max(4, round(0.012 * min(regions.solid.shape)))
    reach = margin + round(_WALLS_NEAR * regions.thickness_px)
    # Each edge as the upper one of a picture turned round.
    turns = {"upper": 0, "right": 1, "lower": 2, "left": 3}
    cut = []
    for name, turn in turns.items():
        walls = np.rot90(regions.solid, turn)
        strip, closed = walls[:margin].any(axis=0), walls[:reach].any(axis=0)
        if strip.mean() >= 1 - _CUT_SHARE:
            continue
        loose, shape = strip.copy(), regions.solid.shape
        spans = [_beside_upper(_turned(p, turn, shape), reach) for p in polygons_px]
        for first, last in (span for span in spans if span is not None):
            loose[max(first - reach, 0) : last + reach] = False
            if last - first > reach and closed[first:last].mean() < _CLOSED_SHARE:
                loose[first:last] = True
        if loose.any():
            cut.append(name)
    return cut


def _turned(polygon_px: FloatArray, turn: int, shape: tuple[int, ...]) -> FloatArray:
    """A polygon (N, 2) where numpy.rot90 lays its picture's pixels."""
    height, width = shape[:2]
    for _ in range(turn):
        polygon_px = np.stack([polygon_px[:, 1], width - polygon_px[:, 0]], axis=1)
        height, width = width, height
    return polygon_px


def _beside_upper(polygon_px: FloatArray, reach: float) -> tuple[int, int] | None:
    """First and last column of a polygon's corners within reach of the upper edge."""
    beside = polygon_px[polygon_px[:, 1] < reach, 0]
    return (max(round(beside.min()), 0), max(round(beside.max()), 0)) if len(beside) else None
