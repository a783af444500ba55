"""What may be changed in a room that breaks planning rules: other places along every wall for the
pieces that break them, each with what belongs to it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice, product

import numpy as np

from chord_usd.base.metrics.complete import WALLED
from chord_usd.base.metrics.design import judged_room
from chord_usd.base.metrics.design.bedroom_rules import WARDROBE_RULES, bedside, wardrobes
from chord_usd.base.metrics.design.dining_rules import chairs_of
from chord_usd.base.metrics.design.group_rules import strays
from chord_usd.base.metrics.design.living_rules import SINGLES
from chord_usd.base.metrics.design.price import conflicts, quick_price
from chord_usd.base.metrics.design.shell import TOUCH_M
from chord_usd.base.metrics.design.shut_leaves import shut_in
from chord_usd.base.metrics.design.view import View, sleepers_of
from chord_usd.base.metrics.rooms import stands_in
from chord_usd.base.scene.geometry import to_world
from chord_usd.base.scene.types import WET_KINDS, Box, Item
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.lists.changes import (
    BY_KIND,
    TABLE_TO_SOFA_M,
    Change,
    Propose,
    Size,
    at_walls,
    beside_bed,
    but,
    longest_sofa,
    loose,
    new_piece,
)
from chord_usd.line.lists.dining_changes import beside_ways, laid_table, more_chairs, seats_at
from chord_usd.line.lists.improve import free_of_clashes
from chord_usd.line.lists.pieces import TALL_M
from chord_usd.line.lists.second_zone import second_zone
from chord_usd.line.lists.wardrobe_changes import (
    WARDROBE_M,
    another_wardrobe,
    longer_wardrobe,
    wardrobe_instead,
)
from chord_usd.line.lists.wet_places import composed

_ALONE = frozenset((*WALLED, "shower", "bathtub", "table"))
_TV_M, _SMALL_TV_M = (1.4, 0.4, 0.47), (1.0, 0.35, 0.47)
_ARMCHAIR_M = (0.8, 0.8, 0.85)
_COFFEE_M = (0.9, 0.55, 0.42)
_SOFA_M = (2.2, 0.9, 0.85)
_SOFAS_M = (2.25, 1.7)
"""Lengths of sofas beside the one that is there."""
_BEDS_M = ((1.6, 2.0, 0.5), (1.4, 2.0, 0.5), (0.9, 2.0, 0.5))
"""A first bed."""
_SIDEBOARDS = ("dining_cabinet", "side_coffee_table")
_SPARE = (*_SIDEBOARDS, "table", "chair")
"""What a room that is slept in can do without before it does without sofa, bed and television."""
_AT_WALLS = ("cabinet", "shoe_cabinet")
"""What finds another place in a living room once its group has one."""
_WEIGHED, _ZONED, _BEDS, _TABLES, _LAID, _OTHERS = 24, 5, 2, 8, 2, 6
"""Groups that are weighed, those for which other furniture is placed elsewhere, places of a bed for
each of these, and of a dining table for each of these; of tables those that stay, and places of
each other piece."""
_BESIDE_TABLES = 8
"""Places of a bed that are tried with a dining table in the room."""
_WORTH = 0.5
"""Weight of broken rules from which on a whole group is placed again: a search of a second."""
_DEEP_M2 = 16.0
_BESIDE_M = 0.05
"""From a sofa to a side table."""
_VIEWED_FROM_M = (2.2, 3.0)
"""From the front of a sofa to a television, where no wall is behind the sofa."""


def changes_of(view: View) -> list[Propose]:
    """What may be changed in a room, in order; nothing in one that keeps every rule."""
    if not any(judged.findings for judged in judged_room(view)) and not _clashing(view):
        return []
    seats = partial(more_chairs, seats=max(2, seats_at(view)))
    wet: list[Propose] = [composed] if view.shell.kind in WET_KINDS else []
    chairs: list[Propose] = [seats] if view.of("dining_table") else []
    changes: list[Propose] = [*wet, *BY_KIND.get(view.shell.kind, ())]
    if view.shell.kind == "bedroom":
        changes += [bed_instead, longer_wardrobe, another_wardrobe]
    elif view.of("bed"):
        changes += [*BY_KIND["bedroom"], longer_wardrobe, another_wardrobe]
    last: Mapping[str, Sequence[Propose]] = {
        "living": (zoned, slept_in, second_zone), "bedroom": (wardrobe_instead,),
    }  # fmt: skip
    return [*changes, *chairs, moved, *last.get(view.shell.kind, ()), regrouped]


def regrouped(view: View) -> Iterator[Change]:
    """Pieces without what they belong to there: side tables beside the sofa, sideboards as
    cabinets; or else without them."""
    alone = loose(view, strays(view))
    if not alone:
        return
    yield but(view, alone)
    for at in alone:
        item, rest = view.items[at], but(view, [at])
        yield rest
        if item.category == "dining_cabinet" and stands_in("cabinet", view.shell.kind):
            yield (*rest, replace(item, category="cabinet"))
        for sofa in view.of("sofa") if item.category == "side_coffee_table" else ():
            out = float(view.length[sofa] + view.length[at]) / 2 + _BESIDE_M
            for side in (-1, 1):
                box = _placed(view.items[sofa].box, (side * out, 0.0), item.box.size_m, 0.0)
                yield (*rest, moved_to(item, box))


def moved(view: View) -> Iterator[Change]:
    """The room with one of the pieces that break rules elsewhere."""
    findings = [finding for judged in judged_room(view) for finding in judged.findings]
    named = {name for finding in findings for name in finding.items} | _clashing(view)
    if any(finding.rule in WARDROBE_RULES for finding in findings):
        named |= {item.id for item in view.items if item.category == "bed"}
    for at, item in enumerate(view.items):
        if item.facts.unit is not None or item.facts.locked:
            continue
        if item.category == "bed" and item.id in named:
            yield from _bed(view, at)
        elif item.category == "dining_table" and (
            item.id in named or named & {view.items[chair].id for chair in chairs_of(view, at)}
        ):
            seats = max(2, len(chairs_of(view, at)))
            yield from beside_ways(view, laid_table(view, seats, at))
        elif item.category in _ALONE and item.id in named:
            rest = (*view.items[:at], *view.items[at + 1 :])
            for box in at_walls(view, item.box.size_m):
                yield (*rest, moved_to(item, box))
    if view.shell.kind == "living" and _lost(view) >= _WORTH:
        yield from sofa_groups(view)


def _lost(view: View) -> float:
    """Weight of the rules that a room breaks."""
    return sum(judged.weight - judged.won for judged in judged_room(view))


def _clashing(view: View) -> set[str]:
    """Ids of pieces in others, in walls, before openings or leaves, and of pieces with such leaves,
    also before walls: as showers before windows, what a room cannot do without is not left out for
    that."""
    stopping, stopped = shut_in(view)
    wrong = (conflicts(view) > TOUCH_M).any(axis=1) | stopping | stopped
    return {item.id for item, is_wrong in zip(view.items, wrong, strict=True) if is_wrong}


def moved_to(item: Item, box: Box) -> Item:
    """The piece elsewhere; it keeps its id."""
    return replace(item, box=box)


def _bed(view: View, at: int) -> Iterator[Change]:
    """The bed at each wall, with its tables at one or both sides; where wardrobes break rules, also
    with a wardrobe for all at each wall."""
    tables = bedside(view, at)
    sizes = [view.items[table].box.size_m for table in tables] or [(0.4, 0.4, 0.5)]
    stored = wardrobes(view)
    length = min(max(1.0 * sleepers_of(view), 0.8), 2.6)
    moves = [at, *tables, *view.of("bed_background")]
    rest, bare = but(view, moves), but(view, [*moves, *stored])
    shelves = [new_piece(view, "cabinet", box)
               for box in at_walls(view, (length, WARDROBE_M, TALL_M), 0.5)]  # fmt: skip
    places = at_walls(view, view.items[at].box.size_m)
    for bed in _standing(view, bare, (moved_to(view.items[at], box) for box in places)):
        box = bed.box
        pair = beside_bed(view, box, sizes[0])
        for chosen in (pair, pair[:1], pair[1:]):
            yield (*rest, bed, *chosen)
        for shelf in shelves:
            yield (*bare, bed, *pair, shelf)


def bed_and_table(view: View, seats: int) -> Iterator[Change]:
    """The bed where it leaves place for a dining table, and the table."""
    for bed in view.of("bed")[:1]:
        for change in _best(view, free_of_clashes(view, list(_bed(view, bed))), _BESIDE_TABLES):
            yield from _laid(view, change, seats)


def bed_instead(view: View) -> Iterator[Change]:
    """A first bed at each wall, without the pieces that stand there or could not be used then."""
    if view.of("bed"):
        return
    # Tables of a bed that found no place come to this one later.
    others = but(view, loose(view, view.of("bedside_table", "bed_background")))
    for size in _BEDS_M:
        beds = [new_piece(view, "bed", box) for box in at_walls(view, size)]
        alone = [bed for (bed,) in free_of_clashes(view, [(bed,) for bed in beds])]
        pairs = [(item, bed) for bed in alone for item in others]
        free = {(id(item), id(bed)) for item, bed in free_of_clashes(view, pairs)}
        for bed in alone:
            rest = tuple(item for item in others if (id(item), id(bed)) in free)
            yield (*rest, bed)


def sofa_groups(view: View) -> Iterator[Change]:
    """The sofa, or a first one, at each wall or before a television: the table before it, armchairs
    beside that, a television opposite, on a cabinet or where the wall has a place for a screen."""
    yield from _grouped(view, ())


def zoned(view: View) -> Iterator[Change]:
    """The group first, then the dining table, then sideboards; where the room has no television,
    the group with one, and what stands at its walls after it, too."""
    if _lost(view) < _WORTH:
        return
    tables = view.of("dining_table")
    chairs = {chair for table in tables for chair in chairs_of(view, table)}
    if len(loose(view, tables)) < len(tables):
        tables, chairs = [], set()
    lacks = not view.televisions
    again = loose(view, view.of(*_SIDEBOARDS, *(_AT_WALLS if lacks else ())))
    moves = [*tables, *chairs, *again]
    groups = free_of_clashes(view, list(_grouped(view, moves, lacks))) if moves else []
    if lacks:
        groups = [items for items in groups if View(view.shell, items, view.hung).televisions]
    lost = [view.items[at] for at in again if view.categories[at] in _AT_WALLS]
    for items in _unlike(view, groups):
        for laid in _laid(view, items, len(chairs)) if tables else [items]:
            if not lacks or View(view.shell, laid, view.hung).televisions:
                yield _with_others(view, laid, lost)


def _unlike(view: View, groups: Sequence[Change]) -> Iterator[Change]:
    """The groups that break the fewest rules, no two with the sofa at the same place; the first of
    each place with a television's cabinet and without stand for the others there."""

    def sofa(items: Change) -> Box:
        return next(item.box for item in items[::-1] if item.category == "sofa")

    fullest = {(sofa(items), items[-1].category == "tv_cabinet"): items
               for items in reversed(groups)}  # fmt: skip
    best: dict[Box, Change] = {}
    for items in _best(view, [*fullest.values()], _WEIGHED):
        best.setdefault(sofa(items), items)
    yield from islice(best.values(), _ZONED)


