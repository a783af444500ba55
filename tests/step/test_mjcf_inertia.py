"""Inertias of shapes in an MJCF model, against those of MuJoCo."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from chord_usd.line.stage.export.exchange.mjcf_geoms import Shape
from chord_usd.line.stage.export.exchange.mjcf_masses import inertia_of

SOLIDS = {
    "box": {"type": "box", "size": "0.1 0.2 0.3", "pos": "0.1 0.2 -0.3", "quat": "0.8 0.6 0 0"},
    "sphere": {"type": "sphere", "size": "0.2"},
    "ellipsoid": {"type": "ellipsoid", "size": "0.1 0.2 0.3", "quat": "0.8 0 0.6 0"},
    "cylinder": {"type": "cylinder", "size": "0.1 0.4", "pos": "0 0.5 0"},
    "capsule": {"type": "capsule", "size": "0.1 0.4", "quat": "0.6 0 0 0.8"},
}


@pytest.mark.parametrize("kind", SOLIDS)
def test_inertias_are_those_that_mujoco_computes(kind: str) -> None:
    told = " ".join(f'{name}="{value}"' for name, value in SOLIDS[kind].items())
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><body><freejoint/><geom mass="3" {told}/></body></worldbody></mujoco>'
    )
    turn = np.empty(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[1])
    turn = turn.reshape(3, 3)
    centre, inertia = inertia_of(Shape(SOLIDS[kind], 1.0), 3.0)
    assert centre == pytest.approx(model.body_ipos[1])
    assert inertia == pytest.approx(turn @ np.diag(model.body_inertia[1]) @ turn.T, abs=1e-9)
