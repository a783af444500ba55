"""A grasp tried in MuJoCo: the gripper closes, lifts by 10 cm, and holds for 3 s."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from pxr import Usd, UsdGeom

from chord_usd.base.runtime.extras import needed_for
from chord_usd.base.runtime.stages import open_stage
from chord_usd.base.scene.palette import usual_mass_kg
from chord_usd.base.scene.types import Asset, FloatArray
from chord_usd.library.grasps import OPEN_M, PAD_M, PALM_M, TIP_M, Grasp, candidates
from chord_usd.library.prop import GRASPS

LIFT_M, HOLD_S = 0.10, 3.0
KEPT, TRIED = 3, 16
"""Grasps that are kept of an asset, and the most that are tried."""

_FORCE_N, _DAMPING_NS_PER_M = 40.0, 200.0
"""Of each finger, which so closes at 20 cm a second."""

_CLOSE_S, _LIFT_S, _STEP_S = 0.5, 1.0, 0.002
_SLIP_M = 0.02
"""What was between the pads is no farther from them: a thing may swing between them."""
_HOLLOW = 0.6
"""A solid that fills less of its hull collides as pieces of its wall."""

_SECTORS, _BANDS = 12, 4


@dataclass(frozen=True, eq=False)
class Trial:
    """What became of an asset."""

    held: tuple[Grasp, ...]
    tried: int
    floor_m: float

    def record(self) -> dict[str, Any]:
        """As grasps.json has it: metres and axes in the frame of the asset."""
        return {
            "gripper": {"opens": OPEN_M, "force": _FORCE_N, "tip": TIP_M},
            "tried": self.tried,
            "grasps": [
                {
                    "position": np.round(grasp.middle_m, 5).tolist(),
                    "closes": np.round(grasp.axes[:, 0], 5).tolist(),
                    "approach": np.round(grasp.axes[:, 2], 5).tolist(),
                    "width": round(grasp.width_m, 5),
                    "from_support": grasp.clears_floor(self.floor_m),
                }
                for grasp in self.held
            ],
        }


def try_asset(asset: Asset) -> Trial:
    """Grasps that hold an asset, of at most TRIED. Raises MissingExtraError without MuJoCo."""
    mesh = seen_mesh(asset.usd_path)
    parts = convex_parts(mesh)
    mass_kg = usual_mass_kg(asset.category, asset.size_m)
    held, tried = [], 0
    for grasp in itertools.islice(_spread(candidates(mesh)), TRIED):
        tried += 1
        if holds(grasp, parts, mass_kg):
            held.append(grasp)
        if len(held) == KEPT:
            break
    return Trial(tuple(held), tried, float(mesh.bounds[0, 2]))


def write_grasps(asset: Asset) -> Trial:
    """Write grasps.json beside the asset's interface, from where houses copy it."""
    trial = try_asset(asset)
    text = json.dumps(trial.record(), indent=1) + "\n"
    (Path(asset.usd_path).parent / GRASPS).write_text(text, encoding="utf-8")
    return trial


def _spread(grasps: Iterator[Grasp]) -> Iterator[Grasp]:
    """Grasps that differ: not the next centimetre along the same edge, nor a small turn."""
    kept: list[Grasp] = []
    for grasp in grasps:
        alike = (
            np.linalg.norm(grasp.middle_m - other.middle_m) < 0.01
            and grasp.axes[:, 2] @ other.axes[:, 2] > 0.9
            for other in kept
        )
        if not any(alike):
            kept.append(grasp)
            yield grasp


def seen_mesh(interface: Path) -> trimesh.Trimesh:
    """All that is seen of an asset, in its frame, triangles with outward normals."""
    stage = open_stage(interface)
    frames = UsdGeom.XformCache()
    meshes = []
    for prim in Usd.PrimRange(stage.GetDefaultPrim(), Usd.TraverseInstanceProxies()):
        shape = UsdGeom.Mesh(prim)
        if not shape or shape.ComputePurpose() == UsdGeom.Tokens.guide:
            continue
        matrix = np.array(frames.GetLocalToWorldTransform(prim))
        points = np.array(shape.GetPointsAttr().Get(), float) @ matrix[:3, :3] + matrix[3, :3]
        counts = np.array(shape.GetFaceVertexCountsAttr().Get())
        indices = np.array(shape.GetFaceVertexIndicesAttr().Get())
        starts = np.concatenate([[0], np.cumsum(counts)[:-1]])
        faces = [
            (indices[start], indices[start + k], indices[start + k + 1])
            for start, count in zip(starts, counts, strict=True)
            for k in range(1, count - 1)
        ]
        meshes.append(trimesh.Trimesh(points, np.array(faces)))
    whole = trimesh.util.concatenate(meshes)
    assert isinstance(whole, trimesh.Trimesh)
    return whole


def convex_parts(mesh: trimesh.Trimesh) -> list[FloatArray]:
    """(N, 3) points of each convex part: connected solids, hollow ones piece by piece."""
    parts: list[FloatArray] = []
    for solid in mesh.split(only_watertight=False):
        if _is_flat(solid.vertices):
            continue
        hull = solid.convex_hull
        if abs(solid.volume) > _HOLLOW * hull.volume:
            parts.append(np.asarray(hull.vertices))
        else:
            parts += _wall(solid)
    return parts or [np.asarray(mesh.convex_hull.vertices)]


