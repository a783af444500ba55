"""The out-of-distribution experiment as the paper does it (CHOrD, section 5).

Clean layouts are compared with the layouts of other houses that have the highest PIoU of many. The
paper's many are 3D-FRONT's houses, whose furniture collides as it was drawn; ours are drawn clean,
so every piece is moved by noise first. Where other houses are compared, so are their sizes: the
same houses before the noise stand beside.
"""

from __future__ import annotations

import heapq
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Any, NamedTuple

import numpy as np

from chord_usd.base.metrics.overlap import scene_overlap
from chord_usd.base.raster import canvas
from chord_usd.base.runtime.progress import Progress, Warn
from chord_usd.base.scene.types import FloatArray, SceneGraph
from chord_usd.line.layout.device import in_batches
from chord_usd.line.layout.outlier import Drawing, NoiseError
from chord_usd.workshop.data.splits import split_hash
from chord_usd.workshop.evaluation.cases import Case
from chord_usd.workshop.evaluation.collisions import jostle
from chord_usd.workshop.evaluation.ood import (
    BATCH,
    PAPER_ERRORS,
    PAPER_GAP,
    noise_span,
    times_between,
)
from chord_usd.workshop.evaluation.report import markdown_table, number_text

SPREAD_M = 0.25
"""Of the noise: about as wide as a bedside table is deep, half."""


@dataclass(frozen=True)
class WorstScores:
    """Mean noise-prediction errors in the paper's range of noise."""

    clean: float
    """Of houses with no collision."""
    before: float
    """Of the worst houses before their pieces were moved."""
    colliding: float
    gap_error: float
    """Standard error of gap, over houses."""
    own_gap_error: float
    """The same of own_gap."""
    houses: int
    """Of each of the three."""
    out_of: int
    """Houses that the worst are the worst of."""
    draws: int
    noise_to_signal: tuple[float, float]
    piou_clean: float
    piou_colliding: float
    split: str
    checkpoint: str

    @property
    def gap(self) -> float:
        """How much more error the worst have than clean ones, as a share of theirs: the paper's."""
        return self.colliding / self.clean - 1.0

    @property
    def own_gap(self) -> float:
        """How much more the same houses have than before."""
        return self.colliding / self.before - 1.0


class _Worst(NamedTuple):
    piou: float
    rank: int
    before: SceneGraph
    after: SceneGraph


def measure_worst(
    errors: NoiseError,
    cases: Sequence[Case],
    worst: int,
    *,
    draws: int,
    seed: int = 0,
    progress: Progress | None = None,
    warn: Warn | None = None,
) -> WorstScores:
    """The first `worst` cases are the clean houses; of the others, moved, that many are compared.

    draws: noises of each layout.
    """
    clean = [case.truth(seed) for case in cases[:worst]]
    moves = heapq.nlargest(worst, _moved(cases[worst:], seed), key=lambda move: move[:2])
    span = noise_span(errors)
    times = times_between(errors, span, draws, seed)
    scenes = [*clean, *(move.before for move in moves), *(move.after for move in moves)]
    rows = _errors(errors, scenes, times, seed, progress, warn)
    parts = np.split(rows, [len(clean), len(clean) + len(moves)])
    unspoilt, before, after = parts
    return WorstScores(
        clean=float(unspoilt.mean()),
        before=float(before.mean()),
        colliding=float(after.mean()),
        gap_error=float(
            np.hypot(_of_mean(after), after.mean() / unspoilt.mean() * _of_mean(unspoilt))
            / unspoilt.mean()
        ),
        own_gap_error=float(
            _of_mean(after - after.mean() / before.mean() * before) / before.mean()
        ),
        houses=len(moves),
        out_of=len(cases) - worst,
        draws=draws,
        noise_to_signal=span,
        piou_clean=float(np.mean([scene_overlap(scene).piou for scene in clean])),
        piou_colliding=float(np.mean([move.piou for move in moves])),
        split=split_hash(case.id for case in cases),
        checkpoint=errors.model.checkpoint.content_hash,
    )


def _of_mean(values: FloatArray) -> float:
    """Standard error of a mean."""
    return float(values.std(ddof=1) / np.sqrt(len(values))) if len(values) > 1 else 0.0


def _moved(cases: Sequence[Case], seed: int) -> Iterator[_Worst]:
    for index, case in enumerate(cases):
        before = case.truth(seed)
        rng = np.random.default_rng((seed, int(split_hash([case.id]), 16)))
        after = jostle(before, rng, SPREAD_M)
        yield _Worst(scene_overlap(after).piou, index, before, after)


def _errors(
    errors: NoiseError,
    scenes: Sequence[SceneGraph],
    times: Sequence[int],
    seed: int,
    progress: Progress | None,
    warn: Warn | None,
) -> FloatArray:
    """(scenes,) mean error over pixels and times."""

    def work(part: Sequence[SceneGraph]) -> list[float]:
        drawings = [Drawing.of(canvas.draw_plan(scene.plan), scene.items) for scene in part]
        maps = [error_map.mean(axis=(1, 2)) for error_map in errors.maps(drawings, times, seed)]
        return [float(value) for value in np.mean(maps, axis=0)]

    rows = []
    for row in in_batches(work, scenes, BATCH, warn):
        rows.append(row)
        if progress:
            progress(len(rows), len(scenes))
    return np.array(rows)


def as_data(scores: WorstScores) -> dict[str, Any]:
    """For --json."""
    return {**asdict(scores), "gap": scores.gap, "own_gap": scores.own_gap, "paper_gap": PAPER_GAP}


def as_markdown(scores: WorstScores) -> str:
    """The table, beside the paper's."""
    low, high = scores.noise_to_signal
    rows = [
        [
            f"the {scores.houses} worst of {scores.out_of}", f"{low:.1f} to {high:.1f}",
            number_text(scores.clean), number_text(scores.colliding),
            f"{scores.gap:+.1%} ± {scores.gap_error:.1%}",
            f"{scores.own_gap:+.1%} ± {scores.own_gap_error:.1%}", str(scores.draws),
        ],
        [
            "the paper's 400 worst", "", *map(number_text, PAPER_ERRORS), f"{PAPER_GAP:+.2%}", "",
            "100",
        ],
    ]  # fmt: skip
    head = [
        "layouts", "sigma/alpha", "clean, other houses", "colliding", "gap",
        "gap to the same houses", "draws",
    ]  # fmt: skip
    return (
        f"split {scores.split}, checkpoint {scores.checkpoint}; pieces moved by {SPREAD_M * 100:g} "
        f"cm; PIoU {number_text(scores.piou_clean)} clean, {number_text(scores.piou_colliding)} "
        "colliding\n\n" + markdown_table(head, rows)
    )
