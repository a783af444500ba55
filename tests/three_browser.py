"""Files in three.js, in a real browser: a page that is served, and what it says of each."""

from __future__ import annotations

import shutil
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
from pxr import Usd, UsdGeom

SOFTWARE = ("--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader")

MEASURES = """
const boundsOf = (house) => {
  const point = house.position.clone();
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
  return {low: low.toArray(), high: high.toArray()};
};
const rendererOf = (THREE, side) => {
  const renderer = new THREE.WebGLRenderer({preserveDrawingBuffer: true});
  renderer.setPixelRatio(1);
  renderer.setSize(side, side);
  return renderer;
};
const luminance = (renderer, scene, camera) => {
  renderer.render(scene, camera);
  const gl = renderer.getContext(), side = gl.drawingBufferWidth;
  const pixels = new Uint8Array(4 * side * side);
  gl.readPixels(0, 0, side, side, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let sum = 0;
  for (let k = 0; k < pixels.length; k += 4)
    sum += 0.2126 * pixels[k] + 0.7152 * pixels[k + 1] + 0.0722 * pixels[k + 2];
  return sum / (255 * side * side);
};
"""
"""JavaScript: bounds of a scene as it stands, and how bright a camera sees it."""


def page_with(script: str, head: str = "") -> str:
    """A page whose script defines window.see(address)."""
    return (
        f'<!doctype html><html><head><link rel="icon" href="data:,">{head}</head>'
        f'<body><script type="module">{script}</script></body></html>'
    )


@contextmanager
def served(folder: Path, page: str) -> Iterator[str]:
    """The address of a folder, with this page in it."""
    (folder / "index.html").write_text(page)
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_address[1]}"
    server.shutdown()


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Nobody reads along."""


def seen(address: str, name: str) -> dict[str, Any]:
    """What three.js says of a file; fails where the page has an error."""
    from playwright.sync_api import sync_playwright

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


def bounds_y_up(stage: Path) -> np.ndarray:
    """(2, 3) bounds of what is seen of a stage with Z up, as a scene with Y up has them."""
    shown = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    opened = Usd.Stage.Open(str(stage))
    box = shown.ComputeWorldBound(opened.GetPseudoRoot()).ComputeAlignedRange()
    (west, south, floor), (east, north, top) = box.GetMin(), box.GetMax()
    return np.array([[west, floor, -north], [east, top, -south]])
