"""Any other drawing -> Plan, by what a network sees on the page.

The network says of each pixel what is built there, and finds rooms among furniture, dimension lines
and pages of text (seen.py). What is printed gives rooms their kinds, and the scale.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import Any

import numpy as np
import shapely
from shapely.geometry import Polygon

from chord_usd.base.errors import PlanError
from chord_usd.base.runtime.locations import checkpoint_folder
from chord_usd.base.scene.drawn_pieces import DRAWN, to_entry
from chord_usd.base.scene.geometry import footprint, room_polygon
from chord_usd.base.scene.room_areas import scale_by_home, scale_by_rooms
from chord_usd.base.scene.stair_places import DRAWN_STAIRS
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    BoolArray,
    ByteArray,
    FloatArray,
    Item,
    PixelFrame,
    Plan,
    Room,
    RoomKind,
    frozen_array,
)
from chord_usd.base.scene.units import cm_from_m, m_from_px, px_from_m
from chord_usd.base.scene.wet_rooms import with_wet_kinds
from chord_usd.base.terms import with_step
from chord_usd.line.plan.doubts import (
    doubts,
    doubts_of_sizes,
    is_all_guessed,
    named_rooms,
    refuse_nonsense,
)
from chord_usd.line.plan.false_borders import NICHES, without_false_borders, without_pieces
from chord_usd.line.plan.fitted import Fit, fit
from chord_usd.line.plan.floor_parts import part_floors, too_small
from chord_usd.line.plan.home_graph import (
    of_dwelling,
    of_dwellings,
    said_of,
    uses_of_dwellings,
    work_names,
)
from chord_usd.line.plan.home_uses import Floor, named_pieces, speaking, uses_of_home
from chord_usd.line.plan.labels import named_by_texts, numbered, seen_as, texts_in, uses_named
from chord_usd.line.plan.lifts import without_lifts
from chord_usd.line.plan.parts import parts_of
from chord_usd.line.plan.placement import DRAWING, WARNINGS, placement
from chord_usd.line.plan.printed import STATED, Estimate, estimates
from chord_usd.line.plan.regions import is_stairwell, stair_outlines
from chord_usd.line.plan.scale_choice import SCALE, Scale, choose_scale
from chord_usd.line.plan.seen import Reader, SeenReading, read_seen
from chord_usd.line.plan.seen_kinds import SeenKinds, seen_kinds
from chord_usd.line.plan.seen_pieces import SeenPiece, found_on, pieces_within, with_needed
from chord_usd.line.plan.segment import READER_CHECKPOINT, PageReader, Segments, load_reader
from chord_usd.line.plan.sheet import Sheet, ink_of, on_white, prepare
from chord_usd.line.plan.storey_titles import titled
from chord_usd.line.plan.text import Text, read_texts, warm_up
from chord_usd.line.plan.verdict import JOINED
from chord_usd.line.plan.ways_in import (
    with_rooms_shut,
    with_ways_in,
    without_doors_onto_baths,
    without_scraps,
)

_REREAD = math.log(1.1)
"""A scale that turns out so far from the assumed one changes what is a room and what a cupboard."""
_READINGS = 2
_LEAST_FITTED = 3
"""Of two measures that agree neither says which walls are off."""

_BESIDE_SHARE = 0.3
"""Of a plan's longer side: dimensions stand so near to it."""

_SHOWS = "the sheet shows "

_MOST_PLANS = 12
"""Of one sheet."""


@dataclass(frozen=True, eq=False)
class Known:
    """What is known of a picture beside its pixels."""

    texts: tuple[Text, ...] = ()
    """What is printed on it; empty where that has to be read from the pixels, too."""
    stated_m_per_px: float | None = None
    """By a scale such as 1:100 and the size of the paper."""
    paper_m_per_px: float | None = None
    """Of the sheet of paper, whatever its scale is."""
    is_open: bool = False
    """Whether it shows the outer walls of a home, whose rooms are planned later."""


