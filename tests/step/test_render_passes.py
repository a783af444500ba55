"""Depth, normals and masks against rays through the stage's own meshes."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Sdf, Usd, UsdGeom, UsdShade
from shapely.geometry import Polygon

from chord_usd.base.scene.label_sets import classes_of
from chord_usd.line.image.exr import read_exr
from chord_usd.line.image.joined import joined_rooms, touching
from chord_usd.line.image.options import QUALITIES, RenderOptions
from chord_usd.line.image.products import read_mask, write_coco
from chord_usd.line.image.render import Rendered, render_stage
from chord_usd.line.image.stage_cameras import read_views
from tests.every import later

DATA = ("depth", "normal", "instance", "semantic")
CAMERA = "Bedroom_0"


@dataclass(frozen=True)
class Hits:
    """Where rays through the centres of pixels first meet the stage, (R,) each."""

    row: np.ndarray
    column: np.ndarray
    depth_m: np.ndarray
    owner: np.ndarray
    """Path of the shape, or of the instance it is part of."""
    normal: np.ndarray
    """(R, 3)."""


@pytest.fixture(scope="module")
def rendered(staged_house: Path, tmp_path_factory: pytest.TempPathFactory) -> Rendered:
    options = RenderOptions(
        cameras=(CAMERA, "Top"), resolution_px=(96, 54), samples=1, passes=DATA, device="cpu"
    )
    return render_stage(staged_house, tmp_path_factory.mktemp("passes"), options)


@pytest.fixture(scope="module")
def folder(rendered: Rendered) -> Path:
    return rendered.files[0].parent


@pytest.fixture(scope="module")
def sidecar(folder: Path) -> dict:
    return json.loads((folder / f"{CAMERA}.json").read_text())


@pytest.fixture(scope="module")
def hits(staged_house: Path, sidecar: dict) -> Hits:
    return cast_rays(staged_house, sidecar["camera"], 600)


def cast_rays(stage_path: Path, camera: dict, count: int) -> Hits:
    """Rays through random pixels, by the camera's own matrices (Moeller and Trumbore)."""
    rng = np.random.default_rng(4)
    triangles, owners = triangles_of(stage_path)
    stage = Usd.Stage.Open(str(stage_path))
    lens = UsdGeom.Camera(stage.GetPrimAtPath(f"/House/Cameras/{CAMERA}"))
    near_m = lens.GetClippingRangeAttr().Get()[0]  # a view through a wall begins behind that
    column = rng.integers(0, camera["width_px"], count)
    row = rng.integers(0, camera["height_px"], count)
    pixels = np.column_stack([column + 0.5, row + 0.5, np.ones(count)])
    in_camera = pixels @ np.linalg.inv(np.array(camera["intrinsics_px"])).T
    to_world = np.linalg.inv(np.array(camera["world_to_camera_cv"]))
    rays = in_camera @ to_world[:3, :3].T  # of length 1 along the camera's axis
    origin = to_world[:3, 3]
    a, ab, ac = triangles[:, 0], *(triangles[:, i] - triangles[:, 0] for i in (1, 2))
    nearest = np.full(count, np.inf)
    face = np.zeros(count, dtype=int)
    for at, ray in enumerate(rays):
        p = np.cross(ray, ac)
        determinant = (ab * p).sum(1)
        with np.errstate(divide="ignore", invalid="ignore"):
            u = ((origin - a) * p).sum(1) / determinant
            q = np.cross(origin - a, ab)
            v = (q @ ray) / determinant
            t = (q * ac).sum(1) / determinant
        hit = (np.abs(determinant) > 1e-12) & (u >= 0) & (v >= 0) & (u + v <= 1) & (t > near_m)
        if hit.any():
            face[at] = np.flatnonzero(hit)[np.argmin(t[hit])]
            nearest[at] = t[face[at]]
    normal = np.cross(ab, ac)[face]
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    towards = (normal * rays).sum(1, keepdims=True)
    return Hits(
        row, column, nearest, np.array(owners)[face], np.where(towards > 0, -normal, normal)
    )


def triangles_of(path: Path) -> tuple[np.ndarray, list[str]]:
    """(T, 3, 3) all shown triangles in the world, and the shape or instance each belongs to."""
    stage = Usd.Stage.Open(str(path))
    found, owners = [], []
    everywhere = Usd.TraverseInstanceProxies(Usd.PrimDefaultPredicate)
    for prim in Usd.PrimRange(stage.GetPseudoRoot(), everywhere):
        mesh = UsdGeom.Mesh(prim)
        if not mesh or mesh.ComputePurpose() == UsdGeom.Tokens.guide:
            continue
        place = np.array(mesh.ComputeLocalToWorldTransform(0))
        points = np.array(mesh.GetPointsAttr().Get()) @ place[:3, :3] + place[3, :3]
        at = 0
        instance = next((p for p in ancestors(prim) if p.IsInstance()), prim)
        for count in mesh.GetFaceVertexCountsAttr().Get():
            corners = mesh.GetFaceVertexIndicesAttr().Get()[at : at + count]
            for i in range(1, count - 1):
                found.append(points[[corners[0], corners[i], corners[i + 1]]])
                owners.append(str(instance.GetPath()))
            at += count
    return np.array(found), owners


