"""A house as a data set of Habitat: files of its form, things where the stage has them."""

from __future__ import annotations

import json
from pathlib import Path

import jsonschema
import numpy as np
import pytest
import trimesh
from pxr import Usd, UsdGeom
from scipy.spatial.transform import Rotation

from chord_usd.line.stage.export.export_stage import export_stage
from chord_usd.line.stage.export.gltf import Y_UP

SCHEMA = json.loads((Path(__file__).parent.parent / "habitat.schema.json").read_text())


@pytest.fixture(scope="module")
def data_set(opening_house: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("habitat") / "house"
    export_stage(opening_house, folder, "habitat")
    return folder


def read(folder: Path, kind: str) -> dict:
    (path,) = folder.rglob(f"*.{kind}.json")
    return json.loads(path.read_text())


def bounds_m(corners: np.ndarray) -> np.ndarray:
    return np.array([corners.min(axis=0), corners.max(axis=0)])


def test_files_keep_to_the_form_of_habitat(data_set: Path) -> None:
    kinds = set()
    for path in data_set.rglob("*.json"):
        kind = path.name.split(".")[-2]
        kinds.add(kind)
        jsonschema.validate(json.loads(path.read_text()), {**SCHEMA, "$ref": f"#/$defs/{kind}"})
    assert kinds == set(SCHEMA["$defs"]) - {"vector", "quaternion"}
    told = read(data_set, "scene_dataset_config")
    for kind in ("stages", "objects", "light_setups", "scene_instances"):
        assert (data_set / told[kind]["paths"][".json"][0]).is_dir()
    for path in told["semantic_scene_descriptor_instances"].values():
        assert (data_set / path).is_file()


def test_things_are_as_large_and_where_the_stage_has_them(
    data_set: Path, opening_house: Path
) -> None:
    stage = Usd.Stage.Open(str(opening_house))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"])
    motions = set()
    for one in read(data_set, "scene_instance")["object_instances"]:
        config = json.loads((data_set / f"{one['template_name']}.object_config.json").read_text())
        shape = trimesh.load_scene(data_set / "objects" / config["render_asset"])
        points = shape.to_mesh().vertices * one["non_uniform_scale"]
        w, x, y, z = one["rotation"]
        seen = points @ Rotation.from_quat([x, y, z, w]).as_matrix().T + one["translation"]
        prim = stage.GetPrimAtPath(one["user_defined"]["path"])
        there = [
            mesh_points(below) for below in Usd.PrimRange(prim, Usd.TraverseInstanceProxies())
            if below.IsA(UsdGeom.Mesh) and cache.ComputeWorldBound(below)
        ]  # fmt: skip
        expected = np.concatenate(there) @ Y_UP[:3, :3].T
        assert np.allclose(bounds_m(seen), bounds_m(expected), atol=2e-3), prim.GetPath()
        assert (data_set / "objects" / config["collision_asset"]).is_file()
        assert one["user_defined"]["class"]
        motions.add(one["motion_type"])
    assert motions == {"STATIC", "KINEMATIC", "DYNAMIC"}


def mesh_points(prim: Usd.Prim) -> np.ndarray:
    """(N, 3) in the world."""
    matrix = np.array(UsdGeom.Xformable(prim).ComputeLocalToWorldTransform(Usd.TimeCode.Default()))
    points = np.array(UsdGeom.Mesh(prim).GetPointsAttr().Get(), float)
    return points @ matrix[:3, :3] + matrix[3, :3]


def test_the_stage_is_the_house_without_things_and_rooms_are_regions(
    data_set: Path, opening_house: Path
) -> None:
    names = set(trimesh.load_scene(data_set / "stages" / "house.glb").graph.nodes)
    assert any(name.startswith("Wall_0") for name in names)
    assert not any(name.startswith(("Leaf_", "Refrigerator_")) for name in names)
    stage = Usd.Stage.Open(str(opening_house))
    rooms = {prim.GetName() for prim in stage.GetPrimAtPath("/House/Rooms").GetChildren()}
    regions = read(data_set, "semantic_config")["region_annotations"]
    assert {one["name"] for one in regions} == rooms
