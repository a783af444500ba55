"""What a clause of a sentence proposes: speech act, verb, pieces, places, counts, sizes, looks."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.intents import Coat
from chord_usd.line.lists.edit_words import (
    Thing,
)
from chord_usd.line.lists.speech_acts import Act

WHERE = "the sentence"


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
    is_other: bool = False
    size: Literal["", "small", "large"] = ""
    form: str = ""
    coat: Coat | None = None


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
    coat: Coat | None = None
    """What something is to look like; that of a noun belongs to its piece."""
    surfaces: list[str] = field(default_factory=list)
    scale: int = 0
    """1 for bigger, -1 for smaller."""
    percent: float | None = None
    extent_m: float | None = None
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
            or self.degrees is not None or self.is_less or self.coat or self.surfaces or self.scale
        )  # fmt: skip


def not_understood(said: str, why: str, expected: str = "", try_: str = "") -> ChordError:
    """The error for a sentence a part of which has no meaning here."""
    return ChordError(
        f"{said!r} is not understood: {why}", where=WHERE, expected=expected, try_=try_
    )
