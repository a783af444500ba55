"""Looks of walls and floors as people say them: "white oak", "sage", "dark grey tiles"."""

from __future__ import annotations

from chord_usd.base.scene.colour_space import ALIKE, Rgb, colour_distance
from chord_usd.base.scene.intents import Coat
from chord_usd.base.scene.look_families import Family, family_named
from chord_usd.base.scene.style_rooms import Part, Wanted
from chord_usd.base.scene.types import RoomKind
from chord_usd.library.looks.look_colours import MARBLES, WOODS

_FAMILIES: dict[Part, dict[str, str]] = {
    "floor": {"wood": "planks", "tiles": "stone_tile", "stone": "stone_tile",
              "ceramic": "stone_tile", "": "stone_tile"},
    "wall": {"wood": "panelling", "tiles": "glazed", "ceramic": "glazed", "stone": "stone_tile",
             "": "plaster"},
}  # fmt: skip
"""Where the family has another name than the material. "" is a colour alone."""

_LIKE = {"pine": "larch", "ash": "white_oak", "maple": "birch", "teak": "larch",
         "mahogany": "cherry", "bamboo": "hinoki"}  # fmt: skip
"""Woods that are not drawn, and those that look like them."""

_SOFT: tuple[RoomKind, ...] = ("bedroom", "living", "study", "dining")
"""Rooms where a floor of a colour that no wood has is a carpet."""


def look_wanted(coat: Coat, part: Part, kind: RoomKind) -> Wanted | None:
    """The look that a coat asks for in a room of a kind; None where there is none."""
    material, wood = coat.material, _wood(coat)
    named = any(coat.material in name for name in WOODS) or coat.material in _LIKE
    if named and material:
        material = "wood"
    elif part == "floor" and not material:
        near = wood and colour_distance(_of_wood(wood), coat.rgb or (0, 0, 0)) <= ALIKE
        material = "wood" if near else "carpet" if kind in _SOFT else ""
    family = _family(_FAMILIES[part].get(material, material))
    if family is None or family.surface not in (part, "both"):
        return None
    return Wanted(family.name, _settings(family, coat, wood))


def _family(name: str) -> Family | None:
    from chord_usd.base.scene.look_families import load_families

    return family_named(name) if name in load_families() else None


def _settings(family: Family, coat: Coat, wood: str) -> dict[str, float | str]:
    """Parameters that say the colour."""
    if "wood" in family.parameters:
        return {"wood": wood} if wood else {}
    if coat.rgb is None:
        return {}
    colour = "#{:02x}{:02x}{:02x}".format(*coat.rgb)
    if family.name == "marble":
        rgb = coat.rgb
        return {"kind": min(MARBLES, key=lambda name: colour_distance(MARBLES[name][0], rgb))}
    if family.name == "brick" and min(coat.rgb) > 120:
        return {"painted": 1.0, "paint": colour}
    name = next((key for key in ("colour", "ground_colour") if key in family.parameters), "")
    return {name: colour} if name else {}


def _wood(coat: Coat) -> str:
    """The wood that a coat names, or the one whose colour is most like it; "" for neither."""
    said = _LIKE.get(coat.material, coat.material)
    able = [name for name in WOODS if said in name.split("_") or said == name] or list(WOODS)
    if coat.rgb is None:
        return said if said in WOODS else ""
    rgb = coat.rgb
    return min(able, key=lambda name: colour_distance(_of_wood(name), rgb))


def _of_wood(name: str) -> Rgb:
    late, early = WOODS[name]
    red, green, blue = ((dark + pale) // 2 for dark, pale in zip(late, early, strict=True))
    return red, green, blue
