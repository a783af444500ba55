"""The component packages, read back with usd-core."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdPhysics, UsdSemantics, UsdShade, UsdUtils, UsdValidation

from chord_usd.base.scene.label_sets import wikidata_item
from chord_usd.base.scene.palette import (
    DRESSING_CATEGORIES,
    HOUSE_CATEGORIES,
    TABLE_CATEGORIES,
    having,
)
from chord_usd.base.scene.types import Asset
from chord_usd.library.catalogue import designs
from chord_usd.library.component import material_path, write_component
from chord_usd.library.database import build_assets, load_database, read_index
from chord_usd.library.kit.fittings import METAL_VARIANT_SET, METALS, USUAL, fitting_slots
from chord_usd.library.kit.model import Design
from chord_usd.library.surfaces.physical import stuff_of
from chord_usd.library.surfaces.surface_maps import MAPS_FOLDER
from tests.design_forms import ends
from tests.every import later

DRESSING_NAMES = {row.name for row in DRESSING_CATEGORIES}
"""What is soft or thin needs no collider."""

ALL = {design.id: design for design in designs()}
FIRST = list({design.category: design for design in reversed(ALL.values())}.values())
"""The first design of each category."""


@pytest.fixture(scope="module", params=[FIRST[::2], *later(list(ALL.values())[::15])], ids=len)
def sample(request: pytest.FixtureRequest) -> list[Design]:
    return list(request.param)


@pytest.fixture(scope="module")
def library(sample: list[Design], tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("library")
    build_assets(folder, chosen=sample)
    return folder


@pytest.fixture(scope="module")
def assets(library: Path) -> tuple[Asset, ...]:
    return read_index(library)


def open_asset(asset: Asset, load: Usd.Stage.InitialLoadSet = Usd.Stage.LoadAll) -> Usd.Stage:
    return Usd.Stage.Open(str(asset.usd_path), load)


def meshes_of(stage: Usd.Stage) -> list[UsdGeom.Mesh]:
    return [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]


def bytes_of(folder: Path) -> dict[str, bytes]:
    files = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def test_the_index_names_every_design(assets: tuple[Asset, ...], sample: list[Design]) -> None:
    assert {asset.id: asset.size_m for asset in assets} == {
        design.id: design.size_m for design in sample
    }
    assert all(asset.licence == "CC0-1.0" and asset.author for asset in assets)


def test_usd_validation_finds_nothing(assets: tuple[Asset, ...]) -> None:
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    for asset in assets:
        errors = context.Validate(open_asset(asset))
        assert [error.GetMessage() for error in errors] == [], asset.id
        assert UsdUtils.ComputeAllDependencies(str(asset.usd_path))[2] == []


def test_the_same_design_gives_the_same_bytes(
    library: Path, sample: list[Design], tmp_path: Path
) -> None:
    for design in sample[::9]:
        write_component(design, tmp_path)
        assert bytes_of(tmp_path / design.id) == bytes_of(library / design.id)


def test_components_are_built_as_the_asset_guidelines_ask(assets: tuple[Asset, ...]) -> None:
    for asset in assets:
        stage = open_asset(asset)
        root = stage.GetDefaultPrim()
        assert root.GetName() == asset.id
        assert Usd.ModelAPI(root).GetKind() == "component"
        assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z
        assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
        assert [str(p) for p in root.GetInherits().GetAllDirectInherits()] == [
            f"/__class__/{asset.id}"
        ]
        parts = {child.GetName() for child in root.GetChildren()}
        assert parts == {"Geometry", "Materials", "Colliders"}
        assert all(child.IsA(UsdGeom.Scope) for child in root.GetChildren())
        assert root.GetAssetInfoByKey("name") == asset.id
        assert root.HasPayload()


def test_labels_say_what_a_component_is_and_what_it_is_made_of(assets: tuple[Asset, ...]) -> None:
    changed = 0
    for asset in assets:
        stage, design = open_asset(asset), ALL[asset.id]
        root = stage.GetDefaultPrim()
        item = wikidata_item(asset.category)
        for taxonomy, name in {"class": asset.category, "wikidata_qcode": item}.items():
            assert list(UsdSemantics.LabelsAPI(root, taxonomy).GetLabelsAttr().Get()) == [name]
        said = set()
        for colourway, looks in list(design.colourways.items())[:2]:
            root.GetVariantSet("colour").SetVariantSelection(colourway)
            for slot, finish in looks.items():
                material = stage.GetPrimAtPath(material_path(asset.id, slot))
                if material:
                    assert material.HasAPI(UsdSemantics.LabelsAPI, "material")
                    labels = material.GetAttribute("semantics:labels:material").Get()
                    assert list(labels) == [stuff_of(design.finishes[finish])], material
                    said.add((slot, labels[0]))
        changed += len(said) > len({slot for slot, _ in said})
    assert changed, "some colourway is of other stuff"


def test_a_closed_payload_still_gives_bounds_and_colourways(assets: tuple[Asset, ...]) -> None:
    for asset in assets:
        closed, opened = open_asset(asset, Usd.Stage.LoadNone), open_asset(asset)
        assert meshes_of(closed) == []
        root = closed.GetDefaultPrim()
        low, high = (np.array(corner) for corner in UsdGeom.ModelAPI(root).GetExtentsHint())
        corners = [np.array(mesh.GetExtentAttr().Get()) for mesh in meshes_of(opened)]
        assert np.allclose(low, np.min([c[0] for c in corners], axis=0))
        assert np.allclose(high, np.max([c[1] for c in corners], axis=0))
        assert np.allclose((high - low)[:2], asset.size_m[:2], atol=1e-6)
        assert root.GetVariantSet("colour").GetVariantNames() == sorted(ALL[asset.id].colourways)


def test_meshes_are_whole(assets: tuple[Asset, ...]) -> None:
    """Topology, extents, normals, UVs, material: all there, all of the right length."""
    for asset in assets:
        stage = open_asset(asset)
        for mesh in meshes_of(stage):
            points = np.array(mesh.GetPointsAttr().Get())
            corners = np.array(mesh.GetFaceVertexIndicesAttr().Get())
            counts = np.array(mesh.GetFaceVertexCountsAttr().Get())
            assert set(corners.tolist()) == set(range(len(points))), "every point is used"
            assert np.all(counts == 3)
            assert counts.sum() == len(corners)
            assert mesh.GetSubdivisionSchemeAttr().Get() == UsdGeom.Tokens.none
            extent = np.array(mesh.GetExtentAttr().Get())
            assert np.allclose(extent, [points.min(axis=0), points.max(axis=0)])
            normals = np.array(mesh.GetNormalsAttr().Get())
            assert mesh.GetNormalsInterpolation() == UsdGeom.Tokens.faceVarying
            assert normals.shape == (len(corners), 3)
            uvs = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st")
            assert uvs.GetInterpolation() == UsdGeom.Tokens.faceVarying
            assert len(uvs.ComputeFlattened()) == len(corners)
            assert len(set(uvs.Get())) == len(uvs.Get()), "no coordinate is said twice"
            material = UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial()[0]
            assert material.GetPath().HasPrefix(Sdf.Path(f"/{asset.id}/Materials"))


def test_colliders_are_shapes_and_nothing_is_a_rigid_body(assets: tuple[Asset, ...]) -> None:
    for asset in assets:
        stage = open_asset(asset)
        prims = list(stage.Traverse())
        assert not any(prim.HasAPI(UsdPhysics.RigidBodyAPI) for prim in prims)
        solid = [prim for prim in prims if prim.HasAPI(UsdPhysics.CollisionAPI)]
        assert solid or asset.category in DRESSING_NAMES, asset.id
        for prim in solid:
            if prim.IsA(UsdGeom.Cube):
                assert UsdGeom.Imageable(prim).ComputePurpose() == UsdGeom.Tokens.guide
            else:
                approximation = UsdPhysics.MeshCollisionAPI(prim).GetApproximationAttr().Get()
                assert approximation == "convexHull"


def test_every_collider_has_a_physics_material(assets: tuple[Asset, ...]) -> None:
    for asset in assets:
        stage = open_asset(asset)
        for prim in stage.Traverse():
            if prim.HasAPI(UsdPhysics.CollisionAPI):
                bound = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial("physics")[0]
                feel = UsdPhysics.MaterialAPI(bound.GetPrim())
                assert bound.GetPrim().HasAPI(UsdPhysics.MaterialAPI), f"{asset.id} {prim}"
                slides = feel.GetDynamicFrictionAttr().Get()
                assert 0.0 < slides <= feel.GetStaticFrictionAttr().Get() < 1.0
                assert 0.0 <= feel.GetRestitutionAttr().Get() < 1.0
                assert 20.0 < feel.GetDensityAttr().Get() < 8000.0


def test_what_people_move_is_felt_as_boxes_and_hulls_that_stand_on_boxes() -> None:
    """Hulls rock on their many corners, and triangles are nothing that could move."""
    for design in ends(design for design in designs() if design.category in having("moved")):
        parts = design.parts()
        boxes = [bounds for part in parts for bounds in part.collider_boxes_m().values()]
        assert min(bounds[0, 2] for bounds in boxes) < 1e-3, design.id
        for part in parts:
            assert part.collider != "none", f"{design.id} {part.name}"
            if part.collider == "convexHull":
                assert part.solid.bounds_m()[0, 2] > 1e-3, f"{design.id} {part.name}"


def test_a_chair_fits_under_every_table(assets: tuple[Asset, ...]) -> None:
    """No collider of a dining table or desk fills the knee room in its middle at the front."""
    for asset in assets:
        if asset.category not in ("table", "dining_table") or "Round" in asset.id:
            continue
        bounds = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default", "guide"])
        stage = open_asset(asset)
        for prim in stage.Traverse():
            if prim.HasAPI(UsdPhysics.CollisionAPI):
                box = bounds.ComputeWorldBound(prim).ComputeAlignedRange()
                low, high = box.GetMin(), box.GetMax()
                over = low[0] < 0.0 < high[0] and low[1] < -asset.size_m[1] * 0.35 < high[1]
                assert not (over and low[2] < 0.55), f"{asset.id} {prim.GetName()}"


def colours(stage: Usd.Stage) -> dict[str, tuple]:
    shaders = (UsdShade.Shader(p) for p in stage.Traverse() if p.GetName() == "Surface")
    return {str(s.GetPath()): tuple(s.GetInput("diffuseColor").Get()) for s in shaders}


def pictures(stage: Usd.Stage) -> dict[str, str]:
    """The file of each picture on a surface."""
    shaders = (UsdShade.Shader(p) for p in stage.Traverse() if p.IsA(UsdShade.Shader))
    return {str(s.GetPath()): s.GetInput("file").Get().path for s in shaders if s.GetInput("file")}


def test_colourways_change_what_is_seen(assets: tuple[Asset, ...]) -> None:
    for asset in assets[::7]:
        stage, design = open_asset(asset), ALL[asset.id]
        variants = stage.GetDefaultPrim().GetVariantSet("colour")
        assert variants.GetVariantSelection() == next(iter(design.colourways)), asset.id
        seen = []
        for name in design.colourways:
            variants.SetVariantSelection(name)
            seen.append((colours(stage), pictures(stage)))
        assert all(one != other for one, other in itertools.pairwise(seen)), asset.id


def test_instances_of_two_colourways_keep_their_own(assets: tuple[Asset, ...]) -> None:
    asset = next(asset for asset in assets if "walnut" in ALL[asset.id].colourways)
    stage = Usd.Stage.CreateInMemory()
    names = list(ALL[asset.id].colourways)[:2]
    for name in names:
        prim = UsdGeom.Xform.Define(stage, f"/{name}").GetPrim()
        prim.GetReferences().AddReference(str(asset.usd_path))
        prim.GetVariantSet("colour").SetVariantSelection(name)
        prim.SetInstanceable(True)
    first, second = (stage.GetPrimAtPath(f"/{name}").GetPrototype() for name in names)
    assert first
    assert second
    assert first != second


FITTED = next(design for design in ALL.values() if design.category == "washbasin")


def test_fittings_are_of_the_chosen_metal_in_every_colourway(tmp_path: Path) -> None:
    """Nothing else changes with the metal; as usual, they are what the colourway says."""
    stage = Usd.Stage.Open(str(write_component(FITTED, tmp_path)))
    used = {slot for looks in FITTED.colourways.values() for slot in looks}
    paths = {f"{material_path(FITTED.id, slot)}/Surface": slot for slot in used}
    fittings = fitting_slots(FITTED, used)
    sets = stage.GetDefaultPrim().GetVariantSets()
    for colourway, looks in FITTED.colourways.items():
        sets.SetSelection("colour", colourway)
        for metal in (USUAL, *METALS):
            sets.SetSelection(METAL_VARIANT_SET, metal)
            for path, seen in colours(stage).items():
                slot = paths[path]
                changed = metal != USUAL and slot in fittings
                finish = FITTED.finishes[metal if changed else looks[slot]]
                assert np.allclose(seen, finish.linear_rgb(), atol=1e-6), (path, metal)


def test_the_cache_holds_what_was_asked_for(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("CHORD_USD_CACHE", str(tmp_path))
    database = load_database(texture_px=128)
    assert len(database.assets) == len(ALL)
    assert list(tmp_path.iterdir()) == [], "nothing is drawn before it is asked for"
    for row in (*HOUSE_CATEGORIES, *TABLE_CATEGORIES):
        middle = tuple(sum(span) / 2 for span in (row.length_m, row.width_m, row.height_m))
        found = database.nearest(row.name, middle)
        assert found.category == row.name
        assert Usd.Stage.Open(str(found.usd_path)).GetDefaultPrim().GetName() == found.id
    (folder,) = tmp_path.iterdir()
    drawn = {one.name for one in folder.iterdir()} - {MAPS_FOLDER}
    assert len(drawn) <= len(HOUSE_CATEGORIES) + len(TABLE_CATEGORIES)
    bed = database.nearest("bed", (1.8, 2.1, 1.0))
    stamp = bed.usd_path.stat().st_mtime_ns
    again = load_database(texture_px=128).nearest("bed", (1.8, 2.1, 1.0))
    assert again == bed
    assert again.usd_path.stat().st_mtime_ns == stamp, "the second time it is only read"
