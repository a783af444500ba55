"""Families of looks: what can be chosen about planks, tiles, plaster and the like.

A family is a folder of materials/ with family.json: what its parameters are, between which values,
and which drawing makes it (assets.look_library). A user's own may narrow the ranges of a drawing.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path
from typing import Any

from chord_usd.base.errors import AssetError
from chord_usd.base.runtime.locations import materials_folder
from chord_usd.base.scene.looks import SURFACES, Surface

FAMILY_FILE = "family.json"

Setting = float | str
"""Value of a parameter: a number, a word, or a colour as #rrggbb."""

_COLOUR = re.compile(r"#[0-9a-f]{6}")
_DECIMALS = 5


@dataclass(frozen=True)
class Parameter:
    """One thing that can be chosen about a look: a number of a range, a word, or a colour."""

    name: str
    default: Setting
    about: str
    """For people, with the unit."""
    range: tuple[float, float] | None = None
    choices: tuple[str, ...] = ()

    def expected(self) -> str:
        """What it may be, for people."""
        if self.range:
            return f"{self.range[0]:g} to {self.range[1]:g}"
        return f"one of {', '.join(self.choices)}" if self.choices else "a colour such as #c8b49a"

    def checked(self, value: object) -> Setting:
        """The value as it is used: numbers rounded. Raises ValueError."""
        if self.range:
            number = float(value)  # type: ignore[arg-type]
            if not (math.isfinite(number) and self.range[0] <= number <= self.range[1]):
                raise ValueError
            return round(number, _DECIMALS)
        word = str(value).lower()
        if word not in self.choices if self.choices else not _COLOUR.fullmatch(word):
            raise ValueError
        return word


@dataclass(frozen=True)
class Family:
    """Looks that differ in parameters only."""

    name: str
    label: str
    """For people."""
    surface: Surface
    drawing: str
    """Name of the function that draws it."""
    parameters: Mapping[str, Parameter]

    def settings(self, given: Mapping[str, object], where: str = "") -> dict[str, Setting]:
        """All parameters, those that are not given as usual.

        Raises AssetError that names the family, the parameter and what it may be.
        """
        for name in given:
            if name not in self.parameters:
                near = get_close_matches(name[:40], self.parameters, n=1)
                raise AssetError(
                    f"{self.name} has no parameter '{name[:40]}'",
                    where=where,
                    expected=f"one of {', '.join(self.parameters)}",
                    try_=near[0] if near else "",
                )
        chosen = {}
        for name, parameter in self.parameters.items():
            value = given.get(name, parameter.default)
            try:
                chosen[name] = parameter.checked(value)
            except (TypeError, ValueError):
                raise AssetError(
                    f"{name} of {self.name} is {str(value)[:40]!r}",
                    where=where,
                    expected=parameter.expected(),
                    try_=f"<looks show={self.name}>",
                ) from None
        return chosen


def load_families(folder: Path | None = None) -> dict[str, Family]:
    """Families by name; by default those that ship, and a user's beside them.

    Raises AssetError for a folder without families and for a damaged family.json.
    """
    return _load(materials_folder() if folder is None else folder)


@lru_cache(maxsize=8)
def _load(folder: Path) -> dict[str, Family]:
    families = [_read(file) for file in sorted(folder.glob(f"*/{FAMILY_FILE}"))]
    if not families:
        raise AssetError(
            "there are no families of looks here",
            where=str(folder),
            expected=f"folders that each hold a {FAMILY_FILE}",
            try_="the materials folder of the package",
        )
    return {family.name: family for family in families}


def family_named(name: str, families: Mapping[str, Family] | None = None) -> Family:
    """The family of this name. Raises AssetError that suggests the nearest."""
    families = load_families() if families is None else families
    if name not in families:
        near = get_close_matches(name[:40], families, n=1)
        raise AssetError(
            f"there is no family of looks '{name[:40]}'",
            expected=f"one of {', '.join(families)}",
            try_=near[0] if near else "<looks list>",
        )
    return families[name]


def _read(file: Path) -> Family:
    try:
        return _family(json.loads(file.read_text(encoding="utf-8")), file)
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        raise AssetError(
            f"the family of looks cannot be read ({error})",
            where=str(file),
            expected='{"name", "label", "surface", "drawing", "parameters": {NAME: {"range" or '
            '"choices" or "colour", "default", "about"}}}',
        ) from None


def _family(data: Mapping[str, Any], file: Path) -> Family:
    if data["name"] != file.parent.name:
        raise ValueError(f"its name is {data['name']!r}, its folder's {file.parent.name!r}")
    if data["surface"] not in SURFACES:
        raise ValueError(f"surface is {data['surface']!r}, not one of {', '.join(SURFACES)}")
    parameters = {name: _parameter(name, entry) for name, entry in data["parameters"].items()}
    return Family(data["name"], data["label"], data["surface"], data["drawing"], parameters)


def _parameter(name: str, entry: Mapping[str, Any]) -> Parameter:
    span = entry.get("range")
    if span is not None:
        low, high = (float(value) for value in span)
        if not low <= high:
            raise ValueError(f"the range of {name} is {span}")
        span = (low, high)
    choices = tuple(str(word) for word in entry.get("choices", ()))
    parameter = Parameter(name, entry["default"], str(entry.get("about", "")), span, choices)
    try:
        parameter.checked(parameter.default)
    except (TypeError, ValueError):
        raise ValueError(f"the default of {name} is {entry['default']!r}") from None
    return parameter
