"""A house while it is changed as somebody asked, and the best place for a piece in it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from itertools import chain, islice
from typing import Any, Protocol

from chord_usd.base.errors import ChordError
from chord_usd.base.metrics.complete import TABLES
from chord_usd.base.metrics.walk import walk
from chord_usd.base.scene.geometry import footprint_polygon, to_own, to_world
from chord_usd.base.scene.intents import Intent
from chord_usd.base.scene.palette import Level, Mount, category
from chord_usd.base.scene.style_rooms import Part, Wanted
from chord_usd.base.scene.types import Asset, Box, Item, Room, SceneGraph
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.arrange.asked_leeway import Judge, Leeway, flaws, small_things, worse
from chord_usd.line.arrange.asked_places import NEAR_M, Floor
from chord_usd.line.graph.match import Database

TRIED = 48
"""Of the best places, so many are asked whether rooms can still be reached."""


JUDGED = 8
"""Of places without flaws, so many are judged by all that may be worse."""


class Catalogue(Database, Protocol):
    """A database in which one can look around; chord_usd.library.database has it."""

    def of_category(self, name: str, /) -> Sequence[Asset]:
        """The meshes of a category, which need not be on disk."""

    def named(self, asset_id: str, /) -> Asset:
        """The mesh of an id, on disk."""

    def in_style(self, name: str, /) -> Catalogue:
        """The same, with the forms of a style before others."""


@dataclass
class Work:
    """A house while it is changed."""

    graph: SceneGraph
    database: Callable[[], Catalogue]
    """Loads it, when it is first asked."""
    locked: set[str] = field(default_factory=set)
    new: set[str] = field(default_factory=set)
    """Ids of things that were not there before."""
    moved: dict[str, Box] = field(default_factory=dict)
    """Where things stood at first that stand elsewhere now, by id."""
    styles: dict[str, str] = field(default_factory=dict)
    """By id of the rooms that get one."""
    locks: dict[str, bool] = field(default_factory=dict)
    """Things that are locked or unlocked."""
    assets: Mapping[str, Asset] = field(default_factory=dict)
    """The models of what was there before, by id."""
    worn: Mapping[str, str] = field(default_factory=dict)
    """The colourways of what was there before, by id."""
    colours: dict[str, str] = field(default_factory=dict)
    """Colourways that things get, by id."""
    looks: dict[tuple[str, Part], Wanted] = field(default_factory=dict)
    """Looks of walls and floors, by id of the room."""
    notes: list[str] = field(default_factory=list)
    """How what is done differs from what was asked, or says it more exactly; a line each."""
    judge: Judge = worse
    leeway: Leeway = field(default_factory=Leeway)
    """Of the candidate that is tried."""
    start: SceneGraph | None = None
    """The house before what is tried."""
    aside: frozenset[str] = frozenset()
    """Ids of things that may give way to it."""

    def tried(self, intent: Intent, leeway: Leeway) -> Work:
        """A copy to try a candidate on."""
        kept = ("locked", "new", "moved", "styles", "locks", "colours", "looks", "notes")
        copies: dict[str, Any] = {name: copy(getattr(self, name)) for name in kept}
        gives_way = leeway.gives_way
        aside = small_things(self.graph, intent, self.locked) if gives_way else frozenset()
        return replace(self, leeway=leeway, start=self.graph, aside=aside, **copies)

    def floor(self, room_id: str, gone: frozenset[str] = frozenset()) -> Floor:
        """A room to find places in. gone: ids of things that are no obstacles."""
        return Floor(self.graph, self.room(room_id), gone | self.aside)

    def room(self, room_id: str) -> Room:
        return next(room for room in self.graph.rooms if room.id == room_id)

    def item(self, item_id: str) -> Item:
        things = (*self.graph.items, *self.graph.dressing)
        return next(piece for piece in things if piece.id == item_id)

    def put(self, item: Item) -> None:
        """Add a thing, or set it in the place of the one with its id."""
        self.remove([item.id])
        if category(item.category).level is Level.DRESSING:
            self.graph = replace(self.graph, dressing=(*self.graph.dressing, item))
        else:
            self.graph = replace(self.graph, items=(*self.graph.items, item))

    def remove(self, ids: Sequence[str]) -> None:
        gone = set(ids)
        kept = tuple(piece for piece in self.graph.dressing if piece.id not in gone)
        self.graph = replace(self.graph.without(gone), dressing=kept)

    def move(self, item: Item, box: Box, room_id: str = "") -> None:
        """Set a thing elsewhere, with what rests on it."""
        for other in self.resting_on(item.id):
            x, y = to_world(box, to_own(item.box, other.box.center_m[:2]))
            turn_deg = wrap_deg(other.box.yaw_deg + box.yaw_deg - item.box.yaw_deg)
            center_m = (float(x), float(y), other.box.center_m[2])
            self._set(other, replace(other.box, center_m=center_m, yaw_deg=turn_deg), room_id)
        self._set(item, box, room_id)

    def _set(self, item: Item, box: Box, room_id: str) -> None:
        if item.id not in self.new:
            self.moved.setdefault(item.id, item.box)
        self.put(replace(item, box=box, room_id=room_id or item.room_id))

    def resting_on(self, item_id: str) -> list[Item]:
        """Dressing that lies on a thing, and what lies on that."""
        carried = [piece for piece in self.graph.dressing if piece.facts.rests_on == item_id]
        return [*carried, *(below for piece in carried for below in self.resting_on(piece.id))]


def refused(intent: Intent, why: str, expected: str = "", try_: str = "") -> ChordError:
    return ChordError(f"cannot {intent.wording}: {why}", expected=expected, try_=try_)


def called(work: Work, room_id: str) -> str:
    return work.room(room_id).name or room_id


def with_resting(work: Work, group: Sequence[Item]) -> frozenset[str]:
    return frozenset(
        one_id for item in group for one_id in (item.id, *(r.id for r in work.resting_on(item.id)))
    )


Score = Callable[[Item], tuple[float, ...] | None]
"""How well a place is what was asked for, the lower the better; None for not at all."""


def score_of(work: Work, floor: Floor, intent: Intent, old: Item | None = None) -> Score:
    sides = floor.polygon.exterior
    middle = floor.polygon.centroid

    def score(item: Item) -> tuple[float, ...] | None:
        shape = footprint_polygon(item.box)
        if old is not None:
            away_m = math.dist(item.box.center_m[:2], old.box.center_m[:2])
            turned = abs(wrap_deg(item.box.yaw_deg - old.box.yaw_deg))
            return (round(away_m, 1), turned) if away_m < 1.5 else None
        missed_m = floor.misses_m(item, intent.relation, intent.anchors)
        if intent.relation and missed_m > NEAR_M.get(intent.relation, 1.0):
            return None
        if item.category == "chair" and not any(
            piece.category in TABLES and footprint_polygon(piece.box).distance(shape) < 0.1
            for piece in work.graph.items
        ):
            away = 1.0
        else:
            away = 0.0
        wall_m = 0.0 if category(item.category).mount is Mount.UNDERFOOT else sides.distance(shape)
        in_corner = -round(float(shape.centroid.distance(middle)), 1)
        if category(item.category).mount is Mount.UNDERFOOT:
            in_corner = -in_corner
        elif category(item.category).mount is Mount.WALL:
            in_corner = _crowd_m(floor, item)
        return (away, round(missed_m, 1), round(float(wall_m), 1), in_corner)

    return score


def _crowd_m(floor: Floor, item: Item) -> float:
    """How near a thing on a wall is to other things: what hangs alone hangs best."""
    shape = footprint_polygon(item.box)
    near = [shape.distance(footprint_polygon(piece.box)) for piece in floor.things]
    return -round(float(min(near, default=1.0)), 1)


def best_place(work: Work, floor: Floor, item: Item, score: Score) -> Item | None:
    """The item in the best free place that shuts nobody in; rather in one where nothing stands
    wrongly that did not before, and where nothing swings."""
    scored: list[tuple[tuple[float, ...], int, Item]] = []
    for at, box in enumerate(floor.places(item)):
        placed = replace(item, box=box)
        value = score(placed)
        if value is not None:
            scored.append((value, at, placed))
    scored.sort(key=lambda entry: entry[:2])
    scored.sort(key=lambda entry: floor.stops_leaves(entry[2]))
    free = list(islice((piece for _, _, piece in scored if not floor.obstacle_at(piece)), TRIED))
    if not free or category(item.category).mount is not Mount.FLOOR:
        return free[0] if free else None
    known = flaws(work.graph)
    right = [placed for placed in free if flaws(_with(work.graph, placed)) <= known]
    start = work.start or work.graph
    good = (placed for placed in right[:JUDGED]
            if not work.judge(start, _with(work.graph, placed)))  # fmt: skip
    places = chain(good, right, free)
    return next((placed for placed in places if not shuts_in(work, placed)), None)


def _with(graph: SceneGraph, placed: Item) -> SceneGraph:
    rest = (piece for piece in graph.items if piece.id != placed.id)
    return replace(graph, items=(*rest, placed))


def shuts_in(work: Work, placed: Item) -> bool:
    """Whether with a piece in this place fewer rooms can be reached."""
    after = _with(work.graph, placed)
    return len(walk(after).unreachable) > len(walk(work.graph).unreachable)
