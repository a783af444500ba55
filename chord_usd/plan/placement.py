"""Where the picture lies that a plan was read from: kept in the plan, and so in its JSON."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from chord_usd.types import PixelFrame, Plan

DRAWING = "drawing"
"""Key of Plan.extra."""

PAGE = "page"
"""Key of Plan.extra: the page of a PDF that was read, from 1."""

WARNINGS = "warnings"
"""Key of Plan.extra: sentences about what a user should know of the plan."""


def placement(frame: PixelFrame) -> Mapping[str, Any]:
    """The entry for Plan.extra that remembers a picture's frame."""
    return {
        DRAWING: {
            "mPerPx": frame.m_per_px,
            "originM": list(frame.origin_m),
            "heightPx": frame.height_px,
        }
    }


UPRIGHT = "upright"
"""Key beside the frame of a drawing: how its picture was turned before it was read."""


def skew_of(plan: Plan) -> float:
    """Degrees clockwise that were taken out of the picture before it was read."""
    return float(plan.extra.get(DRAWING, {}).get(UPRIGHT, {}).get("skewDeg", 0.0))


def frame_of(plan: Plan) -> PixelFrame | None:
    """The frame of the picture the plan was read from; None if it was read from none."""
    try:
        kept = plan.extra[DRAWING]
        x_m, y_m = kept["originM"]
        return PixelFrame(float(kept["mPerPx"]), (float(x_m), float(y_m)), int(kept["heightPx"]))
    except (KeyError, TypeError, ValueError):
        return None
