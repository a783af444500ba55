"""A stage as files: valid, movable, repeatable, shared packages, looks, nothing left on failure."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import pytest
from pxr import Sdf, Usd, UsdShade, UsdUtils, UsdValidation

from chord_usd.base.errors import AssetError, OutputError, SceneError
from chord_usd.base.runtime.files import deliver
from chord_usd.base.runtime.stages import files_of
from chord_usd.base.scene.geometry import room_polygon, seams
from chord_usd.base.scene.types import Asset, SceneGraph
from chord_usd.library.looks.look_library import StyleLooks
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.line.stage.read.describe import summary

LooksOf = Callable[[int], StyleLooks]


def files_below(folder: Path) -> dict[str, bytes]:
    return {
        str(file.relative_to(folder)): file.read_bytes()
        for file in folder.rglob("*")
        if file.is_file()
    }


# --- files --------------------------------------------------------------------------------------


def problems(path: Path) -> list[str]:
    registry = UsdValidation.ValidationRegistry()
    context = UsdValidation.ValidationContext(registry.GetOrLoadAllValidators())
    return [error.GetMessage() for error in context.Validate(Usd.Stage.Open(str(path)))]


def test_usd_finds_nothing_wrong_with_it(staged_house: Path) -> None:
    assert problems(staged_house) == []


def test_the_folder_can_be_moved(staged_house: Path, tmp_path: Path) -> None:
    moved = tmp_path / "elsewhere"
    shutil.copytree(staged_house.parent, moved)
    layers, files, missing = UsdUtils.ComputeAllDependencies(str(moved / staged_house.name))
    assert missing == []
    assert files, "looks have maps"
    used = [Path(layer.realPath) for layer in layers] + [Path(str(file)) for file in files]
    assert all(file.is_relative_to(moved.resolve()) for file in used)


def test_same_graph_and_seed_give_the_same_bytes(
    staged_graph: SceneGraph, staged_house: Path, looks_of: LooksOf, tmp_path: Path
) -> None:
    again = author_stage(
        staged_graph, tmp_path / "a folder" / "house.usda", seed=3, looks=looks_of(3)
    )
    assert files_below(again.path.parent) == files_below(staged_house.parent)
    # In one style, whose trim is of one colour, the building is the same with every seed.
    styled = replace(staged_graph, style="modern")
    third, fourth = (
        author_stage(styled, tmp_path / str(seed) / "house.usda", seed=seed, looks=looks_of(seed))
        for seed in (3, 4)
    )
    assert fourth.content_hash != third.content_hash
    assert {
        name for name, data in files_below(fourth.path.parent).items() if "architecture" in name
        and data != files_below(third.path.parent)[name]
    } == set()  # fmt: skip


def test_an_open_stage_sees_the_house_that_replaces_it(
    staged_graph: SceneGraph, tmp_path: Path
) -> None:
    path = author_stage(staged_graph, tmp_path / "house.usda").path
    opened = Usd.Stage.Open(str(path))
    author_stage(replace(staged_graph, rooms=staged_graph.rooms[:1], items=(), openings=()), path)
    assert len(opened.GetPrimAtPath("/House/Rooms").GetChildren()) == 1


def test_a_different_house_gives_different_bytes(staged_graph: SceneGraph, tmp_path: Path) -> None:
    first = author_stage(staged_graph, tmp_path / "first.usda")
    fewer = replace(staged_graph, items=staged_graph.items[1:])
    assert author_stage(fewer, tmp_path / "second.usda").content_hash != (first.content_hash)


def test_houses_of_a_folder_share_their_packages(staged_graph: SceneGraph, tmp_path: Path) -> None:
    author_stage(staged_graph, tmp_path / "one.usda")
    asset = tmp_path / "assets" / "Block" / "Block.usda"
    written_ns = asset.stat().st_mtime_ns
    author_stage(staged_graph, tmp_path / "two.usda")
    assert asset.stat().st_mtime_ns == written_ns
    assert {path.name for path in (tmp_path / "assets").iterdir()} == {"Block", "Placeholder"}
    assert (tmp_path / "two_architecture").is_dir()


def test_a_second_house_of_a_folder_is_whole_before_it_is_delivered(
    staged_graph: SceneGraph, tmp_path: Path
) -> None:
    """Its certificate is made then: generate said that no mesh was there."""
    author_stage(staged_graph, tmp_path / "one.usda")
    with deliver() as delivery:
        path = delivery.place(tmp_path / "two.usda")
        author_stage(staged_graph, path)
        assert "CHORD008" not in {error.rule for error in check_stage(path, trusted=True).errors}


def test_two_packages_of_one_name_stay_apart(
    staged_graph: SceneGraph, block: Asset, tmp_path: Path
) -> None:
    shutil.copytree(block.usd_path.parent, tmp_path / "library" / "Block")
    twin = replace(block, usd_path=tmp_path / "library" / "Block" / "Block.usda")
    items = (
        replace(staged_graph.items[0], asset=block),
        replace(staged_graph.items[1], asset=twin),
    )
    path = author_stage(replace(staged_graph, items=items), tmp_path / "house.usda").path
    assert (tmp_path / "assets" / "Block_2" / "Block.usda").is_file()
    assert UsdUtils.ComputeAllDependencies(str(path))[2] == []


def test_usdz_is_the_same_house_in_one_file(
    staged_graph: SceneGraph, staged_house: Path, tmp_path: Path
) -> None:
    packed = author_stage(staged_graph, tmp_path / "house.usdz", seed=3)
    beside = {file.name for file in tmp_path.iterdir() if not file.name.startswith(".")}
    assert beside == {"house.usdz", "house_attribution.txt"}
    assert summary(packed.path) == summary(staged_house)
    assert problems(packed.path) == []


@pytest.mark.usefixtures("fresh_readers")  # a fork maps more, and memory has a limit
def test_a_package_of_many_layers_and_large_pictures_is_read(tmp_path: Path) -> None:
    """Each of its layers mapped all of it, and reading has a limit."""
    root = Usd.Stage.CreateNew(str(tmp_path / "house.usda"))
    names = [f"part_{number}.usdc" for number in range(150)]
    for name in names:
        part = Usd.Stage.CreateNew(str(tmp_path / name))
        part.SetDefaultPrim(part.DefinePrim("/Part", "Xform"))
        part.Save()
        root.DefinePrim(f"/{name[:-5]}").GetReferences().AddReference(f"./{name}")
    root.Save()
    (tmp_path / "picture.png").write_bytes(bytes(20_000_000))
    package = tmp_path / "house.usdz"
    with Sdf.ZipFileWriter.CreateNew(str(package)) as writer:
        for name in ("house.usda", *names, "picture.png"):
            writer.AddFile(str(tmp_path / name), name)
    assert files_of(package).layers == (package,)
    assert files_of(package).missing == ()


@pytest.mark.parametrize("suffix", [".usd", ".usdc"])
def test_binary_layers_hold_the_same_house(
    staged_graph: SceneGraph, suffix: str, tmp_path: Path, staged_house: Path
) -> None:
    path = author_stage(staged_graph, tmp_path / f"house{suffix}").path
    assert summary(path) == summary(staged_house)


# --- looks --------------------------------------------------------------------------------------


def worn_shaders(stage: Usd.Stage) -> Iterator[tuple[str, str]]:
    for prim in stage.Traverse():
        if prim.GetName() == "Floor" or prim.GetName().startswith("Wall_"):
            material, _ = UsdShade.MaterialBindingAPI(prim).ComputeBoundMaterial()
            shader = material.ComputeSurfaceSource()[0]
            yield str(prim.GetPath()), str(shader.GetPath()) if shader else ""


def test_every_floor_and_wall_wears_a_look_in_every_variant(staged_house: Path) -> None:
    stage = Usd.Stage.Open(str(staged_house))
    stage.SetEditTarget(stage.GetSessionLayer())
    for room in stage.GetPrimAtPath("/House/Rooms").GetChildren():
        names = room.GetVariantSets().GetNames()
        assert sorted(names) == ["floorMaterial", "wallMaterial"]
        for name in names:
            variants = room.GetVariantSet(name)
            assert len(variants.GetVariantNames()) >= 2
            for choice in variants.GetVariantNames():
                variants.SetVariantSelection(choice)
                assert all(shader for _, shader in worn_shaders(stage))


def test_rooms_wear_the_looks_of_their_style(
    stage: Usd.Stage, staged_graph: SceneGraph, looks_of: LooksOf
) -> None:
    """Each those of its kind; of rooms that touch, those of one of them."""
    looks = looks_of(3)
    rooms = staged_graph.rooms
    touching: dict[str, set[str]] = {room.id: {room.id} for room in rooms}
    for one, other, _ in seams([room_polygon(room) for room in rooms], 0.01):
        joined = touching[rooms[one].id] | touching[rooms[other].id]
        touching.update(dict.fromkeys(joined, joined))
    worn: dict[str, list[str]] = {}
    for room, prim in zip(rooms, stage.GetPrimAtPath("/House/Rooms").GetChildren(), strict=True):
        for part in ("floor", "wall"):
            offered = prim.GetVariantSet(f"{part}Material")
            names = [offered.GetVariantSelection(), *sorted(offered.GetVariantNames())]
            expected = [
                [look.name for look in looks.choices(part, other, 3)]  # type: ignore[arg-type]
                for other in rooms
                if other.id in touching[room.id]
            ]
            assert names in [[each[0], *sorted(each)] for each in expected]
            if room.kind not in ("bathroom", "balcony", "store"):
                group = f"{part}/{min(touching[room.id])}"
                assert worn.setdefault(group, names) == names


def test_materials_of_the_building_are_labelled(stage: Usd.Stage) -> None:
    for prim in stage.Traverse():
        if prim.IsA(UsdShade.Material) and "Architecture" in str(prim.GetPath()):
            (name,) = prim.GetAttribute("semantics:labels:material").Get()
            worn = prim.GetName().endswith(("_Floor", "_Wall"))
            plain = prim.GetName().startswith(f"{name}_")
            assert re.fullmatch(r"[A-Za-z]+_[0-9a-f]{6}", name) if worn else plain


def test_material_names_are_unique_in_the_house(stage: Usd.Stage) -> None:
    """Blender merges materials by name, and with them how a pattern is laid."""
    names = [
        prim.GetName()
        for prim in stage.Traverse()
        if prim.IsA(UsdShade.Material) and prim.GetName().endswith(("_Floor", "_Wall"))
    ]
    assert names
    assert len(set(names)) == len(names)


# --- bad input ----------------------------------------------------------------------------------


def test_a_target_that_cannot_be_written_leaves_nothing(
    staged_graph: SceneGraph, tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(OutputError):
        author_stage(staged_graph, tmp_path / "file" / "house.usda")
    (tmp_path / "house.usda").mkdir()
    with pytest.raises(OutputError):
        author_stage(staged_graph, tmp_path / "house.usda")
    with pytest.raises(OutputError, match="blend"):
        author_stage(staged_graph, tmp_path / "house.blend")
    assert sorted(files_below(tmp_path)) == ["file"]


def test_a_failure_half_way_leaves_the_older_house_alone(
    staged_graph: SceneGraph, block: Asset, tmp_path: Path
) -> None:
    author_stage(replace(staged_graph, items=()), tmp_path / "house.usda")
    before = files_below(tmp_path)
    lost = replace(block, usd_path=tmp_path / "nowhere" / "Lost.usda")
    broken = replace(
        staged_graph, items=(*staged_graph.items[1:], replace(staged_graph.items[0], asset=lost))
    )
    with pytest.raises(AssetError, match="Lost"):
        author_stage(broken, tmp_path / "house.usda")
    assert files_below(tmp_path) == before


def test_a_house_without_rooms_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(SceneError, match="room"):
        author_stage(SceneGraph((), (), ()), tmp_path / "house.usda")
    assert list(tmp_path.iterdir()) == []


def test_an_unknown_category_is_an_error(staged_graph: SceneGraph, tmp_path: Path) -> None:
    strange = replace(staged_graph.items[0], category="spaceship")
    with pytest.raises(SceneError, match="spaceship"):
        author_stage(replace(staged_graph, items=(strange,)), tmp_path / "house.usda")


def test_references_are_relative(staged_house: Path) -> None:
    for path in [staged_house, *staged_house.parent.glob("*_architecture/*.usdc")]:
        text = Sdf.Layer.FindOrOpen(str(path)).ExportToString()
        assert all(target.startswith("./") for target in re.findall(r"@([^@]+)@", text))
