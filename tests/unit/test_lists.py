"""Lists of a room's pieces: told and read back, and drawn as asked."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.metrics import score_scene
from chord_usd.base.metrics.complete import homely_rooms, lacking
from chord_usd.base.metrics.design.price import broken_share, conflicts, tight
from chord_usd.base.metrics.design.shell import shells
from chord_usd.base.metrics.design.view import View
from chord_usd.base.metrics.rooms import mixed_kind, stands_in
from chord_usd.base.metrics.violations import room_faults
from chord_usd.base.metrics.walk import ways_shut
from chord_usd.base.scene.geometry import footprint
from chord_usd.base.scene.palette import HOUSE_CATEGORIES, category
from chord_usd.base.scene.pose import Pose, posed
from chord_usd.base.scene.types import (
    Box,
    Item,
    Opening,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)
from chord_usd.line.lists import pieces
from chord_usd.line.lists.changes import at_walls, placed_again
from chord_usd.line.lists.dining_changes import laid_table
from chord_usd.line.lists.home_programme import programme_of
from chord_usd.line.lists.house import Drafts, furnish_by_lists
from chord_usd.line.lists.improve import improved
from chord_usd.line.lists.list_sampler import GRAPH_INPUTS, Drawn, ListDrawer, Subject
from chord_usd.line.lists.other_places import changes_of
from chord_usd.line.lists.pieces import PIECES
from chord_usd.line.lists.ranking import Ranking, mended
from chord_usd.line.lists.vocabulary import END, NOTHING, Element, sequence_of
from chord_usd.line.lists.wishes import Asked, Piece
from chord_usd.workshop.data.furnish import furnish
from chord_usd.workshop.data.houses import random_plan
from tests.every import later

SEEDS = st.integers(0, 100_000)


def house(seed: int) -> SceneGraph:
    rng = np.random.default_rng(seed)
    return furnish(random_plan(rng), rng)


def told_and_read(graph: SceneGraph) -> SceneGraph:
    items = []
    for around, room in zip(pieces.rooms_around(graph, "homes"), graph.rooms, strict=True):
        elements = pieces.pieces_of(graph.items_of(room.id), around.frame)
        items += pieces.items_from(elements, around, room.id)
    return replace(graph, items=tuple(items))


def test_lists_can_tell_every_category_of_the_palette() -> None:
    assert sorted(PIECES.categories) == sorted(row.name for row in HOUSE_CATEGORIES)


@pytest.mark.parametrize("count", [15, *later(60)])
def test_what_is_told_and_read_back_is_the_same_home(count: int) -> None:
    """But for the grid: a cabinet that fills what is left of a run is no multiple of 5 cm."""
    before = [house(seed) for seed in range(count)]
    after = [told_and_read(graph) for graph in before]
    for one, other in zip(before, after, strict=True):
        assert homely_rooms(other) == homely_rooms(_renamed(one))
        assert len(other.items) == len(one.items)
    scores = [score_scene(graph) for graph in after]
    assert np.mean([score.overlap.piou for score in scores]) < 2e-5
    outside = sum(len(score.out_of_room) for score in scores)
    assert outside <= 0.05 * sum(score.items for score in scores)


def test_pieces_of_a_list_for_a_hall_are_no_larger_than_they_are_made() -> None:
    """Networks see a room of 20 m as one of 8 m, and write sofas of 5 m into it."""
    hall = Room("hall", "living", frozen_array([(0, 0), (20, 0), (20, 20), (0, 20)]))
    sofa = Item("hall/sofa_0", "sofa", Box((6.0, 19.0, 0.0), (5.3, 2.0, 0.8), 0.0), "hall")
    (read,) = told_and_read(SceneGraph((hall,), (), (sofa,))).items
    row = category("sofa")
    assert read.box.size_m[:2] == (row.length_m[1], row.width_m[1])
    assert footprint(read.box)[0][1] == pytest.approx(20.0)


def _renamed(graph: SceneGraph) -> SceneGraph:
    """With the names and the order that reading gives pieces."""
    items = []
    for room in graph.rooms:
        frame = pieces.frame_of(room)
        own = list(graph.items_of(room.id))
        keys = [pieces.pieces_of([item], frame)[0] for item in own]
        told = pieces.pieces_of(own, frame)
        order = sorted(range(len(own)), key=lambda i: told.index(keys[i]))
        counts: dict[str, int] = {}
        for index in order:
            category = own[index].category
            items.append(replace(own[index], id=f"{room.id}/{category}_{counts.get(category, 0)}"))
            counts[category] = counts.get(category, 0) + 1
    return replace(graph, items=tuple(items))


@settings(max_examples=10, deadline=None)
@given(SEEDS, st.floats(-180, 180), st.tuples(st.floats(-9, 9), st.floats(-9, 9)))
def test_pieces_stay_within_a_step_of_where_they_stood(
    seed: int, yaw_deg: float, shift: tuple[float, float]
) -> None:
    graph = posed(house(seed), Pose(yaw_deg=yaw_deg, offset_m=shift))
    renamed = {item.id: item for item in _renamed(graph).items}
    for item in told_and_read(graph).items:
        other = renamed[item.id]
        moved = np.subtract(item.box.center_m[:2], other.box.center_m[:2])
        assert np.abs(moved).max() < 2 * pieces.STEP_M


@pytest.mark.parametrize(
    "corners",
    [
        [(0, 0), (20, 0), (20, 20), (0, 20)],
        [(0, 0), (0.9, 0), (0.9, 1.0), (0, 1.0)],
        [(np.cos(a), np.sin(a)) for a in np.linspace(0, 2 * np.pi, 40, endpoint=False)],
    ],
)
def test_odd_rooms_are_seen(corners: list[tuple[float, float]]) -> None:
    room = Room("r", "bedroom", frozen_array(corners))
    (around,) = pieces.rooms_around(SceneGraph((room,), (), ()), "homes")
    segments = pieces.segments_of(around)
    assert 0 < len(segments) <= pieces.MOST_SEGMENTS
    assert segments[:, 1:].min() >= 0
    assert segments[:, 1:].max() < pieces.PLACES
    back = around.frame.world(around.frame.points(room.polygon_m))
    assert np.allclose(back, room.polygon_m)


def test_units_of_a_kitchen_are_told_as_they_stand() -> None:
    """Each begins where the last one ends, around a corner too, in whichever pose."""
    sizes = [("double_door_floor_cabinet", 0.8), ("sink_cabinet", 0.6), ("cooker_cabinet", 0.6),
             ("single_door_floor_cabinet", 0.4), ("refrigerator", 0.7)]  # fmt: skip
    frame = pieces.Frame((2.0, 1.5), 0.0, 1.0)
    at, items = 0.0, []
    for name, length_m in sizes[:3]:  # along the lower wall, from its left corner
        at += length_m
        box = Box((at - length_m / 2, 0.3, 0.0), (length_m, 0.6, 0.9), 180.0)
        items.append(Item(name, name, box, "k"))
    at = 0.6
    for name, length_m in sizes[3:]:  # along the right wall
        at += length_m
        box = Box((3.7, at - length_m / 2, 0.0), (length_m, 0.6, 0.9), 270.0)
        items.append(Item(name, name, box, "k"))
    for turns in range(4):
        for is_mirrored in (False, True):
            told = pieces.pieces_of(items[::-1], frame, turns, is_mirrored)
            names = [PIECES.categories[one.category] for one in told]
            wanted = [name for name, _ in sizes]
            assert names == (wanted[::-1] if is_mirrored else wanted)


class Chance:
    """In place of a trained network: all that may stand somewhere is as likely."""

    def shapes(self) -> dict[str, list[int]]:
        return {"keys_0": [0, 2, 0, 4], "values_of_0": [0, 2, 0, 4]}

    def run(self, inputs: dict[str, Any]) -> list[np.ndarray]:
        assert set(inputs) == {*GRAPH_INPUTS, *self.shapes()}
        allowed = PIECES.allowed()[inputs["roles"][:, -1]]
        drawn = np.where(allowed, inputs["noise"], -np.inf).argmax(axis=-1)
        given = inputs["values"][:, -1]
        drawn = np.where(given == NOTHING, drawn, given)
        known = [inputs[name] for name in ("there", *self.shapes())]
        return [drawn, np.zeros(drawn.shape, np.float32), *known]


def subject(**asked: Any) -> Subject:
    room = Room("r", "bedroom", frozen_array([(0, 0), (4, 0), (4, 3), (0, 3)]))
    (around,) = pieces.rooms_around(SceneGraph((room,), (), ()), "homes")
    return Subject(pieces.segments_of(around), around.facts, around.flags, **asked)


CATEGORIES = st.integers(0, len(PIECES.categories) - 1)


@settings(max_examples=40, deadline=None)
@given(st.lists(CATEGORIES, max_size=5), st.frozensets(CATEGORIES, max_size=9), SEEDS)
def test_lists_hold_what_is_wanted_in_order_and_not_what_is_excluded(
    wanted: list[int], excluded: frozenset[int], seed: int
) -> None:
    drawer = ListDrawer(Chance(), PIECES, "")  # type: ignore[arg-type]
    asked = [subject(wanted=tuple(wanted), excluded=excluded), subject()]
    first, other = drawer.draw(asked, np.random.default_rng(seed))
    categories = [element.category for element in first.elements]
    ranks = [int(PIECES.ranks[category]) for category in categories]
    assert ranks == sorted(ranks)
    assert all(categories.count(one) >= wanted.count(one) for one in wanted)
    assert not (set(categories) - set(wanted)) & excluded
    assert len(other.elements) <= PIECES.most


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_what_is_kept_stands_where_it_stood(seed: int) -> None:
    rng = np.random.default_rng(seed)
    kept = tuple(
        Element(category, (0, *map(int, rng.integers(pieces.PLACES, size=4))))
        for category in sorted(rng.integers(len(PIECES.categories), size=4).tolist())
    )
    drawer = ListDrawer(Chance(), PIECES, "")  # type: ignore[arg-type]
    (drawn,) = drawer.draw([subject(kept=kept)], rng)
    assert all(element in drawn.elements for element in kept)


def test_the_same_seed_draws_the_same_lists() -> None:
    drawer = ListDrawer(Chance(), PIECES, "")  # type: ignore[arg-type]
    first, again = (drawer.draw([subject()] * 3, np.random.default_rng(5)) for _ in range(2))
    assert first == again
    assert drawer.draw([], np.random.default_rng(0)) == []


def test_a_sequence_tells_categories_then_values() -> None:
    told = [Element(1, (0, 1, 2, 3, 4)), Element(1, (6, 5, 6, 7, 8))]
    found = sequence_of(PIECES, told)
    assert found.roles.tolist() == [0, 0, 0, 2, 2]
    assert found.left.tolist() == [0, 0, 0, 2, 1]
    assert found.values[2, 0] == END
    allowed = PIECES.allowed()
    for role, values in zip(found.roles, found.values, strict=True):
        assert all(allowed[role, slot, value] for slot, value in enumerate(values))


def test_rooms_are_furnished_as_asked_and_the_others_left_alone() -> None:
    graph = house(4)
    chosen = graph.rooms[0]
    drawer = ListDrawer(Chance(), PIECES, "")  # type: ignore[arg-type]
    asked = {chosen.id: Asked((Piece("bed"), Piece("table")), excluded=frozenset({"sofa"}))}
    found = furnish_by_lists(
        graph.plan, drawer, Drafts(1, 3), asked, rooms=[chosen.id], standing=graph.items
    )
    others = [item for item in graph.items if item.room_id != chosen.id]
    assert [item for item in found.items if item.room_id != chosen.id] == others
    names = Counter(item.category for item in found.items_of(chosen.id))
    assert "sofa" not in names


class Rarely:
    """A list network that takes a room for another kind, but for every ninth list."""

    content_hash = ""

    def __init__(self, mostly: tuple[Element, ...], rarely: tuple[Element, ...]) -> None:
        self.mostly, self.rarely, self.drawn = mostly, rarely, 0

    def draw(self, subjects: Sequence[Subject], *_: object) -> list[Drawn]:
        found = []
        for one in subjects:
            if one.excluded:  # the same pieces in other places
                held = {element.category for element in self.rarely}
                own = self.rarely if set(one.wanted) <= held else self.mostly
            else:
                self.drawn += 1
                own = self.mostly if self.drawn % 9 else self.rarely
            found.append(Drawn(own, 0.0))
        return found


def test_of_several_lists_one_that_lacks_nothing_is_held_though_it_is_shorter() -> None:
    graph = house(4)
    bath = next(room for room in graph.rooms if room.kind == "bathroom")
    bed = next(room for room in graph.rooms if room.kind == "bedroom")
    lists = [
        tuple(pieces.pieces_of(list(graph.items_of(room.id)), pieces.frame_of(room)))
        for room in (bed, bath)
    ]
    drawer = Rarely(lists[0], lists[1][:3])
    found = furnish_by_lists(
        graph.plan, drawer, Drafts(1, 3), rooms=[bath.id], standing=graph.items
    )
    held = {item.category for item in found.items_of(bath.id)}
    assert not lacking("bathroom", 5.0, held)


def test_faults_of_a_furnished_house_are_none_and_grow_with_what_is_wrong() -> None:
    graph = house(7)
    assert sum(room_faults(graph, graph.rooms)) == 0.0
    (first, *_) = graph.items
    x, y, z = first.box.center_m
    aside = replace(first, box=replace(first.box, center_m=(x + 30.0, y, z)))
    spoilt = replace(graph, items=(aside, *graph.items[1:]))
    index = [room.id for room in graph.rooms].index(first.room_id)
    assert room_faults(spoilt, graph.rooms)[index] > 0.0


def test_pieces_that_part_the_doors_of_a_room_are_a_fault() -> None:
    hall = Room("hall", "corridor", np.array([[0, 0], [6, 0], [6, 1.3], [0, 1.3]], np.float64))
    doors = tuple(
        Opening(f"door{x}", "door", Box((x, 0.0, 0.0), (0.8, 0.24, 2.0), 0.0), ("hall",))
        for x in (0.6, 5.4)
    )
    across = Item("table", "table", Box((3.0, 0.65, 0.0), (0.5, 1.25, 0.7), 0.0), "hall", "")
    along = replace(across, box=Box((3.0, 1.1, 0.0), (0.9, 0.3, 0.7), 0.0))
    for item, shut in ((across, 1), (along, 0)):
        assert ways_shut(SceneGraph((hall,), doors, (item,)), hall) == shut


def test_a_home_is_planned_for_those_who_sleep_in_it() -> None:
    def room(name: str, kind: RoomKind, x: float, wide: float) -> Room:
        corners = frozen_array([(x, 0), (x + wide, 0), (x + wide, 4), (x, 4)])
        return Room(name, kind, corners)

    rooms = (
        room("hall", "corridor", 0, 1.5), room("living", "living", 2, 5),
        room("one", "bedroom", 8, 3), room("two", "bedroom", 12, 2),
        room("bath", "bathroom", 15, 2),
    )  # fmt: skip
    front = Opening("front", "door", Box((0.7, -0.12, 0.0), (0.9, 0.24, 2.1), 0.0), ("hall",))
    programme = programme_of(rooms, [front])
    assert programme["living"].count("chair") == 3, "two in the larger bedroom, another in the next"
    assert {"sofa", "tv_cabinet", "dining_table"} <= set(programme["living"])
    assert programme["one"].count("bedside_table") == 2
    assert programme["two"].count("bedside_table") == 1
    assert (programme["hall"], programme["bath"]) == (("shoe_cabinet",), ("washing_machine",))


@pytest.mark.parametrize("others", [("bathroom", "kitchen"), ("bathroom", "corridor")])
def test_people_sleep_in_the_living_room_of_a_studio_only(
    others: tuple[RoomKind, ...],
) -> None:
    corners = frozen_array([(0, 0), (6.2, 0), (6.2, 4.2), (0, 4.2)])
    rooms = [Room("living", "living", corners)]
    rooms += [Room(kind, kind, frozen_array(corners * 0.4 + (6.5, 2 * at)))
              for at, kind in enumerate(others)]  # fmt: skip
    sleeps = "corridor" not in others
    assert ("bed" in programme_of(rooms, ())["living"]) == sleeps
    assert stands_in("bed", "living", mixed_kind([room.kind for room in rooms])) == sleeps


def test_the_draft_that_breaks_fewest_rules_is_taken() -> None:
    """A bed under the window with a door at its foot is drawn as likely as the other."""
    corners = frozen_array([(0, 0), (4, 0), (4, 4), (0, 4)])
    room = Room("room", "bedroom", corners)
    openings = (
        Opening("w", "window", Box((-0.12, 2.0, 0.9), (1.2, 0.24, 1.2), 90.0), ("room",)),
        Opening("d", "door", Box((4.12, 2.0, 0.0), (0.9, 0.24, 2.1), 90.0), ("room",)),
    )
    beds = {
        "under": Item("bed", "bed", Box((1.05, 2.0, 0.0), (1.6, 2.1, 1.0), 90.0), "room"),
        "beside": Item("bed", "bed", Box((2.0, 2.95, 0.0), (1.6, 2.1, 1.0), 0.0), "room"),
    }
    for order in (("under", "beside"), ("beside", "under")):
        ranking = Ranking(SceneGraph((room,), openings, ()), [room], [Asked()])
        ranking.weigh({0: [[beds[name]] for name in order]})
        assert beds["beside"].box in [item.box for item in ranking.chosen()]


def test_a_chosen_draft_keeps_more_rules_and_gets_no_tighter() -> None:
    """A wardrobe of 1 m for two sleepers, with free wall beside it, and one bedside table."""
    corners = frozen_array([(0, 0), (4.5, 0), (4.5, 4), (0, 4)])
    room = Room("room", "bedroom", corners)
    boxes = {
        "bed": Box((2.2, 2.95, 0.0), (1.6, 2.1, 1.0), 0.0),
        "bedside_table": Box((1.15, 3.8, 0.0), (0.5, 0.4, 0.5), 0.0),
        "cabinet": Box((1.0, 0.3, 0.0), (1.0, 0.6, 2.15), 180.0),
    }
    items = tuple(Item(f"room/{name}_0", name, box, "room") for name, box in boxes.items())
    before = View(shells((room,), ())["room"], items)
    after = improved(before, lambda _: 0.0, changes_of(before))
    assert broken_share(before) > broken_share(after) == 0.0
    assert tight(before) == tight(after) == 0
    assert len(after.of("bedside_table")) == 2
    assert sum(after.length[after.of("cabinet")]) >= 2.0 - 0.01
    assert after.items[after.of("bed")[0]].box == boxes["bed"]


def test_a_step_into_a_wall_or_another_piece_is_mended() -> None:
    corners = frozen_array([(0, 0), (4, 0), (4, 4), (0, 4)])
    room = Room("room", "bedroom", corners)
    boxes = (((2.0, 2.95, 0.0), (1.6, 2.1, 1.0)), ((1.0, 3.85, 0.0), (0.5, 0.4, 0.5)))
    items = tuple(
        Item(name, name, Box(*box, 0.0), "room")
        for name, box in zip(("bed", "bedside_table"), boxes, strict=True)
    )
    view = View(shells((room,), ())["room"], items)
    assert conflicts(view).max() > 0.04
    after = mended(view)
    assert conflicts(after).max() < 0.01
    moved = np.abs(after.at - view.at)
    assert moved.max() < 0.3


def _living(items: Sequence[tuple[str, Box]], *openings: Opening) -> View:
    room = Room("room", "living", frozen_array([(0, 0), (5, 0), (5, 4), (0, 4)]))
    own = tuple(
        Item(f"room/{name}_{at}", name, box, "room") for at, (name, box) in enumerate(items)
    )
    return View(shells((room,), openings)["room"], own)


_SOFA = ("sofa", Box((2.5, 3.5, 0.0), (2.0, 0.9, 0.8), 0.0))


def test_what_was_lost_is_placed_again_on_free_floor() -> None:
    there = ("cabinet", Box((0.3, 2.0, 0.0), (1.2, 0.5, 0.9), 90.0))
    view = _living([_SOFA, there])
    lost = [Item("room/cabinet_9", "cabinet", Box((0.3, 1.4, 0.0), (1.2, 0.5, 0.9), 90.0), "room")]
    after = improved(view, lambda _: 0.0, [placed_again(lost[0])], gain=0.0)
    assert len(after.of("cabinet")) == 2
    assert tight(after) == 0
    assert after.items[:2] == view.items


def test_a_television_hangs_where_its_cabinet_would_stand_before_a_window() -> None:
    window = Opening("w", "window", Box((2.0, -0.12, 0.9), (1.2, 0.24, 1.2), 0.0), ("room",))
    cabinet = ("tv_cabinet", Box((2.2, 0.2, 0.0), (1.6, 0.4, 0.5), 180.0))
    view = _living([_SOFA, cabinet], window)
    (screen,) = view.televisions
    assert view.bare == [1]
    assert not screen.id
    assert screen.at[0] - screen.length / 2 > 2.6, "beside the window"
    assert abs(screen.at[1]) < 0.1, "on the wall that the sofa faces"


def test_halls_have_no_more_places_than_large_rooms() -> None:
    """A scale read wrong makes halls of rooms, whose places would take minutes to try."""
    hall = Room("room", "dining", np.array([[0, 0], [90, 0], [90, 90], [0, 90]], np.float64))
    view = View(shells((hall,), ())["room"], ())
    assert sum(1 for _ in at_walls(view, (1.0, 0.5, 0.8))) < 250
    assert sum(1 for _ in laid_table(view, 4)) < 15_000
