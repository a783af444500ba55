"""New furniture for one room of a stage: only that room changes."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdUtils

from chord_usd.base.errors import StageError
from chord_usd.base.runtime.house_history import undo
from chord_usd.base.scene.types import Asset, Item, Provenance, SceneGraph
from chord_usd.base.scene.units import rotation_2d
from chord_usd.line.pipeline import one_room
from chord_usd.line.stage.author.attribution import attribution_file
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.line.stage.edit.refurnish import NewFurniture, refurnish
from chord_usd.line.stage.edit.staged_house import read_house
from chord_usd.line.stage.read.describe import describe_stage
from tests.every import later

MADE = Provenance(checkpoint_hash="feed", seed=8)


@pytest.fixture
def folder(staged_house: Path, tmp_path: Path) -> Path:
    """A copy of the shared house, to change."""
    return Path(shutil.copytree(staged_house.parent, tmp_path / "house"))


def room_with_items(path: Path) -> str:
    house = read_house(path)
    return next(
        name for name, room_id in house.room_ids.items() if len(list(house.graph.items_of(room_id)))
    )


def new_furniture(path: Path, name: str, count: int = 1) -> NewFurniture:
    """The room with only its first pieces, turned round."""
    house = read_house(path)
    room = house.room(name, path)
    kept = list(house.graph.items_of(room.id))[:count]
    turned = [replace(item, box=replace(item.box, yaw_deg=item.box.yaw_deg + 180)) for item in kept]
    return NewFurniture(name, room, turned, MADE)


def elsewhere(path: Path, name: str) -> str:
    """The root layer as text, without what is below the room's Furniture."""
    layer = Sdf.Layer.OpenAsAnonymous(str(path))
    furniture = layer.GetPrimAtPath(f"/House/Rooms/{name}/Furniture")
    for child in list(furniture.nameChildren.keys()):
        del furniture.nameChildren[child]
    for own in list(furniture.attributes.keys()):
        del furniture.properties[own]
    return layer.ExportToString()


def test_what_is_read_is_what_was_written(staged_house: Path, staged_graph: SceneGraph) -> None:
    house = read_house(staged_house)
    assert {room.id for room in house.graph.rooms} == {room.id for room in staged_graph.rooms}
    assert set(house.seeds.values()) == {3}

    def placed(graph: SceneGraph) -> dict[str, tuple[object, ...]]:
        return {
            item.id: (item.category, item.room_id, *(round(v, 3) for v in item.box.center_m[:2]))
            for item in graph.items
        }

    assert placed(house.graph) == placed(staged_graph)


