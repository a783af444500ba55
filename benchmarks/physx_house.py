"""A house in PhysX, on the CPU: what moves at rest, and how far joints open by force.

    ENVIRONMENT/bin/python benchmarks/physx_house.py HOUSE.usda ... [--pull]

The environment needs `pip install ovphysx physx-usd-schemas newton-usd-schemas usd-core`. At rest
no body may move 1 cm in two seconds. With `--pull` furniture is jointed, and hinges are pulled by
30 N m, slides by 80 N, for 1.6 s, as `chord-usd check --open` pulls them in MuJoCo: one joint of
each piece at a time, and alone where it does not reach 90 % of its range. Exit code 1 where a body
moves, or a joint stays below half.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import ovphysx
import ovstage
from ovphysx import PhysX
from ovphysx.samples.python_samples.schema_support import physx_schema_paths
from ovphysx.types import ObjectScope, SimObjectType
from pxr import Sdf, Usd, UsdPhysics

STEP_S, REST_S, PULL_S, STRAY_M = 1 / 240, 2.0, 1.6, 0.01
PULLS = {"angular": (UsdPhysics.RevoluteJoint, 30.0), "linear": (UsdPhysics.PrismaticJoint, 80.0)}
"""By kind of drive: the joints it moves, and the largest torque in N m or force in N."""

STIFF = 1e6
"""Of a drive towards the limit, so that its force is the largest all the way."""

OPEN_SHARE, STUCK_SHARE = 0.9, 0.5

Pose = tuple[np.ndarray, np.ndarray]
"""Position in m, (3,), and orientation, xyzw."""


def main() -> int:
    """Prints a line for each fault and the counts; returns the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("stages", type=Path, nargs="+")
    parser.add_argument("--pull", action="store_true", help="pull every joint by force")
    options = parser.parse_args()
    PhysX.set_cpu_mode(True)
    schemas = [*map(str, physx_schema_paths()), str(ovphysx.newton_schema_root())]
    ovstage.population.register_usd_schemas(schemas)
    physx = PhysX()
    try:
        judge = pulled if options.pull else rested
        return max(judge(physx, stage.resolve()) for stage in options.stages)
    finally:
        physx.destroy()


def rested(physx: Any, stage: Path) -> int:
    """Let a house stand still; 1 where a body moves."""
    with simulated(physx, stage) as poses:
        before = poses(0.0)
        after = poses(REST_S)
    moved_m = {path: np.linalg.norm(after[path][0] - before[path][0]) for path in before}
    astray = {path: far for path, far in moved_m.items() if far >= STRAY_M}
    for path, far in astray.items():
        _say(f"{stage}: {path} moved {far:.3f} m")
    most_mm = 1000 * max(moved_m.values(), default=0.0)
    _say(f"{stage}: {len(moved_m)} bodies, {len(astray)} moved 1 cm, at most {most_mm:.1f} mm")
    return int(bool(astray) or not moved_m)


def pulled(physx: Any, stage: Path) -> int:
    """Pull all joints of a house; 1 where a joint stays below half of its range."""
    shares: dict[Sdf.Path, float] = {}
    with tempfile.TemporaryDirectory() as folder:
        jointed = _jointed(stage, Path(folder))
        joints = list(_joints(jointed))
        pieces: dict[Sdf.Path, list[Sdf.Path]] = {}
        for joint in joints:
            pieces.setdefault(joint.GetParentPath(), []).append(joint)
        for number in range(max(map(len, pieces.values()), default=0)):
            together = [own[number] for own in pieces.values() if number < len(own)]
            shares |= _opened(physx, jointed, together)
        for joint in joints:
            if shares[joint] < OPEN_SHARE:
                shares |= _opened(physx, jointed, [joint])
    for joint, share in shares.items():
        if share < OPEN_SHARE:
            _say(f"{stage}: {joint} stops at {share:.0%}")
    reached = sum(share >= OPEN_SHARE for share in shares.values())
    _say(f"{stage}: {reached} of {len(shares)} joints reach {OPEN_SHARE:.0%}")
    return int(any(share < STUCK_SHARE for share in shares.values()))


