"""What people call pieces of furniture, in the languages of room_names. Blanks are "_"."""

from __future__ import annotations

import math
from typing import NamedTuple

from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import WET_KINDS, RoomKind

ANY_M = (0.0, math.inf)

_SIZED = (
    ("bed", (0.0, 1.3), "single_bed twin_bed einzelbett lit_simple cama_individual"
     " cama_de_solteiro enkelsang 单人床 單人床 シングルベッド"),
    ("bed", (1.3, math.inf), "double_bed doppelbett lit_double cama_doble cama_de_matrimonio"
     " cama_de_casal dubbelsang parisanky 双人床 雙人床 ダブルベッド"),
    ("bed", (1.45, 1.75), "queen_bed queen_size_bed queen_sized_bed"),
    ("bed", (1.75, math.inf), "king_bed king_size_bed king_sized_bed"),
    ("sofa", (0.0, 1.9), "loveseat love_seat two_seater two_seater_sofa 2_seater 2_seater_sofa"
     " zweisitzer canape_deux_places"),
    ("sofa", (1.9, math.inf), "three_seater three_seater_sofa 3_seater 3_seater_sofa dreisitzer"
     " canape_trois_places"),
)  # fmt: skip
"""Words that say how long a piece is: metres, along its back."""

_LOUNGE = dict.fromkeys(("armchair", "arm chair", "easy chair"), "leisure_sofa")

HERE: dict[RoomKind, dict[str, str]] = {
    "bedroom": _LOUNGE,
    "study": _LOUNGE,
    "balcony": _LOUNGE,
    **{kind: {"sink": "washbasin"} for kind in WET_KINDS},
    "kitchen": {"table": "dining_table", "basin": "sink_cabinet"},
    "dining": {"table": "dining_table"},
}
"""Words that mean another category in some rooms."""


class Named(NamedTuple):
    """What a word stands for."""

    word: str
    """As the tables have it, with blanks."""
    category: str
    length_m: tuple[float, float] = ANY_M


WORDS: dict[str, Named] = {
    word.replace("_", ""): Named(word.replace("_", " "), category, length_m)
    for category, length_m, words in (
        *((row.name, ANY_M, row.words) for row in CATEGORIES.values()),
        *_SIZED,
    )
    for word in (words.split() if isinstance(words, str) else words)
}
"""By the word without blanks."""

_PLURALS = ("s", "es", "x", "n", "en", "e", "er", "ar", "r", "a", "ta")


def named(words: list[str]) -> Named | None:
    """What these words together name, singular or plural; None for what is not known."""
    joined = "".join(words)
    stems = [joined, *(joined.removesuffix(end) for end in _PLURALS if joined.endswith(end))]
    stems += [joined[:-3] + "f"] if joined.endswith("ves") else []
    # "Chests of drawers", "tables de chevet": several, said in the first word.
    stems += ["".join([words[0].removesuffix("s"), *words[1:]])] if len(words) > 1 else []
    stems += [stem.removesuffix("s") for stem in stems[-1:]]
    return next((WORDS[stem] for stem in stems if stem in WORDS), None)
