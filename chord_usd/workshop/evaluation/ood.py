"""The paper's experiment on collisions as out-of-distribution samples (CHOrD, section 5).

Clean layouts and the same layouts with furniture moved into other furniture are noised, and the
error of the predicted noise is compared. The paper compares different houses; here each house is
its own control. A second control, the same kind of pieces moved to where they touch nothing,
separates the share of the collision in the gap from the share of the place.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from chord_usd.base.errors import SceneError
from chord_usd.base.metrics.scores import score_scenes
from chord_usd.base.raster import canvas
from chord_usd.base.runtime.progress import Progress, Warn
from chord_usd.base.scene.types import FloatArray, SceneGraph
from chord_usd.line.layout.device import in_batches
from chord_usd.line.layout.outlier import Drawing, NoiseError
from chord_usd.line.layout.schedule import LINEAR_BETAS
from chord_usd.workshop.data.splits import split_hash
from chord_usd.workshop.evaluation.cases import Case
from chord_usd.workshop.evaluation.collisions import Spoilt, collide, displace
from chord_usd.workshop.evaluation.report import figure_png, markdown_table, new_figure, number_text

PAPER_TIMES = (900, 1000)
"""Of DDPM's 1000 linear steps."""

PAPER_GAP = 0.3222
PAPER_ERRORS = (5.37e-5, 7.10e-5)

LEVELS = 14
"""Noise levels of the curve over the whole schedule."""

BATCH = 6


@dataclass(frozen=True)
class Gap:
    """Mean noise-prediction errors of clean and of spoilt layouts over one range of noise."""

    clean: float
    colliding: float
    displaced: float
    noise_to_signal: tuple[float, float]
    draws: int

    @property
    def of_colliding(self) -> float:
        """How much more error there is than in clean layouts, as a share of theirs."""
        return self.colliding / self.clean - 1.0

    @property
    def of_displaced(self) -> float:
        """The same for pieces moved to where they touch nothing."""
        return self.displaced / self.clean - 1.0


@dataclass(frozen=True)
class OodScores:
    """The whole experiment."""

    ranges: dict[str, Gap]
    curve: tuple[Gap, ...]
    """One gap per noise level, from little noise to much."""
    item_auc: float
    """Chance that a piece moved into another has a higher score than one left in place."""
    houses: int
    moved: int
    piou_clean: float
    piou_colliding: float
    split: str
    checkpoint: str


@dataclass(frozen=True, eq=False)
class _Triple:
    """A house as it is, with collisions, and with pieces moved clear of others."""

    clean: SceneGraph
    colliding: Spoilt
    displaced: Spoilt

    def drawings(self) -> list[Drawing]:
        plan_image = canvas.draw_plan(self.clean.plan)
        scenes = (self.clean, self.colliding.scene, self.displaced.scene)
        return [Drawing.of(plan_image, scene.items) for scene in scenes]


def paper_noise_to_signal() -> tuple[float, float]:
    """sigma/alpha at the ends of PAPER_TIMES on DDPM's linear schedule: about 58 and 157."""
    alphas = np.cumprod(1.0 - np.linspace(*LINEAR_BETAS, 1000))
    first, last = (float(np.sqrt((1 - a) / a)) for a in alphas[[PAPER_TIMES[0], -1]])
    return first, last


def noise_span(errors: NoiseError) -> tuple[float, float]:
    """The part of the paper's range of noise that a model knows."""
    low, high = paper_noise_to_signal()
    ratios = errors.noise_to_signal
    return float(max(low, ratios[0])), float(min(high, ratios[-1]))


def measure_ood(
    errors: NoiseError,
    cases: Sequence[Case],
    *,
    draws: int = 100,
    per_room: int = 1,
    seed: int = 0,
    progress: Progress | None = None,
    warn: Warn | None = None,
) -> OodScores:
    """Repeats the experiment on these houses; draws noises per layout and range.

    per_room: how many pieces of a room are moved. Houses in which nothing could be moved into
    anything are left out; raises SceneError where all are.
    """
    triples = [triple for triple in (_spoil(case, seed, per_room) for case in cases) if triple]
    if not triples:
        raise SceneError("no piece could be moved into another", expected="furnished houses")
    ratios = errors.noise_to_signal
    spans = {
        "paper's range": noise_span(errors),
        "whole schedule": (float(ratios[0]), float(ratios[-1])),
    }
    plans = {name: times_between(errors, span, draws, seed) for name, span in spans.items()}
    levels = [errors.time_of(r) for r in np.geomspace(ratios[0], ratios[-1], LEVELS)]
    every = [time for times in plans.values() for time in times] + levels
    means = _mean_errors(errors, triples, every, seed, progress, warn)
    ranges, start = {}, 0
    for name, times in plans.items():
        ranges[name] = _gap(means[start : start + draws], spans[name])
        start += len(times)
    curve = [
        _gap(means[start + k : start + k + 1], (float(ratios[t]),) * 2)
        for k, t in enumerate(levels)
    ]
    return OodScores(
        ranges=ranges,
        curve=tuple(curve),
        item_auc=_item_auc(errors, triples, seed),
        houses=len(triples),
        moved=sum(len(triple.colliding.moved) for triple in triples),
        piou_clean=score_scenes([triple.clean for triple in triples])["piou"].value,
        piou_colliding=score_scenes([triple.colliding.scene for triple in triples])["piou"].value,
        split=split_hash(case.id for case in cases),
        checkpoint=errors.model.checkpoint.content_hash,
    )


