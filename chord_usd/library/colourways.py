"""Variants of components, and the colourway of a component that is most like a coat."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from chord_usd.base.runtime.stages import open_layer
from chord_usd.base.scene.colour_space import ALIKE, Rgb, colour_distance, lightness
from chord_usd.base.scene.intents import Coat
from chord_usd.base.scene.style_finishes import Kind, kind_of
from chord_usd.library.component import COLOUR_VARIANT_SET
from chord_usd.library.surfaces.finishes import finish_named

_KINDS: dict[str, Kind] = {"wood": "wood", "metal": "metal", "stone": "stone", "cloth": "textile"}
"""Materials that are a kind of finishes."""

_LEAST_STEP = 0.08
"""So much darker is darker."""


@dataclass(frozen=True)
class Offer:
    """Variants of a component."""

    variants: dict[str, list[str]]
    """Names of variants by variant set."""
    finishes: dict[str, list[str]]
    """Names of the finishes of each colourway, a slot each."""


@lru_cache(maxsize=256)
def offer_of(path: Path) -> Offer:
    """What the component of an interface layer offers; nothing where it is not there."""
    layer = open_layer(path) if path.is_file() else None
    root = layer.GetPrimAtPath(f"/{layer.defaultPrim}") if layer else None
    sets = root.variantSets if root else {}
    noted = root.customData.get("chord", {}) if root else {}
    return Offer(
        {name: [*entry.variants.keys()] for name, entry in sets.items()},
        {name: text.split() for name, text in noted.get("finishes", {}).items()},
    )


def colourway_like(path: Path, coat: Coat, now: str = "") -> str:
    """The colourway of a component that is most like a coat; "" where none is like it.

    now: its present colourway, with which darker and lighter ones are compared.
    """
    offer = offer_of(path)
    shown = {name: _shown(offer.finishes.get(name, [name]))
             for name in offer.variants.get(COLOUR_VARIANT_SET, ())}  # fmt: skip
    if coat.material in ("darker", "lighter"):
        return _toned(shown, now, 1.0 if coat.material == "lighter" else -1.0)
    fit, most = {}, 3.0 * ALIKE if coat.material else ALIKE
    for name, finish in shown.items():
        rgb = _rgb(finish) or _rgb(name)
        if coat.material and not _is_of(finish, coat.material):
            continue
        if coat.rgb is None:
            fit[name] = 0.0
        elif rgb and (away := colour_distance(coat.rgb, rgb)) <= most:
            fit[name] = away
    return min(fit, key=fit.__getitem__, default="")


def _toned(shown: dict[str, str], now: str, sign: float) -> str:
    """The nearest colourway that is lighter (sign 1) or darker (-1) than another."""
    rgb = {name: colour for name, finish in shown.items() if (colour := _rgb(finish))}
    if now not in rgb:
        return ""
    able = [name for name, colour in rgb.items()
            if sign * (lightness(colour) - lightness(rgb[now])) > _LEAST_STEP]  # fmt: skip
    return min(able, key=lambda name: colour_distance(rgb[name], rgb[now]), default="")


def _shown(finishes: list[str]) -> str:
    """The finish of most slots, of several the last, and metals only where nothing else is."""
    solid = [finish for finish in finishes if kind_of(finish) != "metal"] or finishes
    counts = Counter(solid)
    return max(reversed(solid), key=counts.__getitem__)


def _is_of(finish: str, material: str) -> bool:
    return kind_of(finish) == _KINDS.get(material, "") or material in finish.split("_")


def _rgb(finish: str) -> Rgb | None:
    """The colour of a finish; of one that is not listed, of the first word that is."""
    names = [finish, *finish.split("_"), f"{finish.split('_')[0]}_cloth"]
    return next((row.rgb for name in names if (row := finish_named(name))), None)
