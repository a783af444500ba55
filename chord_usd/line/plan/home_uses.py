"""What the floors of a home are for: one most likely assignment of uses to all of them together.

What speaks for a use of a floor is in nats: its names, what is drawn there, its size, its doors,
windows and stairs. What speaks for the home is in nats, too: it has an entrance, a bath, a bed, a
seat, and exactly one kitchen where one is named or drawn. A floor may have several uses, as in an
open plan. The best assignment is exact: the home's needs depend on counts alone, so that floors are
taken one after the other, with the best way to each count (dynamic programming).
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import combinations

from shapely.geometry import Point, Polygon

from chord_usd.base.raster.page_labels import KIND_NAMES
from chord_usd.base.scene.palette import category
from chord_usd.base.scene.room_areas import plausibility
from chord_usd.base.scene.room_names import room_kind
from chord_usd.base.scene.room_words import plain
from chord_usd.base.scene.types import WET_KINDS, FloatArray, Item, RoomKind, learned_kind
from chord_usd.line.plan.open_plans import can_share

_SURE = 0.5
"""A room's kind is known from this chance on."""
_LEAST_CHANCE = 1e-3

_MISSED: dict[str, float] = {
    "bathroom": 4.0, "bed": 3.0, "seat": 2.0, "kitchens": 2.5, "entrance": 1.5
}  # fmt: skip
"""Nats that a home without it costs, by the fields of _Counts."""
_MISSED_NAMED = 12.0
"""Nats that a home costs without the kitchen that is named."""
_SECOND_KITCHEN = 4.0
"""Nats of a kitchen without a name beside another."""

_HOST_M2 = 14.0
_HOSTS: dict[tuple[RoomKind, RoomKind], float] = {
    ("living", "kitchen"): 1.6, ("dining", "kitchen"): 1.8, ("bedroom", "kitchen"): 2.2,
    ("corridor", "kitchen"): 3.5, ("living", "bedroom"): 1.5,
}  # fmt: skip
"""(leading use, further use) of a floor, and nats of a further use that is not named there."""
_GUESTS: tuple[RoomKind, ...] = ("kitchen", "bedroom")
_DRAWN_M2, _DRAWN_NATS = 2.0, 0.5
"""From so many square metres on a kitchen is drawn; nats a square metre of one not built there."""
_MOST_DRAWN_NATS = 3.0

_SPEAKS: dict[str, tuple[RoomKind, float]] = {
    "bathtub": ("bathroom", 3.0), "shower": ("bathroom", 2.0), "toilet": ("bathroom", 3.0),
    "washbasin": ("bathroom", 1.0), "cooker_cabinet": ("kitchen", 3.0),
    "sink_cabinet": ("kitchen", 1.0), "refrigerator": ("kitchen", 2.0),
    "bed": ("bedroom", 3.0), "sofa": ("living", 2.0),
}  # fmt: skip
"""What a drawn piece speaks for, and nats of one that is surely there."""
_PRINTED: dict[RoomKind, tuple[str, ...]] = {
    "kitchen": (
        *("island", "kitchen_island", "kochinsel", "kucheninsel", "dishwasher", "microwave"),
        *("geschirrspuler", "spulmaschine", "lave_vaisselle", "lavavajillas", "lava_loucas"),
        *("lavastoviglie", "diskmaskin", "astianpesukone", "vaatwasser", "食洗機", "洗碗机"),
    ),
    "bedroom": ("mattress", "matratze", "matelas", "colchon", "colchao", "materasso", "madrass"),
}  # fmt: skip
"""Words for what has no category, and stands in one kind of room; without accents."""
_PRINTED_NATS = 4.0
"""Of such a word: what is printed is surer than what is drawn."""
_MOST_SPOKEN, _SPOKEN = 4.0, 1.5
"""Nats of all pieces of a kind; from so many on a kitchen is drawn."""

_ON_STAIRS, _STAIRS = 3.0, 0.2
"""Nats of a use on floor of which stairs take up this share, but for corridors."""
_MANY_WAYS, _HALL_NATS = 3, 0.7
"""Doors and passages from which on a floor is rather a corridor, and no bath or store."""
_MOST_WAYS = 4
"""...and none but a living room: nats of each further one, a front door included."""
_HALL_CHANCE, _MOST_HALL = 0.2, 0.6
"""Least chance of a hall, for each further one, and in all."""
_SHUT_NATS = 1.5
"""Nats of a kitchen into which no way is seen: a closet with a door that was missed."""
_WAY_M2, _PASSED, _PASSED_NATS = 0.8, 0.6, 1.5
"""Floor that a way keeps free; from this share of a floor on it has no place for what rooms hold;
nats of a room to furnish there."""
_FURNISHED: frozenset[RoomKind] = frozenset({"kitchen", "dining", "bedroom", "living", "study"})
_ENTERED: frozenset[RoomKind] = frozenset({"corridor", "living", "kitchen", "dining"})
"""What a front door leads into."""
_WINDOWLESS: dict[RoomKind, float] = {"living": 0.7, "bedroom": 0.7, "kitchen": 0.3}
"""Nats of a room without a window in a home that has windows."""


