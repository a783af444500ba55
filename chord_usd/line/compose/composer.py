"""A kitchen for a room: the cheapest in the taste of one seed, cut into units."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
import shapely

from chord_usd.base.metrics.clear_floor import shut_borders
from chord_usd.base.metrics.design.kitchen_rules import RULES
from chord_usd.base.metrics.design.rule import judge
from chord_usd.base.metrics.design.shell import shells
from chord_usd.base.metrics.design.view import View
from chord_usd.base.metrics.footprints import is_underfoot
from chord_usd.base.metrics.fronts import FRONT, floor_before, shut_fronts
from chord_usd.base.metrics.unit_gaps import KITCHEN_UNITS
from chord_usd.base.scene.geometry import footprint_polygon, room_polygon
from chord_usd.base.scene.trim import DRIP_M
from chord_usd.base.scene.types import WALL_THICKNESS_M, Edit, Item, Room, SceneGraph
from chord_usd.base.scene.units import wrap_deg
from chord_usd.line.compose.cut import DOUBLE, Unit, box_at, units_of
from chord_usd.line.compose.prices import AISLE_M
from chord_usd.line.compose.search import EFFORT, Found, Hint, Wanted, cheapest
from chord_usd.line.compose.site import BEFORE_M, Site, Wall, floor_of, site_of

DEPTHS_M = 0.6, 0.55, 0.5
HEIGHT_M = 0.87
LEAST_HEIGHT_M = 0.8
"""Of a worktop below a low window."""
_NOTHING = (0, 0.0)
_MOST_APART = 24.0
"""Cost of a kitchen beside the cheapest: no more than a number or two."""
_MOST_APART_DRAWN = 3.0
"""Where the plan shows its units: a quarter of a metre away from them."""
_EACH = 8
"""Shapes looked at for each kitchen that is judged by all rules."""


def compose(
    house: SceneGraph,
    room: Room,
    seed: int,
    *,
    hints: Sequence[Hint] = (),
    stays: Collection[Item] = (),
    without: Collection[str] = frozenset(),
    effort: int = EFFORT,
    compact: bool = True,
    is_drawn: bool = False,
) -> list[Unit]:
    """Units for a room of a house, [] where no run fits in.

    hints: where lists, a picture or a drawing have units: walls and extents are taken from them
    where numbers allow. stays: pieces that units stand beside; other pieces may move, and are paid
    for. without: categories that are not wanted. effort: shapes that are looked at.
    compact: whether a sink narrower than usual will do where nothing else fits. is_drawn: whether
    hints are what the plan shows, which weighs more than planning numbers.
    """
    held = {item.id for item in stays}
    moves = [item for item in house.items_of(room.id)
             if item.category not in KITCHEN_UNITS and item.id not in held]  # fmt: skip
    site = site_of(house, room, stays, moves)
    wanted = Wanted(
        "refrigerator" not in without, "electrical_floor_cabinet" not in without, tuple(hints),
        worktop_height(site), effort, is_drawn=is_drawn,
    )  # fmt: skip
    rng = np.random.default_rng(seed)
    stood_on = shapely.union_all([footprint_polygon(item.box) for item in stays])
    floor = room_polygon(room).difference(stood_on)
    options = cheapest(site, wanted, rng, DEPTHS_M, compact=compact)[: 1 + effort // _EACH]
    # All rules weigh nearly the same there: a cooker at the end of its run is worse than that.
    most = _MOST_APART_DRAWN if is_drawn else _MOST_APART
    options = [option for option in options if option.cost < options[0].cost + most]
    best: tuple[tuple[int, float], list[Unit]] | None = None
    for layout in options:
        units = units_of(layout, wanted, rng)
        units += island_of(site, floor, layout, units, wanted.height, rng)
        if len(options) == 1:
            return units
        missed = _missed(house, room, stays, units)
        if best is None or missed < best[0]:
            best = missed, units
        if missed == _NOTHING:
            break
    return best[1] if best else []


def _missed(
    house: SceneGraph, room: Room, stays: Collection[Item], units: Sequence[Unit]
) -> tuple[int, float]:
    """How many fronts nobody could stand before and borders nobody could cross, and the share of
    planning rules (metrics.design) that units break."""
    items = [Item(str(index), unit.category, unit.box, room.id) for index, unit in enumerate(units)]
    floor = room_polygon(room)
    rooms = [
        neighbour
        for neighbour in house.rooms
        if room_polygon(neighbour).dwithin(floor, WALL_THICKNESS_M / 2)
    ]
    local = SceneGraph(tuple(rooms), house.openings, (*stays, *items))
    shut = len(shut_fronts(local)) + sum(1 for _ in shut_borders(local))
    judged = judge(
        RULES,
        View(shells(house.rooms, house.openings)[room.id], local.items),
        "",
        "kitchen",
        floor.area,
    )
    return shut, 1.0 - judged.share


def worktop_height(site: Site) -> float:
    """Below the lowest sill that units can stand under."""
    sills = [sill - DRIP_M[1] - 0.002 for sill in site.sills]
    return min([HEIGHT_M, *(sill for sill in sills if sill >= LEAST_HEIGHT_M)])


# An island before the run with the sink, where a kitchen has room to walk all round it -----------

FROM_M2 = 14.0
"""Smaller kitchens have none."""
SHARE = 0.6
"""Of the kitchens that have room for one."""
WALKWAY_M = 0.91
"""All round it; a work aisle on the side of the run [NKBA 6, 7]."""
_DEPTH_M = 0.6
_LENGTHS_M = 2.0, 1.6, 1.2
_STEP_M = 0.1


def island_of(
    site: Site, floor: shapely.Polygon, layout: Found, units: Sequence[Unit], height: float,
    rng: np.random.Generator,
) -> list[Unit]:  # fmt: skip
    """Two units that face the run with the sink, [] where they have no room or are not drawn."""
    if site.area_m2 < FROM_M2 or rng.random() >= SHARE:
        return []
    run = layout.shape.runs[layout.sink[0]]
    taken = [footprint_polygon(unit.box) for unit in units]
    free = floor.difference(shapely.union_all([*taken, *site.pieces]))
    keep = shapely.union_all(list(site.swings))
    near = run.depth + AISLE_M
    middle = (run.low + run.high) / 2
    for length in _LENGTHS_M:
        starts = np.arange(run.low, run.high - length + 1e-6, _STEP_M)
        for low in sorted(starts.tolist(), key=lambda s: abs(s + length / 2 - middle)):
            shape = shapely.Polygon(run.wall.rectangle(low, low + length, near, near + _DEPTH_M))
            around = shape.buffer(WALKWAY_M, join_style="mitre")
            if free.covers(around) and not keep.intersects(shape):
                return [
                    _unit(run.wall, low + at * length / 2, length / 2, near, height)
                    for at in (0, 1)
                ]
    return []


def _unit(wall: Wall, low: float, length: float, near: float, height: float) -> Unit:
    box = box_at(wall, low, low + length, _DEPTH_M, height)
    x_m, y_m = wall.at(low + length / 2, near + _DEPTH_M / 2)
    box = replace(
        box, center_m=(float(x_m), float(y_m), 0.0), yaw_deg=wrap_deg(box.yaw_deg + 180.0)
    )
    return Unit(DOUBLE, box, "island")


# The kitchens of a house: composed before they are painted, and put back as composed -------------

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
    kitchens = {}
    for room in rooms:
        items = list(house.items_of(room.id))
        shut_out, stay = excluded.get(room.id, ()), list(kept.get(room.id, ()))
        placed = [item for item in items if item.category in KITCHEN_UNITS]
        is_kitchen = room.kind == "kitchen" or {item.category for item in placed} >= CORE
        is_given = any(item.category in KITCHEN_UNITS for item in stay)
        if not is_kitchen or is_given or CORE.intersection(shut_out):
            continue
        if room.kind != "kitchen":
            stay += [item for item in items if item.category not in KITCHEN_UNITS]
        drawn = [item for item in shown if item.room_id == room.id]
        units = compose(
            house, room, seed + 7919 * numbers[room.id], stays=stay,
            hints=[(item.category, *item.box.center_m[:2]) for item in drawn or placed],
            without=frozenset(shut_out), is_drawn=bool(drawn), effort=effort,
        )  # fmt: skip
        if units:
            kitchens[room.id] = tuple(_items(room.id, units))
    return kitchens


def _items(room_id: str, units: Iterable[Unit]) -> Iterator[Item]:
    counts: dict[str, int] = defaultdict(int)
    for unit in units:
        number = counts[unit.category]
        counts[unit.category] += 1
        item = Item(f"{room_id}/{unit.category}_{number}", unit.category, unit.box, room_id)
        yield item.with_facts(unit=unit.variety)


def with_kitchens(house: SceneGraph, kitchens: Kitchens) -> SceneGraph:
    """The house with composed units in place of all others of these rooms."""
    items = [
        item
        for item in house.items
        if item.room_id not in kitchens or item.category not in KITCHEN_UNITS
    ]
    return replace(house, items=(*items, *(item for units in kitchens.values() for item in units)))


def displaced(house: SceneGraph, kitchens: Kitchens) -> dict[str, list[Item]]:
    """By room id, other pieces that stand in composed units, before them, or behind them, and that
    the plan does not show there."""
    moved: dict[str, list[Item]] = defaultdict(list)
    for room_id, units in kitchens.items():
        stood_on = [footprint_polygon(item.box) for item in units]
        used = [footprint_polygon(floor_before(item.box, FRONT, 0.0, BEFORE_M)) for item in units]
        for item in house.items_of(room_id):
            if item.category in KITCHEN_UNITS or is_underfoot(item) or item.facts.locked:
                continue
            body, *before = floor_of(item)
            pairs = [(body, place) for place in (*stood_on, *used)]
            pairs += [(front, place) for front in before for place in stood_on]
            if any(first.intersection(other).area > _TOUCH_M2 for first, other in pairs):
                moved[room_id].append(item)
    return dict(moved)


def composed_of(house: SceneGraph) -> Kitchens:
    """The composed units that a house holds."""
    kitchens: dict[str, list[Item]] = defaultdict(list)
    for item in house.items:
        if item.facts.unit is not None:
            kitchens[item.room_id].append(item)
    return dict(kitchens)


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
    matched = []
    for unit in units:
        shape = footprint_polygon(unit.box)

        def shared(item: Item) -> float:
            return footprint_polygon(item.box).intersection(shape).area / shape.area  # noqa: B023

        same = [item for item in left if item.category == unit.category]
        best = max(same, key=shared, default=None)
        if best is None or shared(best) < _SEEN_SHARE:
            matched.append(unit)
            continue
        left.remove(best)
        facts = replace(best.facts, unit=unit.facts.unit, below_sill_m=None,
                        edits=(Edit(RULE, best.box),))  # fmt: skip
        matched.append(replace(unit, score=best.score, facts=facts))
    return tuple(matched)
