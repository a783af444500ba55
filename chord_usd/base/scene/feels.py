"""How surfaces feel: friction, bounce and density of what a house is built of."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Feel:
    """A physics material, in the terms of USD Physics."""

    static_friction: float
    dynamic_friction: float
    """Against a surface like itself."""
    restitution: float
    """Speed after a bounce as a share of that before."""
    density_kg_per_m3: float
    """Of the solid stuff, without the air in what is made of it."""

    def attributes(self) -> dict[str, float]:
        """As a material has them, by the names of USD Physics."""
        return {
            "physics:staticFriction": self.static_friction,
            "physics:dynamicFriction": self.dynamic_friction,
            "physics:restitution": self.restitution,
            "physics:density": self.density_kg_per_m3,
        }


METAL = Feel(0.45, 0.35, 0.25, 7800.0)
GLASS = Feel(0.45, 0.35, 0.3, 2500.0)
LACQUER = Feel(0.45, 0.35, 0.25, 900.0)
WOOD = Feel(0.55, 0.45, 0.2, 680.0)
STONE = Feel(0.6, 0.5, 0.15, 2600.0)
CONCRETE = Feel(0.7, 0.6, 0.1, 2300.0)
CLOTH = Feel(0.75, 0.65, 0.05, 250.0)
_PLASTER = Feel(0.65, 0.55, 0.1, 1200.0)
_TILES = Feel(0.55, 0.45, 0.2, 2300.0)
_PAINTED = Feel(0.45, 0.35, 0.25, 750.0)

FEEL_OF_LOOK: dict[str, Feel] = {
    "planks": WOOD, "herringbone": WOOD, "chevron": WOOD, "parquet": WOOD,
    "laminate": LACQUER, "panelling": WOOD, "wainscot": _PAINTED,
    "stone_tile": STONE, "marble": STONE, "terrazzo": STONE, "mosaic": _TILES,
    "glazed": _TILES, "brick": Feel(0.7, 0.6, 0.1, 1800.0), "plaster": _PLASTER,
    "limewash": _PLASTER, "wallpaper": _PLASTER, "concrete": CONCRETE,
    "carpet": Feel(0.8, 0.7, 0.05, 250.0), "tatami": Feel(0.65, 0.55, 0.05, 250.0),
}  # fmt: skip
"""By family of looks. Handbook values between dry surfaces of one kind, rounded."""

FEEL_OF_SURFACE: dict[str, Feel] = {
    "PlainFloor": WOOD, "PlainWall": _PLASTER, "Ceiling": _PLASTER, "Facade": _PLASTER,
    "WallTop": _PLASTER, "Trim": _PAINTED, "WindowFrame": _PAINTED, "EntranceDoor": _PAINTED,
    "RoofTiles": _TILES, "Placeholder": _PAINTED, "Metal": METAL, "Glass": GLASS,
}  # fmt: skip
"""By name of what has no look; the first two also of looks that say no family."""
