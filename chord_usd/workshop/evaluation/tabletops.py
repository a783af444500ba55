"""Scores of the table model: what it lays, before and after items are stood on their pieces.

"Raw" scores are of what is drawn, by list or by pixels, before anything is moved or left out.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import shapely

from chord_usd.base.metrics.detection import edge_errors_m
from chord_usd.base.metrics.fidelity import MAX_TURN_DEG, match_items
from chord_usd.base.metrics.footprints import is_underfoot
from chord_usd.base.metrics.overlap import STACKED_TOLERANCE_M, Overlap, items_overlap
from chord_usd.base.metrics.scores import Score, mean_of, share_of
from chord_usd.base.raster import canvas
from chord_usd.base.raster.relief import Relief, Reliefs
from chord_usd.base.raster.table_top import SIDES
from chord_usd.base.runtime.progress import Progress
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.palette import SUPPORTS, Level
from chord_usd.base.scene.types import Item, LayoutImage
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.graph.match import Database, items_seen
from chord_usd.line.graph.table_items import TopPainter, read_items, read_table_pixels, things_seen
from chord_usd.line.graph.table_place import Laid
from chord_usd.line.graph.tabletop import TopModel
from chord_usd.workshop.data.splits import split_hash
from chord_usd.workshop.data.statistics import total_variation
from chord_usd.workshop.data.tabletops.board import FACING_DEG as SIDE_YAW_DEG
from chord_usd.workshop.evaluation.tabletop_cases import Case

MOST_OVER_EDGE = 0.01
"""An item with more than this share of its footprint beside the top is off its edge."""

FACING = ("all_in_one_computer", "laptop", "dinner_set", "photo_frame", "standing_book")
"""Items that somebody looks at or eats from: they have a right and a wrong way round."""

PAINTED = 0.5
"""Share of its pixels that must have an item's colour for it to be seen at all."""

FACING_DEG = 45.0
"""So far from straight an item still faces a side."""


@dataclass(frozen=True, eq=False)
class Workplace:
    """What it takes to lay tables."""

    model: TopModel
    database: Database
    reliefs: Reliefs
    seed: int = 0


@dataclass(frozen=True, eq=False)
class Judged:
    """One piece with what was drawn for it, and all that came of it."""

    case: Case
    raw: tuple[Item, ...]
    """What was drawn, as it was drawn."""
    laid: Laid
    layout: LayoutImage | None = None
    """The raster that it was read from, if it was painted."""


@dataclass(frozen=True)
class TableScores:
    """One column: scores on one set of pieces."""

    pieces: int
    split: str
    rows: dict[str, Score]
    by_category: dict[str, dict[str, Score]]
    """filled and items, by the category of the piece."""


def drawn(at: Workplace, cases: Sequence[Case], progress: Progress | None = None) -> list[Judged]:
    """What the model lays on each piece; case i gets the seed plus i. Raises AssetError."""
    tops = [case.view.top for case in cases]
    seeds = [at.seed + index for index in range(len(cases))]
    if isinstance(at.model, TopPainter):
        return judge_layouts(at, cases, at.model.layouts(tops, seeds, progress))
    return judge(at, cases, at.model.things(tops, seeds, progress))


def judge_layouts(
    at: Workplace, cases: Sequence[Case], layouts: Sequence[LayoutImage]
) -> list[Judged]:
    """Reads every raster and stands its items on its piece. Raises AssetError."""
    things = [
        things_seen(layout, case.view.item.category)
        for case, layout in zip(cases, layouts, strict=True)
    ]
    judged = judge(at, cases, things)
    return [replace(top, layout=layout) for top, layout in zip(judged, layouts, strict=True)]


def judge(at: Workplace, cases: Sequence[Case], things: Sequence[Sequence[Item]]) -> list[Judged]:
    """Stands things on their pieces. Raises AssetError."""
    return [
        Judged(case, tuple(laid), case.view.laid(laid, at.database, at.reliefs))
        for case, laid in zip(cases, things, strict=True)
    ]


def cpu_seconds(at: Workplace, cases: Sequence[Case]) -> float:
    """Processor time of laying these pieces in one batch, all threads, placing too.

    Processor time is what counts on a machine that is shared.
    """
    started = time.process_time()
    drawn(at, cases)
    return time.process_time() - started


def score_tabletops(judged: Sequence[Judged], at: Workplace) -> TableScores:
    """All scores of these pieces; those that need a truth only where there is one."""
    rows = {**_raw_scores(judged), **_placed_scores(judged, at.reliefs), **_dining(judged)}
    if judged and all(top.case.truth is not None for top in judged):
        rows.update(_beside_data(judged))
    by_category = {}
    for name in SUPPORTS:
        of_category = [top for top in judged if top.case.view.item.category == name]
        if of_category:
            by_category[name] = {"filled": _filled(of_category), "items": _items(of_category)}
    split = split_hash(top.case.id for top in judged)
    return TableScores(len(judged), split, rows, by_category)


