"""A program that answers as chord-usd does, and has everything ready. Run by other scripts."""

import json
import os
import shutil
import sys
import time
from pathlib import Path


def main(answer: str, code: int, options: str, models: str, house: str, pause_s: float) -> None:
    """Answer this command line: with a version, with options, or with what is ready.

    pause_s: how long a house takes, once its progress is printed.
    """
    if "--version" in sys.argv:
        sys.stdout.write(f"{answer}\n")
        sys.exit(code)
    if "--help" in sys.argv:
        sys.stdout.write(f"  --seed N  {options}\n")
        sys.exit()
    words = dict(zip(sys.argv, sys.argv[1:], strict=False))
    verb = sys.argv[1]
    if verb == "describe":
        os.execv(sys.executable, [sys.executable, "-m", "chord_usd", *sys.argv[1:]])
    if verb == "regenerate":
        refuse_elephants(sys.argv)
        tell(stage=take_a_cabinet(sys.argv[2]), room=words["--room"])
    if verb == "assets":
        shutil.copytree(models, words["-o"], dirs_exist_ok=True)
        tell(assets=3)
    if verb == "generate":
        text = "".join(word.partition("=")[2] for word in sys.argv if word.startswith("--text="))
        generate(text, Path(words["-o"]), house, pause_s)


def refuse_elephants(words: list[str]) -> None:
    """What the program says of a piece that it does not know."""
    if any("elephant" in word for word in words):
        sys.stderr.write("error: --with: 'elephant' is no piece that is known; expected bed\n")
        sys.exit(2)


def generate(text: str, target: Path, house: str, pause_s: float) -> None:
    """A house that is there already, after a pause."""
    if "elephant" in text:
        sys.stderr.write("error: --text: the text names no rooms; expected rooms, in words\n")
        sys.exit(2)
    planned = {"understood": text.upper(), "rooms": 5, "area_m2": 64.6}
    missed = {"planned": planned, "warnings": ["asked for 2 bedrooms, planned 1"]} if text else {}
    sys.stderr.write(json.dumps({"step": "layout", "done": 1, "total": 4}) + "\n")
    sys.stderr.flush()
    time.sleep(pause_s)
    shutil.copytree(house, target.parent, dirs_exist_ok=True)
    tell(stage=str(target), certificate={"valid": True, "walkable": 0.9}, **missed)


def take_a_cabinet(house: str) -> str:
    """Another room: one piece less."""
    from pxr import Usd

    stage = Usd.Stage.Open(house)
    stage.GetPrimAtPath("/House/Rooms/Bedroom_0/Furniture/Cabinet_0").SetActive(False)
    stage.Save()
    return house


def tell(**report: object) -> None:
    """One JSON object, as --json asks."""
    sys.stdout.write(json.dumps(report) + "\n")
