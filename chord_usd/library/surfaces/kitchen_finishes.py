"""Finishes of kitchen and bath things beside the common ones, and the colourways of kitchens."""

from __future__ import annotations

from collections.abc import Mapping

from chord_usd.library.surfaces.finishes import FINISHES as COMMON
from chord_usd.library.surfaces.finishes import Finish

FINISHES: Mapping[str, Finish] = {
    **COMMON,
    # glazes
    "tile_sage": Finish((150, 170, 146), 0.14, surface="ceramic"),
    "tile_navy": Finish((42, 66, 98), 0.14, surface="ceramic"),
    "tile_graphite": Finish((66, 68, 70), 0.2, surface="ceramic"),
    "tile_clay": Finish((186, 122, 92), 0.3, surface="ceramic"),
    "glazed_white": Finish((240, 243, 241), 0.05),
    "glazed_sage": Finish((172, 188, 170), 0.05),
    "glazed_graphite": Finish((58, 62, 66), 0.05),
    "stoneware": Finish((206, 196, 178), 0.45, surface="ceramic"),
    "stoneware_blue": Finish((84, 108, 128), 0.35, surface="ceramic"),
    "stoneware_dark": Finish((70, 68, 66), 0.5, surface="ceramic"),
    # enamel and metal
    "enamel_cream": Finish((236, 226, 200), 0.18, surface="glaze"),
    "enamel_red": Finish((158, 38, 34), 0.18, surface="glaze"),
    "enamel_blue": Finish((52, 88, 120), 0.18, surface="glaze"),
    "cast_iron": Finish((38, 38, 40), 0.62, surface="powder"),
    "copper": Finish((196, 122, 84), 0.24, 1.0, surface="polished"),
    "brushed_steel": Finish((176, 178, 180), 0.34, 1.0, surface="brushed"),
    # glass and what shows through
    "clear_glass": Finish((226, 236, 234), 0.03, 0.0, 0.22),
    "amber_glass": Finish((124, 66, 24), 0.08, 0.0, 0.82),
    "oil": Finish((178, 150, 42), 0.08, 0.0, 0.85),
    "vinegar": Finish((62, 26, 18), 0.08, 0.0, 0.92),
    "pasta": Finish((226, 190, 116), 0.7, surface="kernels"),
    "rice": Finish((236, 230, 214), 0.8, surface="kernels", contrast=0.5),
    "beans": Finish((92, 44, 36), 0.55, surface="kernels"),
    "lentils": Finish((196, 104, 54), 0.7, surface="kernels"),
    "oats": Finish((208, 184, 146), 0.9, surface="kernels"),
    "sugar": Finish((244, 242, 236), 0.8, surface="kernels", contrast=0.5),
    # plastic and labels
    "label": Finish((238, 232, 218), 0.75, surface="paper"),
    "label_dark": Finish((46, 44, 42), 0.7, surface="paper"),
    "plastic_sage": Finish((158, 176, 158), 0.35, surface="moulded"),
    "plastic_blush": Finish((222, 184, 172), 0.35, surface="moulded"),
    "plastic_blue": Finish((112, 150, 178), 0.35, surface="moulded"),
    "cork": Finish((186, 146, 102), 0.9, surface="kernels"),
    "lemon": Finish((232, 200, 66), 0.5, surface="peel"),
}
"""Finish by name."""
