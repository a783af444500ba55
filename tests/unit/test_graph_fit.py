"""How meshes fill the boxes they are found for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.base.scene.geometry import footprint, footprint_polygon
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.types import Asset, Box
from chord_usd.line.graph.match import MOST_STRETCH, fitted_box

SIDE = st.floats(0.3, 3.0).map(lambda side: round(side, 3))
SIZE = st.tuples(SIDE, SIDE, SIDE)


def armchair(size_m: tuple[float, float, float]) -> Asset:
    return Asset("Armchair", "single_sofa", size_m, Path("Armchair.usda"))


@given(wanted=SIZE, found=SIZE, yaw_deg=st.sampled_from((0.0, 30.0, 90.0, -135.0)))
def test_a_mesh_keeps_its_proportions_and_stays_in_its_box(
    wanted: tuple[float, float, float], found: tuple[float, float, float], yaw_deg: float
) -> None:
    box = Box((1.0, 2.0, 0.0), wanted, yaw_deg)
    fitted = fitted_box(box, armchair(found), category("single_sofa"), is_guess=True)
    scale = np.array(fitted.size_m[:2]) / np.array(found[:2])
    assert scale.max() / scale.min() <= MOST_STRETCH + 1e-4
    grown = footprint_polygon(box).buffer(1e-4)
    assert grown.contains(footprint_polygon(fitted)), "nothing collides that did not before"
    assert min(np.array(wanted[:2]) - np.array(fitted.size_m[:2])) < 1e-5, "and fills one side"


def test_a_mesh_of_nearly_the_size_fills_its_box() -> None:
    box = Box((0.0, 0.0, 0.0), (0.8, 0.84, 0.85), 0.0)
    fitted = fitted_box(box, armchair((0.8, 0.82, 0.9)), category("single_sofa"), is_guess=True)
    assert fitted.size_m == (0.8, 0.84, 0.9), "its height is its own: pictures show none"
    told = fitted_box(box, armchair((0.8, 0.82, 0.9)), category("single_sofa"), is_guess=False)
    assert told.size_m == (0.8, 0.84, 0.85)


def test_a_mesh_that_is_shallower_stands_against_the_back() -> None:
    box = Box((0.0, 0.0, 0.0), (0.8, 1.2, 0.9), 0.0)
    fitted = fitted_box(box, armchair((0.8, 0.8, 0.9)), category("single_sofa"), is_guess=False)
    assert fitted.size_m[1] < 1.0
    assert fitted.center_m[1] + fitted.size_m[1] / 2 == 0.6


def test_kitchens_have_no_gaps() -> None:
    box = Box((0.0, 0.0, 0.0), (0.47, 0.5, 0.85), 0.0)
    asset = Asset("Door", "single_door_floor_cabinet", (0.4, 0.6, 0.87), Path("Door.usda"))
    fitted = fitted_box(box, asset, category(asset.category), is_guess=True)
    assert fitted.size_m == (0.47, 0.5, 0.87)
    assert fitted.center_m == box.center_m


@pytest.mark.parametrize("name", ["picture", "ceiling_lamp", "curtain", "rug", "bowl"])
def test_dressing_keeps_its_size_and_its_place(name: str) -> None:
    row = category(name)
    asset = Asset("a", name, (1.0, 0.1, 0.5), Path("a"))
    box = Box((1.0, 2.0, 0.7), (1.4, 0.2, 0.6), 90.0)
    fitted = fitted_box(box, asset, row, is_guess=False)
    most = np.array([1.15, 1.15]) if name in ("curtain", "rug") else np.ones(2)
    assert np.all(np.array(fitted.size_m[:2]) <= np.array(asset.size_m[:2]) * most + 1e-9)
    top = box.center_m[2] + box.size_m[2]
    if row.mount in (Mount.CEILING, Mount.WINDOW):
        assert fitted.center_m[2] + fitted.size_m[2] == pytest.approx(top)
    assert fitted.center_m[2] == box.center_m[2]
    if row.mount in (Mount.WALL, Mount.WINDOW):
        assert np.allclose(footprint(fitted)[[0, 3], 0], footprint(box)[[0, 3], 0])
