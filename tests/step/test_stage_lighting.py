"""The variant set `lighting`: what shines by day, in the evening and at night; skies."""

from __future__ import annotations

import struct
from dataclasses import replace
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux

from chord_usd.base.errors import ChordError, RenderError
from chord_usd.base.raster.hdri import developed, read_hdri, require_picture
from chord_usd.base.runtime.confined import Limits, confined
from chord_usd.base.scene.skies import SKIES, sky_named
from chord_usd.base.scene.types import Asset, Box, Item, Opening, Plan, Room, SceneGraph
from chord_usd.line.image.exr import write_exr
from chord_usd.line.image.picture_layers import lit_stage
from chord_usd.line.image.stage_cameras import read_views
from chord_usd.line.stage.author.attribution import attribution_file
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.author.lighting import MOODS, sky_rgb, sun_yaw_deg
from chord_usd.line.stage.shell.walls import build_walls

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
        at = 0 if room.id in lit else 1
        share = MOODS["day"].panels[at] / MOODS["evening"].panels[at]
        assert day[prim.GetName()] == pytest.approx(share * evening[prim.GetName()])


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
    day, dusk = sky_named("noon"), sky_named("evening")
    rgb = sky_rgb(day.stops).astype(int)
    assert rgb[0, 0, 2] > rgb[0, 0, 0] + 50  # blue overhead
    assert abs(rgb[-1, 0, 2] - rgb[-1, 0, 0]) < 20  # grey below
    assert sky_rgb(dusk.stops).mean() < rgb.mean() / 2


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
        pytest.raises(RenderError, match="one of day, evening, night"),
        lit_stage(staged_house, "noon"),
    ):
        pass


@pytest.fixture
def lamp(block: Asset, tmp_path: Path) -> Asset:
    """The block, which shines from half a metre above its middle."""
    folder = tmp_path / "lamps" / "Lamp"
    folder.mkdir(parents=True)
    layer = Sdf.Layer.CreateNew(str(folder / "Lamp.usda"))
    layer.TransferContent(Sdf.Layer.FindOrOpen(str(block.usd_path)))
    light = {"at_m": Gf.Vec3d(0.1, 0, 0.5), "radius_m": 0.03, "lumens": 800.0}
    layer.GetPrimAtPath("/Block").customData = {"chord": {"light": light}}
    layer.Save()
    (folder / "payload.usda").write_bytes(block.usd_path.with_name("payload.usda").read_bytes())
    return Asset("Lamp", "table_lamp", block.size_m, folder / "Lamp.usda")


def test_lamps_shine_where_they_stand_but_not_by_day(
    staged_graph: SceneGraph, lamp: Asset, tmp_path: Path
) -> None:
    at = next(n for n, item in enumerate(staged_graph.items) if item.children)
    carrier, items = staged_graph.items[at], list(staged_graph.items)
    size_m = tuple(2.0 * side for side in lamp.size_m)
    child = Item("lamp", "table_lamp", Box((0.2, 0.0, 0.4), size_m, 90.0), asset=lamp)
    items[at] = replace(carrier, children=(child,))
    path = author_stage(replace(staged_graph, items=tuple(items)), tmp_path / "h.usda").path
    stage = Usd.Stage.Open(str(path))
    (light,) = [prim for prim in stage.Traverse() if prim.IsA(UsdLux.SphereLight)]
    assert light.GetParent().GetName() == "Lights"
    room = light.GetParent().GetParent()
    assert light.GetName().endswith(f"TableLamp_0_{room.GetName()}")
    intensity = UsdLux.SphereLight(light).GetIntensityAttr()
    assert intensity.Get() == 0.0
    for time in ("evening", "night"):
        choose(stage, time)
        assert intensity.Get() > 0.1
    there = UsdGeom.Xformable(light).ComputeLocalToWorldTransform(0).ExtractTranslation()
    turn = np.radians(carrier.box.yaw_deg)
    along = np.array([np.cos(turn), np.sin(turn)])
    across = np.array([-along[1], along[0]])
    wanted = np.array(carrier.box.center_m[:2]) + 0.2 * along + 0.2 * across
    assert np.allclose(there[:2], wanted, atol=1e-3)
    assert there[2] == pytest.approx(carrier.box.center_m[2] + 0.4 + 1.0, abs=1e-3)


