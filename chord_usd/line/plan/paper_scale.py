"""Scales of drawings on paper: printed ("1:100"), or the usual one that the drawing is close to."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

M_PER_POINT = 0.0254 / 72.0
_STATED = re.compile(r"\b1\s*[:：]\s*(20|25|33|40|50|75|100|125|150|200|250|300|400|500)\b")

_USUAL = (20, 50, 100, 200, 500)
"""Of floor plans, by ISO 5455; each at least twice the one before."""

_NEAR = math.log(1.25)
"""Doors and walls are off by so much: closer to a usual scale, a drawing has that scale."""


def stated_ratio(texts: Iterable[str]) -> int | None:
    """The n of the first "1:n" that is printed."""
    return next((int(match[1]) for text in texts if (match := _STATED.search(text))), None)


def usual_scale(m_per_unit: float, paper_m_per_unit: float) -> float | None:
    """Metres per unit at the usual scale that a drawing's scale is close to; None for none.

    m_per_unit: by what is drawn; paper_m_per_unit: of the sheet.
    """
    scales = [n * paper_m_per_unit for n in _USUAL]
    nearest = min(scales, key=lambda scale: abs(math.log(scale / m_per_unit)))
    return nearest if abs(math.log(nearest / m_per_unit)) < _NEAR else None
