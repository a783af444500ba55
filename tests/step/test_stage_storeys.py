"""Houses of storeys as stages: valid, walked over their stairs; and what breaks a stair is told."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom

from chord_usd.base.errors import StageError
from chord_usd.base.scene.stacking import stack
from chord_usd.base.scene.storeys import STOREY_M, Building
from chord_usd.line.stage.author.author_stage import author_levels, author_stage
from chord_usd.line.stage.author.stage_levels import levels_of
from chord_usd.line.stage.check.check_scene import read_scene
from chord_usd.line.stage.check.check_stage import check_stage
from chord_usd.workshop.data.storey_houses import random_storeys
from tests.every import later
from tests.stair_houses import cornered, terraced


def built(form: str, storeys: int) -> Building:
    for seed in range(200):
        made = stack(random_storeys(np.random.default_rng(seed), storeys))
        if made.climbs[0].built.stair.form == form:
            return made
    raise AssertionError(form)


HOUSES: dict[str, Callable[[], Building]] = {
    "U": lambda: built("U", 2), "L": lambda: built("L", 2),
    "straight": lambda: built("straight", 3),
    "quarter winder": lambda: cornered("winder_L", (1.7, 3.0)),
    "half winder": lambda: cornered("winder_U", (1.75, 2.3)), "terraced": lambda: stack(terraced()),
    "spiral": lambda: cornered("spiral", (2.0, 2.0), "left"),
    "two spirals": lambda: stack(random_storeys(np.random.default_rng(0), 3, ("spiral",))),
}  # fmt: skip


LARGE = ("L", "straight", "two spirals")
"""What the others state as well: a turn, three storeys."""


@pytest.fixture(
    scope="module",
    params=[*[name for name in HOUSES if name not in LARGE], *later(*LARGE)],
    ids=str,
)
def house(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = HOUSES[request.param]()
    path = tmp_path_factory.mktemp("storeys") / "house.usda"
    author_levels(levels_of(made, [storey.plan.scene() for storey in made.storeys]), path)
    return path


def test_every_room_is_reached_over_stairs_that_can_be_walked(house: Path) -> None:
    report = check_stage(house)
    assert not report.errors
    assert not report.stairs
    assert report.reachable_rooms == 1.0
    assert report.walkable > 0.95


def test_storeys_are_groups_with_an_elevation_and_room_names_are_unique(house: Path) -> None:
    stage = Usd.Stage.Open(str(house), Usd.Stage.LoadNone)
    storeys = stage.GetPrimAtPath("/House/Rooms").GetChildren()
    names = [room.GetName() for storey in storeys for room in storey.GetChildren()]
    assert len(names) == len(set(names))
    for index, storey in enumerate(storeys):
        assert storey.GetName() == f"Storey_{index}"
        assert Usd.ModelAPI(storey).GetKind() == "group"
        lift = UsdGeom.XformCache().GetLocalToWorldTransform(storey).ExtractTranslation()
        assert np.allclose(lift, (0, 0, index * STOREY_M))
        assert storey.GetAttribute("chord:elevation_m").Get() == pytest.approx(index * STOREY_M)
    low, high = stage.GetPrimAtPath("/House").GetAttribute("extentsHint").Get()
    assert high[2] - low[2] >= (len(storeys) - 1) * STOREY_M + 2.7 - 1e-4


def test_what_is_made_for_one_storey_says_so(house: Path) -> None:
    with pytest.raises(StageError, match="storeys, and this is not made for these yet"):
        read_scene(Usd.Stage.Open(str(house)))


def test_a_house_of_one_storey_is_the_same_bytes_either_way(tmp_path: Path) -> None:
    made = stack(random_storeys(np.random.default_rng(0))[:1])
    graph = made.storeys[0].plan.scene()
    files = []
    for folder in ("one", "two"):
        (tmp_path / folder).mkdir()
        path = tmp_path / folder / "house.usda"
        if folder == "one":
            author_stage(graph, path)
        else:
            author_levels(levels_of(made, [graph]), path)
        files.append(path.read_bytes())
    assert files[0] == files[1]


def lowered(stage: Usd.Stage) -> None:
    """The upper storey 25 cm too high."""
    group = stage.GetPrimAtPath("/House/Rooms/Storey_1")
    UsdGeom.XformCommonAPI(group).SetTranslate(Gf.Vec3d(0, 0, STOREY_M + 0.25))
    group.GetAttribute("chord:elevation_m").Set(STOREY_M + 0.25)


def gone(stage: Usd.Stage) -> None:
    """Steps that are not there."""
    shaft = next(
        room for room in stage.GetPrimAtPath("/House/Rooms/Storey_0").GetChildren()
        if room.GetName().startswith("Stairs")
    )  # fmt: skip
    stair = f"Stair_0_{shaft.GetName()}"
    steps = f"Architecture/Geometry/{stair}/Steps_{stair}"
    steps = shaft.GetPath().AppendPath(steps)
    assert stage.GetPrimAtPath(steps)
    stage.OverridePrim(steps).SetActive(False)


def covered(stage: Usd.Stage) -> None:
    """A floor where the hole should be."""
    shaft = next(
        room for room in stage.GetPrimAtPath("/House/Rooms/Storey_1").GetChildren()
        if room.GetName().startswith("Stairs")
    )  # fmt: skip
    mesh = UsdGeom.Mesh.Define(stage, shaft.GetPath().AppendPath("Architecture/Geometry/Floor"))
    size = 50.0
    mesh.CreatePointsAttr([(-size, -size, 0), (size, -size, 0), (size, size, 0), (-size, size, 0)])
    mesh.CreateFaceVertexCountsAttr([4])
    mesh.CreateFaceVertexIndicesAttr([0, 1, 2, 3])


SPOILT = (
    (lowered, "a step of [234]"),
    (gone, "below the floor|nothing to stand on|of headroom"),
    (covered, "of headroom"),
)


@pytest.mark.parametrize("way", [None, *later(*range(len(SPOILT)))])
def test_a_broken_stair_is_told_and_leads_nowhere(
    request: pytest.FixtureRequest, house: Path, way: int | None
) -> None:
    """None: a way for each house, so that each form is broken, and each way met."""
    form = list(HOUSES).index(request.node.callspec.params["house"])
    spoil, told = SPOILT[form % len(SPOILT) if way is None else way]
    layer = Sdf.Layer.CreateNew(str(house.with_name("spoilt.usda")))
    layer.subLayerPaths.append(f"./{house.name}")
    layer.Save()
    stage = Usd.Stage.Open(layer)
    stage.SetDefaultPrim(stage.GetPrimAtPath("/House"))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    spoil(stage)
    layer.Save()
    report = check_stage(Path(layer.realPath))
    assert re.search(told, " ".join(report.stairs))
    assert not report.holds
    assert report.reachable_rooms < 0.8


def test_ids_of_storeys_are_their_own() -> None:
    made = built("U", 3)
    graphs = [storey.plan.scene() for storey in made.storeys]
    ids = [room.room.id for level in levels_of(made, graphs) for room in level.rooms]
    assert len(ids) == len(set(ids))
