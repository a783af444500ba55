"""Names and kinds of rooms, from what is printed in them and from what is fitted there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from shapely.geometry import Point

from chord_usd.geometry import room_polygon
from chord_usd.plan.measures import parse_measure
from chord_usd.plan.text import Text
from chord_usd.room_names import room_kind
from chord_usd.types import PixelFrame, Room, RoomKind
from chord_usd.units import m_from_px

KIND_CONFIDENCE = "kindConfidence"
"""Key of Room.extra: how well its name was legible, or fixtures tell its kind, [0, 1]."""

_BY_FIXTURES = 0.7

_LEADING: tuple[RoomKind, ...] = (
    "living", "bedroom", "kitchen", "bathroom", "dining", "study", "balcony", "store", "corridor",
)  # fmt: skip
"""The kind of an open plan is that of its leading part; a wardrobe in a bedroom is no store."""


def label_rooms(
    rooms: Sequence[Room], texts: Sequence[Text], frame: PixelFrame, fitted: Sequence[RoomKind] = ()
) -> tuple[Room, ...]:
    """The rooms with their kinds and names. texts: of the picture that lies in frame.

    fitted: each room's kind by what stands in it, which counts where no name is printed. Ids are by
    kind where a kind was read (bedroom1), as those of a plan raster are.
    """
    kinds: Sequence[RoomKind] = fitted or ["unknown"] * len(rooms)
    labelled = [
        _fitted(_labelled(room, texts_in(room, texts, frame)), kind)
        for room, kind in zip(rooms, kinds, strict=True)
    ]
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
    kind = min(found, key=_LEADING.index)
    score = min((t.score for t in names if kinds.get(t.text) == kind), default=names[0].score)
    spoken = [name for name, said in kinds.items() if said != "unknown"]
    extra = {**room.extra, KIND_CONFIDENCE: round(score, 2)}
    return replace(room, kind=kind, name=", ".join(spoken), extra=extra)


def _fitted(room: Room, kind: RoomKind) -> Room:
    if room.kind == "unknown" and kind != "unknown":
        return replace(room, kind=kind, extra={**room.extra, KIND_CONFIDENCE: _BY_FIXTURES})
    return room


def _is_measure_alone(text: str) -> bool:
    return parse_measure(text) is not None and room_kind(text) == "unknown"
