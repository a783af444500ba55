"""Drawn looks: seamless maps in true size, sound materials, the same bytes each time."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import Usd, UsdShade, UsdUtils, UsdValidation

from chord_usd.base.scene.look_families import Family, load_families
from chord_usd.base.scene.styles import STYLES
from chord_usd.base.scene.types import FloatArray, Room
from chord_usd.library.looks.look_drawing import DRAWINGS, draw_look
from chord_usd.library.looks.look_library import drawn_look, own_looks, style_looks
from chord_usd.library.looks.look_package import map_file, write_material
from chord_usd.library.textures.fields import normal_map
from tests.every import for_every

FAMILIES = load_families()
PX = 256
every_family = for_every("family", FAMILIES.values(), ids=lambda one: one.name)
every_form = for_every(
    ("name", "settings"),
    [
        (family.name, {parameter.name: choice})
        for family in FAMILIES.values()
        for parameter in family.parameters.values()
        if parameter.name not in ("wood", "kind", "chips")
        for choice in parameter.choices or parameter.range or (parameter.default,)
    ],
)
LARGEST_BYTES = 700 * 1024


@every_form
def test_maps_meet_at_their_edges(name: str, settings: dict[str, object]) -> None:
    """The step across the seam is no larger than the largest step inside."""
    maps = draw_look(FAMILIES[name], settings, 128)
    for values in (maps.rgb, maps.roughness[..., None] * 255.0):
        assert np.isfinite(values).all()
        for axis in (0, 1):
            if maps.standing and axis == 0:
                continue
            steps = np.abs(np.diff(values, axis=axis)).mean(axis=(1 - axis, 2))
            seam = np.abs(values.take(0, axis=axis) - values.take(-1, axis=axis)).mean()
            assert seam <= 1.8 * steps.max() + 1.0


def dark_lines(maps_rgb: FloatArray, axis: int, tile_m: float) -> float:
    """Mean distance of the darkest lines along an axis, in metres."""
    profile = maps_rgb.mean(axis=(1 - axis, 2))
    power = np.abs(np.fft.rfft(profile - profile.mean()))
    return tile_m / int(power.argmax())


@pytest.mark.parametrize("width_m", [0.1, 0.2, 0.3])
def test_planks_are_as_wide_as_asked(width_m: float) -> None:
    maps = draw_look(FAMILIES["planks"], {"width_m": width_m, "joint_m": 0.006, "wear": 0.0}, 512)
    edges = np.flatnonzero(np.diff((maps.rgb.mean(axis=(1, 2)) < _low(maps.rgb)).astype(int)) == 1)
    spacing_m = np.diff(edges) / 512 * maps.ground.tile_m[1]
    assert np.median(spacing_m) == pytest.approx(width_m, abs=0.012)


def _low(rgb: FloatArray) -> float:
    """A third of the way from the darkest row to the usual one."""
    rows = rgb.mean(axis=(1, 2))
    return float(rows.min() + (np.median(rows) - rows.min()) / 3)


@pytest.mark.parametrize(("size_m", "aspect"), [(0.1, 1.0), (0.2, 2.0), (0.3, 3.0)])
def test_tiles_are_as_large_as_asked(size_m: float, aspect: float) -> None:
    settings = {"size_m": size_m, "aspect": aspect, "bond": "stack", "joint_m": 0.008,
                "grout": "#000000", "variation": 0.0}  # fmt: skip
    maps = draw_look(FAMILIES["glazed"], settings, 512)
    across, up = maps.ground.tile_m
    assert dark_lines(maps.rgb, 1, across) == pytest.approx(size_m, rel=0.02)
    assert dark_lines(maps.rgb, 0, up) == pytest.approx(size_m / aspect, rel=0.02)


@pytest.mark.parametrize("wood", ["pale_oak", "walnut"])
def test_a_wood_has_its_colour_in_every_family(wood: str) -> None:
    means = [
        draw_look(FAMILIES[name], {"wood": wood}, 128).rgb.mean(axis=(0, 1))
        for name in ("planks", "herringbone", "chevron", "parquet", "laminate")
    ]
    assert np.ptp(means, axis=0).max() < 20.0


def test_every_family_has_a_drawing_with_its_parameters() -> None:
    assert {family.drawing for family in FAMILIES.values()} == set(DRAWINGS)


@every_family
def test_packages_are_valid_small_and_the_same_each_time(family: Family, tmp_path: Path) -> None:
    from chord_usd.library.looks.look_drawing import write_look

    look = drawn_look(family, {}, PX)
    folder = look.usd_path.parent
    again = write_look(look.name, family, {}, PX, look.kinds, tmp_path)
    files = [path for path in folder.rglob("*") if path.is_file()]
    assert len(files) == 5
    assert all(f.read_bytes() == (again / f.relative_to(folder)).read_bytes() for f in files)
    assert sum(path.stat().st_size for path in files) < LARGEST_BYTES
    stage = Usd.Stage.Open(str(look.usd_path))
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    assert [error.GetMessage() for error in context.Validate(stage)] == []
    assert UsdUtils.ComputeAllDependencies(str(look.usd_path))[2] == []
    material = UsdShade.Material(stage.GetDefaultPrim())
    scale = np.array(material.GetInput("uvScale").Get())
    assert np.allclose(scale * look.tile_m, 1.0, atol=1e-4)


@every_family
def test_normals_are_even_on_the_whole(family: Family) -> None:
    maps = draw_look(family, {}, PX)
    normals = normal_map(maps.height_m, maps.ground.tile_m) * 2.0 - 1.0
    assert np.allclose(normals.mean(axis=(0, 1))[:2], 0.0, atol=0.02)
    assert normals[..., 2].min() > 0.0


def test_a_material_is_adjusted_through_its_inputs(tmp_path: Path) -> None:
    write_material(tmp_path / "Oak.usda", (2.0, 1.0), 0.0, {})
    stage = Usd.Stage.Open(str(tmp_path / "Oak.usda"))
    place = UsdShade.Shader(stage.GetPrimAtPath("/Oak/Place"))
    for inner, public in (
        ("scale", "uvScale"),
        ("rotation", "uvRotation"),
        ("translation", "uvOffset"),
    ):
        source = place.GetInput(inner).GetConnectedSources()[0][0]
        assert source.source.GetPath() == stage.GetDefaultPrim().GetPath()
        assert source.sourceName == public
    spaces = [
        UsdShade.Shader(stage.GetPrimAtPath(f"/Oak/{name}")).GetInput("sourceColorSpace").Get()
        for name in ("BaseColor", "Roughness", "Normal")
    ]
    assert spaces == ["sRGB", "raw", "raw"]


def test_what_lays_a_look_has_values_beside_its_connections(tmp_path: Path) -> None:
    write_material(tmp_path / "Oak.usda", (0.5, 2.0), 90.0, {})
    stage = Usd.Stage.Open(str(tmp_path / "Oak.usda"))
    place = UsdShade.Shader(stage.GetPrimAtPath("/Oak/Place"))
    said = [place.GetInput(name).GetAttr().Get() for name in ("scale", "rotation", "translation")]
    assert said == [(2.0, 0.5), 90.0, (0.0, 0.0)]
    assert all(place.GetInput(name).HasConnectedSource() for name in ("scale", "rotation"))


def test_looks_of_a_user_go_before_those_of_the_style(tmp_path: Path) -> None:
    theirs = tmp_path / "Mine"
    (theirs / "maps").mkdir(parents=True)
    write_material(theirs / "Mine.usda", (1.0, 1.0), 0.0, {})
    for name in ("base_color", "roughness", "normal"):
        Image.new("RGB", (8, 8)).save(theirs / "maps" / map_file("Mine", name))
    entry = {
        "name": "Mine", "label": "Mine", "surface": "floor", "kinds": ["bedroom"],
        "tile_m": [1.0, 1.0], "licence": "CC0-1.0", "author": "me",
    }  # fmt: skip
    (theirs / "look.json").write_text(json.dumps(entry))
    named = tmp_path / "Pale"
    named.mkdir()
    parameters = {"wood": "birch", "width_m": 0.1}
    text = {**entry, "name": "Pale", "family": "planks", "parameters": parameters}
    (named / "look.json").write_text(json.dumps(text))
    assert [look.name.split("_")[0] for look in own_looks(tmp_path)] == ["Mine", "Planks"]
    looks = style_looks(STYLES["modern"], 0, PX, tmp_path)
    bedroom = Room("b", "bedroom", np.zeros((4, 2)))
    offered = looks.choices("floor", bedroom, 3)
    assert offered[0].name == "Mine"
    assert len({look.name for look in offered}) == 3
    assert not any(look.name == "Mine" for look in looks.choices("wall", bedroom, 3))


def test_a_ramp_leans_its_normals_against_its_rise() -> None:
    """A bump rises towards +u and +v: red and green fall below the middle there (OpenGL)."""
    rows, columns = np.indices((64, 64)) / 64
    u, v = columns, 1.0 - rows
    bump_m = 0.05 * np.exp(-((u - 0.5) ** 2 + (v - 0.5) ** 2) / 0.02)
    normals = normal_map(bump_m, (1.0, 1.0))
    before = normals[44, 20]  # lower left of the bump
    assert before[0] < 0.5
    assert before[1] < 0.5
    after = normals[20, 44]  # upper right
    assert after[0] > 0.5
    assert after[1] > 0.5
    slope = 0.05 * np.exp(-((0.1) ** 2) / 0.02) * 2 * 0.1 / 0.02
    left = normals[32, round(0.4 * 64)] * 2 - 1
    assert -left[0] / left[2] == pytest.approx(slope, rel=0.1)
