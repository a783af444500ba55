"""Masses of the meshes, beside weights that shops and data sheets give for such things."""

from __future__ import annotations

import pytest

from chord_usd.base.scene.palette import usual_mass_kg
from chord_usd.library.catalogue import designs


@pytest.mark.parametrize(
    ("category", "lightest_kg", "heaviest_kg"),
    [
        ("bed", 40, 210),
        ("bowl", 0.1, 1.5),
        ("chair", 3, 12),
        ("dining_table", 15, 80),
        ("dinner_set", 0.2, 4),
        ("floor_plant", 0.9, 35),
        ("laptop", 1, 3),
        ("refrigerator", 50, 130),
        ("shower_screen", 15, 35),
        ("sofa", 30, 110),
        ("throw", 0.3, 3),
        ("washing_machine", 55, 85),
    ],
)
def test_a_mass_is_that_of_such_a_thing(
    category: str, lightest_kg: float, heaviest_kg: float
) -> None:
    masses = [
        usual_mass_kg(one.category, one.size_m) for one in designs() if one.category == category
    ]
    assert masses
    assert lightest_kg <= min(masses) <= max(masses) <= heaviest_kg