def _say(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def _jointed(stage: Path, folder: Path) -> Path:
    """A stage over this one in which all furniture that can is jointed."""
    over = Usd.Stage.CreateNew(str(folder / "jointed.usda"))
    over.GetRootLayer().subLayerPaths = [str(stage)]
    source = Sdf.Layer.FindOrOpen(str(stage))
    over.GetRootLayer().defaultPrim = source.defaultPrim
    for key in ("upAxis", "metersPerUnit", "kilogramsPerUnit"):
        over.SetMetadata(key, source.pseudoRoot.GetInfo(key))
    for prim in list(over.Traverse()):
        choice = prim.GetVariantSets().GetVariantSet("articulation")
        if "jointed" in choice.GetVariantNames():
            choice.SetVariantSelection("jointed")
    over.Save()
    return folder / "jointed.usda"


def _joints(stage: Path) -> Iterator[Sdf.Path]:
    kinds = [kind for kind, _ in PULLS.values()]
    opened = Usd.Stage.Open(str(stage))
    for prim in opened.Traverse():
        if any(prim.IsA(kind) for kind in kinds):
            yield prim.GetPath()


def _opened(physx: Any, jointed: Path, joints: Sequence[Sdf.Path]) -> dict[Sdf.Path, float]:
    """Share of its range, [0, 1], to which each of some joints opens when they are pulled."""
    layer = Sdf.Layer.CreateNew(
        str(jointed.with_name(f"pull_{len(list(jointed.parent.iterdir()))}.usda"))
    )
    layer.subLayerPaths = [f"./{jointed.name}"]
    stage = Usd.Stage.Open(layer)
    for key in ("upAxis", "metersPerUnit", "kilogramsPerUnit"):
        stage.SetMetadata(key, Sdf.Layer.FindOrOpen(str(jointed)).pseudoRoot.GetInfo(key))
    ends = {joint: _drive(stage.GetPrimAtPath(joint)) for joint in joints}
    layer.Save()
    with simulated(physx, Path(layer.realPath)) as poses:
        before, after = poses(0.0), poses(PULL_S)
    return {
        joint: _turn(kind, before, after, bodies) / abs(widest)
        for joint, (kind, widest, bodies) in ends.items()
    }


def _drive(prim: Usd.Prim) -> tuple[str, float, tuple[str, str]]:
    """Let a drive pull a joint to its farther limit; its kind, this limit, and both bodies."""
    kind = next(name for name, (of, _) in PULLS.items() if prim.IsA(of))
    limits = [prim.GetAttribute(f"physics:{end}Limit").Get() for end in ("lower", "upper")]
    widest = max(limits, key=abs)
    drive = UsdPhysics.DriveAPI.Apply(prim, kind)
    drive.CreateStiffnessAttr(STIFF)
    drive.CreateTargetPositionAttr(widest)
    drive.CreateMaxForceAttr(PULLS[kind][1])
    joint = UsdPhysics.Joint(prim)
    (base,), (tip,) = joint.GetBody0Rel().GetTargets(), joint.GetBody1Rel().GetTargets()
    return kind, widest, (str(base), str(tip))


def _turn(
    kind: str, before: dict[str, Pose], after: dict[str, Pose], bodies: tuple[str, str]
) -> float:
    """How far the second body turned, in degrees, or slid, in m, as the first sees it."""
    still = (np.zeros(3), np.array([0.0, 0.0, 0.0, 1.0]))
    at, turn = zip(
        *(_seen(where.get(bodies[0], still), where[bodies[1]]) for where in (before, after)),
        strict=True,
    )
    if kind == "linear":
        return float(np.linalg.norm(at[1] - at[0]))
    return float(np.degrees(2 * np.arccos(np.clip(abs(turn[0] @ turn[1]), 0.0, 1.0))))


def _seen(base: Pose, tip: Pose) -> Pose:
    """A pose in the frame of another."""
    back = base[1] * np.array([-1.0, -1.0, -1.0, 1.0])
    along, real = back[:3], back[3]
    way = tip[0] - base[0]
    at = way + 2 * np.cross(along, np.cross(along, way) + real * way)
    x, y = tip[1][:3], tip[1][3]
    turn = np.append(real * x + y * along + np.cross(along, x), real * y - along @ x)
    return at, turn


@contextmanager
def simulated(physx: Any, path: Path) -> Iterator[Any]:
    """A function of seconds: the poses of all bodies after so many more, by path."""
    stage = ovstage.Stage(path.stem)
    try:
        domains = ovstage.PopulationDomain.ALL
        ovstage.population.open_usd(stage, str(path), ordinal=1, domains=domains)
        stage.advance_write_floor(ordinal=1).wait()
        physx.wait_task(physx.attach_ovstage(stage, read_ordinal=1))

        def poses(seconds: float) -> dict[str, Pose]:
            for _ in range(round(seconds / STEP_S)):
                physx.step_sync(STEP_S)
            return _poses(physx, stage)

        yield poses
        physx.wait_task(physx.detach_ovstage())
    finally:
        stage.destroy()


def _poses(physx: Any, stage: Any) -> dict[str, Pose]:
    values: dict[str, list[dict[str, np.ndarray]]] = {}
    with ovstage.PathDictionary(stage) as paths:
        for kind in (SimObjectType.RIGID_BODY, SimObjectType.ARTICULATION_LINK):
            columns = []
            for name in ("position", "orientation"):
                rows: dict[str, np.ndarray] = {}
                with physx.read_sync(kind, [name], scope=ObjectScope.ALL) as result:
                    for group in result.groups:
                        if not group.is_delete and group.tensors:
                            array = np.array(group.tensors[0].numpy(), dtype=np.float64)
                            rows |= zip(paths.get_path_strings(group.prim_list), array, strict=True)
                columns.append(rows)
            values |= {path: [columns[0][path], columns[1][path]] for path in columns[0]}
    return {path: (at, turn) for path, (at, turn) in values.items()}


if __name__ == "__main__":
    sys.exit(main())
