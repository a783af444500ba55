"""Masses of the meshes, beside weights that shops and data sheets give for such things."""

from __future__ import annotations

import math

import pytest

from chord_usd.base.scene.articulation import hinge_damping
from chord_usd.base.scene.palette import usual_mass_kg
from chord_usd.library.catalogue import designs
from chord_usd.line.stage.author.physics import DOOR_KG_PER_M2


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


@pytest.mark.parametrize("width_m", [0.6, 0.9, 1.15])
def test_a_hand_opens_a_door_in_time(width_m: float) -> None:
    """30 N m turn a leaf of 2.1 m by 81 of 90 degrees within 1.6 s, as check --open asks."""
    inertia = DOOR_KG_PER_M2 * width_m * 2.1 * width_m**2 / 3
    damping = math.degrees(hinge_damping(inertia))
    settles_s = inertia / damping
    turned = 30.0 / damping * (1.6 - settles_s * (1.0 - math.exp(-1.6 / settles_s)))
    assert math.degrees(turned) > 81.0
