"""Rooms with faults are drawn again, and only what got better is kept."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pytest

from chord_usd.base.errors import ChordError
from chord_usd.base.metrics.walk import walk
from chord_usd.base.raster import canvas
from chord_usd.base.scene.palette import having
from chord_usd.base.scene.types import (
    Box,
    Item,
    LayoutImage,
    Opening,
    Plan,
    PlanImage,
    Provenance,
    Room,
    RoomKind,
    SceneGraph,
    frozen_array,
)
from chord_usd.line.lists.list_sampler import Drawn, Subject
from chord_usd.line.lists.pieces import frame_of, pieces_of
from chord_usd.line.lists.vocabulary import Element
from chord_usd.line.lists.wishes import Asked, Piece
from chord_usd.line.pipeline.redraw import WISH_DRAWS, Draw, arrange_drawn, faults_by_room
from chord_usd.line.pipeline.resample import (
    Mended,
    Resampler,
    furnish_again,
    listed_well,
    mend_rooms,
)


class Painter:
    """A model that paints, call by call, these furnitures, the last one from then on; and the eye
    that reads them."""

    def __init__(self, *draws: Sequence[Item]) -> None:
        self.draws = list(draws)
        self.seeds: list[int] = []

    def resample(self, plan_image: PlanImage, *_: object, seed: int, **__: object) -> LayoutImage:
        self.seeds.append(seed)
        return canvas.layout_image(plan_image, self._drawn())

    def read(self, layout: LayoutImage, plan: Plan) -> SceneGraph:
        return SceneGraph(plan.rooms, plan.openings, tuple(self._drawn()))

    def _drawn(self) -> Sequence[Item]:
        return self.draws[min(len(self.seeds), len(self.draws)) - 1]


def mended(
    graph: SceneGraph,
    painter: Painter,
    times: int = 2,
    asked: Mapping[str, Asked] | None = None,
    spared: Collection[str] = (),
) -> Mended:
    plan_image = canvas.draw_plan(graph.plan, canvas.house_frame(graph.plan))
    layout = replace(canvas.layout_image(plan_image, graph.items), provenance=Provenance())
    draw = Draw(seed=7, asked=asked or {})
    sampler = Resampler(plan_image, painter, painter.read, draw)
    return mend_rooms(graph, layout, sampler, times=times, spared=spared)


@pytest.fixture
def sound_house(furnished_house: SceneGraph) -> SceneGraph:
    """Without a fault: its kitchen, which has no cooker, is a room of no known kind."""
    rooms = (
        replace(r, kind="unknown") if r.kind == "kitchen" else r for r in furnished_house.rooms
    )
    return replace(furnished_house, rooms=tuple(rooms))


@pytest.fixture
def bare(sound_house: SceneGraph) -> tuple[SceneGraph, str, tuple[Item, ...]]:
    """A house with a bedroom that stands empty, its id, and what stood in it."""
    room = next(room for room in sound_house.rooms if room.kind == "bedroom")
    others = tuple(item for item in sound_house.items if item.room_id != room.id)
    items = tuple(sound_house.items_of(room.id))
    return replace(sound_house, items=others), room.id, items


def left_out(graph: SceneGraph, draw: Draw) -> tuple[str, ...]:
    """Ids of the pieces that are not built."""
    built = {item.id for item in arrange_drawn(graph, draw).items}
    return tuple(item.id for item in graph.items if item.id not in built)


def test_a_sound_house_stays_as_it_is(sound_house: SceneGraph) -> None:
    painter = Painter()
    assert not faults_by_room(sound_house)
    found = mended(sound_house, painter)
    assert (found.graph.items, found.rooms, painter.seeds) == (sound_house.items, (), [])
    assert not left_out(sound_house, Draw())


def test_a_bare_room_is_furnished_by_the_next_draw(bare) -> None:
    graph, room_id, items = bare
    assert set(faults_by_room(graph)) == {room_id}
    painter = Painter(items)
    found = mended(graph, painter)
    assert found.rooms == (room_id,)
    assert not faults_by_room(found.graph)
    assert [i.box for i in found.graph.items_of(room_id)] == [i.box for i in items]
    assert painter.seeds != [7], "the seed that left it bare"


class Lister(Draw):
    """Lists that furnish rooms from the second seed on only."""

    furniture: Sequence[Item] = ()
    drawn: list[tuple[int, list[str]]] = []  # noqa: RUF012

    def listed(self, graph, rooms, kept_ids=()):
        self.drawn.append((self.seed, [room.id for room in rooms]))
        new = self.furniture if self.seed != 7 else ()
        return replace(graph, items=(*graph.items, *new))


def test_a_room_that_lists_leave_wrong_is_listed_again_before_it_is_painted(bare) -> None:
    graph, room_id, items = bare
    for furniture, times, wrong, calls in (
        (items, 2, set(), 2), (items, 0, {room_id}, 1), ((), 2, {room_id}, 3),
    ):  # fmt: skip
        Lister.furniture, Lister.drawn = furniture, []
        listed, left, later = listed_well(graph, graph.rooms, Lister(seed=7), times)
        assert listed is not None
        assert (set(left), len(Lister.drawn)) == (wrong, calls)
        assert later == ({room_id} if times and not wrong else set())
        assert len({seed for seed, _ in Lister.drawn}) == calls
        assert all(ids == [room_id] for _, ids in Lister.drawn[1:]), "the other rooms stay"
        there = [item.box for item in listed.items_of(room_id)]
        assert there == ([] if wrong else [item.box for item in items])


def test_a_room_that_no_list_mends_is_painted_again_once(bare) -> None:
    graph, room_id, items = bare
    painter = Painter((), items)
    mended(graph, painter, spared={room_id})
    assert len(painter.seeds) == 1


def test_the_picture_changes_in_the_room_alone(bare) -> None:
    graph, room_id, items = bare
    found = mended(graph, Painter(items))
    frame = found.layout.frame
    before = canvas.layout_image(canvas.draw_plan(graph.plan, frame), graph.items)
    changed = (found.layout.rgb != before.rgb).any(axis=-1)
    assert changed.any()
    assert not (changed & ~canvas.room_pixels(graph.plan.room(room_id), frame)).any()


def test_a_draw_that_is_no_better_is_left(bare) -> None:
    graph, room_id, items = bare
    painter = Painter((), items)
    assert mended(graph, painter).rooms == (room_id,)
    assert len(set(painter.seeds)) == 2
    still = mended(graph, Painter((), ()))
    assert (still.graph.items, still.rooms) == (graph.items, ())


@pytest.mark.parametrize("times", [0, 1, 2])
def test_bare_rooms_are_drawn_as_often_as_asked(bare, times: int) -> None:
    painter = Painter(())
    mended(bare[0], painter, times)
    assert len(set(painter.seeds)) == len(painter.seeds) == times


def test_a_room_that_lacks_an_essential_is_drawn_again(sound_house: SceneGraph) -> None:
    bathroom = next(room for room in sound_house.rooms if room.kind == "bathroom")
    kept = tuple(
        item
        for item in sound_house.items
        if item.room_id != bathroom.id or item.category != "toilet"
    )
    house = replace(sound_house, items=kept)
    assert faults_by_room(house) == {bathroom.id: 1}
    painter = Painter(tuple(i for i in kept if i.room_id == bathroom.id))
    mended(house, painter)
    assert len(painter.seeds) == 2


def test_pieces_in_the_way_are_faults_of_their_rooms(sound_house: SceneGraph) -> None:
    door = next(o for o in sound_house.openings if o.kind == "door" and o.room_ids)
    room_id = door.room_ids[0]
    piece = next(i for i in sound_house.items_of(room_id) if i.box.size_m[2] > 0.3)
    x_m, y_m = door.box.center_m[:2]
    at_the_door = replace(piece.box, center_m=(x_m, y_m, piece.box.center_m[2]))
    moved = tuple(
        replace(item, box=at_the_door) if item is piece else item for item in sound_house.items
    )
    assert faults_by_room(replace(sound_house, items=moved))[room_id]


def test_a_piece_in_another_is_a_fault(sound_house: SceneGraph) -> None:
    bed = next(item for item in sound_house.items if item.category == "bed")
    twice = replace(sound_house, items=(*sound_house.items, replace(bed, id="bed_99")))
    assert faults_by_room(twice)[bed.room_id] > 0.1


def test_a_kitchen_cooks_and_rinses(furnished_house: SceneGraph) -> None:
    kitchen = next(room for room in furnished_house.rooms if room.kind == "kitchen")
    assert faults_by_room(furnished_house) == {kitchen.id: 1}


def test_of_two_pieces_that_stay_in_each_other_the_smaller_is_left_out(
    sound_house: SceneGraph,
) -> None:
    bed = next(item for item in sound_house.items if item.category == "bed")
    length_m, width_m, height_m = bed.box.size_m
    small = replace(bed.box, size_m=(0.8 * length_m, 0.8 * width_m, height_m))
    graph = replace(sound_house, items=(*sound_house.items, replace(bed, id="bed_9", box=small)))
    assert left_out(graph, Draw()) == ("bed_9",)


def test_what_stands_in_a_bed_goes_before_the_bed(sound_house: SceneGraph) -> None:
    """The smaller is the bed here, but a bedroom is not without one."""
    bed = next(item for item in sound_house.items if item.category == "bed")
    cabinet = replace(bed, id="cabinet_9", category="cabinet")
    length_m, width_m, height_m = bed.box.size_m
    small = replace(bed, box=replace(bed.box, size_m=(0.9 * length_m, 0.9 * width_m, height_m)))
    around = (item for item in sound_house.items if item.id != bed.id)
    graph = replace(sound_house, items=(*around, small, cabinet))
    assert left_out(graph, Draw()) == ("cabinet_9",)


def test_a_bed_before_a_window_stays_and_a_cabinet_there_goes(sound_house: SceneGraph) -> None:
    bed = next(item for item in sound_house.items if item.category == "bed")
    window = next(
        o for o in sound_house.openings if bed.room_id in o.room_ids and o.kind == "window"
    )
    around = tuple(item for item in sound_house.items if item.room_id != bed.room_id)
    middle_m = np.mean(sound_house.plan.room(bed.room_id).polygon_m, axis=0)
    x_m, y_m = 0.5 * np.array(window.box.center_m[:2]) + 0.5 * middle_m
    high = replace(bed.box, size_m=(1.5, 2.0, 2.0), center_m=(float(x_m), float(y_m), 0.0))
    before = replace(bed, box=high)
    shaded = replace(sound_house, items=(*around, before))
    assert set(faults_by_room(shaded)) == {bed.room_id}
    assert left_out(shaded, Draw()) == ()
    cabinet = replace(before, id="cabinet_9", category="cabinet")
    beside = sound_house.items_of(bed.room_id)
    graph = replace(sound_house, items=(*around, *beside, cabinet))
    assert left_out(graph, Draw()) == ("cabinet_9",)


def wished(item: Item, *more: Piece, **asked: object) -> dict[str, Asked]:
    wanted = (Piece(item.category, word="thing"), *more)
    return {item.room_id: Asked(wanted, room="Room_0", **asked)}  # type: ignore[arg-type]


@pytest.mark.parametrize("times", [0, 2])
def test_a_room_that_lacks_what_is_wished_is_drawn_until_it_is_there(
    sound_house: SceneGraph, times: int
) -> None:
    table = next(item for item in sound_house.items if item.category == "bedside_table")
    own = tuple(sound_house.items_of(table.room_id))
    without = tuple(i for i in own if i.category != "bedside_table")
    lacks = sound_house.without(i.id for i in own if i.category == "bedside_table")
    painter = Painter(without, without, own)
    found = mended(lacks, painter, times, wished(table))
    assert len(set(painter.seeds)) == 3
    assert {i.category for i in found.graph.items_of(table.room_id)} >= {"bedside_table"}


class Lists:
    """A list network that knows one list."""

    def __init__(self, *elements: Element) -> None:
        self.elements = elements

    def draw(self, subjects: Sequence[Subject], *_: object) -> list[Drawn]:
        return [Drawn(self.elements, 0.0) for _ in subjects]


@pytest.mark.parametrize("is_kept", [False, True])
def test_what_the_painter_will_not_paint_is_given_from_a_list(
    sound_house: SceneGraph, is_kept: bool
) -> None:
    bed = next(item for item in sound_house.items if item.category == "bed")
    room = sound_house.plan.room(bed.room_id)
    own = tuple(sound_house.items_of(room.id))
    others = tuple(item for item in own if item.category != "bed")
    lists = Lists(*pieces_of(own, frame_of(room)))
    draw = Draw(7, lists=lists, asked=wished(bed))  # type: ignore[arg-type]
    kept = [item.id for item in own if item.category == "bedside_table"][:is_kept]
    house = sound_house.without([bed.id])
    plan_image = canvas.draw_plan(house.plan, canvas.house_frame(house.plan))
    painter = Painter(others)
    made = furnish_again(house, room, Resampler(plan_image, painter, painter.read, draw, kept))
    found = made.graph
    assert len(painter.seeds) == 2
    (given,) = (item for item in found.items_of(room.id) if item.category == "bed")
    assert np.allclose(given.box.center_m[:2], bed.box.center_m[:2], atol=0.06)
    assert {item.id for item in found.items_of(room.id)} >= set(kept)
    before = canvas.layout_image(plan_image, house.items)
    assert not (before.rgb == made.layout.rgb).all()


def test_what_finds_no_place_is_an_error_that_names_it(sound_house: SceneGraph) -> None:
    bed = next(item for item in sound_house.items if item.category == "bed")
    asked = wished(bed, Piece("bathtub"), Piece("bathtub"))
    painter = Painter(tuple(sound_house.items_of(bed.room_id)))
    found = mended(sound_house, painter, 0, asked)
    assert len(painter.seeds) == WISH_DRAWS
    draw = Draw(asked=asked)
    assert {p.category for p in draw.lacking(found.graph)[bed.room_id]} == {"bathtub"}
    with pytest.raises(ChordError, match="Room_0: no place was found for: 2 × bathtub"):
        draw.refuse_lacking(found.graph)
    Draw().refuse_lacking(found.graph)


def test_what_is_painted_of_a_kitchen_stands_in_no_room_of_unknown_kind(
    furnished_house: SceneGraph,
) -> None:
    (kitchen,) = (room for room in furnished_house.rooms if room.kind == "kitchen")
    (spare, *_) = (room for room in furnished_house.rooms if room.kind == "living")
    rooms = tuple(replace(r, kind="unknown") if r == spare else r for r in furnished_house.rooms)
    (hob, *_) = having("kitchen_unit")
    units = tuple(
        Item(f"{r.id}/u", hob, furnished_house.items[0].box, r.id) for r in (kitchen, spare)
    )
    house = replace(furnished_house, rooms=rooms, items=units)
    assert [item.room_id for item in Draw().heeded(house).items] == [kitchen.id]
    wishes = {spare.id: Asked(wanted=(Piece(hob),))}
    assert len(Draw(asked=wishes).heeded(house).items) == 2


def test_what_stands_in_a_wish_goes_before_the_wish(sound_house: SceneGraph) -> None:
    """The smaller is the wish here."""
    cabinet = next(i for i in sound_house.items if i.category == "cabinet")
    length_m, width_m, height_m = cabinet.box.size_m
    small = replace(cabinet.box, size_m=(0.8 * length_m, 0.8 * width_m, height_m))
    desk = replace(cabinet, id="table_9", category="table", box=small)
    graph = replace(sound_house, items=(*sound_house.items, desk))
    assert left_out(graph, Draw()) == ("table_9",)
    assert left_out(graph, Draw(asked=wished(desk))) == (cabinet.id,)


def test_what_shall_not_be_there_is_not_and_not_missed(sound_house: SceneGraph) -> None:
    bed = next(item for item in sound_house.items if item.category == "bed")
    draw = Draw(asked={bed.room_id: Asked((), frozenset({"bed"}))})
    kept = draw.heeded(sound_house)
    assert {i.id for i in sound_house.items} - {i.id for i in kept.items} == {bed.id}
    assert faults_by_room(kept)[bed.room_id]
    assert not faults_by_room(kept, draw=draw)


def test_a_room_furnished_anew_holds_what_is_wished_under_its_own_seed(
    sound_house: SceneGraph,
) -> None:
    bed = next(item for item in sound_house.items if item.category == "bed")
    own = tuple(sound_house.items_of(bed.room_id))
    plan_image = canvas.draw_plan(sound_house.plan, canvas.house_frame(sound_house.plan))
    room = sound_house.plan.room(bed.room_id)

    def anew(painter: Painter, **asked: Asked) -> SceneGraph:
        sampler = Resampler(plan_image, painter, painter.read, Draw(5, asked=asked))
        made = furnish_again(sound_house, room, sampler)
        assert made.layout.provenance.seed == made.graph.provenance.seed == 5
        return made.graph

    others = tuple(item for item in own if item.category != "bed")
    painter = Painter(others, others, own)
    assert "bed" in {i.category for i in anew(painter, **wished(bed)).items_of(room.id)}
    assert len(set(painter.seeds)) == 3
    painter = Painter(others)
    assert "bed" not in {i.category for i in anew(painter).items_of(room.id)}
    assert painter.seeds == [5]
    with pytest.raises(ChordError, match="no place was found for: thing"):
        anew(Painter(others), **wished(bed))
    barred = anew(Painter(own), **{room.id: Asked((), frozenset({"bed"}))})
    assert "bed" not in {i.category for i in barred.items_of(room.id)}


def test_of_two_pieces_that_shut_a_house_one_after_another_both_go() -> None:
    """A hall 90 cm wide between the front door and a bedroom: either piece alone shuts it."""
    outlines = {"hall": [(0, 0), (5, 0), (5, 0.9), (0, 0.9)],
                "bedroom": [(5.24, 0), (9, 0), (9, 3), (5.24, 3)]}  # fmt: skip
    kinds: dict[str, RoomKind] = {"hall": "corridor", "bedroom": "bedroom"}
    rooms = tuple(Room(name, kinds[name], frozen_array(own)) for name, own in outlines.items())
    doors = (
        Opening("front", "door", Box((-0.12, 0.45, 0.0), (0.8, 0.24, 2.0), 90.0), ("hall",)),
        Opening("in", "door", Box((5.12, 0.45, 0.0), (0.8, 0.24, 2.0), 90.0), ("hall", "bedroom")),
    )
    items = tuple(
        Item(f"hall/cabinet_{x}", "cabinet", Box((x, 0.6, 0.0), (0.8, 0.6, 2.0), 0.0), "hall")
        for x in (1.8, 3.2)
    )
    house = SceneGraph(rooms, doors, items)
    assert walk(house).shut
    assert not walk(arrange_drawn(house, Draw())).shut


@pytest.mark.parametrize(("score", "category", "stays"), [
    (0.4, "cabinet", False), (0.9, "cabinet", True), (0.4, "washing_machine", True),
])  # fmt: skip
def test_unsure_drawn_furniture_that_hinders_is_left_out(
    sound_house: SceneGraph, score: float, category: str, stays: bool
) -> None:
    """A wardrobe was seen before the bed, and neither opened."""
    bed = next(item for item in sound_house.items if item.category == "bed")
    room = sound_house.plan.room(bed.room_id)
    own = tuple(sound_house.items_of(room.id))
    lists = Lists(*pieces_of(own, frame_of(room)))
    seen = replace(bed, id="drawn", category=category, score=score).with_facts(locked=True)
    draw = Draw(7, lists=lists, locked=(seen,))  # type: ignore[arg-type]
    listed = draw.listed(sound_house, [room])
    assert listed is not None
    freer, made = draw.freed(listed)
    assert (freer.locked == (seen,)) is stays
    if not stays:
        assert not faults_by_room(made)
        assert [i.id for i in made.items if i.room_id != room.id] == [
            i.id for i in sound_house.items if i.room_id != room.id
        ]
