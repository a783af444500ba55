"""Counterfactual twins: a house and edits of it, each with one fault and its place.

A judge of houses has to rate the two differently; where it does not, it is blind to the fault.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from chord_usd.base.metrics.complete import homely_rooms
from chord_usd.base.metrics.design import design_of
from chord_usd.base.metrics.violations import violations
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.scene.chord_json import write_scene
from chord_usd.base.scene.types import Box, Item, SceneGraph
from chord_usd.workshop.data.twin_faults import KINDS, FaultKind

MANIFEST = "twins.jsonl"
_TRIES = 40
"""Edits of a kind that are looked at before the house has none of it."""
_NEAR_M = 1.0
"""A finding so near to a fault is about it."""


@dataclass(frozen=True)
class Twin:
    """A house with one fault."""

    kind: FaultKind
    graph: SceneGraph
    before: Item
    after: Item
    other: str
    """Id of the piece, opening or room that the fault is about, too."""


def twins_of(
    graph: SceneGraph, rng: np.random.Generator, kinds: Sequence[FaultKind] = KINDS
) -> Iterator[Twin]:
    """A twin of each kind that the house has a place for. Nothing but the fault's piece moves.

    The same rng gives the same twins.
    """
    for kind in kinds:
        for nth, (item, box, other) in enumerate(kind.search(graph, rng)):
            if nth == _TRIES:
                break
            if box != item.box:
                after = replace(item, box=box)
                yield Twin(kind, _with(graph, after), item, after, other)
                break


def _with(graph: SceneGraph, after: Item) -> SceneGraph:
    def put(items: tuple[Item, ...]) -> tuple[Item, ...]:
        return tuple(after if item.id == after.id else item for item in items)

    return replace(graph, items=put(graph.items), dressing=put(graph.dressing))


# --- judges ----------------------------------------------------------------------------------

Findings = Mapping[str, Sequence[tuple[tuple[str, ...], tuple[float, float] | None]]]
"""By judge: the ids of what each finding is about, and where."""


def findings_of(graph: SceneGraph) -> Findings:
    """What the planning table and the list of faults find in a house."""
    homely = homely_rooms(graph)
    design = design_of([graph], homely)
    every = [finding for judged in (*design.rooms, design.home) for finding in judged.findings]
    return {
        "planning table": [((f.rule, *f.items), f.at) for f in every],
        "faults on the floor": [
            ((v.kind, v.item, v.other), None) for v in violations(graph, homely=homely)
        ],
    }


def found_by(sound: Findings, twin: Twin) -> dict[str, dict[str, bool]]:
    """Whether each judge finds more in the twin, and finds it at the fault: a new finding that
    names the piece or lies within 1 m of it."""
    after = findings_of(twin.graph)
    x, y = twin.after.box.center_m[:2]
    verdicts = {}
    for judge, rows in after.items():
        known = {ids for ids, _ in sound[judge]}
        new = [(ids, at) for ids, at in rows if ids not in known]
        there = any(
            twin.after.id in ids or (at is not None and np.hypot(at[0] - x, at[1] - y) <= _NEAR_M)
            for ids, at in new
        )
        verdicts[judge] = {"found": bool(new), "at_its_place": bool(there)}
    return verdicts


# --- files -----------------------------------------------------------------------------------


def write_twins(
    name: str, graph: SceneGraph, stage: str, folder: Path, seed: Sequence[int]
) -> list[dict[str, Any]]:
    """Writes a house and its twins; returns a row of the manifest for each pair.

    stage: of the house, as seen from where the pairs will lie in the end, where ids are paths of
    prims: each twin gets a layer over it, too. Empty for a house without.
    """
    write_scene(graph, folder / f"{name}.json")
    sound, rows = findings_of(graph), []
    for twin in twins_of(graph, np.random.default_rng(seed)):
        stem = f"{name}_{twin.kind.name.replace(' ', '_')}"
        write_scene(twin.graph, folder / f"{stem}.json")
        files = {"house": f"{name}.json", "twin": f"{stem}.json"}
        if stage:
            layer = folder / f"{stem}.usda"
            write_atomic(layer, override(twin, stage))
            files |= {"stage": stage, "twin_stage": layer.name}
        rows.append({**files, **_row(twin), "found_by": found_by(sound, twin)})
    return rows


def _row(twin: Twin) -> dict[str, Any]:
    def placed(box: Box) -> dict[str, Any]:
        return {"at_m": [round(v, 4) for v in box.center_m], "yaw_deg": round(box.yaw_deg, 2)}

    return {
        "fault": twin.kind.name, "named_by_a_rule": twin.kind.is_named, "why": twin.kind.why,
        "source": twin.kind.source, "room": twin.after.room_id, "piece": twin.after.id,
        "category": twin.after.category, "with": twin.other, "before": placed(twin.before.box),
        "after": placed(twin.after.box),
    }  # fmt: skip


def override(twin: Twin, stage: str) -> str:
    """A layer over the house's stage that moves one prim: its place and turn, in its room's frame,
    which is the house's."""
    names = twin.after.id.strip("/").split("/")
    x, y, z = twin.after.box.center_m
    was = twin.before.box.yaw_deg
    turn = twin.after.box.yaw_deg
    lines = ["#usda 1.0", "(", '    defaultPrim = "House"', f"    subLayers = [@{stage}@]",
             "    metersPerUnit = 1", '    upAxis = "Z"', ")", ""]  # fmt: skip
    for depth, prim in enumerate(names):
        lines += [f'{"    " * depth}over "{prim}"', f"{'    ' * depth}{{"]
    inner = "    " * len(names)
    lines.append(f"{inner}double3 xformOp:translate = ({x:.6f}, {y:.6f}, {z:.6f})")
    if turn != was:
        lines.append(f"{inner}double xformOp:rotateZ = {turn:.6f}")
    lines += ["    " * depth + "}" for depth in reversed(range(len(names)))]
    return "\n".join(lines) + "\n"


def write_manifest(rows: Sequence[Mapping[str, Any]], folder: Path) -> None:
    """twins.jsonl, a pair a line."""
    text = "".join(json.dumps(row, ensure_ascii=False) + "\n" for row in rows)
    write_atomic(folder / MANIFEST, text)


def shares(rows: Sequence[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """By kind of fault and judge: pairs, and how many were found, at their place."""
    table = []
    for kind in KINDS:
        held = [row for row in rows if row["fault"] == kind.name]
        for judge in held[0]["found_by"] if held else ():
            verdicts = [row["found_by"][judge] for row in held]
            table.append({
                "fault": kind.name, "named_by_a_rule": kind.is_named, "judge": judge,
                "pairs": len(held), "found": sum(v["found"] for v in verdicts),
                "at_its_place": sum(v["at_its_place"] for v in verdicts),
            })  # fmt: skip
    return table
