"""Flat areas become triangles that meet at their corners."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest
import shapely

from chord_usd.stage.mesh import flat

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
