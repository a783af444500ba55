"""How many sampler steps are worth their time: seconds per layout against the scores."""

from __future__ import annotations

import resource
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from chord_usd.base.metrics.scores import Score
from chord_usd.base.raster.canvas import draw_plan
from chord_usd.base.runtime.networks import usable_cores
from chord_usd.base.runtime.progress import Progress, Warn
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.workshop.data.splits import split_hash
from chord_usd.workshop.evaluation.cases import Case
from chord_usd.workshop.evaluation.encoders import Encoder
from chord_usd.workshop.evaluation.layouts import Furnished, Sampling, sampled, score_layouts
from chord_usd.workshop.evaluation.realism import Realism, realism, reference_layouts
from chord_usd.workshop.evaluation.report import figure_png, markdown_table, new_figure, score_text

DEFAULT_STEPS = (1, 2, 5, 10, 20, 50, 100)

JUDGED = ("por", "piou", "blocked_openings", "furnished")
SCORES = (*JUDGED, "items_per_house")
_SHARES = ("blocked_openings", "furnished")

LOSS = 0.05
"""A score may be this much worse, as a share of its best, for the fewer steps to count as good."""


@dataclass(frozen=True)
class Run:
    """One sampler at one number of steps."""

    sampler: str
    steps: int
    seconds: float
    """Wall clock per layout, one at a time."""
    cpu_seconds: float
    """Processor time per layout, all threads; what counts on a machine that is shared."""
    batch_seconds: float
    """Wall clock per layout in batches."""
    scores: dict[str, Score]
    fid: float | None
    same_pixels: float
    """Share of pixels as in the run of most steps of the same sampler, from the same noise."""


@dataclass(frozen=True)
class SpeedScores:
    """All runs, and what they were measured on."""

    runs: tuple[Run, ...]
    split: str
    plans: int
    checkpoint: str
    device: str
    threads: int
    peak_mib: float
    """Most memory that the process has held."""
    default_steps: int


def measure_speed(
    model: LayoutModel,
    cases: Sequence[Case],
    sampling: Sampling,
    steps: Sequence[int],
    samplers: Sequence[str],
    encoder: Encoder | None = None,
    progress: Progress | None = None,
    warn: Warn | None = None,
) -> SpeedScores:
    """Samples every case with every sampler at every number of steps, from the same noise."""
    runs = []
    total = len(steps) * len(samplers)
    for sampler in samplers:
        reference: list[Furnished] = []
        for count in sorted(steps, reverse=True):
            how = replace(sampling, sampler=sampler, steps=count)
            started = time.perf_counter()
            made = list(sampled(model, cases, how, warn=warn))
            batch_seconds = (time.perf_counter() - started) / len(cases)
            reference = reference or made
            runs.append(_run(model, made, how, count, reference, batch_seconds, encoder))
            if progress:
                progress(len(runs), total)
    return SpeedScores(
        runs=tuple(sorted(runs, key=lambda run: (run.sampler, run.steps))),
        split=split_hash(case.id for case in cases),
        plans=len(cases),
        checkpoint=model.checkpoint.content_hash,
        device=model.device,
        threads=usable_cores(),
        peak_mib=resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
        default_steps=model.config.default_steps,
    )


def _run(
    model: LayoutModel,
    made: Sequence[Furnished],
    how: Sampling,
    steps: int,
    reference: Sequence[Furnished],
    batch_seconds: float,
    encoder: Encoder | None,
) -> Run:
    seconds, cpu_seconds = _time_one(model, made[0].case, how)
    scores = score_layouts(made, model.checkpoint.content_hash, how).rows["house"]
    same = [
        float((layout.image.rgb == other.image.rgb).all(axis=2).mean())
        for layout, other in zip(made, reference, strict=True)
    ]
    figures = _realism(made, how, encoder) if encoder else None
    return Run(
        how.sampler or "", steps, seconds, cpu_seconds, batch_seconds,
        {name: scores[name] for name in SCORES},
        figures.fid if figures else None,
        sum(same) / len(same),
    )  # fmt: skip


