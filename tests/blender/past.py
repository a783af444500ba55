"""The history of a house, the same as the program's; then every button without arguments."""

import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from in_blender import Scenario

s = Scenario()
bpy, told, own = s.bpy, s.told, s.own
house, programs = Path(sys.argv[4]), Path(sys.argv[5])
bed, cabinet = (f"/House/Rooms/Bedroom_0/Furniture/{name}" for name in ("Bed_0", "Cabinet_0"))
opened = s.part("core.layer").opened_file


def pressed(*names: str) -> dict[str, str]:
    """What each button answers that is given nothing."""
    return {name: s.press(name) for name in names}


def seen() -> list[object]:
    """What the artist sees of the history, and of what it changes."""
    lines = [line.name for line in s.own.past]
    return [lines, s.own.past_index, cabinet in s.objects(), s.places()[bed][0][3]]


every = sorted(set(dir(bpy.ops.chord)) - {"check_program"})
told["every"] = every
# The program of this test would render, and build a library, for minutes.
s.use(str(programs / "good"))
told["nothing_there"] = pressed(*every)
told["came_of_nothing"] = [s.own.house, len(s.objects())]

# Moved by hand, then changed by a sentence: each is a change of the house.
s.use(str(s.program))
told["opened"] = s.press("open_house", filepath=str(house))
s.choose_room("Bedroom_0")
told["none_yet"], told["nothing_to_undo"] = seen(), s.press("undo")
s.objects()[bed].location.x += 0.25
told["saved"] = s.start("save_edits")
told["listed"] = s.press("read_history")
s.own.sentence = "remove the cabinet from bedroom 1"
told["edited"] = s.press("edit_by_words")
told["after"], told["drawn"] = seen(), s.drawn()
told["undo"], told["undone"] = s.press("undo"), seen()
told["again"], told["undone_again"] = s.press("undo"), seen()
told["redo"], told["redone"] = s.press("redo"), seen()
own = s.own
own.past_index = 0
told["go_to"], told["gone_to"] = s.press("go_to"), seen()
line = [sys.executable, "-m", "chord_usd", "history", str(house)]
told["program"] = subprocess.run(line, capture_output=True, text=True, check=True).stdout
own.past.clear()
told["no_choice"] = s.press("go_to")

# Blender's undo shows the scene before it; the house on disk follows when it is saved.
bpy.ops.ed.undo()
told["saved_undone"] = s.start("save_edits")
told["planning"] = s.press("check_house")
told["findings"] = [[one.is_planning, one.name, one.paths] for one in s.own.findings]

# Every button, given nothing, with a house.
s.use(str(programs / "good"))
told["house_there"] = pressed(*[name for name in every if name not in ("build_library", "cancel")])
s.use(str(s.program))
told["opens"] = s.press("open_house", filepath=str(opened(house)))
told["whole"] = len(s.objects())
s.disable()
s.tell()
