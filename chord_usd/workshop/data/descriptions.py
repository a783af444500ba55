"""Plans in words: the sentences that text-conditioned floor planning learns from.

The paper's sentence form (supplementary, "Text-conditioned floor planning") and the ways in which
people and estate agents write: numbers as digits or words, square metres or feet, some rooms
mentioned and others not, rooms that are not wanted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from chord_usd.base.scene.types import Plan, RoomKind
from chord_usd.base.scene.wish import (
    NAMES,
    WISHED_KINDS,
    Wish,
    floor_area_m2,
    has_open_kitchen,
    listed,
    room_counts,
)

NUMBER_WORDS = (
    "zero", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten",
    "eleven", "twelve",
)  # fmt: skip

SQUARE_FEET_PER_M2 = 10.7639

_OTHER_NAMES: dict[RoomKind, tuple[tuple[str, str], ...]] = {
    "living": (("lounge", "lounges"), ("sitting room", "sitting rooms")),
    "dining": (("dining area", "dining areas"),),
    "bedroom": (("bed", "beds"),),
    "bathroom": (("bath", "baths"), ("toilet", "toilets")),
    "balcony": (("terrace", "terraces"),),
    "corridor": (("hallway", "hallways"), ("hall", "halls")),
    "study": (("home office", "home offices"),),
    "store": (("storage room", "storage rooms"), ("closet", "closets")),
}
"""Words beside wish.NAMES: singular, plural."""

_PAPER_KINDS: tuple[RoomKind, ...] = ("living", "bedroom", "kitchen", "bathroom")

_DWELLINGS = ("flat", "apartment", "house", "home", "unit", "maisonette", "bungalow")
_OPENINGS = ("", "", "a ", "I want a ", "Please design a ", "we are looking for a ", "Draw a ")

MENTION_CHANCE: dict[RoomKind, float] = {"bedroom": 0.97, "bathroom": 0.85, "corridor": 0.25}
"""Chance that free English mentions the rooms of a kind that a house has."""
_OTHER_MENTION_CHANCE = 0.6
_ABSENT_CHANCE = 0.06
"""Chance that it says of a kind that there is none."""


@dataclass(frozen=True)
class Description:
    """A text, and what it says."""

    text: str
    wish: Wish


def describe(plan: Plan, rng: np.random.Generator) -> Description:
    """A text about a plan, in the paper's form or in free English, and the wish it stands for."""
    counts = room_counts(plan)
    area = float(round(floor_area_m2(plan)))
    if rng.random() < 0.4:
        kinds = [k for k in WISHED_KINDS if k in _PAPER_KINDS or (counts[k] and rng.random() < 0.5)]
        wish = Wish({kind: counts[kind] for kind in kinds}, area)
        return Description(wish.sentence, wish)
    mentioned: dict[RoomKind, int] = {}
    for kind in WISHED_KINDS:
        chance = MENTION_CHANCE.get(kind, _OTHER_MENTION_CHANCE) if counts[kind] else _ABSENT_CHANCE
        if rng.random() < chance:
            mentioned[kind] = counts[kind]
    kitchen = mentioned.get("kitchen") == 1 and has_open_kitchen(plan) and rng.random() < 0.7
    wish = Wish(mentioned, area if rng.random() < 0.7 or not mentioned else None, kitchen)
    return _free(wish, rng)


def _free(wish: Wish, rng: np.random.Generator) -> Description:
    """Free English; areas are in round figures, and the wish holds what the words say."""
    counts = dict(wish.counts)
    dwelling = str(rng.choice(_DWELLINGS))
    head = str(rng.choice(_OPENINGS))
    beds = counts.get("bedroom", 0)
    if beds and rng.random() < 0.5:
        counts.pop("bedroom")
        dwelling = f"{_number(beds, rng)}-{rng.choice(['bed', 'bedroom'])} {dwelling}"
    if wish.open_kitchen:
        counts.pop("kitchen")
    present = [kind for kind in counts if counts[kind]]
    rng.shuffle(present)
    said = [_counted(counts[kind], kind, rng) for kind in present]
    if wish.open_kitchen:
        said.insert(int(rng.integers(len(said) + 1)), str(rng.choice(_OPEN_KITCHENS)))
    absent = [NAMES[kind][0] for kind in counts if not counts[kind]]
    text = f"{head}{dwelling}"
    text += f" with {listed(said)}" if said else ""
    if absent:
        text += str(rng.choice([", no ", " but without "])) + " or ".join(absent)
    area = wish.area_m2
    if area is not None:
        area, phrase = _area(area, rng)
        text = f"{phrase} {text}" if rng.random() < 0.3 and not head else f"{text}, {phrase}"
    return Description(text, Wish(wish.counts, area, wish.open_kitchen))


_OPEN_KITCHENS = ("an open kitchen", "an open-plan kitchen", "a kitchen open to the living area")


def _area(area_m2: float, rng: np.random.Generator) -> tuple[float, str]:
    about = str(rng.choice(["about ", "", "around ", "approximately ", "roughly "]))
    if rng.random() < 0.2:
        feet = round(area_m2 * SQUARE_FEET_PER_M2, -1)
        unit = str(rng.choice(["sq ft", "square feet", "sqft"]))
        return feet / SQUARE_FEET_PER_M2, f"{about}{feet:.0f} {unit}"
    unit = str(rng.choice(["m²", "m2", "sqm", "square metres", "square meters"]))
    return area_m2, f"{about}{area_m2:.0f} {unit}"


def _counted(count: int, kind: RoomKind, rng: np.random.Generator) -> str:
    """ "2 bedrooms", "two beds", "a kitchen"."""
    names = (NAMES[kind], *_OTHER_NAMES.get(kind, ()))
    noun = names[int(rng.integers(len(names)))][count != 1]
    if count == 1 and rng.random() < 0.6:
        return f"{'an' if noun[0] in 'aeiou' else 'a'} {noun}"
    return f"{_number(count, rng)} {noun}"


def _number(count: int, rng: np.random.Generator) -> str:
    return NUMBER_WORDS[count] if count < len(NUMBER_WORDS) and rng.random() < 0.5 else str(count)