@dataclass(frozen=True, eq=False)
class Floor:
    """What is known of the floor of a room."""

    chances: FloatArray
    """(K,) of KIND_NAMES, by what is drawn there."""
    named_kind: RoomKind = "unknown"
    """The leading kind that its name says."""
    named: frozenset[RoomKind] = frozenset()
    """All kinds that its names say and that can share a floor."""
    area_m2: float | None = None
    """None while the scale is not known."""
    drawn_m2: Mapping[RoomKind, float] = field(default_factory=dict)
    """How much of it looks like each kind."""
    drawn: Mapping[RoomKind, float] = field(default_factory=dict)
    """Nats by the furniture and fixtures that are drawn there."""
    ways: int = 0
    """Doors and passages into other rooms."""
    is_outer: bool = False
    """Whether a door leads out of the house."""
    has_window: bool = True
    """Or stands in a home without any."""
    stairs: float = 0.0
    """Share that stairs take up."""

    @property
    def crossings(self) -> int:
        """Ways beyond those that rooms have, a front door included."""
        return max(self.ways + self.is_outer - _MOST_WAYS, 0)

    @property
    def names_kitchen(self) -> bool:
        """Whether it is named a kitchen, among others."""
        return "kitchen" in self.named | {self.named_kind}


@dataclass(frozen=True)
class Uses:
    """What a floor is for."""

    kind: RoomKind
    """The leading use; unknown where nothing speaks for any."""
    further: frozenset[RoomKind] = frozenset()
    """Uses of its parts."""
    chance: float = 0.0
    """Of the kind, by what is drawn."""

    @property
    def all(self) -> frozenset[RoomKind]:
        """The leading use and the uses of parts."""
        return self.further | {self.kind}


@dataclass(frozen=True)
class _Counts:
    """What a home needs and has so far."""

    kitchens: int = 0
    """Up to two."""
    bathroom: bool = False
    bed: bool = False
    seat: bool = False
    entrance: bool = False

    def more(self, uses: Uses, floor: Floor) -> _Counts:
        has = uses.all
        return _Counts(
            min(self.kitchens + ("kitchen" in has), 2),
            self.bathroom or not has.isdisjoint(("bathroom", "wc")),
            self.bed or bool(has & {"bedroom", "study"}),
            self.seat or bool(has & {"living", "dining"}),
            self.entrance or (floor.is_outer and uses.kind in _ENTERED),
        )


def uses_of_home(
    floors: Sequence[Floor], is_home: bool, banned: Collection[tuple[int, RoomKind]] = ()
) -> list[Uses]:
    """The most likely uses of N floors together.

    is_home: whether these are all floors of a home. banned: (floor, use without a name) that the
    floor has no place for.
    """
    is_named = any(floor.names_kitchen for floor in floors)
    best: dict[_Counts, tuple[float, tuple[Uses, ...]]] = {_Counts(): (0.0, ())}
    for index, floor in enumerate(floors):
        reached: dict[_Counts, tuple[float, tuple[Uses, ...]]] = {}
        options = list(_options(floor, {use for at, use in banned if at == index}, is_home))
        for counts, (nats, way) in best.items():
            for more, uses in options:
                after = counts.more(uses, floor)
                is_second = "kitchen" in uses.all and (is_named or counts.kitchens > 0)
                total = nats + more
                if is_second and not floor.names_kitchen:
                    # A sink drawn elsewhere, in a scullery or a bar, makes no second kitchen.
                    total -= _SECOND_KITCHEN + floor.drawn.get("kitchen", 0.0)
                if after not in reached or total > reached[after][0]:
                    reached[after] = total, (*way, uses)
        best = reached
    missed = {**_MISSED, **({"kitchens": _MISSED_NAMED} if is_named else {})} if is_home else {}
    ends = [
        (nats - sum(cost for need, cost in missed.items() if not getattr(counts, need)), way)
        for counts, (nats, way) in best.items()
    ]
    return list(max(ends, key=lambda end: end[0])[1])


def _options(
    floor: Floor, banned: Collection[RoomKind], is_home: bool
) -> Iterator[tuple[float, Uses]]:
    """(nats, uses) of the ways to use a floor."""
    kinds: Sequence[RoomKind] = (*KIND_NAMES, "unknown")
    likeliest = max(KIND_NAMES, key=lambda kind: _chance(floor, kind))
    free = [kind for kind in kinds if kind not in banned]
    for kind in free if floor.named_kind == "unknown" else (floor.named_kind,):
        chance = _chance(floor, kind)
        nats = 0.0
        if floor.named_kind == "unknown":
            # What speaks against the likeliest kind makes another one likelier, not none.
            against = _speaks_against(floor, likeliest if kind == "unknown" else kind)
            nats = math.log(max(chance, _LEAST_CHANCE)) - against
        further = (floor.named - {kind}) if can_share(kind) else frozenset()
        plain = Uses(kind, frozenset(further), round(chance if kind != "unknown" else 0.0, 2))
        yield nats - _unexplained(floor, plain) + _drawn(floor, plain), plain
        guests: dict[RoomKind, float] = {
            use: cost
            for use in _GUESTS
            if (kind, use) in _HOSTS and use not in plain.all and use not in banned and is_home
            and (cost := _hosting(floor, kind, use)) is not None
        }  # fmt: skip
        for number in range(len(guests)):
            for some in combinations(guests, number + 1):
                shared = Uses(kind, plain.further.union(some), plain.chance)
                cost = sum(guests[use] for use in some)
                yield nats - cost - _unexplained(floor, shared) + _drawn(floor, shared), shared


