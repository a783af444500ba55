"""How well finishes suit a home: by their names, since furniture of others has only names."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from chord_usd.base.scene.styles import Agreed, HomeStyle

Kind = Literal["wood", "metal", "stone", "textile", "lacquer", "other"]

_NAMES: dict[Kind, str] = {
    "textile": "cloth linen cotton wool knit boucle velvet leather weave felt denim sheepskin jute "
    "sisal canvas tweed silk flannel",
    "metal": "metal chrome steel brass copper bronze gold nickel iron zinc",
    "stone": "ceramic marble stone quartz terracotta concrete terrazzo slate granite travertine "
    "stoneware porcelain",
    "wood": "oak walnut cherry birch stain ash beech pine teak maple bamboo hinoki cedar elm wood "
    "rattan mahogany",
    "lacquer": "white grey graphite black navy sage forest blush sand lacquer cream green blue "
    "teal mustard burgundy",
}
_WORDS = {kind: frozenset(names.split(" ")) for kind, names in _NAMES.items()}
"""Words of the names of finishes, those that decide first before others."""

_SHADES: dict[str, frozenset[str]] = {
    "sage": frozenset({"sage", "green", "olive", "eucalyptus"}),
    "blush": frozenset({"blush", "pink", "rose"}),
    "blue": frozenset({"blue", "sky", "denim"}),
    "navy": frozenset({"navy", "indigo", "blue"}),
    "indigo": frozenset({"indigo", "navy", "blue"}),
    "rust": frozenset({"rust", "terracotta", "orange", "brick"}),
    "terracotta": frozenset({"terracotta", "rust"}),
    "mustard": frozenset({"mustard", "ochre", "yellow"}),
    "gold": frozenset({"gold", "mustard", "ochre"}),
    "teal": frozenset({"teal", "petrol"}),
    "burgundy": frozenset({"burgundy", "wine", "red", "bordeaux"}),
    "forest": frozenset({"forest", "green", "bottle"}),
    "moss": frozenset({"moss", "olive", "green", "sage"}),
    "tan": frozenset({"tan", "cognac", "camel"}),
    "charcoal": frozenset({"charcoal", "graphite", "anthracite"}),
}
"""An accent and the words that are as much as it."""

_ACCENTED = frozenset({"cushion", "throw", "towel", "vase", "rug", "bath_mat", "armchair", "pouf"})
"""Categories that show the accent of a home."""


@lru_cache(maxsize=4096)
def kind_of(finish: str) -> Kind:
    """What a finish is made of, by the words of its name."""
    words = set(finish.split("_"))
    return next((kind for kind, names in _WORDS.items() if names & words), "other")


def suitability(
    finishes: Iterable[str], style: HomeStyle, home: Agreed, category: str = ""
) -> float:
    """How well a colourway with these finishes suits a home of a style; more is better.

    category: of the piece; cushions, throws and the like show the accent.
    """
    return sum(_suits(finish, style, home, category in _ACCENTED) for finish in finishes)


def _suits(finish: str, style: HomeStyle, home: Agreed, accented: bool) -> float:
    match kind_of(finish):
        case "wood":
            return _rank(finish, home.wood, style.woods, best=3.0, strange=-1.5)
        case "metal":
            metal = metal_like(finish)
            liked = tuple(metal_like(name) for name in style.metals)
            return _rank(metal, metal_like(home.metal), liked, best=1.5, strange=-0.8)
        case "stone":
            return _rank(finish, home.stone, style.stones, best=1.0, strange=-0.2)
        case "textile":
            return _coloured(finish, home.textile, style.textiles, home, accented, style)
        case "lacquer":
            return _coloured(finish, home.lacquer, style.lacquers, home, accented, style)
    return 0.0


def metal_like(finish: str) -> str:
    """The one of chrome, brass and black_metal that a metal looks like, by its name."""
    words = set(finish.split("_"))
    if words & {"brass", "copper", "bronze", "gold"}:
        return "brass"
    return "black_metal" if words & {"black", "iron"} else "chrome"


def _rank(finish: str, agreed: str, liked: Sequence[str], *, best: float, strange: float) -> float:
    if finish == agreed:
        return best
    if finish in liked:
        return 0.4 * best / (1.0 + liked.index(finish))
    return strange


def _coloured(
    finish: str, agreed: str, liked: Sequence[str], home: Agreed, accented: bool, style: HomeStyle
) -> float:
    """Textiles and lacquers, of which some show the home's accent."""
    if shows(finish, home.accent):
        return 3.0 if accented else 0.6
    neutral = _rank(finish, agreed, liked, best=2.0, strange=-1.0)
    if neutral < 0.0 and any(shows(finish, accent) for accent in style.accents):
        return -0.4
    return neutral


def shows(finish: str, accent: str) -> bool:
    """Whether the name of a finish names this accent colour."""
    return not _SHADES.get(accent, frozenset({accent})).isdisjoint(finish.split("_"))
