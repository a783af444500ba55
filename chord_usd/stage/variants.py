"""Which variants furniture wears: colourways that go together, wall units where there is a wall."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from shapely.geometry import LineString

from chord_usd.runtime.stages import open_layer
from chord_usd.scene.geometry import footprint, footprint_polygon
from chord_usd.scene.palette import category
from chord_usd.scene.style_finishes import suitability
from chord_usd.scene.styles import Agreed, HomeStyle
from chord_usd.scene.types import Item, Opening, Room

COLOUR = "colour"
WALL_UNIT = "wallUnit"
HUNG = "hung"

_AT_WALL_M = 0.06
"""A back this near to a wall stands against it."""

_CLEAR_M = 0.1
"""Between a wall unit and the side of a window."""

_UNIT_FROM_M = 1.35
"""Openings that end below this are no obstacle."""


_AS_GOOD = 0.05
"""Colourways that suit a home by so little less than the best are as good."""


@dataclass(frozen=True)
class _Offer:
    """What a component can wear."""

    variants: dict[str, list[str]]
    """Names of variants by variant set."""
    finishes: dict[str, list[str]]
    """Names of the finishes of each colourway, a slot each."""


@dataclass
class Wardrobe:
    """What there is to wear in a house, and how a room chooses."""

    seed: int = 0
    openings: Sequence[Opening] = ()
    """Of the whole house, or at least of the rooms furnished."""
    style: HomeStyle | None = None
    """None chooses colourways by the draw alone."""
    home: Agreed | None = None
    """What the rooms of the house agree on, of the style."""
    _choices: dict[Path, _Offer] = field(default_factory=dict)

    def selections(self, item: Item, room: Room) -> dict[str, str]:
        """Variant set to variant for an item of a room; the same seed chooses the same.

        Pieces of one category in one room match, and so do all cabinets of a kitchen.
        """
        if item.asset is None:
            return {}
        offered = self._offered(item.asset.usd_path)
        chosen = {}
        if len(offered.variants.get(COLOUR, ())) > 1:
            chosen[COLOUR] = self._colourway(offered, item, room)
        if HUNG in offered.variants.get(WALL_UNIT, ()) and self._has_wall(item, room):
            chosen[WALL_UNIT] = HUNG
        return chosen

    def _offered(self, path: Path) -> _Offer:
        """What a component offers to choose from."""
        if path not in self._choices:
            layer = open_layer(path) if path.is_file() else None
            root = layer.GetPrimAtPath(f"/{layer.defaultPrim}") if layer else None
            sets = root.variantSets if root else {}
            noted = root.customData.get("chord", {}) if root else {}
            self._choices[path] = _Offer(
                {name: [*entry.variants.keys()] for name, entry in sets.items()},
                {name: text.split() for name, text in noted.get("finishes", {}).items()},
            )
        return self._choices[path]

    def _colourway(self, offered: _Offer, item: Item, room: Room) -> str:
        """One of those that suit the home best; which of them, the room and the kind decide."""
        names = offered.variants[COLOUR]
        if self.style is not None and self.home is not None:
            suits = {
                name: suitability(
                    offered.finishes.get(name, [name]), self.style, self.home, item.category
                )
                for name in names
            }
            names = [name for name in names if suits[name] >= max(suits.values()) - _AS_GOOD]
        kind = "kitchen" if _is_fitted(item) else item.category
        return names[self._draw(f"{room.id}/{kind}", len(names))]

    def _draw(self, key: str, count: int) -> int:
        digest = hashlib.sha256(f"{self.seed}/{key}".encode()).digest()
        return int.from_bytes(digest[:4], "little") % count

    def _has_wall(self, item: Item, room: Room) -> bool:
        """Whether there is wall without a hole behind the whole length of an item."""
        corners = footprint(item.box)
        back = LineString([corners[0], corners[3]])
        ring = LineString(np.concatenate([room.polygon_m, room.polygon_m[:1]]))
        if not ring.buffer(_AT_WALL_M, cap_style="square").contains(back):
            return False
        strip = back.buffer(_AT_WALL_M + _CLEAR_M)
        return not any(
            opening.box.center_m[2] + opening.box.size_m[2] > _UNIT_FROM_M
            and footprint_polygon(opening.box).buffer(_CLEAR_M).intersects(strip)
            for opening in self.openings
        )


def _is_fitted(item: Item) -> bool:
    """Whether the item is part of a kitchen run."""
    return category(item.category).rooms == ("kitchen",)
