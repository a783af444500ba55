"""Plants that stand on floors, in pots and baskets."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from chord_usd.library.kit.forms import (
    CLASSIC,
    INDUSTRIAL,
    JAPANESE,
    MODERN,
    SCANDINAVIAN,
)
from chord_usd.library.kit.model import Design, Part
from chord_usd.library.kit.solids import Size
from chord_usd.library.plants.leaves import (
    OVAL,
    PADDLE,
    PotKind,
    grown,
    pot,
)
from chord_usd.library.plants.species import bamboo, cactus, monstera, olive, palm, snake, tree
from chord_usd.library.surfaces.dry_finishes import DRY


def _potted(
    size_m: Size, kind: PotKind, radius_m: float, height_m: float, draw: Callable
) -> tuple[Part, ...]:
    length, width, height = size_m
    vessel = pot(kind, radius_m, height_m)
    named = draw(size_m, vessel)
    return (*vessel.parts, *grown(named, length, width, vessel.soil_m, height))


def _looks(
    leaf_: str,
    *pots: tuple[str, str, str],
    stem: str = "green_stem",
    bark: str = "bark",
    edge: str = "leaf_fresh",
) -> dict[str, dict[str, str]]:
    """Colourways by pot: (name, pot, basket or stand)."""
    return {
        name: {
            "leaf": leaf_,
            "stem": stem,
            "bark": bark,
            "edge": edge,
            "soil": "earth",
            "pot": pot_,
            "basket": other,
            "stand": other,
        }
        for name, pot_, other in pots
    }


_CERAMIC = (
    ("white", "stoneware", "oak"),
    ("black", "dark_stoneware", "walnut"),
    ("sage", "celadon", "oak"),
)


_CLAY = (
    ("clay", "clay", "oak"),
    ("white", "chalk", "oak"),
    ("concrete", "raw_concrete", "black_metal"),
)


_GLAZE = (
    ("celadon", "celadon", "bamboo_wood"),
    ("indigo", "indigo_glaze", "bamboo_wood"),
    ("black", "dark_stoneware", "black_stain"),
)


_WOVEN = (
    ("seagrass", "clay", "seagrass"),
    ("rattan", "clay", "rattan"),
    ("dark", "clay", "dark_rattan"),
)


_MS = (MODERN, SCANDINAVIAN)


def _design(
    name: str,
    size_m: Size,
    draw: Callable,
    kind: PotKind,
    radius_m: float,
    height_m: float,
    looks: dict,
    styles: tuple[str, ...] = (),
) -> Design:
    made = partial(_potted, kind=kind, radius_m=radius_m, height_m=height_m, draw=draw)
    return Design(name, "floor_plant", size_m, made, looks, DRY, styles)


_RUBBER = partial(
    tree, outline=OVAL, leaves=42, long=0.2, wide=0.1, stems=3, bare=0.2, seed="rubber"
)


_STRELITZIA = partial(
    monstera,
    leaves=11,
    slits=0,
    outline=PADDLE,
    long=0.56,
    wide=0.27,
    pitch=74.0,
    seed="strelitzia",
)


_FICUS = partial(
    olive, twigs=60, leaves=10, long=0.075, wide=0.045, outline=OVAL, crown=0.4, seed="ficus"
)


DESIGNS = (
    _design(
        "Plant_Fiddle_Leaf",
        (0.7, 0.7, 1.6),
        partial(tree, seed="fiddle"),
        "basket",
        0.19,
        0.32,
        _looks("leaf_deep", *_WOVEN),
        (MODERN, SCANDINAVIAN, CLASSIC),
    ),
    _design(
        "Plant_Fiddle_Leaf_Pot",
        (0.6, 0.6, 1.25),
        partial(tree, leaves=26, seed="fiddle"),
        "taper",
        0.16,
        0.28,
        _looks("leaf_deep", *_CERAMIC),
        _MS,
    ),
    _design(
        "Plant_Rubber",
        (0.6, 0.6, 1.3),
        _RUBBER,
        "cylinder",
        0.16,
        0.28,
        _looks("leaf_wine", *_CERAMIC),
        (MODERN, INDUSTRIAL),
    ),
    _design(
        "Plant_Rubber_Small",
        (0.45, 0.45, 0.8),
        partial(_RUBBER, leaves=24, long=0.17),
        "stand",
        0.14,
        0.3,
        _looks("leaf_deep", *_CERAMIC),
        _MS,
    ),
    _design(
        "Plant_Monstera",
        (0.85, 0.85, 1.05),
        monstera,
        "basket",
        0.19,
        0.3,
        _looks("leaf_deep", *_WOVEN),
        (MODERN, SCANDINAVIAN, INDUSTRIAL),
    ),
    _design(
        "Plant_Monstera_Small",
        (0.55, 0.55, 0.65),
        partial(monstera, leaves=9, long=0.22, wide=0.21),
        "taper",
        0.14,
        0.22,
        _looks("leaf_deep", *_CERAMIC),
        (),
    ),
    _design(
        "Plant_Strelitzia",
        (0.85, 0.85, 1.7),
        _STRELITZIA,
        "cylinder",
        0.19,
        0.34,
        _looks("leaf_deep", *_CERAMIC),
        (MODERN, CLASSIC),
    ),
    _design(
        "Plant_Snake",
        (0.3, 0.3, 0.9),
        snake,
        "cylinder",
        0.13,
        0.24,
        _looks("leaf_deep", *_CERAMIC),
        (MODERN, INDUSTRIAL),
    ),
    _design(
        "Plant_Snake_Stand",
        (0.32, 0.32, 1.0),
        snake,
        "stand",
        0.15,
        0.34,
        _looks("leaf_deep", *_CERAMIC),
        _MS,
    ),
    _design(
        "Plant_Snake_Small",
        (0.25, 0.25, 0.6),
        partial(snake, leaves=11),
        "taper",
        0.11,
        0.18,
        _looks("leaf_deep", *_CLAY),
        (),
    ),
    _design(
        "Plant_Palm",
        (0.9, 0.9, 1.6),
        palm,
        "basket",
        0.18,
        0.3,
        _looks("leaf_fresh", *_WOVEN),
        (SCANDINAVIAN, CLASSIC),
    ),
    _design(
        "Plant_Palm_Small",
        (0.7, 0.7, 1.0),
        partial(palm, fronds=10),
        "rim",
        0.15,
        0.26,
        _looks("leaf_fresh", *_CLAY),
        (),
    ),
    _design(
        "Plant_Olive",
        (0.65, 0.65, 1.7),
        olive,
        "rim",
        0.18,
        0.32,
        _looks("leaf_dusty", *_CLAY),
        (SCANDINAVIAN, CLASSIC, INDUSTRIAL),
    ),
    _design(
        "Plant_Olive_Small",
        (0.45, 0.45, 1.0),
        partial(olive, twigs=26),
        "cube",
        0.15,
        0.24,
        _looks("leaf_dusty", *_CLAY),
        (MODERN, INDUSTRIAL, JAPANESE),
    ),
    _design(
        "Plant_Ficus",
        (0.6, 0.6, 1.5),
        _FICUS,
        "fluted",
        0.19,
        0.32,
        _looks("leaf_deep", *_CERAMIC),
        (CLASSIC,),
    ),
    _design(
        "Plant_Bamboo",
        (0.6, 0.6, 1.6),
        bamboo,
        "cube",
        0.17,
        0.3,
        _looks("leaf_fresh", *_GLAZE),
        (JAPANESE, MODERN),
    ),
    _design(
        "Plant_Bamboo_Small",
        (0.45, 0.45, 1.05),
        partial(bamboo, canes=5),
        "belly",
        0.15,
        0.22,
        _looks("leaf_fresh", *_GLAZE),
        (JAPANESE,),
    ),
    _design(
        "Plant_Maple",
        (0.75, 0.75, 1.2),
        partial(
            olive,
            twigs=40,
            leaves=10,
            long=0.075,
            wide=0.065,
            outline=(0.2, 1.0, 0.4, 0.7, 0.0),
            crown=0.62,
            seed="maple",
        ),
        "belly",
        0.18,
        0.24,
        _looks("leaf_red", *_GLAZE),
        (JAPANESE,),
    ),
    _design(
        "Plant_Cactus",
        (0.28, 0.28, 0.95),
        cactus,
        "rim",
        0.14,
        0.22,
        _looks("leaf_dusty", *_CLAY),
        (INDUSTRIAL, MODERN),
    ),
)
