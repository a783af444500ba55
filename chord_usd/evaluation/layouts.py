"""Scores of the layout model's raw output: nothing repairs a layout between model and metric."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from chord_usd import raster
from chord_usd.data.furnish import furnish
from chord_usd.data.houses import random_plan
from chord_usd.data.splits import TEST_SEED, split_hash
from chord_usd.graph.extract import extract_graph
from chord_usd.layout.sample import LayoutModel
from chord_usd.metrics.rooms import empty_rooms, is_to_furnish
from chord_usd.metrics.scores import Score, rooms_of_kind, score_scenes
from chord_usd.types import Plan, RoomKind, SceneGraph

MUST_FURNISH: tuple[RoomKind, ...] = ("living", "bedroom", "kitchen", "bathroom")
"""A house is furnished when none of these stands empty."""

BATCH = 8

Progress = Callable[[int, int], None]


@dataclass(frozen=True)
class LayoutScores:
    """One evaluation: a row of scores per part of the house, and what they were measured on."""

    rows: dict[str, dict[str, Score]]
    """By part: house, bedroom, living, ...; then by score name (metrics.scores.score_scenes)."""
    furnished_houses: Score
    """Share of houses in which every room of MUST_FURNISH holds an item of its kind."""
    items_per_house: Score
    split: str
    checkpoint: str
    steps: int


def held_out_plans(count: int) -> list[Plan]:
    """The first plans of the procedural test range; training never draws from it."""
    return [random_plan(np.random.default_rng(TEST_SEED + index)) for index in range(count)]


def procedural_scenes(plans: Sequence[Plan], seed: int = 0) -> list[SceneGraph]:
    """What the training data's own furnisher puts into these plans: the score to reach."""
    return [furnish(plan, np.random.default_rng((seed, index))) for index, plan in enumerate(plans)]


def sampled_scenes(
    model: LayoutModel,
    plans: Sequence[Plan],
    *,
    shaded: bool,
    seed: int = 0,
    steps: int | None = None,
    progress: Progress | None = None,
) -> Iterator[SceneGraph]:
    """Samples a layout for every plan and reads the items back; rooms come from the plan."""
    for start in range(0, len(plans), BATCH):
        part = plans[start : start + BATCH]
        images = [raster.draw_plan(plan, shade=shaded) for plan in part]
        seeds = [seed + start + index for index in range(len(part))]
        layouts = model.sample_batch(images, seeds=seeds, steps=steps)
        for layout, plan in zip(layouts, part, strict=True):
            yield extract_graph(layout, plan=plan)
        if progress:
            progress(min(start + BATCH, len(plans)), len(plans))


def score_layouts(
    scenes: Sequence[SceneGraph], split_ids: Sequence[str], checkpoint: str, steps: int
) -> LayoutScores:
    """All rows of the table for these scenes.

    split_ids: one id per plan, in order; their hash is printed beside the scores.
    """
    rows = {"house": score_scenes(scenes)}
    for kind in MUST_FURNISH:
        rows[kind] = score_scenes(rooms_of_kind(scenes, kind))
    furnished = [_is_furnished(scene) for scene in scenes]
    items = [len(scene.items) for scene in scenes]
    return LayoutScores(
        rows=rows,
        furnished_houses=Score(float(np.mean(furnished)), len(scenes), "houses"),
        items_per_house=Score(float(np.mean(items)), len(scenes), "houses"),
        split=split_hash(split_ids),
        checkpoint=checkpoint,
        steps=steps,
    )


def _is_furnished(scene: SceneGraph) -> bool:
    empty = set(empty_rooms(scene))
    return not any(
        room.id in empty
        for room in scene.rooms
        if room.kind in MUST_FURNISH and is_to_furnish(room)
    )


def as_markdown(scores: LayoutScores) -> str:
    """The table that goes into the model card, each figure with its denominator."""
    names = list(scores.rows["house"])
    lines = [
        f"split {scores.split}, checkpoint {scores.checkpoint}, {scores.steps} steps; "
        f"furnished houses {_text(scores.furnished_houses)}; "
        f"items per house {_text(scores.items_per_house)}",
        "",
        "| part | " + " | ".join(names) + " |",
        "|---|" + "---|" * len(names),
    ]
    for part, row in scores.rows.items():
        lines.append(f"| {part} | " + " | ".join(_text(row[name]) for name in names) + " |")
    return "\n".join(lines) + "\n"


def _text(score: Score) -> str:
    return f"{score.value:.4f} (n = {score.count} {score.over})"
