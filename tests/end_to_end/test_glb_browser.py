"""A .glb in three.js, in a real browser: how large it is, and how bright its rooms are."""

from __future__ import annotations

import shutil
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

if not shutil.which("chromium"):
    pytest.skip("there is no chromium: apt-get install chromium", allow_module_level=True)
if not (find_spec("nicegui") and find_spec("playwright")):
    pytest.skip("the extras web and dev are not installed", allow_module_level=True)

from chord_usd.base.errors import RenderError
from chord_usd.base.runtime.extras import three_module
from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.image.exr import read_exr
from chord_usd.line.image.options import WEB, RenderOptions
from chord_usd.line.image.products import read_mask
from chord_usd.line.image.render import render_stage
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.export.export_stage import export_stage
from chord_usd.line.stage.export.gltf import write_drawn
from tests.three_browser import MEASURES, bounds_y_up, page_with, seen, served

NEAR_M = 1e-3
LUMINANCE = (0.35, 0.65)
"""Mean over all rooms at the viewer's default exposure: pictures neither burnt nor dark."""

SCRIPT = f"""
import {{ GLTFLoader, THREE }} from "/three.js";
{MEASURES}
window.see = async (address) => {{
  const gltf = await new GLTFLoader().loadAsync(address);
  const renderer = rendererOf(THREE, 160), bright = {{}};
  for (const camera of gltf.cameras) {{
    camera.aspect = 1;
    camera.updateProjectionMatrix();
    bright[camera.name] = luminance(renderer, gltf.scene, camera);
  }}
  return {{...boundsOf(gltf.scene), bright}};
}};
"""


def test_three_js_shows_a_house_as_large_as_it_is_and_neither_burnt_nor_dark(
    furnished_house: SceneGraph, tmp_path: Path
) -> None:
    shutil.copyfile(three_module(), tmp_path / "three.js")
    stage = author_stage(furnished_house, tmp_path / "house.usda", seed=3).path
    export_stage(stage, tmp_path / "house.glb", "gltf")
    with served(tmp_path, page_with(SCRIPT)) as address:
        record = seen(address, "house.glb")
    assert np.allclose([record["low"], record["high"]], bounds_y_up(stage), atol=NEAR_M)
    rooms = [value for name, value in record["bright"].items() if name not in ("Top", "Isometric")]
    assert len(rooms) == len(furnished_house.rooms)
    assert LUMINANCE[0] < np.mean(rooms) < LUMINANCE[1], record["bright"]


def test_browser_and_blender_see_the_same_things_at_the_same_distance(
    furnished_house: SceneGraph, tmp_path: Path
) -> None:
    stage = author_stage(furnished_house, tmp_path / "house.usda", seed=3).path
    asked = RenderOptions(
        rooms=("Bedroom_0",),
        resolution_px=(160, 90),
        passes=("depth", "instance"),
    )
    drawn = replace(asked, engine=WEB, passes=("rgb", *asked.passes))
    render_stage(stage, tmp_path / "drawn", drawn, write_glb=write_drawn)
    render_stage(stage, tmp_path / "traced", asked)
    (mask,) = (tmp_path / "drawn").glob("*.instance.png")
    camera = mask.name.removesuffix(".instance.png")
    browser, blender = (
        (
            read_mask(tmp_path / folder / mask.name),
            read_exr(tmp_path / folder / f"{camera}.depth.exr")[0]["Z"],
        )
        for folder in ("drawn", "traced")
    )
    assert np.mean(browser[0] == blender[0]) > 0.97
    assert np.mean(np.abs(browser[1] - blender[1]) < 0.02) > 0.97
    with Image.open(tmp_path / "drawn" / f"{camera}.png") as picture:
        assert 0.25 < np.asarray(picture.convert("L")).mean() / 255 < 0.75


def test_a_browser_refuses_a_camera_that_sees_the_house_cut_open(
    furnished_house: SceneGraph, tmp_path: Path
) -> None:
    stage = author_stage(furnished_house, tmp_path / "house.usda", seed=3).path
    asked = RenderOptions(cameras=("Isometric",), engine=WEB)
    with pytest.raises(RenderError, match="cut open"):
        render_stage(stage, tmp_path / "pictures", asked, write_glb=write_drawn)
    with pytest.raises(RenderError, match="write_glb"):
        render_stage(stage, tmp_path / "pictures", replace(asked, cameras=("Bedroom_0",)))
