"""What Blender makes of a stage, as JSON: run by stage_sizes.py in a process of its own.

python benchmarks/blender_import.py house.usda
"""

from __future__ import annotations

import json
import re
import resource
import sys
import time
from pathlib import Path
from typing import Any

import bpy
import numpy as np

_NUMBERED = re.compile(r"\.\d{3,}$")


def main() -> None:
    """Imports the stage and tells the costs, how many meshes are shown, and their bounds."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.world = bpy.data.worlds.new("World")
    before = _resident_mib()
    wall, processor = time.perf_counter(), time.process_time()
    bpy.ops.wm.usd_import(filepath=sys.argv[1], set_frame_range=False)
    wall, processor = time.perf_counter() - wall, time.process_time() - processor
    told: dict[str, Any] = {
        "wall_s": wall,
        "processor_s": processor,
        "grown_mib": _resident_mib() - before,
        "peak_mib": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        **_shown(),
        **_names(),
    }
    sys.stdout.write(f"RESULT{json.dumps(told)}\n")


def _shown() -> dict[str, Any]:
    """Meshes that are shown, instances one by one, and the corners of all of them together."""
    count, low, high = 0, np.full(3, np.inf), np.full(3, -np.inf)
    corners: dict[str, np.ndarray] = {}
    for one in bpy.context.evaluated_depsgraph_get().object_instances:
        mesh = one.object
        if mesh.type != "MESH" or not len(mesh.data.vertices):
            continue
        count += 1
        if mesh.data.name not in corners:
            points = np.empty(3 * len(mesh.data.vertices))
            mesh.data.vertices.foreach_get("co", points)
            corners[mesh.data.name] = points.reshape(-1, 3)
        matrix = np.array(one.matrix_world)
        world = corners[mesh.data.name] @ matrix[:3, :3].T + matrix[:3, 3]
        low, high = np.minimum(low, world.min(axis=0)), np.maximum(high, world.max(axis=0))
    return {"meshes": count, "low_m": low.tolist(), "high_m": high.tolist()}


def _names() -> dict[str, int]:
    """How many names Blender gave, and how many end in a number since another has them; without
    the collections `proto`, which are its own."""
    kinds = ("objects", "meshes", "materials", "lights", "cameras", "collections", "images")
    names = [one.name for kind in kinds for one in getattr(bpy.data, kind)]
    names = [name for name in names if not name.startswith("proto")]
    return {"names": len(names), "numbered": sum(bool(_NUMBERED.search(name)) for name in names)}


def _resident_mib() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 2**20


if __name__ == "__main__":
    main()
