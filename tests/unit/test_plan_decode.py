"""decode(draw(plan)) is the plan, within half a pixel."""

from __future__ import annotations

import numpy as np
import pytest
from plan_round_trip import HALF_DIAGONAL_PX, assert_round_trip

from chord_usd.base.errors import PlanError
from chord_usd.base.raster import canvas
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import (
    WALL_THICKNESS_M,
    Box,
    Opening,
    Plan,
    PlanImage,
    Room,
    RoomKind,
    frozen_array,
)
from chord_usd.line.plan.decode import decode_plan, wall_thickness_px
from chord_usd.workshop.data.houses import random_plan

Kinds = tuple[RoomKind, RoomKind]


def test_random_houses_come_back_within_half_a_pixel() -> None:
    differing = [assert_round_trip(seed) for seed in range(20)]
    # Most come back to the pixel; the rest differ along a slanted wall.
    assert np.mean(np.equal(differing, 0)) > 0.75
    assert max(differing) < 60


@pytest.mark.parametrize("seed", range(3))
def test_decoding_what_was_decoded_changes_nothing(seed: int) -> None:
    image = canvas.draw_plan(random_plan(np.random.default_rng(seed + 100)))
    once = decode_plan(image)
    twice = decode_plan(canvas.draw_plan(once, image.frame))
    assert len(once.rooms) == len(twice.rooms)
    for first, second in zip(once.rooms, twice.rooms, strict=True):
        strayed = room_polygon(first).hausdorff_distance(room_polygon(second))
        assert strayed / image.frame.m_per_px <= HALF_DIAGONAL_PX


def test_rooms_keep_the_thickness_of_the_wall_between_them() -> None:
    plan = two_rooms()
    decoded = decode_plan(canvas.draw_plan(plan))
    left, right = sorted(decoded.rooms, key=lambda room: room.polygon_m[:, 0].min())
    apart = right.polygon_m[:, 0].min() - left.polygon_m[:, 0].max()
    assert apart == pytest.approx(WALL_THICKNESS_M, abs=1e-9)


# What a raster can and cannot tell ---------------------------------------------------------------


def two_rooms(
    opening: str = "door", kinds: tuple[RoomKind, RoomKind] = ("living", "kitchen")
) -> Plan:
    return Plan(
        (
            Room("a", kinds[0], frozen_array([[0, 0], [4.07, 0], [4.07, 5], [0, 5]])),
            Room("b", kinds[1], frozen_array([[4.31, 0], [8, 0], [7, 5], [4.31, 5]])),
        ),
        (
            Opening("o", opening, Box((4.19, 2.03, 0), (1.1, 0.24, 2.1), 90), ("a", "b")),  # type: ignore[arg-type]
            Opening("w", "window", Box((2, -0.12, 0.9), (1.5, 0.24, 1.5), 0), ("a",)),
        ),
    )  # fmt: skip


@pytest.mark.parametrize("opening", ["door", "window", "passage"])
@pytest.mark.parametrize("shade", [True, False])
def test_openings_join_the_rooms_they_joined(opening: str, shade: bool) -> None:
    decoded = decode_plan(canvas.draw_plan(two_rooms(opening), shade=shade))
    assert len(decoded.rooms) == 2
    (joint,) = (o for o in decoded.openings if len(o.room_ids) == 2)
    assert joint.kind == opening
    assert joint.box.size_m[1] == pytest.approx(WALL_THICKNESS_M)
    assert joint.box.yaw_deg == 90.0


def test_unshaded_rooms_are_of_unknown_kind() -> None:
    decoded = decode_plan(canvas.draw_plan(two_rooms(), shade=False))
    assert {room.kind for room in decoded.rooms} == {"unknown"}


def test_a_passage_between_rooms_of_one_shade_still_parts_them() -> None:
    decoded = decode_plan(canvas.draw_plan(two_rooms("passage", ("living", "living"))))
    assert [room.kind for room in decoded.rooms] == ["living", "living"]
    assert [o.kind for o in decoded.openings if len(o.room_ids) == 2] == ["passage"]


def test_a_window_round_a_corner_becomes_two() -> None:
    room = Room("a", "living", frozen_array([[0, 0], [4, 0], [4, 4], [0, 4]]))
    openings = (
        Opening("w1", "window", Box((3.62, -0.12, 0.9), (1.24, 0.24, 1.5), 0)),
        Opening("w2", "window", Box((4.12, 0.5, 0.9), (1.0, 0.24, 1.5), 90)),
    )
    decoded = decode_plan(canvas.draw_plan(Plan((room,), openings)))
    assert sorted(o.box.yaw_deg for o in decoded.openings) == [0.0, 90.0]


# Scale -------------------------------------------------------------------------------------------


def test_the_frame_gives_the_scale() -> None:
    image = canvas.draw_plan(two_rooms())
    width = np.ptp(np.concatenate([r.polygon_m for r in decode_plan(image).rooms])[:, 0])
    assert width == pytest.approx(8.0, abs=image.frame.m_per_px)
    doubled = decode_plan(image, m_per_px=2 * image.frame.m_per_px)
    assert np.ptp(np.concatenate([r.polygon_m for r in doubled.rooms])[:, 0]) == pytest.approx(
        2 * width, rel=0.02
    )


def test_walls_give_the_scale_where_nothing_else_does() -> None:
    errors = []
    for seed in range(12):
        image = canvas.draw_plan(random_plan(np.random.default_rng(seed)))
        solid = (image.rgb == 0).all(axis=2)
        measured = WALL_THICKNESS_M / wall_thickness_px(solid)
        errors.append(measured / image.frame.m_per_px - 1)
    assert np.median(np.abs(errors)) < 0.05
    assert np.max(np.abs(errors)) < 0.2


def test_a_picture_without_a_frame_lies_at_the_origin() -> None:
    image = canvas.draw_plan(two_rooms())
    decoded = decode_plan(image.rgb, image.frame.m_per_px)
    shift = np.array(image.frame.origin_m)
    for room in decode_plan(image).rooms:
        np.testing.assert_allclose(decoded.room(room.id).polygon_m, room.polygon_m - shift)


@pytest.mark.parametrize("value", [0, 255])
def test_a_blank_picture_is_no_plan(value: int) -> None:
    with pytest.raises(PlanError, match=r"no (closed room|wall)"):
        decode_plan(np.full((256, 256, 3), value, np.uint8))


def test_rooms_open_to_the_outside_are_not_closed() -> None:
    image = canvas.draw_plan(two_rooms(), shade=False)
    rgb = image.rgb.copy()
    rgb[120:123, :40] = 255
    decoded = decode_plan(PlanImage(rgb, image.frame))
    assert len(decoded.rooms) == 1