def read_drawing(
    rgb: ByteArray,
    m_per_px: float | None = None,
    part: int = 1,
    known: Known | None = None,
    reader: Reader | None = None,
) -> Plan:
    """The plan in a drawing, RGB (H, W, 3).

    m_per_px: of the picture as given; without it printed measures, doors (0.8 m) or else the walls
    (0.24 m) give the scale. part: which plan of a sheet with several, the largest being 1. reader:
    whoever sees what is built; by default the network of the checkpoint.
    Raises CheckpointError, and PlanError where no closed room is found, or what was found cannot be
    a house.
    """
    return _read_part(_page(rgb, m_per_px, part, known, reader)).plan


def read_sheet(
    rgb: ByteArray, m_per_px: float | None = None, known: Known | None = None
) -> list[tuple[Plan, str]]:
    """All plans of a sheet with what each is titled, as storeys of one house: the lowest first,
    all at the scale of the one that is surest of its own.

    Without titles the largest is the lowest. Raises CheckpointError, and PlanError.
    """
    page = replace(_page(rgb, m_per_px, 1, known, None), is_home=False)
    parts = list(_all_parts(page))
    if m_per_px is None and len(parts) > 1:
        surest = max(parts, key=lambda part: part.plan.extra[SCALE]["confidence"])
        scaled = replace(page, m_per_px=surest.plan.extra[SCALE]["mPerPx"])
        parts = list(_all_parts(scaled))
    titles = titled([part.bounds_px for part in parts], page.texts)
    rows = [
        (title[0] if title else 0.5 * index, index, _alone(part.plan), title[1] if title else "")
        for index, (part, title) in enumerate(zip(parts, titles, strict=True))
    ]
    return [(plan, title) for _, _, plan, title in sorted(rows, key=lambda row: row[:2])]


def _alone(plan: Plan) -> Plan:
    """A plan without the warning that the sheet shows others."""
    warnings = [line for line in plan.extra.get(WARNINGS, ()) if not line.startswith(_SHOWS)]
    rest = {key: value for key, value in plan.extra.items() if key != WARNINGS}
    return replace(plan, extra={**rest, **({WARNINGS: warnings} if warnings else {})})


def _all_parts(page: _Page) -> Iterator[_Found]:
    """The plans of a sheet, the largest first. Raises PlanError where the first cannot be read."""
    for part in range(1, _MOST_PLANS + 1):
        try:
            yield _read_part(replace(page, part=part))
        except NoSuchPartError:
            return
        except PlanError:
            if part == 1:
                raise


def _page(
    rgb: ByteArray,
    m_per_px: float | None,
    part: int,
    known: Known | None,
    reader: Reader | None,
) -> _Page:
    known = known or Known()
    # Loading is Python's work, straightening OpenCV's: they go side by side.
    with ThreadPoolExecutor(1) as aside:
        if not known.texts:
            aside.submit(warm_up)
        sheet = prepare(rgb)
    light = on_white(sheet.rgb)
    segments = (reader or _reader()).read(light)
    texts = _texts(sheet, known)
    return _Page(sheet, segments, texts, m_per_px, part, known, not known.is_open)


@dataclass(frozen=True, eq=False)
class _Page:
    """A sheet, and what is known of it."""

    sheet: Sheet
    segments: Segments
    """What the network sees on it."""
    texts: tuple[Text, ...]
    m_per_px: float | None
    part: int
    known: Known = Known()
    is_home: bool = True
    """Whether the sheet's plan is all of a home, and no storey of one."""

    @property
    def given(self) -> float | None:
        """Metres per pixel of the working picture, if the user gave a scale."""
        return self.m_per_px and self.m_per_px / self.sheet.shrink

    @cached_property
    def ink(self) -> BoolArray:
        """(H, W) what is drawn."""
        return ink_of(on_white(self.sheet.rgb))


@dataclass(frozen=True, eq=False)
class _Found:
    """A plan of a sheet."""

    plan: Plan
    bounds_px: FloatArray
    """(2, 2) lowest and highest corner on the working picture."""


class NoSuchPartError(PlanError):
    """A sheet shows fewer plans than were asked for."""


