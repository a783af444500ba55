"""The whole line as a user runs it: a plan in, a furnished stage out, read back with usd-core."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from pxr import Kind, Usd, UsdGeom, UsdLux, UsdUtils

from tests.exit_codes import written

RunCli = Callable[..., subprocess.CompletedProcess[str]]

EXAMPLES = Path(__file__).parents[2] / "examples"
STEPS = 4
"""Sampler steps: enough for a house, and quick."""

MUST_BE_FURNISHED = ("living", "bedroom", "kitchen", "bathroom")


POSE = ("type", "pos", "length", "width", "height", "rotate")


@dataclass(frozen=True)
class Made:
    """What one run left."""

    folder: Path
    told: dict[str, Any]
    progress: str

    @property
    def stage_path(self) -> Path:
        return self.folder / "house.usda"


def make(run_cli: RunCli, folder: Path, plan: str, *more: str) -> Made:
    done = run_cli(
        "generate", EXAMPLES / plan, "-o", folder / "house.usda", "--steps", STEPS,
        "--layout-out", folder / "layout.png", "--graph-out", folder / "scene.json",
        "--preview", folder / "preview.png", "--keep", folder / "kept",
        "--json", "--progress", "json", *more,
    )  # fmt: skip
    return Made(folder, written(done), done.stderr)


@pytest.fixture(scope="module")
def made(run_cli: RunCli, tmp_path_factory: pytest.TempPathFactory) -> Made:
    return make(run_cli, tmp_path_factory.mktemp("house") / "new" / "folder", "two_bedrooms.png")


@pytest.fixture(scope="module")
def again(run_cli: RunCli, tmp_path_factory: pytest.TempPathFactory) -> Made:
    """Made by a process that was started for it, whose sets have another order."""
    return make(partial(run_cli, fresh=True), tmp_path_factory.mktemp("again"), "two_bedrooms.png")


@pytest.fixture(scope="module")
def first_draw(run_cli: RunCli, tmp_path_factory: pytest.TempPathFactory) -> Made:
    """No room is drawn again, nothing is laid or dressed."""
    folder, bare = tmp_path_factory.mktemp("first"), ("--no-tabletop", "--no-dressing")
    return make(run_cli, folder, "two_bedrooms.png", "--redraws", "0", *bare)


@pytest.fixture(scope="module")
def stage(made: Made) -> Usd.Stage:
    return Usd.Stage.Open(str(made.stage_path))


def scene_of(made: Made) -> dict[str, Any]:
    return json.loads((made.folder / "scene.json").read_text())


def furniture_in(stage: Usd.Stage) -> dict[str, list[Usd.Prim]]:
    """Placed pieces by the name of their room."""
    rooms = stage.GetPrimAtPath("/House/Rooms").GetChildren()
    return {
        room.GetName(): room.GetChild("Furniture").GetChildren()
        for room in rooms
        if room.GetChild("Furniture")
    }


def test_the_summary_counts_what_the_scene_holds(made: Made) -> None:
    scene = scene_of(made)
    assert made.told["stage"] == str(made.stage_path)
    assert made.told["rooms"] == len(scene["rooms"]) == 7
    assert made.told["furniture"] == len(scene["furniture"])
    assert made.told["openings"] == len(scene["windowsDoors"])
    assert {"load", "plan", "layout", "graph", "stage"} <= made.told["seconds"].keys()
    assert 0.01 < made.told["m_per_px"] < 0.2


def test_tables_are_laid_unless_they_shall_not_be(made: Made, first_draw: Made) -> None:
    pieces = [item for item in scene_of(made)["furniture"] if item.get("children")]
    carried = sum(len(item["children"]) for item in pieces)
    told = made.told["tabletop"]
    assert told["items"] == carried == made.told["items"] - made.told["furniture"] > 0
    assert told["pieces"] == len(pieces) + len(told["bare"]) + len(told["too_small"])
    assert not any(item.get("children") for item in scene_of(first_draw)["furniture"])
    assert first_draw.told["items"] == first_draw.told["furniture"]
    assert "tabletop" not in first_draw.told["seconds"]


def test_what_stands_on_a_table_is_below_it_in_the_stage(stage: Usd.Stage, made: Made) -> None:
    """A group around the table and its items, which stand on its mesh."""
    cache = UsdGeom.BBoxCache(Usd.TimeCode.Default(), [UsdGeom.Tokens.default_])
    found = 0
    for pieces in furniture_in(stage).values():
        for piece in pieces:
            items = piece.GetChild("Items")
            if not items:
                continue
            table = next(child for child in piece.GetChildren() if child != items)
            top = cache.ComputeWorldBound(table).ComputeAlignedRange()
            for item in items.GetChildren():
                box = cache.ComputeWorldBound(item).ComputeAlignedRange()
                assert top.GetMin()[2] < box.GetMin()[2] <= top.GetMax()[2] + 0.1
                middle = box.GetMidpoint()
                assert all(top.GetMin()[k] < middle[k] < top.GetMax()[k] for k in (0, 1))
                found += 1
    assert found == made.told["tabletop"]["items"]
    assert made.told["certificate"]["unsupported"] == []


def test_the_certificate_is_that_of_check(made: Made, run_cli: RunCli) -> None:
    done = run_cli("check", made.stage_path, "--json", "--progress", "none")
    certificate = json.loads(done.stdout)
    assert certificate == made.told["certificate"]
    assert not certificate["errors"], certificate["errors"]
    faults = ("errors", "collisions", "out_of_room", "blocked_openings", "unsupported")
    holds = not any(certificate[fault] for fault in (*faults, "empty_rooms"))
    assert done.returncode == (0 if holds else 1)


def test_progress_is_json_and_ends_every_step(made: Made) -> None:
    lines = [json.loads(line) for line in made.progress.splitlines()]
    last = {line["step"]: line for line in lines}
    steps = ["plan", "load", "list", "layout", "graph", "redraw", "outliers", "tabletop"]
    assert list(last) == [*steps, "settle", "dress", "stage", "check"]
    assert all(line["done"] == line["total"] for line in last.values())
    assert 1 <= last["layout"]["total"] <= STEPS


def test_the_stage_is_a_house_of_rooms_of_furniture(stage: Usd.Stage, made: Made) -> None:
    house = stage.GetDefaultPrim()
    assert house.GetPath() == "/House"
    assert Usd.ModelAPI(house).GetKind() == Kind.Tokens.assembly
    assert UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    rooms = stage.GetPrimAtPath("/House/Rooms").GetChildren()
    assert len(rooms) == made.told["rooms"]
    for room in rooms:
        assert Usd.ModelAPI(room).GetKind() == Kind.Tokens.group
        assert room.GetChild("Architecture").HasPayload()
        lights = [prim for prim in Usd.PrimRange(room) if prim.IsA(UsdLux.RectLight)]
        assert len(lights) == 1
    assert len(stage.GetPrimAtPath("/House/Cameras").GetChildren()) >= len(rooms)


def test_every_item_of_the_scene_stands_in_its_room(stage: Usd.Stage, made: Made) -> None:
    """Count by category, and where: the placed prim's origin is the item's position."""
    placed = [prim for pieces in furniture_in(stage).values() for prim in pieces]
    assert len(placed) == made.told["furniture"] > 5
    cache = UsdGeom.XformCache()
    found = Counter()
    for prim in placed:
        x, y, _ = cache.GetLocalToWorldTransform(prim).ExtractTranslation()
        found[round(x, 2), round(y, 2)] += 1
    wanted = Counter(
        (round(item["pos"][0] / 100, 2), round(item["pos"][1] / 100, 2))
        for item in scene_of(made)["furniture"]
    )
    near = sum(
        any(abs(x - a) < 0.02 and abs(y - b) < 0.02 for a, b in wanted) * count
        for (x, y), count in found.items()
    )
    assert near == len(placed)


def test_furniture_has_meshes_and_a_plain_load_has_none(stage: Usd.Stage, made: Made) -> None:
    def meshes(of: Usd.Stage) -> int:
        instances = Usd.TraverseInstanceProxies()
        return sum(prim.IsA(UsdGeom.Mesh) for prim in of.Traverse(instances))

    assert meshes(stage) > 50
    bare = Usd.Stage.Open(str(made.stage_path), Usd.Stage.LoadNone)
    assert meshes(bare) == 0


def test_the_folder_can_be_moved(made: Made, tmp_path: Path) -> None:
    shutil.copytree(made.folder, tmp_path / "moved")
    layers, _, unresolved = UsdUtils.ComputeAllDependencies(str(tmp_path / "moved/house.usda"))
    assert unresolved == []
    assert all(Path(layer.realPath).is_relative_to(tmp_path) for layer in layers)


def test_the_same_seed_gives_the_same_bytes(made: Made, again: Made) -> None:
    def files(folder: Path) -> dict[str, bytes]:
        paths = [path for path in folder.rglob("*") if path.is_file()]
        return {str(path.relative_to(folder)): path.read_bytes() for path in paths}

    first, second = files(made.folder), files(again.folder)
    assert first.keys() == second.keys()
    assert [name for name in first if first[name] != second[name]] == []


def test_another_seed_gives_another_layout(
    first_draw: Made, run_cli: RunCli, tmp_path: Path
) -> None:
    plan, target = EXAMPLES / "two_bedrooms.png", tmp_path / "layout.png"
    words = ["layout", plan, "-o", target, "--steps", STEPS, "--progress", "none"]
    assert run_cli(*words, "--seed", 1).returncode == 0
    assert target.read_bytes() != (first_draw.folder / "layout.png").read_bytes()
    # The verb alone draws what it draws within the line.
    assert run_cli(*words, "--seed", 0).returncode == 0
    assert target.read_bytes() == (first_draw.folder / "kept/layout_first.png").read_bytes()


def test_the_steps_one_by_one_give_the_same_furniture(
    first_draw: Made, run_cli: RunCli, tmp_path: Path
) -> None:
    done = run_cli(
        "graph",
        first_draw.folder / "kept/layout_first.png",
        "-o",
        tmp_path / "scene.json",
        "--progress",
        "none",
    )
    assert done.returncode == 0, done.stderr
    scene = json.loads((tmp_path / "scene.json").read_text())
    # Before pieces in conflict are left out.
    read = json.loads((first_draw.folder / "kept/read.json").read_text())
    assert Counter(item["type"] for item in scene["furniture"]) == Counter(
        item["type"] for item in read["furniture"]
    )


def test_only_rooms_that_are_told_differ_from_the_first_draw(made: Made, first_draw: Made) -> None:
    assert first_draw.told["redrawn"] == []
    before, after = (
        {
            item["id"]: [item[key] for key in ("roomId", *POSE)]
            for item in scene_of(one)["furniture"]
        }
        for one in (first_draw, made)
    )
    both = before.keys() | after.keys()
    rooms = {name.split("/")[0] for name in both if before.get(name) != after.get(name)}
    left_out = {name.split("/")[0] for one in (made, first_draw) for name in one.told["left_out"]}
    assert rooms <= {*made.told["redrawn"], *left_out}


@pytest.mark.acceptance
def test_a_usdz_holds_the_house_in_one_file(made: Made, run_cli: RunCli, tmp_path: Path) -> None:
    target = tmp_path / "house.usdz"
    done = run_cli(
        "stage", made.folder / "scene.json", "-o", target, "--json", "--progress", "none"
    )
    written(done)
    # The makers of the sky are named beside it, since an archive of USD holds no text.
    told = {target.name, "house_attribution.txt", ".chord-usd.manifest"}
    assert {file.name for file in tmp_path.iterdir()} == told
    packed = Usd.Stage.Open(str(target))
    assert sum(map(len, furniture_in(packed).values())) == made.told["furniture"]


@pytest.mark.acceptance
def test_a_picture_is_rendered(made: Made, run_cli: RunCli, tmp_path: Path) -> None:
    import numpy as np
    from PIL import Image

    camera = next(name for name in furniture_in(Usd.Stage.Open(str(made.stage_path))))
    done = run_cli(
        "render", made.stage_path, "-o", tmp_path / "pictures", "--camera", camera,
        "--samples", 2, "--resolution", "160x90", "--json", "--progress", "none",
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    (picture,) = json.loads(done.stdout)["pictures"]
    with Image.open(picture) as image:
        pixels = np.asarray(image.convert("RGB"), np.float64)
    assert pixels.shape == (90, 160, 3)
    assert 20.0 < pixels.mean() < 245.0
    assert pixels.std() > 8.0
