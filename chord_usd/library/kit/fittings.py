"""Taps, handles, rails: the parts whose metal a home agrees on, whatever the colourway of the
piece."""

from __future__ import annotations

from collections.abc import Iterable

from chord_usd.base.scene.style_finishes import kind_of
from chord_usd.library.kit.model import Design

METAL_VARIANT_SET = "metal"

USUAL = "usual"
"""The variant that leaves fittings as the colourway has them."""

METALS = ("chrome", "brass", "black_metal")
"""Finishes that fittings come in; variants are named after them."""

_SLOTS = ("handle", "tap", "metal")


def fitting_slots(design: Design, used: Iterable[str]) -> tuple[str, ...]:
    """Slots in use that are fittings: metal in every colourway. Empty where none of them comes in
    two metals, since such a piece (a steel frame, an oven) is what it is."""
    ways = design.colourways.values()
    worn = {slot: {looks.get(slot, "") for looks in ways} for slot in used if slot in _SLOTS}
    slots = [slot for slot, names in worn.items() if all(kind_of(n) == "metal" for n in names)]
    return tuple(slots) if any(len(worn[slot]) > 1 for slot in slots) else ()
