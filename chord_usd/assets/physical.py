"""How finishes feel: friction, bounce, density."""

from __future__ import annotations

from typing import TYPE_CHECKING

from chord_usd.assets.finishes import Finish, Surface
from chord_usd.scene.feels import Feel

if TYPE_CHECKING:
    from pxr import Usd

_METAL_FROM = 0.5
_CLEAR_BELOW = 0.7


METAL = Feel(0.45, 0.35, 0.25, 7800.0)
GLASS = Feel(0.45, 0.35, 0.3, 2500.0)
_LACQUER = Feel(0.45, 0.35, 0.25, 900.0)
_WOOD = Feel(0.55, 0.45, 0.2, 680.0)
_CLOTH = Feel(0.75, 0.65, 0.05, 250.0)
_STONE = Feel(0.6, 0.5, 0.15, 2600.0)
_GLAZED = Feel(0.5, 0.4, 0.2, 2300.0)
_PAPER = Feel(0.5, 0.45, 0.1, 800.0)
_EARTH = Feel(0.8, 0.7, 0.05, 1400.0)
_GREEN = Feel(0.6, 0.5, 0.1, 500.0)

BY_SURFACE: dict[Surface, Feel] = {
    "plain": _LACQUER,
    "wood": _WOOD,
    "weave": _CLOTH,
    "linen": _CLOTH,
    "knit": _CLOTH,
    "boucle": _CLOTH,
    "velvet": _CLOTH,
    "leather": Feel(0.65, 0.55, 0.1, 860.0),
    "brushed": METAL,
    "stone": _STONE,
    "marble": _STONE,
    "quartz": _STONE,
    "ceramic": _GLAZED,
    "concrete": Feel(0.7, 0.6, 0.1, 2300.0),
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


def write_feel(prim: Usd.Prim, feel: Feel) -> None:
    """Make a material one that is felt, too."""
    from pxr import UsdPhysics

    material = UsdPhysics.MaterialAPI.Apply(prim)
    material.CreateStaticFrictionAttr(feel.static_friction)
    material.CreateDynamicFrictionAttr(feel.dynamic_friction)
    material.CreateRestitutionAttr(feel.restitution)
    material.CreateDensityAttr(feel.density_kg_per_m3)
