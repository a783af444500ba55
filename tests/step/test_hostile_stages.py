"""Stages, scenes and libraries from a stranger: nothing outside the target is copied or changed.

Each test has a victim's folder with a secret; its bytes are the same afterwards, and the secret is
in no output.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import shutil
import time
import zipfile
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from pxr import Sdf, Usd, UsdGeom, UsdUtils

from chord_usd import cli
from chord_usd.assets.database import read_index, write_index
from chord_usd.assets.libraries.add import add_library
from chord_usd.chord_json import write_scene
from chord_usd.errors import AssetError, ChordError, StageError
from chord_usd.farm.bundle import Work, write_bundle
from chord_usd.image.cameras import read_views, stage_files
from chord_usd.pipeline import Settings, read_scene_file, write_stage
from chord_usd.runtime import stages
from chord_usd.stage.author import author_stage
from chord_usd.stage.check import check_stage
from chord_usd.stage.describe import describe_stage
from chord_usd.stage.diff import diff_stages
from chord_usd.stage.export import export_stage
from chord_usd.stage.refurnish import NewFurniture, read_edited_house, read_house, refurnish
from chord_usd.types import Asset, Provenance, SceneGraph

SECRET = b"-----BEGIN PRIVATE KEY----- of somebody else"


def tree(folder: Path) -> dict[str, str]:
    """Hash of every file, and what every link leads to."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_symlink():
            found[name] = f"-> {path.readlink()}"
        elif path.is_file():
            found[name] = hashlib.sha256(path.read_bytes()).hexdigest()
        else:
            found[name] = "folder"
    return found


def leaks(folder: Path) -> list[str]:
    """Files that hold the secret, also inside archives, which store it as it is."""
    files = (f for f in folder.rglob("*") if f.is_file() and not f.is_symlink())
    return [str(file) for file in files if SECRET in file.read_bytes()]


@pytest.fixture
def victim(tmp_path: Path, block: Asset) -> Iterator[Path]:
    """A stranger's folder: a key, an asset beside it, a house; the same after the test."""
    folder = tmp_path / "victim"
    shutil.copytree(block.usd_path.parent, folder / "Block")
    own = replace(block, usd_path=folder / "Block" / "Block.usda")
    write_index([own], folder)
    (folder / "id_rsa").write_bytes(SECRET)
    (folder / "Block" / "id_rsa").write_bytes(SECRET)
    picture = Image.fromarray(np.full((8, 8, 3), 77, np.uint8))
    picture.save(folder / "private.png")
    with (folder / "private.png").open("ab") as file:
        file.write(SECRET)
    (folder / "house.usda").write_text('#usda 1.0\n(\n defaultPrim="House"\n)\ndef "House"\n{\n}\n')
    before = tree(folder)
    yield folder
    assert tree(folder) == before
    assert [leak for leak in leaks(tmp_path) if not leak.startswith(str(folder))] == []


@pytest.fixture
def house(staged_house: Path, tmp_path: Path) -> Path:
    """A copy of the shared house, to be made hostile."""
    return Path(shutil.copytree(staged_house.parent, tmp_path / "house")) / "house.usda"


def furniture_of(path: Path) -> NewFurniture:
    read = read_house(path)
    name = next(n for n, i in read.room_ids.items() if list(read.graph.items_of(i)))
    room = read.room(name, path)
    items = list(read.graph.items_of(room.id))[:1]
    return NewFurniture(name, room, items, Provenance(seed=8))


def edited(path: Path, change: Callable[[Sdf.Layer], None]) -> Path:
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    change(layer)
    layer.Export(str(path))
    return path


def with_sublayer(target: str) -> Callable[[Sdf.Layer], None]:
    return lambda layer: layer.subLayerPaths.append(target)


def with_reference(target: str) -> Callable[[Sdf.Layer], None]:
    def change(layer: Sdf.Layer) -> None:
        prim = Sdf.CreatePrimInLayer(layer, "/House/Stranger")
        prim.specifier = Sdf.SpecifierDef
        prim.referenceList.prependedItems.append(Sdf.Reference(target))

    return change


