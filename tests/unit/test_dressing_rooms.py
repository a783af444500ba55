"""What rooms are dressed with is in its room, in nothing else, and in nobody's way."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import cast

import numpy as np
import pytest
import shapely

from chord_usd.base.metrics.clear_floor import clearances, enters_height, shut_borders
from chord_usd.base.metrics.design.view import view_home
from chord_usd.base.metrics.fronts import FRONT, STRIP_M, USED_SIDES, floor_before, shut_fronts
from chord_usd.base.metrics.walk import entrance, free_floor, walk
from chord_usd.base.scene.geometry import (
    footprint,
    footprint_polygon,
    in_world,
    polygons_of,
    room_polygon,
)
from chord_usd.base.scene.palette import Mount, category
from chord_usd.base.scene.styles import STYLES
from chord_usd.base.scene.types import (
    ROOM_HEIGHT_M,
    Asset,
    Box,
    Item,
    Opening,
    OpeningKind,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)
from chord_usd.library.database import AssetDatabase
from chord_usd.line.dressing.dress import dress
from chord_usd.line.dressing.stock import Draws, Stock
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from tests.dressing_stock import stock_of_boxes

STOCK = stock_of_boxes()
STYLE = list(STYLES)
TOUCH_M = 0.002
HOUSES = range(12)


@cache
def furnished(seed: int) -> SceneGraph:
    return furnish(random_plan(np.random.default_rng(seed)), np.random.default_rng(seed))


@cache
def dressed(seed: int) -> SceneGraph:
    return dress(furnished(seed), STOCK, STYLES[STYLE[seed % len(STYLE)]], seed)


def mount_of(item: Item) -> Mount:
    return category(item.category).mount


def share_space(a: Box, b: Box) -> bool:
    low = max(a.center_m[2], b.center_m[2])
    high = min(a.center_m[2] + a.size_m[2], b.center_m[2] + b.size_m[2])
    if high - low <= TOUCH_M:
        return False
    return footprint_polygon(a).buffer(-TOUCH_M).intersects(footprint_polygon(b))


def share_area(floor: shapely.Polygon, box: Box) -> bool:
    return floor.buffer(-TOUCH_M).intersects(footprint_polygon(box))


def standing(graph: SceneGraph) -> list[tuple[str, Box]]:
    found = [(item.id, item.box) for item in graph.items]
    for item in graph.items:
        found += [(child.id, in_world(child.box, item.box)) for child in item.children]
    return found


@pytest.mark.parametrize("seed", HOUSES)
def test_dressing_is_in_nothing_else(seed: int) -> None:
    graph = dressed(seed)
    assert graph.dressing
    around = standing(graph)
    solid = [item for item in graph.dressing if mount_of(item) is not Mount.UNDERFOOT]
    boxes = shapely.STRtree([footprint_polygon(item.box) for item in solid])
    for item in solid:
        for other_id, box in around:
            if other_id != item.facts.rests_on:
                assert not share_space(item.box, box), (item.id, other_id)
        for index in boxes.query(footprint_polygon(item.box)):
            other = solid[index]
            hangs = {item.facts.rests_on, other.facts.rests_on} & {item.id, other.id}
            if other is not item and not hangs:
                assert not share_space(item.box, other.box), (item.id, other.id)


@pytest.mark.parametrize("seed", HOUSES)
def test_nothing_stands_in_the_pile_of_a_rug(seed: int) -> None:
    graph = dressed(seed)
    on_floor = [item for item in graph.dressing if mount_of(item) is Mount.FLOOR]
    rugs = [item for item in graph.dressing if mount_of(item) is Mount.UNDERFOOT]
    for rug in rugs:
        for item in (*graph.items, *on_floor):
            if rug.box.size_m[2] > 0.005 and item.box.center_m[2] < 0.5:
                assert not share_space(rug.box, item.box), (rug.id, item.id)


def test_furniture_stands_on_flat_rugs() -> None:
    under = [
        rug.id
        for graph in map(dressed, HOUSES)
        for rug in graph.dressing
        if rug.category == "rug" and any(share_space(rug.box, item.box) for item in graph.items)
    ]
    assert len(under) > len(HOUSES) / 2


@pytest.mark.parametrize("seed", HOUSES)
def test_dressing_is_in_its_room_and_keeps_doors_clear(seed: int) -> None:
    graph = dressed(seed)
    floors = {room.id: room_polygon(room).buffer(0.003) for room in graph.rooms}
    clear = list(clearances(graph.rooms, graph.openings))
    for item in graph.dressing:
        base, top = item.box.center_m[2], item.box.center_m[2] + item.box.size_m[2]
        assert base >= -1e-6
        assert top <= ROOM_HEIGHT_M + 1e-6
        shape = footprint_polygon(item.box)
        on_sill = mount_of(item) is Mount.BOARD and item.facts.rests_on is None
        if mount_of(item) is not Mount.WINDOW and not on_sill:
            assert floors[item.room_id].covers(shape), item.id
        for opening, floor in clear:
            is_window = opening.kind == "window" and mount_of(item) is Mount.WINDOW
            if is_window or mount_of(item) is Mount.UNDERFOOT or on_sill:
                continue
            if enters_height(base, top, opening):
                assert shape.intersection(floor).area < 1e-3, (item.id, opening.id)


@pytest.mark.parametrize("seed", HOUSES)
def test_what_hangs_on_walls_has_its_back_on_one(seed: int) -> None:
    graph = dressed(seed)
    walls = {room.id: room_polygon(room).exterior for room in graph.rooms}
    for item in graph.dressing:
        if mount_of(item) is Mount.WALL:
            back = shapely.points(footprint(item.box)[[0, 3]])
            assert np.all(shapely.distance(walls[item.room_id], back) < 0.02), item.id


@pytest.mark.parametrize("style", STYLE)
def test_nothing_hangs_beyond_the_end_of_a_wall(style: str) -> None:
    """The wall beside this toilet ends in a corner before the holder would be on it."""
    corners = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.35, 2.0), (0.35, 1.4), (0.0, 1.4)]
    room = Room("r", "bathroom", frozen_array(corners))
    toilet = Item("t", "toilet", Box((0.275, 1.03, 0.0), (0.32, 0.55, 0.78), 90.0), "r")
    graph = dress(SceneGraph((room,), (), (toilet,)), STOCK, STYLES[style], 0)
    hung = [item for item in graph.dressing if mount_of(item) is Mount.WALL]
    assert "paper_holder" in {item.category for item in hung}
    for item in hung:
        back = shapely.points(footprint(item.box)[[0, 3]])
        assert np.all(shapely.distance(room_polygon(room).exterior, back) < 0.02), item.id


@pytest.mark.parametrize("seed", HOUSES)
def test_one_walks_as_before(seed: int) -> None:
    graph = dressed(seed)
    before, after = walk(replace(graph, dressing=())), walk(graph)
    assert after.unreachable == before.unreachable
    assert after.walkable >= before.walkable - 0.02
    assert {*shut_borders(graph)} == {*shut_borders(replace(graph, dressing=()))}


def parts(graph: SceneGraph) -> int:
    """Parts of the floor that a robot 0.2 m wide gets to."""
    reached = free_floor(graph).buffer(-0.1, quad_segs=2)
    return sum(part.area > 0.03 for part in polygons_of(reached))


@pytest.mark.parametrize("seed", HOUSES)
def test_no_floor_is_cut_off_from_small_robots(seed: int) -> None:
    graph = dressed(seed)
    stands = tuple(item for item in graph.dressing if mount_of(item) is Mount.FLOOR)
    assert parts(replace(graph, dressing=stands)) <= parts(replace(graph, dressing=()))


@pytest.mark.parametrize("seed", HOUSES)
def test_fronts_stay_free(seed: int) -> None:
    graph = dressed(seed)
    assert shut_fronts(graph) == shut_fronts(replace(graph, dressing=()))
    on_floor = [item for item in graph.dressing if mount_of(item) is Mount.FLOOR]
    for piece in graph.items:
        if piece.category in USED_SIDES:
            strip = footprint_polygon(floor_before(piece.box, FRONT, *STRIP_M))
            for item in on_floor:
                if item.room_id == piece.room_id:
                    assert not share_area(strip, item.box), (piece.id, item.id)


@pytest.mark.parametrize(("gap_m", "heated"), [(0.45, False), (1.2, True)])
def test_a_radiator_leaves_the_way_past_a_bed(gap_m: float, heated: bool) -> None:
    """The bathroom's only door is beyond the bed, and the way to it leads along the window."""
    rooms = [
        Room(name, kind, frozen_array([(0.0, low), (4.0, low), (4.0, high), (0.0, high)]))
        for name, kind, low, high in (
            ("bed", cast("RoomKind", "bedroom"), 0.0, 5.0),
            ("bath", cast("RoomKind", "bathroom"), 5.24, 7.5),
        )
    ]
    holes = [
        Opening("front", "door", Box((2.0, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("bed",)),
        Opening("inner", "door", Box((2.0, 5.12, 0.0), (0.8, 0.24, 2.1), 0.0), ("bed", "bath")),
        Opening("view", "window", Box((-0.12, 2.5, 0.9), (1.6, 0.24, 1.3), 90.0), ("bed",)),
    ]
    wide_m = 4.0 - gap_m
    bed = Item("i", "bed", Box((gap_m + wide_m / 2, 2.5, 0.0), (wide_m, 1.8, 0.5), 0.0), "bed")
    bare = SceneGraph(tuple(rooms), tuple(holes), (bed,))
    assert not walk(bare).unreachable
    found = [dress(bare, STOCK, STYLES["classic"], seed) for seed in range(4)]
    assert not any(walk(graph).unreachable for graph in found)
    radiators = [one for graph in found for one in graph.dressing if one.category == "radiator"]
    assert radiators
    window = np.array([-0.12, 2.5])
    near = [np.hypot(*(np.array(one.box.center_m[:2]) - window)) < 0.5 for one in radiators]
    assert heated == any(near)


@pytest.mark.parametrize("seed", HOUSES)
def test_every_room_that_people_live_in_is_heated_or_none(seed: int) -> None:
    graph = dressed(seed)
    heated = {one.room_id for one in graph.dressing if one.category == "radiator"}
    lived = {
        room.id
        for room in graph.rooms
        if room.kind in ("living", "dining", "bedroom", "study", "kitchen", "unknown")
    }
    assert not heated & lived or heated >= lived


def test_no_picture_hangs_twice_in_a_home() -> None:
    hung = 0
    for seed in HOUSES:
        pictures = [item for item in dressed(seed).dressing if item.category == "picture"]
        assert len({item.asset for item in pictures}) == len(pictures)
        hung += len(pictures)
    assert hung > 6 * len(HOUSES)


def test_coats_and_a_mirror_hang_at_most_front_doors() -> None:
    near: Counter[str] = Counter()
    for seed in HOUSES:
        graph = dressed(seed)
        door = entrance(graph)
        assert door is not None
        at_door = {
            one.category
            for one in graph.dressing
            if one.room_id in door.room_ids
            and np.hypot(*np.subtract(one.box.center_m[:2], door.box.center_m[:2])) < 3.5
        }
        near.update(at_door)
    assert near["hook_rail"] > len(HOUSES) / 2
    assert near["mirror"] > len(HOUSES) / 2


@pytest.mark.parametrize("seed", range(3))
def test_the_same_seed_dresses_the_same_and_another_does_not(seed: int) -> None:
    def told(graph: SceneGraph) -> list[tuple[str, Box]]:
        return [(item.id, item.box) for item in graph.dressing]

    style = STYLES["classic"]
    first = dress(furnished(seed), STOCK, style, 1)
    assert told(first) == told(dress(furnished(seed), STOCK, style, 1))
    assert told(first) != told(dress(furnished(seed), STOCK, style, 2))


def test_a_room_dressed_anew_leaves_the_others() -> None:
    graph = dressed(1)
    room = graph.rooms[0].id
    again = dress(graph, STOCK, STYLES["classic"], 99, rooms=(room,))
    for other in graph.rooms[1:]:
        assert list(again.dressing_of(other.id)) == list(graph.dressing_of(other.id))
    assert list(again.dressing_of(room)) != list(graph.dressing_of(room))


def test_kept_dressing_stays_and_ids_are_unique() -> None:
    graph = dressed(2)
    kept = {item.id for item in graph.dressing[::3]}
    again = dress(graph, STOCK, STYLES["industrial"], 5, keep=kept)
    by_id = {item.id: item for item in again.dressing}
    assert len(by_id) == len(again.dressing)
    assert all(by_id[item.id] is item for item in graph.dressing if item.id in kept)


def test_what_rests_on_something_names_it() -> None:
    for seed in HOUSES:
        graph = dressed(seed)
        known = {item.id for item in (*graph.items, *graph.dressing)}
        for item in graph.dressing:
            assert item.facts.rests_on is None or item.facts.rests_on in known
            if mount_of(item) is Mount.PIECE:
                assert item.facts.rests_on is not None


def _room(kind: RoomKind, length: float, depth: float, *openings: Opening) -> SceneGraph:
    corners = [(0.0, 0.0), (length, 0.0), (length, depth), (0.0, depth)]
    return SceneGraph((Room("r", kind, frozen_array(corners)),), openings, ())


def _opening(kind: OpeningKind, at: float, length: float, base: float, height: float) -> Opening:
    """In the wall along y = 0."""
    box = Box((at, -0.12, base), (length, 0.24, height), 0.0)
    return Opening(f"{kind}_{at}", kind, box, ("r",))


def test_a_window_as_wide_as_its_wall_is_dressed() -> None:
    for kind in ("living", "kitchen"):
        window = _opening("window", 1.5, 3.0, 0.9, 1.5)
        graph = dress(_room(cast(RoomKind, kind), 3.0, 4.0, window), STOCK, STYLES["classic"], 0)
        assert {"curtain", "blind"} & {item.category for item in graph.dressing}


def test_a_window_up_to_the_ceiling_has_no_rail() -> None:
    window = _opening("window", 2.0, 1.2, 0.9, 1.79)
    graph = dress(_room("living", 4.0, 4.0, window), STOCK, STYLES["classic"], 0)
    assert "curtain_rail" not in {item.category for item in graph.dressing}


@pytest.mark.parametrize("style", STYLE)
def test_tiny_rooms_and_houses_without_windows(style: str) -> None:
    for kind in ("bathroom", "living", "store", "corridor", "balcony", "kitchen", "bedroom"):
        for side in (0.3, 1.0, 1.6):
            door = _opening("door", side / 2, min(0.7, 0.8 * side), 0.0, 2.1)
            graph = _room(cast(RoomKind, kind), side, side, door)
            for item in dress(graph, STOCK, STYLES[style], 0).dressing:
                assert (
                    room_polygon(graph.rooms[0]).buffer(0.003).covers(footprint_polygon(item.box))
                )


def test_nothing_hangs_where_heads_are_but_over_tables() -> None:
    for seed in HOUSES:
        graph = dressed(seed)
        tables = [i for i in graph.items if i.category == "dining_table"]
        for item in graph.dressing:
            if mount_of(item) is Mount.CEILING and item.box.center_m[2] < 2.0:
                assert any(
                    footprint_polygon(table.box).covers(footprint_polygon(item.box))
                    for table in tables
                )


def test_every_basin_with_a_wall_above_has_a_mirror() -> None:
    basins = mirrors = 0
    for seed in HOUSES:
        graph = dressed(seed)
        basins += sum(item.category == "washbasin" for item in graph.items)
        in_baths = {r.id for r in graph.rooms if r.kind == "bathroom"}
        mirrors += sum(i.category == "mirror" and i.room_id in in_baths for i in graph.dressing)
    assert mirrors >= 0.8 * basins


def test_an_empty_database_dresses_nothing() -> None:
    assert dress(furnished(0), AssetDatabase(()), STYLES["modern"], 0).dressing == ()


def test_rooms_are_lived_in() -> None:
    """Objects over all levels; things on tables come on top."""
    counts: dict[str, list[int]] = {}
    for seed in HOUSES:
        graph = dressed(seed)
        number = Counter(item.room_id for item in (*graph.items, *graph.dressing))
        for room in graph.rooms:
            counts.setdefault(room.kind, []).append(number[room.id])
    for kind, least in (("living", 20), ("bedroom", 16), ("bathroom", 13)):
        assert np.median(counts[kind]) >= least, kind


@pytest.mark.parametrize("style", STYLE)
def test_nothing_stands_across_an_open_border(style: str) -> None:
    """Two corridors meet at a corner 1.18 m wide: a plant in it leaves no way."""
    long = [(12.27, 7.74), (4.89, 7.74), (4.89, 6.56), (12.27, 6.56)]
    short = [(4.77, 13.58), (3.55, 13.58), (3.55, 6.56), (4.89, 6.56), (4.89, 7.74), (4.77, 7.74)]
    rooms = (
        Room("room7", "corridor", frozen_array(long)),
        Room("room13", "corridor", frozen_array(short)),
    )
    ways = (
        Opening("way", "passage", Box((12.39, 7.155, 0.0), (0.95, 0.24, 2.3), 90.0), ("room7",)),
        Opening("left", "door", Box((11.445, 7.86, 0.0), (0.75, 0.24, 2.1), 0.0), ("room7",)),
        Opening("right", "door", Box((8.535, 7.86, 0.0), (0.95, 0.24, 2.1), 0.0), ("room7",)),
    )
    graph = dress(SceneGraph(rooms, ways, ()), STOCK, STYLES[style], 0)
    assert "floor_plant" in {item.category for item in graph.dressing}
    assert not list(shut_borders(graph))


def test_an_own_asset_without_the_tag_replaces_no_shipped_one_that_has_it() -> None:
    """Curtains that nobody has called open or drawn leave the window its shipped ones."""
    size_m = (0.4, 0.1, 2.4)
    mine, shipped = (
        Asset(name, "curtain", size_m, Path(f"{name}.usda"), tags=tags)
        for name, tags in (("Mine", ()), ("Shipped", ("open",)))
    )
    stock = Stock(AssetDatabase((mine, shipped), own_ids=frozenset(["Mine"])), "modern", Draws(0))
    assert stock.offered("curtain") == (mine,)
    assert stock.offered("curtain", "open") == (shipped,)
    tagged = replace(mine, tags=("open",))
    stock = Stock(AssetDatabase((tagged, shipped), own_ids=frozenset(["Mine"])), "modern", Draws(0))
    assert stock.offered("curtain", "open") == (tagged,)


def test_a_television_that_rules_count_on_a_wall_hangs() -> None:
    """As deep as those of ours, on a wall that curtains also want; these fit beside it."""
    deep = [replace(one, size_m=(one.size_m[0], 0.06, one.size_m[2]))
            for one in STOCK.of_category("television")]  # fmt: skip
    stock = AssetDatabase(
        tuple(one for one in STOCK.assets if one not in STOCK.of_category("television"))
        + tuple(deep)
    )
    room = Room("room", "living", frozen_array([(0, 0), (2.55, 0), (2.55, 3.6), (0, 3.6)]))
    window = Opening("w", "window", Box((0.7, 3.72, 0.4), (1.2, 0.24, 1.6), 0.0), ("room",))
    sofa = Item("room/sofa_0", "sofa", Box((1.35, 0.5, 0.0), (1.6, 0.9, 0.8), 180.0), "room")
    house = SceneGraph((room,), (window,), (sofa,))
    assert view_home(house).rooms[0].televisions
    hung = Counter(item.category for item in dress(house, stock, STYLES[STYLE[0]], 5).dressing)
    assert hung["television"] == 1
    assert hung["curtain"]
