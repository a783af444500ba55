"""Rules of whole homes: the programme that follows from who sleeps there, and the entrance."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator

import numpy as np

from chord_usd.base.metrics.complete import HOME
from chord_usd.base.metrics.design.bedroom_rules import wardrobes
from chord_usd.base.metrics.design.dining_rules import chairs_of
from chord_usd.base.metrics.design.rule import Measured, Rule
from chord_usd.base.metrics.design.shell import Hole
from chord_usd.base.metrics.design.view import HomeView, Point, View, distances
from chord_usd.base.metrics.rooms import is_studio
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import WET_KINDS, FloatArray

MOST_DINERS = 8
HALL_M = 1.2
LAUNDRY, LAUNDRIES = "laundry", "washing machines"
TABLE, STORAGE = "dining table", "storage in a store room"
NO_HOME_WITHOUT, DINERS = "what no home is without", "diners without a seat"
TELEVISION, WARDROBES = "television", "wardrobe a sleeper"
SHOES, MORE_SHOES = "shoe cabinet from the entrance", "shoe cabinets"
HALL = "share of the floor behind the entrance taken"
"""Names of rules that pieces which are added keep."""
_STORAGE, _LAUNDRY = having("storage"), having("laundry")


def _middle(home: HomeView) -> Point:
    if home.entrance is not None:
        x, y = home.entrance.box.center_m[:2]
        return float(x), float(y)
    return home.rooms[0].middle if home.rooms else (0.0, 0.0)


def _count(*categories: str) -> Callable[[HomeView], Iterator[Measured]]:
    def measure(home: HomeView) -> Iterator[Measured]:
        yield Measured(len(home.of(*categories)), _middle(home))

    return measure


def _wardrobe(home: HomeView) -> Iterator[Measured]:
    total = sum(room.once(_wardrobes_m) for room in home.rooms)
    yield Measured(total / max(1, home.sleepers), _middle(home))


def _wardrobes_m(room: View) -> float:
    return float(room.length[wardrobes(room)].sum())


def _diners(home: HomeView) -> Iterator[Measured]:
    seats = sum(room.once(_seats) for room in home.rooms)
    wanted = min(max(1, home.sleepers), MOST_DINERS)
    yield Measured(max(0, wanted - seats), _middle(home))


def _unseated(home: HomeView) -> Iterator[Measured]:
    """The same as a share of those who eat there."""
    for diners in _diners(home):
        wanted = min(max(1, home.sleepers), MOST_DINERS)
        yield Measured(diners.have / wanted, diners.at)


def _seats(room: View) -> int:
    return len({chair for table in room.of("dining_table") for chair in chairs_of(room, table)})


def _televisions(home: HomeView) -> Iterator[Measured]:
    yield Measured(sum(len(room.televisions) for room in home.rooms), _middle(home))


def _lacks(home: HomeView) -> Iterator[Measured]:
    there = {name for room in home.rooms for name in room.categories}
    missing = [name for name, categories in HOME.items() if not there & categories]
    yield Measured(len(missing), _middle(home))


def _shoes(home: HomeView) -> Iterator[Measured]:
    if home.entrance is None:
        return
    door = np.array([home.entrance.box.center_m[:2]])
    away = [float(distances(door, room.edges[at]).min()) for room, at in home.of("shoe_cabinet")]
    yield Measured(min(away, default=math.inf), _middle(home))


def _hall(home: HomeView) -> Iterator[Measured]:
    """How much of the floor behind the entrance is taken."""
    if home.entrance is None:
        return
    for room in home.rooms:
        if any(hole.id == home.entrance.id for hole in room.shell.holes):
            for name, share in room.once(_taken_behind):
                if name == home.entrance.id:
                    yield Measured(share, _middle(home))


def _taken_behind(room: View) -> list[tuple[str, float]]:
    """Ids of the openings of a room, and how much of the floor behind each is taken."""
    standing = np.flatnonzero(room.stands).tolist()
    if not standing:
        return [(hole.id, 0.0) for hole in room.shell.holes]
    return [
        (hole.id, float(room.covered(_square(hole), standing).sum())) for hole in room.shell.holes
    ]


def _square(door: Hole) -> FloatArray:
    """(K, 2) points over the floor behind a door."""
    along = (np.arange(12) + 0.5) / 12
    ahead = door.depth_m / 2 + (np.arange(16) + 0.5) / 16 * HALL_M
    line = door.ends[0] + along[:, None] * (door.ends[1] - door.ends[0])
    points: FloatArray = line[:, None] + ahead[None, :, None] * door.inward
    return points.reshape(-1, 2)


def _empty_stores(home: HomeView) -> Iterator[Measured]:
    for room in home.rooms:
        if room.shell.kind == "store":
            yield Measured(len(room.of(*_STORAGE, *_LAUNDRY)), room.middle)


def _bare_bedrooms(home: HomeView) -> Iterator[Measured]:
    """Bedrooms without a bed; of a studio, its living room."""
    kind = "living" if is_studio([room.shell.kind for room in home.rooms]) else "bedroom"
    slept_in = [room for room in home.rooms if room.shell.kind == kind]
    if kind == "living":
        slept_in = [room for room in slept_in if room.shell.is_largest]
    bare = [room for room in slept_in if not room.of("bed")]
    if slept_in:
        yield Measured(len(bare), bare[0].middle if bare else _middle(home))


def _bathrooms(home: HomeView) -> list[View]:
    return [room for room in home.rooms if room.shell.kind in WET_KINDS]


def _wash(home: HomeView) -> Iterator[Measured]:
    """A bath or shower somewhere."""
    if _bathrooms(home):
        yield Measured(len(home.of(*having("bathing"))), _middle(home))


RULES: tuple[Rule[HomeView], ...] = (
    Rule(NO_HOME_WITHOUT, 0, "count", "NDSS", _lacks, at_most=True, weight=2.0),
    Rule("rooms to sleep in without a bed", 0, "count", "NDSS", _bare_bedrooms, at_most=True,
         weight=2.0),
    Rule(WARDROBES, 1.00, "m", "HUD 1973", _wardrobe),
    Rule(LAUNDRY, 1, "count", "DIN 18022", _count(*_LAUNDRY)),
    Rule(LAUNDRIES, 1, "count", "planning guides", _count(*_LAUNDRY), at_most=True, weight=0.5),
    Rule(DINERS, 0, "count", "HUD 1973", _diners, at_most=True),
    Rule("share of the diners without a seat", 0.4, "share", "HUD 1973", _unseated, at_most=True),
    Rule(TABLE, 1, "count", "HUD 1973", _count("dining_table")),
    Rule(TELEVISION, 1, "count", "planning guides", _televisions),
    Rule("refrigerator", 1, "count", "NKBA 3", _count("refrigerator")),
    Rule("bath or shower", 1, "count", "DIN 18022", _wash),
    Rule(SHOES, 3.00, "m", "DIN 18011", _shoes, at_most=True),
    Rule(MORE_SHOES, 1, "count", "planning guides", _count("shoe_cabinet"), at_most=True,
         weight=0.5),
    Rule(HALL, 0.03, "share", "DIN 18011", _hall, at_most=True),
    Rule(STORAGE, 1, "count", "NDSS", _empty_stores, weight=0.5),
)  # fmt: skip
