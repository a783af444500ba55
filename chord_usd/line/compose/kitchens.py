"""The kitchens of a house: composed before they are painted, and put back as composed after."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

from chord_usd.base.metrics.footprints import is_underfoot
from chord_usd.base.metrics.fronts import FRONT, floor_before
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.scene.geometry import footprint_polygon
from chord_usd.base.scene.types import Edit, Item, Room, SceneGraph
from chord_usd.line.compose.composer import compose
from chord_usd.line.compose.cut import Unit
from chord_usd.line.compose.search import EFFORT
from chord_usd.line.compose.site import BEFORE_M, floor_of

RULE = "kitchen as composed"
"""Name of the edit in units that were painted elsewhere or in another size."""

CORE = frozenset(("sink_cabinet", "cooker_cabinet"))
"""Rooms of other kinds that hold these have a kitchen in them."""

_TOUCH_M2 = 1e-3
_SEEN_SHARE = 0.3
"""Of a unit's floor that a painted one of its category covers, so that it is that."""

Kitchens = Mapping[str, Sequence[Item]]
"""Composed units by room id."""


def composed_kitchens(
    house: SceneGraph,
    rooms: Iterable[Room],
    seed: int,
    excluded: Mapping[str, Collection[str]],
    kept: Mapping[str, Sequence[Item]],
    shown: Sequence[Item] = (),
    effort: int = EFFORT,
) -> Kitchens:
    """Units for the kitchens among these rooms.

    The house holds what lists or a picture have placed: walls and extents are taken from that.
    excluded: categories by room id. kept: pieces that stay, by room id; a kitchen with kept units,
    or without sink or cooker by wish, is left as it is. shown: units that the plan shows.
    effort: of compose.
    """
    numbers = {room.id: number for number, room in enumerate(house.rooms)}
    found = {}
    for room in rooms:
        own = list(house.items_of(room.id))
        shut_out, stay = excluded.get(room.id, ()), list(kept.get(room.id, ()))
        placed = [item for item in own if item.category in KITCHEN_UNITS]
        is_kitchen = room.kind == "kitchen" or {item.category for item in placed} >= CORE
        is_given = any(item.category in KITCHEN_UNITS for item in stay)
        if not is_kitchen or is_given or CORE.intersection(shut_out):
            continue
        if room.kind != "kitchen":
            stay += [item for item in own if item.category not in KITCHEN_UNITS]
        drawn = [item for item in shown if item.room_id == room.id]
        units = compose(
            house, room, seed + 7919 * numbers[room.id], stays=stay,
            hints=[(item.category, *item.box.center_m[:2]) for item in drawn or placed],
            without=frozenset(shut_out), is_drawn=bool(drawn), effort=effort,
        )  # fmt: skip
        if units:
            found[room.id] = tuple(_items(room.id, units))
    return found


def _items(room_id: str, units: Iterable[Unit]) -> Iterator[Item]:
    counts: dict[str, int] = defaultdict(int)
    for unit in units:
        number = counts[unit.category]
        counts[unit.category] += 1
        item = Item(f"{room_id}/{unit.category}_{number}", unit.category, unit.box, room_id)
        yield item.found(unit=unit.variety)


def with_kitchens(house: SceneGraph, kitchens: Kitchens) -> SceneGraph:
    """The house with composed units in place of all others of these rooms."""
    items = [
        item
        for item in house.items
        if item.room_id not in kitchens or item.category not in KITCHEN_UNITS
    ]
    return replace(house, items=(*items, *(item for own in kitchens.values() for item in own)))


def displaced(house: SceneGraph, kitchens: Kitchens) -> dict[str, list[Item]]:
    """By room id, other pieces that stand in composed units, before them, or behind them, and that
    the plan does not show there."""
    found: dict[str, list[Item]] = defaultdict(list)
    for room_id, units in kitchens.items():
        stood_on = [footprint_polygon(item.box) for item in units]
        used = [footprint_polygon(floor_before(item.box, FRONT, 0.0, BEFORE_M)) for item in units]
        for item in house.items_of(room_id):
            if item.category in KITCHEN_UNITS or is_underfoot(item) or item.facts.locked:
                continue
            own, *before = floor_of(item)
            pairs = [(own, one) for one in (*stood_on, *used)]
            pairs += [(front, one) for front in before for one in stood_on]
            if any(one.intersection(other).area > _TOUCH_M2 for one, other in pairs):
                found[room_id].append(item)
    return dict(found)


def composed_of(house: SceneGraph) -> Kitchens:
    """The composed units that a house holds."""
    found: dict[str, list[Item]] = defaultdict(list)
    for item in house.items:
        if item.facts.unit is not None:
            found[item.room_id].append(item)
    return dict(found)


def put_back(house: SceneGraph, kitchens: Kitchens) -> SceneGraph:
    """A house that was read, its kitchens as they were composed: what is known of painted units
    goes to those that they stand for."""
    return with_kitchens(house, {
        room_id: _seen(units, [i for i in house.items_of(room_id) if i.category in KITCHEN_UNITS])
        for room_id, units in kitchens.items()
    })  # fmt: skip


def _seen(units: Sequence[Item], painted: Sequence[Item]) -> tuple[Item, ...]:
    """Composed units with what was found out about the painted ones that they stand for."""
    left = list(painted)
    found = []
    for unit in units:
        shape = footprint_polygon(unit.box)

        def shared(item: Item) -> float:
            return footprint_polygon(item.box).intersection(shape).area / shape.area  # noqa: B023

        own = [item for item in left if item.category == unit.category]
        best = max(own, key=shared, default=None)
        if best is None or shared(best) < _SEEN_SHARE:
            found.append(unit)
            continue
        left.remove(best)
        facts = replace(best.facts, unit=unit.facts.unit, below_sill_m=None,
                        edits=(Edit(RULE, best.box),))  # fmt: skip
        found.append(replace(unit, score=best.score, facts=facts))
    return tuple(found)
