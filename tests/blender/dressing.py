"""A dressed house: what rests on a piece goes with it; dressing is listed, locked and deleted."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from in_blender import Scenario

s = Scenario()
bpy, told, own = s.bpy, s.told, s.own

house = Path(sys.argv[4])
told["open"] = s.press("open_house", filepath=str(house))
s.choose_room("Bedroom_0")
told["tree"] = s.tree(bpy.context.scene.collection)
told["drawn"] = s.drawn()
told["names"] = sorted(item.name for item in s.objects().values())
suns = [light for light in bpy.data.lights if light.type == "SUN"]
told["suns"] = [sun.energy for sun in suns]
told["untouched"] = s.start("save_edits") or sorted(p.name for p in house.parent.glob("*.edits.*"))
room = "/House/Rooms/Bedroom_0"
table, bowl, picture = (
    f"{room}/{path}"
    for path in ("Furniture/BedsideTable_0", "Dressing/Bowl_0", "Dressing/Picture_0")
)
told["densities"] = [s.objects()[path].get("chord:kg_per_m3") for path in (bowl, picture)]
before = s.places()
s.objects()[table].location.x += 0.25
bpy.context.view_layer.update()
told["before"], told["after"] = before[bowl], s.places()[bowl]
told["still"] = s.places()[picture] == before[picture]
s.start("save_edits")
read = s.part("core.layer").read_changes
told["moved"] = sorted(read(house).pieces)
told["reopened"] = s.press("open_house", filepath=str(house))
told["again"] = s.places()[bowl]
s.start("lock_piece", path=bowl)
s.start("save_edits")
told["locked"] = list(read(house).locked)
s.start("lock_piece", path=table)
s.start("save_edits")
told["unlocked"] = list(read(house).locked)
told["found"] = s.press("find_models", path=picture)
told["offered"] = len(s.part("core.swaps").candidates(s.part("properties").parsed(own.swap_models)))
told["swapped"] = s.press("swap", index=1)
told["swaps"] = sorted(read(house).swaps)
told["edits"] = s.part("core.layer").edits_file(house).read_text(encoding="utf-8")
s.start("delete_piece", path=table)
s.start("save_edits")
told["gone"] = sorted(path for path, edit in read(house).pieces.items() if edit.matrix is None)
s.disable()
s.tell()
