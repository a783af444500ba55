"""A text -> the wish in it: rooms by kind, floor area, whether the kitchen is open.

English, and the other languages of room_names in plain phrases. Warnings name the words that are
not understood. A text without any wish, or with wishes that contradict each other or cannot be
built, is an error that says what was understood.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.numbers_said import HAN_NUMBERS, NUMBERS, plain_text
from chord_usd.base.scene.room_names import kind_of_word, kinds_in_han
from chord_usd.base.scene.types import RoomKind, learned_kind
from chord_usd.base.scene.wish import NAMES, WISHED_KINDS, Wish, listed

MOST_CHARACTERS = 2000
MOST_ROOMS = 24
"""As many as the largest houses that were learned from have."""
AREA_M2 = (14.0, 260.0)
"""Floor areas that were learned from."""

_LEAST_AREA_M2: dict[RoomKind, float] = {
    "living": 8.0, "dining": 4.0, "bedroom": 6.0, "kitchen": 3.0, "bathroom": 2.0, "balcony": 1.5,
    "corridor": 1.0, "study": 4.0, "store": 1.0,
}  # fmt: skip
"""Smaller ones are rarely built: what a programme needs at the very least."""

_UNITS_M2 = {
    r"sq(?:uare)?\.?[\s-]*(?:ft|feet|foot)\.?|ft2|sqft|pies? cuadrados": 1 / 10.7639,
    r"m\s?2|m\^2|sqm|qm|kvm|sq\.?\s?m(?:et(?:er|re)s?)?\b\.?|square[\s-]*met(?:er|re)s?"
    r"|quadratmetern?|metres? carres?|metros? (?:cuadrados|quadrados)|kvadratmeter"
    r"|nelio(?:ta|metria|n)?|平方米|平米|平方メートル": 1.0,
    r"畳|帖|jo\b|tatami": 1.62,
    r"坪|tsubo": 3.306,
}  # fmt: skip

_HAN_SHORT: dict[str, RoomKind] = {
    "室": "bedroom", "房": "bedroom", "厅": "living", "廳": "living", "卫": "bathroom",
    "衛": "bathroom", "厨": "kitchen", "廚": "kitchen",
}  # fmt: skip

_OPEN_KITCHEN = re.compile(
    r"open(?:[\s-]*plan)?[\s-]+kitchens?|kitchen (?:that is )?open to (?:the )?(?:living|dining)"
    r"(?: (?:area|room))?|offene[rn]? (?:wohn)?kuche|cuisine (?:ouverte|americaine)"
    r"|cocina (?:abierta|americana)|cozinha (?:aberta|americana)|oppet kok|avokeittio|开放式厨房"
)
_STUDIO = re.compile(r"\b(studio|bedsit|einzimmerwohnung|monolocale)\b")
_ENGLISH_WORDS = (
    "a an the with and of for bed beds bedroom bedrooms bath flat apartment house home room rooms"
    " kitchen living bathroom no without square about"
)
_ENGLISH = frozenset(_ENGLISH_WORDS.split())
_BELOW_ZERO = re.compile(
    r"(?:\b(?:minus|miinus|moins|menos|negative|negativ[aeo]?)\s+|(?:(?<=\s)|^)[-\u2212])"
    r"(?:\d+|" + "|".join(word for word, number in NUMBERS.items() if number > 1) + r")\b"
    r"(?:\s[^\s,;.]+)?"
    r"|负\s*[\d一二三四五六七八九十两]+\S?|マイナス\s*\S+"
)
_SHOWN = 60
"""Characters of a text that a warning repeats."""

_REACH = 3
"""So many words may stand between a number and what it counts."""


@dataclass(frozen=True)
class Understood:
    """What was read in a text."""

    wish: Wish
    english: bool
    """Whether the text reads as English, which is what the language model knows."""
    warnings: tuple[str, ...] = ()
    """What of the text is not heard, and why."""

    @property
    def summary(self) -> str:
        """The wish in short: "2 bedrooms, 1 kitchen, 70 m²"."""
        wet = self.wish.wet
        counts = {kind: n - sum(wet.values()) * (kind == "bathroom")
                  for kind, n in (*self.wish.counts.items(), *wet.items())}  # fmt: skip
        parts = [f"{n} {NAMES[kind][n != 1]}" for kind, n in counts.items()]
        parts += ["an open kitchen"] if self.wish.open_kitchen else []
        area_m2 = self.wish.area_m2
        if area_m2 is not None:
            parts.append(f"{area_m2:.0f} m²" if area_m2 < 1e6 else f"{area_m2:.3g} m²")
        return listed(parts)


def read_wish(text: str) -> Understood:
    """The wish in a text. Raises ChordError where there is none, or none that can be built."""
    if len(text) > MOST_CHARACTERS:
        raise _error(f"has {len(text)} characters", f"at most {MOST_CHARACTERS}")
    if not text.strip():
        raise _error("is empty")
    if any(unicodedata.category(c) in ("Cc", "Cs") and not c.isspace() for c in text):
        raise _error("holds a control character", "words and numbers")
    plain = plain_text(text)
    below = _BELOW_ZERO.search(plain)
    if below:
        raise _error(f"asks for less than nothing: '{below[0].strip()}'", "numbers from zero on")
    warnings: list[str] = []
    area_m2, rest = _area(plain, warnings)
    open_kitchen = bool(_OPEN_KITCHEN.search(rest))
    rest = _OPEN_KITCHEN.sub(" ", rest)
    words = re.findall(r"[a-z]+", plain)
    english = sum(word in _ENGLISH for word in words) >= 0.25 * max(len(words), 1)
    said, total = _counts(rest, english, warnings)
    counts, wet = _by_class(said)
    if open_kitchen and counts.get("kitchen") == 0:
        open_kitchen = False
        _drop_contradiction(counts, "kitchen", warnings)
    elif open_kitchen:
        counts.setdefault("kitchen", 1)
    if _STUDIO.search(rest):
        counts.setdefault("living", 1)
        if counts.setdefault("bedroom", 0):
            warnings.append("a studio has no bedroom of its own, but bedrooms are asked for")
    understood = Understood(Wish(counts, area_m2, open_kitchen, wet), english, tuple(warnings))
    if not counts and area_m2 is None and total is None and warnings:
        raise _error(f"cannot be planned: {listed(warnings)}")
    if not counts and area_m2 is None and total is None:
        raise _error("names no rooms and no floor area that could be understood")
    _refuse_impossible(understood, total)
    if total and not {"bedroom", "living"} & set(counts):
        # A "three-room flat" is counted without kitchen and bathroom, from the living room on.
        counts = {"living": 1, "bedroom": total - 1, **counts}
    return replace(understood, wish=Wish(counts, area_m2, open_kitchen, wet))


def _refuse_impossible(understood: Understood, total: int | None) -> None:
    wish = understood.wish
    rooms = f"{total} rooms in all, " if total is not None else ""
    summary = f"understood {rooms}{understood.summary}"
    if total == 0 or (total is not None and wish.counts.get("bedroom", 0) > total):
        raise _error(f"contradicts itself: {summary}")
    if wish.rooms > MOST_ROOMS or (total or 0) > MOST_ROOMS:
        raise _error(f"asks for more rooms than can be planned: {summary}", f"at most {MOST_ROOMS}")
    if len(wish.counts) == len(WISHED_KINDS) and not wish.rooms:
        raise _error(f"leaves no room: {summary}", "at least one room")
    if wish.area_m2 is None:
        return
    if not AREA_M2[0] <= wish.area_m2 <= AREA_M2[1]:
        raise _error(
            f"asks for a floor area that cannot be planned: {summary}",
            f"{AREA_M2[0]:.0f} to {AREA_M2[1]:.0f} m²",
        )
    least_m2 = sum(_LEAST_AREA_M2[kind] * count for kind, count in wish.counts.items())
    if least_m2 > wish.area_m2:
        raise _error(
            f"asks for more than fits: {summary}", f"at least {least_m2:.0f} m² for so much"
        )


def _error(what: str, expected: str = "rooms and a floor area, in words") -> ChordError:
    return ChordError(
        f"the text {what}",
        where="<text>",
        expected=expected,
        try_='"a two-bedroom flat with an open kitchen and a bathroom, about 70 m²"',
    )


_DIGITS = r"(?:(?<![a-z\d.,])\d[\d.,]*(?:e[+-]?\d+)?)"
"""A number from its first digit on: the 99 of 1e99 is none."""


def _area(text: str, warnings: list[str]) -> tuple[float | None, str]:
    """The floor area in square metres, the largest of several, and the text without it."""
    areas: list[float] = []
    for units, factor in _UNITS_M2.items():
        pattern = re.compile(rf"({_DIGITS}|(?:\b[a-z]+)(?:[\s-][a-z]+)??)[\s-]*(?:{units})")
        for match in pattern.finditer(text):
            number = _number(match[1])
            if number is not None:
                areas.append(number * factor)
                text = text.replace(match[0], " ", 1)
    unheard = [f"{area:.0f} m²" for area in sorted(areas)[:-1] if area < 0.95 * max(areas)]
    if unheard:
        warnings.append(f"{listed(unheard)}: only the floor area of the whole is heard")
    return (max(areas) if areas else None), text


def _number(said: str) -> float | None:
    """A number in digits ("1,200", "72.5") or words ("seventy five")."""
    if said[0].isdigit():
        digits = said.rstrip(".,")
        if "e" in digits:
            return _in_powers(digits)
        if re.fullmatch(r"\d{1,3}([.,]\d{3})+", digits):
            return float(re.sub(r"[.,]", "", digits))
        return (
            float(digits.replace(",", ".")) if digits.count(",") + digits.count(".") < 2 else None
        )
    numbers = [NUMBERS.get(word) for word in re.split(r"[\s-]", said)]
    known = [number for number in numbers if number is not None]
    return float(sum(known)) if known and numbers[-1] is not None else None


def _in_powers(digits: str) -> float | None:
    """A number as programs write it: "1e3"."""
    try:
        return float(digits.replace(",", "."))
    except ValueError:
        return None


def _counts(
    text: str, english: bool, warnings: list[str]
) -> tuple[dict[RoomKind, int], int | None]:
    """Rooms by kind, and rooms in all where the text says so."""
    counts: dict[RoomKind, int] = {}
    denied: set[RoomKind] = set()
    total: int | None = None
    ldk = _LDK.search(text)
    if ldk:
        counts |= _ldk(int(ldk[1]), ldk[2])
        text = text.replace(ldk[0], " ")
    for kind, number in [*_latin(text, english, warnings), *_han(text)]:
        if kind is None:
            if total not in (None, number):
                warnings.append(f"{total} rooms in all and {number}: the first is heard")
            total = number if total is None else total
            continue
        if number == 0:
            denied.add(kind)
        counts[kind] = counts.get(kind, 0) + number
    for kind in NAMES:
        if kind in denied and counts[kind]:
            _drop_contradiction(counts, kind, warnings)
    return counts, total


def _by_class(
    counts: Mapping[RoomKind, int],
) -> tuple[dict[RoomKind, int], dict[RoomKind, int]]:
    """Rooms by the classes that networks plan, and how many bathrooms are washrooms and WCs. A home
    of which no other wet room is named has its toilet in a bathroom."""
    wet = {kind: n for kind, n in counts.items() if learned_kind(kind) != kind and n}
    merged = {kind: n for kind, n in counts.items() if learned_kind(kind) == kind}
    if wet:
        alone = "bathroom" not in merged and "wc" in wet
        merged["bathroom"] = merged.get("bathroom", 0) + sum(wet.values())
        wet = {kind: n - (alone and kind == "wc") for kind, n in wet.items()}
    return merged, {kind: n for kind, n in wet.items() if n}


def _drop_contradiction(counts: dict[RoomKind, int], kind: RoomKind, warnings: list[str]) -> None:
    """Drops a kind that is wished and refused; the rest of the text counts."""
    del counts[kind]
    warnings.append(f"{NAMES[kind][1]} are asked for and denied: how many is left open")


_LDK = re.compile(r"(\d)\s?(s?ldk|dk|k)\b")


def _ldk(rooms: int, tail: str) -> Mapping[RoomKind, int]:
    """Japanese agents' short form: 2LDK has two rooms beside living, dining and kitchen."""
    counts: dict[RoomKind, int] = {"bedroom": rooms, "kitchen": 1}
    return counts | ({"living": 1} if "l" in tail else {})


