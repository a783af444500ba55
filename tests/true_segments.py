"""A reader that cannot err: it is told what is built on a page."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from chord_usd.base.raster.page_labels import BUILT_NAMES, KIND_NAMES, built_of
from chord_usd.base.scene.types import ByteArray
from chord_usd.line.plan.segment import Segments
from chord_usd.workshop.data.drawn.truth import CrowdedPage


@dataclass(frozen=True, eq=False)
class TrueReader:
    """Sees upright pages, scaled as they are read."""

    page: CrowdedPage

    def read(self, rgb: ByteArray) -> Segments:
        """The truth, as sure as can be."""
        size = rgb.shape[1], rgb.shape[0]
        labels = cv2.resize(self.page.labels, size, interpolation=cv2.INTER_NEAREST)
        share = rgb.shape[0] / self.page.labels.shape[0]
        to_seen = np.diag([share, share, 1.0]) @ self.page.to_picture
        kinds = np.full((len(KIND_NAMES), *rgb.shape[:2]), 1.0 / len(KIND_NAMES), np.float32)
        for room in (room for storey in self.page.storeys for room in storey.plan.rooms):
            seen = np.column_stack([room.polygon_m, np.ones(len(room.polygon_m))]) @ to_seen.T
            mask = np.zeros(rgb.shape[:2], np.uint8)
            cv2.fillPoly(mask, [np.rint(seen[:, :2] / seen[:, 2:] - 0.5).astype(np.int32)], (1.0,))
            kinds[:, mask > 0] = 0.0
            kinds[KIND_NAMES.index(room.kind), mask > 0] = 1.0
        return segments_of(np.asarray(labels, np.uint8), kinds)


def segments_of(labels: ByteArray, kinds: np.ndarray | None = None) -> Segments:
    """(H, W) labels of a page as a network would say them that has no doubt."""
    built = built_of(labels)
    shape = labels.shape
    return Segments(
        np.stack([built == kind for kind in range(len(BUILT_NAMES))]).astype(np.float32),
        np.full((len(KIND_NAMES), *shape), 1 / 9, np.float32) if kinds is None else kinds,
    )