def _laid(view: View, items: Change, seats: int) -> list[Change]:
    """These pieces with a dining table for so many, or else for two, at its best places."""
    room = View(view.shell, items, view.hung)
    for count in dict.fromkeys((max(2, seats), 2)):
        laid = free_of_clashes(room, list(laid_table(room, count)))
        if laid:
            return _best(room, laid[:: 1 + len(laid) // _TABLES], _LAID)
    return []


def _with_others(view: View, items: Change, others: Iterable[Item]) -> Change:
    """These pieces with others where they stood, or else at the wall where they cost least; without
    those that find no place."""
    for other in others:
        room = View(view.shell, items, view.hung)
        there = free_of_clashes(room, [(*items, other)]) or free_of_clashes(
            room, [(*items, moved_to(other, box)) for box in at_walls(room, other.box.size_m)]
        )
        items = next(iter(_best(room, there[:: 1 + len(there) // _OTHERS], 1)), items)
    return items


def slept_in(view: View) -> Iterator[Change]:
    """A living room where one sleeps, with sofa, bed, wardrobe and dining table placed in this
    order; without what it can do without."""
    beds = view.of("bed")[:1]
    if not beds or not any(judged.findings for judged in judged_room(view)):
        return
    tables, spare = view.of("dining_table"), view.of(*_SPARE)
    moves = {*view.of("bed_background", "bedside_table", "cabinet"), *beds, *tables, *spare}
    seats = max(2, seats_at(view))
    for items in _best(view, free_of_clashes(view, list(_grouped(view, [*moves])))):
        room = View(view.shell, (*items, view.items[beds[0]]), view.hung)
        for change in _best(room, free_of_clashes(room, list(_bed(room, len(items)))), _BEDS):
            laid = list(laid_table(View(view.shell, change, view.hung), seats)) if tables else []
            yield from _best(view, laid[:: 1 + len(laid) // _TABLES] or [change], 1)


def _best(view: View, groups: Sequence[Change], most: int = _ZONED) -> list[Change]:
    """The groups that break the fewest rules, of some that differ most."""
    some = groups[:: 1 + len(groups) // _WEIGHED]
    return sorted(some, key=lambda items: quick_price(View(view.shell, items, view.hung)))[:most]


def _grouped(view: View, moves: Sequence[int], is_small: bool = False) -> Iterator[Change]:
    """The group at each of its places, without some other pieces; about what the plan shows of it,
    which stays. is_small: also without armchairs, before a television that is narrow."""
    at = longest_sofa(view)
    first = new_piece(view, "sofa", Box((0.0, 0.0, 0.0), _SOFA_M, 0.0))
    longest = first if at is None else view.items[at]
    singles, tables, screens = view.of(*SINGLES), view.of("coffee_table"), view.of("tv_cabinet")
    group = [*singles, *tables, *screens, *view.of("sofa_background")]
    rest = but(view, loose(view, [*group, *moves, *([] if at is None else [at])]))
    coffee, seat, stand = (
        view.items[there[0]].box.size_m if there else size
        for there, size in ((tables, _COFFEE_M), (singles, _ARMCHAIR_M), (screens, _TV_M))
    )
    chair = view.categories[singles[0]] if singles else "single_sofa"
    places = (box for length in dict.fromkeys((float(longest.box.size_m[0]), *_SOFAS_M))
              for box in _sofa_places(view, (length, *longest.box.size_m[1:]), stand))  # fmt: skip
    sofas = _standing(view, rest, (moved_to(longest, box) for box in places))
    is_given = longest.facts.locked
    has_seats, has_table, has_screen = (
        len(loose(view, there)) < len(there) for there in (singles, tables, screens)
    )
    for sofa in [longest] if is_given else sofas:
        box = sofa.box
        ahead = -(box.size_m[1] / 2 + TABLE_TO_SOFA_M + coffee[1] / 2)
        table = new_piece(view, "coffee_table", _placed(box, (0.0, ahead), coffee, 0.0))
        before = [*(() if is_given else (sofa,)), *(() if has_table else (table,))]
        reach = max(coffee[0] + 0.25, 1.35) / 2 + seat[1] / 2 + 0.1
        pair = [
            new_piece(view, chair, _placed(box, (side * reach, ahead), seat, -90.0 * side), n)
            for n, side in enumerate((-1, 1))
        ]
        # Beside a sofa that stays, there may be room for no seat.
        none: list[list[Item]] = [[]] if is_given or is_small else []
        some = [[]] if has_seats else [pair, pair[:1], pair[1:], *none]
        stands = dict.fromkeys((stand, _SMALL_TV_M) if is_small else (stand,))
        walls = (
            [] if has_screen else [place for size in stands for place in _opposite(view, box, size)]
        )
        for seats, cabinet in product(some, (*walls, None)):
            shown = [new_piece(view, "tv_cabinet", cabinet)] if cabinet else []
            yield (*rest, *before, *seats, *shown)


def _sofa_places(view: View, size: Size, stand: Size) -> Iterator[Box]:
    """At each wall; in a room that is deep, also before a television of a size at each wall."""
    yield from at_walls(view, size, 0.5)
    if view.shell.area_m2 >= _DEEP_M2:
        for screen, far in product(at_walls(view, stand, 0.6), _VIEWED_FROM_M):
            away = -(stand[1] / 2 + far + size[1] / 2)
            yield _placed(screen, (0.0, away), size, 180.0)


def _opposite(view: View, sofa: Box, size: tuple[float, float, float]) -> Iterator[Box]:
    """A cabinet at the wall that a sofa faces, on its axis."""
    for start, end in view.shell.walls:
        long = float(np.hypot(*(end - start)))
        along = (end - start) / max(long, 1e-6)
        inward = np.array([-along[1], along[0]])
        turn = np.radians(sofa.yaw_deg)
        front = np.array([np.sin(turn), -np.cos(turn)])
        middle = np.array(sofa.center_m[:2])
        s, away = float((middle - start) @ along), float((start - middle) @ front)
        if inward @ front < -0.97 and 2.2 <= away <= 4.4 and size[0] / 2 <= s <= long - size[0] / 2:
            x, y = (start + along * s + inward * size[1] / 2).tolist()
            yaw = wrap_deg(float(np.degrees(np.arctan2(inward[0], -inward[1]))))
            yield Box((x, y, 0.0), size, round(yaw, 6))


def _placed(
    box: Box, place: tuple[float, float], size: tuple[float, float, float], turn_deg: float
) -> Box:
    """A piece at a place in the frame of another."""
    x, y = to_world(box, place)
    return Box((float(x), float(y), 0.0), size, wrap_deg(box.yaw_deg + turn_deg))


def _standing(view: View, rest: Sequence[Item], pieces: Iterable[Item]) -> Iterator[Item]:
    """Those of some pieces that clash with nothing that stays."""
    for items in free_of_clashes(view, [(*rest, piece) for piece in pieces]):
        yield items[-1]