def _latin(text: str, english: bool, warnings: list[str]) -> Iterator[tuple[RoomKind | None, int]]:
    """Kinds of rooms and the numbers before them; None for "rooms" of no kind."""
    words = re.findall(r"\d+[.,]5(?!\d)|\d+|[a-z]+|[,;.]", text)
    number: int | None = None
    since, index, said_at = 0, 0, 0
    while index < len(words):
        word = words[index]
        kind, taken = _kind_at(words, index, english)
        if kind:
            # "bedrooms": some, how many is left open; two is what it says at least.
            several = english and words[index + taken - 1].endswith(("rooms", "beds", "baths"))
            yield kind, (1 + several if number is None else number)
            # "no study or storeroom" denies both.
            number = (
                0 if number == 0 and words[index + taken : index + taken + 1] == ["or"] else None
            )
            since = 0
        elif word in _ROOM_WORDS and number is not None:
            yield None, number
            number = None
        elif word[0].isdigit() or word in NUMBERS:
            said = _counted(word, warnings)
            if said > 1 and number not in (None, 0, 1, said):
                warnings.append(f"{number} and then {said}: the last is heard")
            # "no" and "without a" stay a denial; "a two-bed flat" is no "one".
            number = 0 if number == 0 and said == 1 else said
            since, said_at = 0, index
        elif since >= _REACH or word in ",;.":
            warnings += _unheard(words[said_at:index], number)
            number, since = None, 0
        else:
            since += 1
        index += taken
    warnings += _unheard(words[said_at:], number)


