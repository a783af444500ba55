"""How many pieces rooms have, beside what the data's own furnisher puts into the same rooms."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence

import numpy as np

from chord_usd.base.metrics.scores import Score
from chord_usd.base.scene.types import RoomKind, SceneGraph
from chord_usd.workshop.data.statistics import total_variation
from chord_usd.workshop.evaluation.cases import Case

_SEEDS = (1, 2)
"""Of the furnisher: what two of its own furnishings differ by is what chance alone gives."""


def piece_scores(
    scenes: Sequence[SceneGraph],
    cases: Sequence[Case],
    kinds: Sequence[RoomKind],
    median_of: Sequence[RoomKind],
) -> dict[RoomKind | None, dict[str, Score]]:
    """The median number of pieces a room, and the total variation between the histograms of these
    numbers here and in the data, for each kind of room; under None over all kinds, by their rooms.

    pieces_tv_floor: between two furnishings of the data. median_of: of kinds, those that the median
    over all looks at.
    """
    mine = _counts(scenes, kinds)
    data, again = (
        _counts((case.truth(seed) for case in cases if case.furnished is None), kinds)
        for seed in _SEEDS
    )
    rows: dict[RoomKind | None, dict[str, Score]] = {}
    for kind in kinds:
        rows[kind] = {
            "pieces_median": _median(mine[kind]),
            "pieces_tv": _variation(mine[kind], data[kind]),
            "pieces_tv_floor": _variation(again[kind], data[kind]),
        }
    together = sum((mine[kind] for kind in median_of), Counter[int]())
    whole = {"pieces_median": _median(together)}
    for name in ("pieces_tv", "pieces_tv_floor"):
        whole[name] = _mean([rows[kind][name] for kind in kinds])
    return {None: whole, **rows}


def _counts(
    scenes: Iterable[SceneGraph], kinds: Sequence[RoomKind]
) -> dict[RoomKind, Counter[int]]:
    """By kind, how many rooms have how many pieces."""
    found: dict[RoomKind, Counter[int]] = {kind: Counter() for kind in kinds}
    for scene in scenes:
        pieces = Counter(item.room_id for item in scene.items)
        for room in scene.rooms:
            if room.kind in found:
                found[room.kind][pieces[room.id]] += 1
    return found


def _median(counts: Counter[int]) -> Score:
    rooms = sorted(counts.elements())
    return Score(float(np.median(rooms)) if rooms else 0.0, len(rooms), "rooms")


def _variation(mine: Counter[int], data: Counter[int]) -> Score:
    known = mine.total() if data else 0
    return Score(total_variation(mine, data) if known else 0.0, known, "rooms")


def _mean(scores: Sequence[Score]) -> Score:
    """By rooms."""
    rooms = sum(score.count for score in scores)
    total = sum(score.value * score.count for score in scores)
    return Score(total / rooms if rooms else 0.0, rooms, "rooms")