def _realism(made: Sequence[Furnished], how: Sampling, encoder: Encoder) -> Realism | None:
    real, others = reference_layouts([layout.case for layout in made], how)
    sets = ([layout.image.rgb for layout in part] for part in (made[: len(real)], real, others))
    return realism(*map(encoder.features, sets))


def _time_one(model: LayoutModel, case: Case, how: Sampling) -> tuple[float, float]:
    """Wall clock and processor seconds of one layout, after one that warms up."""
    image = draw_plan(case.plan, shade=how.shaded)
    model.sample(image, steps=1, sampler=how.sampler)
    wall, cpu = time.perf_counter(), time.process_time()
    model.sample(image, seed=how.seed, steps=how.steps, sampler=how.sampler)
    return time.perf_counter() - wall, time.process_time() - cpu


def fewest_steps(scores: SpeedScores) -> tuple[str, int]:
    """The cheapest sampler and steps whose scores lose no more than LOSS against the most steps.

    A share may also be worse by one opening or room: a smaller difference is noise.
    """
    most = max(scores.runs, key=lambda run: run.steps)
    for run in sorted(scores.runs, key=lambda run: (run.cpu_seconds, run.steps)):
        if all(_is_as_good(name, run.scores[name], most.scores[name]) for name in JUDGED):
            return run.sampler, run.steps
    return most.sampler, most.steps


def _is_as_good(name: str, score: Score, best: Score) -> bool:
    step = 1.0 / max(best.count, 1) if name in _SHARES else 0.0
    slack = max(LOSS * best.value, step) + 1e-12
    if name == "furnished":
        return score.value >= best.value - slack
    return score.value <= best.value + slack


def as_data(scores: SpeedScores) -> dict[str, Any]:
    """For --json."""
    sampler, steps = fewest_steps(scores)
    return {**asdict(scores), "fewest_steps": {"sampler": sampler, "steps": steps}}


def as_markdown(scores: SpeedScores) -> str:
    """The table, one row per sampler and number of steps."""
    rows = [
        [
            run.sampler, str(run.steps), f"{run.seconds:.2f}", f"{run.cpu_seconds:.2f}",
            f"{run.batch_seconds:.2f}", *(score_text(run.scores[name]) for name in SCORES),
            "" if run.fid is None else f"{run.fid:.1f}", f"{run.same_pixels:.4f}",
        ]
        for run in scores.runs
    ]  # fmt: skip
    head = ["sampler", "steps", "s", "CPU s", "s in batches", *SCORES, "FID-EffLite0", "same"]
    sampler, steps = fewest_steps(scores)
    return (
        f"split {scores.split}, {scores.plans} plans, checkpoint {scores.checkpoint}, "
        f"{scores.device} with {scores.threads} threads, at most {scores.peak_mib:.0f} MiB; "
        f"the checkpoint's own steps are {scores.default_steps}; the cheapest run that loses no "
        f"more than {LOSS:.0%} is {sampler} in {steps} steps\n\n" + markdown_table(head, rows)
    )


def plot(scores: SpeedScores) -> bytes:
    """Scores against processor seconds."""
    names = ("por", "blocked_openings", "furnished")
    figure = new_figure(len(names))
    for axes, name in zip(figure.axes, names, strict=True):
        for sampler in dict.fromkeys(run.sampler for run in scores.runs):
            runs = [run for run in scores.runs if run.sampler == sampler]
            values = [run.scores[name].value for run in runs]
            axes.plot([run.cpu_seconds for run in runs], values, "o-", label=sampler)
            for run, value in zip(runs, values, strict=True):
                axes.annotate(str(run.steps), (run.cpu_seconds, value), fontsize=7)
        axes.set_xscale("log")
        axes.set_xlabel("CPU seconds per layout")
        axes.set_title(name)
    figure.axes[0].legend(fontsize=8)
    return figure_png(figure)
