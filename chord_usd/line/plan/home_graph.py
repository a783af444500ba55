"""Which rooms of a plan are whose: a stair or landing that homes hang on is common to them.

A home has a bath, and a kitchen or a room to sit in. Where a corridor is taken away and two or more
parts of the house that hung on it are homes by themselves, the corridor is common, and so are the
parts that are none: lifts, stores, the stair behind a landing. A bedroom with its bath is no home,
and neither is a wing with a table alone beside a part that has a kitchen. A single home on a
landing has its stair for itself, unless other doors lead out of the landing or its stair, too.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

from chord_usd.base.scene.dwellings import DWELLING, NO_HOME, dwelling_of
from chord_usd.base.scene.geometry import hanging_together
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.room_words import plain
from chord_usd.base.scene.types import WET_KINDS, Plan, Room, RoomKind
from chord_usd.base.terms import with_step
from chord_usd.line.plan.home_uses import Floor, Uses, uses_of_home

_SHOWS = "the plan shows "

_SEATS: frozenset[RoomKind] = frozenset({"living", "kitchen", "dining"})

_WORK = frozenset((
    "openspace", "openplan", "meeting", "meetingroom", "conference", "boardroom", "reception",
    "lobby", "classroom", "lecture", "auditorium", "laboratory", "shop", "showroom", "warehouse",
    "ward", "surgery", "consulting", "waiting", "treatment", "server", "copy", "staff", "coworking",
    "workshop", "factory", "restaurant", "gym",
    "grossraumburo", "besprechung", "besprechungsraum", "konferenz", "empfang", "klassenzimmer",
    "werkstatt", "wartezimmer", "praxis", "laden", "verkauf",
    "reunion", "accueil", "classe", "atelier", "boutique", "reuniones", "recepcion", "aula",
    "tienda", "almacen", "reuniao", "recepcao", "loja", "riunioni", "negozio", "vergaderruimte",
    "receptie", "motesrum", "motesrom", "recepcja", "konferencyjna",
))  # fmt: skip
"""Words for rooms of offices, schools, shops and surgeries, without accents."""
_OFFICE = frozenset(
    ("office", "study", "buro", "bureau", "oficina", "ufficio", "kantoor", "kontor")
)
"""Words for rooms that homes have, too."""
_LEAST_WORK = 2
"""A house may have a shop, and an office."""
_AT_HOME: frozenset[RoomKind] = frozenset({"living", "kitchen", "dining", "bedroom"})


_STAIRS = 0.3
"""Least share of a floor that the stairs of a building take up."""
_DOORS_OUT = 2
"""Least number of doors out of a landing and its stair: of the building, and of other homes."""
_COMMON: frozenset[RoomKind] = frozenset({"corridor", "unknown", "store"})
"""What a landing, and what hangs on it, may seem to be."""


def of_dwellings(
    floors: Sequence[Floor], ways: Sequence[Sequence[int]]
) -> tuple[list[Floor], list[int]]:
    """The floors of a plan, and the number of each one's dwelling; doors of homes to common parts
    lead outside. ways: doors and passages, by the one or two rooms that each opens into."""
    kinds = [uses.kind for uses in uses_of_home(floors, is_home=False)]
    pairs = [(way[0], way[1]) for way in ways if len(way) == 2]
    numbers = dwellings_of(kinds, pairs)
    if set(numbers) == {1}:
        doors = Counter(way[0] for way in ways if len(way) == 1)
        common = _core(kinds, pairs, [floor.stairs for floor in floors], doors)
        numbers = [int(index not in common) for index in range(len(floors))]
    entered = {room for pair in pairs if any(not numbers[at] for at in pair) for room in pair}
    outer = [replace(floor, is_outer=floor.is_outer or index in entered)
             for index, floor in enumerate(floors)]  # fmt: skip
    return outer, numbers


def _core(
    kinds: Sequence[RoomKind],
    pairs: Sequence[tuple[int, int]],
    stairs: Sequence[float],
    doors: Mapping[int, int],
) -> set[int]:
    """The landing on which one home hangs by one door, with its stair, where they are common.

    stairs: share of each floor. doors: by room, how many lead out of the house.
    """
    for hall, kind in enumerate(kinds):
        left = [pair for pair in pairs if hall not in pair]
        beside = [room for pair in pairs if hall in pair for room in pair if room != hall]
        parts = [part for part in hanging_together(len(kinds), left) if set(beside) & set(part)]
        home = max(parts, key=len, default=[])
        core = {hall, *(room for part in parts if part != home for room in part)}
        has_bath = any(kinds[room] in WET_KINDS for room in home)
        if kind not in _COMMON or not has_bath or len(set(beside) & set(home)) != 1:
            continue
        is_stair = max(stairs[room] for room in core) >= _STAIRS
        is_public = sum(doors[room] for room in core) >= _DOORS_OUT
        if is_stair and is_public and {kinds[room] for room in core} <= _COMMON:
            return core
    return set()


def uses_of_dwellings(
    floors: Sequence[Floor],
    whose: Sequence[int],
    is_home: bool,
    banned: Collection[tuple[int, RoomKind]],
) -> list[Uses]:
    """Uses of all floors: of each dwelling by itself, common parts as they are."""
    all_uses = [Uses("unknown")] * len(floors)
    for number in sorted(set(whose)):
        members = [index for index, home in enumerate(whose) if home == number]
        local = {(members.index(at), use) for at, use in banned if at in members}
        uses = uses_of_home([floors[index] for index in members], is_home and number > 0, local)
        for index, each in zip(members, uses, strict=True):
            all_uses[index] = each if number else Uses("corridor")
    return all_uses


def of_dwelling(room: Room, number: int, whose: Sequence[int]) -> Room:
    """A room with the number of its dwelling, where the plan shows common parts or several."""
    if set(whose) == {1}:
        return room
    kind = room.kind if number else "corridor"
    return replace(room, kind=kind, extra={**room.extra, DWELLING: number})


def said_of(plan: Plan, work: Sequence[str]) -> list[str]:
    """Of common parts and several dwellings, and of what is no home. work: names that say so."""
    count = len({dwelling_of(room) for room in plan.rooms} - {0})
    common = [room.id for room in plan.rooms if dwelling_of(room) == 0]
    lines = (
        [with_step(f"{_SHOWS}{count} dwellings", "; <dwelling> takes one alone")]
        if count > 1
        else []
    )
    if common and count == 1:
        lines.append(f"{_SHOWS}a common landing or stair, which stays empty: {', '.join(common)}")
    listed = ", ".join(map(repr, dict.fromkeys(work)))
    return [*lines, f"{NO_HOME}: rooms are named {listed}"] if work else lines


def dwellings_of(kinds: Sequence[RoomKind], pairs: Sequence[tuple[int, int]]) -> list[int]:
    """Of N rooms the number of each one's dwelling, from 1, 0 for common parts; all 1 for one home.

    kinds: of the rooms, as far as they are known; pairs: rooms with a way between them.
    """
    best: list[list[int]] = []
    for hall, kind in enumerate(kinds):
        if kind != "corridor":
            continue
        homes = _homes(hall, kinds, pairs)
        if len(homes) > max(1, len(best)):
            best = homes
    numbers = [1 if not best else 0] * len(kinds)
    for number, home in enumerate(sorted(best), 1):
        for room in home:
            numbers[room] = number
    return numbers


def _homes(
    hall: int, kinds: Sequence[RoomKind], pairs: Sequence[tuple[int, int]]
) -> list[list[int]]:
    """The parts that are homes once a corridor is taken away on which they hang."""
    left = [pair for pair in pairs if hall not in pair]
    beside = {room for pair in pairs if hall in pair for room in pair} - {hall}
    parts = [sorted(part) for part in hanging_together(len(kinds), left) if beside & set(part)]
    homes = [part for part in parts if _is_home(part, kinds)]
    seats = [{kinds[room] for room in part} & _SEATS for part in homes]
    if not any("kitchen" in kinds_of for kinds_of in seats):
        return homes
    return [part for part, seat in zip(homes, seats, strict=True) if seat != {"dining"}]


def _is_home(rooms: Collection[int], kinds: Sequence[RoomKind]) -> bool:
    home_kinds = {kinds[room] for room in rooms}
    return not home_kinds.isdisjoint(("bathroom", "wc")) and bool(home_kinds & _SEATS)


def work_names(names: Sequence[str]) -> list[str]:
    """The names of rooms of a plan that is no home: offices, schools, shops. Empty for a home."""
    work = [name for name in names if _is_work(name)]
    home = [name for name in names if name not in work and room_kind(name) in _AT_HOME]
    office = [name for name in names if name not in work and _words(name) & _OFFICE]
    return [*work, *office] if len(work) >= _LEAST_WORK and not home else []


def _is_work(name: str) -> bool:
    return bool(_words(name) & _WORK)


def _words(name: str) -> set[str]:
    """Words of a name without numbers and accents, and two that follow one another as one."""
    words = [word for word in plain(name.casefold()).replace("/", " ").split() if word.isalpha()]
    return {*words, *(a + b for a, b in pairwise(words))}