def _spoil(case: Case, seed: int, per_room: int) -> _Triple | None:
    clean = case.truth(seed)
    key = (seed, int(split_hash([case.id]), 16))
    colliding = collide(clean, np.random.default_rng(key), per_room)
    displaced = displace(clean, np.random.default_rng(key), per_room)
    return _Triple(clean, colliding, displaced) if colliding.moved else None


def times_between(
    errors: NoiseError, span: tuple[float, float], draws: int, seed: int
) -> list[int]:
    """Training steps drawn evenly from a range of noise."""
    first, last = errors.time_of(span[0]), errors.time_of(span[1])
    rng = np.random.default_rng(seed)
    return [int(time) for time in rng.integers(first, last + 1, size=draws)]


def _mean_errors(
    errors: NoiseError,
    triples: Sequence[_Triple],
    times: Sequence[int],
    seed: int,
    progress: Progress | None,
    warn: Warn | None,
) -> FloatArray:
    """(times, 3) error over all pixels, mean over houses, of clean, colliding, displaced."""

    def work(part: Sequence[_Triple]) -> list[FloatArray]:
        drawings = [drawing for triple in part for drawing in triple.drawings()]
        rows = np.array([maps.mean(axis=(1, 2)) for maps in errors.maps(drawings, times, seed)])
        return list(rows.reshape(len(times), len(part), 3).transpose(1, 0, 2))

    total = np.zeros((len(times), 3))
    rows = in_batches(work, triples, max(BATCH // 3, 1), warn)
    for done, row in enumerate(rows, start=1):
        total += row
        if progress:
            progress(done, len(triples))
    return total / len(triples)


def _gap(rows: FloatArray, span: tuple[float, ...]) -> Gap:
    clean, colliding, displaced = (float(value) for value in rows.mean(axis=0))
    return Gap(clean, colliding, displaced, (float(span[0]), float(span[1])), len(rows))


def _item_auc(errors: NoiseError, triples: Sequence[_Triple], seed: int) -> float:
    """Area under the curve of the scores that generate writes, on the colliding houses."""
    still: list[float] = []
    moved: list[float] = []
    for triple in triples:
        plan_image = canvas.draw_plan(triple.clean.plan)
        scores = errors.item_scores(plan_image, triple.colliding.scene.items, seed)
        for item_id, score in scores.items():
            (moved if item_id in triple.colliding.moved else still).append(score)
    above = np.array(moved)[:, None] - np.array(still)[None, :]
    return float(((above > 0) + 0.5 * (above == 0)).mean()) if above.size else 0.0


def as_data(scores: OodScores) -> dict[str, Any]:
    """For --json."""
    gaps = {
        name: {"gap": gap.of_colliding, "gap_displaced": gap.of_displaced}
        for name, gap in scores.ranges.items()
    }
    return {**asdict(scores), "gaps": gaps, "paper_gap": PAPER_GAP}


def as_markdown(scores: OodScores) -> str:
    """The table, beside the paper's."""
    rows = [
        [
            name, f"{gap.noise_to_signal[0]:.1f} to {gap.noise_to_signal[1]:.1f}",
            number_text(gap.clean), number_text(gap.colliding), f"{gap.of_colliding:+.2%}",
            f"{gap.of_displaced:+.2%}", str(gap.draws),
        ]
        for name, gap in scores.ranges.items()
    ]  # fmt: skip
    errors = [number_text(error) for error in PAPER_ERRORS]
    rows.append(["the paper, t in [900, 1000]", "", *errors, f"{PAPER_GAP:+.2%}", "", "100"])
    head = [
        "noise", "sigma/alpha", "clean", "colliding", "gap", "gap when moved clear", "draws",
    ]  # fmt: skip
    return (
        f"split {scores.split}, checkpoint {scores.checkpoint}; {scores.houses} houses, "
        f"{scores.moved} pieces moved; PIoU {number_text(scores.piou_clean)} clean, "
        f"{number_text(scores.piou_colliding)} colliding; a moved piece scores higher than one "
        f"left in place with chance {scores.item_auc:.3f}\n\n" + markdown_table(head, rows)
    )


def plot(scores: OodScores) -> bytes:
    """The gap against the noise."""
    figure = new_figure(1, size_in=(6.0, 3.6))
    (axes,) = figure.axes
    ratios = [gap.noise_to_signal[0] for gap in scores.curve]
    axes.plot(ratios, [100 * gap.of_colliding for gap in scores.curve], "o-", label="colliding")
    axes.plot(ratios, [100 * gap.of_displaced for gap in scores.curve], "s--", label="moved clear")
    axes.axhline(100 * PAPER_GAP, color="grey", linewidth=1, label="the paper's gap")
    axes.axvspan(*scores.ranges["paper's range"].noise_to_signal, alpha=0.15)
    axes.set_xscale("log")
    axes.set_xlabel("noise to signal, sigma/alpha (shaded: the paper's range)")
    axes.set_ylabel("more error than clean, %")
    axes.legend(fontsize=8)
    return figure_png(figure)
