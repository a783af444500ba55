"""assets add: libraries of other people become components, and bad ones are refused in words."""

from __future__ import annotations

import json
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from pxr import Usd, UsdGeom, UsdValidation

from chord_usd.base.errors import AssetError
from chord_usd.base.runtime import archives
from chord_usd.base.scene.types import SceneGraph
from chord_usd.library.database import AssetDatabase, read_index
from chord_usd.library.libraries.add import Added, add_library
from chord_usd.library.libraries.readers import open_library, read_properties
from chord_usd.line.stage.author.attribution import attribution_file
from chord_usd.line.stage.author.author_stage import author_stage


def chair_mesh(scale: float = 1.0) -> trimesh.Trimesh:
    """A seat with a back, y up and the front towards +z, as in glTF: 0.5 x 0.9 x 0.55."""
    seat = trimesh.creation.box((0.5, 0.45, 0.55)).apply_translation((0.0, 0.225, 0.0))
    back = trimesh.creation.box((0.5, 0.45, 0.1)).apply_translation((0.0, 0.675, -0.225))
    return trimesh.util.concatenate([seat, back]).apply_scale(scale)


def folder_with(tmp_path: Path, *rows: dict[str, Any], name: str = "mine") -> Path:
    folder = tmp_path / name
    folder.mkdir(exist_ok=True)
    (folder / "manifest.json").write_text(json.dumps(list(rows)))
    return folder


def add(library: Path, tmp_path: Path, **options: Any) -> tuple[Added, Path]:
    target = tmp_path / "database"
    target.mkdir(exist_ok=True)
    return add_library(library, target, **options), target


@pytest.mark.parametrize("suffix", [".glb", ".obj"])
def test_a_model_stands_upright_and_faces_the_front(tmp_path: Path, suffix: str) -> None:
    row = {"file": f"chair{suffix}", "category": "chair", "licence": "CC0-1.0", "author": "Jo"}
    folder = folder_with(tmp_path, row)
    chair_mesh().export(folder / row["file"])
    _, database = add(folder, tmp_path)
    (asset,) = read_index(database)
    assert (asset.category, asset.licence, asset.author) == ("chair", "CC0-1.0", "Jo")
    assert asset.size_m == pytest.approx((0.5, 0.55, 0.9))
    stage = Usd.Stage.Open(str(asset.usd_path))
    points = np.concatenate(
        [
            np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get())
            for prim in stage.Traverse()
            if prim.IsA(UsdGeom.Mesh)
        ]
    )
    high = points[points[:, 2] > 0.8]
    assert np.all(high[:, 1] > 0.1), "its back is at +y"
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    assert [error.GetMessage() for error in context.Validate(stage)] == []


def test_the_catalogue_size_counts_and_wrong_units_are_guessed(tmp_path: Path) -> None:
    folder = folder_with(
        tmp_path,
        {"file": "chair.obj", "category": "chair", "size_cm": [48, 52, 88], "id": "sized"},
        {"file": "large.obj", "category": "chair"},
    )
    chair_mesh().export(folder / "chair.obj")
    chair_mesh(100.0).export(folder / "large.obj")
    added, _ = add(folder, tmp_path)
    assert added.assets[0].size_m == pytest.approx((0.48, 0.52, 0.88))
    assert added.assets[1].size_m == pytest.approx((0.5, 0.55, 0.9))


def test_heavy_meshes_are_reduced(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, {"file": "pouf.glb", "category": "pouf"})
    ball = trimesh.creation.icosphere(subdivisions=5, radius=0.4)
    ball.export(folder / "pouf.glb")
    added, _ = add(folder, tmp_path, most_triangles=2000)
    assert added.assets[0].category == "leisure_sofa"
    stage = Usd.Stage.Open(str(added.assets[0].usd_path))
    faces = sum(
        len(UsdGeom.Mesh(prim).GetFaceVertexCountsAttr().Get())
        for prim in stage.Traverse()
        if prim.IsA(UsdGeom.Mesh)
    )
    assert 500 < faces <= 2000
    assert any("reduced from 20,480" in warning for warning in added.warnings)


def test_what_cannot_be_used_is_refused_and_the_rest_taken(tmp_path: Path) -> None:
    folder = folder_with(
        tmp_path,
        {"file": "chair.glb", "category": "chair"},
        {"file": "chair.glb", "category": "spaceship", "id": "ship"},
        {"file": "gone.glb", "category": "chair"},
        {"file": "empty.obj", "category": "chair"},
        {"file": "noise.glb", "category": "chair"},
        {"file": "huge.glb", "category": "chair", "unit": "m"},
    )
    chair_mesh().export(folder / "chair.glb")
    chair_mesh(37.0).export(folder / "huge.glb")
    (folder / "empty.obj").write_text("v 0 0 0\nv 1 0 0\n")
    (folder / "noise.glb").write_bytes(b"glTF" + bytes(60))
    added, _ = add(folder, tmp_path)
    assert [asset.id for asset in added.assets] == ["chair"]
    why = {refused.id: refused.why for refused in added.refused}
    assert set(why) == {"ship", "gone", "empty", "noise", "huge"}
    assert "no known category fits 'spaceship'" in why["ship"]
    assert "missing" in why["gone"]
    assert "measures" in why["huge"]


def test_a_category_spelled_wrong_is_guessed_and_said(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, {"file": "t.glb", "category": "toilett"})
    trimesh.creation.box((0.4, 0.8, 0.65)).export(folder / "t.glb")
    added, _ = add(folder, tmp_path)
    assert added.assets[0].category == "toilet"


