"""Stairs keep their rules, whatever box they stand in."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from shapely.geometry import LineString, Point, Polygon
from shapely.ops import unary_union

from chord_usd.base.errors import PlanError
from chord_usd.base.scene.geometry import footprint_polygon, to_world
from chord_usd.base.scene.stair_forms import BuiltStair, build_stair, least_square_m
from chord_usd.base.scene.stair_spirals import POLE_M, RIM_M, SPIRAL_THICK_M, is_round
from chord_usd.base.scene.storeys import GOING_M, HEADROOM_M, RISE_M, Stair, Turn
from chord_usd.base.scene.types import Box
from tests.every import for_every

SIZES = {
    "straight": (0.95, 4.0), "U": (2.0, 3.0), "L": (2.8, 3.0), "winder_L": (1.7, 3.0),
    "winder_U": (1.75, 2.3), "spiral": (2.5, 3.1),
}  # fmt: skip
CASES = list(itertools.product(SIZES, ("left", "right"), (0.0, 90.0, 37.0), (2.6, 3.0, 3.2)))


def built(form: str, turn: str, yaw_deg: float, height_m: float) -> BuiltStair:
    width, depth = SIZES[form]
    box = Box((3.0, -2.0, 0.0), (width, depth + (height_m - 3.0) * 1.5, 1.0), yaw_deg)
    return build_stair(Stair("stair", form, box, turn), height_m)  # type: ignore[arg-type]


@for_every("case", CASES, ids=str)
def test_walking_a_stair_is_even_steps_of_the_rule(case: tuple[str, str, float, float]) -> None:
    stair = built(*case)
    assert RISE_M[0] - 1e-9 <= stair.rise_m <= RISE_M[1] + 1e-9
    assert GOING_M[0] - 1e-6 <= stair.going_m <= GOING_M[1] + 1e-6
    line = LineString(stair.walk_m[:, :2])
    rings = [to_world(stair.stair.box, np.asarray(t.area_m.exterior.coords)) for t in stair.treads]
    places = [Polygon(ring).buffer(1e-3) for ring in rings]
    heights = [0.0]
    for along in np.arange(0.0, line.length, 0.02):
        point: Point = line.interpolate(along)
        under = [
            tread.top_m
            for tread, place in zip(stair.treads, places, strict=True)
            if tread.top_m < heights[-1] + 1.0 and place.covers(point)
        ]
        if under:
            heights.append(max(under))
    heights.append(stair.height_m)
    steps = np.diff(heights)
    up = steps[np.abs(steps) > 1e-6]
    assert np.allclose(up, stair.rise_m)
    assert footprint_polygon(stair.stair.box).buffer(1e-3).covers(stair.area_m)
    assert stair.area_m.distance(Point(stair.walk_m[-1, :2])) > 0.3
    assert stair.departure_m.length == pytest.approx(stair.arrival_m.length)


@pytest.mark.parametrize(
    ("form", "size"),
    [
        ("straight", (0.95, 2.5)), ("U", (1.5, 3.0)), ("L", (1.9, 1.9)), ("winder_L", (0.7, 3.5)),
        ("winder_L", (1.2, 2.6)), ("winder_U", (1.6, 2.5)), ("winder_U", (1.9, 1.4)),
        ("spiral", (1.6, 1.6)), ("spiral", (1.94, 2.5)),
    ],
)  # fmt: skip
def test_a_box_too_small_is_refused(form: str, size: tuple[float, float]) -> None:
    with pytest.raises(PlanError, match="cannot rise"):
        build_stair(Stair("s", form, Box((0, 0, 0), (*size, 1.0), 0.0)), 3.0)  # type: ignore[arg-type]


@pytest.mark.parametrize("size", [(1.0, 3.5), (1.7, 3.0), (2.4, 2.4), (3.2, 1.8)])
@pytest.mark.parametrize("height_m", [2.7, 3.0])
def test_the_going_of_a_winder_is_even_on_its_walking_line_and_5_cm_at_the_newel(
    size: tuple[float, float], height_m: float
) -> None:
    for form, extra in (("winder_L", 0.0), ("winder_U", 0.75)):
        box = Box((0.0, 0.0, 0.0), (size[0] + extra, size[1] + extra, 1.0), 0.0)
        stair = build_stair(Stair("s", form, box), height_m)  # type: ignore[arg-type]
        line = LineString(stair.walk_m[:, :2])
        edges = [one.edges_m for one in stair.treads if one.edges_m]
        for on, off in edges:
            goings = [line.project(edge.intersection(line)) for edge in (on, off)]
            assert goings[1] - goings[0] == pytest.approx(stair.going_m, abs=1e-3)
            assert Point(on.coords[0]).distance(Point(off.coords[0])) >= 0.05 - 1e-6
        areas = [tread.area_m for tread in stair.treads]
        assert all(area.is_valid for area in areas)
        assert unary_union(areas).area == pytest.approx(sum(area.area for area in areas))


@pytest.mark.parametrize("height_m", [2.6, 2.7, 3.0, 3.2])
@pytest.mark.parametrize("more_m", [0.0, 0.15, 0.5])
@pytest.mark.parametrize("turn", ["left", "right"])
def test_a_spiral_stair_has_its_going_halfway_and_headroom_below_its_own_turns(
    turn: Turn, more_m: float, height_m: float
) -> None:
    side = least_square_m(height_m) + more_m
    stair = build_stair(
        Stair("s", "spiral", Box((0.0, 0.0, 0.0), (side, side, 1.0), 0.0), turn), height_m
    )
    *treads, landing = stair.treads
    rim = max(np.hypot(*point) for point in treads[0].area_m.exterior.coords)
    walked = LineString(Point(0.0, 0.0).buffer((POLE_M + rim) / 2, quad_segs=90).exterior)
    for tread in treads:
        assert walked.intersection(tread.area_m).length == pytest.approx(stair.going_m, abs=2e-3)
    for one, other in itertools.combinations(stair.treads, 2):
        if one.area_m.intersection(other.area_m).area > 1e-4:
            assert other.top_m - SPIRAL_THICK_M - one.top_m >= HEADROOM_M - 1e-6
    assert landing.top_m == height_m
    assert stair.landing_m is not None
    assert stair.landing_m.distance(stair.arrival_m) == pytest.approx(RIM_M, abs=2e-3)
    assert is_round(stair.hole_m)
    assert stair.area_m.covers(stair.hole_m)


def test_a_spiral_stair_too_small_is_told_how_large_it_has_to_be() -> None:
    side = least_square_m(3.0)
    for size, told in ((side, None), (side - 0.01, "cm deep"), (1.6, "too narrow")):
        stair = Stair("s", "spiral", Box((0.0, 0.0, 0.0), (size, size, 1.0), 0.0))
        if told is None:
            assert build_stair(stair, 3.0).going_m >= GOING_M[0] - 1e-6
            continue
        with pytest.raises(PlanError, match=told) as refused:
            build_stair(stair, 3.0)
        assert f"a square of {side:.2f} m" in str(refused.value)


def test_a_winder_takes_less_room_than_a_landing() -> None:
    box = Box((0.0, 0.0, 0.0), (1.75, 2.1, 1.0), 0.0)
    assert build_stair(Stair("s", "winder_U", box), 3.0).going_m >= GOING_M[0]
    with pytest.raises(PlanError, match="cannot rise"):
        build_stair(Stair("s", "U", box), 3.0)
