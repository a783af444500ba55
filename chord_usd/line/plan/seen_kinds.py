"""What a drawing shows that its floors are for, spot by spot."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
import numpy.typing as npt
from shapely.geometry import Polygon

from chord_usd.base.raster.page_labels import KIND_NAMES
from chord_usd.base.scene.types import BoolArray, PixelFrame, RoomKind
from chord_usd.base.scene.units import px_from_m

_STEP_M = 0.1
"""Between the spots that are looked at."""
_LEAST_CHANCE = 0.02
_LIKELIER = 0.5

_Map = npt.NDArray[np.float32]


@dataclass(frozen=True, eq=False)
class SeenKinds:
    """Chances of kinds on a plan."""

    chances: _Map
    """(K, H, W) of KIND_NAMES."""
    frame: PixelFrame
    """Of the drawing."""
    step_px: int
    """Pixels of the drawing for one of those that the chances are for."""

    def log_chances(self, floor: Polygon) -> dict[RoomKind, float]:
        """The logarithms of the chances of each kind, over all of a floor: nats times m2."""
        return self._sums(floor, self._logarithms)

    def areas_m2(self, floor: Polygon) -> dict[RoomKind, float]:
        """How much of a floor is likelier of each kind than not."""
        return self._sums(floor, self.chances > _LIKELIER)

    @cached_property
    def _logarithms(self) -> _Map:
        return np.log(np.maximum(self.chances, _LEAST_CHANCE))

    def _sums(self, floor: Polygon, values: _Map | BoolArray) -> dict[RoomKind, float]:
        corners = px_from_m(np.asarray(floor.exterior.coords), self.frame) / self.step_px
        low = np.maximum(np.floor(corners.min(axis=0)).astype(int), 0)
        high = np.ceil(corners.max(axis=0)).astype(int) + 1
        part = values[:, low[1] : high[1], low[0] : high[0]]
        mask = np.zeros(part.shape[1:], np.uint8)
        if not mask.size:
            return dict.fromkeys(KIND_NAMES, 0.0)
        cv2.fillPoly(mask, [np.rint(corners - 0.5 - low).astype(np.int32)], (1,))
        sums = part[:, mask > 0].sum(axis=1) * (self.step_px * self.frame.m_per_px) ** 2
        return {kind: float(value) for kind, value in zip(KIND_NAMES, sums, strict=True)}


def seen_kinds(chances: _Map, frame: PixelFrame) -> SeenKinds:
    """Of the chances, (K, H, W), for the pixels of a frame."""
    step = max(1, round(_STEP_M / frame.m_per_px))
    return SeenKinds(chances[:, step // 2 :: step, step // 2 :: step], frame, step)
