"""The extension in Blender: built, installed, enabled, used, disabled. In a process of its own."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pxr import Usd, UsdGeom

from chord_usd.cli import main

ROOT = Path(__file__).parents[2]

SCENE = ROOT / "tests" / "fixtures" / "furnished_house.json"

IN_BLENDER = '''
import json, os, sys, time
out, zip_file, program, plan = sys.argv[1:]
os.environ["BLENDER_USER_RESOURCES"] = out + "/user"
import bpy
bpy.ops.wm.read_factory_settings(use_empty=True)
before = set(dir(bpy.types))
bpy.ops.extensions.package_install_files(
    filepath=zip_file, repo="user_default", enable_on_install=True
)
name = "bl_ext.user_default.chord_usd"
from bl_ext.user_default.chord_usd import panel
from bl_ext.user_default.chord_usd.core.state import panel_state
from bl_ext.user_default.chord_usd.session import session

def run(operator):
    try:
        operator()
    except RuntimeError as error:
        return str(error)
    while session.step(bpy.context):
        time.sleep(0.05)
    return own.error

class Drawing:
    """Stands in for a layout and writes down what is drawn."""
    def __init__(self, log):
        self.log = log
    def __getattr__(self, kind):
        def draw(*args, **kwargs):
            self.log.append([kind, *[a for a in args if isinstance(a, str)], *kwargs.values()])
            return Drawing(self.log)
        return draw

class Panel:
    pass

def drawn():
    shown = Panel()
    log = []
    shown.layout = Drawing(log)
    panel.ChordPanel.draw(shown, bpy.context)
    return [[str(part) for part in line] for line in log]

def tree(collection):
    return {c.name: tree(c) for c in collection.children if not c.name.startswith("proto")}

own = bpy.context.scene.chord_usd
result = {"empty": drawn()}
bpy.context.preferences.addons[name].preferences.program = "/nowhere"
result["no_program"] = run(bpy.ops.chord.generate)
own.plan = plan
result["wrong_program"] = run(bpy.ops.chord.generate)
result["failed"] = drawn()
bpy.context.preferences.addons[name].preferences.program = program
result["check_program"] = list(bpy.ops.chord.check_program())
result["error"] = run(bpy.ops.chord.generate)
result["tree"] = tree(bpy.context.scene.collection)
result["rooms"] = [room.name for room in own.rooms]
result["done"] = drawn()
objects = len(bpy.data.objects)
bpy.ops.chord.generate()
result["running"] = drawn()
while session.step(bpy.context):
    time.sleep(0.05)
result["same_number_of_objects"] = objects == len(bpy.data.objects)
bpy.ops.chord.show_finding(index=0)
result["selected"] = sorted(o["chord_usd_path"] for o in bpy.context.selected_objects)
pieces = {o["chord_usd_path"]: o for o in bpy.context.scene.objects if "chord_usd_placed" in o}
result["pieces"] = sorted(pieces)
moved, removed = result["pieces"][:2]
pieces[moved].location.x += 0.25
pieces[moved].rotation_euler.z += 0.5
bpy.context.view_layer.update()
result["moved"] = [moved, [list(row) for row in pieces[moved].matrix_world]]
result["removed"] = removed
bpy.data.objects.remove(pieces[removed], do_unlink=True)
result["saved"] = list(bpy.ops.chord.save_edits())
from bl_ext.user_default.chord_usd.importer import import_house
from pathlib import Path
import_house(bpy.context, Path(own.house))
bpy.context.view_layer.update()
again = {o["chord_usd_path"]: o for o in bpy.context.scene.objects if "chord_usd_placed" in o}
result["again"] = [sorted(again), [list(row) for row in again[moved].matrix_world]]
own.hide_ceilings = False
result["house"] = own.house
result["camera"] = bpy.context.scene.camera.name
os.remove(plan)
result["plan_gone"] = run(bpy.ops.chord.generate)
bpy.ops.preferences.addon_disable(module=name)
result["left"] = [t for t in set(dir(bpy.types)) - before if "chord" in t.lower()]
result["field_left"] = hasattr(bpy.types.Scene, "chord_usd")
print("RESULT" + json.dumps(result))
'''

STANDS_IN = """#!{python}
import json, sys, time
if "--version" in sys.argv:
    print("chord-usd 9.0.0")
    sys.exit()
