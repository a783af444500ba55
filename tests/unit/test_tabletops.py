"""Procedural tabletops, their pictures, what the network sees of them and what is read back."""

from __future__ import annotations

from collections import Counter
from functools import cache

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from chord_usd.base.metrics.detection import edge_errors_m
from chord_usd.base.metrics.fidelity import match_items
from chord_usd.base.metrics.overlap import items_overlap
from chord_usd.base.raster import canvas
from chord_usd.base.raster.table_top import (
    CANVAS_M,
    TABLE_CANVAS_PX,
    Border,
    TableTop,
    draw_table,
    table_frame,
    top_mask,
)
from chord_usd.base.scene.geometry import footprint, footprint_polygon, front_direction
from chord_usd.base.scene.palette import (
    SUPPORTS,
    TABLE_CATEGORIES,
    TOP_SHADES,
    Level,
    Mount,
    category,
)
from chord_usd.base.scene.types import Box, Item, LayoutImage
from chord_usd.line.graph.match import items_seen
from chord_usd.line.graph.table_items import read_items
from chord_usd.line.layout.table_condition import (
    AREA_PLANE,
    GRID_PLANES,
    PIXEL_PLANES,
    table_condition,
)
from chord_usd.workshop.data.floorplans.dice import Dice
from chord_usd.workshop.data.tabletops import Tabletop, lay, random_tabletop
from chord_usd.workshop.data.tabletops.board import EDGE_M, Board, Outline
from chord_usd.workshop.data.tabletops.tops import SHARES, Piece

COUNT = 200
CELL_PX = 4


@cache
def tabletops() -> tuple[Tabletop, ...]:
    return tuple(random_tabletop(np.random.default_rng((3, seed))) for seed in range(COUNT))


def drawn(tabletop: Tabletop) -> LayoutImage:
    return canvas.layout_image(draw_table(tabletop.top), tabletop.items, Level.TABLE)


def read(layout: LayoutImage, name: str) -> list[Item]:
    found = read_items(layout, name)
    return list(items_seen([one.detection for one in found], layout.frame))


def top_of(name: str, length_m: float, width_m: float, *borders: Border) -> TableTop:
    return TableTop(name, (length_m, width_m), np.ones((30, 60), np.bool_), borders)


