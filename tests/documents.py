"""The documents, the command lines in them, and inputs with which the lines run in a short time."""

from __future__ import annotations

import gzip
import json
import re
import shutil
from pathlib import Path

import cv2
import numpy as np
import trimesh
from PIL import Image

from tests.foreign_records import flat_lines, procthor_house
from tests.verbs import ACTIONS, VERBS

ROOT = Path(__file__).parents[1]
CARDS = sorted((ROOT / "checkpoints").glob("*/README.md"))
DOCUMENTS = [*sorted(ROOT.glob("*.md")), *sorted((ROOT / "docs").glob("*.md")), *CARDS]

ELSEWHERE = ("/shared/", "HEAD:", "--fid")
"""Command lines with these need other machines or files that nobody may fetch here."""

TINY: dict[str, str] = {
    "--batch": "1",
    "--count": "2",
    "--draws": "1",
    "--frames": "2",
    "--generated": "0",
    "--minutes": "0.001",
    "--n": "1",
    "--painters": "1",
    "--per-room": "1",
    "--redraws": "0",
    "--resolution": "32x32",
    "--samples": "4",
    "--score-houses": "1",
    "--steps": "1",
    "--synth": "1",
}
"""Options of budgets, and what they get; the last value of an option counts."""

TINY_OF: dict[str, dict[str, str]] = {
    "evaluate detector": {"--houses": "1"},
    "evaluate diversity": {"--seeds": "2"},
    "evaluate speed": {"--sampler": "ddim"},
    "evaluate tabletops": {"--houses": "1"},
    "farm bundle": {"--samples": "8"},
    "batch": {"--seeds": "1"},
}
"""Budgets of single verbs."""


def fences(text: str) -> list[str]:
    """The insides of fenced blocks."""
    return re.findall(r"^```\w*\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def command_lines(text: str) -> list[str]:
    """Command lines of chord-usd in fenced blocks."""
    return [
        line
        for block in fences(text)
        for line in block.splitlines()
        if line.startswith("chord-usd ")
    ]


def python_blocks(text: str) -> list[str]:
    """The fenced blocks of Python."""
    return re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def verb_of(line: str) -> str | None:
    """The verb that a command line begins with; None for what is no verb."""
    words = line.split()[1:]
    return next((v for v in (" ".join(words[:n]) for n in (2, 1)) if v in VERBS), None)


def with_tiny_budgets(line: str) -> str:
    """The command line with the smallest budgets that its verb has options for."""
    verb = verb_of(line) or ""
    taken = {o for prog, a in ACTIONS if prog == f"chord-usd {verb}" for o in a.option_strings}
    budgets = {option: value for option, value in TINY.items() if option in taken}
    for name in ("--synth", "--generated", "--painters", "--frames"):
        if name not in line.split():
            budgets.pop(name, None)
    budgets |= TINY_OF.get(verb, {})
    return " ".join([line.split(" #")[0].rstrip(), *(f"{o} {v}" for o, v in budgets.items())])


def write_inputs(folder: Path) -> None:
    """What the lines of the documents read, under the names that they use."""
    (folder / "examples").symlink_to(ROOT / "examples")
    for name in ("my_plan.png", "plans/studio.png"):
        (folder / name).parent.mkdir(exist_ok=True)
        shutil.copyfile(ROOT / "examples" / "studio.png", folder / name)
    (folder / "more").mkdir()
    Image.open(folder / "my_plan.png").convert("RGB").save(folder / "more" / "scan.pdf")
    photo = cv2.imread(str(ROOT / "examples" / "studio.png"))
    cv2.imwrite(str(folder / "my_plan.jpg"), photo)
    outline = np.full((256, 256, 3), 255, np.uint8)
    cv2.rectangle(outline, (40, 60), (200, 180), (0, 0, 0), 3)
    cv2.imwrite(str(folder / "open.png"), outline)
    (folder / "models").mkdir()
    trimesh.creation.box((0.5, 0.9, 0.5)).export(folder / "models" / "chair.obj")
    row = {"file": "chair.obj", "category": "chair", "licence": "CC0-1.0", "author": "Jo"}
    (folder / "models" / "manifest.json").write_text(json.dumps([row]))
    (folder / "my_houses").mkdir()
    for number in range(40):  # so that each split has some
        house = ROOT / "tests" / "fixtures" / "furnished_house.json"
        shutil.copyfile(house, folder / "my_houses" / f"house_{number}.json")
    flats = [json.dumps({"id": f"flat/{n}", "lines": flat_lines()}) for n in range(40)]
    (folder / "flats.jsonl").write_text("\n".join(flats) + "\n")
    with gzip.open(folder / "rooms.jsonl.gz", "wt") as file:
        file.write(json.dumps(procthor_house()) + "\n")
