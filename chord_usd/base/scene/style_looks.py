"""Looks of floors and walls of each style: families and ranges of their parameters.

Sizes that come in steps are words: a pair of numbers would be a range.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from chord_usd.base.scene.types import RoomKind

Value = float | str | tuple[float, float] | tuple[str, ...]
"""One value, a range that is drawn from evenly, or words of which one is drawn."""

HOME_WOOD = "home"
"""In place of a wood: the one that the home agrees on."""

ACCENTS = ("accent_pale", "accent", "accent_deep")
"""In place of a colour: the home's accent, as paint (PAINTS)."""


@dataclass(frozen=True)
class Ranges:
    """A family of looks and what its parameters may be; the rest keep their defaults."""

    family: str
    """Name of a family (assets.look_families)."""
    weight: float = 1.0
    """How often it is taken, next to the others of its list."""
    parameters: Mapping[str, Value] = field(default_factory=dict)


GROUP_OF: dict[RoomKind, str] = {
    "living": "living", "dining": "living", "study": "living", "unknown": "living",
    "bedroom": "bedroom", "corridor": "corridor", "store": "corridor",
    "kitchen": "kitchen", "bathroom": "bathroom", "balcony": "balcony",
    "washroom": "bathroom", "wc": "bathroom",
}  # fmt: skip
"""Rooms of a group have the same looks."""

Looks = Mapping[str, Mapping[str, Sequence[Ranges]]]
"""Style, group of rooms, families."""


def _of(family: str, weight: float = 1.0, **parameters: Value) -> Ranges:
    return Ranges(family, weight, parameters)


_BRUSHED: dict[str, Value] = {"wear": (0.0, 0.08), "sheen": (0.35, 0.5)}
_OILED: dict[str, Value] = {"wear": (0.05, 0.2), "sheen": (0.2, 0.35)}
_WAXED: dict[str, Value] = {"wear": (0.1, 0.3), "sheen": (0.6, 0.75)}


def _smooth(*colours: str, weight: float = 1.0) -> Ranges:
    return _of(
        "plaster", weight, colour=colours, finish="smooth", relief=(0.3, 0.6), sheen=(0.08, 0.2)
    )


def _rolled(*colours: str, weight: float = 1.0) -> Ranges:
    return _of(
        "plaster", weight, colour=colours, finish="roller", relief=(0.5, 1.0), sheen=(0.05, 0.15)
    )


def _slab(*colours: str, weight: float = 1.0, **more: Value) -> Ranges:
    """Large tiles with hardly a joint."""
    usual: dict[str, Value] = {
        "size_m": ("0.6", "0.75", "0.9"), "joint_m": (0.0015, 0.0025), "mottle": (0.4, 0.9),
        "sheen": (0.45, 0.65), "grout": ("#a8a59f", "#b9b6b0"),
    }  # fmt: skip
    return Ranges("stone_tile", weight, {"colour": colours, **usual, **more})


def _deck(wood: str, **more: Value) -> Ranges:
    usual: dict[str, Value] = {
        "wood": wood, "width_m": (0.12, 0.145), "length_m": (1.8, 2.4), "joint_m": 0.005,
        "wear": (0.3, 0.6), "sheen": 0.1,
    }  # fmt: skip
    return Ranges("planks", 1.0, {**usual, **more})


def _checker(size_m: tuple[float, float], weight: float = 1.0) -> Ranges:
    return _of(
        "stone_tile", weight, pattern="checker", colour=("#eae7e0", "#e6dfd0"),
        second=("#2e2e30", "#3a4a42", "#5c4a3e"), size_m=size_m, joint_m=0.0015,
        mottle=(0.6, 1.0), sheen=(0.75, 0.9), grout="#9d978c",
    )  # fmt: skip


# Modern: wide calm planks, large slabs, micro cement; white, greige, one deep colour, slats.

