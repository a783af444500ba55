"""The variant set `lighting`: what shines by day and in the evening."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from pxr import Gf, Usd, UsdGeom, UsdLux

from chord_usd.errors import RenderError
from chord_usd.image.picture_layers import lit_stage
from chord_usd.image.stage_cameras import read_views
from chord_usd.scene.types import Box, Opening, Plan, Room, SceneGraph
from chord_usd.stage.lighting import DAY, EVENING, sky_rgb, sun_yaw_deg
from chord_usd.stage.walls import build_walls

SQUARE = Room("r", "living", np.array([(0, 0), (4, 0), (4, 3), (0, 3)], float))


def choose(stage: Usd.Stage, lighting: str) -> None:
    stage.SetEditTarget(stage.GetSessionLayer())
    stage.GetDefaultPrim().GetVariantSet("lighting").SetVariantSelection(lighting)


def powers(stage: Usd.Stage) -> dict[str, float]:
    """Power of each lamp over its area."""
    return {
        prim.GetPath().pathString.split("/")[3]: float(
            UsdLux.LightAPI(prim).GetIntensityAttr().Get()
            * UsdLux.RectLight(prim).GetWidthAttr().Get()
            * UsdLux.RectLight(prim).GetHeightAttr().Get()
        )
        for prim in stage.Traverse()
        if prim.IsA(UsdLux.RectLight)
    }


def test_by_day_there_are_sun_and_sky_and_lamps_where_no_window_is(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    assert stage.GetDefaultPrim().GetVariantSet("lighting").GetVariantSelection() == "day"
    day = powers(stage)
    scope = stage.GetPrimAtPath("/House/Lighting")
    assert {child.GetTypeName() for child in scope.GetChildren()} == {"DomeLight", "DistantLight"}
    choose(stage, "evening")
    evening = powers(stage)
    assert {child.GetTypeName() for child in scope.GetChildren()} == {"DomeLight"}
    lit = {r for o in staged_graph.openings if o.kind == "window" for r in o.room_ids}
    for room, prim in zip(
        staged_graph.rooms, stage.GetPrimAtPath("/House/Rooms").GetChildren(), strict=True
    ):
        share = DAY.lamps[0] if room.id in lit else DAY.lamps[1]
        assert day[prim.GetName()] == pytest.approx(share * evening[prim.GetName()])
    assert EVENING.lamps == (1.0, 1.0)


@pytest.mark.parametrize(
    ("at_m", "yaw_deg", "outward"),
    [((4.12, 1.5), 90.0, (1, 0)), ((-0.12, 1.5), 90.0, (-1, 0)), ((2.0, 3.12), 0.0, (0, 1))],
)
def test_the_sun_stands_before_the_windows(
    at_m: tuple[float, float], yaw_deg: float, outward: tuple[int, int]
) -> None:
    window = Opening("w", "window", Box((*at_m, 0.9), (1.5, 0.24, 1.4), yaw_deg), ("r",))
    yaw = np.radians(sun_yaw_deg(build_walls(Plan((SQUARE,), (window,)))))
    assert np.dot((np.cos(yaw), np.sin(yaw)), outward) > 0.8


def test_the_sun_shines_down_from_where_it_stands(
    stage: Usd.Stage, staged_graph: SceneGraph
) -> None:
    sun = UsdGeom.Xformable(stage.GetPrimAtPath("/House/Lighting/Sun"))
    shines = sun.ComputeLocalToWorldTransform(0).TransformDir(Gf.Vec3d(0, 0, -1))
    yaw = np.radians(sun_yaw_deg(build_walls(staged_graph.plan)))
    assert shines[2] < -0.5
    assert np.dot((np.cos(yaw), np.sin(yaw)), shines[:2]) < -0.7


def test_the_sky_is_above() -> None:
    rgb = sky_rgb(DAY.sky_stops).astype(int)
    assert rgb[0, 0, 2] > rgb[0, 0, 0] + 50  # blue overhead
    assert abs(rgb[-1, 0, 2] - rgb[-1, 0, 0]) < 20  # grey below
    assert sky_rgb(EVENING.sky_stops).mean() < rgb.mean() / 2


def test_the_top_of_the_dome_is_up(stage: Usd.Stage) -> None:
    dome = UsdGeom.Xformable(stage.GetPrimAtPath("/House/Lighting/Sky"))
    top = dome.ComputeLocalToWorldTransform(0).TransformDir(Gf.Vec3d(0, 1, 0))
    assert np.allclose(top, (0, 0, 1), atol=1e-6)


def test_a_picture_may_choose_its_lighting(staged_house: Path) -> None:
    before = staged_house.read_bytes()
    with lit_stage(staged_house, "evening") as lit:
        stage = Usd.Stage.Open(str(lit))
        assert not stage.GetPrimAtPath("/House/Lighting/Sun")
        assert UsdGeom.GetStageUpAxis(stage) == "Z"
        assert read_views(lit) == read_views(staged_house)
    assert not lit.exists()
    assert staged_house.read_bytes() == before
    with (
        pytest.raises(RenderError, match="one of day, evening"),
        lit_stage(staged_house, "noon"),
    ):
        pass
