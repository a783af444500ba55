"""What a large house costs: on disk, to open, in Blender, and as other packages.

    python benchmarks/stage_sizes.py [--rooms N] [--seed N] [--folder DIR]

The house is a procedural one with tabletop items and dressing, alone in its folder.
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import trimesh
from pxr import Usd, UsdGeom
from results import write_section

from chord_usd.base.scene.types import SceneGraph
from chord_usd.line.graph.match import match_assets
from chord_usd.line.pipeline import Settings, dress_rooms, lay_tables, load_models, write_stage
from chord_usd.line.stage.export.export_stage import export_stage
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan

MIB = 2**20
_PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)

OPEN = """
import sys, time
from pxr import Usd
load = Usd.Stage.LoadAll if sys.argv[2] == "all" else Usd.Stage.LoadNone
wall, processor = time.perf_counter(), time.process_time()
stage = Usd.Stage.Open(sys.argv[1], load)
print(time.perf_counter() - wall, time.process_time() - processor)
"""


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rooms", type=int, default=20)
    parser.add_argument("--seed", type=int, default=20)
    parser.add_argument("--folder", type=Path, help="keep the house here")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        folder = options.folder or Path(scratch)
        folder.mkdir(parents=True, exist_ok=True)
        rows = [*measure(house_of(options.rooms, options.seed), folder, options.seed)]
    note = f"`python benchmarks/stage_sizes.py --rooms {options.rooms} --seed {options.seed}`."
    sys.stdout.write(write_section("stages: a large house", rows, note))


def house_of(rooms: int, seed: int) -> SceneGraph:
    """A furnished house with tabletop items, dressed."""
    rng = np.random.default_rng(seed)
    settings = Settings(seed=seed)
    models = load_models(settings)
    assert models.table is not None
    graph = furnish(random_plan(rng, rooms), rng)
    graph = match_assets(graph, models.reader.database)
    graph = lay_tables(graph, models.table, models.reader.database, settings).graph
    return dress_rooms(graph, models.reader.database, settings)


def measure(graph: SceneGraph, folder: Path, seed: int) -> Iterator[tuple[str, str]]:
    """Rows of the table."""
    children = sum(len(item.children) for item in graph.items)
    dressing = len(graph.dressing)
    pieces = f"{len(graph.items)} pieces, {children} on them, {dressing} of dressing"
    yield "house", f"{len(graph.rooms)} rooms, {pieces}"
    house = folder / "house.usda"
    seconds = _timed(lambda: write_stage(graph, house, Settings(seed=seed)))
    own = ("assets", "materials", "house_architecture")
    files = [house, *(file for name in own for file in (folder / name).rglob("*.*"))]
    yield "written in", f"{seconds:.2f} s of processor time"
    yield "folder", f"{sum(file.stat().st_size for file in files) / MIB:.1f} MiB"
    yield "house.usda alone", f"{house.stat().st_size / MIB:.2f} MiB"
    for load in ("all", "none"):
        yield f"opens, payloads {load}", _opening(house, load)
    yield from _bounds_rows(house)
    yield from _blender_rows(house)
    yield from _package_rows(graph, house, seed)


def _opening(house: Path, load: str) -> str:
    """Medians over processes of their own, after the import of pxr."""
    runs = []
    for _ in range(5):
        run = [sys.executable, "-c", OPEN, str(house), load]
        told = subprocess.run(run, check=True, capture_output=True, text=True)
        runs.append([1000.0 * float(word) for word in told.stdout.split()])
    wall, processor = (statistics.median(column) for column in zip(*runs, strict=True))
    return f"{processor:.0f} ms of processor time, {wall:.0f} ms by the clock"


def _bounds_rows(house: Path) -> Iterator[tuple[str, str]]:
    whole, count = _bounds(Usd.Stage.Open(str(house)))
    hinted, bare = _bounds(Usd.Stage.Open(str(house), Usd.Stage.LoadNone))
    off_mm = 1000.0 * np.abs(whole - hinted).max()
    yield "without payloads", f"{bare} meshes of {count}, bounds off by {off_mm:.2f} mm"


def _bounds(stage: Usd.Stage) -> tuple[np.ndarray, int]:
    """(2, 3) bounds of the house, from hints where payloads are closed, and its shown meshes."""
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default", "render"], useExtentsHint=True)
    box = cache.ComputeWorldBound(stage.GetDefaultPrim()).ComputeAlignedRange()
    count = sum(
        prim.IsA(UsdGeom.Mesh) and UsdGeom.Imageable(prim).ComputePurpose() != "guide"
        for prim in Usd.PrimRange(stage.GetPseudoRoot(), _PROXIES)
    )
    return np.array([box.GetMin(), box.GetMax()]), count


def _blender_rows(house: Path) -> Iterator[tuple[str, str]]:
    script = Path(__file__).with_name("blender_import.py")
    run = subprocess.run(
        [sys.executable, str(script), str(house)], check=True, capture_output=True, text=True
    )
    told = json.loads(run.stdout.split("RESULT")[1])
    bounds, count = mesh_bounds(house)
    off_mm = 1000.0 * np.abs(np.array([told["low_m"], told["high_m"]]) - bounds).max()
    yield (
        "Blender imports it in",
        f"{told['processor_s']:.2f} s of processor time, {told['wall_s']:.2f} s by the clock",
    )
    yield "Blender grows by", f"{told['grown_mib']:.0f} MiB, to {told['peak_mib']:.0f} MiB"
    yield (
        "Blender shows",
        f"{told['meshes']} meshes of {count}, bounds off by {off_mm:.2f} mm",
    )


def mesh_bounds(house: Path, *, rendered: bool = True) -> tuple[np.ndarray, int]:
    """(2, 3) bounds of all meshes as UsdGeom has them, without hints, and their number.

    rendered: also what is there for renderers only, the ground, which packages leave out.
    """
    unseen = {"guide"} if rendered else {"guide", "render"}
    stage = Usd.Stage.Open(str(house))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default", "render"])
    boxes = [
        cache.ComputeWorldBound(prim).ComputeAlignedRange()
        for prim in Usd.PrimRange(stage.GetPseudoRoot(), _PROXIES)
        if prim.IsA(UsdGeom.Mesh) and UsdGeom.Imageable(prim).ComputePurpose() not in unseen
    ]
    low = np.min([box.GetMin() for box in boxes], axis=0)
    return np.array([low, np.max([box.GetMax() for box in boxes], axis=0)]), len(boxes)


def _package_rows(graph: SceneGraph, house: Path, seed: int) -> Iterator[tuple[str, str]]:
    zipped = house.with_suffix(".usdz")
    write_stage(graph, zipped, Settings(seed=seed))
    yield "house.usdz", f"{zipped.stat().st_size / MIB:.1f} MiB"
    for package, suffix in (("web", ".usdz"), ("gltf", ".glb")):
        target = house.with_name(f"{package}{suffix}")
        seconds = _timed(lambda t=target, p=package: export_stage(house, t, p))
        size = f"{target.stat().st_size / MIB:.1f} MiB in {seconds:.1f} s of processor time"
        yield f"export for {package}", f"{size}, {_loaded(target, house)}"


def _loaded(target: Path, house: Path) -> str:
    """What a reader finds in a package."""
    bounds, count = mesh_bounds(house, rendered=False)
    what = "meshes"
    if target.suffix == ".glb":
        scene = trimesh.load(target)
        low, high = scene.bounds
        what, found = "primitives for meshes", len(scene.graph.nodes_geometry)
        # glTF has y up: x, z, -y
        theirs = np.array([[low[0], -high[2], low[1]], [high[0], -low[2], high[1]]])
    else:
        theirs, found = mesh_bounds(target)
    off_mm = 1000.0 * np.abs(theirs - bounds).max()
    return f"{found} {what} of {count}, bounds off by {off_mm:.2f} mm"


def _timed(work: Callable[[], object]) -> float:
    before = resource.getrusage(resource.RUSAGE_SELF)
    work()
    after = resource.getrusage(resource.RUSAGE_SELF)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


if __name__ == "__main__":
    main()
