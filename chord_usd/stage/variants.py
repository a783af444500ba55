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
from chord_usd.scene.types import Item, Opening, Room

COLOUR = "colour"
WALL_UNIT = "wallUnit"
HUNG = "hung"

_TONES = ("oak", "walnut", "white")
"""Colourways whose name holds the tone of the room are taken before others."""

_AT_WALL_M = 0.06
"""A back this near to a wall stands against it."""

_CLEAR_M = 0.1
"""Between a wall unit and the side of a window."""

_UNIT_FROM_M = 1.35
"""Openings that end below this are no obstacle."""


@dataclass
class Wardrobe:
    """What there is to wear in a house, and how a room chooses."""

    seed: int = 0
    openings: Sequence[Opening] = ()
    """Of the whole house, or at least of the rooms furnished."""
    _choices: dict[Path, dict[str, list[str]]] = field(default_factory=dict)

    def selections(self, item: Item, room: Room) -> dict[str, str]:
        """Variant set to variant for an item of a room; the same seed chooses the same.

        Pieces of one category in one room match, and so do all cabinets of a kitchen.
        """
        if item.asset is None:
            return {}
        offered = self._offered(item.asset.usd_path)
        chosen = {}
        if len(offered.get(COLOUR, ())) > 1:
            chosen[COLOUR] = self._colourway(offered[COLOUR], item, room)
        if HUNG in offered.get(WALL_UNIT, ()) and self._has_wall(item, room):
            chosen[WALL_UNIT] = HUNG
        return chosen

    def _offered(self, path: Path) -> dict[str, list[str]]:
        """Variant names of the variant sets of a component."""
        if path not in self._choices:
            layer = open_layer(path) if path.is_file() else None
            root = layer.GetPrimAtPath(f"/{layer.defaultPrim}") if layer else None
            sets = root.variantSets if root else {}
            self._choices[path] = {name: [*entry.variants.keys()] for name, entry in sets.items()}
        return self._choices[path]

    def _colourway(self, names: Sequence[str], item: Item, room: Room) -> str:
        tone = _TONES[self._draw(room.id, len(_TONES))]
        fitting = [name for name in names if tone in name.split("_")]
        if fitting:
            return fitting[0]
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