def test_a_stage_is_rewritten_by_a_name_that_goes_up(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its folder, by two names, was taken for two, and its own files for those of others."""
    name = room_with_items(folder / "house.usda")
    (folder.parent / "beside").mkdir()
    monkeypatch.chdir(folder.parent / "beside")
    source = Path("../house/house.usda")
    refurnish(source, source, new_furniture(source, name))
    refurnish(source, Path("../beside/new.usda"), new_furniture(source, name))
    assert read_house(folder.parent / "beside" / "new.usda").room_ids


def broken_rules(path: Path) -> set[str]:
    return {finding.rule for finding in check_stage(path).errors}


def test_only_the_room_changes(folder: Path, staged_house: Path) -> None:
    path = folder / "house.usda"
    name = room_with_items(path)
    before = elsewhere(path, name)
    text = path.read_text()
    refurnish(path, path, new_furniture(path, name))
    assert elsewhere(path, name) == before
    start = text.index(f'def Xform "{name}"')
    assert path.read_text()[:start] == text[:start]
    house = read_house(path)
    assert len(list(house.graph.items_of(house.room_ids[name]))) == 1
    assert house.seeds[name] == 8
    assert broken_rules(path) <= broken_rules(staged_house)


def test_what_is_asked_for_is_kept_with_the_room_and_its_history(folder: Path) -> None:
    path = folder / "house.usda"
    name = room_with_items(path)
    new = new_furniture(path, name)
    for asked in ("desk, no sofa", None, ""):
        before = read_house(path).requests.get(name, "")
        refurnish(path, path, replace(new, requests=asked))
        assert read_house(path).requests.get(name, "") == (before if asked is None else asked)
    undo(path)
    assert describe_stage(path).rooms[[*read_house(path).room_ids].index(name)].requests
    assert read_house(path).requests == {name: "desk, no sofa"}


def test_the_same_furniture_gives_the_same_file(folder: Path) -> None:
    path = folder / "house.usda"
    new = new_furniture(path, room_with_items(path))
    refurnish(path, path, new)
    first = path.read_bytes()
    refurnish(path, path, new)
    assert path.read_bytes() == first


def test_what_an_artist_changed_elsewhere_stays(folder: Path) -> None:
    path = folder / "house.usda"
    name = room_with_items(path)
    stage = Usd.Stage.Open(str(path))
    other = next(
        p for p in stage.GetPrimAtPath("/House/Rooms").GetChildren() if p.GetName() != name
    )
    other.GetVariantSet("wallMaterial").SetVariantSelection(
        other.GetVariantSet("wallMaterial").GetVariantNames()[-1]
    )
    other.CreateAttribute("mine", Sdf.ValueTypeNames.String).Set("kept")
    stage.Save()
    before = elsewhere(path, name)
    refurnish(path, path, new_furniture(path, name))
    assert elsewhere(path, name) == before


def test_a_layer_over_the_house_outlives_its_new_furniture(folder: Path) -> None:
    """An artist works in a layer of his own; names are stable, so that it goes on fitting."""
    path = folder / "house.usda"
    name = room_with_items(path)
    layer = Sdf.Layer.CreateNew(str(folder / "artist.usda"))
    layer.subLayerPaths = ["./house.usda"]
    stage = Usd.Stage.Open(layer)
    moved = next(
        prim
        for prim in stage.Traverse()
        if prim.HasAttribute("chord:node_id")
        and prim.HasAttribute("xformOp:translate")
        and f"/{name}/" not in str(prim.GetPath())
    )
    moved.GetAttribute("xformOp:translate").Set((9.0, 9.0, 0.0))
    room = stage.GetPrimAtPath(f"/House/Rooms/{name}")
    floors = room.GetVariantSet("floorMaterial")
    chosen = floors.GetVariantNames()[-1]
    floors.SetVariantSelection(chosen)
    layer.Save()
    refurnish(path, path, new_furniture(path, name))
    again = Usd.Stage.Open(str(folder / "artist.usda"))
    assert not again.GetCompositionErrors()
    there = again.GetPrimAtPath(moved.GetPath()).GetAttribute("xformOp:translate").Get()
    assert tuple(there) == (9.0, 9.0, 0.0)
    worn = again.GetPrimAtPath(room.GetPath()).GetVariantSet("floorMaterial")
    assert worn.GetVariantSelection() == chosen


def test_another_folder_gets_everything_the_stage_points_to(
    folder: Path, tmp_path: Path, staged_house: Path
) -> None:
    path, target = folder / "house.usda", tmp_path / "elsewhere" / "copy.usda"
    refurnish(path, target, new_furniture(path, room_with_items(path)))
    shutil.rmtree(folder)
    assert UsdUtils.ComputeAllDependencies(str(target))[2] == []
    assert broken_rules(target) <= broken_rules(staged_house)


def test_an_archive_stays_an_archive(staged_graph: SceneGraph, tmp_path: Path) -> None:
    path = tmp_path / "house.usdz"
    author_stage(staged_graph, path, seed=3)
    name = room_with_items(path)
    refurnish(path, path, new_furniture(path, name))
    beside = {file for file in tmp_path.iterdir() if not file.name.startswith(".")}
    assert beside == {path, attribution_file(path)}
    house = read_house(path)
    assert len(list(house.graph.items_of(house.room_ids[name]))) == 1
    assert house.seeds[name] == 8


def test_a_camera_steps_out_of_new_furniture(folder: Path) -> None:
    path = folder / "house.usda"
    name = room_with_items(path)

    def camera() -> np.ndarray:
        """Where its picture begins: at the lens, or at the clipping plane before it."""
        layer = Sdf.Layer.OpenAsAnonymous(str(path))
        found = layer.GetPrimAtPath(f"/House/Cameras/{name}").attributes
        yaw_deg = found["xformOp:rotateXYZ"].default[2] + 90.0
        ahead = rotation_2d(yaw_deg)[:, 0] * found["clippingRange"].default[0]
        return np.array(found["xformOp:translate"].default[:2]) + ahead

    new = new_furniture(path, name)
    x_m, y_m = camera()
    tall = Item("tall", "cabinet", replace(new.items[0].box, center_m=(x_m, y_m, 0.0),
                size_m=(0.3, 0.3, 2.2)), new.room.id)  # fmt: skip
    refurnish(path, path, replace(new, items=[tall]))
    assert np.hypot(*(camera() - (x_m, y_m))) > 0.2


def test_a_wrong_room_suggests_the_right_one(staged_house: Path) -> None:
    house = read_house(staged_house)
    name = next(iter(house.room_ids))
    with pytest.raises(StageError, match=rf"has no room.*room={name}"):
        house.room(name.lower().replace("_", "-"), staged_house)


def test_a_stage_of_something_else_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "other.usda"
    path.write_text('#usda 1.0\n(\n    defaultPrim = "Thing"\n)\ndef Xform "Thing"\n{\n}\n')
    with pytest.raises(StageError, match="holds no rooms"):
        read_house(path)


def test_a_layer_over_the_house_is_refused_before_anything_is_sampled(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    over = Sdf.Layer.CreateNew(str(folder / "over.usda"))
    over.subLayerPaths.append("./house.usda")
    over.defaultPrim = "House"
    over.Save()
    monkeypatch.delattr(one_room, "load_models")
    path = folder / "over.usda"
    with pytest.raises(StageError, match="not in this layer") as refused:
        one_room.regenerate(path, room_with_items(path))
    assert refused.value.where == str(path)


def test_nothing_is_left_behind_on_failure(folder: Path) -> None:
    path = folder / "house.usda"
    name = room_with_items(path)
    text, names = path.read_text(), sorted(folder.rglob("*"))
    new = replace(new_furniture(path, name), room_name="Nowhere_0")
    with pytest.raises(StageError, match="Nowhere_0"):
        refurnish(path, path, new)
    assert path.read_text() == text
    assert sorted(folder.rglob("*")) == names


def test_what_is_kept_keeps_its_name_and_every_byte(folder: Path) -> None:
    path = folder / "house.usda"
    name = room_with_items(path)
    new = new_furniture(path, name, count=2)
    kept = next(p.split("/")[-1] for p in read_house(path).item_ids if f"/{name}/" in p)

    def text() -> str:
        layer = Sdf.Layer.OpenAsAnonymous(str(path))
        return str(layer.GetPrimAtPath(f"/House/Rooms/{name}/Furniture/{kept}").GetAsText())

    before = text()
    refurnish(path, path, replace(new, kept=[kept]))
    assert text() == before
    house = read_house(path)
    assert len(list(house.graph.items_of(house.room_ids[name]))) == 3


CHAIR_BY_JO = """#usda 1.0
(
    defaultPrim = "Jo"
)
def Xform "Jo" (
    customData = {
        dictionary chord = {
            string author = "Jo"
            string licence = "CC-BY-4.0"
        }
    }
)
{
}
"""


@pytest.mark.parametrize("name", ["house.usda", *later("house.usdz")])
def test_who_made_the_new_furniture_is_named(
    staged_graph: SceneGraph, tmp_path: Path, name: str
) -> None:
    made = tmp_path / "Jo" / "Jo.usda"
    made.parent.mkdir()
    made.write_text(CHAIR_BY_JO)
    house = author_stage(staged_graph, tmp_path / "house" / name).path
    assert "Jo" not in attribution_file(house).read_text()
    room = room_with_items(house)
    new = new_furniture(house, room)
    theirs = Asset("Jo", new.items[0].category, new.items[0].box.size_m, made)
    refurnish(house, house, replace(new, items=[replace(new.items[0], asset=theirs)]))
    assert "author Jo, licence CC-BY-4.0" in attribution_file(house).read_text()
    refurnish(house, house, new)
    assert "Jo" not in attribution_file(house).read_text()
