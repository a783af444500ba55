"""regenerate as a user runs it: a stage in, the same stage with one room furnished anew out."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from pxr import Gf, Sdf, Usd

from chord_usd.base.raster import canvas
from chord_usd.base.raster.raster_files import read_layout
from chord_usd.base.scene.chord_json import read_scene
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.types import Box, Item, SceneGraph
from chord_usd.line.stage.author.author_stage import author_stage
from chord_usd.line.stage.edit.staged_house import read_house
from tests.exit_codes import written

RunCli = Callable[..., subprocess.CompletedProcess[str]]

ROOM = "LivingRoom_0"
WORDS = ("--room", ROOM, "--steps", 2, "--progress", "none", "--json")


@pytest.fixture(scope="module")
def house(furnished_house: SceneGraph, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A lamp stands on every bedside table."""
    lamp = Item("lamp", "table_lamp", Box((0.0, 0.0, 0.5), (0.2, 0.2, 0.4), 30.0))
    items = tuple(
        replace(item, children=(replace(lamp, id=f"{item.id}/lamp"),))
        if item.category == "bedside_table"
        else item
        for item in furnished_house.items
    )
    path = tmp_path_factory.mktemp("regenerate") / "house.usda"
    author_stage(replace(furnished_house, items=items), path, seed=4)
    return path


def test_one_room_changes_in_stage_graph_and_picture(
    house: Path, tmp_path: Path, run_cli: RunCli
) -> None:
    folder = Path(shutil.copytree(house.parent, tmp_path / "house"))
    stage = folder / "house.usda"
    before = read_house(stage)
    done = run_cli(
        "regenerate", stage, *WORDS,
        "--layout-out", tmp_path / "layout.png", "--graph-out", tmp_path / "scene.json",
    )  # fmt: skip
    told = written(done)
    assert told["room"] == ROOM
    assert told["seed"] == 5, "one more than the house's"
    assert not told["certificate"]["errors"], told["certificate"]["errors"]
    after = read_house(stage)
    room_id = before.room_ids[ROOM]

    def others(graph: SceneGraph) -> list[tuple[object, ...]]:
        return [
            (item.id, item.box, [(child.id, child.box) for child in item.children])
            for item in graph.items
            if item.room_id != room_id
        ]

    assert others(after.graph) == others(before.graph)
    assert sum(len(children) for *_, children in others(after.graph)) == 4, "a lamp was lost"
    assert others(read_scene(tmp_path / "scene.json")) != []
    pieces = list(after.graph.items_of(room_id))
    assert len(pieces) == told["furniture"]
    assert sum(1 + len(piece.children) for piece in pieces) == told["items"]
    plan_image = canvas.draw_plan(before.graph.plan)
    layout = read_layout(tmp_path / "layout.png")
    region = canvas.room_pixels(before.room(ROOM, stage), plan_image.frame)
    drawn = canvas.layout_image(plan_image, before.graph.items)
    assert np.array_equal(layout.rgb[~region], drawn.rgb[~region])
    assert not np.array_equal(layout.rgb[region], drawn.rgb[region])
    with Image.open(tmp_path / "layout.png") as picture:
        assert "chord" in picture.text  # type: ignore[attr-defined]


def test_an_unknown_room_leaves_everything(house: Path, run_cli: RunCli) -> None:
    text = house.read_bytes()
    done = run_cli("regenerate", house, "--room", "LivingRoom_1", "--progress", "none")
    assert done.returncode == 2
    assert done.stdout == ""
    assert done.stderr.startswith("error: ")
    assert f"--room {ROOM}" in done.stderr
    assert house.read_bytes() == text


def test_what_is_kept_stays_where_the_edits_have_put_it(
    house: Path, tmp_path: Path, run_cli: RunCli
) -> None:
    stage = Path(shutil.copytree(house.parent, tmp_path / "house")) / "house.usda"
    before = read_house(stage)
    kept = next(p for p in before.item_ids if p.startswith(f"/House/Rooms/{ROOM}/Furniture/Sofa_"))
    pose = next(item.box for item in before.graph.items if item.id == before.item_ids[kept])
    edits = stage.with_name("house.edits.usda")
    write_move(edits, stage, kept, pose.center_m[0] + 0.3)
    kept_text = prim_text(stage, kept)
    done = run_cli("regenerate", stage, *WORDS, "--keep", kept.split("/")[-1], "--edits", edits)
    assert written(done)["kept"] == [kept.split("/")[-1]]
    assert prim_text(stage, kept) == kept_text, "the edits stay in their own layer"
    seen = read_house(edits)
    items = {item.id: item for item in seen.graph.items_of(seen.room_ids[ROOM])}
    own = items.pop(seen.item_ids[kept])
    assert own.box.center_m[0] == pytest.approx(pose.center_m[0] + 0.3, abs=1e-3)
    for item in items.values():
        overlap = footprint_polygon(item.box).intersection(footprint_polygon(own.box)).area
        assert overlap < 0.01 * footprint_polygon(own.box).area, item.id


def test_an_unknown_piece_to_keep_is_refused(house: Path, run_cli: RunCli) -> None:
    done = run_cli("regenerate", house, *WORDS, "--keep", "Piano_0")
    assert done.returncode == 2
    assert "Piano_0" in done.stderr
    assert "expected one of" in done.stderr


def write_move(edits: Path, house: Path, path: str, x_m: float) -> None:
    """A layer over the house in which a piece stands at another x."""
    layer = Sdf.Layer.CreateNew(str(edits))
    layer.subLayerPaths.append(f"./{house.name}")
    stage = Usd.Stage.Open(layer)
    stage.SetMetadata("defaultPrim", "House")
    place = stage.GetPrimAtPath(path).GetAttribute("xformOp:translate")
    place.Set(Gf.Vec3d(x_m, *place.Get()[1:]))
    layer.Save()


def prim_text(stage: Path, path: str) -> str:
    """A prim of the stage's own layer."""
    layer = Sdf.Layer.OpenAsAnonymous(str(stage))  # a prim does not keep its layer
    return str(layer.GetPrimAtPath(path).GetAsText())
