"""What a house will take, by what it holds: processor time and memory, said before the work.

The figures are what was measured on houses of 7 to 500 rooms, rounded up.
"""

from __future__ import annotations

import os
from dataclasses import dataclass

from chord_usd.base.errors import ChordError
from chord_usd.base.scene.types import Plan, PlanImage, SceneGraph

WORTH_SAYING_S = 60.0


@dataclass(frozen=True)
class Estimate:
    """Of some work."""

    seconds: float
    """Of processor time."""
    memory_bytes: float

    def __add__(self, other: Estimate) -> Estimate:
        """Of one after the other."""
        most = max(self.memory_bytes, other.memory_bytes)
        return Estimate(self.seconds + other.seconds, most)

    def said(self) -> str:
        """For a user; empty for what takes less than WORTH_SAYING_S."""
        if self.seconds < WORTH_SAYING_S:
            return ""
        minutes, gb = self.seconds / 60, self.memory_bytes / 1e9
        return f"estimate: {minutes:.0f} min of processor time, {gb:.1f} GB of memory"

    def require_memory(self, where: str) -> None:
        """Raises ChordError where this machine has less."""
        there = _memory_bytes()
        if there is not None and self.memory_bytes > there:
            raise ChordError(
                f"needs about {self.memory_bytes / 1e9:.1f} GB of memory",
                where=where,
                expected=f"at most the {there / 1e9:.1f} GB of this machine",
                try_="a part of the house at a time",
            )


def of_stage(graph: SceneGraph) -> Estimate:
    """Of writing a scene as a stage, and checking it."""
    rooms = len(graph.rooms)
    pieces = (
        len(graph.items) + len(graph.dressing) + sum(len(item.children) for item in graph.items)
    )
    return Estimate(6.0 + 0.08 * rooms + 0.012 * pieces, 3e8 + 1.2e6 * rooms + 4.5e5 * pieces)


def of_furnishing(plan: Plan, raster: PlanImage) -> Estimate:
    """Of furnishing a plan, which is sampled on a raster."""
    rooms, pixels = len(plan.rooms), raster.frame.height_px**2
    return Estimate(6.0 + rooms + 5e-5 * pixels, 5e8 + 1e7 * rooms + 400.0 * pixels)


def _memory_bytes() -> float | None:
    """Of this machine; None where the system does not say."""
    try:
        return float(os.sysconf("SC_PHYS_PAGES")) * os.sysconf("SC_PAGE_SIZE")
    except (OSError, ValueError, AttributeError):
        return None
