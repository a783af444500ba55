"""Floors planned from words and in open plans, scored against what was asked for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np
from shapely.geometry.base import BaseGeometry
from shapely.ops import unary_union

from chord_usd.base.metrics.scores import Score, mean_of, share_of
from chord_usd.base.raster import plan_labels
from chord_usd.base.raster.canvas import draw_plan
from chord_usd.base.scene.geometry import is_axis_aligned, room_polygon, wall_area
from chord_usd.base.scene.palette import BACKGROUND_RGB
from chord_usd.base.scene.types import CANVAS_PX, ByteArray, Plan, Room, RoomKind
from chord_usd.base.scene.wish import WISHED_KINDS, Wish
from chord_usd.line.planning.choose import Candidate
from chord_usd.line.planning.outline import open_shell
from chord_usd.workshop.data.descriptions import describe
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED, split_hash
from chord_usd.workshop.data.statistics import total_variation
from chord_usd.workshop.evaluation.report import framed, markdown_table, score_text

DARK_KINDS: tuple[RoomKind, ...] = ("corridor", "store", "bathroom")
"""Rooms that can do without a window."""


@dataclass(frozen=True, eq=False)
class FloorCase:
    """Something to plan, and the house that it was made from."""

    id: str
    text: str
    wish: Wish
    plan: Plan

    @property
    def shell(self) -> Plan:
        """The house without its rooms."""
        return open_shell(self.plan)


@dataclass(frozen=True)
class FloorFacts:
    """What is measured of one planned floor."""

    missed: tuple[RoomKind, ...]
    """Kinds of room whose number is not the one asked for."""
    area_missed: bool
    faults: tuple[str, ...]
    """planning.faults."""
    rooms: int
    lit: tuple[RoomKind, ...]
    """Kinds of the rooms behind the windows of outer walls; "unknown" for a wall."""
    outline_iou: float
    """Of the whole house, with that which the case was made from; [0, 1]."""
    openings_kept: float
    """Share of the shell's openings that are there."""


@dataclass(frozen=True)
class FloorResult:
    """What was planned for a case."""

    chosen: FloorFacts
    """Of the floor that was taken."""
    first: FloorFacts
    """Of the first that was tried."""
    tried: int


Planner = Callable[[FloorCase], tuple[Sequence[Candidate], Candidate]]
"""Plans a case: all floors tried, in order, and the one taken."""


def measure(case: FloorCase, planner: Planner) -> FloorResult:
    """Plan a case and measure what was planned."""
    tried, chosen = planner(case)
    return FloorResult(facts_of(case, chosen), facts_of(case, tried[0]), len(tried))


def facts_of(case: FloorCase, candidate: Candidate) -> FloorFacts:
    """What a floor is like that was planned for a case."""
    iou, kept = _kept(case.shell, candidate.plan)
    return FloorFacts(
        tuple(candidate.missed), candidate.area_missed, candidate.faults, len(candidate.plan.rooms),
        tuple(_lit(candidate.plan)), iou, kept,
    )  # fmt: skip


def held_out_cases(count: int, aligned: bool) -> list[FloorCase]:
    """The first test houses that fit on a sheet, with a text about each.

    aligned: without houses that have slanted walls.
    """
    cases: list[FloorCase] = []
    seed = TEST_SEED
    while len(cases) < count:
        rng = np.random.default_rng(seed)
        plan = random_plan(rng)
        if plan_labels.fitting_scale(plan) and (is_axis_aligned(plan) or not aligned):
            said = describe(plan, rng)
            cases.append(FloorCase(f"house{seed}", said.text, said.wish, plan))
        seed += 1
    return cases


def split_of(cases: Sequence[FloorCase]) -> str:
    """12 hex digits that name this set."""
    return split_hash([case.id for case in cases])


Pairs = Sequence[tuple[FloorCase, FloorFacts]]


def wish_scores(pairs: Pairs) -> dict[str, Score]:
    """How far floors are what texts asked for; all shares are in [0, 1]."""
    asked = [(facts, kind) for case, facts in pairs for kind in case.wish.counts]
    right = sum(kind not in facts.missed for facts, kind in asked)
    sized = [facts for case, facts in pairs if case.wish.area_m2 is not None]
    scores = {
        "room counts": share_of(right, len(asked), "kinds of room asked for"),
        "all counts": share_of(sum(not f.missed for _, f in pairs), len(pairs), "texts"),
        "area within 10 %": share_of(
            sum(not facts.area_missed for facts in sized), len(sized), "texts with an area"
        ),
    }
    for kind in WISHED_KINDS:
        answers = [facts for facts, other in asked if other == kind]
        scores[f"{kind} count"] = share_of(
            sum(kind not in facts.missed for facts in answers),
            len(answers),
            f"texts that name {kind}",
        )
    return scores | sound_scores([facts for _, facts in pairs])