def _raw_scores(judged: Sequence[Judged]) -> dict[str, Score]:
    overlaps = [items_overlap(top.raw) for top in judged]
    over_edge = [
        1.0 - top.case.view.relief.free_share(item.box) > MOST_OVER_EDGE
        for top in judged
        for item in top.raw
    ]
    facing = [
        faces_somebody(item, top.case)
        for top in judged
        for item in top.raw
        if item.category in FACING
    ]
    scores = {
        **_overlap_scores(overlaps, ""),
        "off_edge": mean_of(over_edge, "items"),
        "faces_right": mean_of(facing, "items with a right way round"),
    }
    painted = [top for top in judged if top.layout is not None]
    if painted:
        marks = [item.facts.front_from == "mark" for top in painted for item in top.raw]
        scores["front_shown"] = mean_of(marks, "items")
        scores["round_trip"] = mean_of([round_trip(top) for top in painted if top.raw], "pieces")
    return scores


def _dining(judged: Sequence[Judged]) -> dict[str, Score]:
    """Whether dining tables are laid, and at how many of their seats."""
    tables = [table for table in judged if table.case.view.item.category == "dining_table"]
    counts = [
        sum(child.category == "dinner_set" for child in table.laid.children) for table in tables
    ]
    seats = [
        sum(border.kind == "seat" for border in table.case.view.top.borders) for table in tables
    ]
    laid_seats = sum(min(pair) for pair in zip(counts, seats, strict=True))
    return {
        "dining_laid": mean_of([count > 0 for count in counts], "dining tables"),
        "seats_laid": share_of(laid_seats, sum(seats), "seats at dining tables"),
    }


def _beside_data(judged: Sequence[Judged]) -> dict[str, Score]:
    """How what was drawn differs from what the data lays on the same pieces, in all."""
    truths = [top.case.truth or () for top in judged]
    mine, data = (
        Counter(item.category for items in these for item in items)
        for these in ([top.raw for top in judged], truths)
    )
    counts = Counter(len(top.raw) for top in judged), Counter(map(len, truths))
    return {
        "items_of_data": mean_of([float(len(items)) for items in truths], "pieces"),
        "categories_tv": Score(total_variation(mine, data), sum(mine.values()), "items"),
        "counts_tv": Score(total_variation(*counts), len(judged), "pieces"),
    }


def _placed_scores(judged: Sequence[Judged], reliefs: Reliefs) -> dict[str, Score]:
    supported = [
        is_supported(child, top.laid.children, top.case.view.relief, reliefs)
        for top in judged
        for child in top.laid.children
    ]
    kept = sum(len(top.laid.children) for top in judged)
    seen = sum(len(top.laid.seen) for top in judged)
    placed = [items_overlap(top.laid.children) for top in judged]
    return {
        **_overlap_scores(placed, "placed_"),
        "supported": mean_of(supported, "items placed"),
        "left_out": share_of(seen - kept, seen, "items"),
        "filled": _filled(judged),
        "items": _items(judged),
    }


def _overlap_scores(overlaps: Iterable[Overlap], prefix: str) -> dict[str, Score]:
    paired = [overlap for overlap in overlaps if overlap.pairs]
    over = "pieces with a pair of items"
    scores = {
        "por": mean_of([overlap.por for overlap in paired], over),
        "por_all": mean_of([overlap.por_all for overlap in paired], over),
        "piou": mean_of([overlap.piou for overlap in paired], over),
    }
    return {prefix + name: score for name, score in scores.items()}


def _filled(judged: Sequence[Judged]) -> Score:
    return mean_of([bool(top.laid.children) for top in judged], "pieces")


def _items(judged: Sequence[Judged]) -> Score:
    return mean_of([float(len(top.laid.children)) for top in judged], "pieces")


def faces_somebody(item: Item, case: Case) -> bool:
    """Whether an item's front points to a side where somebody sits; where nobody does, to any side
    without a wall."""
    borders = case.view.top.borders
    seats = {border.side for border in borders if border.kind == "seat"}
    walls = {border.side for border in borders if border.kind == "wall"}
    sides = seats or {*SIDES} - walls
    off_deg = (abs(wrap_deg(item.box.yaw_deg - SIDE_YAW_DEG[side])) for side in sides)
    return any(off <= FACING_DEG + 1e-6 for off in off_deg)


