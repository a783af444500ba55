"""What somebody wants in a room: "Bedroom 1: double bed, two chairs, no desk"."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import NamedTuple

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.numbers_said import HAN_NUMBERS, NUMBERS, plain_text
from chord_usd.base.scene.palette import CATEGORIES, TABLE_CATEGORIES
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.types import Item, Room
from chord_usd.base.scene.wish import NAMES
from chord_usd.line.lists.pieces import MOST_PIECES
from chord_usd.line.lists.vocabulary import ANY_M, HERE, WORDS, Named, named

MOST_CHARACTERS = 2000
SLACK_M = 0.08
"""Two pixels of a layout: a bed of 1.27 m is as good as one of 1.3 m."""

EXAMPLE = '"Bedroom 1: double bed, desk; Bathroom: bathtub"'

_OR = frozenset(["or", "nor", "oder", "ou", "o", "eller", "tai"])
_WITH = frozenset(["with", "mit", "avec", "con", "com", "med"])
_JOINING = _OR | _WITH | frozenset(["and", "und", "et", "y", "e", "och", "ja", "&", "+"])
_COUNTS = NUMBERS | {"pair": 2, "couple": 2}
_ARTICLES = frozenset(["x", "the", "some", "of"])
_EVERY = frozenset(["every", "each", "all", "both"])
_ORDINALS = {"first": 1, "second": 2, "third": 3, "fourth": 4, "fifth": 5}
_HAN_PIECE = re.compile(
    r"(不要|没有|沒有|无|無)?(?:(\d+|[一二三四五六七八九十两兩])[个個张張把台只隻脚つ]?の?)?"
    r"(\D+?)(なし)?"
)
_ON_TABLES = {word for row in TABLE_CATEGORIES for word in row.label.lower().split()} - {"big"}


class Piece(NamedTuple):
    """A piece that a room must hold."""

    category: str
    length_m: tuple[float, float] = ANY_M
    """From, to; words such as "double" say it."""
    word: str = ""
    """What it was called."""

    def is_met_by(self, item: Item) -> bool:
        """Whether a piece is one like this."""
        least_m, most_m = self.length_m
        length_m = item.box.size_m[0]
        return item.category == self.category and (
            least_m - SLACK_M <= length_m <= most_m + SLACK_M
        )


class Wishes(NamedTuple):
    """What was said of one room, or of one kind of room."""

    wanted: tuple[Named, ...] = ()
    """As often as they are wanted."""
    excluded: tuple[Named, ...] = ()

    def in_words(self) -> str:
        """As read_pieces reads it again, to be kept with a house."""
        return ", ".join([*(p.word for p in self.wanted), *(f"no {p.word}" for p in self.excluded)])

    def after(self, kept: Wishes, stays: Collection[str] = ()) -> Wishes:
        """These wishes with those that a room had before: of each category the last ones hold.

        stays: categories of pieces that stay in the room, which cannot be excluded any more.
        """
        last = {piece.category for piece in (*self.wanted, *self.excluded)}
        return Wishes(
            self.wanted + tuple(p for p in kept.wanted if p.category not in last),
            self.excluded + tuple(p for p in kept.excluded if p.category not in {*last, *stays}),
        )

    def without_lost(self, before: Iterable[str], after: Iterable[str]) -> Wishes:
        """These wishes without those that an edit went against: categories that a room held before
        and after it, as often as it holds pieces of them."""
        then, now = Counter(before), Counter(after)
        wanted = list(self.wanted)
        for category in {piece.category for piece in wanted}:
            of_it = [piece for piece in wanted if piece.category == category]
            lost = min(then[category], len(of_it)) - now[category]
            for piece in of_it[: max(lost, 0)]:
                wanted.remove(piece)
        return Wishes(
            tuple(wanted), tuple(p for p in self.excluded if now[p.category] <= then[p.category])
        )


@dataclass(frozen=True)
class Asked:
    """Pieces that a room must and must not hold."""

    wanted: tuple[Piece, ...] = ()
    """At least so many of each; what is kept counts."""
    excluded: frozenset[str] = frozenset()
    """Categories."""
    kept: tuple[Item, ...] = ()
    """Pieces that stand there already."""
    room: str = ""
    """Name of its prim."""
    wishes: Wishes = Wishes()  # noqa: RUF009
    """In the words that it was asked for in."""

    @property
    def is_asked(self) -> bool:
        """Whether somebody decides about the room."""
        return bool(self.wanted or self.excluded or self.kept)

    @property
    def has_lengths(self) -> bool:
        """Whether a piece is wanted as long as a word says."""
        return any(piece.length_m != ANY_M for piece in self.wanted)

    def missing(self, items: Iterable[Item]) -> tuple[Piece, ...]:
        """Which of the pieces wanted are not among the items."""
        # Who ends first is served first: no other order serves more.
        waiting = sorted(self.wanted, key=lambda piece: piece.length_m[1])
        for item in sorted(items, key=lambda candidate: candidate.box.size_m[0]):
            met = next((piece for piece in waiting if piece.is_met_by(item)), None)
            if met:
                waiting.remove(met)
        return tuple(waiting)


def read_pieces(wanted: str | None, excluded: str | None = None) -> Wishes:
    """Wishes for one room. excluded: pieces that must not be there, without a "no" before it.

    Raises ChordError, as all of this module, where a text cannot be understood.
    """
    wishes = _read(wanted, "<wish>") if wanted is not None else Wishes()
    if excluded is None:
        return wishes
    denied = _read(excluded, "<without>")
    return Wishes(
        wishes.wanted, (*wishes.excluded, *dict.fromkeys((*denied.wanted, *denied.excluded)))
    )


def read_furniture(text: str) -> tuple[tuple[str, Wishes], ...]:
    """Wishes by what rooms were called: "ROOM: PIECE, PIECE; ROOM: PIECE"."""
    where = "<furniture>"
    _refuse_odd(text, where)
    read = []
    for part in filter(str.strip, re.split(r"[;；\n]", text)):
        room, colon, pieces = re.sub("：", ":", part).partition(":")
        if not colon or not room.strip():
            raise _error(f"'{part.strip()}' names no room", where, "ROOM: PIECE, PIECE", EXAMPLE)
        read.append((room.strip(), _read(pieces, f"{where} '{room.strip()}'")))
    if not read:
        raise _error("is empty", where, "ROOM: PIECE, PIECE", EXAMPLE)
    return tuple(read)


def _read(text: str, where: str) -> Wishes:
    _refuse_odd(text, where)
    wanted: list[Named] = []
    excluded: list[Named] = []
    for part in filter(str.strip, re.split(r"[,，、\n]", text)):
        for count, piece in _pieces(part, where):
            if count > MOST_PIECES:
                raise _error(f"asks for {count} × {piece.word}", where, f"at most {MOST_PIECES}")
            if count:
                wanted += [piece] * count
            else:
                excluded.append(piece)
    if not wanted and not excluded:
        raise _error("names no piece of furniture", where, "pieces, such as: desk, two chairs")
    return Wishes(tuple(wanted), tuple(excluded))


def _refuse_odd(text: str, where: str) -> None:
    if not text.strip():
        raise _error("is empty", where, "pieces of furniture, in words")
    if len(text) > MOST_CHARACTERS:
        raise _error(f"has {len(text)} characters", where, f"at most {MOST_CHARACTERS}")


def _pieces(part: str, where: str) -> Iterator[tuple[int, Named]]:
    """Pieces between two commas, and how many of each; 0 for pieces that must not be there."""
    plain = plain_text(part).strip(" .!")
    han = _HAN_PIECE.fullmatch(plain.replace(" ", ""))
    if han and han[3] in WORDS and not han[3].isascii():
        count = HAN_NUMBERS.get(han[2]) or int(han[2]) if han[2] else 1
        yield (0 if han[1] or han[4] else count), WORDS[han[3]]
        return
    words = re.findall(r"[^\W\d_]+|[0-9]+|\S", re.sub(r"(?<=\w)[-_/'’](?=\w)", " ", plain))
    denied, name = False, list[str]()
    for word in [*words, ""]:
        denies = _COUNTS.get(word) == 0 or word == "0"
        if word and not denies and word not in _JOINING:
            name.append(word)
            continue
        if name:
            count, piece = _piece(name, where)
            # "No sofa and two chairs": who counts wants them.
            denied = denied and count < 2
            yield (0 if denied else count), piece
        name = []
        denied = denies or (denied and word not in _WITH)
    if words and (words[-1] == "0" or _COUNTS.get(words[-1]) == 0):
        raise _error(f"'{words[-1]}' is followed by nothing", where)


def _piece(words: list[str], where: str) -> tuple[int, Named]:
    """What "two double beds" names, and how many."""
    for start in range(len(words)):
        before, piece = words[:start], named(words[start:])
        counts = [int(word) if word.isdigit() else _COUNTS.get(word, 1) for word in before]
        are_counts = all(w.isdigit() or w in _COUNTS or w in _ARTICLES for w in before)
        if piece and are_counts and "double" not in before:
            if CATEGORIES[piece.category].rank is None:
                later = f"<edit=add a {piece.word} to the ROOM>"
                raise _error(f"'{piece.word}' is in no list", where, "a piece of lists", later)
            return max(counts, default=1), piece
    said = " ".join(words)
    if _ON_TABLES & {words[-1], words[-1].removesuffix("s")}:
        raise _error(f"'{said}' stands on tables, and only furniture can be asked for", where)
    nouns = [word for word in words if not (word.isdigit() or word in _COUNTS)]
    near = get_close_matches("".join(nouns), WORDS, n=3, cutoff=0.7)
    known = ", ".join(WORDS[word].word for word in near) or "furniture, such as bed, desk or sofa"
    raise _error(f"'{said}' is no piece that is known", where, known)


def rooms_meant(said: str, rooms: Mapping[str, Room], where: str = "<furniture>") -> list[Room]:
    """The rooms that a name means, by the names of their prims.

    A printed name, a prim's name, a kind with its number from 1, a kind alone (the largest of that
    kind), several ("bedrooms", "every bedroom"). where: what errors name.
    """
    plain = _words(said)
    printed = [room for room in rooms.values() if plain and _words(room.name) == plain]
    prims = [room for name, room in rooms.items() if name.casefold() == said.strip().casefold()]
    if prims or printed:
        return [_largest(prims or printed)]
    words = re.findall(r"[^\W\d]+|\d+", plain)
    every = bool(words) and words[0] in _EVERY
    number = next((_ORDINALS[word] for word in words if word in _ORDINALS), None)
    if words and (words[-1].isdigit() or words[-1] in _COUNTS):
        last = words.pop()
        number = int(last) if last.isdigit() else _COUNTS[last]
    rest = [word for word in words if word not in _EVERY and word not in _ORDINALS]
    kind = " ".join(rest)
    meant = _of_kind(kind, every, rooms)
    if any(word.isdigit() or word in _COUNTS for word in rest):
        meant = []
    elif number is not None:
        meant = meant[number - 1 : number] if number else []
    elif meant and not every and kind not in ("rooms", *(many for _, many in NAMES.values())):
        meant = [_largest(meant)]
    if not meant:
        there = ", ".join(rooms)
        raise _error(f"there is no room '{said}'", where, f"one of {there}")
    return meant


def _words(name: str) -> str:
    return " ".join(re.findall(r"[^\W_]+", plain_text(name)))


def _of_kind(word: str, every: bool, rooms: Mapping[str, Room]) -> list[Room]:
    if word == "rooms" or (every and word == "room"):
        return list(rooms.values())
    kind = room_kind(word)
    if kind == "unknown" and word != "room":
        return []
    return [room for room in rooms.values() if room.kind == kind]


def _largest(rooms: list[Room]) -> Room:
    return max(rooms, key=lambda room: room_polygon(room).area)


def furniture_asked(
    said: Iterable[tuple[str, Wishes]], rooms: Mapping[str, Room]
) -> dict[str, Asked]:
    """Wishes of rooms, by their ids. rooms: by the names of their prims."""
    by_room: dict[str, Wishes] = {}
    by_id = {room.id: (name, room) for name, room in rooms.items()}
    for name, wishes in said:
        for room in rooms_meant(name, rooms):
            before = by_room.get(room.id, Wishes())
            by_room[room.id] = Wishes(
                before.wanted + wishes.wanted, before.excluded + wishes.excluded
            )
    return {room_id: asked_in(*by_id[room_id], wishes) for room_id, wishes in by_room.items()}


def asked_in(name: str, room: Room, wishes: Wishes, kept: Iterable[Item] = ()) -> Asked:
    """The wishes of one room. name: of its prim; kept: pieces that stay in it."""
    here = HERE.get(room.kind, {})
    wanted = tuple(
        Piece(here.get(piece.word, piece.category), piece.length_m, piece.word)
        for piece in wishes.wanted
    )
    excluded = {here.get(piece.word, piece.category): piece.word for piece in wishes.excluded}
    for piece in wanted:
        if piece.category in excluded:
            said = dict.fromkeys((piece.word, excluded[piece.category]))
            raise _error(
                f"{' and '.join(said)}: wanted and excluded at once", name, "one of the two"
            )
    for item in kept:
        if item.category in excluded:
            raise _error(f"a {excluded[item.category]} is kept and excluded at once", name)
    if len(wanted) > MOST_PIECES:
        raise _error(f"{len(wanted)} pieces are asked for", name, f"at most {MOST_PIECES}")
    # Panels hang over what they belong to.
    panels = {f"{category}_background" for category in excluded} & {
        "bed_background",
        "sofa_background",
    }
    barred = {*excluded, *panels} - {piece.category for piece in wanted}
    return Asked(wanted, frozenset(barred), room=name, wishes=wishes)


def _error(what: str, where: str, expected: str = "", try_: str = "") -> ChordError:
    return ChordError(what, where=where, expected=expected, try_=try_)
