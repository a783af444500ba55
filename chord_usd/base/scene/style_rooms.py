"""The look of a room of a home: family and parameters, sampled from the ranges of its style.

Rooms agree since all draws of a home share their numbers: two rooms that may have planks have the
same ones.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from chord_usd.base.scene.style_looks import ACCENTS, GROUP_OF, HOME_WOOD, PAINTS, Ranges, Value
from chord_usd.base.scene.styles import HomeStyle, share
from chord_usd.base.scene.types import Room

Part = Literal["floor", "wall"]

_ACCENT_POOL = 2
"""So many different accent walls a home has at most."""


@dataclass(frozen=True)
class Wanted:
    """A look that is not drawn yet."""

    family: str
    settings: Mapping[str, float | str]
    """Parameters that are not as usual."""


def looks_for(style: HomeStyle, seed: int, part: Part, room: Room, count: int) -> list[Wanted]:
    """Looks of the floor or walls of a room, the first one worn; up to count different ones.

    The draw depends on style, seed, kind and id of the room alone.
    """
    group = GROUP_OF[room.kind]
    looks = style.floors[group] if part == "floor" else style.walls[group]
    usual = _drawn(looks, style, seed, part, count)
    if part == "floor":
        return usual
    accents = _drawn(style.accent_looks.get(group, ()), style, seed, "accent", _ACCENT_POOL)
    key = f"{style.name}/{seed}/{room.id}"
    if not accents or share(f"{key}/accented") >= style.accent_walls:
        return _different([*usual[:2], *accents, *usual[2:]], count)
    worn = accents[int(share(f"{key}/accent") * len(accents))]
    return _different([worn, *usual[:1], *accents, *usual[1:]], count)


def _drawn(
    looks: Sequence[Ranges], style: HomeStyle, seed: int, part: str, count: int
) -> list[Wanted]:
    """Looks in a weighted order, each family once, then further draws of them."""
    key = f"{style.name}/{seed}/{part}"
    # Weighted order without replacement, by the one number that a family has in this home.
    order = sorted(
        enumerate(looks),
        key=lambda entry: -(share(f"{key}/{_name(entry[1], looks)}") ** (1.0 / entry[1].weight)),
    )
    settled = [
        _settled(ranges, style, seed, f"{key}/{_name(ranges, looks)}/{again}")
        for again in range(count if looks else 0)
        for _, ranges in order
    ]
    return _different(settled, count)


def _name(ranges: Ranges, looks: Sequence[Ranges]) -> str:
    """Of a family within a list; numbered where a list has it several times."""
    same = [other for other in looks if other.family == ranges.family]
    return f"{ranges.family}{next(n for n, other in enumerate(same) if other is ranges)}"


def _different(looks: Sequence[Wanted], count: int) -> list[Wanted]:
    distinct: list[Wanted] = []
    for look in looks:
        if look not in distinct:
            distinct.append(look)
    return distinct[:count]


def _settled(ranges: Ranges, style: HomeStyle, seed: int, key: str) -> Wanted:
    """One value for each range."""
    home = style.agreed(seed)
    settings = {}
    for name, value in ranges.parameters.items():
        chosen = _value(value, share(f"{key}/{name}"))
        if chosen == HOME_WOOD:
            chosen = home.wood
        elif chosen in ACCENTS:
            chosen = PAINTS[home.accent][ACCENTS.index(str(chosen))]
        settings[name] = chosen
    return Wanted(ranges.family, settings)


def _value(value: Value, at: float) -> float | str:
    if not isinstance(value, tuple):
        return value
    if isinstance(value[0], str):
        return value[int(at * len(value))]
    low, high = float(value[0]), float(value[1])
    return float(f"{low + at * (high - low):.3g}")
