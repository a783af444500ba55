"""Pictures are as bright as what they show, within what a photographer would do."""

import numpy as np
import pytest

from chord_usd.line.image.exposure import EXPOSURE_RANGE_EV, KEY, PALE_ALBEDO, exposure_ev, tone


def test_the_key_is_reached_whatever_the_light() -> None:
    room = np.random.default_rng(1).uniform(0.2, 0.8, 4000)
    for brightness in (0.001, 1.0, 500.0):
        shown = np.sort(brightness * room)[400:] * 2.0 ** exposure_ev(brightness * room, KEY)
        assert np.exp2(np.log2(shown).mean()) == pytest.approx(KEY)
    assert exposure_ev(np.zeros(10), KEY) == 0.0
    assert exposure_ev(np.full(10, 1e-5), KEY) == EXPOSURE_RANGE_EV[1]


def test_dark_rooms_are_shown_darker_but_not_by_all_of_it() -> None:
    assert tone(np.full(9, PALE_ALBEDO)) == pytest.approx(1.0)
    assert tone([]) == 1.0
    tones = [tone([albedo]) for albedo in (0.0, 0.12, 0.25, 0.5, 0.7, 1.0)]
    assert tones == sorted(tones)
    # A room of a quarter of the albedo shows darker than the pale one, by less than two stops.
    assert 0.25 < tone([PALE_ALBEDO / 4]) < 0.75
