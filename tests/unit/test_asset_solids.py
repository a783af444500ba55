"""Solids are closed, look outwards and measure what they were asked to; their UVs are metres."""

from __future__ import annotations

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely.affinity import scale

from chord_usd.library.kit import solids
from chord_usd.library.kit.joinery import round_colliders
from chord_usd.library.kit.shading import corner_normals, corner_uvs_m
from chord_usd.library.kit.solids import Solid

SIDE = st.floats(0.05, 3.0)
SIZE = st.tuples(SIDE, SIDE, SIDE)


def edges_of(solid: Solid) -> np.ndarray:
    """(3 T, 2) directed edges."""
    faces = solid.faces
    return np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])


def is_closed(solid: Solid) -> bool:
    """Every directed edge occurs as often as its reverse: no hole, no flipped face."""
    edges = edges_of(solid)
    forward, backward = (np.unique(e, axis=0, return_counts=True) for e in (edges, edges[:, ::-1]))
    return np.array_equal(forward[0], backward[0]) and np.array_equal(forward[1], backward[1])


def volume_m3(solid: Solid) -> float:
    """Signed volume; negative where faces look inwards."""
    a, b, c = (solid.points_m[solid.faces[:, k]] for k in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6)


def areas_m2(solid: Solid) -> np.ndarray:
    a, b, c = (solid.points_m[solid.faces[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2


SHAPES = {
    "box": lambda s: solids.box(s),
    "block": lambda s: solids.block(s, 0.01),
    "slab": lambda s: solids.rounded_slab(s, 0.08, 0.01, 4, 2),
    "cushion": lambda s: solids.cushion(s, 0.06, 0.04, min(0.03, s[2] / 4)),
    "pillow": lambda s: solids.pillow(s),
    "soft block": lambda s: solids.soft_block(s, 0.03, (2, 3, 1)),
}


@pytest.mark.parametrize("shape", SHAPES)
@given(size=SIZE)
@settings(max_examples=25, deadline=None)
def test_blocks_are_closed_and_fill_their_size(
    shape: str, size: tuple[float, float, float]
) -> None:
    solid = SHAPES[shape](size)
    assert is_closed(solid)
    low, high = solid.bounds_m()
    assert np.allclose(high - low, size, atol=1e-9)
    assert low[2] == pytest.approx(0.0, abs=1e-9)
    assert np.allclose(low[:2] + high[:2], 0.0, atol=1e-9)
    assert 0.2 * math.prod(size) < volume_m3(solid) <= math.prod(size) * (1 + 1e-9)


@given(size=SIZE)
def test_a_box_holds_length_times_width_times_height(size: tuple[float, float, float]) -> None:
    assert volume_m3(solids.box(size)) == pytest.approx(math.prod(size))


def test_turned_shapes_hold_what_the_formulas_say() -> None:
    cone = solids.cylinder(0.3, 0.9, sides=96, top_m=0.1)
    frustum = math.pi * 0.9 / 3 * (0.3**2 + 0.3 * 0.1 + 0.1**2)
    assert volume_m3(cone) == pytest.approx(frustum, rel=0.002)
    profile = [(0.5, 0.0), (0.5, 0.2), (0.4, 0.2), (0.4, 0.0)]
    hoop = solids.lathe(profile, 96, loop=True)
    assert is_closed(hoop)
    assert volume_m3(hoop) == pytest.approx(math.pi * (0.25 - 0.16) * 0.2, rel=0.002)


def test_an_extrusion_leaves_its_holes_open() -> None:
    hole = solids.ring(0.4, 0.2, 0.0, steps=0)[:, :2]
    for turned in (hole, hole[::-1]):
        plate = solids.extruded(solids.ring(1.0, 0.6, 0.0, steps=0), 0.05, [turned])
        assert is_closed(plate)
        assert volume_m3(plate) == pytest.approx((0.6 - 0.08) * 0.05)


def test_a_tube_keeps_its_thickness_around_bends() -> None:
    path = np.array([[0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1.0]])
    bar = solids.tube(path, 0.02, 32)
    assert is_closed(bar)
    section = math.pi * 0.02**2
    assert volume_m3(bar) == pytest.approx(3.0 * section, rel=0.01)


@given(size=SIZE, x=SIDE, turn=st.floats(-180, 180))
@settings(deadline=None)
def test_moving_turning_and_mirroring_keep_the_volume(
    size: tuple[float, float, float], x: float, turn: float
) -> None:
    solid = solids.block(size)
    moved = solid.moved(x, -x, 2 * x).turned("y", turn).scaled(x=-1.0)
    assert is_closed(moved)
    assert volume_m3(moved) == pytest.approx(volume_m3(solid), rel=1e-6)


def test_axes_turn_counter_clockwise_as_seen_down_them() -> None:
    arrow = solids.box((0.1, 0.1, 1.0)).moved(z=1.0)
    tip = arrow.turned("x", 90).bounds_m()
    assert tip[0, 1] == pytest.approx(-2.0)  # z turns to -y
    tip = arrow.turned("y", 90).bounds_m()
    assert tip[1, 0] == pytest.approx(2.0)  # z turns to x


def test_folds_push_no_further_than_asked() -> None:
    cloth = solids.soft_block((1.5, 1.2, 0.2), 0.05, (8, 8, 1))
    creased = solids.creased(cloth, 0.01, 0.5)
    assert is_closed(creased)
    shift = np.linalg.norm(creased.points_m - cloth.points_m, axis=1)
    assert 0.004 < shift.max() <= 0.01


@pytest.mark.parametrize("shape", SHAPES)
def test_normals_are_unit_and_look_outwards(shape: str) -> None:
    solid = SHAPES[shape]((0.8, 0.5, 0.3))
    normals = corner_normals(solid)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1.0)
    corners = solid.points_m[solid.faces]
    flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.all(np.einsum("tci,ti->tc", normals.reshape(-1, 3, 3), flat) > 0.0)


def test_a_box_keeps_flat_faces_and_a_cylinder_shades_round() -> None:
    normals = corner_normals(solids.box((1.0, 1.0, 1.0)))
    assert np.allclose(np.abs(normals).max(axis=1), 1.0)
    post = solids.cylinder(0.2, 1.0, sides=24)
    sides = np.abs(post.points_m[post.faces][:, :, 2].std(axis=1)) > 0.1
    around = corner_normals(post).reshape(-1, 3, 3)[sides].reshape(-1, 3)
    radial = post.points_m[post.faces[sides].reshape(-1)] * [1, 1, 0] / 0.2
    assert np.allclose(around, radial, atol=0.02)


@given(size=SIZE)
@settings(max_examples=20, deadline=None)
def test_uvs_of_faces_along_the_axes_are_metres(size: tuple[float, float, float]) -> None:
    solid = solids.box(size)
    uv = corner_uvs_m(solid).reshape(-1, 3, 2)
    first, second = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    signed = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]) / 2
    assert np.allclose(np.abs(signed), areas_m2(solid))
    tops = np.ptp(solid.points_m[solid.faces][:, :, 2], axis=1) > 0
    assert np.all(signed[tops] > 0.0), "seen from outside, pictures are not mirrored"


@pytest.mark.parametrize("size", [(0.4, 0.4), (0.9, 0.9), (1.0, 0.6)])
def test_the_blocks_of_a_round_top_stay_inside_it_and_near_its_rim(
    size: tuple[float, float],
) -> None:
    """Not at the chairs beside it, and below whatever stands on it but the last 3 cm."""
    length, width = size
    top = solids.cylinder(0.5, 0.03, 0, 90).scaled(x=length, y=width)
    felt = shapely.union_all(
        [shapely.box(*one.bounds_m()[:, :2].ravel()) for one in round_colliders(top)]
    )
    disc = scale(shapely.Point(0, 0).buffer(0.5, 90), length, width)
    assert felt.difference(disc).area < 1e-4
    assert disc.difference(felt.buffer(0.03)).area < 1e-4