_MODERN_PLANKS = _of(
    "planks", 3.0, wood=HOME_WOOD, tone=(-0.1, 0.35), width_m=(0.18, 0.24), length_m=(1.9, 2.4),
    joint_m=(0.0005, 0.001), **_BRUSHED,
)  # fmt: skip
_MODERN_SLAB = _slab("#bdb8af", "#c9c4ba", "#a9a8a5", weight=1.2)
_MICRO_CEMENT = _of(
    "concrete", 0.9, colour=("#bbb6ad", "#aaa8a4", "#c6c0b6"), joints="none", cloud=(0.5, 0.9),
    pores=(0.0, 0.05), sheen=(0.45, 0.6),
)  # fmt: skip
_MODERN_LIVING = (_MODERN_PLANKS, _MODERN_SLAB, _MICRO_CEMENT)
_MODERN_FLOORS = {
    "living": _MODERN_LIVING,
    "bedroom": (_MODERN_PLANKS, _of("carpet", 0.9, colour=("#a7a49e", "#8e8d8c", "#b9b2a6"),
                                    pile="cut", fleck=(0.1, 0.4))),
    "corridor": _MODERN_LIVING,
    "kitchen": _MODERN_LIVING,
    "bathroom": (
        _slab("#b4b1ab", "#8f8e8c", "#c8c3ba", weight=2.5),
        _of("marble", 1.2, kind=("grey", "carrara", "nero"), slab_m=(0.6, 0.9), veins=(0.5, 0.8)),
        _of("terrazzo", 0.7, colour="#c9c7c2", chips="grey", chip_m=(0.008, 0.014)),
    ),
    "balcony": (_slab("#9b9994", "#86857f", sheen=0.25), _deck("smoked_oak")),
}  # fmt: skip
_MODERN_MAIN = (_smooth("#f0efeb", "#ebe9e4", "#ecebea", weight=2.0), _smooth("#ddd8ce", "#d5d3cf"))
_MODERN_WALLS = {
    **dict.fromkeys(("living", "bedroom", "corridor", "kitchen", "balcony"), _MODERN_MAIN),
    "bathroom": (
        _slab("#d6d3cc", "#c4c1ba", "#a3a19d", size_m="1.2", aspect=2.0, weight=2.0),
        _of("marble", 1.0, kind=("nero", "grey"), slab_m=(0.9, 1.2), aspect=1.0),
        _slab("#bdbab4", "#8f8d8a", size_m="0.6", aspect=2.0, bond="stack"),
    ),
}
_MODERN_ACCENTS = (
    _smooth("accent", weight=1.6),
    _smooth("#8d8880", "#5b5e60", "#4c5358"),
    _of("marble", 0.9, kind=("grey", "calacatta"), slab_m=(0.9, 1.2), aspect=1.0),
    _of("concrete", 0.9, colour="#b3b1ac", joints="none", cloud=1.0, pores=0.1, sheen=0.2),
)

# Scandinavian: pale oiled boards, white walls, pale colours, small leaves, honest white tiles.

