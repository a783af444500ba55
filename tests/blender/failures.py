"""Everything that can be wrong: said in plain words, and nothing broken afterwards."""

import os
import signal
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from in_blender import Scenario

s = Scenario()
bpy, told, own = s.bpy, s.told, s.own
plan, programs = Path(sys.argv[4]), Path(sys.argv[5])
session = s.part("session").session

told["no_plan"] = s.press("generate")
own.plan = str(plan)
for name in ("nowhere", "old", "wrong", "broken"):
    s.use(str(programs / name))
    told[name] = s.press("generate")
    told[f"{name}_drawn"] = s.drawn()
s.start("check_program")
told["checked_broken"] = s.answer()
path, os.environ["PATH"] = os.environ["PATH"], ""
os.environ["HOME"] = str(s.folder)
s.use("")
told["none"] = s.press("generate")
os.environ["PATH"] = path

s.use(str(programs / "good"))
told["check_program"] = [*bpy.ops.chord.check_program(), s.answer()]
told["offered"] = s.drawn()
told["error"] = s.press("generate")
told["running"] = []
s.use(str(programs / "endless"))
s.start("generate")
told["running"] = s.drawn()
told["second_job"] = s.start("check_house")
while session.job.progress is None:
    session.step(bpy.context)
    time.sleep(0.02)
os.killpg(session.job._process.pid, signal.SIGKILL)
told["killed"] = s.wait()
s.start("generate")
bpy.ops.chord.cancel()
told["cancelled"] = s.wait()
s.use(str(programs / "good"))
told["left_by_failures"] = s.houses()
told["still"] = [room.name for room in own.rooms]
told["after_failures"] = s.press("generate")

# A second Blender has the house open.
house = Path(own.house)
claims = s.part("core.claim").Claims()
session.claims.release()
told["claimed"] = claims.take(house.parent)
told["two"] = [
    s.press("save_edits"),
    s.press("regenerate"),
    s.press("open_house", filepath=str(house)),
]
told["other_folder"] = s.press("generate")
told["folders"] = [house.parent.name, Path(own.house).parent.name]
claims.release()

# What lay on disk is gone.
before, away = s.houses(), plan.with_name("away.png")
s.use(str(s.program))
s.start("generate")
plan.rename(away)
told["plan_gone_meanwhile"] = s.wait()
s.use(str(programs / "good"))
told["plan_gone"] = s.press("generate")
told["left_by_gone_plan"] = sorted({*s.houses()} - {*before})
away.rename(plan)
assert own.house, "else this were the folder that we are in"
made = Path(own.house).parent
made.rename(made.with_name("taken away"))
told["house_gone"] = s.press("check_house")
own.asset_folders = str(s.folder / "no meshes")
told["assets_gone"] = s.press("generate")
own.asset_folders = ""

# A file is opened while a job runs.
before = s.houses()
s.use(str(programs / "endless"))
s.start("generate")
bpy.ops.wm.read_homefile(use_empty=True)
own = s.own
for thread in threading.enumerate():
    if thread is not threading.main_thread() and not thread.daemon:
        thread.join(20.0)
told["left_by_file"] = sorted({*s.houses()} - {*before})
told["left_running"] = session.is_running
told["fresh"] = s.wait()
s.use(str(programs / "good"))

# The furniture becomes a library, and takes nobody's place.
taken = s.folder / "Möbel"
(taken / "models").mkdir(parents=True)
(taken / "models" / "mine.txt").write_text("mine", encoding="utf-8")
own.library_folder = str(taken)
told["library"] = s.press("build_library")
told["library_note"] = own.note
libraries = bpy.context.preferences.filepaths.asset_libraries
told["libraries"] = [[one.name, one.path] for one in libraries]
told["again"] = s.press("build_library")
told["once"] = sum(one.name == "CHOrD furniture" for one in libraries)
told["assets"] = {}
told["mine"] = (taken / "models" / "mine.txt").is_file()
for file in sorted(taken.glob("*/*.blend")):
    with bpy.data.libraries.load(str(file), assets_only=True) as (found, wanted):
        wanted.collections = found.collections
    for collection in wanted.collections:
        data = collection.asset_data
        told["assets"][collection.name] = {
            "catalog": data.catalog_id,
            "licence": data.license,
            "preview": list(collection.preview.image_size),
            "meshes": sum(one.type == "MESH" for one in collection.all_objects),
        }
s.disable()
s.tell()