def _read_part(page: _Page) -> _Found:
    """One plan of a sheet, with its scale, names and doubts. Raises PlanError."""
    reading, warnings = _taken(read_seen(page.segments, page.given), page)
    scale = _scale(reading, page)
    for _ in range(_READINGS):
        if abs(math.log(scale.m_per_px / reading.frame.m_per_px)) <= _REREAD:
            break
        reading, warnings = _taken(reading.again(scale.m_per_px), page)
        # What is a room says, in turn, which printed sizes are heard.
        again = _scale(reading, page)
        scale = again if again.is_printed else scale
    several = any(line.startswith(_SHOWS) for line in warnings)
    page = replace(page, is_home=page.is_home and not several)
    seen_pieces = found_on(page.sheet, scale.m_per_px)
    reading = _without_pieces(reading, page, scale.m_per_px, seen_pieces)
    reading, shown = _without_lifts(reading, page, scale.m_per_px)
    drawn_px = _drawn_px(seen_pieces, reading, page, scale.m_per_px)
    baths_px = [outline for name, outline in drawn_px if name in NICHES]
    reading = without_doors_onto_baths(reading, scale.m_per_px, baths_px)
    reading = with_ways_in(reading, scale.m_per_px, [outline for _, outline in drawn_px])
    fitted = _fitted(reading, page, scale) if scale.is_printed else None
    if fitted is not None:
        reading, scale = reading.with_fit(fitted), replace(scale, m_per_px=fitted.m_per_px)
    frame = replace(reading.frame, m_per_px=scale.m_per_px)
    refuse_nonsense(reading.polygons_px, reading.regions, frame)
    seen = seen_kinds(page.segments.kinds, frame)
    pieces = pieces_within(seen_pieces, reading, page.sheet, frame)
    plan, parted = _plan(reading, page, frame, _Seen(seen, pieces))
    faint = pieces_within(seen_pieces, reading, page.sheet, frame, is_sure=False)
    # What is faint says of no room what it is.
    with_kinds = with_wet_kinds(replace(plan, extra={DRAWN: to_entry(pieces)}))
    pieces = with_needed(pieces, faint, with_kinds.rooms)
    if is_all_guessed(plan):
        raise _no_room()
    sheet = page.sheet
    drawing = PixelFrame(scale.m_per_px * sheet.shrink, (0.0, 0.0), sheet.height_px)
    rooms = named_rooms(plan, page.texts, frame)
    warnings += [
        *shown,
        *scale.warnings(),
        *(doubts_of_sizes(plan, fitted, frame) if fitted is not None else ()),
        *doubts(plan, reading.regions, rooms, frame),
        *parted,
    ]
    entry = {**placement(drawing)[DRAWING], **sheet.straightening.entry()}
    stairs = _stairs(plan, page, frame)
    extra: dict[str, Any] = {DRAWING: entry, SCALE: scale.report(sheet.shrink)}
    extra |= {DRAWN_STAIRS: stairs} if stairs else {}
    extra |= {DRAWN: to_entry(pieces)} if pieces else {}
    extra |= {JOINED: reading.joined} if reading.joined else {}
    plan = replace(plan, extra={**extra, **({WARNINGS: warnings} if warnings else {})})
    corners = np.concatenate(reading.polygons_px)
    bounds = np.array([corners.min(axis=0), corners.max(axis=0)])
    return _Found(plan, bounds)


def _texts(sheet: Sheet, known: Known) -> tuple[Text, ...]:
    """What is printed, in pixels of the working picture."""
    if known.texts and not sheet.straightening.entry():
        return tuple(replace(t, corners_px=t.corners_px * sheet.shrink) for t in known.texts)
    return tuple(
        replace(text, corners_px=text.corners_px / sheet.fine_per_px)
        for text in read_texts(on_white(sheet.fine))
    )


@cache
def _reader() -> PageReader:
    return load_reader(checkpoint_folder(READER_CHECKPOINT))


def _no_room() -> PlanError:
    return PlanError(
        "no closed room was found",
        expected="a floor plan: rooms seen from above, with walls round them",
        try_="a clearer picture, cut to one floor",
    )


def _take_part(reading: SeenReading, part: int) -> tuple[SeenReading, list[str]]:
    """One plan of the sheet, and what to say if there are more. Raises PlanError."""
    if not reading.outlines:
        raise _no_room()
    parts = parts_of(reading.polygons_px, reading.regions)
    if part > len(parts):
        raise NoSuchPartError(
            f"part {part} was asked for, but the sheet shows {len(parts)}",
            expected=f"<part> from 1 to {len(parts)}" if len(parts) > 1 else "no <part>",
        )
    chosen = reading.of(parts[part - 1])
    if len(parts) == 1:
        return chosen, []
    which = "the largest was taken" if part == 1 else f"number {part} by size was taken"
    return chosen, [with_step(f"{_SHOWS}{len(parts)} plans; {which}", ", <part> takes another")]


