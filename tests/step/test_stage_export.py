"""Packages of a house, opened again with what will open them."""

from __future__ import annotations

import json
import struct
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image
from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdUtils

from chord_usd.base.errors import OutputError
from chord_usd.cli import UNUSABLE, main
from chord_usd.line.stage.author.names import BORDER
from chord_usd.line.stage.author.surfaces import (
    bound_material,
    placed,
    placement_of,
    source_of,
    st_of,
)
from chord_usd.line.stage.export.export_stage import export_stage
from chord_usd.line.stage.export.gltf import write_glb
from chord_usd.line.stage.export.gltf_lights import LUX_PER_UNIT

Y_UP = np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
PROXIES = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)


def bounds_m(path: Path) -> np.ndarray:
    stage = Usd.Stage.Open(str(path))
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"])
    box = cache.ComputeWorldBound(stage.GetPseudoRoot()).ComputeAlignedRange()
    return np.array([box.GetMin(), box.GetMax()])


def is_shown(prim: Usd.Prim) -> bool:
    return prim.IsA(UsdGeom.Mesh) and prim.GetParent().GetName() != "Ground"


def mesh_names(path: Path) -> set[str]:
    stage = Usd.Stage.Open(str(path))
    return {str(prim.GetPath()).strip("/") for prim in stage.Traverse(PROXIES) if is_shown(prim)}


