"""Exports in the programs that they are for: Khronos' glTF validator, three.js' USD loader.

`make acceptance-tools` brings both from npm, pinned.
"""

from __future__ import annotations

import json
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.export.export_stage import export_stage
from tests.three_browser import MEASURES, bounds_y_up, page_with, seen, served

pytestmark = pytest.mark.acceptance

MODULES = Path(__file__).parents[2] / ".venv/node/node_modules"
NEAR_M = 1e-3
LUMINANCE = (0.35, 0.65)
"""Mean over views into a house without ceilings, under an even sky: neither burnt nor dark."""

VALIDATE = """
const { validateBytes } = require("gltf-validator");
const bytes = new Uint8Array(require("fs").readFileSync(process.argv[1]));
validateBytes(bytes, { maxIssues: 20 }).then((report) => console.log(JSON.stringify(report)));
"""

SCRIPT = f"""
import * as THREE from "three";
import {{ USDLoader }} from "three/addons/loaders/USDLoader.js";
{MEASURES}
window.see = async (address) => {{
  const drawn = new Promise((done) => {{ THREE.DefaultLoadingManager.onLoad = done; }});
  const house = await new USDLoader().loadAsync(address);
  await Promise.race([drawn, new Promise((done) => setTimeout(done, 20000))]);
  const {{low, high}} = boundsOf(house), scene = new THREE.Scene();
  scene.add(house, new THREE.HemisphereLight(0xffffff, 0xffffff, 3.0));
  let meshes = 0;
  house.traverse((node) => {{ meshes += Boolean(node.isMesh); }});
  const renderer = rendererOf(THREE, 160), bright = {{}};
  const reach = Math.max(high[0] - low[0], high[2] - low[2]) / 4;
  const cut = low[1] + 2.2, above = high[1] + 1;  // below ceilings and lamps
  const camera = new THREE.OrthographicCamera(-reach, reach, reach, -reach, above - cut, 100);
  camera.position.set((low[0] + high[0]) / 2, above, (low[2] + high[2]) / 2);
  camera.up.set(0, 0, -1);
  camera.lookAt(camera.position.x, 0, camera.position.z);
  return {{low, high, meshes, bright: luminance(renderer, scene, camera)}};
}};
"""

IMPORTS = """<script type="importmap">
{"imports": {"three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"}}
</script>"""


@pytest.fixture(scope="module")
def stage(furnished_house: SceneGraph, tmp_path_factory: pytest.TempPathFactory) -> Path:
    place = tmp_path_factory.mktemp("house")
    return author_stage(furnished_house, place / "house.usda", seed=3).path


@pytest.mark.skipif(not (MODULES / "gltf-validator").is_dir(), reason="make acceptance-tools")
@pytest.mark.parametrize("lights", [False, True])
def test_khronos_finds_no_error_and_no_warning(stage: Path, tmp_path: Path, lights: bool) -> None:
    export_stage(stage, tmp_path / "house.glb", "gltf", photometric=lights)
    report = subprocess.run(
        ["node", "-e", VALIDATE, str(tmp_path / "house.glb")],
        cwd=MODULES.parent, capture_output=True, text=True, check=True,
    )  # fmt: skip
    issues = json.loads(report.stdout)["issues"]
    assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues["messages"]


@pytest.mark.skipif(
    not ((MODULES / "three").is_dir() and shutil.which("chromium") and find_spec("playwright")),
    reason="make acceptance-tools, apt-get install chromium, extra dev",
)
@pytest.mark.parametrize("kind", ["web", "ar"])
def test_three_js_shows_a_usdz_as_large_as_the_house_is(
    stage: Path, tmp_path: Path, kind: str
) -> None:
    export_stage(stage, tmp_path / f"{kind}.usdz", kind)
    (tmp_path / "three").symlink_to(MODULES / "three")
    with served(tmp_path, page_with(SCRIPT, IMPORTS)) as address:
        record = seen(address, f"{kind}.usdz")
    assert np.allclose([record["low"], record["high"]], bounds_y_up(stage), atol=NEAR_M)
    assert record["meshes"] > 100
    assert LUMINANCE[0] < record["bright"] < LUMINANCE[1]