def with_texture(target: str) -> Callable[[Sdf.Layer], None]:
    def change(layer: Sdf.Layer) -> None:
        prim = Sdf.CreatePrimInLayer(layer, "/House")
        value = Sdf.AttributeSpec(prim, "look", Sdf.ValueTypeNames.Asset)
        value.default = Sdf.AssetPath(target)

    return change


WAYS = [with_sublayer, with_reference, with_texture]


def names(way: Callable[..., object], victim: Path) -> str:
    return "private.png" if way is with_texture else "house.usda"


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
    with pytest.raises(AssetError, match=f"--assets {victim}"):
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
    author_stage(staged_graph, tmp_path / "one.usda", looks=())
    theirs = tmp_path / "assets" / "Block" / "payload.usda"
    theirs.write_text(theirs.read_text().replace("0.25", "0.26"))
    (tmp_path / "assets" / "Placeholder" / "notes.txt").write_text("mine")
    before = tree(tmp_path / "assets")
    for name in ("two.usda", "three.usda", "two.usda"):
        author_stage(staged_graph, tmp_path / name, looks=())
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
    assert cli.main(words) == 2
    told = [line for line in capfd.readouterr().err.splitlines() if not line.startswith("{")]
    assert len(told) == 1
    assert told[0].startswith("error: ")
    assert f"--assets {victim}" in told[0]
    assert list((tmp_path / "out").iterdir()) == []
    assert cli.main([*words, "--assets", str(victim)]) == 0
    assert (tmp_path / "out" / "assets" / "Block" / "Block.usda").is_file()


# --- stages ------------------------------------------------------------------------------------


