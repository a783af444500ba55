"""Scenes and libraries from a stranger: what they name is not copied from elsewhere."""

from __future__ import annotations

import json
import resource
import shutil
import struct
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from pxr import UsdUtils
from strangers import WAYS, edited, names, tree, victim_in

from chord_usd import cli
from chord_usd.base.errors import AssetError
from chord_usd.base.runtime import stages
from chord_usd.base.scene.chord_json import read_scene, write_scene
from chord_usd.base.scene.types import Asset, Box, Item, Room, SceneGraph
from chord_usd.library.asset_shapes import triangles_m
from chord_usd.library.contact_sheet import colourways, draw_asset
from chord_usd.library.database import read_index
from chord_usd.library.libraries.add import add_library
from chord_usd.line.pipeline import Settings, read_scene_file, write_stage
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.export.packages import package_files


@pytest.fixture
def victim(tmp_path: Path, block: Asset) -> Iterator[Path]:
    """A folder of somebody else, the same after the test."""
    with victim_in(tmp_path, block) as folder:
        yield folder


# --- scenes that name assets --------------------------------------------------------------------


def scene_with(graph: SceneGraph, usd_path: str, folder: Path) -> Path:
    folder.mkdir(exist_ok=True)
    assert graph.items[0].asset
    items = tuple(
        replace(item, asset=replace(graph.items[0].asset, usd_path=Path(usd_path)), children=())
        for item in graph.items[:1]
    )
    write_scene(replace(graph, items=items), folder / "scene.json")
    return folder / "scene.json"


@pytest.mark.parametrize("how", ["absolute", "relative", "link to the file", "link to the folder"])
def test_a_scene_takes_no_asset_from_elsewhere(
    staged_graph: SceneGraph, victim: Path, tmp_path: Path, how: str
) -> None:
    folder = tmp_path / "mine"
    folder.mkdir()
    (folder / "file.usda").symlink_to(victim / "Block" / "Block.usda")
    (folder / "link").symlink_to(victim / "Block")
    name = {
        "absolute": str(victim / "Block" / "Block.usda"),
        "relative": "../victim/Block/Block.usda",
        "link to the file": "file.usda",
        "link to the folder": "link/Block.usda",
    }[how]
    scene = scene_with(staged_graph, name, folder)
    with pytest.raises(AssetError, match=f"asset_folders={victim}"):
        read_scene_file(scene, Settings())
    if how == "link to the file":
        return  # its payload does not lie beside the link
    graph = read_scene_file(scene, Settings(asset_folders=(victim,)))
    write_stage(graph, tmp_path / "out" / "house.usda", Settings())
    taken = [file.name for file in (tmp_path / "out" / "assets").rglob("*") if file.is_file()]
    assert sorted(taken) == ["Block.usda", "payload.usda"]


@pytest.mark.parametrize(
    "content", [b"no usd at all", b"", b"PXR-USDC" + bytes(200), b"#usda 1.0\n"]
)
@pytest.mark.parametrize("suffix", [".usda", ".usdc", ".usdz", ".png"])
def test_an_asset_that_is_none_is_one_line(
    staged_graph: SceneGraph, tmp_path: Path, content: bytes, suffix: str
) -> None:
    scene = scene_with(staged_graph, f"asset{suffix}", tmp_path / "mine")
    (tmp_path / "mine" / f"asset{suffix}").write_bytes(content)
    with pytest.raises(AssetError, match="asset"):
        read_scene_file(scene, Settings())


def test_an_asset_that_points_elsewhere_is_refused(
    staged_graph: SceneGraph, victim: Path, block: Asset, tmp_path: Path
) -> None:
    for way in WAYS:
        folder = tmp_path / way.__name__
        shutil.copytree(block.usd_path.parent, folder / "Block")
        edited(folder / "Block" / "Block.usda", way(str(victim / names(way, victim))))
        scene = scene_with(staged_graph, "Block/Block.usda", folder)
        with pytest.raises(AssetError, match="points to"):
            write_stage(read_scene_file(scene, Settings()), folder / "house.usda", Settings())
        assert not (folder / "house.usda").exists()


