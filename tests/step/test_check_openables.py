"""What opens must open: found on the stage, mended by the rules, kept free by dressing."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from chord_usd.base.places.swept import OPENS, swept_box
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.cli import DONE, NOT_HELD, main
from chord_usd.library.asset_shapes import leaves_of, openable
from chord_usd.library.catalogue import design_of, entries
from chord_usd.library.database import AssetDatabase, load_database
from chord_usd.library.kit.moves import Hinge
from chord_usd.line.arrange.arrangement import Arrangement
from chord_usd.line.arrange.leaves_free import free_leaves
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_openables import Opens
from chord_usd.line.stage.check.check_stage import Report, check_stage
from chord_usd.line.stage.check.pulled import Pulled, contradictions, pull_joints
from chord_usd.line.stage.export.export_stage import export_stage

_AT_SIDE_M = 0.05
_FLUSH_M = 1e-3


@pytest.fixture(scope="module")
def database() -> AssetDatabase:
    return load_database(())


def wardrobe(database: AssetDatabase, x: float, y: float) -> Item:
    """With leaves, its back at y = 4."""
    asset = database.nearest("cabinet", (1.2, 0.6, 2.0))
    assert leaves_of(_placed(asset, (0.0, 0.0)))
    return _placed(asset, (x, y - asset.size_m[1] / 2))


def _placed(asset, at) -> Item:
    return Item("wardrobe", "cabinet", Box((*at, 0.0), asset.size_m, 0.0), "a", asset)


def house(*items: Item) -> SceneGraph:
    polygon = frozen_array([(0.0, 0.0), (5.0, 0.0), (5.0, 4.0), (0.0, 4.0)])
    door = Opening("door", "door", Box((1.0, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("a",))
    return SceneGraph((Room("a", "bedroom", polygon),), (door,), items)


def report(tmp_path: Path, graph: SceneGraph) -> Report:
    return check_stage(author_stage(graph, tmp_path / "house.usda", seed=0).path)


def chest(at: tuple[float, float]) -> Item:
    return Item("chest", "table", Box((*at, 0.0), (0.8, 0.5, 0.75), 0.0), "a")


def test_a_piece_before_a_door_stops_it_and_the_report_says_where(tmp_path, database, capsys):
    free = wardrobe(database, 2.5, 3.99)
    front = free.box.center_m[1] - free.box.size_m[1] / 2
    for folder in ("shut", "free"):
        (tmp_path / folder).mkdir()
    shut = report(tmp_path / "shut", house(free, chest((2.5, front - 0.35))))
    assert shut.shut
    assert {one.stopped_by.rsplit("/", 1)[-1] for one in shut.shut} == {"Table_0"}
    assert any("Cabinet_0/Door" in fault for fault in (*shut.faults, *shut.flaws))
    assert main(["check", str(tmp_path / "shut/house.usda")]) in (DONE, NOT_HELD)
    assert "of furniture (doors, drawers, flaps) open" in capsys.readouterr().out
    wide = report(tmp_path / "free", house(free))
    assert wide.opens
    assert not wide.shut
    assert {one.free_share for one in wide.opens} == {1.0}


def test_force_agrees_with_swept_volumes(tmp_path, database, capsys):
    """MuJoCo pulls the leaves of a wardrobe before which a heavy chest stands, or nothing."""
    free = wardrobe(database, 2.5, 3.99)
    front = free.box.center_m[1] - free.box.size_m[1] / 2
    heavy = replace(chest((2.5, front - 0.3)), category="cabinet")
    for name, items in (("shut", [heavy]), ("free", [])):
        path = author_stage(house(free, *items), tmp_path / f"{name}.usda", seed=0).path
        leaves = check_stage(path).opens
        pulled = {one.path: one for one in pull_joints(path)}
        assert {leaf.path for leaf in leaves} <= pulled.keys()
        assert contradictions(leaves, list(pulled.values())) == []
        assert any(pulled[leaf.path].is_stuck for leaf in leaves) == (name == "shut")
    assert main(["check", str(tmp_path / "shut.usda"), "--open"]) == NOT_HELD
    printed = capsys.readouterr().out
    assert "by force" in printed
    assert re.search(r"Cabinet_\d/Door_\d stops at", printed)
    free_leaf = [Opens(leaf.path, 1.0, "all") for leaf in leaves]
    assert contradictions(free_leaf, [Pulled(free_leaf[0].path, 0.2)]) == [
        f"{free_leaf[0].path} opens all by its swept volume, 20% by force"
    ]


def test_a_stage_in_one_piece_is_judged_as_a_jointed_one(tmp_path, database):
    graph = house(wardrobe(database, 2.5, 3.99), chest((2.5, 2.9)))
    shares = []
    for articulation in ("fixed", "jointed"):
        (tmp_path / articulation).mkdir()
        path = tmp_path / articulation / "house.usda"
        stage = author_stage(graph, path, seed=0, articulation=articulation).path
        shares.append([(one.path, one.free_share) for one in check_stage(stage).opens])
    assert shares[0] == shares[1]


def test_a_piece_goes_where_its_leaves_open(database):
    piece = wardrobe(database, 2.5, 4.0)
    front = piece.box.center_m[1] - piece.box.size_m[1] / 2
    beside = Item("chest", "table", Box(
        (2.5 + piece.box.size_m[0] / 2 + 0.2, front - 0.3, 0.0), (0.5, 0.5, 0.75), 0.0), "a",
    )  # fmt: skip
    before = house(piece, replace(beside, facts=replace(beside.facts, unit="run")))
    after = free_leaves(Arrangement.of(before))
    moved = next(one for one in after.items if one.id == "wardrobe")
    assert moved.box != piece.box
    swept = [footprint_polygon(swept_box(leaf, moved.box)) for leaf in leaves_of(moved)]
    assert all(shape.intersection(footprint_polygon(beside.box)).area < 1e-4 for shape in swept)


def test_a_piece_between_walls_gets_a_model_that_opens(database):
    piece = wardrobe(database, 2.5, 4.0)
    x, y, _ = piece.box.center_m
    length, depth, _ = piece.box.size_m
    posts = [
        Item(f"post{side}", "table", Box((x + side * (length / 2 + 0.1), y - 0.3, 0.0),
             (0.2, depth + 0.6, 2.2), 0.0), "a")
        for side in (-1, 1)
    ]  # fmt: skip
    shut = Item("chest", "table", Box((x, y - depth / 2 - 0.35, 0.0), (length, 0.5, 2.0), 0.0), "a")
    before = house(piece, *posts, shut)
    models = Arrangement.of(before, movable={"wardrobe"}, database=database)
    after = next(one for one in free_leaves(models).items if one.id == "wardrobe")
    assert after.asset != piece.asset
    assert after.asset.category == "cabinet"
    assert footprint_polygon(piece.box).buffer(1e-6).covers(footprint_polygon(after.box))
    alone = free_leaves(Arrangement.of(before, movable={"wardrobe"}))
    assert next(one for one in alone.items if one.id == "wardrobe").asset == piece.asset


def test_doors_at_a_side_stay_within_their_piece():
    """So that a wall, or a taller piece, may be there."""
    judged = 0
    for name in list(entries())[::60]:
        design = design_of(name)
        length = design.size_m[0]
        moves = [one for part in design.parts() for one in part.moves]
        for one in moves:
            motion = one.leaf.motion
            if not isinstance(motion, Hinge) or motion.axis != "z":
                continue
            side = np.sign(motion.at_m[0])
            hangs_at = length / 2 - side * motion.at_m[0]
            if not 0.0 <= hangs_at < _AT_SIDE_M or side * motion.opens_deg < 0.0:
                continue
            judged += 1
            low, high = one.solid.bounds_m()
            corners = np.array([(x, y) for x in (low[0], high[0]) for y in (low[1], high[1])])
            for angle in np.radians(np.linspace(0.0, motion.opens_deg, 60)):
                turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
                there = (corners - motion.at_m[:2]) @ turn.T + motion.at_m[:2]
                assert (side * there[:, 0]).max() < length / 2 + _FLUSH_M, design.id
            assert abs(motion.opens_deg) > 75.0
    assert judged > 10


def test_foreign_assets_widenothing(tmp_path):
    assert openable(str(tmp_path / "none.usda")) is None


def _pulled(model: mujoco.MjModel, joint: int) -> float:
    """Share of its range that a joint reaches under 20 N m or 30 N, within two seconds."""
    data = mujoco.MjData(model)
    wide = max(model.jnt_range[joint], key=abs)
    force = math.copysign(20.0 if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE else 30.0,
                          wide)  # fmt: skip
    reached = 0.0
    while data.time < 2.0 and reached < OPENS:
        data.qfrc_applied[model.jnt_dofadr[joint]] = force
        mujoco.mj_step(model, data)
        reached = max(reached, float(data.qpos[model.jnt_qposadr[joint]] / wide))
    return reached


@pytest.mark.parametrize("away_m", [0.15, 0.35, 0.9])
def test_force_opens_what_the_certificate_calls_free_and_nothing_else(
    tmp_path, database, away_m: float
):
    piece = wardrobe(database, 2.5, 3.99)
    front = piece.box.center_m[1] - piece.box.size_m[1] / 2
    at = (2.5, front - away_m - 0.3, 0.0)
    counter = Item("sink", "cabinet", Box(at, (0.6, 0.6, 0.85), 180.0),
                   "a")  # fmt: skip
    path = tmp_path / "house.usda"
    author_stage(house(piece, counter), path, seed=0, articulation="jointed")
    told = {one.path.rsplit("/", 1)[-1]: one.is_free for one in check_stage(path).opens}
    export_stage(path, tmp_path / "model", "mujoco")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "model/model.xml"))
    names = {model.joint(at).name: at for at in range(model.njnt) if ".Cabinet_" in
             model.joint(at).name}  # fmt: skip
    force = {name.rsplit(".", 1)[-1]: _pulled(model, at) >= OPENS for name, at in names.items()}
    assert len(told) > 1
    assert force == told
