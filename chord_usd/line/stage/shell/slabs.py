"""What lies between two storeys: the edge of the floor, its holes, and roofs over what juts out."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from shapely.geometry import MultiPolygon, Polygon
from shapely.geometry.base import BaseGeometry
from shapely.geometry.polygon import orient
from shapely.ops import unary_union

from chord_usd.base.scene.geometry import polygons_of
from chord_usd.base.scene.storeys import STOREY_M
from chord_usd.base.scene.types import ROOM_HEIGHT_M
from chord_usd.line.stage.shell.mesh import Face, flat, upright
from chord_usd.line.stage.shell.walls import Walls

_JOINT_M = 1e-3
"""Storeys that differ by less are drawn as flush."""

_LEAST_M2 = 1e-3

SEAM_M = 2e-3
"""Holes are cut to a millimetre."""

SLAB_M = 0.2
"""How far down a floor is solid."""


def slab_faces(
    lower: Walls, upper: Walls, holes: Sequence[Polygon]
) -> tuple[list[Face], list[Face]]:
    """Faces outside, and in the holes, of what lies over the lower storey; in its frame."""
    below, above = covered(lower), covered(upper)
    slab = unary_union([below, above]).buffer(_JOINT_M, join_style="mitre")
    slab = slab.buffer(-_JOINT_M, join_style="mitre").difference(unary_union(list(holes)))
    outside: list[Face] = []
    inside: list[Face] = []
    for part in map(orient, polygons_of(slab)):
        outside += _sides(part.exterior)
        for ring in part.interiors:
            inside += _sides(ring)
    outside += flat(_beyond(slab, above), STOREY_M, up=True)
    outside += flat(_beyond(slab, below), ROOM_HEIGHT_M, up=False)
    return outside, inside


def covered(walls: Walls) -> BaseGeometry:
    """What a storey covers, its walls included."""
    return unary_union([walls.solid_m, *walls.floors_m]).buffer(0)


def _beyond(slab: BaseGeometry, storey: BaseGeometry) -> MultiPolygon:
    """What of the slab lies neither over nor under a storey."""
    free = slab.difference(storey.buffer(2 * _JOINT_M, join_style="mitre"))
    return MultiPolygon([part for part in polygons_of(free) if part.area > _LEAST_M2])


def _sides(ring: BaseGeometry) -> list[Face]:
    corners = np.asarray(ring.simplify(_JOINT_M / 2).coords)
    return [upright(a, b, ROOM_HEIGHT_M, STOREY_M) for a, b in pairwise(corners)]
