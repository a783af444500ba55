"""Houses cut open: walls are closed at the cut, whatever lies at its height."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

from chord_usd.base.scene.types import Box, Opening, Room, SceneGraph, frozen_array
from chord_usd.line.image.options import RenderOptions
from chord_usd.line.image.render import render_stage
from chord_usd.line.stage.author.author_stage import author_stage

ROOM = Room("r", "bedroom", frozen_array([(0, 0), (4, 0), (4, 3), (0, 3)]))


def cut_picture(folder: Path, sill_m: float) -> np.ndarray:
    window = Opening("w", "window", Box((2.0, 3.12, sill_m), (1.2, 0.24, 1.0), 0.0), ("r",))
    folder.mkdir()
    author_stage(SceneGraph((ROOM,), (window,), ()), folder / "house.usda")
    options = RenderOptions(cameras=("Isometric",), resolution_px=(96, 64), samples=8, device="cpu")
    (picture,) = render_stage(
        folder / "house.usda", folder / "out", replace(options, exposure_ev=-2.0)
    ).pictures
    return np.asarray(Image.open(picture).convert("RGB"), np.float64)


def test_walls_are_closed_where_a_sill_lies_at_the_height_of_the_cut(tmp_path: Path) -> None:
    higher, at_cut = (cut_picture(tmp_path / str(sill_m), sill_m) for sill_m in (1.25, 1.2))
    assert np.abs(higher - at_cut).mean() < 1.0
