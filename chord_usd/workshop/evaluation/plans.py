"""Drawn plans in many styles, read back: how right, how often refused, how often wrong unsaid."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely

from chord_usd.base.errors import PlanError
from chord_usd.base.metrics.fidelity import plan_fidelity, room_iou
from chord_usd.base.raster.page_labels import PASSAGE, built_of
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.types import (
    Box,
    ByteArray,
    FloatArray,
    Opening,
    PixelFrame,
    Plan,
    Room,
    frozen_array,
)
from chord_usd.base.scene.units import m_from_px, px_from_m, rotation_2d
from chord_usd.workshop.data.drawn.crowded import draw_page
from chord_usd.workshop.data.drawn.page_looks import random_look
from chord_usd.workshop.data.drawn.page_styles import random_style
from chord_usd.workshop.data.drawn.styled_plans import Drawing, draw_in_style, without_seams
from chord_usd.workshop.data.drawn.truth import CrowdedPage
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.data.splits import TEST_SEED
from chord_usd.workshop.evaluation.report import markdown_table


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

_SEED_STEP = 10_000

_RIGHT_IOU = 0.7
"""A house whose rooms overlap the true ones less is wrong."""

_WRONG_SCALE = 0.3
"""So is one so much too large or too small, as a share."""


@dataclass(frozen=True, eq=False)
class Case:
    """A drawing and its truth."""

    family: str
    rgb: ByteArray
    """(H, W, 3)."""
    storeys: tuple[Plan, ...]
    """Metres; rooms that run into each other touch. A reading is held against the nearest."""
    frame: PixelFrame
    """Where the upright drawing lies."""
    to_picture: FloatArray
    """(3, 3) from the upright drawing's continuous pixels to pixels of rgb."""
    recognisable: frozenset[str]
    """Rooms of the truth whose kind is shown."""


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
    """Rooms with a name or a symbol in the drawing; each room of a shared floor counts."""
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
    families: Sequence[str], seed: int, draw: Callable[[str, int, int], Case],
    known: Mapping[int, PlanScore] | None = None,
    keep: Callable[[int, PlanScore], None] | None = None,
) -> list[PlanScore]:  # fmt: skip
    """Draw count plans of every family and read them. Same seed, same drawings.

    families: kinds of crowded pages, or styles of clean drawings. draw: makes the case of a family,
    a seed and a number: crowded or clean. known: scores by the drawing's number, which are not read
    again; keep: called with every new score.
    """
    scores = []
    total = count * len(families)
    for number in range(total):
        score = (known or {}).get(number)
        if score is None:
            family = families[number % len(families)]
            case = draw(family, seed, number)
            score = score_reading(case, reader)
            if keep:
                keep(number, score)
        scores.append(score)
        progress(number + 1, total)
    return scores


def crowded(family: str, seed: int, number: int) -> Case:
    """A crowded page of a kind, of a house that nothing is trained on."""
    number += TEST_SEED + _SEED_STEP * seed
    page = draw_page(number, random_look(np.random.default_rng(number), family))
    return crowded_case(page, family)


def clean(family: str, seed: int, number: int) -> Case:
    """A clean drawing in a style."""
    rng = np.random.default_rng([_FIRST_SEED + seed, number])
    plan = random_plan(rng)
    return clean_case(draw_in_style(plan, random_style(rng, family), rng))


def clean_case(drawing: Drawing) -> Case:
    """A clean drawing and its truth."""
    return Case(
        drawing.style.family, drawing.rgb, (drawing.truth,), drawing.frame, drawing.to_picture,
        drawing.recognisable,
    )  # fmt: skip