def _counted(word: str, warnings: list[str]) -> int:
    """A number of rooms. Half a bathroom has no bath, half a room is a small one: one each."""
    if word in NUMBERS:
        return NUMBERS[word]
    if word.isdigit():
        return int(word)
    whole = int(word[:-2]) + 1
    warnings.append(f"{word} rooms are heard as {whole}")
    return whole


def _unheard(words: list[str], number: int | None) -> list[str]:
    """What to say of a number that counts nothing; "one" is an article in many languages."""
    if number is None or number == 1:
        return []
    return [f"'{' '.join(words)[:_SHOWN]}' is not understood"]


_ROOM_WORDS = frozenset(
    ("room", "rooms", "zimmer", "pieces", "habitaciones", "rum", "huonetta", "huone")
)


def _kind_at(words: list[str], index: int, english: bool) -> tuple[RoomKind | None, int]:
    """The kind that the words from here on name, longest name first, and how many they are."""
    for taken in (3, 2, 1):
        joined = "".join(words[index : index + taken])
        whole = len(words) >= index + taken and joined.isalpha()
        kind = kind_of_word(joined, english, inflected=taken == 1) if whole else None
        if kind and kind != "unknown":
            more = _ROOM_TAILS & set(words[index + taken : index + taken + 1])
            return kind, taken + len(more)
    return None, 1


_ROOM_TAILS = frozenset(("room", "rooms", "area", "areas"))


def _han(text: str) -> Iterator[tuple[RoomKind, int]]:
    """Rooms in Chinese and Japanese: 三室两厅, 2つの寝室."""
    names = kinds_in_han(text)
    covered = {place for start, end, _ in names for place in range(start, end)}
    names += [(i, i + 1, _HAN_SHORT[c]) for i, c in enumerate(text)
              if c in _HAN_SHORT and i not in covered]  # fmt: skip
    for start, _end, kind in sorted(names):
        before = re.search(
            r"(\d+|[〇一二三四五六七八九十两兩无無])\s*(?:つの|个|個|間|间)?$", text[:start]
        )
        yield kind, (_han_number(before[1]) if before else 1)


_HAN_COUNT = re.compile(r"(\d+|[〇一二三四五六七八九十两兩无無])\s*(?:つの|个|個|間|间)?$")


def _han_number(said: str) -> int:
    return int(said) if said.isdigit() else HAN_NUMBERS[said]
