"""How rooms keep the planning rules, noted on their groups of furniture.

`chord:design_share` is the share of the rules kept, [0, 1]; `chord:design_findings` holds a line
for each value that misses its number. An edit removes both from the rooms that it changes.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from pxr import Sdf

from chord_usd.base.metrics.design import Judged, design_of
from chord_usd.line.stage.author.furniture import FURNITURE
from chord_usd.line.stage.author.prims import note
from chord_usd.line.stage.author.stage_levels import Level, room_spec

SHARE, FINDINGS = "design_share", "design_findings"


def note_design(layer: Sdf.Layer, levels: Sequence[Level]) -> None:
    """Note the planning rules of each room; an edit of one changes the home's rules, too."""
    design = design_of([level.graph for level in levels])
    paths = {room.room.id: room.path for level in levels for room in level.rooms}
    by_room: dict[str, list[Judged]] = {}
    for judged in design.rooms:
        by_room.setdefault(judged.place, []).append(judged)
    for room_id, judged_as in by_room.items():
        group = layer.GetPrimAtPath(f"{paths[room_id]}/{FURNITURE}")
        if group:
            _note(group, judged_as)


def _note(prim: Sdf.PrimSpec, judged: Sequence[Judged]) -> None:
    weight = sum(each.weight for each in judged)
    if not weight:
        return
    lines = [
        f"{finding.said} ({finding.source}), at {finding.at[0]:.2f}, {finding.at[1]:.2f} m"
        for each in judged
        for finding in each.findings
    ]
    share = sum(each.won for each in judged) / weight
    note(prim, design_share=round(share, 4), design_findings=lines)


def forget_design(layer: Sdf.Layer, rooms: Iterable[str]) -> None:
    """Remove the notes of rooms, by the names of their prims."""
    specs = (room_spec(layer, name) for name in rooms)
    for prim in (spec.nameChildren.get(FURNITURE) for spec in specs if spec):
        for name in (SHARE, FINDINGS):
            if prim and f"chord:{name}" in prim.attributes:
                prim.RemoveProperty(prim.attributes[f"chord:{name}"])


def standard_noted(noted: Mapping[str, Any]) -> str:
    """Names of the standards in the notes of a house; "" for notes of any other form."""
    made = noted.get("provenance")
    text = made.get("configuration", "") if isinstance(made, dict) else ""
    with contextlib.suppress(ValueError, AttributeError):
        standard = json.loads(text).get("standard", "")
        return standard if isinstance(standard, str) else ""
    return ""
