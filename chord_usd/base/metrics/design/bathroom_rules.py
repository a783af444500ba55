"""Rules of bathrooms: clearances of toilet, basin, bath and shower, and their sizes."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from chord_usd.base.metrics.complete import lacking
from chord_usd.base.metrics.design.rule import Measured, Rule, flag
from chord_usd.base.metrics.design.view import View, distances
from chord_usd.base.scene.palette import having

BASINS, WET = having("basin"), having("bathing")
BASIN_FROM_M2 = 2.2
"""Rooms with a toilet have room for a basin beside it from this area on."""
PLUMBED = ("toilet", "bathtub", *BASINS)
_FACE_M2 = 2.5
"""A smaller room cannot turn its toilet from the door."""
_ENTRY_M = 0.6


def _id(view: View, *numbers: int) -> tuple[str, ...]:
    return tuple(view.items[at].id for at in numbers)


def _toilet(view: View) -> Iterator[int]:
    yield from view.of("toilet")[:1]


def _basin(view: View) -> Iterator[int]:
    yield from view.of(*BASINS)[:1]


def _wet(view: View) -> Iterator[int]:
    yield from view.of(*WET)[:1]


def _toilet_side(view: View) -> Iterator[Measured]:
    for at in _toilet(view):
        low, high = 0.15 - view.depth[at] / 2, view.depth[at] / 2
        free = min(view.beside(at, side, low, high) for side in (-1, 1))
        yield Measured(free + view.length[at] / 2, view.point(at), _id(view, at))


def _front_of(view: View, at: int) -> Measured:
    half = view.length[at] / 2 - 0.02
    free = view.before(at, -half, half)
    return Measured(free, view.point(at, 0, view.depth[at] / 2), _id(view, at))


def _toilet_front(view: View) -> Iterator[Measured]:
    for at in _toilet(view):
        yield _front_of(view, at)


def _basin_front(view: View) -> Iterator[Measured]:
    for at in _basin(view):
        yield _front_of(view, at)


def faces_door(view: View, at: int) -> bool:
    """Whether somebody in a door looks at the front of a piece."""
    half = np.array([view.length[at], view.depth[at]]) / 2
    points = view.grid(at, (-half[0], half[0]), (-half[1], half[1]))
    for hole in view.shell.entries:
        ahead = points - hole.middle
        along = (hole.ends[1] - hole.ends[0]) / max(hole.length_m, 1e-6)
        forward, aside = ahead @ hole.inward, np.abs(ahead @ along)
        share = ((forward > 0.1) & (forward < 5.0) & (aside < hole.length_m / 2 - 0.05)).mean()
        taken_m2 = share * view.length[at] * view.depth[at]
        if taken_m2 > 0.05 and view.front[at] @ hole.inward < -0.7:
            return True
    return False


def _toilet_door(view: View) -> Iterator[Measured]:
    for at in _toilet(view):
        yield flag(faces_door(view, at), view.point(at), *_id(view, at))


def _basin_width(view: View) -> Iterator[Measured]:
    for at in _basin(view):
        yield Measured(float(view.length[at]), view.point(at), _id(view, at))


def _basin_side(view: View) -> Iterator[Measured]:
    """From the middle of the basin to a side wall or piece."""
    for at in _basin(view):
        low, high = 0.1 - view.depth[at] / 2, view.depth[at] / 2
        free = min(view.beside(at, side, low, high) for side in (-1, 1))
        yield Measured(free + view.length[at] / 2, view.point(at), _id(view, at))


def _access(view: View) -> Iterator[Measured]:
    """Free floor before bath or shower, somewhere along a side that is not at a wall."""
    for at in _wet(view):
        low, high = 0.1 - view.depth[at] / 2, view.depth[at] / 2 - 0.1
        best = max(view.beside(at, side, low, high) for side in (-1, 1))
        half = view.length[at] / 2
        starts = np.arange(-half, max(half - _ENTRY_M, -half) + 1e-6, 0.15)
        best = max(best, *(view.before(at, u, min(u + _ENTRY_M, half)) for u in starts))
        yield Measured(best, view.point(at, 0, view.depth[at] / 2), _id(view, at))


def _sizes(category: str) -> Callable[[View], Iterator[Measured]]:
    def measure(view: View) -> Iterator[Measured]:
        for at in _wet(view):
            if view.categories[at] == category:
                size = view.length[at]
                if category == "shower":
                    size = min(size, view.depth[at])
                yield Measured(float(size), view.point(at), _id(view, at))

    return measure


def _all_there(view: View) -> Iterator[Measured]:
    missing = lacking(view.shell.kind, view.shell.area_m2, view.categories)
    yield Measured(len(missing), view.middle)


def _basin_there(view: View) -> Iterator[Measured]:
    """Basins; none counts where a bathroom has nothing to bathe in for it."""
    is_instead = view.shell.kind == "bathroom" and not view.of(*WET)
    if view.of("toilet"):
        count = 0 if is_instead else len(view.of(*BASINS))
        yield Measured(count, view.middle, _id(view, *view.of("toilet")[:1]))


def _toilets(view: View) -> Iterator[Measured]:
    yield Measured(len(view.of("toilet")), view.middle, _id(view, *view.of("toilet")))


def _oblique(view: View) -> Iterator[Measured]:
    """How far plumbing is turned from the nearest wall."""
    sides = view.shell.sides
    along = sides[:, 1] - sides[:, 0]
    for at in view.of(*PLUMBED, "shower"):
        away = distances(view.corners[at], sides).min(axis=0)
        near = along[int(np.argmin(away))]
        turn = np.degrees(np.arctan2(near[1], near[0])) - view.yaw[at]
        yield Measured(abs((turn + 45.0) % 90.0 - 45.0), view.point(at), _id(view, at))


RULES: tuple[Rule[View], ...] = (
    Rule("fixtures missing", 0, "count", "DIN 18022", _all_there, at_most=True, weight=2.0),
    Rule("toilets", 1, "count", "DIN 18022", _toilets, at_most=True),
    Rule(
        "washbasin beside the toilet",
        1,
        "count",
        "DIN 18022",
        _basin_there,
        weight=1.5,
        from_m2=BASIN_FROM_M2,
    ),
    Rule("middle of the toilet to a side", 0.40, "m", "NKBA bath 5 (code 38)", _toilet_side),
    Rule(
        "middle of the toilet to a side, comfortably",
        0.46,
        "m",
        "NKBA bath 5",
        _toilet_side,
        weight=0.3,
    ),
    Rule("before the toilet", 0.60, "m", "NKBA bath 5 (code 53)", _toilet_front),
    Rule("before the toilet, comfortably", 0.76, "m", "NKBA bath 5", _toilet_front, weight=0.3),
    Rule(
        "toilet faces the door",
        0,
        "count",
        "planning guides",
        _toilet_door,
        at_most=True,
        from_m2=_FACE_M2,
    ),
    Rule("before the basin", 0.70, "m", "NKBA bath 8", _basin_front),
    Rule("before the basin, comfortably", 0.76, "m", "NKBA bath 8", _basin_front, weight=0.3),
    Rule("width of the basin", 0.50, "m", "DIN 18022", _basin_width, is_fine=True),
    Rule("middle of the basin to a side", 0.38, "m", "NKBA bath 8 (code)", _basin_side, weight=0.5),
    Rule("before bath or shower", 0.60, "m", "NKBA bath (code 53)", _access),
    Rule("before bath or shower, comfortably", 0.76, "m", "NKBA bath", _access, weight=0.3),
    Rule("sides of the shower", 0.80, "m", "DIN 18022", _sizes("shower")),
    Rule(
        "sides of the shower, comfortably",
        0.90,
        "m",
        "NKBA bath",
        _sizes("shower"),
        is_fine=True,
        weight=0.3,
    ),
    Rule("length of the bath", 1.50, "m", "DIN 18022", _sizes("bathtub"), is_fine=True),
    Rule(
        "plumbing oblique to its wall",
        1,
        "deg",
        "planning guides",
        _oblique,
        at_most=True,
        weight=0.5,
    ),
)