def _taken(reading: SeenReading, page: _Page) -> tuple[SeenReading, list[str]]:
    """The plan that was asked for, with floors joined that no wall parts, and what to say of
    others. Raises PlanError."""
    whole = without_false_borders(reading, _are_named(reading, page))
    chosen, lines = _take_part(whole, page.part)
    left, said = without_scraps(chosen, _are_named(chosen, page))
    return left, [*lines, *said]


def _without_pieces(
    reading: SeenReading, page: _Page, m_per_px: float, seen_pieces: Sequence[SeenPiece]
) -> SeenReading:
    """With floors joined to others that are furniture, or niches of baths."""
    frame = replace(reading.frame, m_per_px=m_per_px)
    pieces = pieces_within(seen_pieces, reading, page.sheet, frame)
    whole = without_pieces(reading, _are_named(reading, page), pieces, frame)
    return reading if whole is reading else _take_part(whole, page.part)[0]


def _drawn_px(
    seen_pieces: Sequence[SeenPiece], reading: SeenReading, page: _Page, m_per_px: float
) -> list[tuple[str, Polygon]]:
    """Category and footprint, in pixels of the working picture, of the surely drawn pieces."""
    frame = replace(reading.frame, m_per_px=m_per_px)
    pieces = pieces_within(seen_pieces, reading, page.sheet, frame)
    return [(piece.category, Polygon(px_from_m(footprint(piece.box), frame))) for piece in pieces]


def _without_lifts(
    reading: SeenReading, page: _Page, m_per_px: float
) -> tuple[SeenReading, list[str]]:
    rooms = _named_rooms(reading, page, reading.frame)
    texts = [texts_in(room, page.texts, reading.frame) for room in rooms]
    return without_lifts(reading, rooms, texts, page.ink, m_per_px)


def _are_named(reading: SeenReading, page: _Page) -> list[bool]:
    """Whether a name, or a stair, says what each room is for."""
    return [room.kind != "unknown" for room in _named_rooms(reading, page, reading.frame)]


def _fitted(reading: SeenReading, page: _Page, scale: Scale) -> Fit:
    """Walls where printed sizes put them, which say the scale, too."""
    polygons = reading.polygons_px
    texts, thickness = _beside(page.texts, polygons), reading.regions.thickness_px
    moves = scale.count >= _LEAST_FITTED
    return fit(polygons, reading.openings, texts, scale.m_per_px, thickness, moves)


def _scale(reading: SeenReading, page: _Page) -> Scale:
    polygons = reading.polygons_px
    printed = estimates(_beside(page.texts, polygons), polygons, page.ink)
    known, shrink = page.known, page.sheet.shrink
    if known.stated_m_per_px:
        printed.append(Estimate(STATED, known.stated_m_per_px / shrink, "1:n"))
    paper = known.paper_m_per_px and known.paper_m_per_px / shrink
    walls = WALL_THICKNESS_M / max(reading.regions.thickness_px, 1.0)
    rooms = _named_rooms(reading, page, reading.frame)
    kinds = [
        uses.kind
        for uses in uses_of_home(_floors(reading, page, rooms, reading.frame), page.is_home)
    ]
    areas = [Polygon(polygon).area for polygon in polygons]
    # Of an open plan, the floor is that of a whole home.
    usual = scale_by_home(areas) if known.is_open else scale_by_rooms(kinds, areas)
    doors = reading.entrance_m_per_px if known.is_open else reading.doors_m_per_px
    return choose_scale(printed, doors, walls, page.given, usual, paper)


def _beside(texts: Sequence[Text], polygons_px: Sequence[FloatArray]) -> list[Text]:
    """Texts in a plan or near it: what else is printed may be of another drawing."""
    corners = np.concatenate(polygons_px)
    low, high = corners.min(axis=0), corners.max(axis=0)
    reach = _BESIDE_SHARE * float((high - low).max())
    return [
        text
        for text in texts
        if bool(np.all((low - reach < text.center_px) & (text.center_px < high + reach)))
    ]


