"""Pictures: a real, tiny rendering by Blender, and the errors a user can cause."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import Gf, Sdf, Usd, UsdGeom, UsdLux, UsdShade, UsdUtils

from chord_usd.errors import OutputError, RenderError, StageError
from chord_usd.image.cameras import read_views
from chord_usd.image.render import RenderOptions, is_finished, picture_name, render_stage

SIZE_PX = (64, 36)
TINY = RenderOptions(resolution_px=SIZE_PX, samples=4, device="cpu")

ROOM_M = (4.0, 3.5, 2.6)


def define_box(stage: Usd.Stage, path: str, low: tuple, high: tuple, rgb: tuple) -> None:
    """A box with flat normals and a material of its own."""
    mesh = UsdGeom.Mesh.Define(stage, path)
    (x0, y0, z0), (x1, y1, z1) = low, high
    ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    mesh.CreatePointsAttr([(x, y, z) for z in (z0, z1) for x, y in ring])
    mesh.CreateFaceVertexCountsAttr([4] * 6)
    faces = [(3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
    mesh.CreateFaceVertexIndicesAttr([corner for face in faces for corner in face])
    normals = [(0, 0, -1), (0, 0, 1), (0, -1, 0), (1, 0, 0), (0, 1, 0), (-1, 0, 0)]
    mesh.CreateNormalsAttr([normal for normal in normals for _ in range(4)])
    mesh.SetNormalsInterpolation("faceVarying")
    mesh.CreateSubdivisionSchemeAttr("none")
    mesh.CreateExtentAttr([low, high])
    material = UsdShade.Material.Define(stage, f"/House/Materials/{Sdf.Path(path).name}")
    surface = UsdShade.Shader.Define(stage, f"{material.GetPath()}/Surface")
    surface.CreateIdAttr("UsdPreviewSurface")
    surface.CreateInput("diffuseColor", Sdf.ValueTypeNames.Color3f).Set(rgb)
    material.CreateSurfaceOutput().ConnectToSource(surface.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)


def paint_red(stage: Usd.Stage, path: str, picture: Path) -> None:
    """Let a box wear a red texture, given by its path relative to the stage."""
    picture.parent.mkdir()
    Image.new("RGB", (4, 4), (200, 40, 40)).save(picture)
    st = UsdGeom.PrimvarsAPI(stage.GetPrimAtPath(path)).CreatePrimvar(
        "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.faceVarying
    )
    st.Set([(0, 0), (1, 0), (1, 1), (0, 1)] * 6)
    texture = UsdShade.Shader.Define(stage, f"/House/Materials/{Sdf.Path(path).name}/Map")
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", Sdf.ValueTypeNames.Asset).Set(f"./{picture.parent.name}/red.png")
    output = texture.CreateOutput("rgb", Sdf.ValueTypeNames.Float3)
    reader = UsdShade.Shader.Define(stage, f"/House/Materials/{Sdf.Path(path).name}/St")
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", Sdf.ValueTypeNames.String).Set("st")
    texture.CreateInput("st", Sdf.ValueTypeNames.Float2).ConnectToSource(
        reader.CreateOutput("result", Sdf.ValueTypeNames.Float2)
    )
    surface = UsdShade.Shader.Get(stage, f"/House/Materials/{Sdf.Path(path).name}/Surface")
    surface.GetInput("diffuseColor").ConnectToSource(output)


def define_cameras(stage: Usd.Stage) -> None:
    length_m, width_m, _ = ROOM_M
    UsdGeom.Scope.Define(stage, "/House/Cameras")
    room = UsdGeom.Camera.Define(stage, "/House/Cameras/Bedroom_0")
    look = Gf.Matrix4d().SetLookAt(
        Gf.Vec3d(3.7, 0.3, 1.5), Gf.Vec3d(1, 2.6, 0.8), Gf.Vec3d(0, 0, 1)
    )
    room.AddTransformOp().Set(look.GetInverse())
    room.CreateFocalLengthAttr(0.2)
    room.CreateHorizontalApertureAttr(0.36)
    room.CreateVerticalApertureOffsetAttr(-0.018)
    top = UsdGeom.Camera.Define(stage, "/House/Cameras/Top")
    top.AddTransformOp().Set(Gf.Matrix4d().SetTranslate((length_m / 2, width_m / 2, 12)))
    top.CreateProjectionAttr("orthographic")
    top.CreateHorizontalApertureAttr(64.0)
    room.CreateClippingRangeAttr((0.05, 100))
    top.CreateClippingRangeAttr((0.05, 100))


def write_house(path: Path) -> Path:
    """One room with a red floor, a ceiling, four walls, a blue box, a lamp and two cameras."""
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/House").GetPrim())
    for name in ("Rooms", "Rooms/Bedroom_0", "Rooms/Bedroom_0/Geometry"):
        UsdGeom.Xform.Define(stage, f"/House/{name}")
    UsdGeom.Scope.Define(stage, "/House/Materials")
    geometry = "/House/Rooms/Bedroom_0/Geometry"
    length, width, height = ROOM_M
    white = (0.8, 0.8, 0.78)
    define_box(stage, f"{geometry}/Floor", (0, 0, -0.1), (length, width, 0), white)
    paint_red(stage, f"{geometry}/Floor", path.parent / "maps" / "red.png")
    define_box(stage, f"{geometry}/Ceiling", (0, 0, height), (length, width, height + 0.1), white)
    define_box(stage, f"{geometry}/Wall_0", (0, -0.1, 0), (length, 0, height), white)
    define_box(stage, f"{geometry}/Wall_1", (0, width, 0), (length, width + 0.1, height), white)
    define_box(stage, f"{geometry}/Wall_2", (-0.1, 0, 0), (0, width, height), white)
    define_box(stage, f"{geometry}/Wall_3", (length, 0, 0), (length + 0.1, width, height), white)
    define_box(stage, f"{geometry}/Bed", (0.4, 1.4, 0), (2.0, 3.4, 0.5), (0.05, 0.1, 0.6))
    lamp = UsdLux.RectLight.Define(stage, f"{geometry}/AreaLight")
    lamp.CreateIntensityAttr(30.0)
    UsdGeom.XformCommonAPI(lamp).SetTranslate((length / 2, width / 2, height - 0.05))
    define_cameras(stage)
    stage.Save()
    return path


@pytest.fixture(scope="module")
def house(tmp_path_factory) -> Path:
    return write_house(tmp_path_factory.mktemp("house") / "house.usda")


@pytest.fixture(scope="module")
def pictures(house: Path, tmp_path_factory) -> list[Path]:
    told: list[tuple[int, int]] = []
    files = render_stage(
        house,
        tmp_path_factory.mktemp("pictures"),
        TINY,
        lambda done, total: told.append((done, total)),
    )
    assert told[-1] == (8, 8)
    assert [done for done, _ in told] == sorted(done for done, _ in told)
    return files


def rgb(file: Path) -> np.ndarray:
    return np.asarray(Image.open(file).convert("RGB")).astype(float)


def header_of(png: Path) -> tuple[int, int]:
    """Bit depth and colour type of a PNG, which Pillow does not tell."""
    start = png.read_bytes()[:33]
    return start[24], start[25]


def test_every_camera_gives_a_picture_and_nothing_else_is_left(pictures):
    assert [file.name for file in pictures] == ["Bedroom_0.png", "Top.png"]
    assert sorted(pictures[0].parent.iterdir()) == sorted(pictures)
    assert all(is_finished(file, SIZE_PX) for file in pictures)
    assert all(header_of(file) == (8, 2) for file in pictures)  # 8 bits, RGB


def test_the_room_is_lit_and_shows_its_red_floor_and_blue_bed(pictures):
    picture = rgb(pictures[0])
    assert 40 < picture.mean() < 215
    assert picture.std() > 15
    red, green, blue = picture[..., 0], picture[..., 1], picture[..., 2]
    assert ((red > 1.5 * green) & (red > 1.5 * blue)).mean() > 0.05
    assert (blue > 1.5 * red).mean() > 0.05


def test_the_house_is_seen_from_above_through_its_ceiling(pictures):
    """The view is 6.4 m wide, 0.1 m a pixel: the bed covers x 1.6 to 3.2 m of it."""
    picture = rgb(pictures[1])
    bed = picture[36 - 18 - 17 + 4 : 36 - 18 - 3, 18:30]
    floor = picture[18:33, 36:50]
    assert (bed[..., 2] > 1.5 * bed[..., 0]).mean() > 0.8
    assert (floor[..., 0] > 1.5 * floor[..., 2]).mean() > 0.8


def test_the_same_seed_gives_the_same_picture_and_finished_ones_are_skipped(
    house, pictures, tmp_path
):
    options = RenderOptions(**{**vars(TINY), "cameras": ("Bedroom_0",), "skip_existing": True})
    (again,) = render_stage(house, tmp_path, options)
    # Pixels, not bytes: Cycles writes its render times into the file.
    np.testing.assert_array_equal(rgb(again), rgb(pictures[0]))
    written = again.stat().st_mtime_ns
    render_stage(house, tmp_path, options)
    assert again.stat().st_mtime_ns == written


def test_tiles_are_bands_of_the_picture(house, tmp_path):
    options = {**vars(TINY), "cameras": ("Bedroom_0",), "resolution_px": (32, 19)}
    bands = [
        render_stage(house, tmp_path, RenderOptions(**{**options, "tile": (index, 2)}))[0]
        for index in range(2)
    ]
    assert [band.name for band in bands] == [
        "Bedroom_0.tile-0-of-2.png",
        "Bedroom_0.tile-1-of-2.png",
    ]
    assert [Image.open(band).size for band in bands] == [(32, 9), (32, 10)]
    (whole,) = render_stage(house, tmp_path, RenderOptions(**{**options, "tile": (0, 1)}))
    np.testing.assert_array_equal(np.concatenate([rgb(band) for band in bands]), rgb(whole))


def test_a_packed_stage_brings_its_textures(house, tmp_path):
    packed = tmp_path / "house.usdz"
    assert UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(house)), str(packed))
    options = RenderOptions(**{**vars(TINY), "cameras": ("Top",)})
    (file,) = render_stage(packed, tmp_path / "pictures", options)
    floor = rgb(file)[18:33, 36:50]
    assert (floor[..., 0] > 1.5 * floor[..., 2]).mean() > 0.8


def test_a_part_of_a_picture_is_not_a_finished_one(pictures, tmp_path):
    cut = tmp_path / "cut.png"
    cut.write_bytes(pictures[0].read_bytes()[:-200])
    assert not is_finished(cut, SIZE_PX)
    assert not is_finished(tmp_path / "none.png", SIZE_PX)
    assert not is_finished(pictures[0], (65, 36))


def test_cameras_are_read_in_metres(house):
    views = read_views(house)
    room, top = views.cameras
    assert (room.name, room.room, room.from_above) == ("Bedroom_0", "Bedroom_0", False)
    assert room.focal_m == pytest.approx(0.02)
    assert room.aperture_m == pytest.approx(0.036)
    assert room.shift == pytest.approx((0.0, -0.05))
    assert [row[3] for row in room.matrix] == pytest.approx([3.7, 0.3, 1.5, 1])
    assert (top.room, top.from_above, top.orthographic) == ("", True, True)
    assert top.aperture_m == pytest.approx(6.4)


def test_an_unknown_camera_or_room_lists_the_names_there_are(house, tmp_path):
    with pytest.raises(
        RenderError, match=r"'Bedrom_0'.*one of Bedroom_0, Top.*Try: --camera Bedroom_0"
    ):
        render_stage(house, tmp_path, RenderOptions(cameras=("Bedrom_0",)))
    with pytest.raises(RenderError, match=r"room named 'Attic'; expected one of Bedroom_0"):
        render_stage(house, tmp_path, RenderOptions(rooms=("Attic",)))
    with pytest.raises(RenderError, match="no camera fits both"):
        render_stage(house, tmp_path, RenderOptions(cameras=("Top",), rooms=("Bedroom_0",)))


def test_a_stage_that_cannot_be_read_is_named(tmp_path):
    with pytest.raises(StageError, match="there is no such file"):
        render_stage(tmp_path / "no.usda", tmp_path, TINY)
    broken = tmp_path / "broken.usda"
    broken.write_text("not a stage")
    with pytest.raises(StageError, match=r"broken\.usda: cannot be opened"):
        render_stage(broken, tmp_path, TINY)


@pytest.mark.parametrize(
    ("wrong", "says"),
    [
        ({"resolution_px": (0, 10)}, "--resolution"),
        ({"samples": 0}, "--samples"),
        ({"seed": -1}, "--seed"),
        ({"engine": "eevee"}, "--engine"),
        ({"device": "toaster"}, "--device"),
        ({"tile": (2, 2)}, "--tile"),
        ({"passes": ("rgb", "depth")}, "cannot be rendered by this version"),
        ({"passes": ("smell",)}, "unknown pass 'smell'"),
    ],
)
def test_options_that_make_no_picture(wrong, says):
    with pytest.raises(RenderError, match=says):
        RenderOptions(**wrong)


def test_a_folder_that_is_a_file_is_refused_before_blender_starts(house, tmp_path):
    target = tmp_path / "file"
    target.write_text("")
    with pytest.raises(OutputError, match="cannot be written to"):
        render_stage(house, target, TINY)


def test_an_interrupt_ends_blender_and_leaves_no_part(house, tmp_path):
    """A run that would take minutes, interrupted as by Ctrl-C once it renders."""
    code = (
        "import sys; from pathlib import Path\n"
        "from chord_usd.image.render import RenderOptions, render_stage\n"
        "options = RenderOptions(cameras=('Bedroom_0',), device='cpu', samples=60000)\n"
        "told = lambda done, total: print(done, flush=True)\n"
        "render_stage(Path(sys.argv[1]), Path(sys.argv[2]), options, told)\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(house), str(tmp_path)],
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    assert process.stdout is not None
    process.stdout.readline()
    workers = children(process.pid)
    assert workers
    process.send_signal(signal.SIGINT)
    assert process.wait(90) != 0
    assert list(tmp_path.iterdir()) == []
    deadline = time.monotonic() + 10
    while any(Path(f"/proc/{pid}").exists() for pid in workers) and time.monotonic() < deadline:
        time.sleep(0.1)
    assert not any(Path(f"/proc/{pid}").exists() for pid in workers)


def children(pid: int) -> list[int]:
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True)
    return [int(line) for line in found.stdout.split()]


def test_picture_names():
    assert picture_name("Top") == "Top.png"
    assert picture_name("Top", (0, 4)) == "Top.tile-0-of-4.png"


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_read_only_folder_is_refused(house, tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(OutputError):
        render_stage(house, tmp_path / "pictures", TINY)


@pytest.fixture
def tiny_disk(tmp_path):
    """A disk with room for one page, where this user may mount one."""
    folder = tmp_path / "disk"
    folder.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=4k", "tmpfs", str(folder)]
    if shutil.which("mount") is None or subprocess.run(mount, capture_output=True).returncode:
        pytest.skip("mounting a tiny disk wants root")
    yield folder
    subprocess.run(["umount", str(folder)], check=True)


def test_a_full_disk_leaves_no_picture(house, tiny_disk):
    """Blender itself says "Saved" and goes on."""
    options = RenderOptions(cameras=("Top",), resolution_px=(160, 90), samples=1, device="cpu")
    with pytest.raises(OutputError, match="the disk is full"):
        render_stage(house, tiny_disk, options)
    assert list(tiny_disk.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["none.usda"], "none.usda"),
        (["{house}", "--camera", "Attic"], "one of Bedroom_0, Top"),
        (["{house}", "--passes", "depth"], "expected rgb"),
        (["{house}", "--device", "toaster"], "--device"),
    ],
)
def test_the_command_line_ends_with_2_and_one_line(house, tmp_path, arguments, says):
    told = [argument.format(house=house) for argument in arguments]
    command = [sys.executable, "-m", "chord_usd.cli", "render", *told, "-o", str(tmp_path / "p")]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []
