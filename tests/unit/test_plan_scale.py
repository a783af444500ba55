"""Printed measures, and which of several witnesses of the scale to believe."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chord_usd.base.scene.room_areas import plausibility, scale_by_rooms
from chord_usd.base.scene.types import RoomKind
from chord_usd.line.plan.measures import parse_measure
from chord_usd.line.plan.printed import Estimate, estimates
from chord_usd.line.plan.scale_choice import NO_MEASURE, choose_scale
from chord_usd.line.plan.text import Text

MEASURES = {
    "13m²": ("area", (13.0,)),
    "41 m2": ("area", (41.0,)),
    "8,5 ㎡": ("area", (8.5,)),
    "120 sq ft": ("area", (11.148,)),
    "LDK 12.5帖": ("area", (20.25,)),
    "6 畳": ("area", (9.72,)),
    "8 jo": ("area", (12.96,)),
    "3.45 x 2.90": ("size", (3.45, 2.9)),
    "3,45m × 2,90m": ("size", (3.45, 2.9)),
    "322 X 347": ("size", (3.22, 3.47)),
    "3220x3470": ("size", (3.22, 3.47)),
    "10'1\" × 11'1\"": ("size", (3.073, 3.378)),
    "11'1° × 13'6\"": ("size", (3.378, 4.115)),
    "3.66m x 3.05m (12'0\" x 10'0\")": ("size", (3.66, 3.05)),
    "12'0\" x 10'0\" / 3.66 x 3.05": ("size", (3.66, 3.05)),
    "13 m² (140 sq ft)": ("area", (13.0,)),
    "Bedroom 2 3.66m x 3.05m": ("size", (3.66, 3.05)),
    "9,8 f X 11.1 f": ("size", (2.987, 3.383)),
    "162×14'10": ("size", (4.928, 4.521)),
    '8\'2" x 5°3"': ("size", (2.489, 1.600)),
    "12'-6\"": ("length", (3.81,)),
    "12ft 6in": ("length", (3.81,)),
    "4500": ("length", (4.5,)),
    "3.5 m": ("length", (3.5,)),
    "350 cm": ("length", (3.5,)),
}


@pytest.mark.parametrize("text", MEASURES)
def test_measures_are_read_in_metres(text: str) -> None:
    kind, values = MEASURES[text]
    measure = parse_measure(text)
    assert measure is not None
    assert measure.kind == kind
    assert measure.values == pytest.approx(values, rel=1e-3)


@pytest.mark.parametrize("text", ["", "BH=700", "2", "Bedroom 2", "18", "9000 m²", "0 x 0", "x"])
def test_what_no_room_measures_is_no_measure(text: str) -> None:
    assert parse_measure(text) is None


@given(st.text(max_size=30))
def test_no_text_is_too_strange(text: str) -> None:
    measure = parse_measure(text)
    assert measure is None or all(value > 0.0 for value in measure.values)


# Estimates ---------------------------------------------------------------------------------------


def text_at(said: str, x: float, y: float, *, width: float = 40.0, height: float = 10.0) -> Text:
    half = np.array([width, height]) / 2
    signs = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    return Text(said, np.array([x, y]) + signs * half, 1.0)


def test_room_sizes_may_be_printed_either_way_round() -> None:
    room = np.array([[0, 0], [400, 0], [400, 300], [0, 300]], float)
    for said in ("4.00 x 3.00", "3.00 x 4.00", "400 x 300"):
        (estimate,) = estimates([text_at(said, 200, 150)], [room])
        assert estimate.m_per_px == pytest.approx(0.01)
    # The proportions of another room.
    assert estimates([text_at("4.00 x 1.50", 200, 150)], [room]) == []
    assert estimates([text_at("4.00 x 3.00", 900, 150)], [room]) == []


def test_areas_of_an_open_plan_are_added() -> None:
    room = np.array([[0, 0], [400, 0], [400, 300], [0, 300]], float)
    (estimate,) = estimates([text_at("8 m²", 100, 100), text_at("4 m²", 300, 200)], [room])
    assert estimate.m_per_px == pytest.approx(0.01)


def test_a_size_in_two_units_is_one_and_a_lost_mark_does_no_harm() -> None:
    room = np.array([[0, 0], [400, 0], [400, 300], [0, 300]], float)
    # 132×910 was 13'2 × 9'10, and looks like centimetres.
    for feet in ("13'1\" x 9'10\"", "13'1 × 910", "132×910"):
        (estimate,) = estimates([text_at(feet, 200, 100), text_at("4.00 x 3.00", 200, 150)], [room])
        assert estimate.m_per_px == pytest.approx(0.01)
    areas = [text_at("12 m²", 100, 100), text_at("129 sq ft", 100, 120)]
    (estimate,) = estimates(areas, [room])
    assert estimate.m_per_px == pytest.approx(0.01)


def lines_of(found: list[Estimate]) -> list[float]:
    return [e.m_per_px for e in found if e.witness == "dimension lines"]


@pytest.mark.parametrize("extended", [False, True])
def test_an_arrow_ends_at_its_point(extended: bool) -> None:
    canvas = np.zeros((200, 700), np.uint8)
    cv2.line(canvas, (50, 92), (650, 92), (255,), 1)
    for tip, inward in ((50, 1), (250, -1), (250, 1), (650, -1)):
        head = np.array([[tip, 92], [tip + 14 * inward, 87], [tip + 14 * inward, 97]])
        cv2.fillPoly(canvas, [head], (255,))
        if extended:
            cv2.line(canvas, (tip, 70), (tip, 130), (255,), 1)
    texts = [text_at("2000", 150, 80), text_at("4000", 450, 80)]
    scales = lines_of(estimates(texts, [], canvas > 0))
    assert sum(value == pytest.approx(0.01, rel=0.012) for value in scales) == 2


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("broken", [False, True])
def test_a_dimension_line_is_measured_between_its_ticks(turned: bool, broken: bool) -> None:
    canvas = np.zeros((200, 700), np.uint8)
    y = 80 if broken else 92
    for x in (50, 250, 650):
        cv2.line(canvas, (x - 5, y + 5), (x + 5, y - 5), (255,), 2)
    cv2.line(canvas, (50, y), (650, y), (255,), 1)
    if broken:
        canvas[60:100, 125:175] = canvas[60:100, 425:475] = 0
    texts = [text_at("2000", 150, 80), text_at("4000", 450, 80)]
    ink = canvas > 0
    if turned:
        ink = ink.T
        texts = [Text(t.text, t.corners_px[:, ::-1], 1.0) for t in texts]
    sure = lines_of(estimates(texts, [], ink))
    assert sum(value == pytest.approx(0.01, rel=0.02) for value in sure) == 2


def chain(numbers: list[str], m_per_px: float, unit_m: float, upright: bool) -> list[Text]:
    """Numbers in the middle of what they measure, along or up the sheet; "?" was not read."""
    texts, end = [], 50.0
    for said in numbers:
        length_px = float(said.strip("?")) * unit_m / m_per_px
        if "?" not in said:
            texts.append(text_at(said, end + length_px / 2, 100, width=24, height=8))
        end += length_px
    if upright:
        texts = [Text(t.text, t.corners_px[:, ::-1], 1.0) for t in texts]
    return texts


@pytest.mark.parametrize("upright", [False, True])
@pytest.mark.parametrize(
    ("numbers", "unit_m"),
    [
        (["1540", "440", "980"], 0.001),
        (["340", "3080", "1960", "120?", "2060", "340", "3860"], 0.001),
        (["1.80", "4.29", "4.00", "4.00", "5.40"], 1.0),
    ],
)
def test_numbers_in_a_row_say_the_scale_without_any_line(
    numbers: list[str], unit_m: float, upright: bool
) -> None:
    """0 of 30 dimension lines of a real plan were right; its doors are 2.19 times too wide."""
    texts = chain(numbers, 0.0095, unit_m, upright)
    scale = choose_scale(estimates(texts, []), doors=0.0095 * 1.5, walls=0.0095 * 1.3)
    assert scale.m_per_px == pytest.approx(0.0095, rel=0.03)
    assert scale.witness == "dimension chains"


def test_a_size_may_be_that_of_a_rectangle_in_a_room() -> None:
    """A bedroom with a wardrobe or an alcove is larger than the size that is printed in it."""
    room = np.array([[0, 0], [500, 0], [500, 100], [400, 100], [400, 300], [0, 300]], float)
    (estimate,) = estimates([text_at("4.00 x 3.00", 200, 150)], [room])
    assert estimate.m_per_px == pytest.approx(0.01)


def test_a_size_counts_the_floor_that_a_wardrobe_takes() -> None:
    """A bedroom open to the kitchen, with a wardrobe in its corner: br_phone_3 was 9 % off."""
    floor = [[0, 200], [130, 200], [130, 0], [310, 0], [310, 430], [190, 430], [190, 480], [0, 480]]
    found = estimates([text_at("3.10 x 2.80", 150, 300)], [np.array(floor, float)])
    assert any(one.m_per_px == pytest.approx(0.01, rel=0.02) for one in found)


def test_a_size_has_several_readings_of_which_the_others_choose() -> None:
    """A bedroom with a built-in wardrobe and a niche: cn_townhouse was read 12 % too large."""
    ring = [[0, 0], [240, 0], [240, 310], [150, 310], [150, 400], [0, 400]]
    texts = [text_at("2.40 x 3.10", 120, 150), text_at("3.80 x 3.10", 500, 150)]
    found = estimates(
        texts,
        [np.array(ring, float), np.array([[310, 0], [690, 0], [690, 310], [310, 310]], float)],
    )
    assert choose_scale(found, doors=0.0108, walls=0.012).m_per_px == pytest.approx(0.01, rel=0.01)


def test_a_size_in_one_of_many_parts_of_a_floor_is_heard() -> None:
    teeth = [
        [x, y]
        for n in range(6)
        for x, y in ((40 * n, 0), (40 * n + 20, 0), (40 * n + 20, 20), (40 * n + 40, 20))
    ]
    ring = np.array([*teeth, [600, 20], [600, 800], [400, 800], [400, 420], [0, 420]], float)
    texts = [text_at("2.00 x 3.80", 500, 600), text_at("6.00 x 4.00", 300, 300)]
    scales = [e.m_per_px for e in estimates(texts, [ring]) if e.text == "2.00 x 3.80"]
    assert any(value == pytest.approx(0.01, rel=0.03) for value in scales)


def test_an_area_printed_under_a_plan_is_of_all_within_its_outer_walls() -> None:
    rooms = [
        np.array([[at, 0], [at + 300, 0], [at + 300, 500], [at, 500]], float) for at in (0, 312)
    ]
    texts = [
        text_at("423 sq. ft", 300, 560),
        text_at("(39.29 sq. m)", 300, 580),
        text_at("60 m²", 900, 560),
    ]
    (estimate,) = estimates(texts, rooms)
    assert estimate.witness == "floor area"
    assert estimate.m_per_px == pytest.approx((39.29 / (612 * 500)) ** 0.5, rel=0.005)


@pytest.mark.parametrize(("doors", "usual"), [(0.0098, 0.0102), (0.0110, 0.0112)])
def test_the_only_area_of_a_sheet_may_be_that_of_the_home(doors: float, usual: float) -> None:
    """Also where doors and rooms lie between: cubicasa_hqa_3 was read 10 % too large."""
    rooms = [
        np.array([[at, 0], [at + x, 0], [at + x, 300], [at, 300]], float)
        for at, x in ((0, 700), (710, 300))
    ]
    found = estimates([text_at("30 m²", 300, 150)], rooms)
    scale = choose_scale(found, doors=doors, walls=0.011, rooms=(usual, 0.2))
    assert scale.m_per_px == pytest.approx(0.01, rel=0.01)


def test_areas_of_torn_floors_that_differ_a_little_count_alike() -> None:
    said = {"20 m²": 0.0108, "3 m²": 0.0095}
    printed = [Estimate("room areas", m_per_px, text) for text, m_per_px in said.items()]
    scale = choose_scale(printed, doors=0.0112, walls=0.012, rooms=(0.0102, 0.2))
    assert scale.m_per_px == pytest.approx((0.0108 * 0.0095) ** 0.5, rel=1e-6)
    assert "differ 1.14 times" in scale.warnings()[0]
    third = Estimate("room areas", 0.0107, "9 m²")
    assert choose_scale([*printed, third], doors=0.0112, walls=0.012).m_per_px > 0.0106


def test_a_scale_bar_is_read_in_one_piece_or_in_several() -> None:
    numbers = [text_at(said, 100 + 80 * i, 50, width=8) for i, said in enumerate("0123")]
    (estimate,) = estimates([*numbers, text_at("4m", 420, 50, width=16)], [])
    assert estimate.m_per_px == pytest.approx(1 / 80, rel=0.02)


# Choice ------------------------------------------------------------------------------------------


def printed(*values: float, witness: str = "room sizes") -> list[Estimate]:
    return [Estimate(witness, value, f"{i}") for i, value in enumerate(values)]


def test_printed_measures_that_agree_outvote_one_that_does_not() -> None:
    scale = choose_scale(printed(0.0101, 0.0099, 0.0100, 0.0300), doors=0.012, walls=0.015)
    assert scale.witness == "room sizes"
    assert scale.m_per_px == pytest.approx(0.01, rel=0.02)
    assert scale.count == 3
    assert scale.agreement == pytest.approx(0.75)


def test_a_lone_misread_measure_loses_to_the_doors() -> None:
    assert choose_scale(printed(0.1), doors=0.012, walls=0.015).witness == "doors"
    assert choose_scale(printed(0.011), doors=0.012, walls=0.015).witness == "room sizes"
    assert choose_scale([], doors=None, walls=0.015).witness == "walls"


def test_measures_of_which_few_agree_lose_and_say_so() -> None:
    lines = printed(*np.geomspace(0.004, 0.04, 12), 0.016, 0.0161, witness="dimension lines")
    scale = choose_scale(lines, doors=0.012, walls=0.011)
    assert scale.witness == "doors"
    assert scale.m_per_px == pytest.approx(0.012, rel=0.03)
    assert "only 14% of the printed dimension lines agree" in scale.warnings()[0]
    # Room sizes that agree are believed beside them.
    sizes = printed(0.0099, 0.01, 0.0101, witness="room sizes")
    scale = choose_scale([*lines, *sizes], doors=0.012, walls=0.011)
    assert scale.witness == "room sizes"
    assert scale.m_per_px == pytest.approx(0.01, rel=0.03)
    assert scale.warnings() == []


def test_two_misread_measures_that_agree_lose_to_doors_and_rooms_that_do() -> None:
    """Two of three "dimension lines" were the numbers of plots: 1.75 times too large."""
    lines = printed(0.0304, 0.0306, 0.008, witness="dimension lines")
    scale = choose_scale(lines, doors=0.0163, walls=0.0205, rooms=(0.0169, 0.2))
    assert scale.m_per_px == pytest.approx(0.017, rel=0.05)
    assert "dimension lines are not believed" in scale.warnings()[0]


def test_the_scale_given_wins_and_the_report_tells_what_the_others_say() -> None:
    scale = choose_scale(printed(0.01), doors=0.012, walls=0.015, given=0.02)
    report = scale.report()
    assert (report["mPerPx"], report["witness"], report["confidence"]) == (0.02, "given", 1.0)
    assert report["says"] == {"doors": 0.012, "room sizes": 0.01, "walls": 0.015}
    assert scale.warnings() == []


def test_witnesses_far_apart_are_a_warning() -> None:
    (spread,) = choose_scale([], doors=0.01, walls=0.012).warnings()
    assert spread.startswith(NO_MEASURE), "how far doors may be off"
    assert "guess" in choose_scale([], doors=None, walls=0.012).warnings()[0]
    scale = choose_scale(printed(0.01, 0.01, 0.01), doors=0.02, walls=0.01)
    assert "doors say 2.00 times" in scale.warnings()[0]


def test_a_blend_of_witnesses_that_contradict_each_other_is_a_warning() -> None:
    alike = choose_scale([], doors=0.01, walls=0.02, rooms=(0.012, 0.2))
    assert [one.startswith(NO_MEASURE) for one in alike.warnings()] == [True]
    apart = choose_scale([], doors=0.0064, walls=0.016, rooms=(0.0135, 0.2))
    assert "differ 2.11 times" in apart.warnings()[0]
    assert apart.report()["agreement"] < alike.report()["agreement"] < 1.0


def test_a_sheet_has_its_usual_scale_where_doors_are_near_to_it() -> None:
    near = choose_scale([], doors=0.0094, walls=0.0114, paper=0.0001)
    assert (near.m_per_px, near.witness) == (pytest.approx(0.01), "paper")
    assert choose_scale([], doors=0.0145, walls=0.0145, paper=0.0001).witness == "doors"
    assert choose_scale(printed(0.013, 0.013), 0.0094, 0.0114, paper=0.0001).witness != "paper"


def test_one_pair_of_numbers_is_no_chain_that_speaks_against_sizes() -> None:
    measures = [*printed(0.01, 0.0101), Estimate("dimension chains", 0.036, "2.50 | 85")]
    assert choose_scale(measures, doors=0.011, walls=0.012).warnings() == []


def test_misread_measures_that_agree_are_doubted_where_walls_say_otherwise() -> None:
    measures = [Estimate("dimension lines", 0.06, text) for text in ("1", "2", "3")]
    assert "walls say" in choose_scale(measures, None, 0.0225).warnings()[0]
    assert choose_scale(measures, None, 0.04).warnings() == []
    assert choose_scale(measures, 0.055, 0.0225).warnings() == []


def test_without_measures_doors_rooms_and_walls_speak_together() -> None:
    """Doors drawn half as wide as usual do not make bedrooms of 3 m²."""
    kinds: list[RoomKind] = ["bedroom", "bedroom", "living", "bathroom"]
    areas_m2 = np.array([11.0, 13.0, 21.0, 3.2])
    said = scale_by_rooms(kinds, list(areas_m2 / 0.02**2))
    assert said is not None
    assert said[0] == pytest.approx(0.02, rel=0.1)
    small = choose_scale([], doors=0.01, walls=0.02, rooms=said)
    assert 0.014 < small.m_per_px < 0.02
    assert scale_by_rooms(["unknown"], [100.0]) is None


def test_what_is_too_small_for_a_bedroom_is_none() -> None:
    assert plausibility("bedroom", 1.8) < 0.01
    assert plausibility("bedroom", 60.0) < 0.1
    assert plausibility("store", 0.9) == plausibility("bedroom", 9.0) == 1.0