def test_the_same_id_twice_gets_a_number(tmp_path: Path) -> None:
    for name in ("first", "second"):
        folder = folder_with(tmp_path, {"file": "chair.glb", "category": "chair"}, name=name)
        chair_mesh().export(folder / "chair.glb")
        added, database = add(folder, tmp_path)
    assert [asset.id for asset in read_index(database)] == ["chair", "chair_2"]
    assert any("was there already" in warning for warning in added.warnings)


def test_open_surfaces_are_shown_from_both_sides(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, {"file": "chair.glb", "category": "chair"})
    mesh = chair_mesh()
    mesh.update_faces(np.arange(len(mesh.faces)) > 1)
    mesh.export(folder / "chair.glb")
    added, _ = add(folder, tmp_path)
    assert any("open or non-manifold" in warning for warning in added.warnings)


def sweet_home(path: Path, catalogue: str, **files: bytes) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("PluginFurnitureCatalog.properties", catalogue)
        for name, data in files.items():
            archive.writestr(name.replace("__", "/"), data)
    return path


CATALOGUE = """# a library
license=CC BY 3.0
provider=Somebody
id#1=Jos\\u00e9#red chair
name#1=Chair
model#1=/jo/chair.obj
width#1=48.0
depth#1=52.0
height#1=90.0
creator#1=Jos\\u00e9
id#2=door
name#2=Door
model#2=/jo/chair.obj
width#2=90
depth#2=10
height#2=200
doorOrWindow#2=true
"""


def test_sweet_home_libraries_bring_size_licence_and_creator(tmp_path: Path) -> None:
    chair_mesh().export(tmp_path / "chair.obj")
    path = sweet_home(
        tmp_path / "l.sh3f", CATALOGUE, jo__chair_obj=(tmp_path / "chair.obj").read_bytes()
    )
    with zipfile.ZipFile(path, "a") as archive:
        archive.write(tmp_path / "chair.obj", "jo/chair.obj")
    added, _ = add(path, tmp_path)
    (asset,) = added.assets
    assert asset.id == "red_chair"
    assert asset.size_m == pytest.approx((0.48, 0.52, 0.9))
    assert (asset.licence, asset.author) == ("CC BY 3.0", "José")


def test_properties_are_read_as_java_does() -> None:
    text = "a = one\\\n  two\n! no\nb=caf\\u00e9\n"
    assert read_properties(text) == {"a": "onetwo", "b": "café"}


@pytest.mark.parametrize("name", ["../outside.obj", "/etc/outside.obj", "a/../../outside.obj"])
def test_names_that_leave_the_archive_are_refused(tmp_path: Path, name: str) -> None:
    with zipfile.ZipFile(tmp_path / "bad.sh3f", "w") as archive:
        archive.writestr(name, "v 0 0 0")
    with pytest.raises(AssetError, match="outside itself"):
        open_library(tmp_path / "bad.sh3f").models()


def test_zip_bombs_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with zipfile.ZipFile(tmp_path / "bomb.sh3f", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("zeros", bytes(16 * 2**20))
    with pytest.raises(AssetError, match="zip bomb"):
        open_library(tmp_path / "bomb.sh3f").models()
    monkeypatch.setattr(archives, "MOST_BYTES", 2**20)
    with pytest.raises(AssetError, match="unpacks to"):
        open_library(tmp_path / "bomb.sh3f").models()


def test_3d_future_is_known_by_its_list(tmp_path: Path) -> None:
    folder = tmp_path / "3D-FUTURE-model"
    (folder / "abc").mkdir(parents=True)
    chair_mesh().export(folder / "abc" / "raw_model.obj")
    rows = [
        {"model_id": "abc", "super-category": "Chair", "category": "Dining Chair"},
        {"model_id": "not-here", "super-category": "Sofa", "category": "Lazy Sofa"},
    ]
    (folder / "model_info.json").write_text(json.dumps(rows))
    added, _ = add(folder, tmp_path)
    assert [(a.id, a.category) for a in added.assets] == [("future_abc", "chair")]


def test_a_folder_that_is_no_library_is_told_how_to_become_one(tmp_path: Path) -> None:
    with pytest.raises(AssetError, match=r"manifest\.json"):
        open_library(tmp_path)


def test_added_models_are_retrieved(tmp_path: Path) -> None:
    folder = folder_with(tmp_path, {"file": "chair.glb", "category": "chair"})
    chair_mesh().export(folder / "chair.glb")
    added, database = add(folder, tmp_path)
    found = AssetDatabase(read_index(database)).nearest("chair", (0.5, 0.5, 0.9))
    assert found.id == added.assets[0].id


def test_who_made_a_model_is_named_beside_the_house(
    staged_graph: SceneGraph, tmp_path: Path
) -> None:
    row = {"file": "chair.glb", "category": "chair", "licence": "CC-BY-4.0", "author": "José"}
    folder = folder_with(tmp_path, row)
    chair_mesh().export(folder / "chair.glb")
    added, _ = add(folder, tmp_path)
    first, *others = staged_graph.items
    theirs = replace(staged_graph, items=(replace(first, asset=added.assets[0]), *others))
    for name in ("house.usda", "packed.usdz"):
        stage = tmp_path / "out" / name
        author_stage(theirs, stage)
        told = attribution_file(stage).read_text(encoding="utf-8")
        assert "author José, licence CC-BY-4.0" in told
        assert sum("chair" in line.lower() for line in told.splitlines()) == 1
    author_stage(staged_graph, tmp_path / "out" / "house.usda")
    assert "José" not in attribution_file(tmp_path / "out" / "house.usda").read_text()
    author_stage(staged_graph, tmp_path / "own" / "house.usda")
    assert "José" not in attribution_file(tmp_path / "own" / "house.usda").read_text()
