"""Names of pieces in files of others: "eTeks#bed140x190", "Double Bed 2" -> a category."""

from __future__ import annotations

import re
from functools import cache

from chord_usd.base.scene.numbers_said import plain_text
from chord_usd.base.scene.palette import CATEGORIES, Level, Mount

_WORD = re.compile(r"[^\W\d_]+")
_HUMP = re.compile(r"(?<=[a-z])(?=[A-Z])")
_LEAST_PART = 5
"""Letters of a word that is part of another one."""
_MOST_WORDS = 3
"""Of a name of a piece, such as "chest of drawers"."""


def piece_named(name: str) -> str | None:
    """The category of furniture that a name says, by its longest known words; None for none."""
    words = _WORD.findall(plain_text(_HUMP.sub(" ", name)))
    for count in range(_MOST_WORDS, 0, -1):
        for start in range(len(words) - count + 1):
            joined = "".join(words[start : start + count])
            category = _table().get(joined) or _table().get(joined.removesuffix("s"))
            if category:
                return category
    # Words are joined in some languages: "Duschkabine".
    known = [entry for entry in _table() if len(entry) >= _LEAST_PART
             and any(word.startswith(entry) or word.endswith(entry) for word in words)]  # fmt: skip
    return _table()[max(known, key=len)] if known else None


@cache
def _table() -> dict[str, str]:
    return {
        plain_text(word).replace("_", ""): row.name
        for row in CATEGORIES.values()
        if row.level is Level.HOUSE and row.mount is Mount.FLOOR
        for word in row.words
    }