_NORDIC_PLANKS = _of(
    "planks", 3.0, wood=(HOME_WOOD, HOME_WOOD, "white_oak"), tone=(0.0, 0.5),
    width_m=(0.13, 0.2), length_m=(1.8, 2.4), joint_m=(0.0008, 0.0015), **_OILED,
)  # fmt: skip
_NORDIC_STRIPS = _of(
    "laminate", 0.7, wood=HOME_WOOD, tone=(0.1, 0.5), strip_m=(0.062, 0.07), sheen=(0.3, 0.45)
)
_NORDIC_HEXAGONS = _of(
    "mosaic", 1.6, shape="hexagon", colour=("#e9e8e4", "#d9dad8"), second=("#5d6468", "#9aa7a5"),
    share=(0.0, 0.18), size_m=(0.05, 0.11), grout=("#b9b8b4", "#8f908e"), sheen=0.35,
)  # fmt: skip
_NORDIC_FLOORS = {
    **dict.fromkeys(("living", "corridor"), (_NORDIC_PLANKS, _NORDIC_STRIPS)),
    "bedroom": (_NORDIC_PLANKS, _NORDIC_STRIPS,
                _of("carpet", 0.6, colour=("#cfcac0", "#c3c4c2"), pile="loop", fleck=(0.4, 0.8))),
    "kitchen": (_NORDIC_PLANKS, _NORDIC_STRIPS, _slab("#c9c8c5", "#d6d3cd", sheen=0.35)),
    "bathroom": (
        _NORDIC_HEXAGONS,
        _of("terrazzo", 1.4, colour=("#e6e3dd", "#dedddb"), chips=("mixed", "rose", "grey"),
            chip_m=(0.008, 0.016), density=(0.2, 0.4)),
        _slab("#b9b9b7", "#a4a5a5", size_m=("0.3", "0.6"), sheen=0.3),
    ),
    "balcony": (_deck("grey_oak"), _slab("#a8a7a3", sheen=0.2)),
}  # fmt: skip
_NORDIC_MAIN = (_rolled("#f6f5f2", "#f3f2ee", "#f4f3f1", weight=3.0), _rolled("#ebe8e1"))
_NORDIC_GLAZE = _of(
    "glazed", 2.0, colour=("#f3f2ee", "#eeeeea"), size_m=("0.1", "0.13", "0.2"), aspect=1.0,
    bond="stack", grout=("#c9c7c2", "#a9a9a6"), variation=(0.15, 0.4), waviness=(0.1, 0.3),
)  # fmt: skip
_NORDIC_WALLS = {
    **dict.fromkeys(("living", "bedroom", "corridor", "kitchen", "balcony"), _NORDIC_MAIN),
    "bathroom": (
        _NORDIC_GLAZE,
        _of("glazed", 1.5, colour=("#f2f2ef",), size_m=("0.15", "0.2"), aspect=2.0, bond="half",
            grout=("#b8b7b3", "#8c8c8a")),
        _of("glazed", 1.0, colour="accent_pale", size_m="0.1", aspect=1.0, bond="stack",
            variation=(0.5, 0.9), waviness=0.5, grout="#e3e0d9"),
    ),
}  # fmt: skip
_NORDIC_ACCENTS = (
    _rolled("accent_pale", weight=2.6),
    _of("wallpaper", 1.5, pattern=("leaves", "lattice"), ground_colour="#f1eee6", ink="accent_pale",
        second="#d5cfbf", repeat_m=("0.265", "0.353", "0.53")),
    _of("wainscot", 1.0, colour="#f3f2ee", above="accent_pale", height_m=(1.1, 1.3),
        panel_m=(0.4, 0.55), moulding_m=(0.012, 0.016), sheen=0.35),
)  # fmt: skip

# Classic: herringbone and chevron waxed, panelled walls, stripes and damask, marble, chessboards.