def crowded_case(page: CrowdedPage, family: str = "") -> Case:
    """A crowded page and its truth."""
    storeys = tuple(_as_drawn(storey.plan, page) for storey in page.storeys)
    # As coarse as the page is at its middle.
    height, width = page.rgb.shape[:2]
    spots = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]) + np.array([[width / 2], [height / 2]])
    there = np.linalg.inv(page.to_picture) @ np.vstack([spots, np.ones(3)])
    x, y = there[:2] / there[2]
    m_per_px = math.sqrt(abs((x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])))
    frame = PixelFrame(m_per_px, (0.0, 0.0), height)
    to_m = np.array([[m_per_px, 0, 0], [0, -m_per_px, height * m_per_px], [0, 0, 1]])
    known = frozenset(room.id for plan in storeys for room in plan.rooms if room.kind != "unknown")
    return Case(family, page.rgb, storeys, frame, page.to_picture @ to_m, known)


def _as_drawn(plan: Plan, page: CrowdedPage) -> Plan:
    """A door that is drawn without a leaf looks like a passage."""
    built = built_of(page.labels)

    def drawn(opening: Opening) -> Opening:
        x, y, far = page.to_picture @ np.array([*opening.box.center_m[:2], 1.0])
        column, row = int(x / far), int(y / far)
        inside = 0 <= row < built.shape[0] and 0 <= column < built.shape[1]
        is_passage = inside and built[row, column] == PASSAGE
        return replace(opening, kind="passage") if is_passage else opening

    return replace(plan, openings=tuple(map(drawn, plan.openings)))


def score_reading(case: Case, reader: Reader) -> PlanScore:
    """Read one drawing and compare; positions are compared on the paper, not by the read scale."""
    try:
        plan = reader.read(case.rgb)
    except PlanError:
        return PlanScore(case.family, kinds=len(case.recognisable))
    frame = reader.frame_of(plan)
    if frame is None:
        raise ValueError("the reader does not say where its plan lies in the picture")
    placed = _on_paper(plan, frame, reader.straightening(plan, case.rgb.shape), case)
    floors = without_seams(placed)
    storeys = [(storey, without_seams(storey)) for storey in case.storeys]
    truth, true_floors = max(storeys, key=lambda pair: room_iou(floors, pair[1]))
    fidelity = plan_fidelity(floors, true_floors)
    parts = (fidelity.doors, fidelity.windows, fidelity.passages)
    total = sum(part.read + part.truth for part in parts)
    right = sum(2 * part.read_matched for part in parts)
    known = [room for room in truth.rooms if room.id in case.recognisable]
    return PlanScore(
        case.family, refused=False, walls=fidelity.walls.value,
        openings=right / total if total else 1.0, room_iou=fidelity.room_iou,
        kinds_right=sum(_is_kind_right(placed, room) for room in known), kinds=len(known),
        scale_error=abs(frame.m_per_px / case.frame.m_per_px - 1.0),
        warned=bool(plan.extra.get("warnings")),
    )  # fmt: skip


def _on_paper(plan: Plan, frame: PixelFrame, straight: FloatArray, case: Case) -> Plan:
    """The plan in the drawing's own metres: back into the picture, and from there on the paper."""
    matrix = np.linalg.inv(straight @ case.to_picture)

    def moved(points: np.ndarray) -> np.ndarray:  # type: ignore[type-arg]
        pixels = px_from_m(points, frame)
        paper = np.concatenate([pixels, np.ones((*pixels.shape[:-1], 1))], axis=-1) @ matrix.T
        return m_from_px(paper[..., :2] / paper[..., 2:], case.frame)

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


def _is_kind_right(plan: Plan, room: Room) -> bool:
    """Whether most of a room is of its kind."""
    floor = room_polygon(room)
    alike = shapely.union_all(
        [room_polygon(other) for other in plan.rooms if other.kind == room.kind]
    )
    return bool(alike.intersection(floor).area > floor.area / 2)


# Report ------------------------------------------------------------------------------------------


def summaries(scores: Sequence[PlanScore]) -> dict[str, dict[str, float]]:
    """Means per family and over all; every figure is over all drawings of the row."""
    families = list(dict.fromkeys(score.family for score in scores))
    rows = {name: [s for s in scores if s.family == name] for name in families}
    return {
        name: _summary(family_scores)
        for name, family_scores in {**rows, "all": list(scores)}.items()
    }


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