def _wall(solid: trimesh.Trimesh) -> Iterator[FloatArray]:
    """Points of the pieces of a wall around an upright axis."""
    fine = solid.subdivide_to_size(float(solid.extents.max()) / 4)
    assert isinstance(fine, trimesh.Trimesh)
    middles = fine.triangles_center - fine.bounds.mean(axis=0)
    sector = np.floor((np.arctan2(middles[:, 1], middles[:, 0]) / (2 * np.pi) + 0.5) * _SECTORS)
    band = np.floor((middles[:, 2] / max(float(fine.extents[2]), 1e-6) + 0.5) * _BANDS)
    bins = sector * _BANDS + np.clip(band, 0, _BANDS - 1)
    for number in np.unique(bins):
        points = np.unique(fine.triangles[bins == number].reshape(-1, 3).round(6), axis=0)
        if not _is_flat(points):
            yield points


def _is_flat(points: FloatArray) -> bool:
    """Whether points make no solid."""
    if len(points) < 4:
        return True
    spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return bool(spread[-1] < 1e-5)


def holds(grasp: Grasp, parts: Sequence[FloatArray], mass_kg: float) -> bool:
    """Whether the gripper still has the thing 3 s after it was lifted by 10 cm."""
    with needed_for("assets grasps"):
        import mujoco
    up = grasp.axes.T @ np.array([0.0, 0.0, 1.0])
    model = _model(grasp, parts, mass_kg, up)
    data = mujoco.MjData(model)
    fingers = [model.actuator(f"finger_{side}").id for side in (0, 1)]
    lift, thing = model.actuator("lift").id, model.body("thing").id
    data.ctrl[fingers] = _FORCE_N
    mujoco.mj_forward(model, data)
    model.opt.gravity[:] = 0.0  # until it is held
    while data.time < _CLOSE_S:
        mujoco.mj_step(model, data)
    start = data.xpos[thing].copy()
    model.opt.gravity[:] = -9.81 * up
    while data.time < _CLOSE_S + _LIFT_S + HOLD_S:
        data.ctrl[lift] = LIFT_M * min((data.time - _CLOSE_S) / _LIFT_S, 1.0)
        mujoco.mj_step(model, data)
    return bool(np.linalg.norm(data.xpos[thing] - start - LIFT_M * up) < _SLIP_M)


def _model(grasp: Grasp, parts: Sequence[FloatArray], mass_kg: float, up: FloatArray) -> Any:
    """The gripper at its own origin, which rises along up, and the thing between its pads."""
    import mujoco

    spec = mujoco.MjSpec()
    spec.option.timestep, spec.option.impratio = _STEP_S, 10.0
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.gravity = (-9.81 * up).tolist()
    box, slide = mujoco.mjtGeom.mjGEOM_BOX, mujoco.mjtJoint.mjJNT_SLIDE
    palm = spec.worldbody.add_body(name="palm", gravcomp=1.0)
    palm.add_joint(name="lift", type=slide, axis=up.tolist())
    at, half = (0.0, 0.0, -PALM_M - 0.012), (OPEN_M / 2, 0.02, 0.01)
    palm.add_geom(type=box, pos=at, size=half, mass=0.5)
    _driven(spec, "lift", 20_000.0, 600.0)
    for side, sign in enumerate((-1.0, 1.0)):
        finger = palm.add_body(name=f"finger_{side}", gravcomp=1.0)
        finger.add_joint(
            name=f"finger_{side}", type=slide, axis=[-sign, 0, 0], damping=_DAMPING_NS_PER_M,
            range=[0.0, OPEN_M / 2], limited=True,
        )  # fmt: skip
        x = sign * (OPEN_M + PAD_M[0]) / 2
        z = TIP_M - PAD_M[2] / 2
        finger.add_geom(
            type=box, pos=[x, 0, z], size=[v / 2 for v in PAD_M], mass=0.1,
            friction=[1.0, 0.01, 0.0001], condim=4,
        )  # fmt: skip
        motor = spec.add_actuator(name=f"finger_{side}", target=f"finger_{side}")
        motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
    pair = spec.add_equality(name1="finger_0", name2="finger_1", data=[0, 1, *[0] * 10])
    pair.type, pair.objtype = mujoco.mjtEq.mjEQ_JOINT, mujoco.mjtObj.mjOBJ_JOINT
    thing = spec.worldbody.add_body(name="thing")
    thing.add_freejoint()
    for number, points in enumerate(parts):
        spec.add_mesh(name=f"part_{number}", uservert=grasp.in_gripper(points).ravel().tolist())
        thing.add_geom(
            type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"part_{number}", condim=4,
            mass=mass_kg / len(parts), friction=[0.6, 0.01, 0.0001],
        )  # fmt: skip
    return spec.compile()


def _driven(spec: Any, joint: str, stiffness: float, damping: float) -> None:
    """A position actuator."""
    import mujoco

    motor = spec.add_actuator(name=joint, target=joint)
    motor.trntype = mujoco.mjtTrn.mjTRN_JOINT
    motor.biastype = mujoco.mjtBias.mjBIAS_AFFINE
    motor.gainprm[0] = stiffness
    motor.biasprm[:3] = [0.0, -stiffness, -damping]