_CLASSIC_HERRINGBONE = _of(
    "herringbone", 3.0, wood=HOME_WOOD, tone=(0.0, 0.35), width_m=(0.075, 0.11), ratio=("5", "6"),
    **_WAXED,
)  # fmt: skip
_CLASSIC_CHEVRON = _of(
    "chevron", 2.0, wood=HOME_WOOD, tone=(0.0, 0.35), width_m=(0.085, 0.11), length_m=(0.5, 0.65),
    angle_deg=("45", "52"), **_WAXED,
)  # fmt: skip
_CLASSIC_BASKET = _of(
    "parquet", 1.0, wood=HOME_WOOD, tone=(0.0, 0.3), block_m=(0.28, 0.45), strips=("4", "5"),
    **_WAXED,
)  # fmt: skip
_CLASSIC_LIVING = (_CLASSIC_HERRINGBONE, _CLASSIC_CHEVRON, _CLASSIC_BASKET)
_CLASSIC_FLOORS = {
    "living": _CLASSIC_LIVING,
    "bedroom": (*_CLASSIC_LIVING, _of("carpet", 1.2, colour=("#d5c8b0", "#c9bca6", "#8a8f84"),
                                      pile="cut", fleck=(0.1, 0.3))),
    "corridor": (*_CLASSIC_LIVING, _checker((0.33, 0.45), 2.0)),
    "kitchen": (_checker((0.3, 0.42), 2.5), _slab("#d8c9ae", "#cbb894", size_m=("0.4", "0.5"),
                                                  joint_m=0.004, grout="#b7a88c", mottle=1.2)),
    "bathroom": (
        _of("marble", 2.0, kind=("carrara", "crema", "calacatta"), slab_m=(0.4, 0.6)),
        _checker((0.2, 0.3), 1.6),
        _of("mosaic", 1.0, shape="hexagon", colour="#efece4", second="#26272a", share=(0.06, 0.14),
            size_m=(0.026, 0.036), grout="#bdb8ac"),
    ),
    "balcony": (_slab("#b9785a", "#c08c66", size_m=("0.2", "0.3"), joint_m=0.006, mottle=1.6,
                      sheen=0.15, grout="#b3a28c"), _checker((0.2, 0.3))),
}  # fmt: skip
_CREAM = ("#f0e8d8", "#ece3d2", "#efe6da", "#e8e0d2")
_CLASSIC_WAINSCOT = _of(
    "wainscot", 1.5, colour=("#f1ece0", "#eee6d6"), above=_CREAM, height_m=(0.9, 1.05),
    panel_m=(0.5, 0.75), moulding_m=(0.024, 0.036),
)  # fmt: skip
_CLASSIC_MAIN = (_CLASSIC_WAINSCOT, _smooth(*_CREAM))
_CLASSIC_WALLS = {
    **dict.fromkeys(("living", "corridor"), _CLASSIC_MAIN),
    **dict.fromkeys(("bedroom", "kitchen", "balcony"), (_smooth(*_CREAM, weight=2.0),)),
    "bathroom": (
        _of("marble", 1.6, kind=("carrara", "crema", "calacatta"), slab_m=(0.5, 0.8), aspect=2.0),
        _of("glazed", 1.6, colour=("#f2ecdd", "#f3f0e8"), size_m="0.15", aspect=2.0, bond="half",
            grout="#cfc6b4", variation=0.3),
        _of("glazed", 0.9, colour="accent_deep", size_m="0.15", aspect=2.0, bond="half",
            grout="#c9c0ae", variation=0.5),
    ),
}  # fmt: skip
_CLASSIC_ACCENTS = (
    _of("wallpaper", 1.6, pattern=("stripes", "damask"), ground_colour=("#efe6d2", "#ece4d4"),
        ink="accent_pale", second="#b79a63", repeat_m=("0.353", "0.53")),
    _of("wainscot", 1.6, colour="#f1ece0", above="accent_deep", height_m=(0.9, 1.05),
        panel_m=(0.5, 0.75)),
    _smooth("accent_deep"),
)  # fmt: skip

# Industrial: concrete, old dark boards, brick bare or painted, raw plaster, dark joints.

