"""Small valid examples of everything that the program reads, made by the code of its tests."""

from __future__ import annotations

import gzip
import json
import shutil
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import trimesh
from PIL import Image
from pxr import Sdf, UsdUtils

from chord_usd.base.raster.canvas import draw_plan, layout_image
from chord_usd.base.raster.raster_files import write_raster
from chord_usd.base.scene.chord_json import read_scene, write_plan, write_scene
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import Plan, SceneGraph
from chord_usd.cli import main
from tests import plan_files
from tests.foreign_records import flat_lines, front_house, procthor_house

ROOT = Path(__file__).parents[2]
STRANGER = "stranger"
"""Folder with what is somebody else's; nothing may change it, or take something out of it."""


def make(folder: Path) -> Path:
    """Write all examples into a new folder; returns it."""
    folder.mkdir()
    whole = read_scene(ROOT / "tests" / "fixtures" / "furnished_house.json")
    small = _one_room(whole)
    _plans(folder, whole.plan)
    _scenes(folder, whole, small)
    _stages(folder, small)
    _libraries(folder)
    _records(folder, whole)
    _checkpoints(folder / "checkpoints")
    return folder


def make_stranger(folder: Path) -> None:
    """A folder of somebody else."""
    folder.mkdir()
    (folder / "thesis.txt").write_text("years of work")
    (folder / "house.usda").write_text(
        '#usda 1.0\n(\n    defaultPrim = "House"\n)\ndef "House"\n{\n}\n'
    )
    Image.new("RGB", (8, 8), "navy").save(folder / "private.png")
    (folder / ".hidden").write_text("secret")


def _one_room(scene: SceneGraph) -> SceneGraph:
    """The bedroom with two pieces: a stage that is soon made."""
    room = next(room for room in scene.rooms if room.kind == "bedroom")
    return replace(
        scene,
        rooms=(room,),
        openings=tuple(replace(one, room_ids=(room.id,)) for one in scene.openings
                       if room.id in one.room_ids and one.kind != "passage"),
        items=tuple(scene.items_of(room.id))[:2],
    )  # fmt: skip


def _plans(folder: Path, plan: Plan) -> None:
    write_plan(plan, folder / "plan.json")
    drawn = draw_plan(plan)
    write_raster(drawn, folder / "plan.png")
    picture = Image.fromarray(np.asarray(drawn.rgb))
    for name in ("plan.jpg", "plan.webp", "plan.tiff", "plan.gif", "plan.bmp"):
        picture.save(folder / name)
    picture.convert("1").resize((400, 400)).save(folder / "lines.png")
    plan_files.write_dxf(plan, folder / "plan.dxf")
    plan_files.write_ifc(folder / "plan.ifc")
    plan_files.write_cubicasa(plan, folder / "plan.svg")
    plan_files.write_sweethome(folder / "plan.sh3d")
    _write_pdf(plan, folder / "plan.pdf")


def _write_pdf(plan: Plan, path: Path) -> None:
    """Walls filled and rooms named, uncompressed, 1:100."""
    per_m = 72 / 0.0254 / 100
    parts = []
    for wall in plan_files.solid_walls(plan):
        for ring in (wall.exterior, *wall.interiors):
            points = [f"{x * per_m + 100:.2f} {y * per_m + 100:.2f}" for x, y in ring.coords]
            parts.append(f"{points[0]} m " + " ".join(f"{one} l" for one in points[1:]) + " h")
        parts.append("f*")
    for room in plan.rooms:
        place = room_polygon(room).representative_point()
        at = f"{place.x * per_m + 100:.1f} {place.y * per_m + 100:.1f}"
        parts.append(f"BT /F 8 Tf {at} Td ({room.kind}) Tj ET")
    content = "\n".join(parts)
    font = "<< /Type /Font /Subtype /Type1 /BaseFont /Helvetica >>"
    bodies = (
        "<< /Type /Catalog /Pages 2 0 R >>", "<< /Type /Pages /Kids [3 0 R] /Count 1 >>",
        "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 842 842] /Contents 4 0 R "
        f"/Resources << /Font << /F {font} >> >> >>",
        f"<< /Length {len(content)} >>\nstream\n{content}\nendstream",
    )  # fmt: skip
    objects = [f"{number} 0 obj\n{body}\nendobj\n" for number, body in enumerate(bodies, 1)]
    path.write_text("%PDF-1.7\n" + "".join(objects) + "trailer << /Root 1 0 R >>\n%%EOF\n")


