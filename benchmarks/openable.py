"""Pulls every door, drawer and lid of the furniture open and shut, in MuJoCo on the CPU.

python benchmarks/openable.py [--every N] [--only WORD]
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from pxr import Usd, UsdGeom, UsdPhysics
from results import write_section

from chord_usd.assets.component import write_component
from chord_usd.assets.furniture.catalogue import designs
from chord_usd.assets.jointed import ARTICULATION, JOINTED
from chord_usd.assets.links import opens
from chord_usd.assets.material import MapShelf
from chord_usd.assets.model import Design
from chord_usd.assets.surface_maps import MAPS_FOLDER

STEP_S, REST_S, PULL_S, MOST_S = 1 / 250, 2.0, 1.0, 6.0
_MAP_PX = 16
STRAY_M, STRAY_RAD = 0.001, np.radians(1.0)
"""What is at rest may move so far, and what is pulled may end so far from its limit."""


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--every", type=int, default=1, help="of the designs (default: 1)")
    parser.add_argument("--only", default="", help="designs whose name holds this")
    options = parser.parse_args()
    chosen = [d for d in designs() if options.only in d.id and opens(d.parts())]
    joints: Counter[str] = Counter()
    faults: list[str] = []
    with tempfile.TemporaryDirectory() as folder:
        for design in chosen[:: options.every]:
            model = jointed_spec(written(design, Path(folder))).compile()
            joints[design.category] += model.njnt
            faults += [f"{design.id}: {fault}" for fault in faults_of(model)]
    sys.stdout.write("".join(f"{fault}\n" for fault in faults))
    if options.only:
        return
    count = sum(joints.values())
    rows = [
        ("designs that open", f"{len(chosen)}, of which pulled {len(chosen[:: options.every])}"),
        ("joints pulled open and shut", f"{count}"),
        ("joints that miss a limit, touch something or drift", f"{len(faults)}"),
    ]
    note = f"`python benchmarks/openable.py --every {options.every}`."
    sys.stdout.write(write_section("stages: what opens", rows, note))


def written(design: Design, folder: Path) -> Path:
    """A design as an asset in its first colours, with hardly any pictures; drawn once."""
    there = folder / design.id / f"{design.id}.usda"
    if there.is_file():
        return there
    name, looks = next(iter(design.colourways.items()))
    plain = replace(design, colourways={name: looks})
    return write_component(plain, folder, maps=MapShelf(folder / MAPS_FOLDER, _MAP_PX))


def jointed_spec(path: Path) -> Any:
    """The jointed form of an asset as a MuJoCo model to be compiled, its base fixed.

    Nothing is filtered: base and leaves that touch are in contact.
    """
    stage = Usd.Stage.Open(str(path))
    stage.GetDefaultPrim().GetVariantSet(ARTICULATION).SetVariantSelection(JOINTED)
    spec = mujoco.MjSpec()
    spec.option.timestep = STEP_S
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    joints = {
        str(joint.GetBody1Rel().GetTargets()[0]): joint.GetPrim()
        for joint in (UsdPhysics.Joint(prim) for prim in stage.Traverse())
        if joint and not joint.GetPrim().IsA(UsdPhysics.FixedJoint)
    }
    cache = UsdGeom.XformCache()
    for prim in stage.Traverse():
        if prim.HasAPI(UsdPhysics.RigidBodyAPI):
            _add_body(spec, prim, joints.get(str(prim.GetPath())), cache)
    return spec


def _add_body(spec: Any, prim: Usd.Prim, joint: Usd.Prim | None, cache: UsdGeom.XformCache) -> None:
    at = cache.GetLocalToWorldTransform(prim)
    origin = np.array(at.ExtractTranslation())
    body = spec.worldbody.add_body(name=prim.GetName(), pos=origin)
    if joint is not None:
        turns = joint.IsA(UsdPhysics.RevoluteJoint)
        kind = mujoco.mjtJoint.mjJNT_HINGE if turns else mujoco.mjtJoint.mjJNT_SLIDE
        axis = ["X", "Y", "Z"].index(joint.GetAttribute("physics:axis").Get())
        low, high = (joint.GetAttribute(f"physics:{end}Limit").Get() for end in ("lower", "upper"))
        drive = UsdPhysics.DriveAPI(joint, "angular" if turns else "linear")
        damping = drive.GetDampingAttr().Get()
        body.add_joint(
            name=joint.GetName(), type=kind, axis=np.eye(3)[axis], limited=1,
            range=[low, high],
            damping=np.degrees(damping) if turns else damping, armature=1e-4,
        )  # fmt: skip
    boxes = 0
    for collider in Usd.PrimRange(prim):
        if not collider.HasAPI(UsdPhysics.CollisionAPI):
            continue
        matrix = np.array(cache.GetLocalToWorldTransform(collider))
        if collider.IsA(UsdGeom.Cube):
            boxes += 1
            half = np.linalg.norm(matrix[:3, :3], axis=1) / 2
            body.add_geom(
                name=f"{prim.GetName()}/{collider.GetName()}", type=mujoco.mjtGeom.mjGEOM_BOX,
                size=half, pos=matrix[3, :3] - origin,
            )  # fmt: skip
        else:
            boxes += 1
            points = np.array(UsdGeom.Mesh(collider).GetPointsAttr().Get())
            mesh = spec.add_mesh(name=f"{prim.GetName()}/{collider.GetName()}")
            mesh.uservert = (points + matrix[3, :3] - origin).reshape(-1)
            body.add_geom(name=mesh.name, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh.name)
    if not boxes:
        raise ValueError(f"{prim.GetPath()} is felt nowhere")
    body.explicitinertial = False
    body.mass = UsdPhysics.MassAPI(prim).GetMassAttr().Get()


def faults_of(model: mujoco.MjModel) -> Iterator[str]:
    """What is wrong with a jointed piece, a line each; joints one by one."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    yield from _touches(model, data, "shut")
    for _ in range(round(REST_S / STEP_S)):
        mujoco.mj_step(model, data)
    yield from _touches(model, data, "at rest")
    for joint in range(model.njnt):
        if abs(data.qpos[joint]) > _stray(model, joint):
            yield f"{model.joint(joint).name} drifts by {data.qpos[joint]:.4f}"
    for joint in range(model.njnt):
        yield from _pull(model, joint)


