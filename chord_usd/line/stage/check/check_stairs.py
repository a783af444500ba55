"""Whether the stairs of a stage can be walked: measured on its meshes, along the line one walks."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence

import numpy as np
from shapely.geometry import LineString

from chord_usd.base.metrics.walk import Ascent, Walk, walk_storeys
from chord_usd.base.scene.storeys import HEADROOM_M, STEEP
from chord_usd.base.scene.types import FloatArray
from chord_usd.line.stage.check.check_scene import StageScene, StageStair

_EVERY_M = 0.04
"""Along the line, between the places that are measured."""

_SLACK_M = 0.005
_STEP_UP_M = 0.5
"""What is no higher than this over a foot is a step, if too high a one; else it is overhead."""

_FACING = 0.5
"""Of a unit normal, upwards: faces that one stands on or hits one's head at."""


def stair_faults(storeys: Sequence[StageScene]) -> dict[str, str]:
    """What is wrong with stairs, by the path of the stair."""
    faults = {}
    for below, lower, upper in zip(
        [None, *storeys[:-1]], storeys, [*storeys[1:], None], strict=True
    ):
        for stair in lower.stairs:
            fault = (
                "leads to no storey" if upper is None
                else next(_faults(stair, below, lower, upper), "")
            )  # fmt: skip
            if fault:
                faults[stair.body.path] = fault
    return faults


def _faults(
    stair: StageStair, below: StageScene | None, lower: StageScene, upper: StageScene
) -> Iterator[str]:
    rise_m = upper.elevation_m - lower.elevation_m
    triangles = _level_faces(below, lower, upper)
    line = LineString(stair.walk_m[:, :2])
    count = max(2, int(line.length / _EVERY_M))
    height_m = 0.0
    for along in np.linspace(0.0, line.length, count):
        point = line.interpolate(along)
        heights = _heights(triangles, (point.x, point.y))
        stood = heights[heights <= height_m + _STEP_UP_M]
        if not len(stood):
            yield f"has nothing to stand on {along:.1f} m along the way"
            return
        step = float(stood.max()) - height_m
        if abs(step) > STEEP.rise_m[1] + _SLACK_M:
            yield f"has a step of {step * 100:.0f} cm {along:.1f} m along the way"
            return
        height_m = float(stood.max())
        over = heights[heights > height_m + _SLACK_M]
        if len(over) and over.min() - height_m < HEADROOM_M - _SLACK_M:
            yield f"has {over.min() - height_m:.2f} m of headroom {along:.1f} m along the way"
            return
    if abs(height_m - rise_m) > _SLACK_M:
        yield f"ends {rise_m - height_m:.2f} m below the floor that it leads to"


def _level_faces(below: StageScene | None, lower: StageScene, upper: StageScene) -> FloatArray:
    """(M, 3, 3) faces near level of floors, ceilings and stairs of two storeys, and of the stairs
    that come up from below, whose landing one may step on from; in the lower's frame."""
    faces = []
    for scene in (below, lower, upper) if below else (lower, upper):
        bodies = [stair.body for stair in scene.stairs]
        bodies += [] if scene is below else [*scene.ground, *scene.ceilings]
        lift_m = scene.elevation_m - lower.elevation_m
        for body in bodies:
            if body.solids:
                faces.append(body.triangles_m + np.array([0.0, 0.0, lift_m]))
    triangles = np.concatenate(faces)
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    level = np.abs(normals[:, 2]) > _FACING * np.maximum(lengths, 1e-12)
    return triangles[level]


def _heights(triangles: FloatArray, at_m: tuple[float, float]) -> FloatArray:
    """Heights of the triangles (M, 3, 3) over or under a place."""
    flat = triangles[:, :, :2]
    near = (flat.min(axis=1) <= at_m).all(axis=1) & (flat.max(axis=1) >= at_m).all(axis=1)
    nearby = triangles[near]
    a, b, c = nearby[:, 0], nearby[:, 1], nearby[:, 2]
    area = _cross(b - a, c - a)
    place = np.array([*at_m, 0.0])
    u = _cross(place - a, c - a) / area
    v = _cross(b - a, place - a) / area
    inside = (u >= -1e-6) & (v >= -1e-6) & (u + v <= 1.0 + 1e-6)
    heights: FloatArray = (a[:, 2] + u * (b - a)[:, 2] + v * (c - a)[:, 2])[inside]
    return heights


def _cross(first: FloatArray, second: FloatArray) -> FloatArray:
    """Of the plan, (M,)."""
    return first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]


# How far one gets on foot in a house on its stage: for the certificate and for robots ------------


def stage_walks(storeys: Sequence[StageScene], faulty: Collection[str] = ()) -> list[Walk]:
    """On each storey, over the stairs that can be walked. faulty: paths of stairs that cannot."""
    ascents = [
        Ascent(index, tuple(stair.walk_m[0, :2].tolist()), tuple(stair.walk_m[-1, :2].tolist()))
        for index, scene in enumerate(storeys[:-1])
        for stair in scene.stairs
        if stair.body.path not in faulty
    ]  # fmt: skip
    return walk_storeys([scene.entered_graph for scene in storeys], ascents)
