"""The variant set `roof`: off until it is chosen, then whole and valid, with its own bounds."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import Usd, UsdGeom

from chord_usd.base.errors import RenderError
from chord_usd.base.scene.roof_planes import OVERHANG_M
from chord_usd.base.scene.stacking import stack
from chord_usd.line.image.options import RenderOptions
from chord_usd.line.image.picture_layers import lit_stage
from chord_usd.line.image.render import render_stage
from chord_usd.line.stage.author.author_stage import author_levels
from chord_usd.line.stage.author.stage_levels import levels_of
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.line.stage.export.gltf import write_view
from chord_usd.workshop.data.storey_houses import random_storeys
from tests.every import later

Written = Callable[[Path, str, int], Path]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    """Houses by roof and storeys, copied into a folder of the test."""
    kept = tmp_path_factory.mktemp("roofs")

    def write(folder: Path, roof: str, storeys: int) -> Path:
        name = f"{roof}_{storeys}"
        if not (kept / name).is_dir():
            made = stack(random_storeys(np.random.default_rng(1), 2)[:storeys])
            graphs = [storey.plan.scene() for storey in made.storeys]
            (kept / name).mkdir()
            author_levels(levels_of(made, graphs), kept / name / "house.usda", roof=roof)  # type: ignore[arg-type]
        return Path(shutil.copytree(kept / name, folder / name)) / "house.usda"

    return write


def bounds(stage: Usd.Stage) -> np.ndarray:
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"], useExtentsHint=True)
    box = cache.ComputeWorldBound(stage.GetPrimAtPath("/House")).ComputeAlignedRange()
    return np.array([box.GetMin(), box.GetMax()])


@pytest.mark.parametrize(
    ("roof", "storeys"),
    [("flat", 2), ("gable", 1), *later(("flat", 1), ("gable", 2), ("hip", 1), ("hip", 2))],
)
def test_a_roof_is_off_until_it_is_chosen(
    roof: str, storeys: int, written: Written, tmp_path: Path
) -> None:
    house = written(tmp_path, roof, storeys)
    bare = Usd.Stage.Open(str(house))
    assert not bare.GetPrimAtPath("/House/Roof")
    plain = written(tmp_path, "none", storeys)
    assert np.allclose(bounds(bare), bounds(Usd.Stage.Open(str(plain))))
    assert not check_stage(house).errors
    with lit_stage(house, "", roof=roof) as chosen:
        assert Usd.Stage.Open(str(chosen)).GetPrimAtPath("/House/Roof/Geometry/Roof")
    before = bounds(bare)
    bare.GetPrimAtPath("/House").GetVariantSet("roof").SetVariantSelection(roof)
    bare.Save()
    assert not check_stage(house).errors
    roofed = Usd.Stage.Open(bare.GetRootLayer(), Usd.Stage.LoadNone)
    hinted = bounds(roofed)
    assert not list(roofed.GetPrimAtPath("/House/Roof").GetChildren())
    roofed.Load()
    points = [
        UsdGeom.Mesh(mesh).GetPointsAttr().Get()
        for mesh in Usd.PrimRange(roofed.GetPrimAtPath("/House/Roof"))
        if mesh.IsA(UsdGeom.Mesh)
    ]
    meshes = np.vstack(points)
    assert np.allclose(meshes.max(axis=0), hinted[1], atol=1e-3)
    reach = 0.25 if roof == "flat" else OVERHANG_M
    assert np.allclose((meshes.min(axis=0) - before[0])[:2], -reach, atol=0.05)  # sills stand out
    assert hinted[1][2] > before[1][2] + (0.2 if roof == "flat" else 1.5)


@pytest.mark.acceptance
def test_a_house_cut_open_shows_its_inside_whatever_roof_it_wears(
    written: Written, tmp_path: Path
) -> None:
    house = written(tmp_path, "hip", 2)
    options = RenderOptions(
        cameras=("Isometric",), resolution_px=(96, 64), samples=8, device="cpu", exposure_ev=-2.0
    )
    alone = render_stage(house, tmp_path / "alone", options)
    both = replace(options, cameras=("Isometric", "Isometric_Storey_1"), roof="hip")
    roofed = render_stage(house, tmp_path / "roofed", both)
    bare, seen = (
        np.asarray(Image.open(one.pictures[0]).convert("RGB"), np.float64)
        for one in (alone, roofed)
    )
    assert bare.std() > 5.0
    assert np.abs(bare - seen).mean() < 1.0


def test_the_page_has_the_roof_in_its_view(written: Written, tmp_path: Path) -> None:
    for roof in ("none", "gable"):
        write_view(written(tmp_path, roof, 1), tmp_path / f"{roof}.glb")
        data = (tmp_path / f"{roof}.glb").read_bytes()
        nodes = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])["nodes"]
        known = [one for one in nodes if one.get("extras", {}).get("category") == "roof"]
        assert [one["extras"]["path"] for one in known] == ["/House/Roof"][: len(known)]
        assert len(known) == (roof != "none")


def test_without_a_roof_nothing_of_it_is_written(written: Written, tmp_path: Path) -> None:
    house = written(tmp_path, "none", 1)
    assert "roof" not in house.read_text().lower()
    with (
        pytest.raises(RenderError, match=r"has no roof 'hip'.*generate with roof=hip"),
        lit_stage(house, "", roof="hip"),
    ):
        raise AssertionError
