"""Many cases in one test: all of them run, and the message names each that fails."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from typing import Any

import pytest

LATER = pytest.mark.acceptance
"""What `make test` leaves to `make acceptance`."""

MOST_SHOWN = 20
"""Failures that a message describes; it counts the others."""


def later(*cases: Any) -> list[Any]:
    """Cases for pytest.mark.parametrize that `make acceptance` runs and `make test` does not.

    A case is the value of the parameter, or a tuple of the values of several.
    """
    return [
        pytest.param(*(case if isinstance(case, tuple) else (case,)), marks=LATER) for case in cases
    ]


def for_every(
    names: str | tuple[str, ...],
    cases: Iterable[Any],
    ids: Callable[[Any], str] = str,
    step: int = 1,
) -> Callable[[Callable[..., None]], Callable[..., None]]:
    """As pytest.mark.parametrize, but one test: a loop over all cases, which share its fixtures.

    For cases that state one property of many files, designs or seeds.

    Args:
        names: the parameter that takes a case, or the parameters that take its members.
        cases: the cases; at least one.
        ids: the name of a case in the message.
        step: `make test` runs each step-th case, `make acceptance` the others.
    """
    every = list(cases)
    assert every, "a loop over nothing proves nothing"
    sample = every[::step]
    rest = [case for index, case in enumerate(every) if index % step]
    taken = (names,) if isinstance(names, str) else names

    def decorate(test: Callable[..., None]) -> Callable[..., None]:
        @wraps(test)
        def run(some: Sequence[Any] = every, **fixtures: Any) -> None:
            faults = []
            for case in some:
                members = (case,) if isinstance(names, str) else case
                try:
                    test(**dict(zip(taken, members, strict=True)), **fixtures)
                except Exception as error:
                    faults.append(f"{ids(case)}: {type(error).__name__}: {error}")
            shown = "\n".join(faults[:MOST_SHOWN])
            assert not faults, f"{len(faults)} of {len(some)} cases fail:\n{shown}"

        signature = inspect.signature(test)
        kept = [p for name, p in signature.parameters.items() if name not in taken]
        if rest:
            kept.append(inspect.Parameter("some", inspect.Parameter.KEYWORD_ONLY))
        run.__signature__ = signature.replace(parameters=kept)  # type: ignore[attr-defined]
        del run.__wrapped__  # type: ignore[attr-defined]
        if rest:
            parts = [pytest.param(sample, id="sample"), pytest.param(rest, id="rest", marks=LATER)]
            return pytest.mark.parametrize("some", parts)(run)
        return run

    return decorate
