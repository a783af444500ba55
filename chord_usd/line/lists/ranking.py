"""Which drafts of a home's rooms are taken: those that cost least on one scale, room by room, then
as a home."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeVar

import numpy as np

from chord_usd.base.metrics.complete import lacking
from chord_usd.base.metrics.design.price import FAULT, conflicts, home_price, quick_price
from chord_usd.base.metrics.design.shell import TOUCH_M, Shell, shells
from chord_usd.base.metrics.design.view import HomeView, View, view_home
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.metrics.violations import room_faults
from chord_usd.base.scene.palette import CATEGORIES
from chord_usd.base.scene.types import Box, FloatArray, Item, Room, SceneGraph
from chord_usd.line.lists.wishes import Asked

WEIGHED = 4
"""Of the drafts of a room, so many of the best are looked at for faults, which is slow."""


MENDED = 6
"""So many of the best are mended."""


@dataclass(frozen=True, eq=False)
class Draft:
    """What one list makes of a room."""

    items: tuple[Item, ...]
    view: View
    missing: int
    """Pieces that are wanted and are not there."""
    price: float


class Ranking:
    """The drafts of rooms, which go by their number."""

    def __init__(self, house: SceneGraph, rooms: Sequence[Room], wishes: Sequence[Asked]) -> None:
        """house: with what stands in rooms that are not drawn."""
        self.house, self.rooms, self.wishes = house, rooms, wishes
        self._shells: Mapping[str, Shell] = shells(house.rooms, house.openings)
        self._standing = view_home(house)
        self._numbers = {room.id: at for at, room in enumerate(rooms)}
        self._best: dict[int, list[Draft]] = {}

    def weigh(self, listed: Mapping[int, Sequence[list[Item]]]) -> None:
        """Add drafts to rooms."""
        drafts = {at: [self._draft(at, items) for items in lists] for at, lists in listed.items()}
        chosen = {at: min(ranked, key=_key) for at, ranked in drafts.items()}
        chosen = {at: ranked[0] for at, ranked in self._best.items()} | chosen
        few = {at: self._likeliest(at, ranked, chosen) for at, ranked in drafts.items()}
        settled = {at: ranked[0].items for at, ranked in self._best.items()}
        for nth in range(max(map(len, few.values()), default=0)):
            tried = {at: ranked[nth] for at, ranked in few.items() if nth < len(ranked)}
            standing = settled | {at: draft.items for at, draft in tried.items()}
            items = (*self.house.items, *(item for pieces in standing.values() for item in pieces))
            rooms = [self.rooms[at] for at in tried]
            faults = room_faults(replace(self.house, items=items), rooms, unpainted=True)
            for (at, draft), fault in zip(tried.items(), faults, strict=True):
                priced = replace(draft, price=draft.price + FAULT * fault)
                self._best.setdefault(at, []).append(priced)
            settled = {at: self._ranked(at)[0].items for at in self._best}
        for at in few:
            self._best[at] = self._ranked(at)

    def _draft(self, at: int, items: Sequence[Item]) -> Draft:
        view = View(self._shells[self.rooms[at].id], tuple(items))
        return Draft(view.items, view, len(self.wishes[at].missing(items)), quick_price(view))

    def _likeliest(
        self, at: int, drafts: Sequence[Draft], chosen: Mapping[int, Draft]
    ) -> list[Draft]:
        """The best drafts of a room as far as a quick look shows, with what its home gains."""

        def cost(draft: Draft) -> tuple[int, float]:
            home = self._home({**chosen, at: draft})
            there = needed_there(draft.view.shell, draft.view.categories)
            return draft.missing, draft.price + home_price(home) - FAULT * there

        few = []
        for draft in sorted(drafts, key=cost)[:MENDED]:
            view = mended(draft.view)
            if not self.wishes[at].is_asked:
                view = cleared(view)
            if view is not draft.view:
                draft = replace(draft, items=view.items, view=view, price=quick_price(view))
            few.append(draft)
        return sorted(few, key=cost)[:WEIGHED]

    def _home(self, drafts: Mapping[int, Draft]) -> HomeView:
        views = tuple(
            drafts[at].view if (at := self._numbers.get(view.shell.room.id, -1)) in drafts else view
            for view in self._standing.rooms
        )
        return replace(self._standing, rooms=views)

    def _ranked(self, at: int) -> list[Draft]:
        return sorted(self._best[at], key=_key)

    def lacks(self, at: int) -> bool:
        """Whether the best draft of a room lacks what its kind cannot do without."""
        view = self._best[at][0].view
        return bool(lacking(view.shell.kind, view.shell.area_m2, view.categories))

    def chosen(self) -> Iterator[Item]:
        """The pieces of the best home: of each room in turn the draft with which room and home
        together cost least."""
        chosen = {at: ranked[0] for at, ranked in self._best.items()}
        for at, ranked in sorted(self._best.items()):
            ranked = [draft for draft in ranked if draft.missing == ranked[0].missing]
            costs = [
                draft.price + home_price(self._home({**chosen, at: draft})) for draft in ranked
            ]
            chosen[at] = ranked[costs.index(min(costs))]
        return (item for at in sorted(chosen) for item in chosen[at].items)


def _key(draft: Draft) -> tuple[int, float]:
    return draft.missing, draft.price


# What a few centimetres mend in a draft, before drafts are compared: lists write on a ------------

# 5 cm, and nearly every list of a living room has a piece a step into another or before a door.
#
# A piece moves or gets shorter by no more than MOST_M, and only where that leaves less wrong.

T = TypeVar("T")

MOST_M = 0.2
TIMES = 6
"""Changes of one draft at most."""
_SPARE_M = 0.005
"""A piece is moved so much farther than to touch."""


def mended(view: View) -> View:
    """The draft with small conflicts put right."""
    deep = conflicts(view)
    stuck: set[int] = set()
    for _ in range(TIMES):
        worst = np.where((deep > TOUCH_M) & (deep <= MOST_M), deep, 0.0).max(axis=1, initial=0.0)
        worst[list(stuck)] = 0.0
        if not worst.any():
            break
        at = int(worst.argmax())
        better = _best_change(view, at, deep)
        if better is None:
            stuck.add(at)
        else:
            view, deep = better
    return view


def cleared(view: View) -> View:
    """The draft without pieces that are still in others, before openings or in walls: they are left
    out of any house. Of those in each other the one goes without which the room costs least; what a
    room cannot do without stays."""
    while ((deep := conflicts(view)) > TOUCH_M).any():
        least = needed_there(view.shell, view.categories)
        wrong = np.flatnonzero((deep > TOUCH_M).any(axis=1)).tolist()
        units = [at for at in wrong if view.categories[at] in KITCHEN_UNITS]
        if units:  # runs are composed later: which of many units goes first is worth no search
            wrong = [max(units, key=lambda at: float(deep[at].max()))]
        going = dict.fromkeys(
            number for at in wrong
            for number in (at, *np.flatnonzero(view.depths[at] > TOUCH_M).tolist())
            if number == at or deep[at, 0] > TOUCH_M
        )  # fmt: skip
        lefts = (
            View(view.shell, tuple(_without(view.items, number)), view.hung) for number in going
        )
        options = [left for left in lefts if needed_there(left.shell, left.categories) >= least]
        if not options:
            break
        view = min(options, key=quick_price) if len(options) > 1 else options[0]
    return view


def needed_there(shell: Shell, categories: Sequence[str]) -> int:
    """How much of what its room cannot do without is there; a bed is never done without."""
    return ("bed" in categories) - len(lacking(shell.kind, shell.area_m2, categories))


def _without(values: Sequence[T], at: int) -> list[T]:
    return [*values[:at], *values[at + 1 :]]


def _best_change(view: View, at: int, deep: FloatArray) -> tuple[View, FloatArray] | None:
    """Of the piece, or else of those that it is in, the change that leaves least wrong."""
    best, least = None, float(deep.sum()) - TOUCH_M
    steps = sorted({float(depth) for depth in deep[at] if TOUCH_M < depth <= MOST_M})
    for number in dict.fromkeys([at, *np.flatnonzero(view.depths[at] > TOUCH_M).tolist()]):
        boxes = (
            box
            for step in steps
            for box in _changes(view.items[number].box, view.categories[number], step)
        )
        for box in boxes:
            items = list(view.items)
            items[number] = replace(items[number], box=box)
            tried = View(view.shell, tuple(items), view.hung)
            left = conflicts(tried)
            if left.sum() < least:
                best, least = (tried, left), float(left.sum())
        if best is not None:
            break
    return best


def _changes(box: Box, category: str, depth: float) -> Iterator[Box]:
    """The box moved by a depth along each of its axes, or shorter by it at each end."""
    step = depth + _SPARE_M
    turn = np.radians(box.yaw_deg)
    right = np.array([np.cos(turn), np.sin(turn)])
    front = np.array([np.sin(turn), -np.cos(turn)])
    x, y, z = box.center_m
    for direction in (right, -right, front, -front):
        dx, dy = (direction * step).tolist()
        yield replace(box, center_m=(x + dx, y + dy, z))
    length, width, height = box.size_m
    row = CATEGORIES.get(category)
    if row is not None and length - step >= row.length_m[0]:
        for side in (0.5, -0.5):
            dx, dy = (right * step * side).tolist()
            yield replace(box, center_m=(x + dx, y + dy, z), size_m=(length - step, width, height))