def ancestors(prim: Usd.Prim) -> list[Usd.Prim]:
    above = []
    while not prim.IsPseudoRoot():
        above.append(prim)
        prim = prim.GetParent()
    return above


def test_the_pixels_of_a_thing_show_that_thing(folder: Path, sidecar: dict, hits: Hits) -> None:
    mask = read_mask(folder / f"{CAMERA}.instance.png")
    paths = {thing["id"]: thing["path"] for thing in sidecar["instances"]}
    told = [paths.get(int(number), "") for number in mask[hits.row, hits.column]]
    right = [owner.startswith(path) and path for owner, path in zip(hits.owner, told, strict=True)]
    assert np.isfinite(hits.depth_m).all()
    assert len(set(told)) > 5
    assert np.mean([bool(one) for one in right]) >= 0.995


def test_depth_is_the_distance_along_the_axis_in_metres(folder: Path, hits: Hits) -> None:
    depth_m = read_exr(folder / f"{CAMERA}.depth.exr")[0]["Z"][hits.row, hits.column]
    assert (np.abs(depth_m - hits.depth_m) < 1e-3).mean() >= 0.995


def test_normals_are_of_the_surface_in_the_world(folder: Path, hits: Hits) -> None:
    channels, _ = read_exr(folder / f"{CAMERA}.normal.exr")
    normal = np.stack([channels[axis] for axis in "XYZ"], axis=-1)[hits.row, hits.column]
    assert ((normal * hits.normal).sum(1) > 0.999).mean() >= 0.99


def test_the_semantic_mask_says_what_the_instances_are(folder: Path, sidecar: dict) -> None:
    numbers = read_mask(folder / f"{CAMERA}.instance.png")
    meanings = read_mask(folder / f"{CAMERA}.semantic.png")
    for thing in sidecar["instances"]:
        found = np.unique(meanings[numbers == thing["id"]])
        assert found.tolist() == [sidecar["categories"][thing["label"]]] == [thing["category_id"]]


def test_boxes_in_the_world_hold_the_boxes_in_the_picture(sidecar: dict) -> None:
    """The corners of a thing's box, seen by the camera, lie around its pixels."""
    camera = sidecar["camera"]
    lens, eye = np.array(camera["intrinsics_px"]), np.array(camera["world_to_camera_cv"])
    corners = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 2
    judged = 0
    for thing in sidecar["instances"]:
        matrix, size = np.array(thing["box_m"]["matrix"]), np.array(thing["box_m"]["size_m"])
        world = (corners * size) @ matrix[:3, :3].T + matrix[:3, 3]
        seen = world @ eye[:3, :3].T + eye[:3, 3]
        if (seen[:, 2] < 0.1).any():
            continue  # reaches behind the camera
        pixels = seen @ lens.T
        pixels = pixels[:, :2] / pixels[:, 2:]
        left, top, width, height = thing["box_px"]
        assert (pixels.min(axis=0) <= (left + 1, top + 1)).all()
        assert (pixels.max(axis=0) >= (left + width - 1, top + height - 1)).all()
        judged += 1
    assert judged > 3


def test_from_above_one_sees_past_the_ceilings_and_nothing_around_the_house(folder: Path) -> None:
    sidecar = json.loads((folder / "Top.json").read_text())
    labels = {thing["label"] for thing in sidecar["instances"]}
    assert "floor" in labels
    assert "ceiling" not in labels
    mask = read_mask(folder / "Top.instance.png")
    depth_m = read_exr(folder / "Top.depth.exr")[0]["Z"]
    assert mask[0, 0] == 0
    assert np.array_equal(np.isinf(depth_m), mask == 0)


def test_coco_lists_every_thing_that_is_seen(folder: Path, sidecar: dict) -> None:
    data = json.loads((folder / "coco.json").read_text())
    assert [image["file_name"] for image in data["images"]] == [
        f"{CAMERA}.instance.png",
        "Top.instance.png",
    ]
    mine = [a for a in data["annotations"] if a["image_id"] == 1]
    assert [a["prim_path"] for a in mine] == [thing["path"] for thing in sidecar["instances"]]
    for annotation in mine:
        assert sum(annotation["segmentation"]["counts"][1::2]) == annotation["area"]
    assert {a["category_id"] for a in data["annotations"]} == {c["id"] for c in data["categories"]}


