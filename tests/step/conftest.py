"""A house on a stage, shared by the tests of the stages."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING

import pytest
from pxr import Gf, Kind, Usd, UsdGeom

from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.styles import MIXED, style_named
from chord_usd.base.scene.types import Asset, Box, Item, Provenance, SceneGraph
from chord_usd.library.database import load_database
from chord_usd.library.looks.look_library import StyleLooks, style_looks
from chord_usd.line.stage.author.author_stage import author_stage

if TYPE_CHECKING:
    from starlette.testclient import TestClient

    from tests.page_stand_in import StandIn

BLOCK_SIZE_M = (0.5, 0.4, 0.25)


@pytest.fixture(scope="session")
def block(tmp_path_factory: pytest.TempPathFactory) -> Asset:
    """A component with its mesh behind a payload: a block that stands on the origin."""
    folder = tmp_path_factory.mktemp("database") / "Block"
    folder.mkdir()
    length, width, height = BLOCK_SIZE_M
    payload = Usd.Stage.CreateNew(str(folder / "payload.usda"))
    UsdGeom.Xform.Define(payload, "/Block")
    UsdGeom.Scope.Define(payload, "/Block/Geometry")
    mesh = UsdGeom.Mesh.Define(payload, "/Block/Geometry/Body")
    corners = [
        Gf.Vec3f(x * length / 2, y * width / 2, z * height)
        for z in (0, 1) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))
    ]  # fmt: skip
    mesh.CreatePointsAttr(corners)
    mesh.CreateFaceVertexCountsAttr([4] * 6)
    mesh.CreateFaceVertexIndicesAttr(
        [3, 2, 1, 0, 4, 5, 6, 7, 0, 1, 5, 4, 1, 2, 6, 5, 2, 3, 7, 6, 3, 0, 4, 7]
    )
    extent = [corners[0], corners[6]]
    mesh.CreateExtentAttr(extent)
    payload.SetDefaultPrim(payload.GetPrimAtPath("/Block"))
    _set_units(payload)
    payload.Save()
    interface = Usd.Stage.CreateNew(str(folder / "Block.usda"))
    root = UsdGeom.Xform.Define(interface, "/Block").GetPrim()
    Usd.ModelAPI(root).SetKind(Kind.Tokens.component)
    UsdGeom.ModelAPI(root).SetExtentsHint(extent)
    root.GetPayloads().AddPayload("./payload.usda")
    interface.SetDefaultPrim(root)
    _set_units(interface)
    interface.Save()
    return Asset("Block", "table", BLOCK_SIZE_M, folder / "Block.usda")


def _set_units(stage: Usd.Stage) -> None:
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)


@pytest.fixture(scope="session")
def staged_graph(furnished_house: SceneGraph, block: Asset) -> SceneGraph:
    """A furnished house; its first item that can carries two things, its last has no mesh."""
    items = [replace(item, asset=block) for item in furnished_house.items]
    items[-1] = replace(items[-1], asset=None)
    cup = Item("cup", "coffee_cup", Box((0.1, 0.05, 0.4), (0.1, 0.1, 0.1), 45.0), asset=block)
    book = Item("book", "lying_book", Box((-0.1, 0.0, 0.4), (0.15, 0.2, 0.03), 0.0), asset=block)
    at = next(n for n, item in enumerate(items) if item.category == "bedside_table")
    items[at] = replace(items[at], children=(cup, book))
    made = Provenance(input_hash="cafe", seed=5, configuration={"steps": 20})
    return replace(furnished_house, items=tuple(items), provenance=made)


LooksOf = Callable[[int], StyleLooks]


@pytest.fixture(scope="session")
def looks_of() -> LooksOf:
    """Small looks of the style of a seed."""
    return lambda seed: style_looks(style_named(MIXED, seed), seed, 256)


@pytest.fixture(scope="session")
def staged_house(
    staged_graph: SceneGraph, looks_of: LooksOf, tmp_path_factory: pytest.TempPathFactory
) -> Path:
    path = tmp_path_factory.mktemp("stage") / "house.usda"
    return author_stage(staged_graph, path, seed=3, looks=looks_of(3)).path


@pytest.fixture(scope="session")
def opening_house(furnished_house: SceneGraph, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Pieces of the library that open, a book on those with a top, a lamp in two kinds of rooms."""
    database = load_database(texture_px=256)
    book = database.nearest("lying_book", (0.15, 0.2, 0.03))
    items = []
    for item in furnished_house.items:
        if item.category in ("cabinet", "bedside_table"):
            on_top = Box((0.0, 0.0, item.box.size_m[2]), book.size_m, 0.0)
            on_it = Item(f"{item.id}/book", "lying_book", on_top, item.room_id, book)
            children = (on_it,) if item.category == "bedside_table" else ()
            asset = database.nearest(item.category, item.box.size_m)
            items.append(replace(item, asset=asset, children=children))
    lamp = database.nearest("floor_lamp", (0.4, 0.4, 1.5))
    lamps = [
        Item(f"{room.id}/lamp", "floor_lamp",
             Box((*room_polygon(room).centroid.coords[0], 0.0), lamp.size_m, 0.0), room.id, lamp)
        for room in furnished_house.rooms if room.kind in ("bedroom", "living")
    ]  # fmt: skip
    graph = replace(furnished_house, items=tuple(items), dressing=tuple(lamps))
    return author_stage(graph, tmp_path_factory.mktemp("opening") / "house.usda", seed=3).path


@pytest.fixture
def stage(staged_house: Path) -> Usd.Stage:
    return Usd.Stage.Open(str(staged_house))


@pytest.fixture(scope="session")
def puller() -> ModuleType:
    """benchmarks/openable.py, which pulls what moves open and shut."""
    folder = Path(__file__).parents[2] / "benchmarks"
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module("openable")
    finally:
        sys.path.remove(str(folder))


@pytest.fixture
def verbs() -> StandIn:
    """The verbs that the page's server runs, recorded and not run."""
    from tests.page_stand_in import StandIn

    return StandIn()


@pytest.fixture
def page(tmp_path: Path, verbs: StandIn) -> Iterator[TestClient]:
    """A browser at the page's server."""
    from tests.page_stand_in import browser

    with browser(tmp_path, verbs) as client:
        yield client
