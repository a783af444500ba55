"""Where the picture lies that a plan was read from: kept in the plan, and so in its JSON."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from chord_usd.base.scene.types import PixelFrame, Plan

DRAWING = "drawing"
"""Key of Plan.extra."""

PAGE = "page"
"""Key of Plan.extra: the page of a PDF that was read, from 1."""

WARNINGS = "warnings"
"""Key of Plan.extra: sentences about what a user should know of the plan."""

CHECK_SCALE = "check the scale"
"""Ends warnings about the scale."""


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
"""Key beside the frame of a drawing: how its picture was straightened before it was read."""


@dataclass(frozen=True)
class Straightening:
    """What was done to a user's picture before it was read."""

    skew_deg: float = 0.0
    """Clockwise turn that was taken out, after the slant."""
    corners_px: tuple[tuple[float, float], ...] = ()
    """Of a sheet seen at a slant, clockwise from its upper left; none for a picture without one."""
    size_px: tuple[int, int] = (0, 0)
    """Width and height of that sheet, seen from above."""

    def entry(self) -> Mapping[str, Any]:
        """For the plan's JSON; empty where nothing was done."""
        said: dict[str, Any] = {"skewDeg": self.skew_deg} if self.skew_deg else {}
        if self.corners_px:
            corners = [[round(x, 2), round(y, 2)] for x, y in self.corners_px]
            said |= {"sheetPx": corners, "sizePx": list(self.size_px)}
        return {UPRIGHT: said} if said else {}


def straightening_of(plan: Plan) -> Straightening:
    """How the picture was straightened that a plan was read from."""
    try:
        said = plan.extra.get(DRAWING, {}).get(UPRIGHT, {})
        corners = tuple((float(x), float(y)) for x, y in said.get("sheetPx", ()))
        width, height = said.get("sizePx", (0, 0))
        return Straightening(float(said.get("skewDeg", 0.0)), corners, (int(width), int(height)))
    except (AttributeError, TypeError, ValueError):
        return Straightening()


def frame_of(plan: Plan) -> PixelFrame | None:
    """The frame of the picture the plan was read from; None if it was read from none."""
    try:
        kept = plan.extra[DRAWING]
        x_m, y_m = kept["originM"]
        return PixelFrame(float(kept["mPerPx"]), (float(x_m), float(y_m)), int(kept["heightPx"]))
    except (KeyError, TypeError, ValueError):
        return None
