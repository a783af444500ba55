"""What a room is, from what people call it, in 17 languages and in draughtsmen's short forms.

The words are in room_words.tsv. A name is taken apart until its parts are words that are known:
at blanks and separators, then compounds ("Elternschlafzimmer"), then letters that OCR confuses.
A name most of which stays unknown is no room's: addresses, brands and sentences about rooms hold
their words, too.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from typing import cast

from chord_usd.base.scene.room_words import ROOM_KINDS, WORDS, Word, plain, skeleton
from chord_usd.base.scene.types import WET_KINDS, RoomKind

LEADING: tuple[RoomKind, ...] = (
    "living", "bedroom", "kitchen", "bathroom", "dining", "study", "washroom", "wc", "balcony",
    "store", "corridor",
)  # fmt: skip
"""The kind of an open plan is that of its leading part; a wardrobe in a bedroom is no store."""

_LEAST_KNOWN = 0.5
"""Share of a name's letters that must be known."""

_OPEN_PLAN: frozenset[RoomKind] = frozenset({"living", "dining", "kitchen"})
_ANNEXES: frozenset[RoomKind] = frozenset({*WET_KINDS, "store", "balcony", "corridor"})
"""Named after the room that they belong to: "Bedroom closet"."""

_OF_LETTER: dict[str, RoomKind] = {"l": "living", "d": "dining", "k": "kitchen"}
_SEVERAL: dict[str, tuple[RoomKind, ...]] = {
    "tupakeittio": ("living", "kitchen"), "tupak": ("living", "kitchen"),
    "wohnkuche": ("living", "kitchen"),
    "livingdining": ("living", "dining"), "kitchendining": ("kitchen", "dining"),
    "kitchendiner": ("kitchen", "dining"), "woonkeuken": ("kitchen", "dining"),
    "keittiotupa": ("living", "kitchen"),
}  # fmt: skip
"""Words for more than one room, as scene.room_words.plain spells them."""

_LONGEST_PHRASE = 4
_LONGEST_NAME = 80
_SHORTEST_COMPOUND, _SHORTEST_PART = 6, 3
_LINKS = ("s", "n", "en", "e")
"""Letters between the parts of German, Dutch and Scandinavian compounds."""

_SHORTEST_ABBREVIATION = 4
_SHORTEST_LOOKALIKE, _SHORTEST_MISSPELT = 5, 8
"""In letters: shorter words are too near to one another."""
_UNITS = frozenset(("m", "cm", "mm", "qm", "kvm", "sqm", "sq", "ft", "sf", "in", "feet", "jo"))

_TOKEN = re.compile(r"[^\W_]+\.?|[/+&,;|()\n]")
_CODE = re.compile(
    r"[^\W\d_]{1,4}\.?\s*(?:=\s*[-+±]?\d[\d.,]*|:?\s*[-+±]?\d{3,4})\s*(?:mm|cm|m)?\s*"
)
"""A height or a width with its letters: "LD:930" (a sill), "BH=700", "OH 2400"."""
_NUMBERED = re.compile(r"(\d*)(.*?)(\d*)(\.?)")
_UNBLANKED = re.compile(r"[\u3040-\u30ff\u3400-\u9fff\uac00-\ud7af々〆]+")
"""Scripts that put no blanks between words."""


def room_kind(name: str) -> RoomKind:
    """The kind that a room's name speaks of ("Master Bedroom 2" -> "bedroom"), else "unknown".

    Of several rooms in one name ("Kitchen / Dining Room") the leading one counts. What is not
    mostly made of known words has no kind, nor has what speaks of streets, firms or the sheet.
    """
    return next(iter(room_kinds(name)), "unknown")


def room_kinds(name: str) -> tuple[RoomKind, ...]:
    """All kinds that a room's name speaks of, the leading one first: a "Kitchen / Dining Room", an
    LDK and a "Wohnküche" are two or three rooms on one floor. Empty where it names none."""
    return _kinds(name) if len(name) <= _LONGEST_NAME else ()


