"""What a room is, from what people call it."""

from __future__ import annotations

import re

from chord_usd.types import RoomKind

_KIND_WORDS: dict[RoomKind, str] = {
    "living": "living livingroom lounge parlour parlor sittingroom familyroom livingdining ldk",
    "dining": "dining diningroom breakfastroom dinette",
    "bedroom": "bedroom masterbedroom secondbedroom guestroom kidsroom childrensroom childroom"
    " childrenroom nursery elderlyroom masterroom secondroom japaneseroom tatamiroom",
    "kitchen": "kitchen kitchenette pantrykitchen cookingarea",
    "bathroom": "bathroom bath toilet wc restroom washroom washingroom lavatory powderroom ensuite"
    " masterbathroom secondbathroom showerroom",
    "balcony": "balcony terrace loggia veranda verandah patio deck",
    "corridor": "corridor hall hallway entrance entry entryway foyer vestibule aisle passage"
    " passageway lobby stairs stairwell",
    "study": "study studyroom office homeoffice workroom library den",
    "store": "store storage storeroom storageroom closet cloakroom wardrobe walkincloset pantry"
    " utility utilityroom laundry laundryroom equipmentroom boxroom garage cellar",
    "unknown": "unknown undefined other room",
}
_KIND_OF_WORD = {word: kind for kind, words in _KIND_WORDS.items() for word in words.split()}


def room_kind(name: str) -> RoomKind:
    """The kind that a room's name speaks of ("Master Bedroom 2" -> "bedroom"), else "unknown"."""
    words = re.findall(r"[a-z]+", name.lower())
    joined = "".join(words)
    for candidate in (joined, *reversed(words)):
        if candidate in _KIND_OF_WORD:
            return _KIND_OF_WORD[candidate]
    known = (word for word in _KIND_OF_WORD if len(word) > 4 and word in joined)
    return _KIND_OF_WORD.get(max(known, key=len, default=""), "unknown")
