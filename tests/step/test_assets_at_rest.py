"""Whatever people move stays where it is put: designs on a floor, felt as their colliders."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from chord_usd.base.scene.palette import CATEGORIES, having
from chord_usd.library.catalogue import designs
from chord_usd.library.kit.model import Design
from chord_usd.line.stage.author.physics import GRAVITY_M_PER_S2
from tests.every import for_every

MOVABLE = [design for design in designs() if design.category in having("moved")]
STEP_S, SECONDS = 1 / 240, 2.0
MOST_M, MOST_RAD = 0.01, 0.1
APART_M = 4.0
"""Between the middles of two designs on the floor."""

FOOT_M = 0.002
"""What is lower stands on the floor."""

BESIDE_M = 0.02
"""So far from all that is felt a foot may reach."""


def ends_of(chosen: Sequence[Design]) -> list[Design]:
    """Of designs that differ in size only, the smallest and the largest."""
    found: dict[str, Design] = {}
    for design in sorted(chosen, key=lambda one: one.size_m[0] * one.size_m[1]):
        form = re.sub(r"_\d+x\d+$", "", design.id)
        found[f"{form}/{int(f'{form}/0' in found)}"] = design
    return list(found.values())


@for_every("design", MOVABLE, ids=lambda design: design.id, step=4)
def test_what_is_seen_to_stand_is_felt_to_stand(design: Design) -> None:
    """Feet that nothing feels let a piece sink to its colliders, or tip over."""
    parts = design.parts()
    felt = [box for part in parts for box in part.collider_boxes_m().values()]
    soles = np.array([box for box in felt if box[0, 2] < FOOT_M])
    for part in parts:
        low = part.solid.points_m
        feet = low[low[:, 2] < FOOT_M][:, None, :2]
        beside = np.maximum(soles[:, 0, :2] - feet, feet - soles[:, 1, :2]).max(axis=2)
        assert np.all(beside.min(axis=1) < BESIDE_M), part.name


def test_what_is_movable_stays_where_it_is_put() -> None:
    chosen = ends_of(MOVABLE)
    model = floor_with(chosen)
    data = mujoco.MjData(model)
    before = data.qpos.reshape(-1, 7).copy()
    for _ in range(round(SECONDS / STEP_S)):
        mujoco.mj_step(model, data)
    after = data.qpos.reshape(-1, 7)
    moved = np.linalg.norm(after[:, :3] - before[:, :3], axis=1)
    turned = 2 * np.arccos(np.clip(np.abs((after[:, 3:] * before[:, 3:]).sum(axis=1)), 0.0, 1.0))
    restless = {
        design.id: (round(float(m), 3), round(float(t), 3))
        for design, m, t in zip(chosen, moved, turned, strict=True)
        if not (m < MOST_M and t < MOST_RAD)
    }
    assert restless == {}


def floor_with(chosen: Sequence[Design]) -> Any:
    """A MuJoCo model: designs as free bodies in rows on a floor."""
    spec = mujoco.MjSpec()
    spec.option.timestep = STEP_S
    spec.option.gravity = (0.0, 0.0, -GRAVITY_M_PER_S2)
    columns = int(np.ceil(np.sqrt(len(chosen))))
    reach = APART_M * (columns + 1)
    box = mujoco.mjtGeom.mjGEOM_BOX
    spec.worldbody.add_geom(type=box, size=(reach, reach, 0.1), pos=(0.0, 0.0, -0.1))
    for index, design in enumerate(chosen):
        row, column = divmod(index, columns)
        at = (APART_M * (column - columns / 2), APART_M * (row - columns / 2), 0.0)
        _add_body(spec, design, at)
    return spec.compile()


def _add_body(spec: Any, design: Design, at_m: tuple[float, float, float]) -> None:
    body = spec.worldbody.add_body(pos=at_m)
    body.add_freejoint()
    parts = design.parts()
    boxes = [bounds for part in parts for bounds in part.collider_boxes_m().values()]
    mass = CATEGORIES[design.category].kg_per_m3 * float(np.prod(design.size_m))
    density = mass / sum(float(np.prod(high - low)) for low, high in boxes)
    for low, high in boxes:
        body.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX,
            size=(high - low) / 2,
            pos=(high + low) / 2,
            density=density,
        )
    for part in parts:
        if part.collider == "convexHull":
            mesh = spec.add_mesh(name=f"{design.id}/{part.name}")
            mesh.uservert = part.solid.points_m.astype(np.float32).ravel()
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh.name, density=density)


BALL_M = 0.015


def test_what_is_put_into_a_hollow_thing_lies_in_it() -> None:
    """A ball over the drain comes to rest on it: solvers would throw it out of a hull."""
    hollow = [one for one in designs() if one.category in ("shower", "bathtub", "washbasin")]
    lost = {}
    for design in ends_of(hollow):
        drain = next(part.solid.bounds_m() for part in design.parts() if part.name == "Drain")
        # Of several bowls in a row it is over the first one.
        x = drain[0, 0] + (drain[1, 1] - drain[0, 1]) / 2
        at = np.array([x, drain[:, 1].mean(), drain[1, 2] + 0.05])
        moved = _fallen(design, at)
        if np.linalg.norm(moved[:2]) > 0.03 or not -0.06 < moved[2] < -0.03:
            lost[design.id] = moved.round(3).tolist()
    assert lost == {}


def _fallen(design: Design, at_m: np.ndarray) -> np.ndarray:
    """(3,) how far a ball fell in a piece of furniture."""
    spec = mujoco.MjSpec()
    spec.option.timestep = STEP_S
    for part in design.parts():
        for low, high in part.collider_boxes_m().values():
            spec.worldbody.add_geom(
                type=mujoco.mjtGeom.mjGEOM_BOX, size=(high - low) / 2, pos=(low + high) / 2
            )
    ball = spec.worldbody.add_body(pos=at_m)
    ball.add_freejoint()
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=(BALL_M, 0.0, 0.0), condim=6)
    model = spec.compile()
    data = mujoco.MjData(model)
    for _ in range(round(SECONDS / STEP_S)):
        mujoco.mj_step(model, data)
    return np.asarray(data.qpos[:3] - at_m)
