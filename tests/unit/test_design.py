"""Planning rules: each is kept by a planned room and broken, at its place, by one change."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
import pytest
import shapely
from shapely.affinity import rotate, translate

from chord_usd.base.metrics.design import Design, Finding, design_of, worse_planned
from chord_usd.base.metrics.design.group_rules import strays
from chord_usd.base.metrics.design.price import tight
from chord_usd.base.metrics.design.shell import shells
from chord_usd.base.metrics.design.view import View, view_home
from chord_usd.base.scene.types import Box, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.line.lists.improve import improved
from chord_usd.line.lists.other_places import changes_of, regrouped

Piece = tuple[str, float, float, float, float, float, float]
"""Category, x, y, length, depth, height, yaw."""

KITCHEN: list[Piece] = [
    ("refrigerator", 0.3, 2.7, 0.6, 0.6, 1.8, 0),
    ("single_door_floor_cabinet", 0.825, 2.7, 0.45, 0.6, 0.9, 0),
    ("sink_cabinet", 1.35, 2.7, 0.6, 0.6, 0.9, 0),
    ("double_door_floor_cabinet", 2.1, 2.7, 0.9, 0.6, 0.9, 0),
    ("cooker_cabinet", 2.85, 2.7, 0.6, 0.6, 0.9, 0),
    ("single_door_floor_cabinet", 3.4, 2.7, 0.5, 0.6, 0.9, 0),
]
BEDROOM: list[Piece] = [
    ("bed", 2.0, 1.95, 1.6, 2.1, 1.0, 0),
    ("bedside_table", 0.95, 2.75, 0.45, 0.4, 0.5, 0),
    ("bedside_table", 3.05, 2.75, 0.45, 0.4, 0.5, 0),
    ("cabinet", 1.2, -0.7, 2.2, 0.6, 2.2, 180),
]


def home(kind: str, pieces: Sequence[Piece], *openings: Opening, low: float = 0.0) -> SceneGraph:
    corners = frozen_array([(0, low), (4, low), (4, 3), (0, 3)])
    room = Room("room", kind, corners)  # type: ignore[arg-type]
    items = tuple(
        Item(f"{name}_{at}", name, Box((x, y, 0.0), (long, deep, high), yaw), "room")
        for at, (name, x, y, long, deep, high, yaw) in enumerate(pieces)
    )
    return SceneGraph((room,), openings, items)


def window(x: float, y: float, yaw: float = 0.0) -> Opening:
    return Opening("window", "window", Box((x, y, 0.9), (1.0, 0.24, 1.2), yaw), ("room",))


def door(x: float, y: float, yaw: float = 0.0) -> Opening:
    return Opening("door", "door", Box((x, y, 0.0), (0.9, 0.24, 2.0), yaw), ("room",))


def findings(graph: SceneGraph) -> dict[str, Finding]:
    return {one.rule: one for one in design_of([graph]).rooms[0].findings}


def kitchen(change: Callable[[list[Piece]], None] | None = None) -> SceneGraph:
    pieces = list(KITCHEN)
    if change:
        change(pieces)
    return home("kitchen", pieces, window(1.35, 3.12), door(2.0, -0.12))


def bedroom(change: Callable[[list[Piece]], None] | None = None) -> SceneGraph:
    pieces = list(BEDROOM)
    if change:
        change(pieces)
    return home("bedroom", pieces, door(4.12, -0.4, 90.0), window(-0.12, 1.0, 90.0), low=-1.0)


def put(at: int, **places: float) -> Callable[[list[Piece]], None]:
    names = ("x", "y", "length", "depth", "height", "yaw")

    def change(pieces: list[Piece]) -> None:
        values = list(pieces[at])
        for name, value in places.items():
            values[1 + names.index(name)] = value
        pieces[at] = tuple(values)  # type: ignore[assignment]

    return change


def swap(pieces: list[Piece]) -> None:
    """Sink and cooker change places."""
    pieces[2], pieces[4] = (("cooker_cabinet", *pieces[2][1:]), ("sink_cabinet", *pieces[4][1:]))


def wash_apart(pieces: list[Piece]) -> None:
    """A washing machine at the wall before the run."""
    pieces.append(("washing_machine", 3.4, 0.3, 0.6, 0.6, 0.85, 180))


def drop(at: int) -> Callable[[list[Piece]], None]:
    return lambda pieces: pieces.pop(at) and None


def test_a_planned_bedroom_keeps_all_rules() -> None:
    assert not findings(bedroom())


@pytest.mark.parametrize(
    ("change", "rule", "have"),
    [
        (drop(0), "refrigerator", 0),
        (swap, "cooker before a window", 1),
        (swap, "sink away from the window", 1),
        (put(4, x=3.7), "cooker to a side wall", 0.0),
        (drop(3), "sink and cooker in one run or over one aisle", 1),
        (drop(5), "worktop on the lesser side of the cooker", 0.0),
        (wash_apart, "washing machine from the units", 1.8),
    ],
)
def test_a_kitchen_breaks_a_rule(
    change: Callable[[list[Piece]], None], rule: str, have: float
) -> None:
    assert rule not in findings(kitchen())
    found = findings(kitchen(change))[rule]
    assert found.have == pytest.approx(have, abs=0.035)
    assert shapely.box(0, 0, 4, 3).buffer(0.1).contains(shapely.Point(found.at))


@pytest.mark.parametrize(
    ("change", "rule", "have"),
    [
        (put(0, x=0.9), "beside a double bed, lesser side", 0.1),
        (drop(1), "bedside tables of a double bed", 1),
        (put(3, y=0.3), "at the foot of the bed", 0.3),
        (put(3, length=1.2), "wardrobe a sleeper", 0.6),
        (put(3, height=1.0), "wardrobe", 0),
        (put(0, y=1.05, yaw=0), "before a wardrobe", 0.4),
        (put(2, length=0.6), "bedside tables differ", 0.15),
    ],
)
def test_a_bedroom_breaks_a_rule(
    change: Callable[[list[Piece]], None], rule: str, have: float
) -> None:
    found = findings(bedroom(change))[rule]
    assert found.have == pytest.approx(have, abs=0.03)
    assert found.said.startswith(rule)


def test_a_washing_machine_goes_to_the_units() -> None:
    """There is floor beside them."""

    def shorter(pieces: list[Piece]) -> None:
        put(3, x=1.95, length=0.6)(pieces)
        put(4, x=2.55)(pieces)
        put(5, x=3.1)(pieces)
        wash_apart(pieces)

    house = kitchen(shorter)
    before = view_home(house).rooms[0]
    after = improved(before, lambda _: 0.0, changes_of(before))
    (machine,) = after.of("washing_machine")
    assert after.gaps(machine)[after.of("single_door_floor_cabinet")].min() < 0.1
    assert after.depths[machine].sum() - after.depths[machine, machine] < 1e-6
    assert after.height[machine] == 0.85


@pytest.mark.parametrize("table", ["coffee_table", "dining_table"])
def test_knees_fit_between_an_armchair_and_a_table(table: str) -> None:
    pieces: list[Piece] = [("sofa", 2.0, 2.5, 2.0, 0.9, 0.8, 0),
                           (table, 2.0, 1.4, 1.0, 0.5, 0.4, 0)]  # fmt: skip
    for gap, is_broken in ((0.02, True), (0.15, True), (0.3, False)):
        chair = ("single_sofa", 2.5 + gap + 0.4, 1.4, 0.8, 0.8, 0.8, -90)
        found = findings(home("living", [*pieces, chair]))
        assert ("armchair to a table" in found) == is_broken


WAY = "way between doors and to the dining place"


@pytest.mark.parametrize("gap", [0.4, 0.5, 0.7, 0.85, 1.2])
def test_a_way_is_as_wide_as_its_narrowest_place(gap: float) -> None:
    """Between a table with its chair and a cabinet, on the way from one door to the other."""
    pieces: list[Piece] = [("dining_table", 0.6, 1.5, 1.2, 0.8, 0.75, 0),
                           ("chair", 1.4, 1.5, 0.45, 0.5, 0.9, -90),
                           ("cabinet", 2.825 + gap / 2, 1.5, 2.35 - gap, 0.5, 2.0, 0)]  # fmt: skip
    graph = home("dining", pieces, door(3.0, -0.12), replace(door(3.0, 3.12), id="back"))
    found = findings(graph)
    assert (WAY in found) == (gap < 0.6)
    assert ("main " + WAY in found) == (gap < 0.9)
    if WAY in found:
        assert found[WAY].have == pytest.approx(gap, abs=0.06)
        assert abs(found[WAY].at[0] - 1.65 - gap / 2) < 0.1
        assert {"chair_1", "cabinet_2"} <= set(found[WAY].items)


def test_a_way_that_no_furniture_makes_narrow_is_not_asked() -> None:
    corners = frozen_array([(0, 0), (0.8, 0), (0.8, 4), (0, 4)])
    doors = (door(0.4, -0.12), replace(door(0.4, 4.12), id="back"))
    hall = SceneGraph((Room("room", "corridor", corners),), doors, ())
    (judged,) = design_of([hall]).rooms
    assert judged.kept == (WAY,)


@pytest.mark.parametrize(("long", "count"), [(2.0, 0), (3.4, 2)])
def test_one_gets_to_the_chairs_behind_a_table(long: float, count: int) -> None:
    pieces: list[Piece] = [("dining_table", 2.0, 1.9, long, 0.7, 0.75, 0)]
    pieces += [("chair", 2.0 + side * 0.5, 2.45, 0.45, 0.5, 0.9, 0) for side in (-1, 1)]
    pieces += [("chair", 2.0 + side * 0.5, 1.35, 0.45, 0.5, 0.9, 180) for side in (-1, 1)]
    judged = design_of([home("dining", pieces, door(3.0, -0.12))])
    found = [one for room in judged.rooms for one in room.findings
             if one.rule == "chairs that nobody gets to"]  # fmt: skip
    assert sum(int(one.have) for one in found) == count


STRAYS = "pieces without what they belong to"


@pytest.mark.parametrize(
    ("kind", "pieces", "count"),
    [
        ("bedroom", BEDROOM[1:], 2),
        ("bedroom", BEDROOM, 0),
        ("living", [("dining_cabinet", 2.0, 2.8, 1.2, 0.4, 0.9, 0)], 1),
        ("kitchen", [("dining_cabinet", 2.0, 2.8, 1.2, 0.4, 0.9, 0)], 0),
        ("living", [("sofa", 1.2, 2.5, 2.0, 0.9, 0.8, 0),
                    ("side_coffee_table", 2.5, 2.7, 0.45, 0.45, 0.5, 0)], 0),
        ("living", [("sofa", 1.2, 2.5, 2.0, 0.9, 0.8, 0),
                    ("side_coffee_table", 3.7, 0.3, 0.45, 0.45, 0.5, 0)], 1),
    ],
)  # fmt: skip
def test_a_group_has_its_head(kind: str, pieces: list[Piece], count: int) -> None:
    found = findings(home(kind, pieces))
    assert (found[STRAYS].have if STRAYS in found else 0) == count


def test_strays_find_what_they_belong_to_or_go() -> None:
    pieces: list[Piece] = [("sofa", 1.2, 2.5, 2.0, 0.9, 0.8, 0),
                           ("side_coffee_table", 3.7, 0.3, 0.45, 0.45, 0.5, 0),
                           ("dining_cabinet", 3.0, 0.2, 0.9, 0.4, 0.9, 180)]  # fmt: skip
    before = view_home(home("living", pieces)).rooms[0]
    after = improved(before, lambda _: 0.0, [regrouped, regrouped])
    assert not strays(after)
    assert "dining_cabinet" not in after.categories


@pytest.mark.parametrize(("gap", "is_broken"), [(0.0, False), (0.4, True), (0.9, False)])
def test_nobody_passes_a_slit_behind_a_sofa(gap: float, is_broken: bool) -> None:
    found = findings(home("living", [("sofa", 2.0, 2.55 - gap, 2.0, 0.9, 0.8, 0)]))
    assert ("slit behind the sofa" in found) == is_broken


def test_free_depth_is_that_of_shapes() -> None:
    rng = np.random.default_rng(3)
    for _ in range(60):
        yaw = float(rng.uniform(0, 360))
        pieces: list[Piece] = [("cabinet", 2.0, 1.5, 0.8, 0.5, 1.0, yaw)]
        pieces += [
            ("cabinet", *rng.uniform((0.5, 0.5), (3.5, 2.5)), 0.6, 0.5, 1.0, rng.uniform(0, 360))
            for _ in range(3)
        ]
        graph = home("living", pieces)
        view = View(shells(graph.rooms, graph.openings)["room"], graph.items)
        if (view.depths[0, 1:] > 0).any():
            continue
        depth = view.before(0, -0.4, 0.4)
        strip = shapely.box(-0.38, -0.25 - depth + 0.05, 0.38, -0.26)
        strip = translate(rotate(strip, yaw, origin=(0, 0)), 2.0, 1.5)
        others = shapely.union_all([shapely.Polygon(c) for c in view.corners[1:]])
        assert depth < 0.05 or strip.intersection(others).area < 1e-3
        assert depth < 0.05 or strip.difference(shapely.box(0, 0, 4, 3)).area < 0.05
        longer = shapely.box(-0.4, -0.25 - depth - 0.1, 0.4, -0.26)
        longer = translate(rotate(longer, yaw, origin=(0, 0)), 2.0, 1.5)
        beyond = longer.difference(shapely.box(0, 0, 4, 3)).area
        assert beyond + longer.intersection(others).area > 1e-4


def test_a_home_lacks_seats_for_its_sleepers() -> None:
    judged = design_of([bedroom()]).home
    found = {one.rule: one for one in judged.findings}
    assert found["diners without a seat"].have == 2
    assert "laundry" in found
    bare = replace(bedroom(), items=())
    assert {one.rule: one.have for one in design_of([bare]).home.findings}[
        "diners without a seat"
    ] == 1


def test_floor_that_pieces_cut_off_is_tight() -> None:
    row: list[Piece] = [("cabinet", 2.0, 1.5, long, 0.6, 2.2, 0) for long in (3.9, 2.8)]
    for pieces, parts in ((row[:1], 1), (row[1:], 0), ([], 0)):
        graph = home("living", pieces)
        view = View(shells(graph.rooms, graph.openings)["room"], graph.items)
        assert tight(view) == parts


def test_a_bed_pushed_against_the_wardrobe_is_worse_planned_and_a_removed_lamp_is_not():
    polygon = np.array([[0.0, 0.0], [4.5, 0.0], [4.5, 4.0], [0.0, 4.0]])
    room = Room("a", "bedroom", polygon)
    door = Opening("d", "door", Box((0.6, -0.12, 0.0), (0.8, 0.24, 2.1), 0.0), ("a",))

    def planned(bed_y: float, *more: Item) -> Design:
        bed = Item("bed", "bed", Box((2.4, bed_y, 0.0), (1.6, 2.0, 0.5), 0.0), "a")
        tall = Item("tall", "cabinet", Box((2.4, 0.3, 0.0), (2.0, 0.6, 2.2), 180.0), "a")
        return design_of([SceneGraph((room,), (door,), (bed, tall, *more))])

    lamp = Item("lamp", "floor_lamp", Box((4.2, 3.7, 0.0), (0.3, 0.3, 1.6), 0.0), "a")
    before = planned(2.99, lamp)
    assert worse_planned(before, planned(2.99)) == {}
    worse = worse_planned(before, planned(1.7, lamp))
    assert set(worse) == {"a"}
    assert re.search(r"at the foot of the bed: \d+ cm, not 75 cm", worse["a"])
