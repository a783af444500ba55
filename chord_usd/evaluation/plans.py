"""Drawn plans in many styles, read back: how right, how often refused, how often wrong unsaid."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from chord_usd.data.drawn.draw import Drawing, draw_in_style
from chord_usd.data.drawn.styles import FAMILIES, random_style
from chord_usd.data.houses import random_plan
from chord_usd.errors import PlanError
from chord_usd.evaluation.report import markdown_table
from chord_usd.geometry import room_polygon
from chord_usd.metrics.fidelity import plan_fidelity, room_iou
from chord_usd.progress import Progress
from chord_usd.types import Box, ByteArray, FloatArray, PixelFrame, Plan, Room, frozen_array
from chord_usd.units import m_from_px, px_from_m, rotation_2d


@dataclass(frozen=True)
class Reader:
    """What is scored."""

    read: Callable[[ByteArray], Plan]
    """RGB (H, W, 3) -> plan; raises PlanError."""
    frame_of: Callable[[Plan], PixelFrame | None]
    """Where the picture lies that a plan was read from, once straightened."""
    straightening: Callable[[Plan, tuple[int, ...]], FloatArray]
    """(3, 3) from continuous pixels of a picture of a shape (H, W) to those once straightened."""


_FIRST_SEED = 900_000
"""Far from the seeds that houses are trained on."""

_RIGHT_IOU = 0.7
"""A house whose rooms overlap the true ones less is wrong."""

_WRONG_SCALE = 0.3
"""So is one so much too large or too small, as a share."""

_SAME_ROOM_IOU = 0.5


@dataclass(frozen=True)
class PlanScore:
    """One drawing, read. Scores of a refused one are 0."""

    family: str
    refused: bool = True
    walls: float = 0.0
    openings: float = 0.0
    """F1 over doors, windows and passages together."""
    room_iou: float = 0.0
    kinds_right: int = 0
    kinds: int = 0
    """Rooms with a name or a symbol in the drawing."""
    scale_error: float = 0.0
    """|metres per pixel / truth - 1|."""
    warned: bool = False

    @property
    def wrong_in_silence(self) -> bool:
        """A wrong house without a word."""
        is_wrong = self.room_iou < _RIGHT_IOU or self.scale_error > _WRONG_SCALE
        return is_wrong and not self.refused and not self.warned


def measure_reading(
    reader: Reader, count: int, progress: Progress,
    families: Sequence[str] = FAMILIES, seed: int = 0,
    known: Mapping[int, PlanScore] | None = None,
    keep: Callable[[int, PlanScore], None] | None = None,
) -> list[PlanScore]:  # fmt: skip
    """Draw count plans of every family and read them. Same seed, same drawings.

    known: scores by the drawing's number, which are not read again; keep: told of every new one.
    """
    scores = []
    total = count * len(families)
    for number in range(total):
        score = (known or {}).get(number)
        if score is None:
            rng = np.random.default_rng([_FIRST_SEED + seed, number])
            plan = random_plan(rng)
            style = random_style(rng, families[number % len(families)])
            drawing = draw_in_style(plan, style, rng)
            score = score_reading(drawing, reader)
            if keep:
                keep(number, score)
        scores.append(score)
        progress(number + 1, total)
    return scores


def score_reading(drawing: Drawing, reader: Reader) -> PlanScore:
    """Read one drawing and compare; positions are compared on the paper, not by the read scale."""
    kinds = len(drawing.told)
    try:
        plan = reader.read(drawing.rgb)
    except PlanError:
        return PlanScore(drawing.style.family, kinds=kinds)
    frame = reader.frame_of(plan)
    if frame is None:
        raise ValueError("the reader does not tell where its plan lies in the picture")
    placed = _on_paper(plan, frame, reader.straightening(plan, drawing.rgb.shape), drawing)
    fidelity = plan_fidelity(placed, drawing.truth)
    parts = (fidelity.doors, fidelity.windows, fidelity.passages)
    total = sum(part.found + part.truth for part in parts)
    right = sum(2 * part.found_right for part in parts)
    return PlanScore(
        drawing.style.family, refused=False, walls=fidelity.walls.value,
        openings=right / total if total else 1.0, room_iou=room_iou(placed, drawing.truth),
        kinds_right=_kinds_right(placed, drawing), kinds=kinds,
        scale_error=abs(frame.m_per_px / drawing.frame.m_per_px - 1.0),
        warned=bool(plan.extra.get("warnings")),
    )  # fmt: skip


def _on_paper(plan: Plan, frame: PixelFrame, straight: FloatArray, drawing: Drawing) -> Plan:
    """The plan in the drawing's own metres: back into the picture, and from there on the paper."""
    matrix = np.linalg.inv(straight @ drawing.to_picture)

    def moved(points: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
        pixels = px_from_m(points, frame)
        paper = np.concatenate([pixels, np.ones((*pixels.shape[:-1], 1))], axis=-1) @ matrix.T
        return m_from_px(paper[..., :2] / paper[..., 2:], drawing.frame)

    rooms = tuple(replace(r, polygon_m=frozen_array(moved(r.polygon_m))) for r in plan.rooms)
    openings = tuple(replace(o, box=_moved_box(o.box, moved)) for o in plan.openings)
    return Plan(rooms, openings)


def _moved_box(box: Box, moved: Callable[[np.ndarray], np.ndarray]) -> Box:  # type: ignore[type-arg]
    """The box with its ends where these are moved."""
    length, width, height = box.size_m
    middle = np.array(box.center_m[:2])
    half = rotation_2d(box.yaw_deg) @ np.array([length / 2, 0.0])
    start, stop = moved(np.stack([middle - half, middle + half]))
    (x, y), (dx, dy) = (start + stop) / 2, stop - start
    long = math.hypot(dx, dy)
    size = long, width * long / length, height
    return Box((float(x), float(y), box.center_m[2]), size, math.degrees(math.atan2(dy, dx)))


def _kinds_right(plan: Plan, drawing: Drawing) -> int:
    return sum(
        any(found.kind == room.kind and _iou(found, room) > _SAME_ROOM_IOU for found in plan.rooms)
        for room in drawing.truth.rooms
        if room.id in drawing.told
    )


def _iou(one: Room, other: Room) -> float:
    first, second = room_polygon(one), room_polygon(other)
    shared = first.intersection(second).area
    return float(shared / (first.area + second.area - shared))


# Report ------------------------------------------------------------------------------------------


def summaries(scores: Sequence[PlanScore]) -> dict[str, dict[str, float]]:
    """Means per family and over all; every figure is over all drawings of the row."""
    families = list(dict.fromkeys(score.family for score in scores))
    rows = {name: [s for s in scores if s.family == name] for name in families}
    return {name: _summary(own) for name, own in {**rows, "all": list(scores)}.items()}


def _summary(scores: Sequence[PlanScore]) -> dict[str, float]:
    read = [score for score in scores if not score.refused]
    kinds = sum(score.kinds for score in scores)
    return {
        "plans": len(scores),
        "read": len(read),
        "wall_f1": float(np.mean([s.walls for s in scores])),
        "opening_f1": float(np.mean([s.openings for s in scores])),
        "room_iou": float(np.mean([s.room_iou for s in scores])),
        "kind": sum(s.kinds_right for s in scores) / kinds if kinds else 0.0,
        "scale_error": float(np.median([s.scale_error for s in read])) if read else 0.0,
        "wrong_in_silence": sum(s.wrong_in_silence for s in scores),
    }


def as_markdown(scores: Sequence[PlanScore]) -> str:
    """The table of summaries."""
    head = ["style", "plans", "read", "wall F1", "opening F1", "room IoU", "kind", "scale error",
            "wrong in silence"]  # fmt: skip
    return markdown_table(head, [_row(name, row) for name, row in summaries(scores).items()])


def _row(name: str, row: Mapping[str, Any]) -> list[str]:
    counts = [f"{row[key]:.0f}" for key in ("plans", "read")]
    means = [f"{row[key]:.3f}" for key in ("wall_f1", "opening_f1", "room_iou", "kind")]
    return [name, *counts, *means, f"{row['scale_error']:.1%}", f"{row['wrong_in_silence']:.0f}"]