def speaking(pieces: Iterable[Item], floor: Polygon) -> dict[RoomKind, float]:
    """Nats for kinds of a floor by the pieces that are drawn on it."""
    spoken: dict[RoomKind, float] = {}
    for piece in pieces:
        kind, nats = _SPEAKS.get(piece.category, ("unknown", 0.0))
        if nats and floor.covers(Point(piece.box.center_m[:2])):
            spoken[kind] = min(spoken.get(kind, 0.0) + nats * piece.score, _MOST_SPOKEN)
    return spoken


def named_pieces(texts: Iterable[str]) -> dict[RoomKind, float]:
    """Nats for kinds of a floor by furniture and fixtures that are named there, and are no names of
    rooms: "Bett", "stove"."""
    spoken: dict[RoomKind, float] = {}
    for text in texts:
        words = re.findall(r"\w+", plain(text.casefold()))
        phrases = {"_".join(words[a:b]) for a in range(len(words)) for b in range(a + 1, a + 4)}
        said = [_SPEAKS[_piece_words()[phrase]] for phrase in phrases & _piece_words().keys()]
        said += [(kind, _PRINTED_NATS) for kind, words in _PRINTED.items() if phrases & {*words}]
        for kind, nats in {*said}:
            spoken[kind] = min(spoken.get(kind, 0.0) + nats, _MOST_SPOKEN)
    return spoken


@cache
def _piece_words() -> dict[str, str]:
    """Category by each word for what speaks for a kind of room."""
    return {
        plain(word): name
        for name in _SPEAKS
        for word in category(name).words
        if room_kind(word.replace("_", " ")) == "unknown"
    }


def _drawn(floor: Floor, uses: Uses) -> float:
    kinds = {learned_kind(kind) for kind in uses.all}
    return sum(nats for kind, nats in floor.drawn.items() if kind in kinds)


def _chance(floor: Floor, kind: RoomKind) -> float:
    """Of a kind, by what is drawn and how large the floor is; of none, what a kind has to beat."""
    if kind == "unknown":
        return _SURE
    chance = float(floor.chances[KIND_NAMES.index(learned_kind(kind))])
    if kind == "corridor":  # a bare hall looks like any bare room
        chance = max(chance, min(_HALL_CHANCE * floor.crossings, _MOST_HALL))
    return chance if floor.area_m2 is None else chance * plausibility(kind, floor.area_m2)


def _speaks_against(floor: Floor, kind: RoomKind) -> float:
    """Nats by doors, windows and stairs."""
    nats = 0.0 if floor.has_window else _WINDOWLESS.get(kind, 0.0)
    if floor.stairs > _STAIRS and kind not in ("corridor", "unknown"):
        nats += _ON_STAIRS
    if floor.ways >= _MANY_WAYS and kind in (*WET_KINDS, "store"):
        nats += _HALL_NATS
    if kind not in ("corridor", "living", "unknown"):
        nats += _HALL_NATS * floor.crossings
    if kind == "kitchen" and not floor.ways and not floor.is_outer and floor.area_m2:
        nats += _SHUT_NATS
    if kind in _FURNISHED and floor.area_m2 and floor.ways * _WAY_M2 > _PASSED * floor.area_m2:
        nats += _PASSED_NATS
    return nats


def _hosting(floor: Floor, kind: RoomKind, use: RoomKind) -> float | None:
    """Nats of a further use on a floor that is not named for it; None where it has no place."""
    if floor.area_m2 is None or floor.area_m2 < _HOST_M2:
        return None
    drawn = floor.drawn_m2.get(use, 0.0)
    if use == "kitchen" and (drawn > _DRAWN_M2 or floor.drawn.get(use, 0.0) > _SPOKEN):
        return 0.0
    return _HOSTS[kind, use]


def _unexplained(floor: Floor, uses: Uses) -> float:
    """Nats of a kitchen that is drawn on a part of a floor, and not built there."""
    drawn = floor.drawn_m2.get("kitchen", 0.0)
    if "kitchen" in uses.all or drawn < _DRAWN_M2 or (uses.kind, "kitchen") not in _HOSTS:
        return 0.0
    return min(_DRAWN_NATS * drawn, _MOST_DRAWN_NATS)
