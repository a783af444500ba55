"""All that is made of cloth, and what it hangs from."""

from __future__ import annotations

from chord_usd.assets.dressing import (
    blinds,
    curtain_rails,
    curtains,
    rugs,
)
from chord_usd.assets.model import Design

DESIGNS: tuple[Design, ...] = tuple(
    design for module in (curtains, curtain_rails, blinds, rugs) for design in module.DESIGNS
)
