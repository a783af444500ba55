"""The model card that lies beside a detector's weights."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from chord_usd.graph.detect import ARCHITECTURES, Kind

_TASKS: dict[Kind, str] = {
    "items": "oriented boxes of the 28 house categories in layout rasters",
    "rooms": "masks and kinds of the rooms in plan and layout rasters, shaded or white",
}


def _origin(facts: dict[str, Any]) -> str:
    start = facts.get("start")
    return f"started from the backbone of `{start}`" if start else "trained from scratch"


def write_card(kind: Kind, folder: Path, facts: dict[str, Any]) -> None:
    """Write README.md into folder. facts: as config.json has them."""
    scores = facts["scores"]
    lines = [
        f"# detector_{kind}",
        "",
        f"Finds {_TASKS[kind]}.",
        f"ultralytics `{ARCHITECTURES[kind]}`, {_origin(facts)}; weights in `weights.safetensors`",
        "(fp16), classes in `config.json`.",
        "",
        "| | |",
        "|---|---|",
        "| data | procedural houses of this package, drawn as they were needed; edges frayed, "
        "marks lost, colours drifted, houses turned, rooms shaded or white |",
        f"| split | scored on test houses (`chord_usd.data.splits`), hash `{scores['split']}`; "
        "none of them was trained on |",
        f"| images seen | {facts['images']:,} |",
        f"| time | {facts['minutes']} minutes on {facts['device']}, {facts['threads']} thread(s) |",
        f"| mAP50 | {scores['map50']:.3f} over {scores['truths']:,} {kind} in {scores['houses']} "
        "clean layouts of test houses, half of them unshaded |",
        "| licence | AGPL-3.0-or-later, as ultralytics and this package |",
        "",
        "Average precision at an overlap of one half, by class:",
        "",
        "| class | AP50 |",
        "|---|---|",
        *(f"| {name} | {value:.3f} |" for name, value in scores["by_class"].items()),
        "",
        f"Made by `chord-usd train detector --kind {kind}`.",
        "",
    ]
    (folder / "README.md").write_text("\n".join(lines), encoding="utf-8")
