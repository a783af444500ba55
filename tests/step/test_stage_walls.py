"""The walls of any house: one solid, closed, with real holes, every face somebody's."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import shapely

from chord_usd.base.scene.types import Box, Opening, Plan, Room
from chord_usd.line.stage.shell.mesh import Face, mesh_of
from chord_usd.line.stage.shell.opening_parts import lining_faces, sill_faces
from chord_usd.line.stage.shell.walls import (
    ROOM_HEIGHT_M,
    Walls,
    build_walls,
    top_faces,
    wall_faces,
)
from chord_usd.workshop.data.houses import random_plan
from tests.every import for_every


def rectangle(room_id: str, x0: float, y0: float, x1: float, y1: float) -> Room:
    return Room(room_id, "bedroom", np.array([(x0, y0), (x1, y0), (x1, y1), (x0, y1)], float))


def door(at_m: tuple[float, float], yaw_deg: float, kind: str = "door") -> Opening:
    return Opening("door", kind, Box((*at_m, 0.0), (0.9, 0.24, 2.05), yaw_deg))


def upright_faces(walls: Walls) -> list[Face]:
    return wall_faces(walls.lines)


def all_faces(walls: Walls) -> list[Face]:
    faces = upright_faces(walls) + top_faces(walls)
    for tunnel in walls.cuts():
        faces += lining_faces(tunnel) + sill_faces(tunnel)
    return faces


def enclosed_m3(faces: list[Face]) -> float:
    """Volume inside faces that look outwards, by Gauss's theorem; the open bottom is at z = 0."""
    volume = 0.0
    for face in faces:
        first, *others = face.corners_m
        for second, third in pairwise(others):
            volume += float(first @ np.cross(second, third)) / 6.0
    return volume


def crossings(faces: list[Face], start: np.ndarray, end: np.ndarray) -> int:
    """How many faces the segment from start to end passes through."""
    count = 0
    for face in faces:
        first, *others = face.corners_m
        for second, third in pairwise(others):
            system = np.column_stack([second - first, third - first, start - end])
            if abs(np.linalg.det(system)) > 1e-12:
                u, v, t = np.linalg.solve(system, start - first)
                count += bool(u >= 0 and v >= 0 and u + v <= 1 and 0 <= t <= 1)
    return count


@for_every("seed", range(20))
def test_faces_enclose_the_walls_less_their_holes_exactly_once(seed: int) -> None:
    walls = build_walls(random_plan(np.random.default_rng(seed)))
    holes = sum(t.area_m.area * (t.high_m - t.low_m) for t in walls.cuts())
    expected = walls.solid_m.area * ROOM_HEIGHT_M - holes
    assert enclosed_m3(all_faces(walls)) == pytest.approx(expected, abs=2e-3)


@for_every("seed", range(20))
def test_every_face_looks_out_of_the_wall_into_the_space_that_owns_it(seed: int) -> None:
    walls = build_walls(random_plan(np.random.default_rng(seed)))
    for line in walls.lines:
        along = (line.end_m - line.start_m) / np.hypot(*(line.end_m - line.start_m))
        ahead = (line.start_m + line.end_m) / 2 + 0.004 * np.array([along[1], -along[0]])
        assert not walls.solid_m.contains(shapely.Point(ahead))
        owners = [i for i, floor in enumerate(walls.floors_m) if shapely.contains_xy(floor, *ahead)]
        assert owners == ([] if line.room is None else [line.room])


@for_every("seed", range(20))
def test_the_facade_has_no_corner_in_the_middle_of_an_edge(seed: int) -> None:
    """Such corners open hairline cracks, and other programs call the mesh non-manifold."""
    walls = build_walls(random_plan(np.random.default_rng(seed)))
    mesh = mesh_of(wall_faces([line for line in walls.lines if line.room is None]))
    points = mesh.points_m
    corners = mesh.indices.reshape(-1, 4)
    for first, second in zip(corners.T, np.roll(corners, -1, axis=1).T, strict=True):
        a, b = points[first][:, None], points[second][:, None]
        along = np.sum((points - a) * (b - a), axis=2) / np.sum((b - a) ** 2, axis=2)
        off = np.linalg.norm(a + along[..., None] * (b - a) - points, axis=2)
        assert not np.any((off < 1e-6) & (along > 1e-6) & (along < 1 - 1e-6))


