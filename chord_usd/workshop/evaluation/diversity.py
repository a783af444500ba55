"""How different the layouts of one plan are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
import shapely

from chord_usd.base.metrics.fidelity import MIN_MATCH_IOU, match_items
from chord_usd.base.metrics.footprints import footprints_of
from chord_usd.base.runtime.progress import Progress, Warn
from chord_usd.base.scene.types import ByteArray, Item
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.line.lists.list_sampler import ListDrawer
from chord_usd.workshop.data.splits import split_hash
from chord_usd.workshop.evaluation.cases import Case
from chord_usd.workshop.evaluation.layouts import Furnished, Sampling, made_by, sampled
from chord_usd.workshop.evaluation.report import enlarged, framed, markdown_table

SHEET_PLANS, SHEET_LAYOUTS = 3, 3
"""As in the paper's figure."""

SAME_ROOM_SHARE = 0.8
"""Two furnishings of a room are one arrangement when this share of their items match."""


@dataclass(frozen=True)
class PlanDiversity:
    """How far apart the layouts of one plan are."""

    plan: str
    item_iou: float
    """Mean over pairs of layouts of the overlap of their furniture, category by category, as
    intersection over union; 1 where all are the same."""
    arrangements: float
    """Mean over rooms of the number of different furnishings among the layouts."""
    rooms: int
    """Rooms that any layout furnishes."""


@dataclass(frozen=True)
class DiversityScores:
    """All plans, and what they were sampled with."""

    plans: tuple[PlanDiversity, ...]
    seeds: int
    split: str
    checkpoint: str
    steps: int

    @property
    def item_iou(self) -> float:
        """Mean over plans."""
        return float(np.mean([plan.item_iou for plan in self.plans]))

    @property
    def arrangements(self) -> float:
        """Mean over plans, at most seeds."""
        return float(np.mean([plan.arrangements for plan in self.plans]))


def measure_diversity(
    model: LayoutModel,
    cases: Sequence[Case],
    sampling: Sampling,
    seeds: int = 8,
    lists: ListDrawer | None = None,
    progress: Progress | None = None,
    warn: Warn | None = None,
) -> tuple[DiversityScores, ByteArray]:
    """Samples every plan under seeds in a row; returns the scores and a sheet to look at.

    lists: what the model starts from.
    """
    rows: list[list[Furnished]] = []
    for index, case in enumerate(cases):
        how = replace(sampling, seed=sampling.seed + index * seeds)
        rows.append(list(sampled(model, [case] * seeds, how, lists, warn=warn)))
        if progress:
            progress(index + 1, len(cases))
    scores = DiversityScores(
        plans=tuple(map(diversity_of, rows)),
        seeds=seeds,
        split=split_hash(case.id for case in cases),
        checkpoint=made_by(model, lists),
        steps=sampling.settled(model.config).steps or 0,
    )
    return scores, sheet(rows)


def diversity_of(layouts: Sequence[Furnished]) -> PlanDiversity:
    """How different these layouts of one plan are."""
    scenes = [layout.scene for layout in layouts]
    overlaps = [item_iou(a.items, b.items) for a, b in combinations(scenes, 2)]
    counts = []
    for room in layouts[0].case.plan.rooms:
        furnishings = [list(scene.items_of(room.id)) for scene in scenes]
        if any(furnishings):
            counts.append(arrangements(furnishings))
    return PlanDiversity(
        plan=layouts[0].case.id,
        item_iou=float(np.mean(overlaps)) if overlaps else 1.0,
        arrangements=float(np.mean(counts)) if counts else 0.0,
        rooms=len(counts),
    )


def item_iou(a: Sequence[Item], b: Sequence[Item]) -> float:
    """Area on which both have the same category over area on which either has any, [0, 1].

    Two empty sets are the same: 1.0.
    """
    shared = either = 0.0
    for category in {item.category for item in (*a, *b)}:
        ours, theirs = (
            shapely.union_all(
                footprints_of([item for item in items if item.category == category]).polygons
            )
            for items in (a, b)
        )
        shared += ours.intersection(theirs).area
        either += ours.union(theirs).area
    return shared / either if either else 1.0


def arrangements(furnishings: Sequence[Sequence[Item]]) -> int:
    """How many different ones there are among furnishings of one room.

    One is new when fewer than SAME_ROOM_SHARE of its items and of every known one's match: same
    category, footprints overlapping by MIN_MATCH_IOU.
    """
    known: list[Sequence[Item]] = []
    for items in furnishings:
        if not any(_is_same(items, other) for other in known):
            known.append(items)
    return len(known)


def _is_same(a: Sequence[Item], b: Sequence[Item]) -> bool:
    total = len(a) + len(b)
    return total == 0 or 2 * len(match_items(a, b)) >= SAME_ROOM_SHARE * total


def sheet(rows: Sequence[Sequence[Furnished]], enlarge: int = 2) -> ByteArray:
    """(H, W, 3) pictures: a row per plan, SHEET_LAYOUTS layouts side by side."""
    lines = []
    for row in rows[:SHEET_PLANS]:
        tiles = [framed(enlarged(layout.image.rgb, enlarge)) for layout in row[:SHEET_LAYOUTS]]
        lines.append(np.concatenate(tiles, axis=1))
    # Rasters of large houses are wider.
    width = max(line.shape[1] for line in lines)
    missing = [((0, 0), (0, width - line.shape[1]), (0, 0)) for line in lines]
    padded = [np.pad(*pair, constant_values=255) for pair in zip(lines, missing, strict=True)]
    return np.concatenate(padded)


def as_data(scores: DiversityScores) -> dict[str, Any]:
    """For --json."""
    return {**asdict(scores), "item_iou": scores.item_iou, "arrangements": scores.arrangements}


def as_markdown(scores: DiversityScores) -> str:
    """A row per plan, then the mean."""
    rows = [
        [plan.plan, f"{plan.item_iou:.3f}", f"{plan.arrangements:.2f}", str(plan.rooms)]
        for plan in scores.plans
    ]
    rows.append(["mean", f"{scores.item_iou:.3f}", f"{scores.arrangements:.2f}", ""])
    head = ["plan", "pairwise item IoU", f"arrangements of a room, of {scores.seeds}", "rooms"]
    return (
        f"split {scores.split}, checkpoint {scores.checkpoint}, {scores.steps} steps; "
        f"{scores.seeds} seeds a plan; a room is arranged differently where less than "
        f"{SAME_ROOM_SHARE:.0%} of its items match at IoU {MIN_MATCH_IOU}\n\n"
        + markdown_table(head, rows)
    )
