"""Grasps: pads face each other on the surface, and what they hold in MuJoCo is written down."""

from __future__ import annotations

import itertools
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from pxr import Usd

from chord_usd.base.scene.types import Asset
from chord_usd.library.database import load_database
from chord_usd.library.grasp_trials import convex_parts, holds, write_grasps
from chord_usd.library.grasps import OPEN_M, Grasp, candidates
from chord_usd.library.prop import GRASPS
from chord_usd.line.stage.export.exchange.robot_layer import graspable_at

BLOCK_M = (0.04, 0.05, 0.12)


def block() -> trimesh.Trimesh:
    return trimesh.creation.box(BLOCK_M)


def test_pads_face_each_other_on_the_surface() -> None:
    found = list(itertools.islice(candidates(block()), 20))
    assert found
    for grasp in found:
        assert np.allclose(grasp.axes.T @ grasp.axes, np.eye(3), atol=1e-9)
        ends = grasp.middle_m + np.outer([-0.5, 0.5], grasp.axes[:, 0]) * grasp.width_m
        _, away, _ = trimesh.proximity.closest_point_naive(block(), ends)
        assert away.max() < 1e-9
        assert grasp.width_m < OPEN_M


def test_nothing_is_held_that_is_wider_than_the_gripper() -> None:
    assert not list(candidates(trimesh.creation.box((0.1, 0.1, 0.1))))


def test_a_gripper_holds_a_block_by_its_middle_and_no_safe() -> None:
    pytest.importorskip("mujoco")
    parts = convex_parts(block())
    grasp = next(candidates(block()))
    assert holds(grasp, parts, 0.2)
    assert not holds(grasp, parts, 60.0)
    beside = Grasp(grasp.middle_m + grasp.axes[:, 1] * 0.2, grasp.axes, grasp.width_m)
    assert not holds(beside, parts, 0.2)


def test_a_bowl_is_felt_as_its_wall() -> None:
    tube = trimesh.creation.annulus(0.07, 0.08, 0.08, sections=24)
    volume = sum(trimesh.convex.convex_hull(points).volume for points in convex_parts(tube))
    assert tube.volume <= volume < 0.5 * tube.convex_hull.volume


def test_grasps_are_written_once_and_stand_where_the_thing_does(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    cup = load_database().named("Coffee_Cup")
    trial = write_grasps(_moved(cup, tmp_path))
    assert trial.held
    told = json.loads((tmp_path / "Coffee_Cup" / GRASPS).read_text())["grasps"]
    stage = Usd.Stage.CreateInMemory()
    prim = stage.DefinePrim("/Cup", "Xform")
    prim.GetReferences().AddReference(str(tmp_path / "Coffee_Cup" / "Coffee_Cup.usda"))
    from pxr import UsdGeom

    UsdGeom.Xformable(prim).AddTranslateOp().Set((1.0, 2.0, 0.7))
    there = list(graspable_at(prim, UsdGeom.XformCache()))
    assert len(there) == len(told)
    for own, world in zip(told, there, strict=True):
        assert np.allclose(np.add(own["position"], (1.0, 2.0, 0.7)), world["position"], atol=1e-4)


def _moved(asset: Asset, folder: Path) -> Asset:
    """A copy that a test may write beside."""
    import shutil

    home = Path(asset.usd_path).parent
    shutil.copytree(home, folder / home.name, ignore=shutil.ignore_patterns(GRASPS))
    return replace(asset, usd_path=folder / home.name / Path(asset.usd_path).name)