@pytest.mark.parametrize("name", [sky.name for sky in SKIES])
def test_a_house_stands_under_the_sky_that_was_chosen(
    name: str, furnished_house: SceneGraph, tmp_path: Path
) -> None:
    rooms = furnished_house.rooms[:1]
    seen = tuple(o for o in furnished_house.openings if o.room_ids == (rooms[0].id,))
    bare = replace(furnished_house, rooms=rooms, openings=seen, items=())
    assert any(opening.kind == "window" for opening in seen)
    houses = [author_stage(bare, tmp_path / folder / "h.usda", sky=name) for folder in "ab"]
    assert houses[0].content_hash == houses[1].content_hash
    stage = Usd.Stage.Open(str(houses[0].path))
    sky = sky_named(name)
    assert stage.GetDefaultPrim().GetVariantSet("lighting").GetVariantSelection() == sky.time
    dome = UsdLux.DomeLight(stage.GetPrimAtPath("/House/Lighting/Sky"))
    file = dome.GetTextureFileAttr().Get().path
    assert file == f"./h_architecture/sky_{name}.exr"
    credit = attribution_file(houses[0].path).read_text()
    assert sky.title in credit
    assert "CC0" in credit
    assert bool(stage.GetPrimAtPath("/House/Lighting/Sun")) == (sky.sun is not None)


def test_the_sun_of_a_picture_is_turned_to_the_windows(
    staged_graph: SceneGraph, tmp_path: Path
) -> None:
    light = np.full((64, 128, 3), 0.5, np.float32)
    light[16:18, 20:22] = (9000.0, 8000.0, 6000.0)
    file = tmp_path / "mine.exr"
    write_exr(file, {name: light[..., at] for at, name in enumerate("RGB")})
    path = author_stage(staged_graph, tmp_path / "h.usda", sky=str(file)).path
    stage = Usd.Stage.Open(str(path))
    sun = UsdGeom.Xformable(stage.GetPrimAtPath("/House/Lighting/Sun"))
    away = sun.ComputeLocalToWorldTransform(0).TransformDir(Gf.Vec3d(0, 0, 1))
    assert np.degrees(np.arcsin(away[2])) == pytest.approx(42.0, abs=3.0)
    dome = UsdGeom.Xformable(stage.GetPrimAtPath("/House/Lighting/Sky"))
    longitude = np.radians(21.0 / 128.0 * 360.0)
    # A picture's middle lies towards a dome's +z, its left half towards +x (seen in Blender).
    own = Gf.Vec3d(np.sin(longitude), 0.0, -np.cos(longitude))
    world = dome.ComputeLocalToWorldTransform(0).TransformDir(own)
    assert np.dot(world[:2], away[:2]) / np.hypot(*away[:2]) > 0.99


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("mornin", "Try: sky=morning"),
        ("gone.hdr", "no such file"),
        ("text.hdr", "is no HDRI"),
        ("text.exr", "is no HDRI"),
        ("square.exr", "64x64 pixels"),
        ("black.exr", "black all over"),
        ("house.png", "there is no sky"),
    ],
)
def test_what_is_no_sky_is_refused(
    name: str, told: str, staged_graph: SceneGraph, tmp_path: Path
) -> None:
    for suffix in ("hdr", "exr"):
        (tmp_path / f"text.{suffix}").write_text("no picture")
    for file, size in (("square", (64, 64)), ("black", (32, 64))):
        write_exr(tmp_path / f"{file}.exr", {one: np.zeros(size, np.float32) for one in "RGB"})
    sky = name if name == "mornin" else str(tmp_path / name)
    with pytest.raises(ChordError, match=told):
        author_stage(staged_graph, tmp_path / "out" / "h.usda", sky=sky)
    assert not (tmp_path / "out").exists()


def test_a_large_sky_is_reduced_while_it_is_decoded(tmp_path: Path) -> None:
    """The stage carries 4096 pixels: those of the file, 400 MB, are never there at once."""
    size = (4096, 8192)
    rng = np.random.default_rng(0)
    rows = rng.uniform(0.2, 1.0, (size[0] // 2, 1, 1)).repeat(2, axis=0)
    light = np.broadcast_to(rows.astype(np.float16), (*size, 3))
    file = tmp_path / "large.exr"
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": np.ascontiguousarray(light)}).write(str(file))
    small = confined(read_hdri, file, where=str(file), limits=Limits(memory_bytes=450 * 2**20))
    assert small.shape == (2048, 4096, 3)
    assert np.allclose(small[:, ::500], rows[::2].astype(np.float16), atol=1e-6)
    sky = developed(sky_named(str(file)))
    assert sky is not None
    assert len(sky.exr) > 1000


@pytest.mark.parametrize(("suffix", "width"), [("exr", 32768), ("hdr", 16384)])
def test_a_sky_too_large_is_refused_by_its_head(suffix: str, width: int, tmp_path: Path) -> None:
    file = tmp_path / f"large.{suffix}"
    if suffix == "hdr":
        file.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 16384\n")
    else:
        window = struct.pack("<4i", 0, 0, width - 1, width // 2 - 1)
        sized = b"dataWindow\0box2i\0" + struct.pack("<i", 16) + window
        file.write_bytes(b"\x76\x2f\x31\x01\x02\0\0\0" + sized + b"\0")
    with pytest.raises(ChordError, match=f"of {width}x{width // 2} pixels"):
        require_picture(sky_named(str(file)))
