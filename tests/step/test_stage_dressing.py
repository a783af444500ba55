"""Dressing on a stage: a level of its own that can be left out, left unloaded, and read back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdPhysics

import chord_usd
from chord_usd.base.scene.types import Asset, Box, Facts, Item, Provenance, SceneGraph
from chord_usd.library.looks.look_library import StyleLooks
from chord_usd.line.image.annotations import category_ids
from chord_usd.line.image.marks import read_marks
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.edit.refurnish import NewFurniture, refurnish
from chord_usd.line.stage.edit.staged_house import read_house
from chord_usd.line.stage.read.describe import describe_stage, summary
from chord_usd.line.stage.read.diff import diff_stages


@pytest.fixture(scope="module")
def dressed_graph(staged_graph: SceneGraph, block: Asset) -> SceneGraph:
    """The shared house with a bowl on a table of each room that has furniture, and a vase."""
    dressing = []
    for room in staged_graph.rooms:
        for item in list(staged_graph.items_of(room.id))[:1]:
            x, y, z = item.box.center_m
            top = (x, y, z + item.box.size_m[2])
            dressing += [
                Item(
                    f"{room.id}/dressing/bowl_0", "bowl", Box(top, (0.2, 0.2, 0.1), 0.0), room.id,
                    asset=block, facts=Facts(rests_on=item.id),
                ),
                Item(
                    f"{room.id}/dressing/floor_plant_0", "floor_plant",
                    Box((*room.polygon_m.mean(axis=0), 0.0), (0.3, 0.3, 1.0), 0.0), room.id,
                ),
            ]  # fmt: skip
    return replace(staged_graph, dressing=tuple(dressing))


@pytest.fixture(scope="module")
def dressed_house(
    dressed_graph: SceneGraph,
    looks_of: Callable[[int], StyleLooks],
    tmp_path_factory: pytest.TempPathFactory,
) -> Path:
    return author_stage(
        dressed_graph, tmp_path_factory.mktemp("dressed") / "house.usda", seed=3, looks=looks_of(3)
    ).path


def groups(stage: Usd.Stage) -> list[Usd.Prim]:
    rooms = stage.GetPrimAtPath("/House/Rooms").GetChildren()
    return [room.GetChild("Dressing") for room in rooms]


def test_without_its_groups_it_is_the_undressed_house(
    dressed_house: Path, staged_house: Path
) -> None:
    layer = Sdf.Layer.OpenAsAnonymous(str(dressed_house))
    for room in layer.GetPrimAtPath("/House/Rooms").nameChildren:
        del room.nameChildren["Dressing"]
    house = layer.GetPrimAtPath("/House")
    house.RemoveProperty(house.relationships["collection:dressing:includes"])
    schemas = house.GetInfo("apiSchemas").prependedItems
    kept = [name for name in schemas if name != "CollectionAPI:dressing"]
    house.SetInfo("apiSchemas", Sdf.TokenListOp.Create(prependedItems=kept))
    undressed = Sdf.Layer.OpenAsAnonymous(str(staged_house))
    for one in (layer, undressed):  # a camera makes room for a plant
        del one.GetPrimAtPath("/House").nameChildren["Cameras"]
    assert layer.ExportToString() == undressed.ExportToString()
    for file in (staged_house.parent / "house_architecture").iterdir():
        assert (dressed_house.parent / "house_architecture" / file.name).read_bytes() == (
            file.read_bytes()
        )


def test_each_thing_is_an_instance_that_says_what_it_is(
    dressed_house: Path, dressed_graph: SceneGraph
) -> None:
    stage = Usd.Stage.Open(str(dressed_house))
    found = [prim for group in groups(stage) for prim in group.GetChildren()]
    assert {prim.GetAttribute("chord:node_id").Get() for prim in found} == {
        item.id for item in dressed_graph.dressing
    }
    for prim in found:
        assert prim.IsInstance()
        assert Usd.ModelAPI(prim).GetKind() == "component"
        assert prim.GetAttribute("chord:level").Get() == "dressing"
        category = prim.GetAttribute("chord:category").Get()
        assert prim.GetAttribute("semantics:labels:category").Get() == [category]
    bowls = [prim for prim in found if prim.GetName() == "Bowl_0"]
    assert len({prim.GetPrototype().GetPath() for prim in bowls}) == 1
    assert all(bowl.GetAttribute("chord:rests_on").Get() for bowl in bowls)
    house = Usd.CollectionAPI(stage.GetDefaultPrim(), "dressing")
    assert all(house.ComputeMembershipQuery().IsPathIncluded(prim.GetPath()) for prim in found)
    order = [
        child.GetName()
        for child in stage.GetPrimAtPath("/House/Rooms").GetChildren()[0].GetChildren()
    ]
    assert order == ["Architecture", "Furniture", "Dressing", "Lights"]


def test_it_may_stay_unloaded_and_keeps_its_bounds(dressed_house: Path) -> None:
    def bounds(stage: Usd.Stage, path: Sdf.Path) -> np.ndarray:
        cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), ["default"], useExtentsHint=True)
        box = cache.ComputeWorldBound(stage.GetPrimAtPath(path)).ComputeAlignedRange()
        return np.array([box.GetMin(), box.GetMax()])

    loaded = Usd.Stage.Open(str(dressed_house))
    bare = Usd.Stage.Open(str(dressed_house), Usd.Stage.LoadNone)
    for group in groups(loaded):
        assert np.allclose(bounds(loaded, group.GetPath()), bounds(bare, group.GetPath()))
        loaded.Unload(group.GetPath())
        assert not any(
            prim.IsA(UsdGeom.Mesh)
            for prim in Usd.PrimRange(group, Usd.TraverseInstanceProxies(Usd.PrimAllPrimsPredicate))
        )


def test_what_is_read_is_what_was_written(dressed_house: Path, dressed_graph: SceneGraph) -> None:
    house = read_house(dressed_house)

    def told(graph: SceneGraph) -> set[tuple[object, ...]]:
        return {
            (item.id, item.category, item.room_id, item.facts.rests_on,
             *np.round(item.box.center_m, 3), *np.round(item.box.size_m, 3))
            for item in graph.dressing
        }  # fmt: skip

    assert house.is_dressed
    assert told(house.graph) == told(dressed_graph)


def test_a_room_is_dressed_anew_and_the_others_stay(
    dressed_house: Path, block: Asset, tmp_path: Path
) -> None:
    house = read_house(dressed_house)
    name = next(name for name, one in house.room_ids.items() if any(house.graph.dressing_of(one)))
    room = house.room(name, dressed_house)
    kept = house.kept(name, ["Bowl_0"], dressed_house)
    assert len(kept) == 2, "what the bowl stands on stays, too"
    box = Box((*room.polygon_m.mean(axis=0), 0.0), (0.2, 0.2, 0.3), 0.0)
    vase = Item("v", "vase", box, room.id, asset=block)
    new = NewFurniture(name, room, (), Provenance(seed=9), (vase,), kept=tuple(kept.values()))
    target = refurnish(dressed_house, tmp_path / "house.usda", new).path
    after = read_house(target).graph
    assert {item.category for item in after.dressing_of(room.id)} == {"bowl", "vase"}
    assert {item.id for item in after.items_of(room.id)} <= set(kept)

    def others(path: Path) -> str:
        layer = Sdf.Layer.OpenAsAnonymous(str(path))
        for group in ("Furniture", "Dressing"):
            del layer.GetPrimAtPath(f"/House/Rooms/{name}").nameChildren[group]
        return layer.ExportToString()

    assert others(target) == others(dressed_house)


def test_it_is_described_beside_the_furniture(
    dressed_house: Path, dressed_graph: SceneGraph
) -> None:
    rooms = describe_stage(dressed_house).rooms
    pieces = [piece for room in rooms for piece in room.dressing]
    assert len(pieces) == len(dressed_graph.dressing) == summary(dressed_house).dressing
    furniture = {piece.path for room in rooms for piece in room.furniture}
    for piece in pieces:
        assert (piece.rests_on in furniture) == (piece.category == "bowl")


def test_what_changed_names_dressing(
    dressed_house: Path,
    staged_house: Path,
    dressed_graph: SceneGraph,
    looks_of: Callable[[int], StyleLooks],
    tmp_path: Path,
) -> None:
    changed = {change.path for change in diff_stages(dressed_house, staged_house)}
    # Cameras stand where dressing is not in their way.
    groups_gone = {path for path in changed if not path.startswith("/House/Cameras/")}
    assert all(path.endswith("/Dressing") or path == "/House" for path in groups_gone), groups_gone
    first, *others = dressed_graph.dressing
    x, y, z = first.box.center_m
    moved = replace(first, box=replace(first.box, center_m=(x + 0.1, y, z)))
    other = author_stage(
        replace(dressed_graph, dressing=(moved, *others)),
        tmp_path / "house.usda",
        seed=3,
        looks=looks_of(3),
    ).path
    (change,) = diff_stages(dressed_house, other)
    assert (change.path.split("/")[-2:], change.text) == (
        ["Dressing", "Bowl_0"], "moved 0.10 m to the east",
    )  # fmt: skip


def test_masks_name_it(dressed_house: Path) -> None:
    things = read_marks(dressed_house).things
    named = {thing.label: thing for thing in things if "/Dressing/" in thing.path}
    assert set(named) == {"bowl", "floor_plant"}
    ids = category_ids([*named, "sofa", "floor"])
    assert ids == category_ids(["floor", "sofa", *named])
    assert min(ids["bowl"], ids["floor_plant"]) > max(ids["sofa"], ids["floor"])


def test_what_rests_on_a_piece_that_moves_moves_with_it(
    staged_graph: SceneGraph, block: Asset, tmp_path: Path
) -> None:
    """As a body on its top, tied where it lies within; also in the room it is brought to."""
    carrier = next(one for one in staged_graph.items if one.category == "leisure_sofa")
    x, y, z = carrier.box.center_m
    top = Box((x, y, z + carrier.box.size_m[2]), (0.2, 0.2, 0.1), 0.0)
    seat = Box((x + 0.1, y, z + 0.4), (0.4, 0.2, 0.3), 35.0)
    facts, room = Facts(rests_on=carrier.id), carrier.room_id
    things = (
        Item("bowl", "bowl", top, room, asset=block, facts=facts),
        Item("cushion", "cushion", seat, room, asset=block, facts=facts),
    )
    graph = replace(staged_graph, dressing=things)
    house = author_stage(graph, tmp_path / "house.usda", seed=3).path
    assert bodies_and_ties(house) == ({"bowl", "cushion"}, {"cushion"})
    sentence = "carry the armchair from the balcony into the living room"
    chord_usd.open(house).edit(sentence, force=True)
    assert bodies_and_ties(house) == ({"bowl", "cushion"}, {"cushion"})
    chord_usd.open(house).edit("remove the armchair from the living room", force=True)
    assert bodies_and_ties(house) == (set(), set())


def bodies_and_ties(house: Path) -> tuple[set[str], set[str]]:
    """Ids of dressing that can move, and of what fixed joints hold where it is."""
    stage = Usd.Stage.Open(str(house))
    noted = {prim: prim.GetAttribute("chord:node_id").Get() for prim in stage.Traverse()}
    joints = [UsdPhysics.Joint(one) for one in noted if one.IsA(UsdPhysics.FixedJoint)]
    tied = set()
    for joint in joints:
        frames = []
        for body, at, turn in (
            (joint.GetBody0Rel(), joint.GetLocalPos0Attr(), joint.GetLocalRot0Attr()),
            (joint.GetBody1Rel(), joint.GetLocalPos1Attr(), joint.GetLocalRot1Attr()),
        ):
            prim = stage.GetPrimAtPath(body.GetTargets()[0])
            assert prim.HasAPI(UsdPhysics.RigidBodyAPI)
            matrix = UsdGeom.XformCache().GetLocalToWorldTransform(prim)
            turned = Gf.Rotation(Gf.Quatd(turn.Get())) * matrix.RemoveScaleShear().ExtractRotation()
            frames.append([*matrix.Transform(Gf.Vec3d(at.Get())), *turned.TransformDir((1, 0, 0))])
        assert np.allclose(*frames, atol=1e-5)
        tied.add(noted[prim])
    moves = {noted[one] for one in noted if one.HasAPI(UsdPhysics.RigidBodyAPI)}
    return {one for group in groups(stage) if group for one in moves
            & {noted[prim] for prim in group.GetChildren()}}, tied  # fmt: skip
