"""Scores of planned floors, and measurements that go on where they were stopped."""

from pathlib import Path

import pytest

from chord_usd.base.errors import OutputError
from chord_usd.base.scene.types import Plan
from chord_usd.line.planning.choose import Candidate, judged
from chord_usd.line.planning.faults import faults
from chord_usd.workshop.evaluation.floor_records import measure_all
from chord_usd.workshop.evaluation.floors import (
    FloorCase,
    held_out_cases,
    shell_scores,
    wish_scores,
)

CASES = held_out_cases(6, aligned=True)


def test_houses_that_were_learned_from_are_sound() -> None:
    """Open plans among them, whose rooms meet without a wall."""
    for case in held_out_cases(60, aligned=False):
        assert faults(case.plan) == [], case.id


class Truth:
    """Plans the very house that a text is about, as its second try; first it plans nothing."""

    def __init__(self) -> None:
        self.asked: list[str] = []

    def __call__(self, case: FloorCase) -> tuple[tuple[Candidate, ...], Candidate]:
        self.asked.append(case.id)
        tried = judged(Plan((), ()), case.wish), judged(case.plan, case.wish)
        return tried, tried[1]


def test_the_truth_scores_in_full_and_nothing_scores_nothing() -> None:
    results = measure_all(CASES, Truth(), "a", None)
    chosen = [(case, result.chosen) for case, result in zip(CASES, results, strict=True)]
    first = [(case, result.first) for case, result in zip(CASES, results, strict=True)]
    assert {result.tried for result in results} == {2}
    scores = wish_scores(chosen)
    for name in ("room counts", "all counts", "area within 10 %", "valid"):
        assert scores[name].value == 1.0, name
    assert wish_scores(first)["all counts"].value == 0.0
    assert wish_scores(first)["valid"].value == 0.0
    shells = shell_scores(chosen)
    assert shells["outline IoU"].value > 0.99
    assert shells["windows kept"].value == 1.0
    assert shells["room-count TV"].value == 0.0
    assert shell_scores(first)["outline IoU"].value == 0.0


def test_a_measurement_goes_on_where_it_was_stopped(tmp_path: Path) -> None:
    records = tmp_path / "records.jsonl"
    before = measure_all(CASES[:2], Truth(), "a", records)
    with records.open("a") as file:
        file.write('{"networks": "a", "ca')
    truth = Truth()
    after = measure_all(CASES, truth, "a", records)
    assert truth.asked == [case.id for case in CASES[2:]]
    assert after[:2] == before
    assert measure_all(CASES, Truth(), "a", None) == after
    others = Truth()
    measure_all(CASES[:1], others, "b", records)
    assert others.asked == [CASES[0].id], "other networks have scores of their own"


def test_a_file_of_something_else_is_refused(tmp_path: Path) -> None:
    records = tmp_path / "records.jsonl"
    records.write_text('{"seed": 3}\n')
    with pytest.raises(OutputError, match="no score of a planned floor"):
        measure_all(CASES[:1], Truth(), "a", records)
