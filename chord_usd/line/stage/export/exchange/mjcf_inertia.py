"""Centres and moments of inertia of the solids that geoms of MJCF are."""

from __future__ import annotations

import numpy as np
import trimesh
from scipy.spatial.transform import Rotation

from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.export.exchange.mjcf_geoms import Shape


def inertia_of(shape: Shape, mass_kg: float) -> tuple[FloatArray, FloatArray]:
    """Centre, (3,) in metres, and inertia about it, (3, 3) in kg m2, of an even solid of a mass, in
    the frame of its body."""
    if shape.hull is not None:
        return _of_hull(shape.hull, mass_kg)
    told = shape.attributes
    size = np.array([float(word) for word in told["size"].split()])
    squares = mass_kg * _mean_squares(told["type"], size)
    own = np.diag(squares.sum() - squares)
    centre = np.array([float(word) for word in told.get("pos", "0 0 0").split()])
    w, x, y, z = (float(word) for word in told.get("quat", "1 0 0 0").split())
    turn = Rotation.from_quat([x, y, z, w]).as_matrix()
    return centre, turn @ own @ turn.T


def _mean_squares(kind: str, size: FloatArray) -> FloatArray:
    """(3,) means of x, y and z squared over a solid about its middle; size: as MJCF has it."""
    if kind == "box":
        return size**2 / 3
    if kind in ("sphere", "ellipsoid"):
        return np.broadcast_to(size, 3) ** 2 / 5
    radius, half = size
    if kind == "cylinder":
        return np.array([radius**2 / 4, radius**2 / 4, half**2 / 3])
    # A capsule: a cylinder, and two half balls whose middles lie 3/8 of the radius beyond its ends.
    ball = 4 / 3 * radius / (4 / 3 * radius + 2 * half)
    across = ball * radius**2 / 5 + (1 - ball) * radius**2 / 4
    caps = half**2 + 3 / 4 * half * radius + radius**2 / 5
    return np.array([across, across, ball * caps + (1 - ball) * half**2 / 3])


def _of_hull(points: FloatArray, mass_kg: float) -> tuple[FloatArray, FloatArray]:
    hull = trimesh.convex.convex_hull(points)
    return np.array(hull.center_mass), np.array(hull.moment_inertia) * mass_kg / hull.volume
