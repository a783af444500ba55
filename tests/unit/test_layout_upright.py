"""Rooms with slanted walls are laid out upright and turned back."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.raster import canvas
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.types import Box, Item, LayoutImage, Plan, Provenance, Room
from chord_usd.line.layout.upright import (
    SAME_DEG,
    direction_of,
    rooms_by_direction,
    sample_upright,
    upright_sheet,
)

OBLONG = [(0.0, 0.0), (5.0, 0.0), (5.0, 3.5), (0.0, 3.5)]


def _room(corners, name: str = "r") -> Room:
    return Room(name, "bedroom", np.array(corners, float))


def _turned(room: Room, yaw_deg: float) -> Room:
    return posed(Plan((room,), ()), Pose(yaw_deg=yaw_deg)).rooms[0]


@given(st.floats(-44.0, 44.0))
def test_a_room_has_the_direction_that_it_was_turned_to(yaw_deg: float) -> None:
    found = direction_of(_turned(_room(OBLONG), yaw_deg))
    assert found == pytest.approx(yaw_deg if abs(yaw_deg) > SAME_DEG else 0.0, abs=1e-4)


def test_a_room_with_one_slanted_wall_stays_as_it_is() -> None:
    assert direction_of(_room([(0, 0), (5, 0), (5, 5.2), (1.4, 5.2)])) == 0.0


def test_a_round_room_stays_as_it_is() -> None:
    angles = np.radians(np.arange(7.5, 360.0, 15.0))
    assert direction_of(_room(np.stack([np.cos(angles), np.sin(angles)], axis=1) * 3)) == 0.0


def test_a_hexagon_stands_on_its_side() -> None:
    angles = np.radians(np.arange(0.0, 360.0, 60.0))
    assert direction_of(_room(np.stack([np.cos(angles), np.sin(angles)], axis=1) * 3)) == 0.0


def test_rooms_of_one_wing_go_together() -> None:
    wing = [_turned(_room(OBLONG, f"w{index}"), 30.0 + 0.4 * index) for index in range(3)]
    groups = rooms_by_direction([_room(OBLONG), *wing])
    assert [len(rooms) for rooms in groups.values()] == [1, 3]


class Furnishing:
    """A model that paints the same bed, upright, into the middle of every sheet."""

    def sample_batch(self, images, *, seeds, steps=None, sampler=None, drafts=(), progress=None):
        layouts = []
        for image in images:
            middle_m = image.frame.m_per_px * image.frame.height_px / 2
            x, y = np.array(image.frame.origin_m) + middle_m
            bed = Item("bed_1", "bed", Box((x, y, 0.0), (1.8, 2.1, 0.9), 90.0), "r")
            drawn = canvas.layout_image(image, [bed])
            layouts.append(replace(drawn, provenance=Provenance(seed=seeds[0])))
        return layouts


@settings(deadline=None, max_examples=20)
@given(st.floats(5.0, 40.0))
def test_what_is_painted_upright_lies_along_the_slanted_walls(yaw_deg: float) -> None:
    room = _turned(_room(OBLONG), yaw_deg)
    plan = Plan((room,), ())
    image = canvas.draw_plan(plan, canvas.house_frame(plan))
    layout = sample_upright(Furnishing(), plan, image, seed=5)
    assert layout.frame == image.frame
    assert layout.provenance.seed == 5
    centre = room.polygon_m.mean(axis=0)
    bed = Item("bed_1", "bed", Box((*centre, 0.0), (1.8, 2.1, 0.9), 90.0 + yaw_deg), "r")
    wanted = canvas.layout_image(image, [bed]).rgb
    floor = canvas.room_pixels(room, image.frame)
    assert np.array_equal(layout.rgb[~floor], image.rgb[~floor])
    beds = [(one != image.rgb).any(axis=2) for one in (layout.rgb, wanted)]
    assert (beds[0] & beds[1]).sum() > 0.97 * (beds[0] | beds[1]).sum()


def test_an_upright_house_is_sampled_as_ever() -> None:
    plan = Plan((_room(OBLONG),), ())
    image = canvas.draw_plan(plan, canvas.house_frame(plan))
    direct = Furnishing().sample_batch([image], seeds=[1])[0]
    assert np.array_equal(sample_upright(Furnishing(), plan, image, seed=1).rgb, direct.rgb)


def test_what_stood_in_a_region_is_gone() -> None:
    room = _turned(_room(OBLONG), 20.0)
    plan = Plan((room,), ())
    image = canvas.draw_plan(plan, canvas.house_frame(plan))
    centre = room.polygon_m.mean(axis=0)
    old = Item("sofa_1", "sofa", Box((*centre, 0.0), (2.0, 0.9, 0.8), 20.0), "r")
    before: LayoutImage = canvas.layout_image(image, [old])
    sheet = upright_sheet(plan, plan.rooms, direction_of(room), image)
    region = canvas.room_pixels(room, image.frame)
    after = sheet.turned_back(sheet.image.rgb, before.rgb, image, region)
    assert np.array_equal(after, image.rgb)
