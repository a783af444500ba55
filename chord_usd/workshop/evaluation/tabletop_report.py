"""The tables and the sheet of evaluate tabletops."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any

import cv2
import numpy as np

from chord_usd.base.raster import canvas
from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.palette import SUPPORTS, Level
from chord_usd.base.scene.types import ByteArray
from chord_usd.base.scene.units import px_from_m
from chord_usd.workshop.evaluation.report import (
    enlarged,
    framed,
    markdown_table,
    picture_png,
    score_text,
)
from chord_usd.workshop.evaluation.tabletops import Judged, ReaderScores, TableScores

TARGETS: dict[str, float] = {
    "por": 0.01, "off_edge": 0.01, "supported": 1.0, "filled": 0.97, "dining_laid": 1.0,
}  # fmt: skip
"""What the model is meant to reach on pieces of every kind."""

_LESS_IS_BETTER = ("por", "off_edge")

COLUMNS, ENLARGE, MARGIN_PX = 8, 3, 6


@dataclass(frozen=True)
class Made:
    """Who laid the tables, and how."""

    made_by: str
    """Hash of the checkpoint."""
    how: str
    """Steps of which sampler, or how many lists of each top."""
    batch_cpu_seconds: float
    """Processor time of one batch, placing included."""
    batch: int
    """Tables in it."""


def as_markdown(
    columns: Mapping[str, TableScores], readers: Mapping[str, ReaderScores], made: Made
) -> str:
    """The tables that go into the model card."""
    names = list(dict.fromkeys(name for scores in columns.values() for name in scores.rows))
    rows = []
    for name in names:
        row = [scores.rows.get(name) for scores in columns.values()]
        over = next(score.over for score in row if score is not None)
        rows.append([name, *map(score_text, row), over, _target(name)])
    heads = [f"{name} (split {scores.split})" for name, scores in columns.items()]
    text = (
        f"made by {made.made_by}, {made.how}; {made.batch} tables in one batch take "
        f"{made.batch_cpu_seconds:.2f} s of processor time; in brackets, over how many"
        "\n\n"
    )
    text += markdown_table(["score", *heads, "over", "target"], rows)
    text += "\n" + _category_table(columns)
    return text + "\n" + _reader_table(readers) if readers else text


def _target(name: str) -> str:
    if name not in TARGETS:
        return ""
    return f"{'≤' if name in _LESS_IS_BETTER else '≥'} {TARGETS[name]:g}"


def _category_table(columns: Mapping[str, TableScores]) -> str:
    rows = []
    for name in SUPPORTS:
        row = [name]
        for scores in columns.values():
            category_scores = scores.by_category.get(name, {})
            row += [
                score_text(category_scores.get("filled")),
                score_text(category_scores.get("items")),
            ]
        rows.append(row)
    heads = [f"{kind}, {name}" for name in columns for kind in ("filled", "items")]
    return markdown_table(["piece", *heads], rows)


def _reader_table(readers: Mapping[str, ReaderScores]) -> str:
    names = [field.name for field in fields(ReaderScores)]
    rows = [
        [name.replace("_", " "), *(_number(getattr(scores, name)) for scores in readers.values())]
        for name in names
    ]
    return markdown_table(["reader", *readers], rows)


def _number(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:.4f}"


def as_data(
    columns: Mapping[str, TableScores], readers: Mapping[str, ReaderScores], made: Made
) -> dict[str, Any]:
    """The same for --json."""
    return {
        **asdict(made),
        "columns": {name: asdict(scores) for name, scores in columns.items()},
        "reader": {name: asdict(scores) for name, scores in readers.items()},
        "targets": TARGETS,
        "missed": missed(columns),
    }


def missed(columns: Mapping[str, TableScores]) -> dict[str, float]:
    """By `column/score`, how far the value is from a target that is not reached."""
    gaps = {}
    for column, scores in columns.items():
        for name, target in TARGETS.items():
            score = scores.rows[name]
            gap = score.value - target if name in _LESS_IS_BETTER else target - score.value
            if score.count and gap > 0:
                gaps[f"{column}/{name}"] = round(gap, 6)
    return gaps


def draw_sheet(parts: Sequence[Sequence[Judged]]) -> bytes:
    """A PNG: for each part a row of tops with what was drawn on them, outlined."""
    rows = []
    for part in parts:
        shown = [_cell(judged) for judged in part[:COLUMNS]]
        shown += [np.full_like(shown[0], 255)] * (COLUMNS - len(shown))
        rows.append(np.concatenate(shown, axis=1))
    return picture_png(np.concatenate(rows))


def _cell(judged: Judged) -> ByteArray:
    """A raster, enlarged, with the outlines of its items and a stroke along each front."""
    image = judged.case.image
    layout = judged.layout or canvas.layout_image(image, judged.raw, Level.TABLE)
    picture = enlarged(layout.rgb, ENLARGE)
    for item in judged.raw:
        corners_px = px_from_m(footprint(item.box), image.frame)
        corners = np.rint(corners_px * ENLARGE).astype(np.int32)
        cv2.polylines(picture, [corners], True, (90, 90, 90), 1, cv2.LINE_AA)
        cv2.polylines(picture, [corners[1:3]], False, (200, 0, 0), 2)
    cut = MARGIN_PX * ENLARGE
    return framed(picture[cut:-cut, cut:-cut])
