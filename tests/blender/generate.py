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

# What is asked for in words is said first, then done; what was moved by hand there stays so.
stand = {p: p.split("/")[-1] for p in s.places() if "/LivingRoom_0/Furniture/" in p}
stand = {p: name for p, name in stand.items() if p.count("/") == 5}
alone = [
    p for p, name in stand.items() if name.endswith("_0") and f"{name[:-1]}1" not in stand.values()
]
# The coffee table has room around it: a centimetre aside does not bring it into a wall.
beside = next(p for p in alone if "/CoffeeTable_0" in p)
gone = next(p for p in alone if p not in (beside, told["locked"]))
words = s.part("core.report").spaced(stand[gone].removesuffix("_0")).lower()
own.sentence = f"remove the {words} from the living room"
told["read"], told["read_drawn"] = s.press("read_sentence"), s.drawn()
s.objects()[beside].location.x += 0.01
told["beside_at"] = s.places()[beside]
told["said"] = s.press("edit_by_words")
told["still_there"] = gone in s.places()
told["beside_after"] = s.places()[beside]
told["by_hand"] = beside in s.part("house").changes_of(bpy.context).pieces

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
