"""Packages of a house, opened again with what will open them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from pxr import Usd, UsdGeom, UsdShade, UsdUtils

from chord_usd.errors import OutputError
from chord_usd.stage.export import export_stage

PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)


def bounds_m(path: Path) -> np.ndarray:
    stage = Usd.Stage.Open(str(path))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"])
    box = cache.ComputeWorldBound(stage.GetPseudoRoot()).ComputeAlignedRange()
    return np.array([box.GetMin(), box.GetMax()])


def mesh_names(path: Path) -> set[str]:
    stage = Usd.Stage.Open(str(path))
    return {
        str(prim.GetPath()).strip("/")
        for prim in stage.Traverse(PROXIES)
        if prim.IsA(UsdGeom.Mesh) and prim.GetParent().GetName() != "Ground"
    }


@pytest.fixture(scope="module")
def glb(staged_house: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("gltf") / "house.glb"
    export_stage(staged_house, path, "gltf")
    return path


def test_a_glb_holds_every_mesh_in_its_place(staged_house: Path, glb: Path) -> None:
    scene = trimesh.load_scene(glb)
    assert set(scene.graph.nodes_geometry) == mesh_names(staged_house)
    low, high = bounds_m(staged_house)
    # Y up: x stays, z becomes y, y becomes -z.
    assert np.allclose(scene.bounds[0], (low[0], low[2], -high[1]), atol=1e-4)
    assert np.allclose(scene.bounds[1], (high[0], high[2], -low[1]), atol=1e-4)


def test_instances_share_their_meshes_in_a_glb(glb: Path) -> None:
    scene = trimesh.load_scene(glb)
    assert len(scene.geometry) < len(scene.graph.nodes_geometry)


def test_floors_have_their_picture_in_a_glb(glb: Path) -> None:
    scene = trimesh.load_scene(glb)
    floors = [name for name in scene.graph.nodes_geometry if name.endswith("/Geometry/Floor")]
    assert floors
    for name in floors:
        mesh = scene.geometry[scene.graph[name][1]]
        assert mesh.visual.material.baseColorTexture.size[0] >= 256
        assert np.ptp(mesh.visual.uv, axis=0).min() > 0.2  # it spreads over the floor
        assert mesh.vertex_normals[:, 2].min() > 0.99  # up, in the frame of the mesh


def test_a_web_package_is_flat_and_whole(staged_house: Path, tmp_path: Path) -> None:
    path = tmp_path / "house.usdz"
    export_stage(staged_house, path, "web")
    stage = Usd.Stage.Open(str(path))
    prims = list(stage.Traverse(PROXIES))
    assert not any(prim.IsInstance() or prim.HasAuthoredPayloads() for prim in prims)
    assert not any(prim.HasAuthoredReferences() for prim in prims)
    assert UsdUtils.ComputeAllDependencies(str(path))[2] == []
    assert mesh_names(path) == mesh_names(staged_house)
    assert np.allclose(bounds_m(path), bounds_m(staged_house), atol=1e-4)
    assert not any(prim.GetTypeName() == "Cube" for prim in prims)
    for prim in prims:
        if prim.IsA(UsdGeom.Mesh) and prim.GetName() == "Floor":
            material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
            assert material.ComputeSurfaceSource()[0]


def test_pictures_lie_in_a_web_package_as_they_do_in_a_glb(
    staged_house: Path, glb: Path, tmp_path: Path
) -> None:
    path = tmp_path / "house.usdz"
    export_stage(staged_house, path, "web")
    stage = Usd.Stage.Open(str(path))
    assert not any(
        UsdShade.Shader(prim).GetIdAttr().Get() == "UsdTransform2d"
        for prim in stage.Traverse()
        if prim.IsA(UsdShade.Shader)
    )
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    assert all(set(mesh.GetFaceVertexCountsAttr().Get()) == {3} for mesh in meshes)
    scene = trimesh.load_scene(glb)
    for prim in stage.Traverse():
        if prim.GetName() in ("Floor", "Wall_0"):
            mesh = scene.geometry[scene.graph[str(prim.GetPath()).strip("/")][1]]
            uvs = np.array(UsdGeom.PrimvarsAPI(prim).GetPrimvar("st").Get())
            for pick in (np.min, np.max):
                assert np.allclose(pick(uvs, axis=0), pick(mesh.visual.uv, axis=0), atol=1e-4)


def test_the_suffix_belongs_to_the_package(staged_house: Path, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"house\.glb"):
        export_stage(staged_house, tmp_path / "house.usdz", "gltf")
    assert list(tmp_path.iterdir()) == []
