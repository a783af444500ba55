"""What a home lacks by its rules once its rooms are furnished, and the rooms that can give it, the
most fitting first: a home without a living room sits and watches television where it sleeps."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from chord_usd.base.metrics.complete import HOME
from chord_usd.base.metrics.design import judged_home, judged_room
from chord_usd.base.metrics.design.bedroom_rules import wardrobes
from chord_usd.base.metrics.design.home_rules import (
    DINERS,
    HALL,
    LAUNDRIES,
    LAUNDRY,
    MORE_SHOES,
    MOST_DINERS,
    NO_HOME_WITHOUT,
    SHOES,
    STORAGE,
    TABLE,
    TELEVISION,
    WARDROBES,
)
from chord_usd.base.metrics.design.view import HomeView, View, distances
from chord_usd.base.metrics.rooms import is_studio, stands_in
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import Box, FloatArray, RoomKind
from chord_usd.line.lists.changes import Change, Propose, Size, at_walls, but, new_piece
from chord_usd.line.lists.dining_changes import (
    Compose,
    beside_ways,
    composed_around,
    laid_instead,
    laid_table,
    more_chairs,
    seats_at,
)
from chord_usd.line.lists.home_programme import WASHED_IN, suits_dining
from chord_usd.line.lists.other_places import bed_and_table, bed_instead, sofa_groups, zoned
from chord_usd.line.lists.pieces import TALL_M
from chord_usd.line.lists.wardrobe_changes import SPARE_M, WARDROBE_M

_WASHER_M = (0.6, 0.6, 0.85)
_SHELVES_M = ((1.6, 0.4, 2.0), (0.8, 0.4, 2.0), (0.6, 0.38, 2.0))
_SHOES_M = ((0.8, 0.3, 1.1), (0.7, 0.3, 1.1), (0.6, 0.25, 1.1))
"""The painter loses 5 of 16 of 60 x 25 cm."""
_TVS_M = ((1.2, 0.35, 0.45), (1.0, 0.3, 0.45))
_EASY_M = (0.8, 0.8, 0.85)
NEAR_DOOR_M = 2.9
_FAMILY = 4
"""Seats of a dining room from which on a second table elsewhere is not worth its floor."""
_STORED_IN: tuple[RoomKind, ...] = ("bedroom", "corridor", "store", "study", "living")


Repair = tuple[int, Iterator[Propose]]
"""Number of a room in its home, and what may be changed there, one after another."""


def repairs(home: HomeView, rule: str, compose: Compose | None = None) -> Iterator[Repair]:
    """Rooms that can give their home what a rule of it lacks, the most fitting first.

    compose: makes kitchens again around a table or a shoe cabinet.
    """
    by_rule = _BY_RULE.get(rule)
    yield from by_rule(home) if by_rule else _COMPOSING[rule](home, compose)


def lacking(home: HomeView) -> list[str]:
    """Names of the rules that a home breaks and that pieces may mend, in order."""
    broken = {finding.rule for finding in judged_home(home).findings}
    return [
        rule for rule in dict.fromkeys((NO_HOME_WITHOUT, *_COMPOSING, *_BY_RULE)) if rule in broken
    ]


def _of_kinds(home: HomeView, kinds: Sequence[RoomKind]) -> list[int]:
    """Rooms of these kinds, in their order; of a kind the largest first."""
    shells = [room.shell for room in home.rooms]
    there = [at for at, shell in enumerate(shells) if shell.kind in kinds]
    return sorted(there, key=lambda at: (kinds.index(shells[at].kind), -shells[at].area_m2))


def _lived_in(home: HomeView) -> list[int]:
    """The largest bedroom of a home that lives where it sleeps."""
    bedrooms = _of_kinds(home, ("bedroom",))
    return [at for at in bedrooms if home.rooms[at].shell.is_lived_in]


def _laundry(home: HomeView) -> Iterator[Repair]:
    for at in _of_kinds(home, WASHED_IN):
        yield at, iter([partial(_added, category="washing_machine", sizes=[_WASHER_M])])


def _laundries(home: HomeView) -> Iterator[Repair]:
    """No further machine, the least fitting room first."""
    fitting = _of_kinds(home, WASHED_IN)
    others = [at for at in range(len(home.rooms)) if at not in fitting]
    for at in (*others, *reversed(fitting)):
        yield at, iter([_without_machine])


def _without_machine(view: View) -> Iterator[Change]:
    return (but(view, [at]) for at in view.of(*having("laundry")))


def _more_shoes(home: HomeView) -> Iterator[Repair]:
    """No further shoe cabinet, the room farthest from the front door first."""
    if home.entrance is None:
        return
    door = np.array(home.entrance.box.center_m[:2])
    away = [float(distances(door[None], room.shell.sides).min()) for room in home.rooms]
    for at in sorted(range(len(away)), key=lambda at: -away[at]):
        yield at, iter([_without_shoes])


def _without_shoes(view: View) -> Iterator[Change]:
    return (but(view, [at]) for at in view.of("shoe_cabinet"))


def _storage(home: HomeView) -> Iterator[Repair]:
    for at in _of_kinds(home, ("store",)):
        yield at, iter([partial(_added, category="cabinet", sizes=_SHELVES_M)])


def _table(home: HomeView, compose: Compose | None) -> Iterator[Repair]:
    for at in _eaten_in(home):
        yield at, _tables(home, at, compose)


def _diners(home: HomeView, compose: Compose | None) -> Iterator[Repair]:
    """Rooms that have a table first; no others where a dining room seats a family."""
    laid = [at for at in _eaten_in(home) if home.rooms[at].of("dining_table")]
    yield from ((at, _tables(home, at, compose)) for at in laid)
    dining = (home.rooms[at] for at in laid if home.rooms[at].shell.kind == "dining")
    if all(seats_at(room) < _FAMILY for room in dining):
        for at in _eaten_in(home):
            if at not in laid:
                tables = _tables(home, at, compose)
                yield at, map(_roomy, tables) if laid else tables


def _roomy(propose: Propose) -> Propose:
    """Those of some changes after which all chairs can be pulled out and passed."""

    def changes(view: View) -> Iterator[Change]:
        for change in propose(view):
            judged = judged_room(View(view.shell, change, view.hung))
            tables = [verdict.findings for verdict in judged if verdict.kind == "dining table"]
            if not any(finding.unit == "m" for findings in tables for finding in findings):
                yield change

    return changes


def _eaten_in(home: HomeView) -> list[int]:
    rooms = _of_kinds(home, ("dining", "living", "kitchen")) + _lived_in(home)
    return sorted(rooms, key=lambda at: suits_dining(home.rooms[at].shell))


def _tables(home: HomeView, at: int, compose: Compose | None) -> Iterator[Propose]:
    """More chairs at the table of a room, a longer table, and a first or second one, in place of
    what a room can do without, or with a kitchen composed around it; as many seats as the home
    lacks, or else fewer."""
    room = home.rooms[at]
    there, tables = seats_at(room), room.of("dining_table")
    missing = min(max(2, home.sleepers), MOST_DINERS) - sum(map(seats_at, home.rooms))
    most = min(there + missing, MOST_DINERS)
    for seats in range(most, max(1, there), -1):
        if tables:
            yield partial(more_chairs, seats=seats)
            yield partial(_laid, seats=seats, table=tables[0])
        else:
            yield partial(_laid, seats=seats)
            yield partial(laid_instead, seats=seats)
    if room.shell.kind == "bedroom" and not tables:
        yield partial(bed_and_table, seats=most)
    if compose and room.shell.kind == "kitchen" and not home.of("dining_table"):
        yield from (
            partial(composed_around, propose=partial(laid_table, seats=seats), compose=compose)
            for seats in dict.fromkeys((most, 2))
        )


def _laid(view: View, seats: int, table: int | None = None) -> Iterator[Change]:
    return beside_ways(view, laid_table(view, seats, table))


def _television(home: HomeView) -> Iterator[Repair]:
    for at in _of_kinds(home, ("living",)):
        yield at, iter([sofa_groups, zoned])
    for at in _of_kinds(home, ("bedroom",)):
        yield at, iter([_before_bed, partial(_added, category="tv_cabinet", sizes=_TVS_M)])


def _before_bed(view: View) -> Iterator[Change]:
    """A television at the wall that the bed faces."""
    for change in _added(view, "tv_cabinet", _TVS_M):
        turn = np.radians(change[-1].box.yaw_deg)
        front = np.array([np.sin(turn), -np.cos(turn)])
        if any(front @ view.front[bed] < -0.97 for bed in view.of("bed")):
            yield change


def _wardrobes(home: HomeView) -> Iterator[Repair]:
    there = sum(float(room.length[wardrobes(room)].sum()) for room in home.rooms)
    missing = home.sleepers - there + SPARE_M
    lengths = [length for length in (missing, 1.6, 1.2, 0.8) if length <= max(missing, 0.8)]
    sizes = [(min(max(length, 0.6), 2.6), WARDROBE_M, TALL_M) for length in lengths]
    for at in _of_kinds(home, _STORED_IN):
        yield at, (partial(_another, category="cabinet", size=size) for size in sizes)


def _shoes(home: HomeView, compose: Compose | None) -> Iterator[Repair]:
    """Rooms near the front door; the room that a home without a living room lives in; a kitchen,
    composed around the cabinet."""
    if home.entrance is None:
        return
    door = np.array(home.entrance.box.center_m[:2])
    near = [at for at, room in enumerate(home.rooms)
            if distances(door[None], room.shell.sides).min() < NEAR_DOOR_M]  # fmt: skip
    by_door = partial(_by_door, door=door)
    for at in near:
        shell = home.rooms[at].shell
        if stands_in("shoe_cabinet", shell.kind) or shell.is_lived_in:
            yield at, iter([by_door])
    for at in near:
        if compose and home.rooms[at].shell.kind == "kitchen":
            yield at, iter([partial(composed_around, propose=by_door, compose=compose)])


def _hall(home: HomeView) -> Iterator[Repair]:
    """The shoe cabinet beside the floor behind the front door, or a smaller one."""
    if home.entrance is None:
        return
    door = np.array(home.entrance.box.center_m[:2])
    for at, room in enumerate(home.rooms):
        if there := room.of("shoe_cabinet"):
            yield at, iter([partial(_by_door, door=door, instead=there)])


def _by_door(view: View, door: FloatArray, instead: Sequence[int] = ()) -> Iterator[Change]:
    """A shoe cabinet at a wall by the front door, the largest and then the nearest places first.

    instead: numbers of pieces that it replaces.
    """
    view = View(view.shell, but(view, instead), view.hung)

    def away_m(box: Box) -> float:
        return float(np.hypot(*(np.array(box.center_m[:2]) - door)))

    for size in _SHOES_M:
        for box in sorted(at_walls(view, size), key=away_m):
            if away_m(box) < NEAR_DOOR_M:
                new = new_piece(view, "shoe_cabinet", box, len(view.of("shoe_cabinet")))
                yield (*view.items, new)


def _needed(home: HomeView) -> Iterator[Repair]:
    """A bed and a seat, where a home has none: a studio sleeps in its living room."""
    there = {name for room in home.rooms for name in room.categories}
    if not there & HOME["bed"] and is_studio([room.shell.kind for room in home.rooms]):
        for at in _of_kinds(home, ("living",)):
            yield at, iter([bed_instead])
    if there & HOME["seat"]:
        return
    for at in _of_kinds(home, ("living",)):
        yield at, iter([sofa_groups])
    for at in _of_kinds(home, ("bedroom",)):
        yield at, iter([partial(_added, category="leisure_sofa", sizes=[_EASY_M])])


def _added(view: View, category: str, sizes: Sequence[Size]) -> Iterator[Change]:
    """A first piece of a category at each wall."""
    if not view.of(category):
        for size in sizes:
            yield from _another(view, category, size)


def _another(view: View, category: str, size: Size) -> Iterator[Change]:
    for box in at_walls(view, size):
        yield (*view.items, new_piece(view, category, box, len(view.of(category))))


_COMPOSING: Mapping[str, Callable[[HomeView, Compose | None], Iterator[Repair]]] = {
    TABLE: _table, DINERS: _diners, SHOES: _shoes,
}  # fmt: skip
_BY_RULE: Mapping[str, Callable[[HomeView], Iterator[Repair]]] = {
    NO_HOME_WITHOUT: _needed, TELEVISION: _television,
    WARDROBES: _wardrobes, HALL: _hall, LAUNDRY: _laundry, LAUNDRIES: _laundries,
    MORE_SHOES: _more_shoes, STORAGE: _storage,
}  # fmt: skip
