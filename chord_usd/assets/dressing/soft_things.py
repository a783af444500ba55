"""All that is made of cloth, and what it hangs from."""

from __future__ import annotations

from chord_usd.assets.dressing import curtain_rails, curtains, rugs
from chord_usd.assets.model import Design

DESIGNS: tuple[Design, ...] = tuple(
    design for module in (curtains, curtain_rails, rugs) for design in module.DESIGNS
)
