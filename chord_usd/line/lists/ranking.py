"""Which drafts of a home's rooms are taken: those that cost least on one scale, room by room, then
as a home."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from chord_usd.base.metrics.complete import lacking
from chord_usd.base.metrics.design.price import FAULT, home_price, quick_price
from chord_usd.base.metrics.design.shell import Shell, shells
from chord_usd.base.metrics.design.view import HomeView, View, view_home
from chord_usd.base.metrics.violations import room_faults
from chord_usd.base.scene.types import Item, Room, SceneGraph
from chord_usd.line.lists.mend import cleared, mended, needed_there
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

    def weigh(self, told: Mapping[int, Sequence[list[Item]]]) -> None:
        """Add drafts to rooms."""
        drafts = {at: [self._draft(at, items) for items in own] for at, own in told.items()}
        chosen = {at: min(own, key=_key) for at, own in drafts.items()}
        chosen = {at: own[0] for at, own in self._best.items()} | chosen
        few = {at: self._likeliest(at, own, chosen) for at, own in drafts.items()}
        settled = {at: own[0].items for at, own in self._best.items()}
        for nth in range(max(map(len, few.values()), default=0)):
            tried = {at: own[nth] for at, own in few.items() if nth < len(own)}
            standing = settled | {at: draft.items for at, draft in tried.items()}
            items = (*self.house.items, *(item for own in standing.values() for item in own))
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
        chosen = {at: own[0] for at, own in self._best.items()}
        for at, own in sorted(self._best.items()):
            own = [draft for draft in own if draft.missing == own[0].missing]
            costs = [draft.price + home_price(self._home({**chosen, at: draft})) for draft in own]
            chosen[at] = own[costs.index(min(costs))]
        return (item for at in sorted(chosen) for item in chosen[at].items)


def _key(draft: Draft) -> tuple[int, float]:
    return draft.missing, draft.price
