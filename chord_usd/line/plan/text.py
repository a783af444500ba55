"""What is printed on a drawing, by OCR. The models travel inside the rapidocr wheel."""

from __future__ import annotations

import os
from dataclasses import dataclass
from functools import cache
from typing import Any

import cv2
import numpy as np

from chord_usd.base.runtime.networks import import_onnxruntime
from chord_usd.base.scene.types import ByteArray, FloatArray

_LARGEST_SIDE_PX = 1800
_SMALLEST_SIDE_PX = 1200
"""Letters of a smaller picture are too small for the detector; it is enlarged."""

_DETECTOR_SIDE_PX = 1440
"""Lines are found in a smaller copy, which takes 0.6 in place of 0.9 GiB, and read in the larger:
of 92 lines on a sheet of four plans 5 are lost, of 140 on ten single plans none."""

_LEAST_SCORE = 0.6

_LONGEST_STRIP = 5
"""So many times as long as wide are pictures at most when they reach the engine."""


@dataclass(frozen=True, eq=False)
class Text:
    """A line of text in a picture."""

    text: str
    corners_px: FloatArray
    """(4, 2) continuous pixels, from the beginning of the line clockwise, as one reads it."""
    score: float
    """Of the recogniser, [0, 1]."""

    @property
    def center_px(self) -> FloatArray:
        return self.corners_px.mean(axis=0)

    @property
    def height_px(self) -> float:
        """Of the letters."""
        return float(min(self._sides))

    @property
    def is_upright(self) -> bool:
        """Whether the line runs up or down the picture."""
        low, high = self.corners_px.min(axis=0), self.corners_px.max(axis=0)
        return bool(high[1] - low[1] > 1.5 * (high[0] - low[0]))

    @property
    def _sides(self) -> FloatArray:
        edges = np.roll(self.corners_px, -1, axis=0)[:2] - self.corners_px[:2]
        return np.hypot(edges[:, 0], edges[:, 1])


def read_texts(rgb: ByteArray) -> tuple[Text, ...]:
    """The lines of text in a picture, RGB (H, W, 3); lines that are hardly legible are left out."""
    side = max(rgb.shape[:2])
    scale = np.clip(1.0, _SMALLEST_SIDE_PX / side, _LARGEST_SIDE_PX / side)
    how = cv2.INTER_AREA if scale < 1.0 else cv2.INTER_CUBIC
    height, width = (max(1, round(length * scale)) for length in rgb.shape[:2])
    sized = rgb if scale == 1.0 else cv2.resize(rgb, (width, height), interpolation=how)
    # The engine takes BGR, as OpenCV does; without its classifier lines that run up are read
    # upside down.
    broad = _broadened(np.asarray(sized, np.uint8))
    result = _engine()(np.ascontiguousarray(broad[:, :, ::-1]), use_cls=True)
    if result.txts is None:
        return ()
    return tuple(
        Text(str(text), np.asarray(corners, np.float64) / scale, float(score))
        for text, corners, score in zip(result.txts, result.boxes, result.scores, strict=True)
        if score >= _LEAST_SCORE
    )


def _broadened(rgb: ByteArray) -> ByteArray:
    """A long strip with paper at its right or lower side; others as they are.

    The engine scales pictures until their shorter side is 30 px: a strip of 1800 x 1 would come
    out 54,000 px long and take 2.4 GB.
    """
    height, width = rgb.shape[:2]
    least = -(-max(height, width) // _LONGEST_STRIP)
    if min(height, width) >= least:
        return rgb
    below, beside = max(least - height, 0), max(least - width, 0)
    white = (255, 255, 255)
    padded = cv2.copyMakeBorder(rgb, 0, below, 0, beside, cv2.BORDER_CONSTANT, value=white)
    return np.asarray(padded, np.uint8)


def warm_up() -> None:
    """Load the engine, so that the first picture need not wait for it."""
    _engine()


def let_go() -> None:
    """Free the 300 MB that are kept for reading further pictures."""
    _engine.cache_clear()


@cache
def _engine() -> Any:
    """The OCR engine; loading takes about a second, so that it waits for a picture to read."""
    import_onnxruntime()
    from rapidocr import RapidOCR

    # Threads without a core of their own wait for one another, busily.
    threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else 1
    engine = "EngineConfig.onnxruntime"
    return RapidOCR(
        params={
            "Global.log_level": "critical",
            "Det.limit_type": "max",
            "Det.limit_side_len": _DETECTOR_SIDE_PX,
            f"{engine}.intra_op_num_threads": min(threads, 4),
            f"{engine}.inter_op_num_threads": 1,
            # Without one every layer of a large picture asks the system for fresh memory.
            f"{engine}.enable_cpu_mem_arena": True,
        }
    )
