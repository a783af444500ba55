"""A house of two storeys in Blender: shown up to one of them, its rooms known by their paths."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from in_blender import Scenario

s = Scenario()
bpy, told = s.bpy, s.told
told["opened"] = s.press("open_house", filepath=sys.argv[4])
house = bpy.data.collections["House"]
told["tree"] = s.tree(house)
told["rooms"] = [room.name for room in s.own.rooms]
told["drawn"] = [line for line in s.drawn() if "storey" in line]


def hidden() -> list[str]:
    """Storeys of which nothing is seen."""
    bpy.context.view_layer.update()
    storey_of = s.part("core.tree").storey_of
    seen = {storey_of(path) for path, item in s.objects().items() if item.visible_get()}
    return sorted({"Storey_0", "Storey_1"} - seen)


for storey in (0, 1, 2):
    s.own.storey = storey
    told[f"hidden_{storey}"] = hidden()
told["roof_drawn"] = [line for line in s.drawn() if "show_roof" in line]


def roof() -> bool:
    """Whether something of the roof is seen."""
    bpy.context.view_layer.update()
    return any(one.visible_get() for path, one in s.objects().items() if "/Roof/" in path)


s.own.storey = 0
told["roof"] = [roof()]
for s.own.show_roof, s.own.storey in ((True, 0), (True, 1), (True, 2), (False, 0)):
    told["roof"].append(roof())
s.choose_room("Corridor_1")
told["path"] = s.part("house").chosen_path(bpy.context)
s.disable()
s.tell()
