"""Plans drawn in every style are read; scores are right."""

from __future__ import annotations

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
from tests.every import later


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
@pytest.mark.parametrize("every", [4, *later(1)])
def test_clean_drawings_in_every_style_are_read(every: int) -> None:
    """They are drawn by other means than the pages that the network is trained on."""
    scores = []
    for number, family in list(enumerate(FAMILIES))[::every]:
        case = clean(family, 3, number)
        m_per_px = case.frame.m_per_px
        reader = Reader(lambda rgb, s=m_per_px: read_drawing(rgb, s), frame_of, straight)
        scores.append(score_reading(case, reader))
    assert sum(score.refused for score in scores) <= 1
    assert np.median([score.walls for score in scores]) > 0.85
    assert np.median([score.room_iou for score in scores]) > 0.85
    assert not any(score.wrong_in_silence for score in scores)


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
