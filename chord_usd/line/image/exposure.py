"""How bright a picture is to be: what a meter reads, and what a photographer makes of it."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

KEY = 0.36
KEY_BY_LAMPS = 0.2
KEY_FROM_ABOVE = 0.24
"""Log-average luminance of a finished picture. Above a grey card's 0.18: rooms are mostly pale.
From above one sees their floors instead, which are darker; by lamplight corners stay dark."""

PALE_ALBEDO = 0.5
"""Log-average albedo of a view of a room with white walls, for which the keys are."""

DARKENS = 0.6
"""How far a picture follows the tone of what it shows: 0 not at all, 1 as an incident meter."""

_TONES = (0.4, 1.35)

EXPOSURE_RANGE_EV = (-12.0, 12.0)


def tone(albedo: npt.ArrayLike) -> float:
    """How bright a picture of these things is, next to one of a pale room.

    A meter that sees light only would show every room in one tone: concrete as white plaster.
    """
    seen = np.clip(np.asarray(albedo), 0.02, 1.0)
    if not seen.size:
        return 1.0
    mean = float(np.exp2(np.log2(seen).mean()))
    return float(np.clip((mean / PALE_ALBEDO) ** DARKENS, *_TONES))


def exposure_ev(luminance: npt.ArrayLike, key: float) -> float:
    """Stops from scene-linear luminances to a log-average of key.

    The darkest tenth is left out: what no light reaches should stay dark. 0.0 for a black scene.
    """
    lit = np.sort(np.asarray(luminance).ravel())
    lit = lit[len(lit) // 10 :]
    lit = lit[lit > 1e-6]
    if not len(lit):
        return 0.0
    log_average = float(np.exp2(np.log2(lit).mean()))
    return float(np.clip(math.log2(key / log_average), *EXPOSURE_RANGE_EV))
