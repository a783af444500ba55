"""Selection of furniture's variants: colourways that go together."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass

from chord_usd.base.scene.articulation import ARTICULATION, FIXED
from chord_usd.base.scene.palette import Level, category
from chord_usd.base.scene.style_finishes import kind_of, metal_like, suitability
from chord_usd.base.scene.styles import Agreed, HomeStyle
from chord_usd.base.scene.types import Item, Room
from chord_usd.library.colourways import Offer, offer_of
from chord_usd.library.component import COLOUR_VARIANT_SET

COLOUR, METAL = COLOUR_VARIANT_SET, "metal"
"""Names of the variant sets of components."""

_OVER_RUNS = ("wall_cabinet", "cooker_hood")

_AS_GOOD = 0.05
"""Colourways that suit a home by so little less than the best are as good."""


@dataclass
class Wardrobe:
    """Selects the variants of the pieces of a house, room by room."""

    seed: int = 0
    style: HomeStyle | None = None
    """None chooses colourways by the draw alone."""
    home: Agreed | None = None
    """What the rooms of the house agree on, of the style."""
    articulation: str = FIXED
    """Whether what can open does."""

    def selections(self, item: Item, room: Room) -> dict[str, str]:
        """Variant set to variant for an item of a room; the same seed chooses the same.

        Pieces of one category in one room match, and so do all cabinets of a kitchen.
        """
        if item.asset is None:
            return {}
        offered = offer_of(item.asset.usd_path)
        chosen = {}
        if len(offered.variants.get(COLOUR, ())) > 1:
            chosen[COLOUR] = self._colourway(offered, item, room)
        if self.home is not None and METAL in offered.variants:
            chosen[METAL] = metal_like(self.home.metal)
        if ARTICULATION in offered.variants:
            chosen[ARTICULATION] = self.articulation
        return chosen

    def _colourway(self, offered: Offer, item: Item, room: Room) -> str:
        """A colourway among the best for the home; the room and the kind decide which."""
        names = offered.variants[COLOUR]
        if _is_fitted(item) and self.home is not None:
            # By the name alone: cabinets over the worktop offer less than cabinets below it.
            fronts = [name for name in (self.home.lacquer, self.home.wood) if name in names]
            if fronts:
                return fronts[self._draw(f"{room.id}/kitchen", len(fronts))]
        if self.style is not None and self.home is not None:
            suits = {
                name: suitability(_that_vary(offered, name), self.style, self.home, item.category)
                for name in names
            }
            names = [name for name in names if suits[name] >= max(suits.values()) - _AS_GOOD]
        kind = "kitchen" if _is_fitted(item) else item.category
        return names[self._draw(f"{room.id}/{kind}", len(names))]

    def _draw(self, key: str, count: int) -> int:
        digest = hashlib.sha256(f"{self.seed}/{key}".encode()).digest()
        return int.from_bytes(digest[:4], "little") % count


def _that_vary(offered: Offer, colourway: str) -> list[str]:
    """Finishes of a colourway; fittings do not count where the home says what metal they are."""
    names = offered.finishes.get(colourway, [colourway])
    if METAL not in offered.variants:
        return names
    return [name for name in names if kind_of(name) != "metal"]


def _is_fitted(item: Item) -> bool:
    """Whether the item is part of a kitchen run, or hangs over one."""
    row = category(item.category)
    return row.rooms == ("kitchen",) and (row.level is Level.HOUSE or row.name in _OVER_RUNS)
