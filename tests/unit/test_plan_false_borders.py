"""Floors that furniture cuts become whole; rooms that walls part do not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from true_segments import segments_of

from chord_usd.base.raster.page_labels import DOOR, FLOOR, OUTSIDE, PASSAGE, WALL
from chord_usd.base.scene.types import Box, ByteArray, Item
from chord_usd.base.scene.units import m_from_px
from chord_usd.line.plan.false_borders import without_false_borders, without_pieces
from chord_usd.line.plan.seen import SeenReading, read_seen
from chord_usd.line.plan.segment import Segments

M_PER_PX = 0.02


def two_floors(between: int) -> ByteArray:
    """A room of 8 x 4 m, and in its corner a floor of 1.6 x 1.6 m behind a border of 0.2 m; a wall
    with a door below both, and a third room."""
    labels = np.full((480, 520), OUTSIDE, np.uint8)
    labels[50:430, 50:470] = WALL
    labels[60:260, 60:460] = FLOOR
    labels[270:420, 60:460] = FLOOR
    labels[260:270, 100:140] = DOOR
    labels[60:150, 370:460] = between
    labels[60:140, 380:460] = FLOOR
    return labels


def reading(labels: ByteArray, sure: float) -> SeenReading:
    """What a network reads that is so sure, and else takes what it sees for bare paper."""
    seen = segments_of(labels)
    built = sure * seen.built
    built[OUTSIDE] += 1 - sure
    return read_seen(Segments(built.astype(np.float32), seen.kinds), M_PER_PX)


@pytest.mark.parametrize(
    ("between", "sure", "is_named", "rooms"),
    [
        (PASSAGE, 0.6, False, 2),
        (PASSAGE, 0.6, True, 3),  # an alcove with a name
        (PASSAGE, 0.9, False, 3),  # what is surely a passage
        (WALL, 0.6, False, 3),
        (DOOR, 0.6, False, 3),
    ],
)
def test_what_no_wall_parts_is_one_floor(between, sure, is_named, rooms):
    seen = reading(two_floors(between), sure)
    assert len(seen.outlines) == 3
    whole = without_false_borders(seen, [is_named] * 3)
    assert len(whole.outlines) == rooms
    assert whole.joined == 3 - rooms
    if rooms == 2:
        largest = max(whole.polygons_px, key=lambda polygon: np.ptp(polygon[:, 0]))
        assert np.ptp(largest, axis=0).tolist() == pytest.approx([400, 200], abs=4)


def drawn(category: str, size_px: tuple[int, int], seen: SeenReading) -> Item:
    """A piece in the middle of the small floor."""
    x, y = m_from_px(np.array([[420.0, 100.0]]), seen.frame)[0].tolist()
    length, depth = (side * M_PER_PX for side in size_px)
    return Item("", category, Box((x, y, 0.0), (length, depth, 0.8), 0.0))


@pytest.mark.parametrize(
    ("category", "size_px", "between", "rooms"),
    [
        ("sofa", (80, 70), WALL, 2),  # its outline was taken for a wall
        ("sofa", (80, 30), WALL, 3),  # stands in a small room
        ("sofa", (160, 100), WALL, 3),  # larger than that floor: misread
        ("sofa", (80, 70), DOOR, 3),
        ("cabinet", (80, 80), WALL, 3),  # a closet
        ("bathtub", (80, 60), PASSAGE, 2),
        ("shower", (80, 80), WALL, 3),  # a shower room
    ],
)
def test_a_floor_that_a_piece_covers_is_no_room(category, size_px, between, rooms):
    seen = reading(two_floors(between), 0.9)
    piece = drawn(category, size_px, seen)
    assert len(without_pieces(seen, [False] * 3, [piece], seen.frame).outlines) == rooms
    assert without_pieces(seen, [True] * 3, [piece], seen.frame) is seen


def test_a_niche_is_of_the_bathroom_that_its_toilet_tells() -> None:
    """A bath with two fifths of its rim seen as wall was a bathroom by itself."""
    labels = two_floors(WALL)
    labels[140:150, 380:408] = PASSAGE
    seen = reading(labels, 0.9)
    tub = drawn("bathtub", (80, 60), seen)
    assert without_pieces(seen, [False] * 3, [tub], seen.frame) is seen
    x, y = m_from_px(np.array([[200.0, 200.0]]), seen.frame)[0].tolist()
    toilet = Item("", "toilet", Box((x, y, 0.0), (0.4, 0.6, 0.8), 0.0))
    assert len(without_pieces(seen, [False] * 3, [tub, toilet], seen.frame).outlines) == 2


@pytest.mark.parametrize(("width_px", "rooms"), [(32, 2), (80, 3)], ids=["worktop", "kitchen"])
def test_a_floor_as_narrow_as_a_worktop_with_a_sink_is_one(width_px: int, rooms: int) -> None:
    """The counter of a kitchen was a toilet."""
    labels = two_floors(WALL)
    labels[60 : 140 - width_px, 380:460] = WALL
    seen = reading(labels, 0.9)
    sink = drawn("sink_cabinet", (30, 20), seen)
    y = sink.box.center_m[1] - (40 - width_px / 2) * M_PER_PX
    sink = replace(sink, box=replace(sink.box, center_m=(sink.box.center_m[0], y, 0.0)))
    assert len(without_pieces(seen, [False] * 3, [sink], seen.frame).outlines) == rooms