@lru_cache(4096)
def _kinds(name: str) -> tuple[RoomKind, ...]:
    folded = unicodedata.normalize("NFKC", _humps_parted(name)).casefold()
    if _CODE.fullmatch(folded):
        return ()
    # Japanese sheets: LDK, DK and K, with the area behind them.
    if match := re.match(r"[^a-z]*(s?ldk|ld|dk)(?![a-z])", folded):
        return _by_rank(_OF_LETTER[letter] for letter in match[1] if letter in _OF_LETTER)
    pieces = _pieces(folded)
    if any(piece.means == "not" for piece in pieces):
        return ()
    content = [piece for piece in pieces if piece.means not in ("page", "of", "and", "part")]
    letters = sum(piece.letters for piece in content)
    known = sum(piece.letters for piece in content if piece.means)
    if not letters or known / letters < _LEAST_KNOWN:
        return ()
    kinds = {kind for part in _parts(pieces) for kind in _kinds_of_part(part)}
    if not kinds and known == letters and not any(piece.means == "page" for piece in pieces):
        kinds = {cast(RoomKind, piece.means) for piece in pieces if piece.means in ROOM_KINDS}
    folded_words = set(re.split(r"[\W\d_]+", plain(folded)))
    for word, several in _SEVERAL.items():
        kinds |= set(several) if word in folded_words else set()
    if len(kinds.intersection(WET_KINDS)) > 1:
        # A WC with a shower or a washing machine in it.
        kinds = kinds.difference(WET_KINDS) | {"bathroom"}
    return _by_rank(kinds)


def _by_rank(kinds: Iterable[RoomKind]) -> tuple[RoomKind, ...]:
    return tuple(sorted(set(kinds), key=LEADING.index))


@dataclass(frozen=True)
class _Piece:
    """A word, or several that are one, and what is known of it."""

    means: str
    """A kind of room, a role (see room_words.tsv), "part" for a separator, or "" if unknown."""
    letters: int
    is_weak: bool = False
    """Whether it counts only where nothing unknown stands beside."""


def _pieces(folded: str) -> list[_Piece]:
    """The words of a name in the order in which they are written."""
    pieces: list[_Piece] = []
    end = 0
    for run in _UNBLANKED.finditer(folded):
        pieces += [*_spaced(folded[end : run.start()]), *_unblanked(run[0])]
        end = run.end()
    return [*pieces, *_spaced(folded[end:])]


def _kinds_of_part(part: list[_Piece]) -> tuple[RoomKind, ...]:
    """What stands between separators: most languages say last what the room is."""
    kinds: list[RoomKind] = []
    for piece in part:
        if piece.means == "of" and kinds:
            break
        if piece.means in ROOM_KINDS and not piece.is_weak:
            kinds.append(cast(RoomKind, piece.means))
    if kinds and kinds[-1] not in _ANNEXES and _OPEN_PLAN.issuperset(kinds):
        return _by_rank(kinds)
    return tuple(kinds[-1:])


def _parts(pieces: Iterable[_Piece]) -> list[list[_Piece]]:
    parts: list[list[_Piece]] = [[]]
    for piece in pieces:
        if piece.means in ("part", "and"):
            parts.append([])
        else:
            parts[-1].append(piece)
    return parts


# Words with blanks between them -------------------------------------------------------------------


def _spaced(text: str) -> Iterator[_Piece]:
    tokens = _tokens(text)
    index = 0
    while index < len(tokens):
        token = tokens[index]
        if _is_sign(token):
            if token in "/+&,;|()\n":
                yield _Piece("part", 0)
            index += 1
            continue
        taken, word = _phrase(tokens, index)
        if word is not None:
            yield _piece(word, sum(map(len, tokens[index : index + taken])))
        else:
            is_counted = index > 0 and tokens[index - 1] == "#"
            yield from _single(token, is_alone=len(tokens) == 1, is_counted=is_counted)
        index += taken


