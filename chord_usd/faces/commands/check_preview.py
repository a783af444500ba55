"""What a check found, drawn on the house from above."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from chord_usd.base.runtime.files import deliver

if TYPE_CHECKING:
    from chord_usd.base.metrics.design import Finding, Judged
    from chord_usd.base.scene.types import SceneGraph
    from chord_usd.line.image.preview_marks import Mark
    from chord_usd.line.stage.check.check_stage import Report

MOST_MARKS = 60
"""More do not fit beside a picture."""


def draw_report(stage: Path, report: Report, target: Path) -> None:
    """Write a PNG of the storeys side by side with the faults, flaws and planning findings of a
    report. Raises StageError for a stage without rooms that can be read."""
    from chord_usd.line.image.preview import draw_storeys
    from chord_usd.line.stage.export.exchange.built_house import read_built

    houses = read_built(stage)
    seen = [house.scene.entered_graph for house in houses]
    with deliver() as delivery:
        draw_storeys(
            [house.drawn_graph for house in houses],
            delivery.place(target),
            [marks_of(report, graph, seen) for graph in seen],
        )


def worst_of(judged: Judged) -> list[Finding]:
    """Of each rule the finding that misses its number most."""
    worst: dict[str, Finding] = {}
    for finding in judged.findings:
        if finding.rule not in worst or finding.missed > worst[finding.rule].missed:
            worst[finding.rule] = finding
    return list(worst.values())


def marks_of(report: Report, graph: SceneGraph, storeys: Sequence[SceneGraph]) -> list[Mark]:
    """Marks for one of the storeys; what concerns the whole home is marked on the first."""
    from chord_usd.line.image.preview_marks import Mark

    is_first = graph is storeys[0]
    rooms = {room.id for room in graph.rooms}
    lines = [(line, True) for line in report.faults] + [(line, False) for line in report.flaws]
    marks = [
        Mark(_shortened(line), at, is_fault)
        for line, is_fault in lines
        if (at := place_of(line, graph))
        or (is_first and not any(place_of(line, g) for g in storeys))
    ]
    for judged in (*report.design.rooms, report.design.home):
        path = judged.place
        if path not in rooms and not (is_first and not path):
            continue
        room = path.rsplit("/", 1)[-1] if path else "home"
        marks += [
            Mark(f"{room}: {finding.said} ({finding.source})",
                 finding.at if path or finding.items else None)
            for finding in worst_of(judged)
        ]  # fmt: skip
    return marks[:MOST_MARKS]


def place_of(line: str, graph: SceneGraph) -> tuple[float, float] | None:
    """Place of the prim that a line of a report begins with; None for one of no part of a graph."""
    from chord_usd.base.scene.geometry import room_polygon

    path = line.split(" ", 1)[0].rstrip(":")
    boxes = {item.id: item.box for item in (*graph.items, *graph.dressing)}
    boxes |= {opening.id: opening.box for opening in graph.openings}
    for thing, box in boxes.items():
        if f"{path}/".startswith(f"{thing}/"):
            x, y = box.center_m[:2]
            return float(x), float(y)
    for room in graph.rooms:
        if f"{path}/".startswith(f"{room.id}/"):
            point = room_polygon(room).representative_point()
            return float(point.x), float(point.y)
    return None


def _shortened(line: str) -> str:
    """A line with names in place of prim paths."""
    return " ".join(
        "/".join(word.split("/")[-3:]) if word.startswith("/House/") else word
        for word in line.split(" ")
    )
