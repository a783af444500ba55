"""What there is to dress rooms with: the forms of the home's style, one family of each kind."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Asset
from chord_usd.library.database import AssetDatabase

STRETCH = 0.15
"""Share by which a textile, a rail, a blind is made longer or shorter to fit."""

_SIZE = re.compile(r"(_\d+(x\d+)*)+$")

_OWN_FORM = 3.0
"""How many times likelier a form of the style is than one that suits all."""


class Stock:
    """The assets of a database that suit a style."""

    def __init__(self, database: AssetDatabase, style: str, house: Draws) -> None:
        self._database, self._style, self._house = database, style, house
        self._offered: dict[str, tuple[Asset, ...]] = {}

    def offered(self, category: str, tag: str = "") -> tuple[Asset, ...]:
        """Assets of a category in forms that suit the style, or in any where none does.

        tag: one that they carry (library.database.TAGS). Assets of the user's own go before
        shipped ones, unless none of them carries the tag. None for a category that the palette
        does not know.
        """
        if category not in self._offered:
            self._offered[category] = self._suiting(self.every(category))
        assets = self._offered[category]
        tagged = _with_tag(assets, tag)
        if tagged or not any(asset.id in self._database.own_ids for asset in assets):
            return tagged
        shipped = [a for a in self.every(category) if a.id not in self._database.own_ids]
        return _with_tag(self._suiting(shipped), tag)

    def every(self, category: str) -> tuple[Asset, ...]:
        """Assets of a category whatever their style."""
        return self._database.of_category(category) if category in CATEGORIES else ()

    def _suiting(self, assets: Sequence[Asset]) -> tuple[Asset, ...]:
        preferred = tuple(asset for asset in assets if asset.id in self._database.own_ids)
        candidates = preferred or tuple(assets)
        suited = tuple(a for a in candidates if not a.styles or self._style in a.styles)
        return suited or candidates

    def family(self, assets: Sequence[Asset], topic: str) -> tuple[Asset, ...]:
        """Those of the one family that the house has chosen among them: they differ in size."""
        if not assets:
            return ()
        families: dict[str, list[Asset]] = {}
        for asset in assets:
            families.setdefault(family_of(asset), []).append(asset)

        def rank(name: str) -> tuple[bool, float]:
            special = any(self._style in asset.styles for asset in families[name])
            return not special, self._house.share(f"{topic}/{name}")

        return tuple(families[min(families, key=rank)])

    def some(self, assets: Sequence[Asset], rng: np.random.Generator, count: int) -> list[Asset]:
        """Up to count different assets, the forms of the style likelier first."""
        if not assets:
            return []
        weights = np.array([_OWN_FORM if self._style in asset.styles else 1.0 for asset in assets])
        count = min(count, len(assets))
        chosen = rng.choice(len(assets), count, replace=False, p=weights / weights.sum())
        return [assets[int(index)] for index in chosen]

    def fetch(self, asset: Asset) -> Asset:
        """The asset, on disk."""
        self._database.prepare(asset)
        return asset


def _with_tag(assets: Sequence[Asset], tag: str) -> tuple[Asset, ...]:
    return tuple(asset for asset in assets if not tag or tag in asset.tags)


def family_of(asset: Asset) -> str:
    """The asset's id without its sizes."""
    return _SIZE.sub("", asset.id)


def within(
    assets: Sequence[Asset],
    most_m: tuple[float, float, float],
    least_m: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> list[Asset]:
    """Those whose length, width and height lie between these."""
    return [
        asset
        for asset in assets
        if all(
            low <= side <= high
            for low, side, high in zip(least_m, asset.size_m, most_m, strict=True)
        )
    ]


def nearest_length(assets: Sequence[Asset], length_m: float) -> Asset | None:
    """The one whose length is nearest; ties go to the lower id."""
    return min(assets, key=lambda a: (round(abs(a.size_m[0] - length_m), 6), a.id), default=None)


def stretched(side_m: float, wanted_m: float, share: float = STRETCH) -> float:
    """The side as near to what is wanted as stretching by this share brings it."""
    return float(np.clip(wanted_m, side_m * (1.0 - share), side_m * (1.0 + share)))


# Random numbers by what they are for, so that one choice does not change the next ----------------


class Draws:
    """Generators of one room, or of what agrees through a house."""

    def __init__(self, seed: int, place: str = "") -> None:
        """place: id of the room; empty for the house."""
        self._key = f"{seed}/{place}"

    def rng(self, topic: str) -> np.random.Generator:
        """A generator that starts at the same place each time it is asked for."""
        return np.random.default_rng(_number(f"{self._key}/{topic}"))

    def chance(self, topic: str, share: float) -> bool:
        """True for about this share of topics."""
        return self.share(topic) < share

    def share(self, topic: str) -> float:
        """A number in [0, 1)."""
        return _number(f"{self._key}/{topic}") / 2.0**64


def _number(text: str) -> int:
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:8], "little")


# How much of what each style shows ---------------------------------------------------------------


@dataclass(frozen=True)
class Taste:
    """What a style does with a room. Shares and chances are in [0, 1]."""

    pictures: float
    """Share of the places for pictures that are used."""
    gallery: float
    """Chance that a place has a group of them in place of one."""
    symmetric: bool
    """Whether things stand in pairs about an axis, or in groups beside it."""
    cushions: int
    """Most cushions on a sofa."""
    throws: float
    plants: int
    """Most plants on the floor of a room."""
    curtains: float
    """Chance that a house has curtains rather than blinds where people sit and sleep."""
    sheers: float
    """Chance that a room's curtains are sheer ones, drawn."""
    rugs: float
    boards: float
    """Share of the length of boards and shelves that is filled."""
    shelves: float
    """Chance of a wall shelf where there is a place for one."""
    wall_lamps: float
    mirrors: float
    radiators: float
    open_kitchen: float
    """Chance that a place over the worktop has a rail or a shelf in place of a cabinet."""
    little: float
    """Share of small things that are put out at all: jars, bottles, candles."""


TASTES: dict[str, Taste] = {
    "modern": Taste(0.75, 0.3, False, 4, 0.6, 2, 0.85, 0.35, 0.85, 0.5, 0.4, 0.4, 0.5, 0.6, 0.1,
                    0.7),
    "scandinavian": Taste(0.8, 0.5, False, 4, 0.85, 3, 0.9, 0.4, 0.9, 0.5, 0.6, 0.5, 0.6, 0.8,
                          0.35, 0.8),
    "classic": Taste(1.0, 0.6, True, 5, 0.6, 2, 1.0, 0.2, 0.95, 0.65, 0.35, 0.9, 0.9, 0.9, 0.05,
                     1.0),
    "industrial": Taste(0.85, 0.45, False, 3, 0.6, 2, 0.55, 0.1, 0.8, 0.6, 0.7, 0.6, 0.5, 0.9, 0.4,
                        0.85),
    "japanese": Taste(0.55, 0.1, False, 3, 0.5, 2, 0.35, 0.5, 0.8, 0.4, 0.5, 0.3, 0.3, 0.2, 0.3,
                      0.6),
}  # fmt: skip
"""By name of the style (scene.styles)."""


def taste_of(style: str) -> Taste:
    """That of a style; of modern for one that has none."""
    return TASTES.get(style, TASTES["modern"])
