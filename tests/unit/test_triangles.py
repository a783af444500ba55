"""Closed and convex meshes, as trimesh finds them."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.line.stage.check.triangles import Triangles

_BOX = trimesh.creation.box()
_MESHES = {
    "box": _BOX,
    "ball": trimesh.creation.icosphere(2),
    "ring": trimesh.creation.torus(0.4, 0.1),
    "rod": trimesh.creation.cylinder(0.1, 1.0),
    "two boxes": trimesh.util.concatenate([_BOX, _BOX.copy().apply_translation((2, 0, 0))]),
    "inside out": trimesh.Trimesh(_BOX.vertices, _BOX.faces[:, ::-1], process=False),
    "open": trimesh.Trimesh(_BOX.vertices, _BOX.faces[1:], process=False),
    "twice": trimesh.Trimesh(_BOX.vertices, [*_BOX.faces, *_BOX.faces], process=False),
    "dented": trimesh.Trimesh(
        np.where(_BOX.vertices == _BOX.vertices[0], 0.9, 1.0) * _BOX.vertices, _BOX.faces
    ),
}


@pytest.mark.parametrize("name", _MESHES)
def test_meshes_are_closed_and_convex_as_trimesh_says(name: str) -> None:
    mesh = _MESHES[name]
    own = Triangles(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    assert (own.is_watertight, own.is_convex) == (mesh.is_watertight, mesh.is_convex)


@given(st.integers(0, 10**6))
def test_hulls_of_points_are_convex_until_a_corner_is_pushed_in(seed: int) -> None:
    rng = np.random.default_rng(seed)
    hull = trimesh.convex.convex_hull(rng.normal(size=(12, 3)))
    own = Triangles(np.asarray(hull.vertices), np.asarray(hull.faces))
    assert own.is_convex
    pushed = own.vertices.copy()
    pushed[0] = pushed.mean(axis=0)
    assert not Triangles(pushed, own.faces).is_convex


def test_the_box_is_that_of_trimesh() -> None:
    to_world = trimesh.transformations.rotation_matrix(0.7, (0, 0, 1), (1, 2, 3))
    theirs, own = trimesh.creation.box((0.5,) * 3, to_world), Triangles.box(0.5, to_world)
    assert np.allclose(theirs.vertices, own.vertices)
    assert (theirs.faces == own.faces).all()
