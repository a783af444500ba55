"""A sentence that changes a house, taken apart: clauses, each with one verb and what goes with it.

Every word has to have a part in its clause: what has none makes the whole sentence not understood.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.numbers_said import plain_text
from chord_usd.base.scene.room_names import kind_of_word, room_kind
from chord_usd.base.scene.types import Room
from chord_usd.line.lists.edit_words import WISHES, Thing, Token, mended, tokens, words_of
from chord_usd.line.lists.speech_acts import Act, acts_of, separates

MOST_CHARACTERS = 1000
WHERE = "the sentence"
_EXAMPLE = 'chord-usd edit HOUSE "put a plant in bedroom 1, no rug in the hall" --dry-run'

_LONGEST_ROOM = 5
_ROOM_WORDS = frozenset((
    "living", "sitting", "dining", "bath", "bed", "master", "main", "entrance", "front", "room",
    "rooms", "area", "first", "second", "third", "fourth", "every", "each", "all", "both",
))  # fmt: skip
_NUMBERED = frozenset(("one", "two", "three", "four", "five", "six"))
_OUTSIDE = ("outside", "outdoors")
_PARTED = {
    "out": ("take", "get", "bring", "carry", "move", "put"),
    "away": ("take", "get", "bring", "carry", "move", "put", "give", "send"),
    "down": ("take", "get", "bring"),
}
"""Verbs that mean to remove together with a word that may stand after their object."""


@dataclass
class Noun:
    """Pieces that are spoken of."""

    thing: Thing
    said: str
    count: float | None = None
    is_definite: bool = False
    is_denied: bool = False
    is_every: bool = False
    is_more: bool = False
    is_less: bool = False
    is_only: bool = False
    size: str = ""


@dataclass
class Clause:
    """One verb and what goes with it."""

    act: Act = "order"
    said: list[str] = field(default_factory=list)
    verb: str = ""
    verb_said: str = ""
    nouns: list[Noun] = field(default_factory=list)
    rooms: list[tuple[str, str]] = field(default_factory=list)
    """Preposition, and what the room is called."""
    relation: str = ""
    anchors: list[Noun | str] = field(default_factory=list)
    number: float | None = None
    distance_m: float | None = None
    degrees: float | None = None
    sense: int = 0
    way: str = ""
    style: str = ""
    is_it: bool = False
    is_there: bool = False
    is_less: bool = False
    swapped_for: int | None = None
    """How many nouns stand before "for"."""

    @property
    def words(self) -> str:
        """As it was said."""
        return " ".join(self.said)

    @property
    def is_bare(self) -> bool:
        """Whether it says nothing but a verb or less."""
        return not (
            self.nouns or self.rooms or self.anchors or self.style or self.is_it or self.way
            or self.degrees is not None or self.is_less
        )  # fmt: skip


def not_understood(said: str, why: str, expected: str = "", try_: str = "") -> ChordError:
    """The error for a sentence a part of which has no meaning here."""
    return ChordError(
        f"{said!r} is not understood: {why}", where=WHERE, expected=expected, try_=try_
    )


Answer = Callable[[Sequence[Token]], str]
"""What a house has of the pieces that a question names, in words."""


def clauses_of(
    sentence: str, rooms: Mapping[str, Room], answer: Answer
) -> tuple[list[Clause], list[str]]:
    """The clauses of a sentence, in its order, and which words were read as which others.

    rooms: by the names of their prims, named as people call them. Raises ChordError for a sentence
    that is empty, too long, holds words that have no meaning here, asks, or orders nothing.
    """
    if not sentence.strip():
        raise ChordError("is empty", where=WHERE, expected="what shall be changed, in English")
    if len(sentence) > MOST_CHARACTERS:
        raise ChordError(
            f"has {len(sentence)} characters", where=WHERE, expected=f"at most {MOST_CHARACTERS}"
        )
    words = words_of(sentence)
    read = list(tokens(words, _rooms_in(words, rooms)))
    corrected = _corrected(words, {token.said for token in read if token.kind == "unknown"})
    slips = [f"{was!r} as {is_!r}" for was, is_ in zip(words, corrected, strict=True) if was != is_]
    if slips:
        read = list(tokens(corrected, _rooms_in(corrected, rooms)))
    acts = acts_of(read)
    _refuse_no_order(acts, read, sentence, answer)
    _refuse_unknown(read, sentence)
    return _joined(list(_split(read, acts))), slips


def _refuse_no_order(
    acts: Sequence[Act], read: Sequence[Token], sentence: str, answer: Answer
) -> None:
    """Raises ChordError for a question, with its answer, and for statements without an order."""
    said = " ".join(sentence.split())
    if "question" in acts:
        raise ChordError(
            f"{said!r} is a question, and changes nothing: {answer(read)}", where=WHERE,
            expected="an order", try_=_EXAMPLE,
        )  # fmt: skip
    if acts[-1] == "statement":
        raise ChordError(
            f"{said!r} states something, and changes nothing", where=WHERE,
            expected="an order, also after what it is about", try_=_EXAMPLE,
        )  # fmt: skip


def _rooms_in(words: list[str], rooms: Mapping[str, Room]) -> dict[int, tuple[int, str]]:
    """Where rooms are named: from which word, how many words, and the name."""
    own = {plain_text(name) for room in rooms.items() for name in (room[0], room[1].name)}
    found: dict[int, tuple[int, str]] = {}
    for start in range(len(words)):
        for taken in range(min(_LONGEST_ROOM, len(words) - start), 0, -1):
            part = words[start : start + taken]
            if " ".join(part) in own or _is_room(part):
                found[start] = taken, " ".join(part)
                break
            if taken == 1 and part[0] in _OUTSIDE:
                found[start] = 1, "balcony"
    return found


def _is_room(words: list[str]) -> bool:
    """Whether words name a room of some kind: "the second bedroom" without its article."""
    *front, last = words
    if last.isdigit() or (last in _NUMBERED and front):
        words = front
    kinds = [word for word in words if kind_of_word(word, english=True, inflected=False)]
    plain = all(word in kinds or word in _ROOM_WORDS for word in words)
    if not words or not plain or words[-1] in _NUMBERED:
        return False
    if len({kind_of_word(word, english=True) for word in kinds}) > 1:
        return False  # two rooms, or a room of a room
    is_room = room_kind(" ".join(words)) != "unknown"
    return (bool(kinds) or is_room) and words.count("room") <= 1


def _corrected(words: list[str], unknown: set[str]) -> list[str]:
    rooms = frozenset(["living", "livingroom", "bedroom", "bathroom", "kitchen", "dining",
                       "corridor", "balcony", "hallway", "lounge", "terrace", "study"])  # fmt: skip
    return [(mended(word, rooms) or word) if word in unknown else word for word in words]


def _refuse_unknown(read: list[Token], sentence: str) -> None:
    runs: list[list[str]] = [[]]
    for token in read:
        if token.kind in ("unknown", "cannot"):
            runs[-1].append(token.said)
        elif runs[-1]:
            runs.append([])
    strange = [" ".join(run) for run in runs if run]
    if not strange:
        return
    told = ", ".join(repr(one) for one in strange)
    raise not_understood(
        " ".join(sentence.split()), f"{told} has no meaning here",
        "pieces, rooms, places, turns, styles and counts, in English",
        _EXAMPLE,
    )  # fmt: skip


def _split(read: Iterable[Token], acts: Iterable[Act]) -> Iterator[Clause]:
    """Clauses between commas and "and"; a verb after a verb with its object begins one, too."""
    parser, act_of_part = _Parser(), iter(acts)
    act, part = next(act_of_part), list[Token]()
    for token in read:
        if separates(token, part):
            yield from parser.ended(act)
            act, part = next(act_of_part), []
            continue
        part.append(token)
        if token.kind == "and":
            parser.goes_on()
            continue
        if token.kind == "verb" and parser.is_full(token):
            yield from parser.ended(act)
        parser.take(token)
    yield from parser.ended(act)


def _joined(clauses: list[Clause]) -> list[Clause]:
    """Clauses, with both halves of a swap in one."""
    found: list[Clause] = []
    for own in clauses:
        before = found[-1] if found else Clause()
        is_end = own.verb == "swap" and before.verb in ("", "weak") and before.nouns
        is_half = before.verb == "swap" and len(before.nouns) == 1 and not own.verb
        if is_end or is_half:
            _take_over(before, own)
        else:
            found.append(own)
    return found


def _take_over(before: Clause, own: Clause) -> None:
    before.verb, before.verb_said = "swap", "swap"
    before.said += ["and", *own.said]
    before.nouns += own.nouns
    before.rooms += own.rooms
    before.is_there = before.is_there or own.is_there


class _Parser:
    """One clause while its words are read."""

    def __init__(self) -> None:
        self._begin()

    def _begin(self) -> None:
        self.clause = Clause()
        self.next = Noun(Thing("", ()), "")
        self.prep = self.pending = ""
        self.number: float | None = None
        self.is_meant = False
        """Whether more than politeness was said."""

    def is_full(self, token: Token) -> bool:
        """Whether a verb belongs to the next clause."""
        own = self.clause.verb
        return bool(own and own != "weak" and token.value != "weak" and not self.clause.is_bare
                    and not self._is_wished
                    and token.said not in ("up", "face", "get"))  # fmt: skip

    @property
    def _is_wished(self) -> bool:
        """Whether what is wished is about to be said: "I want the sofa to"."""
        return self.clause.verb_said in WISHES and self.prep == "to"

    def goes_on(self) -> None:
        """Read the next noun as one more anchor."""
        self.pending = "between"

    def ended(self, act: Act) -> Iterator[Clause]:
        clause = self.clause
        clause.act = act
        if self.number is not None:
            clause.number = self.number
        if self.pending in ("around",) and clause.verb == "turn":
            clause.degrees, self.pending = 180.0, ""
        if self.pending == "for" or (self.pending and not clause.is_bare):
            clause.relation = clause.relation or self.pending
        leaves = any(prep == "from" for prep, _ in clause.rooms)
        stays = clause.relation or clause.way or any(prep == "to" for prep, _ in clause.rooms)
        if leaves and not stays and clause.verb_said in _PARTED["out"]:
            clause.verb = "remove"  # "take the sofa out of the living room"
        if self.is_meant:
            yield clause
        self._begin()

    def take(self, token: Token) -> None:
        clause = self.clause
        clause.said.append(token.said)
        self.is_meant = self.is_meant or token.kind != ""
        getattr(self, f"on_{token.kind}", self._pass_over)(token)

    def _pass_over(self, token: Token) -> None:
        pass

    def on_verb(self, token: Token) -> None:
        if not self.clause.verb or self.clause.verb == "weak" or self._is_wished:
            self.clause.verb, self.clause.verb_said = token.value, token.said
            self.prep = ""
        elif token.value != "weak" and self.clause.verb != token.value:
            raise not_understood(
                self.clause.words, f"'{self.clause.verb_said}' and '{token.said}' at once",
                "one thing to do between two commas",
            )  # fmt: skip

    def on_particle(self, token: Token) -> None:
        clause = self.clause
        if clause.verb in ("", "weak") or clause.verb_said in _PARTED[token.said]:
            clause.verb, clause.verb_said = "remove", f"{clause.verb_said} {token.said}".strip()
        elif clause.verb != "remove":
            raise not_understood(clause.words, f"'{token.said}' after '{clause.verb_said}'")

    def on_thing(self, token: Token) -> None:
        assert token.thing is not None
        own = self.next
        own.thing, own.said = token.thing, token.said
        own.count = own.count if self.number is None else self.number
        self.number, self.next = None, Noun(Thing("", ()), "")
        self._noun(own)

    def _noun(self, noun: Noun | str) -> None:
        clause = self.clause
        if self.pending == "for" and clause.verb in ("replace", "swap"):
            clause.swapped_for = len(clause.nouns)
            self.pending = ""
        if self.pending or (isinstance(noun, str) and self.prep in ("to", "of", "in", "from")):
            if clause.anchors and self.pending != "between":
                raise not_understood(clause.words, "two places at once")
            clause.relation = self._relation()
            if noun == "window" and clause.relation == "under":
                clause.relation = "by"  # as low as the sill, wherever it stands by a window
            clause.anchors.append(noun)
            self.pending = self.prep = ""
        elif isinstance(noun, str):
            if clause.verb != "face":
                raise not_understood(clause.words, f"{noun}s stay as they are")
            clause.anchors.append(noun)
        elif self.prep == "to" or (clause.verb == "face" and clause.nouns):
            clause.relation, self.prep = clause.relation or "by", ""
            clause.anchors.append(noun)
        elif self.prep == "in":
            raise not_understood(
                clause.words, f"nothing can be put in or on '{noun.said}'", "a room, or 'next to'"
            )
        else:
            clause.nouns.append(noun)
            if self.prep == "of":
                self.prep = ""

    def _relation(self) -> str:
        return {"for": "by", "around": "by", "": "by"}.get(self.pending, self.pending)

    def on_feature(self, token: Token) -> None:
        self.next = Noun(Thing("", ()), "")
        self._noun(token.value)

    def on_room(self, token: Token) -> None:
        if self.pending:
            if self.pending not in ("for", "nearer to"):
                raise not_understood(
                    self.clause.words, f"'{self.pending}' a room", "a piece, a window or a door"
                )
            self.prep, self.pending = "to", ""
        self.clause.rooms.append((self.prep, token.value))
        self.next.is_definite = False
        self.prep = ""
        if self.next.is_every:
            self.clause.rooms[-1] = ("", f"every {token.value}")
            self.next.is_every = False

    def on_relation(self, token: Token) -> None:
        is_for = token.said == "by" and self.clause.verb in ("replace", "swap")
        self.pending = "for" if is_for else token.said if token.said in ("for", "around") else (
            token.value
        )  # fmt: skip

    def on_prep(self, token: Token) -> None:
        if token.said == "into" and self.clause.verb == "turn":
            raise not_understood(self.clause.words, "nothing turns into something else")
        self.prep = token.value

    def on_number(self, token: Token) -> None:
        self.number = float(token.value)

    def on_unit(self, token: Token) -> None:
        if self.number is None:
            raise not_understood(self.clause.words, f"how many {token.said}?")
        self.clause.distance_m, self.number = self.number * float(token.value), None
        self.next = Noun(Thing("", ()), "")

    def on_degrees(self, token: Token) -> None:
        if self.number is None:
            raise not_understood(self.clause.words, f"how many {token.said}?")
        self.clause.degrees, self.number = self.number, None
        if self.pending == "by":
            self.pending = ""

    def on_angle(self, token: Token) -> None:
        self.clause.degrees, self.number = float(token.value), None

    def on_sense(self, token: Token) -> None:
        self.clause.sense = int(token.value)

    def on_way(self, token: Token) -> None:
        self.clause.way = token.value
        self.pending = self.prep = ""

    def on_style(self, token: Token) -> None:
        if self.clause.style and self.clause.style != token.value:
            raise not_understood(self.clause.words, "two styles at once", "one style for a room")
        self.clause.style = token.value

    def on_styled(self, token: Token) -> None:
        self.prep = ""

    def on_size(self, token: Token) -> None:
        self.next.size = token.value

    def on_no(self, token: Token) -> None:
        self.next.is_denied = True

    def on_every(self, token: Token) -> None:
        self.next.is_every = True

    def on_more(self, token: Token) -> None:
        if self.clause.nouns and self.number is None:
            self.clause.nouns[-1].is_more = True
        else:
            self.next.is_more = True

    def on_less(self, token: Token) -> None:
        if self.clause.nouns:
            self.clause.nouns[-1].is_less = True
        else:
            self.next.is_less = True

    def on_only(self, token: Token) -> None:
        self.next.is_only = True

    def on_the(self, token: Token) -> None:
        self.next.is_definite = True

    def on_a(self, token: Token) -> None:
        self.next.count = 1.0

    def on_it(self, token: Token) -> None:
        self.clause.is_it = True

    def on_there(self, token: Token) -> None:
        self.clause.is_there = True
        self.prep = ""

    def on_with(self, token: Token) -> None:
        if self.clause.verb in ("replace", "swap"):
            self.pending = "for"
        elif self.clause.verb == "remove":
            raise not_understood(self.clause.words, "'with' after what is removed")
