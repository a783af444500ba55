"""Evaluations as Markdown, JSON and PNG plots, each figure with what it is a mean of."""

from __future__ import annotations

import io
import json
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from chord_usd.base.metrics.scores import Score
from chord_usd.base.runtime.files import deliver
from chord_usd.base.scene.types import ByteArray

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def markdown_table(head: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """A table; lines end with a line break."""
    lines = ["| " + " | ".join(row) + " |" for row in (head, ["---"] * len(head), *rows)]
    return "\n".join(lines) + "\n"


def score_text(score: Score | None) -> str:
    """`0.0021 (20)`: the value and its count; nothing where there is none."""
    if score is None:
        return ""
    if not score.count:
        return "- (0)"
    return f"{number_text(score.value)} ({score.count})"


def number_text(value: float) -> str:
    """Four decimals, more for what would vanish, fewer for what is large."""
    if value and abs(value) < 0.001:
        return f"{value:.2e}"
    return f"{value:.4f}" if abs(value) < 100 else f"{value:.1f}"


def new_figure(columns: int, rows: int = 1, size_in: tuple[float, float] = (4.5, 3.2)) -> Figure:
    """A figure with a grid of axes, drawn without any window."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure((size_in[0] * columns, size_in[1] * rows), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    figure.subplots(rows, columns, squeeze=False)
    return figure


def figure_png(figure: Figure) -> bytes:
    """The figure as a PNG; the same figure gives the same bytes."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", metadata={"Software": ""})
    return buffer.getvalue()


def enlarged(rgb: ByteArray, times: int) -> ByteArray:
    """(times H, times W, 3) the picture with a square for each pixel."""
    return rgb.repeat(times, axis=0).repeat(times, axis=1)


def framed(rgb: ByteArray) -> ByteArray:
    """The picture with a thin grey line round it, for a sheet of several."""
    return np.pad(rgb, ((2, 2), (2, 2), (0, 0)), constant_values=150)


def picture_png(rgb: ByteArray) -> bytes:
    """An (H, W, 3) picture as a PNG."""
    from PIL import Image

    buffer = io.BytesIO()
    Image.fromarray(rgb).save(buffer, format="png")
    return buffer.getvalue()


def write_report(
    path: Path, markdown: str, data: Mapping[str, Any], pictures: Mapping[str, bytes]
) -> list[Path]:
    """Writes path (Markdown), the same name with .json, and a PNG per picture, all or none.

    pictures: by what is added to the name; "" gives the name itself. Returns the paths. Raises
    OutputError.
    """
    stem = path.with_suffix("")
    contents: dict[Path, bytes] = {
        path: markdown.encode(),
        stem.with_suffix(".json"): (json.dumps(data, indent=1) + "\n").encode(),
    }
    for name, png in pictures.items():
        contents[stem.with_name(stem.name + (f"_{name}" if name else "") + ".png")] = png
    with ExitStack() as stack:
        delivery = stack.enter_context(deliver())
        for target, content in contents.items():
            delivery.place(target, asked=target == path).write_bytes(content)
    return list(contents)
