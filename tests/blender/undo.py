"""Undo brings back the scene, and the house on disk that belongs to it."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from in_blender import Scenario

s = Scenario()
bpy, told = s.bpy, s.told
plan, programs = Path(sys.argv[4]), Path(sys.argv[5])
s.use(str(programs / "good"))
s.own.plan = str(plan)
read_changes = s.part("core.layer").read_changes
room = "/House/Rooms/Bedroom_0/Furniture"
bed, cabinet, table = (f"{room}/{name}" for name in ("Bed_0", "Cabinet_0", "BedsideTable_0"))


def moved(by_m: float) -> None:
    """Move the bed, as one step to undo."""
    s.objects()[bed].location.x += by_m
    bpy.ops.ed.undo_push(message="Move")


# One step back from the first house.
bpy.ops.ed.undo_push(message="Before")
told["first"] = s.press("generate")
first = Path(s.own.house)
bpy.ops.ed.undo()
told["none"] = [s.own.house, len(s.objects()), "House" in bpy.data.collections]
bpy.ops.ed.redo()
told["redone"] = s.own.house == str(first) and bool(s.objects())

# A second house of the same plan is a second house; the edits of the first are there.
moved(0.25)
told["saved"] = s.start("save_edits")
s.objects()[table].location.x += 0.25  # not saved, nor a step to undo
told["second"] = s.press("generate")
second = Path(s.own.house)
told["folders"] = [first.parent.name, second.parent.name]
told["first_edits"] = sorted(read_changes(first).pieces)
bpy.ops.ed.undo()
told["first_again"] = s.own.house == str(first)
moved(0.25)
told["saved_again"] = s.start("save_edits")
told["second_edits"] = sorted(read_changes(second).pieces)

# A room furnished anew, and taken back.
before = first.read_bytes()
s.choose_room("Bedroom_0")
told["regenerated"] = s.press("regenerate")
after = first.read_bytes()
told["furnished_anew"] = before != after and cabinet not in s.objects()
bpy.ops.ed.undo()
told["back_in_scene"] = cabinet in s.objects()
s.objects()[cabinet].location.x += 0.125
bpy.ops.ed.undo_push(message="Move")
told["saved_back"] = s.start("save_edits")
told["back_on_disk"] = first.read_bytes() == before
told["edits_back"] = sorted(read_changes(first).pieces)
bpy.ops.ed.undo()
bpy.ops.ed.redo()

# Something else writes the house.
with first.open("a", encoding="utf-8") as file:
    file.write("# by hand\n")
told["changed_outside"] = [s.start("save_edits"), s.press("check_house")]
told["not_touched"] = first.read_text(encoding="utf-8").endswith("# by hand\n")
told["brought_in"] = s.press("open_house", filepath=str(first)) or s.start("save_edits")

# Taken back while a room is furnished: what was saved for the house stays with it.
moved(0.5)
told["saved_before"] = s.start("save_edits")
kept = read_changes(first).pieces[bed].matrix
bpy.ops.ed.undo_push(message="Before")
s.start("regenerate")
for _ in range(3):
    bpy.ops.ed.undo()
told["shows_another"] = s.objects()[bed].matrix_local[0][3] != kept[0][3]
told["meanwhile"] = s.wait()
told["kept"] = kept, s.part("house").placements(s.objects())[bed]
s.disable()
s.tell()
