"""What Blender makes of a stage: every mesh that UsdGeom knows, where UsdGeom has it."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
from pxr import Usd, UsdGeom

IMPORT = Path(__file__).parents[2] / "benchmarks" / "blender_import.py"


def in_blender(stage: Path) -> dict:
    run = subprocess.run(
        [sys.executable, str(IMPORT), str(stage)], check=True, capture_output=True, text=True
    )
    return json.loads(run.stdout.split("RESULT")[1])


def seen_meshes(stage: Usd.Stage) -> list[Usd.Prim]:
    """Meshes of a stage, also those of instances, without what is never rendered."""
    proxies = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
    return [
        prim
        for prim in stage.Traverse(proxies)
        if prim.IsA(UsdGeom.Mesh) and UsdGeom.Imageable(prim).ComputePurpose() != "guide"
    ]


def test_blender_shows_every_mesh_in_its_place(staged_house: Path, stage: Usd.Stage) -> None:
    told = in_blender(staged_house)
    meshes = seen_meshes(stage)
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default", "render"])
    boxes = [cache.ComputeWorldBound(prim).ComputeAlignedRange() for prim in meshes]
    assert told["meshes"] == len(meshes)
    assert np.allclose(told["low_m"], np.min([b.GetMin() for b in boxes], axis=0), atol=1e-4)
    assert np.allclose(told["high_m"], np.max([b.GetMax() for b in boxes], axis=0), atol=1e-4)
