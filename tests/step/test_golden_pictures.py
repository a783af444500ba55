"""What people look at, beside kept pictures: previews, layouts, furniture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from golden import LEAST_SSIM, require_alike, shrunk, ssim

from chord_usd.base.raster.canvas import draw_plan, layout_image
from chord_usd.base.scene.types import SceneGraph
from chord_usd.library.contact_sheet import draw_asset
from chord_usd.library.database import load_database
from chord_usd.line.image.preview import preview_rgb

ASSETS = ("Sofa_Slim_215x95", "Chair_Slats_43x49", "Armchair_Wing_77x77")
ASSET_PX = 96


def test_the_preview(furnished_house: SceneGraph, tmp_path: Path) -> None:
    require_alike("preview", preview_rgb(furnished_house), tmp_path)


def test_the_preview_of_a_house_without_some_pieces_is_not_alike(
    furnished_house: SceneGraph,
) -> None:
    other = furnished_house.without({item.id for item in furnished_house.items[::3]})
    assert ssim(*(shrunk(preview_rgb(house)) for house in (furnished_house, other))) < LEAST_SSIM


def test_the_layout(furnished_house: SceneGraph, tmp_path: Path) -> None:
    layout = layout_image(draw_plan(furnished_house.plan), furnished_house.items)
    require_alike("layout", layout.rgb, tmp_path)


def test_furniture(tmp_path: Path) -> None:
    database = load_database(())
    row = [np.asarray(draw_asset(database.named(name), ASSET_PX))[..., :3] for name in ASSETS]
    require_alike("furniture", np.concatenate(row, axis=1), tmp_path)


def test_likeness_is_one_of_the_same_and_falls_with_noise() -> None:
    picture = np.random.default_rng(0).integers(0, 255, (40, 60, 3)).astype(np.uint8)
    noisy = np.clip(picture + np.random.default_rng(1).normal(0, 40, picture.shape), 0, 255)
    assert ssim(picture, picture) == pytest.approx(1.0)
    assert ssim(picture, noisy.astype(np.uint8)) < 0.95
