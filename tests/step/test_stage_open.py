"""Furniture of a house opens by one opinion about its variant."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from pxr import Usd, UsdPhysics

from chord_usd.base.scene.types import Item, SceneGraph
from chord_usd.library.database import load_database
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.check.check_rules import broken_rules
from chord_usd.line.stage.check.check_stage import check_stage

OPENS = ("bedside_table", "cabinet")


@pytest.fixture(scope="module")
def drawn_graph(furnished_house: SceneGraph) -> SceneGraph:
    """A house whose pieces wear the embedded assets; two cabinets are of one kind."""
    database = load_database(texture_px=256)

    def dressed(item: Item) -> Item:
        return replace(item, asset=database.nearest(item.category, item.box.size_m), children=())

    items = [dressed(item) for item in furnished_house.items]
    twin = next(item for item in items if item.category == "cabinet")
    x, y, z = twin.box.center_m
    other = replace(twin, id="twin", box=replace(twin.box, center_m=(x, y, z)))
    return replace(furnished_house, items=(*items, other), dressing=())


@pytest.fixture(scope="module")
def houses(drawn_graph: SceneGraph, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("opens")
    return {
        form: author_stage(drawn_graph, folder / f"{form}.usda", seed=3, articulation=form).path
        for form in ("fixed", "jointed")
    }


def pieces(stage: Usd.Stage) -> list[Usd.Prim]:
    """What has the variant set."""
    return [
        prim
        for prim in stage.Traverse()
        if prim.HasAttribute("chord:node_id")
        and prim.GetVariantSets().HasVariantSet("articulation")
    ]


def bodies(prim: Usd.Prim) -> list[Usd.Prim]:
    """Rigid bodies at and below a prim."""
    return [one for one in Usd.PrimRange(prim) if one.HasAPI(UsdPhysics.RigidBodyAPI)]


def test_fixed_pieces_are_instances_and_share_what_they_are(houses: dict[str, Path]) -> None:
    stage = Usd.Stage.Open(str(houses["fixed"]))
    found = pieces(stage)
    assert {prim.GetAttribute("chord:category").Get() for prim in found} >= set(OPENS)
    assert all(prim.IsInstance() for prim in found)
    cabinets = [p for p in found if p.GetAttribute("chord:category").Get() == "cabinet"]
    assert len({str(prim.GetPrototype().GetPath()) for prim in cabinets}) < len(cabinets)
    for prim in found:
        moves = prim.GetAttribute("chord:category").Get() == "bedside_table"
        assert prim.HasAPI(UsdPhysics.RigidBodyAPI) == moves


@pytest.mark.parametrize("category", OPENS)
def test_one_opinion_opens_a_piece(category: str, houses: dict[str, Path]) -> None:
    stage = Usd.Stage.Open(str(houses["fixed"]))
    piece = next(p for p in pieces(stage) if p.GetAttribute("chord:category").Get() == category)
    path = piece.GetPath()
    piece.GetVariantSet("articulation").SetVariantSelection("jointed")
    piece = stage.GetPrimAtPath(path)
    assert not piece.IsInstance()
    assert not piece.HasAPI(UsdPhysics.RigidBodyAPI)
    assert len(bodies(piece)) > 1
    anchor = UsdPhysics.Joint(piece.GetPrimAtPath("Joints/Anchor"))
    assert anchor.GetJointEnabledAttr().Get() == (category != "bedside_table")
    assert broken_rules(stage) == []


def test_a_whole_house_opens_and_keeps_its_certificate(houses: dict[str, Path]) -> None:
    stage = Usd.Stage.Open(str(houses["jointed"]))
    found = pieces(stage)
    assert found
    for piece in found:
        assert len(bodies(piece)) > 1
    assert broken_rules(stage) == []
    told = [check_stage(houses[form], trusted=True) for form in ("fixed", "jointed")]
    assert [one.errors for one in told] == [(), ()]
    # Not how deep: between triangles that depends on where a mesh is cut into parts.
    fixed, jointed = ({(c.a, c.b) for c in one.collisions} for one in told)
    assert jointed == fixed
