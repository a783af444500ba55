"""What each verb of a sentence asks for in one house: a clause -> intents."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal, cast

from chord_usd.base.scene.intents import Action, Coat, Intent, NewPiece, Relation, Surface, Way
from chord_usd.base.scene.palette import Level, category
from chord_usd.base.scene.types import Item, Room, SceneGraph
from chord_usd.line.lists.clauses import Clause, Noun, not_understood
from chord_usd.line.lists.coat_words import WOODS
from chord_usd.line.lists.edit_words import (
    ONE,
)
from chord_usd.line.lists.pieces import MOST_PIECES
from chord_usd.line.lists.referents import ROOM_TOO, Referents
from chord_usd.line.lists.wishes import SLACK_M


class Reader(Referents):
    """Finds what clauses mean in one house, one after the other."""

    def __init__(self, graph: SceneGraph, rooms: Mapping[str, Room]) -> None:
        super().__init__(graph, rooms)
        self._verb = ""

    def intents(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        """What a clause wants. Raises ChordError."""
        verb = clause.verb if clause.verb not in ("", "weak") else ""
        rooms = self.rooms_of(clause, "from", "in", "", "of")
        if clause.is_bare or (clause.rooms and not verb and _only_rooms(clause)):
            if not rooms:
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
        name = f"_{self._act_of(clause, verb)}"
        if not hasattr(self, name):
            raise not_understood(clause.words, "it orders nothing", "a verb, such as move")
        unnamed = [noun for noun in (*clause.nouns, *clause.anchors)
                   if isinstance(noun, Noun) and noun.thing is ONE]  # fmt: skip
        if unnamed and (name not in _EXCHANGES or clause.nouns[1:] != unnamed):
            raise not_understood(clause.words, f"what is '{unnamed[0].said}'?", "a piece")
        act = cast(Callable[[Clause, Sequence[Clause]], list[Intent]], getattr(self, name))
        intents = act(clause, following)
        if intents and intents[0].action == "add" and not (clause.rooms or clause.anchors):
            pass  # where nobody said a room, the next piece goes to its usual one
        elif len({intent.room for intent in intents}) == 1:
            self.room_said = intents[-1].to_room or intents[-1].room
        elif intents:
            self.room_said = ""  # of several, none is the room of what follows
        self.last = intents[-1].items if intents else ()  # none of "it" for what is new
        return intents

    def _act_of(self, clause: Clause, verb: str) -> str:
        """The name of what does it: what a clause holds says more than its verb."""
        if clause.style and not clause.nouns:
            return "restyle"
        if clause.surfaces or (clause.coat and verb != "replace" and not clause.swapped_for):
            return "paint"
        is_new = verb in ("add", "put") or clause.swapped_for
        if verb in ("bigger", "smaller") or (
            not is_new and (clause.scale or clause.extent_m is not None)
        ):
            return "resize"
        return _OF_VERB.get(verb, verb)

    def _implied(self, clause: Clause) -> str:
        """The verb of a clause without one: that of the clause before, or what its nouns say."""
        if any(noun.is_denied or noun.is_less or noun.is_only for noun in clause.nouns):
            return "remove"
        if clause.said[0] == "with":
            return "add"
        if clause.coat or clause.surfaces:
            return "paint"
        if clause.scale or clause.extent_m is not None:
            return "resize"
        if any(noun.is_other for noun in clause.nouns):
            return "change"
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
        raise not_understood(clause.words, "it names no action", "a verb, such as move")

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
        """Nothing: a later order names the action for these pieces."""
        if not any(noun.is_denied for noun in clause.nouns):
            items = self.subjects(clause, self.rooms_for(clause, following, "in", "from", "", "of"))
            self.last, self.room_said = tuple(item.id for item in items), items[0].room_id
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
            raise not_understood(clause.words, "in which room?", ROOM_TOO)
        intents = []
        for room in dict.fromkeys(rooms):
            for noun in clause.nouns:
                intents.append(self._added(clause, noun, room))
        if not intents:
            raise not_understood(clause.words, "it names no piece")
        return intents

    def _is_move(self, clause: Clause) -> bool:
        """Whether "put the sofa by the window" means the sofa that is there."""
        nouns = clause.nouns
        if len(nouns) != 1 or not nouns[0].is_definite or nouns[0].is_more:
            return False
        return bool(self.there(nouns[0], []))

    def _added(self, clause: Clause, noun: Noun, room: str) -> Intent:
        chosen = self.categories(noun, room)[0]
        if category(chosen).level not in (Level.HOUSE, Level.DRESSING):
            raise not_understood(clause.words, f"a {noun.said} stands on tables")
        count = int(1 if noun.count is None else noun.count)
        if not 1 <= count <= MOST_PIECES or noun.count not in (None, count):
            raise not_understood(
                clause.words, f"{noun.count:g} × {noun.said}", f"at most {MOST_PIECES}"
            )
        anchors = self.anchors(clause, room)
        relation = cast(Relation, clause.relation)
        scaled: dict[int, Literal["large", "small"]] = {1: "large", -1: "small"}
        size = noun.size or scaled.get(clause.scale, "")
        new = NewPiece(
            chosen, noun.thing.length_m, size, noun.coat, clause.style, noun.form, noun.thing.word
        )
        wording = f"add {count} × {_coated(noun.coat)}{noun.thing.word} to {self.name(room)}"
        wording += self._where(clause)
        return Intent(
            "add", room, wording, new=new, count=count, relation=relation, anchors=anchors
        )

    def _where(self, clause: Clause) -> str:
        if not clause.relation:
            return ""
        names = [
            anchor if isinstance(anchor, str) else anchor.thing.word for anchor in clause.anchors
        ]
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
        return [item for noun in clause.nouns for item in self._removed(clause, noun, rooms)]

    def _removed_ids(self, clause: Clause) -> list[Intent]:
        items = self.subjects(clause, [])
        wording = f"remove {len(items)} × {category(items[0].category).label.lower()}"
        wording += f" from {self.name(items[0].room_id)}"
        return [Intent("remove", items[0].room_id, wording, tuple(item.id for item in items))]

    def _removed(self, clause: Clause, noun: Noun, rooms: Sequence[str]) -> Iterator[Intent]:
        items = self._to_remove(clause, noun, rooms)
        for room in rooms if noun.is_denied and rooms else dict.fromkeys(i.room_id for i in items):
            ids = tuple(item.id for item in items if item.room_id == room)
            wording = f"remove {len(ids)} × {noun.thing.word} from {self.name(room)}"
            barred = (
                NewPiece(noun.thing.categories[0], word=noun.thing.word) if noun.is_denied else None
            )
            yield Intent("remove", room, wording, ids, barred)

    def _to_remove(self, clause: Clause, noun: Noun, rooms: Sequence[str]) -> list[Item]:
        count = int(1 if noun.count is None else noun.count)
        if noun.is_denied and rooms:  # "no rug in the hall" is true of a hall without
            return self.near(self.there(noun, rooms), clause)
        if noun.is_denied or noun.is_every:
            return self.near(self.meant(clause, noun, rooms), clause)
        if noun.is_less or noun.is_only or (noun.count is not None and not noun.is_definite):
            items = self.near(self.meant(clause, noun, rooms), clause)
            gone = len(items) - count if noun.is_only else count
            if not 0 <= gone <= len(items) or noun.count not in (None, count):
                raise not_understood(clause.words, f"there are {len(items)} of '{noun.said}'")
            return items[len(items) - gone :]
        items = self.single(clause, noun, rooms)
        if len(self.near(items, clause)) != len(items):
            raise not_understood(clause.words, f"'{noun.said}' stands elsewhere")
        return items

    def _move(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        _refuse_rest(clause, "degrees", "number")
        source = self.rooms_of(clause, "in", "from", "", "of")
        target = self.rooms_of(clause, "to")
        if clause.verb == "put" and not target:
            source, target = [], source
        items = self.subjects(clause, source)
        here = items[0].room_id
        to_room = target[0] if target and target[0] != here else ""
        anchors = self.anchors(clause, to_room or here, [item.id for item in items])
        if not (to_room or anchors or clause.way):
            raise not_understood(clause.words, "whereto?", "a room, a way or 'next to' something")
        if clause.distance_m is not None and not (
            clause.way or clause.relation in ("nearer to", "away from")
        ):
            raise not_understood(clause.words, "which way?", "north, east, south, west, or towards")
        anchors = tuple(self.wall_named(anchor, items[0]) for anchor in anchors)
        wording = f"move {items[0].category.replace('_', ' ')} in {self.name(here)}"
        wording += f" {clause.distance_m:g} m" if clause.distance_m is not None else ""
        wording += f" {clause.way}" if clause.way else ""
        wording += f" to {self.name(to_room)}" if to_room else ""
        intent = Intent(
            "move", here, wording + self._where(clause), relation=cast(Relation, clause.relation),
            anchors=anchors, way=cast(Way, clause.way), distance_m=clause.distance_m,
            to_room=to_room,
        )  # fmt: skip
        return [replace(intent, items=(item.id,)) for item in items]

    def _turn(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        if clause.degrees is None and clause.way in _QUARTERS:
            clause.degrees, clause.way = _QUARTERS[clause.way], ""
        if clause.degrees is None and not clause.anchors and not clause.way:
            clause.degrees = 90.0  # "rotate the sofa": a quarter turn, as buttons of planners do
        if clause.degrees is None:
            return self._face(clause, following)
        _refuse_rest(clause, "distance_m", "way", "number", "anchors")
        items = self.subjects(clause, self.rooms_of(clause, "in", "from", "", "of"))
        turn_deg = clause.degrees * (clause.sense or 1)
        sense = "clockwise" if turn_deg < 0 else "counter-clockwise"
        return [
            Intent(
                "turn", item.room_id, f"turn {item.category.replace('_', ' ')} in "
                f"{self.name(item.room_id)} by {abs(turn_deg):g}° {sense}", (item.id,),
                turn_deg=turn_deg,
            )
            for item in items
        ]  # fmt: skip

    def _flip(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        if not clause.anchors:
            clause.degrees = 180.0
        return self._turn(clause, following)

    def _face(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        _refuse_rest(clause, "distance_m", "number", "degrees")
        items = self.subjects(clause, self.rooms_of(clause, "in", "from", "", "of"))
        here = items[0].room_id
        anchors = self.anchors(clause, here, [item.id for item in items])
        if bool(anchors) == bool(clause.way):
            raise not_understood(clause.words, "it names no direction", "a piece, window or door")
        names = clause.way or " and ".join(
            anchor if isinstance(anchor, str) else anchor.thing.word for anchor in clause.anchors
        )
        wording = f"turn {items[0].category.replace('_', ' ')} in {self.name(here)} to the {names}"
        return [
            Intent("face", here, wording, (item.id,), anchors=anchors, way=cast(Way, clause.way))
            for item in items
        ]

    def _swap(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        is_other = bool(clause.nouns and clause.nouns[-1].is_other)
        if (
            clause.swapped_for is not None
            or is_other
            or (len(clause.nouns) == 2 and clause.nouns[1].count)
        ):
            return self._replace(clause, following)
        _refuse_rest(clause, "distance_m", "number", "degrees", "way", "anchors")
        rooms = self.rooms_of(clause, "in", "from", "", "of")
        items = self.subjects(clause, rooms)
        if len(items) != 2 or items[0].room_id != items[1].room_id:
            raise not_understood(clause.words, "two pieces of one room change places")
        names = " and ".join(item.category.replace("_", " ") for item in items)
        wording = f"swap {names} in {self.name(items[0].room_id)}"
        return [Intent("swap", items[0].room_id, wording, tuple(item.id for item in items))]

    def _replace(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        _refuse_rest(clause, "distance_m", "number", "degrees", "way", "anchors")
        if len(clause.nouns) == 1 and not (clause.coat or clause.swapped_for):
            clause.nouns[0].is_other |= clause.nouns[0].is_definite  # "replace the sofa"
        if len(clause.nouns) == 1 and clause.nouns[0].is_other:
            clause.nouns.insert(0, replace(clause.nouns[0], is_other=False, coat=None))
        if len(clause.nouns) == 1 and clause.coat:  # "replace the sofa with leather"
            return self._paint(clause, following)
        if len(clause.nouns) != 2:
            raise not_understood(clause.words, "what is replaced by what?")
        rooms = self.rooms_of(clause, "in", "from", "", "of")
        old = self.single(clause, clause.nouns[0], rooms)
        noun = clause.nouns[1]
        coat = noun.coat or clause.coat
        if len(old) != 1 or (noun.count or 1) != 1:
            raise not_understood(clause.words, "one piece is replaced by one other")
        room = old[0].room_id
        named = f"replace {old[0].category.replace('_', ' ')} in {self.name(room)} by 1 × "
        if noun.thing is ONE or noun.thing == clause.nouns[0].thing:
            if clause.scale or noun.size:
                scale = clause.scale or (1 if noun.size == "large" else -1)
                return [self._resized(clause, old[0], scale, coat)]
            if coat and not (noun.is_other or clause.style or noun.form):
                return self._painted(old, coat)
            new = NewPiece(old[0].category, coat=coat, style=clause.style, form=noun.form,
                           is_other=True)  # fmt: skip
            wording = f"{named}{clause.style or 'other'} {old[0].category.replace('_', ' ')}"
            return [Intent("replace", room, wording, (old[0].id,), new)]
        chosen = self.categories(noun, room)[0]
        new = NewPiece(
            chosen, noun.thing.length_m, noun.size, coat, clause.style, noun.form, noun.thing.word
        )
        wording = f"{named}{_coated(coat)}{noun.thing.word}"
        return [Intent("replace", room, wording, (old[0].id,), new)]

    def _change(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        if (
            any(noun.is_other or noun.is_definite for noun in clause.nouns)
            or len(clause.nouns) == 2
        ):
            return self._replace(clause, following)
        raise not_understood(clause.words, "into what?", "a colour, a size, a style or a piece")

    def _resize(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        """Pieces in another size, in the place of those that are there."""
        _refuse_rest(clause, "degrees", "way", "number", "anchors", "distance_m")
        items = self.subjects(clause, self.rooms_for(clause, following, "in", "from", "", "of"))
        scale = clause.scale or (-1 if clause.verb == "smaller" else 1)
        return [self._resized(clause, item, scale) for item in items]

    def _resized(self, clause: Clause, item: Item, scale: int, coat: Coat | None = None) -> Intent:
        was_m = item.box.size_m[0]
        exact_m = clause.extent_m
        if exact_m is None and clause.percent is not None:
            exact_m = was_m * (1 + scale * clause.percent / 100)
        if exact_m is not None:
            length_m, said = (exact_m - SLACK_M, exact_m + SLACK_M), f"of {exact_m:.2g} m"
        elif scale > 0:
            length_m, said = (was_m * 1.06, was_m * 1.5), "of a larger size"
        else:
            length_m, said = (was_m * 0.6, was_m * 0.94), "of a smaller size"
        kind = item.category.replace("_", " ")
        wording = f"replace {kind} in {self.name(item.room_id)} by 1 × {_coated(coat)}{kind} {said}"
        new = NewPiece(item.category, length_m, coat=coat)
        return Intent("replace", item.room_id, wording, (item.id,), new)

    def _paint(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        """A colour or a material for pieces, or for walls and floors."""
        _refuse_rest(clause, "distance_m", "degrees", "way", "number", "anchors")
        coat = clause.coat
        if coat is None:
            raise not_understood(clause.words, "into what?", "a colour or a material")
        rooms = self.rooms_for(clause, following, "in", "from", "", "of", "to")
        is_floor = len(clause.nouns) == 1 and clause.nouns[0].said.startswith("carpet")
        if is_floor and (
            coat.material in FLOORS or clause.surfaces == ["floor"]
        ):  # "replace the carpet with hardwood"
            clause.nouns, clause.surfaces = [], ["floor"]
        if clause.rooms and not (clause.nouns or clause.surfaces or coat.material):
            clause.surfaces = ["wall"]  # "paint the kitchen red"
        if clause.surfaces:
            if clause.nouns:
                raise not_understood(clause.words, "a piece and a surface at once")
            rooms = rooms or ([self.room_said] if self.room_said else self.all_rooms(coat))
            return [
                Intent("paint", room, f"give {self.name(room)} {surface}s of {coat.name}",
                       coat=coat, surface=cast(Surface, surface))
                for surface in dict.fromkeys(clause.surfaces) for room in rooms
            ]  # fmt: skip
        if not clause.nouns and not clause.is_it:
            raise not_understood(clause.words, "what is to look so?", _COATED)
        if clause.is_it and not clause.nouns and not self.last:
            raise not_understood(clause.words, "what is meant by 'it'?", _COATED)
        if len(clause.nouns) == 1 and not rooms:  # "the curtains" are those of all rooms, as walls
            clause.nouns[0].is_every |= self.is_group(clause.nouns[0])
        items = self.subjects(clause, rooms)
        first = {noun.thing.categories[0] for noun in clause.nouns}  # curtains, and not their rails
        return self._painted([item for item in items if item.category in first] or items, coat)

    def _painted(self, items: Sequence[Item], coat: Coat) -> list[Intent]:
        return [
            Intent("paint", item.room_id, f"give {item.category.replace('_', ' ')} in "
                   f"{self.name(item.room_id)} {coat.name}", (item.id,), coat=coat)
            for item in items
        ]  # fmt: skip

    def _restyle(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        _refuse_rest(clause, "distance_m", "number", "degrees", "way", "anchors", "nouns")
        rooms = self.rooms_of(clause, "in", "", "of", "to")
        if clause.is_it and not rooms:
            rooms = [self.room_said] if self.room_said else self.all_rooms()
        if not rooms:
            raise not_understood(clause.words, "which room?", ROOM_TOO)
        return [
            Intent("style", room, f"furnish {self.name(room)} in {clause.style} style",
                   style=clause.style)
            for room in rooms
        ]  # fmt: skip

    def _lock(self, clause: Clause, following: Sequence[Clause]) -> list[Intent]:
        _refuse_rest(clause, "distance_m", "number", "degrees", "way", "anchors")
        action: Action = "unlock" if clause.verb == "unlock" else "lock"
        items = self.subjects(clause, self.rooms_for(clause, following, "in", "from", "", "of"))
        return [
            Intent(action, item.room_id, f"{action} {item.category.replace('_', ' ')} in "
                   f"{self.name(item.room_id)}", (item.id,))
            for item in items
        ]  # fmt: skip


_EXCHANGES = ("_replace", "_swap", "_change")
"""What may have a piece that is named before, as in "a larger one"."""
_OF_VERB = {"put": "add", "unlock": "lock", "style": "restyle"}
_COATED = "a piece, walls or a floor"
_QUARTERS = {"left": 90.0, "right": -90.0}
"""Turns of a piece to its own sides, counter-clockwise."""
FLOORS = frozenset((*WOODS, "wood", "parquet", "herringbone", "chevron", "laminate", "tiles",
                    "terrazzo", "mosaic", "tatami", "concrete", "stone", "marble"))  # fmt: skip
"""Materials that take the place of a carpet that is a floor."""


def _coated(coat: Coat | None) -> str:
    return f"{coat.name} " if coat else ""


def _only_rooms(clause: Clause) -> bool:
    return not (clause.nouns or clause.style or clause.anchors or clause.is_it or clause.coat
                or clause.surfaces)  # fmt: skip


def _refuse_rest(clause: Clause, *unused: str) -> None:
    """Raises ChordError for what a verb has no use for."""
    for name in unused:
        value = getattr(clause, name)
        if value is not None and value not in ("", False, []):
            words = {"distance_m": "a distance", "degrees": "a turn", "way": "a direction",
                    "is_it": "'it'", "number": "a number", "anchors": "a place",
                    "nouns": "the style of a single piece"}[name]  # fmt: skip
            raise not_understood(clause.words, f"{words} has no meaning there")