def _plan(
    reading: SeenReading, page: _Page, frame: PixelFrame, seen: _Seen
) -> tuple[Plan, list[str]]:
    """Rooms with what they are for, and the openings in their walls; what to say of their parts."""
    named = _named_rooms(reading, page, frame)
    floors = _floors(reading, page, named, frame, seen)
    banned: set[tuple[int, RoomKind]] = set()
    seen_ways = [o for o in reading.openings if not o.is_guess]
    floors, whose = of_dwellings(floors, [[room for room, _ in o.rooms] for o in seen_ways
                                          if o.kind != "window"])  # fmt: skip
    work = work_names([t.text for room in named for t in texts_in(room, page.texts, frame)])
    while True:
        uses = uses_of_dwellings(floors, whose, page.is_home and not work, banned)
        rooms = numbered([
            of_dwelling(seen_as(room, each.kind, each.chance), number, whose)
            for room, each, number in zip(named, uses, whose, strict=True)
        ])  # fmt: skip
        placed = reading.placed([room.id for room in rooms], frame)
        openings = with_rooms_shut([opening for opening in placed if opening.room_ids], rooms)
        plan = Plan(rooms, openings)
        if page.known.is_open:
            return plan, []
        spots = {room.id: uses_named(room, page.texts, frame) for room in rooms}
        parted, lines, failed = part_floors(plan, uses, spots, seen.kinds, seen.pieces)
        failed |= too_small(parted, rooms, named)
        if failed <= banned:
            return parted, [*said_of(parted, work), *lines]
        banned |= failed


@dataclass(frozen=True, eq=False)
class _Seen:
    """What a drawing of known scale shows on its floors."""

    kinds: SeenKinds
    pieces: Sequence[Item]


def _stairs(plan: Plan, page: _Page, frame: PixelFrame) -> list[list[list[float]]]:
    """The stairs seen in the plan's rooms: corners, centimetres."""
    house = shapely.union_all([room_polygon(room) for room in plan.rooms])
    outlines = [m_from_px(o, frame) for o in stair_outlines(page.segments, frame.m_per_px)]
    return [
        [[round(cm_from_m(at), 1) for at in corner] for corner in outline]
        for outline in outlines
        if Polygon(outline).intersection(house).area > 0.5 * Polygon(outline).area
    ]


def _named_rooms(reading: SeenReading, page: _Page, frame: PixelFrame) -> list[Room]:
    """Rooms with what their names, and stairs, say that they are for."""
    outlined = [
        Room(
            "",
            "unknown",
            frozen_array(m_from_px(o.polygon_px, frame)),
            extra=o.extra(frame.m_per_px),
        )
        for o in reading.outlines
    ]
    return [
        replace(room, kind="corridor") if room.kind == "unknown" and is_stairwell(outline) else room
        for room, outline in zip(
            named_by_texts(outlined, page.texts, frame), reading.outlines, strict=True
        )
    ]


def _floors(
    reading: SeenReading,
    page: _Page,
    rooms: Sequence[Room],
    frame: PixelFrame,
    seen: _Seen | None = None,
) -> list[Floor]:
    """What is known of the floor of each room. seen: of the drawing, where its scale is known."""
    has_windows = any(opening.kind == "window" for opening in reading.openings)
    floors = []
    for index, (room, outline) in enumerate(zip(rooms, reading.outlines, strict=True)):
        room_openings = [
            o for o in reading.openings if index in [at for at, _ in o.rooms] and not o.is_guess
        ]
        polygon = room_polygon(room)
        named = uses_named(room, page.texts, frame)
        floors.append(
            Floor(
                outline.kinds, room.kind, frozenset(use.kind for use in named),
                polygon.area if seen else None, seen.kinds.areas_m2(polygon) if seen else {},
                speaking(seen.pieces if seen else (), polygon)
                | named_pieces(text.text for text in texts_in(room, page.texts, frame)),
                sum(o.kind != "window" and len(o.rooms) == 2 for o in room_openings),
                any(o.kind == "door" and len(o.rooms) == 1 for o in room_openings),
                not has_windows or any(o.kind == "window" for o in room_openings), outline.stairs,
            )
        )  # fmt: skip
    return floors
