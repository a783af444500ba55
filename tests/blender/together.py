"""Two Blenders at once: one has the house, until it ends; the other is told, and waits."""

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from in_blender import Scenario

s = Scenario()
role, house, meeting = sys.argv[4], Path(sys.argv[5]), Path(sys.argv[6])
LATEST_S = 200.0


def meet(name: str) -> None:
    """Wait until the other says that it is so far."""
    began = time.monotonic()
    while not (meeting / name).exists():
        assert time.monotonic() - began < LATEST_S, f"nobody said {name}"
        time.sleep(0.05)


if role == "first":
    s.told["open"] = s.press("open_house", filepath=str(house))
    (meeting / "opened").touch()
    meet("tried")
    s.told["save"] = s.start("save_edits")
else:
    meet("opened")
    s.told["refused"] = s.press("open_house", filepath=str(house))
    s.told["empty"] = not s.objects()
    (meeting / "tried").touch()
    meet("ended")
    s.told["open"] = s.press("open_house", filepath=str(house))
s.disable()
s.tell()