def round_trip(judged: Judged) -> float:
    """Share of pixels with the same item where the raster or what was read of it has one."""
    assert judged.layout is not None
    painted = read_table_pixels(judged.layout.rgb, judged.case.view.item.category).item + 1
    again, _ = canvas.draw_items(judged.raw, judged.layout.frame, Level.TABLE)
    either = (painted > 0) | (again > 0)
    return float((painted == again)[either].mean()) if either.any() else 1.0


def is_supported(child: Item, siblings: Sequence[Item], relief: Relief, reliefs: Reliefs) -> bool:
    """Whether an item touches something below, and its middle lies over the hull of the contact
    (metric "unsupported"). Heights are of the meshes."""
    box = child.box
    points = _contact(relief, box, box.center_m[2])
    for other in siblings:
        if other is child or not is_underfoot(other) or other.asset is None:
            continue
        base = other.box
        carrier = reliefs(other.asset).scaled(base.size_m)
        inside = shapely.intersection(footprint_polygon(box), footprint_polygon(base))
        top_m = base.center_m[2] + carrier.level_m
        if abs(top_m - box.center_m[2]) <= STACKED_TOLERANCE_M and inside.area > 0.0:
            points = np.concatenate([points, shapely.get_coordinates(inside)])
    if not len(points):
        return False
    hull = shapely.convex_hull(shapely.multipoints(points)).buffer(STACKED_TOLERANCE_M / 2)
    return bool(hull.contains(shapely.Point(box.center_m[:2])))


def _contact(relief: Relief, box: Any, base_m: float) -> np.ndarray:
    """(N, 2) middles of the cells under a box that are as high as its underside."""
    mask, (rows, columns) = relief.under(box)
    near = mask & (np.abs(relief.heights_m[rows, columns] - base_m) <= STACKED_TOLERANCE_M)
    row, column = np.nonzero(near)
    count_y, count_x = relief.heights_m.shape
    x = ((column + columns.start + 0.5) / count_x - 0.5) * relief.size_m[0]
    y = (0.5 - (row + rows.start + 0.5) / count_y) * relief.size_m[1]
    return np.stack([x, y], axis=1)


@dataclass(frozen=True)
class ReaderScores:
    """Rasters of which it is known what is meant -> items."""

    recall: float
    recall_painted: float
    """Over those items of which at least PAINTED of the pixels still have the right colour. What
    is missing here is the reader's fault; all else is that of whoever drew."""
    precision: float
    orientation: float
    """Share of the items found whose front is within 10 degrees of the truth."""
    quarter: float
    """The same within 45 degrees: small items that lie askew are read as straight."""
    edge_px: float
    """Median distance of an edge from where it should be."""
    edges_within_half_px: float
    truths: int


def score_reader(cases: Sequence[Case], layouts: Sequence[LayoutImage]) -> ReaderScores:
    """How well the items of these cases are read from rasters of them."""
    truths = seen = 0
    turns: list[float] = []
    edges: list[float] = []
    painted_found: list[bool] = []
    for case, layout in zip(cases, layouts, strict=True):
        truth = case.truth or ()
        read = read_items(layout, case.view.item.category)
        mine = items_seen([entry.detection for entry in read], layout.frame)
        truths, seen = truths + len(truth), seen + len(mine)
        pairs = match_items(mine, truth)
        known = {true.id for _, true in pairs}
        painted_found += [item.id in known for item in _painted(case, layout)]
        for piece, true in pairs:
            turns.append(abs(wrap_deg(piece.box.yaw_deg - true.box.yaw_deg)))
            edges += (edge_errors_m(piece.box, true.box) / layout.frame.m_per_px).tolist()
    return ReaderScores(
        recall=len(turns) / max(truths, 1),
        recall_painted=_share(np.array(painted_found)),
        precision=len(turns) / max(seen, 1),
        orientation=_share(np.array(turns) <= MAX_TURN_DEG),
        quarter=_share(np.array(turns) < FACING_DEG),
        edge_px=float(np.median(edges)) if edges else 0.0,
        edges_within_half_px=_share(np.array(edges) <= 0.5),
        truths=truths,
    )


def _painted(case: Case, layout: LayoutImage) -> list[Item]:
    """The true items that a raster still shows."""
    truth = case.truth or ()
    visible, _ = canvas.draw_items(truth, layout.frame, Level.TABLE)
    painted = read_table_pixels(layout.rgb, case.view.item.category).item + 1
    shown = []
    for item in truth:
        alone, _ = canvas.draw_items([item], layout.frame, Level.TABLE)
        pixels = (alone > 0) & (visible == alone)
        if pixels.any() and (painted == visible)[pixels].mean() >= PAINTED:
            shown.append(item)
    return shown


def _share(holds: np.ndarray) -> float:
    return float(holds.mean()) if holds.size else 0.0