_INDUSTRIAL_PLANKS = _of(
    "planks", 1.6, wood=(HOME_WOOD, "smoked_oak"), tone=(0.0, 0.4), width_m=(0.14, 0.26),
    length_m=(1.4, 2.2), joint_m=(0.0015, 0.003), wear=(0.5, 0.9), sheen=(0.25, 0.4),
)  # fmt: skip
_SCREED = _of(
    "concrete", 2.0, colour=("#9b9995", "#8d8b88", "#a6a39d"), joints=("none", "slabs"),
    slab_m=(1.6, 2.4), cloud=(1.1, 1.6), pores=(0.1, 0.35), sheen=(0.35, 0.55),
)  # fmt: skip
_INDUSTRIAL_FLOORS = {
    **dict.fromkeys(("living", "bedroom", "corridor"), (_SCREED, _INDUSTRIAL_PLANKS)),
    "kitchen": (_SCREED, _slab("#55565a", "#6a6966", sheen=0.3, grout="#4a4a4a")),
    "bathroom": (
        _SCREED,
        _of("mosaic", 1.4, shape="hexagon", colour=("#3a3c3f", "#4d4f50"), second="#6d6e6e",
            share=(0.0, 0.15), size_m=(0.06, 0.12), grout="#8a8985", sheen=0.25),
        _slab("#4e5053", "#626262", size_m=("0.3", "0.6"), sheen=0.25, grout="#77756f"),
    ),
    "balcony": (_of("concrete", 1.0, colour="#98968f", joints="slabs", slab_m=(0.8, 1.2),
                    pores=0.6, sheen=0.05), _deck("grey_oak", wear=0.8)),
}  # fmt: skip
_RAW = _of(
    "plaster", 1.6, colour=("#c9c6c0", "#bcb9b4", "#d3d0ca"), finish="sand", relief=(0.6, 1.1),
    sheen=0.03,
)  # fmt: skip
_PAINTED_BRICK = _of(
    "brick", 1.4, painted=(0.75, 1.0), paint=("#e9e7e2", "#e2e0db"), wear=(0.3, 0.6)
)
_BARE_BRICK = _of(
    "brick", 2.0, colour=("#80503f", "#74463a", "#8a5e4a"), mortar=("#b7aea0", "#a09a90"),
    painted=0.0, wear=(0.4, 0.8),
)  # fmt: skip
_FORMWORK = _of(
    "concrete", 1.3, colour=("#b0aea9", "#a3a19c"), joints="formwork", slab_m=(1.8, 2.4),
    cloud=(0.9, 1.4), pores=(0.5, 0.9), sheen=0.1,
)  # fmt: skip
_INDUSTRIAL_WALLS = {
    **dict.fromkeys(("living", "corridor", "balcony"), (_RAW, _PAINTED_BRICK)),
    "bedroom": (_RAW, _FORMWORK),
    "kitchen": (_RAW, _PAINTED_BRICK, _BARE_BRICK),
    "bathroom": (
        _of("glazed", 2.0, colour=("#eceae5", "#f0efec"), size_m=("0.15", "0.2"), aspect=2.0,
            bond="half", grout=("#4a4a4a", "#5b5a58"), joint_m=0.003, variation=0.3),
        _of("glazed", 1.2, colour=("#26282a", "#34383a"), size_m=("0.15", "0.2"), aspect=2.0,
            bond=("half", "stack"), grout="#77746e", variation=0.5),
        _FORMWORK,
    ),
}  # fmt: skip
_INDUSTRIAL_ACCENTS = (
    _BARE_BRICK,
    _FORMWORK,
    _of("plaster", 0.9, colour=("#4b4e50", "#5a5854", "#3f4648"), finish="sand", relief=0.7,
        sheen=0.05),
)  # fmt: skip

# Japanese: tatami, narrow pale boards, clay with straw, slats of wood, grass cloth, slate.

_JAPANESE_PLANKS = _of(
    "planks", 2.6, wood=(HOME_WOOD, "hinoki"), tone=(0.05, 0.4), width_m=(0.09, 0.125),
    length_m=(1.6, 1.9), joint_m=(0.0005, 0.001), wear=(0.0, 0.1), sheen=(0.3, 0.45),
)  # fmt: skip
_TATAMI = _of(
    "tatami", 1.1, mat_m=(0.88, 0.955), age=(0.2, 0.8), border=("#39442f", "#2f3437", "#4a3d2c")
)
_SLATE = _slab(
    "#5a5c5b", "#6e6f6b", "#7d7b74", size_m=("0.3", "0.6"), aspect=("1", "2"), sheen=0.25,
    mottle=1.3, grout="#5b5b58",
)  # fmt: skip
_JAPANESE_FLOORS = {
    "living": (_JAPANESE_PLANKS, _TATAMI),
    "bedroom": (Ranges("tatami", 6.0, _TATAMI.parameters), _JAPANESE_PLANKS),
    **dict.fromkeys(("corridor", "kitchen"), (_JAPANESE_PLANKS,)),
    "bathroom": (
        _SLATE,
        _of(
            "mosaic",
            1.2,
            shape=("square", "penny"),
            colour=("#7d8a80", "#8f918b", "#5f6a68"),
            share=0.0,
            size_m=(0.022, 0.05),
            variation=(0.5, 0.9),
            grout="#a5a29a",
            sheen=0.4,
        ),
    ),
    "balcony": (_deck("hinoki", tone=-0.2), _SLATE),
}
_CLAY = _of(
    "limewash", 2.2, colour=("#ddd0b8", "#d8cab0", "#e2d8c4", "#d9cdbc"), cloud=(0.4, 0.9),
    relief=(0.6, 1.2), straw=(0.2, 0.8),
)  # fmt: skip
_SAND = _of(
    "plaster", 1.0, colour=("#e9e1d0", "#e5dcca"), finish="sand", relief=(0.6, 1.0), sheen=0.02
)
_JAPANESE_WALLS = {
    **dict.fromkeys(("living", "bedroom", "corridor", "kitchen", "balcony"), (_CLAY, _SAND)),
    "bathroom": (
        _of("mosaic", 2.0, shape="finger", colour=("#8f9c90", "#a9a79c", "#6c7d80", "#d8d3c6"),
            share=0.0, size_m=(0.02, 0.028), variation=(0.6, 1.0), grout="#b5b1a6", sheen=0.75),
        _of("panelling", 1.0, wood="hinoki", pattern="boards", board_m=(0.09, 0.12), sheen=0.3),
        _SLATE,
    ),
}  # fmt: skip
_JAPANESE_ACCENTS = (
    _of("panelling", 0.7, wood=HOME_WOOD, pattern=("slats", "boards"), board_m=(0.04, 0.055)),
    _of("limewash", 1.6, colour=("#a8a488", "#9b8b72", "#8f9284", "#b49f80"), cloud=(0.6, 1.0),
        straw=(0.3, 0.9)),
    _of("wallpaper", 1.0, pattern=("grasscloth", "arches"), ground_colour=("#d9ccb0", "#e2d9c6"),
        ink="#cbbd9d", second="#bfae8a", repeat_m=("0.353", "0.53")),
)  # fmt: skip


