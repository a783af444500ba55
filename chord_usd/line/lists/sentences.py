"""A sentence -> what it wants changed in a house: "turn the sofa to the window, no rug here".

All of it is understood, or nothing is: a sentence a part of which has no meaning here, or not one
meaning, raises a ChordError that says so.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.intents import Intent
from chord_usd.base.scene.types import Room, SceneGraph
from chord_usd.line.lists.clauses import WHERE, Clause, not_understood
from chord_usd.line.lists.said_clauses import clauses_of
from chord_usd.line.lists.verbs import Reader


@dataclass(frozen=True)
class Understood:
    """What a sentence says."""

    intents: tuple[Intent, ...]
    read_as: tuple[str, ...] = ()
    """Misspelt words, and what they were taken for."""
    answer: str = ""
    """To a question, which asks for no change."""

    @property
    def told(self) -> list[str]:
        """In words, one line for each thing to do, or the answer."""
        return [intent.wording for intent in self.intents] or [self.answer]


def understand(sentence: str, graph: SceneGraph, rooms: Mapping[str, Room]) -> Understood:
    """What a sentence wants changed in a house.

    rooms: of the house, by the names of their prims, named as people call them. Raises ChordError.
    """
    reader = Reader(graph, rooms)
    read = clauses_of(sentence, rooms, reader.answer)
    if read.answer:
        return Understood((), tuple(read.slips), read.answer)
    intents: list[Intent] = []
    for at, clause in enumerate(read.clauses):
        following = read.clauses[at + 1 :]
        if intents and (worn := _worn(intents[-1], clause)):
            intents[-1] = worn
            continue
        try:
            more = reader.intents(clause, following)
        except ChordError as error:
            known = "; ".join(intent.wording for intent in intents)
            raise _with_known(error, known) if known else error from None
        intents += [intent for intent in more if intent not in intents]
    if not intents:
        raise not_understood(" ".join(sentence.split()), "it asks for nothing")
    _refuse_contradictions(intents)
    return Understood(tuple(intents), tuple(read.slips))


def _worn(intent: Intent, clause: Clause) -> Intent | None:
    """A new piece in a look that is said after it: "make the sofa bigger. Dark leather." """
    rest = clause.nouns or clause.rooms or clause.surfaces or clause.verb or clause.is_it
    if intent.new is None or intent.action == "remove" or clause.coat is None or rest:
        return None
    wording = f"{intent.wording}, {clause.coat.name}"
    return replace(intent, new=replace(intent.new, coat=clause.coat), wording=wording)


def _with_known(error: ChordError, known: str) -> ChordError:
    return ChordError(
        f"{error.what} (understood: {known})", where=error.where, expected=error.expected,
        try_=error.try_,
    )  # fmt: skip


def _refuse_contradictions(intents: Sequence[Intent]) -> None:
    """Raises ChordError where one thing undoes another."""
    for at, intent in enumerate(intents):
        for other in intents[at + 1 :]:
            shared = set(intent.items) & set(other.items)
            kinds = {intent.action, other.action}
            ends = kinds & {"remove", "replace"}
            moves = {"move", "turn", "face", "swap", "replace", "remove"}
            clash = bool(shared) and (
                bool(ends) or kinds == {"lock", "unlock"}
                or ("lock" in kinds and bool(kinds & moves))
                or (intent.action == other.action and intent != other and intent.action != "lock")
            )  # fmt: skip
            if intent.action == other.action and intent.action in ("style", "paint") and not shared:
                clash = intent != other and (intent.room, intent.surface) == (
                    other.room,
                    other.surface,
                )
                clash = clash and not intent.items
            clash = clash or _comes_and_goes(intent, other)
            if clash:
                raise ChordError(
                    f"'{intent.wording}' and '{other.wording}' contradict each other", where=WHERE,
                    expected="one of the two",
                )  # fmt: skip


def _comes_and_goes(intent: Intent, other: Intent) -> bool:
    """Whether a kind of piece is added to a room and is not to be there."""
    for add, gone in ((intent, other), (other, intent)):
        if add.action == "add" and gone.action == "remove" and add.room == gone.room and add.new:
            barred = gone.new
            if barred and barred.category == add.new.category:
                return True
    return False
