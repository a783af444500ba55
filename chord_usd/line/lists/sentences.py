"""A sentence -> what it wants changed in a house: "turn the sofa to the window, no rug here".

All of it is understood, or nothing is: a sentence a part of which has no meaning here, or not one
meaning, raises a ChordError that says so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import cast

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.intents import Action, Compass, Intent, NewPiece, Relation
from chord_usd.base.scene.palette import Level, category
from chord_usd.base.scene.types import Item, Room, SceneGraph
from chord_usd.line.lists.clauses import WHERE, Clause, Noun, clauses_of, not_understood
from chord_usd.line.lists.pieces import MOST_PIECES
from chord_usd.line.lists.referents import Referents


@dataclass(frozen=True)
class Understood:
    """What a sentence says."""

    intents: tuple[Intent, ...]
    read_as: tuple[str, ...] = ()
    """Misspelt words, and what they were taken for."""

    @property
    def told(self) -> list[str]:
        """In words, one line for each thing to do."""
        return [intent.wording for intent in self.intents]


def understand(sentence: str, graph: SceneGraph, rooms: Mapping[str, Room]) -> Understood:
    """What a sentence wants changed in a house.

    rooms: of the house, by the names of their prims, named as people call them. Raises ChordError.
    """
    reader = _Reader(graph, rooms)
    clauses, slips = clauses_of(sentence, rooms, reader.answer)
    intents: list[Intent] = []
    for at, clause in enumerate(clauses):
        following = clauses[at + 1 :]
        try:
            found = reader.intents(clause, following)
        except ChordError as error:
            known = "; ".join(one.wording for one in intents)
            raise _with_known(error, known) if known else error from None
        intents += [one for one in found if one not in intents]
    if not intents:
        raise not_understood(" ".join(sentence.split()), "it asks for nothing")
    _refuse_contradictions(intents)
    return Understood(tuple(intents), tuple(slips))


def _with_known(error: ChordError, known: str) -> ChordError:
    return ChordError(
        f"{error.what} (understood: {known})", where=error.where, expected=error.expected,
        try_=error.try_,
    )  # fmt: skip


def _refuse_contradictions(intents: Sequence[Intent]) -> None:
    """Raises ChordError where one thing undoes another."""
    for at, one in enumerate(intents):
        for other in intents[at + 1 :]:
            shared = set(one.items) & set(other.items)
            kinds = {one.action, other.action}
            ends = kinds & {"remove", "replace"}
            moves = {"move", "turn", "face", "swap", "replace", "remove"}
            clash = bool(shared) and (
                bool(ends) or kinds == {"lock", "unlock"}
                or ("lock" in kinds and bool(kinds & moves))
                or (one.action == other.action and one != other and one.action != "lock")
            )  # fmt: skip
            if one.action == other.action == "style" and one.room == other.room:
                clash = True
            clash = clash or _comes_and_goes(one, other)
            if clash:
                raise ChordError(
                    f"'{one.wording}' and '{other.wording}' contradict each other", where=WHERE,
                    expected="one of the two",
                )  # fmt: skip


def _comes_and_goes(one: Intent, other: Intent) -> bool:
    """Whether a kind of piece is added to a room and is not to be there."""
    for add, gone in ((one, other), (other, one)):
        if add.action == "add" and gone.action == "remove" and add.room == gone.room and add.new:
            barred = gone.new
            if barred and barred.category == add.new.category:
                return True
    return False


class _Reader(Referents):
    """Finds what clauses mean in one house."""

    def __init__(self, graph: SceneGraph, rooms: Mapping[str, Room]) -> None:
        super().__init__(graph, rooms)
        self._verb = ""

    def intents(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        """What a clause wants. Raises ChordError."""
        verb = clause.verb if clause.verb not in ("", "weak") else ""
        rooms = self.rooms_of(clause, "from", "in", "", "of")
        if clause.is_bare or (clause.rooms and not verb and _only_rooms(clause)):
            if not clause.rooms and (verb or clause.said):
                raise not_understood(clause.words, "it names no piece and no room")
            self.room_said, self._verb = rooms[0], ""  # "kitchen: a fridge"
            return []
        if clause.act == "statement":
            return self._stated(clause, following)
        said, verb = verb, verb or self._implied(clause)
        if said:
            self._verb = said
        if clause.relation and not clause.anchors:
            raise not_understood(clause.words, f"'{clause.relation}' what?")
        if clause.style:
            found = self._restyled(clause)
        else:
            act = cast(Callable[[Clause, Sequence[Clause]], list[Intent]],
                       getattr(self, f"_{_OF_VERB.get(verb, verb)}"))  # fmt: skip
            found = act(clause, following)
        self.room_said = found[-1].to_room or found[-1].room if found else self.room_said
        self.last = found[-1].items if found else ()  # none of "it" for what is new
        return found

    def _implied(self, clause: Clause) -> str:
        """The verb of a clause without one: that of the clause before, or what its nouns say."""
        if any(noun.is_denied or noun.is_less or noun.is_only for noun in clause.nouns):
            return "remove"
        if clause.said[0] == "with":
            return "add"
        relation = clause.relation in ("nearer to", "away from")
        if relation and any(noun.is_definite for noun in clause.nouns):
            return "move"
        if clause.verb != "weak" and self._verb and not clause.style:
            return self._verb
        if clause.style:
            return "style"
        wanted = all(noun.count or noun.is_more for noun in clause.nouns) and clause.nouns
        if wanted or (clause.nouns and not any(noun.is_definite for noun in clause.nouns)):
            self._refuse_total(clause)
            return "add"
        raise not_understood(clause.words, "what shall be done with it?", "a verb, such as move")

    def _refuse_total(self, clause: Clause) -> None:
        """Raises ChordError for "two beds in bedroom 1", where one stands there already."""
        rooms = self.rooms_of(clause, "in", "to", "", "of")
        for noun in clause.nouns:
            if (noun.count or 0) > 1 and not noun.is_more and rooms and self.there(noun, rooms):
                raise not_understood(
                    clause.words, f"some of '{noun.said}' stand there: so many more, or in all?",
                    "'add' or 'only'",
                )  # fmt: skip

    # Verbs ----------------------------------------------------------------------------------------

    def _stated(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        """Nothing: an order that follows says what shall be done with the pieces it is about."""
        if not any(noun.is_denied for noun in clause.nouns):
            own = self.subjects(clause, self.rooms_for(clause, following, "in", "from", "", "of"))
            self.last, self.room_said = tuple(one.id for one in own), own[0].room_id
        return []

    def _add(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        if clause.verb == "put" and not clause.is_it and self._is_move(clause):
            return self._move(clause, following)
        if clause.is_it and clause.verb == "put":
            return self._move(clause, following)
        denied = [noun for noun in clause.nouns if noun.is_denied]
        if denied:
            return self._remove(clause, following)
        _refuse_rest(clause, "distance_m", "degrees", "way", "is_it", "number")
        rooms = self.rooms_for(clause, following, "in", "to", "", "of")
        rooms = rooms or [room for room in [self.anchor_room(clause)] if room]
        rooms = rooms or [room for room in [self.room_said or self.home_of(clause)] if room]
        if not rooms:
            raise not_understood(clause.words, "in which room?", "a room of the house")
        found = []
        for room in dict.fromkeys(rooms):
            for noun in clause.nouns:
                found.append(self._added(clause, noun, room))
        if not found:
            raise not_understood(clause.words, "it names no piece")
        return found

    def _is_move(self, clause: Clause) -> bool:
        """Whether "put the sofa by the window" means the sofa that is there."""
        nouns = clause.nouns
        if len(nouns) != 1 or not nouns[0].is_definite or nouns[0].is_more:
            return False
        return bool(self.there(nouns[0], []))

    def _added(self, clause: Clause, noun: Noun, room: str) -> Intent:
        own = self.categories(noun, room)[0]
        if category(own).level not in (Level.HOUSE, Level.DRESSING):
            raise not_understood(clause.words, f"a {noun.said} stands on tables")
        count = int(1 if noun.count is None else noun.count)
        if not 1 <= count <= MOST_PIECES or noun.count not in (None, count):
            raise not_understood(
                clause.words, f"{noun.count:g} × {noun.said}", f"at most {MOST_PIECES}"
            )
        anchors = self.anchors(clause, room)
        relation = cast(Relation, clause.relation)
        new = NewPiece(own, noun.thing.length_m, noun.size)  # type: ignore[arg-type]
        told = f"add {count} × {noun.thing.word} to {self.name(room)}{self._where(clause)}"
        return Intent("add", room, told, new=new, count=count, relation=relation, anchors=anchors)

    def _where(self, clause: Clause) -> str:
        if not clause.relation:
            return ""
        names = [one if isinstance(one, str) else one.thing.word for one in clause.anchors]
        return f", {clause.relation} the {' and the '.join(names)}"

    def _remove(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        _refuse_rest(clause, "distance_m", "degrees", "way", "number")
        rooms = self.rooms_for(clause, following, "in", "from", "", "of")
        if clause.anchors and not rooms:
            rooms = [room for room in [self.anchor_room(clause)] if room]
        if clause.is_it and not clause.nouns:
            return self._removed_ids(clause)
        if not clause.nouns:
            raise not_understood(clause.words, "it names no piece")
        return [one for noun in clause.nouns for one in self._removed(clause, noun, rooms)]

    def _removed_ids(self, clause: Clause) -> list[Intent]:
        own = self.subjects(clause, [])
        told = f"remove {len(own)} × {category(own[0].category).label.lower()}"
        told += f" from {self.name(own[0].room_id)}"
        return [Intent("remove", own[0].room_id, told, tuple(one.id for one in own))]

    def _removed(self, clause: Clause, noun: Noun, rooms: Sequence[str]) -> Iterator[Intent]:
        own = self._to_remove(clause, noun, rooms)
        for room in rooms if noun.is_denied and rooms else dict.fromkeys(i.room_id for i in own):
            ids = tuple(one.id for one in own if one.room_id == room)
            told = f"remove {len(ids)} × {noun.thing.word} from {self.name(room)}"
            barred = NewPiece(noun.thing.categories[0]) if noun.is_denied else None
            yield Intent("remove", room, told, ids, barred)

    def _to_remove(self, clause: Clause, noun: Noun, rooms: Sequence[str]) -> list[Item]:
        count = int(1 if noun.count is None else noun.count)
        if noun.is_denied and rooms:  # "no rug in the hall" is true of a hall without
            return self.near(self.there(noun, rooms), clause)
        if noun.is_denied or noun.is_every:
            return self.near(self.meant(clause, noun, rooms), clause)
        if noun.is_less or noun.is_only or (noun.count is not None and not noun.is_definite):
            own = self.near(self.meant(clause, noun, rooms), clause)
            gone = len(own) - count if noun.is_only else count
            if not 0 <= gone <= len(own) or noun.count not in (None, count):
                raise not_understood(clause.words, f"there are {len(own)} of '{noun.said}'")
            return own[len(own) - gone :]
        own = self.single(clause, noun, rooms)
        if len(self.near(own, clause)) != len(own):
            raise not_understood(clause.words, f"'{noun.said}' stands elsewhere")
        return own

    def _move(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        _refuse_rest(clause, "degrees", "number")
        source = self.rooms_of(clause, "in", "from", "", "of")
        target = self.rooms_of(clause, "to")
        if clause.verb == "put" and not target:
            source, target = [], source
        own = self.subjects(clause, source)
        here = own[0].room_id
        to_room = target[0] if target and target[0] != here else ""
        anchors = self.anchors(clause, to_room or here, [one.id for one in own])
        if not (to_room or anchors or clause.way):
            raise not_understood(clause.words, "whereto?", "a room, a way or 'next to' something")
        if clause.distance_m is not None and not (
            clause.way or clause.relation in ("nearer to", "away from")
        ):
            raise not_understood(clause.words, "which way?", "north, east, south, west, or towards")
        if clause.way and clause.distance_m is None:
            raise not_understood(clause.words, "how far?", "a distance, such as 0.5 m")
        told = f"move {own[0].category.replace('_', ' ')} in {self.name(here)}"
        told += f" {clause.distance_m:g} m" if clause.distance_m is not None else ""
        told += f" {clause.way}" if clause.way else ""
        told += f" to {self.name(to_room)}" if to_room else ""
        intent = Intent(
            "move", here, told + self._where(clause), relation=cast(Relation, clause.relation),
            anchors=anchors, way=cast(Compass, clause.way), distance_m=clause.distance_m,
            to_room=to_room,
        )  # fmt: skip
        return [replace(intent, items=(one.id,)) for one in own]

    def _turn(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        if clause.degrees is None:
            return self._face(clause, following)
        _refuse_rest(clause, "distance_m", "way", "number", "anchors")
        own = self.subjects(clause, self.rooms_of(clause, "in", "from", "", "of"))
        turn_deg = clause.degrees * (clause.sense or 1)
        sense = "clockwise" if turn_deg < 0 else "counter-clockwise"
        return [
            Intent(
                "turn", one.room_id, f"turn {one.category.replace('_', ' ')} in "
                f"{self.name(one.room_id)} by {abs(turn_deg):g}° {sense}", (one.id,),
                turn_deg=turn_deg,
            )
            for one in own
        ]  # fmt: skip

    def _face(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        _refuse_rest(clause, "distance_m", "number", "degrees")
        own = self.subjects(clause, self.rooms_of(clause, "in", "from", "", "of"))
        here = own[0].room_id
        anchors = self.anchors(clause, here, [one.id for one in own])
        if bool(anchors) == bool(clause.way):
            raise not_understood(clause.words, "whereto shall it look?", "a piece, window or door")
        names = clause.way or " and ".join(
            one if isinstance(one, str) else one.thing.word for one in clause.anchors
        )
        told = f"turn {own[0].category.replace('_', ' ')} in {self.name(here)} to the {names}"
        return [
            Intent("face", here, told, (one.id,), anchors=anchors, way=cast(Compass, clause.way))
            for one in own
        ]

    def _swap(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        if clause.swapped_for is not None or (len(clause.nouns) == 2 and clause.nouns[1].count):
            return self._replace(clause, following)
        _refuse_rest(clause, "distance_m", "number", "degrees", "way", "anchors")
        rooms = self.rooms_of(clause, "in", "from", "", "of")
        own = self.subjects(clause, rooms)
        if len(own) != 2 or own[0].room_id != own[1].room_id:
            raise not_understood(clause.words, "two pieces of one room change places")
        names = " and ".join(one.category.replace("_", " ") for one in own)
        told = f"swap {names} in {self.name(own[0].room_id)}"
        return [Intent("swap", own[0].room_id, told, tuple(one.id for one in own))]

    def _replace(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        _refuse_rest(clause, "distance_m", "number", "degrees", "way", "anchors")
        if len(clause.nouns) != 2:
            raise not_understood(clause.words, "what is replaced by what?")
        rooms = self.rooms_of(clause, "in", "from", "", "of")
        old = self.single(clause, clause.nouns[0], rooms)
        noun = clause.nouns[1]
        if len(old) != 1 or (noun.count or 1) != 1:
            raise not_understood(clause.words, "one piece is replaced by one other")
        room = old[0].room_id
        own = self.categories(noun, room)[0]
        told = f"replace {old[0].category.replace('_', ' ')} in {self.name(room)} by 1 × "
        new = NewPiece(own, noun.thing.length_m, noun.size)  # type: ignore[arg-type]
        return [Intent("replace", room, told + noun.thing.word, (old[0].id,), new)]

    def _restyled(self, clause: Clause) -> list[Intent]:
        _refuse_rest(clause, "distance_m", "number", "degrees", "way", "anchors", "nouns")
        rooms = self.rooms_of(clause, "in", "", "of", "to")
        if clause.is_it and not rooms and self.room_said:
            rooms = [self.room_said]
        if not rooms:
            raise not_understood(clause.words, "which room?", "a room of the house")
        return [
            Intent("style", room, f"furnish {self.name(room)} in {clause.style} style",
                   style=clause.style)
            for room in rooms
        ]  # fmt: skip

    def _lock(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        _refuse_rest(clause, "distance_m", "number", "degrees", "way", "anchors")
        action: Action = "unlock" if clause.verb == "unlock" else "lock"
        own = self.subjects(clause, self.rooms_for(clause, following, "in", "from", "", "of"))
        return [
            Intent(action, one.room_id, f"{action} {one.category.replace('_', ' ')} in "
                   f"{self.name(one.room_id)}", (one.id,))
            for one in own
        ]  # fmt: skip


_OF_VERB = {"put": "add", "unlock": "lock"}


def _only_rooms(clause: Clause) -> bool:
    return not (clause.nouns or clause.style or clause.anchors or clause.is_it)


def _refuse_rest(clause: Clause, *unused: str) -> None:
    """Raises ChordError for what a verb has no use for."""
    for name in unused:
        value = getattr(clause, name)
        if value is not None and value not in ("", False, []):
            told = {"distance_m": "a distance", "degrees": "a turn", "way": "a direction",
                    "is_it": "'it'", "number": "a number", "anchors": "a place",
                    "nouns": "the style of a single piece"}[name]  # fmt: skip
            raise not_understood(clause.words, f"{told} has no meaning there")
