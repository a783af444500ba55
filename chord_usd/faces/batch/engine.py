"""What every engine does with a unit: try it, and say what came of it."""

from __future__ import annotations

import traceback
from collections import Counter, deque
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Protocol

from chord_usd.base.errors import ChordError, DiskFullError
from chord_usd.faces.batch.make import Make
from chord_usd.faces.batch.work_units import Unit

MOST_TRIES = 3
"""Of a unit whose worker dies: the first may have been killed for what others did."""

Load = Callable[[], Make]
"""Makes a Make, in the worker. Travels there, so it must be picklable."""


@dataclass(frozen=True)
class Result:
    """What came of a unit."""

    unit: Unit
    why: str = ""
    """Why it could not be made; empty where it was."""
    detail: str = ""
    """Traceback of an error that nobody foresaw, or the last lines of a worker that died."""
    fatal: ChordError | None = None
    """Why no other unit could be made either."""


class Engine(Protocol):
    """Spreads units over workers."""

    def run(self, units: Sequence[Unit], load: Load) -> Iterator[Result]:
        """One result for each unit, as they come. Closing the iterator ends the workers."""


def attempt(make: Make, unit: Unit) -> Result:
    """Make a unit. A unit that cannot be made is an answer, not an error."""
    try:
        make(unit)
    except DiskFullError as error:
        return Result(unit, str(error), fatal=error)
    except ChordError as error:
        return Result(unit, str(error))
    except Exception as error:
        why = f"unexpected {type(error).__name__}: {error}"
        return Result(unit, " ".join(why.split()), traceback.format_exc())
    return Result(unit)


class Queue:
    """Units that wait to be made, and how often each was tried."""

    def __init__(self, units: Sequence[Unit]) -> None:
        self._waiting = deque(units)
        self._tries: Counter[str] = Counter()

    def __len__(self) -> int:
        return len(self._waiting)

    def take(self) -> Unit:
        """The next one."""
        unit = self._waiting.popleft()
        self._tries[unit.name] += 1
        return unit

    def died(self, unit: Unit, how: str, log: str = "") -> Result | None:
        """A worker died over a unit, which waits again; the result where it was tried enough."""
        if self._tries[unit.name] < MOST_TRIES:
            self._waiting.append(unit)
            return None
        return Result(unit, f"its worker died {MOST_TRIES} times: {how}", log)
