"""A sentence -> its clauses, or the answer to a question."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.numbers_said import plain_text
from chord_usd.base.scene.room_names import kind_of_word, room_kind
from chord_usd.base.scene.types import Room
from chord_usd.line.lists.clause_parser import clauses_in, joined
from chord_usd.line.lists.clauses import WHERE, Clause, not_understood
from chord_usd.line.lists.edit_words import (
    Token,
    is_unit,
    mended,
    tokens,
    words_of,
)
from chord_usd.line.lists.speech_acts import acts_of

MOST_CHARACTERS = 1000
_EXAMPLE = "<edit=put a plant in bedroom 1, no rug in the hall>"

_LONGEST_ROOM = 5
_ROOM_WORDS = frozenset((
    "living", "sitting", "dining", "bath", "bed", "master", "main", "entrance", "front", "room",
    "rooms", "area", "first", "second", "third", "fourth", "every", "each", "all", "both",
))  # fmt: skip
_NUMBERED = frozenset(("one", "two", "three", "four", "five", "six"))
_OUTSIDE = ("outside", "outdoors")


Answer = Callable[[Sequence[Token]], str]
"""What a house has of the pieces that a question names, in words."""


@dataclass(frozen=True)
class Read:
    """A sentence, taken apart."""

    clauses: Sequence[Clause] = ()
    """In its order; none of a question."""
    slips: Sequence[str] = ()
    """Which words were read as which others."""
    answer: str = ""
    """To a question."""


def clauses_of(sentence: str, rooms: Mapping[str, Room], answer: Answer) -> Read:
    """The clauses of a sentence.

    rooms: by the names of their prims, named as people call them. Raises ChordError for a sentence
    that is empty, too long, holds words that have no meaning here, or orders nothing.
    """
    if not sentence.strip():
        raise ChordError("is empty", where=WHERE, expected="a change, in English")
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
    if "question" in acts:
        return Read(slips=slips, answer=answer(read))
    if acts[-1] == "statement":
        raise ChordError(
            f"{' '.join(sentence.split())!r} states something, and changes nothing", where=WHERE,
            expected="an order, also after what it is about", try_=_EXAMPLE,
        )  # fmt: skip
    _refuse_unknown(read, sentence)
    return Read(joined(list(clauses_in(read, acts))), slips)


def _rooms_in(words: list[str], rooms: Mapping[str, Room]) -> dict[int, tuple[int, str]]:
    """Where rooms are named: from which word, how many words, and the name."""
    names = {plain_text(name) for room in rooms.items() for name in (room[0], room[1].name)}
    matches: dict[int, tuple[int, str]] = {}
    for start in range(len(words)):
        for taken in range(min(_LONGEST_ROOM, len(words) - start), 0, -1):
            part = words[start : start + taken]
            is_measure = part[-1].isdigit() and is_unit(words[start + taken :][:1])
            if " ".join(part) in names or (_is_room(part) and not is_measure):
                matches[start] = taken, " ".join(part)
                break
            if taken == 1 and part[0] in _OUTSIDE:
                matches[start] = 1, "balcony"
    return matches


def _is_room(words: list[str]) -> bool:
    """Whether words name a room of some kind: "the second bedroom" without its article."""
    *front, last = words
    if last.isdigit() or (last in _NUMBERED and front):
        words = front
    kinds = [word for word in words if kind_of_word(word, english=True, inflected=False)]
    plain = all(word in kinds or word in _ROOM_WORDS for word in words)
    if not words or not plain or words[-1] in (*_NUMBERED, "stairs", "staircase"):
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
    for at, token in enumerate(read):
        after = read[at + 1].kind if at + 1 < len(read) else ""
        if token.kind in ("unknown", "cannot") or (token.coat and after == "unknown"):
            runs[-1].append(token.said)
        elif runs[-1]:
            runs.append([])
    strange = [" ".join(run) for run in runs if run]
    if not strange:
        return
    words = ", ".join(repr(word) for word in strange)
    error = not_understood(
        " ".join(sentence.split()), f"{words} has no meaning here",
        "pieces, rooms, places, turns, colours, styles and counts, in English", _EXAMPLE,
    )  # fmt: skip
    named = [run for run in strange if run in _named_things(read)]
    raise UnknownThingError(error, named[0]) if named else error


class UnknownThingError(ChordError):
    """Names a piece that is not known here."""

    def __init__(self, error: ChordError, thing: str) -> None:
        super().__init__(error.what, where=error.where, expected=error.expected, try_=error.try_)
        self.thing = thing


def _named_things(read: Sequence[Token]) -> str:
    """The words that stand where a piece is named: after an article, a count or a verb."""
    words, is_named = [], False
    for token in read:
        if token.kind in ("unknown", "coat") and is_named:
            words.append(token.said)
            continue
        is_named = token.kind in ("a", "the", "more", "other", "number", "size", "scale") or (
            token.kind == "verb" and token.value in ("add", "put", "remove", "move", "replace")
        )
        words.append("|")
    return " ".join(words)
