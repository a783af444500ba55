"""What reaches the OCR engine is bounded in shape, and looks as it did."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.line.plan.text import _broadened

sides = st.integers(1, 400)


@given(sides, sides)
def test_strips_get_paper_at_their_side_until_they_are_five_times_as_long(h: int, w: int) -> None:
    rgb = np.random.default_rng(h * 1000 + w).integers(0, 255, (h, w, 3), np.uint8)
    broad = _broadened(rgb)
    assert np.array_equal(broad[:h, :w], rgb)
    assert max(broad.shape[:2]) == max(h, w)
    assert max(broad.shape[:2]) <= 5 * min(broad.shape[:2])
    assert (broad[h:] == 255).all()
    assert (broad[:, w:] == 255).all()
    if max(h, w) <= 5 * min(h, w):
        assert broad is rgb
