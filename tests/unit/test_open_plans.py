"""Open plans: parts as large as their kinds, names where they were, every opening kept."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.geometry import Point
from shapely.ops import unary_union

from chord_usd.base.metrics.clear_floor import blocked_openings, clearances
from chord_usd.base.raster.page_labels import KIND_NAMES
from chord_usd.base.scene.geometry import room_polygon
from chord_usd.base.scene.room_names import room_kind, room_kinds
from chord_usd.base.scene.types import (
    Box,
    Item,
    Opening,
    PixelFrame,
    Plan,
    Room,
    SceneGraph,
    frozen_array,
)
from chord_usd.line.plan.floor_parts import part_floors, part_open_plans, too_small
from chord_usd.line.plan.home_uses import Floor, Uses, named_pieces, uses_of_home
from chord_usd.line.plan.labels import uses_named
from chord_usd.line.plan.open_plans import Use, part_room
from chord_usd.line.plan.seen_kinds import seen_kinds
from chord_usd.line.plan.text import Text
from chord_usd.line.plan.vector.assemble import assemble
from chord_usd.line.plan.vector.shapes import Label, RoomShape, VectorDrawing


def room(name, kind, *corners):
    return Room(name, kind, frozen_array(corners))


def rectangle(name, kind, west, south, east, north):
    return room(name, kind, (west, south), (east, south), (east, north), (west, north))


def opening(name, kind, x, y, length, yaw_deg, *rooms):
    return Opening(name, kind, Box((x, y, 0.0), (length, 0.24, 2.1), yaw_deg), rooms)


LONG = Plan(
    (
        rectangle("living1", "living", 0, 0, 9, 4),
        rectangle("bathroom1", "bathroom", 6.5, 4.24, 9, 6.5),
    ),
    (
        opening("door1", "door", 8, 4.12, 0.8, 0, "living1", "bathroom1"),
        opening("window1", "window", 2, -0.12, 2.0, 0, "living1"),
        opening("window2", "window", 7.5, -0.12, 1.2, 0, "living1"),
    ),
)


def parts_of(plan, parent):
    ids = {other.id for other in LONG.rooms} - {parent}
    return {one.id: room_polygon(one) for one in plan.rooms if one.id not in ids}


@pytest.mark.parametrize("turned_deg", [0.0, 30.0])
def test_names_end_up_in_rooms_of_their_own(turned_deg):
    angle = np.radians(turned_deg)
    turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    spots = {"living": (2.0, 2.0), "kitchen": (8.0, 1.5)}
    uses = [Use(kind, (kind,), (tuple(np.array(at) @ turn),)) for kind, at in spots.items()]
    whole = room("living1", "living", *(LONG.rooms[0].polygon_m @ turn))
    plan = part_room(Plan((whole,), ()), "living1", uses)
    floors = {one.kind: room_polygon(one) for one in plan.rooms}
    assert set(floors) == {"living", "kitchen"}
    for use in uses:
        assert floors[use.kind].contains(Point(use.spots_m[0]))
    assert unary_union([*floors.values()]).symmetric_difference(room_polygon(whole)).area < 1e-3
    assert floors["living"].intersection(floors["kitchen"]).area < 1e-6
    border = floors["living"].intersection(floors["kitchen"])
    assert border.length == pytest.approx(4.0, abs=0.1)


def test_openings_open_into_the_part_beside_them():
    uses = [Use("living", ("Lounge",), ((2.0, 2.0),)), Use("kitchen", ("Kitchen",), ((8.0, 1.5),))]
    plan = part_room(LONG, "living1", uses)
    rooms_of = {one.id: one.room_ids for one in plan.openings}
    assert rooms_of["window1"] == ("living1",)
    assert rooms_of["window2"] == ("kitchen1",)
    assert set(rooms_of["door1"]) == {"kitchen1", "bathroom1"}
    assert len(rooms_of) == len(LONG.openings)
    for one in plan.openings:
        middle = Point(one.box.center_m[:2])
        assert room_polygon(plan.room(one.room_ids[0])).distance(middle) < 0.2


def test_a_floor_without_room_for_two_stays_whole():
    small = Plan((rectangle("living1", "living", 0, 0, 2.4, 2.2),), ())
    uses = [Use("living", ("L",), ((0.6, 1.1),)), Use("dining", ("D",), ((1.8, 1.1),))]
    assert part_room(small, "living1", uses) is small


def drawn(**zones):
    """What is seen where each kind has a zone, (west, south, east, north) in metres."""
    seen = np.full((len(KIND_NAMES), 50, 100), 0.05, np.float32)
    for kind, (west, south, east, north) in zones.items():
        rows = slice(round(50 - 10 * north), round(50 - 10 * south))
        seen[:, rows, round(10 * west) : round(10 * east)] = 0.02
        seen[KIND_NAMES.index(kind), rows, round(10 * west) : round(10 * east)] = 0.84
    return seen_kinds(seen, PixelFrame(0.1, (0.0, 0.0), 50))


@pytest.mark.parametrize("end", [2.5, 3.5])
def test_a_kitchen_that_is_drawn_gets_a_part_of_its_own(end):
    plan = Plan((rectangle("living1", "living", 0, 0, 9, 4),), ())
    seen = drawn(kitchen=(0, 0, end, 4), living=(end, 0, 9, 4))
    parted = part_open_plans(plan, {}, seen)
    assert sorted(one.kind for one in parted.rooms) == ["kitchen", "living"]
    kitchen = next(room_polygon(one) for one in parted.rooms if one.kind == "kitchen")
    assert kitchen.symmetric_difference(shapely.box(0, 0, end, 4)).area < 1.5
    alike = drawn(living=(0, 0, 9, 4))
    assert part_open_plans(plan, {}, alike).rooms == plan.rooms


def test_a_spot_of_another_kind_parts_nothing():
    bedroom = Plan((rectangle("bedroom1", "bedroom", 0, 0, 5, 4),), ())
    seen = drawn(bedroom=(0, 0, 5, 4), kitchen=(0, 0, 0.6, 0.6))
    assert part_open_plans(bedroom, {}, seen).rooms == bedroom.rooms


def test_three_uses_of_one_floor():
    uses = {
        "living1": [
            Use("living", ("Living",), ((1.5, 2.0),)),
            Use("dining", ("Dining",), ((5.0, 2.0),)),
            Use("kitchen", ("Kitchen",), ((8.0, 1.5),)),
        ]
    }
    plan = part_open_plans(LONG, uses)
    assert sorted(one.kind for one in plan.rooms) == ["bathroom", "dining", "kitchen", "living"]
    assert all(min(one.area / one.minimum_rotated_rectangle.area for one in parts.values()) > 0.8
               for parts in [parts_of(plan, "living1")])  # fmt: skip


KITCHEN_TOO = [Uses("living", frozenset({"kitchen"})), Uses("bathroom")]


def test_a_home_without_a_kitchen_gets_one_beside_the_bath():
    plan, told, failed = part_floors(LONG, KITCHEN_TOO, {}, None)
    kinds = {one.kind: room_polygon(one) for one in plan.rooms}
    assert kinds["kitchen"].distance(kinds["bathroom"]) < 0.5
    assert told == ["no kitchen was recognised: a part of living1 became kitchen1"]
    assert not failed


@pytest.mark.parametrize("at", [(1.0, 3.6), (6.0, 3.6)])
def test_a_kitchen_without_a_name_lies_where_its_hob_is_drawn(at):
    hob = Item("", "cooker_cabinet", Box((*at, 0.0), (0.6, 0.6, 0.9), 0.0))
    plan, _, failed = part_floors(LONG, KITCHEN_TOO, {}, None, [hob])
    kitchen = next(room_polygon(one) for one in plan.rooms if one.kind == "kitchen")
    assert kitchen.contains(Point(at))
    assert not failed


def test_what_looks_like_a_second_kitchen_parts_no_floor():
    uses = [Uses("living"), Uses("bathroom")]
    looks = drawn(living=(3, 0, 9, 4), kitchen=(0, 0, 3, 4))
    parted, _, _ = part_floors(LONG, uses, {}, looks)
    assert "kitchen" in {one.kind for one in parted.rooms}
    beside = replace(LONG, rooms=(*LONG.rooms, rectangle("kitchen1", "kitchen", 0, 5, 3, 8)))
    whole, _, _ = part_floors(beside, [*uses, Uses("kitchen")], {}, looks)
    assert whole == beside


def test_a_floor_that_has_no_place_for_a_use_says_so():
    small = Plan((rectangle("living1", "living", 0, 0, 2.4, 2.2),), ())
    plan, told, failed = part_floors(small, KITCHEN_TOO[:1], {}, None)
    assert (plan.rooms, told, failed) == (small.rooms, [], {(0, "kitchen")})


def test_a_kitchen_lies_where_its_name_is_also_where_nothing_of_it_is_drawn():
    empty = drawn(living=(0, 0, 9, 4))
    spots = {"living": (7.5, 2.0), "kitchen": (1.0, 2.0)}
    named = {"living1": [Use(kind, (kind,), (at,)) for kind, at in spots.items()]}
    plan, told, _ = part_floors(LONG, KITCHEN_TOO, named, empty)
    kitchen = next(room_polygon(one) for one in plan.rooms if one.kind == "kitchen")
    assert kitchen.contains(Point(spots["kitchen"]))
    assert kitchen.bounds[2] < spots["living"][0]
    assert told == []


@pytest.mark.parametrize(
    ("name", "seen", "said"),
    [
        ("Living / Kitchen", None, "living1 is named a kitchen, too: a part of it became kitchen1"),
        ("", drawn(living=(3, 0, 9, 4), kitchen=(0, 0, 3, 4)),
         "kitchen1 is the part of living1 where a kitchen is drawn"),
    ],
)  # fmt: skip
def test_a_parted_floor_is_told_as_it_is(name, seen, said):
    plan = replace(LONG, rooms=(replace(LONG.rooms[0], name=name), LONG.rooms[1]))
    assert part_floors(plan, KITCHEN_TOO, {}, seen)[1] == [said]


def test_a_name_for_several_parts_does_not_say_where_they_are():
    """The spot of "TUPAKEITTIÖ", before the hob, kept the kitchen from where it is drawn."""
    frame = PixelFrame(0.01, (0.0, 0.0), 400)
    corners = np.array([(700.0, 190.0), (800.0, 190.0), (800.0, 210.0), (700.0, 210.0)])
    texts = [Text("TUPAKEITTIÖ", corners, 0.9)]
    uses = uses_named(LONG.rooms[0], texts, frame)
    assert {use.kind for use in uses} == {"living", "kitchen"}
    assert not any(use.spots_m for use in uses)


def chances(**rows):
    table = np.full((len(rows), len(KIND_NAMES)), 0.01)
    for row, likely in zip(table, rows.values(), strict=True):
        for kind, chance in likely.items():
            row[KIND_NAMES.index(kind)] = chance
    return table


def floors(seen, areas, told, **further):
    return [
        Floor(row, kind, area_m2=area, **further.get(f"floor{index}", {}))
        for index, (row, area, kind) in enumerate(zip(seen, areas, told, strict=True))
    ]


def test_what_a_home_needs_goes_to_the_room_that_speaks_against_it_least():
    seen = chances(
        large={"living": 0.8}, plain={"bedroom": 0.4, "study": 0.45}, wet={"bathroom": 0.35}
    )
    areas = [12.0, 11.0, 4.0]
    nameless = floors(seen, areas, ["unknown"] * 3)
    assert [one.kind for one in uses_of_home(nameless, False)] == ["living", "unknown", "unknown"]
    home = uses_of_home(nameless, True)
    assert home[0].kind == "living"
    assert home[1].kind in ("bedroom", "study")
    assert home[2].kind == "bathroom"
    named = floors(seen, areas, ["unknown", "unknown", "bathroom"])
    assert uses_of_home(named, True)[1].kind in ("bedroom", "study")


STAIRS = chances(large={"living": 0.7}, stairs={"kitchen": 0.5, "corridor": 0.3}, bath={}, bed={})


@pytest.mark.parametrize(
    "large",
    [
        {"named": frozenset({"living", "kitchen"})},
        {"drawn_m2": {"kitchen": 9.0}},
    ],
)
def test_no_other_room_is_a_kitchen_where_a_part_of_a_floor_is(large):
    """A stairwell that looks a little like a kitchen became one, though "Keuken" was printed."""
    areas, told = [36.0, 8.0, 4.0, 12.0], ["living", "unknown", "bathroom", "bedroom"]
    assert uses_of_home(floors(STAIRS, areas, told), True)[1].kind == "kitchen"
    uses = uses_of_home(floors(STAIRS, areas, told, floor0=large), True)
    assert "kitchen" in uses[0].further
    assert uses[1].kind != "kitchen"


@pytest.mark.parametrize("first", [True, False])
def test_a_named_kitchen_is_the_only_one(first):
    """A courtyard became a second kitchen where "Cocina" stands in a room further down the list."""
    seen = chances(court={"kitchen": 0.7, "living": 0.2}, named={}, bed={"bedroom": 0.9})
    rows = floors(seen, [14.0, 6.0, 12.0], ["unknown", "kitchen", "unknown"])
    order = [1, 0, 2] if first else [0, 1, 2]
    uses = uses_of_home([rows[at] for at in order], True)
    assert [use.kind for use in uses].count("kitchen") == 1
    assert not any("kitchen" in use.further for use in uses)


def test_a_sink_drawn_elsewhere_makes_no_second_kitchen():
    """The bar beside "Cocina" became another one."""
    seen = chances(bar={"kitchen": 0.8, "living": 0.15}, named={}, bed={}, seat={})
    told, areas = ["unknown", "kitchen", "bedroom", "living"], [9.0, 6.0, 12.0, 20.0]
    rows = floors(seen, areas, told, floor0={"drawn": {"kitchen": 4.0}})
    found = [use.all for use in uses_of_home(rows, True)]
    assert ["kitchen" in uses for uses in found] == [False, True, False, False]
    told[1] = "store"
    rows = floors(seen, areas, told, floor0={"drawn": {"kitchen": 4.0}})
    assert uses_of_home(rows, True)[0].kind == "kitchen"


def test_a_kitchen_that_is_drawn_is_no_reason_for_a_bed():
    """The courtyard of es_casaraiz, where a hob was seen, became a living room with a bedroom."""
    seen = chances(large={"living": 0.8}, named={}, bed={}, bath={})
    told, areas = ["unknown", "kitchen", "bedroom", "bathroom"], [24.0, 6.0, 12.0, 4.0]
    rows = floors(seen, areas, told, floor0={"drawn_m2": {"kitchen": 4.0}})
    assert "bedroom" not in uses_of_home(rows, True)[0].further


def test_a_front_door_and_many_ways_make_a_hall_and_no_dining_room():
    """The hall of r3d_47541863, into which six doors lead, was read as a dining room."""
    seen = chances(hall={"dining": 0.89}, bed={}, bath={}, large={})
    told, areas = ["unknown", "bedroom", "bathroom", "living"], [10.0, 12.0, 4.0, 20.0]
    quiet, busy = {"ways": 1}, {"ways": 6, "is_outer": True}
    assert uses_of_home(floors(seen, areas, told, floor0=quiet), True)[0].kind == "dining"
    assert uses_of_home(floors(seen, areas, told, floor0=busy), True)[0].kind == "corridor"


@pytest.mark.parametrize(
    ("areas", "rooms"),
    [
        # The hall of cubicasa_lines_10004: five ways cross its 5.4 square metres.
        ([5.4, 13.0], ({"ways": 5}, {"ways": 2})),
        # A closet of cubicasa_lines_1000, into which no way was seen.
        ([2.5, 12.9], ({"ways": 0}, {"ways": 3})),
    ],
)
def test_a_kitchen_has_a_way_in_and_place_beside_its_ways(areas, rooms):
    seen = chances(small={"kitchen": 0.4, "bathroom": 0.2}, other={"living": 0.4, "kitchen": 0.25},
                   bed={}, bath={}, seat={})  # fmt: skip
    told = ["unknown", "unknown", "bedroom", "bathroom", "living"]
    some = floors(seen, [*areas, 12.0, 4.0, 20.0], told, floor0=rooms[0], floor1=rooms[1])
    quiet = floors(seen, [*areas, 12.0, 4.0, 20.0], told, floor0={"ways": 1}, floor1={"ways": 1})
    assert [one.kind for one in uses_of_home(quiet, True)].index("kitchen") == 0
    assert [one.kind for one in uses_of_home(some, True)].index("kitchen") == 1


def test_one_floor_may_be_lived_slept_and_cooked_in():
    """The studio of cubicasa_lines_10010 had a bedroom and no kitchen."""
    seen = chances(large={"bedroom": 0.75, "living": 0.2, "kitchen": 0.04}, bath={"bathroom": 0.8})
    entered = {"drawn_m2": {"bedroom": 18.0}, "is_outer": True, "ways": 3}
    rows = floors(seen, [18.6, 2.6], ["unknown"] * 2, floor0=entered)
    assert {"living", "kitchen", "bedroom"} <= uses_of_home(rows, True)[0].all


def test_one_enters_a_hall_and_not_a_store():
    seen = chances(entered={"store": 0.6, "corridor": 0.3}, bed={"bedroom": 0.9}, bath={})
    told = ["unknown", "bedroom", "bathroom"]
    rows = floors(seen, [5.0, 12.0, 4.0], told, floor0={"is_outer": True})
    assert uses_of_home(rows, True)[0].kind == "corridor"
    assert uses_of_home(rows, False)[0].kind == "store"


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        *(
            ("Bett", "bedroom"),
            ("stove", "kitchen"),
            ("ソファ", "living"),
            ("badewanne", "bathroom"),
        ),
        *(("Island", "kitchen"), ("Geschirrspüler", "kitchen"), ("Mattress", "bedroom")),
    ],
)
def test_words_for_furniture_say_what_a_floor_is_for(text, kind):
    assert set(named_pieces([text])) == {kind}
    seen = chances(plain={"study": 0.55, kind: 0.2})
    rows = floors(seen, [9.0], ["unknown"], floor0={"drawn": named_pieces([text])})
    assert uses_of_home(rows, False)[0].kind == kind


@pytest.mark.parametrize("text", ["Bedroom", "WC", "Scale 1:100", "Tower"])
def test_names_of_rooms_and_other_words_are_no_furniture(text):
    assert named_pieces([text]) == {}


def test_a_use_without_a_place_goes_elsewhere():
    seen = chances(large={"living": 0.9}, plain={"store": 0.4, "kitchen": 0.02}, bath={}, bed={})
    told = ["living", "unknown", "bathroom", "bedroom"]
    rows = floors(seen, [30.0, 6.0, 4.0, 12.0], told)
    assert "kitchen" in uses_of_home(rows, True)[0].further
    banned = uses_of_home(rows, True, {(0, "kitchen")})
    assert not banned[0].further


@pytest.mark.parametrize(
    ("name", "kinds"),
    [
        ("Kitchen / Dining Room", ("kitchen", "dining")),
        ("LDK 12.5", ("living", "kitchen", "dining")),
        ("TUPAKEITTIÖ+ALK", ("living", "kitchen")),
        ("Wohnküche", ("living", "kitchen")),
        ("sala-cozinha", ("living", "kitchen")),
        ("Bedroom closet", ("store",)),
        ("Main Street 12", ()),
    ],
)
def test_all_that_a_name_speaks_of(name, kinds):
    assert room_kinds(name)[: len(kinds)] == kinds
    assert room_kind(name) == (kinds[0] if kinds else "unknown")


def test_walls_and_labels_of_a_vector_file_tell_as_much():
    ring = shapely.box(-0.2, -0.2, 9.2, 4.2).difference(shapely.box(0, 0, 9, 4))
    labels = [Label("Lounge", np.array((2.0, 2.0))), Label("Kitchen", np.array((8.0, 1.5)))]
    plan = assemble(VectorDrawing(walls=[ring], labels=labels, m_per_unit=1.0), "a.dxf")
    assert sorted(one.kind for one in plan.rooms) == ["kitchen", "living"]
    authored = RoomShape(shapely.box(0, 0, 9, 4), "Lounge")
    drawn = VectorDrawing([authored], [ring], labels=labels, m_per_unit=1.0)
    assert [one.kind for one in assemble(drawn, "a.ifc").rooms] == ["living"]


@pytest.mark.parametrize(("lengths_m", "is_shut"), [((2.0, 1.0), False), ((2.0, 1.7), True)])
def test_an_open_border_is_shut_where_no_way_is_left_across_it(lengths_m, is_shut):
    rooms = (
        rectangle("living1", "living", 0, 0, 5, 4),
        rectangle("kitchen1", "kitchen", 5, 0, 8, 4),
    )
    border = Opening("passage1", "passage", Box((5, 2, 0), (4.0, 0.02, 2.3), 90), ("a", "b"))
    south, north = lengths_m
    items = tuple(
        Item(f"sofa{index}", "sofa", Box((4.6, y, 0), (length, 0.7, 0.8), 90), "living1")
        for index, (y, length) in enumerate([(south / 2, south), (4 - north / 2, north)])
    )
    graph = SceneGraph(rooms, (border,), items)
    assert bool(blocked_openings(graph)) == is_shut
    assert not list(clearances(rooms, (border,)))


@pytest.mark.parametrize(("deep", "is_bedroom"), [(1.3, False), (3.2, True)])
def test_what_becomes_a_bedroom_holds_a_bed(deep, is_bedroom):
    """A passage of 5 m2 between doors became a bedroom, and the home had no bed."""
    floor = rectangle("bedroom1", "bedroom", 0, 0, 4, deep)
    doors = tuple(
        opening(f"door{x}", "door", x, y, 0.9, 0, "bedroom1")
        for x in (0.6, 2.0, 3.4)
        for y in ((-0.12, deep + 0.12) if deep < 2 else (-0.12,))
    )
    unnamed = replace(floor, kind="unknown")
    found = too_small(Plan((floor,), doors), [floor], [unnamed])
    assert found == (set() if is_bedroom else {(0, "bedroom")})
    assert not too_small(Plan((floor,), doors), [floor], [floor]), "its name says so"


def test_every_use_that_is_named_gets_its_part():
    """A flat with "ALK" printed in its corner had no bedroom: what is drawn spoke against it."""
    whole = Plan((rectangle("living1", "living", 0, 0, 7, 5),), ())
    spots = {"living": (1.5, 1.0), "bedroom": (5.5, 2.5)}
    named = {"living1": [Use(kind, (kind,), (at,)) for kind, at in spots.items()]}
    chances = np.full((len(KIND_NAMES), 60, 80), 0.01, np.float32)
    chances[KIND_NAMES.index("living")] = 0.98
    seen = seen_kinds(chances, PixelFrame(0.1, (0.0, 0.0), 60))
    parted, _, _ = part_floors(whole, [Uses("living", frozenset({"bedroom"}))], named, seen)
    assert {room.kind for room in parted.rooms} == {"living", "bedroom"}