def sound_scores(floors: Sequence[FloorFacts]) -> dict[str, Score]:
    """How many floors are houses."""
    reached = [not any("cannot be reached" in fault for fault in f.faults) for f in floors]
    return {
        "valid": share_of(sum(not floor.faults for floor in floors), len(floors), "floors"),
        "every room reachable": share_of(sum(reached), len(floors), "floors"),
    }


def shell_scores(pairs: Pairs) -> dict[str, Score]:
    """How well open plans were divided."""
    lit = [kind for _, facts in pairs for kind in facts.lit]
    counts = Counter(facts.rooms for _, facts in pairs)
    true_counts = Counter(len(case.plan.rooms) for case, _ in pairs)
    return {
        **sound_scores([facts for _, facts in pairs]),
        "outline IoU": mean_of([facts.outline_iou for _, facts in pairs], "floors"),
        "windows kept": mean_of([facts.openings_kept for _, facts in pairs], "floors"),
        "windows to rooms that want them": share_of(
            sum(kind not in DARK_KINDS for kind in lit), len(lit), "windows"
        ),
        "room-count TV": Score(total_variation(counts, true_counts), len(pairs), "floors"),
    }


def _lit(plan: Plan) -> list[RoomKind]:
    return [
        plan.room(opening.room_ids[0]).kind if opening.room_ids else "unknown"
        for opening in plan.openings
        if opening.kind == "window" and len(opening.room_ids) < 2
    ]


def _kept(shell: Plan, plan: Plan) -> tuple[float, float]:
    """IoU of the house with its walls, and the share of the shell's openings that are there."""
    before, after = (_whole(rooms) for rooms in (shell.rooms, plan.rooms))
    iou = before.intersection(after).area / before.union(after).area if plan.rooms else 0.0
    boxes = {opening.box for opening in plan.openings}
    kept = sum(opening.box in boxes for opening in shell.openings)
    return float(iou), kept / len(shell.openings) if shell.openings else 1.0


def _whole(rooms: Sequence[Room]) -> BaseGeometry:
    """Floors and walls, the seams between them closed."""
    floors = [room_polygon(room) for room in rooms]
    return wall_area(rooms).union(unary_union(floors)).buffer(0.01).buffer(-0.01)


def diversity(plans: Sequence[Plan]) -> float:
    """1 - mean IoU of the rooms of each kind, over all pairs of plans of one wish; [0, 1]."""
    distances = []
    for first, second in combinations(plans, 2):
        shares = []
        for kind in {room.kind for room in (*first.rooms, *second.rooms)}:
            a, b = (unary_union([room_polygon(r) for r in p.rooms if r.kind == kind])
                    for p in (first, second))  # fmt: skip
            union = a.union(b).area
            shares.append(a.intersection(b).area / union if union else 1.0)
        distances.append(1.0 - float(np.mean(shares)))
    return float(np.mean(distances)) if distances else 0.0


def tried_text(results: Sequence[FloorResult]) -> str:
    """How many floors it took."""
    mean = np.mean([result.tried for result in results])
    return f"{mean:.1f} floors planned for each on average, the best of them taken"


def as_markdown(title: str, columns: dict[str, dict[str, Score]], notes: Sequence[str]) -> str:
    """A table of scores, a column per choice; below it what there is to know."""
    names = list(next(iter(columns.values())))
    rows = [[name, *(score_text(scores[name]) for scores in columns.values())] for name in names]
    table = markdown_table(["score (n)", *columns], rows)
    return "\n".join([f"## {title}\n", table, *(f"- {note}" for note in notes), ""])


def as_data(columns: dict[str, dict[str, Score]]) -> dict[str, Any]:
    """For JSON."""
    return {
        column: {
            name: {"value": score.value, "n": score.count, "over": score.over}
            for name, score in scores.items()
        }
        for column, scores in columns.items()
    }


def sheet(rows: Sequence[Sequence[Plan]]) -> ByteArray:
    """A picture of plans, a row for each wish."""
    blank = np.full((CANVAS_PX, CANVAS_PX, 3), BACKGROUND_RGB, np.uint8)
    return np.concatenate(
        [
            np.concatenate(
                [framed(draw_plan(plan).rgb if plan.rooms else blank) for plan in row], axis=1
            )
            for row in rows
        ]
    )