class TestData:
    def test_the_same_dice_lay_the_same_table(self) -> None:
        one, other, third = (random_tabletop(np.random.default_rng(seed)) for seed in (5, 5, 6))
        assert [item.box for item in one.items] == [item.box for item in other.items]
        assert [item.box for item in one.items] != [item.box for item in third.items]

    def test_every_supporting_piece_and_every_item_occurs(self) -> None:
        assert {name for name, _ in SHARES} == set(SUPPORTS)
        assert {one.piece.category for one in tabletops()} == set(SUPPORTS)
        found = Counter(item.category for one in tabletops() for item in one.items)
        assert set(found) == {row.name for row in TABLE_CATEGORIES}

    def test_hardly_a_top_is_left_bare(self) -> None:
        assert sum(not one.items for one in tabletops()) <= 0.01 * COUNT

    def test_nothing_overlaps_but_what_lies_on_things_underfoot(self) -> None:
        natural = 0
        for one in tabletops():
            overlap = items_overlap(one.items)
            assert overlap.por == 0.0, one.piece
            natural += len(overlap.overlapping)
        assert natural > 10, "nothing lies on a pad or a magazine"

    def test_what_lies_on_something_is_as_high_as_that(self) -> None:
        for one in tabletops():
            pads = [item for item in one.items if category(item.category).mount is Mount.UNDERFOOT]
            for item in one.items:
                below = [
                    pad.box.center_m[2] + pad.box.size_m[2]
                    for pad in pads
                    if pad is not item
                    and shapely.intersection(
                        footprint_polygon(pad.box), footprint_polygon(item.box)
                    ).area > 1e-6
                ]  # fmt: skip
                assert item.box.center_m[2] == pytest.approx(max(below, default=0.0))

    def test_everything_stands_on_the_top_away_from_its_edge(self) -> None:
        for one in tabletops():
            for item in one.items:
                for x, y in footprint(item.box):
                    assert one.piece.outline.holds(float(x), float(y), EDGE_M - 1e-9)

    def test_settings_face_a_seat_and_are_near_it(self) -> None:
        """Whoever sits there has the plate in front: its front points to the seat's side."""
        out = {"back": (0, 1), "front": (0, -1), "left": (-1, 0), "right": (1, 0)}
        settings_laid = 0
        for one in tabletops():
            if one.piece.category != "dining_table":
                continue
            seats = one.piece.seats()
            for item in one.items:
                if item.category == "dinner_set":
                    settings_laid += 1
                    facing = front_direction(item.box.yaw_deg)
                    sides = [seat.side for seat in seats] or list(out)
                    assert any(facing @ np.array(out[side]) > 0.99 for side in sides)
        assert settings_laid > 20

    def test_every_dining_table_is_laid_at_nearly_all_of_its_seats(self) -> None:
        laid = seats = 0
        for one in tabletops():
            if one.piece.category == "dining_table":
                settings_laid = sum(item.category == "dinner_set" for item in one.items)
                assert settings_laid > 0, one.piece
                laid += min(settings_laid, len(one.piece.seats()))
                seats += len(one.piece.seats())
        assert laid > 0.9 * seats

    def test_screens_face_who_sits_at_the_desk(self) -> None:
        sides = {"back": 180.0, "front": 0.0, "left": -90.0, "right": 90.0}
        for one in tabletops():
            if one.piece.category == "table" and one.piece.seats():
                side = one.piece.seats()[0].side
                for item in one.items:
                    if item.category == "all_in_one_computer":
                        assert abs(item.box.yaw_deg) == pytest.approx(abs(sides[side]))

    def test_the_lamp_stands_on_the_side_of_the_bed(self) -> None:
        towards = {"left": -1.0, "right": 1.0}
        sums = []
        for one in tabletops():
            beds = one.piece.sides("bed")
            if one.piece.category == "bedside_table" and beds:
                lamps = [item for item in one.items if item.category == "table_lamp"]
                sums += [lamp.box.center_m[0] * towards[beds[0]] for lamp in lamps]
        assert np.mean(sums) > 0.02

    def test_nothing_stands_where_a_television_does(self) -> None:
        for one in tabletops():
            for hole in one.piece.outline.holes:
                shape = footprint_polygon(hole)
                assert not any(shape.intersects(footprint_polygon(i.box)) for i in one.items)

    def test_a_top_too_small_for_anything_stays_empty(self) -> None:
        for name in SUPPORTS:
            piece = Piece(name, Outline(0.04, 0.04, 0.0), ())
            assert lay(piece, Dice(np.random.default_rng(0))) == ()

    def test_a_round_top_has_no_corners(self) -> None:
        outline = Outline(1.0, 1.0, 0.5)
        assert outline.mask().mean() == pytest.approx(np.pi / 4, abs=0.01)
        assert outline.holds(0.48, 0.0)
        assert not outline.holds(0.4, 0.4)
        board = Board(outline, Dice(np.random.default_rng(0)))
        assert board.put("coffee_cup", (0.1, 0.1, 0.1), 0.4, 0.4, 0.0) is None
        assert board.put("coffee_cup", (0.1, 0.1, 0.1), 0.0, 0.4, 0.0) is not None


class TestPicture:
    def test_a_top_is_at_true_size_in_the_middle_of_two_metres(self) -> None:
        image = draw_table(top_of("dining_table", 1.6, 0.8))
        assert image.frame.m_per_px == CANVAS_M / TABLE_CANVAS_PX
        rows, columns = np.nonzero(top_mask(image.rgb))
        assert len(rows) * image.frame.m_per_px**2 == pytest.approx(1.6 * 0.8, rel=0.02)
        assert (rows.mean() + 0.5, columns.mean() + 0.5) == pytest.approx((64, 64), abs=0.6)

    def test_only_what_is_longer_than_the_canvas_is_drawn_smaller(self) -> None:
        frame = table_frame((3.0, 0.5))
        assert frame.m_per_px * frame.height_px > 3.0
        assert top_mask(draw_table(top_of("tv_cabinet", 3.0, 0.5)).rgb).any(axis=0).sum() < 128

    @pytest.mark.parametrize(
        ("side", "place"),
        [("back", (-1, 0)), ("front", (1, 0)), ("left", (0, -1)), ("right", (0, 1))],
    )
    def test_a_wall_is_drawn_where_it_is(self, side, place) -> None:
        image = draw_table(top_of("table", 1.0, 0.6, Border(side, "wall", -0.2, 0.2)))
        rows, columns = np.nonzero((image.rgb == 0).all(axis=2))
        found = np.sign(np.round(np.array([rows.mean(), columns.mean()]) - 63.5, -1))
        assert tuple(found) == place

    def test_shades_of_tops_stay_apart_from_what_is_painted_beside(self) -> None:
        assert len(set(TOP_SHADES.values())) == len(SUPPORTS)
        for name in SUPPORTS:
            image = draw_table(top_of(name, 0.5, 0.5, Border("back", "bed", -0.2, 0.2)))
            assert top_mask(image.rgb).sum() == (image.rgb == TOP_SHADES[name][0]).all(axis=2).sum()


