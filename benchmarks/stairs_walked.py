"""A walker goes up every stair of procedural houses in mujoco: a capsule on a leg.

    python benchmarks/stairs_walked.py [--houses N] [--first SEED] [--form FORM]

The capsule, 70 kg and 1.7 m high, is pushed along the stair's walking line at half a metre a
second. A leg, as characters in games have one, holds it over the highest ground near its foot; it
takes steps of up to 25 cm. What it touches on its way is reported: headroom or width is missing.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import get_args

import mujoco
import numpy as np
from pxr import Usd
from results import write_section

from chord_usd.base.scene.stacking import stack
from chord_usd.base.scene.storeys import StairForm
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.author.author_stage import author_levels
from chord_usd.line.stage.author.stage_levels import levels_of
from chord_usd.line.stage.check.check_scene import read_storeys
from chord_usd.line.stage.export.export_stage import export_stage
from chord_usd.workshop.data.storey_houses import random_storeys

_APART = 50_000
"""Seeds of houses begin here, as in storeys_certificate.py."""

RADIUS_M, HEIGHT_M, LEG_M, MASS_KG = 0.2, 1.7, 0.3, 70.0
STEP_M, SPEED_M_S, LONGEST_S = 0.25, 0.5, 60.0
_FEET_M = ((0.0, 0.0), (0.12, 0.0), (-0.12, 0.0), (0.0, 0.12), (0.0, -0.12))
_PUSH_N = 600.0
_FELT = np.array([0, 0, 0, 1, 0, 0], np.uint8)
"""The group of geoms that are felt, and not only seen."""


@dataclass(frozen=True)
class Ascent:
    """How one walker got on."""

    arrives: bool
    seconds: float
    touched_mm: float
    """How deep it was pressed into anything."""


def climb(model_file: Path, walk_m: FloatArray) -> Ascent:
    """Walk a line, (N, 3), through the house of an MJCF file."""
    model, foot_z = _with_walker(model_file, walk_m[0])
    data = mujoco.MjData(model)
    dofs = [model.joint(f"walker_{axis}").dofadr[0] for axis in "xyz"]
    body = model.body("walker").id
    start = model.body_pos[body].copy()
    steps = np.hypot(*np.diff(walk_m[:, :2], axis=0).T)
    along = np.concatenate([[0.0], np.cumsum(steps)])
    gone, touched = 0.0, 0.0
    while data.time < LONGEST_S:
        at, speed = start + data.qpos[dofs], data.qvel[dofs]
        target = np.array([np.interp(gone, along, walk_m[:, axis]) for axis in (0, 1)])
        behind = target - at[:2]
        if np.hypot(*behind) < RADIUS_M:
            gone = min(gone + SPEED_M_S * model.opt.timestep, along[-1])
        push = MASS_KG * (40.0 * behind - 12.0 * speed[:2])
        data.qfrc_applied[dofs[:2]] = push * min(1.0, _PUSH_N / max(np.hypot(*push), 1e-9))
        data.qfrc_applied[dofs[2]] = _lift(model, data, body, at, float(speed[2]), foot_z)
        mujoco.mj_step(model, data)
        touched = max([touched, *(-contact.dist for contact in data.contact[: data.ncon])])
        if gone >= along[-1] and np.hypot(*behind) < RADIUS_M / 2:
            break
    at = start + data.qpos[dofs]
    arrives = gone >= along[-1] and abs(at[2] - foot_z - walk_m[-1, 2]) < 0.05
    return Ascent(bool(arrives), float(data.time), 1000.0 * touched)


def _with_walker(model_file: Path, start_m: FloatArray) -> tuple[mujoco.MjModel, float]:
    """The house with a walker at a place, and how high the walker's middle is over its feet."""
    spec = mujoco.MjSpec.from_file(str(model_file))
    half = (HEIGHT_M - LEG_M) / 2 - RADIUS_M
    foot_z = LEG_M + half + RADIUS_M
    walker = spec.worldbody.add_body(name="walker", pos=[*start_m[:2], start_m[2] + foot_z])
    for name, axis in zip("xyz", np.eye(3), strict=True):
        walker.add_joint(name=f"walker_{name}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
    walker.add_geom(
        type=mujoco.mjtGeom.mjGEOM_CAPSULE, size=[RADIUS_M, half, 0.0], mass=MASS_KG, group=3,
        friction=[0.05, 0.001, 0.0001],
    )  # fmt: skip
    return spec.compile(), foot_z


def _lift(
    model: mujoco.MjModel, data: mujoco.MjData, body: int, at: FloatArray, rising: float,
    foot_z: float,
) -> float:  # fmt: skip
    """What the leg bears: most where the ground is nearest; nothing where there is none."""
    met = np.array([-1], np.int32)
    down = np.array([0.0, 0.0, -1.0])
    heights = [
        mujoco.mj_ray(
            model, data, np.array([at[0] + x, at[1] + y, at[2]]), down, _FELT, 1, body, met
        )
        for x, y in _FEET_M
    ]
    ground = min((height for height in heights if height > 0.0), default=np.inf)
    if ground > foot_z + STEP_M:
        return 0.0
    wanted = 9.81 + 150.0 * (foot_z - ground) - 25.0 * rising
    return float(np.clip(MASS_KG * wanted, 0.0, 3 * MASS_KG * 9.81))


def _ascents(seed: int, folder: Path, forms: Sequence[StairForm]) -> list[tuple[str, Ascent]]:
    """Of all stairs of an unfurnished house, with their forms."""
    rng, storeys = np.random.default_rng(_APART + seed), 3 if seed % 4 == 0 else 2
    made = stack(random_storeys(rng, storeys, forms))
    house = folder / "house.usda"
    author_levels(levels_of(made, [storey.plan.scene() for storey in made.storeys]), house)
    export_stage(house, folder / "mujoco", "mujoco")
    storeys = read_storeys(Usd.Stage.Open(str(house)))
    lines = [
        stair.walk_m + np.array([0.0, 0.0, storey.elevation_m])
        for storey in storeys
        for stair in storey.stairs
    ]
    named = [climbed.built.stair.form for climbed in made.climbs]
    model_file = folder / "mujoco" / "model.xml"
    return [(form, climb(model_file, line)) for form, line in zip(named, lines, strict=True)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--houses", type=int, default=100)
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--form", choices=get_args(StairForm))
    options = parser.parse_args()
    drawn: tuple[StairForm, ...] = (options.form,) if options.form else get_args(StairForm)
    found: list[tuple[str, Ascent]] = []
    for seed in range(options.first, options.first + options.houses):
        with tempfile.TemporaryDirectory() as folder:
            own = _ascents(seed, Path(folder), drawn)
        found += own
    forms = {form: [one for name, one in found if name == form] for form in get_args(StairForm)}
    rows = [
        (
            f"{form} stairs",
            f"{sum(one.arrives for one in own)} of {len(own)} walked up, "
            f"{np.median([one.seconds for one in own]):.0f} s; "
            f"{sum(one.touched_mm > 1.0 for one in own)} with something in the way",
        )
        for form, own in forms.items()
        if own
    ]
    note = f"{options.houses} procedural houses, every fourth of three storeys, unfurnished."
    title = (
        f"stages: {options.form} stairs walked up" if options.form else "stages: stairs walked up"
    )
    write_section(title, rows, note)


if __name__ == "__main__":
    main()
