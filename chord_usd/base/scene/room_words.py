"""The words of room_words.tsv, by what is asked of them."""

from __future__ import annotations

import csv
import unicodedata
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Literal, cast, get_args

from chord_usd.base.scene.types import RoomKind

Where = Literal["word", "label", "alone", "han"]

ROOM_KINDS = frozenset(get_args(RoomKind)) - {"unknown"}

_FILE = Path(__file__).with_name("room_words.tsv")
_SHORTEST_ALIKE, _SHORTEST_MISSPELT = 5, 7
"""In letters: shorter words are too near to others."""

_FLATTENED = str.maketrans(
    {"ß": "ss", "ø": "o", "æ": "ae", "œ": "oe", "ð": "d", "ł": "l", "đ": "d", "ı": "i"}
)
_SPELT_OUT = str.maketrans({"ä": "ae", "ö": "oe", "ü": "ue", "å": "aa", "ø": "oe"})
_ACCENTS = (("\u0300", "\u036f"), ("\u0591", "\u05c7"))
"""Of Latin and Cyrillic letters, and the points of Hebrew."""

_LOOKALIKES = (("rn", "m"), ("vv", "w"))
_CONFUSED = str.maketrans("0qe1jl58269hu", "oociiisbzggnv")


@dataclass(frozen=True)
class Word:
    """A word, and what it says of a room."""

    text: str
    means: str
    """A kind of room, or a role: see room_words.tsv."""
    where: Where

    @property
    def is_room(self) -> bool:
        return self.means in ROOM_KINDS


def plain(text: str) -> str:
    """Without accents: "Küche" -> "kuche". text: in lower case."""
    if text.isascii():
        return text
    parts = unicodedata.normalize("NFD", text.translate(_FLATTENED))
    kept = (c for c in parts if not any(low <= c <= high for low, high in _ACCENTS))
    return unicodedata.normalize("NFC", "".join(kept))


def skeleton(word: str) -> str:
    """The word with all letters made one that OCR takes for another: "bedr00m" and "bedroom"."""
    for drawn, meant in _LOOKALIKES:
        word = word.replace(drawn, meant)
    return word.translate(_CONFUSED)


class _Words:
    """The table, read when it is first asked."""

    @cached_property
    def _all(self) -> list[Word]:
        """Rooms first: what names a room may also say which."""
        with _FILE.open(encoding="utf-8", newline="") as file:
            lines = [line for line in file if not line.startswith("#")]
        table = csv.reader(lines, delimiter="\t", quoting=csv.QUOTE_NONE)
        words = [
            Word(text, means, cast(Where, where))
            for means, _, where, texts in table
            for text in texts.split()
        ]
        return sorted(words, key=lambda word: not word.is_room)

    @cached_property
    def exact(self) -> dict[str, Word]:
        """By spelling, without accents and blanks; "ü" may be spelt "ue"."""
        by_spelling: dict[str, Word] = {}
        for word in self._all:
            if word.where != "han" and word.means not in ("and", "of"):
                bare = word.text.replace("_", "").replace("'", "")
                for spelt in (bare, bare.translate(_SPELT_OUT)):
                    by_spelling.setdefault(plain(spelt), word)
        return by_spelling

    @cached_property
    def roles(self) -> dict[str, str]:
        """Words that join: "and" or "of"."""
        return {plain(w.text): w.means for w in self._all if w.means in ("and", "of")}

    @cached_property
    def han(self) -> list[Word]:
        """Of scripts without blanks, the longest first."""
        return sorted((w for w in self._all if w.where == "han"), key=lambda w: -len(w.text))

    @cached_property
    def spoken(self) -> dict[str, RoomKind]:
        """What names a room in a sentence, too."""
        return {
            key: cast(RoomKind, word.means)
            for key, word in self.exact.items()
            if word.where == "word"
        }

    @cached_property
    def alike(self) -> dict[str, Word]:
        """By skeleton."""
        return {
            skeleton(key): word
            for key, word in self.exact.items()
            if word.is_room and word.where != "alone" and len(key) >= _SHORTEST_ALIKE
        }

    @cached_property
    def without_one(self) -> dict[str, Word]:
        """By skeletons that lack one letter, though not the first."""
        return {
            key[:i] + key[i + 1 :]: word
            for key, word in self.alike.items()
            if len(key) >= _SHORTEST_MISSPELT
            for i in range(1, len(key))
        }


WORDS = _Words()
