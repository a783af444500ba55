"""The model card that lies beside a detector's weights."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from chord_usd.base.runtime.files import write_atomic
from chord_usd.line.graph.detect import IMAGE_PX, LEAST_SIDE_PX, Kind
from chord_usd.workshop.training.yolo import ARCHITECTURES

CARD_FILE = "README.md"
SHEET_FILE = "sheet.jpg"
"""What the network proposes for held-out layouts; `evaluate detector --sheet` draws it."""

_GOOD = 0.99

_TASKS: dict[Kind, str] = {
    "items": "oriented boxes of the house categories in layout rasters",
    "rooms": "masks and kinds of the rooms in plan and layout rasters, shaded or white",
}
_CONVENTIONS: dict[Kind, str] = {
    "items": f"Boxes are {LEAST_SIDE_PX:g} pixels long and wide at least, in training and in the "
    "scores: a box must hold a point of\nthe output grid, which has one every 8 pixels. What is "
    "thinner gets its true edges from its pixels.",
    "rooms": f"The raster is looked at {IMAGE_PX['rooms']} pixels wide. The network only names "
    "rooms: their outlines are read from the walls.",
}


def write_card(
    kind: Kind, folder: Path, facts: Mapping[str, Any], scores: Mapping[str, Any]
) -> None:
    """Write the card into folder.

    facts: the summary of training. scores: map50, by_class, truths, layouts, split.
    """
    start = facts.get("start")
    origin = f"started from the weights of `{start}`" if start else "trained from scratch"
    lines = [
        f"# detector_{kind}",
        "",
        f"Finds {_TASKS[kind]}.",
        f"ultralytics `{ARCHITECTURES[kind]}`, {origin}; weights in",
        "`weights.safetensors` (fp16), classes in `config.json`.",
        "",
        _CONVENTIONS[kind],
        "",
        "| | |",
        "|---|---|",
        "| data | procedural houses of this package, drawn as they were needed, each shown in "
        "several views; edges frayed, marks lost, colours drifted, houses turned, rooms shaded "
        "or white |",
        f"| generated | {facts.get('generated', 0)} layouts that the layout model painted, every "
        "second sample; the truth is what their colours say |",
        "| split | scored on test houses (`chord_usd.workshop.data.splits`), hash "
        f"`{scores['split']}`; none of them was trained on |",
        f"| images seen | {facts['images']:,} |",
        f"| time | {facts['minutes']} minutes on {facts['device']}, {facts['threads']} thread(s) |",
        f"| mAP50 | {scores['map50']:.3f} over {scores['truths']:,} {kind} in "
        f"{scores['layouts']} clean layouts of test houses, half of them unshaded |",
        "| licence | AGPL-3.0-or-later, as ultralytics and this package |",
        "",
        "Average precision at an overlap of one half, by class: "
        f"{_weak_classes(scores['by_class'])}.",
        "",
        *_sheet(folder),
        f"Made by `chord-usd train detector --kind {kind}`; `chord-usd evaluate detector` scores "
        "it again.",
        "",
    ]
    write_atomic(folder / CARD_FILE, "\n".join(lines))


def _weak_classes(by_class: Mapping[str, float]) -> str:
    """The classes that are found less well; a table of all would fill the page."""
    weak = {name: value for name, value in by_class.items() if value < _GOOD}
    named = ", ".join(f"{name} {value:.3f}" for name, value in sorted(weak.items()))
    return f"{named + '; ' if weak else ''}{'all others' if weak else 'all'} {_GOOD} or more"


def _sheet(folder: Path) -> list[str]:
    """The lines that show the sheet, where there is one."""
    if not (folder / SHEET_FILE).is_file():
        return []
    return [f"![What it proposes for held-out layouts, drawn and generated]({SHEET_FILE})", ""]
