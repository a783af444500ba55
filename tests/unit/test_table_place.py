"""Supporting pieces in their rooms, and items that are stood on the real tops of meshes."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from chord_usd.base.raster.relief import Relief
from chord_usd.base.raster.table_top import TableTop
from chord_usd.base.scene.geometry import footprint, footprint_polygon, in_world
from chord_usd.base.scene.types import Asset, Box, Item, Opening, Room, SceneGraph, frozen_array
from chord_usd.line.graph.table_place import Laid, place_on
from chord_usd.line.graph.tabletop import (
    is_too_small,
    lay_pieces,
    table_views,
    view_from_above,
    with_items,
)

TOP_M = 0.75
ROOM = Room("a", "living", frozen_array([(0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)]))


def mesh(name: str, size_m: tuple[float, float, float]) -> Asset:
    return Asset(name, name, size_m, Path(f"{name}.usda"))


def flat(size_m: tuple[float, float, float]) -> Relief:
    """A block: as high as it is, everywhere."""
    rows, columns = (max(round(side / 0.005), 1) for side in (size_m[1], size_m[0]))
    return Relief(np.full((rows, columns), size_m[2]), size_m)


def flat_of(asset: Asset, /) -> Relief:
    return flat(asset.size_m)


class Sizes:
    """A database with a mesh of every size asked for."""

    def nearest(self, name: str, size_m: tuple[float, float, float], /, **_: object) -> Asset:
        return mesh(name, size_m)


def table(name: str = "table", size_m=(1.2, 0.6, TOP_M), at=(2.0, 1.5), yaw=0.0) -> Item:
    box = Box((*at, 0.0), size_m, yaw)
    return Item(f"a/{name}_0", name, box, "a", asset=mesh(name, size_m))


def thing(name: str, x: float, y: float, size_m, yaw: float = 0.0) -> Item:
    return Item(name, name, Box((x, y, 0.0), size_m, yaw))


def laid(on: Item, *items: Item, relief: Relief | None = None, around=()) -> Laid:
    relief = relief or flat(on.box.size_m)
    return place_on(on, relief, items, Sizes(), flat_of, around)


class Told:
    """A model that lays what it is told."""

    content_hash = "none"

    def __init__(self, *things: list[Item]) -> None:
        self.told, self.seeds = list(things), [0]

    def things(self, tops, seeds, progress=None) -> list[list[Item]]:
        assert len(tops) == len(self.told)
        self.seeds = list(seeds)
        return self.told


class TestRelief:
    def test_the_top_is_the_level_that_most_of_a_piece_is_at(self) -> None:
        heights = np.full((60, 120), TOP_M)
        heights[:10] = 1.2  # a hutch at the back
        heights[:, 60:70] = 0.1  # a gap through which one sees the foot
        relief = Relief(heights, (1.2, 0.6, 1.2))
        assert relief.level_m == TOP_M
        assert relief.free.mean() == pytest.approx(1 - (10 * 120 + 50 * 10) / (60 * 120))

    def test_what_is_not_felt_carries_nothing(self) -> None:
        """In a simulator, what stood there would fall: the rim of a round top."""
        felt = np.full((60, 120), TOP_M)
        felt[:, :12] = 0.0
        relief = Relief(np.full((60, 120), TOP_M), (1.2, 0.6, TOP_M), felt)
        assert relief.free.mean() == pytest.approx(0.9)
        assert relief.scaled((1.2, 0.6, 2 * TOP_M)).free.mean() == pytest.approx(0.9)
        assert relief.highest_m(Box((-0.55, 0.0, 0.0), (0.05, 0.05, 0.1), 0.0)) == TOP_M

    def test_what_is_under_a_box(self) -> None:
        heights = np.full((60, 120), TOP_M)
        heights[:20, :40] = 1.0  # back left
        relief = Relief(heights, (1.2, 0.6, 1.0))
        assert relief.highest_m(Box((-0.5, 0.2, 0.0), (0.1, 0.1, 0.1), 0.0)) == 1.0
        assert relief.highest_m(Box((0.5, 0.2, 0.0), (0.1, 0.1, 0.1), 0.0)) == TOP_M
        assert relief.highest_m(Box((5.0, 0.0, 0.0), (0.1, 0.1, 0.1), 0.0)) == 0.0
        half = Box((-0.2, 0.2, 0.0), (0.2, 0.1, 0.1), 0.0)
        assert relief.free_share(half) == pytest.approx(0.5, abs=0.05)

    @pytest.mark.parametrize("yaw", [0.0, 30.0, 45.0, 90.0, -120.0])
    def test_the_cells_under_a_turned_box_are_its_area(self, yaw: float) -> None:
        relief = flat((1.2, 0.6, TOP_M))
        box = Box((0.1, 0.05, 0.0), (0.3, 0.2, 0.1), yaw)
        mask, _ = relief.under(box)
        assert mask.sum() * relief.cell_m2 == pytest.approx(0.06, rel=0.06)
        assert relief.free_share(box) == pytest.approx(1.0, abs=0.005)

    def test_a_centimetre_beyond_the_edge_is_not_over_the_top(self) -> None:
        box = Box((-0.43, 0.0, 0.0), (0.36, 0.28, 0.1), 0.0)
        assert flat((1.2, 0.6, TOP_M)).free_share(box) == pytest.approx(0.35 / 0.36, abs=0.001)

    def test_a_piece_of_another_size_has_its_relief_scaled(self) -> None:
        relief = flat((1.0, 0.5, 0.7)).scaled((2.0, 1.0, 0.8))
        assert relief.level_m == pytest.approx(0.8)
        assert relief.cell_m2 == pytest.approx(2.0 / relief.heights_m.size)


class TestView:
    def test_walls_and_seats_are_seen_in_the_frame_of_the_piece(self) -> None:
        """A desk turned by a quarter: the wall is at its own back, the chair at its own front."""
        desk = table(at=(3.7, 1.5), yaw=-90.0)
        chair = Item("c", "chair", Box((3.1, 1.5, 0.0), (0.45, 0.45, 0.9), 90.0), "a")
        top = view_from_above(desk, (desk, chair), ROOM, flat(desk.box.size_m))
        assert {(border.side, border.kind) for border in top.borders} == {
            ("back", "wall"), ("front", "seat"),
        }  # fmt: skip
        (seat,) = (border for border in top.borders if border.kind == "seat")
        assert (seat.from_m + seat.to_m) / 2 == pytest.approx(0.0, abs=1e-6)

    def test_a_chair_that_looks_away_is_no_seat(self) -> None:
        desk = table()
        away = Item("c", "chair", Box((2.0, 0.95, 0.0), (0.45, 0.45, 0.9), 0.0), "a")
        top = view_from_above(desk, (desk, away), ROOM, flat(desk.box.size_m))
        assert top.borders == ()

    def test_a_bed_is_beside_a_bedside_table_only(self) -> None:
        small = table("bedside_table", (0.45, 0.4, 0.5), at=(0.3, 2.8))
        bed = Item("b", "bed", Box((1.35, 2.0, 0.0), (1.6, 2.0, 0.9), 0.0), "a")
        top = view_from_above(small, (small, bed), ROOM, flat(small.box.size_m))
        assert ("right", "bed") in {(border.side, border.kind) for border in top.borders}
        desk = table(at=(0.3, 2.8))
        top = view_from_above(desk, (desk, bed), ROOM, flat(desk.box.size_m))
        assert not any(border.kind == "bed" for border in top.borders)

    def test_small_and_narrow_tops_are_too_small(self) -> None:
        def top(rows: int, columns: int) -> TableTop:
            free = np.ones((rows, columns), np.bool_)
            return TableTop("table", (columns * 0.01, rows * 0.01), free)

        assert is_too_small(top(8, 150))
        assert not is_too_small(top(30, 30))
        free = np.zeros((60, 120), np.bool_)
        free[::10] = True  # a grate
        assert is_too_small(TableTop("table", (1.2, 0.6), free))


class TestPlacing:
    def test_items_stand_on_the_top_where_they_were_drawn(self) -> None:
        desk = table()
        cup = thing("coffee_cup", 0.3, -0.1, (0.13, 0.12, 0.08), 180.0)
        (child,) = laid(desk, cup).children
        assert child.box.center_m[:2] == pytest.approx(cup.box.center_m[:2], abs=0.01)
        assert child.box.center_m[2] == TOP_M
        assert child.box.yaw_deg == pytest.approx(180.0)
        assert child.id == "a/table_0/coffee_cup_0"
        assert child.asset is not None

    def test_a_laptop_stands_on_the_mat_below_it(self) -> None:
        desk = table()
        mat = thing("big_mouse_pad", 0.0, 0.0, (0.8, 0.35, 0.004))
        laptop = thing("laptop", 0.0, 0.0, (0.32, 0.28, 0.2))
        children = {child.category: child for child in laid(desk, laptop, mat).children}
        below = children["big_mouse_pad"].box
        assert below.center_m[2] == TOP_M
        assert children["laptop"].box.center_m[2] == pytest.approx(TOP_M + below.size_m[2])

    @pytest.mark.parametrize(
        ("x_m", "stands"),
        [(-0.31, "beside"), (-0.28, "beside"), (-0.18, ""), (-0.15, "on"), (-0.08, "on")],
    )
    def test_nothing_tips_over_the_rim_of_a_mat(self, x_m: float, stands: str) -> None:
        """Its middle is over the mat, or none of it is; the few millimetres tip a laptop over."""
        desk = table()
        mat = thing("big_mouse_pad", 0.15, 0.0, (0.6, 0.35, 0.004))
        laptop = thing("laptop", x_m, 0.0, (0.32, 0.28, 0.2))
        result = laid(desk, laptop, mat)
        children = {child.category: child.box for child in result.children}
        assert result.left_out == (not stands)
        if not stands:
            return
        rim_m = footprint(children["big_mouse_pad"])[:, 0].min()
        box = children["laptop"]
        assert (box.center_m[2] > TOP_M) == (stands == "on")
        if stands == "on":
            assert box.center_m[0] > rim_m + 0.4 * min(box.size_m[:2]) - 1e-9
        else:
            assert footprint(box)[:, 0].max() <= rim_m + 0.001

    def test_what_only_just_reaches_a_mat_is_moved_off_it(self) -> None:
        desk = table()
        mat = thing("big_mouse_pad", 0.2, 0.0, (0.6, 0.35, 0.004))
        cup = thing("coffee_cup", -0.13, 0.1, (0.1, 0.1, 0.1))
        children = {child.category: child.box for child in laid(desk, cup, mat).children}
        assert children["coffee_cup"].center_m[2] == TOP_M
        assert children["coffee_cup"].center_m[0] == pytest.approx(-0.13, abs=0.07)

    def test_what_reaches_over_the_edge_is_brought_back(self) -> None:
        desk = table()
        over = thing("laptop", 0.45, 0.0, (0.34, 0.28, 0.2))
        result = laid(desk, over)
        assert abs(footprint(result.seen[0].box)[:, 0]).max() > 0.6
        corners = footprint(result.children[0].box)
        assert abs(corners[:, 0]).max() <= 0.6 + 0.005
        assert abs(corners[:, 1]).max() <= 0.3 + 0.005

    def test_what_is_mostly_beside_the_top_is_left_out_and_counted(self) -> None:
        desk = table()
        relief = flat(desk.box.size_m)
        relief.heights_m[:, 120:] = 0.0  # half of the top is missing
        result = laid(desk, thing("laptop", 0.3, 0.0, (0.34, 0.28, 0.2)), relief=relief)
        assert result.children == ()
        assert len(result.seen) == 1

    def test_of_two_that_overlap_the_larger_stays(self) -> None:
        desk = table()
        items = (
            thing("laptop", 0.0, 0.0, (0.34, 0.28, 0.2)),
            thing("coffee_cup", 0.16, 0.0, (0.13, 0.13, 0.08)),
        )
        result = laid(desk, *items)
        assert [child.category for child in result.children] == ["laptop"]
        assert {one.category for one in result.seen} == {"laptop", "coffee_cup"}

    def test_what_only_just_reaches_a_foot_is_moved_off_it(self) -> None:
        """Else it would be lifted by the foot of the television and hang in the air."""
        desk = table("tv_cabinet", (1.6, 0.4, 0.5))
        relief = flat(desk.box.size_m)
        relief.heights_m[38:41, 140:180] = 0.51
        plant = thing("small_plant", -0.189, 0.07, (0.18, 0.18, 0.24))
        (child,) = laid(desk, plant, relief=relief).children
        assert child.box.center_m[2] == 0.5
        assert relief.is_level(child.box)

    def test_nothing_stands_on_a_hump(self) -> None:
        """Where something rises from the top (a television) nothing is put on it."""
        desk = table("tv_cabinet", (1.6, 0.4, 0.5))
        relief = flat(desk.box.size_m)
        relief.heights_m[:20, 60:260] = 1.1
        items = (
            thing("small_plant", 0.0, 0.15, (0.18, 0.18, 0.24)),
            thing("small_plant", 0.65, 0.0, (0.18, 0.18, 0.24)),
        )
        (child,) = laid(desk, *items, relief=relief).children
        assert child.box.center_m[0] == pytest.approx(0.65, abs=0.02)
        assert child.box.center_m[2] == pytest.approx(0.5)

    def test_nothing_runs_into_what_hangs_over_the_piece(self) -> None:
        desk = table()
        x, y, _ = desk.box.center_m
        shelf = Item("s", "bed_background", Box((x, y + 0.25, 0.9), (1.2, 0.2, 0.5), 0.0), "a")
        lamp = thing("table_lamp", 0.0, 0.15, (0.25, 0.25, 0.45))
        assert laid(desk, lamp).children
        assert laid(desk, lamp, around=(shelf.box,)).children == ()

    def test_what_stands_below_a_window_is_moved_off_the_board(self) -> None:
        desk = replace(table(), box=Box((2.0, 3.7, 0.0), (1.4, 0.6, 0.75), 0.0))
        window = Opening("w", "window", Box((2.0, 4.12, 0.9), (1.2, 0.24, 1.2), 0.0))
        room = Room("a", "bedroom", np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]))
        graph = SceneGraph((room,), (window,), (desk,))
        (view,) = table_views(graph, flat_of)
        (board,) = view.around
        lamp = thing("table_lamp", 0.0, 0.2, (0.25, 0.18, 0.45))
        (kept,) = laid(desk, lamp, around=view.around).children
        world = footprint_polygon(in_world(kept.box, desk.box))
        assert world.distance(footprint_polygon(board)) > 0.0
        assert world.bounds[3] > 3.9, "moved as little as clears the board"

    def test_what_rises_beside_a_piece_is_minded_and_what_reaches_under_it_is_not(self) -> None:
        desk = table()
        x, y, _ = desk.box.center_m
        cabinet = Item("c", "cabinet", Box((x + 0.9, y, 0.0), (0.6, 0.6, 1.8), 0.0), "a")
        low = Item("l", "bedside_table", Box((x - 0.85, y, 0.0), (0.5, 0.5, 0.5), 0.0), "a")
        chair = Item("h", "chair", Box((x, y - 0.3, 0.0), (0.5, 0.5, 0.95), 0.0), "a")
        graph = SceneGraph((ROOM,), (), (desk, cabinet, low, chair))
        (view,) = (one for one in table_views(graph, flat_of) if one.item.id == desk.id)
        assert view.around == (cabinet.box,)

    def test_a_child_turns_with_its_parent(self) -> None:
        parent = Box((2.0, 1.0, 0.0), (1.0, 0.5, 0.7), 90.0)
        world = in_world(Box((0.3, 0.1, 0.7), (0.1, 0.1, 0.1), 10.0), parent)
        assert world.center_m == pytest.approx((1.9, 1.3, 0.7))
        assert world.yaw_deg == 100.0


class TestHouse:
    def house(self, *items: Item) -> SceneGraph:
        return SceneGraph(rooms=(ROOM,), openings=(), items=items)

    def test_every_supporting_piece_with_a_mesh_is_seen_once(self) -> None:
        desk, small = table(), table("bedside_table", (0.08, 0.4, 0.5), at=(1.0, 1.0))
        bare = replace(table("coffee_table"), asset=None)
        chair = Item("c", "chair", Box((1.0, 2.0, 0.0), (0.45, 0.45, 0.9), 0.0), "a")
        views = table_views(self.house(desk, small, bare, chair), flat_of)
        assert [view.item.id for view in views] == [desk.id, small.id]
        assert [view.is_too_small for view in views] == [False, True]
        assert table_views(self.house(desk), flat_of, rooms=("b",)) == []
        child = replace(chair, category="coffee_cup")
        assert table_views(self.house(replace(desk, children=(child,))), flat_of) == []

    def test_a_piece_too_small_is_left_empty_and_told(self) -> None:
        desk, small = table(), table("bedside_table", (0.08, 0.4, 0.5), at=(1.0, 1.0))
        house = self.house(desk, small)
        cup = thing("coffee_cup", 0.3, -0.1, (0.13, 0.12, 0.08))
        views = table_views(house, flat_of)
        laid = lay_pieces(views, Told([cup]), 0, Sizes(), flat_of)
        filled = with_items(house, views, laid)
        assert filled.too_small == (small.id,)
        assert filled.bare == ()
        assert (filled.items, filled.left_out) == (1, 0)
        by_id = {item.id: item for item in filled.graph.items}
        assert by_id[small.id].children == ()
        assert [child.category for child in by_id[desk.id].children] == ["coffee_cup"]

    def test_each_piece_is_drawn_once_with_its_own_seed(self) -> None:
        desk, other = table(), table("coffee_table", (1.0, 0.6, 0.4), at=(1.0, 1.0))
        views = table_views(self.house(desk, other), flat_of)
        laptop = thing("laptop", 0.0, 0.0, (0.34, 0.28, 0.2))
        in_it = thing("coffee_cup", 0.16, 0.0, (0.13, 0.13, 0.08))
        model = Told([laptop, in_it], [])
        laid = lay_pieces(views, model, 7, Sizes(), flat_of)
        assert model.seeds == [view.seed(7) for view in views]
        assert [child.category for child in laid[desk.id].children] == ["laptop"]
        assert laid[desk.id].left_out == 1
        assert with_items(self.house(desk, other), views, laid).bare == (other.id,)

    def test_a_seed_depends_on_house_and_piece_alone(self) -> None:
        desk, other = table(), table("coffee_table")
        alone = table_views(self.house(desk), flat_of)[0]
        both = table_views(self.house(other, desk), flat_of)
        assert alone.seed(3) == both[1].seed(3)
        assert len({alone.seed(3), alone.seed(4), both[0].seed(3)}) == 3