def _scenes(folder: Path, whole: SceneGraph, small: SceneGraph) -> None:
    write_scene(whole, folder / "scene.json")
    write_scene(small, folder / "small.json")
    drawn = draw_plan(whole.plan)
    write_raster(layout_image(drawn, whole.items), folder / "layout.png")
    (folder / "houses").mkdir()
    for name, scene in (("one", whole), ("two", small)):
        write_scene(scene, folder / "houses" / f"{name}.json")


def _stages(folder: Path, small: SceneGraph) -> None:
    home = folder / "house"
    for target in (home / "house.usda", folder / "house.usdz"):
        if target.suffix == ".usda":
            assert (
                main(["stage", str(folder / "small.json"), "-o", str(target), "--progress", "none"])
                == 0
            )
        else:
            assert UsdUtils.CreateNewUsdzPackage(str(home / "house.usda"), str(target))
    layer = Sdf.Layer.FindOrOpen(str(home / "house.usda"))
    layer.Export(str(home / "house.usdc"))
    edits = Sdf.Layer.CreateNew(str(home / "edits.usda"))
    edits.subLayerPaths.append("./house.usda")
    edits.defaultPrim = layer.defaultPrim
    for key in ("metersPerUnit", "upAxis"):
        edits.pseudoRoot.SetInfo(key, layer.pseudoRoot.GetInfo(key))
    piece = _first_piece(layer)
    over = Sdf.CreatePrimInLayer(edits, piece)
    move = Sdf.AttributeSpec(over, "xformOp:translate", Sdf.ValueTypeNames.Double3)
    move.default = (1.0, 1.0, 0.0)
    edits.Save()


def _done(*words: object) -> None:
    assert main([*map(str, words), "--progress", "none"]) == 0


def _first_piece(layer: Sdf.Layer) -> str:
    """Path of the first piece of furniture, by what only pieces have."""
    found: list[str] = []
    layer.Traverse("/", lambda path: found.append(str(path)))
    return min(path for path in found if path.endswith(".chord:node_id")).split(".")[0]


def _libraries(folder: Path) -> None:
    library = folder / "library"
    library.mkdir()
    chair = trimesh.util.concatenate([
        trimesh.creation.box((0.5, 0.05, 0.5)), trimesh.creation.box((0.5, 0.5, 0.05)),
    ])  # fmt: skip
    for suffix in ("glb", "obj"):
        chair.export(library / f"chair.{suffix}")
    rows = [
        {"file": "chair.glb", "category": "chair", "licence": "CC0-1.0", "author": "A"},
        {
            "file": "chair.obj",
            "category": "chair",
            "id": "second",
            "size_cm": [50, 50, 90],
            "up": "+y",
        },
    ]
    (library / "manifest.json").write_text(json.dumps(rows))
    catalogue = (
        "license=CC BY 3.0\nid#1=x#red chair\nname#1=Chair\nmodel#1=/jo/chair.obj\nwidth#1=48.0\n"
        "depth#1=52.0\nheight#1=90.0\ncreator#1=Jos\\u00e9\nmodelRotation#1=1 0 0 0 1 0 0 0 1\n"
    )
    with zipfile.ZipFile(folder / "chairs.sh3f", "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("PluginFurnitureCatalog.properties", catalogue)
        archive.write(library / "chair.obj", "jo/chair.obj")
    assert (
        main(["assets", "add", str(library), "-o", str(folder / "database"), "--progress", "none"])
        == 0
    )


def _records(folder: Path, whole: SceneGraph) -> None:
    flats = "".join(json.dumps({"id": f"a/{n}", "lines": flat_lines()}) + "\n" for n in range(40))
    (folder / "flats.jsonl").write_text(flats)
    (folder / "flats.jsonl.gz").write_bytes(gzip.compress(flats.encode(), mtime=0))
    (folder / "front.json").write_text(json.dumps(front_house()))
    (folder / "procthor.json").write_text(json.dumps(procthor_house()))
    rows = [front_house(), procthor_house(), {"id": "flat", "lines": flat_lines()}]
    (folder / "mixed.jsonl").write_text("".join(json.dumps(row) + "\n" for row in rows))
    (folder / "model_info.json").write_text(
        json.dumps([{"model_id": "m1", "category": "King-size Bed"}])
    )
    sizes = {"Bed": [{"assetId": "Bed_1", "boundingBox": {"x": 1.6, "y": 0.9, "z": 2.0}}]}
    (folder / "asset-database.json").write_text(json.dumps(sizes))


def _checkpoints(folder: Path) -> None:
    """A folder for CHORD_USD_CHECKPOINTS with the two smallest."""
    folder.mkdir()
    for name in ("bubbles", "text2plan"):
        shutil.copytree(ROOT / "checkpoints" / name, folder / name)
