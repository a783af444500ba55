"""The robot layer of a house: valid, and of the frames and prims that the stage has."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from pxr import Usd, UsdGeom

from chord_usd.base.scene.articulation import ARTICULATION, JOINTED
from chord_usd.line.stage.export.exchange import robot_layer
from chord_usd.line.stage.export.export_stage import export_stage


@pytest.fixture(scope="module")
def layer(opening_house: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    path = tmp_path_factory.mktemp("robot") / "house.robot.json"
    export_stage(opening_house, path, "robot")
    record: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    return record


@pytest.fixture(scope="module")
def jointed(opening_house: Path) -> Usd.Stage:
    """The house with all its pieces open to joints."""
    stage = Usd.Stage.Open(str(opening_house))
    with Usd.EditContext(stage, stage.GetSessionLayer()):
        for prim in list(stage.Traverse()):
            if prim.GetVariantSets().HasVariantSet(ARTICULATION):
                prim.GetVariantSet(ARTICULATION).SetVariantSelection(JOINTED)
    return stage


def bounds_m(stage: Usd.Stage, path: str) -> np.ndarray:
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    box = cache.ComputeWorldBound(stage.GetPrimAtPath(path)).ComputeAlignedRange()
    return np.array([box.GetMin(), box.GetMax()])


def turned(point: np.ndarray, axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' rotation."""
    across = np.cross(axis, point) * np.sin(angle)
    return point * np.cos(angle) + across + axis * (axis @ point) * (1 - np.cos(angle))


def test_a_layer_keeps_its_schema(layer: dict[str, Any]) -> None:
    schema = json.loads(robot_layer.SCHEMA.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.validate(layer, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**layer, "rooms": [{}]}, schema)


def test_handles_lie_on_their_leaves_and_move_as_they_are_pulled(
    layer: dict[str, Any], jointed: Usd.Stage
) -> None:
    assert {entry["class"] for entry in layer["openables"]} >= {"door", "window", "cabinet"}
    for entry in layer["openables"]:
        low, high = bounds_m(jointed, entry["id"])
        joint, origin = entry["joint"], np.array(entry["joint"]["origin"])
        axis = np.array(joint["axis"])
        assert entry["handles"], entry["id"]
        for handle in entry["handles"]:
            at, pull = np.array(handle["position"]), np.array(handle["pull"])
            assert (at > low - 2e-3).all(), entry["id"]
            assert (at < high + 2e-3).all(), entry["id"]
            step = np.copysign(1e-3, joint["open"])
            moved = (
                origin + turned(at - origin, axis, step) - at
                if joint["type"] == "revolute" else axis * step
            )  # fmt: skip
            assert moved @ pull / np.linalg.norm(moved) > 0.999, entry["id"]


def test_what_stands_on_a_support_stands_at_its_height(
    layer: dict[str, Any], jointed: Usd.Stage
) -> None:
    carried = 0
    for entry in layer["supports"]:
        assert entry["area"] > 0.0
        for child in entry["carries"]:
            carried += 1
            assert bounds_m(jointed, child)[0, 2] == pytest.approx(entry["height"], abs=3e-3)
    assert carried


def test_ids_are_those_of_the_stage_and_tasks_name_what_is_listed(
    layer: dict[str, Any], jointed: Usd.Stage
) -> None:
    for group in ("openables", "supports", "graspable"):
        assert layer[group]
        for entry in layer[group]:
            assert jointed.GetPrimAtPath(entry["id"]), entry["id"]
    rooms = {room["id"]: room for room in layer["rooms"]}
    known = {
        "room": set(rooms), "openable": {entry["id"] for entry in layer["openables"]},
        "thing": {entry["id"] for entry in layer["graspable"]},
    }  # fmt: skip
    assert {task["task"] for task in layer["tasks"]} == {"go", "open", "move"}
    for task in layer["tasks"]:
        (subject,) = known.keys() & task.keys()
        assert task[subject] in known[subject], task
    assert {entry["room"] for entry in (*layer["graspable"], *layer["supports"])} <= set(rooms)
    leaves = [leaf for door in layer["doors"] for leaf in door["leaves"]]
    assert len(leaves) == len(set(leaves))
    assert set(leaves) == {entry["id"] for entry in layer["openables"] if entry["class"] == "door"}
    for room, poses in layer["spawns"].items():
        assert bool(poses) == rooms[room]["reachable"], room
