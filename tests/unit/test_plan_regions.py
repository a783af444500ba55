"""From what is seen on a page to rooms and openings: exact where the seeing is."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from shapely.geometry import Polygon
from true_segments import TrueReader, segments_of

from chord_usd.base.raster.page_labels import DOOR, FLOOR, OUTSIDE, PASSAGE, STAIRS, WALL, WINDOW
from chord_usd.base.scene.stair_spirals import is_round
from chord_usd.base.scene.types import ByteArray
from chord_usd.line.plan.drawing import Known, read_drawing
from chord_usd.line.plan.placement import WARNINGS, frame_of, straightening_of
from chord_usd.line.plan.regions import find_regions, room_outlines, stair_outlines
from chord_usd.line.plan.segment import Segments
from chord_usd.line.plan.sheet import straightening_matrix
from chord_usd.line.plan.text import Text
from chord_usd.line.plan.wall_openings import find_openings
from chord_usd.workshop.data.drawn.crowded import draw_page
from chord_usd.workshop.data.drawn.page_looks import Look
from chord_usd.workshop.data.drawn.truth import CrowdedPage
from chord_usd.workshop.evaluation.plans import Reader, crowded_case, score_reading
from tests.every import later

UPRIGHT = Look("agent", names=0.0, sizes=0.0, chains=0.0, furniture_of_page=0.0, surroundings=0.0)
NOWHERE = Known((Text("x", np.zeros((4, 2)), 1.0),))
"""So that nothing is read by OCR, which other tests are about."""


@pytest.mark.parametrize("seeds", [[0, 2, 4, 8], *later([0, 1, 2, 3, 4, 5, 7, 8])])
def test_what_is_seen_right_is_read_right(seeds: list[int]) -> None:
    scores = []
    for seed in seeds:
        page = draw_page(seed, UPRIGHT)
        case = crowded_case(page)
        scores.append(score_reading(case, _reader_of(page, case.frame.m_per_px)))
    assert not any(score.refused for score in scores)
    assert min(score.walls for score in scores) > 0.95
    assert min(score.room_iou for score in scores) > 0.93
    assert np.median([score.openings for score in scores]) > 0.9
    assert all(score.kinds_right == score.kinds for score in scores)


def _reader_of(page: CrowdedPage, m_per_px: float) -> Reader:
    return Reader(
        lambda rgb: read_drawing(rgb, m_per_px, known=NOWHERE, reader=TrueReader(page)),
        frame_of,
        lambda plan, shape: straightening_matrix(straightening_of(plan), shape)[0],
    )


def two_rooms() -> ByteArray:
    """A wall of 10 px round two rooms, a door of 40 px between them, an entrance, a window."""
    labels = np.full((320, 520), OUTSIDE, np.uint8)
    labels[50:270, 50:470] = WALL
    labels[60:260, 60:250] = FLOOR
    labels[60:260, 260:460] = FLOOR
    labels[100:140, 250:260] = DOOR
    labels[260:270, 100:140] = DOOR
    labels[50:60, 300:380] = WINDOW
    return labels


def seen(labels: ByteArray) -> tuple[int, list[str]]:
    """How many rooms there are, and what opens."""
    segments = segments_of(labels)
    regions = find_regions(segments)
    polygons = [room.polygon_px for room in room_outlines(regions, segments, 0.02)]
    openings = find_openings(polygons, segments, regions.thickness_px)
    return len(polygons), sorted(opening.kind for opening in openings)


def test_two_rooms_and_what_opens() -> None:
    assert seen(two_rooms()) == (2, ["door", "door", "window"])


@pytest.mark.parametrize("hole_px", [3, 8, 11])
def test_a_hole_in_a_wall_that_nobody_fits_through_joins_no_rooms(hole_px: int) -> None:
    labels = two_rooms()
    labels[200 : 200 + hole_px, 250:260] = FLOOR
    assert seen(labels) == (2, ["door", "door", "window"])


@pytest.mark.parametrize(("seen_share", "windows"), [(0.9, 2), (0.3, 2), (0.05, 1)])
def test_windows_side_by_side_are_two_where_a_post_is_seen(seen_share: float, windows: int) -> None:
    segments = segments_of(two_rooms())
    built = segments.built.copy()
    built[WINDOW, 50:60, 337:340] -= seen_share
    built[WALL, 50:60, 337:340] += seen_share
    found = find_regions(segments)
    polygons = [room.polygon_px for room in room_outlines(found, segments, 0.02)]
    kinds = [
        one.kind
        for one in find_openings(polygons, Segments(built, segments.kinds), found.thickness_px)
    ]
    assert kinds.count("window") == windows


def test_rooms_without_a_wall_between_them_are_one() -> None:
    labels = two_rooms()
    labels[160:260, 250:260] = FLOOR
    assert seen(labels)[0] == 1


@pytest.mark.parametrize(("seen_from", "rooms"), [(170, 2), (60, 1)])
def test_outside_that_leaks_into_a_room_is_its_floor(seen_from: int, rooms: int) -> None:
    """A rug looked like a terrace: the bedroom lost its middle. A yard stays one."""
    labels = two_rooms()
    labels[60:260, seen_from:250] = OUTSIDE
    labels[50:60, 180:230] = OUTSIDE
    segments = segments_of(labels)
    found = room_outlines(find_regions(segments), segments, 0.02)
    assert len(found) == rooms
    if rooms == 2:
        whole = Polygon([(60, 60), (250, 60), (250, 260), (60, 260)])
        left = min((Polygon(room.polygon_px) for room in found), key=lambda one: one.centroid.x)
        assert left.intersection(whole).area > 0.95 * left.union(whole).area


def test_a_torn_rim_has_no_more_corners_than_a_room() -> None:
    """Hair lines and what is drawn at them tear the rim of a room in the eyes of the network."""
    rng, labels = np.random.default_rng(3), two_rooms()
    for y in range(66, 250, 9):
        reach = int(rng.integers(1, 9))
        labels[y : y + 5, 60 : 60 + reach] = WALL
    for x in range(66, 240, 11):
        labels[60 : 60 + int(rng.integers(1, 9)), x : x + 6] = WALL
    segments = segments_of(labels)
    rooms = room_outlines(find_regions(segments), segments, 0.024)
    assert max(len(room.polygon_px) for room in rooms) <= 14
    torn = min((Polygon(room.polygon_px) for room in rooms), key=lambda one: one.centroid.x)
    whole = Polygon([(60, 60), (250, 60), (250, 260), (60, 260)])
    assert torn.intersection(whole).area > 0.95 * torn.union(whole).area


def test_specks_are_no_openings_and_belong_to_what_is_beside_them() -> None:
    labels = two_rooms()
    labels[220:225, 250:260] = WINDOW
    labels[118:122, 250:260] = PASSAGE
    assert seen(labels) == (2, ["door", "door", "window"])


def test_stairs_are_floor_of_the_room_that_they_stand_in() -> None:
    labels = two_rooms()
    labels[60:160, 60:120] = STAIRS
    assert seen(labels)[0] == 2


def test_stairs_seen_round_are_a_circle_and_others_a_rectangle() -> None:
    labels = np.zeros((200, 400), np.uint8)
    cv2.circle(labels, (100, 100), 50, (float(STAIRS),), cv2.FILLED)
    labels[60:140, 250:350] = STAIRS
    rectangle, circle = sorted(stair_outlines(segments_of(labels), 0.02), key=len)
    assert len(rectangle) == 4
    assert is_round(Polygon(circle))
    assert Polygon(circle).area == pytest.approx(np.pi * 50**2, rel=0.03)
    assert np.allclose(Polygon(circle).centroid.coords[0], (100.5, 100.5), atol=1.1)


def test_the_well_of_a_staircase_is_no_room() -> None:
    labels = two_rooms()
    labels[110:210, 110:210] = WALL
    labels[115:205, 115:205] = FLOOR
    assert seen(labels)[0] == 2


def test_nothing_built_is_nothing() -> None:
    assert seen(np.zeros((64, 64), np.uint8)) == (0, [])


def test_storeys_side_by_side_are_two_plans() -> None:
    one = two_rooms()
    labels = np.concatenate([one, one[:, :-150]], axis=1)
    labels[labels.shape[0] - 3 :] = OUTSIDE
    page = replace(draw_page(1, UPRIGHT), labels=labels, storeys=())
    rgb = np.full((*labels.shape, 3), 255, np.uint8)
    plan = read_drawing(rgb, 0.02, known=NOWHERE, reader=TrueReader(page))
    assert len(plan.rooms) == 2
    assert any("2 plans" in told for told in plan.extra[WARNINGS])
