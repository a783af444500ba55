"""A house is opened and changed in every way that there is; the changes come back."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from in_blender import Scenario

s = Scenario()
bpy, told, own = s.bpy, s.told, s.own

house = Path(sys.argv[4])
told["empty"] = s.drawn()
told["open"] = s.press("open_house", filepath=str(house))
told["tree"] = s.tree(bpy.context.scene.collection)
layers = bpy.context.view_layer.layer_collection.children
told["shown"] = [layer.name for layer in layers if not layer.exclude]
told["rooms"] = [room.name for room in own.rooms]
laid = {p.split("/Items/")[0] for p in s.objects() if "/Items/" in p}
told["laid"] = {
    room: sorted(p.split("/")[-1] for p in laid if f"/{room}/" in p) for room in told["rooms"]
}
told["camera"] = bpy.context.scene.camera.name
told["done"] = s.drawn()
told["untouched"] = s.start("save_edits") or sorted(p.name for p in house.parent.glob("*.edits.*"))


def reach(path: str) -> list[float]:
    """Lengths of what an instance shows, along its own axes."""
    item = s.objects()[path]
    shown = [o for o in item.instance_collection.all_objects if o.type == "MESH"]
    corners = [o.matrix_world @ s.math.Vector(c) for o in shown for c in o.bound_box]
    scale = item.matrix_world.to_scale()
    return [
        scale[axis] * (max(c[axis] for c in corners) - min(c[axis] for c in corners))
        for axis in range(3)
    ]


# Which pictures: of the chosen room, of another, of all.
room = "Bedroom_0"
s.choose_room(room)
settings = s.part("operators").render_settings
told["pictures"] = [settings(bpy.context).cameras]
own.render_room = told["rooms"][0]
told["pictures"].append(settings(bpy.context).cameras)
own.render_room, own.render_folder = "", str(s.folder / "pictures")
told["no_room"] = s.start("render")
own.all_rooms = True
told["pictures"].append(settings(bpy.context).cameras)
own.all_rooms = False

# Moved, turned, deleted; and moved back.
bed, cabinet = (f"/House/Rooms/{room}/Furniture/{name}" for name in ("Bed_0", "Cabinet_0"))
others = [f"/House/Rooms/{room}/Furniture/BedsideTable_0"]
pieces = s.objects()
before = s.places()
pieces[bed].location.x += 0.25
pieces[bed].rotation_euler.z += 0.5
told["bed"], told["moved"] = bed, s.places()[bed]
told["other"] = others[0]
s.start("delete_piece", path=others[0])
told["saved"] = s.start("save_edits")
told["layer"] = str(s.part("core.layer").edits_file(house))
Path(told["layer"]).with_name("first.usda").write_bytes(Path(told["layer"]).read_bytes())
told["reopened"] = s.press("open_house", filepath=str(house))
told["again"] = s.places()
bed_object = s.objects()[bed]
bed_object.matrix_local = s.math.Matrix(s.part("house").house_placements(bpy.context)[bed])
s.start("save_edits")
told["moved_back"] = sorted(s.part("core.layer").read_changes(house).pieces)

# Locked, lit, with other looks and another model.
s.start("lock_piece", path=cabinet)
own.rooms[own.room_index].light = 2.0
told["looks"] = s.press("shuffle_looks")
told["no_look"] = s.press("choose_look")
told["evening"] = s.press("choose_look", path="/House", variant_set="lighting", variant="evening")
told["light_after"] = own.rooms[own.room_index].light
s.objects()[bed]["chord:edited_by"] = "neighbours parted"
s.objects()[bed]["chord:moved_m"] = 0.04
told["found"] = s.press("find_models", path=bed)
told["swap_drawn"] = s.drawn()
told["offered"] = len(s.part("core.swaps").candidates(s.part("properties").parsed(own.swap_models)))
told["swapped"] = s.press("swap", index=2)
Path(told["layer"]).with_name("all.usda").write_bytes(Path(told["layer"]).read_bytes())
changes = s.part("core.layer").read_changes(house)
told["swap"] = {p: [one.usd, one.size_m] for p, one in changes.swaps.items()}
told["swap_reach"] = reach(bed)
told["locked"] = list(changes.locked)
told["chosen"] = {p: dict(one) for p, one in changes.looks.items()}
bpy.ops.ed.undo()
own = s.own
s.start("save_edits")
told["undone"] = list(s.part("core.layer").read_changes(house).swaps)
told["discarded"] = s.press("discard_edits")
left = s.part("core.layer").read_changes(house)
told["left_after"] = [sorted(left.pieces), sorted(left.looks), list(left.lights)]
told["back"] = others[0] in s.objects()

# An artist's own things outlive the house.
lamp = bpy.data.objects.new("My lamp", None)
bpy.data.collections[room].objects.link(lamp)
ceilings = [one for path, one in s.objects().items() if s.part("core.tree").is_ceiling(path)]
told["ceilings_hidden"] = [one.hide_get() for one in ceilings]
own.hide_ceilings = False
told["ceilings_shown"] = [one.hide_get() for one in ceilings]
own.solo = True
hidden = bpy.context.view_layer.layer_collection.children["House"].children
told["solo"] = [layer.name for layer in hidden if not layer.hide_viewport]
piece = s.objects()[bed]
piece.matrix_local = s.objects()[cabinet].matrix_local.copy()
told["check"] = s.press("check_house")
told["headline"], told["findings"] = own.certificate, len(own.findings)
s.start("show_finding", index=0)
paths = {item: path for path, item in s.objects().items()}
told["selected"] = [paths[item] for item in bpy.context.selected_objects]
told["culprits"] = own.findings[0].paths.splitlines() if own.findings else []
told["reopen"] = s.press("open_house", filepath=str(house))
told["lamp"] = "My lamp" in bpy.context.scene.objects
s.disable()
s.tell()
