"""Finishes of curtains, bedding, cushions, rugs and towels, and colourways made of them."""

from __future__ import annotations

from dataclasses import replace

from chord_usd.library.surfaces.finishes import Finish, Surface, finish_table

_COLOURS: dict[str, tuple[int, int, int]] = {
    "white": (240, 238, 233),
    "cream": (234, 226, 211),
    "oat": (214, 201, 178),
    "beige": (196, 178, 152),
    "grey": (158, 158, 156),
    "charcoal": (72, 73, 76),
    "black": (40, 39, 40),
    "rust": (168, 92, 60),
    "terracotta": (184, 112, 84),
    "mustard": (198, 152, 66),
    "gold": (176, 140, 78),
    "sage": (150, 162, 138),
    "olive": (112, 112, 76),
    "moss": (94, 104, 74),
    "forest": (52, 78, 64),
    "teal": (56, 104, 108),
    "blue": (98, 124, 152),
    "navy": (46, 60, 86),
    "indigo": (52, 62, 96),
    "blush": (214, 176, 164),
    "burgundy": (104, 40, 50),
    "tan": (172, 126, 84),
}

_WEAVES: dict[str, tuple[Surface, float]] = {
    "linen": ("weave", 0.95),
    "cloth": ("weave", 0.95),
    "cotton": ("weave", 0.92),
    "wool": ("knit", 0.97),
    "velvet": ("velvet", 0.7),
    "boucle": ("boucle", 0.97),
}


def _textiles() -> dict[str, Finish]:
    made = {}
    for colour, rgb in _COLOURS.items():
        for cloth, (surface, roughness) in _WEAVES.items():
            made[f"{colour}_{cloth}"] = Finish(rgb, roughness, surface=surface)
    return made


TEXTILES: dict[str, Finish] = {
    **_textiles(),
    **finish_table("textiles"),
}
"""By name: `colour_cloth`, such as sage_linen, beside the furniture's finishes."""


BED_LINEN: dict[str, Finish] = {
    **TEXTILES,
    **{
        f"{name}_bedding": replace(finish, surface="crumpled")
        for name, finish in TEXTILES.items()
        if finish.surface in ("weave", "linen") and finish.opacity == 1.0
    },
}
"""TEXTILES, and each woven one as it is on a bed: `white_cloth_bedding` is creased."""

DRY_TEXTILES: dict[str, Finish] = {**TEXTILES, **finish_table("dry")}
"""TEXTILES beside the textiles of dry rooms, which count where both have a name."""
