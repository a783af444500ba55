"""All scores of one scene, and their means over a set with what each is a mean of."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from chord_usd.base.metrics.clear_floor import rooms_beside
from chord_usd.base.metrics.complete import Homely, homely_rooms, is_complete, is_right
from chord_usd.base.metrics.overlap import Overlap, scene_overlap
from chord_usd.base.metrics.rooms import empty_rooms, rooms_to_furnish
from chord_usd.base.metrics.violations import Violation, violations
from chord_usd.base.metrics.walk import Walk, walk
from chord_usd.base.scene.types import RoomKind, SceneGraph


@dataclass(frozen=True)
class SceneScores:
    """What metrics say about one scene. Lists name the culprits, so a score can be looked into."""

    overlap: Overlap
    walk: Walk
    items: int
    openings: int
    rooms_to_furnish: int
    empty_rooms: tuple[str, ...]
    homely: tuple[Homely, ...]
    """What the rooms that are judged lack, in their order."""
    violations: tuple[Violation, ...]

    @property
    def out_of_room(self) -> tuple[str, ...]:
        """Ids of pieces that stand beyond the floor of their room."""
        return tuple(
            violation.item for violation in self.violations if violation.kind == "out of room"
        )

    @property
    def blocked_openings(self) -> tuple[str, ...]:
        """Ids of openings that something stands in front of, each once."""
        blocked = (
            violation.other
            for violation in self.violations
            if violation.kind == "before an opening"
        )
        return tuple(dict.fromkeys(blocked))


@dataclass(frozen=True)
class Score:
    """A mean that says what it is a mean of."""

    value: float
    count: int
    """How many of `over` there were; at 0 the value is 0 and means nothing."""
    over: str


def part_of(graph: SceneGraph, room_ids: Collection[str]) -> SceneGraph:
    """The scene that consists of these rooms only, with the openings in their walls.

    Raises KeyError for an id that names no room.
    """
    unknown = set(room_ids) - {room.id for room in graph.rooms}
    if unknown:
        raise KeyError(sorted(unknown)[0])
    rooms = tuple(room for room in graph.rooms if room.id in room_ids)
    beside = zip(graph.openings, rooms_beside(graph.openings, rooms), strict=True)
    return replace(
        graph,
        rooms=rooms,
        openings=tuple(opening for opening, sides in beside if any(sides)),
        items=tuple(item for item in graph.items if item.room_id in room_ids),
        dressing=tuple(item for item in graph.dressing if item.room_id in room_ids),
    )


def rooms_of_kind(graphs: Iterable[SceneGraph], kind: RoomKind) -> Iterator[SceneGraph]:
    """Every room of one kind as a scene of its own (the paper's bedroom and living room rows)."""
    for graph in graphs:
        for room in graph.rooms:
            if room.kind == kind:
                yield part_of(graph, {room.id})


def score_scene(graph: SceneGraph, room_ids: Collection[str] | None = None) -> SceneScores:
    """All scores of a scene, or of some of its rooms."""
    if room_ids is not None:
        graph = part_of(graph, room_ids)
    overlap, homely = scene_overlap(graph), homely_rooms(graph)
    return SceneScores(
        overlap=overlap,
        walk=walk(graph),
        items=len(graph.items),
        openings=len(graph.openings),
        rooms_to_furnish=len(rooms_to_furnish(graph.rooms)),
        empty_rooms=tuple(empty_rooms(graph)),
        homely=tuple(room for room in homely if room.is_judged),
        violations=tuple(violations(graph, overlap=overlap, homely=homely)),
    )


def score_scenes(graphs: Iterable[SceneGraph]) -> dict[str, Score]:
    """Scores of a set of scenes by name.

    Overlap and walking are means over scenes; a scene without any pair of items has no overlap
    ratio and is left out of those, so that empty scenes cannot better them. The others are shares
    of all items, openings and rooms of the set.
    """
    return mean_scores(score_scene(graph) for graph in graphs)


def mean_scores(scores: Iterable[SceneScores]) -> dict[str, Score]:
    """The same, from scenes that were scored already."""
    all_scores = list(scores)
    paired = [s.overlap for s in all_scores if s.overlap.pairs]
    walks = [s.walk for s in all_scores]
    furnished = sum(s.rooms_to_furnish - len(s.empty_rooms) for s in all_scores)
    pairs = "scenes with a pair of items"
    return {
        "por": mean_of([o.por for o in paired], pairs),
        "por_all": mean_of([o.por_all for o in paired], pairs),
        "piou": mean_of([o.piou for o in paired], pairs),
        "piou_all": mean_of([o.piou_all for o in paired], pairs),
        "out_of_room": share_of(
            sum(len(s.out_of_room) for s in all_scores), sum(s.items for s in all_scores), "items"
        ),
        "blocked_openings": share_of(
            sum(len(s.blocked_openings) for s in all_scores),
            sum(s.openings for s in all_scores),
            "openings",
        ),
        "furnished": share_of(
            furnished, sum(s.rooms_to_furnish for s in all_scores), "rooms to furnish"
        ),
        **homely_scores(s.homely for s in all_scores),
        "walkable": mean_of([w.walkable for w in walks], "scenes"),
        "reachable_rooms": mean_of([w.reachable_rooms for w in walks], "scenes"),
    }


def homely_scores(
    houses: Iterable[Sequence[Homely]], kind: RoomKind | None = None
) -> dict[str, Score]:
    """Shares of rooms complete and right, of one kind or of all that are judged."""
    rooms = [room for house in houses for room in house if kind in (None, room.kind)]
    over = "rooms judged"
    return {
        "complete": share_of(sum(room.complete for room in rooms), len(rooms), over),
        "right": share_of(sum(room.right for room in rooms), len(rooms), over),
    }


def homely_house_scores(houses: Iterable[Sequence[Homely]]) -> dict[str, Score]:
    """Shares of houses of which every room is complete, or right."""
    every = list(houses)
    return {
        "complete_houses": share_of(sum(map(is_complete, every)), len(every), "houses"),
        "right_houses": share_of(sum(map(is_right, every)), len(every), "houses"),
    }


def mean_of(values: Sequence[float], over: str) -> Score:
    """The mean of some values; of none it is 0."""
    return Score(sum(values) / len(values) if values else 0.0, len(values), over)


def share_of(part: int, whole: int, over: str) -> Score:
    """How much of a whole a part is; of nothing it is 0."""
    return Score(part / whole if whole else 0.0, whole, over)
