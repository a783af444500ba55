"""Where the reader looks on a page."""

from __future__ import annotations

import numpy as np
import pytest

from chord_usd.line.plan.segment import _unseen_plans

PAPER = (255.0,) * 3
PLANS = [(60, 60), (60, 460), (460, 60), (460, 460)]


def sheet(seen: int, legend: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """Four plans, so many of them seen, and a legend of so many pixels."""
    rgb = np.full((800, 800, 3), 255, np.uint8)
    built = np.zeros((800, 800), bool)
    for index, (y, x) in enumerate(PLANS):
        rgb[y : y + 280, x : x + 280] = 90
        rgb[y + 8 : y + 272, x + 8 : x + 272] = 255
        built[y : y + 280, x : x + 280] = index < seen
    rgb[760 : 760 + legend, 100 : 100 + legend] = 0
    return rgb, built


@pytest.mark.parametrize(
    ("seen", "looked"),
    [(4, 0), (3, 1), (2, 2), (1, 0)],
    ids=["all", "one is not", "two are not", "no sheet of plans"],
)
def test_a_sheet_is_looked_at_where_a_plan_was_not_seen(seen: int, looked: int) -> None:
    """Of twelve storeys on a sheet three were seen."""
    windows = list(_unseen_plans(*sheet(seen, legend=30), PAPER))
    assert len(windows) == looked
    for (rows, columns), (y, x) in zip(windows, PLANS[seen:], strict=False):
        assert rows.start <= y
        assert y + 280 <= rows.stop <= y + 310
        assert columns.start <= x
