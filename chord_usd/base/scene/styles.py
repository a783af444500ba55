"""The styles of a home: which materials, textiles, lamps and forms agree with each other.

Finishes are named as in assets.finishes and the dressing, in the order in which a style likes
them. A home has one wood, one metal and one accent colour of its style throughout
(`HomeStyle.agreed`).
"""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from typing import Literal

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.style_looks import ACCENT_LOOKS, FLOOR_LOOKS, WALL_LOOKS, Ranges

InnerDoor = Literal["panel", "flush"]
"""Forms of doors between rooms."""

MIXED = "mixed"
"""Name of the choice that takes one of STYLES by the seed of the house."""


@dataclass(frozen=True)
class Agreed:
    """What all rooms of one home have in common; names of finishes."""

    wood: str
    metal: str
    lacquer: str
    textile: str
    """Of large things: sofas, curtains, beds."""
    accent: str
    """A colour, not a finish: what cushions, throws and small things share."""
    stone: str


@dataclass(frozen=True)
class HomeStyle:
    """What agrees through a home."""

    name: str
    label: str
    woods: tuple[str, ...]
    metals: tuple[str, ...]
    lacquers: tuple[str, ...]
    textiles: tuple[str, ...]
    """Of large things: sofas, curtains, beds."""
    accents: tuple[str, ...]
    """Words of colour, such as `sage`: a finish or colourway suits that has one of its words."""
    stones: tuple[str, ...]
    """Also ceramics and concrete."""
    richness: float = 1.0
    """How much is put up and laid out, next to a usual home; 0.5 to 1.5."""
    curtains: tuple[str, ...] = ("Curtain",)
    """First words of the assets that windows of dry rooms are dressed with, best first."""
    rugs: tuple[str, ...] = ("Rug",)
    """First words of the rugs' assets, best first."""
    accent_walls: float = 0.4
    """Share of the rooms one lives and sleeps in whose walls differ from the house's walls."""
    floors: Mapping[str, Sequence[Ranges]] = field(default_factory=dict)
    """Look families of floors by group of rooms (style_looks.GROUP_OF)."""
    walls: Mapping[str, Sequence[Ranges]] = field(default_factory=dict)
    accent_looks: Mapping[str, Sequence[Ranges]] = field(default_factory=dict)
    """Looks of walls that differ."""
    ceiling: str = "#f3f2ef"
    trim: str = "#f0efeb"
    """Colour of skirting, inner doors and their frames."""
    frames: str = "#e2e2e0"
    """Colour of window frames."""
    doors: InnerDoor = "panel"

    def agreed(self, seed: int) -> Agreed:
        """The one wood, metal, lacquer, textile and accent of a home; a seed always gives the same.

        The first of each list comes most often.
        """
        return Agreed(
            wood=_liked(self.woods, f"{self.name}/{seed}/wood"),
            metal=_liked(self.metals, f"{self.name}/{seed}/metal"),
            lacquer=_liked(self.lacquers, f"{self.name}/{seed}/lacquer"),
            textile=_liked(self.textiles, f"{self.name}/{seed}/textile"),
            accent=self.accents[int(share(f"{self.name}/{seed}/accent") * len(self.accents))],
            stone=_liked(self.stones, f"{self.name}/{seed}/stone"),
        )


def share(key: str) -> float:
    """A number in [0, 1) that a key always gives; keys that differ give independent ones."""
    return int.from_bytes(hashlib.sha256(key.encode()).digest()[:6], "little") / 2.0**48


def _liked(names: Sequence[str], key: str) -> str:
    """One of names; the first n times as likely as the n-th."""
    weights = [1.0 / (place + 1) for place in range(len(names))]
    left = share(key) * sum(weights)
    for name, weight in zip(names, weights, strict=True):
        left -= weight
        if left < 0.0:
            return name
    return names[-1]


