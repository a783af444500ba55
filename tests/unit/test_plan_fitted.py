"""Walls go where printed sizes put them, straight and joined; what does not fit is named."""

from __future__ import annotations

import numpy as np
import pytest
from shapely.geometry import Polygon

from chord_usd.line.plan.fitted import fit
from chord_usd.line.plan.text import Text
from chord_usd.line.plan.wall_openings import WallOpening

M_PER_PX, WALL_PX = 0.01, 12.0


def text_at(said: str, x: float, y: float) -> Text:
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    return Text(said, np.array([x, y]) + signs * np.array([20.0, 5.0]), 1.0)


def room(west: float, north: float, east: float, south: float) -> np.ndarray:
    return np.array([[west, north], [west, south], [east, south], [east, north]], float)


def sides_m(polygon: np.ndarray, m_per_px: float) -> tuple[float, float]:
    width, height = np.ptp(polygon, axis=0) * m_per_px
    return float(width), float(height)


# Two rooms beside each other, seen 8 and 6 px off, and one below both.
SEEN = [room(0, 0, 408, 300), room(420, 0, 714, 300), room(0, 312, 714, 512)]
DOOR = WallOpening("door", np.array([414.0, 150.0]), np.array([0.0, 1.0]), 80.0, WALL_PX, (), 0.9)
SIZES = [text_at("4.00 x 3.00", 200, 150), text_at("3.00 x 3.00", 560, 150)]


def test_walls_move_to_printed_sizes_and_openings_with_them() -> None:
    found = fit(SEEN, [DOOR], SIZES, M_PER_PX, WALL_PX)
    assert sides_m(found.polygons_px[0], found.m_per_px) == pytest.approx((4.0, 3.0), abs=0.02)
    assert sides_m(found.polygons_px[1], found.m_per_px) == pytest.approx((3.0, 3.0), abs=0.02)
    left, right, below = found.polygons_px
    wall = right[:, 0].min() - left[:, 0].max()
    assert wall == pytest.approx(WALL_PX, abs=0.2)
    assert below[:, 0].max() == pytest.approx(right[:, 0].max())  # the outer wall stays straight
    assert found.openings[0].center_px[0] == pytest.approx(left[:, 0].max() + wall / 2, abs=0.2)
    assert found.misfits == ()


def test_lengths_of_a_chain_move_walls_too() -> None:
    chain = [text_at("4.00", 204, -40), text_at("3.00", 567, -40)]
    found = fit(SEEN, [], chain, M_PER_PX, WALL_PX)
    assert sides_m(found.polygons_px[0], found.m_per_px)[0] == pytest.approx(4.0, abs=0.02)


def test_an_area_is_kept_to_its_last_digit() -> None:
    found = fit(SEEN[:1], [], [text_at("12.0 m²", 200, 150)], M_PER_PX, WALL_PX)
    assert Polygon(found.polygons_px[0]).area * M_PER_PX**2 == pytest.approx(12.0, abs=0.1)
    found = fit(SEEN[:1], [], [text_at("12 m²", 200, 150)], M_PER_PX, WALL_PX)
    assert np.allclose(found.polygons_px[0], SEEN[0])  # 12.24 m² is 12 m²


def test_a_size_that_does_not_fit_is_named_with_what_was_read_and_moves_nothing() -> None:
    found = fit(SEEN, [], [text_at("4.00 x 2.40", 200, 150)], M_PER_PX, WALL_PX)
    (misfit,) = found.misfits
    assert misfit.text == "4.00 x 2.40"
    assert misfit.at_px == (200.0, 150.0)
    assert misfit.read_m == pytest.approx((4.08, 3.0), abs=0.01)
    assert all(np.allclose(a, b) for a, b in zip(found.polygons_px, SEEN, strict=True))


def test_sizes_that_contradict_each_other_are_named() -> None:
    """Both rooms and the one below them are printed, and the sum is 20 cm off."""
    texts = [*SIZES, text_at("7.35 x 2.00", 300, 412)]
    found = fit(SEEN, [], texts, M_PER_PX, WALL_PX)
    assert found.misfits
    assert {one.text for one in found.misfits} <= {text.text for text in texts}


def test_walls_without_measures_stay() -> None:
    found = fit(SEEN, [DOOR], [], M_PER_PX, WALL_PX)
    assert all(np.allclose(a, b) for a, b in zip(found.polygons_px, SEEN, strict=True))
    assert found.m_per_px == M_PER_PX


def test_digits_that_were_not_read_move_nothing_far() -> None:
    """OCR reads 3.1 for 3.19: half a decimetre is what such a length may be off."""
    rooms = [room(0, 0, 319, 400)]
    exact = fit(rooms, [], [text_at("3.10 x 4.00", 160, 200)], M_PER_PX, WALL_PX)
    coarse = fit(rooms, [], [text_at("3.1 x 4.00", 160, 200)], M_PER_PX, WALL_PX)
    moved = [abs(np.ptp(one.polygons_px[0][:, 0]) - 319) for one in (exact, coarse)]
    assert moved[1] < 0.75 * moved[0]


def test_few_measures_move_nothing_and_are_still_compared() -> None:
    texts = [text_at("4.00 x 2.40", 200, 150), SIZES[1]]
    still = fit(SEEN, [], texts, M_PER_PX, WALL_PX, moves=False)
    assert all(np.allclose(a, b) for a, b in zip(still.polygons_px, SEEN, strict=True))
    assert [one.text for one in still.misfits] == ["4.00 x 2.40"]


def test_many_sizes_say_the_scale_together() -> None:
    rooms = [room(420.0 * n, 0, 420.0 * n + 400, 300) for n in range(4)]
    texts = [text_at("4.10 x 3.08", 420.0 * n + 200, 150) for n in range(4)]
    assert fit(rooms, [], texts, M_PER_PX, WALL_PX).m_per_px == pytest.approx(0.01026, rel=2e-3)


def test_areas_that_say_another_scale_alike_move_no_wall() -> None:
    """Walls of a drawn plan moved up to 10 px where the scale was 2.5 % off."""
    areas = [1.05 * Polygon(polygon).area * M_PER_PX**2 for polygon in SEEN]
    spots = [(200, 150), (560, 150), (350, 412)]
    texts = [text_at(f"{m2:.1f} m²", *at) for m2, at in zip(areas, spots, strict=True)]
    found = fit(SEEN, [DOOR], texts, M_PER_PX, WALL_PX)
    assert found.m_per_px == pytest.approx(M_PER_PX * 1.05**0.5, rel=5e-3)
    assert all(np.allclose(a, b, atol=1.5) for a, b in zip(found.polygons_px, SEEN, strict=True))
