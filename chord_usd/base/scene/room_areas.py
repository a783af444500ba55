"""How large rooms of a kind usually are: they scale a drawing without measures, and
distinguish a bedroom from a cupboard."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

import numpy as np

from chord_usd.base.scene.types import RoomKind

_USUAL_M2: dict[RoomKind, tuple[float, float]] = {
    "living": (18.0, 0.4), "dining": (10.0, 0.35), "bedroom": (11.5, 0.3), "kitchen": (7.5, 0.4),
    "bathroom": (3.5, 0.5), "balcony": (5.0, 0.6), "corridor": (4.5, 0.65), "study": (9.0, 0.35),
    "store": (2.0, 0.6), "washroom": (3.0, 0.6), "wc": (1.8, 0.5),
}  # fmt: skip
"""Median, and standard deviation of the logarithm. Between the 852 Japanese flats of data.flats
(bedrooms 12.4 and 0.26, baths and WCs apart 2.4 and 0.46) and estate agents' plans with printed
sizes."""

_HOMES = 0.15
"""By how much the logarithm of all lengths of a home differs from the usual."""


_USUAL = 2.0
"""Standard deviations within which nothing speaks against a kind."""


def plausibility(kind: RoomKind, area_m2: float) -> float:
    """From 0 to 1: 1 where a room of this kind may well be so large, 0 where none ever is."""
    if kind not in _USUAL_M2:
        return 1.0
    median, spread = _USUAL_M2[kind]
    off = abs(math.log(max(area_m2, 1e-3) / median)) / spread
    return math.exp(-0.5 * max(0.0, off - _USUAL) ** 2)


def fit_of_area(kinds: Collection[RoomKind], area_m2: float) -> float:
    """How likely rooms of these kinds are to be so large together, in nats below their usual size;
    at most 0."""
    usual = np.array([_USUAL_M2[kind] for kind in kinds])
    median = float(usual[:, 0].sum())
    spread = float(np.hypot.reduce(usual[:, 0] * usual[:, 1])) / median
    return -0.5 * (math.log(max(area_m2, 1e-3) / median) / spread) ** 2


_HOME_M2, _HOME_SPREAD = 75.0, 0.3
"""Of most homes, 40 to 140 m2: the spread of the logarithm of their sides."""


def scale_by_rooms(
    kinds: Sequence[RoomKind], areas_px2: Sequence[float]
) -> tuple[float, float] | None:
    """Metres per pixel at which rooms are as large as usual, and the standard deviation of its
    logarithm; None where no kind is known."""
    known = [(_USUAL_M2[kind], area) for kind, area in zip(kinds, areas_px2, strict=True)
             if kind in _USUAL_M2 and area > 0]  # fmt: skip
    if not known:
        return None
    logs = np.array([0.5 * math.log(median / area) for (median, _), area in known])
    weights = np.array([(2.0 / spread) ** 2 for (_, spread), _ in known])
    middle = float(np.average(logs, weights=weights))
    return math.exp(middle), math.sqrt(_HOMES**2 + 1.0 / float(weights.sum()))


def scale_by_home(areas_px2: Sequence[float]) -> tuple[float, float] | None:
    """Metres per pixel at which all floors together are as large as a usual home, and the standard
    deviation of its logarithm; None without floor."""
    area_px2 = sum(areas_px2)
    return (math.sqrt(_HOME_M2 / area_px2), _HOME_SPREAD) if area_px2 > 0 else None
