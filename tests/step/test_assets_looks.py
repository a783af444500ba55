"""The shipped wall and floor looks: seamless maps, sound materials."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import Usd, UsdShade, UsdUtils, UsdValidation

from chord_usd.assets.look_library import RECIPES, write_look
from chord_usd.assets.look_noise import blurred, normal_map, spectral_noise
from chord_usd.scene.looks import Look, load_looks

LOOKS = load_looks()
every_look = pytest.mark.parametrize("look", LOOKS, ids=lambda look: look.name)
LARGEST_BYTES = 600 * 1024


def pixels(look: Look, name: str) -> np.ndarray:
    with Image.open(look.usd_path.parent / "maps" / f"{name}.jpg") as image:
        return np.asarray(image, dtype=np.float64)


def test_every_recipe_is_shipped_and_nothing_else() -> None:
    assert [look.name for look in LOOKS] == sorted(recipe.name for recipe in RECIPES)


@every_look
@pytest.mark.parametrize("name", ["base_color", "normal", "roughness"])
def test_maps_meet_at_their_edges(look: Look, name: str) -> None:
    """The step across the seam is no larger than the largest step inside."""
    values = pixels(look, name)
    for axis in (0, 1):
        steps = np.abs(np.diff(values, axis=axis))
        inside = steps.mean(axis=tuple(a for a in range(values.ndim) if a != axis))
        seam = np.abs(values.take(0, axis=axis) - values.take(-1, axis=axis)).mean()
        assert seam <= 1.25 * inside.max() + 0.5


@every_look
def test_normals_are_unit_and_even_on_the_whole(look: Look) -> None:
    normals = pixels(look, "normal") / 127.5 - 1.0
    # JPEG blurs what is as fine as loop pile, so a few may stray.
    stray = np.abs(np.linalg.norm(normals, axis=-1) - 1.0)
    assert np.quantile(stray, 0.99) < 0.2
    assert stray.mean() < 0.07
    assert np.allclose(normals.mean(axis=(0, 1))[:2], 0.0, atol=0.02)
    assert normals[..., 2].min() > 0.0


@every_look
def test_packages_are_small_and_valid(look: Look) -> None:
    files = [path for path in look.usd_path.parent.rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in files) < LARGEST_BYTES
    stage = Usd.Stage.Open(str(look.usd_path))
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    assert [error.GetMessage() for error in context.Validate(stage)] == []
    assert UsdUtils.ComputeAllDependencies(str(look.usd_path))[2] == []


@every_look
def test_materials_are_adjusted_through_their_inputs(look: Look) -> None:
    stage = Usd.Stage.Open(str(look.usd_path))
    material = UsdShade.Material(stage.GetDefaultPrim())
    assert material.GetPrim().GetName() == look.name
    scale = np.array(material.GetInput("uvScale").Get())
    assert np.allclose(scale * look.tile_m, 1.0)
    place = UsdShade.Shader(stage.GetPrimAtPath(f"/{look.name}/Place"))
    for inner, public in (
        ("scale", "uvScale"),
        ("rotation", "uvRotation"),
        ("translation", "uvOffset"),
    ):
        source = place.GetInput(inner).GetConnectedSources()[0][0]
        assert source.source.GetPath() == material.GetPath()
        assert source.sourceName == public
    spaces = {
        name: UsdShade.Shader(stage.GetPrimAtPath(f"/{look.name}/{name}"))
        .GetInput("sourceColorSpace")
        .Get()
        for name in ("BaseColor", "Roughness", "Normal")
    }
    assert spaces == {"BaseColor": "sRGB", "Roughness": "raw", "Normal": "raw"}
    surface = material.ComputeSurfaceSource()[0]
    assert surface.GetIdAttr().Get() == "UsdPreviewSurface"


def test_the_same_recipe_gives_the_same_bytes(tmp_path: Path) -> None:
    recipe = next(recipe for recipe in RECIPES if recipe.name == "WarmPlaster")
    first = write_look(recipe, tmp_path / "first")
    second = write_look(recipe, tmp_path / "second")
    for path in first.rglob("*"):
        if path.is_file():
            assert path.read_bytes() == (second / path.relative_to(first)).read_bytes()


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


def test_noise_is_seamless_and_blur_keeps_the_mean() -> None:
    field = spectral_noise(np.random.default_rng(1), (128, 96), slope=1.5, stretch=(3.0, 1.0))
    assert field.mean() == pytest.approx(0.0, abs=1e-9)
    assert field.std() == pytest.approx(1.0)
    soft = blurred(field, 2.0)
    assert soft.mean() == pytest.approx(field.mean(), abs=1e-9)
    assert soft.std() < field.std()
    inside = np.abs(np.diff(field, axis=1)).mean()
    assert np.abs(field[:, 0] - field[:, -1]).mean() < 2 * inside
