"""What settling and painting lost: pieces that lists placed are placed again on free floor, and
what rooms and home then lack by planning rules is added, where nothing gets worse."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import cached_property, partial
from itertools import count

import numpy as np

from chord_usd.base.metrics.clear_floor import ClearFloors, clearances
from chord_usd.base.metrics.complete import table_of
from chord_usd.base.metrics.design.price import (
    FAULT,
    broken_share,
    conflicts,
    home_price,
    quick_price,
    room_prices,
    tight,
)
from chord_usd.base.metrics.design.shell import TOUCH_M
from chord_usd.base.metrics.design.shut_leaves import stuck
from chord_usd.base.metrics.design.view import View, view_home
from chord_usd.base.metrics.rooms import is_to_furnish
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.metrics.violations import room_faults
from chord_usd.base.places.free_places import first_pieces
from chord_usd.base.places.wall_frames import out_of_walls
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.types import Edit, Item, Room, SceneGraph
from chord_usd.line.lists.changes import Change, Propose, but, loose, placed_again
from chord_usd.line.lists.dining_changes import Compose
from chord_usd.line.lists.improve import LEAST_GAIN, improved
from chord_usd.line.lists.other_places import changes_of
from chord_usd.line.lists.repairs import lacking, repairs

RULE = "placed again"
"""Name of the edit in pieces that were added or changed."""

_ROUNDS = 2
"""Of changes to a room: one may make place for another."""
_EMPTY = 9.0
"""More than any piece costs."""
_BESIDE_M = 0.3
"""Rooms no farther away share walls or open borders with a room."""


def put_back(
    graph: SceneGraph,
    listed: SceneGraph,
    rooms: Collection[str],
    decided: Collection[str],
    finish: Callable[[SceneGraph], SceneGraph],
    *,
    is_searched: bool = False,
    compose: Compose | None = None,
) -> SceneGraph:
    """The finished house with lost pieces in their rooms.

    listed: the pieces of lists. rooms: ids of those that are looked at. decided: of these where
    somebody else says what they hold: nothing but lost pieces is added. finish: leaves out what
    must not stand; a room that it takes pieces from stays as it was unless it costs less.
    is_searched: whether the lists went through here: what they lack is not looked for again.
    compose: makes a kitchen's units beside pieces that stay.
    """
    work = _Work(graph)
    before = view_home(listed) if is_searched else None
    for at, view in enumerate(work.home.rooms):
        if view.shell.room.id not in rooms:
            continue
        wanted = listed.items_of(view.shell.room.id)
        work.change(at, (placed_again(item) for item in lost(view.items, wanted)), gain=0.0)
        if view.shell.room.id in decided:
            continue
        for _ in range(_ROUNDS):
            now = work.home.rooms[at]
            if before and broken_share(now) <= broken_share(before.rooms[at]):
                break
            if not work.change(at, changes_of(now)):
                break
        work.mend(at)
        work.change(at, [without_stuck], gain=-_EMPTY)
        work.change(at, [without_strays], gain=-_EMPTY, mends=True)
    work.furnish_empty(set(rooms) - set(decided))
    work.repair(set(rooms) - set(decided), lacking(before) if before else (), compose)
    finished = _finished(graph, work.made(), finish)
    # All that a room held may shut the ways through it, which something smaller does not.
    emptied = {item.room_id for item in graph.items} - {item.room_id for item in finished.items}
    if bare := emptied & set(rooms) - set(decided):
        work = _Work(finished)
        work.furnish_empty(bare)
        finished = _finished(finished, work.made(), finish)
    return finished


class _Work:
    """A home while its rooms change."""

    def __init__(self, graph: SceneGraph) -> None:
        self.home = self._before = view_home(graph)
        self._graph = graph
        self._permits: dict[int, _Permits] = {}

    def change(
        self, at: int, changes: Iterable[Propose], gain: float = LEAST_GAIN, *, mends: bool = False
    ) -> bool:
        """Whether any of these changes to a room was worth it. mends: with what faults cost."""
        view, home = self.home.rooms[at], self.home
        permits = self._permits_of(at)

        def cost(room: View) -> float:
            return home_price(replace(home, rooms=(*home.rooms[:at], room, *home.rooms[at + 1 :])))

        def cheaper(room: View) -> bool:
            return price(room) < price(view)

        def price(room: View) -> float:
            return FAULT * permits.faults(room.items) + quick_price(room) + cost(room)

        better = improved(view, cost, changes, cheaper if mends else permits, gain)
        if better is view:
            return False
        self.home = replace(home, rooms=(*home.rooms[:at], better, *home.rooms[at + 1 :]))
        self._permits = {at: self._permits[at]}
        return True

    def _permits_of(self, at: int) -> _Permits:
        if at not in self._permits:
            standing = {room.shell.room.id: room.items for room in self.home.rooms}
            self._permits[at] = _Permits(self._graph, self.home.rooms[at].shell.room, standing)
        return self._permits[at]

    def mend(self, at: int) -> None:
        """Let a room break rules where fewer pieces stand wrongly then, if that costs less: a bath
        in place of a shower before a window."""
        view = self.home.rooms[at]
        is_wrong = (conflicts(view) > TOUCH_M).any() or stuck(view).any()
        if is_wrong and self._permits_of(at).most:
            self.change(at, map(_fewer_wrong, changes_of(view)), -_EMPTY, mends=True)

    def furnish_empty(self, rooms: Collection[str]) -> None:
        """Give each of these rooms that is empty the first piece that fits: however few rules it
        keeps, an empty room keeps none. A room whose only piece stands wrongly gets it in place
        of that where less is wrong then, as a narrow bath that its shower fills."""
        for at, view in enumerate(self.home.rooms):
            room = view.shell.room
            if room.id not in rooms or not is_to_furnish(room) or len(view.items) > 1:
                continue
            if not view.items or self._permits_of(at).most:
                pieces = first_pieces(self._graph, room.id)
                self.change(at, [partial(_alone, pieces)], -_EMPTY, mends=bool(view.items))

    def repair(
        self, rooms: Collection[str], known: Collection[str], compose: Compose | None
    ) -> None:
        """Give the home what it lacks, in these rooms. known: rules that no room could keep."""
        tried = {*known}
        while rule := next((broken for broken in lacking(self.home) if broken not in tried), None):
            tried.add(rule)
            for at, changes in repairs(self.home, rule, compose):
                if self.home.rooms[at].shell.room.id in rooms:
                    any(self.change(at, [propose]) for propose in changes)
                if rule not in lacking(self.home):
                    break

    def made(self) -> dict[str, tuple[Item, ...]]:
        """The pieces of each room, by its id."""
        graph = self._graph
        clear = ClearFloors(list(clearances(graph.rooms, graph.openings)))
        pieces = {}
        for was, now in zip(self._before.rooms, self.home.rooms, strict=True):
            room = now.shell.room
            pieces[room.id] = was.items if was is now else tuple(
                _anew(room, was.items, now.items, clear)
            )  # fmt: skip
        return pieces


def _finished(
    graph: SceneGraph,
    made: dict[str, tuple[Item, ...]],
    finish: Callable[[SceneGraph], SceneGraph],
) -> SceneGraph:
    """The house with these pieces by room id; rooms that lose some of
    them and cost more than before stay as they were."""
    roomless = [item for item in graph.items if item.room_id not in made]
    items = (*(item for pieces in made.values() for item in pieces), *roomless)
    there = {item.id for item in graph.items}
    finished = finish(replace(graph, items=items))
    left = {item.id for item in finished.items}
    torn = {item.room_id for item in items if item.id not in left}
    if not torn or {item.id for item in items} == there:
        return finished
    before, after = _prices(graph), _prices(finished)
    worse = {room_id for room_id in torn if after.get(room_id, 0.0) > before.get(room_id, 0.0)}
    if not worse:
        return finished
    kept = {room_id: tuple(graph.items_of(room_id)) if room_id in worse else pieces
            for room_id, pieces in made.items()}  # fmt: skip
    return finish(
        replace(graph, items=(*(i for pieces in kept.values() for i in pieces), *roomless))
    )


def _prices(graph: SceneGraph) -> dict[str, float]:
    """What each room costs with its faults, by id."""
    faults = room_faults(graph, graph.rooms)
    by_id = {room.id: fault for room, fault in zip(graph.rooms, faults, strict=True)}
    return room_prices(graph, by_id)


def lost(there: Iterable[Item], listed: Iterable[Item]) -> list[Item]:
    """Listed pieces that no piece of their category stands for, but panels and kitchen units."""
    left = list(there)
    missing = []
    for item in listed:
        if item.category in KITCHEN_UNITS or category(item.category).mount is not Mount.FLOOR:
            continue
        same = [piece for piece in left if piece.category == item.category]
        if same:
            left.remove(min(same, key=lambda piece: _away_m(piece, item)))
        else:
            missing.append(item)
    return missing


def _away_m(item: Item, other: Item) -> float:
    return float(np.hypot(*np.subtract(item.box.center_m[:2], other.box.center_m[:2])))


def _anew(
    room: Room, before: Sequence[Item], after: Sequence[Item], clear: ClearFloors
) -> Iterator[Item]:
    """The pieces of a room; new ones get ids of their own, and changed ones lose their meshes."""
    old = {item.id: item for item in before}
    same = {id(item) for item in before}
    taken = {item.id for item in after if id(item) in same}
    for item in after:
        if id(item) in same:
            yield item
            continue
        was = old.get(item.id) if item.id not in taken else None
        numbered = (f"{room.id}/{item.category}_{n}" for n in count())
        name = item.id if was else next(free for free in numbered if free not in taken | {*old})
        taken.add(name)
        edits = (*item.facts.edits, Edit(RULE, was.box if was else item.box))
        facts = replace(item.facts, source_px=(), asset_distance_m=None, below_sill_m=None,
                        edits=edits)  # fmt: skip
        box = out_of_walls(item.box, room)
        yield clear.below_sill(replace(item, id=name, box=box, asset=None, facts=facts))


class _Permits:
    """Whether with these pieces no more is wrong in a room and those beside it than was."""

    def __init__(
        self, graph: SceneGraph, room: Room, standing: dict[str, tuple[Item, ...]]
    ) -> None:
        floor = room_polygon(room)
        self._near = [near for near in graph.rooms if room_polygon(near).dwithin(floor, _BESIDE_M)]
        items = tuple(
            item for near in self._near if near.id != room.id for item in standing[near.id]
        )
        self._around = replace(graph, items=items, dressing=())
        self._own = standing[room.id]

    @cached_property
    def most(self) -> float:
        """How much is wrong as it is."""
        return self.faults(self._own)

    def faults(self, items: Sequence[Item]) -> float:
        """How much is wrong with these pieces in the room."""
        house = replace(self._around, items=(*self._around.items, *items))
        return sum(room_faults(house, self._near))

    def __call__(self, view: View) -> bool:
        return self.faults(view.items) <= self.most


def _fewer_wrong(propose: Propose) -> Propose:
    """Those of some changes with which fewer pieces stand wrongly."""

    def fewer(view: View) -> Iterator[Change]:
        most = tight(view)
        return (
            change for change in propose(view) if tight(View(view.shell, change, view.hung)) < most
        )

    return fewer


def without_stuck(view: View) -> Iterator[Change]:
    """The room without the pieces that walls keep shut, together and each alone."""
    shut = [at for at in np.flatnonzero(stuck(view)).tolist() if view.items[at].facts.unit is None]
    for going in (shut, *([at] for at in shut)) if shut else ():
        yield but(view, going)


def without_strays(view: View) -> Iterator[Change]:
    """The room without chairs at no table, together and each alone."""
    chairs = loose(view, view.of("chair"))
    strays = [at for at in chairs if table_of(view.items[at], view.items) is None]
    for going in (strays, *([at] for at in strays)) if strays else ():
        yield but(view, going)


def _alone(pieces: Iterator[Item], _: View) -> Iterator[Change]:
    """Each of these pieces as all that a room holds."""
    return ((piece,) for piece in pieces)
