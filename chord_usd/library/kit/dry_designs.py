"""What designs of dry rooms share: their finishes, and what each part wears unless told."""

from __future__ import annotations

from chord_usd.library.kit.model import Design, Draw
from chord_usd.library.kit.solids import Size
from chord_usd.library.surfaces.dry_finishes import DRY


def container_looks(**ways: dict[str, str]) -> dict[str, dict[str, str]]:
    """Colourways of containers by name; each says where it differs from the usual finishes."""
    base = {
        "weave": "rattan",
        "cloth": "canvas_cloth",
        "grip": "tan_leather",
        "metal": "steel",
        "plastic": "plastic_black",
        "paper": "paper",
        "wood": "oak",
        "body": "black_metal",
        "tray": "black_metal",
        "cloth_a": "coat_navy",
        "cloth_b": "beige_cloth",
        "card": "paper",
    }
    return {name: {**base, **way} for name, way in ways.items()}


WOVEN = container_looks(
    seagrass={"weave": "seagrass"},
    rattan={},
    dark={"weave": "dark_rattan"},
    white={"weave": "white_rattan"},
)


WOODEN = container_looks(
    oak={},
    walnut={"wood": "walnut"},
    bamboo={"wood": "bamboo_wood"},
    black_stain={"wood": "black_stain"},
)


def pot_looks(*pots: tuple[str, str], **more: str) -> dict[str, dict[str, str]]:
    """Colourways of pots by (name, finish of the pot); more: finishes that all of them have."""
    base = {
        "soil": "earth",
        "leaf": "leaf_fresh",
        "stem": "green_stem",
        "twig": "twig",
        "plume": "pampas",
        "flower": "tulip_pink",
        "wick": "ink",
        "glass": "clear_glass",
        "label": "cream",
        "wax": "wax",
        "basket": "seagrass",
        "stand": "oak",
    }
    return {name: {**base, **more, "pot": finish} for name, finish in pots}


CERAMIC = (
    ("white", "chalk"),
    ("stoneware", "stoneware"),
    ("black", "dark_stoneware"),
    ("clay", "clay"),
)


def design(
    name: str, category: str, size_m: Size, draw: Draw, looks: dict, styles: tuple[str, ...] = ()
) -> Design:
    """A design that wears the finishes of dry rooms."""
    return Design(name, category, size_m, draw, looks, DRY, styles)
