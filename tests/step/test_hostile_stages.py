"""Stages from a stranger: nothing outside the target is copied, changed or waited for.

A test with a victim's folder ends with its bytes unchanged, and its secret in no output.
"""

from __future__ import annotations

import os
import re
import shutil
import time
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from pxr import Gf, Sdf, Usd, UsdGeom
from strangers import WAYS, edited, names, victim_in, with_reference, with_sublayer, with_texture

from chord_usd import cli
from chord_usd.base.errors import ChordError, StageError
from chord_usd.base.runtime import stages
from chord_usd.base.scene.types import Asset, Provenance
from chord_usd.faces.farm.bundle import Work, write_bundle
from chord_usd.line.image.stage_cameras import read_views
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.line.stage.edit.refurnish import NewFurniture, refurnish
from chord_usd.line.stage.edit.staged_house import read_edited_house, read_house
from chord_usd.line.stage.export.export_stage import export_stage
from chord_usd.line.stage.read.describe import describe_stage
from chord_usd.line.stage.read.diff import diff_stages


@pytest.fixture
def victim(tmp_path: Path, block: Asset) -> Iterator[Path]:
    """A folder of somebody else, the same after the test."""
    with victim_in(tmp_path, block) as folder:
        yield folder


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
        work = Work(evil, stages.files_of(evil), ("Camera",), ())
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


def noise_below(folder: Path) -> Path:
    """What cannot be read in the trial may be what memory did not suffice for."""
    path = folder / "above.usda"
    path.write_text(f"#usda 1.0\n(\n subLayers = [@./{noise(folder).name}@]\n)\n")
    return path


@pytest.mark.parametrize("make", [deep, nested, exponential, noise, noise_below, cut])
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


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
@pytest.mark.parametrize("name", ["xformOp:translate", "xformOp:rotateZ"])
def test_a_placement_that_is_no_number_is_refused_with_its_place(
    house: Path, name: str, value: float
) -> None:
    layer = Sdf.Layer.OpenAsAnonymous(str(house))
    placed: list[Sdf.AttributeSpec] = []
    layer.Traverse(
        Sdf.Path.absoluteRootPath,
        lambda path: placed.append(layer.GetObjectAtPath(path)) if path.name == name else None,
    )
    spec = placed[-1]
    spec.default = (value, 0.0, 0.0) if name.endswith("translate") else value
    layer.Export(str(house))
    for read in READERS:
        with pytest.raises(StageError, match="is not finite") as caught:
            read(house)
        assert str(spec.path) in str(caught.value)


@pytest.mark.parametrize("op", ["transform", "scale"])
def test_a_placement_that_leaves_no_size_is_refused_with_its_place(house: Path, op: str) -> None:
    """`regenerate --keep` of such a piece ended in an "unexpected GEOSException"."""
    stage = Usd.Stage.Open(str(house))
    prim = next(p for p in stage.Traverse() if p.GetAttribute("chord:size_m"))
    shape = UsdGeom.Xformable(prim)
    shape.ClearXformOpOrder()
    if op == "scale":
        shape.AddScaleOp(opSuffix="again").Set((1.0, 0.0, 1.0))
    else:
        shape.AddTransformOp(opSuffix="again").Set(Gf.Matrix4d(0.0))
    stage.Save()
    for read in READERS:
        with pytest.raises(StageError, match=f"{prim.GetPath()}.*is zero"):
            read(house)


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
