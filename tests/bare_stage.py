"""A stage with what a plan is read from and no more: floors and openings, without any walls."""

from __future__ import annotations

from pathlib import Path

from pxr import Gf, Sdf, Usd, UsdGeom

from chord_usd.base.scene.types import Plan
from chord_usd.line.stage.author.names import name_rooms


def write_bare_stage(plan: Plan, path: Path) -> Path:
    """Rooms and openings as an authored house has them; for houses that take long to author."""
    stage = Usd.Stage.CreateNew(str(path))
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/House").GetPrim())
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    for named in name_rooms(plan.scene()):
        room = UsdGeom.Xform.Define(stage, f"/House/Rooms/{named.name}").GetPrim()
        kind = room.CreateAttribute("semantics:labels:room", Sdf.ValueTypeNames.TokenArray)
        kind.Set([named.room.kind])
        parts = f"{room.GetPath()}/Architecture/Geometry"
        floor = UsdGeom.Mesh.Define(stage, f"{parts}/Floor")
        triangles = _triangles(named.room.polygon_m)
        floor.CreatePointsAttr([(float(x), float(y), 0.0) for x, y in named.room.polygon_m])
        floor.CreateFaceVertexCountsAttr([3] * len(triangles))
        floor.CreateFaceVertexIndicesAttr([int(corner) for corner in triangles.ravel()])
        for opening in named.openings:
            box = opening.opening.box
            hole = UsdGeom.Xform.Define(stage, f"{parts}/{opening.name}")
            hole.AddTranslateOp().Set(Gf.Vec3d(*box.center_m))
            hole.AddRotateZOp(UsdGeom.XformOp.PrecisionDouble).Set(box.yaw_deg)
            told = hole.GetPrim()
            told.CreateAttribute("chord:category", Sdf.ValueTypeNames.Token).Set(
                opening.opening.kind
            )
            told.CreateAttribute("chord:size_m", Sdf.ValueTypeNames.Double3).Set(
                Gf.Vec3d(*box.size_m)
            )
    stage.Save()
    return path


def _triangles(corners):  # type: ignore[no-untyped-def]
    import mapbox_earcut
    import numpy as np

    ends = np.array([len(corners)], dtype=np.uint32)
    return mapbox_earcut.triangulate_float64(np.array(corners), ends).reshape(-1, 3)
