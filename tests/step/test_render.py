"""Pictures: a real, tiny rendering by Blender, and the errors a user can cause."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from golden import require_alike
from PIL import Image
from pxr import Sdf, Usd, UsdGeom, UsdUtils
from render_house import FROM_ABOVE, SIZE_PX, TINY, define_box, paint_red, write_house
from scipy.stats import spearmanr

from chord_usd import cli
from chord_usd.base.errors import OutputError, RenderError, StageError
from chord_usd.base.runtime.stages import StageFiles
from chord_usd.base.runtime.targets import MANIFEST_FILE
from chord_usd.base.scene.types import SceneGraph
from chord_usd.library.looks.look_library import StyleLooks
from chord_usd.line.image.exr import read_exr
from chord_usd.line.image.made import picture_record, stage_digest
from chord_usd.line.image.options import RenderOptions
from chord_usd.line.image.products import MADE_NOTE, are_finished
from chord_usd.line.image.render import Rendered, render_stage, unfinished
from chord_usd.line.image.stage_cameras import read_views
from chord_usd.line.image.turntable import turn_cameras
from chord_usd.line.image.walkthrough import walk_cameras
from chord_usd.line.stage.author.author_stage import author_stage

LooksOf = Callable[[int], StyleLooks]


@pytest.fixture(scope="module")
def house(tmp_path_factory) -> Path:
    return write_house(tmp_path_factory.mktemp("house") / "house.usda")


@pytest.fixture(scope="module")
def rendered(house: Path, tmp_path_factory) -> Rendered:
    told: list[tuple[int, int]] = []
    rendered = render_stage(
        house,
        tmp_path_factory.mktemp("pictures"),
        TINY,
        lambda done, total: told.append((done, total)),
    )
    assert told[-1] == (8, 8)
    assert [done for done, _ in told] == sorted(done for done, _ in told)
    return rendered


@pytest.fixture(scope="module")
def pictures(rendered: Rendered) -> tuple[Path, ...]:
    return rendered.pictures


def rgb(file: Path) -> np.ndarray:
    return np.asarray(Image.open(file).convert("RGB")).astype(float)


def header_of(png: Path) -> tuple[int, int]:
    """Bit depth and colour type of a PNG, which Pillow does not tell."""
    start = png.read_bytes()[:33]
    return start[24], start[25]


def test_every_camera_gives_a_picture_and_nothing_else_is_left(rendered, pictures):
    assert [file.name for file in pictures] == ["Bedroom_0.png", "Top.png"]
    assert rendered.device == "CPU"
    left = sorted(file.name for file in pictures[0].parent.iterdir() if file.name[0] != ".")
    assert left == [
        f"{camera}.{kind}" for camera in ("Bedroom_0", "Top") for kind in ("exr", "json", "png")
    ]
    assert all(Image.open(file).size == SIZE_PX for file in pictures)
    assert all(header_of(file) == (8, 2) for file in pictures)  # 8 bits, RGB


def test_the_linear_picture_is_the_light_behind_the_picture(pictures):
    """Brighter light, brighter pixel; and there is more of it than a picture can show."""
    channels, _ = read_exr(pictures[0].with_suffix(".exr"))
    light = 0.2126 * channels["R"] + 0.7152 * channels["G"] + 0.0722 * channels["B"]
    shown = rgb(pictures[0]) @ (0.2126, 0.7152, 0.0722)
    assert spearmanr(light.ravel(), shown.ravel()).statistic > 0.97


def test_layers_are_the_light_of_the_picture_with_its_mattes(house, pictures, tmp_path):
    options = replace(TINY, cameras=("Bedroom_0",), passes=("layers",))
    (file,) = render_stage(house, tmp_path, options).pictures
    assert file.name == "Bedroom_0.layers.exr"
    channels, header = read_exr(file)
    light, _ = read_exr(pictures[0].with_suffix(".exr"))
    for name in "RGB":
        np.testing.assert_allclose(channels[f"ViewLayer.Combined.{name}"], light[name], rtol=1e-3)
    assert {f"ViewLayer.{name}" for name in ("Depth.Z", "Denoising Albedo.R", "Noisy Image.R")} <= (
        channels.keys()
    )
    manifests = [json.loads(header[key]) for key in header if key.endswith("/manifest")]
    (hashed,) = {one["Bed"] for one in manifests if "Wall_0" in one and "Bed" in one}
    # Cryptomatte: the name's hash, as the bits of a float, in the pixels that show it.
    number = np.array([int(hashed, 16)], dtype=np.uint32).view(np.float32)[0]
    ranks = [f"ViewLayer.Crypto{kind}00.r" for kind in ("Object", "Material")]
    assert any((channels[rank] == number).mean() > 0.02 for rank in ranks)


def test_the_room_is_lit_and_shows_its_red_floor_and_blue_bed(pictures):
    picture = rgb(pictures[0])
    assert 40 < picture.mean() < 215
    assert picture.std() > 15
    red, green, blue = picture[..., 0], picture[..., 1], picture[..., 2]
    assert ((red > 1.5 * green) & (red > 1.5 * blue)).mean() > 0.05
    assert (blue > 1.5 * red).mean() > 0.05


def test_a_picture_looks_as_it_did(house: Path, tmp_path: Path) -> None:
    options = replace(TINY, cameras=("Bedroom_0",), samples=16, resolution_px=(96, 54))
    (picture,) = render_stage(house, tmp_path, options).pictures
    require_alike("render", np.asarray(Image.open(picture).convert("RGB")), tmp_path)


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
    options = replace(TINY, cameras=("Bedroom_0",), skip_existing=True)
    again = render_stage(house, tmp_path, options)
    for suffix in (".png", ".exr", ".json"):
        ours, theirs = (
            run[0].with_suffix(suffix).read_bytes() for run in (again.pictures, pictures)
        )
        assert ours == theirs
    written = again.pictures[0].stat().st_mtime_ns
    assert render_stage(house, tmp_path, options).rendered == 0
    assert again.pictures[0].stat().st_mtime_ns == written


def test_a_picture_says_what_it_was_made_from(pictures):
    made = json.loads(pictures[0].with_suffix(".json").read_text())["made"]
    with Image.open(pictures[0]) as picture:
        assert json.loads(picture.text.pop(MADE_NOTE)) == made
        assert picture.text == {}  # no date, no time
    assert json.loads(read_exr(pictures[0].with_suffix(".exr"))[1][MADE_NOTE]) == made


def change_texture(house: Path) -> None:
    Image.new("RGB", (4, 4), (40, 200, 40)).save(house.parent / "maps" / "red.png")


def test_pictures_with_other_textures_are_not_finished(pictures, tmp_path):
    house = write_house(tmp_path / "moved" / "house.usda")
    assert unfinished(house, pictures[0].parent, TINY) == []
    change_texture(house)
    assert len(unfinished(house, pictures[0].parent, TINY)) == 2


def test_any_file_of_a_stage_counts_and_its_place_does_not(tmp_path):
    def digest(folder: Path, change: str = "") -> str:
        folder.mkdir()
        files = [folder / name for name in ("house.usda", "walls.usda", "wood.png")]
        for file in files:
            file.write_text("changed" if file.name == change else file.stem)
        return stage_digest(StageFiles(tuple(files[:2]), tuple(files[2:]), ()))

    same = digest(tmp_path / "a")
    assert digest(tmp_path / "b") == same
    changed = [digest(tmp_path / name, name) for name in ("house.usda", "walls.usda", "wood.png")]
    assert len({same, *changed}) == 4


def test_views_of_walks_and_turntables_of_one_name_are_told_apart(staged_house: Path) -> None:
    """Walk_001 of two views is the last, of four the second."""
    room, other = read_views(staged_house).rooms[:2]
    views = [
        *(walk_cameras(staged_house, count)[1] for count in (2, 4)),
        *(turn_cameras(staged_house, name, 2)[1] for name in (room, other)),
    ]
    records = [picture_record({}, "", view)["sha256"] for view in views]
    assert len(set(records)) == 4


def test_a_stage_without_a_file_is_refused_until_it_comes(house, pictures, tmp_path):
    lacking = write_house(tmp_path / "house.usda")
    texture = tmp_path / "maps" / "red.png"
    data = texture.read_bytes()
    texture.unlink()
    with pytest.raises(
        RenderError, match=r"1 file is missing \(.*maps/red\.png\).*copies of them beside it"
    ):
        render_stage(lacking, tmp_path / "pictures", TINY)
    assert not (tmp_path / "pictures").exists()
    options = replace(FROM_ABOVE, allow_missing=True, skip_existing=True)
    plain = render_stage(lacking, tmp_path / "pictures", options)
    assert "1 file is missing" in plain.warnings[0]
    texture.write_bytes(data)
    assert render_stage(lacking, tmp_path / "pictures", options).rendered == 1


def test_a_texture_that_cannot_be_read_is_named(tmp_path):
    house = write_house(tmp_path / "house.usda")
    (tmp_path / "maps" / "red.png").write_bytes(b"no picture")
    with pytest.raises(RenderError, match=r"textures that cannot be read: 1 \(red\.png\)"):
        render_stage(house, tmp_path / "pictures", TINY)
    assert list((tmp_path / "pictures").glob("*.png")) == []


@pytest.mark.parametrize("harm", ["cut", "zeroed", "flipped", "other options", "sidecar lost"])
def test_what_is_damaged_or_of_another_kind_is_not_finished(pictures, tmp_path, harm):
    for file in pictures[0].parent.glob("Bedroom_0.*"):
        shutil.copy(file, tmp_path)
    made = json.loads((tmp_path / "Bedroom_0.json").read_text())["made"]
    assert are_finished(tmp_path, "Bedroom_0", made)
    picture = tmp_path / "Bedroom_0.png"
    data = bytearray(picture.read_bytes())
    if harm == "cut":
        picture.write_bytes(data[:-200])
    elif harm == "zeroed":
        picture.write_bytes(bytes(len(data)))
    elif harm == "flipped":
        data[len(data) // 2] ^= 1
        picture.write_bytes(data)
    elif harm == "other options":
        made = {**made, "seed": 1}
    else:
        (tmp_path / "Bedroom_0.json").unlink()
    assert not are_finished(tmp_path, "Bedroom_0", made)


@pytest.mark.acceptance
def test_two_runs_into_one_folder_leave_whole_pictures(house, tmp_path):
    options = replace(TINY, cameras=("Bedroom_0",))
    with ThreadPoolExecutor() as pool:
        runs = [pool.submit(render_stage, house, tmp_path, options) for _ in range(2)]
        made = [run.result() for run in runs]
    assert [run.rendered for run in made] == [1, 1]
    assert render_stage(house, tmp_path, replace(options, skip_existing=True)).rendered == 0
    assert sorted(file.name for file in tmp_path.iterdir()) == [
        MANIFEST_FILE, "Bedroom_0.exr", "Bedroom_0.json", "Bedroom_0.png",
    ]  # fmt: skip


@pytest.mark.acceptance
def test_a_packed_house_looks_as_its_files_do(
    staged_house: Path, staged_graph: SceneGraph, looks_of: LooksOf, tmp_path: Path
) -> None:
    packed = tmp_path / "house.usdz"
    author_stage(staged_graph, packed, seed=3, looks=looks_of(3))
    cameras = tuple(camera.name for camera in read_views(packed).cameras if camera.room)[:3]
    options = RenderOptions(cameras=cameras, resolution_px=(96, 54), samples=8)
    taken = [
        render_stage(stage, tmp_path / stage.suffix, options).pictures
        for stage in (staged_house, packed)
    ]
    assert len(taken[0]) == 3
    for from_files, from_package in zip(*taken, strict=True):
        assert np.abs(rgb(from_files) - rgb(from_package)).mean() < 1.0


def test_a_packed_stage_brings_its_textures(house, tmp_path):
    packed = tmp_path / "house.usdz"
    assert UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(house)), str(packed))
    (file,) = render_stage(packed, tmp_path / "pictures", FROM_ABOVE).pictures
    floor = rgb(file)[18:33, 36:50]
    assert (floor[..., 0] > 1.5 * floor[..., 2]).mean() > 0.8


def test_a_stage_of_anybody_is_rendered_with_a_camera_and_light_of_our_own(tmp_path):
    """Y up, centimetres, no camera, no light, and a texture that is missing."""
    path = tmp_path / "box.usda"
    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 0.01)
    define_box(stage, "/House/Box", (0, 0, 0), (50, 100, 60), (0.05, 0.6, 0.1))
    define_box(stage, "/House/Lost", (100, 0, 0), (150, 100, 60), (0.7, 0.7, 0.7))
    paint_red(stage, "/House/Lost", tmp_path / "maps" / "red.png")
    stage.Save()
    shutil.rmtree(tmp_path / "maps")
    made = render_stage(path, tmp_path / "pictures", replace(TINY, allow_missing=True))
    assert [file.name for file in made.pictures] == ["Default.png"]
    assert "1 file is missing (" in made.warnings[0]
    assert "has no camera" in made.warnings[1]
    picture = rgb(made.pictures[0])
    red, green, blue = picture[..., 0], picture[..., 1], picture[..., 2]
    assert ((green > 1.3 * red) & (green > 1.3 * blue)).mean() > 0.02
    magenta = (red > 1.5 * green) & (blue > 1.5 * green)
    assert magenta.mean() < 0.01


def test_an_empty_stage_holds_nothing_to_look_at(tmp_path):
    stage = Usd.Stage.CreateNew(str(tmp_path / "empty.usda"))
    UsdGeom.Xform.Define(stage, "/Nothing")
    stage.Save()
    with pytest.raises(RenderError, match="holds nothing to look at"):
        render_stage(tmp_path / "empty.usda", tmp_path / "pictures", TINY)


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
        RenderError, match=r"'Bedrom_0'.*one of Bedroom_0, Top.*Try: view=Bedroom_0"
    ):
        render_stage(house, tmp_path, RenderOptions(cameras=("Bedrom_0",)))
    with pytest.raises(RenderError, match=r"room named 'Attic'; expected one of Bedroom_0"):
        render_stage(house, tmp_path, RenderOptions(rooms=("Attic",)))
    with pytest.raises(RenderError, match="no such camera in these rooms"):
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
        ({"resolution_px": (0, 10)}, "size: a picture of 0x10"),
        ({"resolution_px": (100000, 10)}, "size: a picture"),
        ({"samples": 0}, "^samples: "),
        ({"seed": -1}, "^seed: "),
        ({"engine": "eevee"}, "^engine: "),
        ({"device": "toaster"}, "^device: "),
        ({"tile": (2, 2)}, "^tile: "),
        ({"sample_block": (0, 3), "samples": 16}, "only equal blocks"),
        ({"merge": True, "tile": (0, 2)}, "^merge: "),
        ({"walkthrough": -1}, "^walkthrough: "),
        ({"passes": ()}, "no pass"),
        ({"passes": ("smell",)}, "unknown pass 'smell'"),
        ({"passes": ("layers",), "tile": (0, 2)}, "layers come in no parts"),
        ({"denoiser": "blur"}, "^denoiser: "),
    ],
)
def test_options_that_make_no_picture(wrong, says):
    with pytest.raises(RenderError, match=says):
        RenderOptions(**wrong)


def test_a_folder_that_is_a_file_is_refused_before_blender_starts(house, tmp_path):
    target = tmp_path / "file"
    target.write_text("")
    with pytest.raises(OutputError, match=r"cannot be written \(file exists\)"):
        render_stage(house, target, TINY)


def test_an_interrupt_ends_blender_and_leaves_no_part(house, tmp_path):
    """A run that would take minutes, interrupted as by Ctrl-C once it renders."""
    code = (
        "import sys; from pathlib import Path\n"
        "from chord_usd.line.image.render import RenderOptions, render_stage\n"
        "options = RenderOptions(\n"
        "    cameras=('Bedroom_0',), device='cpu', samples=60000, exposure_ev=0.0)\n"
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
    options = replace(FROM_ABOVE, resolution_px=(160, 90), samples=1)
    with pytest.raises(OutputError, match="the disk is full"):
        render_stage(house, tiny_disk, options)
    assert list(tiny_disk.iterdir()) == []


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (["none.usda"], "none.usda"),
        (["{house}", "--camera", "Attic"], "one of Bedroom_0, Top"),
        (["{house}", "--passes", "smell"], "one of rgb, depth"),
        (["{house}", "--merge"], "has no parts of 'Bedroom_0'"),
        (["{house}", "--device", "toaster"], "--device: unknown device"),
        (["{house}", "--resolution", "100000x100000"], "4 to 16384 pixels each way"),
    ],
)
def test_the_command_line_ends_with_2_and_one_line(house, tmp_path, arguments, says):
    filled = [argument.format(house=house) for argument in arguments]
    command = [sys.executable, "-m", "chord_usd.cli", "render", *filled, "-o", str(tmp_path / "p")]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_a_blender_file_holds_the_house_with_its_pictures(house, tmp_path, capsys):
    target = tmp_path / "house.blend"
    assert cli.main(["export", str(house), "--for", "blend", "-o", str(target)]) == 0
    look = (
        f"import bpy; bpy.ops.wm.open_mainfile(filepath={str(target)!r});"
        "print('HELD', sum(1 for o in bpy.data.objects if o.type == 'CAMERA'),"
        "all(image.packed_file for image in bpy.data.images))"
    )
    seen = subprocess.run([sys.executable, "-c", look], capture_output=True, text=True)
    assert "HELD 2 True" in seen.stdout
    assert cli.main(["export", str(house), "--for", "blend", "-o", str(tmp_path / "x.glb")]) == 2
    assert ".blend" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == [target]
