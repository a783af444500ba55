"""A house as training sees it: from any side."""

from __future__ import annotations

import numpy as np

from chord_usd.base.scene.pose import House, Pose, posed

SKEW_CHANCE = 0.1
"""Share of houses that random_pose turns by any angle; most plans are drawn axis-aligned."""


def random_pose(house: House, rng: np.random.Generator) -> House:
    """One of the eight symmetries of the square; with SKEW_CHANCE any angle instead."""
    mirrored = bool(rng.integers(2))
    quarter_deg = 90.0 * int(rng.integers(4))
    skew_deg = float(rng.uniform(-45.0, 45.0)) if rng.random() < SKEW_CHANCE else 0.0
    return posed(house, Pose(mirrored, 1.0, quarter_deg + skew_deg))