@pytest.fixture(scope="module")
def glb(staged_house: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("gltf") / "house.glb"
    export_stage(staged_house, path, "gltf")
    return path


def read_glb(path: Path) -> dict[str, Any]:
    """The JSON of a .glb."""
    data = path.read_bytes()
    magic, version, length, size, kind = struct.unpack("<4s3I4s", data[:20])
    assert (magic, version, length, kind) == (b"glTF", 2, len(data), b"JSON")
    return json.loads(data[20 : 20 + size])


def worlds(document: dict[str, Any]) -> dict[str, np.ndarray]:
    """(4, 4) of each node by the names from the root to it."""
    found = {}

    def go(place: int, above: str, frame: np.ndarray) -> None:
        node = document["nodes"][place]
        frame = frame @ np.reshape(node.get("matrix", np.eye(4)), (4, 4)).T
        found[f"{above}/{node['name']}"] = frame
        for child in node.get("children", ()):
            go(child, f"{above}/{node['name']}", frame)

    go(document["scenes"][0]["nodes"][0], "", np.eye(4))
    return found


def test_a_glb_is_as_large_as_the_house(staged_house: Path, glb: Path) -> None:
    scene = trimesh.load_scene(glb)
    low, high = bounds_m(staged_house)
    assert np.allclose(
        scene.bounds,
        [Y_UP @ (low[0], high[1], low[2]), Y_UP @ (high[0], low[1], high[2])],
        atol=1e-4,
    )


def test_a_glb_has_every_triangle(staged_house: Path, glb: Path) -> None:
    stage = Usd.Stage.Open(str(staged_house))
    meshes = [prim for prim in stage.Traverse(PROXIES) if is_shown(prim)]
    counts = sum(
        np.sum(np.array(UsdGeom.Mesh(p).GetFaceVertexCountsAttr().Get()) - 2) for p in meshes
    )
    scene = trimesh.load_scene(glb)
    parts = [scene.geometry[scene.graph[name][1]] for name in scene.graph.nodes_geometry]
    assert sum(len(part.faces) for part in parts) == counts


def test_what_has_a_label_is_a_node_that_says_so(staged_house: Path, glb: Path) -> None:
    stage, document = Usd.Stage.Open(str(staged_house)), read_glb(glb)
    said = {
        node["extras"]["path"]: node["extras"] for node in document["nodes"] if "extras" in node
    }
    labelled = {
        str(prim.GetPath()): str(prim.GetAttribute("semantics:labels:category").Get()[0])
        for prim in stage.Traverse(PROXIES)
        if prim.HasAttribute("semantics:labels:category")
        and not prim.GetName().startswith(("Ground", BORDER))  # open borders have no mesh
    }
    assert {
        path: extras["category"] for path, extras in said.items() if "category" in extras
    } == labelled
    for path, extras in said.items():
        assert (
            extras["room"] == path.split("/")[3]
            if path.startswith("/House/Rooms")
            else "room" not in extras
        )
        assert extras.get("id") == stage.GetPrimAtPath(path).GetAttribute("chord:node_id").Get()
    rooms = [extras for extras in said.values() if "kind" in extras]
    assert len(rooms) == len(stage.GetPrimAtPath("/House/Rooms").GetChildren())


def test_nodes_stand_where_prims_do(staged_house: Path, glb: Path) -> None:
    stage, frames = Usd.Stage.Open(str(staged_house)), UsdGeom.XformCache()
    found = worlds(read_glb(glb))
    furniture = [name for name in found if "/Furniture/" in name]
    assert furniture
    cameras = [name for name in found if name.startswith("/House/Cameras/")]
    assert len(cameras) == len(stage.GetPrimAtPath("/House/Cameras").GetChildren())
    for name in (*furniture, *cameras):
        world = np.array(frames.GetLocalToWorldTransform(stage.GetPrimAtPath(name))).T
        assert np.allclose(found[name][:3], Y_UP @ world[:3], atol=1e-5)


def test_a_glb_has_the_lights_that_shine(staged_house: Path, glb: Path, tmp_path: Path) -> None:
    counts = {}
    for time in ("day", "night"):
        stage = Usd.Stage.Open(str(staged_house))
        stage.SetEditTarget(stage.GetSessionLayer())
        stage.GetDefaultPrim().GetVariantSet("lighting").SetVariantSelection(time)
        write_glb(stage, tmp_path / f"{time}.glb")
        lights = read_glb(tmp_path / f"{time}.glb")["extensions"]["KHR_lights_punctual"]["lights"]
        assert all(light["intensity"] > 0.0 for light in lights)
        counts[time] = sum(light["type"] == "directional" for light in lights)
    assert counts == {"day": 1, "night": 0}
    document = read_glb(glb)
    used = [node["extensions"] for node in document["nodes"] if "extensions" in node]
    assert len(used) == len(document["extensions"]["KHR_lights_punctual"]["lights"])


def test_instances_and_looks_are_shared_in_a_glb(glb: Path) -> None:
    document = read_glb(glb)
    worn = [node["mesh"] for node in document["nodes"] if "mesh" in node]
    assert len(document["meshes"]) == len(set(worn)) < len(worn)
    looks = [{**look, "name": ""} for look in document["materials"]]
    assert all(look not in looks[:at] for at, look in enumerate(looks))


def test_floors_have_their_pictures_in_a_glb(glb: Path) -> None:
    document, scene = read_glb(glb), trimesh.load_scene(glb)
    floors = [node for node in document["nodes"] if node["name"].startswith("Floor")]
    assert floors
    for node in floors:
        (part,) = document["meshes"][node["mesh"]]["primitives"]
        look = document["materials"][part["material"]]
        surface = look["pbrMetallicRoughness"]
        places = [
            surface["baseColorTexture"],
            surface["metallicRoughnessTexture"],
            look["normalTexture"],
        ]
        names = [
            document["images"][document["textures"][p["index"]]["source"]]["name"] for p in places
        ]
        kinds = ("base_color", "roughness", "normal")
        assert all(kind in name for kind, name in zip(kinds, names, strict=True))
    for name in scene.graph.nodes_geometry:
        if name.startswith("Floor"):
            mesh = scene.geometry[scene.graph[name][1]]
            assert mesh.visual.material.baseColorTexture.size[0] >= 256
            assert np.ptp(mesh.visual.uv, axis=0).min() > 0.2  # it spreads over the floor
            assert mesh.vertex_normals[:, 2].min() > 0.99  # up, in the frame of the mesh


def test_pictures_hang_upright_in_a_glb(tmp_path: Path) -> None:
    """glTF counts v from the top of a picture, USD from its foot."""
    stage = Usd.Stage.CreateInMemory()
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/Wall").GetPrim())
    mesh = UsdGeom.Mesh.Define(stage, "/Wall/Picture")
    mesh.CreatePointsAttr([(0, 0, 0), (2, 0, 0), (2, 0, 1), (0, 0, 1)])
    mesh.CreateFaceVertexCountsAttr([4])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    st = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(
        "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex
    )
    st.Set([(0, 0), (1, 0), (1, 1), (0, 1)])
    bind_textures(stage, mesh, tmp_path)
    write_glb(stage, tmp_path / "wall.glb")
    document = read_glb(tmp_path / "wall.glb")
    ((part,),) = [one["primitives"] for one in document["meshes"]]
    points, uvs, tangents = (
        accessor(tmp_path / "wall.glb", part["attributes"][name])
        for name in ("POSITION", "TEXCOORD_0", "TANGENT")
    )
    assert np.allclose(uvs, np.column_stack([points[:, 0] / 2, 1.0 - points[:, 2]]))
    assert np.allclose(tangents, (1.0, 0.0, 0.0, 1.0))


def bind_textures(stage: Usd.Stage, mesh: UsdGeom.Mesh, folder: Path) -> None:
    """A material with a picture and a relief on it."""
    material = UsdShade.Material.Define(stage, "/Wall/Look")
    shader = UsdShade.Shader.Define(stage, "/Wall/Look/Surface")
    shader.CreateIdAttr("UsdPreviewSurface")
    reader = UsdShade.Shader.Define(stage, "/Wall/Look/Reader")
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
    for name, kind in (("diffuseColor", "Color3f"), ("normal", "Normal3f")):
        Image.new("RGB", (2, 2), (128, 128, 255)).save(folder / f"{name}.png")
        texture = UsdShade.Shader.Define(stage, f"/Wall/Look/{name}")
        texture.CreateIdAttr("UsdUVTexture")
        texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(str(folder / f"{name}.png"))
        texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(
            reader.ConnectableAPI(), "result"
        )
        shader.CreateInput(name, getattr(Sdf.ValueTypeNames, kind)).ConnectToSource(
            texture.ConnectableAPI(), "rgb"
        )
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)


