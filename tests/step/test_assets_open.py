"""Doors, drawers and lids of furniture: each is pulled open and shut, and things lie inside."""

from __future__ import annotations

from pathlib import Path
from types import ModuleType
from typing import Any

import mujoco
import numpy as np
import pytest
from pxr import Usd, UsdPhysics

from chord_usd.library.catalogue import designs
from chord_usd.library.kit.links import links_of, opens
from chord_usd.library.kit.model import Design, Part, hollow_part, moving_part
from chord_usd.library.kit.moves import Slide, door
from chord_usd.library.kit.solids import box
from tests.design_forms import forms
from tests.every import for_every

ALL_OPEN = (
    "cabinet", "cooker_cabinet", "dining_cabinet", "double_door_floor_cabinet",
    "electrical_floor_cabinet", "refrigerator", "shoe_cabinet", "single_door_floor_cabinet",
    "sink_cabinet", "toilet", "tv_cabinet", "washing_machine", "washing_set",
)  # fmt: skip
"""Categories all of whose designs open."""

FORMS = sorted(forms(designs()), key=lambda form: form[0].category)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("openable")


@for_every("form", FORMS, ids=lambda form: form[0].id, step=3)
def test_all_that_moves_opens_and_shuts_and_touches_nothing(
    form: list[Design], puller: ModuleType, folder: Path
) -> None:
    """Also: of a form either all sizes open, or none; of some categories, all forms."""
    first, parts = form[0], form[0].parts()
    if len(form) > 1:
        assert opens(parts) == opens(form[-1].parts())
    if not opens(parts):
        assert first.category not in ALL_OPEN
        return
    spec = puller.jointed_spec(puller.written(first, folder))
    model = spec.compile()
    assert model.njnt == len(links_of(parts)) - 1
    assert list(puller.faults_of(model)) == []


def _crate(*, post_y: float) -> Design:
    """A box with a door, and a post before it."""
    case = box((0.6, 0.4, 0.8)).moved(y=0.05)
    panel = box((0.596, 0.018, 0.79)).moved(y=-0.16, z=0.005)
    post = box((0.1, 0.05, 0.8)).moved(y=post_y)

    def draw(size_m: tuple[float, float, float]) -> tuple[Part, ...]:
        front = moving_part("Doors", [panel], "body", [door(panel, hung="left")])
        return hollow_part("Body", case), front, Part("Post", post, "body", above=True)

    depth = 0.25 + 0.169
    return Design("Crate", "cabinet", (0.6, depth, 0.8), draw, {"oak": {"body": "oak"}})


@pytest.mark.parametrize(("post_y", "word"), [(-0.4, "goes open"), (-0.18, "shut")])
def test_what_is_in_the_way_is_found(
    post_y: float, word: str, puller: ModuleType, tmp_path: Path
) -> None:
    model = puller.jointed_spec(puller.written(_crate(post_y=post_y), tmp_path)).compile()
    faults = list(puller.faults_of(model))
    assert any("Post" in fault and word in fault for fault in faults)


def test_a_ball_in_a_drawer_travels_with_it(puller: ModuleType, folder: Path) -> None:
    chest = next(design for design in designs() if design.id.startswith("Chest_"))
    spec = puller.jointed_spec(puller.written(chest, folder))
    drawers = [link for link in links_of(chest.parts()) if isinstance(link.motion, Slide)]
    bounds = np.array([b for piece in drawers[0].pieces for b in piece.colliders_m])
    low, high = bounds[:, 0].min(axis=0), bounds[:, 1].max(axis=0)
    ball = spec.worldbody.add_body(name="ball", pos=(low + high) / 2)
    ball.add_freejoint()
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.03, 0, 0], mass=0.1)
    model = spec.compile()
    data = mujoco.MjData(model)
    name = f"/{chest.id}/Joints/{drawers[0].name}"
    slide = model.joint(name)
    force = 2 * float(model.dof_damping[slide.dofadr[0]]) * float(slide.range[0])
    for _ in range(round(2.0 / model.opt.timestep)):
        data.joint(name).qfrc_applied[0] = force
        mujoco.mj_step(model, data)
    moved = float(data.joint(name).qpos[0])
    assert moved < 0.9 * float(slide.range[0])
    at = data.body("ball").xpos - [0.0, moved, 0.0]
    assert np.all(at > low)
    assert np.all(at < high)


def _jointed(path: Path) -> Usd.Stage:
    stage = Usd.Stage.Open(str(path))
    stage.GetDefaultPrim().GetVariantSet("articulation").SetVariantSelection("jointed")
    return stage


def test_an_asset_is_fixed_until_its_variant_is_said(puller: ModuleType, folder: Path) -> None:
    chest = next(design for design in designs() if design.id.startswith("Chest_"))
    path = puller.written(chest, folder)
    stage = Usd.Stage.Open(str(path))
    assert stage.GetDefaultPrim().GetVariantSet("articulation").GetVariantSelection() == "fixed"
    assert not [prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]
    jointed = _jointed(path)
    root = jointed.GetDefaultPrim()
    assert root.HasAPI(UsdPhysics.ArticulationRootAPI)
    assert not root.GetChild("Geometry").IsActive()
    for prim in jointed.Traverse():
        joint: Any = UsdPhysics.Joint(prim)
        if joint:
            assert _drive_is_off(prim)
            assert str(prim.GetPath().GetParentPath()) == f"{root.GetPath()}/Joints"


def _drive_is_off(prim: Usd.Prim) -> bool:
    """Whether nothing but damping acts on a joint that moves."""
    if prim.IsA(UsdPhysics.FixedJoint):
        return True
    drive = UsdPhysics.DriveAPI(prim, "angular" if prim.IsA(UsdPhysics.RevoluteJoint) else "linear")
    return drive.GetStiffnessAttr().Get() == 0.0 and drive.GetDampingAttr().Get() > 0.0
