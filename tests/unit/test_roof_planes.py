"""Roofs: whole, nowhere twice, without a step between two planes; gables where a hip would end."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely.affinity import rotate
from shapely.geometry import Polygon, box
from shapely.geometry.base import BaseGeometry

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.roof_planes import OVERHANG_M, RoofPlane, roof_planes
from chord_usd.line.stage.shell.slabs import covered as covered_by
from chord_usd.line.stage.shell.walls import build_walls
from chord_usd.workshop.data.houses import random_plan
from tests.every import for_every


def outline(seed: int) -> BaseGeometry:
    """Up to five wings, every third house with a courtyard, turned any way."""
    rng = np.random.default_rng(seed)
    corners, sizes = rng.uniform(0, 12, (5, 2)), rng.uniform(2, 9, (5, 2))
    parts = [box(x, y, x + w, y + h) for (x, y), (w, h) in zip(corners, sizes, strict=True)]
    shape = shapely.union_all(parts)
    if seed % 3 == 0:
        shape = shape.difference(box(5, 5, 5 + rng.uniform(0.5, 4), 9))
    return rotate(shape, rng.uniform(0, 360), origin=(0, 0))


def covered(planes: list[RoofPlane]) -> BaseGeometry:
    return shapely.union_all([plane.area_m for plane in planes], grid_size=1e-6)


@pytest.mark.parametrize("form", ["gable", "hip"])
@for_every("seed", range(25))
def test_a_roof_covers_all_and_nothing_twice(seed: int, form: str) -> None:
    shape = outline(seed)
    planes = roof_planes(shape, form)  # type: ignore[arg-type]
    whole = covered(planes)
    assert sum(plane.area_m.area for plane in planes) == pytest.approx(whole.area, abs=1e-3)
    eaves = shape.buffer(OVERHANG_M - 0.01, join_style="mitre")
    assert eaves.difference(whole.buffer(1e-6)).area < 1e-3


@for_every("seed", range(25))
def test_planes_of_a_hip_roof_meet_at_one_height_and_begin_at_one(seed: int) -> None:
    planes = roof_planes(outline(seed), "hip")
    whole = covered(planes).buffer(1e-4, join_style="mitre").buffer(-1e-4, join_style="mitre")
    rim = whole.boundary
    for plane in planes:
        corners = np.asarray(plane.area_m.exterior.coords)
        heights = plane.heights_m(corners)
        assert (heights >= plane.foot_m - 1e-6).all()
        for other in planes:
            met = shapely.distance(other.area_m, shapely.points(corners)) < 1e-6
            assert np.allclose(other.heights_m(corners[met]), heights[met], atol=1e-4)
        on_rim = shapely.distance(rim, shapely.points(corners)) < 1e-5
        assert np.allclose(heights[on_rim], plane.foot_m, atol=1e-4)


@for_every("seed", [90016, 90085])
def test_outer_walls_that_touch_at_a_corner_get_a_roof(seed: int) -> None:
    """What is left of a plane is an area and a line, which overlays do not take."""
    walls = build_walls(random_plan(np.random.default_rng(seed)))
    shape = covered_by(walls)
    whole = covered(roof_planes(shape, "hip"))
    assert shape.difference(whole.buffer(1e-5)).area < 1e-3


def test_a_gable_roof_has_a_ridge_from_end_to_end() -> None:
    planes = roof_planes(box(0, 0, 10, 6), "gable")
    assert len(planes) == 2
    tops = [np.asarray(plane.area_m.exterior.coords) for plane in planes]
    for plane, corners in zip(planes, tops, strict=True):
        ridge = corners[np.isclose(plane.heights_m(corners), plane.heights_m(corners).max())]
        assert np.ptp(ridge[:, 0]) == pytest.approx(10 + 2 * OVERHANG_M)


def test_walls_that_slant_get_a_flat_roof_only() -> None:
    slanted = Polygon([(0, 0), (8, 0), (8, 4), (4, 8), (0, 8)])
    assert roof_planes(slanted, "flat")[0].slope == 0.0
    for form in ("gable", "hip"):
        with pytest.raises(PlanError, match=f"1 outer walls slant, which no {form} roof"):
            roof_planes(slanted, form)  # type: ignore[arg-type]
