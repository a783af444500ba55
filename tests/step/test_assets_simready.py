"""Meshes as props for simulators: what NVIDIA's profile Robotics-Prop asks of a package."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import Usd, UsdGeom, UsdPhysics, UsdSemantics, UsdShade, UsdUtils, UsdValidation

from chord_usd.base.scene.articulation import ARTICULATION, JOINTED
from chord_usd.base.scene.palette import CATEGORIES, Level, usual_mass_kg
from chord_usd.base.scene.types import Asset
from chord_usd.library.catalogue import designs
from chord_usd.library.component import write_component
from chord_usd.library.kit.model import Design, Part
from chord_usd.library.kit.solids import box
from chord_usd.library.prop import body_of
from chord_usd.line.stage.export.exchange.simready import copy_prop
from chord_usd.line.stage.export.packages import SHARED, Packages

NAMES = ("Refrigerator_58x60", "Coffee_Cup", "Cushion_Bolster_42")
"""One that opens, one that people carry, one that has no collider in a house."""

TEXTS = (
    "asset_name", "asset_type", "author", "asset_license", "category", "qcode", "source_file",
    "usd_date_generated",
)  # fmt: skip


@pytest.fixture(scope="module")
def props(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Root layers, in a folder that has been moved since it was written."""
    built, written = tmp_path_factory.mktemp("built"), tmp_path_factory.mktemp("written")
    roots = {}
    for design in (design for design in designs() if design.id in NAMES):
        path = write_component(design, built)
        asset = Asset(design.id, design.category, design.size_m, path, "CC0-1.0")
        roots[design.id] = copy_prop(asset, written)
    moved = tmp_path_factory.mktemp("moved") / "props"
    shutil.move(written, moved)
    shutil.rmtree(built)
    return {name: moved / root.relative_to(written) for name, root in roots.items()}


def bodies(stage: Usd.Stage) -> list[Usd.Prim]:
    return [prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.RigidBodyAPI)]


@pytest.mark.parametrize("name", NAMES)
def test_a_package_is_whole_and_alone(name: str, props: dict[str, Path]) -> None:
    root = props[name]
    assert root.parts[-3:] == (name, "simready_usd", f"{name}.usda")
    assert [file.name for file in root.parent.glob("*.usd*")] == [root.name]
    layers, files, missing = UsdUtils.ComputeAllDependencies(str(root))
    assert missing == []
    used = [Path(layer.realPath) for layer in layers] + [Path(file) for file in files]
    assert all(file.is_relative_to(root.parent) for file in used)
    with Image.open(root.parent / f".thumbs/256x256/{root.name}.png") as picture:
        assert picture.size == (256, 256)
        assert np.ptp(np.asarray(picture.convert("L"))) > 40, "nothing is drawn"
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    assert [error.GetMessage() for error in context.Validate(Usd.Stage.Open(str(root)))] == []


@pytest.mark.parametrize("name", NAMES)
def test_a_prop_is_one_labelled_body_that_is_felt(name: str, props: dict[str, Path]) -> None:
    stage = Usd.Stage.Open(str(props[name]))
    root = stage.GetDefaultPrim()
    assert bodies(stage) == [root]
    told = stage.GetRootLayer().customLayerData["SimReady_Metadata"]
    assert UsdPhysics.MassAPI(root).GetMassAttr().Get() == pytest.approx(told["mass"])
    assert told["mass"] > 0.0
    assert told["rigid_body_count"] == 1
    assert all(told[field] for field in TEXTS)
    seen = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    size_m = seen.ComputeWorldBound(root).ComputeAlignedRange().GetSize()
    assert list(told["asset_extents"]) == pytest.approx(list(size_m), abs=1e-5)
    for taxonomy, field in {"class": "category", "wikidata_qcode": "qcode"}.items():
        labels = UsdSemantics.LabelsAPI(root, taxonomy).GetLabelsAttr().Get()
        assert list(labels) == [told[field]]
    felt = [prim for prim in stage.Traverse() if prim.HasAPI(UsdPhysics.CollisionAPI)]
    assert felt
    for prim in felt:
        bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")[0]
        assert bound.GetPrim().HasAPI(UsdPhysics.MaterialAPI)
    materials = [prim for prim in stage.Traverse() if prim.IsA(UsdShade.Material)]
    assert all(prim.HasAPI(UsdSemantics.LabelsAPI, "material") for prim in materials)


def test_a_piece_that_opens_has_no_body_within_a_body(props: dict[str, Path]) -> None:
    stage = Usd.Stage.Open(str(props["Refrigerator_58x60"]))
    root = stage.GetDefaultPrim()
    root.GetVariantSet(ARTICULATION).SetVariantSelection(JOINTED)
    inside = bodies(stage)
    assert len(inside) > 1
    assert root not in inside


def test_a_package_beside_a_house_stands_alone_and_costs_no_space(tmp_path: Path) -> None:
    """Its pictures are those of the house by another name; what refers to it is no body."""
    built, home = tmp_path / "built", tmp_path / "home"
    packages = Packages(home, [home], "assets")
    for design in (design for design in designs() if design.id in NAMES):
        reference = packages.add(write_component(design, built))
        placed = Usd.Stage.Open(str(home / reference))
        assert bodies(placed) == []
        root = home / f"assets/{design.id}/simready_usd/{design.id}.usda"
        layers, files, missing = UsdUtils.ComputeAllDependencies(str(root))
        used = [Path(layer.realPath) for layer in layers] + [Path(file) for file in files]
        assert not missing
        assert all(file.is_relative_to(root.parent) for file in used)
        assert (root.parent / f".thumbs/256x256/{root.name}.png").is_file()
        assert bodies(Usd.Stage.Open(str(root))) != []
        shared = home / "assets" / SHARED
        assert files
        for file in map(Path, files):
            assert file.samefile(shared / file.name)


def test_a_body_turns_as_its_volumes_say() -> None:
    """A hammer: the head of steel below, the handle of wood beside its middle."""
    head, handle = box((0.2, 0.2, 0.2)), box((0.02, 0.02, 0.6)).moved(x=0.05, z=0.2)
    finishes = {"head": "steel", "handle": "oak"}
    parts = Part("Head", head, "head"), Part("Handle", handle, "handle")
    design = Design("Hammer", "vase", (0.2, 0.2, 0.8), lambda size: parts, {"plain": finishes})
    body = body_of(design, parts)
    assert body.mass_kg == pytest.approx(usual_mass_kg("vase", design.size_m))
    assert 0.0 < body.centre_m[0] < 0.01
    assert 0.1 < body.centre_m[2] < 0.15
    assert np.allclose(body.axes @ body.axes.T, np.eye(3))
    assert np.linalg.det(body.axes) == pytest.approx(1.0)
    assert np.all(body.moments_kg_m2 > 0.0)
    # No two moments are smaller together than the third, of any body.
    low, middle, high = np.sort(body.moments_kg_m2)
    assert low + middle > high
    alone = body_of(design, parts[:1])
    cube = usual_mass_kg("vase", design.size_m) * 0.2**2 / 6
    assert alone.moments_kg_m2 == pytest.approx([cube] * 3)


def test_everything_there_is_weighs_something() -> None:
    for name, row in CATEGORIES.items():
        if row.level is not Level.PLAN:
            low, high = (
                usual_mass_kg(
                    name, tuple(side[end] for side in (row.length_m, row.width_m, row.height_m))
                )
                for end in (0, 1)
            )
            assert 0.0 < low <= high < 500.0, name
