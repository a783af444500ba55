"""Finishes as finishes.tsv lists them: colour, roughness, metalness, opacity, surface."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, cast

if TYPE_CHECKING:
    from PIL.Image import Image


Surface = Literal[
    "plain", "wood", "weave", "linen", "crumpled", "knit", "boucle", "velvet", "leather", "brushed",
    "stone", "marble", "quartz", "ceramic", "concrete", "terracotta", "rattan", "paper", "leaf",
    "bark", "soil", "polished", "powder", "patina", "glaze", "moulded", "peel", "kernels",
]  # fmt: skip
"""What a finish is made of, and so which maps are drawn for it; plain has none."""


@dataclass(frozen=True)
class Finish:
    """How a surface looks, in the terms of UsdPreviewSurface."""

    rgb: tuple[int, int, int]
    """sRGB, 0 to 255, as a designer would pick it."""
    roughness: float
    metallic: float = 0.0
    opacity: float = 1.0
    glow: float = 0.0
    """Emission as a share of the colour; screens and lamp shades."""
    texture: Image | None = None
    """A picture in place of the colour, on the part's own texture coordinates."""
    surface: Surface = "plain"
    """Grain, weave or veins over the colour, in metres."""
    contrast: float = 1.0
    """How strongly grain, yarns or veins stand out against the colour; 1 is usual."""

    def linear_rgb(self) -> tuple[float, float, float]:
        """The colour in linear light, 0 to 1, which is what USD colour inputs hold."""
        red, green, blue = (_linear(value / 255.0) for value in self.rgb)
        return red, green, blue


def _linear(value: float) -> float:
    """sRGB transfer function, inverted (IEC 61966-2-1)."""
    return value / 12.92 if value <= 0.04045 else float(((value + 0.055) / 1.055) ** 2.4)


@cache
def _tables() -> dict[str, dict[str, Finish]]:
    """The finishes of finishes.tsv by table and name."""
    tables: dict[str, dict[str, Finish]] = {}
    with Path(__file__).with_name("finishes.tsv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file, delimiter="\t", quoting=csv.QUOTE_NONE, restval=""):
            tables.setdefault(row["table"], {})[row["name"]] = _finish(row)
    return tables


def _finish(row: Mapping[str, str]) -> Finish:
    red, green, blue = map(int, row["rgb"].split())
    return Finish(
        (red, green, blue),
        float(row["roughness"]),
        float(row["metallic"] or 0.0),
        float(row["opacity"] or 1.0),
        float(row["glow"] or 0.0),
        surface=cast("Surface", row["surface"] or "plain"),
        contrast=float(row["contrast"] or 1.0),
    )


@cache
def finish_table(name: str) -> dict[str, Finish]:
    """Finish by name: a table of finishes.tsv, beside and before the common finishes."""
    return {**_tables()["common"], **_tables()[name]}


def finish_named(name: str) -> Finish | None:
    """The finish of this name, in whichever table it is."""
    return next((table[name] for table in _tables().values() if name in table), None)


FINISHES = finish_table("common")
"""The common finishes by name."""

PLAIN: dict[str, tuple[str, ...]] = {
    "glass": (
        "glass", "smoked_glass", "black_glass", "clear_glass", "amber_glass", "bottle_green",
        "mirror_glass", "glazed_white", "glazed_sage", "glazed_graphite",
    ),
    "lacquer": (
        "white", "warm_white", "light_grey", "grey", "graphite", "black", "navy", "sage", "forest",
        "blush", "sand",
    ),
    "light": ("opal_glass", "bulb", "flame", "screen"),
    "liquid": ("water", "coffee", "oil", "vinegar", "wine"),
}  # fmt: skip
"""The finishes, here and of the dressing, that are even by nature; all others have maps."""
