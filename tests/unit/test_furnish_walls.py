"""Free spans along walls and free paths through rooms, against shapely."""

from __future__ import annotations

import random

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.scene.types import Room, frozen_array
from chord_usd.workshop.data.furnish.floor import Door, Floor
from chord_usd.workshop.data.furnish.walkways import _flooded, path_faults

L_SHAPE = [(0.0, 0.0), (5.0, 0.0), (5.0, 2.0), (2.5, 2.0), (2.5, 4.0), (0.0, 4.0)]
SLANTED = [(0.0, 0.0), (4.0, 0.5), (4.6, 3.5), (0.4, 3.0)]


def _floor(corners: list[tuple[float, float]], kind: str = "living") -> Floor:
    room = Room("r", kind, frozen_array(corners))  # type: ignore[arg-type]
    return Floor(room, room.kind, random.Random(0))


@settings(max_examples=60, deadline=None)
@given(
    corners=st.sampled_from([L_SHAPE, SLANTED]),
    wall=st.integers(0, 3),
    others=st.lists(
        st.tuples(st.integers(0, 3), st.floats(0.3, 3.0), st.floats(0.3, 1.0)), max_size=4
    ),
    depth=st.floats(0.1, 1.5),
    reach=st.floats(0.0, 0.8),
)
def test_what_stands_in_a_gap_meets_nothing(corners, wall, others, depth, reach) -> None:
    floor = _floor(corners)
    for index, s, size in others:
        floor.put("cabinet", floor.walls[index], s, (size, size, 1.0))
    outline = shapely.Polygon(corners).buffer(1e-6)
    standing = shapely.unary_union([_print(piece) for piece in floor.placed])
    frame = floor.walls[wall]
    for s_from, s_to in frame.gaps(depth, 1.0, reach, least=0.2):
        assert frame.fits(s_from, s_to, 0.0, depth)
        taken = [(s_from, 0), (s_to, 0), (s_to, depth + reach), (s_from, depth + reach)]
        area = shapely.Polygon([frame.world(s, t) for s, t in taken])
        assert outline.covers(area)
        assert area.intersection(standing).area < 1e-5


def _print(piece) -> shapely.Polygon:
    half = np.array([piece.ux, piece.uy]) * piece.size[0] / 2
    deep = np.array([-piece.uy, piece.ux]) * piece.size[1] / 2
    middle = np.array([piece.x, piece.y])
    return shapely.Polygon([middle - half + deep, middle - half - deep,
                            middle + half - deep, middle + half + deep])  # fmt: skip


def test_gaps_are_as_long_as_they_can_be() -> None:
    floor = _floor([(0.0, 0.0), (6.0, 0.0), (6.0, 3.0), (0.0, 3.0)])
    floor.put("cabinet", floor.walls[0], 2.0, (1.0, 0.5, 1.0))
    floor.put("cabinet", floor.walls[1], 0.25, (0.5, 0.6, 1.0))
    south, north = floor.walls[0].gaps(0.4, 1.0), floor.walls[2].gaps(2.6, 1.0)
    assert np.allclose(south, [(0.0, 1.5), (2.5, 5.4)])
    assert np.allclose(north, [(0.6, 3.5), (4.5, 6.0)])


def test_undo_gives_the_floor_back() -> None:
    floor = _floor(L_SHAPE)
    floor.put("cabinet", floor.walls[0], 1.0, (1.0, 0.5, 1.0), reach=0.5)
    before = [wall.gaps(0.5, 1.0) for wall in floor.walls]
    mark = floor.mark()
    floor.put("bed", floor.walls[4], 1.0, (1.5, 2.0, 1.0), reach=0.5)
    assert [wall.gaps(0.5, 1.0) for wall in floor.walls] != before
    floor.undo(mark)
    assert [wall.gaps(0.5, 1.0) for wall in floor.walls] == before


@pytest.mark.parametrize(("gap_m", "passes"), [(0.3, False), (0.45, False), (0.75, True)])
def test_a_way_past_furniture_needs_two_feet(gap_m: float, passes: bool) -> None:
    """A barrier across the room leaves a gap; the cabinet behind it is reached or not."""
    floor = _floor([(0.0, 0.0), (6.0, 0.0), (6.0, 3.0), (0.0, 3.0)])
    floor.put("cabinet", floor.walls[1], 0.6, (1.2, 0.5, 1.0))
    depth = 3.0 - gap_m
    floor.put("sofa", floor.walls[0], 3.0, (0.5, depth, 1.0))
    floor.doors.append(Door(floor.walls[3], 1.0, 1.9, True, None))
    assert (path_faults(floor) == 0) is passes


@given(st.integers(3, 14), st.integers(3, 14), st.data())
def test_flooding_reaches_what_connects(columns: int, rows: int, data: st.DataObject) -> None:
    """Checked against a flood that goes one step at a time, diagonal steps included."""
    stride = columns + 2
    cells = [y * stride + x for y in range(rows) for x in range(columns)]
    free = set(data.draw(st.lists(st.sampled_from(cells), min_size=1, unique=True)))
    start = data.draw(st.sampled_from(sorted(free)))
    reached, border = {start}, [start]
    while border:
        cell = border.pop()
        around = {cell + dx + dy for dx in (-1, 0, 1) for dy in (-stride, 0, stride)}
        fresh = (around & free) - reached
        reached |= fresh
        border += fresh
    standing = sum(1 << cell for cell in free)
    connected = sum(1 << cell for cell in reached)
    never = 0  # touches nothing, so that the flood runs to its end
    assert _flooded(standing, 1 << start, stride, columns, rows, [never]) == connected
    wanted = [1 << data.draw(st.sampled_from(cells)) for _ in range(2)]
    walked = _flooded(standing, 1 << start, stride, columns, rows, wanted)
    assert walked & connected == walked
    assert [bool(cell & walked) for cell in wanted] == [bool(cell & connected) for cell in wanted]
