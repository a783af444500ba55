"""Every design of the dressing level: sound, of its category's size, made for where it hangs."""

from __future__ import annotations

import numpy as np
import trimesh

from chord_usd.base.scene.palette import CATEGORIES, DRESSING_CATEGORIES, Mount, category
from chord_usd.base.scene.styles import STYLES
from chord_usd.library.catalogue import designs
from chord_usd.library.kit.model import Design, Part
from chord_usd.library.pictures.wall_pictures import ART_SLOTS
from tests.design_forms import forms
from tests.every import for_every
from tests.whole_meshes import is_manifold, points_differ

DRESSING = {row.name for row in DRESSING_CATEGORIES}
ALL = tuple(design for design in designs() if design.category in DRESSING)
MOST_TRIANGLES = {"floor_plant": 6200, "trailing_plant": 6000}
MOST_OF_SOFT, MOST_OF_OTHERS = 12_000, 5000
SOFT = ("curtain", "throw", "cushion", "rug", "towel_rail", "towel_stack")
FLAT_M = 1e-6


def most_triangles(design: Design) -> int:
    most = MOST_OF_SOFT if design.category in SOFT else MOST_OF_OTHERS
    return MOST_TRIANGLES.get(design.category, most)


def flat_area_m2(parts: tuple[Part, ...], axis: int, level_m: float) -> float:
    """Area of what lies in the plane at level_m across an axis."""
    total = 0.0
    for part in parts:
        corners = part.solid.points_m[part.solid.faces]
        there = corners[np.all(np.abs(corners[..., axis] - level_m) < FLAT_M, axis=1)]
        if len(there):
            total += float(np.sum(trimesh.triangles.area(there)))
    return total


def test_ids_are_unique_and_sizes_lie_in_the_range_of_the_palette() -> None:
    assert len({design.id for design in ALL}) == len(ALL)
    for design in ALL:
        row = category(design.category)
        sides = zip(design.size_m, (row.length_m, row.width_m, row.height_m), strict=True)
        assert all(low <= side <= high for side, (low, high) in sides), design.id
        assert set(design.styles) <= set(STYLES), design.id


@for_every("design", [form[0] for form in forms(ALL)], ids=lambda design: design.id, step=4)
def test_a_design_is_sound(design: Design) -> None:
    parts = design.parts()
    mount, (length, width, height) = CATEGORIES[design.category].mount, design.size_m
    assert sum(len(part.solid.faces) for part in parts) <= most_triangles(design)
    assert len({part.name for part in parts}) == len(parts)
    for part in parts:
        mesh = trimesh.Trimesh(part.solid.points_m, part.solid.faces, process=False)
        assert mesh.is_winding_consistent, part.name
        assert part.two_sided or (mesh.is_watertight and mesh.volume > 0.0), part.name
        assert mesh.area_faces.min() > 0.0, part.name
        assert points_differ(part.solid.points_m), part.name
        assert is_manifold(part.solid.faces), part.name
        assert part.uvs is None or part.uvs.shape == (3 * len(part.solid.faces), 2)
        worn = {looks[part.slot] for looks in design.colourways.values()}
        assert all(name in design.finishes for name in worn), part.name
    if mount is Mount.WALL and CATEGORIES[design.category].rooms != ("kitchen",):
        assert flat_area_m2(parts, 1, width / 2) > 0.0, "touches the wall"
    if mount is Mount.CEILING:
        assert flat_area_m2(parts, 2, height) > 0.0, "touches the ceiling"
    if design.light is not None:
        x, y, z = design.light.at_m
        assert abs(x) <= length / 2
        assert abs(y) <= width / 2
        assert 0.0 <= z <= height


def test_a_throw_is_a_cloth_and_no_block() -> None:
    """A closed mesh around what it lies on would hold tens of litres of bed."""
    for design in ALL:
        if design.category == "throw":
            cloth = next(part for part in design.parts() if part.name == "Throw")
            mesh = trimesh.Trimesh(cloth.solid.points_m, cloth.solid.faces, process=False)
            assert 2 * mesh.volume / mesh.area < 0.02, design.id


def test_a_drawing_is_the_same_each_time() -> None:
    """Lofts, leaves and art: whatever draws random numbers takes them from the name."""
    for name in ("Plant_Monstera", "Books_40", "Vase_Pampas", "Basket_Round"):
        design = next(one for one in ALL if one.id == name)
        first, second = design.parts(), design.parts()
        for a, b in zip(first, second, strict=True):
            assert a.solid.points_m.tobytes() == b.solid.points_m.tobytes()
    picture = next(one for one in ALL if one.category == "picture")
    art = picture.finishes[ART_SLOTS[0]].texture
    assert art is not None
    assert max(art.size) <= 512


def test_all_lamps_of_rooms_say_where_they_shine() -> None:
    for design in ALL:
        if design.category in ("ceiling_lamp", "pendant_lamp", "floor_lamp", "wall_lamp"):
            assert design.light is not None, design.id
