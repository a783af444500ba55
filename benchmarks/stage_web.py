"""A house in a browser: its packages loaded by three.js in headless Chromium, counted and drawn.

    python benchmarks/stage_web.py HOUSE.usda --three .../node_modules/three [--picture web.png]

The house is exported for web and for gltf, and each package is loaded as a page would load it
(`npm install three`, Debian's chromium). The script exits 1 unless three.js finds every mesh of the
house within its bounds. The page sends what it found, and the picture, back to this script.
"""

from __future__ import annotations

import argparse
import base64
import json
import queue
import shutil
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np
from results import write_section
from stage_sizes import mesh_bounds

from chord_usd.line.stage.export.export_stage import export_stage

PATIENCE_S = 300.0
NEAR_M = 1e-3
"""Bounds of the meshes in the browser are those of the stage within this."""

_PICTURE_PX = (1280, 960)

PAGE = """<!doctype html>
<html><body style="margin: 0">
<script type="importmap">
{"imports": {"three": "/three/build/three.module.js", "three/addons/": "/three/examples/jsm/"}}
</script>
<script type="module">
const asked = new URLSearchParams(location.search);
const tell = (found) => fetch("/told", {method: "POST", body: JSON.stringify(found)});
window.addEventListener("error", (event) => tell({error: event.message}));
try {
  const THREE = await import("three");
  const name = asked.get("file");
  const loader = name.endsWith(".glb")
    ? new (await import("three/addons/loaders/GLTFLoader.js")).GLTFLoader()
    : new (await import("three/addons/loaders/USDLoader.js")).USDLoader();
  const textures = new Promise((done) => {
    THREE.DefaultLoadingManager.onLoad = done;
    setTimeout(done, 60000);
  });
  const loaded = await loader.loadAsync("/" + name);
  await textures;
  const house = loaded.scene ?? loaded;
  house.updateMatrixWorld(true);
  const box = new THREE.Box3(), point = new THREE.Vector3();
  let meshes = 0, triangles = 0;
  const pictures = new Set();
  house.traverse((node) => {
    if (!node.isMesh) return;
    meshes += 1;
    const points = node.geometry.attributes.position;
    triangles += (node.geometry.index?.count ?? points.count) / 3;
    for (let k = 0; k < points.count; k += 1) {
      box.expandByPoint(point.fromBufferAttribute(points, k).applyMatrix4(node.matrixWorld));
    }
    for (const material of [node.material].flat()) {
      if (material.map?.image) pictures.add(material.map.image);
    }
  });
  const [width, height] = asked.get("size").split("x").map(Number);
  const renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true});
  renderer.setSize(width, height);
  document.body.append(renderer.domElement);
  const scene = new THREE.Scene();
  scene.background = new THREE.Color(0xd8dde2);
  scene.add(house, new THREE.HemisphereLight(0xffffff, 0x998877, 2.5));
  const sun = new THREE.DirectionalLight(0xffffff, 2.0);
  sun.position.set(3, 8, 5);
  scene.add(sun);
  const middle = box.getCenter(new THREE.Vector3());
  const reach = box.getSize(new THREE.Vector3()).length();
  const camera = new THREE.PerspectiveCamera(40, width / height, 0.1, 10 * reach);
  camera.position.copy(middle).add(new THREE.Vector3(0, 0.95 * reach, 0.65 * reach));
  camera.lookAt(middle);
  renderer.render(scene, camera);
  await tell({
    revision: THREE.REVISION, meshes, triangles, pictures: pictures.size,
    low: box.min.toArray(), high: box.max.toArray(),
    picture: renderer.domElement.toDataURL("image/png"),
  });
} catch (error) {
  await tell({error: String(error.stack ?? error)});
}
</script></body></html>
"""


def main() -> None:
    """Exports, loads, compares; writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("house", type=Path)
    parser.add_argument("--three", type=Path, required=True, metavar="DIR", help="the npm package")
    parser.add_argument("--chromium", default="chromium", metavar="PROGRAM")
    parser.add_argument("--picture", type=Path, metavar="PNG", help="what the browser drew")
    options = parser.parse_args()
    bounds_m, count = mesh_bounds(options.house, rendered=False)
    rows, is_whole = [], True
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        (folder / "three").symlink_to(options.three.absolute())
        (folder / "index.html").write_text(PAGE)
        for package, suffix in (("web", ".usdz"), ("ar", ".usdz"), ("gltf", ".glb")):
            export_stage(options.house, folder / f"{package}{suffix}", package)
            found = seen_by_browser(folder, f"{package}{suffix}", options.chromium)
            off_m = float(np.abs(_z_up(found["low"], found["high"]) - bounds_m).max())
            # Meshes of a piece and a material are one in a .glb.
            is_merged = package == "gltf"
            is_whole &= (is_merged or found["meshes"] == count) and off_m <= NEAR_M
            rows.append((f"export for {package}", _row(found, count, off_m)))
            if options.picture:
                picture = options.picture.with_stem(f"{options.picture.stem}_{package}")
                picture.write_bytes(base64.b64decode(found["picture"].split(",")[1]))
    note = "`python benchmarks/stage_web.py HOUSE.usda --three DIR`."
    sys.stdout.write(write_section("stages: in a browser", rows, note))
    sys.exit(not is_whole)


def _z_up(low: list[float], high: list[float]) -> np.ndarray:
    """(2, 3) bounds with Z up, of those of a scene with Y up: x, z, -y."""
    return np.array([[low[0], -high[2], low[1]], [high[0], -low[2], high[1]]])


def _row(found: dict[str, Any], count: int, off_m: float) -> str:
    return (
        f"three.js r{found['revision']} loads {found['meshes']} meshes of {count}, "
        f"{found['triangles']:.0f} triangles, {found['pictures']} textures; "
        f"bounds off by {1000 * off_m:.2f} mm"
    )


def seen_by_browser(folder: Path, name: str, chromium: str) -> dict[str, Any]:
    """What the page in folder says of the file of this name there. Raises RuntimeError."""
    program = shutil.which(chromium)
    if program is None:
        raise RuntimeError(f"{chromium} is not there; try: apt-get install chromium")
    width, height = _PICTURE_PX
    with _serving(folder) as (port, told):
        address = f"http://127.0.0.1:{port}/index.html?file={name}&size={width}x{height}"
        browser = subprocess.Popen(
            [
                program, "--headless=new", "--no-sandbox", "--use-angle=swiftshader",
                "--enable-unsafe-swiftshader", "--disable-dev-shm-usage",
                f"--user-data-dir={folder / 'profile'}", address,
            ],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )  # fmt: skip
        try:
            found = told.get(timeout=PATIENCE_S)
        except queue.Empty:
            raise RuntimeError(f"{name}: nothing heard in {PATIENCE_S:.0f} s") from None
        finally:
            browser.terminate()
            browser.wait()
    if "error" in found:
        raise RuntimeError(f"{name}: {found['error']}")
    return found


@contextmanager
def _serving(folder: Path) -> Iterator[tuple[int, queue.Queue[dict[str, Any]]]]:
    """A server of the files in folder; what pages post to it arrives in the queue."""
    told: queue.Queue[dict[str, Any]] = queue.Queue()

    class Handler(SimpleHTTPRequestHandler):
        def do_POST(self) -> None:
            body = self.rfile.read(int(self.headers["Content-Length"]))
            told.put(json.loads(body))
            self.send_response(204)
            self.end_headers()

        def log_message(self, *_: object) -> None:
            """Nobody reads along."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Handler, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        yield server.server_address[1], told
    finally:
        server.shutdown()


if __name__ == "__main__":
    main()