def test_a_package_that_lies_there_is_never_changed(
    staged_graph: SceneGraph, tmp_path: Path
) -> None:
    """Another house's package of the name stays, ours gets a number, and one of ours is reused."""
    author_stage(staged_graph, tmp_path / "one.usda")
    theirs = tmp_path / "assets" / "Block" / "payload.usda"
    theirs.write_text(theirs.read_text().replace("0.25", "0.26"))
    (tmp_path / "assets" / "Placeholder" / "notes.txt").write_text("mine")
    before = tree(tmp_path / "assets")
    for name in ("two.usda", "three.usda", "two.usda"):
        author_stage(staged_graph, tmp_path / name)
        _, _, missing = UsdUtils.ComputeAllDependencies(str(tmp_path / name))
        assert missing == []
        after = tree(tmp_path / "assets")
        assert {name: after[name] for name in before} == before
        folders = {one.name for one in (tmp_path / "assets").iterdir()}
        assert folders == {"Block", "Block_2", "Placeholder"}


def test_a_database_lists_nothing_outside_its_folder(victim: Path, tmp_path: Path) -> None:
    index = json.loads((victim / "index.json").read_text())
    for path in (str(victim / "Block" / "Block.usda"), "../victim/Block/Block.usda", "link.usda"):
        folder = tmp_path / "database"
        folder.mkdir(exist_ok=True)
        if not (folder / "link.usda").is_symlink():
            (folder / "link.usda").symlink_to(victim / "Block" / "Block.usda")
        index["assets"][0]["path"] = path
        (folder / "index.json").write_text(json.dumps(index))
        with pytest.raises(AssetError, match="outside the folder"):
            read_index(folder)


def test_a_private_key_stays_where_it_is(
    staged_graph: SceneGraph, victim: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    scene = scene_with(staged_graph, str(victim / "Block" / "Block.usda"), tmp_path / "mine")
    (tmp_path / "out").mkdir()
    words = ["stage", str(scene), "-o", str(tmp_path / "out" / "house.usda"), "--progress", "json"]
    words.append("--no-check")  # a block in place of furniture
    assert cli.main(words) == 2
    told = [line for line in capfd.readouterr().err.splitlines() if not line.startswith("{")]
    assert len(told) == 1
    assert told[0].startswith("error: ")
    assert f"--assets {victim}" in told[0]
    assert list((tmp_path / "out").iterdir()) == []
    assert cli.main([*words, "--assets", str(victim)]) == 0
    assert (tmp_path / "out" / "assets" / "Block" / "Block.usda").is_file()


def with_swollen_count(path: Path) -> None:
    """A crate whose table of specs says that it has 2^28 rows."""
    data = bytearray(path.read_bytes())
    (table,) = struct.unpack_from("<q", data, 16)
    (rows,) = struct.unpack_from("<Q", data, table)
    for row in range(rows):
        name, start, _ = struct.unpack_from("<16sqq", data, table + 8 + 32 * row)
        if name.startswith(b"SPECS"):
            struct.pack_into("<Q", data, start, 2**28)
    path.write_bytes(data)


@pytest.mark.parametrize(
    "read",
    [
        lambda a: package_files(a.usd_path),
        lambda a: triangles_m(a.usd_path),
        lambda a: [draw_asset(a)],
        colourways,
    ],
)
def test_a_damaged_mesh_of_a_database_takes_no_memory(
    block: Asset, tmp_path: Path, read: Callable[[Asset], object]
) -> None:
    """One of 4 KB took 10 GiB: databases of users were opened without a trial."""
    path = tmp_path / "Block.usdc"
    stages.open_known(block.usd_path).Flatten().Export(str(path))
    asset = replace(block, usd_path=path)
    assert read(asset)
    with_swollen_count(path)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(AssetError, match="cannot be used"):
        read(asset)
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 2**20


# --- libraries -----------------------------------------------------------------------------------


def library(folder: Path, *rows: dict[str, object]) -> Path:
    folder.mkdir(exist_ok=True)
    (folder / "manifest.json").write_text(json.dumps(list(rows)))
    return folder


def refused(folder: Path, tmp_path: Path) -> str:
    target = tmp_path / "database"
    target.mkdir(exist_ok=True)
    with pytest.raises(AssetError) as caught:
        add_library(folder, target)
    assert list(target.iterdir()) == []
    assert "\n" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("file", ["{victim}/chair.glb", "../victim/chair.glb", "link.glb"])
def test_a_library_takes_no_mesh_from_elsewhere(victim: Path, tmp_path: Path, file: str) -> None:
    folder = library(tmp_path / "mine", {"file": file.format(victim=victim), "category": "chair"})
    (folder / "link.glb").symlink_to(victim / "Block" / "Block.usda")
    assert refused(folder, tmp_path)


def test_licences_and_lists_have_an_end(tmp_path: Path) -> None:
    row = {"file": "chair.glb", "category": "chair", "licence": "x" * 10_000_000}
    assert "licence has 10,000,000 letters" in refused(library(tmp_path / "a", row), tmp_path)
    nest = library(tmp_path / "b", row)
    (nest / "manifest.json").write_text("[" * 200_000)
    assert "manifest" in refused(nest, tmp_path)


def chair(folder: Path) -> None:
    seat = trimesh.creation.box((0.5, 0.45, 0.55)).apply_translation((0.0, 0.225, 0.0))
    back = trimesh.creation.box((0.5, 0.45, 0.1)).apply_translation((0.0, 0.675, -0.225))
    trimesh.util.concatenate([seat, back]).export(folder / "chair.obj")


@pytest.mark.parametrize("line", ["mtllib ../victim/secret.mtl", "mtllib {victim}/secret.mtl"])
def test_an_obj_names_no_material_elsewhere(victim: Path, tmp_path: Path, line: str) -> None:
    folder = library(tmp_path / "mine", {"file": "chair.obj", "category": "chair"})
    chair(folder)
    text = (folder / "chair.obj").read_text()
    (folder / "chair.obj").write_text(f"{line.format(victim=victim)}\nusemtl a\n{text}")
    assert "outside its library" in refused(folder, tmp_path)


@pytest.mark.parametrize("uri", ["../victim/id_rsa", "{victim}/id_rsa", "file://{victim}/id_rsa"])
def test_a_gltf_names_no_buffer_elsewhere(victim: Path, tmp_path: Path, uri: str) -> None:
    folder = library(tmp_path / "mine", {"file": "chair.gltf", "category": "chair"})
    view = {"buffer": 0, "byteOffset": 0, "byteLength": 36}
    points = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}
    told = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"uri": uri.format(victim=victim), "byteLength": 36}],
        "bufferViews": [view],
        "accessors": [points],
    }
    (folder / "chair.gltf").write_text(json.dumps(told))
    refused(folder, tmp_path)


