"""Pulls every door, drawer and lid of the furniture open and shut, in MuJoCo on the CPU.

python benchmarks/openable.py [--every N] [--only WORD]
python benchmarks/openable.py --houses HOUSE.usda ...

The second form pulls each joint of houses by force, alone, as `check --open` does.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from pxr import Sdf, Usd, UsdGeom, UsdPhysics
from results import write_section

from chord_usd.base.scene.articulation import ARTICULATION, JOINTED
from chord_usd.library.catalogue import designs
from chord_usd.library.component import write_component
from chord_usd.library.kit.links import opens
from chord_usd.library.kit.model import Design
from chord_usd.library.material import MapShelf
from chord_usd.library.surfaces.surface_maps import MAPS_FOLDER
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.line.stage.check.pulled import OPEN_SHARE, contradictions, pull_joints

STEP_S, REST_S, PULL_S, MOST_S = 1 / 250, 2.0, 1.0, 6.0
_MAP_PX = 16
STRAY_M, STRAY_RAD = 0.001, np.radians(1.0)
"""What is at rest may move so far, and what is pulled may end so far from its limit."""


def main() -> None:
    """Measures and writes benchmarks/RESULTS.md."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--every", type=int, default=1, help="of the designs (default: 1)")
    parser.add_argument("--only", default="", help="designs whose name holds this")
    parser.add_argument("--houses", nargs="+", type=Path, help="stages to pull by force")
    options = parser.parse_args()
    if options.houses:
        _pull_houses(options.houses)
        return
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


def _pull_houses(houses: Sequence[Path]) -> None:
    """Print what stops a joint, where the certificate says otherwise, and how many open."""
    opened = count = contradicted = 0
    for house in houses:
        pulled = pull_joints(house)
        lines = contradictions(check_stage(house).opens, pulled)
        lines += [f"{one.path} stops at {one.share:.0%}" for one in pulled if not one.is_open]
        sys.stdout.write("".join(f"{house}: {line}\n" for line in lines))
        count += len(pulled)
        opened += sum(one.is_open for one in pulled)
        contradicted += sum("by its swept volume" in line for line in lines)
    sys.stdout.write(
        f"{opened} of {count} joints reach {OPEN_SHARE:.0%} of their range by force; "
        f"{contradicted} leaves are judged differently by the certificate\n"
    )


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
    return spec_of(stage.Traverse())


def spec_of(prims: Iterable[Usd.Prim]) -> Any:
    """Rigid bodies, the joints they hang on, and colliders, as a MuJoCo model to be compiled.

    Bodies are direct children of the world, which is where what they hang on stands still.
    """
    chosen = list(prims)
    spec = mujoco.MjSpec()
    spec.option.timestep = STEP_S
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    joints = {
        joint.GetBody1Rel().GetTargets()[0]: joint.GetPrim()
        for joint in map(UsdPhysics.Joint, chosen)
        if joint and not joint.GetPrim().IsA(UsdPhysics.FixedJoint)
    }
    cache = UsdGeom.XformCache()
    bodies: dict[Sdf.Path, tuple[Any, np.ndarray]] = {}
    for prim in chosen:
        if prim.HasAPI(UsdPhysics.RigidBodyAPI):
            at = cache.GetLocalToWorldTransform(prim)
            pose = np.array(at.RemoveScaleShear())
            quat = at.RemoveScaleShear().ExtractRotationQuat()
            body = spec.worldbody.add_body(
                name=str(prim.GetPath()), pos=pose[3, :3],
                quat=[quat.GetReal(), *quat.GetImaginary()],
            )  # fmt: skip
            bodies[prim.GetPath()] = body, np.linalg.inv(pose)
            if prim.GetPath() in joints:
                _add_joint(body, joints[prim.GetPath()])
            body.explicitinertial = False
            body.mass = UsdPhysics.MassAPI(prim).GetMassAttr().Get()
        if prim.HasAPI(UsdPhysics.CollisionAPI):
            above = [path for path in prim.GetPath().GetPrefixes() if path in bodies]
            owner = bodies[above[-1]] if above else (spec.worldbody, np.eye(4))
            _add_geom(spec, prim, owner, np.array(cache.GetLocalToWorldTransform(prim)))
    return spec


def _add_joint(body: Any, joint: Usd.Prim) -> None:
    turns = joint.IsA(UsdPhysics.RevoluteJoint)
    kind = mujoco.mjtJoint.mjJNT_HINGE if turns else mujoco.mjtJoint.mjJNT_SLIDE
    axis = ["X", "Y", "Z"].index(joint.GetAttribute("physics:axis").Get())
    limits = [joint.GetAttribute(f"physics:{end}Limit").Get() for end in ("lower", "upper")]
    damping = UsdPhysics.DriveAPI(joint, "angular" if turns else "linear").GetDampingAttr().Get()
    body.add_joint(
        name=str(joint.GetPath()), type=kind, axis=np.eye(3)[axis], limited=1, range=limits,
        damping=np.degrees(damping) if turns else damping, armature=1e-4,
    )  # fmt: skip


def _add_geom(spec: Any, prim: Usd.Prim, owner: tuple[Any, np.ndarray], matrix: np.ndarray) -> None:
    """A box, or the hull of a mesh. matrix: of the prim in the world; rows are its axes."""
    body, to_body = owner
    own = matrix @ to_body
    name = str(prim.GetPath())
    if prim.IsA(UsdGeom.Cube):
        size = np.linalg.norm(own[:3, :3], axis=1)
        quat = np.empty(4)
        mujoco.mju_mat2Quat(quat, (own[:3, :3] / size[:, None]).T.reshape(-1))
        body.add_geom(
            name=name, type=mujoco.mjtGeom.mjGEOM_BOX, size=size / 2, pos=own[3, :3], quat=quat
        )
        return
    points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get())
    mesh = spec.add_mesh(name=name)
    mesh.uservert = (points @ own[:3, :3] + own[3, :3]).reshape(-1)
    body.add_geom(name=name, type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name)


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
            # Nobody slams it: the last tenth of the way goes slower.
            slow = np.clip(10 * abs(away / wide), 0.2, 1.0)
            data.qfrc_applied[joint] = np.sign(away) * slow * push + data.qfrc_bias[joint]
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
