"""Which rooms of a plan are whose: a stair or landing that homes hang on is common to them.

A home has a bath, and a kitchen or a room to sit in. Where a corridor is taken away and two or more
parts of the house that hung on it are homes by themselves, the corridor is common, and so are the
parts that are none: lifts, stores, the stair behind a landing. A bedroom with its bath is no home,
and neither is a wing with a table alone beside a part that has a kitchen.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from itertools import pairwise

from chord_usd.base.scene.geometry import hanging_together
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.room_words import plain
from chord_usd.base.scene.types import RoomKind

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
    if not any("kitchen" in one for one in seats):
        return homes
    return [part for part, one in zip(homes, seats, strict=True) if one != {"dining"}]


def _is_home(rooms: Collection[int], kinds: Sequence[RoomKind]) -> bool:
    own = {kinds[room] for room in rooms}
    return not own.isdisjoint(("bathroom", "wc")) and bool(own & _SEATS)


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
