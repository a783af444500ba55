"""All that is made of cloth, and what it hangs from."""

from __future__ import annotations

from chord_usd.library.dressing import (
    blinds,
    curtain_rails,
    curtains,
    cushions,
    rugs,
    towels,
)
from chord_usd.library.kit.model import Design

_MODULES = (curtains, curtain_rails, blinds, rugs, cushions, towels)

DESIGNS: tuple[Design, ...] = tuple(design for module in _MODULES for design in module.DESIGNS)
