"""Changes by which a room keeps more planning rules, one after another; it gets no tighter."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

import numpy as np

from chord_usd.base.metrics.design.price import TIGHT, beyond_walls, quick_price, tight
from chord_usd.base.metrics.design.shell import APART_M, TOUCH_M
from chord_usd.base.metrics.design.shut_leaves import before_walls, opens, stand_before
from chord_usd.base.metrics.design.view import View
from chord_usd.base.metrics.overlap import overlaps_by_nature
from chord_usd.base.scene.types import Item
from chord_usd.line.lists.changes import Change, Propose

LEAST_GAIN = 1e-6
_WEIGHED = 24
"""Changes of one kind that are weighed by all rules, evenly of those that clash with nothing."""
_LOOKED_AT = 4
"""Of the changes of one kind, so many of the best are looked at exactly."""


def improved(
    view: View,
    home: Callable[[View], float],
    changes: Iterable[Propose],
    permits: Callable[[View], bool] = lambda _: True,
    gain: float = LEAST_GAIN,
) -> View:
    """The room with each of these changes that lowers what room and home cost, one after another.

    home: what the home costs with this room. permits: whether a room is no worse by faults. gain:
    least decrease of the cost; 0 takes changes that cost nothing, the first of equal ones.
    """
    most = tight(view)
    price = quick_price(view, most) + home(view)
    for propose in changes:
        better = []
        options = free_of_clashes(view, _keeping(view, propose(view)))
        for nth, items in enumerate(options[:: 1 + len(options) // _WEIGHED]):
            tried = View(view.shell, items, view.hung)
            faults = tight(tried)
            if faults <= most:
                others = home(tried)
                if TIGHT * faults + others > price - gain:  # however few rules it breaks
                    continue
                cost = quick_price(tried, faults, price - gain - others) + others
                if cost <= price - gain:
                    better.append((round(cost, 9), nth, faults, tried))
        for cost, _, faults, tried in sorted(better, key=lambda entry: entry[:2])[:_LOOKED_AT]:
            if permits(tried):
                view, price, most = tried, cost, faults
                break
    return view


def _keeping(view: View, changes: Iterable[Change]) -> list[Change]:
    """Those of some changes that leave what the plan shows as it is."""
    locked = {id(item) for item in view.items if item.facts.locked}
    return [items for items in changes if locked <= {id(item) for item in items}]


def free_of_clashes(view: View, changes: Sequence[Change]) -> list[Change]:
    """Those of some changes whose new pieces stand in no others and not in each other, before no
    opening and no leaf that opens, within the room, and open against no wall."""
    there = {id(item): at for at, item in enumerate(view.items)}
    stays = np.zeros((len(changes), len(view.items)), np.bool_)
    new: list[Item] = []
    change_of: list[int] = []
    for nth, items in enumerate(changes):
        for item in items:
            at = there.get(id(item))
            if at is None:
                new.append(item)
                change_of.append(nth)
            else:
                stays[nth, at] = True
    if not new:
        return list(changes)
    fresh = View(view.shell, tuple(new))
    beside = stays[change_of]
    shut = stand_before(fresh, view) | stand_before(view, fresh).T
    deep = (fresh.rects.depths(view.rects) > APART_M) & beside
    for new_at, at in np.argwhere(deep):
        deep[new_at, at] = not overlaps_by_nature(new[new_at], view.items[at])
    blocks = fresh.rects.depths(view.shell.clear) > TOUCH_M
    blocks &= fresh.height[:, None] > view.shell.clear_from_m + TOUCH_M
    number = np.array(change_of)
    together = np.zeros(len(new), np.bool_)
    for step in range(1, int(np.bincount(number).max())):
        first = np.flatnonzero(number[:-step] == number[step:])
        into = fresh.rects.of(first).depths_each(fresh.rects.of(first + step)) > APART_M
        for new_at in first[into].tolist():
            together[new_at] |= not overlaps_by_nature(new[new_at], new[new_at + step])
        for a, b in ((first, first + step), (first + step, first)):
            meets = fresh.rects.of(a).depths_each(fresh.leaf_floors().of(b)) > TOUCH_M
            together[first] |= meets & fresh.stands[a] & opens(fresh)[b]
    wrong = (shut & beside).any(axis=1) | together | deep.any(axis=1) | blocks.any(axis=1)
    wrong |= (beyond_walls(fresh.corners, view.shell) > TOUCH_M) | before_walls(fresh)
    refused = set(number[wrong].tolist())
    return [items for nth, items in enumerate(changes) if nth not in refused]