def hostile_archive(path: Path, entries: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        for name, data in entries.items():
            archive.writestr(zipfile.ZipInfo(name), data)
    return path


@pytest.mark.parametrize("name", ["../victim/house.usda", "{victim}/house.usda"])
@pytest.mark.parametrize("is_first", [True, False])
def test_an_archive_writes_only_into_its_target(
    house: Path, victim: Path, tmp_path: Path, name: str, is_first: bool
) -> None:
    new = furniture_of(house)
    entries = {"house.usda": house.read_bytes(), name.format(victim=victim): house.read_bytes()}
    order = reversed(entries) if is_first else iter(entries)
    evil = hostile_archive(tmp_path / "evil.usdz", {key: entries[key] for key in order})
    (tmp_path / "out").mkdir()
    with pytest.raises(StageError, match="outside itself"):
        refurnish(evil, tmp_path / "out" / "out.usdz", new)
    for read in (check_stage, describe_stage, read_views, read_house):
        with pytest.raises(StageError, match="outside itself"):
            read(evil)
    assert list((tmp_path / "out").iterdir()) == []


@pytest.mark.parametrize("way", WAYS)
def test_what_a_stage_names_elsewhere_is_not_copied(
    house: Path, victim: Path, tmp_path: Path, way: Callable[..., Callable[[Sdf.Layer], None]]
) -> None:
    new = furniture_of(house)
    link = house.parent / f"link-{names(way, victim)}"
    link.symlink_to(victim / names(way, victim))
    out = tmp_path / "out"
    out.mkdir()
    for target in (str(victim / names(way, victim)), f"../victim/{names(way, victim)}", link.name):
        evil = Path(shutil.copyfile(house, house.with_name("evil.usda")))
        edited(evil, way(f"./{target}" if target == link.name else target))
        with pytest.raises(StageError, match="points to"):
            refurnish(evil, out / "out.usda", new)
        for package, suffix in (("web", ".usdz"), ("gltf", ".glb")):
            with pytest.raises(StageError, match="points to"):
                export_stage(evil, out / f"out{suffix}", package)
        work = Work(evil, tuple(stage_files(evil)), ("Camera",), ())
        with pytest.raises(ChordError, match="points to"):
            write_bundle(work, out / "job")
        assert list(out.iterdir()) == []
        check_stage(evil)  # reading is no copying


def test_an_archive_that_names_files_elsewhere_is_not_edited(
    house: Path, victim: Path, tmp_path: Path
) -> None:
    new = furniture_of(house)
    (tmp_path / "out").mkdir()
    for way in WAYS:
        root = Path(shutil.copyfile(house, tmp_path / "root.usda"))
        # From where it is unpacked: a folder in a hidden one, beside the target.
        edited(root, way(f"../../../../victim/{names(way, victim)}"))
        evil = hostile_archive(tmp_path / "evil.usdz", {"root.usda": root.read_bytes()})
        with pytest.raises(StageError, match=f"{evil}: points to"):
            refurnish(evil, tmp_path / "out" / "out.usdz", new)
        assert list((tmp_path / "out").iterdir()) == []


def test_edits_name_only_files_beside_them_or_the_house(
    house: Path, victim: Path, tmp_path: Path
) -> None:
    mine = tmp_path / "edits"
    mine.mkdir()
    over = mine / "edits.usda"
    over.write_text(f'#usda 1.0\n(\n subLayers = [@{house}@]\n defaultPrim="House"\n)\n')
    assert read_edited_house(over, house).room_ids == read_house(house).room_ids
    edited(over, with_sublayer(str(victim / "house.usda")))
    with pytest.raises(StageError, match="points to"):
        read_edited_house(over, house)


READERS = [check_stage, describe_stage, read_views, read_house, lambda p: diff_stages(p, p)]


@pytest.mark.parametrize("kind", ["zero", "pipe"])
@pytest.mark.parametrize("way", WAYS)
def test_pipes_and_devices_are_not_opened(
    house: Path, kind: str, way: Callable[..., Callable[[Sdf.Layer], None]]
) -> None:
    pipe = house.parent / ("pipe.png" if way is with_texture else "pipe.usda")
    if kind == "pipe":
        os.mkfifo(pipe)
    else:
        pipe.symlink_to("/dev/zero")
    edited(house, way(f"./{pipe.name}"))
    for read in READERS:
        with pytest.raises(StageError, match="device or a pipe"):
            read(house)
    with pytest.raises(StageError, match="regular file"):
        check_stage(pipe)


def test_a_cycle_of_references_is_no_end(house: Path) -> None:
    other = house.with_name("other.usda")
    shutil.copyfile(house, other)
    edited(other, with_sublayer("./house.usda"))
    edited(house, with_sublayer("./other.usda"))
    edited(house, with_reference("./house.usda"))
    began = time.monotonic()
    for read in READERS:
        read(house)
    assert time.monotonic() - began < 30


def test_addresses_are_missing_files(house: Path) -> None:
    """No resolver of ours goes to the network; they are files that are not there."""
    edited(house, with_reference("http://127.0.0.1:9/house.usda"))
    edited(house, with_texture("omniverse://localhost/house.usda"))
    found = {finding.rule for finding in check_stage(house).errors}
    assert {"CHORD005", "CHORD008"} <= found


def deep(folder: Path) -> Path:
    path = folder / "deep.usda"
    path.write_text("#usda 1.0\n" + 'def "a" {\n' * 100_000 + "}\n" * 100_000)
    return path


def nested(folder: Path) -> Path:
    path = folder / "nested.usda"
    path.write_text("#usda 1.0\n" + 'def "a" {\n' * 1000 + "}\n" * 1000)
    return path


def exponential(folder: Path) -> Path:
    """Nine layers that each refer to the next ten times: 10^9 prims of instances."""
    for level in range(9):
        below = f"@./l{level + 1}.usda@"
        prims = "".join(
            f'def "p{n}" (instanceable = true\n references = {below})\n{{\n}}\n' for n in range(10)
        )
        text = f'#usda 1.0\n(\n defaultPrim = "A"\n)\ndef "A"\n{{\n{prims}\n}}\n'
        (folder / f"l{level}.usda").write_text(text)
    (folder / "l9.usda").write_text('#usda 1.0\n(\n defaultPrim="A"\n)\ndef "A"\n{\n}\n')
    return folder / "l0.usda"


def sublayers(folder: Path) -> Path:
    names = ", ".join(f"@./s{n}.usda@" for n in range(200))
    (folder / "s.usda").write_text(f"#usda 1.0\n(\n subLayers = [{names}]\n)\n")
    for n in range(200):
        shutil.copyfile(folder / "s.usda", folder / f"s{n}.usda")
    return folder / "s.usda"


def noise(folder: Path) -> Path:
    (folder / "noise.usdc").write_bytes(b"PXR-USDC" + os.urandom(5000))
    return folder / "noise.usdc"


def cut(folder: Path) -> Path:
    stage = Usd.Stage.CreateNew(str(folder / "cut.usdc"))
    UsdGeom.Cube.Define(stage, "/A")
    stage.Save()
    data = (folder / "cut.usdc").read_bytes()
    (folder / "cut2.usdc").write_bytes(data[: len(data) // 2])
    return folder / "cut2.usdc"


@pytest.mark.parametrize("make", [deep, nested, exponential, noise, cut])
def test_a_bomb_is_one_line(
    tmp_path: Path, make: Callable[[Path], Path], capfd: pytest.CaptureFixture[str]
) -> None:
    path = make(tmp_path)
    began = time.monotonic()
    assert cli.main(["check", str(path)]) == 2
    assert time.monotonic() - began < 60
    told = capfd.readouterr().err
    assert told.startswith("error: ")
    assert told.count("\n") == 1
    assert "unexpected" not in told


def test_sublayers_of_sublayers_come_to_an_end(tmp_path: Path) -> None:
    began = time.monotonic()
    with pytest.raises(StageError, match="sublayers"):
        describe_stage(sublayers(tmp_path))
    assert time.monotonic() - began < 10


def test_usd_says_nothing_on_standard_error(
    house: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Its warnings come by the dozen, before our one line."""
    edited(house, with_reference("./nowhere.usda"))
    edited(house, with_sublayer("./nothing.usda"))
    stages._remembered.clear()
    for words in (["describe"], ["check"], ["diff", str(house)]):
        cli.main([*words, str(house), "--progress", "json"])
    cli.main(
        ["export", str(house), "--for", "gltf", "-o", str(tmp_path / "a.glb"), "--progress", "json"]
    )
    told = capfd.readouterr().err.splitlines()
    assert [line for line in told if not line.startswith(("error: ", "{"))] == []


TYPES = ["Matrix4d", "String", "IntArray", "Asset", "Bool"]


@pytest.mark.parametrize("type_name", TYPES)
def test_values_of_another_type_are_told(house: Path, type_name: str) -> None:
    """Every attribute that we wrote becomes one of another type; no reader is surprised."""
    layer = Sdf.Layer.OpenAsAnonymous(str(house))
    kind = getattr(Sdf.ValueTypeNames, type_name)

    def spoil(path: Sdf.Path) -> None:
        prim = layer.GetPrimAtPath(path) if path.IsPrimPath() else None
        for name in list(prim.attributes.keys()) if prim else []:
            if not name.startswith("xformOp"):
                del prim.properties[name]
                Sdf.AttributeSpec(prim, name, kind).default = kind.defaultValue

    layer.Traverse(Sdf.Path.absoluteRootPath, spoil)
    layer.Export(str(house))
    for read in READERS:
        told = ""
        try:
            read(house)
        except StageError as error:
            told = str(error)
        assert told == "" or "cannot be read" in told or "no rooms" in told


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


PACKAGE = Path(stages.__file__).parents[1]


@pytest.mark.parametrize(
    ("call", "owner"),
    [
        (r"\bzipfile\b", "archives.py"),
        (r"\bStage\.Open\(str", "stages.py"),
        (r"\bStage\.OpenMasked\(", "stages.py"),
        (r"\bLayer\.(FindOrOpen|OpenAsAnonymous)\(", "stages.py"),
    ],
)
def test_one_module_opens_what_comes_from_strangers(call: str, owner: str) -> None:
    found = {file.name for file in PACKAGE.rglob("*.py") if re.search(call, file.read_text())}
    assert found <= {owner}
