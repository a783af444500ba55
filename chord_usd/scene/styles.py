"""The styles of a home: which materials, textiles, lamps and forms agree with each other."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from chord_usd.errors import ChordError

MIXED = "mixed"
"""Name of the choice that takes one of STYLES by the seed of the house."""


@dataclass(frozen=True)
class HomeStyle:
    """What agrees through a home."""

    name: str
    label: str


STYLES: dict[str, HomeStyle] = {
    style.name: style
    for style in (
        HomeStyle("modern", "Modern"),
        HomeStyle("scandinavian", "Scandinavian"),
        HomeStyle("classic", "Classic"),
        HomeStyle("industrial", "Industrial"),
        HomeStyle("japanese", "Japanese"),
    )
}


def style_named(name: str, seed: int) -> HomeStyle:
    """The style of this name; for `mixed` one of them, always the same for a seed.

    Raises ChordError for a name that is none.
    """
    if name == MIXED:
        digest = hashlib.sha256(f"style/{seed}".encode()).digest()
        return list(STYLES.values())[digest[0] % len(STYLES)]
    if name not in STYLES:
        raise ChordError(
            f"there is no style '{name}'",
            where="--style",
            expected=f"one of {', '.join((*STYLES, MIXED))}",
        )
    return STYLES[name]
