"""The data set tables as one picture: ours beside the paper's."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from chord_usd.base.metrics import mean_scores
from chord_usd.base.runtime.files import write_atomic
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.workshop.data import paper_tables as paper
from chord_usd.workshop.data.statistics import Statistics

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_OURS, _PAPER = "#c2571a", "#5b7a99"
_SIZE_IN, _DPI = (13.0, 9.0), 110
_BAR = 0.4


def plot_statistics(statistics: Statistics, path: Path) -> None:
    """Write a PNG: categories, rooms per house, non-empty rooms and quality. Raises OutputError."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=_SIZE_IN, layout="constrained")
    grid = figure.add_gridspec(3, 2, width_ratios=(1.25, 1.0))
    houses = max(statistics.houses, 1)
    _pairs_across(
        figure.add_subplot(grid[:, 0]),
        [CATEGORIES[name].label for name in paper.ITEMS],
        [statistics.items[name] / houses for name in paper.ITEMS],
        [count / paper.HOUSES for count in paper.ITEMS.values()],
        f"Items per house (total variation {statistics.category_distance:.3f})",
    )
    _room_counts(figure.add_subplot(grid[0, 1]), statistics)
    _pairs_up(
        figure.add_subplot(grid[1, 1]),
        [" +\n".join(kinds) for kinds in paper.ROOM_GROUPS.values()],
        [statistics.non_empty_of_group(group) / houses for group in paper.ROOM_GROUPS],
        [paper.NON_EMPTY_ROOMS[group] / paper.HOUSES for group in paper.ROOM_GROUPS],
        "Non-empty rooms per house",
    )
    _quality(figure.add_subplot(grid[2, 1]), statistics)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=_DPI, metadata={"Software": None})
    write_atomic(path, buffer.getvalue())


def _pairs_across(
    axes: Axes, names: Sequence[str], ours: Sequence[float], theirs: Sequence[float], title: str
) -> None:
    """Two level bars for each name, the first at the top."""
    places = range(len(names))
    axes.barh([p - _BAR / 2 for p in places], ours, _BAR, color=_OURS, label="ours")
    axes.barh([p + _BAR / 2 for p in places], theirs, _BAR, color=_PAPER, label="paper")
    axes.set_yticks(list(places), names, fontsize=8)
    axes.invert_yaxis()
    axes.set_title(title, fontsize=10)
    axes.legend()


def _pairs_up(
    axes: Axes, names: Sequence[str], ours: Sequence[float], theirs: Sequence[float], title: str
) -> None:
    places = range(len(names))
    bars = [
        axes.bar([p - _BAR / 2 for p in places], ours, _BAR, color=_OURS, label="ours"),
        axes.bar([p + _BAR / 2 for p in places], theirs, _BAR, color=_PAPER, label="paper"),
    ]
    for bar in bars:
        axes.bar_label(bar, fmt="%.3g", fontsize=7)
    axes.set_xticks(list(places), names, fontsize=8)
    axes.margins(y=0.15)
    axes.set_title(title, fontsize=10)


def _room_counts(axes: Axes, statistics: Statistics) -> None:
    def shares(counts: Mapping[int, int]) -> list[float]:
        total = max(sum(counts.values()), 1)
        return [counts.get(n, 0) / total for n in numbers]

    numbers = sorted(paper.ROOM_COUNTS.keys() | statistics.rooms_per_house.keys())
    axes.bar(numbers, shares(statistics.rooms_per_house), 0.8, color=_OURS)
    axes.plot(numbers, shares(paper.ROOM_COUNTS), "o-", color=_PAPER, markersize=3)
    axes.set_title(
        f"Share of houses by rooms (total variation {statistics.room_count_distance:.3f})",
        fontsize=10,
    )


def _quality(axes: Axes, statistics: Statistics) -> None:
    means: dict[str, Any] = mean_scores(statistics.scores)
    _pairs_up(
        axes,
        ["empty-room rate", "POR", "PIoU"],
        [statistics.empty_room_rate, means["por"].value, means["piou"].value],
        [paper.EMPTY_ROOM_RATE, paper.POR, paper.PIOU],
        f"Quality, {statistics.houses} houses",
    )
