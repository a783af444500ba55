"""Flat areas become triangles that meet at their corners."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
import shapely

from chord_usd.line.stage.shell.door_leaves import LeafKind, leaf_parts
from chord_usd.line.stage.shell.mesh import flat, mesh_of, prism, upright
from chord_usd.line.stage.shell.opening_shapes import Leaf

SLANTED = shapely.Polygon(
    [(0.0, 0.0), (10.4341, 0.0), (9.8286, 11.91), (6.49, 12.59)],
    [
        [(10.1816, 0.24), (2.94, 0.24), (10.0026, 3.76)],
        [(9.9904, 4.0), (6.49, 4.0), (6.49, 7.9), (9.7922, 7.9)],
    ],
)
"""Two rooms along a slanted wall, whose corners are on a line but for a fraction of a millimetre:
their triangles were once cut without an end."""

COMB = shapely.Polygon(
    [(0, 0), (4, 0), (4, 2), (3, 2), (3, 1), (2, 1), (2, 2), (1, 2), (1, 1), (0, 1)]
)


@pytest.mark.parametrize("area", [SLANTED, COMB], ids=["slanted", "comb"])
def test_triangles_fill_the_area_and_nothing_else(area: shapely.Polygon) -> None:
    faces = [face.corners_m for face in flat(area, 2.8, up=True)]
    outlines = [shapely.Polygon(face[:, :2]) for face in faces]
    assert sum(one.area for one in outlines) == pytest.approx(area.area, abs=1e-3)
    assert shapely.union_all(outlines).symmetric_difference(area).area < 1e-3
    assert all((face[:, 2] == 2.8).all() for face in faces)


def test_no_corner_lies_in_the_middle_of_a_side() -> None:
    """Every side is that of two triangles, or lies on the outline."""
    sides: Counter[frozenset[tuple[float, ...]]] = Counter()
    for face in flat(COMB, 0.0, up=False):
        corners = [tuple(np.round(corner[:2], 6)) for corner in face.corners_m]
        sides.update(map(frozenset, zip(corners, corners[1:] + corners[:1], strict=True)))
    for side, count in sides.items():
        line = shapely.LineString(sorted(side))
        assert count == (1 if COMB.exterior.covers(line) else 2)


@pytest.mark.parametrize(
    "area",
    [shapely.Polygon(), shapely.box(0, 0, 1, 0), shapely.box(0, 0, 1, 1e-9), shapely.Point(0, 0)],
    ids=["nothing", "a line", "a hair", "a point"],
)
def test_what_covers_nothing_has_no_faces(area: shapely.Geometry) -> None:
    assert not prism(area, 0.0, 1.0)
    assert not flat(area, 0.0, up=True)
    assert not flat(area, 0.0, up=True, cut=True)
    assert mesh_of(prism(area, 0.0, 1.0)).is_empty


def test_faces_without_area_are_left_out() -> None:
    point, end = np.zeros(2), np.array([1.0, 0.0])
    lines = [upright(point, point, 0.0, 1.0), upright(point, end, 1.0, 1.0)]
    assert mesh_of(lines).is_empty
    assert mesh_of([*lines, upright(point, end, 0.0, 1.0)]).counts.tolist() == [4]
    assert not prism(shapely.box(0, 0, 1, 1), 0.5, 0.5)


@pytest.mark.parametrize("kind", ["panel", "flush", "glass", "entrance"])
def test_leaves_of_all_sizes_are_solid(kind: LeafKind) -> None:
    for width in (0.17, 0.33, 0.34, 0.36, 0.6, 0.72, 0.73, 1.2):
        for height in (0.2, 0.99, 2.06):
            for part in leaf_parts(Leaf(width, height, hung_right=width > 0.5), kind=kind, opens=1):
                mesh = mesh_of(part.faces)
                assert mesh.counts.min() >= 3
                assert mesh.points_m[:, 2].min() >= 0.0
