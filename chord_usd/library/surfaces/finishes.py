"""The one table of furniture finishes: colour, roughness, metalness, opacity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

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


FINISHES: dict[str, Finish] = {
    # wood
    "oak": Finish((198, 160, 112), 0.5, surface="wood"),
    "pale_oak": Finish((219, 194, 156), 0.5, surface="wood", contrast=0.85),
    "walnut": Finish((104, 68, 44), 0.42, surface="wood", contrast=1.5),
    "dark_walnut": Finish((66, 44, 31), 0.42, surface="wood", contrast=1.5),
    "cherry": Finish((134, 78, 52), 0.42, surface="wood", contrast=1.1),
    "birch": Finish((228, 208, 174), 0.5, surface="wood", contrast=0.6),
    "black_stain": Finish((38, 35, 33), 0.5, surface="wood", contrast=0.8),
    # lacquer and laminate
    "white": Finish((238, 237, 233), 0.35),
    "warm_white": Finish((233, 226, 213), 0.4),
    "light_grey": Finish((196, 197, 196), 0.4),
    "grey": Finish((140, 143, 145), 0.4),
    "graphite": Finish((62, 66, 70), 0.4),
    "black": Finish((26, 26, 28), 0.35),
    "navy": Finish((44, 62, 88), 0.4),
    "sage": Finish((142, 158, 132), 0.45),
    "forest": Finish((50, 82, 68), 0.45),
    "blush": Finish((214, 170, 156), 0.45),
    "sand": Finish((212, 198, 172), 0.45),
    # metal
    "chrome": Finish((214, 216, 218), 0.12, 1.0, surface="polished"),
    "steel": Finish((172, 174, 176), 0.3, 1.0, surface="brushed"),
    "brass": Finish((192, 160, 104), 0.3, 1.0, surface="brushed"),
    "black_metal": Finish((34, 34, 36), 0.45, 0.6, surface="powder"),
    # stone and ceramic
    "ceramic": Finish((246, 246, 244), 0.12, surface="glaze"),
    "ceramic_grey": Finish((150, 154, 156), 0.2, surface="ceramic"),
    "marble": Finish((232, 230, 226), 0.16, surface="marble"),
    "dark_stone": Finish((58, 58, 60), 0.25, surface="stone"),
    "quartz": Finish((222, 219, 212), 0.25, surface="quartz"),
    "terracotta": Finish((178, 98, 66), 0.75, surface="terracotta"),
    "concrete": Finish((166, 163, 157), 0.8, surface="concrete"),
    # cloth and leather
    "linen": Finish((222, 212, 196), 0.95, surface="linen"),
    "cream_cloth": Finish((236, 229, 216), 0.95, surface="linen"),
    "white_cloth": Finish((242, 241, 238), 0.95, surface="linen"),
    "grey_cloth": Finish((146, 149, 152), 0.95, surface="weave"),
    "charcoal_cloth": Finish((74, 77, 82), 0.95, surface="weave"),
    "blue_cloth": Finish((72, 98, 132), 0.95, surface="weave"),
    "green_cloth": Finish((92, 112, 88), 0.95, surface="weave"),
    "rust_cloth": Finish((176, 98, 66), 0.95, surface="weave"),
    "mustard_cloth": Finish((204, 158, 70), 0.95, surface="weave"),
    "pink_cloth": Finish((210, 158, 150), 0.95, surface="weave"),
    "teal_cloth": Finish((58, 112, 116), 0.95, surface="weave"),
    "beige_cloth": Finish((200, 182, 156), 0.95, surface="weave"),
    "tan_leather": Finish((160, 100, 60), 0.42, surface="leather"),
    "brown_leather": Finish((88, 56, 40), 0.4, surface="leather"),
    "black_leather": Finish((36, 34, 33), 0.4, surface="leather"),
    "mattress": Finish((240, 238, 234), 0.95, surface="linen"),
    # glass, screens, plastic, rubber
    "glass": Finish((214, 230, 232), 0.04, 0.0, 0.16),
    "smoked_glass": Finish((70, 78, 82), 0.06, 0.0, 0.5),
    "black_glass": Finish((14, 15, 17), 0.06),
    "screen": Finish((16, 22, 32), 0.08, 0.0, 1.0, 0.05),
    "lamp_shade": Finish((248, 236, 208), 0.9, 0.0, 1.0, 0.4, surface="linen", contrast=0.6),
    "rubber": Finish((46, 46, 48), 0.85, surface="moulded"),
    "plastic_white": Finish((240, 240, 240), 0.3, surface="moulded"),
    "plastic_black": Finish((30, 30, 32), 0.35, surface="moulded"),
    "water": Finish((150, 200, 214), 0.05, 0.0, 0.35),
    # print, plants, food
    "light_blue": Finish((166, 196, 216), 0.8, surface="linen"),
    "paper": Finish((240, 236, 224), 0.85, surface="paper"),
    "red_cover": Finish((170, 52, 46), 0.6, surface="linen"),
    "blue_cover": Finish((44, 82, 136), 0.6, surface="linen"),
    "green_cover": Finish((62, 112, 82), 0.6, surface="linen"),
    "yellow_cover": Finish((222, 178, 72), 0.6, surface="linen"),
    "leaf": Finish((66, 116, 58), 0.6, surface="leaf"),
    "dark_leaf": Finish((40, 84, 52), 0.5, surface="leaf"),
    "soil": Finish((62, 46, 36), 0.95, surface="soil"),
    "coffee": Finish((62, 36, 22), 0.2),
    "crust": Finish((172, 112, 58), 0.75, surface="terracotta"),
    "apple": Finish((188, 44, 38), 0.35, surface="peel", contrast=0.5),
    "orange": Finish((232, 140, 46), 0.55, surface="peel"),
    "pear": Finish((176, 186, 76), 0.5, surface="peel", contrast=0.5),
    "bottle_green": Finish((46, 84, 56), 0.1, 0.0, 0.75),
    "wine": Finish((98, 22, 36), 0.1, 0.0, 0.9),
}
"""Finish by name."""

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
