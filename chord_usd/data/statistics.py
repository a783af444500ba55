"""What the paper's data set tables count (CHOrD, supplementary, section on the data set)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from chord_usd.metrics import SceneScores, mean_scores, score_scene
from chord_usd.palette import HOUSE_CATEGORIES
from chord_usd.types import ROOM_KINDS, SceneGraph

PAPER_EMPTY_ROOM_RATE, PAPER_POR, PAPER_PIOU = 0.2902, 0.0044, 0.0018
"""Of the CHOrD data set (paper, table on data quality)."""

PAPER_ROOMS_PER_HOUSE = 9.78


@dataclass
class Statistics:
    """Counts over a set of houses; count adds one house."""

    houses: int = 0
    rooms_per_house: Counter[int] = field(default_factory=Counter)
    """Houses by their number of rooms."""
    rooms: Counter[str] = field(default_factory=Counter)
    """Rooms by kind."""
    non_empty_rooms: Counter[str] = field(default_factory=Counter)
    """Rooms with at least one item, by kind."""
    items: Counter[str] = field(default_factory=Counter)
    """Items by category."""
    scores: list[SceneScores] = field(default_factory=list)

    def count(self, scene: SceneGraph) -> None:
        """Add a house."""
        self.houses += 1
        self.rooms_per_house[len(scene.rooms)] += 1
        occupied = {item.room_id for item in scene.items}
        for room in scene.rooms:
            self.rooms[room.kind] += 1
            self.non_empty_rooms[room.kind] += room.id in occupied
        self.items.update(item.category for item in scene.items)
        self.scores.append(score_scene(scene))

    @property
    def empty_room_rate(self) -> float:
        """Share of rooms without any item (paper); 0 where there is no room."""
        rooms = self.rooms.total()
        return 1.0 - self.non_empty_rooms.total() / rooms if rooms else 0.0

    @property
    def mean_rooms(self) -> float:
        """Rooms per house; 0 where there is no house."""
        return self.rooms.total() / self.houses if self.houses else 0.0

    def as_json(self) -> dict[str, Any]:
        """Plain values; every mean with what it is a mean of."""
        means = mean_scores(self.scores)
        return {
            "houses": self.houses,
            "rooms_per_house": dict(sorted(self.rooms_per_house.items())),
            "mean_rooms_per_house": self.mean_rooms,
            "rooms": dict(self.rooms),
            "non_empty_rooms": dict(self.non_empty_rooms),
            "empty_room_rate": self.empty_room_rate,
            "items": dict(self.items),
            "scores": {
                name: {"value": score.value, "count": score.count, "over": score.over}
                for name, score in means.items()
            },
        }


def count_houses(scenes: Iterable[SceneGraph]) -> Statistics:
    """Statistics of a set of houses."""
    statistics = Statistics()
    for scene in scenes:
        statistics.count(scene)
    return statistics


def as_text(statistics: Statistics) -> str:
    """The tables, for people; the paper's own figures stand beside where it gives them."""
    means = mean_scores(statistics.scores)
    lines = [
        f"{statistics.houses} houses, {statistics.rooms.total()} rooms, "
        f"{statistics.mean_rooms:.2f} per house (paper {PAPER_ROOMS_PER_HOUSE})",
        f"empty room rate {statistics.empty_room_rate:.4f} (paper {PAPER_EMPTY_ROOM_RATE})",
        f"POR {means['por'].value:.4f} (paper {PAPER_POR}), "
        f"PIoU {means['piou'].value:.4f} (paper {PAPER_PIOU}), n = {means['por'].count} houses",
        "",
        f"{'room kind':<28} {'rooms':>7} {'furnished':>9}",
    ]
    lines += [
        f"{kind:<28} {statistics.rooms[kind]:>7} {statistics.non_empty_rooms[kind]:>9}"
        for kind in ROOM_KINDS
        if statistics.rooms[kind]
    ]
    lines += ["", f"{'category':<28} {'items':>7} {'per house':>9}"]
    lines += [
        f"{row.name:<28} {statistics.items[row.name]:>7} "
        f"{statistics.items[row.name] / max(statistics.houses, 1):>9.2f}"
        for row in HOUSE_CATEGORIES
    ]
    lines += ["", f"{'rooms per house':<28} {'houses':>7}"]
    lines += [f"{n:<28} {c:>7}" for n, c in sorted(statistics.rooms_per_house.items())]
    return "\n".join(lines)
