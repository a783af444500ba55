"""Which rooms and pieces of a house the nouns of a clause mean."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence

from chord_usd.base.metrics.complete import table_of
from chord_usd.base.scene.geometry import footprint_polygon, front_direction, room_polygon
from chord_usd.base.scene.intents import COMPASS_DEG, Coat
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.types import (
    ROOM_KINDS,
    WET_KINDS,
    Item,
    Room,
    RoomKind,
    SceneGraph,
)
from chord_usd.line.lists.clauses import WHERE, Clause, Noun, not_understood
from chord_usd.line.lists.coat_words import WOODS
from chord_usd.line.lists.edit_words import SEATED_AT, Token
from chord_usd.line.lists.vocabulary import HERE
from chord_usd.line.lists.wishes import SLACK_M, rooms_meant

_BY_M = 0.6
"""What is farther from a piece does not stand by it."""

ROOM_TOO = "the room, too"
"""What is expected of a sentence that may mean several rooms."""


class Referents:
    """Looks for what is meant, in the house and in what was said before."""

    def __init__(self, graph: SceneGraph, rooms: Mapping[str, Room]) -> None:
        """rooms: by the names of their prims, named as people call them."""
        self._graph, self._rooms = graph, rooms
        self._things = (*graph.items, *graph.dressing)
        self._name_of = {room.id: room.name or name for name, room in rooms.items()}
        self._kinds: dict[str, RoomKind] = {room.id: room.kind for room in graph.rooms}
        self.room_said = ""
        """Id of the room last spoken of."""
        self.last: tuple[str, ...] = ()
        """Ids of the pieces last spoken of."""

    def answer(self, tokens: Sequence[Token]) -> str:
        """What the house has of the things that a question names, in the rooms that it names."""
        said = [token.value for token in tokens if token.kind == "room"]
        rooms = [room.id for name in said for room in rooms_meant(name, self._rooms, WHERE)]
        lines = []
        for token in tokens:
            if token.thing is not None:
                items = self.there(Noun(token.thing, token.said), rooms)
                counts = Counter(self.name(item.room_id) for item in items)
                places = [f"{count} in {room}" for room, count in counts.items()]
                lines.append(f"{token.thing.word}: {', '.join(places) or 'none there'}")
        if not lines:
            lines = [f"{self.name(room)} has {self._inventory(room)}" for room in rooms]
        return "; ".join(dict.fromkeys(lines)) or "it names no piece and no room of this house"

    def _inventory(self, room_id: str) -> str:
        """What furniture a room has, in words."""
        categories = [item.category for item in self._graph.items if item.room_id == room_id]
        counts = Counter(name.replace("_", " ") for name in categories)
        return ", ".join(f"{count} × {name}" for name, count in counts.items()) or "no furniture"

    def home_of(self, clause: Clause) -> str:
        """Id of the room where new pieces usually go: the only one of its kind, or the largest
        that has none of them, or the living room; "" where there is none."""
        rows = [category(noun.thing.categories[0]) for noun in clause.nouns]
        if any(row.mount is Mount.WINDOW for row in rows):
            return ""  # of which windows, nobody said
        kinds = {row.rooms for row in rows[:1]}  # "a dining table with six chairs"
        homes = {rooms[0] for rooms in kinds if set(rooms) < set(ROOM_KINDS)}
        suitable = [
            room_id
            for room_id, kind in self._kinds.items()
            if kind in homes and room_id in self._name_of
        ]
        if len(homes) != 1 or len(kinds) != 1:
            return ""
        first = clause.nouns[:1]
        lacking = [
            room_id for room_id in suitable
            if len(suitable) == 1 or not any(self.there(noun, [room_id]) for noun in first)
        ]  # fmt: skip
        if not lacking and all("living" in rooms for rooms in kinds):
            lacking = [room_id for room_id in self._name_of if self._kinds[room_id] == "living"]
        area = {room.id: room_polygon(room).area for room in self._rooms.values()}
        return max(lacking, key=area.__getitem__, default="")

    def all_rooms(self, coat: Coat | None = None) -> list[str]:
        """Ids of all rooms of the house, where none is named; balconies keep their surfaces, and
        rooms with water get no wood."""
        kept = {"balcony"} if coat else set()
        kept |= set(WET_KINDS) if coat and coat.material in (*WOODS, "wood") else set()
        return [room_id for room_id in self._name_of if self._kinds[room_id] not in kept]

    def wall_named(self, anchor: str, item: Item) -> str:
        """The wall that an anchor means, where it depends on a piece: the one before its front."""
        if anchor != "opposite wall":
            return anchor
        front = front_direction(item.box.yaw_deg)
        return max(COMPASS_DEG, key=lambda way: float(
            front @ (math.cos(math.radians(COMPASS_DEG[way])),
                     math.sin(math.radians(COMPASS_DEG[way]))))) + " wall"  # fmt: skip

    def rooms_of(self, clause: Clause, *preps: str) -> list[str]:
        """Ids of the rooms that a clause names with one of these prepositions."""
        ids = []
        for prep, said in clause.rooms:
            if prep in preps:
                ids += [room.id for room in rooms_meant(said, self._rooms, WHERE)]
        if clause.is_there and not ids and "in" in preps and self.room_said:
            ids.append(self.room_said)
        return ids

    def rooms_for(self, clause: Clause, following: Sequence[Clause], *preps: str) -> list[str]:
        """The same; where it names none, what the clauses without a verb that follow name."""
        ids = self.rooms_of(clause, *preps)
        for later in following if not ids else ():
            if later.verb or later.coat:
                break
            ids = self.rooms_of(later, *preps)
            if ids:
                break
        return ids

    def there(self, noun: Noun, rooms: Sequence[str], *, but: Sequence[str] = ()) -> list[Item]:
        """Pieces of the house that a noun means, in these rooms or in any."""
        items = [
            item for item in self._things if item.category in self.categories(noun, item.room_id)
        ]
        least, most = noun.thing.length_m
        items = [item for item in items if least - SLACK_M <= item.box.size_m[0] <= most + SLACK_M]
        kind = SEATED_AT.get(noun.thing.word)
        if kind:
            tables = {item.id: table_of(item, self._things) for item in items}
            items = [item for item in items if (at := tables[item.id]) and at.category == kind]
        return [
            item for item in items if (not rooms or item.room_id in rooms) and item.id not in but
        ]

    def categories(self, noun: Noun, room_id: str) -> tuple[str, ...]:
        kind = self._kinds.get(room_id, "unknown")
        here = HERE.get(kind, {}).get(noun.thing.word)
        return (here, *noun.thing.categories) if here else noun.thing.categories

    def meant(self, clause: Clause, noun: Noun, rooms: Sequence[str]) -> list[Item]:
        """The pieces that a noun means, which are there. Raises ChordError where none or too many
        are."""
        if noun.coat or noun.form:
            looks = noun.coat.name if noun.coat else noun.form
            raise not_understood(
                clause.words, f"which '{noun.said}' is {looks} is not known here",
                "pieces by their kind and room",
            )  # fmt: skip
        items = self.there(noun, rooms)
        if not items:
            place = f"in {self.name(rooms[0])}" if rooms else "in the house"
            raise not_understood(clause.words, f"no {noun.said} {place}")
        beside = self.anchor_room(clause) if not rooms else ""
        if beside and any(item.room_id == beside for item in items):
            items = [item for item in items if item.room_id == beside]
        elif not rooms and self.room_said and any(item.room_id == self.room_said for item in items):
            items = [item for item in items if item.room_id == self.room_said]
        if not noun.is_every:
            items = self._usual(noun, items)
        if len({item.room_id for item in items}) > 1 and not noun.is_every:
            names = ", ".join(dict.fromkeys(self.name(item.room_id) for item in items))
            raise not_understood(clause.words, f"'{noun.said}' may be that of {names}", ROOM_TOO)
        return items

    def _usual(self, noun: Noun, items: Sequence[Item]) -> list[Item]:
        """Of one piece in several rooms, that of the room where such a piece belongs first, where
        the home has one such room: "the dining table" is that of the dining room."""
        if len({item.room_id for item in items}) < 2 or self.is_group(noun):
            return list(items)
        homes = category(noun.thing.categories[0]).rooms
        kinds = [kind for kind in homes[:1] if kind not in ("bedroom", "unknown")]
        usual = [item for item in items if self._kinds[item.room_id] in kinds]
        return usual if len({item.room_id for item in usual}) == 1 else list(items)

    @staticmethod
    def is_group(noun: Noun) -> bool:
        """Whether it is a plural without a number."""
        return noun.count is None and noun.said.endswith("s") and not noun.thing.word.endswith("s")

    def single(self, clause: Clause, noun: Noun, rooms: Sequence[str]) -> list[Item]:
        """The one piece that a noun means, or as many as are counted, or all of a group."""
        items = self.meant(clause, noun, rooms)
        if noun.is_every or self.is_group(noun) or len(items) == 1:
            return items
        if noun.count is not None and noun.count == len(items):
            return items
        raise not_understood(
            clause.words, f"there are {len(items)} of '{noun.said}' in "
            f"{self.name(items[0].room_id)}", "all of them, or what is there once"
        )  # fmt: skip

    def name(self, room_id: str) -> str:
        return self._name_of.get(room_id, room_id)

    def subjects(self, clause: Clause, rooms: Sequence[str]) -> list[Item]:
        """What a verb is done to: nouns, or what was spoken of before."""
        if clause.is_it and not clause.nouns:
            before = [item for item in self._things if item.id in self.last]
            if not before:
                raise not_understood(clause.words, "what is meant by 'it'?", "what the house has")
            return before
        if not clause.nouns:
            raise not_understood(clause.words, "it names no piece")
        return [item for noun in clause.nouns for item in self.single(clause, noun, rooms)]

    def anchors(self, clause: Clause, room: str, but: Sequence[str] = ()) -> tuple[str, ...]:
        """Ids of what a relation is to, and features."""
        ids: list[str] = []
        for anchor in clause.anchors:
            if isinstance(anchor, str):
                ids.append(anchor)
                continue
            items = self.there(anchor, [room] if room else [], but=but)
            if not items:
                place = f"in {self.name(room)}" if room else "in the house"
                raise not_understood(clause.words, f"no {anchor.said} {place}")
            items = items if room else self._usual(anchor, items)
            if not room and len({item.room_id for item in items}) > 1:
                names = ", ".join(dict.fromkeys(self.name(item.room_id) for item in items))
                raise not_understood(
                    clause.words, f"'{anchor.said}' may be that of {names}", ROOM_TOO
                )
            ids += [item.id for item in items]
        if clause.relation and not ids:
            raise not_understood(clause.words, f"'{clause.relation}' what?")
        if clause.relation == "between" and len(clause.anchors) < 2:
            raise not_understood(clause.words, "between what?")
        return tuple(ids)

    def near(self, items: Sequence[Item], clause: Clause) -> list[Item]:
        """Those of the pieces that stand where a relation says."""
        if not clause.anchors:
            return list(items)
        if clause.relation != "by" or any(isinstance(anchor, str) for anchor in clause.anchors):
            raise not_understood(clause.words, f"'{clause.relation}' for what is there already")
        room = items[0].room_id if items else ""
        ids = self.anchors(clause, room, [item.id for item in items])
        shapes = [footprint_polygon(item.box) for item in self._things if item.id in ids]
        return [
            item for item in items
            if any(footprint_polygon(item.box).distance(shape) <= _BY_M for shape in shapes)
        ]  # fmt: skip

    def anchor_room(self, clause: Clause) -> str:
        """Id of the one room where all pieces are that a relation is to; "" where that is none."""
        nouns = [anchor for anchor in clause.anchors if isinstance(anchor, Noun)]
        rooms = {item.room_id for noun in nouns for item in self.there(noun, [])}
        return rooms.pop() if len(rooms) == 1 else ""