OBJ = {
    "nan": "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n",
    "no point": "v 0 0 0\nv 1 0 0\nv 0 1 1\nf 1 2 900000000\n",
    "huge": "v 1e300 0 0\nv -1e300 0 0\nv 0 1e300 1e300\nf 1 2 3\n",
    "noise": "f f f\n\x00\xff v v",
}


@pytest.mark.parametrize("name", OBJ)
def test_meshes_of_nonsense_are_refused(tmp_path: Path, name: str) -> None:
    folder = library(tmp_path / "mine", {"file": "a.obj", "category": "chair"})
    (folder / "a.obj").write_text(OBJ[name])
    refused(folder, tmp_path)


def test_a_count_in_a_header_takes_no_memory(tmp_path: Path) -> None:
    """A GLB that counts 10^9 faces, and has three points."""
    folder = library(tmp_path / "mine", {"file": "chair.glb", "category": "chair"})
    chair(folder)
    trimesh.load(folder / "chair.obj").export(folder / "chair.glb")
    data = (folder / "chair.glb").read_bytes()
    length = int.from_bytes(data[12:16], "little")
    told = json.loads(data[20 : 20 + length])
    for accessor in told["accessors"]:
        accessor["count"] = 10**9
    text = json.dumps(told).encode()
    text += b" " * (-len(text) % 4)
    head = len(text).to_bytes(4, "little") + b"JSON"
    body = head + text + data[20 + length :]
    whole = data[:8] + (12 + len(body)).to_bytes(4, "little") + body
    (folder / "chair.glb").write_bytes(whole)
    refused(folder, tmp_path)


def test_a_scene_names_no_folder_of_its_maker(
    tmp_path: Path, block: Asset, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Meshes of the cache are named by their place in it, others from the scene's folder."""
    monkeypatch.setenv("CHORD_USD_CACHE", str(tmp_path / "home of mine" / "cache"))
    shipped = tmp_path / "home of mine" / "cache" / "assets" / "x" / "Bed" / "Bed.usda"
    box = Box((1.0, 1.0, 0.0), (1.0, 1.0, 1.0), 0.0)
    room = Room("r", "bedroom", np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]))
    items = (
        Item("a", "bed", box, "r", replace(block, usd_path=shipped)),
        Item("b", "table", box, "r", replace(block, usd_path=tmp_path / "lib" / "B" / "B.usda")),
    )
    scene = tmp_path / "out" / "scene.json"
    write_scene(SceneGraph((room,), (), items), scene)
    assert str(tmp_path) not in scene.read_text()
    named = [item.asset.usd_path.as_posix() for item in read_scene(scene).items if item.asset]
    assert named == ["assets/x/Bed/Bed.usda", "../lib/B/B.usda"]