def _tokens(text: str) -> list[str]:
    """Words without accents, numbers as "#", separators; abbreviations keep their point."""
    # w.c., A/C, с/у
    joined = re.sub(r"\b([^\W\d_])[./]\s?(?=[^\W\d_]\b)", r"\1", plain(text))
    tokens = [part for match in _TOKEN.finditer(joined) for part in _unnumbered(match[0])]
    words = [token for token in tokens if not _is_sign(token)]
    if len(words) > 3 and all(len(word.rstrip(".")) == 1 for word in words):
        return ["".join(word.rstrip(".") for word in words)]  # K I T C H E N
    return tokens


def _unnumbered(token: str) -> list[str]:
    """ "bedroom2" -> "bedroom", "#"; digits that are misread letters stay where they are."""
    match = _NUMBERED.fullmatch(token)
    if match is None or not (match[1] or match[3]):
        return [token]
    if match[2] not in WORDS.exact and skeleton(token) in WORDS.alike:
        return [token]
    parts = ["#" * bool(match[1]), match[2] + match[4], "#" * bool(match[3])]
    return [part for part in parts if part not in ("", ".")]


def _is_sign(token: str) -> bool:
    return token[0] in "#/+&,;|()\n"


def _phrase(tokens: list[str], index: int) -> tuple[int, Word | None]:
    """The longest known phrase from here on, and how many tokens it takes."""
    for taken in range(min(_LONGEST_PHRASE, len(tokens) - index), 1, -1):
        window = tokens[index : index + taken]
        if any(_is_sign(token) for token in window):
            continue
        joined = "".join(token.rstrip(".") for token in window)
        word = WORDS.exact.get(joined)
        if word is None and len(joined) >= _SHORTEST_MISSPELT:
            word = WORDS.alike.get(skeleton(joined))
        # "Bed" and "en" make no word; parts of it that have meanings of their own keep these.
        if word is not None and word.is_room:
            return taken, word
    return 1, None


def _single(token: str, is_alone: bool, is_counted: bool) -> Iterator[_Piece]:
    """A word by itself. is_alone: nothing else is written; is_counted: a number is before it."""
    bare = token.rstrip(".")
    letters = len(bare)
    if not is_alone and bare in WORDS.roles:
        yield _Piece(WORDS.roles[bare], letters)
    elif bare in WORDS.exact:
        yield _piece(WORDS.exact[bare], letters)
    elif letters == 1 or bare in _UNITS:
        return
    elif bare.endswith("s") and bare[:-1] in WORDS.exact:
        # "4 bedrooms" is what an advertisement counts.
        yield _Piece("", letters) if is_counted else _piece(WORDS.exact[bare[:-1]], letters)
    elif parts := _compound(bare):
        for part in parts:
            yield _piece(part, 0)
        yield _Piece("qualifier", letters)
    elif word := _misread(bare) or (_abbreviated(bare) if token.endswith(".") else None):
        yield _piece(word, letters)
    else:
        yield _Piece("", letters)


def _piece(word: Word, letters: int) -> _Piece:
    return _Piece(word.means, letters, word.where == "alone")


def _compound(word: str) -> list[Word]:
    """The known words that one is put together from, the fewest possible; none for no way."""
    if not _SHORTEST_COMPOUND <= len(word) <= _LONGEST_NAME:
        return []
    ways: dict[int, list[Word]] = {0: []}
    for end in range(_SHORTEST_PART, len(word) + 1):
        for start in range(end - _SHORTEST_PART + 1):
            known = WORDS.exact.get(word[start:end])
            if start not in ways or known is None:
                continue
            links = [len(link) for link in _LINKS if word.startswith(link, end)]
            for place in (end, *(end + long for long in links if end + long < len(word))):
                if place not in ways or len(ways[start]) + 1 < len(ways[place]):
                    ways[place] = [*ways[start], known]
    parts = ways.get(len(word), [])
    return parts if any(part.is_room and part.where != "alone" for part in parts) else []