@for_every("seed", range(30))
def test_the_tops_of_the_walls_hang_together_at_their_corners(seed: int) -> None:
    """No corner lies in the middle of an edge of another triangle."""
    mesh = mesh_of(top_faces(build_walls(random_plan(np.random.default_rng(seed)))))
    points, corners = mesh.points_m[:, :2], mesh.indices.reshape(-1, 3)
    for first, second in zip(corners.T, np.roll(corners, -1, axis=1).T, strict=True):
        a, b = points[first][:, None], points[second][:, None]
        along = np.sum((points - a) * (b - a), axis=2) / np.sum((b - a) ** 2, axis=2)
        off = np.linalg.norm(a + along[..., None] * (b - a) - points, axis=2)
        assert not np.any((off < 1e-6) & (along > 1e-4) & (along < 1 - 1e-4))


@for_every("seed", range(10))
def test_doors_windows_and_passages_are_real_holes(seed: int) -> None:
    plan = random_plan(np.random.default_rng(seed), rooms=6)
    walls = build_walls(plan)
    faces = all_faces(walls)
    cut = [opening for opening in plan.openings if opening.id in walls.tunnels]
    assert cut
    for opening in cut:
        tunnel = walls.tunnels[opening.id]
        across = np.deg2rad(opening.box.yaw_deg + 90.0)
        reach = 0.2 * np.array([np.cos(across), np.sin(across), 0.0])
        middle = np.array([*tunnel.area_m.centroid.coords[0], (tunnel.low_m + tunnel.high_m) / 2])
        assert crossings(faces, middle - reach, middle + reach) == 0
        lintel = np.array([*middle[:2], (tunnel.high_m + ROOM_HEIGHT_M) / 2 + 1e-4])
        assert crossings(faces, lintel - reach, lintel + reach) == 2


def test_a_shared_wall_is_one_solid_with_two_faces() -> None:
    walls = build_walls(
        Plan((rectangle("a", 0, 0, 3, 3), rectangle("b", 3.24, 0, 6, 3)), (door((3.12, 1.5), 90),))
    )
    shared = [line for line in walls.lines if np.isclose(line.start_m[0], line.end_m[0])]
    inner = {float(line.start_m[0]): line.room for line in shared if line.room is not None}
    assert inner == {0.0: 0, 3.0: 0, 3.24: 1, 6.0: 1}
    assert len(walls.solid_m.geoms) == 1
    assert walls.tunnels["door"].area_m.equals(shapely.box(3.0, 1.05, 3.24, 1.95))


def test_rooms_that_touch_have_no_wall_between_them() -> None:
    rooms = (rectangle("a", 0, 0, 3, 3), rectangle("b", 3, 0, 6, 3))
    walls = build_walls(Plan(rooms, (door((3.0, 1.5), 90, "passage"),)))
    assert "door" not in walls.tunnels
    assert not walls.solid_m.intersects(shapely.box(0.01, 0.01, 5.99, 2.99))
    assert {(line.room, line.edge) for line in walls.lines if line.room is not None} == {
        (0, 0), (0, 2), (0, 3), (1, 0), (1, 1), (1, 2),
    }  # fmt: skip


def test_a_door_in_a_slanted_wall_goes_straight_through() -> None:
    slanted = Room("a", "bedroom", np.array([(0, 0), (4, 0), (4, 3), (2, 4), (0, 4)], float))
    yaw_deg = float(np.degrees(np.arctan2(-1.0, 2.0)))
    outwards = np.array([1.0, 2.0]) / np.sqrt(5.0)
    middle = np.array([3.0, 3.5]) + 0.12 * outwards
    walls = build_walls(Plan((slanted,), (door((middle[0], middle[1]), yaw_deg),)))
    tunnel = walls.tunnels["door"]
    assert sum(tunnel.is_end) == 2
    assert tunnel.area_m.area == pytest.approx(0.9 * 0.24, abs=1e-3)


def test_a_door_in_a_corner_does_not_scratch_the_wall_that_runs_crosswise() -> None:
    walls = build_walls(Plan((rectangle("a", 0, 0, 3, 3),), (door((0.35, -0.12), 0),)))
    assert walls.tunnels["door"].area_m.equals(shapely.box(0.0, -0.24, 0.8, 0.0))


def test_overlapping_rooms_get_one_floor_each_and_no_floor_twice() -> None:
    walls = build_walls(Plan((rectangle("a", 0, 0, 3, 3), rectangle("b", 2.9, 0, 6, 3)), ()))
    assert walls.floors_m[0].intersection(walls.floors_m[1]).area == pytest.approx(0.0, abs=1e-9)


def test_an_opening_of_no_size_or_far_from_all_walls_cuts_nothing() -> None:
    room = rectangle("a", 0, 0, 3, 3)
    flat = Opening("flat", "window", Box((1.0, -0.12, 0.9), (0.0, 0.24, 0.0), 0.0))
    lost = Opening("lost", "window", Box((1.5, 1.5, 0.9), (1.0, 0.24, 1.2), 0.0))
    assert build_walls(Plan((room,), (flat, lost))).tunnels == {}