_MODERN = HomeStyle(
    "modern", "Modern",
    woods=("walnut", "oak"),
    metals=("black_metal", "chrome"),
    lacquers=("light_grey", "white"),
    textiles=("grey_cloth", "charcoal_cloth", "cream_cloth"),
    accents=("teal", "mustard", "rust", "navy"),
    stones=("quartz", "marble", "dark_stone"),
    richness=0.9, curtains=("Curtain", "Blind"), rugs=("Rug",), accent_walls=0.35,
    frames="#4c4e50", doors="flush",
)  # fmt: skip
_SCANDINAVIAN = HomeStyle(
    "scandinavian", "Scandinavian",
    woods=("pale_oak", "birch"),
    metals=("black_metal", "brass"),
    lacquers=("white", "warm_white", "sage"),
    textiles=("linen", "white_cloth", "grey_cloth", "beige_cloth"),
    accents=("sage", "blush", "blue", "mustard"),
    stones=("terrazzo", "quartz", "ceramic"),
    richness=1.1, curtains=("Curtain",), rugs=("Rug",), accent_walls=0.45,
    ceiling="#f6f6f4", trim="#f4f4f1",
)  # fmt: skip
_CLASSIC = HomeStyle(
    "classic", "Classic",
    woods=("cherry", "dark_walnut", "walnut"),
    metals=("brass",),
    lacquers=("warm_white", "navy", "forest"),
    textiles=("cream_cloth", "beige_cloth", "linen"),
    accents=("burgundy", "navy", "forest", "gold"),
    stones=("marble", "dark_stone"),
    richness=1.25, curtains=("Curtain",), rugs=("Rug",), accent_walls=0.6,
    ceiling="#f5f1e8", trim="#f3efe5", frames="#efe9dc",
)  # fmt: skip
_INDUSTRIAL = HomeStyle(
    "industrial", "Industrial",
    woods=("dark_walnut", "walnut"),
    metals=("black_metal", "steel"),
    lacquers=("graphite", "black", "grey"),
    textiles=("charcoal_cloth", "tan_leather", "grey_cloth", "brown_leather"),
    accents=("rust", "mustard", "tan", "teal"),
    stones=("concrete", "dark_stone"),
    richness=1.0, curtains=("Blind", "Curtain"), rugs=("Rug",), accent_walls=0.75,
    ceiling="#dedcd8", trim="#4a4a4c", frames="#2e2f31", doors="flush",
)  # fmt: skip
_JAPANESE = HomeStyle(
    "japanese", "Japanese",
    woods=("oak",),
    metals=("black_metal",),
    lacquers=("warm_white", "sand", "black"),
    textiles=("linen", "beige_cloth", "cream_cloth"),
    accents=("moss", "indigo", "charcoal", "terracotta"),
    stones=("ceramic_grey", "dark_stone", "concrete"),
    richness=0.75, curtains=("Blind", "Curtain"), rugs=("Mat", "Rug"), accent_walls=0.5,
    ceiling="#efe9dc", trim="#c8b494", frames="#b39c7a", doors="flush",
)  # fmt: skip

STYLES: dict[str, HomeStyle] = {
    style.name: replace(
        style,
        floors=FLOOR_LOOKS[style.name],
        walls=WALL_LOOKS[style.name],
        accent_looks=ACCENT_LOOKS[style.name],
    )
    for style in (_MODERN, _SCANDINAVIAN, _CLASSIC, _INDUSTRIAL, _JAPANESE)
}


def style_named(name: str, seed: int) -> HomeStyle:
    """The style of this name; for `mixed` one of them, always the same for a seed.

    Raises ChordError for a name that is none.
    """
    if name == MIXED:
        return list(STYLES.values())[int(share(f"style/{seed}") * len(STYLES))]
    if name not in STYLES:
        near = get_close_matches(name[:40], (*STYLES, MIXED), n=1)
        raise ChordError(
            f"there is no style '{name[:40]}'",
            where="<style>",
            value=name,
            expected=f"one of {', '.join((*STYLES, MIXED))}",
            try_=f"<style={near[0]}>" if near else "",
        )
    return STYLES[name]