time.sleep(0.3)
bed = "/House/Rooms/Bedroom_0/Furniture/Bed_0"
print(json.dumps({{"stage": {stage!r}, "certificate": {{"valid": True, "walkable": 0.9,
    "unsupported": [bed]}}}}))
"""


@pytest.fixture(scope="module")
def extension(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The built zip."""
    bpy_folder = next(Path(folder) for folder in sys.path if (Path(folder) / "bpy").is_dir())
    tool = next(bpy_folder.glob("bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py"))
    out = tmp_path_factory.mktemp("dist")
    command = [sys.executable, tool, "build", "--source-dir", ROOT / "blender_addon"]
    subprocess.run([*command, "--output-dir", out], check=True, capture_output=True)
    built = next(out.glob("chord_usd-*.zip"))
    subprocess.run([sys.executable, tool, "validate", built], check=True, capture_output=True)
    return built


@pytest.fixture(scope="module")
def told(extension: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What happened in Blender, with a program that hands out a stage made here."""
    folder = tmp_path_factory.mktemp("blender user")
    stage = folder / "house.usda"
    assert main(["stage", str(SCENE), "-o", str(stage)]) == 0
    program = folder / "chord-usd"
    program.write_text(STANDS_IN.format(python=sys.executable, stage=str(stage)), encoding="utf-8")
    program.chmod(0o755)
    plan = folder / "plän.png"
    plan.touch()
    script = folder / "in_blender.py"
    script.write_text(IN_BLENDER)
    command = [sys.executable, script, folder, extension, program, plan]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    lines = [line for line in done.stdout.splitlines() if line.startswith("RESULT")]
    assert lines, done.stdout[-2000:] + done.stderr[-2000:]
    return dict(json.loads(lines[0].removeprefix("RESULT")))


def test_what_is_missing_is_said_in_plain_words(told: dict[str, Any]) -> None:
    assert "Choose a floor plan" in told["no_program"]
    assert "There is no file" in told["wrong_program"]
    assert "not there" in told["plan_gone"]


def test_the_house_comes_in_as_a_collection_tree(told: dict[str, Any]) -> None:
    assert told["error"] == ""
    assert told["check_program"] == ["FINISHED"]
    house = told["tree"]["House"]
    assert set(told["rooms"]) < set(house)
    assert "Cameras" in house
    for room in told["rooms"]:
        assert f"{room} Architecture" in house[room]
    assert told["camera"]


def test_a_new_house_takes_the_place_of_the_old_one(told: dict[str, Any]) -> None:
    assert told["same_number_of_objects"]


def test_a_finding_selects_the_culprit(told: dict[str, Any]) -> None:
    assert told["selected"]
    assert all("/Bedroom_0/Furniture/Bed_0" in path for path in told["selected"])


def test_edits_are_an_override_layer_that_comes_back(told: dict[str, Any]) -> None:
    """Read by USD itself, and by Blender when it opens the house again."""
    moved, matrix = told["moved"]
    assert told["saved"] == ["FINISHED"]
    house = Path(told["house"])
    stage = Usd.Stage.Open(str(house.with_name("house.edits.usda")))
    place = UsdGeom.Xformable(stage.GetPrimAtPath(moved)).ComputeLocalToWorldTransform(0)
    assert np.allclose(np.array(place).T, matrix, atol=1e-5)
    assert not stage.GetPrimAtPath(told["removed"]).IsActive()
    assert Usd.Stage.Open(str(house)).GetPrimAtPath(told["removed"]).IsActive()
    pieces, matrix_again = told["again"]
    assert pieces == [path for path in told["pieces"] if path != told["removed"]]
    assert np.allclose(matrix_again, matrix, atol=1e-5)


@pytest.mark.parametrize(
    ("state", "has", "has_not"),
    [
        ("empty", "chord.generate", "chord.regenerate"),
        ("failed", "chord.generate", "chord.cancel"),
        ("done", "chord.regenerate", "chord.cancel"),
        ("running", "chord.cancel", "never"),
    ],
)
def test_the_panel_draws_every_state(
    told: dict[str, Any], state: str, has: str, has_not: str
) -> None:
    operators = [line[1] for line in told[state] if line[0] == "operator"]
    assert has in operators
    assert has_not not in operators


def test_nothing_is_left_when_it_is_disabled(told: dict[str, Any]) -> None:
    assert told["left"] == []
    assert not told["field_left"]
