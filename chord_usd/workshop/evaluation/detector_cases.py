"""Layouts whose furniture is known: drawn ones by construction, generated ones by their colours."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from chord_usd.base.raster import canvas
from chord_usd.base.raster.raster_files import read_layout
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.types import Item, LayoutImage, Plan
from chord_usd.line.graph.match import items_seen
from chord_usd.line.graph.snap import decode_items
from chord_usd.line.layout.device import in_batches
from chord_usd.line.layout.sample import LayoutModel
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED

BATCH = 6


@dataclass(frozen=True, eq=False)
class Case:
    """One layout raster and what is in it."""

    name: str
    layout: LayoutImage
    items: tuple[Item, ...]
    plan: Plan | None
    """None where only the picture is known."""
    shaded: bool
    """Whether the floors show the kinds of the rooms."""


def clean_cases(count: int) -> Iterator[Case]:
    """Drawings of the first held-out houses, every second one unshaded."""
    for index in range(count):
        rng = np.random.default_rng(TEST_SEED + index)
        graph = furnish(random_plan(rng), rng)
        shaded = index % 2 == 0
        layout = canvas.layout_image(canvas.draw_plan(graph.plan, shade=shaded), graph.items)
        yield Case(f"{TEST_SEED + index}", layout, graph.items, graph.plan, shaded)


def generated_cases(
    model: LayoutModel, count: int, steps: int | None = None, progress: Progress | None = None
) -> Iterator[Case]:
    """Samples of the layout model for the first held-out plans, every second one unshaded.

    Nobody drew these, so what their colours say, read without the networks, is the truth.
    """
    plans = [random_plan(np.random.default_rng(TEST_SEED + index)) for index in range(count)]

    def paint(indices: Sequence[int]) -> list[LayoutImage]:
        images = [canvas.draw_plan(plans[index], shade=index % 2 == 0) for index in indices]
        return model.sample_batch(images, seeds=indices, steps=steps)

    for index, layout in enumerate(in_batches(paint, range(count), BATCH)):
        name = f"{TEST_SEED + index}"
        yield Case(name, layout, read_by_colour(layout), plans[index], index % 2 == 0)
        if progress:
            progress(index + 1, count)


def cases_of_files(files: Sequence[Path]) -> Iterator[Case]:
    """Layout rasters of anybody's; their colours are the truth. Raises SceneError."""
    for file in files:
        layout = read_layout(file)
        yield Case(file.stem, layout, read_by_colour(layout), None, False)


def read_by_colour(layout: LayoutImage) -> tuple[Item, ...]:
    """Items by colour alone, without room."""
    return items_seen(decode_items(layout), layout.frame)
