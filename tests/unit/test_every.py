"""A loop over cases fails as often as its cases do, and names them."""

from __future__ import annotations

import inspect

import pytest

from tests.every import for_every


def test_all_cases_run_and_those_that_fail_are_named() -> None:
    seen = []

    @for_every(("first", "second"), [(1, 1), (1, 2), (3, 3), (0, 4)])
    def are_equal(first: int, second: int, shared: str) -> None:
        seen.append(shared)
        assert first == second

    assert list(inspect.signature(are_equal).parameters) == ["shared"]
    with pytest.raises(AssertionError, match=r"(?s)2 of 4 cases fail:.*\(1, 2\).*\(0, 4\)"):
        are_equal(shared="fixture")
    assert seen == ["fixture"] * 4


def test_an_error_in_a_case_is_a_failure() -> None:
    @for_every("number", [0, 1])
    def divide(number: int) -> None:
        assert 1 / number == 1

    with pytest.raises(AssertionError, match="1 of 2 cases fail:\n0: ZeroDivisionError"):
        divide()


def test_steps_leave_the_other_cases_to_acceptance() -> None:
    @for_every("number", range(7), step=3)
    def keep(number: int) -> None:
        seen.append(number)

    (mark,) = keep.pytestmark  # type: ignore[attr-defined]
    parts = []
    for part in mark.args[1]:
        seen: list[int] = []
        keep(*part.values)
        parts.append((seen, [one.name for one in part.marks]))
    assert parts == [([0, 3, 6], []), ([1, 2, 4, 5], ["acceptance"])]


def test_no_cases_are_refused() -> None:
    with pytest.raises(AssertionError, match="nothing"):
        for_every("case", [])
