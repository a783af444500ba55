"""Names and kinds of rooms, from what is printed in them and from what is drawn there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from shapely.geometry import Point, Polygon

from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.room_names import LEADING, room_kind, room_kinds
from chord_usd.base.scene.types import PixelFrame, Room, RoomKind
from chord_usd.base.scene.units import m_from_px
from chord_usd.line.plan.measures import parse_measure
from chord_usd.line.plan.open_plans import Use, can_share
from chord_usd.line.plan.text import Text

KIND_CONFIDENCE = "kindConfidence"
"""Key of Room.extra: how well its name was legible, or the drawing shows its kind, [0, 1]."""

_BESIDE_M = 1.3
"""A name no farther from a room than this may be its."""


def named_by_texts(rooms: Sequence[Room], texts: Sequence[Text], frame: PixelFrame) -> list[Room]:
    """The rooms with the names that are printed in them, or else beside them, and the kinds that
    those say. texts: of the picture that lies in frame."""
    inside = [texts_in(room, texts, frame) for room in rooms]
    labelled = [_labelled(room, room_texts) for room, room_texts in zip(rooms, inside, strict=True)]
    taken = {id(text) for room_texts in inside for text in room_texts}
    outside = [text for text in texts if id(text) not in taken and room_kinds(text.text)]
    for text in outside:
        index = _beside(text, labelled, frame)
        if index is not None:
            labelled[index] = _labelled(labelled[index], [text])
    return labelled


def _beside(text: Text, rooms: Sequence[Room], frame: PixelFrame) -> int | None:
    """The nameless room that a name stands next to, as it does where a room is too small for it.

    What is open to the sky has its name where it is, though no room was seen there.
    """
    if room_kind(text.text) == "balcony":
        return None
    around = Polygon(m_from_px(text.corners_px, frame)).convex_hull
    away = {
        index: room_polygon(room).distance(around)
        for index, room in enumerate(rooms)
        if room.kind == "unknown"
    }
    nearest = min(away, key=lambda index: away[index], default=None)
    return nearest if nearest is not None and away[nearest] < _BESIDE_M else None


def numbered(rooms: Sequence[Room]) -> tuple[Room, ...]:
    """The rooms with ids as a plan raster has: by kind where a kind is known (bedroom1)."""
    counts: dict[RoomKind, int] = {}
    rooms_with_ids = []
    for room in rooms:
        counts[room.kind] = counts.get(room.kind, 0) + 1
        stem = "room" if room.kind == "unknown" else room.kind
        rooms_with_ids.append(replace(room, id=f"{stem}{counts[room.kind]}"))
    return tuple(rooms_with_ids)


def seen_as(room: Room, kind: RoomKind, confidence: float) -> Room:
    """A room without a name as the kind that is drawn there, and how sure that is."""
    if room.kind == "unknown" and kind != "unknown":
        return replace(room, kind=kind, extra={**room.extra, KIND_CONFIDENCE: confidence})
    return room


def uses_named(room: Room, texts: Sequence[Text], frame: PixelFrame) -> list[Use]:
    """What the names that are printed in a room say that its floor is used for, and where."""
    names: dict[RoomKind, list[Text]] = {}
    for text in texts_in(room, texts, frame):
        kinds = [kind for kind in room_kinds(text.text) if can_share(kind)]
        for kind in kinds:
            # Where each part of a "Living Kitchen" is, its name does not say.
            names.setdefault(kind, []).extend([text] if len(kinds) == 1 else [])
    return [
        Use(kind, tuple(t.text for t in kind_texts), tuple(_spot_m(t, frame) for t in kind_texts))
        for kind, kind_texts in names.items()
    ]


def _spot_m(text: Text, frame: PixelFrame) -> tuple[float, float]:
    x, y = m_from_px(text.center_px, frame)
    return float(x), float(y)


def texts_in(room: Room, texts: Sequence[Text], frame: PixelFrame) -> list[Text]:
    """What is printed in a room."""
    floor = room_polygon(room)
    return [text for text in texts if floor.contains(Point(*m_from_px(text.center_px, frame)))]


def _labelled(room: Room, texts: Sequence[Text]) -> Room:
    """The room with the leading kind among its texts; a name in two lines is one name, too."""
    if room.kind != "unknown":
        return room
    names = [text for text in texts if not _is_measure_alone(text.text)]
    joined = " ".join(text.text for text in names)
    kinds: dict[str, RoomKind] = {text.text: room_kind(text.text) for text in names}
    known: set[RoomKind] = {kind for kind in kinds.values() if kind != "unknown"}
    if not known and len(names) > 1 and room_kind(joined) != "unknown":
        kinds = {joined: room_kind(joined)}
        known = set(kinds.values())
    if not known:
        return room
    kind = min(known, key=LEADING.index)
    score = min((t.score for t in names if kinds.get(t.text) == kind), default=names[0].score)
    spoken = [name for name, said in kinds.items() if said != "unknown"]
    extra = {**room.extra, KIND_CONFIDENCE: round(score, 2)}
    return replace(room, kind=kind, name=", ".join(spoken), extra=extra)


def _is_measure_alone(text: str) -> bool:
    return parse_measure(text) is not None and room_kind(text) == "unknown"