def _stray(model: mujoco.MjModel, joint: int) -> float:
    turns = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE
    return float(STRAY_RAD if turns else STRAY_M)


def _pull(model: mujoco.MjModel, joint: int) -> Iterator[str]:
    """Open, then shut, by a force that overcomes damping and weight."""
    data = mujoco.MjData(model)
    name = model.joint(joint).name
    low, high = model.jnt_range[joint]
    wide = low if abs(low) > abs(high) else high
    push = 1.5 * model.dof_damping[joint] * abs(wide) / PULL_S
    for target, word in ((wide, "open"), (0.0, "shut")):
        for _ in range(round(MOST_S / STEP_S)):
            away = target - data.qpos[joint]
            if abs(away) < _stray(model, joint):
                break
            data.qfrc_applied[joint] = np.sign(away) * push + data.qfrc_bias[joint]
            mujoco.mj_step(model, data)
            if data.ncon:
                yield from _touches(model, data, f"while {name} goes {word}")
                return
        else:
            yield f"{name} stops at {data.qpos[joint]:.3f}, {word} is {target:.3f}"
            return


def _touches(model: mujoco.MjModel, data: mujoco.MjData, when: str) -> Iterator[str]:
    pairs = {tuple(sorted(model.geom(g).name for g in contact.geom)) for contact in data.contact}
    for one, other in sorted(pairs):
        yield f"{one} touches {other} {when}"


if __name__ == "__main__":
    main()
