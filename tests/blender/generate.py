"""From an example plan to a house, another room, pictures and a farm's job; all by chord-usd."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from in_blender import Scenario

s = Scenario()
bpy, told, own = s.bpy, s.told, s.own
plan = Path(sys.argv[4])

# A Blender file without a name.
own.plan, own.steps, own.tabletop = str(plan), 2, False
told["generated"] = s.press("generate")
told["first"] = own.house
told["tree"] = s.tree(bpy.context.scene.collection)
told["rooms"] = [room.name for room in own.rooms]
told["world"] = bpy.context.scene.world.name
told["camera"] = bpy.context.scene.camera.name
told["units"] = bpy.context.scene.unit_settings.scale_length
told["temporary"] = [line for line in s.drawn() if "temporary" in str(line)]
told["nowhere"] = s.press("render")

# It gets a name, and the house comes with it.
blend = s.folder / "mein häuschen.blend"
bpy.ops.wm.save_as_mainfile(filepath=str(blend))
told["second"] = own.house

# Another living room around a locked piece; an edit of another room stays.
before = s.places()
room = max(own.rooms, key=lambda one: len(s.part("house").pieces_of(bpy.context, one.name))).name
other = next(p for p in before if s.part("core.tree").room_of(p) != room and p.count("/") == 5)
s.objects()[other].location.x += 0.2
told["other"], told["moved"] = other, s.places()[other]
s.choose_room(room)
told["locked"] = next(iter(s.part("house").pieces_of(bpy.context, room)))
told["locked_at"] = before[told["locked"]]
s.start("lock_piece", path=told["locked"])
told["objects"] = len(bpy.data.objects)
told["regenerated"] = s.start("regenerate")
# Blender stays usable meanwhile: what is done goes on.
meanwhile = next(p for p in before if p.count("/") == 5 and f"/{room}/" not in p and p != other)
s.objects()[meanwhile].location.x += 0.1
told["meanwhile"], told["meanwhile_at"] = meanwhile, s.places()[meanwhile]
told["regenerated"] += s.wait()
after = s.places()
told["before"], told["after"], told["room"] = before, after, room
told["other_at"], told["locked_after"] = after[other], after.get(told["locked"])
told["still_locked"] = list(s.part("house").changes_of(bpy.context).locked)

# Taken back, and done again; the stage on disk follows when it is saved.
house = Path(own.house)
anew = house.read_bytes()
bpy.ops.ed.undo()
told["undone"], told["saved_undone"] = s.places(), s.start("save_edits")
told["undone_on_disk"] = house.read_bytes() != anew
bpy.ops.ed.redo()
told["redone"], told["saved_redone"] = s.places(), s.start("save_edits")
told["redone_on_disk"] = house.read_bytes() == anew
own = s.own

# Pictures, here and elsewhere.
size = bpy.context.scene.render
size.resolution_x, size.resolution_y = 64, 36
own.samples, own.passes = 1, {"rgb", "depth"}
told["farm"] = s.press("write_farm_job")
told["farm_note"] = own.note
told["rendered"] = s.press("render")
told["pictures"] = [image.name for image in bpy.data.images]

# The file is opened again, with everything.
bpy.ops.wm.save_mainfile()
bpy.ops.wm.open_mainfile(filepath=str(blend))
own = s.own
told["reopened"] = s.press("check_house")
told["certificate"] = own.certificate
s.disable()
s.tell()
