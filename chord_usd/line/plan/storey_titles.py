"""Which storey a plan of a sheet is: by the titles that are printed beside it."""

from __future__ import annotations

import re
from collections.abc import Sequence

import numpy as np

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.plan.text import Text

_FLOOR = (
    r"(?:floor|fl\.?|level|storey|story|etage|étage|piano|planta|kondygnacja|piętro|verdieping)"
)

_RANKS: tuple[tuple[str, float], ...] = (
    (r"lower\s*ground|basement|cellar|keller|sous[- ]?sol|s[oó]tano|kelder|kellari", -1.0),
    (rf"ground\s*{_FLOOR}|erdgeschoss?|\bEG\b|rez[- ]?de[- ]?chauss|planta\s*baja|begane\s*grond"
     r"|parter|piano\s*terra|bottenvåning|entr[eé]plan|1\.?\s*krs", 0.0),
    (rf"(?:first|1st)\s*{_FLOOR}|1\.?\s*(?:obergeschoss?|OG\b|étage|etage|krs)|premier\s*étage"
     r"|primer\s*piso|planta\s*primera|primo\s*piano|eerste\s*verdieping|övervåning|upper\s*floor"
     r"|obergeschoss?", 1.0),
    (rf"(?:second|2nd)\s*{_FLOOR}|2\.?\s*(?:obergeschoss?|OG\b|étage|etage|krs)|deuxi[eè]me\s*étage"
     r"|secondo\s*piano|tweede\s*verdieping", 2.0),
    (rf"(?:third|3rd)\s*{_FLOOR}|3\.?\s*(?:obergeschoss?|OG\b|étage|etage)", 3.0),
    (r"attic|loft|dachgeschoss?|\bDG\b|combles|zolder|poddasze|vind\b|mansard", 9.0),
)  # fmt: skip

_FARTHEST = 0.5
"""Of a plan's larger side: a title no farther away is its own."""


def storey_rank(text: str) -> float | None:
    """The storey that a printed line names, 0 for the ground floor; None for any other line."""
    for pattern, rank in _RANKS:
        if re.search(pattern, text, re.IGNORECASE):
            return rank
    return None


def titled(
    bounds_px: Sequence[FloatArray], texts: Sequence[Text]
) -> list[tuple[float, str] | None]:
    """For each plan of a sheet, the rank and the words of the title nearest to it.

    bounds_px: (2, 2) lowest and highest corner of each. A title goes to one plan.
    """
    titles: list[tuple[float, float, str] | None] = [None] * len(bounds_px)
    for text in texts:
        rank = storey_rank(text.text)
        if rank is None:
            continue
        middle = np.asarray(text.corners_px).mean(axis=0)
        gaps = [float(np.hypot(*np.maximum(np.maximum(low - middle, middle - high), 0.0)))
                for low, high in bounds_px]  # fmt: skip
        nearest = int(np.argmin(gaps))
        low, high = bounds_px[nearest]
        held = titles[nearest]
        near = gaps[nearest] <= _FARTHEST * float((high - low).max())
        if near and (held is None or gaps[nearest] < held[0]):
            titles[nearest] = (gaps[nearest], rank, text.text.strip())
    return [None if title is None else title[1:] for title in titles]
