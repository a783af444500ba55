"""How finishes feel: friction, bounce, density."""

from __future__ import annotations

from typing import TYPE_CHECKING

from chord_usd.base.scene.feels import CLOTH, CONCRETE, GLASS, LACQUER, METAL, STONE, WOOD, Feel
from chord_usd.library.surfaces.finishes import Finish, Surface

if TYPE_CHECKING:
    from pxr import Usd

_METAL_FROM = 0.5
_CLEAR_BELOW = 0.7


_GLAZED = Feel(0.5, 0.4, 0.2, 2300.0)
_PAPER = Feel(0.5, 0.45, 0.1, 800.0)
_EARTH = Feel(0.8, 0.7, 0.05, 1400.0)
_GREEN = Feel(0.6, 0.5, 0.1, 500.0)

BY_SURFACE: dict[Surface, Feel] = {
    "plain": LACQUER,
    "wood": WOOD,
    "weave": CLOTH,
    "linen": CLOTH,
    "crumpled": CLOTH,
    "knit": CLOTH,
    "boucle": CLOTH,
    "velvet": CLOTH,
    "leather": Feel(0.65, 0.55, 0.1, 860.0),
    "brushed": METAL,
    "stone": STONE,
    "marble": STONE,
    "quartz": STONE,
    "ceramic": _GLAZED,
    "concrete": CONCRETE,
    "terracotta": Feel(0.65, 0.55, 0.1, 1900.0),
    "rattan": Feel(0.6, 0.5, 0.15, 450.0),
    "paper": _PAPER,
    "leaf": _GREEN,
    "bark": _GREEN,
    "soil": _EARTH,
    "polished": METAL,
    "powder": METAL,
    "patina": METAL,
    "glaze": _GLAZED,
    "moulded": Feel(0.5, 0.4, 0.3, 1050.0),
    "peel": _GREEN,
    "kernels": _EARTH,
}
"""Handbook values between dry surfaces of one kind, rounded; real ones vary by a third."""


def feel_of(finish: Finish) -> Feel:
    """What a finish feels like: metals and glass by how they look, the rest by their surface."""
    if finish.metallic >= _METAL_FROM:
        return METAL
    return GLASS if finish.opacity < _CLEAR_BELOW else BY_SURFACE[finish.surface]


_STUFFS = {
    "wood": ("wood", "bark"),
    "textile": ("weave", "linen", "crumpled", "knit", "boucle", "velvet"),
    "leather": ("leather",),
    "metal": ("brushed", "polished", "powder", "patina"),
    "stone": ("stone", "marble", "quartz"),
    "ceramic": ("ceramic", "glaze", "terracotta"),
    "concrete": ("concrete",),
    "wicker": ("rattan",),
    "paper": ("paper",),
    "plant": ("leaf", "peel", "kernels"),
    "soil": ("soil",),
    "plastic": ("moulded",),
    "lacquer": ("plain",),
}
_STUFF_OF: dict[str, str] = {name: stuff for stuff, names in _STUFFS.items() for name in names}


def stuff_of(finish: Finish) -> str:
    """What a finish is made of, in a word; by the same rule as what it feels like."""
    if finish.metallic >= _METAL_FROM:
        return "metal"
    return "glass" if finish.opacity < _CLEAR_BELOW else _STUFF_OF[finish.surface]


def write_feel(prim: Usd.Prim, feel: Feel) -> None:
    """Make a material a physics material, too."""
    from pxr import Sdf, UsdPhysics

    UsdPhysics.MaterialAPI.Apply(prim)
    for name, value in feel.attributes().items():
        prim.CreateAttribute(name, Sdf.ValueTypeNames.Float, custom=False).Set(value)
