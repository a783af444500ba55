"""Scores of the detector: its networks by themselves, and the whole step from picture to graph."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from chord_usd.base.metrics.detection import edge_errors_m
from chord_usd.base.metrics.fidelity import MAX_TURN_DEG, match_items, room_iou
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.types import Item, Plan
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.graph.detect import ItemDetector, RoomSegmenter
from chord_usd.line.graph.extract import extract_graph
from chord_usd.workshop.data.splits import split_hash
from chord_usd.workshop.evaluation.detector_cases import Case
from chord_usd.workshop.evaluation.detector_networks import (
    NetworkScores,
    score_item_detector,
    score_room_segmenter,
)


@dataclass(frozen=True)
class StepScores:
    """Layout raster -> scene graph, against the truth."""

    recall: float
    """Share of true items found: same category, footprints that overlap by half."""
    precision: float
    """Share of found items that are true."""
    orientation: float
    """Share of the items found whose front is within 10 degrees of the truth."""
    edge_px: float
    """Median distance of an edge from where it should be."""
    edges_within_1px: float
    truths: int
    found: int
    room_iou: float | None = None
    """Mean over true rooms of the overlap with the room read; None where plans are given."""
    room_kinds: float | None = None
    """Share of those rooms that have the right kind."""


@dataclass(frozen=True)
class DetectorScores:
    """One column of the table: all scores on one set of layouts."""

    layouts: int
    split: str
    """Hash of the names of these layouts."""
    items: NetworkScores
    rooms: NetworkScores | None
    """None where no plan is known or no segmenter is there."""
    with_plan: StepScores | None
    """The step as `generate` takes it, the plan known."""
    alone: StepScores
    """The step as `graph` takes it: rooms are read from the picture, too."""


def score_detector(
    cases: Sequence[Case],
    detector: ItemDetector,
    segmenter: RoomSegmenter | None,
    progress: Progress | None = None,
) -> DetectorScores:
    """All scores on these layouts. Raises SceneError where a layout has no room."""
    planned = [case for case in cases if case.plan]
    rooms = score_room_segmenter(planned, segmenter) if planned and segmenter else None
    tally = _Tally(detector, segmenter)
    for index, case in enumerate(cases):
        tally.add(case)
        if progress:
            progress(index + 1, len(cases))
    return DetectorScores(
        layouts=len(cases),
        split=split_hash(case.name for case in cases),
        items=score_item_detector(cases, detector),
        rooms=rooms,
        with_plan=tally.with_plan.scores() if planned else None,
        alone=tally.alone.scores(),
    )


class StepSums:
    """What adds up to StepScores."""

    def __init__(self) -> None:
        self.truths = self.found = self.right = self.turned_right = 0
        self.edges_px: list[float] = []
        self.room_ious: list[float] = []
        self.room_kinds: list[bool] = []

    def add(self, items: Sequence[Item], truth: Sequence[Item], m_per_px: float) -> None:
        """What was read in one layout, and what is in it."""
        pairs = match_items(items, truth)
        self.truths += len(truth)
        self.found += len(items)
        self.right += len(pairs)
        for mine, true in pairs:
            off = abs(wrap_deg(mine.box.yaw_deg - true.box.yaw_deg))
            self.turned_right += off <= MAX_TURN_DEG
            self.edges_px += (edge_errors_m(mine.box, true.box) / m_per_px).tolist()

    def scores(self) -> StepScores:
        """Of all that was added."""
        edges = np.array(self.edges_px)
        return StepScores(
            recall=self.right / max(self.truths, 1),
            precision=self.right / max(self.found, 1),
            orientation=self.turned_right / max(self.right, 1),
            edge_px=float(np.median(edges)) if len(edges) else 0.0,
            edges_within_1px=float((edges <= 1.0).mean()) if len(edges) else 0.0,
            truths=self.truths,
            found=self.found,
            room_iou=float(np.mean(self.room_ious)) if self.room_ious else None,
            room_kinds=float(np.mean(self.room_kinds)) if self.room_kinds else None,
        )


class _Tally:
    """Reads layouts with and without their plan."""

    def __init__(self, detector: ItemDetector, segmenter: RoomSegmenter | None) -> None:
        self.detector, self.segmenter = detector, segmenter
        self.with_plan, self.alone = StepSums(), StepSums()

    def add(self, case: Case) -> None:
        m_per_px = case.layout.frame.m_per_px
        graph = extract_graph(case.layout, None, self.detector, self.segmenter)
        self.alone.add(graph.items, case.items, m_per_px)
        if case.plan:
            self.alone.room_ious.append(room_iou(graph.plan, case.plan))
            self.alone.room_kinds += _kinds_right(graph.plan, case.plan)
            graph = extract_graph(case.layout, case.plan, self.detector, self.segmenter)
            self.with_plan.add(graph.items, case.items, m_per_px)


def _kinds_right(plan: Plan, truth: Plan) -> list[bool]:
    """For each true room of known kind, whether the room read at its place has that kind."""
    from chord_usd.base.scene.geometry import room_polygon

    floors = [(room.kind, room_polygon(room)) for room in plan.rooms]
    results = []
    for room in truth.rooms:
        if room.kind == "unknown":
            continue
        mine = room_polygon(room)
        kind, _ = max(floors, key=lambda floor: floor[1].intersection(mine).area)
        results.append(kind == room.kind)
    return results


ROWS: tuple[tuple[str, Callable[[DetectorScores], float | None]], ...] = (
    ("items network alone, mAP50", lambda s: s.items.map50),
    ("rooms network alone, mAP50", lambda s: s.rooms.map50 if s.rooms else None),
    ("graph, plan known: recall", lambda s: s.with_plan.recall if s.with_plan else None),
    ("precision", lambda s: s.with_plan.precision if s.with_plan else None),
    ("fronts right", lambda s: s.with_plan.orientation if s.with_plan else None),
    ("edges, median px", lambda s: s.with_plan.edge_px if s.with_plan else None),
    ("edges within 1 px", lambda s: s.with_plan.edges_within_1px if s.with_plan else None),
    ("graph, picture alone: recall", lambda s: s.alone.recall),
    ("precision", lambda s: s.alone.precision),
    ("fronts right", lambda s: s.alone.orientation),
    ("edges, median px", lambda s: s.alone.edge_px),
    ("edges within 1 px", lambda s: s.alone.edges_within_1px),
    ("room IoU", lambda s: s.alone.room_iou),
    ("room kinds right", lambda s: s.alone.room_kinds),
)


def as_markdown(columns: dict[str, DetectorScores]) -> str:
    """The table that goes into the model card. columns: scores by the name of the layouts."""
    heads = [
        f"{name}: {s.layouts} layouts, {s.items.truths} items, split {s.split}"
        for name, s in columns.items()
    ]
    lines = ["| | " + " | ".join(heads) + " |", "|---|" + "---|" * len(heads)]
    for name, value in ROWS:
        cells = [_text(value(scores)) for scores in columns.values()]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _text(value: float | None) -> str:
    return "" if value is None else f"{value:.4f}"