def test_coco_can_speak_of_others_classes(folder: Path, tmp_path: Path) -> None:
    """By the same masks: a render of them is not needed again."""
    shutil.copytree(folder, tmp_path, dirs_exist_ok=True)
    data = json.loads(write_coco(tmp_path, [CAMERA, "Top"], "nyu40").read_text())
    assert {a["category_id"] for a in data["annotations"]} <= set(classes_of("nyu40").values())
    own = json.loads((folder / "coco.json").read_text())["annotations"]
    assert [a["segmentation"] for a in data["annotations"]] == [a["segmentation"] for a in own]


def _light(stage: Path, folder: Path, **quality: Any) -> np.ndarray:
    options = RenderOptions(
        cameras=(CAMERA,),
        resolution_px=(32, 18),
        quality=replace(QUALITIES["draft"], **quality),
        exposure_ev=0.0,
        device="cpu",
    )
    made = render_stage(stage, folder, options)
    channels, _ = read_exr(made.pictures[0].with_suffix(".exr"))
    return np.stack([channels[name] for name in "RGB"])


def test_rooms_are_joined_by_what_light_passes(staged_house: Path) -> None:
    """Not by doors with a leaf: each pair has a passage, or glass, in the room of either, or no
    wall between."""
    rooms = set(read_views(staged_house).rooms)
    joined = joined_rooms(staged_house)
    assert all(a in rooms and b in rooms and a != b for a, b in joined)
    stage = Usd.Stage.Open(str(staged_house))
    floors = {
        room.GetName(): Polygon(room.GetAttribute("chord:polygon_m").Get())
        for room in stage.GetPrimAtPath("/House/Rooms").GetChildren()
    }
    open_plan = set(touching(floors))
    assert open_plan <= set(joined)
    prims = [prim for prim in stage.Traverse() if prim.HasAttribute("chord:rooms")]
    between = [prim for prim in prims if len(prim.GetAttribute("chord:rooms").Get()) == 2]
    shut = [
        p
        for p in between
        if (leaf := p.GetChild(f"Leaf_0_{p.GetName()}"))
        and not any(part.GetName().startswith("Glass_") for part in leaf.GetChildren())
    ]
    assert len(between) - len(shut) >= len(set(joined) - open_plan)
    assert shut


@pytest.fixture
def house_with_screen(staged_house: Path) -> Iterator[Path]:
    """The house and, in the middle of the camera's room, a screen that lights it."""
    path = staged_house.with_name("with_screen.usda")
    stage = Usd.Stage.CreateNew(str(path))
    stage.GetRootLayer().subLayerPaths.append(staged_house.name)
    house = stage.GetPrimAtPath("/House")
    stage.SetDefaultPrim(house)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
    room = house.GetPrimAtPath(f"Rooms/{CAMERA}")
    middle = Polygon(room.GetAttribute("chord:polygon_m").Get()).centroid
    corners = [(middle.x + x, middle.y, 1.5 + z) for x, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    screen = UsdGeom.Mesh.Define(stage, room.GetPath().AppendChild("Screen"))
    screen.CreatePointsAttr(corners)
    screen.CreateFaceVertexCountsAttr([4])
    screen.CreateFaceVertexIndicesAttr([0, 1, 2, 3])
    material = UsdShade.Material.Define(stage, screen.GetPath().AppendChild("Picture"))
    shader = UsdShade.Shader.Define(stage, material.GetPath().AppendChild("Surface"))
    shader.CreateIdAttr("UsdPreviewSurface")
    shader.CreateInput("emissiveColor", Sdf.ValueTypeNames.Color3f).Set((5.0, 5.0, 5.0))
    material.CreateSurfaceOutput().ConnectToSource(shader.ConnectableAPI(), "surface")
    UsdShade.MaterialBindingAPI.Apply(screen.GetPrim()).Bind(material)
    stage.Save()
    yield path
    path.unlink()


@pytest.mark.parametrize("lever", [{"own_lamps": False}, *later({"sample_glow": True})])
def test_what_shadow_rays_are_sent_to_leaves_the_light_as_it_is(
    house_with_screen: Path, tmp_path: Path, lever: dict
) -> None:
    ours, other = (
        _light(house_with_screen, tmp_path / str(n), matte_bounces=False, **kind)
        for n, kind in enumerate(({}, lever))
    )
    assert not np.array_equal(ours, other)
    assert abs(ours.mean() - other.mean()) < 0.1 * other.mean()


@pytest.mark.acceptance
def test_matte_bounces_are_as_bright_as_highlights_among_them(
    staged_house: Path, tmp_path: Path
) -> None:
    """A matte surface returns what its highlight would have. With equal noise and all bounces."""
    real = {"matte_bounces": False, "caustics": True, "clamp": 0.0}
    ours, other = (
        _light(staged_house, tmp_path / str(n), samples=64, noise=0.0, **quality)
        for n, quality in enumerate(({"clamp": 0.0}, real))
    )
    assert not np.array_equal(ours, other)
    assert abs(ours.mean() - other.mean()) < 0.015 * other.mean()