def accessor(path: Path, place: int) -> np.ndarray:
    """The values of an accessor of float vectors."""
    document, data = read_glb(path), path.read_bytes()
    entry = document["accessors"][place]
    view = document["bufferViews"][entry["bufferView"]]
    start = 28 + struct.unpack("<I", data[12:16])[0] + view["byteOffset"]
    width = {"VEC2": 2, "VEC3": 3, "VEC4": 4}[entry["type"]]
    return np.frombuffer(data, "<f4", entry["count"] * width, start).reshape(-1, width)


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
        if prim.IsA(UsdGeom.Mesh) and prim.GetName().startswith("Floor_"):
            material = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()[0]
            assert material.ComputeSurfaceSource()[0]


@pytest.mark.parametrize("package", ["web", "ar"])
def test_crates_for_browsers_hold_no_vector_in_the_short_form(
    package: str, staged_house: Path, tmp_path: Path
) -> None:
    """three.js takes a scale of (1, 1, 1) for 65793; before, every piece had it."""
    path = tmp_path / "house.usdz"
    export_stage(staged_house, path, package)
    stage = Usd.Stage.Open(str(path))
    layer, short, seen = stage.GetRootLayer(), [], []

    def visit(at: Sdf.Path) -> None:
        spec = layer.GetAttributeAtPath(at) if at.IsPropertyPath() else None
        value = None if spec is None else spec.default
        if type(value).__name__.startswith("Vec") and not hasattr(value, "FromNumpy"):
            seen.append(at)
            numbers = np.array(list(value), dtype=np.float64)
            short.extend([at] if (numbers == np.round(numbers)).all() else [])

    layer.Traverse(Sdf.Path.absoluteRootPath, visit)
    assert seen
    assert short == []
    suffixed = {op.GetOpName() for prim in stage.Traverse() if prim.IsA(UsdGeom.Xformable)
                for op in UsdGeom.Xformable(prim).GetOrderedXformOps()
                if op.GetOpName().count(":") > 1}  # fmt: skip
    assert suffixed == set(), "three.js passes over operations with a suffix"


