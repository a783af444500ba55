"""Plans drawn in every style are read; what is no plan is refused; scores are right."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from chord_usd.base.errors import OutputError, PlanError
from chord_usd.base.scene.types import ByteArray, FloatArray, PixelFrame, Plan
from chord_usd.line.plan import drawing as drawings
from chord_usd.line.plan.drawing import Known, read_drawing
from chord_usd.line.plan.placement import WARNINGS, frame_of, placement, straightening_of
from chord_usd.line.plan.sheet import straightening_matrix
from chord_usd.line.plan.text import Text
from chord_usd.workshop.data.drawn.inscriptions import write
from chord_usd.workshop.data.drawn.page_styles import FAMILIES, random_style
from chord_usd.workshop.data.drawn.styled_plans import Drawing, draw_in_style
from chord_usd.workshop.data.houses import random_plan
from chord_usd.workshop.evaluation.plans import (
    PlanScore,
    Reader,
    clean,
    clean_case,
    measure_reading,
    score_reading,
    summaries,
)
from chord_usd.workshop.evaluation.plans_records import Records


def drawn(family: str, seed: int, rooms: int = 4) -> Drawing:
    rng = np.random.default_rng(seed)
    return draw_in_style(random_plan(rng, rooms=rooms), random_style(rng, family), rng)


def straight(plan: Plan, shape: tuple[int, ...]) -> FloatArray:
    return straightening_matrix(straightening_of(plan), shape)[0]


@pytest.fixture
def unlettered(monkeypatch: pytest.MonkeyPatch) -> None:
    """Reading without OCR, which other tests are about, and which takes a second."""
    monkeypatch.setattr(drawings, "read_texts", lambda _: ())


@pytest.mark.usefixtures("unlettered")
def test_clean_drawings_in_every_style_are_read() -> None:
    """They are drawn by other means than the pages that the network is trained on."""
    scores = []
    for number, family in enumerate(FAMILIES):
        case = clean(family, 3, number)
        m_per_px = case.frame.m_per_px
        reader = Reader(lambda rgb, s=m_per_px: read_drawing(rgb, s), frame_of, straight)
        scores.append(score_reading(case, reader))
    assert sum(score.refused for score in scores) <= 1
    assert np.median([score.walls for score in scores]) > 0.85
    assert np.median([score.room_iou for score in scores]) > 0.85
    assert not any(score.wrong_in_silence for score in scores)


# What is no plan ---------------------------------------------------------------------------------


def page_of_text() -> ByteArray:
    page = np.full((1000, 750, 3), 255, np.uint8)
    for row in range(60, 960, 30):
        write(page, "the rooms of this house are large and light", (375.0, row), 22, (0, 0, 0))
    return page


def elevation() -> ByteArray:
    """A house from the front: a gable above two rows of windows and a door."""
    page = np.full((700, 900, 3), 255, np.uint8)
    cv2.polylines(page, [np.array([[150, 300], [450, 80], [750, 300]])], True, (0, 0, 0), 2)
    cv2.rectangle(page, (150, 300), (750, 640), (0, 0, 0), 2)
    for x in (200, 340, 480, 620):
        for y in (340, 490):
            cv2.rectangle(page, (x, y), (x + 70, y + 90), (0, 0, 0), 1)
    return page


def street_map() -> ByteArray:
    """Roads in all directions between green and blue."""
    rng = np.random.default_rng(4)
    page = np.full((700, 900, 3), (225, 235, 210), np.uint8)
    cv2.circle(page, (700, 200), 120, (170, 200, 230), -1)
    for _ in range(14):
        points = rng.integers(0, 900, (4, 2)).astype(np.int32)
        cv2.polylines(page, [points], False, (255, 255, 255), 9, cv2.LINE_AA)
    return page


def room_in_perspective() -> ByteArray:
    """A photograph of a room: a back wall, a floor, light that falls off, grain."""
    page = np.full((600, 800, 3), 170, np.float64)
    cv2.fillPoly(page, [np.array([[0, 600], [200, 400], [600, 400], [800, 600]])], (120, 90, 60))
    cv2.fillPoly(page, [np.array([[0, 0], [200, 120], [200, 400], [0, 600]])], (150, 150, 145))
    cv2.rectangle(page, (330, 160), (470, 290), (230, 240, 250), -1)
    cv2.rectangle(page, (250, 350), (420, 450), (70, 60, 90), -1)
    light = np.linspace(1.1, 0.6, 800)[None, :, None]
    grain = np.random.default_rng(1).normal(0.0, 4.0, page.shape)
    soft = cv2.GaussianBlur(page * light, (0, 0), 2.0)
    return np.clip(soft + grain, 0, 255).astype(np.uint8)


NO_PLANS: dict[str, Callable[[], ByteArray]] = {
    "text": page_of_text,
    "elevation": elevation,
    "map": street_map,
    "room": room_in_perspective,
}


@pytest.mark.usefixtures("unlettered")
@pytest.mark.parametrize("name", NO_PLANS)
def test_what_is_no_plan_is_refused_or_doubted(name: str) -> None:
    """Never a house in silence."""
    try:
        plan = read_drawing(NO_PLANS[name]())
    except PlanError:
        return
    assert plan.extra[WARNINGS]


@pytest.mark.usefixtures("unlettered")
def test_a_plan_cut_through_a_room_says_so() -> None:
    whole = drawn("agent", 5)
    cut = whole.rgb[:, : round(0.6 * whole.rgb.shape[1])]
    plan = read_drawing(cut, whole.frame.m_per_px)
    assert any("cut off" in warning for warning in plan.extra[WARNINGS])


def test_what_is_printed_of_several_rooms_in_one_is_told() -> None:
    """Two bedrooms of which the wall between them was not drawn."""
    page = np.full((500, 700, 3), 255, np.uint8)
    cv2.rectangle(page, (60, 60), (640, 440), (0, 0, 0), 14)
    page[430:450, 300:360] = 255
    box = np.array([[-50.0, 240.0], [50.0, 240.0], [50.0, 260.0], [-50.0, 260.0]])
    texts = (
        Text("Bedroom 1", box + np.array([200.0, 0.0]), 1.0),
        Text("Bedroom 2", box + np.array([500.0, 0.0]), 1.0),
    )
    plan = read_drawing(page, known=Known(texts))
    warnings = plan.extra[WARNINGS]
    assert any("of several rooms" in told or "in another way" in told for told in warnings)


# Scores ------------------------------------------------------------------------------------------


def perfect(drawing: Drawing) -> Reader:
    """One who knows the truth, and does not straighten what is askew."""
    plan = replace(drawing.truth, extra=placement(drawing.frame))
    return Reader(lambda rgb: plan, frame_of, lambda plan, _: np.linalg.inv(drawing.to_picture))


def test_a_perfect_reader_scores_one() -> None:
    drawing = drawn("agent", 2)
    score = score_reading(clean_case(drawing), perfect(drawing))
    assert score.walls == score.openings == 1.0
    assert score.room_iou == pytest.approx(1.0)
    assert score.kinds_right == score.kinds
    assert not score.wrong_in_silence


def test_a_wrong_house_counts_only_in_silence() -> None:
    drawing = drawn("agent", 2)
    half = replace(drawing.truth, rooms=drawing.truth.rooms[:1], openings=())
    for extra, silent in (({}, True), ({WARNINGS: ["look"]}, False)):
        plan = replace(half, extra={**placement(drawing.frame), **extra})
        score = score_reading(
            clean_case(drawing), replace(perfect(drawing), read=lambda rgb, p=plan: p)
        )
        assert score.wrong_in_silence is silent


def test_a_house_of_the_wrong_size_is_wrong() -> None:
    told = PlanScore("agent", refused=False, room_iou=1.0, scale_error=2.3)
    assert told.wrong_in_silence
    assert not replace(told, warned=True).wrong_in_silence
    assert not replace(told, scale_error=0.1).wrong_in_silence


def test_who_refuses_scores_nothing() -> None:
    def refuse(rgb: ByteArray) -> Plan:
        raise PlanError("no closed room was found")

    score = score_reading(clean_case(drawn("agent", 2)), Reader(refuse, frame_of, straight))
    assert score.refused
    assert not score.wrong_in_silence
    assert summaries([score])["all"]["read"] == 0


def test_a_measurement_that_was_stopped_goes_on(tmp_path: Path) -> None:
    path, styles, read = tmp_path / "scores.jsonl", ("agent", "cad"), []

    def refuse(rgb: ByteArray) -> Plan:
        read.append(rgb.shape)
        raise PlanError("no closed room was found")

    def measured(count: int) -> list[PlanScore]:
        records = Records(path, 3, styles)
        reader = Reader(refuse, frame_of, straight)
        return measure_reading(
            reader, count, lambda done, total: None, styles, 3, clean, records.scores, records.keep
        )

    first = measured(1)
    with path.open("a") as file:
        file.write('{"seed": 3, "num')
    both = measured(2)
    assert (len(read), both[:2]) == (4, first)
    assert measured(2) == both
    assert len(read) == 4
    path.write_text("house\n")
    with pytest.raises(OutputError, match="is no score"):
        measured(1)


def test_the_same_seed_draws_the_same() -> None:
    assert (drawn("photo", 8).rgb == drawn("photo", 8).rgb).all()
    assert isinstance(drawn("photo", 8).frame, PixelFrame)