class TestCondition:
    def test_it_tells_category_and_size(self) -> None:
        for index, name in enumerate(SUPPORTS):
            image = draw_table(top_of(name, 0.8, 0.5))
            condition = table_condition(image.rgb, image.frame.m_per_px, CELL_PX)
            assert condition.pixels.shape == (PIXEL_PLANES, TABLE_CANVAS_PX, TABLE_CANVAS_PX)
            side = TABLE_CANVAS_PX // CELL_PX
            assert condition.grid.shape == (GRID_PLANES, side, side)
            middle = condition.grid[:, side // 2, side // 2]
            assert middle[1 : 1 + len(SUPPORTS)].argmax() == index
            assert np.expm1(middle[AREA_PLANE] * 3.0) == pytest.approx(0.4, rel=0.05)

    def test_walls_seats_and_beds_have_planes_of_their_own(self) -> None:
        for plane, kind in enumerate(("wall", "seat", "bed"), start=1):
            image = draw_table(top_of("table", 1.0, 0.6, Border("back", kind, -0.2, 0.2)))
            pixels = table_condition(image.rgb, image.frame.m_per_px, CELL_PX).pixels
            assert [bool(pixels[k].any()) for k in (1, 2, 3)] == [k == plane for k in (1, 2, 3)]


class TestReader:
    def test_what_was_drawn_comes_back(self) -> None:
        """Recall and precision over whole tables, overlaps and all; edges in pixels."""
        truths = found = right = 0
        edges_px: list[float] = []
        for one in tabletops()[:60]:
            layout = drawn(one)
            mine = read(layout, one.piece.category)
            pairs = match_items(mine, one.items)
            truths, found, right = truths + len(one.items), found + len(mine), right + len(pairs)
            for seen, true in pairs:
                edges = edge_errors_m(seen.box, true.box) / layout.frame.m_per_px
                edges_px += edges.tolist()
        assert right >= 0.985 * truths
        assert right >= 0.985 * found
        assert np.median(edges_px) < 0.5
        assert np.mean(np.array(edges_px) <= 1.0) > 0.95

    @settings(max_examples=30)
    @given(
        row=st.sampled_from(TABLE_CATEGORIES), support=st.sampled_from(SUPPORTS),
        x=st.floats(-0.25, 0.25), y=st.floats(-0.25, 0.25), turns=st.integers(0, 3),
        share=st.floats(0.0, 1.0),
    )  # fmt: skip
    def test_one_item_comes_back_within_half_a_pixel(self, row, support, x, y, turns, share):
        size = [low + share * (high - low) for low, high in (row.length_m, row.width_m)]
        box = Box((x, y, 0.0), (size[0], size[1], row.height_m[0]), 90.0 * turns)
        image = draw_table(top_of(support, 1.6, 1.6))
        layout = canvas.layout_image(image, [Item("", row.name, box)], Level.TABLE)
        (mine,) = read(layout, support)
        assert mine.category == row.name
        assert (edge_errors_m(mine.box, box) / layout.frame.m_per_px).max() <= 0.501
        if min(size) > 5 * layout.frame.m_per_px:
            assert abs((mine.box.yaw_deg - box.yaw_deg + 180.0) % 360.0 - 180.0) < 1.0

    def test_a_pad_under_a_laptop_and_a_book_on_a_magazine_are_whole(self) -> None:
        items = [
            Item("pad", "big_mouse_pad", Box((-0.3, 0.0, 0.0), (0.8, 0.35, 0.004), 0.0)),
            Item("laptop", "laptop", Box((-0.3, 0.05, 0.004), (0.32, 0.28, 0.2), 0.0)),
            Item("magazine", "magazine", Box((0.5, 0.0, 0.0), (0.21, 0.28, 0.008), 0.0)),
            Item("book", "lying_book", Box((0.52, 0.02, 0.008), (0.15, 0.2, 0.03), 0.0)),
        ]
        layout = canvas.layout_image(draw_table(top_of("table", 1.6, 0.7)), items, Level.TABLE)
        mine = {one.category: one for one in read(layout, "table")}
        for item in items:
            errors_px = edge_errors_m(mine[item.category].box, item.box) / layout.frame.m_per_px
            assert errors_px.max() <= 0.501, item.id

    def test_a_bare_top_holds_nothing(self) -> None:
        for name in SUPPORTS:
            image = draw_table(top_of(name, 0.9, 0.6, Border("back", "wall", -0.4, 0.4),
                                      Border("front", "seat", -0.2, 0.2),
                                      Border("left", "bed", -0.2, 0.2)))  # fmt: skip
            assert read(LayoutImage(image.rgb, image.frame), name) == []