def test_lights_of_a_glb_suit_one_exposure_or_are_photometric(
    staged_house: Path, glb: Path, tmp_path: Path
) -> None:
    """A sun of 1,200 lux burns a picture white; three.js shows 1 as a white wall."""
    target = tmp_path / "house.glb"
    words = ["export", str(staged_house), "--for", "gltf", "-o", str(target)]
    assert main([*words, "--lights", "photometric"]) == 0
    lights = [read_glb(path)["extensions"]["KHR_lights_punctual"]["lights"]
              for path in (glb, target)]  # fmt: skip
    for plain, measured in zip(*lights, strict=True):
        assert plain["intensity"] < 15.0
        share = measured["intensity"] / plain["intensity"]
        assert share == pytest.approx(LUX_PER_UNIT, rel=1e-2)
    words[3] = "web"
    assert main([*words[:-1], str(tmp_path / "house.usdz"), "--lights", "unitless"]) == UNUSABLE


def test_a_web_package_lays_pictures_without_transforms(staged_house: Path, tmp_path: Path) -> None:
    path = tmp_path / "house.usdz"
    export_stage(staged_house, path, "web")
    stage, source = Usd.Stage.Open(str(path)), Usd.Stage.Open(str(staged_house))
    shaders = [UsdShade.Shader(prim) for prim in stage.Traverse() if prim.IsA(UsdShade.Shader)]
    assert "UsdTransform2d" not in {shader.GetIdAttr().Get() for shader in shaders}
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    assert all(set(mesh.GetFaceVertexCountsAttr().Get()) == {3} for mesh in meshes)
    for prim in stage.Traverse():
        if prim.GetName().startswith(("Floor_", "Wall_0_")):
            there = source.GetPrimAtPath(prim.GetPath())
            surface = bound_material(there).ComputeSurfaceSource()[0]
            placement = placement_of(source_of(surface, "diffuseColor"))
            wanted = placed(np.array(st_of(there).ComputeFlattened()), placement)
            laid = np.array(st_of(prim).ComputeFlattened())
            for pick in (np.min, np.max):
                assert np.allclose(pick(laid, axis=0), pick(wanted, axis=0), atol=1e-4)


def test_no_two_pictures_of_a_package_have_one_name(staged_house: Path, tmp_path: Path) -> None:
    """Blender unpacks all of them into one folder."""
    path = tmp_path / "house.usdz"
    export_stage(staged_house, path, "web")
    beside = [file for file in staged_house.parent.rglob("*") if file.suffix in (".jpg", ".png")]
    assert len({file.name for file in beside}) == len(beside) > 3
    with zipfile.ZipFile(path) as archive:
        packed = [Path(name) for name in archive.namelist() if not name.endswith("usdc")]
        assert len({file.name for file in packed}) == len(packed) > 3
        there = {file.read_bytes() for file in beside}
        assert all(archive.read(str(name)) in there for name in packed)


ARKIT_TYPES = {"", "Scope", "Xform", "Camera", "Shader", "Material", "Mesh"}
ARKIT_SHADERS = {"UsdPreviewSurface", "UsdUVTexture", "UsdTransform2d", "UsdPrimvarReader_float2"}


def test_a_package_for_ar_is_of_the_arkit_profile(staged_house: Path, tmp_path: Path) -> None:
    path = tmp_path / "house.usdz"
    export_stage(staged_house, path, "ar")
    stage = Usd.Stage.Open(str(path))
    assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.y
    low, high = bounds_m(staged_house)
    assert np.allclose(bounds_m(path), np.sort([Y_UP @ low, Y_UP @ high], axis=0), atol=1e-4)
    prims = list(stage.TraverseAll())
    assert {prim.GetTypeName() for prim in prims} <= ARKIT_TYPES
    assert not any(name.startswith("Physics") for p in prims for name in p.GetAppliedSchemas())
    shaders = [UsdShade.Shader(prim) for prim in prims if prim.IsA(UsdShade.Shader)]
    assert {shader.GetIdAttr().Get() for shader in shaders} <= ARKIT_SHADERS
    with zipfile.ZipFile(path) as archive:
        layer, *pictures = archive.namelist()
    assert layer == "house.usdc"
    assert {Path(name).suffix for name in pictures} <= {".jpg", ".png"}


def test_the_suffix_belongs_to_the_package(staged_house: Path, tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"house\.glb"):
        export_stage(staged_house, tmp_path / "house.usdz", "gltf")
    assert list(tmp_path.iterdir()) == []
