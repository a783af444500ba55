"""Colours and materials as people say them in English: "dark green leather", "light oak".

A coat is shades, then colours, then a material, each of which may be missing. Colours are those of
paints and cloths in homes: "blue" is no primary colour.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from chord_usd.base.scene.intents import Coat

MOST_WORDS = 5

_COLOURS = (
    "white 240 238 233|off white 236 230 218|warm white 238 231 218|ivory 240 234 216"
    "|cream 236 228 206|eggshell 236 230 214|beige 212 196 170|sand 212 198 172|taupe 168 152 136"
    "|tan 186 148 108|camel 182 142 98|caramel 176 120 72|cognac 150 88 52|brown 110 74 50"
    "|chocolate 78 52 38|black 32 32 34|charcoal 70 73 78|anthracite 62 66 70|graphite 62 66 70"
    "|grey 146 148 150|gray 146 148 150|silver 192 194 196|greige 196 188 174"
    "|blue 84 116 158|navy 40 58 92|navy blue 40 58 92|sky blue 156 192 218|ice blue 206 224 232"
    "|baby blue 178 208 228|powder blue 176 200 216|teal 56 112 116|turquoise 92 176 176"
    "|aqua 142 204 204|mint 178 212 188|green 96 130 92|sage 148 162 136|sage green 148 162 136"
    "|olive 118 118 74|olive green 118 118 74|forest green 50 82 62|emerald 40 108 84"
    "|moss 104 112 70|mint green 178 212 188|yellow 232 202 104|mustard 204 158 70|gold 196 160 88"
    "|ochre 198 148 76|orange 216 132 68|rust 172 96 64|terracotta 186 108 78|peach 238 196 166"
    "|coral 226 132 112|red 170 56 50|burgundy 106 34 44|wine 104 38 48|pink 222 172 170"
    "|blush 218 178 164|rose 210 158 150|purple 118 84 130|lavender 190 178 212|lilac 196 176 208"
    "|plum 94 56 84|violet 124 96 158|denim 78 100 130|indigo 52 62 102|slate 96 108 118"
)
_SHADES = {
    "light": 0.45, "pale": 0.5, "soft": 0.25, "pastel": 0.5, "bright": 0.1, "dark": -0.4,
    "deep": -0.35, "rich": -0.2, "matte": 0.0, "matt": 0.0, "glossy": 0.0, "neutral": 0.0,
    "solid": 0.0,
    "warm": 0.0, "cool": 0.0,
}  # fmt: skip
"""How far to white, or to black."""

WOODS = {
    "oak": (176, 137, 94), "walnut": (98, 74, 56), "birch": (218, 198, 166),
    "cherry": (138, 88, 60), "pine": (206, 168, 122), "ash": (208, 194, 174),
    "maple": (220, 192, 152), "teak": (150, 110, 78), "bamboo": (212, 180, 130),
    "mahogany": (110, 62, 44),
}  # fmt: skip
"""With their usual colours."""
_OF_WOOD = ("parquet", "herringbone", "chevron", "laminate", "panelling")
_MATERIALS = (
    "leather|velvet|linen|cotton|wool|cloth=fabric|boucle|rattan|wicker=rattan|glass|metal|steel"
    "|brass|marble|stone|concrete|ceramic|wood|wood=wooden|wood=timber|wood=hardwood"
    "|wood=hard wood|wood=floorboards|wood=planks|wood=wood planks|parquet|herringbone|chevron"
    "|laminate|tiles|tiles=tile|tiles=tiled|tiles=ceramic tiles|tiles=porcelain|terrazzo|mosaic"
    "|tatami|brick|brick=bricks|brick=exposed brick|wallpaper|plaster|limewash|panelling"
    "|panelling=paneling|panelling=wood panelling|panelling=wood panels|wainscot"
    "|wainscot=wainscoting|carpet=carpeting|darker|lighter"
)


@cache
def _colours() -> dict[str, tuple[int, int, int]]:
    rows = (row.rsplit(" ", 3) for row in _COLOURS.split("|"))
    return {name: (int(red), int(green), int(blue)) for name, red, green, blue in rows}


@cache
def _materials() -> dict[str, str]:
    rows = (row.partition("=") for row in _MATERIALS.split("|"))
    return {said or colour: colour for colour, _, said in rows} | {wood: wood for wood in WOODS}


def coat(words: Sequence[str]) -> Coat | None:
    """What these words together say something is to look like; None for other words."""
    if not words or len(words) > MOST_WORDS:
        return None
    at, toned = 0, 0.0
    while at < len(words) and words[at] in _SHADES:
        toned += _SHADES[words[at]]
        at += 1
    taken = next((n for n in (2, 1) if " ".join(words[at : at + n]) in _colours()), 0)
    rgb = _colours().get(" ".join(words[at : at + taken]))
    material = " ".join(words[at + taken :])
    wood, _, rest = material.partition(" ")
    if wood in WOODS and _materials().get(rest) == "wood":
        material = wood  # "dark oak hardwood"
    elif wood in WOODS and rest in _OF_WOOD:
        material, rgb = rest, rgb or WOODS[wood]  # "oak parquet"
    if material and material not in _materials():
        return None
    if rgb is None and not material:
        return None
    if rgb is None and toned:
        rgb = _toned((150, 112, 76), toned)  # a dark wood, a light leather
    elif rgb is not None:
        rgb = _toned(rgb, toned)
    return Coat(" ".join(words), rgb, _materials().get(material, ""))


def _toned(rgb: tuple[int, int, int], by: float) -> tuple[int, int, int]:
    end = 255 if by > 0 else 0
    red, green, blue = (round(level + (end - level) * abs(by)) for level in rgb)
    return red, green, blue
