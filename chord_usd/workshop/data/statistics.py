"""What the paper's data set tables count, ours beside theirs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, TypeVar

from chord_usd.base.metrics import SceneScores, mean_scores, score_scene
from chord_usd.base.scene.palette import HOUSE_CATEGORIES
from chord_usd.base.scene.types import ROOM_KINDS, SceneGraph
from chord_usd.workshop.data import paper_tables as paper

Key = TypeVar("Key", str, int)


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

    @property
    def category_distance(self) -> float:
        """Total variation distance to the paper's histogram of its 26 categories, in [0, 1]."""
        counted = {name: self.items[name] for name in paper.ITEMS}
        return total_variation(counted, paper.ITEMS)

    @property
    def room_count_distance(self) -> float:
        """The same for its histogram of rooms per house."""
        return total_variation(self.rooms_per_house, paper.ROOM_COUNTS)

    def non_empty_of_group(self, group: str) -> int:
        """Non-empty rooms that fall under a row of the paper's table of them."""
        return sum(self.non_empty_rooms[kind] for kind in paper.ROOM_GROUPS[group])

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
            "distance_to_paper": {
                "categories": self.category_distance,
                "rooms_per_house": self.room_count_distance,
            },
            "scores": {
                name: {"value": score.value, "count": score.count, "over": score.over}
                for name, score in means.items()
            },
        }


def total_variation(counts: Mapping[Key, int], others: Mapping[Key, int]) -> float:
    """Half the sum of differences between two histograms scaled to one, in [0, 1].

    An empty histogram is as far from any other as can be: 1.0.
    """
    total, other_total = sum(counts.values()), sum(others.values())
    if not total or not other_total:
        return 1.0
    keys = counts.keys() | others.keys()
    return (
        sum(abs(counts.get(k, 0) / total - others.get(k, 0) / other_total) for k in sorted(keys))
        / 2
    )


def count_houses(scenes: Iterable[SceneGraph]) -> Statistics:
    """Statistics of a set of houses."""
    statistics = Statistics()
    for scene in scenes:
        statistics.count(scene)
    return statistics


def as_text(statistics: Statistics) -> str:
    """The tables, for people; the paper's own figures stand beside where it gives them."""
    return "\n\n".join(
        "\n".join(lines)
        for lines in (
            _summary(statistics),
            _room_table(statistics),
            _non_empty_table(statistics),
            _category_table(statistics),
            _room_count_table(statistics),
        )
    )


def _summary(statistics: Statistics) -> list[str]:
    means = mean_scores(statistics.scores)
    stated = sum(paper.NON_EMPTY_ROOMS.values()) / sum(n * c for n, c in paper.ROOM_COUNTS.items())
    return [
        f"{statistics.houses} houses, {statistics.rooms.total()} rooms, "
        f"{statistics.mean_rooms:.2f} per house (paper {paper.ROOMS_PER_HOUSE})",
        f"empty room rate {statistics.empty_room_rate:.4f} (paper {paper.EMPTY_ROOM_RATE}; "
        f"{1.0 - stated:.4f} by its own table of non-empty rooms)",
        f"POR {means['por'].value:.4f} (paper {paper.POR}), "
        f"PIoU {means['piou'].value:.4f} (paper {paper.PIOU}), n = {means['por'].count} houses",
        f"furnished rooms {means['furnished'].value:.4f}, n = {means['furnished'].count} "
        f"{means['furnished'].over}",
        f"total variation distance to the paper: categories {statistics.category_distance:.4f}, "
        f"rooms per house {statistics.room_count_distance:.4f}",
    ]


def _room_table(statistics: Statistics) -> list[str]:
    return [
        f"{'room kind':<28} {'rooms':>7} {'non-empty':>9}",
        *(
            f"{kind:<28} {statistics.rooms[kind]:>7} {statistics.non_empty_rooms[kind]:>9}"
            for kind in ROOM_KINDS
            if statistics.rooms[kind]
        ),
    ]


def _non_empty_table(statistics: Statistics) -> list[str]:
    houses = max(statistics.houses, 1)
    return [
        f"{'non-empty rooms per house':<28} {'ours':>7} {'paper':>9}",
        *(
            f"{' and '.join(kinds):<28} {statistics.non_empty_of_group(group) / houses:>7.2f} "
            f"{paper.NON_EMPTY_ROOMS[group] / paper.HOUSES:>9.2f}"
            for group, kinds in paper.ROOM_GROUPS.items()
        ),
    ]


def _category_table(statistics: Statistics) -> list[str]:
    """Shares are over the paper's 26 categories on both sides."""
    houses = max(statistics.houses, 1)
    ours = max(sum(statistics.items[name] for name in paper.ITEMS), 1)
    theirs = sum(paper.ITEMS.values())
    lines = [
        f"{'category':<28} {'items':>7} {'per house':>9} {'paper':>7} {'share':>7} {'paper':>7}"
    ]
    for row in HOUSE_CATEGORIES:
        count = statistics.items[row.name]
        line = f"{row.name:<28} {count:>7} {count / houses:>9.2f}"
        if row.name in paper.ITEMS:
            stated = paper.ITEMS[row.name]
            line += f" {stated / paper.HOUSES:>7.2f} {count / ours:>7.4f} {stated / theirs:>7.4f}"
        lines.append(line)
    return lines


def _room_count_table(statistics: Statistics) -> list[str]:
    houses = max(statistics.houses, 1)
    stated = sum(paper.ROOM_COUNTS.values())
    return [
        f"{'rooms per house':<28} {'houses':>7} {'share':>9} {'paper':>7}",
        *(
            f"{n:<28} {statistics.rooms_per_house[n]:>7} "
            f"{statistics.rooms_per_house[n] / houses:>9.4f} "
            f"{paper.ROOM_COUNTS.get(n, 0) / stated:>7.4f}"
            for n in sorted(paper.ROOM_COUNTS.keys() | statistics.rooms_per_house.keys())
        ),
    ]