def _misread(word: str) -> Word | None:
    """The known word that OCR made this of: letters confused, one lost, added or replaced."""
    if len(word) < _SHORTEST_LOOKALIKE:
        return None
    alike = skeleton(word)
    if alike in WORDS.alike:
        return WORDS.alike[alike]
    shorter = [alike[:place] + alike[place + 1 :] for place in range(1, len(alike))]
    ways = [WORDS.without_one.get(alike)]
    if len(alike) >= _SHORTEST_MISSPELT:
        ways += [WORDS.alike.get(less) for less in shorter]
        ways += [WORDS.without_one.get(less) for less in shorter]
    return next((word for word in ways if word), None)


def _abbreviated(word: str) -> Word | None:
    """What all known words that begin so are called, if they are of one kind."""
    if len(word) < _SHORTEST_ABBREVIATION:
        return None
    longer = [known for key, known in WORDS.exact.items() if key.startswith(word)]
    return longer[0] if longer and len({known.means for known in longer}) == 1 else None


def _humps_parted(name: str) -> str:
    """ "DiningRoom" -> "Dining Room"."""
    return re.sub(r"(?<=[a-zà-ÿ])(?=[A-ZÀ-Þ][a-zà-ÿ])", " ", name)


# Chinese, Japanese, Korean ------------------------------------------------------------------------


def _unblanked(run: str) -> Iterator[_Piece]:
    place = 0
    for start, end, word in _han_words(run):
        if start > place:
            yield _Piece("", start - place)
        yield _Piece(word.means, end - start)
        place = end
    if place < len(run):
        yield _Piece("", len(run) - place)


def _han_words(text: str) -> Iterator[tuple[int, int, Word]]:
    place = 0
    while place < len(text):
        match = next((w for w in WORDS.han if text.startswith(w.text, place)), None)
        if match:
            yield place, place + len(match.text), match
        place += len(match.text) if match else 1


def kinds_in_han(text: str) -> list[tuple[int, int, RoomKind]]:
    """Room names in Chinese, Japanese or Korean: from where, to where, and what they name."""
    return [
        (start, end, cast(RoomKind, w.means)) for start, end, w in _han_words(text) if w.is_room
    ]


# Sentences ----------------------------------------------------------------------------------------


def kind_of_word(word: str, english: bool, inflected: bool = True) -> RoomKind | None:
    """The kind that one word of a sentence names, in Latin letters; singular or plural.

    Stricter than room_kind: short forms that only stand on drawings are words of a sentence, too.
    english: whether the sentence is; a German "Bad" is none in it. inflected: whether a known word
    with an ending that is not a plural will do.
    """
    said = plain(unicodedata.normalize("NFKC", word).casefold())
    others = _OTHER_IN_ENGLISH if english else _OTHER_BUT_IN_ENGLISH
    if (len(said) < _SHORTEST_WORD and said != "wc") or said in others:
        return None
    stems = [said, *(said.removesuffix(end) for end in _PLURALS if said.endswith(end))]
    stems += [said[:-3] + "y"] if said.endswith("ies") else []
    for stem in stems:
        if stem in WORDS.spoken and stem not in others:
            return WORDS.spoken[stem]
    known_words = (word for word in WORDS.spoken if inflected and word not in others)
    longer = (known for known in known_words if len(known) > 5 and said.startswith(known))
    best = max((known for known in longer if len(said) - len(known) <= 4), key=len, default=None)
    return WORDS.spoken[best] if best else None


_SHORTEST_WORD = 3
_PLURALS = ("s", "es", "n", "en", "r", "er", "t", "ta")
_OTHER_IN_ENGLISH = frozenset(["bad", "cuarto", "quarto", "dormitorio"])
_OTHER_BUT_IN_ENGLISH = frozenset(["den", "hall", "closet"])
