"""What an artist does to the tree itself: copies, names, collections, parents."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from in_blender import Scenario

s = Scenario()
bpy, told, own = s.bpy, s.told, s.own
house = Path(sys.argv[4])
room = "/House/Rooms/Bedroom_0/Furniture"
bed, cabinet, table = (f"{room}/{name}" for name in ("Bed_0", "Cabinet_0", "BedsideTable_0"))


def saved() -> list[str]:
    """Which pieces are edits."""
    s.start("save_edits")
    return sorted(s.part("core.layer").read_changes(house).pieces)


told["open"] = s.press("open_house", filepath=str(house))
objects = s.objects()
told["objects"] = len(objects)

# A copy takes the name of its original, and stands elsewhere.
original, name = objects[bed], objects[bed].name
copy = original.copy()
copy.location.x += 3.0
bpy.context.scene.collection.objects.link(copy)
original.name, copy.name = "Zz the bed of the guests", name
told["copied"] = saved()
original.location.x += 0.25
told["renamed"] = saved()
told["bed_x"] = s.places()[bed][0][3]

# The house is put into another collection, and a piece into yet another.
scene, root = bpy.context.scene.collection, bpy.data.collections["House"]
project, mine = (bpy.data.collections.new(name) for name in ("Project", "Mine"))
scene.children.link(project)
scene.children.unlink(root)
project.children.link(root)
furniture = objects[cabinet].users_collection[0]
furniture.objects.unlink(objects[cabinet])
project.objects.link(objects[cabinet])
objects[cabinet].location.y += 0.2
told["elsewhere"] = saved()
s.choose_room("Bedroom_0")
own.solo = True
layers = bpy.context.view_layer.layer_collection.children["Project"].children["House"].children
told["solo"] = [layer.name for layer in layers if not layer.hide_viewport]
own.solo = False

# A piece hangs on something of the artist's, which moves it.
handle = bpy.data.objects.new("Handle", None)
project.objects.link(handle)
bpy.context.view_layer.update()
world = objects[table].matrix_world.copy()
objects[table].parent = handle
objects[table].matrix_world = world
told["hung"] = saved()
handle.location.x += 0.5
told["pulled"] = saved()
told["table"] = s.places()[table]

# Things of the artist's in the collections of the house, and some that nothing uses yet.
chair = bpy.data.objects.new("My chair", None)
furniture.children.link(mine)
mine.objects.link(chair)
bpy.data.materials.new("My varnish").use_fake_user = False
told["reopen"] = s.press("open_house", filepath=str(house))
told["after"] = len(s.objects())
told["all"] = len(
    [one for one in bpy.context.scene.objects if one.name.split()[-1].startswith("Cabinet_0")]
)
told["cabinets"] = sum(path.endswith("/Cabinet_0") for path in s.objects())
told["stays"] = sorted(
    one.name for one in bpy.context.scene.objects if one.name in ("My chair", "Handle", name)
)
told["copy_shows"] = bool(copy.instance_collection.all_objects)
told["varnish"] = "My varnish" in bpy.data.materials
told["again"] = s.places()[bed][0][3], s.places()[table]
told["collections"] = [mine.name in scene.children, "House" in scene.children]

# A layer of somebody else's is not replaced.
layer = s.part("core.layer").edits_file(house)
layer.write_text("#usda 1.0", encoding="utf-8")
told["foreign"] = s.start("save_edits")
told["foreign_kept"] = layer.read_text(encoding="utf-8")
layer.unlink()
s.disable()
s.tell()
