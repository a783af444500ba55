"""Rasters larger than the detectors look at."""

import cv2
import numpy as np
import pytest

from chord_usd.base.scene.types import CANVAS_PX, Detection, LayoutImage, PixelFrame, Plan, Room
from chord_usd.base.scene.units import m_from_px
from chord_usd.line.graph.detect import RoomProposal
from chord_usd.line.graph.extract import HALO_PX, detect_in_tiles, name_in_tiles, tiles_of


def _blobs(rgb):
    """A detector of black rectangles, which are wrong where a tile cuts them."""
    dark = (rgb == 0).all(axis=2).astype(np.uint8)
    _, _, stats, _ = cv2.connectedComponentsWithStats(dark)
    found = []
    for left, top, width, height, _ in stats[1:]:
        right, low = left + width, top + height
        corners = np.array([(left, top), (left, low), (right, low), (right, top)], float)
        found.append(Detection("bed", corners, 1.0))
    return found


@pytest.mark.parametrize("side", [256, 288, 416, 704, 1024])
def test_every_piece_is_seen_once_and_whole(side: int) -> None:
    rng = np.random.default_rng(side)
    rgb = np.full((side, side, 3), 255, np.uint8)
    wanted = set()
    for top in range(4, side - 70, 75):
        for left in range(4, side - 70, 75):
            width, height = rng.integers(3, 2 * HALO_PX * 0.7, 2)
            rgb[top : top + height, left : left + width] = 0
            wanted.add((left, top, left + width, top + height))
    found = detect_in_tiles(_blobs, rgb)
    boxes = [(*one.corners_px.min(axis=0), *one.corners_px.max(axis=0)) for one in found]
    assert len(boxes) == len(wanted)
    assert {tuple(int(edge) for edge in box) for box in boxes} == wanted


def test_a_raster_of_the_usual_size_is_one_tile_even_if_empty() -> None:
    rgb = np.full((CANVAS_PX, CANVAS_PX, 3), 255, np.uint8)
    (tile,) = tiles_of(rgb)
    assert np.array_equal(tile.rgb, rgb)


def test_empty_tiles_are_passed_over() -> None:
    rgb = np.full((1024, 1024, 3), 255, np.uint8)
    rgb[100:200, 100:200] = 0
    assert len(list(tiles_of(rgb))) < 6


def test_rooms_are_named_where_they_lie() -> None:
    side = 704
    frame = PixelFrame(0.07, (3.0, -5.0), side)
    rgb = np.full((side, side, 3), 255, np.uint8)
    rooms, kinds = [], {}
    for index, (x, y) in enumerate([(40, 40), (300, 200), (600, 600), (40, 560)]):
        corners = np.array([(x, y), (x + 60, y), (x + 60, y - 30), (x, y - 30)], float)
        rooms.append(Room(f"r{index}", "unknown", m_from_px(corners[::-1], frame)))
        kinds[f"r{index}"] = "bedroom" if index % 2 else "kitchen"
        rgb[y - 30 : y, x : x + 60] = 10 if index % 2 else 20

    def segment(tile):
        return [
            RoomProposal(kind, 1.0, (tile == level).all(axis=2))
            for kind, level in (("bedroom", 10), ("kitchen", 20))
        ]

    plan = name_in_tiles(segment, Plan(tuple(rooms), ()), LayoutImage(rgb, frame))
    assert {room.id: room.kind for room in plan.rooms} == kinds
