"""A house from a text, or from an open plan: offered, refused, made and told."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from in_blender import Scenario

s = Scenario()
told, own = s.told, s.own
plan, programs, other_house = map(Path, sys.argv[4:7])
session = s.part("session").session
unsaved = s.part("jobs").unsaved_folder()

for name in ("good", "older"):
    s.use(str(programs / name))
    session.program(str(programs / name))
    told[f"{name}_drawn"] = s.drawn()
own.source, own.text = "TEXT", "a flat"
told["older"] = s.press("generate")
told["older_folder"] = (unsaved / "chord-usd").exists()
own.text = ""

s.use(str(programs / "good"))
told["fields"] = {}
for way in ("PLAN", "TEXT", "OUTLINE"):
    own.source = way
    told["fields"][way] = s.drawn()

own.source = "TEXT"
told["wordless"] = s.press("generate")
own.text = "two bedrooms, about 70 m²"
told["text"] = s.press("generate")
told["text_drawn"] = s.drawn()
told["named"] = Path(own.house).parent.name
house = own.house
own.text = "blue elephants"
told["refused"] = s.press("generate")
told["refused_drawn"] = s.drawn()
told["kept"] = own.house == house and bool(s.objects())

s.choose_room("Bedroom_0")
own.wanted, own.unwanted = "an elephant", "sofa"
told["strange"] = s.press("regenerate")
told["strange_drawn"] = s.drawn()
own.wanted = "desk, two chairs"
told["wished"] = s.press("regenerate")

own.source, own.text = "OUTLINE", ""
told["shapeless"] = s.press("generate")
own.outline = str(plan)
s.start("generate")
told["running"] = s.drawn()
told["outline"] = s.wait()
told["outline_drawn"] = s.drawn()
own.text = "two bathrooms"
told["outline_text"] = s.press("generate")
told["outline_text_drawn"] = s.drawn()
s.press("open_house", filepath=str(other_house))
told["opened"] = s.drawn()
s.disable()
s.tell()
