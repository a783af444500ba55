"""Names and kinds of rooms, from what is printed in them and from what is drawn there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from shapely.geometry import Point

from chord_usd.plan.measures import parse_measure
from chord_usd.plan.text import Text
from chord_usd.scene.geometry import room_polygon
from chord_usd.scene.room_names import LEADING, room_kind
from chord_usd.scene.types import PixelFrame, Room, RoomKind
from chord_usd.scene.units import m_from_px

KIND_CONFIDENCE = "kindConfidence"
"""Key of Room.extra: how well its name was legible, or the drawing tells its kind, [0, 1]."""


def label_rooms(
    rooms: Sequence[Room],
    texts: Sequence[Text],
    frame: PixelFrame,
    seen: Sequence[tuple[RoomKind, float]] = (),
) -> tuple[Room, ...]:
    """The rooms with their kinds and names. texts: of the picture that lies in frame.

    seen: each room's kind by what is drawn in it, and how sure that is, which counts where no name
    is printed. Ids are by kind where a kind was read (bedroom1), as those of a plan raster are.
    """
    labelled = [_labelled(room, texts_in(room, texts, frame)) for room in rooms]
    if seen:
        labelled = [_seen(room, *kind) for room, kind in zip(labelled, seen, strict=True)]
    counts: dict[RoomKind, int] = {}
    named = []
    for room in labelled:
        counts[room.kind] = counts.get(room.kind, 0) + 1
        stem = "room" if room.kind == "unknown" else room.kind
        named.append(replace(room, id=f"{stem}{counts[room.kind]}"))
    return tuple(named)


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
    found: set[RoomKind] = {kind for kind in kinds.values() if kind != "unknown"}
    if not found and len(names) > 1 and room_kind(joined) != "unknown":
        kinds = {joined: room_kind(joined)}
        found = set(kinds.values())
    if not found:
        return room
    kind = min(found, key=LEADING.index)
    score = min((t.score for t in names if kinds.get(t.text) == kind), default=names[0].score)
    spoken = [name for name, said in kinds.items() if said != "unknown"]
    extra = {**room.extra, KIND_CONFIDENCE: round(score, 2)}
    return replace(room, kind=kind, name=", ".join(spoken), extra=extra)


def _seen(room: Room, kind: RoomKind, confidence: float) -> Room:
    if room.kind == "unknown" and kind != "unknown":
        return replace(room, kind=kind, extra={**room.extra, KIND_CONFIDENCE: confidence})
    return room


def _is_measure_alone(text: str) -> bool:
    return parse_measure(text) is not None and room_kind(text) == "unknown"
