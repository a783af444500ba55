"""The table and the plot of evaluate layouts, beside the paper's figures."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from chord_usd.workshop.evaluation.layouts import LayoutScores
from chord_usd.workshop.evaluation.realism import Realism
from chord_usd.workshop.evaluation.report import figure_png, markdown_table, new_figure, score_text

PAPER: dict[str, dict[str, dict[str, float]]] = {
    "CHOrD on its own data": {
        "house": {"por": 0.0125, "piou": 0.0007},
        "bedroom": {"por": 0.1049, "piou": 0.0025},
        "living": {"por": 0.0485, "piou": 0.0021},
    },
    "CHOrD on 3D-FRONT": {
        "house": {"por": 0.0130, "piou": 0.0005},
        "bedroom": {"por": 0.0766, "piou": 0.0013},
        "living": {"por": 0.0207, "piou": 0.0015},
    },
    "CHOrD, 100,000 scenes": {"house": {"por": 0.005, "piou": 4.4e-5}},
}
"""Table 2 of the paper, and its supplementary. Its FID and KID come from another encoder and other
data, so they stand nowhere beside ours."""

TARGETS: dict[str, dict[str, float]] = {
    "house": {
        "por": 0.005, "piou": 5e-5, "furnished": 0.97, "blocked_openings": 0.01,
        "out_of_room": 0.01, "complete": 0.98, "right": 0.95, "complete_houses": 0.88,
    },
    "bedroom": {"por": 0.02},
    "living": {"por": 0.02},
}  # fmt: skip
"""What the model is meant to reach."""

_MORE_IS_BETTER = ("furnished", "complete", "right", "complete_houses")


def as_markdown(scores: LayoutScores, realism: dict[str, Realism] | None = None) -> str:
    """The tables that go into the model card, each figure with its count."""
    parts = list(scores.rows)
    names = list(dict.fromkeys(name for row in scores.rows.values() for name in row))
    rows = []
    for name in names:
        row = [scores.rows[part].get(name) for part in parts]
        over = next(score.over for score in row if score is not None)
        rows.append([name, *map(score_text, row), over, _target(name)])
    text = (
        f"split {scores.split}, made by {scores.made_by}, {scores.steps} steps of "
        f"{scores.sampler}; in brackets, over how many\n\n"
    )
    text += markdown_table(["score", *parts, "over", "target, house"], rows)
    if realism:
        text += "\n" + _realism_table(realism)
    return text + "\n" + _paper_table()


def as_data(scores: LayoutScores, realism: dict[str, Realism] | None = None) -> dict[str, Any]:
    """The same for --json."""
    return {
        **asdict(scores),
        "realism": {part: asdict(figures) for part, figures in (realism or {}).items()},
        "paper": PAPER,
        "targets": TARGETS,
        "missed": missed(scores),
    }


def missed(scores: LayoutScores) -> dict[str, float]:
    """By `part/score`, how far the value is from a target that is not reached."""
    gaps = {}
    for part, targets in TARGETS.items():
        for name, target in targets.items():
            score = scores.rows[part][name]
            gap = score.value - target if name not in _MORE_IS_BETTER else target - score.value
            if score.count and gap > 0:
                gaps[f"{part}/{name}"] = round(gap, 6)
    return gaps


def plot(scores: LayoutScores) -> bytes:
    """Bars of POR and PIoU by part of the house beside the paper's."""
    figure = new_figure(2)
    sources = {"chord-usd": scores.rows, **PAPER}
    parts = ("house", "living", "bedroom")
    width = 0.8 / len(sources)
    for axes, name in zip(figure.axes, ("por", "piou"), strict=True):
        for index, (source, rows) in enumerate(sources.items()):
            values = [_value(rows, part, name) for part in parts]
            places = [place + index * width for place in range(len(parts))]
            axes.bar(places, values, width, label=source)
        axes.set_xticks([place + 0.4 - width / 2 for place in range(len(parts))], parts)
        axes.set_title("POR" if name == "por" else "PIoU")
    figure.axes[0].legend(fontsize=7)
    return figure_png(figure)


def _value(rows: Any, part: str, name: str) -> float:
    score = rows.get(part, {}).get(name)
    return float(getattr(score, "value", score) or 0.0)


def _target(name: str) -> str:
    target = TARGETS["house"].get(name)
    if target is None:
        return ""
    return f"{'≥' if name in _MORE_IS_BETTER else '≤'} {target:g}"


def _realism_table(realism: dict[str, Realism]) -> str:
    rows = [
        [
            part, f"{scores.fid:.2f}", f"{scores.fid_floor:.2f}",
            f"{scores.fid / scores.fid_floor:.2f}",
            f"{scores.kid:.4f}", f"{scores.kid_floor:.4f}", str(scores.count),
        ]
        for part, scores in realism.items()
    ]  # fmt: skip
    (encoder,) = {scores.encoder for scores in realism.values()}
    fid, kid = f"FID-{encoder}", f"KID-{encoder}"
    head = ["part", fid, "floor", "over floor", kid, "floor", "pictures each"]
    return markdown_table(head, rows)


def _paper_table() -> str:
    rows = [
        [source, part, f"{row['por']:g}", f"{row['piou']:g}"]
        for source, parts in PAPER.items()
        for part, row in parts.items()
    ]
    return markdown_table(["the paper", "part", "POR", "PIoU"], rows)
