"""Every room is entered, by the likeliest door if none is seen; scraps are no rooms."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from shapely.geometry import Point, Polygon
from true_segments import segments_of

from chord_usd.base.raster.page_labels import DOOR, FLOOR, OUTSIDE, PASSAGE, WALL, WINDOW
from chord_usd.base.scene.types import Box, Opening, OpeningKind, Plan, Room, RoomKind, frozen_array
from chord_usd.line.plan.doubts import NamedRooms, doubts
from chord_usd.line.plan.openings import GUESSED
from chord_usd.line.plan.seen import SeenReading, read_seen
from chord_usd.line.plan.segment import Segments
from chord_usd.line.plan.verdict import symptoms_of
from chord_usd.line.plan.ways_in import (
    with_rooms_shut,
    with_ways_in,
    without_doors_onto_baths,
    without_scraps,
)

M_PER_PX = 0.02
PLACE = (slice(258, 272), slice(100, 140))
"""Of a door between the two rooms."""


def two_rooms() -> np.ndarray:
    """Two rooms of 8 x 4 and 8 x 3 m, one above the other, and a front door into the upper one."""
    labels = np.full((480, 520), OUTSIDE, np.uint8)
    labels[50:430, 50:470] = WALL
    labels[60:260, 60:460] = FLOOR
    labels[270:420, 60:460] = FLOOR
    labels[50:60, 100:145] = DOOR
    return labels


def faint(label: int, chance: float) -> SeenReading:
    """Of a page on which a network sees faintly what is at PLACE."""
    seen = segments_of(two_rooms())
    built = seen.built.copy()
    built[label][PLACE] += chance
    built[WALL][PLACE] -= chance
    return read_seen(Segments(built.astype(np.float32), seen.kinds), M_PER_PX)


def test_a_small_room_that_is_read_first_needs_a_way_in() -> None:
    """A bathroom above the only other room had none."""
    seen = faint(DOOR, 0.3).segments
    built, kinds = (np.ascontiguousarray(planes[:, ::-1]) for planes in (seen.built, seen.kinds))
    turned = with_ways_in(read_seen(Segments(built, kinds), M_PER_PX), M_PER_PX)
    assert [o.is_guess for o in turned.openings if len(o.rooms) == 2] == [True]


@pytest.mark.parametrize("label", [DOOR, PASSAGE])
def test_a_room_without_a_way_in_gets_the_likeliest_door(label: int) -> None:
    """It was furnished, and nobody could enter it."""
    seen = faint(label, 0.3)
    assert not [o for o in seen.openings if len(o.rooms) == 2]
    (door,) = [o for o in with_ways_in(seen, M_PER_PX).openings if len(o.rooms) == 2]
    assert door.is_guess
    assert door.kind == "door"
    assert door.center_px == pytest.approx([120, 265], abs=5)


def test_no_door_is_made_where_nothing_speaks_for_one() -> None:
    seen = read_seen(segments_of(two_rooms()), M_PER_PX)
    assert with_ways_in(seen, M_PER_PX).openings == seen.openings


def test_a_room_with_a_way_in_stays_as_it_is() -> None:
    labels = two_rooms()
    labels[PLACE] = DOOR
    seen = read_seen(segments_of(labels), M_PER_PX)
    assert with_ways_in(seen, M_PER_PX).openings == seen.openings


def test_niches_need_no_way_in() -> None:
    """A door into the shower stood before the toilet."""
    seen = faint(DOOR, 0.3)
    assert with_ways_in(seen, M_PER_PX / 8).openings == seen.openings


def test_the_window_of_a_room_that_no_door_leads_to_is_a_glazed_door() -> None:
    labels = two_rooms()
    labels[260:270, 200:320] = WINDOW
    seen = with_ways_in(read_seen(segments_of(labels), M_PER_PX), M_PER_PX)
    assert [o.kind for o in seen.openings if len(o.rooms) == 2] == ["door"]


def test_a_guessed_door_stands_clear_of_what_is_drawn() -> None:
    """It opened onto the bath, where the wall beside was as thin."""
    built = faint(DOOR, 0.3).segments.built.copy()
    built[:, PLACE[0], 260:300] = built[:, PLACE[0], PLACE[1]]
    seen = read_seen(Segments(built, segments_of(two_rooms()).kinds), M_PER_PX)
    for left in (95, 255):
        bath = shapely.box(left, 272, left + 50, 350)
        (door,) = [o for o in with_ways_in(seen, M_PER_PX, [bath]).openings if o.is_guess]
        assert door.center_px == pytest.approx([375 - left, 265], abs=25)
        assert not bath.buffer(20).contains(Point(door.center_px))


def test_an_outer_door_leads_onto_the_floor_that_its_swing_cut() -> None:
    """The living room was cut off from the hall."""
    labels = two_rooms()
    labels[270:300, 100:200] = OUTSIDE
    labels[270:300, 90:100] = labels[270:300, 200:210] = labels[300:308, 90:210] = WALL
    labels[260:270, 120:160] = DOOR
    seen = read_seen(segments_of(labels), M_PER_PX)
    assert sorted(len(o.rooms) for o in seen.openings if o.kind == "door") == [1, 1]
    made = with_ways_in(seen, M_PER_PX)
    (door,) = [o for o in made.openings if o.is_guess]
    assert len(door.rooms) == 2
    below = Polygon(made.polygons_px[door.rooms[1][0]])
    assert below.is_valid
    assert below.distance(Point(door.center_px)) <= door.depth_px / 2 + 1
    assert below.area == pytest.approx(Polygon(seen.polygons_px[door.rooms[1][0]]).area, rel=0.03)


def test_no_door_leads_onto_a_bath() -> None:
    """The rim of a shower tray was a door into the bedroom."""
    labels = two_rooms()
    labels[PLACE] = DOOR
    seen = read_seen(segments_of(labels), M_PER_PX)
    for top, left in ((275, 1), (330, 2)):
        tray = shapely.box(90, top, 140, top + 50)
        kept = without_doors_onto_baths(seen, M_PER_PX, [tray]).openings
        assert sum(o.kind == "door" for o in kept) == left


@pytest.mark.parametrize(("deep_px", "count"), [(18, 1), (34, 0)], ids=["passage", "wardrobes"])
def test_a_hole_as_deep_as_wardrobes_is_no_passage(deep_px: int, count: int) -> None:
    """Two bedrooms were one through the wardrobes between them."""
    labels = two_rooms()
    labels[270 : 260 + deep_px, 60:460] = WALL
    labels[260 : 260 + deep_px, 100:200] = FLOOR
    labels[262:266, 100:200] = labels[260 + deep_px - 6 : 260 + deep_px - 2, 100:200] = WALL
    seen = read_seen(segments_of(labels), M_PER_PX)
    assert sum(len(o.rooms) == 2 for o in seen.openings) == count


def test_guessed_doors_change_no_verdict() -> None:
    rooms = tuple(
        Room(f"r{x}", "living", frozen_array([(x, 0), (x + 3, 0), (x + 3, 3), (x, 3)]))
        for x in (0.0, 3.2)
    )
    box = Box((3.1, 1.5, 0.0), (0.8, 0.2, 2.1), 90.0)
    door = Opening("door1", "door", box, ("r0.0", "r3.2"), {GUESSED: True, "confidence": 0.1})
    shut, open_ = Plan(rooms, ()), Plan(rooms, (door,))
    assert symptoms_of(shut) == symptoms_of(open_)
    seen = faint(DOOR, 0.3)
    frame = seen.frame
    told = doubts(open_, seen.regions, NamedRooms((), ()), frame)
    assert any("may be missing: door1 " in one for one in told)


@pytest.mark.parametrize(
    ("label", "is_named", "rooms"),
    [(WALL, False, 1), (WALL, True, 2), (DOOR, False, 2)],
    ids=["neighbour", "named", "with a door"],
)
def test_floors_at_the_edge_of_the_picture_are_of_neighbours(
    label: int, is_named: bool, rooms: int
) -> None:
    """They became corridors and stores."""
    labels = np.full((300, 520), OUTSIDE, np.uint8)
    labels[50:260, 0:470] = WALL
    labels[60:250, 70:460] = FLOOR
    labels[60:250, 0:60] = FLOOR
    labels[100:140, 60:70] = label
    seen = read_seen(segments_of(labels), M_PER_PX)
    assert len(seen.outlines) == 2
    at_edge = [polygon[:, 0].min() < 5 for polygon in seen.polygons_px]
    left, told = without_scraps(seen, [is_named and one for one in at_edge])
    assert len(left.outlines) == rooms
    assert len(told) == 2 - rooms


def opening(name: str, kind: OpeningKind, sure: float, *rooms: str) -> Opening:
    box = Box((3.1, 1.5, 0.0), (0.8, 0.2, 2.1), 90.0)
    return Opening(name, kind, box, rooms, {"confidence": sure})


@pytest.mark.parametrize(
    ("room", "sure", "has_door", "kind"),
    [
        ("bathroom", 0.3, True, None),
        ("bedroom", 0.3, True, None),
        ("unknown", 0.3, False, "door"),
        ("bathroom", 0.3, False, "door"),
        ("bathroom", 0.8, True, "passage"),
        ("dining", 0.3, True, "passage"),
    ],
)
def test_bedrooms_and_wet_rooms_are_shut(
    room: RoomKind, sure: float, has_door: bool, kind: str | None
) -> None:
    """A bathroom lay open to the living room where a niche looked like a passage."""
    corners = frozen_array([(0, 0), (3, 0), (3, 3), (0, 3)])
    rooms = [Room("a", "corridor", corners), Room("b", room, corners)]
    seen = [opening("p", "passage", sure, "a", "b"), opening("front", "door", 0.9, "a")]
    seen += [opening("d", "door", 0.3, "a", "b")] if has_door else []
    kept = with_rooms_shut(seen, rooms)
    assert len(kept) == len(seen) - (kind is None)
    assert len({one.id for one in kept}) == len(kept)
    if kind is not None:
        assert kept[0 if kind == "passage" else -1].kind == kind
