"""Houses of storeys as IFC, DXF and maps: read again they are the same plans and stairs."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import get_args

import jsonschema
import numpy as np
import pytest
from pxr import Usd

from chord_usd.base.scene.json_stairs import stairs_of
from chord_usd.base.scene.stacking import stack
from chord_usd.base.scene.stair_forms import build_stair
from chord_usd.base.scene.storeys import STOREY_M, StairForm, StoreyPlan
from chord_usd.base.scene.types import Plan
from chord_usd.line.pipeline.house_states import set_states
from chord_usd.line.plan.read import read_storey_plans
from chord_usd.line.stage.author.author_stage import author_levels
from chord_usd.line.stage.author.stage_levels import levels_of
from chord_usd.line.stage.export.exchange import robot_layer
from chord_usd.line.stage.export.exchange.built_house import houses_of
from chord_usd.line.stage.export.export_stage import export_stage
from chord_usd.workshop.data.storey_houses import random_storeys
from tests.every import later
from tests.plan_alike import likeness

FORMS = get_args(StairForm)
SPIRAL: tuple[StairForm, ...] = ("spiral",)


def staged(
    seed: int, storeys: int, folder: Path, forms: Sequence[StairForm] = FORMS
) -> tuple[tuple[StoreyPlan, ...], Path]:
    given = random_storeys(np.random.default_rng(seed), storeys, forms)
    made = stack(given)
    graphs = [storey.plan.scene() for storey in made.storeys]
    path = folder / "house.usda"
    author_levels(levels_of(made, graphs), path)
    return given, path


@pytest.mark.parametrize(
    ("seed", "storeys", "forms"),
    [
        (0, 3, FORMS),
        (3, 2, SPIRAL),
        *later((1, 2, FORMS), (2, 2, FORMS), (5, 2, FORMS), (0, 2, SPIRAL)),
    ],
)
def test_storeys_and_stairs_come_back(
    seed: int, storeys: int, forms: Sequence[StairForm], tmp_path: Path
) -> None:
    given, house = staged(seed, storeys, tmp_path, forms)
    for package in ("ifc", "dxf"):
        target = tmp_path / f"house.{package}"
        export_stage(house, target, package)
        found = read_storey_plans(target, None)
        assert len(found) == storeys
        for one, wanted in zip(found, given, strict=True):
            check_storey(one.plan, wanted.plan)


def check_storey(plan: Plan, wanted: Plan) -> None:
    """Rooms, openings and stairs that lead up are those of the other plan."""
    assert likeness(plan, wanted).holds(0.01), likeness(plan, wanted)
    ups, wanted_ups = (
        [stair for stair in stairs_of(one, "") if stair.leads == "up"] for one in (plan, wanted)
    )
    for up, known in zip(ups, wanted_ups, strict=True):
        assert (up.form, up.turn) == (known.form, known.turn)
        # Of a box that is larger than it has to be only what the steps take up is told.
        area, wanted_area = (build_stair(one, STOREY_M).area_m for one in (up, known))
        assert area.symmetric_difference(wanted_area).area < 0.08 * wanted_area.area
        assert np.cos(np.radians(up.box.yaw_deg - known.box.yaw_deg)) > 0.99


def test_maps_of_storeys_are_joined_by_stairs(tmp_path: Path) -> None:
    given, house = staged(1, 2, tmp_path)
    export_stage(house, tmp_path / "maps", "ros")
    told = json.loads((tmp_path / "maps" / "house.json").read_text())
    assert [storey["elevation"] for storey in told["storeys"]] == [0.0, STOREY_M]
    for storey, wanted in zip(told["storeys"], given, strict=True):
        folder = tmp_path / "maps" / storey["folder"]
        rooms = json.loads((folder / "rooms.json").read_text())["rooms"]
        assert [room["id"] for room in rooms] == storey["rooms"]
        assert len(rooms) == len(wanted.plan.rooms)
        assert all(room["reachable"] for room in rooms)
        assert {file.name for file in folder.iterdir()} == {
            "map.pgm", "map.yaml", "rooms.json", "spawns.json"
        }  # fmt: skip
    (stair,) = told["stairs"]
    for at, room in enumerate(stair["rooms"]):
        assert room in told["storeys"][stair["storeys"][at]]["rooms"]
    assert stair["rise"] == pytest.approx(STOREY_M)


def test_a_robot_layer_has_all_storeys_and_doors_shut_by_their_state(tmp_path: Path) -> None:
    given, house = staged(1, 2, tmp_path)
    set_states(house, house, "doors: closed")
    export_stage(house, tmp_path / "house.robot.json", "robot")
    told = json.loads((tmp_path / "house.robot.json").read_text(encoding="utf-8"))
    jsonschema.validate(told, json.loads(robot_layer.SCHEMA.read_text(encoding="utf-8")))
    assert [len(storey["rooms"]) for storey in told["storeys"]] == [
        len(storey.plan.rooms) for storey in given
    ]
    assert len(told["stairs"]) == 1
    doors = [one for one in told["openables"] if one["class"] == "door"]
    assert {door["state"] for door in doors} == {"closed"}
    upper = [door for door in doors if door["rooms"][0] in told["storeys"][1]["rooms"]]
    assert upper
    assert all(STOREY_M < handle["position"][2] < 2 * STOREY_M
               for door in upper for handle in door["handles"])  # fmt: skip
    assert not all(room["reachable"] for room in told["rooms"])


@pytest.mark.parametrize(("seed", "forms"), [(0, SPIRAL), *later((1, FORMS), (2, FORMS))])
def test_stairs_can_be_stood_on_in_mujoco(
    seed: int, forms: Sequence[StairForm], tmp_path: Path
) -> None:
    mujoco = pytest.importorskip("mujoco")
    _, house = staged(seed, 2, tmp_path, forms)
    export_stage(house, tmp_path / "model", "mujoco")
    (stair,) = houses_of(Usd.Stage.Open(str(house)))[0].stairs
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "model" / "model.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    gone = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(stair.walk_m[:, :2], axis=0).T))])
    height, met = 0.0, np.zeros(1, dtype=np.int32)
    felt = np.array([0, 0, 0, 1, 0, 0], dtype=np.uint8)  # group 3: what is felt, not seen
    for along in np.arange(0.0, gone[-1], 0.04):
        place = [np.interp(along, gone, stair.walk_m[:, axis]) for axis in (0, 1)]
        eye = np.array([*place, height + 1.9])
        fallen = mujoco.mj_ray(model, data, eye, np.array([0.0, 0.0, -1.0]), felt, 1, -1, met)
        foot = eye[2] - fallen
        assert -0.01 < foot - height < 0.21
        height = foot
    assert height == pytest.approx(STOREY_M, abs=0.01)
