"""How designs of kitchen and bath things are put together."""

from __future__ import annotations

from collections.abc import Mapping

from chord_usd.library.kit.model import Design, Draw
from chord_usd.library.kit.solids import Size
from chord_usd.library.surfaces.kitchen_finishes import FINISHES


def design(
    name: str, category: str, size_m: Size, draw: Draw, looks: Mapping[str, Mapping[str, str]],
    styles: tuple[str, ...] = (),
) -> Design:  # fmt: skip
    """A design that wears the finishes of kitchens and baths."""
    return Design(name, category, size_m, draw, looks, FINISHES, styles)


def sized(name: str, size_m: Size) -> str:
    """The id of a design that comes in several lengths: its name and its length in centimetres."""
    return f"{name}_{100 * size_m[0]:.0f}"
