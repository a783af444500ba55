"""A .glb in three.js, in a real browser: how large it is, and how bright its rooms are."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest

if not shutil.which("chromium"):
    pytest.skip("there is no chromium: apt-get install chromium", allow_module_level=True)
if not (find_spec("nicegui") and find_spec("playwright")):
    pytest.skip("the extras web and dev are not installed", allow_module_level=True)

from playwright.sync_api import sync_playwright
from pxr import Usd, UsdGeom

from chord_usd.base.scene.types import SceneGraph
from chord_usd.faces.page.application import three_module
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.export.export_stage import export_stage

SOFTWARE = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")
NEAR_M = 1e-3
LUMINANCE = (0.35, 0.65)
"""Mean over all rooms at the viewer's default exposure: pictures neither burnt nor dark."""

PAGE = """<!doctype html><html><head><link rel="icon" href="data:,"></head>
<body><script type="module">
import { GLTFLoader, THREE } from "/three.js";
window.see = async (address) => {
  const gltf = await new GLTFLoader().loadAsync(address);
  const house = gltf.scene, point = house.position.clone();
  const low = point.clone().setScalar(Infinity), high = point.clone().setScalar(-Infinity);
  house.updateMatrixWorld(true);
  house.traverse((node) => {
    const points = node.geometry?.attributes.position;
    for (let k = 0; k < (points?.count ?? 0); k += 1) {
      point.fromBufferAttribute(points, k).applyMatrix4(node.matrixWorld);
      low.min(point);
      high.max(point);
    }
  });
  const side = 160, pixels = new Uint8Array(4 * side * side);
  const renderer = new THREE.WebGLRenderer({preserveDrawingBuffer: true});
  renderer.setPixelRatio(1);
  renderer.setSize(side, side);
  const bright = {};
  for (const camera of gltf.cameras) {
    camera.aspect = 1;
    camera.updateProjectionMatrix();
    renderer.render(house, camera);
    const gl = renderer.getContext();
    gl.readPixels(0, 0, side, side, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
    let sum = 0;
    for (let k = 0; k < pixels.length; k += 4)
      sum += 0.2126 * pixels[k] + 0.7152 * pixels[k + 1] + 0.0722 * pixels[k + 2];
    bright[camera.name] = sum / (255 * side * side);
  }
  return {low: low.toArray(), high: high.toArray(), bright};
};
</script></body></html>"""


@pytest.fixture
def folder(tmp_path: Path) -> Iterator[tuple[Path, str]]:
    """A folder, and the address where it is served."""
    shutil.copyfile(three_module(), tmp_path / "three.js")
    (tmp_path / "index.html").write_text(PAGE)
    handler = partial(_Quiet, directory=str(tmp_path))
    server = ThreadingHTTPServer(("127.0.0.1", 0), handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield tmp_path, f"http://127.0.0.1:{server.server_address[1]}"
    server.shutdown()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Nobody reads along."""


def seen(address: str, name: str) -> dict[str, Any]:
    """What three.js says of a file; fails where the page has an error."""
    errors: list[str] = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium"), args=list(SOFTWARE)
        )
        page = browser.new_page()
        page.set_default_timeout(120_000)
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("console", lambda said: said.type == "error" and errors.append(said.text))
        page.goto(f"{address}/index.html")
        page.wait_for_function("() => Boolean(window.see)")
        record: dict[str, Any] = page.evaluate("(name) => window.see(name)", f"/{name}")
        browser.close()
    assert errors == []
    return record


def test_three_js_shows_a_house_as_large_as_it_is_and_neither_burnt_nor_dark(
    furnished_house: SceneGraph, folder: tuple[Path, str]
) -> None:
    place, address = folder
    stage = author_stage(furnished_house, place / "house.usda", seed=3).path
    export_stage(stage, place / "house.glb", "gltf")
    record = seen(address, "house.glb")
    shown = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    opened = Usd.Stage.Open(str(stage))
    box = shown.ComputeWorldBound(opened.GetPseudoRoot()).ComputeAlignedRange()
    (west, south, floor), (east, north, top) = box.GetMin(), box.GetMax()
    assert np.allclose(record["low"], (west, floor, -north), atol=NEAR_M)
    assert np.allclose(record["high"], (east, top, -south), atol=NEAR_M)
    rooms = [value for name, value in record["bright"].items() if name not in ("Top", "Isometric")]
    assert len(rooms) == len(furnished_house.rooms)
    assert LUMINANCE[0] < np.mean(rooms) < LUMINANCE[1], record["bright"]