def _everywhere(looks: Sequence[Ranges]) -> Mapping[str, Sequence[Ranges]]:
    return dict.fromkeys(("living", "bedroom"), looks)


FLOOR_LOOKS: Looks = {
    "modern": _MODERN_FLOORS, "scandinavian": _NORDIC_FLOORS, "classic": _CLASSIC_FLOORS,
    "industrial": _INDUSTRIAL_FLOORS, "japanese": _JAPANESE_FLOORS,
}  # fmt: skip
WALL_LOOKS: Looks = {
    "modern": _MODERN_WALLS, "scandinavian": _NORDIC_WALLS, "classic": _CLASSIC_WALLS,
    "industrial": _INDUSTRIAL_WALLS, "japanese": _JAPANESE_WALLS,
}  # fmt: skip
ACCENT_LOOKS: Looks = {
    name: _everywhere(looks)
    for name, looks in (
        ("modern", _MODERN_ACCENTS), ("scandinavian", _NORDIC_ACCENTS),
        ("classic", _CLASSIC_ACCENTS), ("industrial", _INDUSTRIAL_ACCENTS),
        ("japanese", _JAPANESE_ACCENTS),
    )
}  # fmt: skip
"""Looks of walls that differ from the house's walls."""

PAINTS: dict[str, tuple[str, str, str]] = {
    "teal": ("#b9cccb", "#5f8385", "#2f5256"),
    "mustard": ("#e9dcb9", "#bf9f63", "#8c6f3c"),
    "rust": ("#e3c9ba", "#a97860", "#7c4a36"),
    "navy": ("#c3cad6", "#4a5a76", "#2b3850"),
    "sage": ("#ccd4c3", "#94a389", "#5f6f5a"),
    "blush": ("#ead7cf", "#cfa497", "#9a6a60"),
    "blue": ("#cddae2", "#86a0b4", "#4c6479"),
    "burgundy": ("#d9bdb8", "#8a4a4c", "#5c2b32"),
    "forest": ("#c3cfc2", "#587560", "#2f4a3c"),
    "gold": ("#e9dfc4", "#bfa878", "#8f8468"),
    "tan": ("#e2cdb4", "#b08a62", "#7a5a3c"),
    "moss": ("#cfd0b8", "#8d9270", "#585f44"),
    "indigo": ("#c2c8d6", "#56628a", "#333d5e"),
    "charcoal": ("#c4c5c5", "#6a6d70", "#3c3f42"),
    "terracotta": ("#e4c6b4", "#b87a5c", "#7e4d38"),
}
"""Wall paint of an accent: pale, in between, deep."""
